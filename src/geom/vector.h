/* Three-component vectors for the geometry floor: small enough to be inlined everywhere. */
#ifndef SUNDER_GEOM_VECTOR_H
#define SUNDER_GEOM_VECTOR_H

#include <math.h>
#include <stdbool.h>

static inline double vector_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void vector_cross(const double a[3], const double b[3], double product[3]) {
    double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    product[0] = x, product[1] = y, product[2] = z;
}

static inline void vector_subtract(const double a[3], const double b[3], double difference[3]) {
    for (int i = 0; i < 3; i++) difference[i] = a[i] - b[i];
}

static inline double vector_length(const double a[3]) {
    return sqrt(vector_dot(a, a));
}

/* Scales `a` to unit length; false, with `a` untouched, when it is zero or not finite. Dividing by the largest
 * component first keeps the squares of very long and very short vectors in range. */
static inline bool vector_normalise(double a[3]) {
    double largest = fmax(fabs(a[0]), fmax(fabs(a[1]), fabs(a[2])));
    if (!(largest > 0.0) || !isfinite(a[0]) || !isfinite(a[1]) || !isfinite(a[2])) return false;
    double unit[3] = {a[0] / largest, a[1] / largest, a[2] / largest};
    double length = vector_length(unit);
    for (int i = 0; i < 3; i++) a[i] = unit[i] / length;
    return true;
}

#endif
