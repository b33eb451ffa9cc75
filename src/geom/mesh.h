/* Triangle meshes: read from files, welded, inspected, and made fit to bound a solid. */
#ifndef SUNDER_GEOM_MESH_H
#define SUNDER_GEOM_MESH_H

#include "base/memory.h"
#include "base/status.h"

#include <stdint.h>

typedef struct mesh {
    int64_t vertex_count, vertex_capacity;
    int64_t triangle_count, triangle_capacity;
    double *vertex;    // [vertex_count][3], length
    int32_t *triangle; // [triangle_count][3], indices of vertices, counter-clockwise as seen from outside
} mesh;

typedef enum mesh_orientation {
    MESH_OUTWARD, /* neighbours agree, and the volume is positive */
    MESH_INWARD,  /* neighbours agree, and the volume is not */
    MESH_MIXED,   /* somewhere two neighbours disagree */
} mesh_orientation;

/* What a mesh is like. Edges are counted once, whatever the number of triangles on them. */
typedef struct mesh_report {
    int64_t vertices, triangles;
    double minimum[3], maximum[3];
    int64_t boundary_edges;    /* of one triangle */
    int64_t holes;             /* pieces that the boundary edges form */
    int64_t nonmanifold_edges; /* of three triangles or more */
    int64_t unpaired_edges;    /* of three or more, not as often run one way as the other: no side of them is inside */
    int64_t opposed_edges;     /* of two triangles that disagree about which side is outside */
    int64_t components;        /* pieces joined by edges */
    double volume;             /* enclosed; meaningful for closed meshes that are not MESH_MIXED */
    mesh_orientation orientation;
    double hole_at[3], unpaired_at[3]; /* the middle of one such edge */
} mesh_report;

/* Reads an OBJ, PLY (ASCII or binary) or STL (ASCII or binary) mesh, told apart by the ending of `file`, which also
 * names it in messages. Polygons become fans. Vertices that coincide (within 1e-6 of the mesh's size) become one,
 * triangles that thereby lose a corner and vertices that no triangle uses are left out. Errors: STATUS_INPUT with file
 * and line, or file and byte; STATUS_SYSTEM when memory is out; `out` is then empty. Free with mesh_free. */
status mesh_read(const char *file, const void *data, size_t size, mesh *out, report *r);

void mesh_free(mesh *m);

/* Counts and measures. STATUS_SYSTEM when memory is out. */
status mesh_inspect(const mesh *m, mesh_report *out, report *r);

/* Turns triangles so that neighbours agree (within each piece as most of its triangles have it) and the volume is
 * positive; `turned` tells how many. Errors: STATUS_INPUT when there is no such way (a one-sided surface), STATUS_SYSTEM
 * when memory is out. */
status mesh_orient(const char *file, mesh *m, int64_t *turned, report *r);

/* Orients the mesh and makes sure that it bounds a solid. Errors: STATUS_INPUT when it is open (the number of holes, and
 * where one is), has edges with no inside, or encloses nothing; STATUS_SYSTEM. `facts` describes the mesh as it is now. */
status mesh_make_solid(const char *file, mesh *m, mesh_report *facts, report *r);

/* Cuts triangles until no side is longer than `longest`: the surface stays what it is, neighbours agree. Errors: STATUS_INPUT when that gives too many
 * triangles, STATUS_SYSTEM; the mesh is then as far as it came. */
status mesh_cut_long_sides(mesh *m, double longest, report *r);

/* x ↦ rotation · (scale · x) + translation for every vertex; rotation is row-major. */
void mesh_transform(mesh *m, const double rotation[9], double scale, const double translation[3]);

#endif
