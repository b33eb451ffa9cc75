/* Softening: the diffused quantity takes stiffness and strength away: water weakens bread, heat weakens what melts. E and σc fall linearly with θ
 * down to a floor (METHOD.md, end of §6). What is left is written where parameters that vary in place have theirs, so every effect that knows
 * those knows this. */
#include "solid/tensor.h"

enum { STIFFNESS_LOSS, STRENGTH_LOSS, FLOOR };
enum { KEY_STIFFNESS, KEY_STRENGTH, KEY_FLOOR, KEY_COUNT };

static void constants(const effect_values *all, const solid_definition *d, bool protects, real out[CONSTANTS]) {
    (void)d, (void)protects;
    const effect_values *own = &all[EFFECT_softening];
    out[STIFFNESS_LOSS] = (real)own->value[KEY_STIFFNESS][0];
    out[STRENGTH_LOSS] = (real)own->value[KEY_STRENGTH][0];
    out[FLOOR] = (real)own->value[KEY_FLOOR][0];
}

SIMD_INLINE void soften(const tile_work *w, int32_t pack, int part, int given, int now, real loss) {
    const solid *s = w->state;
    vec theta = vec_load(field_at(&s->fields[s->diffusion.field], pack, 0, part));
    vec left = vec_max(vec_fma(vec_all(-loss), theta, vec_all(1)), vec_all(w->constants[FLOOR]));
    vec_store(field_at(&s->fields[now], pack, 0, part), scaled(s, given, pack, part, left));
}

static void feel(tile_work *w) {
    const solid *s = w->state;
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            int32_t pack = w->tile->first_pack + k;
            soften(w, pack, part, s->given_stiffness, s->stiffness_scale, w->constants[STIFFNESS_LOSS]);
            soften(w, pack, part, s->given_toughness, s->toughness_scale, w->constants[STRENGTH_LOSS]);
        }
}

static const parameter parameters[KEY_COUNT] = {
    [KEY_STIFFNESS] = {.key = "stiffness", .unit = "1", .doc = "share of E lost at a diffused quantity of 1", .maximum = 1e6, .live = true},
    [KEY_STRENGTH] = {.key = "strength", .unit = "1", .doc = "share of sigma_c lost", .maximum = 1e6, .live = true},
    [KEY_FLOOR] = {.key = "floor", .unit = "1", .doc = "share that is always left", .minimum = 1e-6, .maximum = 1, .fallback = {0.01}, .live = true},
};

static const effect_field fields[] = {
    {.key = "softened_stiffness", .components = 1, .unit = "1", .written = true, .doc = "E over its material's"},
    {.key = "softened_strength", .components = 1, .unit = "1", .written = true, .doc = "sigma_c over its material's"},
};

static const solid_stages stages = {.constants = constants, .feel = feel};

const effect SOLID_EFFECT(softening) = {
    .name = "softening", .engine = ENGINE_SOLID, .scope = SCOPE_MATERIAL, .doc = "the diffused quantity weakens the matrix",
    .reference = "METHOD.md section 6 (beyond the papers)", .parameters = parameters, .parameter_count = KEY_COUNT, .fields = fields,
    .field_count = 2, .needs = "diffusion", .stages = &stages,
};
