/* Filling a shape with particles. */
#ifndef SUNDER_GEOM_SAMPLING_H
#define SUNDER_GEOM_SAMPLING_H

#include "base/status.h"
#include "geom/shape.h"

#include <stdint.h>

typedef enum sampling_kind {
    SAMPLING_LATTICE,  /* cubic lattice of cell centres, aligned with the origin */
    SAMPLING_JITTERED, /* the lattice, each point moved by up to a quarter spacing, by the counter-based generator */
    SAMPLING_POISSON,  /* Poisson disk: no two points nearer than SAMPLING_POISSON_DISTANCE × spacing */
} sampling_kind;

/* Measured: dart throwing as in sampling_poisson.c then leaves one point per spacing³, to 1 %. */
#define SAMPLING_POISSON_DISTANCE 0.82

/* Points of a sampled body: position has shape [count][3]. */
typedef struct point_set {
    int64_t count, capacity;
    double *position;
} point_set;

/* Samples `s` so that one particle stands for about spacing³ of volume. Order is by lattice cell, x slowest, and
 * depends on (shape, kind, spacing, seed) alone. Errors: STATUS_INPUT when the shape is unbounded or holds no point, or
 * when the spacing is not positive or far too small for the shape (message says which), STATUS_SYSTEM out of memory;
 * `points` is then empty. The caller frees with point_set_free. */
status shape_sample(const shape *s, sampling_kind kind, double spacing, uint64_t seed, point_set *points, report *r);

void point_set_free(point_set *points);

#endif
