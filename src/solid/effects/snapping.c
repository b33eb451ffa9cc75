/* Snapping: fibres of the first family that break where they are stretched too far (METHOD.md §1, beyond the paper).
 *
 *     d_f' = (1 − d_f) ⟨(ℓ1 − 1)/s − 1⟩/t,   ℓ1 = |F a1|,   and fibres.c stores (1 − d_f)² of the fibre's energy
 *
 * s is the strain at which a fibre begins to break, t how long it takes at twice that; t = 0: at once. Held at a stretch, d_f = 1 −
 * exp(−⟨(ℓ1 − 1)/s − 1⟩ time/t). One backward Euler step of 1 − d_f holds at any step. It belongs to the fibre alone: no neighbour and no
 * damage of the matrix drives it, and it does not heal. */
#include "solid/tensor.h"

enum { STRAIN_INVERSE, RATE };
enum { KEY_SNAP_STRAIN, KEY_SNAP_TIME, KEY_COUNT };

/* Breaks within any step. */
static const double AT_ONCE = 1e-20;

static void constants(const effect_values *all, const solid_definition *d, bool protects, real out[CONSTANTS]) {
    (void)d;
    const effect_values *own = &all[EFFECT_snapping];
    double time = own->value[KEY_SNAP_TIME][0];
    out[STRAIN_INVERSE] = (real)(1 / own->value[KEY_SNAP_STRAIN][0]);
    out[RATE] = (real)(protects ? 0 : 1 / (time > AT_ONCE ? time : AT_ONCE));
}

static void update(tile_work *w) {
    const solid *s = w->state;
    if (s->fibre_field < 0) return;
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            int32_t pack = w->tile->first_pack + k;
            vec3v f = mat3v_times(mat3v_load(&s->fields[FIELD_DEFORMATION], pack, part), vec3v_load(&s->fields[s->fibre_field], pack, part));
            vec over = vec_max((vec_sqrt(vec3v_dot(f, f)) - 1) * w->constants[STRAIN_INVERSE] - 1, vec_all(0));
            real *broken = field_at(&s->fields[s->snapped_field], pack, 0, part);
            vec_store(broken, 1 - (1 - vec_load(broken)) / (1 + w->dt * w->constants[RATE] * over));
        }
}

static const parameter parameters[] = {
    [KEY_SNAP_STRAIN] = {.key = "snap_strain", .unit = "1", .doc = "strain along the fibre beyond which it breaks", .minimum = 1e-6, .maximum = 100,
                         .fallback = {0.2}, .live = true, .logarithmic = true, .required = true, .short_form = "snapping = 0.2"},
    [KEY_SNAP_TIME] = {.key = "snap_time", .unit = "time", .doc = "how long breaking takes at twice that strain; 0: it breaks at once",
                       .maximum = 1e6, .live = true},
};

static const effect_field fields[] = {
    {.key = "fibre_damage", .components = 1, .unit = "1", .written = true, .doc = "how far the first fibre family is broken, 0 … 1"},
};

static const solid_stages stages = {.constants = constants, .update = update};

const effect SOLID_EFFECT(snapping) = {
    .name = "snapping", .engine = ENGINE_SOLID, .scope = SCOPE_MATERIAL, .doc = "fibres that break when they are stretched too far",
    .reference = "METHOD.md section 1 (beyond the paper)", .parameters = parameters, .parameter_count = KEY_COUNT, .fields = fields,
    .field_count = 1, .needs = "fibres", .stages = &stages,
};
