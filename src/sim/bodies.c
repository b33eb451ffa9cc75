#include "sim/bodies.h"

#include "base/memory.h"
#include "geom/fibres.h"
#include "sim/sources.h"
#include "sim/variations.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { DEFAULT_PARTICLES = 50000 };

/* Grid spacing and particle spacing from what the scene says: particles, dx, both or neither. */
static status choose_spacing(const scene *s, double volumes[SCENE_BODIES], body_particles *out, report *r) {
    double total = 0;
    for (int b = 0; b < s->body_count; b++) {
        volumes[b] = shape_volume(s->bodies[b].shape, 0);
        if (!(volumes[b] > 0)) return report_input(r, s->file, 0, s->bodies[b].name, "a body with some volume", "none", NULL);
        total += volumes[b];
    }
    double count = s->particles > 0 ? (double)s->particles : DEFAULT_PARTICLES;
    if (s->particles == 0 && s->dx > 0) count = total * s->particles_per_cell / (s->dx * s->dx * s->dx);
    if (!(count < 5e8)) return report_input(r, s->file, 0, "dx", "a grid spacing that gives under 5e8 particles", "a smaller one", NULL);
    out->spacing = cbrt(total / count);
    out->dx = s->dx > 0 ? s->dx : cbrt(s->particles_per_cell) * out->spacing;
    return STATUS_OK;
}

static status allocate(body_particles *p, bool fibre1, bool fibre2, bool notched, report *r) {
    size_t n = (size_t)p->count, row_bytes = 3 * sizeof(double);
    p->position = memory_allocate_array(n, row_bytes);
    p->velocity = memory_allocate_array(n, row_bytes);
    p->volume = memory_allocate_array(n, sizeof(double));
    p->material = memory_allocate_array(n, 1);
    p->body = memory_allocate_array(n, 1);
    if (fibre1) p->fibre1 = memory_allocate_array(n, row_bytes);
    if (fibre2) p->fibre2 = memory_allocate_array(n, row_bytes);
    if (notched) p->damage = memory_allocate_array(n, sizeof(double));
    if (p->position && p->velocity && p->volume && p->material && p->body && (!fibre1 || p->fibre1) && (!fibre2 || p->fibre2) &&
        (!notched || p->damage))
        return STATUS_OK;
    bodies_free(p);
    return report_set(r, STATUS_SYSTEM, "out of memory for %lld particles", (long long)n);
}

static void free_given(body_particles *p) {
    for (int g = 0; g < p->given_count; g++) memory_free(p->given[g], p->given[g] ? (size_t)p->count * sizeof(double) : 0);
    p->given_count = 0;
}

void bodies_free_loading(body_particles *p) {
    size_t n = (size_t)p->count, owners = p->element_count ? (size_t)p->element_count : n, row_bytes = 3 * sizeof(double) * n;
    memory_free(p->velocity, row_bytes);
    memory_free(p->start, row_bytes);
    memory_free(p->volume, n * sizeof(double));
    memory_free(p->material, owners);
    memory_free(p->fibre1, 3 * sizeof(double) * owners);
    memory_free(p->fibre2, 3 * sizeof(double) * owners);
    p->velocity = p->start = p->volume = p->fibre1 = p->fibre2 = NULL;
    p->material = NULL;
    free_given(p);
}

void bodies_free(body_particles *p) {
    size_t n = (size_t)p->count;
    bodies_free_loading(p);
    memory_free(p->position, 3 * sizeof(double) * n);
    memory_free(p->body, n);
    memory_free(p->corner, 4 * sizeof(int32_t) * (size_t)p->element_count);
    memory_free(p->damage, n * sizeof(double));
    for (int k = 0; k < p->source_count; k++)
        memory_free((void *)(uintptr_t)p->sources[k].value, (size_t)p->sources[k].count * sizeof(double));
    memset(p, 0, sizeof *p);
}

status bodies_set_fibres(const scene *s, const scene_body *b, const double x[3], body_particles *p, int64_t i, report *r) {
    double direction[6] = {1, 0, 0, 0, 1, 0};
    if (b->fibres.families > 0) {
        memset(direction + 3, 0, 3 * sizeof *direction);
        status code = scene_function_evaluate(&b->fibres.direction, x, 3, direction, r);
        if (code != STATUS_OK) return code;
    }
    if (!fibres_orthonormalise(direction, direction + 3)) {
        char found[128];
        snprintf(found, sizeof found, "none at (%.4g, %.4g, %.4g) of body '%.40s'", x[0], x[1], x[2], b->name);
        return report_input(r, s->file, 0, "fibres", "a direction of some length", found, NULL);
    }
    if (p->fibre1) memcpy(p->fibre1 + 3 * i, direction, 3 * sizeof *direction);
    if (p->fibre2) memcpy(p->fibre2 + 3 * i, direction + 3, 3 * sizeof *direction);
    return STATUS_OK;
}

/* Breaks what lies in a body's notches. Notches that catch nothing would be silently no notches. */
static status cut_notches(const scene *s, const scene_body *b, int64_t first, int64_t count, body_particles *p, report *r) {
    int64_t caught = 0;
    for (int64_t i = first; i < first + count; i++)
        if (shape_distance(b->notches, p->position + 3 * i) < 0) p->damage[i] = 1, caught++;
    if (caught > 0) return STATUS_OK;
    char found[160];
    snprintf(found, sizeof found, "none in body '%.48s' (the particles are %.3g apart)", b->name, p->spacing);
    return report_input(r, s->file, 0, "notches", "shapes with some of the body's particles inside", found, NULL);
}

static status fill_body(const scene *s, int body, const point_set *points, double volume, int64_t first, body_particles *p, report *r) {
    const scene_body *b = &s->bodies[body];
    status code = STATUS_OK;
    for (int64_t k = 0; k < points->count && code == STATUS_OK; k++) {
        int64_t i = first + k;
        memcpy(p->position + 3 * i, points->position + 3 * k, 3 * sizeof(double));
        p->volume[i] = volume / (double)points->count;
        p->body[i] = (uint8_t)body;
        p->material[i] = (uint8_t)(b->material + (scene_protects(s, p->position + 3 * i) ? s->material_count : 0));
        if (b->velocity.outputs) code = scene_function_evaluate(&b->velocity, p->position + 3 * i, 3, p->velocity + 3 * i, r);
        if (code == STATUS_OK && p->fibre1) code = bodies_set_fibres(s, b, p->position + 3 * i, p, i, r);
    }
    if (code == STATUS_OK && b->notches) code = cut_notches(s, b, first, points->count, p, r);
    return code;
}

static status fill_sources(const scene *s, int body, int64_t first, int64_t count, body_particles *p, report *r) {
    const scene_body *b = &s->bodies[body];
    status code = STATUS_OK;
    for (int k = 0; k < b->source_count && code == STATUS_OK; k++) {
        const scene_source *from = &b->sources[k];
        if (p->source_count == SOLID_SOURCES) return report_input(r, s->file, 0, "sources", "at most 64 sources in a scene", "more", NULL);
        double *value = memory_allocate_array((size_t)count, sizeof *value);
        if (!value) return report_set(r, STATUS_SYSTEM, "out of memory for the sources of a body");
        p->sources[p->source_count++] =
            (solid_source){.first = first, .count = count, .value = value, .fixed = from->fixed, .start = from->start, .stop = from->stop};
        code = source_evaluate(s, from, BODY_SOURCES * (SCENE_SHEETS + body) + k, b->name, p->position + 3 * first, count, value, r);
    }
    return code;
}

status bodies_sample(const scene *s, body_particles *out, report *r) {
    double volumes[SCENE_BODIES];
    point_set points[SCENE_BODIES];
    memset(points, 0, sizeof points);
    memset(out, 0, sizeof *out);
    status code = choose_spacing(s, volumes, out, r);
    if (code == STATUS_OK && scene_is_tetrahedra(s)) {
        out->dx = out->spacing = s->dx > 0 ? s->dx : out->spacing;
        return tetra_bodies_fill(s, out, r);
    }
    int families = 0;
    bool notched = false;
    for (int b = 0; b < s->body_count && code == STATUS_OK; b++) {
        code = shape_sample(s->bodies[b].shape, s->bodies[b].sampling, out->spacing, s->seed, &points[b], r);
        out->count += points[b].count;
        families = s->bodies[b].fibres.families > families ? s->bodies[b].fibres.families : families;
        notched = notched || s->bodies[b].notches;
    }
    if (code == STATUS_OK && out->count >= INT32_MAX / 2)
        code = report_input(r, s->file, 0, "particles", "fewer than 1e9 particles", "more", NULL);
    if (code == STATUS_OK) code = allocate(out, families > 0, families > 1, notched, r);
    else out->count = 0;
    int64_t first = 0;
    for (int b = 0; b < s->body_count; b++) {
        if (code == STATUS_OK) code = fill_body(s, b, &points[b], volumes[b], first, out, r);
        if (code == STATUS_OK) code = fill_sources(s, b, first, points[b].count, out, r);
        first += points[b].count;
        point_set_free(&points[b]);
    }
    if (code == STATUS_OK) code = variations_evaluate(s, out, r);
    if (code != STATUS_OK) bodies_free(out);
    return code;
}
