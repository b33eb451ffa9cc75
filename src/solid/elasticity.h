/* What the elastic models share (METHOD.md §1): parameters, the split of damage, Ψλ, and E where it varies in place. */
#ifndef SUNDER_SOLID_ELASTICITY_H
#define SUNDER_SOLID_ELASTICITY_H

#include "base/eigen.h"
#include "solid/moduli.h"
#include "solid/tensor.h"

#define ELASTIC_PARAMETERS                                                                                                             \
    [ELASTIC_KEY_E] = {.key = "E", .unit = "mass/(length time^2)", .doc = "Young's modulus of the matrix", .scale = "stiffness_scale", \
                       .minimum = 1e-12, .maximum = 1e18, .fallback = {1e4}, .live = true, .logarithmic = true, .required = true},     \
    [ELASTIC_KEY_NU] = {.key = "nu", .unit = "1", .doc = "Poisson's ratio", .minimum = -0.999, .maximum = 0.4999, .fallback = {0.3}, .live = true}

static const effect_field elastic_fields[] = {
    {.key = "stiffness_scale", .components = 1, .unit = "1", .written = true, .doc = "E over its material's, where it varies"},
};

static const effect_measure elastic_measures[] = {
    {"elastic", "mass length^2/time^2", "stored energy of the matrix"},
};

#define ELASTIC_TABLES .fields = elastic_fields, .field_count = 1, .measures = elastic_measures, .measure_count = 1, .provides = ELASTICITY

/* What scales λ: g in tension (J ≥ 1), 1 in compression. */
SIMD_INLINE vec volumetric_degradation(vec J, vec g) {
    return vec_select(J >= 1, g, vec_all(1));
}

SIMD_INLINE vec degraded_lambda(vec J, vec g, real lambda) {
    return lambda * volumetric_degradation(J, g);
}

/* A modulus of pack k of the tile, times its particles' E over the material's. */
SIMD_INLINE vec stiffened(const tile_work *w, int k, int part, vec value) {
    return scaled(w->state, w->state->stiffness_scale, w->tile->first_pack + k, part, value);
}

/* Adds V (g μ shear(F, J) + g₊ λ/2 (J − 1)²) of each particle to the energy; shear is Ψμ/μ. In f64 particle by particle: what is near 0 at
 * rest is a difference of what is not. */
static inline void elastic_energy(tile_work *w, real mu, real lambda, double (*shear)(const double F[9], double J)) {
    const solid_field *F_field = &w->state->fields[FIELD_DEFORMATION];
    for (int p = 0; p < w->tile->count; p++) {
        int k = p / PACK, lane = p % PACK;
        double F[9];
        for (int c = 0; c < 9; c++) F[c] = (double)field_at(F_field, w->tile->first_pack + k, c, 0)[lane];
        double J = matrix_determinant(F);
        double g = (double)w->scratch->degradation[k * PACK + lane], g_volume = J >= 1 ? g : 1;
        double density = g * (double)mu * shear(F, J) + g_volume * 0.5 * (double)lambda * (J - 1) * (J - 1);
        density *= scale_of(w->state, w->state->stiffness_scale, w->tile->first_pack + k, lane);
        w->energy[0] += density * (double)field_at(&w->state->fields[FIELD_VOLUME], w->tile->first_pack + k, 0, 0)[lane];
    }
}

#endif
