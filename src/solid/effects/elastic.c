/* Elasticity of the matrix, in closed form.
 *
 * Ψμ + Ψλ = μ/2 (|F|² − 3) − μ (J − 1) + λ/2 (J − 1)²  (AnisoMPM §5, METHOD.md §1). The paper writes it with the factors of
 * F = QR; Σ r_ij² = |F|², so no decomposition is needed. Because cof F Fᵀ = J I, the Kirchhoff stress is
 *     τ = P Fᵀ = μ F Fᵀ + (λ (J − 1) − μ) J I.
 * Polynomial: defined for every F, inverted ones included. Damage scales Ψμ always and Ψλ only in tension (J ≥ 1). */
#include "solid/elasticity.h"

enum { MU, LAMBDA };

static void constants(const effect_values *all, const solid_definition *d, bool protects, real out[CONSTANTS]) {
    (void)d, (void)protects;
    double mu = 0, lambda = 0, lame_lambda;
    solid_elastic_moduli(all, &mu, &lambda, &lame_lambda);
    out[MU] = (real)mu;
    out[LAMBDA] = (real)lambda;
}

/* g₊ λ (J − 1) − g μ, what multiplies cof F in P and J I in τ. */
SIMD_INLINE vec cofactor_weight(const tile_work *w, vec J, vec g) {
    return vec_fma(volumetric_degradation(J, g) * w->constants[LAMBDA], J - 1, -(g * w->constants[MU]));
}

static void stress(tile_work *w) {
    const solid_field *F_field = &w->state->fields[FIELD_DEFORMATION];
    real mu = w->constants[MU];
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            mat3v F = mat3v_load(F_field, w->tile->first_pack + k, part);
            vec g = vec_load(scratch_at(w->scratch->degradation, 1, k, 0, part));
            vec J = mat3v_determinant(F);
            sym3v b = mat3v_gram(F);
            vec g_mu = stiffened(w, k, part, g * mu), pressure = J * stiffened(w, k, part, cofactor_weight(w, J, g));
            real *tau = w->scratch->kirchhoff;
            vec_store(scratch_at(tau, 6, k, 0, part), vec_fma(g_mu, b.xx, pressure));
            vec_store(scratch_at(tau, 6, k, 1, part), vec_fma(g_mu, b.yy, pressure));
            vec_store(scratch_at(tau, 6, k, 2, part), vec_fma(g_mu, b.zz, pressure));
            vec_store(scratch_at(tau, 6, k, 3, part), g_mu * b.xy);
            vec_store(scratch_at(tau, 6, k, 4, part), g_mu * b.yz);
            vec_store(scratch_at(tau, 6, k, 5, part), g_mu * b.xz);
        }
}

/* P = g μ F + (g₊ λ (J − 1) − g μ) cof F: the same coefficients as τ's, without Fᵀ. */
static void piola(tile_work *w) {
    const solid_field *F_field = &w->state->fields[FIELD_DEFORMATION];
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            mat3v F = mat3v_load(F_field, w->tile->first_pack + k, part);
            vec g = vec_load(scratch_at(w->scratch->degradation, 1, k, 0, part)), J = mat3v_determinant(F), g_mu = g * w->constants[MU];
            mat3v_add_to(w->piola, k, part, g_mu, F, cofactor_weight(w, J, g), mat3v_cofactor(F));
        }
}

/* Of μ/2 |F|² it is μ; of λ/2 (J − 1)² it is λ |cof F|² and what J's own curvature makes of λ (J − 1) − μ. */
static void stiffness(tile_work *w) {
    const solid_field *F_field = &w->state->fields[FIELD_DEFORMATION];
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            mat3v F = mat3v_load(F_field, w->tile->first_pack + k, part);
            vec g = vec_load(scratch_at(w->scratch->degradation, 1, k, 0, part)), J = mat3v_determinant(F);
            vec bulk = volumetric_degradation(J, g) * w->constants[LAMBDA] * mat3v_square_sum(mat3v_cofactor(F));
            vec curved = vec_abs(cofactor_weight(w, J, g)) * mat3v_cofactor_slope(F);
            real *modulus = scratch_at(w->scratch->wave_modulus, 1, k, 0, part);
            vec_store(modulus, vec_load(modulus) + g * w->constants[MU] + bulk + curved);
        }
}

/* Acoustic tensor of this energy in space (METHOD.md §3): of a wave along n, polarised along a, g μ n·b n + g₊ λ J² (a·n)². */
static void wave(tile_work *w) {
    const solid_field *F_field = &w->state->fields[FIELD_DEFORMATION];
    real mu = w->constants[MU], lambda = w->constants[LAMBDA];
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            mat3v F = mat3v_load(F_field, w->tile->first_pack + k, part);
            vec g = vec_load(scratch_at(w->scratch->degradation, 1, k, 0, part));
            vec J = mat3v_determinant(F);
            vec bulk = volumetric_degradation(J, g) * lambda * J * J;
            real *modulus = scratch_at(w->scratch->wave_modulus, 1, k, 0, part);
            vec_store(modulus, vec_load(modulus) + stiffened(w, k, part, bulk));
            sym3v_add_to(w->scratch->wave_tensor, k, part, stiffened(w, k, part, g * mu), mat3v_gram(F));
        }
}

static double shear_energy(const double F[9], double J) {
    double square = 0;
    for (int c = 0; c < 9; c++) square += F[c] * F[c];
    return 0.5 * (square - 3) - (J - 1);
}

static void energy(tile_work *w) {
    elastic_energy(w, w->constants[MU], w->constants[LAMBDA], shear_energy);
}

static const char *const lame_choices[] = {"consistent", "paper", NULL};

static const parameter parameters[] = {
    ELASTIC_PARAMETERS,
    [ELASTIC_KEY_LAME] = {.key = "lame", .unit = "1", .doc = "consistent: (E, nu) is the linear response; paper: plain Lamé lambda",
                  .kind = PARAMETER_CHOICE, .maximum = 1, .choices = lame_choices, .live = true},
};

static const solid_stages stages = {.constants = constants, .stress = stress, .wave = wave, .energy = energy, .piola = piola, .stiffness = stiffness};

const effect SOLID_EFFECT(elastic) = {
    .name = "elastic", .engine = ENGINE_SOLID, .scope = SCOPE_MATERIAL, .doc = "isotropic elasticity of the matrix",
    .reference = "AnisoMPM section 5; METHOD.md section 1", .parameters = parameters, .parameter_count = 3,
    ELASTIC_TABLES, .stages = &stages,
};
