/* Choices that scenes make and engines obey: shared by the floors on both sides. */
#ifndef SUNDER_EFFECT_KINDS_H
#define SUNDER_EFFECT_KINDS_H

#include <stdbool.h>

/* What a particle's velocity carries between steps (METHOD.md §3). */
typedef enum transfer_kind { TRANSFER_APIC, TRANSFER_RPIC, TRANSFER_PIC, TRANSFER_FLIP } transfer_kind;

/* B-splines. */
typedef enum kernel_kind { KERNEL_QUADRATIC, KERNEL_CUBIC } kernel_kind;

/* What a body is made of: material points on a grid, or linear tetrahedra whose F comes from the mesh. */
typedef enum discretisation_kind { DISCRETISATION_PARTICLES, DISCRETISATION_TETRAHEDRA } discretisation_kind;

/* Where tetrahedra come from: a lattice in any shape, or Gmsh within a triangle mesh. */
typedef enum mesher_kind { MESHER_LATTICE, MESHER_GMSH } mesher_kind;

/* How a source of what diffuses is turned up or down: its rate or held value is multiplied; off, it does nothing. */
typedef struct source_feed {
    double strength;
    bool off;
} source_feed;

#endif
