/* What the damage models share (METHOD.md §2): parameters, fields, measures, the degradation. */
#ifndef SUNDER_SOLID_DAMAGE_MODEL_H
#define SUNDER_SOLID_DAMAGE_MODEL_H

#include "solid/moduli.h"
#include "solid/tensor.h"

#define DAMAGE_DRIVING_LIMIT ((real)1e6)

/* Rows of parameters, under the keys that a model has for them. */
#define DAMAGE_RESIDUAL(most) \
    {.key = "residual", .unit = "1", .doc = "stiffness that a broken particle keeps", .maximum = most, .fallback = {0.01}, .live = true}
#define DAMAGE_LENGTH_SCALE                                                                                         \
    {.key = "length_scale", .unit = "length", .doc = "half width of a crack; 0: half the grid spacing", .maximum = 1e9, \
     .why_not = "cracks already have its width"}

#define DAMAGE_FIELDS                                                                                                \
    {.key = "damage", .components = 1, .unit = "1", .written = true, .doc = "0 whole, 1 broken"},                      \
        {.key = "damage_history", .components = 1, .unit = "1", .written = false, .doc = "largest driving force so far"}

static const effect_measure damage_measures[] = {
    {"damage_mean", "1", "mean damage"},
    {"damage_max", "1", "largest damage"},
    {"broken_fraction", "1", "fraction of particles over 0.9"},
};

#define DAMAGE_TABLES .measures = damage_measures, .measure_count = 3, .provides = "damage model", .needs = ELASTICITY

/* The half width of cracks, from the parameter's value. */
static inline double damage_half_width(double length_scale, const solid_definition *d) {
    return length_scale > 0 ? length_scale : 0.5 * d->dx;
}

/* g(d) = (1 − d)² (1 − r) + r */
static inline void damage_degrade(tile_work *w, real r) {
    const solid_field *damage = &w->state->fields[w->state->damage_field];
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            vec left = 1 - vec_load(field_at(damage, w->tile->first_pack + k, 0, part));
            vec_store(scratch_at(w->scratch->degradation, 1, k, 0, part), vec_fma(left * left, vec_all(1 - r), vec_all(r)));
        }
}

#endif
