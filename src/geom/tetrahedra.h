/* Filling a shape with tetrahedra. */
#ifndef SUNDER_GEOM_TETRAHEDRA_H
#define SUNDER_GEOM_TETRAHEDRA_H

#include "base/status.h"
#include "geom/shape.h"

#include <stdint.h>

typedef struct tetrahedra {
    int64_t vertex_count, count, vertex_capacity, capacity;
    double *vertex;  // [vertex_count][3], length
    int32_t *corner; // [count][4], right-handed: (x1 − x0) × (x2 − x0) · (x3 − x0) > 0
} tetrahedra;

/* The lattice: cubes of about `edge`, fitted to the shape's box, whose middle lies inside, each cut into five tetrahedra, alternately left and right so that
 * faces meet (Kuhn's six have a grain). A box is filled exactly; elsewhere vertices of the stair-stepped surface move onto the shape's, those that
 * a tetrahedron would suffer from (volume under 0.3 of what it was) excepted. Needs no library. Order depends on (shape, edge)
 * alone. Errors: STATUS_INPUT when the shape is unbounded, holds no cube or too many; STATUS_SYSTEM out of memory; `out` is then empty. */
status tetrahedra_fill(const shape *s, double edge, tetrahedra *out, report *r);

/* Tetrahedra of about `edge` within the triangles of a shape that is a mesh, by Gmsh (Delaunay): the triangles' corners stay, and triangles with sides over
 * 1.5 edges are cut first. Gmsh is loaded when it is first wanted. Errors: STATUS_INPUT for another shape, a mesh that Gmsh cannot fill (it says
 * why: self-intersections), or where Gmsh is not there (with the package's name); STATUS_SYSTEM; `out` is then empty. Not for two threads at
 * once. */
status tetrahedra_fill_gmsh(const shape *s, double edge, tetrahedra *out, report *r);

/* Gmsh's version, or NULL with a report that says what is missing. */
const char *tetrahedra_gmsh_version(report *r);

/* Six times the signed volume of tetrahedron i. */
double tetrahedra_determinant(const tetrahedra *t, int64_t i);

void tetrahedra_free(tetrahedra *t);

#endif
