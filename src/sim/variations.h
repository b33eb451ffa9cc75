/* Parameters of materials that vary in place, as factors of their materials' own. */
#ifndef SUNDER_SIM_VARIATIONS_H
#define SUNDER_SIM_VARIATIONS_H

#include "sim/bodies.h"

/* Asks every variation for every particle and fills in given_count, given_field and given. What follows from a parameter that varies
 * varies with it: with a break_stretch, sigma_c follows E from particle to particle. Factors that are 1 everywhere are left out.
 * Errors: a value out of its range or a function that fails (with the place), memory. */
status variations_evaluate(const scene *s, body_particles *p, report *r);

#endif
