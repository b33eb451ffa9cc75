/* Directions of a solved flow: by cube, then at the lattice's nodes, then everywhere. */
#include "geom/fibre_flow.h"

#include "base/threads.h"
#include "geom/disjoint.h"
#include "geom/fibre_flow_cells.h"
#include "geom/vector.h"

#include <string.h>

enum {
    LINEAR_LAYERS = 6, /* layers of nodes into which directions are continued along their change */
    CUBES_AROUND = 2,  /* on each side of a node, for its fit */
    NODES_AROUND = 3,  /* on each side of a node into which directions are continued */
};

/* How far a fit reaches, in spacings, and what is held against slopes that its samples hardly tell (a share of what unit
 * offsets would tell). Cubes are exact enough to be followed closely; what continues them must not amplify their noise. */
typedef struct fit_rule {
    double reach, ridge;
} fit_rule;

static const fit_rule CUBE_RULE = {CUBES_AROUND + 0.5, 1e-3}, NODE_RULE = {NODES_AROUND + 0.5, 0.02};

/* Cubes' worth of body around a node, below which it has its direction from other nodes. */
static const double LEAST_BODY = 0.5;

/* Of the mean gradient: below it a direction is what the solver left over. */
static const double STILL = 1e-6;

struct fibre_flow {
    double origin[3], spacing;
    int nodes[3];
    float (*direction)[3]; // [nodes[0] × nodes[1] × nodes[2]], unit
};

/* ---- fits -------------------------------------------------------------------------------------------------------- */

/* Sums of a weighted fit of a vector that changes linearly with place: v = a + B·offset. */
typedef struct linear_fit {
    double matrix[4][4], right[4][3];
} linear_fit;

static void fit_add(linear_fit *f, const fit_rule *rule, const double offset[3], const double v[3], double share) {
    double base[4] = {1.0, offset[0], offset[1], offset[2]};
    double far = vector_dot(offset, offset) / (rule->reach * rule->reach), weight = share * (1.0 - far) * (1.0 - far);
    if (far >= 1.0) return;
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 4; k++) f->matrix[i][k] += weight * base[i] * base[k];
        for (int c = 0; c < 3; c++) f->right[i][c] += weight * base[i] * v[c];
    }
}

/* The unit vector at offset 0, by elimination of the slopes; false when there were no samples or they cancel. */
static bool fit_solve(linear_fit *f, const fit_rule *rule, double direction[3]) {
    double total = f->matrix[0][0];
    if (!(total > 0.0)) return false;
    for (int i = 1; i < 4; i++) f->matrix[i][i] += rule->ridge * total;
    for (int p = 3; p > 0; p--) {
        for (int i = 0; i < p; i++) {
            double factor = f->matrix[i][p] / f->matrix[p][p];
            for (int k = 0; k < p; k++) f->matrix[i][k] -= factor * f->matrix[p][k];
            for (int c = 0; c < 3; c++) f->right[i][c] -= factor * f->right[p][c];
        }
    }
    for (int c = 0; c < 3; c++) direction[c] = f->right[0][c] / f->matrix[0][0];
    return vector_length(direction) > 1e-3 && vector_normalise(direction);
}

/* ---- cubes ------------------------------------------------------------------------------------------------------- */

typedef struct flow_field {
    const flow_cells *cells;
    double (*gradient)[3]; // [cells] unit, from inflow to outflow; zero where nothing flows
    int32_t *piece;        // [unknowns] parents of disjoint sets
    uint8_t *touched;      // [unknowns] at roots: bits by side
} flow_field;

/* Finds the pieces of the body that join inflow and outflow; false when there is none. */
static bool find_pieces(flow_field *f) {
    const flow_cells *c = f->cells;
    bool joined = false;
    for (int32_t i = 0; i < (int32_t)c->unknown_count; i++) f->piece[i] = i;
    for (int64_t i = 0; i < c->cell_count; i++)
        for (int k = 1; k < 8; k++) {
            int32_t a = disjoint_root(f->piece, c->cell[i].unknown[0]), b = disjoint_root(f->piece, c->cell[i].unknown[k]);
            f->piece[a > b ? a : b] = a > b ? b : a;
        }
    for (int64_t i = 0; i < c->cell_count; i++) {
        uint8_t *touched = &f->touched[disjoint_root(f->piece, c->cell[i].unknown[0])];
        for (int s = 0; s < FLOW_SIDES; s++)
            if (c->cell[i].touches[s]) *touched |= (uint8_t)(1 << s);
        joined = joined || *touched == 3;
    }
    return joined;
}

/* Each cube's gradient in the middle of what is inside: there the elements are most accurate. */
static void find_gradients(flow_field *f, const double *potential) {
    const flow_cells *c = f->cells;
    double sum = 0.0, weight = 0.0;
    for (int64_t i = 0; i < c->cell_count; i++) {
        const flow_cell *cell = &c->cell[i];
        double by_corner[8][3];
        if (f->touched[disjoint_root(f->piece, cell->unknown[0])] != 3) continue;
        flow_gradient(cell->middle, by_corner);
        for (int k = 0; k < 8; k++)
            for (int a = 0; a < 3; a++) f->gradient[i][a] -= potential[cell->unknown[k]] * by_corner[k][a];
        sum += cell->share * vector_length(f->gradient[i]);
        weight += cell->share;
    }
    for (int64_t i = 0; i < c->cell_count; i++) {
        bool still = vector_length(f->gradient[i]) <= STILL * sum / weight;
        if (still || !vector_normalise(f->gradient[i])) memset(f->gradient[i], 0, sizeof f->gradient[i]);
    }
}

static status field_solve(const flow_cells *c, flow_field *f, report *r) {
    size_t unknowns = (size_t)c->unknown_count;
    double *potential = memory_allocate(unknowns * sizeof *potential);
    *f = (flow_field){.cells = c, .gradient = memory_allocate((size_t)c->cell_count * sizeof *f->gradient),
                      .piece = memory_allocate(unknowns * sizeof *f->piece), .touched = memory_allocate(unknowns)};
    status code = STATUS_OK;
    if (!potential || !f->gradient || !f->piece || !f->touched)
        code = report_set(r, STATUS_SYSTEM, "out of memory for a flow of fibres");
    else if (!find_pieces(f))
        code = report_input(r, NULL, 0, "outflow", "inflow and outflow that the body joins", "a gap between them", NULL);
    if (code == STATUS_OK) code = flow_solve(c, potential, r);
    if (code == STATUS_OK) find_gradients(f, potential);
    memory_free(potential, unknowns * sizeof *potential);
    return code;
}

static void field_free(flow_field *f) {
    memory_free(f->gradient, (size_t)f->cells->cell_count * sizeof *f->gradient);
    memory_free(f->piece, (size_t)f->cells->unknown_count * sizeof *f->piece);
    memory_free(f->touched, (size_t)f->cells->unknown_count);
}

/* ---- nodes ------------------------------------------------------------------------------------------------------- */

/* Adds the `reach` cubes on each side of a node to a fit. */
static void add_cubes(const flow_field *f, const int at[3], int reach, linear_fit *fit) {
    const flow_cells *c = f->cells;
    for (int i = at[0] - reach; i < at[0] + reach; i++)
        for (int j = at[1] - reach; j < at[1] + reach; j++)
            for (int k = at[2] - reach; k < at[2] + reach; k++) {
                if (i < 0 || j < 0 || k < 0 || i >= c->nodes[0] || j >= c->nodes[1] || k >= c->nodes[2]) continue;
                int32_t number = c->cell_at[flow_node(c, i, j, k)];
                if (number < 0 || vector_dot(f->gradient[number], f->gradient[number]) == 0.0) continue;
                const double *middle = c->cell[number].middle;
                double offset[3] = {i + middle[0] - at[0], j + middle[1] - at[1], k + middle[2] - at[2]};
                fit_add(fit, &CUBE_RULE, offset, f->gradient[number], c->cell[number].share);
            }
}

enum { NODE_OPEN, NODE_DONE, NODE_NEXT };

/* The nodes that have a direction, while they are being found. */
typedef struct node_layers {
    const flow_cells *cells;
    const flow_field *field;
    fibre_flow *flow;
    uint8_t *state; // [nodes] NODE_…
    int32_t *queue; // [nodes] in the order in which they get their direction
    int64_t queued, first; /* the first of the layer that is being found */
    bool linear;           /* whether it continues directions along their change */
} node_layers;

static void set_direction(node_layers *w, int64_t node, const double direction[3]) {
    for (int c = 0; c < 3; c++) w->flow->direction[node][c] = (float)direction[c];
}

static void fit_node(node_layers *w, const int at[3]) {
    int64_t node = flow_node(w->cells, at[0], at[1], at[2]);
    linear_fit near = {0}, fit = {0};
    double direction[3];
    add_cubes(w->field, at, 1, &near);
    if (near.matrix[0][0] < LEAST_BODY) return;
    add_cubes(w->field, at, CUBES_AROUND, &fit);
    if (!fit_solve(&fit, &CUBE_RULE, direction)) return;
    set_direction(w, node, direction);
    w->state[node] = NODE_DONE;
}

static void fit_row(void *context, int64_t row, int worker) {
    (void)worker;
    node_layers *w = context;
    int at[3] = {(int)(row / w->cells->nodes[1]), (int)(row % w->cells->nodes[1]), 0};
    for (; at[2] < w->cells->nodes[2]; at[2]++) fit_node(w, at);
}

static void node_place(const flow_cells *c, int64_t node, int at[3]) {
    at[0] = (int)(node / c->nodes[2] / c->nodes[1]);
    at[1] = (int)(node / c->nodes[2] % c->nodes[1]);
    at[2] = (int)(node % c->nodes[2]);
}

/* The nodes at most `reach` from a node along each axis, those of the lattice. */
typedef struct node_range {
    int low[3], high[3];
} node_range;

static node_range range_around(const flow_cells *c, const int at[3], int reach) {
    node_range range;
    for (int i = 0; i < 3; i++) {
        range.low[i] = at[i] > reach ? at[i] - reach : 0;
        range.high[i] = at[i] + reach < c->nodes[i] ? at[i] + reach : c->nodes[i] - 1;
    }
    return range;
}

/* A direction from those of the nodes around: continued along their change, or a long way off as they are. */
static void continue_at(node_layers *w, int64_t node, bool linear) {
    int at[3];
    node_place(w->cells, node, at);
    node_range range = range_around(w->cells, at, linear ? NODES_AROUND : 1);
    linear_fit fit = {0};
    double sum[3] = {0, 0, 0}, direction[3], known[3] = {0, 0, 0};
    for (int i = range.low[0]; i <= range.high[0]; i++)
        for (int j = range.low[1]; j <= range.high[1]; j++)
            for (int k = range.low[2]; k <= range.high[2]; k++) {
                int64_t other = flow_node(w->cells, i, j, k);
                if (w->state[other] != NODE_DONE) continue;
                const double offset[3] = {i - at[0], j - at[1], k - at[2]};
                for (int a = 0; a < 3; a++) known[a] = (double)w->flow->direction[other][a], sum[a] += known[a];
                fit_add(&fit, &NODE_RULE, offset, known, 1.0);
            }
    if (linear && fit_solve(&fit, &NODE_RULE, direction)) set_direction(w, node, direction);
    else set_direction(w, node, vector_normalise(sum) ? sum : known); /* where they cancel, any of them */
}

static void queue_around(node_layers *w, int64_t node) {
    int at[3];
    node_place(w->cells, node, at);
    node_range range = range_around(w->cells, at, 1);
    for (int i = range.low[0]; i <= range.high[0]; i++)
        for (int j = range.low[1]; j <= range.high[1]; j++)
            for (int k = range.low[2]; k <= range.high[2]; k++) {
                int64_t other = flow_node(w->cells, i, j, k);
                if (w->state[other] != NODE_OPEN) continue;
                w->state[other] = NODE_NEXT;
                w->queue[w->queued++] = (int32_t)other;
            }
}

static void continue_of_layer(void *context, int64_t i, int worker) {
    (void)worker;
    node_layers *w = context;
    continue_at(w, w->queue[w->first + i], w->linear);
}

/* Layer by layer outwards from the nodes that have a direction, each from the layers before it. */
static void continue_outwards(node_layers *w) {
    int64_t first = 0;
    for (int layer = 0; first < w->queued; layer++) {
        int64_t begin = w->first = w->queued;
        w->linear = layer < LINEAR_LAYERS;
        for (int64_t i = first; i < begin; i++) queue_around(w, w->queue[i]);
        parallel_for(processor_count(), w->queued - begin, 64, continue_of_layer, w);
        for (int64_t i = begin; i < w->queued; i++) w->state[w->queue[i]] = NODE_DONE;
        first = begin;
    }
}

static status find_directions(const flow_field *f, fibre_flow *flow, report *r) {
    const flow_cells *c = f->cells;
    size_t nodes = (size_t)flow_node_count(c);
    node_layers w = {.cells = c, .field = f, .flow = flow};
    w.state = memory_allocate(nodes);
    w.queue = memory_allocate(nodes * sizeof *w.queue);
    bool fine = w.state && w.queue;
    if (fine) {
        parallel_for(processor_count(), (int64_t)c->nodes[0] * c->nodes[1], 4, fit_row, &w);
        for (int64_t i = 0; i < (int64_t)nodes; i++)
            if (w.state[i] == NODE_DONE) w.queue[w.queued++] = (int32_t)i;
        continue_outwards(&w);
    }
    memory_free(w.state, nodes);
    memory_free(w.queue, nodes * sizeof *w.queue);
    return fine ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for a flow of fibres");
}

/* ---- the whole --------------------------------------------------------------------------------------------------- */

status fibre_flow_solve(arena *a, const flow_definition *d, const fibre_flow **out, report *r) {
    flow_cells cells;
    flow_field field = {.cells = &cells};
    *out = NULL;
    status code = flow_cells_create(d, &cells, r);
    if (code == STATUS_OK) code = field_solve(&cells, &field, r);
    fibre_flow *flow = code == STATUS_OK ? arena_allocate(a, sizeof *flow) : NULL;
    if (flow) {
        flow->spacing = cells.spacing;
        memcpy(flow->origin, cells.origin, sizeof flow->origin);
        memcpy(flow->nodes, cells.nodes, sizeof flow->nodes);
        flow->direction = arena_allocate(a, (size_t)flow_node_count(&cells) * sizeof *flow->direction);
    }
    if (code == STATUS_OK && (!flow || !flow->direction))
        code = report_set(r, STATUS_SYSTEM, "out of memory for a flow of fibres");
    if (code == STATUS_OK) code = find_directions(&field, flow, r);
    if (code == STATUS_OK) *out = flow;
    field_free(&field);
    flow_cells_free(&cells);
    return code;
}

void fibre_flow_direction(const fibre_flow *f, const double x[3], double direction[3]) {
    double fraction[3], sum[3] = {0, 0, 0};
    int at[3];
    for (int c = 0; c < 3; c++) {
        double end = f->nodes[c] - 1, place = fmin(fmax((x[c] - f->origin[c]) / f->spacing, 0.0), end);
        at[c] = place < end ? (int)place : f->nodes[c] - 2;
        fraction[c] = place - at[c];
    }
    double weight[8];
    flow_shape(fraction, weight);
    for (int k = 0; k < 8; k++) {
        int64_t node = ((int64_t)(at[0] + (k >> 2)) * f->nodes[1] + at[1] + (k >> 1 & 1)) * f->nodes[2] + at[2] + (k & 1);
        for (int c = 0; c < 3; c++) sum[c] += weight[k] * (double)f->direction[node][c];
    }
    if (!vector_normalise(sum))
        for (int c = 0; c < 3; c++)
            sum[c] = (double)f->direction[((int64_t)at[0] * f->nodes[1] + at[1]) * f->nodes[2] + at[2]][c];
    memcpy(direction, sum, sizeof sum);
}
