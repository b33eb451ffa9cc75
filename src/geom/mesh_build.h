/* How a reader makes a mesh: private to the mesh*.c files. */
#ifndef SUNDER_GEOM_MESH_BUILD_H
#define SUNDER_GEOM_MESH_BUILD_H

#include "geom/mesh.h"

#include <stdbool.h>

/* Further out, squares of lengths would leave the range of numbers in later arithmetic. */
#define MESH_COORDINATE_LIMIT 1e30

/* Whether a coordinate may be kept: finite and within the limit. */
bool mesh_coordinate_ok(double x);

status mesh_add_vertex(mesh *m, const double x[3], report *r);

/* Reads a vertex's three coordinates, words that `next` finds, and adds it; `key` is what messages call it. */
struct text_reader;
struct text_word;
status mesh_read_vertex(struct text_reader *t, bool (*next)(struct text_reader *, struct text_word *), const char *key, mesh *m, report *r);

/* Corners must be indices that fit an int32_t; whether such vertices exist is the reader's business. */
status mesh_add_triangle(mesh *m, int64_t a, int64_t b, int64_t c, report *r);

/* Fills `r`: wrong input at a byte of a binary file. Returns STATUS_INPUT. */
status mesh_wrong_byte(const char *file, size_t byte, const char *expected, const char *found, report *r);

/* The readers. `m` is empty at first and may hold anything after an error: mesh_read frees it. */
status mesh_read_obj(const char *file, const void *data, size_t size, mesh *m, report *r);
status mesh_read_ply(const char *file, const void *data, size_t size, mesh *m, report *r);
status mesh_read_stl(const char *file, const void *data, size_t size, mesh *m, report *r);

#endif
