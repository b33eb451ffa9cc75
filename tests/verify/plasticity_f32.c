/* The layout of tiles depends on the precision alone, so one source drives the stages of every f32 build. */
#define SUNDER_PRECISION 32
#define SUNDER_SIMD 0
#include "verify/plasticity_f32.h"

#include "solid/state.h"

#include <stdlib.h>

_Static_assert((int)PLASTIC_LANES == (int)PACK, "a pack a call");

typedef struct tile_of_one {
    solid state;
    solid_tile tile;
    effect_values values[EFFECT_LIMIT];
    real deformation[9 * PACK], strain[PACK];
} tile_of_one;

int plastic_return_f32(const char *simd, double yield_stress, double F[PLASTIC_LANES][9]) {
    const solid_engine *engine = solid_engine_find(32, simd);
    if (!engine) return 0;
    tile_of_one *t = aligned_alloc(64, (sizeof *t + 63) / 64 * 64);
    memset(t, 0, sizeof *t);
    t->tile = (solid_tile){.pack_count = 1, .count = PACK};
    for (int f = 0; f <= FIELD_BUILT_IN; f++) t->state.fields[f].name = "";
    t->state.fields[FIELD_DEFORMATION] = (solid_field){"deformation_gradient", 9, t->deformation};
    t->state.fields[FIELD_BUILT_IN] = (solid_field){"plastic_strain", 1, t->strain};
    t->state.field_count = FIELD_BUILT_IN + 1;
    for (int e = 0; e < engine->effect_count; e++) effect_values_default(engine->effects[e], &t->values[e]);
    t->values[EFFECT_elastic].on = t->values[EFFECT_plastic].on = true;
    t->values[EFFECT_elastic].value[0][0] = 100;
    t->values[EFFECT_elastic].value[1][0] = 0.3;
    t->values[EFFECT_plastic].value[0][0] = yield_stress;
    for (int lane = 0; lane < PACK; lane++)
        for (int c = 0; c < 9; c++) t->deformation[c * PACK + lane] = (real)F[lane][c];
    real constants[CONSTANTS] = {0};
    const solid_stages *stages = engine->effects[EFFECT_plastic]->stages;
    stages->constants(t->values, &t->state.definition, false, constants);
    tile_work w = {.state = &t->state, .tile = &t->tile, .constants = constants, .effect = EFFECT_plastic};
    stages->update(&w);
    for (int lane = 0; lane < PACK; lane++)
        for (int c = 0; c < 9; c++) F[lane][c] = (double)t->deformation[c * PACK + lane];
    free(t);
    return 1;
}
