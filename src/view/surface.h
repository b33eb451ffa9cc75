/* The surface of a cloud of particles as a closed triangle mesh.
 *
 * The level set of Zhu and Bridson (Animating sand as a fluid, SIGGRAPH 2005, section 5): φ(x) = |x − x̄| − r, x̄ the particles' mean
 * place around x with weights (1 − (d/h)²)³; its zero level by surface nets (Gibson 1998): a vertex in each cell that the level
 * crosses, at the mean of its crossings, and a quadrilateral for each edge of the lattice with a change of sign. No table of cases,
 * and the mesh is closed by construction. Work and memory follow the particles, not their box. */
#ifndef SUNDER_VIEW_SURFACE_H
#define SUNDER_VIEW_SURFACE_H

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

typedef struct view_surface_options {
    float spacing; /* length; of the particles; 0: measured */
    float cell;    /* length; of the lattice; 0: half the spacing */
} view_surface_options;

typedef struct view_surface {
    int64_t vertex_count, triangle_count;
    float *vertex;     /* [vertex_count][3] length */
    float *value;      /* [vertex_count] the particles' quantity, averaged; 0 when there was none */
    int32_t *triangle; /* [triangle_count][3], counter-clockwise seen from outside */
    size_t vertex_capacity, triangle_capacity;
} view_surface;

/* position has shape [count][3], value [count] or NULL; particles that are not finite are left out. Start from a zeroed surface.
 * Errors: STATUS_INPUT for a lattice too fine (over 2^20 cells along an axis, or 2^31 vertices), STATUS_SYSTEM for memory. */
status view_surface_make(const float *position, const float *value, int64_t count, const view_surface_options *options, view_surface *out, report *r);
void view_surface_free(view_surface *surface);

/* The boundary of tetrahedra corner[element_count][4] as triangles over the vertices position[count][3] (all of them are kept). */
status view_surface_tetrahedra(const float *position, const float *value, int64_t count, const int32_t *corner, int64_t element_count, view_surface *out, report *r);

#endif
