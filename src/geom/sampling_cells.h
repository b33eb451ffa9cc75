/* The cells that a shape's box is cut into: private to the sampling*.c files. */
#ifndef SUNDER_GEOM_SAMPLING_CELLS_H
#define SUNDER_GEOM_SAMPLING_CELLS_H

#include "geom/sampling.h"

/* Cells low … low + count − 1 along each axis; cell i spans i × spacing to (i + 1) × spacing. */
typedef struct cell_range {
    const shape *body;
    double spacing;
    int64_t low[3], count[3];
} cell_range;

/* The distance of a cell's centre. `index` counts from the coordinate origin. */
double cell_distance(const cell_range *cells, const int64_t index[3]);

/* How many cells from one on along any axis have centres nearer to it than `clear`: at least 1 (itself), at most
 * `left`. */
int64_t cells_within(double clear, double spacing, int64_t left);

/* A number that depends on the cell's place alone: the counter of its random numbers. */
uint64_t cell_key(const int64_t index[3]);

/* Appends a point; STATUS_SYSTEM when memory is out. */
status point_set_add(point_set *points, const double x[3], report *r);

/* Appends the Poisson-disk points of the body. */
status poisson_sample(const cell_range *cells, uint64_t seed, point_set *points, report *r);

#endif
