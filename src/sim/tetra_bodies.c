/* Bodies of tetrahedra: meshes side by side in one list of vertices and one of elements. */
#include "geom/tetrahedra.h"
#include "sim/bodies.h"

#include <string.h>

static status allocate(body_particles *p, int families, report *r) {
    size_t n = (size_t)p->count, elements = (size_t)p->element_count, row_bytes = 3 * sizeof(double);
    p->position = memory_allocate_array(n, row_bytes);
    p->start = memory_allocate_array(n, row_bytes);
    p->velocity = memory_allocate_array(n, row_bytes);
    p->volume = memory_allocate_array(n, sizeof(double));
    p->body = memory_allocate_array(n, 1);
    p->material = memory_allocate_array(elements, 1);
    p->corner = memory_allocate_array(elements, 4 * sizeof *p->corner);
    if (families > 0) p->fibre1 = memory_allocate_array(elements, row_bytes);
    if (families > 1) p->fibre2 = memory_allocate_array(elements, row_bytes);
    if (p->position && p->start && p->velocity && p->volume && p->body && p->material && p->corner && (families < 1 || p->fibre1) &&
        (families < 2 || p->fibre2))
        return STATUS_OK;
    return report_set(r, STATUS_SYSTEM, "out of memory for %zu tetrahedra", elements);
}

static status fill_vertices(const scene *s, int body, const tetrahedra *t, int64_t first, body_particles *p, report *r) {
    const scene_body *b = &s->bodies[body];
    status code = STATUS_OK;
    memcpy(p->position + 3 * first, t->vertex, (size_t)t->vertex_count * 3 * sizeof *t->vertex);
    memcpy(p->start + 3 * first, t->vertex, (size_t)t->vertex_count * 3 * sizeof *t->vertex);
    for (int64_t i = first; i < first + t->vertex_count && code == STATUS_OK; i++) {
        p->body[i] = (uint8_t)body;
        if (b->start.outputs) code = scene_function_evaluate(&b->start, p->position + 3 * i, 3, p->start + 3 * i, r);
        if (code == STATUS_OK && b->velocity.outputs)
            code = scene_function_evaluate(&b->velocity, p->position + 3 * i, 3, p->velocity + 3 * i, r);
    }
    return code;
}

/* Fibres are those of an element's middle at rest. */
static status fill_elements(const scene *s, int body, const tetrahedra *t, int64_t first_vertex, int64_t first, body_particles *p, report *r) {
    const scene_body *b = &s->bodies[body];
    status code = STATUS_OK;
    for (int64_t i = 0; i < t->count && code == STATUS_OK; i++) {
        double middle[3] = {0, 0, 0}, volume = tetrahedra_determinant(t, i) / 6;
        p->material[first + i] = (uint8_t)b->material;
        for (int k = 0; k < 4; k++) {
            int64_t vertex = t->corner[4 * i + k];
            p->corner[4 * (first + i) + k] = (int32_t)(first_vertex + vertex);
            p->volume[first_vertex + vertex] += 0.25 * volume;
            for (int c = 0; c < 3; c++) middle[c] += 0.25 * t->vertex[3 * vertex + c];
        }
        if (p->fibre1) code = bodies_set_fibres(s, b, middle, p, first + i, r);
    }
    return code;
}

status tetra_bodies_fill(const scene *s, body_particles *out, report *r) {
    tetrahedra meshes[SCENE_BODIES];
    memset(meshes, 0, sizeof meshes);
    status code = STATUS_OK;
    int families = 0;
    for (int b = 0; b < s->body_count && code == STATUS_OK; b++) {
        code = (s->bodies[b].mesher == MESHER_GMSH ? tetrahedra_fill_gmsh : tetrahedra_fill)(s->bodies[b].shape, out->spacing, &meshes[b], r);
        out->count += meshes[b].vertex_count;
        out->element_count += meshes[b].count;
        families = s->bodies[b].fibres.families > families ? s->bodies[b].fibres.families : families;
    }
    if (code == STATUS_OK && out->element_count >= INT32_MAX / 8)
        code = report_input(r, s->file, 0, "particles", "fewer than 2.6e8 tetrahedra", "more", NULL);
    if (code == STATUS_OK) code = allocate(out, families, r);
    int64_t vertices = 0, elements = 0;
    for (int b = 0; b < s->body_count; b++) {
        if (code == STATUS_OK) code = fill_vertices(s, b, &meshes[b], vertices, out, r);
        if (code == STATUS_OK) code = fill_elements(s, b, &meshes[b], vertices, elements, out, r);
        vertices += meshes[b].vertex_count;
        elements += meshes[b].count;
        tetrahedra_free(&meshes[b]);
    }
    if (code != STATUS_OK) bodies_free(out);
    return code;
}
