/* One material point in the hands of the engine's own stages: tests set F, ask for stress, energy and wave modulus. */
#ifndef SUNDER_TESTS_SOLID_POINT_H
#define SUNDER_TESTS_SOLID_POINT_H

#define SUNDER_PRECISION 64
#define SUNDER_SIMD 0
#include "solid/tensor.h"

#include <stdlib.h>

typedef struct material_point {
    solid state;
    solid_tile tile;
    tile_scratch scratch;
    tile_result result;
    effect_values values[EFFECT_LIMIT];
    real storage[FIELD_LIMIT][9 * PACK];
} material_point;

#define POINT_TABLE(name) &SOLID_EFFECT(name),
static const effect *const point_effects[SOLID_EFFECTS] = {SOLID_EFFECT_LIST(POINT_TABLE)};

/* A point with one tile of one pack; all lanes hold the same particle of volume 1. Effects named in `mask` are on. */
static inline material_point *point_create(uint32_t mask) {
    material_point *p = aligned_alloc(64, (sizeof *p + 63) / 64 * 64);
    memset(p, 0, sizeof *p);
    for (int e = 0; e < SOLID_EFFECTS; e++) {
        effect_values_default(point_effects[e], &p->values[e]);
        p->values[e].on = mask >> e & 1;
    }
    p->tile = (solid_tile){.pack_count = 1, .count = PACK};
    const int components[] = {3, 3, 9, 9, 1, 1, 1, 3, 3};
    for (int f = 0; f < 9; f++) p->state.fields[f] = (solid_field){.components = components[f], .data = p->storage[f]};
    p->state.field_count = 9;
    p->state.damage_field = 5, p->state.history_field = 6, p->state.fibre_field = 7, p->state.fibre2_field = 8;
    p->state.definition.dx = 1;
    for (int lane = 0; lane < PACK; lane++) {
        p->storage[FIELD_VOLUME][lane] = 1;
        p->storage[7][lane] = 1;
        p->storage[8][PACK + lane] = 1;
        for (int c = 0; c < 3; c++) p->storage[FIELD_DEFORMATION][4 * c * PACK + lane] = 1;
    }
    return p;
}

static inline void point_set(material_point *p, int field, const double *value) {
    for (int c = 0; c < p->state.fields[field].components; c++)
        for (int lane = 0; lane < PACK; lane++) p->storage[field][c * PACK + lane] = value[c];
}

static tile_work point_work(material_point *p, const effect *e, int index, real constants[CONSTANTS], double dt) {
    memset(constants, 0, CONSTANTS * sizeof *constants);
    e->stages->constants(p->values, &p->state.definition, false, constants);
    return (tile_work){.state = &p->state, .tile = &p->tile, .scratch = &p->scratch, .constants = constants,
                       .result = &p->result, .effect = index, .dt = dt};
}

/* g(d), from the effects that are on. */
static inline void point_degrade(material_point *p) {
    real constants[CONSTANTS];
    for (int i = 0; i < PACK; i++) p->scratch.degradation[i] = 1;
    for (int e = 0; e < SOLID_EFFECTS; e++) {
        if (!p->values[e].on || !point_effects[e]->stages->degrade) continue;
        tile_work w = point_work(p, point_effects[e], e, constants, 0);
        point_effects[e]->stages->degrade(&w);
    }
}

/* τ of the effects that are on, as xx yy zz xy yz xz. */
static inline void point_stress(material_point *p, double tau[6]) {
    real constants[CONSTANTS];
    point_degrade(p);
    memset(p->scratch.kirchhoff, 0, sizeof p->scratch.kirchhoff);
    for (int e = 0; e < SOLID_EFFECTS; e++) {
        if (!p->values[e].on || !point_effects[e]->stages->stress) continue;
        tile_work w = point_work(p, point_effects[e], e, constants, 0);
        point_effects[e]->stages->stress(&w);
    }
    for (int c = 0; c < 6; c++) tau[c] = p->scratch.kirchhoff[c * PACK];
}

/* Ψ̂, the energy density: of the PACK identical particles, one. */
static inline double point_energy(material_point *p) {
    real constants[CONSTANTS];
    double total = 0;
    point_degrade(p);
    p->tile.count = 1;
    for (int e = 0; e < SOLID_EFFECTS; e++) {
        if (!p->values[e].on || !point_effects[e]->stages->energy) continue;
        tile_work w = point_work(p, point_effects[e], e, constants, 0);
        point_effects[e]->stages->energy(&w);
        total += w.energy[0] + w.energy[1];
    }
    p->tile.count = PACK;
    return total;
}

/* ρ0 c², the bound that the time step is chosen by. */
static inline double point_wave(material_point *p) {
    real constants[CONSTANTS];
    point_degrade(p);
    memset(p->scratch.wave_tensor, 0, sizeof p->scratch.wave_tensor);
    memset(p->scratch.wave_modulus, 0, sizeof p->scratch.wave_modulus);
    for (int e = 0; e < SOLID_EFFECTS; e++) {
        if (!p->values[e].on || !point_effects[e]->stages->wave) continue;
        tile_work w = point_work(p, point_effects[e], e, constants, 0);
        point_effects[e]->stages->wave(&w);
    }
    return p->scratch.wave_modulus[0] + sym3v_largest(sym3v_scratch(p->scratch.wave_tensor, 0, 0))[0];
}

#endif
