/* Fibres: one or two families that stiffen the matrix along their directions.
 *
 * Ψf = Σ_k k_k/2 (ℓ_k − 1)², ℓ_k = |F a_k|, k_k = γ_k μ  (AnisoMPM §5, METHOD.md §1). τ = Σ k_k (1 − 1/ℓ_k) (F a_k)(F a_k)ᵀ.
 * Never degraded by the matrix' damage: fibres part, they do not tear; what breaks them is snapping.c. */
#include "solid/moduli.h"
#include "solid/tensor.h"

enum { K1, K2 };
enum { KEY_GAMMA, KEY_GAMMA2 };
#define LENGTH_TINY ((real)1e-12)

static void constants(const effect_values *all, const solid_definition *d, bool protects, real out[CONSTANTS]) {
    (void)d, (void)protects;
    double mu = 0, lambda, lame_lambda;
    solid_elastic_moduli(all, &mu, &lambda, &lame_lambda);
    out[K1] = (real)(mu * all[EFFECT_fibres].value[KEY_GAMMA][0]);
    out[K2] = (real)(mu * all[EFFECT_fibres].value[KEY_GAMMA2][0]);
}

/* γ's own scale, and that of μ; and (1 − d_f)² where fibres of the first family snap. */
SIMD_INLINE vec stiffened(const tile_work *w, int field, int32_t pack, int part, vec value) {
    const solid *s = w->state;
    vec whole = scaled(s, s->gamma_scale, pack, part, scaled(s, s->stiffness_scale, pack, part, value));
    if (s->snapped_field <= 0 || field != s->fibre_field) return whole;
    vec left = 1 - vec_load(field_at(&s->fields[s->snapped_field], pack, 0, part));
    return whole * left * left;
}

/* Adds one family's Kirchhoff stress. As ℓ → 0 the direction F a is lost and with it the (finite) force: the limit
 * (1 − 1/ℓ)(F a)(F a)ᵀ → 0 is what stands. */
static void add_family(tile_work *w, int field, real stiffness) {
    if (field < 0 || stiffness == 0) return;
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            int32_t pack = w->tile->first_pack + k;
            vec3v f = mat3v_times(mat3v_load(&w->state->fields[FIELD_DEFORMATION], pack, part),
                                  vec3v_load(&w->state->fields[field], pack, part));
            vec length = vec_max(vec_sqrt(vec3v_dot(f, f)), vec_all(LENGTH_TINY));
            vec factor = stiffened(w, field, pack, part, stiffness * (1 - 1 / length));
            vec3v g = {factor * f.x, factor * f.y, factor * f.z};
            vec products[6] = {g.x * f.x, g.y * f.y, g.z * f.z, g.x * f.y, g.y * f.z, g.x * f.z};
            for (int c = 0; c < 6; c++) {
                real *tau = scratch_at(w->scratch->kirchhoff, 6, k, c, part);
                vec_store(tau, vec_load(tau) + products[c]);
            }
        }
}

static void stress(tile_work *w) {
    add_family(w, w->state->fibre_field, w->constants[K1]);
    add_family(w, w->state->fibre2_field, w->constants[K2]);
}

/* P = k (ℓ − 1) f/ℓ aᵀ, f = F a. Where ℓ = 0 the force is there, k, and only its direction is lost: the fibre's own at rest
 * stands in for it, so that a collapsed element opens again (METHOD.md §1). */
static void add_family_piola(tile_work *w, int field, real stiffness) {
    if (field < 0 || stiffness == 0) return;
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            int32_t pack = w->tile->first_pack + k;
            vec3v a = vec3v_load(&w->state->fields[field], pack, part);
            vec3v f = mat3v_times(mat3v_load(&w->state->fields[FIELD_DEFORMATION], pack, part), a);
            vec length = vec_sqrt(vec3v_dot(f, f)), inverse = 1 / vec_max(length, vec_all(LENGTH_TINY)), force = stiffness * (length - 1);
            vec_mask lost = length < LENGTH_TINY;
            vec direction[3] = {vec_select(lost, a.x, f.x * inverse), vec_select(lost, a.y, f.y * inverse), vec_select(lost, a.z, f.z * inverse)};
            const vec rest[3] = {a.x, a.y, a.z};
            for (int c = 0; c < 9; c++) {
                real *P = scratch_at(w->piola, 9, k, c, part);
                vec_store(P, vec_fma(force * direction[c / 3], rest[c % 3], vec_load(P)));
            }
        }
}

static void piola(tile_work *w) {
    add_family_piola(w, w->state->fibre_field, w->constants[K1]);
    add_family_piola(w, w->state->fibre2_field, w->constants[K2]);
}

/* Along the fibre k, across it k (1 − 1/ℓ) < k. */
static void stiffness(tile_work *w) {
    vec both = vec_all((w->state->fibre_field >= 0 ? w->constants[K1] : 0) + (w->state->fibre2_field >= 0 ? w->constants[K2] : 0));
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            real *modulus = scratch_at(w->scratch->wave_modulus, 1, k, 0, part);
            vec_store(modulus, vec_load(modulus) + both);
        }
}

/* A wave along n stretches the fibres by (f·n) at most, f = F a: ρ0 c² grows by k (f·n)². */
static void add_wave(tile_work *w, int field, real stiffness) {
    if (field < 0 || stiffness == 0) return;
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            int32_t pack = w->tile->first_pack + k;
            vec3v f = mat3v_times(mat3v_load(&w->state->fields[FIELD_DEFORMATION], pack, part),
                                  vec3v_load(&w->state->fields[field], pack, part));
            sym3v square = {f.x * f.x, f.y * f.y, f.z * f.z, f.x * f.y, f.y * f.z, f.x * f.z};
            sym3v_add_to(w->scratch->wave_tensor, k, part, stiffened(w, field, pack, part, vec_all(stiffness)), square);
        }
}

static void wave(tile_work *w) {
    add_wave(w, w->state->fibre_field, w->constants[K1]);
    add_wave(w, w->state->fibre2_field, w->constants[K2]);
}

static void add_energy(tile_work *w, int field, double stiffness) {
    if (field < 0 || stiffness == 0) return;
    for (int p = 0; p < w->tile->count; p++) {
        int32_t pack = w->tile->first_pack + p / PACK;
        int lane = p % PACK;
        double f[3] = {0, 0, 0};
        for (int row = 0; row < 3; row++)
            for (int c = 0; c < 3; c++)
                f[row] += (double)field_at(&w->state->fields[FIELD_DEFORMATION], pack, row * 3 + c, 0)[lane] *
                          (double)field_at(&w->state->fields[field], pack, c, 0)[lane];
        double stretch = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]) - 1;
        double here = stiffness * scale_of(w->state, w->state->stiffness_scale, pack, lane) * scale_of(w->state, w->state->gamma_scale, pack, lane);
        if (w->state->snapped_field > 0 && field == w->state->fibre_field) {
            double left = 1 - (double)field_at(&w->state->fields[w->state->snapped_field], pack, 0, 0)[lane];
            here *= left * left;
        }
        w->energy[1] += 0.5 * here * stretch * stretch *
                        (double)field_at(&w->state->fields[FIELD_VOLUME], pack, 0, 0)[lane];
    }
}

static void energy(tile_work *w) {
    add_energy(w, w->state->fibre_field, (double)w->constants[K1]);
    add_energy(w, w->state->fibre2_field, (double)w->constants[K2]);
}

static const parameter parameters[] = {
    [KEY_GAMMA] = {.key = "gamma", .unit = "1", .doc = "stiffness of the first fibre family over the matrix' shear modulus",
                   .maximum = 1e6, .fallback = {10}, .live = true, .logarithmic = true, .scale = "gamma_scale"},
    [KEY_GAMMA2] = {.key = "gamma2", .unit = "1", .doc = "the same for the second family", .maximum = 1e6, .live = true,
                    .logarithmic = true},
};

static const effect_field fields[] = {
    {.key = "fibre", .components = 3, .unit = "1", .written = true, .doc = "first fibre direction at rest, unit"},
    {.key = "fibre2", .components = 3, .unit = "1", .written = true, .doc = "second fibre direction at rest, unit"},
    {.key = "gamma_scale", .components = 1, .unit = "1", .written = true,
     .doc = "gamma, and gamma2, over their material's, where gamma varies"},
};

static const effect_measure measures[] = {
    {"fibre", "mass length^2/time^2", "stored energy of the fibres"},
};

static const solid_stages stages = {.constants = constants, .stress = stress, .wave = wave, .energy = energy, .piola = piola, .stiffness = stiffness};

const effect SOLID_EFFECT(fibres) = {
    .name = "fibres", .engine = ENGINE_SOLID, .scope = SCOPE_MATERIAL, .doc = "stiffness along fibre directions",
    .reference = "AnisoMPM section 5; METHOD.md section 1", .parameters = parameters, .parameter_count = 2,
    .fields = fields, .field_count = 3, .measures = measures, .measure_count = 1, .needs = ELASTICITY, .stages = &stages,
};
