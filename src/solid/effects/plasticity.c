/* Plasticity of the matrix: von Mises return mapping of F on logarithmic (Hencky) strain (METHOD.md §3; AnisoMPM Fig. 14).
 *
 * With F = U Σ Vᵀ and ε = log Σ, a particle yields where 2μ |dev ε| > τy + h p (Frobenius norm; μ undegraded, p the plastic
 * strain so far); its deviator is then scaled back so that equality holds, p grows by what the deviator lost, and
 * F ← U exp(ε) Vᵀ. That runs after F has advanced and before damage looks at it. F is from then on the elastic part of the
 * deformation; the rest is in the particles' positions.
 *
 * It is done as F ← F + Σ (exp(Δε_i) − 1) n_i (Fᵀ n_i)ᵀ, with the axes n_i of b = F Fᵀ: V is not needed, det F is unchanged because
 * Σ Δε_i = 0, and rounding is in proportion to the return, not to F. The same formula stands where F is not
 * an ordinary stretch:
 *   inverted   ε is of the singular values' magnitudes; the sign of det F stays, as its value does;
 *   collapsed  a singular value counts as 1e-4 at least (so ε is finite) but is scaled as it is: F stays finite, det F unchanged,
 *              and the surface is reached only once no value is that small. */
#include "base/simd_math.h"
#include "solid/moduli.h"
#include "solid/stretch.h"

enum { YIELD, HARDENING }; /* τy/2μ and h/2μ: strains */
enum { KEY_YIELD_STRESS, KEY_HARDENING };

#define STRETCH_LEAST 1e-4
#define BOUND_MARGIN ((real)0.998) /* the early out's bound holds up to round-off; of a square */

static void constants(const effect_values *all, const solid_definition *d, bool protects, real out[CONSTANTS]) {
    (void)d, (void)protects;
    const effect_values *own = &all[EFFECT_plastic];
    double mu = 1, lambda, lame_lambda;
    solid_elastic_moduli(all, &mu, &lambda, &lame_lambda);
    out[YIELD] = (real)(own->value[KEY_YIELD_STRESS][0] / (2 * mu));
    out[HARDENING] = (real)(own->value[KEY_HARDENING][0] / (2 * mu));
}

/* The engine keeps no index of this field; finding it by name once a tile is nothing beside the tile's particles. */
static const solid_field *plastic_strain(const solid *s) {
    int i = FIELD_BUILT_IN;
    while (strcmp(s->fields[i].name, "plastic_strain") != 0) i++;
    return &s->fields[i];
}

/* False only where |dev ε| ≤ limit for certain. With β = tr b/3 and e = b/β − I (traceless: its eigenvalues y_i ≤ a |e|, a = √⅔)
 *     |dev ε| ≤ |ε − ½ log β I| = ½ |log(1 + y)| ≤ ½ |e|/(1 − a |e|),
 * because |log(1 + y)| ≤ |y|/(1 − |y|). That is ≤ limit where |e| (½ + a limit) ≤ limit. Clamping only brings ε closer together. */
SIMD_INLINE vec_mask may_yield(sym3v b, vec limit) {
    vec mean = (real)(1.0 / 3) * (b.xx + b.yy + b.zz);
    sym3v deviator = {b.xx - mean, b.yy - mean, b.zz - mean, b.xy, b.yz, b.xz};
    vec reach = limit * mean, slope = vec_fma(limit, vec_all((real)0.81649658092772603), vec_all((real)0.5));
    return sym3v_square_sum(deviator) * slope * slope > BOUND_MARGIN * reach * reach;
}

/* F += factor n pᵀ */
SIMD_INLINE void add_dyad(mat3v *F, vec factor, vec3v n, vec3v p) {
    vec3v m = {factor * n.x, factor * n.y, factor * n.z};
    F->xx = vec_fma(m.x, p.x, F->xx), F->xy = vec_fma(m.x, p.y, F->xy), F->xz = vec_fma(m.x, p.z, F->xz);
    F->yx = vec_fma(m.y, p.x, F->yx), F->yy = vec_fma(m.y, p.y, F->yy), F->yz = vec_fma(m.y, p.z, F->yz);
    F->zx = vec_fma(m.z, p.x, F->zx), F->zy = vec_fma(m.z, p.y, F->zy), F->zz = vec_fma(m.z, p.z, F->zz);
}

/* Brings F back to the surface; the increase of plastic strain is returned. Lanes that do not yield keep F's bits, and give 0. */
SIMD_INLINE vec return_to_surface(mat3v *F, const stretch3v *s, vec limit, vec hardening) {
    vec half = vec_all((real)0.5), least = vec_all((real)(STRETCH_LEAST * STRETCH_LEAST));
    vec3v strain = {half * vec_log(vec_max(s->square.x, least)), half * vec_log(vec_max(s->square.y, least)),
                    half * vec_log(vec_max(s->square.z, least))};
    vec mean = (real)(1.0 / 3) * (strain.x + strain.y + strain.z);
    vec3v deviator = {strain.x - mean, strain.y - mean, strain.z - mean};
    vec norm = vec_sqrt(vec3v_dot(deviator, deviator)), excess = norm - limit;
    vec_mask yields = excess > 0;
    /* After the flow Δp: norm − Δp = limit + h Δp. */
    vec flow = excess * (1 / (1 + hardening)), share = -flow / norm;
    mat3v moved = *F;
    add_dyad(&moved, vec_expm1(share * deviator.x), s->first, s->pulled_first);
    add_dyad(&moved, vec_expm1(share * deviator.y), s->second, s->pulled_second);
    add_dyad(&moved, vec_expm1(share * deviator.z), s->third, s->pulled_third);
    *F = (mat3v){vec_select(yields, moved.xx, F->xx), vec_select(yields, moved.xy, F->xy), vec_select(yields, moved.xz, F->xz),
                 vec_select(yields, moved.yx, F->yx), vec_select(yields, moved.yy, F->yy), vec_select(yields, moved.yz, F->yz),
                 vec_select(yields, moved.zx, F->zx), vec_select(yields, moved.zy, F->zy), vec_select(yields, moved.zz, F->zz)};
    return vec_select(yields, flow, vec_all(0));
}

/* EIGEN_TOGETHER parts of a pack. */
SIMD_INLINE void flow_parts(const tile_work *w, const solid_field *strains, int32_t pack, int part) {
    const solid_field *F_field = &w->state->fields[FIELD_DEFORMATION];
    real yield = w->constants[YIELD], hardening = w->constants[HARDENING];
    mat3v F[EIGEN_TOGETHER];
    sym3v b[EIGEN_TOGETHER];
    stretch3v stretch[EIGEN_TOGETHER];
    vec p[EIGEN_TOGETHER], limit[EIGEN_TOGETHER], softness[EIGEN_TOGETHER];
    vec_mask open = vec_all(0) != 0;
    SIMD_UNROLL
    for (int i = 0; i < EIGEN_TOGETHER; i++) {
        F[i] = mat3v_load(F_field, pack, part + i);
        b[i] = mat3v_gram(F[i]);
        p[i] = vec_load(field_at(strains, pack, 0, part + i));
        softness[i] = scaled_down(w->state, w->state->stiffness_scale, pack, part + i, vec_all(1));
        limit[i] = (yield + hardening * p[i]) * softness[i];
        open |= may_yield(b[i], limit[i]);
    }
    if (!vec_any(open)) return;
    mat3v_stretch_each(F, b, stretch, EIGEN_TOGETHER);
    SIMD_UNROLL
    for (int i = 0; i < EIGEN_TOGETHER; i++) {
        vec flow = return_to_surface(&F[i], &stretch[i], limit[i], hardening * softness[i]);
        mat3v_store(F_field, pack, part + i, F[i]);
        vec_store(field_at(strains, pack, 0, part + i), p[i] + flow);
    }
}

static void update(tile_work *w) {
    const solid_field *strains = plastic_strain(w->state);
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part += EIGEN_TOGETHER) flow_parts(w, strains, w->tile->first_pack + k, part);
}

static const parameter parameters[] = {
    [KEY_YIELD_STRESS] = {.key = "yield_stress", .unit = "mass/(length time^2)",
                          .doc = "norm of the deviatoric stress at which it flows (in tension: sqrt(3/2) of this)", .minimum = 1e-12,
                          .maximum = 1e18, .fallback = {1}, .live = true, .logarithmic = true, .required = true,
                          .short_form = "plastic = 2e3"},
    [KEY_HARDENING] = {.key = "hardening", .unit = "mass/(length time^2)", .doc = "growth of yield_stress with plastic strain; 0: none",
                       .maximum = 1e18, .live = true},
};

static const effect_field fields[] = {
    {.key = "plastic_strain", .components = 1, .unit = "1", .written = true, .doc = "length of the path of plastic strain"},
};

static const solid_stages stages = {.constants = constants, .update = update};

const effect SOLID_EFFECT(plastic) = {
    .name = "plastic", .engine = ENGINE_SOLID, .scope = SCOPE_MATERIAL, .doc = "flow beyond a yield stress, without memory of the shape",
    .reference = "AnisoMPM Fig. 14; METHOD.md section 3", .parameters = parameters, .parameter_count = 2, .fields = fields,
    .field_count = 1, .needs = ELASTICITY, .stages = &stages,
};
