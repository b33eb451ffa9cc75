/* Bodies of linear tetrahedra (solid paper, Fig. 19): the state that the engine of that name keeps.
 *
 * Elements take the place of the particle engine's particles: they lie in packs and tiles, carry F, volume and fibres, and effects' tile stages run on
 * them unchanged. Vertices take the place of nodes: they carry velocity and mass in blocks of BLOCK_NODES, and effects' grid stages run on
 * those. F = Ds Dm⁻¹ comes from the corners' places, never from rates, so it is exact in every state, collapsed and inverted ones included. There is no
 * grid: on one, vertices in the same cells share one velocity field, and a body collapsed to a point could not open again. */
#ifndef SUNDER_SOLID_TETRA_H
#define SUNDER_SOLID_TETRA_H

#include "solid/state.h"

typedef struct tetra {
    solid base; /* first: the engine's table hands it out as the state. Elements are its particles, in order of material; `id` is the element */
    int64_t vertex_count;
    int32_t vertex_blocks;
    double *place;   // [vertex_blocks × BLOCK_NODES][3]; f64 always: edges of a collapsed body cancel
    real *nodes;     // [vertex_blocks × BLOCK_NODES][NODE], velocity and mass
    int32_t *corner; // [pack_count][4][PACK], vertices
    int32_t *row;    // [vertex_count + 1]: corners at vertex v are entry[row[v]] … entry[row[v + 1] − 1]
    int32_t *entry;  // [4 × elements], slot × 4 + corner, ascending: forces are summed in one order
    real *inverse;   // [pack_count][9][PACK], Dm⁻¹
    real *spread;    // [pack_count][PACK], the largest eigenvalue of Σ ∇N ∇Nᵀ
    real *force;     // [pack_count][9][PACK], on corners 1, 2, 3; corner 0 has minus their sum
    real *piola;     // [threads][TILE_PACKS][9][PACK]
} tetra;

/* tetra_load.c: everything from the definition, at time 0. Errors: memory; an element without volume. */
status tetra_load(tetra *m, report *r);
void tetra_free(tetra *m);
/* tetra.c: F, its finiteness and the step limit from where the corners are. */
void tetra_deform(tetra *m);
/* tetra_state.c: as solid_engine says. */
status tetra_measure(const solid *s, solid_measures *out, report *r);
int tetra_read(const solid *s, const char *field, double *out);
int tetra_components(const solid *s, const char *field);
status tetra_save(const solid *s, record_list *list, report *r);
status tetra_restore(solid *s, const record_list *list, report *r);

#endif
