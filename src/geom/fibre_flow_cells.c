/* The cubes of a flow: which there are, what of each is inside, and the integrals over that. */
#include "geom/fibre_flow_cells.h"

#include "base/memory.h"
#include "base/threads.h"
#include "geom/vector.h"

#include <string.h>

enum { PARTS = 5 /* samples along each side of a cut cube */, BLOCK = 4, FIRST_CAPACITY = 1024, BATCH = 4096 /* cubes */ };

static const double NODE_LIMIT = 8e6;

/* Half a cube's diagonal, in sides. */
static const double HALF_DIAGONAL = 0.8661;

/* Cubes with less inside have no weight that directions would miss. */
static const double LEAST_SHARE = 1e-3;

/* The stiffness of what is outside within a cut cube, so that a corner far outside is still determined. */
static const double OUTSIDE = 1e-6;

/* Penalty of φ's deviation on held surfaces, times the spacing: the error is a hundredth of φ's change over a cube, and
 * about the same everywhere, which turns no direction. */
static const double PENALTY = 100.0;

/* The length of a gradient interpolated from distances, 1 beside a single surface, below which it is not believed. */
static const double AGREED = 0.8;

/* Least slope of a plane along an axis in the formulas that divide by it. */
static const double LEAST_SLOPE = 0.01;

int64_t flow_node(const flow_cells *c, int i, int j, int k) {
    return ((int64_t)i * c->nodes[1] + j) * c->nodes[2] + k;
}

int64_t flow_node_count(const flow_cells *c) {
    return (int64_t)c->nodes[0] * c->nodes[1] * c->nodes[2];
}

void flow_shape(const double place[3], double value[8]) {
    for (int k = 0; k < 8; k++)
        value[k] = (k & 4 ? place[0] : 1 - place[0]) * (k & 2 ? place[1] : 1 - place[1]) * (k & 1 ? place[2] : 1 - place[2]);
}

void flow_gradient(const double place[3], double gradient[8][3]) {
    for (int k = 0; k < 8; k++) {
        double x = k & 4 ? place[0] : 1 - place[0], y = k & 2 ? place[1] : 1 - place[1], z = k & 1 ? place[2] : 1 - place[2];
        gradient[k][0] = (k & 4 ? 1 : -1) * y * z;
        gradient[k][1] = (k & 2 ? 1 : -1) * x * z;
        gradient[k][2] = (k & 1 ? 1 : -1) * x * y;
    }
}

/* ---- a cube cut by a plane --------------------------------------------------------------------------------------- */

/* The share of a unit cube that lies where normal·(x − middle) < −distance, and the area of the plane within it. By
 * Σ ± ⟨α − Σ n⟩³ / (6 n₀ n₁ n₂) over the subsets of the normal's components (each made positive by a mirror), and its
 * derivative. */
static void cut_cube(double distance, const double normal[3], double *share, double *area) {
    double n[3], length = 0.0, reach = 0.0;
    for (int c = 0; c < 3; c++) n[c] = fmax(fabs(normal[c]), LEAST_SLOPE), length += n[c] * n[c];
    for (int c = 0; c < 3; c++) n[c] /= sqrt(length), reach += 0.5 * n[c];
    *share = distance < 0.0 ? 1.0 : 0.0;
    *area = 0.0;
    if (fabs(distance) >= reach) return;
    double cubes = 0.0, squares = 0.0, product = n[0] * n[1] * n[2];
    for (int k = 0; k < 8; k++) {
        double rest = reach - distance - (k & 4 ? n[0] : 0.0) - (k & 2 ? n[1] : 0.0) - (k & 1 ? n[2] : 0.0);
        bool odd = ((k >> 2) + (k >> 1) + k) & 1;
        if (rest <= 0.0) continue;
        cubes += (odd ? -1.0 : 1.0) * rest * rest * rest;
        squares += (odd ? -1.0 : 1.0) * rest * rest;
    }
    *share = fmin(fmax(cubes / (6.0 * product), 0.0), 1.0);
    *area = fmax(squares / (2.0 * product), 0.0);
}

/* ---- a cube of the lattice --------------------------------------------------------------------------------------- */

typedef struct flow_builder {
    const flow_definition *d;
    flow_cells *cells;
    double *distance; // [nodes] of the body, in spacings; a bound where that is enough
} flow_builder;

/* A sample of a cut cube: a part of it, with what is left of the body once inflow and outflow are taken out. */
typedef struct flow_sample {
    double place[3]; /* 0 … 1 in the cube */
    double x[3];
    double size;  /* of the part, in spacings */
    double share; /* of the part that is body */
} flow_sample;

/* How a surface cuts a part: the share inside, the surface's area by the part's side squared, and where the surface is. */
typedef struct part_cut {
    double share, area, distance, normal[3]; /* distance in the part's sides */
} part_cut;

static part_cut cut_part(const flow_builder *b, const shape *s, const flow_sample *p) {
    double step = p->size * b->cells->spacing;
    part_cut cut = {.distance = shape_distance(s, p->x) / step};
    cut.share = cut.distance < 0.0 ? 1.0 : 0.0;
    if (fabs(cut.distance) >= HALF_DIAGONAL) return cut;
    shape_normal(s, p->x, 0.5 * step, cut.normal);
    cut_cube(cut.distance, cut.normal, &cut.share, &cut.area);
    return cut;
}

/* The body's share of a part, by its distance in the part's sides. The normal comes from the distances at the cube's corners where they agree
 * about it: distances to meshes are dear. */
static double body_share(const flow_builder *b, const double corner[8], const flow_sample *p, double distance) {
    double step = p->size * b->cells->spacing, normal[3] = {0, 0, 0}, area;
    double share = distance < 0.0 ? 1.0 : 0.0, gradient[8][3];
    if (fabs(distance) >= HALF_DIAGONAL) return share;
    flow_gradient(p->place, gradient);
    for (int k = 0; k < 8; k++)
        for (int c = 0; c < 3; c++) normal[c] += corner[k] * gradient[k][c];
    if (vector_length(normal) < AGREED) shape_normal(b->d->body, p->x, 0.5 * step, normal);
    cut_cube(distance, normal, &share, &area);
    return share;
}

/* Adds the penalty of a held surface within a part: φ is asked for where the surface is, not where the sample is. */
static void hold(flow_cell *cell, double matrix[64], int side, const flow_sample *p, const part_cut *cut) {
    double place[3], value[8], weight = PENALTY * cut->area * p->share * p->size * p->size;
    if (!(weight > 0.0)) return;
    for (int c = 0; c < 3; c++) place[c] = p->place[c] - cut->distance * cut->normal[c] * p->size;
    flow_shape(place, value);
    for (int i = 0; i < 8; i++) {
        cell->held[side][i] += weight * value[i];
        for (int k = 0; k < 8; k++) matrix[8 * i + k] += weight * value[i] * value[k];
    }
    cell->touches[side] = true;
}

static void add_stiffness(double matrix[64], const double place[3], double weight) {
    double gradient[8][3];
    flow_gradient(place, gradient);
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 8; k++) matrix[8 * i + k] += weight * vector_dot(gradient[i], gradient[k]);
}

/* Which of inflow and outflow may reach into a cube; true when it lies within one of them altogether. */
static bool within_held(const flow_builder *b, const double corner[3], bool near[FLOW_SIDES]) {
    const shape *side[FLOW_SIDES] = {b->d->inflow, b->d->outflow};
    double h = b->cells->spacing, middle[3];
    bool within = false;
    for (int c = 0; c < 3; c++) middle[c] = corner[c] + 0.5 * h;
    for (int s = 0; s < FLOW_SIDES; s++) {
        double distance = shape_distance(side[s], middle) / h;
        near[s] = fabs(distance) <= HALF_DIAGONAL;
        within = within || distance < -HALF_DIAGONAL;
    }
    return within;
}

/* Integrates over one part of a cut cube. */
static void add_part(const flow_builder *b, const flow_sample *p, const bool near[FLOW_SIDES], flow_cell *cell,
                     double matrix[64]) {
    const shape *side[FLOW_SIDES] = {b->d->inflow, b->d->outflow};
    double free = 1.0, volume = p->size * p->size * p->size;
    for (int s = 0; s < FLOW_SIDES && p->share > 0.0; s++) {
        if (!near[s]) continue;
        part_cut cut = cut_part(b, side[s], p);
        if (cut.share > 0.0 && cut.share < 1.0) hold(cell, matrix, s, p, &cut);
        free -= cut.share;
    }
    double weight = p->share * fmax(free, 0.0) * volume;
    cell->share += weight;
    for (int c = 0; c < 3; c++) cell->middle[c] += weight * p->place[c];
    add_stiffness(matrix, p->place, weight + OUTSIDE * volume);
}

/* x: where corner 0 lies; distance: the body's at the corners. */
static void integrate(const flow_builder *b, const double x[3], const double distance[8], const bool near[FLOW_SIDES],
                      flow_cell *cell, double matrix[64]) {
    memset(matrix, 0, 64 * sizeof *matrix);
    double body = 0.0; /* the distance where it was asked for last, in the part's sides */
    int clear = 0;     /* parts after that which lie on the same side of the surface altogether */
    for (int k = 0; k < PARTS * PARTS * PARTS; k++) {
        const int part[3] = {k / (PARTS * PARTS), k / PARTS % PARTS, k % PARTS};
        flow_sample p = {.size = 1.0 / PARTS};
        for (int c = 0; c < 3; c++) {
            p.place[c] = (part[c] + 0.5) / PARTS;
            p.x[c] = x[c] + p.place[c] * b->cells->spacing;
        }
        if (k % PARTS == 0 || clear-- == 0) {
            body = shape_distance(b->d->body, p.x) * PARTS / b->cells->spacing;
            clear = fabs(body) > HALF_DIAGONAL ? (int)fmin(fabs(body) - HALF_DIAGONAL, PARTS) : 0;
        }
        p.share = body_share(b, distance, &p, body);
        add_part(b, &p, near, cell, matrix);
    }
    for (int c = 0; c < 3 && cell->share > 0.0; c++) cell->middle[c] /= cell->share;
}

/* The stiffness of a whole cube, by the number of axes along which two corners differ. */
static void whole_cube(double matrix[64]) {
    static const double by_axes[4] = {1.0 / 3, 0.0, -1.0 / 12, -1.0 / 12};
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 8; k++) {
            int differ = i ^ k;
            matrix[8 * i + k] = by_axes[(differ >> 2) + (differ >> 1 & 1) + (differ & 1)];
        }
}

/* ---- the lattice ------------------------------------------------------------------------------------------------- */

static status out_of_memory(report *r) {
    return report_set(r, STATUS_SYSTEM, "out of memory for a flow of fibres");
}

/* Room for one more row. */
static bool grow(void **rows, int64_t count, int64_t *capacity, size_t size) {
    if (count < *capacity) return true;
    int64_t wanted = *capacity ? 2 * *capacity : FIRST_CAPACITY;
    void *grown = memory_resize(*rows, (size_t)*capacity * size, (size_t)wanted * size);
    if (!grown) return false;
    *rows = grown, *capacity = wanted;
    return true;
}

static bool keep_matrix(flow_cells *c, const double matrix[64]) {
    void *rows = c->matrix;
    bool fine = grow(&rows, c->matrix_count, &c->matrix_capacity, sizeof *c->matrix);
    c->matrix = rows;
    if (fine) memcpy(c->matrix[c->matrix_count++], matrix, sizeof *c->matrix);
    return fine;
}

static bool keep_cell(flow_cells *c, const flow_cell *made) {
    void *rows = c->cell;
    bool fine = grow(&rows, c->cell_count, &c->cell_capacity, sizeof *c->cell);
    c->cell = rows;
    if (!fine) return false;
    flow_cell *cell = &c->cell[c->cell_count];
    *cell = *made;
    c->cell_at[flow_node(c, cell->at[0], cell->at[1], cell->at[2])] = (int32_t)c->cell_count++;
    for (int k = 0; k < 8; k++) {
        int32_t *unknown = &c->unknown[flow_node(c, cell->at[0] + (k >> 2), cell->at[1] + (k >> 1 & 1), cell->at[2] + (k & 1))];
        if (*unknown < 0) *unknown = (int32_t)c->unknown_count++;
        cell->unknown[k] = *unknown;
    }
    return true;
}

/* A cube as it was found to be: worked out on any thread, kept in the cubes' order. */
typedef enum cube_kind { CUBE_LEFT_OUT, CUBE_WHOLE, CUBE_CUT } cube_kind;
typedef struct made_cube {
    cube_kind kind;
    flow_cell cell;
    double matrix[64]; /* of a cut one */
} made_cube;

/* Works out the cube with corner 0 at a node. */
static void make_cube(const flow_builder *b, const int at[3], made_cube *made) {
    flow_cells *c = b->cells;
    double nearest = HUGE_VAL, furthest = -HUGE_VAL, distance[8], x[3];
    made->kind = CUBE_LEFT_OUT;
    for (int k = 0; k < 8; k++) {
        distance[k] = b->distance[flow_node(c, at[0] + (k >> 2), at[1] + (k >> 1 & 1), at[2] + (k & 1))];
        nearest = fmin(nearest, distance[k]), furthest = fmax(furthest, distance[k]);
    }
    if (nearest > HALF_DIAGONAL) return;
    for (int i = 0; i < 3; i++) x[i] = c->origin[i] + c->spacing * at[i];
    bool near[FLOW_SIDES];
    if (within_held(b, x, near)) return;
    made->cell = (flow_cell){.at = {at[0], at[1], at[2]}, .share = 1.0, .middle = {0.5, 0.5, 0.5}};
    made->kind = CUBE_WHOLE;
    if (furthest < -HALF_DIAGONAL && !near[FLOW_INFLOW] && !near[FLOW_OUTFLOW]) return;
    flow_cell *cell = &made->cell;
    cell->share = cell->middle[0] = cell->middle[1] = cell->middle[2] = 0.0;
    integrate(b, x, distance, near, cell, made->matrix);
    made->kind = cell->share < LEAST_SHARE ? CUBE_LEFT_OUT : CUBE_CUT;
}

typedef struct cube_batch {
    const flow_builder *builder;
    int64_t first;
    made_cube *made; // [BATCH]
} cube_batch;

static void make_of_batch(void *context, int64_t i, int worker) {
    (void)worker;
    const cube_batch *batch = context;
    const int *nodes = batch->builder->cells->nodes;
    int64_t row = (batch->first + i) / (nodes[2] - 1);
    const int at[3] = {(int)(row / (nodes[1] - 1)), (int)(row % (nodes[1] - 1)), (int)((batch->first + i) % (nodes[2] - 1))};
    make_cube(batch->builder, at, &batch->made[i]);
}

static bool keep_made(flow_cells *c, made_cube *made) {
    if (made->kind == CUBE_LEFT_OUT) return true;
    if (made->kind == CUBE_WHOLE) return keep_cell(c, &made->cell);
    made->cell.matrix = (int32_t)c->matrix_count;
    return keep_matrix(c, made->matrix) && keep_cell(c, &made->cell);
}

static bool make_cubes(const flow_builder *b) {
    flow_cells *c = b->cells;
    int64_t cubes = (int64_t)(c->nodes[0] - 1) * (c->nodes[1] - 1) * (c->nodes[2] - 1);
    cube_batch batch = {.builder = b, .made = memory_allocate_array(BATCH, sizeof *batch.made)};
    bool fine = batch.made;
    for (; fine && batch.first < cubes; batch.first += BATCH) {
        int64_t count = cubes - batch.first < BATCH ? cubes - batch.first : BATCH;
        parallel_for(processor_count(), count, 32, make_of_batch, &batch);
        for (int64_t i = 0; i < count && fine; i++) fine = keep_made(c, &batch.made[i]);
    }
    memory_free(batch.made, BATCH * sizeof *batch.made);
    return fine;
}

/* The body's distance at the nodes. Blocks of nodes that lie far from the surface get that of their middle. */
static void sample_block(const flow_builder *b, const int first[3]) {
    const flow_cells *c = b->cells;
    double x[3], reach = 0.5 * BLOCK * sqrt(3.0) + 2.0;
    int end[3];
    for (int i = 0; i < 3; i++) {
        end[i] = first[i] + BLOCK < c->nodes[i] ? first[i] + BLOCK : c->nodes[i];
        x[i] = c->origin[i] + c->spacing * (first[i] + 0.5 * (BLOCK - 1));
    }
    double middle = shape_distance(b->d->body, x) / c->spacing;
    for (int i = first[0]; i < end[0]; i++)
        for (int j = first[1]; j < end[1]; j++)
            for (int k = first[2]; k < end[2]; k++) {
                const double node[3] = {c->origin[0] + c->spacing * i, c->origin[1] + c->spacing * j,
                                        c->origin[2] + c->spacing * k};
                bool far = fabs(middle) > reach;
                b->distance[flow_node(c, i, j, k)] = far ? middle : shape_distance(b->d->body, node) / c->spacing;
            }
}

static void sample_layer(void *context, int64_t layer, int worker) {
    (void)worker;
    const flow_builder *b = context;
    int at[3] = {(int)layer * BLOCK, 0, 0};
    for (at[1] = 0; at[1] < b->cells->nodes[1]; at[1] += BLOCK)
        for (at[2] = 0; at[2] < b->cells->nodes[2]; at[2] += BLOCK) sample_block(b, at);
}

static bool fill(flow_builder *b) {
    double whole[64];
    parallel_for(processor_count(), (b->cells->nodes[0] + BLOCK - 1) / BLOCK, 1, sample_layer, b);
    whole_cube(whole);
    return keep_matrix(b->cells, whole) && make_cubes(b);
}

/* Chooses the lattice: two cubes of room around the body. */
static status place_lattice(const flow_definition *d, flow_cells *c, report *r) {
    double low[3], high[3], longest = 0.0, nodes = 1.0;
    shape_bounds(d->body, low, high);
    for (int i = 0; i < 3; i++) {
        if (!isfinite(low[i]) || !isfinite(high[i]))
            return report_input(r, NULL, 0, "shape", "a bounded shape for the flow", "one that has no end", NULL);
        longest = fmax(longest, high[i] - low[i]);
    }
    double volume = d->resolution > 0 ? 1.0 : shape_volume(d->body, 0);
    if (!(longest > 0.0) || !(volume > 0.0))
        return report_input(r, NULL, 0, "shape", "a shape with some volume for the flow", "none", NULL);
    c->spacing = d->resolution > 0 ? longest / d->resolution : cbrt(volume / FLOW_CUBES);
    for (int i = 0; i < 3; i++) {
        double cubes = ceil((high[i] - low[i]) / c->spacing) + 4.0;
        c->origin[i] = 0.5 * (low[i] + high[i]) - 0.5 * cubes * c->spacing;
        nodes *= cubes + 1.0;
        c->nodes[i] = (int)fmin(cubes + 1.0, NODE_LIMIT);
    }
    if (nodes <= NODE_LIMIT) return STATUS_OK;
    return report_input(r, NULL, 0, "resolution", "a lattice of at most 8 million nodes over the shape's box", "a finer one",
                        NULL);
}

static status check_sides(const flow_cells *c, report *r) {
    static const char *const names[FLOW_SIDES] = {"inflow", "outflow"};
    bool touched[FLOW_SIDES] = {false, false}, both = false;
    for (int64_t i = 0; i < c->cell_count; i++) {
        for (int s = 0; s < FLOW_SIDES; s++) touched[s] = touched[s] || c->cell[i].touches[s];
        both = both || (c->cell[i].touches[FLOW_INFLOW] && c->cell[i].touches[FLOW_OUTFLOW]);
    }
    for (int s = 0; s < FLOW_SIDES; s++)
        if (!touched[s])
            return report_input(r, NULL, 0, names[s], "a shape that holds a part of the body, and not all of it", "none of it, or all", NULL);
    if (both)
        return report_input(r, NULL, 0, "resolution", "cubes smaller than what lies between inflow and outflow",
                            "both in one cube", NULL);
    return STATUS_OK;
}

status flow_cells_create(const flow_definition *d, flow_cells *out, report *r) {
    *out = (flow_cells){0};
    status code = place_lattice(d, out, r);
    if (code != STATUS_OK) return code;
    size_t nodes = (size_t)flow_node_count(out);
    flow_builder b = {.d = d, .cells = out, .distance = memory_allocate(nodes * sizeof *b.distance)};
    out->unknown = memory_allocate(nodes * sizeof *out->unknown);
    out->cell_at = memory_allocate(nodes * sizeof *out->cell_at);
    bool fine = b.distance && out->unknown && out->cell_at;
    if (fine) {
        memset(out->unknown, -1, nodes * sizeof *out->unknown);
        memset(out->cell_at, -1, nodes * sizeof *out->cell_at);
        fine = fill(&b);
    }
    memory_free(b.distance, nodes * sizeof *b.distance);
    return fine ? check_sides(out, r) : out_of_memory(r);
}

void flow_cells_free(flow_cells *c) {
    size_t nodes = (size_t)flow_node_count(c);
    memory_free(c->unknown, nodes * sizeof *c->unknown);
    memory_free(c->cell_at, nodes * sizeof *c->cell_at);
    memory_free(c->cell, (size_t)c->cell_capacity * sizeof *c->cell);
    memory_free(c->matrix, (size_t)c->matrix_capacity * sizeof *c->matrix);
    *c = (flow_cells){0};
}
