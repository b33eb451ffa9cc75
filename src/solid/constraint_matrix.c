/* The inextensible solve's operator as a matrix, B M⁻¹ Bᵀ + ε over the cells that hold fibres (METHOD.md §4): what libraries make
 * preconditioners of. B's row of a cell is dense on the nodes around it: 4³ with the quadratic kernel, 6³ with the cubic. In f64. */
#include "base/memory.h"
#include "base/threads.h"
#include "solid/inextensible_lanes.h"
#include "solid/order.h"

enum { WIDEST = 6, AROUND = BLOCK + 2 * (WIDEST - 1) };

typedef struct assembly {
    const solid *state;
    const int32_t *number; // [slots][BLOCK_NODES], −1: no unknown
    double dt;
    int low, width; /* a cell's nodes start at `low` from it */
    double *rows;   // [cells][width³][3]
    int32_t (*near)[125]; // [slots] slots of the blocks around, −2 … 2; −1: none
    sparse_matrix *matrix;
} assembly;

static size_t row_size(const assembly *a) {
    return (size_t)(a->width * a->width * a->width * 3);
}

/* One particle's share of its cells' rows. */
SIMD_INLINE void add_particle(const assembly *a, const fibre_lanes *l, int lane, const solid_block *b, kernel_kind kernel) {
    int nodes = kernel == KERNEL_QUADRATIC ? 3 : 4, width = a->width;
    double scale = (kernel == KERNEL_QUADRATIC ? 4.0 : 3.0) / a->state->definition.dx, gradient[64], direction[3];
    real gamma[8];
    int base[3], cell[3];
    const vec u[3] = {l->at.u.x, l->at.u.y, l->at.u.z}, low[3] = {l->at.base.x, l->at.base.y, l->at.base.z};
    const vec along[3] = {l->a.x, l->a.y, l->a.z};
    double w[3][4], x[3][4];
    for (int axis = 0; axis < 3; axis++) {
        vec weight[4];
        kernel_weights(kernel, u[axis], weight);
        direction[axis] = (double)along[axis][lane];
        base[axis] = (int)low[axis][lane];
        cell[axis] = (int)floor((double)(low[axis][lane] + u[axis][lane]) - 0.5);
        for (int n = 0; n < nodes; n++) w[axis][n] = (double)weight[n][lane], x[axis][n] = direction[axis] * ((double)n - (double)u[axis][lane]);
    }
    for (int i = 0; i < nodes; i++)
        for (int j = 0; j < nodes; j++)
            for (int n = 0; n < nodes; n++)
                gradient[(i * 4 + j) * 4 + n] = scale * w[0][i] * w[1][j] * w[2][n] * (x[0][i] + x[1][j] + x[2][n]);
    cell_weights(l, lane, gamma);
    for (int c = 0; c < 8; c++) {
        int at[3] = {cell[0] + (c >> 2), cell[1] + (c >> 1 & 1), cell[2] + (c & 1)}, block = 0, node = 0, first[3];
        for (int axis = 0; axis < 3; axis++) {
            int o = at[axis] < 0 ? -1 : at[axis] >= BLOCK ? 1 : 0;
            block = block * 3 + o + 1;
            node = node * BLOCK + at[axis] - o * BLOCK;
            first[axis] = base[axis] - at[axis] - a->low;
        }
        int32_t number = a->number[(int64_t)b->neighbour[block] * BLOCK_NODES + node];
        if (number < 0) continue;
        double *row = a->rows + (size_t)number * row_size(a), share = (double)(l->volume[lane] * gamma[c]);
        for (int i = 0; i < nodes; i++)
            for (int j = 0; j < nodes; j++)
                for (int n = 0; n < nodes; n++) {
                    double *to = row + (((first[0] + i) * width + first[1] + j) * width + first[2] + n) * 3;
                    for (int k = 0; k < 3; k++) to[k] += share * gradient[(i * 4 + j) * 4 + n] * direction[k];
                }
    }
}

SIMD_INLINE void add_block(const assembly *a, int32_t block, kernel_kind kernel) {
    const solid *s = a->state;
    const solid_block *b = &s->blocks[block];
    FOR_EACH_PART(s, b, {
        fibre_lanes l = lanes_load(s, kernel, pack, part);
        for (int lane = 0; lane < LANES_OF(t, first); lane++) add_particle(a, &l, lane, b, kernel);
    })
}

static void add_quadratic(void *context, int32_t block, int32_t next, int worker) {
    (void)next, (void)worker;
    add_block(context, block, KERNEL_QUADRATIC);
}

static void add_cubic(void *context, int32_t block, int32_t next, int worker) {
    (void)next, (void)worker;
    add_block(context, block, KERNEL_CUBIC);
}

static void find_near(void *context, int64_t slot, int worker) {
    (void)worker;
    const assembly *a = context;
    const int32_t *own = a->state->slot_coordinate[slot];
    for (int n = 0; n < 125; n++) {
        int32_t c[3] = {own[0] + n / 25 - 2, own[1] + n / 5 % 5 - 2, own[2] + n % 5 - 2};
        a->near[slot][n] = order_rank(a->state, block_key(c));
    }
}

/* Index [slot][node] of what lies at an offset from a place in a slot, −1 outside the grid. */
static int64_t index_at(const assembly *a, int32_t slot, const int at[3]) {
    int block = 0, node = 0;
    for (int axis = 0; axis < 3; axis++) {
        int o = (at[axis] + 2 * BLOCK) / BLOCK - 2;
        block = block * 5 + o + 2;
        node = node * BLOCK + at[axis] - o * BLOCK;
    }
    int32_t near = a->near[slot][block];
    return near < 0 ? -1 : (int64_t)near * BLOCK_NODES + node;
}

/* M⁻¹ times a cell's row, holds obeyed. */
static void respond(const assembly *a, int32_t slot, const int cell[3], const double *row, double *out) {
    const solid *s = a->state;
    int width = a->width;
    for (int n = 0; n < width * width * width; n++) {
        int at[3] = {cell[0] + a->low + n / (width * width), cell[1] + a->low + n / width % width, cell[2] + a->low + n % width};
        int64_t index = index_at(a, slot, at);
        real mass = index < 0 ? 0 : s->grid[index * NODE + 3];
        double *v = out + 3 * n;
        for (int k = 0; k < 3; k++) v[k] = mass > 0 ? row[3 * n + k] * a->dt / (double)mass : 0;
        if (index >= 0) hold_project(&s->constraint.holds[index], v);
    }
}

/* Σ over the nodes that two cells share, `line` of them in a row along z. */
SIMD_INLINE double product_of(int width, int line, const double *response, const double *row, const int offset[3]) {
    int from[2], to[2], up = offset[2] > 0 ? offset[2] : 0;
    for (int axis = 0; axis < 2; axis++) {
        from[axis] = offset[axis] > 0 ? offset[axis] : 0;
        to[axis] = offset[axis] < 0 ? width + offset[axis] : width;
    }
    double sums[3 * WIDEST] = {0}, sum = 0;
    for (int i = from[0]; i < to[0]; i++)
        for (int j = from[1]; j < to[1]; j++) {
            const double *x = response + ((i * width + j) * width + up) * 3;
            const double *y = row + (((i - offset[0]) * width + j - offset[1]) * width + up - offset[2]) * 3;
            for (int k = 0; k < 3 * line; k++) sums[k] += x[k] * y[k];
        }
    for (int k = 0; k < 3 * line; k++) sum += sums[k];
    return sum;
}

/* Widths and lines as constants: the innermost loop is a few instructions. */
static double product(int width, const double *response, const double *row, const int offset[3]) {
    int line = width - (offset[2] < 0 ? -offset[2] : offset[2]);
    if (width == 4) switch (line) {
        case 4: return product_of(4, 4, response, row, offset);
        case 3: return product_of(4, 3, response, row, offset);
        case 2: return product_of(4, 2, response, row, offset);
        default: return product_of(4, 1, response, row, offset);
        }
    switch (line) {
    case 6: return product_of(6, 6, response, row, offset);
    case 5: return product_of(6, 5, response, row, offset);
    case 4: return product_of(6, 4, response, row, offset);
    case 3: return product_of(6, 3, response, row, offset);
    case 2: return product_of(6, 2, response, row, offset);
    default: return product_of(6, 1, response, row, offset);
    }
}

/* The numbers of a slot's cells and of those that share a node with them; false when the slot has no unknowns. */
static bool number_around(const assembly *a, int32_t slot, int32_t *around) {
    bool some = false;
    for (int n = 0; n < BLOCK_NODES; n++) some |= a->number[(int64_t)slot * BLOCK_NODES + n] >= 0;
    int reach = a->width - 1, wide = BLOCK + 2 * reach;
    for (int n = 0; n < wide * wide * wide && some; n++) {
        int at[3] = {n / (wide * wide) - reach, n / wide % wide - reach, n % wide - reach};
        int64_t index = index_at(a, slot, at);
        around[n] = index < 0 ? -1 : a->number[index];
    }
    return some;
}

/* The column of one cell; `row` and `value` NULL: counts its entries only. */
static int32_t add_column(const assembly *a, const int32_t *around, int32_t own, const int cell[3], const double *response, int32_t *row,
                          double *value) {
    int reach = a->width - 1, wide = BLOCK + 2 * reach;
    int32_t used = 0;
    for (int i = -reach; i <= reach; i++)
        for (int j = -reach; j <= reach; j++) {
            const int32_t *line = around + ((cell[0] + i + reach) * wide + cell[1] + j + reach) * wide + cell[2] + reach;
            for (int k = -reach; k <= reach; k++) {
                if (line[k] < own) continue;
                if (row) {
                    row[used] = line[k];
                    value[used] = product(a->width, response, a->rows + (size_t)line[k] * row_size(a), (const int[]){i, j, k});
                }
                used++;
            }
        }
    return used;
}

static void count_slot(void *context, int64_t index, int worker) {
    (void)worker;
    const assembly *a = context;
    int32_t around[AROUND * AROUND * AROUND], slot = a->state->constraint.slots[index];
    bool some = number_around(a, slot, around);
    for (int n = 0; some && n < BLOCK_NODES; n++) {
        int32_t own = a->number[(int64_t)slot * BLOCK_NODES + n];
        if (own >= 0) a->matrix->start[own + 1] = add_column(a, around, own, (const int[]){n / 16, n / 4 % 4, n % 4}, NULL, NULL, NULL);
    }
}

static void fill_slot(void *context, int64_t index, int worker) {
    (void)worker;
    const assembly *a = context;
    sparse_matrix *m = a->matrix;
    int32_t around[AROUND * AROUND * AROUND], slot = a->state->constraint.slots[index];
    double response[WIDEST * WIDEST * WIDEST * 3];
    bool some = number_around(a, slot, around);
    for (int n = 0; some && n < BLOCK_NODES; n++) {
        int32_t own = a->number[(int64_t)slot * BLOCK_NODES + n];
        if (own < 0) continue;
        int cell[3] = {n / 16, n / 4 % 4, n % 4};
        respond(a, slot, cell, a->rows + (size_t)own * row_size(a), response);
        int32_t *row = m->row + m->start[own];
        double *value = m->value + m->start[own];
        int32_t used = add_column(a, around, own, cell, response, row, value);
        for (int32_t e = 0; e < used; e++)
            if (row[e] == own) value[e] += constraint_relaxation(a->state, slot, n);
    }
}

int constraint_reach(const solid *s) {
    return (s->definition.kernel == KERNEL_QUADRATIC ? 4 : WIDEST) - 1;
}

/* Counts the entries and makes room for them. */
static status allocate_matrix(assembly *a, sparse_matrix *m, int32_t cells, report *r) {
    const solid *s = a->state;
    if (!sparse_start(m, cells)) return report_set(r, STATUS_SYSTEM, "out of memory for the matrix of %d cells of inextensible fibres", cells);
    parallel_for(s->threads, s->constraint.slot_count, 4, count_slot, a);
    int64_t entries = 0;
    for (int32_t i = 0; i < cells; i++) {
        entries += m->start[i + 1];
        if (entries >= INT32_MAX) return report_set(r, STATUS_SYSTEM, "%d cells of inextensible fibres are too many for a matrix", cells);
        m->start[i + 1] = (int32_t)entries;
    }
    if (!sparse_allocate(m)) return report_set(r, STATUS_SYSTEM, "out of memory for the matrix of %d cells of inextensible fibres", cells);
    return STATUS_OK;
}

status constraint_assemble(solid *s, real dt, const int32_t *number, int32_t cells, sparse_matrix *m, report *r) {
    bool quadratic = s->definition.kernel == KERNEL_QUADRATIC;
    assembly a = {.state = s, .number = number, .dt = (double)dt, .low = quadratic ? -1 : -2, .width = constraint_reach(s) + 1, .matrix = m};
    a.rows = memory_allocate_array((size_t)cells, row_size(&a) * sizeof *a.rows);
    a.near = memory_allocate_array((size_t)s->slot_count, sizeof *a.near);
    status code = STATUS_OK;
    if (!a.rows || !a.near) code = report_set(r, STATUS_SYSTEM, "out of memory for the matrix of %d cells of inextensible fibres", cells);
    if (code == STATUS_OK) {
        parallel_for(s->threads, s->slot_count, 64, find_near, &a);
        code = allocate_matrix(&a, m, cells, r);
    }
    if (code == STATUS_OK) {
        colours_pass(s, quadratic ? add_quadratic : add_cubic, &a);
        parallel_for(s->threads, s->constraint.slot_count, 4, fill_slot, &a);
    }
    memory_free(a.rows, a.rows ? (size_t)cells * row_size(&a) * sizeof *a.rows : 0);
    memory_free(a.near, a.near ? (size_t)s->slot_count * sizeof *a.near : 0);
    return code;
}
