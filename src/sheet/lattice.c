/* Endless lattices: neighbours and weights that make them isotropic. */
#include "sheet/network.h"

#include <math.h>

static const double SAME = 1e-9;

int lattice_neighbours(sheet_lattice kind, double radius, double (*xy)[2]) {
    bool hexagonal = kind == SHEET_HEXAGONAL;
    int reach = (int)ceil(radius * 1.2) + 1, count = 0;
    for (int b = -reach; b <= reach; b++)
        for (int a = -2 * reach; a <= 2 * reach; a++) {
            double x = a + (hexagonal ? 0.5 * b : 0), y = b * (hexagonal ? sqrt(0.75) : 1.0), r = hypot(x, y);
            if ((a == 0 && b == 0) || r > radius * (1 + SAME) || count == LATTICE_LIMIT) continue;
            xy[count][0] = x;
            xy[count++][1] = y;
        }
    return count;
}

/* What must sum to zero, weighted, for in-plane isotropy: n_x⁴ − 3 n_x² n_y². */
static double anisotropy(const double xy[2]) {
    double r2 = xy[0] * xy[0] + xy[1] * xy[1], x2 = xy[0] * xy[0] / r2, y2 = xy[1] * xy[1] / r2;
    return 0.5 * (x2 * x2 + y2 * y2) - 3 * x2 * y2; /* x and y alike: the lattices have both */
}

/* The smallest change of 1 − r/R that is isotropic, with W ≥ 0: along the constraint's gradient, on those that stay positive. */
static bool smallest_change(double radius, const double (*xy)[2], int count, double *weight) {
    bool held[LATTICE_LIMIT] = {false};
    for (int round = 0; round <= count; round++) {
        double wanted = 0, gradient = 0;
        for (int k = 0; k < count; k++) {
            double g = anisotropy(xy[k]), start = held[k] ? 0 : 1 - hypot(xy[k][0], xy[k][1]) / radius;
            wanted += start * g;
            if (!held[k]) gradient += g * g;
        }
        if (fabs(wanted) > SAME && !(gradient > SAME)) return false;
        double multiplier = gradient > SAME ? wanted / gradient : 0, total = 0;
        bool changed = false;
        for (int k = 0; k < count; k++) {
            weight[k] = held[k] ? 0 : 1 - hypot(xy[k][0], xy[k][1]) / radius - multiplier * anisotropy(xy[k]);
            if (weight[k] < 0) held[k] = changed = true;
            total += weight[k];
        }
        if (!changed) return total > SAME;
    }
    return false;
}

status lattice_weights(sheet_weight kind, double radius, const double (*xy)[2], int count, double *weight, report *r) {
    double unequal = 0;
    for (int k = 0; k < count; k++) unequal += anisotropy(xy[k]);
    bool constant = kind == WEIGHT_CONSTANT || (kind == WEIGHT_ISOTROPIC && count <= 8 && fabs(unequal) < SAME);
    for (int k = 0; k < count; k++) weight[k] = constant ? 1 : 1 - hypot(xy[k][0], xy[k][1]) / radius;
    if (kind != WEIGHT_ISOTROPIC || constant || smallest_change(radius, xy, count, weight)) return STATUS_OK;
    return report_set(r, STATUS_INPUT, "no bond weights make this lattice isotropic within %g spacings: 1.5 or more are needed", radius);
}
