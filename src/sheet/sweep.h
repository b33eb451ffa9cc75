/* The loop over bonds, for a law to instantiate.
 *
 * A law's file defines  vec bond_law(const real *law, vec s, vec q, vec held, vec *stiffening)  before it includes this: f/c without swelling
 * of rubber, from the stretch s, the mechanical stretch q and the largest q so far; *stiffening is raised to the largest of f′ and f/η where
 * the law is stiffer than c. LAW_HOLDS says whether it needs the largest q, LAW_STIFFENS whether it fills *stiffening. */
#ifndef SUNDER_SHEET_SWEEP_H
#define SUNDER_SHEET_SWEEP_H

#include "sheet/state.h"

/* What a pack's bonds add up to. */
typedef struct bond_sums {
    vec dilatation; /* its own */
    vec acceleration[3], stiffening, left;
} bond_sums;

/* How much of the critical stretch is left at θ̄ (METHOD.md §6; η_c goes as √(G/c)). */
SIMD_INLINE vec limit_factor(const body_constants *b, vec theta, vec stiffness_left) {
    vec stretch = vec_max(1 - b->stretch_loss * theta, vec_all(b->floor));
    if (!b->toughness_softens) return stretch;
    return stretch * vec_sqrt(vec_max(1 - b->toughness_loss * theta, vec_all(b->floor)) / stiffness_left);
}

/* What acts now of the bonds to these neighbours: those to faster packs are evaluated at the faster pace. Few packs have such bonds. */
__attribute__((noinline, cold)) static void find_shares(const pack_work *w, const int32_t *neighbour, real share[VEC_LANES]) {
    const uint8_t *level = w->state->rates->level;
    uint8_t own = level[w->pack];
    for (int i = 0; i < VEC_LANES; i++) share[i] = w->share[level[neighbour[i] / PACK] > own];
}

/* Adds one slot's bonds. `flags` is a constant where this is inlined. */
SIMD_INLINE void add_slot(const pack_work *w, int64_t at, unsigned flags, const own_place *own, bond_sums *sums) {
    sheet *s = w->state;
    const body_constants *b = w->body;
    const int32_t *neighbour = s->neighbour + at;
    vec r[4];
    bond_vector(s, neighbour, own, r);
    vec square = vec_fma(r[0], r[0], vec_fma(r[1], r[1], r[2] * r[2]));
    vec length = vec_sqrt(vec_max(square, vec_all((real)1e-30)));
    vec stretch = length * vec_load(s->inverse + at), eta = stretch - 1, q = eta;
    vec stiffness = vec_load(s->stiffness + at), left = vec_all(1), swelling = vec_all(0), theta = vec_all(0);
    if (w->sifted) {
        real share[VEC_LANES];
        find_shares(w, neighbour, share);
        stiffness = stiffness * vec_load(share);
    }
    vec pull = stiffness / length; /* of a force of 1; early, while the law is worked out */
    if (flags & BOND_FEELS_THETA) {
        theta = r[3] * (real)0.5;
        swelling = b->alpha * theta;
        if (!b->total) q = eta - swelling;
    }
    if (flags & BOND_SOFTENS) {
        left = vec_max(1 - b->stiffness_loss * theta, vec_all(b->floor));
        sums->left = vec_max(left, sums->left);
    }
    vec held = q;
    if (LAW_HOLDS) {
        vec before = vec_load(s->history + at);
        held = vec_max(q, before);
        if (w->sifted) held = vec_select(stiffness > 0, held, before);
        vec_store(s->history + at, held);
    }
    if (flags & BOND_FRACTURES) {
        vec factor = flags & BOND_SOFTENS ? limit_factor(b, theta, left) : vec_all(1);
        if (vec_any((q > b->least_limit * factor) & (stiffness > 0))) {
            vec_mask torn = (q > vec_load(s->limit + at) * factor) & (stiffness > 0);
            if (vec_any(torn)) sheet_break_bonds(w, at, vec_bits(torn));
            pull = vec_select(torn, vec_all(0), pull);
        }
    }
    vec force = bond_law(b->law, stretch, q, held, &sums->stiffening);
    if (LAW_RUBBERY ? (flags & BOND_FEELS_THETA) != 0 : (flags & BOND_FEELS_THETA) && b->total) force = force - swelling;
    if (flags & BOND_SOFTENS) force = force * left;
    if (flags & BOND_STATE) { /* √ of the softening here and √ in the dilatation: the force stays an energy's gradient */
        vec coupling = vec_load(s->coupling + at);
        if (flags & BOND_SOFTENS) coupling = coupling * vec_sqrt(left);
        force = vec_fma(coupling, sums->dilatation + vec_gather(s->dilatation, neighbour, 1), force);
    }
    pull = pull * force;
    for (int c = 0; c < 3; c++) sums->acceleration[c] = vec_fma(pull, r[c], sums->acceleration[c]);
}

SIMD_INLINE void sweep_pack(const pack_work *w, unsigned flags) {
    sheet *s = w->state;
    const sheet_pack *pack = &s->packs[w->pack];
    for (int part = 0; part < PACK_PARTS; part++) {
        int first = part * VEC_LANES;
        own_place own;
        bond_sums sums = {.stiffening = vec_all(1), .left = vec_all(1)};
        own_place_load(s, w->pack, first, &own);
        if (flags & BOND_STATE) sums.dilatation = vec_load(s->dilatation + (int64_t)w->pack * PACK + first);
        int64_t at = (int64_t)pack->first_slot * PACK + first, end = at + (int64_t)pack->slots * PACK;
        for (; at < end; at += PACK) add_slot(w, at, flags, &own, &sums);
        for (int c = 0; c < 3; c++) {
            real *v = s->velocity + ((int64_t)w->pack * 3 + c) * PACK + first;
            vec_store(v, vec_fma(sums.acceleration[c], vec_all(w->dt), vec_load(v)));
        }
        if (LAW_STIFFENS || (flags & BOND_SOFTENS)) {
            real most = vec_largest(sums.stiffening);
            if (!s->rates) most *= vec_largest(sums.left); /* packs with steps of their own are asked for θ before each step */
            if (most > *w->stiffening) *w->stiffening = most;
        }
    }
}

/* The law's `bonds` stage. */
static void sweep(const pack_work *w) {
#define SWEEP_CASE(flags) \
    case flags: sweep_pack(w, flags); break;
    switch (w->body->flags) {
        SWEEP_CASE(0)
        SWEEP_CASE(BOND_FRACTURES)
        SWEEP_CASE(BOND_STATE)
        SWEEP_CASE(BOND_STATE | BOND_FRACTURES)
        SWEEP_CASE(BOND_FEELS_THETA)
        SWEEP_CASE(BOND_FEELS_THETA | BOND_FRACTURES)
        SWEEP_CASE(BOND_FEELS_THETA | BOND_STATE)
        SWEEP_CASE(BOND_FEELS_THETA | BOND_STATE | BOND_FRACTURES)
        SWEEP_CASE(BOND_FEELS_THETA | BOND_SOFTENS)
        SWEEP_CASE(BOND_FEELS_THETA | BOND_SOFTENS | BOND_FRACTURES)
        SWEEP_CASE(BOND_FEELS_THETA | BOND_SOFTENS | BOND_STATE)
        SWEEP_CASE(BOND_FEELS_THETA | BOND_SOFTENS | BOND_STATE | BOND_FRACTURES)
    }
#undef SWEEP_CASE
}

#endif
