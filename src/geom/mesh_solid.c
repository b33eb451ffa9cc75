#include "geom/mesh_solid.h"

#include "geom/mesh_tree.h"
#include "geom/vector.h"

#include <string.h>

struct mesh_solid {
    mesh_tree tree;
    mesh_columns columns;
    int64_t vertices;
    double *vertex; // [vertices][3]
};

const mesh_solid *mesh_solid_create(arena *a, const mesh *m) {
    mesh_solid *s = arena_allocate(a, sizeof *s);
    if (!s || !mesh_tree_create(a, m, &s->tree) || !mesh_columns_create(a, m, &s->columns)) return NULL;
    size_t bytes = (size_t)m->vertex_count * 3 * sizeof *s->vertex;
    s->vertices = m->vertex_count;
    s->vertex = arena_allocate(a, bytes);
    if (!s->vertex) return NULL;
    memcpy(s->vertex, m->vertex, bytes);
    return s;
}

double mesh_solid_distance(const mesh_solid *s, const double x[3]) {
    double distance = mesh_tree_distance(&s->tree, x);
    return mesh_columns_inside(&s->columns, x) ? -distance : distance;
}

double mesh_solid_support(const mesh_solid *s, const double direction[3]) {
    double greatest = -HUGE_VAL;
    for (int64_t v = 0; v < s->vertices; v++) greatest = fmax(greatest, vector_dot(s->vertex + 3 * v, direction));
    return greatest;
}

int64_t mesh_solid_triangles(const mesh_solid *s) {
    return s->tree.triangles;
}
