#include "geom/fibres.h"

#include "geom/vector.h"

/* Sine of the angle to a1 below which a2's orthogonal part is mostly round-off of its input. */
static const double PARALLEL_SINE = 1e-8;

/* The cross product with the coordinate axis that lies furthest from `a` is never short. */
static void any_orthogonal(const double a[3], double orthogonal[3]) {
    int least = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(a[i]) < fabs(a[least])) least = i;
    double axis[3] = {0.0, 0.0, 0.0};
    axis[least] = 1.0;
    vector_cross(a, axis, orthogonal);
    vector_normalise(orthogonal);
}

static void remove_part_along(const double a[3], double b[3]) {
    double along = vector_dot(a, b);
    for (int i = 0; i < 3; i++) b[i] -= along * a[i];
}

bool fibres_orthonormalise(double a1[3], double a2[3]) {
    if (!isfinite(a2[0]) || !isfinite(a2[1]) || !isfinite(a2[2]) || !vector_normalise(a1)) return false;
    if (vector_normalise(a2)) remove_part_along(a1, a2);
    if (vector_length(a2) < PARALLEL_SINE) {
        any_orthogonal(a1, a2);
        return true;
    }
    vector_normalise(a2);
    /* When a2 was close to a1, the first removal left round-off along a1 that normalising has magnified. */
    remove_part_along(a1, a2);
    vector_normalise(a2);
    return true;
}
