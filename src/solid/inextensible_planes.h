/* What the inextensible solve's passes over blocks of particles (inextensible_blocks.c) and its passes over slots (inextensible.c) share. */
#ifndef SUNDER_SOLID_INEXTENSIBLE_PLANES_H
#define SUNDER_SOLID_INEXTENSIBLE_PLANES_H

#include "solid/inextensible_lanes.h"

/* Planes of cells, [slot][PLANES][BLOCK_NODES]. */
enum { TENSION, WEIGHT, RELAXATION, STRAIN, RESIDUAL, PRECONDITIONER, SEARCH, IMAGE, PRECONDITIONED, PLANES, STARTED = 4 };
/* Before the iterations: Σ V Γ (a · G)² over all nodes, and over what may move. */
enum { PULL = SEARCH, FREE_PULL = IMAGE };

static inline real *plane(const solid *s, int64_t slot, int which) {
    return s->constraint.cells + (slot * PLANES + which) * BLOCK_NODES;
}

static inline real *vectors(const solid *s, int64_t slot) {
    return s->constraint.nodes + slot * BLOCK_NODES * NODE;
}

static inline bool block_is_inextensible(const solid *s, const solid_block *b) {
    for (int32_t t = b->first_tile; t < b->first_tile + b->tile_count; t++)
        if (tile_is_inextensible(s, &s->tiles[t])) return true;
    return false;
}

/* Passes over all blocks with inextensible fibres. Sums into cells and nodes add to what is there. */
typedef enum constraint_sweep_kind {
    SWEEP_START,   /* TENSION, WEIGHT, RELAXATION, STRAIN += Σ V Γ of the particles' */
    SWEEP_SPREAD,  /* node vectors += Bᵀ SEARCH; fourth component += Σ_p w_ip V_p |λ_p|, λ of SEARCH */
    SWEEP_IMAGE,   /* IMAGE += B × node vectors */
    SWEEP_RIGHT,   /* RESIDUAL += the same, and what the STRAIN so far asks for */
    SWEEP_RESPOND, /* PRECONDITIONER, PULL, FREE_PULL += what a tension does; node vectors are normals of holds and Δt/m */
    SWEEP_KEEP,    /* the particles' tension and wave from TENSION and the node vectors' fourth component */
} constraint_sweep_kind;
void constraint_sweep(solid *s, real dt, constraint_sweep_kind kind);

#endif
