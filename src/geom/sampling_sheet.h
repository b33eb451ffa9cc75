/* Filling a surface with particles: a plane cut through a shape, or a shape's own surface. */
#ifndef SUNDER_GEOM_SAMPLING_SHEET_H
#define SUNDER_GEOM_SAMPLING_SHEET_H

#include "geom/sampling.h"

typedef enum sheet_sampling { SHEET_SAMPLING_SQUARE, SHEET_SAMPLING_HEXAGONAL, SHEET_SAMPLING_POISSON } sheet_sampling;

typedef struct sheet_region {
    const shape *shape;
    bool surface;      /* the shape's own surface; else what a plane cuts out of it */
    double point[3];   /* of the plane */
    double normal[3];  /* unit */
} sheet_region;

/* The region's area, by counting. 0 for an unbounded shape. */
double sheet_area(const sheet_region *region);

/* Points so that one stands for about spacing² of area (hexagonal: √¾ spacing²). Lattices are centred on the middle of the region's bounds, rows
 * along the first axis; Poisson disks keep 0.8 spacings apart. `area` is that of a particle. Order is by rows, or that of drawing; it depends on
 * (region, kind, spacing, seed) alone. Errors: STATUS_INPUT for an unbounded shape, a lattice on a curved surface, no or far too many points;
 * STATUS_SYSTEM. `points` is then empty. */
status sheet_sample(const sheet_region *region, sheet_sampling kind, double spacing, uint64_t seed, point_set *points, double *area, report *r);

#endif
