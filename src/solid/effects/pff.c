/* PFF-MPM: the isotropic variational phase field (Borden et al. 2012, as CD-MPM of Wolper et al. 2019 uses it), the rival that
 * the solid paper's Fig. 25 compares with (METHOD.md §2). With c = 1 − d, g = c² (1 − r) + r and H = max Ψ⁺,
 *     (4 l0 (1 − r) H/G + 1) c − 4 l0² Δc = 1,   or ċ = −M × (left − right) with a mobility M.
 * Written for d this is the implicit damage system with D̃ = 4 l0 (1 − r) H/G, l0² four times as large and η = 1/M (0 without a
 * mobility): the same solver serves both. */
#include "solid/damage_model.h"
#include "solid/stretch.h"

#include <math.h>

enum { DRIVING, RESIDUAL, MU, LAMBDA, COROTATED, FROZEN };
enum { KEY_TOUGHNESS, KEY_LENGTH_SCALE, KEY_MOBILITY, KEY_RESIDUAL, KEY_TOLERANCE, KEY_COUNT };


static void constants(const effect_values *all, const solid_definition *d, bool protects, real out[CONSTANTS]) {
    const effect_values *own = &all[EFFECT_pff];
    double mu = 0, lambda = 0, lame_lambda, r = own->value[KEY_RESIDUAL][0];
    elastic_model model = solid_elastic_moduli(all, &mu, &lambda, &lame_lambda);
    out[DRIVING] = (real)(4 * damage_half_width(own->value[KEY_LENGTH_SCALE][0], d) * (1 - r) / own->value[KEY_TOUGHNESS][0]);
    out[RESIDUAL] = (real)r;
    out[MU] = (real)mu;
    out[LAMBDA] = (real)lambda;
    out[COROTATED] = model == ELASTIC_COROTATED ? 1 : 0;
    out[FROZEN] = protects ? 1 : 0;
}

static void declare(solid *s, int material, const effect_values *all) {
    const effect_values *own = &all[EFFECT_pff];
    double length = damage_half_width(own->value[KEY_LENGTH_SCALE][0], &s->definition), mobility = own->value[KEY_MOBILITY][0];
    s->material_damaged[material] = s->material_implicit[material] = s->implicit_on = true;
    s->implicit_materials[material] = (implicit_material){(real)(mobility > 0 ? 1 / mobility : 0), (real)(4 * length * length)};
    s->implicit_tolerance = fmin(s->implicit_tolerance, own->value[KEY_TOLERANCE][0]);
}

static void degrade(tile_work *w) {
    damage_degrade(w, w->constants[RESIDUAL]);
}

/* Ψ⁺: Ψμ + Ψλ in tension (J ≥ 1), Ψμ in compression, as the stress is split. */
SIMD_INLINE vec tensile_energy(const real *c, mat3v F) {
    vec J = mat3v_determinant(F), shear;
    sym3v b = mat3v_gram(F);
    if (c[COROTATED] != 0) {
        stretch3v s = mat3v_stretch(F, b);
        vec x = vec_sqrt(s.square.x) - 1, y = vec_sqrt(s.square.y) - 1, z = vec_sqrt(s.square.z) - 1;
        shear = c[MU] * (x * x + y * y + z * z);
    } else {
        shear = (real)0.5 * c[MU] * (b.xx + b.yy + b.zz - 3) - c[MU] * (J - 1);
    }
    vec volume = (real)0.5 * c[LAMBDA] * (J - 1) * (J - 1);
    return vec_max(shear + vec_select(J >= 1, volume, vec_all(0)), vec_all(0));
}

/* The grid has solved for d; scratch->laplacian holds 4 l0² Δd of that. */
static void update(tile_work *w) {
    const solid_field *damage = &w->state->fields[w->state->damage_field];
    const solid_field *histories = &w->state->fields[w->state->history_field];
    const real *c = w->constants;
    if (c[FROZEN] != 0) return;
    real rate = w->state->implicit_materials[w->tile->material].eta / w->dt;
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            int32_t pack = w->tile->first_pack + k;
            vec d = vec_load(field_at(damage, pack, 0, part)), H = vec_load(field_at(histories, pack, 0, part));
            vec spread = vec_load(scratch_at(w->scratch->laplacian, 1, k, 0, part));
            vec driving = c[DRIVING] * tensile_energy(c, mat3v_load(&w->state->fields[FIELD_DEFORMATION], pack, part));
            driving = scaled(w->state, w->state->stiffness_scale, pack, part, driving);
            vec_store(field_at(damage, pack, 0, part), implicit_damage(d, H, spread, vec_all(rate)));
            vec_store(field_at(histories, pack, 0, part), vec_min(vec_max(driving, H), vec_all(DAMAGE_DRIVING_LIMIT)));
        }
}

static const parameter parameters[KEY_COUNT] = {
    [KEY_TOUGHNESS] = {.key = "toughness", .unit = "mass/time^2", .doc = "energy that a crack takes per area", .minimum = 1e-18,
                       .maximum = 1e18, .fallback = {1}, .live = true, .logarithmic = true, .required = true},
    [KEY_LENGTH_SCALE] = DAMAGE_LENGTH_SCALE,
    [KEY_MOBILITY] = {.key = "mobility", .unit = "1/time", .doc = "how fast the phase field follows; 0: at once", .maximum = 1e12,
                      .live = true, .logarithmic = true},
    [KEY_RESIDUAL] = DAMAGE_RESIDUAL(0.999),
    [KEY_TOLERANCE] = {.key = "tolerance", .unit = "1", .doc = "relative residual of the solve on the grid", .minimum = 1e-14, .maximum = 0.1,
                       .fallback = {1e-4}, .live = true, .logarithmic = true, .accuracy = {.kind = ACCURACY_FACTOR, .finer = 0.1}},
};

static const effect_field fields[] = {
    DAMAGE_FIELDS,
};

static const solid_stages stages = {.constants = constants, .declare = declare, .degrade = degrade, .solve = implicit_solve, .update = update};

const effect SOLID_EFFECT(pff) = {
    .name = "pff", .engine = ENGINE_SOLID, .scope = SCOPE_MATERIAL, .doc = "isotropic phase-field fracture (PFF-MPM)",
    .reference = "Wolper et al. 2019; METHOD.md section 2", .parameters = parameters, .parameter_count = KEY_COUNT,
    .fields = fields, .field_count = 2, DAMAGE_TABLES, .stages = &stages,
};
