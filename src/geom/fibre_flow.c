/* Directions of a solved flow: by cube, then at the lattice's nodes, then everywhere. */
#include "geom/fibre_flow.h"

#include "geom/fibre_flow_cells.h"
#include "geom/vector.h"

#include <string.h>

enum { LINEAR_LAYERS = 6 /* nodes that a direction is continued along its own change */ };

/* Reach of the fits, in spacings: two cubes, or nodes, on each side. */
static const double FIT_REACH = 2.5;

/* Held against slopes that few samples tell: relative to a slope that unit offsets tell well. */
static const double RIDGE = 1e-3;

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

static void fit_add(linear_fit *f, const double offset[3], const double v[3]) {
    double base[4] = {1.0, offset[0], offset[1], offset[2]};
    double far = vector_dot(offset, offset) / (FIT_REACH * FIT_REACH), weight = (1.0 - far) * (1.0 - far);
    if (far >= 1.0) return;
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 4; k++) f->matrix[i][k] += weight * base[i] * base[k];
        for (int c = 0; c < 3; c++) f->right[i][c] += weight * base[i] * v[c];
    }
}

/* The unit vector at offset 0, by Cholesky's factorisation in the order that leaves it for last; false when there were
 * no samples or they cancel. */
static bool fit_solve(linear_fit *f, double direction[3]) {
    double total = f->matrix[0][0];
    if (!(total > 0.0)) return false;
    for (int i = 1; i < 4; i++) f->matrix[i][i] += RIDGE * total;
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

static int32_t root_of(int32_t *parent, int32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* Finds the pieces of the body that join inflow and outflow; false when there is none. */
static bool find_pieces(flow_field *f) {
    const flow_cells *c = f->cells;
    bool joined = false;
    for (int32_t i = 0; i < (int32_t)c->unknown_count; i++) f->piece[i] = i;
    for (int64_t i = 0; i < c->cell_count; i++)
        for (int k = 1; k < 8; k++) {
            int32_t a = root_of(f->piece, c->cell[i].unknown[0]), b = root_of(f->piece, c->cell[i].unknown[k]);
            f->piece[a > b ? a : b] = a > b ? b : a;
        }
    for (int64_t i = 0; i < c->cell_count; i++) {
        uint8_t *touched = &f->touched[root_of(f->piece, c->cell[i].unknown[0])];
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
        if (f->touched[root_of(f->piece, cell->unknown[0])] != 3) continue;
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

/* Adds the cubes around a node, those `reach` of them away on each side, to a fit; whether one of them has a flow. */
static bool add_cubes(const flow_field *f, const int at[3], int reach, linear_fit *fit) {
    const flow_cells *c = f->cells;
    bool any = false;
    for (int i = at[0] - reach; i < at[0] + reach; i++)
        for (int j = at[1] - reach; j < at[1] + reach; j++)
            for (int k = at[2] - reach; k < at[2] + reach; k++) {
                if (i < 0 || j < 0 || k < 0 || i >= c->nodes[0] || j >= c->nodes[1] || k >= c->nodes[2]) continue;
                int32_t number = c->cell_at[flow_node(c, i, j, k)];
                if (number < 0 || vector_dot(f->gradient[number], f->gradient[number]) == 0.0) continue;
                const double *middle = c->cell[number].middle;
                double offset[3] = {i + middle[0] - at[0], j + middle[1] - at[1], k + middle[2] - at[2]};
                fit_add(fit, offset, f->gradient[number]);
                any = true;
            }
    return any;
}

/* Which nodes have a direction, while they are being found. */
typedef struct node_layers {
    const flow_cells *cells;
    fibre_flow *flow;
    uint8_t *done;     // [nodes]
    int32_t *frontier; // [nodes] of this layer
} node_layers;

static void set_direction(node_layers *w, int64_t node, const double direction[3]) {
    for (int c = 0; c < 3; c++) w->flow->direction[node][c] = (float)direction[c];
}

static void fit_nodes(node_layers *w, const flow_field *f) {
    const flow_cells *c = w->cells;
    for (int i = 0; i < c->nodes[0]; i++)
        for (int j = 0; j < c->nodes[1]; j++)
            for (int k = 0; k < c->nodes[2]; k++) {
                const int at[3] = {i, j, k};
                int64_t node = flow_node(c, i, j, k);
                linear_fit near = {0}, fit = {0};
                double direction[3];
                if (!add_cubes(f, at, 1, &near)) continue;
                add_cubes(f, at, 2, &fit);
                if (!fit_solve(&fit, direction)) continue;
                set_direction(w, node, direction);
                w->done[node] = 1;
            }
}

/* The direction at a node from those of nodes around it: continued along their change, or where that has become a long
 * way off (or cancels) as they are. */
static bool continue_at(const node_layers *w, const int at[3], bool linear) {
    const flow_cells *c = w->cells;
    linear_fit fit = {0};
    double sum[3] = {0, 0, 0}, direction[3];
    int reach = linear ? 2 : 1;
    for (int i = at[0] - reach; i <= at[0] + reach; i++)
        for (int j = at[1] - reach; j <= at[1] + reach; j++)
            for (int k = at[2] - reach; k <= at[2] + reach; k++) {
                if (i < 0 || j < 0 || k < 0 || i >= c->nodes[0] || j >= c->nodes[1] || k >= c->nodes[2]) continue;
                int64_t node = flow_node(c, i, j, k);
                if (!w->done[node]) continue;
                const float *v = w->flow->direction[node];
                const double offset[3] = {i - at[0], j - at[1], k - at[2]}, known[3] = {(double)v[0], (double)v[1], (double)v[2]};
                fit_add(&fit, offset, known);
                for (int a = 0; a < 3; a++) sum[a] += known[a];
            }
    if (linear && fit_solve(&fit, direction)) memcpy(sum, direction, sizeof sum);
    else if (!vector_normalise(sum)) return false;
    float *to = w->flow->direction[flow_node(c, at[0], at[1], at[2])];
    for (int a = 0; a < 3; a++) to[a] = (float)sum[a];
    return true;
}
