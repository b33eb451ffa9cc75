/* Which way the cracks face. */
#ifndef SUNDER_SIM_CRACK_H
#define SUNDER_SIM_CRACK_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* The principal eigenvector of the mean of ∇d ⊗ ∇d, with d averaged on a grid of the given spacing in rest space. rest has
 * shape [count][3], damage [count]. *found is false while no damage exceeds 0.5. The sign makes the largest component positive.
 * Errors: out of memory. */
status crack_normal(const double *rest, const double *damage, int64_t count, double spacing, double normal[3], bool *found,
                    report *r);

#endif
