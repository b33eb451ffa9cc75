/* Signed distances to a closed mesh: private to the shape*.c and mesh*.c files.
 *
 * The nearest triangle is found in a hierarchy of boxes. The sign does not come from that triangle but from how often
 * the surface lies above the point, each time with its sign (the winding number along a line): right also where pieces
 * overlap or meet in an edge. Lines run along the mesh's shortest side, and the triangles that a line may meet are
 * listed by column. */
#ifndef SUNDER_GEOM_MESH_SOLID_H
#define SUNDER_GEOM_MESH_SOLID_H

#include "geom/mesh.h"

typedef struct mesh_solid mesh_solid;

/* Copies what it needs of a mesh that mesh_make_solid has accepted. NULL when memory is out. */
const mesh_solid *mesh_solid_create(arena *a, const mesh *m);

/* Negative inside. Exact near the surface; further off (two cells of a lattice that follows the number of triangles: 1/6
 * of the mesh's size for a dozen, 1/30 for thousands) a bound, within a tenth of the truth in and around the mesh's box. */
double mesh_solid_distance(const mesh_solid *s, const double x[3]);

/* How far the mesh reaches along a direction: the maximum of x·direction. */
double mesh_solid_support(const mesh_solid *s, const double direction[3]);

int64_t mesh_solid_triangles(const mesh_solid *s);

/* The triangles themselves; free with mesh_free. Errors: memory. */
status mesh_solid_copy(const mesh_solid *s, mesh *out, report *r);

#endif
