/* The discrete problem behind fibre_flow: private to the fibre_flow*.c files. Lengths are in units of the spacing. */
#ifndef SUNDER_GEOM_FIBRE_FLOW_CELLS_H
#define SUNDER_GEOM_FIBRE_FLOW_CELLS_H

#include "geom/fibre_flow.h"

#include <stdint.h>

enum { FLOW_INFLOW, FLOW_OUTFLOW, FLOW_SIDES };

/* A cube that holds part of the flow. Corner k lies at (k & 4, k & 2, k & 1). */
typedef struct flow_cell {
    int at[3];
    int32_t unknown[8]; /* of the corners */
    int32_t matrix;     /* into matrices; 0: the whole cube's */
    double share;       /* of the cube that is inside */
    double middle[3];   /* of that share, 0 … 1 along each axis */
    double held[FLOW_SIDES][8]; /* Σ penalty × shape function on the held surfaces: the right-hand side for φ = 1 there */
    bool touches[FLOW_SIDES];
} flow_cell;

typedef struct flow_cells {
    double origin[3], spacing;
    int nodes[3];
    int32_t *unknown;     // [nodes[0] × nodes[1] × nodes[2]] number of the unknown, −1 for none
    int32_t *cell_at;     // [nodes[0] × nodes[1] × nodes[2]] cell whose corner 0 is that node, −1 for none
    int64_t cell_count, cell_capacity, matrix_count, matrix_capacity, unknown_count;
    flow_cell *cell;
    double (*matrix)[64]; // [matrix_count] stiffness, 8 × 8
} flow_cells;

/* Cuts the body into cubes and integrates over them. `out` may hold anything after an error: flow_cells_free. */
status flow_cells_create(const flow_definition *d, flow_cells *out, report *r);
void flow_cells_free(flow_cells *c);

int64_t flow_node(const flow_cells *c, int i, int j, int k);
int64_t flow_node_count(const flow_cells *c);

/* Values of the corners' shape functions, and their derivatives, at a place 0 … 1 in a cube. */
void flow_shape(const double place[3], double value[8]);
void flow_gradient(const double place[3], double gradient[8][3]);

/* φ by unknown, by conjugate gradients. */
status flow_solve(const flow_cells *c, double *potential, report *r);

#endif
