#include "geom/mesh_solid.h"

#include "geom/mesh_far.h"
#include "geom/mesh_tree.h"
#include "geom/vector.h"

#include <string.h>

enum { FAR_CELLS_LEAST = 12, FAR_CELLS_MOST = 64 };

struct mesh_solid {
    mesh_tree tree;
    mesh_columns columns;
    mesh_far far;
    int64_t vertices, triangles;
    double *vertex;    // [vertices][3]
    int32_t *triangle; // [triangles][3]
};

static double exact_distance(const void *context, const double x[3]) {
    const mesh_solid *s = context;
    double distance = mesh_tree_distance(&s->tree, x);
    return mesh_columns_inside(&s->columns, x) ? -distance : distance;
}

/* Cells about as wide as three triangles: within the distances that the samples leave to it, the exact search is fast. */
static bool sample_far(arena *a, mesh_solid *s) {
    double low[3], high[3];
    for (int c = 0; c < 3; c++) {
        low[c] = s->tree.center[c] - s->tree.half[c];
        high[c] = s->tree.center[c] + s->tree.half[c];
    }
    double cells = sqrt((double)s->tree.triangles) / 2.5;
    int wanted = (int)fmin(fmax(cells, FAR_CELLS_LEAST), FAR_CELLS_MOST);
    return mesh_far_create(a, low, high, wanted, exact_distance, s, &s->far);
}

const mesh_solid *mesh_solid_create(arena *a, const mesh *m) {
    mesh_solid *s = arena_allocate(a, sizeof *s);
    if (!s || !mesh_tree_create(a, m, &s->tree) || !mesh_columns_create(a, m, &s->columns)) return NULL;
    size_t bytes = (size_t)m->vertex_count * 3 * sizeof *s->vertex;
    s->vertices = m->vertex_count;
    s->vertex = arena_allocate(a, bytes);
    size_t corners = (size_t)m->triangle_count * 3 * sizeof *s->triangle;
    s->triangles = m->triangle_count;
    s->triangle = arena_allocate(a, corners);
    if (!s->vertex || !s->triangle) return NULL;
    memcpy(s->vertex, m->vertex, bytes);
    memcpy(s->triangle, m->triangle, corners);
    return sample_far(a, s) ? s : NULL;
}

double mesh_solid_distance(const mesh_solid *s, const double x[3]) {
    double distance;
    return mesh_far_distance(&s->far, x, &distance) ? distance : exact_distance(s, x);
}

double mesh_solid_support(const mesh_solid *s, const double direction[3]) {
    double greatest = -HUGE_VAL;
    for (int64_t v = 0; v < s->vertices; v++) greatest = fmax(greatest, vector_dot(s->vertex + 3 * v, direction));
    return greatest;
}

int64_t mesh_solid_triangles(const mesh_solid *s) {
    return s->tree.triangles;
}

status mesh_solid_copy(const mesh_solid *s, mesh *out, report *r) {
    size_t vertices = (size_t)s->vertices, triangles = (size_t)s->triangles;
    *out = (mesh){.vertex = memory_allocate_array(vertices, 3 * sizeof(double)), .triangle = memory_allocate_array(triangles, 3 * sizeof(int32_t))};
    if (out->vertex) out->vertex_count = out->vertex_capacity = s->vertices;
    if (out->triangle) out->triangle_count = out->triangle_capacity = s->triangles;
    if (!out->vertex || !out->triangle) {
        mesh_free(out);
        return report_set(r, STATUS_SYSTEM, "out of memory for a copy of %zu triangles", triangles);
    }
    memcpy(out->vertex, s->vertex, vertices * 3 * sizeof *out->vertex);
    memcpy(out->triangle, s->triangle, triangles * 3 * sizeof *out->triangle);
    return STATUS_OK;
}
