/* From a scene's bodies to arrays of particles. */
#ifndef SUNDER_SIM_BODIES_H
#define SUNDER_SIM_BODIES_H

#include "sim/scene.h"
#include "solid/solid.h"

/* Particles of all bodies, in the order of bodies and of sampling; the index is the particle's id for ever. */
typedef struct body_particles {
    int64_t count;
    double dx, spacing;
    double *position, *velocity; // [count][3]
    double *volume;              // [count]
    double *fibre1, *fibre2;     // [count][3], NULL when no body has that family
    double *damage;              // [count], 1 inside a notch, else 0; NULL when no body has notches
    int given_count;
    const char *given_field[SOLID_GIVEN];
    double *given[SOLID_GIVEN];  // [count], what a parameter that varies in place is to its material's
    int source_count;
    solid_source sources[SOLID_SOURCES]; /* with arrays of their own, [count] of the source */
    uint8_t *material, *body;    // [count]; material index, plus the number of materials where a grip protects the particle
    /* Bodies of tetrahedra: particles are vertices; fibres and materials are the elements', [element_count]. */
    int64_t element_count; // 0: particles
    int32_t *corner;       // [element_count][4]
    double *start;         // [count][3], places at time 0
} body_particles;

/* The fibres at rest place x of body b into row i of those that there are. Errors: a direction that is zero, with the place; the function's own. */
status bodies_set_fibres(const scene *s, const scene_body *b, const double x[3], body_particles *p, int64_t i, report *r);

/* Fills the bodies with tetrahedra of the edge out->spacing (tetra_bodies.c). Errors as bodies_sample. */
status tetra_bodies_fill(const scene *s, body_particles *out, report *r);

/* Frees what only an engine needs, once it has copied it: rest positions, bodies and notches stay for the measures. */
void bodies_free_loading(body_particles *p);

/* Samples everything. Errors: a parameter that varies out of its range (with the place), a body without volume or particles, a fibre direction that is zero (with the place), notches
 * that hold no particle, memory. */
status bodies_sample(const scene *s, body_particles *out, report *r);
void bodies_free(body_particles *p);

#endif
