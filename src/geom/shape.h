/* Shapes as signed distances: negative inside, in scene units.
 *
 * A shape is an immutable tree in an arena; nothing is freed one by one. Constructors return NULL when memory is out,
 * when a child is NULL or when the tree would be deeper than SHAPE_DEPTH_LIMIT (functions on trees recurse), so that a
 * whole expression can be checked once, and assert on sizes that are not positive (the script floor validates them
 * first). Distances are exact for primitives (for meshes: near the surface) and a bound elsewhere: never further from
 * zero than the true distance, which is what lets volumes and samples skip cells far from the surface. */
#ifndef SUNDER_GEOM_SHAPE_H
#define SUNDER_GEOM_SHAPE_H

#include "base/memory.h"
#include "geom/mesh.h"

#include <stdbool.h>

typedef struct shape shape;

enum { SHAPE_DEPTH_LIMIT = 256 };

/* Levels of the tree: 1 for a primitive. Tells a tree that became too deep from memory that ran out. */
int shape_depth(const shape *s);

const shape *shape_sphere(arena *a, const double center[3], double radius);
const shape *shape_box(arena *a, const double minimum[3], const double maximum[3]);
/* A solid cylinder around `axis` (unit vector) through `center`, of the given total length. */
const shape *shape_cylinder(arena *a, const double center[3], const double axis[3], double radius, double length);
/* A cylinder with a coaxial hole (inner may be 0). A taper other than 1 scales both radii linearly to `taper` times at
 * the +axis end. */
const shape *shape_tube(arena *a, const double center[3], const double axis[3], double outer, double inner,
                        double length, double taper);
const shape *shape_capsule(arena *a, const double from[3], const double to[3], double radius);
/* A ring of `major` radius around `axis` with a tube of `minor` radius. Where minor > major the distance inside is a
 * bound. */
const shape *shape_torus(arena *a, const double center[3], const double axis[3], double major, double minor);
/* Everything with normal·(x − point) < 0. Unbounded: shape_bounds gives ±HUGE_VAL, but for the side that it closes when
 * its normal is a coordinate axis. */
const shape *shape_half_space(arena *a, const double point[3], const double normal[3]);
/* The inside of a mesh that mesh_make_solid has accepted; the mesh and its name (for shape_describe) are copied into the
 * arena. The distance is exact near the surface and a bound further off. Pieces that overlap are one solid; a piece
 * turned inward within another is a cavity. */
const shape *shape_mesh(arena *a, const mesh *m, const char *name);
/* children has shape [count], count ≥ 1; copied into the arena. */
const shape *shape_union(arena *a, const shape *const *children, int count);
const shape *shape_intersection(arena *a, const shape *const *children, int count);
/* What is in `base` and in none of `cuts` [count]. */
const shape *shape_difference(arena *a, const shape *base, const shape *const *cuts, int count);
/* x ↦ rotation · (scale · x) + translation; rotation is a 3×3 rotation, row-major. */
const shape *shape_transform(arena *a, const shape *child, const double rotation[9], double scale,
                             const double translation[3]);

/* Signed distance at x. */
double shape_distance(const shape *s, const double x[3]);

/* Outward unit normal (gradient of the distance, central differences of step `h`); (0,0,0) where it vanishes. */
void shape_normal(const shape *s, const double x[3], double h, double normal[3]);

/* An axis-aligned box that holds the shape; components are ±HUGE_VAL where it is unbounded. Where children are seen not
 * to meet it is the origin alone. */
void shape_bounds(const shape *s, double minimum[3], double maximum[3]);

/* Volume by counting cell centres of a lattice with about `cells` cells over the bounding box (0: 2,000,000); cells
 * that the surface crosses count by a smoothed fraction, so that the error is well under 1 % for solid shapes (walls
 * thinner than a cell and oblique to the axes come out too thick). Returns 0 for an unbounded shape. */
double shape_volume(const shape *s, int cells);

/* Whether the shape is a mesh, perhaps moved, and so has triangles of its own. */
bool shape_is_mesh(const shape *s);

/* Those triangles, where they are now; free with mesh_free. Errors: STATUS_SYSTEM out of memory. Only of a shape that is a mesh. */
status shape_triangles(const shape *s, mesh *out, report *r);

/* One line of text that describes the tree, for `explain`: "difference(cylinder r=0.3 l=2, …)". What does not
 * fit ends in an ellipsis. */
void shape_describe(const shape *s, char *text, size_t size);

#endif
