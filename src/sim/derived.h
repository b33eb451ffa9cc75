/* One number of a particle from its fields: pictures of a run that goes on and of its frames show the same. */
#ifndef SUNDER_SIM_DERIVED_H
#define SUNDER_SIM_DERIVED_H

/* The largest singular value of F, [3][3]: the largest principal stretch. */
double derived_stretch(const double F[9]);

/* |F a| of a fibre's direction a at rest; 1 where there is none (a = 0). */
double derived_fibre_stretch(const double F[9], const double a[3]);

#endif
