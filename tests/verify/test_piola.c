/* The first Piola–Kirchhoff stress of elements, and the bound of their stiffness, at one point (METHOD.md §1), f64.
 *
 * - P Fᵀ is the τ of the particle engine, for every F, inverted ones included; elastic and corotated, with two fibre families.
 * - The bound of ∂²Ψ/∂F² holds along random directions, and is not far off.
 * - Where F is singular, and no τ has a P, it still is the gradient of the energy; in a collapsed state fibres push out along themselves. */
#include "check.h"
#include "verify/matrices.h"
#include "verify/solid_point.h"

enum { SEED = 77 };

static material_point *point_of(bool corotated) {
    material_point *p = point_create(1u << (corotated ? EFFECT_corotated : EFFECT_elastic) | 1u << EFFECT_fibres);
    effect_values *e = &p->values[corotated ? EFFECT_corotated : EFFECT_elastic];
    e->on = true, e->value[0][0] = 10, e->value[1][0] = 0.3;
    p->values[EFFECT_elastic].value[0][0] = p->values[EFFECT_corotated].value[0][0] = 10;
    p->values[EFFECT_fibres].value[0][0] = 4, p->values[EFFECT_fibres].value[1][0] = 2;
    return p;
}

/* P and the bound of the stiffness of what is on. */
static double point_piola(material_point *p, const double F[9], double P[9]) {
    static real piola[9 * TILE_PARTICLES];
    real constants[CONSTANTS];
    memset(piola, 0, sizeof piola);
    memset(p->scratch.wave_modulus, 0, sizeof p->scratch.wave_modulus);
    point_set(p, FIELD_DEFORMATION, F);
    point_degrade(p);
    for (int e = 0; e < SOLID_EFFECTS; e++) {
        if (!p->values[e].on || !point_effects[e]->stages->piola) continue;
        tile_work w = point_work(p, point_effects[e], e, constants, 0);
        w.piola = piola;
        point_effects[e]->stages->piola(&w);
        point_effects[e]->stages->stiffness(&w);
    }
    for (int c = 0; c < 9; c++) P[c] = piola[c * PACK];
    return p->scratch.wave_modulus[0];
}

static double energy_at(material_point *p, const double F[9], double step, const double D[9]) {
    double G[9];
    for (int c = 0; c < 9; c++) G[c] = F[c] + step * D[c];
    point_set(p, FIELD_DEFORMATION, G);
    return point_energy(p);
}

static void piola_is_tau_without_the_inverse(void) {
    for (int corotated = 0; corotated < 2; corotated++) {
        material_point *p = point_of(corotated);
        double worst = 0, curvature = 0, h = 1e-4;
        int inverted = 0;
        for (uint64_t i = 0; i < 20000; i++) {
            double F[9], P[9], tau[6], D[9], length = 0, size = 1;
            for (int c = 0; c < 9; c++) F[c] = (c % 4 == 0) + (i % 2 ? 1.5 : 0.4) * random_sign(SEED, (uint64_t)c, i);
            double bound = point_piola(p, F, P);
            point_stress(p, tau);
            static const int place[9] = {0, 3, 5, 3, 1, 4, 5, 4, 2};
            for (int c = 0; c < 6; c++) size = fmax(size, fabs(tau[c]));
            for (int c = 0; c < 9; c++) {
                double product = P[c - c % 3] * F[c % 3 * 3] + P[c - c % 3 + 1] * F[c % 3 * 3 + 1] + P[c - c % 3 + 2] * F[c % 3 * 3 + 2];
                worst = fmax(worst, fabs(product - tau[place[c]]) / size);
            }
            inverted += matrix_determinant(F) < 0;
            if (corotated && matrix_determinant(F) < 0.05) continue; /* kinks, where the smallest stretch changes sides */
            for (int c = 0; c < 9; c++) D[c] = random_sign(SEED, 20 + (uint64_t)c, i), length += D[c] * D[c];
            for (int c = 0; c < 9; c++) D[c] /= sqrt(length);
            double second = (energy_at(p, F, h, D) - 2 * energy_at(p, F, 0, D) + energy_at(p, F, -h, D)) / (h * h);
            curvature = fmax(curvature, second / bound);
        }
        printf("  %s: P F^T off tau by %.1e, curvature over bound %.3f, %d inverted\n", corotated ? "corotated" : "elastic", worst, curvature, inverted);
        CHECK_ROW("METHOD 1", corotated ? "P of an element times F^T against tau, corotated and fibres: worst difference" : "P of an element times F^T against tau, elastic and fibres: worst difference", 0, worst, 1e-11);
        CHECK(inverted > 3000 && curvature < 1 && curvature > 0.5);
        free(p);
    }
}

/* Where F is singular P is still the gradient of the energy (no τ knows it): along directions that do not meet a kink. */
static void singular_states_have_forces(void) {
    for (int corotated = 0; corotated < 2; corotated++) {
        material_point *p = point_of(corotated);
        double P[9], worst = 0;
        static const double flat[9] = {1.1, 0.2, 0, 0.1, 0.9, 0, 0, 0, 0}, nothing[9] = {0};
        point_piola(p, flat, P);
        static const double aside[9] = {0.3, -0.2, 0, 0.5, 0.1, 0, 0, 0, 0};
        double slope = (energy_at(p, flat, 1e-6, aside) - energy_at(p, flat, -1e-6, aside)) / 2e-6, product = 0;
        for (int c = 0; c < 9; c++) product += P[c] * aside[c];
        worst = fabs(slope - product);
        CHECK(worst < 1e-7);
        point_piola(p, nothing, P); /* collapsed: both fibres push out along themselves, with k = γ μ each */
        double mu = 10 / 2.6;
        if (!corotated) {
            const double pushed[3] = {-4 * mu, -2 * mu, 0};
            for (int c = 0; c < 3; c++) CHECK_NEAR(P[4 * c], pushed[c], 1e-9);
        }
        for (int c = 0; c < 9; c++) CHECK(isfinite(P[c]));
        free(p);
    }
}

int main(void) {
    RUN(piola_is_tau_without_the_inverse);
    RUN(singular_states_have_forces);
    return check_finish();
}
