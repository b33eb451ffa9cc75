/* Fibre directions in material space. */
#ifndef SUNDER_GEOM_FIBRES_H
#define SUNDER_GEOM_FIBRES_H

#include <stdbool.h>

/* Turns one or two directions into an orthonormal pair: a1 is normalised, a2 loses its part along a1 and is normalised.
 * Where a2 is zero or (nearly) parallel to a1 it becomes a unit vector orthogonal to a1, the same one for the same a1.
 * Returns false, with both untouched, when a1 is zero or either is not finite. */
bool fibres_orthonormalise(double a1[3], double a2[3]);

#endif
