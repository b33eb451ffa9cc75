/* Swelling: what diffuses stretches the state without stress by F_θ = (1 + α⊥ θ)(I − a aᵀ) + (1 + α∥ θ) a aᵀ, a the first fibres at rest; without
 * fibres α∥ = α⊥ = α (METHOD.md, end of §6).
 *
 * F is that of the elastic part, F_e = F F_θ⁻¹, so every effect that sees F sees what stress comes of; when θ changes it turns by F_θ,old F_θ,new⁻¹. The
 * stretches that F has been relieved of are kept, so that nothing is lost by many small changes. */
#include "solid/tensor.h"

enum { ACROSS, ALONG };
enum { KEY_ALPHA, KEY_ALONG, KEY_COUNT };

static const real LEAST = (real)0.05; /* of a stretch: what shrinks to nothing has no shape */

static void constants(const effect_values *all, const solid_definition *d, bool protects, real out[CONSTANTS]) {
    (void)d, (void)protects;
    const effect_values *own = &all[EFFECT_swelling];
    out[ACROSS] = (real)own->value[KEY_ALPHA][0];
    out[ALONG] = own->given[KEY_ALONG] ? (real)own->value[KEY_ALONG][0] : out[ACROSS];
}

/* F ← F (across I + (along − across) a aᵀ) */
SIMD_INLINE mat3v relieve(mat3v F, vec across, vec along, vec3v a) {
    vec3v f = vec3v_scale(along - across, mat3v_times(F, a));
    return (mat3v){vec_fma(across, F.xx, f.x * a.x), vec_fma(across, F.xy, f.x * a.y), vec_fma(across, F.xz, f.x * a.z),
                   vec_fma(across, F.yx, f.y * a.x), vec_fma(across, F.yy, f.y * a.y), vec_fma(across, F.yz, f.y * a.z),
                   vec_fma(across, F.zx, f.z * a.x), vec_fma(across, F.zy, f.z * a.y), vec_fma(across, F.zz, f.z * a.z)};
}

static void feel(tile_work *w) {
    const solid *s = w->state;
    const solid_field *F_field = &s->fields[FIELD_DEFORMATION], *swollen = &s->fields[s->own_field[EFFECT_swelling][0]];
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            int32_t pack = w->tile->first_pack + k;
            vec theta = vec_load(field_at(&s->fields[s->diffusion.field], pack, 0, part));
            vec across = vec_max(w->constants[ACROSS] * theta, vec_all(LEAST - 1));
            vec along = vec_max(w->constants[ALONG] * theta, vec_all(LEAST - 1));
            real *across_before = field_at(swollen, pack, 0, part), *along_before = field_at(swollen, pack, 1, part);
            vec change = (1 + vec_load(across_before)) / (1 + across), change_along = (1 + vec_load(along_before)) / (1 + along);
            if (!vec_any((change != 1) | (change_along != 1))) continue;
            const vec zero = vec_all(0);
            vec3v a = s->fibre_field < 0 ? (vec3v){zero, zero, zero} : vec3v_load(&s->fields[s->fibre_field], pack, part);
            mat3v F = mat3v_load(F_field, pack, part);
            mat3v_store(F_field, pack, part, relieve(F, change, change_along, a));
            vec_store(across_before, across);
            vec_store(along_before, along);
        }
}

static const parameter parameters[KEY_COUNT] = {
    [KEY_ALPHA] = {.key = "alpha", .unit = "1", .doc = "stretch of a free body for a diffused quantity of 1", .minimum = -100, .maximum = 100, .live = true,
                   .required = true, .short_form = "swelling = 0.1"},
    [KEY_ALONG] = {.key = "along", .unit = "1", .doc = "the same along the first fibres, where it differs: wood swells across its grain", .minimum = -100,
                   .maximum = 100, .live = true},
};

static const effect_field fields[] = {
    {.key = "swelling", .components = 2, .unit = "1", .written = false, .doc = "stretch without stress, less 1: across the first fibres, and along them"},
    {.key = "fibre", .components = 3, .unit = "1", .written = true, .doc = "first fibre direction at rest, unit"},
};

static const solid_stages stages = {.constants = constants, .feel = feel};

const effect SOLID_EFFECT(swelling) = {
    .name = "swelling", .engine = ENGINE_SOLID, .scope = SCOPE_MATERIAL, .doc = "the diffused quantity stretches the state without stress",
    .reference = "METHOD.md section 6 (beyond the papers)", .parameters = parameters, .parameter_count = KEY_COUNT, .fields = fields,
    .field_count = 2, .needs = "diffusion", .stages = &stages,
};
