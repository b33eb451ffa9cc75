/* The loop over bonds, for a law to instantiate.
 *
 * A law's file defines  vec bond_law(const real *law, vec s, vec q, vec held, vec *stiffening)  before it includes this: f/c without swelling
 * of rubber, from the stretch s, the mechanical stretch q and the largest q so far; *stiffening is raised to the largest of f′ and f/η where
 * the law is stiffer than c. LAW_HOLDS says whether it needs the largest q, LAW_STIFFENS whether it fills *stiffening. */
#ifndef SUNDER_SHEET_SWEEP_H
#define SUNDER_SHEET_SWEEP_H

#include "sheet/state.h"

/* A pack's own places, and what they gather. */
typedef struct own_place {
    vec high[4], low[4], dilatation;
    vec acceleration[3], stiffening, left;
} own_place;

SIMD_INLINE unsigned lanes_of(vec_mask mask) {
    unsigned lanes = 0;
    for (int i = 0; i < VEC_LANES; i++) lanes |= (unsigned)(mask[i] != 0) << i;
    return lanes;
}

/* How much of the critical stretch is left at θ̄ (METHOD.md §6; η_c goes as √(G/c)). */
SIMD_INLINE vec limit_factor(const body_constants *b, vec theta, vec stiffness_left) {
    vec stretch = vec_max(1 - b->stretch_loss * theta, vec_all(b->floor));
    if (!b->toughness_softens) return stretch;
    return stretch * vec_sqrt(vec_max(1 - b->toughness_loss * theta, vec_all(b->floor)) / stiffness_left);
}

/* What acts now of the bonds to these neighbours: those to faster packs are evaluated at the faster pace. */
SIMD_INLINE vec shares_of(const pack_work *w, const int32_t *index) {
    const uint8_t *level = w->state->rates->level;
    uint8_t own = level[w->pack];
    real lanes[VEC_LANES];
    for (int i = 0; i < VEC_LANES; i++) lanes[i] = w->share[level[index[i] / PACK] > own];
    return vec_load(lanes);
}

/* Adds one slot's bonds. `flags` is a constant where this is inlined. */
SIMD_INLINE void add_slot(const pack_work *w, int64_t at, unsigned flags, own_place *own) {
    sheet *s = w->state;
    const body_constants *b = w->body;
    const int32_t *index = s->neighbour + at;
    vec high[4], low[4], r[3];
    vec_gather4(s->node, index, NODE, high);
    vec_gather4(s->node + NODE_LOW, index, NODE, low);
    for (int c = 0; c < 3; c++) r[c] = (high[c] - own->high[c]) + (low[c] - own->low[c]);
    vec square = vec_fma(r[0], r[0], vec_fma(r[1], r[1], r[2] * r[2]));
    vec length = vec_sqrt(vec_max(square, vec_all((real)1e-30)));
    vec stretch = length * vec_load(s->inverse + at), eta = stretch - 1, q = eta;
    vec stiffness = vec_load(s->stiffness + at), left = vec_all(1), swelling = vec_all(0), theta = vec_all(0);
    if (flags & BOND_FEELS_THETA) {
        theta = (own->high[3] + high[3]) * (real)0.5;
        swelling = b->alpha * theta;
        left = vec_max(1 - b->stiffness_loss * theta, vec_all(b->floor));
        own->left = vec_max(left, own->left);
        if (!b->total) q = eta - swelling;
    }
    if (w->sifted) stiffness = stiffness * shares_of(w, index);
    vec held = q;
    if (LAW_HOLDS) {
        vec before = vec_load(s->history + at);
        held = vec_max(q, before);
        if (w->sifted) held = vec_select(stiffness > 0, held, before);
        vec_store(s->history + at, held);
    }
    if (flags & BOND_FRACTURES) {
        vec limit = vec_load(s->limit + at);
        if (flags & BOND_FEELS_THETA) limit = limit * limit_factor(b, theta, left);
        vec_mask torn = (q > limit) & (stiffness > 0);
        if (vec_any(torn)) {
            sheet_break_bonds(w, at, lanes_of(torn));
            stiffness = vec_select(torn, vec_all(0), stiffness);
        }
    }
    vec force = bond_law(b->law, stretch, q, held, &own->stiffening);
    if (LAW_RUBBERY ? (flags & BOND_FEELS_THETA) != 0 : (flags & BOND_FEELS_THETA) && b->total) force = force - swelling;
    force = force * left;
    if (flags & BOND_STATE) { /* √ of the softening here and √ in the dilatation: the force stays an energy's gradient */
        vec coupling = vec_load(s->coupling + at);
        if (flags & BOND_FEELS_THETA) coupling = coupling * vec_sqrt(left);
        force = vec_fma(coupling, own->dilatation + vec_gather(s->dilatation, index, 1), force);
    }
    vec pull = stiffness * force / length;
    for (int c = 0; c < 3; c++) own->acceleration[c] = vec_fma(pull, r[c], own->acceleration[c]);
}

SIMD_INLINE void sweep_pack(const pack_work *w, unsigned flags) {
    sheet *s = w->state;
    const sheet_pack *pack = &s->packs[w->pack];
    for (int part = 0; part < PACK_PARTS; part++) {
        int first = part * VEC_LANES;
        int32_t self[VEC_LANES];
        for (int i = 0; i < VEC_LANES; i++) self[i] = w->pack * PACK + first + i;
        own_place own = {.stiffening = vec_all(1), .left = vec_all(1)};
        vec_gather4(s->node, self, NODE, own.high);
        vec_gather4(s->node + NODE_LOW, self, NODE, own.low);
        if (flags & BOND_STATE) own.dilatation = vec_load(s->dilatation + (int64_t)w->pack * PACK + first);
        for (int32_t k = 0; k < pack->slots; k++) add_slot(w, ((int64_t)pack->first_slot + k) * PACK + first, flags, &own);
        for (int c = 0; c < 3; c++) {
            real *v = s->velocity + ((int64_t)w->pack * 3 + c) * PACK + first;
            vec_store(v, vec_fma(own.acceleration[c], vec_all(w->dt), vec_load(v)));
        }
        if (LAW_STIFFENS || (flags & BOND_FEELS_THETA)) {
            real most = vec_largest(own.stiffening);
            if (!s->rates) most *= vec_largest(own.left); /* packs with steps of their own are asked for θ before each step */
            if (most > *w->stiffening) *w->stiffening = most;
        }
    }
}

/* The law's `bonds` stage. */
static void sweep(const pack_work *w) {
    switch (w->body->flags) {
    case 0: sweep_pack(w, 0); break;
    case 1: sweep_pack(w, 1); break;
    case 2: sweep_pack(w, 2); break;
    case 3: sweep_pack(w, 3); break;
    case 4: sweep_pack(w, 4); break;
    case 5: sweep_pack(w, 5); break;
    case 6: sweep_pack(w, 6); break;
    default: sweep_pack(w, 7); break;
    }
}
_Static_assert(BOND_COMBINATIONS == 8, "a case for each");

#endif
