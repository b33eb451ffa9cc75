/* The inextensible solve's operator as a matrix, B M⁻¹ Bᵀ + ε over the cells that hold fibres (METHOD.md §4): what libraries make
 * preconditioners of. B's row of a cell is dense on the nodes around it: 4³ with the quadratic kernel, 6³ with the cubic. In f64. */
#include "base/memory.h"
#include "base/threads.h"
#include "solid/inextensible_lanes.h"
#include "solid/order.h"

enum {
    WIDEST = 6,
    AROUND = BLOCK + 2 * (WIDEST - 1),
    QUADS = (3 * WIDEST + 3) / 4, /* of a line of nodes along z */
    SHIFTED = (2 * WIDEST - 1) * WIDEST * WIDEST * QUADS * 4,
};

typedef double quad __attribute__((vector_size(4 * sizeof(double))));

typedef struct assembly {
    const solid *state;
    const int32_t *number; // [slots][BLOCK_NODES], −1: no unknown
    double dt;
    int low, width;       /* a cell's nodes start at `low` from it */
    double *rows;         // [cells][width³][3]
    int32_t (*near)[125]; // [slots] slots of the blocks around, −2 … 2; −1: none
    sparse_matrix *matrix;
} assembly;

static size_t row_size(const assembly *a) {
    return (size_t)(a->width * a->width * a->width * 3);
}

/* One particle's share of its cells' rows. */
SIMD_INLINE void add_particle(const assembly *a, const fibre_lanes *l, int lane, const solid_block *b, kernel_kind kernel) {
    int nodes = kernel == KERNEL_QUADRATIC ? 3 : 4, width = a->width;
    double scale = (kernel == KERNEL_QUADRATIC ? 4.0 : 3.0) / a->state->definition.dx, direction[3], pull[4][4][12]; /* a_α (a · G_i) */
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
            for (int n = 0; n < nodes; n++) {
                double gradient = scale * w[0][i] * w[1][j] * w[2][n] * (x[0][i] + x[1][j] + x[2][n]);
                for (int k = 0; k < 3; k++) pull[i][j][3 * n + k] = gradient * direction[k];
            }
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
            for (int j = 0; j < nodes; j++) {
                double *to = row + (((first[0] + i) * width + first[1] + j) * width + first[2]) * 3;
                for (int k = 0; k < 3 * nodes; k++) to[k] += share * pull[i][j][k];
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

static void find_near(void *context, int64_t index, int worker) {
    (void)worker;
    const assembly *a = context;
    int32_t slot = a->state->constraint.slots[index];
    const int32_t *own = a->state->slot_coordinate[slot];
    for (int n = 0; n < 125; n++) {
        int32_t c[3] = {own[0] + n / 25 - 2, own[1] + n / 5 % 5 - 2, own[2] + n % 5 - 2};
        a->near[slot][n] = order_rank(a->state, block_key(c));
    }
}

/* A slot and what its cells share nodes with: the places from `reach` before its first cell to as far after its last. */
typedef struct surroundings {
    int wide;                                /* places along an axis */
    int32_t place[AROUND * AROUND * AROUND]; /* index [slot][node] of each, −1 outside the grid */
    int32_t number[AROUND * AROUND * AROUND];
} surroundings;

static int place_at(const surroundings *around, int reach, int x, int y, int z) {
    return ((x + reach) * around->wide + y + reach) * around->wide + z + reach;
}

/* False, and nothing else known, when none of the slot's own cells is an unknown. */
static bool look_around(const assembly *a, int32_t slot, surroundings *around) {
    bool some = false;
    for (int n = 0; n < BLOCK_NODES; n++) some |= a->number[(int64_t)slot * BLOCK_NODES + n] >= 0;
    if (!some) return false;
    int reach = a->width - 1, wide = around->wide = BLOCK + 2 * reach, block[AROUND], node[AROUND];
    for (int i = 0; i < wide; i++) block[i] = (i - reach + 2 * BLOCK) / BLOCK, node[i] = (i - reach + 2 * BLOCK) % BLOCK;
    int n = 0;
    for (int i = 0; i < wide; i++)
        for (int j = 0; j < wide; j++)
            for (int k = 0; k < wide; k++, n++) {
                int32_t near = a->near[slot][(block[i] * 5 + block[j]) * 5 + block[k]];
                around->place[n] = near < 0 ? -1 : near * BLOCK_NODES + (node[i] * BLOCK + node[j]) * BLOCK + node[k];
                around->number[n] = near < 0 ? -1 : a->number[around->place[n]];
            }
    return true;
}

/* M⁻¹ times a cell's row, holds obeyed. */
static void respond(const assembly *a, const surroundings *around, const int cell[3], const double *row, double *out) {
    const solid *s = a->state;
    int width = a->width;
    for (int n = 0; n < width * width * width; n++) {
        int at = place_at(around, width - 1, cell[0] + a->low + n / (width * width), cell[1] + a->low + n / width % width, cell[2] + a->low + n % width);
        int32_t place = around->place[at];
        double mass = place < 0 ? 0 : (double)s->grid[(int64_t)place * NODE + 3], inverse = mass > 0 ? a->dt / mass : 0, *v = out + 3 * n;
        for (int k = 0; k < 3; k++) v[k] = row[3 * n + k] * inverse;
        if (place >= 0) hold_project(&s->constraint.holds[place], v);
    }
}

static int line_quads(int width) {
    return (3 * width + 3) / 4;
}

/* A response for each distance along z, −reach … reach: moved by so much, zero where nothing is, its lines filled up
 * with zeros to whole quads. A product is then one of whole lines, whatever the distance. */
static void shift_response(int width, const double *response, double *shifted) {
    int reach = width - 1, lines = width * width, length = line_quads(width) * 4;
    memset(shifted, 0, (size_t)((2 * reach + 1) * lines * length) * sizeof *shifted);
    for (int k = -reach; k <= reach; k++)
        for (int line = 0; line < lines; line++, shifted += length) {
            int from = k > 0 ? 3 * k : 0, to = k < 0 ? -3 * k : 0;
            memcpy(shifted + to, response + line * 3 * width + from, (size_t)(3 * width - from - to) * sizeof *shifted);
        }
}

/* Σ over the nodes that two cells share, the second (i, j) further along x and y. Reads up to a quad past the end of the row. */
SIMD_INLINE double product_of(int width, int quads, const double *shifted, const double *row, int i, int j) {
    quad sums[QUADS] = {{0}};
    for (int x = i > 0 ? i : 0; x < width + (i < 0 ? i : 0); x++)
        for (int y = j > 0 ? j : 0; y < width + (j < 0 ? j : 0); y++) {
            const double *response = shifted + (x * width + y) * quads * 4, *other = row + ((x - i) * width + y - j) * 3 * width;
            for (int q = 0; q < quads; q++) {
                quad a, b;
                memcpy(&a, response + q * 4, sizeof a);
                memcpy(&b, other + q * 4, sizeof b);
                sums[q] += a * b;
            }
        }
    for (int q = 1; q < quads; q++) sums[0] += sums[q];
    return (sums[0][0] + sums[0][2]) + (sums[0][1] + sums[0][3]);
}

/* Widths as constants: sums stay in registers. */
static double product(int width, const double *shifted, const double *row, int i, int j, int k) {
    shifted += (k + width - 1) * width * width * line_quads(width) * 4;
    return width == 4 ? product_of(4, 3, shifted, row, i, j) : product_of(6, 5, shifted, row, i, j);
}

/* The column of one cell; `row` and `value` NULL: counts its entries only. */
static int32_t add_column(const assembly *a, const surroundings *around, int32_t own, const int cell[3], const double *shifted, int32_t *row, double *value) {
    int reach = a->width - 1;
    int32_t used = 0;
    for (int i = -reach; i <= reach; i++)
        for (int j = -reach; j <= reach; j++) {
            const int32_t *line = around->number + place_at(around, reach, cell[0] + i, cell[1] + j, cell[2]);
            for (int k = -reach; k <= reach; k++) {
                if (line[k] < own) continue;
                if (row) {
                    row[used] = line[k];
                    value[used] = product(a->width, shifted, a->rows + (size_t)line[k] * row_size(a), i, j, k);
                }
                used++;
            }
        }
    return used;
}

static void count_slot(void *context, int64_t index, int worker) {
    (void)worker;
    const assembly *a = context;
    int32_t slot = a->state->constraint.slots[index];
    surroundings around;
    bool some = look_around(a, slot, &around);
    for (int n = 0; some && n < BLOCK_NODES; n++) {
        int32_t own = a->number[(int64_t)slot * BLOCK_NODES + n];
        if (own >= 0) a->matrix->start[own + 1] = add_column(a, &around, own, (const int[]){n / 16, n / 4 % 4, n % 4}, NULL, NULL, NULL);
    }
}

static void fill_slot(void *context, int64_t index, int worker) {
    (void)worker;
    const assembly *a = context;
    sparse_matrix *m = a->matrix;
    int32_t slot = a->state->constraint.slots[index];
    surroundings around;
    double response[WIDEST * WIDEST * WIDEST * 3], shifted[SHIFTED];
    bool some = look_around(a, slot, &around);
    for (int n = 0; some && n < BLOCK_NODES; n++) {
        int32_t own = a->number[(int64_t)slot * BLOCK_NODES + n];
        if (own < 0) continue;
        int cell[3] = {n / 16, n / 4 % 4, n % 4};
        respond(a, &around, cell, a->rows + (size_t)own * row_size(a), response);
        shift_response(a->width, response, shifted);
        int32_t *row = m->row + m->start[own];
        double *value = m->value + m->start[own];
        int32_t used = add_column(a, &around, own, cell, shifted, row, value);
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
    size_t reals = (size_t)cells * row_size(&a) + 4; /* and what product_of reads past the last */
    a.rows = memory_allocate_array(reals, sizeof *a.rows);
    a.near = memory_allocate_array((size_t)s->slot_count, sizeof *a.near);
    status code = STATUS_OK;
    if (!a.rows || !a.near) code = report_set(r, STATUS_SYSTEM, "out of memory for the matrix of %d cells of inextensible fibres", cells);
    if (code == STATUS_OK) {
        parallel_for(s->threads, s->constraint.slot_count, 16, find_near, &a);
        code = allocate_matrix(&a, m, cells, r);
    }
    if (code == STATUS_OK) {
        colours_pass(s, quadratic ? add_quadratic : add_cubic, &a);
        parallel_for(s->threads, s->constraint.slot_count, 4, fill_slot, &a);
    }
    memory_free(a.rows, a.rows ? reals * sizeof *a.rows : 0);
    memory_free(a.near, a.near ? (size_t)s->slot_count * sizeof *a.near : 0);
    return code;
}
