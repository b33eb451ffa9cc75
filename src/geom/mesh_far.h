/* Distances far from a mesh's surface, from samples on a lattice: private to the mesh*.c files.
 *
 * The exact search is fast near the surface only: towards the middle of a shape more and more triangles are about as
 * near as the nearest. There interpolated samples stand in, less than the most that interpolation can exceed the
 * truth by: for a point's nearest surface point p, |x − p| bounds the distance all over the cell and has second
 * derivatives that sum to 2/|x − p|, so that the error of trilinear interpolation is at most h²/(4|x − p|). */
#ifndef SUNDER_GEOM_MESH_FAR_H
#define SUNDER_GEOM_MESH_FAR_H

#include "base/memory.h"

#include <stdbool.h>

typedef struct mesh_far {
    double origin[3], spacing;
    int nodes[3];
    float *value; // [nodes[0]][nodes[1]][nodes[2]] signed, never further from 0 than the distance
} mesh_far;

/* Samples the box of `low` and `high`, and some way around it, with about `cells` cells along its longest side.
 * `exact` is asked where it must be. False when memory is out. */
bool mesh_far_create(arena *a, const double low[3], const double high[3], int cells,
                     double (*exact)(const void *context, const double x[3]), const void *context, mesh_far *out);

/* Whether x is so far from the surface that the samples tell: then *distance is signed, not beyond the true one, and
 * within a tenth of it inside the lattice. */
bool mesh_far_distance(const mesh_far *f, const double x[3], double *distance);

#endif
