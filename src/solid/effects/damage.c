/* Damage of the matrix: explicit, geometric, anisotropic (AnisoMPM §3, §4.3; METHOD.md §2).
 *
 * σ is the undegraded Cauchy stress of the matrix; it shares its eigenvectors n_i with b = F Fᵀ, because τ = μ b + p I (`elastic`)
 * or 2μ (b − √b) + p I (`corotated`). One symmetric eigen-decomposition of b therefore gives σ⁺ and, through V⁻¹ F a = Σ (n_i · F a)/s_i n_i, the rotated fibres R a.
 *     Φ = tr(A σ⁺ A σ⁺)/σc²,  A = I + α1 (R a1)(R a1)ᵀ + α2 (R a2)(R a2)ᵀ
 *     H ← min(max(H, ζ⟨Φ − 1⟩), 1e6),  d ← min(1, d + Δt/η ⟨(1 − d) H − (d − l0² Δd)⟩)
 * A's eigenvalues lie in [0, 1], so Φ ≤ |σ|²/σc²: where that bound cannot raise H, nothing is decomposed. */
#include "solid/damage_model.h"

#include <math.h>
#include <stdio.h>

enum { ETA_INVERSE, CRITICAL_INVERSE2, ALPHA1, ALPHA2, RESIDUAL, ZETA, LENGTH2, MU, LAMBDA, COROTATED, FROZEN, LAPLACIAN_BOUND, IMPLICIT, INSTANT };
enum { KEY_SIGMA_C, KEY_BREAK_STRETCH, KEY_ETA, KEY_ALPHA, KEY_ALPHA2, KEY_RESIDUAL, KEY_ZETA, KEY_LENGTH_SCALE, KEY_FORM,
       KEY_TOLERANCE, KEY_AS_SHIPPED, KEY_COUNT };

#define OVERSHOOT ((real)1e-3) /* in d, that a step may leave behind */
#define BOUND_MARGIN ((real)0.999) /* the early out's bound holds up to round-off */

static void constants(const effect_values *all, const solid_definition *d, bool protects, real out[CONSTANTS]) {
    const effect_values *own = &all[EFFECT_damage];
    double mu = 0, lambda = 0, lame_lambda;
    elastic_model model = solid_elastic_moduli(all, &mu, &lambda, &lame_lambda);
    double sigma_c = own->value[KEY_SIGMA_C][0], length = damage_half_width(own->value[KEY_LENGTH_SCALE][0], d);
    out[ETA_INVERSE] = own->value[KEY_ETA][0] > 0 ? (real)(1 / own->value[KEY_ETA][0]) : 0; /* implicit: not used */
    out[CRITICAL_INVERSE2] = (real)(1 / (sigma_c * sigma_c));
    out[ALPHA1] = (real)own->value[KEY_ALPHA][0];
    out[ALPHA2] = (real)own->value[KEY_ALPHA2][0];
    out[RESIDUAL] = (real)own->value[KEY_RESIDUAL][0];
    out[ZETA] = (real)own->value[KEY_ZETA][0];
    out[LENGTH2] = (real)(length * length);
    out[MU] = (real)mu;
    out[LAMBDA] = (real)lambda;
    out[COROTATED] = model == ELASTIC_COROTATED ? 1 : 0;
    out[FROZEN] = protects ? 1 : 0;
    /* Σ|N''| = 4 a direction for both splines: no discrete Laplacian of values in [0,1] exceeds 12/dx². */
    out[IMPLICIT] = (real)own->value[KEY_FORM][0];
    out[INSTANT] = own->value[KEY_FORM][0] == 0 ? (real)own->value[KEY_AS_SHIPPED][0] : 0;
    out[LAPLACIAN_BOUND] = (real)(12 * length * length / (d->dx * d->dx));
}

/* The implicit form is solved on the grid for all materials at once, to the strictest of their tolerances. */
static void declare(solid *s, int material, const effect_values *all) {
    const effect_values *own = &all[EFFECT_damage];
    s->material_damaged[material] = true;
    s->material_implicit[material] = own->value[KEY_FORM][0] != 0;
    if (!s->material_implicit[material]) return;
    double length = damage_half_width(own->value[KEY_LENGTH_SCALE][0], &s->definition);
    s->implicit_on = true;
    s->implicit_materials[material] = (implicit_material){(real)own->value[KEY_ETA][0], (real)(length * length)};
    s->implicit_tolerance = fmin(s->implicit_tolerance, own->value[KEY_TOLERANCE][0]);
}

static void degrade(tile_work *w) {
    damage_degrade(w, w->constants[RESIDUAL]);
}

/* Adds one family's α (F a · n_i)(F a · n_j): over the stretches s_i s_j it is its part of A in the axes n_i of the stress. */
SIMD_INLINE void add_structure(const tile_work *w, int32_t pack, int part, int field, real alpha, mat3v F, const eigen3v *e, sym3v *S) {
    if (alpha == 0 || field < 0) return;
    vec3v f = mat3v_times(F, vec3v_load(&w->state->fields[field], pack, part));
    vec x = vec3v_dot(e->first, f), y = vec3v_dot(e->second, f), z = vec3v_dot(e->third, f);
    vec alpha_x = alpha * x, alpha_y = alpha * y, alpha_z = alpha * z;
    *S = (sym3v){vec_fma(alpha_x, x, S->xx), vec_fma(alpha_y, y, S->yy), vec_fma(alpha_z, z, S->zz),
                 vec_fma(alpha_x, y, S->xy), vec_fma(alpha_y, z, S->yz), vec_fma(alpha_x, z, S->xz)};
}

/* tr(A S A S) = Σ_ij s_i s_j A_ij² in the axes of S, A = I + `structure` over the stretches: no cancellation, never negative, and of the stretches only
 * squares. */
SIMD_INLINE vec driving_form(sym3v structure, vec3v inverse_square, vec3v s) {
    vec3v i = inverse_square;
    vec xy = (structure.xy * i.x) * (structure.xy * i.y), yz = (structure.yz * i.y) * (structure.yz * i.z),
        xz = (structure.xz * i.x) * (structure.xz * i.z);
    vec mixed = vec_fma(s.x * s.y, xy, vec_fma(s.y * s.z, yz, s.x * s.z * xz));
    vec x = vec_fma(s.x, structure.xx * i.x, s.x), y = vec_fma(s.y, structure.yy * i.y, s.y), z = vec_fma(s.z, structure.zz * i.z, s.z);
    return vec_fma(x, x, vec_fma(y, y, vec_fma(z, z, mixed + mixed)));
}

/* Principal values of τ from the eigenvalues of b, and |τ|² or a bound of it without them, of each elastic model. */
SIMD_INLINE vec3v principal_closed_form(const real *c, vec3v square, vec pressure) {
    vec mu = vec_all(c[MU]);
    return (vec3v){vec_fma(mu, square.x, pressure), vec_fma(mu, square.y, pressure), vec_fma(mu, square.z, pressure)};
}

SIMD_INLINE vec square_closed_form(const real *c, sym3v b, vec pressure) {
    sym3v tau = {vec_fma(vec_all(c[MU]), b.xx, pressure), vec_fma(vec_all(c[MU]), b.yy, pressure),
                 vec_fma(vec_all(c[MU]), b.zz, pressure), c[MU] * b.xy, c[MU] * b.yz, c[MU] * b.xz};
    return sym3v_square_sum(tau);
}

/* Only where J > 0: all stretches count as positive. */
SIMD_INLINE vec3v principal_corotated(const real *c, vec3v square, vec pressure) {
    vec twice_mu = vec_all(2 * c[MU]), zero = vec_all(0);
    vec3v s = {vec_sqrt(vec_max(square.x, zero)), vec_sqrt(vec_max(square.y, zero)), vec_sqrt(vec_max(square.z, zero))};
    return (vec3v){vec_fma(twice_mu, square.x - s.x, pressure), vec_fma(twice_mu, square.y - s.y, pressure),
                   vec_fma(twice_mu, square.z - s.z, pressure)};
}

/* s² − s = (s² − 1) s/(1 + s), and s/(1 + s) grows with s: |b − √b| ≤ |b − I| S/(1 + S) for any S ≥ the largest s. */
SIMD_INLINE vec square_bound_corotated(const real *c, sym3v b, vec pressure) {
    vec largest = vec_sqrt(sym3v_largest_bound(b));
    sym3v strain = {b.xx - 1, b.yy - 1, b.zz - 1, b.xy, b.yz, b.xz};
    vec shear = 2 * c[MU] * vec_sqrt(sym3v_square_sum(strain)) * largest / (1 + largest);
    vec norm = vec_fma(vec_all((real)1.7320508075688773), vec_abs(pressure), shear); /* |p I| = √3 |p| */
    return norm * norm;
}

/* What decides whether a particle's stress must be looked at. */
typedef struct strained {
    sym3v b;
    vec pressure, inverse_J;
    vec_mask open;
} strained;

/* Φ σc² of the particles whose bound says that it could matter. */
SIMD_INLINE vec driving_stress(const tile_work *w, int32_t pack, int part, const strained *at, const eigen3v *e) {
    const real *c = w->constants;
    vec zero = vec_all(0), tiny = vec_all((real)1e-20);
    vec3v tau = c[COROTATED] != 0 ? principal_corotated(c, e->value, at->pressure) : principal_closed_form(c, e->value, at->pressure);
    vec3v positive = {vec_max(tau.x * at->inverse_J, zero), vec_max(tau.y * at->inverse_J, zero), vec_max(tau.z * at->inverse_J, zero)};
    sym3v structure = {zero, zero, zero, zero, zero, zero};
    vec3v inverse = {zero, zero, zero};
    if (c[ALPHA1] != 0 || c[ALPHA2] != 0) {
        mat3v F = mat3v_load(&w->state->fields[FIELD_DEFORMATION], pack, part);
        inverse = (vec3v){1 / vec_max(e->value.x, tiny), 1 / vec_max(e->value.y, tiny), 1 / vec_max(e->value.z, tiny)};
        add_structure(w, pack, part, w->state->fibre_field, c[ALPHA1], F, e, &structure);
        add_structure(w, pack, part, w->state->fibre2_field, c[ALPHA2], F, e, &structure);
    }
    return driving_form(structure, inverse, positive);
}

/* Stress over σc, squared, by what this particle's E and σc are to its material's. */
SIMD_INLINE vec relative_load(const tile_work *w, int32_t pack, int part, vec value) {
    const solid *s = w->state;
    if (s->toughness_scale <= 0 && s->stiffness_scale <= 0) return value;
    vec toughness = scaled(s, s->toughness_scale, pack, part, vec_all(1));
    vec ratio = scaled(s, s->stiffness_scale, pack, part, vec_all(1)) / toughness;
    return value * ratio * ratio;
}

SIMD_INLINE strained strained_at(const tile_work *w, int32_t pack, int part, vec d, vec H) {
    const real *c = w->constants;
    mat3v F = mat3v_load(&w->state->fields[FIELD_DEFORMATION], pack, part);
    vec J = mat3v_determinant(F);
    strained at = {.b = mat3v_gram(F)};
    bool corotated = c[COROTATED] != 0;
    at.pressure = J * vec_fma(vec_all(c[LAMBDA]), J - 1, vec_all(corotated ? 0 : -c[MU]));
    at.inverse_J = 1 / vec_max(J, vec_all((real)1e-3));
    vec square = corotated ? square_bound_corotated(c, at.b, at.pressure) : square_closed_form(c, at.b, at.pressure);
    vec bound = relative_load(w, pack, part, square * at.inverse_J * at.inverse_J * c[CRITICAL_INVERSE2]);
    at.open = (bound > BOUND_MARGIN * (1 + H * (1 / c[ZETA]))) & (J > 0) & (d < 1);
    return at;
}

/* The histories' new values from this step's F, of EIGEN_TOGETHER parts of a pack. */
SIMD_INLINE void raise_histories(const tile_work *w, int32_t pack, int part, const vec *d, vec *H) {
    const real *c = w->constants;
    strained at[EIGEN_TOGETHER];
    sym3v b[EIGEN_TOGETHER];
    eigen3v e[EIGEN_TOGETHER];
    vec_mask open = vec_all(0) != 0;
    SIMD_UNROLL
    for (int i = 0; i < EIGEN_TOGETHER; i++) {
        at[i] = strained_at(w, pack, part + i, d[i], H[i]);
        b[i] = at[i].b, open |= at[i].open;
    }
    if (!vec_any(open)) return;
    sym3v_eigen_each(b, e, EIGEN_TOGETHER);
    SIMD_UNROLL
    for (int i = 0; i < EIGEN_TOGETHER; i++) {
        vec phi = relative_load(w, pack, part + i, driving_stress(w, pack, part + i, &at[i], &e[i]) * c[CRITICAL_INVERSE2]);
        vec raised = vec_min(vec_max(c[ZETA] * (phi - 1), H[i]), vec_all(DAMAGE_DRIVING_LIMIT));
        H[i] = vec_select(at[i].open, raised, H[i]);
    }
}

/* 1/Δt of the explicit update. It relaxes d towards e = (H + l0² Δd)/(1 + H) at the rate (1 + H + bound)/η and overshoots where
 * Δt times that exceeds 1; the bracket keeps the overshoot. What may be left behind is at most OVERSHOOT, so a particle near e
 * counts less, and one with 1 − e below OVERSHOOT not at all: d ≤ 1 holds it. A particle that nothing drives yet counts at
 * the rate without H, so that it does not leap to d = 1 in the step in which it is first driven. */
SIMD_INLINE vec relaxation_limit(const real *c, vec d, vec H, vec spread) {
    vec inverse = 1 / (1 + H), rest = (H + spread) * inverse, gap = rest - d;
    vec rate = (1 + H + c[LAPLACIAN_BOUND]) * c[ETA_INVERSE];
    vec_mask counts = (d < 1) & (gap > 0) & (1 - rest > OVERSHOOT);
    vec undriven = vec_select((d < 1) & (H == 0), vec_all((1 + c[LAPLACIAN_BOUND]) * c[ETA_INVERSE]), vec_all(0));
    return vec_max(vec_select(counts, rate * gap / (gap + OVERSHOOT), vec_all(0)), undriven);
}

/* The grid has solved for d; scratch->laplacian holds l0² Δd of that. Then the history of the new F, for the next solve. */
static void update_implicit(tile_work *w) {
    const solid_field *damage = &w->state->fields[w->state->damage_field];
    const solid_field *histories = &w->state->fields[w->state->history_field];
    real rate = w->state->implicit_materials[w->tile->material].eta / w->dt;
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part += EIGEN_TOGETHER) {
            int32_t pack = w->tile->first_pack + k;
            vec d[EIGEN_TOGETHER], H[EIGEN_TOGETHER];
            SIMD_UNROLL
            for (int i = 0; i < EIGEN_TOGETHER; i++) {
                H[i] = vec_load(field_at(histories, pack, 0, part + i));
                vec spread = vec_load(scratch_at(w->scratch->laplacian, 1, k, 0, part + i));
                vec pace = scaled(w->state, w->state->viscosity_scale, pack, part + i, vec_all(rate));
                d[i] = implicit_damage(vec_load(field_at(damage, pack, 0, part + i)), H[i], spread, pace);
                vec_store(field_at(damage, pack, 0, part + i), d[i]);
            }
            raise_histories(w, pack, part, d, H);
            SIMD_UNROLL
            for (int i = 0; i < EIGEN_TOGETHER; i++) vec_store(field_at(histories, pack, 0, part + i), H[i]);
        }
}

/* One explicit step of d; its limit where particles are not padding. */
SIMD_INLINE vec relax(const tile_work *w, int k, int part, vec d, vec H) {
    const solid *s = w->state;
    const real *c = w->constants;
    int32_t pack = w->tile->first_pack + k;
    vec spread = c[LENGTH2] * vec_load(scratch_at(w->scratch->laplacian, 1, k, 0, part));
    vec growth = vec_max(vec_fma(1 - d, H, spread - d), vec_all(0));
    vec pace = scaled_down(s, s->viscosity_scale, pack, part, vec_all(1));
    d = vec_min(vec_fma(w->dt * c[ETA_INVERSE] * pace, growth, d), vec_all(1));
    vec_store(field_at(&s->fields[s->damage_field], pack, 0, part), d);
    vec alive = vec_load(field_at(&s->fields[FIELD_VOLUME], pack, 0, part));
    return vec_select(alive > 0, relaxation_limit(c, d, H, spread) * pace, vec_all(0));
}

static void update(tile_work *w) {
    const solid_field *damage = &w->state->fields[w->state->damage_field];
    const solid_field *histories = &w->state->fields[w->state->history_field];
    const real *c = w->constants;
    if (c[FROZEN] != 0) return;
    if (c[IMPLICIT] != 0) {
        update_implicit(w);
        return;
    }
    vec limit = vec_all(0);
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part += EIGEN_TOGETHER) {
            int32_t pack = w->tile->first_pack + k;
            vec d[EIGEN_TOGETHER], H[EIGEN_TOGETHER];
            SIMD_UNROLL
            for (int i = 0; i < EIGEN_TOGETHER; i++) {
                d[i] = vec_load(field_at(damage, pack, 0, part + i));
                H[i] = c[INSTANT] != 0 ? vec_all(0) : vec_load(field_at(histories, pack, 0, part + i));
            }
            raise_histories(w, pack, part, d, H);
            SIMD_UNROLL
            for (int i = 0; i < EIGEN_TOGETHER; i++) {
                vec_store(field_at(histories, pack, 0, part + i), H[i]);
                limit = vec_max(relax(w, k, part + i, d[i], H[i]), limit);
            }
        }
    w->result->limit[w->effect] = vec_largest(limit);
}

/* ---- the table --------------------------------------------------------------------------------------------------- */

/* σc from a stretch p: the closed form's energy density of (1 + p) I, undegraded, without fibres, with the plain Lamé λ: so
 * the papers' numbers hold (FACTS.md §1), and σc is the same whatever `lame` and the elastic model are. */
static double critical_from_stretch(double mu, double lambda, double p) {
    double s = 1 + p, growth = p * (3 + p * (3 + p)); /* J − 1 */
    return 1.5 * mu * (s * s - 1) - mu * growth + 0.5 * lambda * growth * growth;
}

/* The smallest p > 0 with that energy, by doubling and bisection; the energy grows from p = 0 for every admissible (E, ν) as
 * far as the search goes, or the search says so. */
static status stretch_from_critical(double mu, double lambda, double sigma_c, double *p, report *r) {
    double low = 0, high = 1e-6;
    while (critical_from_stretch(mu, lambda, high) < sigma_c) {
        low = high;
        high *= 1.5;
        if (high > 1e4)
            return report_input(r, NULL, 0, "damage.sigma_c", "a value that some stretch below 1e4 reaches", "one that none does", NULL);
    }
    for (int i = 0; i < 200; i++) {
        double middle = 0.5 * (low + high);
        if (critical_from_stretch(mu, lambda, middle) < sigma_c) low = middle;
        else high = middle;
    }
    *p = 0.5 * (low + high);
    return STATUS_OK;
}

static status resolve(effect_values *own, const effect_values *all, report *r) {
    double mu, model_lambda, lambda;
    if (own->value[KEY_ETA][0] == 0 && own->value[KEY_FORM][0] == 0)
        return report_input(r, NULL, 0, "damage.eta", "a positive viscosity, or form = \"implicit\"", "0 in the explicit form", NULL);
    if (solid_elastic_moduli(all, &mu, &model_lambda, &lambda) == ELASTIC_NONE) return STATUS_OK; /* `needs` reports it */
    if (own->given[KEY_SIGMA_C])
        return stretch_from_critical(mu, lambda, own->value[KEY_SIGMA_C][0], &own->value[KEY_BREAK_STRETCH][0], r);
    double sigma_c = critical_from_stretch(mu, lambda, own->value[KEY_BREAK_STRETCH][0]);
    own->value[KEY_SIGMA_C][0] = sigma_c;
    if (sigma_c > 0) return STATUS_OK;
    char found[64];
    snprintf(found, sizeof found, "%g (critical value %g)", own->value[KEY_BREAK_STRETCH][0], sigma_c);
    return report_input(r, NULL, 0, "damage.break_stretch", "a stretch whose critical value is positive", found, NULL);
}

/* The explicit update's pace is that of 1/η. */
static double hasten(const real before[CONSTANTS], const real after[CONSTANTS]) {
    return before[ETA_INVERSE] > 0 ? (double)after[ETA_INVERSE] / (double)before[ETA_INVERSE] : 1;
}

static const char *const form_choices[] = {"explicit", "implicit", NULL};

static const parameter parameters[KEY_COUNT] = {
    [KEY_SIGMA_C] = {.key = "sigma_c", .unit = "mass/(length time^2)", .doc = "critical stress: damage starts above it",
                     .minimum = 1e-12, .maximum = 1e18, .fallback = {1}, .live = true, .logarithmic = true,
                     .required = true, .twin = "break_stretch", .scale = "toughness_scale"},
    [KEY_BREAK_STRETCH] = {.key = "break_stretch", .unit = "1",
                           .doc = "stretch whose energy density sets sigma_c (0.2: about 20 %)", .minimum = 1e-6,
                           .maximum = 100, .fallback = {0.2}, .live = true, .logarithmic = true, .twin = "sigma_c", .scale = "toughness_scale"},
    [KEY_ETA] = {.key = "eta", .unit = "time", .doc = "viscosity of damage: larger is more ductile, smaller more brittle",
                 .maximum = 1e6, .fallback = {0.1}, .live = true, .logarithmic = true, .scale = "viscosity_scale"},
    [KEY_ALPHA] = {.key = "alpha", .unit = "1",
                   .doc = "-1: stress along the first fibres does no damage, cracks run along them; 0: isotropic",
                   .minimum = -1, .maximum = 0, .live = true},
    [KEY_ALPHA2] = {.key = "alpha2", .unit = "1", .doc = "the same for the second family", .minimum = -1, .live = true},
    [KEY_RESIDUAL] = DAMAGE_RESIDUAL(1),
    [KEY_ZETA] = {.key = "zeta", .unit = "1", .doc = "slope of damage above the critical stress", .minimum = 1e-6,
                  .maximum = 1e6, .fallback = {1}, .live = true, .logarithmic = true},
    [KEY_LENGTH_SCALE] = DAMAGE_LENGTH_SCALE,
    [KEY_FORM] = {.key = "form", .unit = "1", .doc = "explicit: cheap, limits the time step by eta; implicit: solved on the grid, any eta",
                  .kind = PARAMETER_CHOICE, .maximum = 1, .choices = form_choices,
                  .why_not = "the grid is made for one form", .accuracy = {.kind = ACCURACY_CHOICE, .finer = -1}},
    [KEY_TOLERANCE] = {.key = "tolerance", .unit = "1", .doc = "relative residual of the implicit solve", .minimum = 1e-14,
                       .maximum = 0.1, .fallback = {1e-4}, .live = true, .logarithmic = true,
                       .accuracy = {.kind = ACCURACY_FACTOR, .finer = 0.1, .when = "form", .is = 1}},
    [KEY_AS_SHIPPED] = {.key = "as_shipped", .unit = "1",
                        .doc = "explicit form: driven by the force of the moment instead of the largest so far, as the authors' code is",
                        .kind = PARAMETER_BOOLEAN, .maximum = 1, .live = true},
};

static const effect_field fields[] = {
    DAMAGE_FIELDS,
    {.key = "fibre", .components = 3, .unit = "1", .written = true, .doc = "first fibre direction at rest, unit"},
    {.key = "fibre2", .components = 3, .unit = "1", .written = true, .doc = "second fibre direction at rest, unit"},
    {.key = "toughness_scale", .components = 1, .unit = "1", .written = true, .doc = "sigma_c over its material's, where it varies"},
    {.key = "viscosity_scale", .components = 1, .unit = "1", .written = true, .doc = "eta over its material's, where it varies"},
};

static const solid_stages stages = {.constants = constants, .declare = declare, .degrade = degrade, .solve = implicit_solve, .update = update, .hasten = hasten};

const effect SOLID_EFFECT(damage) = {
    .name = "damage", .engine = ENGINE_SOLID, .scope = SCOPE_MATERIAL, .doc = "anisotropic damage of the matrix",
    .reference = "AnisoMPM sections 3, 4.3; METHOD.md section 2", .parameters = parameters, .parameter_count = KEY_COUNT,
    .fields = fields, .field_count = 6, DAMAGE_TABLES, .resolve = resolve, .stages = &stages,
};
