/* The two halves of a mesh_solid: the hierarchy of boxes (mesh_tree.c) and the columns (mesh_columns.c). */
#ifndef SUNDER_GEOM_MESH_TREE_H
#define SUNDER_GEOM_MESH_TREE_H

#include "geom/mesh.h"

#include <stdbool.h>

enum { TREE_WIDTH = 4, TREE_LEAF = 4 };

/* The same thing of four boxes. */
typedef float tree_four __attribute__((vector_size(TREE_WIDTH * sizeof(float))));

/* Up to four boxes, in single precision and in units of the tree's `unit` from its center: widened by more than the
 * rounding, so that a box never seems further away than it is. */
typedef struct tree_branch {
    tree_four low[3], high[3];
    int32_t child[TREE_WIDTH]; /* a branch, or where count > 0 the first of that many triangles */
    int32_t count[TREE_WIDTH]; /* 0: a branch; −1: nothing */
} tree_branch;

typedef struct mesh_tree {
    double center[3], half[3], unit; /* of the mesh's box; unit: half its diagonal */
    int64_t triangles;
    tree_branch *branch;
    double (*corner)[3][3]; // [triangles]: a corner and the edges to the two others, in the order of the leaves
} mesh_tree;

/* False when memory is out. */
bool mesh_tree_create(arena *a, const mesh *m, mesh_tree *out);

/* The distance from a point within some thousands of units to the nearest triangle, ≥ 0. */
double mesh_tree_distance(const mesh_tree *t, const double x[3]);

/* A triangle as a column sees it: across the lines in whole numbers, along them as it is. */
typedef struct column_triangle {
    int32_t u[3], v[3];
    double w[3];
} column_triangle;

typedef struct mesh_columns {
    int axis[3];                /* u, v across the lines, w along them */
    double low[3], high[3];     /* of the mesh, by u, v, w */
    double scale;               /* whole numbers a length */
    double wide[2];             /* columns a whole number */
    int32_t count[2];
    int32_t *first;             // [count[0] × count[1] + 1] into item
    int32_t *item;              // triangles of each column
    column_triangle *triangle;
} mesh_columns;

bool mesh_columns_create(arena *a, const mesh *m, mesh_columns *out);

/* Whether the surface winds around x. */
bool mesh_columns_inside(const mesh_columns *c, const double x[3]);

#endif
