/* Damage at one material point and in small bodies (METHOD.md §2; FACTS.md §1), f64.
 *
 * - Uniform D̃ from d(0) = 0: d(t) = D̃/(1 + D̃) (1 − e^{−(1 + D̃) t/η}); explicit Euler converges at first order.
 * - Φ against a direct evaluation in scalar f64: σ⁺ by an independent eigen-solver, R by polar iteration, A σ⁺ A σ⁺ multiplied out.
 * - σ⁺ for repeated and nearly repeated eigenvalues under random rotations, to 1e-12.
 * - σc of the percentage form gives the solid paper's Table 1.
 * - d never decreases, never leaves [0, 1]; compression and inversion do no damage; protected particles stay whole. */
#include "check.h"
#include "verify/matrices.h"
#include "verify/solid_point.h"

enum { SEED = 21, DAMAGE_FIELD = 5, HISTORY_FIELD = 6, KEY_SIGMA_C = 0, KEY_BREAK_STRETCH, KEY_ETA, KEY_ALPHA, KEY_ALPHA2, KEY_AS_SHIPPED = 10 };

static material_point *damage_point(double sigma_c, double eta, double alpha) {
    material_point *p = point_create(1u << EFFECT_elastic | 1u << EFFECT_damage);
    p->values[EFFECT_elastic].value[0][0] = 10;
    p->values[EFFECT_elastic].value[1][0] = 0.3;
    p->values[EFFECT_damage].value[KEY_SIGMA_C][0] = sigma_c;
    p->values[EFFECT_damage].value[KEY_ETA][0] = eta;
    p->values[EFFECT_damage].value[KEY_ALPHA][0] = alpha;
    return p;
}

static void update(material_point *p, double dt) {
    real constants[CONSTANTS];
    tile_work w = point_work(p, &SOLID_EFFECT(damage), EFFECT_damage, constants, dt);
    SOLID_EFFECT(damage).stages->update(&w);
}

static double damage_of(const material_point *p) {
    return p->storage[DAMAGE_FIELD][0];
}

static double history_of(const material_point *p) {
    return p->storage[HISTORY_FIELD][0];
}

static double exponential_error(int steps) {
    double eta = 0.3, end = 0.2, worst = 0;
    material_point *p = damage_point(2, eta, 0);
    const double F[9] = {1.2, 0, 0, 0, 1.05, 0, 0, 0, 1.1};
    point_set(p, FIELD_DEFORMATION, F);
    for (int i = 1; i <= steps; i++) {
        update(p, end / steps);
        double D = history_of(p), t = end * i / steps;
        worst = fmax(worst, fabs(damage_of(p) - D / (1 + D) * (1 - exp(-(1 + D) * t / eta))));
    }
    CHECK(history_of(p) > 0.5);
    free(p);
    return worst;
}

static void uniform_damage_follows_its_exponential(void) {
    double coarse = exponential_error(100), fine = exponential_error(200), finest = exponential_error(400);
    printf("  errors %.2e, %.2e, %.2e: orders %.3f, %.3f\n", coarse, fine, finest, log2(coarse / fine), log2(fine / finest));
    CHECK(coarse < 0.01);
    CHECK_NEAR(log2(coarse / fine), 1, 0.05);
    CHECK_ROW("METHOD 2", "uniform damage against its exponential, explicit: order in the time step", 1, log2(fine / finest), 0.05);
}

/* Φ multiplied out from its definition. */
static double reference_phi(const double F[9], const double a[3], double alpha, double mu, double lambda, double sigma_c) {
    double J = matrix_determinant(F), sigma[9], value[3], vector[3][3], positive[9] = {0}, R[9], A[9], B[9], f[3] = {0};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double b = 0;
            for (int k = 0; k < 3; k++) b += F[3 * i + k] * F[3 * j + k];
            sigma[3 * i + j] = (mu * b + (i == j) * (lambda * (J - 1) - mu) * J) / fmax(J, 1e-3);
        }
    eigen_symmetric(sigma, value, vector);
    for (int e = 0; e < 3; e++)
        for (int c = 0; c < 9; c++) positive[c] += fmax(value[e], 0) * vector[e][c / 3] * vector[e][c % 3];
    polar_rotation(F, R);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) f[i] += R[3 * i + j] * a[j];
    for (int c = 0; c < 9; c++) A[c] = (c % 4 == 0) + alpha * f[c / 3] * f[c % 3];
    multiply(A, positive, B);
    multiply(B, B, B);
    return (B[0] + B[4] + B[8]) / (sigma_c * sigma_c);
}

static void driving_force_is_its_definition(void) {
    double worst = 0, E = 10, nu = 0.3, mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu)) + mu;
    int driven = 0;
    for (uint64_t i = 0; i < 20000; i++) {
        double alpha = -random_unit(5, 0, i), F[9], a[3], length = 0, zero = 0;
        for (int c = 0; c < 9; c++) F[c] = (c % 4 == 0) + 0.5 * random_sign(SEED, (uint64_t)c, i);
        if (matrix_determinant(F) < 0.1) continue;
        for (int c = 0; c < 3; c++) a[c] = random_sign(SEED, 20 + (uint64_t)c, i), length += a[c] * a[c];
        for (int c = 0; c < 3; c++) a[c] /= sqrt(length);
        material_point *p = damage_point(0.7, 0.1, alpha);
        point_set(p, FIELD_DEFORMATION, F);
        point_set(p, p->state.fibre_field, a);
        point_set(p, HISTORY_FIELD, &zero);
        update(p, 1e-9);
        double expected = fmax(reference_phi(F, a, alpha, mu, lambda, 0.7) - 1, 0);
        worst = fmax(worst, fabs(history_of(p) - expected) / (1 + expected));
        driven += expected > 0;
        free(p);
    }
    printf("  worst relative difference %.2e, %d of 20000 driven\n", worst, driven);
    CHECK_ROW("METHOD 2", "driving force against its definition, 19000 random F: worst relative difference", 0, worst, 1e-11);
    CHECK(driven > 5000);
}

/* The engine's Jacobi solver on Q diag(s) Qᵀ: the tensor must come back from values and vectors, which must be orthonormal, and its positive
 * part σ⁺ must be Q diag(⟨s⟩) Qᵀ. */
static void positive_part_with_repeated_values(void) {
    static const double spectra[][3] = {{2, 2, 1}, {1, 1, 1}, {1, 2, 2}, {1, 1 + 1e-9, 1}, {1, 1 + 1e-14, 2}, {0, 0, 5}, {1e-8, 1, 1e8}, {0, 0, 0},
                                        {1, 1, -1}, {-1, 2, -1}, {1, 1 + 1e-9, -2}, {1e-12, -1e-12, 1}, {-3, -3 - 1e-10, -3}, {0, -1e-15, 1e-15}};
    double worst = 0, worst_positive = 0;
    for (size_t k = 0; k < sizeof spectra / sizeof *spectra; k++)
        for (uint64_t i = 0; i < 2000; i++) {
            double M[9], Q[9], a[9] = {0}, positive[9] = {0}, scale = 1e-300;
            for (int c = 0; c < 9; c++) M[c] = random_sign(SEED, 40 + (uint64_t)c, i);
            if (fabs(matrix_determinant(M)) < 0.05) continue;
            polar_rotation(M, Q);
            for (int e = 0; e < 3; e++) {
                scale = fmax(scale, fabs(spectra[k][e]));
                for (int c = 0; c < 9; c++) {
                    double product = Q[3 * (c / 3) + e] * Q[3 * (c % 3) + e];
                    a[c] += spectra[k][e] * product, positive[c] += fmax(spectra[k][e], 0) * product;
                }
            }
            sym3v s = {vec_all(a[0]), vec_all(a[4]), vec_all(a[8]), vec_all(a[1]), vec_all(a[5]), vec_all(a[2])};
            eigen3v e = sym3v_eigen(s);
            const double v[3][3] = {{e.first.x[0], e.first.y[0], e.first.z[0]}, {e.second.x[0], e.second.y[0], e.second.z[0]},
                                    {e.third.x[0], e.third.y[0], e.third.z[0]}}, value[3] = {e.value.x[0], e.value.y[0], e.value.z[0]};
            for (int r = 0; r < 3; r++)
                for (int c = 0; c < 3; c++) {
                    double rebuilt = 0, part = 0, product = 0;
                    for (int n = 0; n < 3; n++) {
                        rebuilt += value[n] * v[n][r] * v[n][c], product += v[r][n] * v[c][n];
                        part += fmax(value[n], 0) * v[n][r] * v[n][c];
                    }
                    worst = fmax(worst, fabs(rebuilt - a[3 * r + c]) / scale);
                    worst = fmax(worst, fabs(product - (r == c)));
                    worst_positive = fmax(worst_positive, fabs(part - positive[3 * r + c]) / scale);
                }
        }
    CHECK_ROW("FACTS 1", "eigenvectors of repeated and nearly repeated values: worst error", 0, worst, 1e-12);
    CHECK_ROW("METHOD 2", "positive part of stress, repeated and nearly repeated values of both signs, random rotations: worst error over the norm",
              0, worst_positive, 1e-12);
}

static void percentages_give_table_1(void) {
    /* E, ν, stretch, σc */
    static const double rows[][4] = {{5e3, .45, .20, 3994.7}, {4e4, .45, .20, 31957.6}, {5e3, .366, .15, 610.17}, {200, .25, .21, 17.779},
                                     {1e5, .4, .20, 35427},   {5e3, .45, .19, 3537.0},  {100, .25, .183, 6.3416}, {7e8, .25, .05, 2.393e6},
                                     {100, .3, .20, 12.673}};
    effect_values all[EFFECT_LIMIT];
    report r;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        memset(all, 0, sizeof all);
        effect_values_default(&SOLID_EFFECT(elastic), &all[EFFECT_elastic]);
        effect_values_default(&SOLID_EFFECT(damage), &all[EFFECT_damage]);
        all[EFFECT_elastic].on = all[EFFECT_damage].on = true;
        all[EFFECT_elastic].value[0][0] = rows[i][0];
        all[EFFECT_elastic].value[1][0] = rows[i][1];
        effect_values *damage = &all[EFFECT_damage];
        damage->value[KEY_BREAK_STRETCH][0] = rows[i][2];
        damage->given[KEY_BREAK_STRETCH] = true;
        CHECK(effect_values_check(&SOLID_EFFECT(damage), damage, all, "test", 1, &r) == STATUS_OK);
        CHECK_ROW("FACTS 1", "critical value from a stretch, a row of the paper's Table 1 (four digits)", rows[i][3], damage->value[KEY_SIGMA_C][0], 2e-4 * rows[i][3]);
        /* and back: the same stretch from σc */
        double sigma_c = damage->value[KEY_SIGMA_C][0];
        damage->given[KEY_BREAK_STRETCH] = false;
        damage->given[KEY_SIGMA_C] = true;
        damage->value[KEY_BREAK_STRETCH][0] = 0;
        damage->value[KEY_SIGMA_C][0] = sigma_c;
        CHECK(effect_values_check(&SOLID_EFFECT(damage), damage, all, "test", 1, &r) == STATUS_OK);
        CHECK_NEAR(damage->value[KEY_BREAK_STRETCH][0], rows[i][2], 1e-9);
    }
}

static void damage_only_grows_and_only_in_tension(void) {
    material_point *p = damage_point(0.2, 0.05, 0);
    double last = 0, harm = 0;
    int wrong = 0;
    for (uint64_t i = 0; i < 5000; i++) {
        double F[9];
        for (int c = 0; c < 9; c++) F[c] = (c % 4 == 0) + 0.8 * random_sign(SEED, (uint64_t)c, i);
        point_set(p, FIELD_DEFORMATION, F);
        p->scratch.laplacian[0] = 40 * random_sign(SEED, 60, i);
        update(p, 0.01 * random_unit(6, 0, i));
        wrong += !(damage_of(p) >= last && damage_of(p) <= 1 && isfinite(history_of(p)));
        last = damage_of(p);
    }
    CHECK_ROW("METHOD 2", "5000 updates by random F and random diffusion: times that d decreased or left [0, 1]", 0, wrong, 0);
    CHECK(last > 0.99);
    free(p);
    static const double harmless[][9] = {{0.7, 0, 0, 0, 0.7, 0, 0, 0, 0.7}, {-1.5, 0, 0, 0, 1.5, 0, 0, 0, 1.5}, {0, 0, 0, 0, 0, 0, 0, 0, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    for (size_t i = 0; i < sizeof harmless / sizeof *harmless; i++) {
        p = damage_point(0.2, 0.05, 0);
        point_set(p, FIELD_DEFORMATION, harmless[i]);
        update(p, 0.01);
        harm += fabs(damage_of(p)) + fabs(history_of(p));
        free(p);
    }
    CHECK_ROW("METHOD 2", "squeezed, inverted, collapsed and undeformed particles: largest d and H", 0, harm, 0);
}

/* as_shipped: once the load is gone nothing drives; otherwise the largest force goes on doing so. */
static void as_shipped_forgets(void) {
    static const double stretched[9] = {1.1, 0, 0, 0, 1.1, 0, 0, 0, 1.1}, whole[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    double after[2];
    for (int shipped = 0; shipped < 2; shipped++) {
        material_point *p = damage_point(0.2, 1, 0);
        p->values[EFFECT_damage].value[KEY_AS_SHIPPED][0] = shipped;
        point_set(p, FIELD_DEFORMATION, stretched);
        update(p, 1e-5);
        double before = damage_of(p);
        CHECK(before > 0 && before < 0.5);
        point_set(p, FIELD_DEFORMATION, whole);
        update(p, 1e-5);
        after[shipped] = damage_of(p) - before;
        free(p);
    }
    CHECK(after[0] > 0 && after[1] == 0);
}

int main(void) {
    RUN(uniform_damage_follows_its_exponential);
    RUN(driving_force_is_its_definition);
    RUN(positive_part_with_repeated_values);
    RUN(percentages_give_table_1);
    RUN(damage_only_grows_and_only_in_tension);
    RUN(as_shipped_forgets);
    return check_finish();
}
