/* How much a lattice holds cracks back: worked out at rest, and measured on running cracks.
 *
 * At rest: bonds of a strip break one by one, each at the load that it needs; the largest of a period (tests/verify/test_sheet_trapping.c works it out
 * anew). A running crack needs a little less, since each break shakes the next bond; by how much is measured at two radii of each lattice
 * (tests/verify/test_sheet_fracture.c) and lies between elsewhere. */
#include "sheet/network.h"

#include <math.h>

typedef struct trapping_row {
    double radius, at_rest; /* in spacings; toughness of the lattice over that of the bonds which the crack cuts */
} trapping_row;

static const trapping_row square[] = {
    {1.5, 2.523}, {2.236, 2.523}, {2.24, 2.361}, {2.3, 2.234}, {2.5, 1.997}, {2.7, 1.880}, {2.83, 1.800}, {2.9, 1.776},
    {3.015, 1.745}, {3.2, 1.691}, {3.5, 1.597}, {4, 1.437}, {5, 1.252}, {6, 1.120},
};

static const trapping_row hexagonal[] = {
    {1.2, 3.626}, {1.732, 3.626}, {1.75, 3.490}, {1.8, 3.193}, {1.9, 2.988}, {2, 2.663}, {2.1, 2.439}, {2.3, 2.209},
    {2.5, 2.091}, {2.65, 2.027}, {2.8, 1.798}, {3, 1.625}, {3.5, 1.384}, {4, 1.210}, {5, 1.074}, {6, 1.009},
};

/* What a running crack needs of that, at the two radii where it was measured. */
static const struct {
    double radius[2], share[2];
} running[] = {
    [SHEET_SQUARE] = {{1.5, 3.015}, {2.48 / 2.523, 1.59 / 1.745}},
    [SHEET_HEXAGONAL] = {{1.5, 2.1}, {3.55 / 3.626, 2.31 / 2.439}},
};

double trapping_at_rest(sheet_lattice lattice, double radius) {
    const trapping_row *row = lattice == SHEET_HEXAGONAL ? hexagonal : square;
    int last = (int)(lattice == SHEET_HEXAGONAL ? sizeof hexagonal / sizeof *hexagonal : sizeof square / sizeof *square) - 1, k = 0;
    while (k < last - 1 && radius > row[k + 1].radius) k++;
    double share = fmin(1, fmax(0, (radius - row[k].radius) / (row[k + 1].radius - row[k].radius)));
    return row[k].at_rest + share * (row[k + 1].at_rest - row[k].at_rest);
}

double trapping_toughness(sheet_lattice lattice, double radius, int neighbours) {
    /* Random sets have no period to work out: a power of the number of neighbours through what the square lattice has at 8 and at 24. */
    if (lattice == SHEET_SCATTERED) return 1 + 1.48 * pow(8.0 / neighbours, 0.837);
    const double *at = running[lattice].radius, *share = running[lattice].share;
    double along = fmin(1, fmax(0, (radius - at[0]) / (at[1] - at[0])));
    return fmax(1, trapping_at_rest(lattice, radius) * (share[0] + along * (share[1] - share[0])));
}
