/* Which way the cracks face. */
#ifndef SUNDER_SIM_CRACK_H
#define SUNDER_SIM_CRACK_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* The principal eigenvector of the mean of ∇d ⊗ ∇d, with d averaged on a grid of the given spacing in rest space. rest has
 * shape [count][3], damage [count]; particles with notched[i] > 0 were broken from the start and do not count (NULL: none were).
 * *found is false while no other damage exceeds 0.5. The sign makes the largest component positive.
 * Errors: out of memory. */
status crack_normal(const double *rest, const double *damage, const double *notched, int64_t count, double spacing, double normal[3],
                    bool *found, report *r);

#endif
