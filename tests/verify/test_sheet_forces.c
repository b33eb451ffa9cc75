/* Forces between the particles of a sheet: objective, balanced, and the gradient of the energy that is reported (METHOD.md §6, "Checks").
 *
 * A hexagonal and a square patch with random places (3 % of a spacing, out of the plane too), random θ, grain, swelling and softening; each law, and
 * the state-based form. */
#include "check.h"
#include "verify/sheet_patch.h"

enum { NX = 9, NY = 7, COUNT = NX * NY };

typedef struct force_case {
    const char *name, *law;
    sheet_lattice lattice;
    double radius, nu;
} force_case;

static const force_case cases[] = {
    {"linear, 8 neighbours", "linear", SHEET_SQUARE, 1.5, 1.0 / 3},
    {"linear, hexagonal, state-based", "linear", SHEET_HEXAGONAL, 2.1, 0.1},
    {"rubber", "rubber", SHEET_SQUARE, 3.015, 1.0 / 3},
    {"elastoplastic, state-based", "elastoplastic", SHEET_SQUARE, 1.5, 0.42},
};
enum { CASES = sizeof cases / sizeof *cases };

static patch *random_patch(const force_case *c) {
    patch *p = patch_create(c->lattice, 0.1, c->radius, 0.02);
    patch_fill(p, NX, NY);
    patch_set(p, c->law, "E", 2e3);
    patch_set(p, c->law, "nu", c->nu);
    if (strcmp(c->law, "rubber") == 0) patch_set(p, "rubber", "c_star", -2e2), patch_set(p, "rubber", "n", 1.7);
    if (strcmp(c->law, "elastoplastic") == 0) patch_set(p, c->law, "eta0", 0.02), patch_set(p, c->law, "beta", 0.3);
    patch_set(p, "diffusion", "k", 0.01);
    patch_set(p, "swelling", "alpha", 0.02);
    patch_set(p, "softening", "stiffness", 0.3);
    patch_set(p, "grain", "stiffness", 1.8);
    patch_set(p, "bending", "stiffness", 1e-3);
    for (int i = 0; i < COUNT; i++) {
        for (int k = 0; k < 3; k++) p->position[i][k] += 0.003 * patch_random((uint64_t)(3 * i + k));
        p->diffused[i] = 0.5 + 0.5 * patch_random((uint64_t)(1000 + i));
    }
    return p;
}

static void rotate(const double R[9], const double x[3], double y[3]) {
    for (int i = 0; i < 3; i++) y[i] = R[3 * i] * x[0] + R[3 * i + 1] * x[1] + R[3 * i + 2] * x[2];
}

/* Rz(0.7) Rx(1.1) */
static void rotation(double R[9]) {
    double a = cos(0.7), b = sin(0.7), c = cos(1.1), d = sin(1.1);
    const double all[9] = {a, -b * c, b * d, b, a * c, -a * d, 0, d, c};
    memcpy(R, all, sizeof all);
}

static double largest(double (*force)[3]) {
    double most = 0;
    for (int i = 0; i < COUNT; i++)
        for (int k = 0; k < 3; k++) most = fmax(most, fabs(force[i][k]));
    return most;
}

static void rotated_places_give_rotated_forces(void) {
    static double before[COUNT][3], after[COUNT][3];
    double R[9];
    rotation(R);
    for (int c = 0; c < CASES; c++) {
        patch *p = random_patch(&cases[c]);
        bool good = patch_forces(p, before[0]);
        double worst = 0, scale = largest(before);
        for (int i = 0; i < COUNT; i++) {
            double x[3];
            memcpy(x, p->position[i], sizeof x);
            rotate(R, x, p->position[i]);
        }
        good = good && patch_forces(p, after[0]);
        CHECK(good && scale > 0.01);
        for (int i = 0; i < COUNT; i++) {
            double turned[3];
            rotate(R, before[i], turned);
            for (int k = 0; k < 3; k++) worst = fmax(worst, fabs(turned[k] - after[i][k]));
        }
        char text[160];
        snprintf(text, sizeof text, "%s: a rotated sheet's forces less the rotated forces, over the largest", cases[c].name);
        CHECK_ROW("METHOD 6", text, 0, worst / scale, 1e-12);
        patch_free(p);
    }
}

static void a_rigid_rotation_gives_no_force(void) {
    static double force[COUNT][3];
    double R[9];
    rotation(R);
    patch *p = patch_create(SHEET_SQUARE, 0.1, 1.5, 0.02);
    patch_fill(p, NX, NY);
    patch_set(p, "linear", "E", 1);
    for (int i = 0; i < COUNT; i++) rotate(R, p->rest[i], p->position[i]);
    CHECK(patch_forces(p, force[0]));
    CHECK_ROW("METHOD 6", "rigid rotation: largest force over E h dx", 0, largest(force) / (0.02 * 0.1), 1e-13);
    patch_free(p);
}

static void forces_and_moments_cancel(void) {
    static double force[COUNT][3];
    for (int c = 0; c < CASES; c++) {
        patch *p = random_patch(&cases[c]);
        CHECK(patch_forces(p, force[0]));
        double sum[3] = {0}, moment[3] = {0}, scale = largest(force);
        for (int i = 0; i < COUNT; i++) {
            const double *x = p->position[i], *f = force[i];
            for (int k = 0; k < 3; k++) {
                sum[k] += f[k];
                moment[k] += x[(k + 1) % 3] * f[(k + 2) % 3] - x[(k + 2) % 3] * f[(k + 1) % 3];
            }
        }
        for (int k = 0; k < 3; k++) {
            CHECK_NEAR(sum[k] / scale, 0, 1e-11);
            CHECK_NEAR(moment[k] / scale, 0, 1e-11);
        }
        patch_free(p);
    }
}

static double energy_of(patch *p) {
    CHECK(patch_start(p, 64, "auto", 1));
    double energy = patch_measure(p).elastic;
    patch_stop(p);
    return energy;
}

/* Central differences at a few particles, edges among them. The elastoplastic law stores what unloading gives back: its gradient is the force only
 * while no bond has yielded. */
static void forces_are_the_gradient_of_the_energy(void) {
    static double force[COUNT][3];
    static const int particles[] = {0, 4, 31, 33, COUNT - 1};
    for (int c = 0; c < CASES; c++) {
        patch *p = random_patch(&cases[c]);
        if (strcmp(cases[c].law, "elastoplastic") == 0) patch_set(p, "elastoplastic", "eta0", 1);
        CHECK(patch_forces(p, force[0]));
        double worst = 0, h = 1e-6;
        for (int n = 0; n < 5; n++)
            for (int k = 0; k < 3; k++) {
                double *x = &p->position[particles[n]][k], kept = *x, up, down;
                *x = kept + h, up = energy_of(p);
                *x = kept - h, down = energy_of(p);
                *x = kept;
                worst = fmax(worst, fabs(-(up - down) / (2 * h) - force[particles[n]][k]));
            }
        char text[160];
        snprintf(text, sizeof text, "%s: force against differences of the stored energy, over the largest force", cases[c].name);
        CHECK_ROW("METHOD 6", text, 0, worst / largest(force), 2e-7);
        patch_free(p);
    }
}

/* Every precision and instruction set against plain f64. */
static void variants_agree(void) {
    static const char *const sets[] = {"plain", "avx2", "avx512"};
    static double reference[COUNT][3], velocity[COUNT][3];
    for (int c = 0; c < CASES; c++)
        for (int precision = 64; precision >= 32; precision -= 32)
            for (int k = 0; k < 3; k++) {
                if (!sheet_engine_find(precision, sets[k])) continue;
                patch *p = random_patch(&cases[c]);
                patch_set(p, "fracture", "stretch", 0.045);
                if (strcmp(cases[c].law, "elastoplastic") == 0) patch_set(p, "elastoplastic", "beta", 0.3);
                CHECK(patch_start(p, precision, sets[k], 1));
                double dt = 0.1 * patch_limit(p), scale = 0, worst = 0;
                CHECK(patch_steps(p, 20, dt) == STATUS_OK);
                p->engine->read(p->state, "velocity", velocity[0]);
                bool first = precision == 64 && k == 0;
                if (first) memcpy(reference, velocity, sizeof reference);
                for (int i = 0; i < 3 * COUNT; i++) {
                    scale = fmax(scale, fabs(reference[i / 3][i % 3]));
                    worst = fmax(worst, fabs(reference[i / 3][i % 3] - velocity[i / 3][i % 3]));
                }
                CHECK(first || worst > 0 || precision == 64);
                CHECK_NEAR(worst / scale, 0, precision == 64 ? 1e-11 : 3e-4);
                CHECK(patch_measure(p).bonds_broken > 0);
                patch_free(p);
            }
}

int main(void) {
    RUN(rotated_places_give_rotated_forces);
    RUN(a_rigid_rotation_gives_no_force);
    RUN(forces_and_moments_cancel);
    RUN(forces_are_the_gradient_of_the_energy);
    RUN(variants_agree);
    return check_finish();
}
