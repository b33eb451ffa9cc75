#include "sim/sheets.h"

#include "base/memory.h"
#include "base/random.h"
#include "geom/vector.h"
#include "sim/sources.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { DEFAULT_SHEET_PARTICLES = 10000, STREAM_RIPPLE = 0x5c01 };

/* ---- spacing ----------------------------------------------------------------------------------------------------- */

/* A sheet's own spacing; else the scene's dx; else from the particles wanted over all sheets. */
static status choose_spacings(const scene *s, double spacing[SCENE_SHEETS], report *r) {
    double total = 0;
    for (int k = 0; k < s->sheet_count; k++) {
        double area = sheet_area(&s->sheets[k].region);
        if (!(area > 0)) return report_input(r, s->file, 0, s->sheets[k].name, "a sheet with some area: does its plane meet the shape?", "none", NULL);
        total += area;
    }
    double count = s->particles > 0 ? (double)s->particles : DEFAULT_SHEET_PARTICLES;
    for (int k = 0; k < s->sheet_count; k++) {
        const scene_sheet *b = &s->sheets[k];
        double each = b->lattice == SHEET_SAMPLING_HEXAGONAL ? sqrt(0.75) : 1;
        spacing[k] = b->spacing > 0 ? b->spacing : s->particles == 0 && s->dx > 0 ? s->dx : sqrt(total / count / each);
    }
    return STATUS_OK;
}

/* ---- memory ------------------------------------------------------------------------------------------------------ */

static status allocate(sheet_particles *p, bool grain, report *r) {
    size_t n = (size_t)p->count, row = 3 * sizeof(double);
    p->rest = memory_allocate_array(n, row);
    p->position = memory_allocate_array(n, row);
    p->velocity = memory_allocate_array(n, row);
    p->area = memory_allocate_array(n, sizeof(double));
    p->protected = memory_allocate_array(n, 1);
    p->sheet = memory_allocate_array(n, 1);
    if (grain) p->grain = memory_allocate_array(n, row);
    if (p->rest && p->position && p->velocity && p->area && p->protected && p->sheet && (!grain || p->grain)) return STATUS_OK;
    return report_set(r, STATUS_SYSTEM, "out of memory for %zu particles of sheets", n);
}

void sheets_free(sheet_particles *p) {
    size_t n = (size_t)p->count, row = n * 3 * sizeof(double);
    memory_free(p->rest, row);
    memory_free(p->position, row);
    memory_free(p->velocity, row);
    memory_free(p->grain, row);
    memory_free(p->area, n * sizeof(double));
    memory_free(p->protected, n);
    memory_free(p->sheet, n);
    for (int k = 0; k < p->source_count; k++) {
        memory_free((void *)(uintptr_t)p->sources[k].particle, n * sizeof(int32_t));
        memory_free((void *)(uintptr_t)p->sources[k].value, n * sizeof(double));
    }
    *p = (sheet_particles){0};
}

/* ---- particles --------------------------------------------------------------------------------------------------- */

/* The grain in the sheet's plane, of unit length. */
static status set_grain(const scene *s, const scene_sheet *b, sheet_particles *p, int64_t i, report *r) {
    double direction[6] = {1, 0, 0};
    const double *x = p->rest + 3 * i;
    status code = b->grain.families > 0 ? scene_function_evaluate(&b->grain.direction, x, 3, direction, r) : STATUS_OK;
    if (code != STATUS_OK) return code;
    double along = b->region.surface ? 0 : vector_dot(direction, b->region.normal);
    for (int c = 0; c < 3; c++) direction[c] -= along * b->region.normal[c];
    memcpy(p->grain + 3 * i, direction, 3 * sizeof *direction);
    if (vector_normalise(p->grain + 3 * i)) return STATUS_OK;
    char found[128];
    snprintf(found, sizeof found, "none in the sheet's plane at (%.4g, %.4g, %.4g) of sheet '%.40s'", x[0], x[1], x[2], b->name);
    return report_input(r, s->file, 0, "grain", "a direction of some length", found, NULL);
}

static status fill_sheet(const scene *s, int number, const point_set *points, double area, double spacing, sheet_particles *p, report *r) {
    const scene_sheet *b = &s->sheets[number];
    int64_t first = p->bodies[number].first;
    status code = STATUS_OK;
    for (int64_t k = 0; k < points->count && code == STATUS_OK; k++) {
        int64_t i = first + k;
        memcpy(p->rest + 3 * i, points->position + 3 * k, 3 * sizeof(double));
        memcpy(p->position + 3 * i, points->position + 3 * k, 3 * sizeof(double));
        double lift = b->ripple * spacing * (2 * random_unit(s->seed, STREAM_RIPPLE, (uint64_t)i) - 1);
        for (int c = 0; c < 3; c++) p->position[3 * i + c] += lift * b->region.normal[c];
        p->area[i] = area;
        p->sheet[i] = (uint8_t)number;
        p->protected[i] = scene_protects(s, p->rest + 3 * i);
        if (b->velocity.outputs) code = scene_function_evaluate(&b->velocity, p->rest + 3 * i, 3, p->velocity + 3 * i, r);
        if (code == STATUS_OK && p->grain) code = set_grain(s, b, p, i, r);
    }
    return code;
}

/* ---- notches and sources ----------------------------------------------------------------------------------------- */

static status add_notches(const scene *s, int number, sheet_particles *p, report *r) {
    const scene_sheet *b = &s->sheets[number];
    for (int k = 0; k < b->notch_count; k++) {
        if (p->notch_count == SHEET_NOTCHES) return report_input(r, s->file, 0, "notches", "at most 64 notches in a scene", "more", NULL);
        sheet_notch *n = &p->notches[p->notch_count++];
        *n = (sheet_notch){.body = number, .shape = b->notches[k].shape};
        memcpy(n->from, b->notches[k].from, sizeof n->from);
        memcpy(n->to, b->notches[k].to, sizeof n->to);
        memcpy(n->normal, b->region.normal, sizeof n->normal);
    }
    return STATUS_OK;
}

static status fill_source(const scene *s, const scene_source *from, int owner, int stream, sheet_particles *p, report *r) {
    const sheet_body *body = &p->bodies[owner];
    if (p->source_count == SHEET_SOURCES) return report_input(r, s->file, 0, "sources", "at most 64 sources in a scene", "more", NULL);
    int32_t *particle = memory_allocate_array((size_t)p->count, sizeof *particle);
    double *value = memory_allocate_array((size_t)p->count, sizeof *value);
    sheet_source *out = &p->sources[p->source_count++];
    *out = (sheet_source){.particle = particle, .value = value, .fixed = from->fixed, .start = from->start, .stop = from->stop};
    if (!particle || !value) return report_set(r, STATUS_SYSTEM, "out of memory for the sources of a sheet");
    status code = source_evaluate(s, from, stream, s->sheets[owner].name, p->rest + 3 * body->first, body->count, value, r);
    for (int64_t i = 0; i < body->count && code == STATUS_OK; i++) {
        if (isnan(value[i])) continue;
        particle[out->count] = (int32_t)(body->first + i);
        value[out->count++] = value[i];
    }
    return code;
}

status sheets_sample(const scene *s, sheet_particles *out, report *r) {
    double spacing[SCENE_SHEETS] = {0}, area[SCENE_SHEETS] = {0};
    point_set points[SCENE_SHEETS];
    static const sheet_lattice lattices[] = {SHEET_SQUARE, SHEET_HEXAGONAL, SHEET_SCATTERED};
    memset(points, 0, sizeof points);
    memset(out, 0, sizeof *out);
    bool grain = false;
    status code = choose_spacings(s, spacing, r);
    for (int k = 0; k < s->sheet_count && code == STATUS_OK; k++) {
        const scene_sheet *b = &s->sheets[k];
        code = sheet_sample(&b->region, b->lattice, spacing[k], s->seed + (uint64_t)k, &points[k], &area[k], r);
        if (code == STATUS_INPUT && !r->file[0]) snprintf(r->file, sizeof r->file, "%s", s->file);
        out->bodies[k] = (sheet_body){.first = out->count, .count = points[k].count, .material = b->material, .lattice = lattices[b->lattice],
                                      .thickness = b->thickness, .spacing = spacing[k], .radius = b->radius};
        out->count += points[k].count;
        grain |= b->grain.families > 0;
    }
    if (code == STATUS_OK && out->count >= INT32_MAX / 4) code = report_input(r, s->file, 0, "particles", "fewer than 5e8 particles", "more", NULL);
    if (code == STATUS_OK) code = allocate(out, grain, r);
    out->body_count = s->sheet_count;
    out->spacing = spacing[0];
    for (int k = 0; k < s->sheet_count; k++) {
        if (code == STATUS_OK) code = fill_sheet(s, k, &points[k], area[k], spacing[k], out, r);
        if (code == STATUS_OK) code = add_notches(s, k, out, r);
        for (int n = 0; n < s->sheets[k].source_count && code == STATUS_OK; n++)
            code = fill_source(s, &s->sheets[k].sources[n], k, BODY_SOURCES * k + n, out, r);
        point_set_free(&points[k]);
    }
    if (code != STATUS_OK) sheets_free(out);
    return code;
}
