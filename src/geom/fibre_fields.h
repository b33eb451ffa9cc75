/* Fields of fibre directions that are more than a formula. Signs mean nothing: a and −a are the same fibre. */
#ifndef SUNDER_GEOM_FIBRE_FIELDS_H
#define SUNDER_GEOM_FIBRE_FIELDS_H

#include "base/memory.h"
#include "base/status.h"

#include <stdint.h>

/* ---- along a curve ---- */

typedef struct fibre_curve fibre_curve;

enum { FIBRE_CURVE_POINTS = 4096 };

/* Through points [count][3], 2 ≤ count ≤ FIBRE_CURVE_POINTS, neighbours apart; closed when the last is the first. NULL
 * when memory is out. */
const fibre_curve *fibre_curve_create(arena *a, const double *points, int count);

/* The curve's direction where it is nearest to x, of unit length: it turns evenly along each segment, and where several
 * segments are about as near it changes over from one to the other within half a segment's length. */
void fibre_curve_direction(const fibre_curve *c, const double x[3], double direction[3]);

/* ---- random ---- */

/* A direction within `spread` (radians, 0 to π) of the unit vector `mean`, evenly over that part of the sphere. It depends
 * on (seed, x) alone, and differs from place to place without any relation. */
void fibre_random_direction(const double mean[3], double spread, uint64_t seed, const double x[3], double direction[3]);

/* ---- from a table ---- */

typedef struct fibre_table fibre_table;

/* Reads rows x, y, z, dx, dy, dz, or with three more numbers for a second family; separated by commas, semicolons or
 * blanks. Empty lines, what follows a '#', and a first line of names are skipped. Errors: STATUS_INPUT with file and line,
 * STATUS_SYSTEM when memory is out. */
status fibre_table_read(arena *a, const char *file, const void *data, size_t size, const fibre_table **out, report *r);

/* 1 or 2. */
int fibre_table_families(const fibre_table *t);

/* The row nearest to x. direction has shape [families][3]; not normalised. */
void fibre_table_nearest(const fibre_table *t, const double x[3], double *direction);

/* The eight nearest rows, weighted by inverse distances so that the field is continuous; each is turned to agree with the
 * nearest first. */
void fibre_table_blend(const fibre_table *t, const double x[3], double *direction);

#endif
