/* The elastic response of lattices: constants under uniform strain, Poisson's ratio, swelling, rubber (METHOD.md §6, "Checks").
 *
 * A patch is given a uniform deformation. The force that one half exerts on the other grows with the patch's width by the stress of one more
 * interior row: edges cancel exactly. */
#include "check.h"
#include "verify/sheet_patch.h"

enum { LONG = 16, WIDE = 12 };

typedef struct lattice_case {
    sheet_lattice lattice;
    double radius, nu;
    const char *law;
    double alpha, theta;
} lattice_case;

static double weight; /* of bonds: a choice of the law */
static const double E = 3, THICKNESS = 0.25, DX = 0.5;

static patch *make(const lattice_case *c, int nx, int ny, const double F[4]) {
    patch *p = patch_create(c->lattice, DX, c->radius, THICKNESS);
    patch_fill(p, nx, ny);
    patch_set(p, c->law, "E", E);
    patch_set(p, c->law, "nu", c->nu);
    patch_set(p, c->law, "weight", weight);
    if (c->alpha != 0) patch_set(p, "diffusion", "k", 0), patch_set(p, "swelling", "alpha", c->alpha);
    for (int64_t i = 0; i < p->d.count; i++) {
        double x = p->rest[i][0], y = p->rest[i][1];
        p->position[i][0] = F[0] * x + F[1] * y;
        p->position[i][1] = F[2] * x + F[3] * y;
        p->diffused[i] = c->theta;
    }
    return p;
}

/* Σ F over the particles beyond the middle along `axis`. */
static void half_force(const lattice_case *c, int nx, int ny, const double F[4], int axis, double out[2]) {
    static double force[PATCH_LIMIT][3];
    patch *p = make(c, nx, ny, F);
    CHECK(patch_forces(p, force[0]));
    double rise = c->lattice == SHEET_HEXAGONAL ? sqrt(0.75) : 1, middle = axis ? DX * rise * ny / 2 : DX * nx / 2;
    out[0] = out[1] = 0;
    for (int64_t i = 0; i < p->d.count; i++)
        if (p->rest[i][axis] > middle - 1e-9)
            for (int k = 0; k < 2; k++) out[k] += force[i][k];
    patch_free(p);
}

/* First Piola stress times thickness on a face whose rest normal is `axis`. */
static void stress(const lattice_case *c, const double F[4], int axis, double P[2]) {
    double one[2], two[2], rise = c->lattice == SHEET_HEXAGONAL ? sqrt(0.75) : 1;
    int more = axis ? 1 : 2; /* two rows: hexagonal ones alternate */
    half_force(c, axis ? WIDE : LONG, axis ? LONG : WIDE, F, axis, one);
    half_force(c, axis ? WIDE + more : LONG, axis ? LONG : WIDE + more, F, axis, two);
    for (int k = 0; k < 2; k++) P[k] = -(two[k] - one[k]) / (more * DX * (axis ? 1 : rise));
}

static void constants(const lattice_case *c, double *C11, double *C12, double *C66) {
    double e = 1e-7, P[2];
    stress(c, (const double[]){1 + e, 0, 0, 1}, 0, P);
    *C11 = P[0] / e;
    stress(c, (const double[]){1, 0, 0, 1 + e}, 0, P);
    *C12 = P[0] / e;
    stress(c, (const double[]){1, e, 0, 1}, 1, P);
    *C66 = P[0] / e;
}

static void eight_neighbours_are_isotropic(void) {
    const lattice_case c = {SHEET_SQUARE, 1.5, 1.0 / 3, "linear", 0, 0};
    double C11, C12, C66, unit = E * THICKNESS;
    constants(&c, &C11, &C12, &C66);
    CHECK_ROW("METHOD 6", "square lattice, 8 neighbours, W = 1: C11 / E h", 9.0 / 8, C11 / unit, 1e-6);
    CHECK_ROW("METHOD 6", "the same: C12 / E h", 3.0 / 8, C12 / unit, 1e-6);
    CHECK_ROW("METHOD 6", "the same: C66 / E h", 3.0 / 8, C66 / unit, 1e-6);
}

static void lattices_have_the_moduli_asked_for(void) {
    static const lattice_case cases[] = {
        {SHEET_SQUARE, 1.5, 1.0 / 3, "linear", 0, 0},    {SHEET_SQUARE, 3.015, 1.0 / 3, "linear", 0, 0},
        {SHEET_SQUARE, 2.3, 1.0 / 3, "linear", 0, 0},    {SHEET_HEXAGONAL, 1.5, 1.0 / 3, "linear", 0, 0},
        {SHEET_HEXAGONAL, 3.015, 1.0 / 3, "linear", 0, 0}, {SHEET_SQUARE, 1.5, 0.1, "linear", 0, 0},
        {SHEET_SQUARE, 3.015, 0.45, "linear", 0, 0},     {SHEET_HEXAGONAL, 1.5, 0.45, "linear", 0, 0},
        {SHEET_HEXAGONAL, 2.1, 0.2, "linear", 0, 0},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        const lattice_case *c = &cases[k];
        double C11, C12, C66;
        constants(c, &C11, &C12, &C66);
        double nu = C12 / C11, modulus = C11 * (1 - nu * nu) / THICKNESS;
        bool free_ratio = fabs(c->nu - 1.0 / 3) > 1e-9;
        char text[160];
        const char *kind = c->lattice == SHEET_SQUARE ? "square" : "hexagonal";
        snprintf(text, sizeof text, "uniform strain, %s lattice, R = %g dx%s: E", kind, c->radius, free_ratio ? ", state-based" : "");
        CHECK_ROW("METHOD 6", text, E, modulus, (free_ratio ? 0.02 : 0.01) * E);
        snprintf(text, sizeof text, "uniform strain, %s lattice, R = %g dx%s: nu", kind, c->radius, free_ratio ? ", state-based" : "");
        CHECK_ROW("METHOD 6", text, c->nu, nu, (free_ratio ? 0.02 : 0.01) * c->nu);
        CHECK_NEAR(C66 / (C11 - C12) * 2, 1, 1e-5); /* isotropic */
    }
}

static void swelling_is_exact(void) {
    static double force[PATCH_LIMIT][3];
    for (int state = 0; state < 2; state++) {
        lattice_case c = {SHEET_SQUARE, 1.5, state ? 0.2 : 1.0 / 3, "linear", 0.01, 2};
        double grown = 1 + c.alpha * c.theta, worst = 0, P[2];
        patch *p = make(&c, LONG, WIDE, (const double[]){grown, 0, 0, grown});
        CHECK(patch_forces(p, force[0]));
        for (int64_t i = 0; i < 3 * p->d.count; i++) worst = fmax(worst, fabs(force[i / 3][i % 3]));
        patch_free(p);
        CHECK_ROW("METHOD 6", state ? "free swelling, nu = 0.2: largest force over E h dx" : "free swelling: largest force over E h dx", 0,
                  worst / (E * THICKNESS * DX), 1e-10);
        stress(&c, (const double[]){1, 0, 0, 1}, 0, P);
        double expected = -E * c.alpha * c.theta / (1 - c.nu);
        CHECK_ROW("METHOD 6", state ? "clamped swelling, nu = 0.2: stress" : "clamped swelling: stress", expected, P[0] / THICKNESS, fabs(expected) * 1e-10);
    }
}

/* Biaxial: any lattice. Uniaxial: the width is sought that is free of force. */
static void rubber_follows_its_curves(void) {
    const lattice_case c = {SHEET_SQUARE, 1.5, 1.0 / 3, "rubber", 0, 0};
    double mu = 3 * E * THICKNESS / 8, P[2], low = 0.5, high = 1;
    stress(&c, (const double[]){2, 0, 0, 2}, 0, P);
    CHECK_ROW("METHOD 6", "rubber, biaxial stretch 2: P/mu", 1.875, P[0] / mu, 1e-10);
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);
        stress(&c, (const double[]){2, 0, 0, middle}, 1, P);
        *(P[1] < 0 ? &low : &high) = middle;
    }
    stress(&c, (const double[]){2, 0, 0, low}, 0, P);
    CHECK_ROW("METHOD 6", "rubber, uniaxial stretch 2, 8 neighbours: P/mu", 1.76, P[0] / mu, 0.005);
}

/* The weights that METHOD.md §6, 3 gives for R = 3.015. */
static void weights_are_the_smallest_change(void) {
    /* read back through the calibrated sums: Σ W and the neighbours that are left */
    patch *p = patch_create(SHEET_SQUARE, 1, 3.015, 1);
    patch_fill(p, 9, 9);
    patch_set(p, "linear", "E", 1);
    CHECK(patch_start(p, 64, "plain", 1));
    sheet_calibration c = p->engine->calibration(p->state, 0);
    CHECK(c.neighbours == 24);
    CHECK_ROW("METHOD 6", "isotropic weights, R = 3.015: sum over neighbours", 4 * (0.60356 + 0.595 + 0.272 + 2 * 0.276 + 0.126), c.weight_sum, 0.01);
    patch_free(p);
}

/* Why W = 1 at eight neighbours: the paper's weight is anisotropic there. And its own stiffness, for who wants to compare. */
static void the_papers_constants_are_to_be_had(void) {
    const lattice_case c = {SHEET_SQUARE, 1.5, 1.0 / 3, "linear", 0, 0};
    double e = 1e-7, P[3][2];
    weight = 1;
    stress(&c, (const double[]){1 + e, 0, 0, 1}, 0, P[0]);
    stress(&c, (const double[]){1, 0, 0, 1 + e}, 0, P[1]);
    stress(&c, (const double[]){1, e, 0, 1}, 1, P[2]);
    weight = 0;
    CHECK_ROW("METHOD 6", "the paper's weight, R = 1.5: Zener ratio", 0.172, 2 * P[2][0] / (P[0][0] - P[1][0]), 0.001);
    patch *p = patch_create(SHEET_SQUARE, DX, 1.5, THICKNESS);
    patch_fill(p, 9, 9);
    patch_set(p, "linear", "E", E);
    patch_set(p, "linear", "nu", 0.3);
    patch_set(p, "linear", "calibration", 1);
    CHECK(patch_start(p, 64, "plain", 1));
    double R = 1.5 * DX, expected = 18 * E / (3 * (1 - 0.6)) / (3.14159265358979 * R * R * R * R);
    CHECK_ROW("METHOD 6", "calibration = \"paper\": c = 18 K / (pi R^4)", expected, p->engine->calibration(p->state, 0).stiffness, 1e-9 * expected);
    patch_free(p);
}

int main(void) {
    RUN(eight_neighbours_are_isotropic);
    RUN(lattices_have_the_moduli_asked_for);
    RUN(swelling_is_exact);
    RUN(rubber_follows_its_curves);
    RUN(weights_are_the_smallest_change);
    RUN(the_papers_constants_are_to_be_had);
    return check_finish();
}
