#include "view/surface.h"

#include "base/memory.h"
#include "view/canvas.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { AXIS_BITS = 21, AXIS_LIMIT = 1 << 20, REACH_TENTHS = 25 /* kernel radius over spacing, in tenths */ };

/* ---- a table of lattice points ----------------------------------------------------------------------------------- */

/* Points of a lattice (nodes or cells) numbered in the order in which they were first asked for. */
typedef struct lattice {
    uint64_t *keys;  /* [count], in that order */
    int32_t *places; /* [slots] number + 1, 0: empty */
    size_t slots, count, capacity;
} lattice;

static uint64_t key_of(const int64_t at[3]) {
    uint64_t key = 0;
    for (int c = 0; c < 3; c++) key = key << AXIS_BITS | (uint64_t)(at[c] + 8);
    return key;
}

static void point_of(uint64_t key, int64_t at[3]) {
    for (int c = 2; c >= 0; c--, key >>= AXIS_BITS) at[c] = (int64_t)(key & ((1u << AXIS_BITS) - 1)) - 8;
}

static size_t slot_of(const lattice *l, uint64_t key) {
    uint64_t h = (key ^ key >> 31) * 0x9e3779b97f4a7c15u;
    size_t slot = (size_t)(h >> 20) & (l->slots - 1);
    while (l->places[slot] && l->keys[l->places[slot] - 1] != key) slot = (slot + 1) & (l->slots - 1);
    return slot;
}

static bool grow_slots(lattice *l) {
    size_t slots = l->slots ? 2 * l->slots : 1 << 12;
    int32_t *places = memory_allocate_array(slots, sizeof *places);
    if (!places) return false;
    memory_free(l->places, l->slots * sizeof *l->places);
    l->places = places;
    l->slots = slots;
    for (size_t i = 0; i < l->count; i++) l->places[slot_of(l, l->keys[i])] = (int32_t)i + 1;
    return true;
}

static bool grow(void **block, size_t *capacity, size_t needed, size_t size) {
    if (needed <= *capacity) return true;
    size_t next = *capacity ? 2 * *capacity : 1 << 10;
    while (next < needed) next *= 2;
    void *larger = memory_resize(*block, *capacity * size, next * size);
    if (!larger) return false;
    *block = larger;
    *capacity = next;
    return true;
}

/* The number of a point, −1 when it is new to the table. */
static int32_t lattice_find(const lattice *l, const int64_t at[3]) {
    return l->slots ? l->places[slot_of(l, key_of(at))] - 1 : -1;
}

/* The number of a point, made when it is new; −1 when memory is out. */
static int32_t lattice_add(lattice *l, const int64_t at[3]) {
    if (2 * (l->count + 1) > l->slots && !grow_slots(l)) return -1;
    uint64_t key = key_of(at);
    size_t slot = slot_of(l, key);
    if (l->places[slot]) return l->places[slot] - 1;
    if (l->count >= INT32_MAX - 1 || !grow((void **)&l->keys, &l->capacity, l->count + 1, sizeof *l->keys)) return -1;
    l->keys[l->count++] = key;
    l->places[slot] = (int32_t)l->count;
    return (int32_t)l->count - 1;
}

static void lattice_free(lattice *l) {
    memory_free(l->keys, l->capacity * sizeof *l->keys);
    memory_free(l->places, l->slots * sizeof *l->places);
    *l = (lattice){0};
}

/* ---- the level set ----------------------------------------------------------------------------------------------- */

/* Sums over the particles around a node: Σ w, Σ w x, Σ w value. */
typedef struct node_sums {
    double w, x[3], value;
} node_sums;

typedef struct level {
    double origin[3], cell, reach, radius;
    lattice nodes, cells;
    node_sums *sums; /* [nodes.count] */
    size_t sums_capacity;
    double (*crossings)[5]; /* [cells.count] Σ x, Σ value, how many */
    size_t crossings_capacity;
} level;

/* Where |x − x̄| stands half a spacing outside the outermost layer of a cubic lattice with a plane face: layers at depth
 * d = ½, 1½ … spacings weigh ∫ (1 − (ρ² + d²)/h²)³ 2πρ dρ ∝ (1 − d²/h²)⁴. */
static double radius_of(double spacing, double reach) {
    double sum = 0, moment = 0;
    for (double d = 0.5 * spacing; d < reach; d += spacing) {
        double w = pow(1 - d * d / (reach * reach), 4);
        sum += w;
        moment += w * d;
    }
    return moment / sum;
}

static bool add_particle(level *l, const float *x, double value) {
    int64_t low[3], high[3], at[3];
    for (int c = 0; c < 3; c++) {
        low[c] = (int64_t)ceil(((double)x[c] - l->origin[c] - l->reach) / l->cell);
        high[c] = (int64_t)floor(((double)x[c] - l->origin[c] + l->reach) / l->cell);
    }
    for (at[0] = low[0]; at[0] <= high[0]; at[0]++)
        for (at[1] = low[1]; at[1] <= high[1]; at[1]++)
            for (at[2] = low[2]; at[2] <= high[2]; at[2]++) {
                double squared = 0;
                for (int c = 0; c < 3; c++) {
                    double d = l->origin[c] + l->cell * (double)at[c] - (double)x[c];
                    squared += d * d;
                }
                double near = 1 - squared / (l->reach * l->reach);
                if (near <= 0) continue;
                int32_t node = lattice_add(&l->nodes, at);
                if (node < 0 || !grow((void **)&l->sums, &l->sums_capacity, l->nodes.count, sizeof *l->sums)) return false;
                node_sums *s = &l->sums[node];
                double w = near * near * near;
                s->w += w;
                s->value += w * value;
                for (int c = 0; c < 3; c++) s->x[c] += w * (double)x[c];
            }
    return true;
}

/* φ at a node; outside of every particle's reach, one cell outside. */
static double level_at(const level *l, int32_t node, const int64_t at[3]) {
    if (node < 0) return l->cell;
    const node_sums *s = &l->sums[node];
    double squared = 0;
    for (int c = 0; c < 3; c++) {
        double d = l->origin[c] + l->cell * (double)at[c] - s->x[c] / s->w;
        squared += d * d;
    }
    return sqrt(squared) - l->radius;
}

/* ---- surface nets ------------------------------------------------------------------------------------------------ */

static bool push_triangle(view_surface *out, int32_t a, int32_t b, int32_t c) {
    if (!grow((void **)&out->triangle, &out->triangle_capacity, (size_t)out->triangle_count + 1, 3 * sizeof *out->triangle)) return false;
    int32_t *t = out->triangle + 3 * out->triangle_count++;
    t[0] = a, t[1] = b, t[2] = c;
    return true;
}

/* An edge of the lattice from an inside node along ±axis crosses the level at `x`: the four cells around it get a share, and a
 * quadrilateral joins them, turned so that it is seen counter-clockwise from outside. */
static bool add_crossing(level *l, const int64_t at[3], int axis, int way, const double x[3], double value, view_surface *out) {
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    int32_t around[4];
    static const int shift[4][2] = {{-1, -1}, {0, -1}, {0, 0}, {-1, 0}};
    for (int k = 0; k < 4; k++) {
        int64_t cell[3] = {at[0], at[1], at[2]};
        if (way < 0) cell[axis]--;
        cell[u] += shift[k][0];
        cell[v] += shift[k][1];
        int32_t number = lattice_add(&l->cells, cell);
        if (number < 0 || !grow((void **)&l->crossings, &l->crossings_capacity, l->cells.count, sizeof *l->crossings)) return false;
        double *sum = l->crossings[number];
        for (int c = 0; c < 3; c++) sum[c] += x[c];
        sum[3] += value;
        sum[4] += 1;
        around[way > 0 ? k : 3 - k] = number;
    }
    return push_triangle(out, around[0], around[1], around[2]) && push_triangle(out, around[0], around[2], around[3]);
}

static bool cross_edges(level *l, view_surface *out) {
    for (size_t node = 0; node < l->nodes.count; node++) {
        int64_t at[3];
        point_of(l->nodes.keys[node], at);
        double here = level_at(l, (int32_t)node, at);
        if (here >= 0) continue;
        for (int side = 0; side < 6; side++) {
            int axis = side / 2, way = side % 2 ? 1 : -1;
            int64_t next[3] = {at[0], at[1], at[2]};
            next[axis] += way;
            double there = level_at(l, lattice_find(&l->nodes, next), next);
            if (there < 0) continue;
            double x[3];
            for (int c = 0; c < 3; c++) x[c] = l->origin[c] + l->cell * (double)at[c];
            x[axis] += way * l->cell * here / (here - there);
            if (!add_crossing(l, at, axis, way, x, l->sums[node].value / l->sums[node].w, out)) return false;
        }
    }
    return true;
}

static bool settle_vertices(const level *l, view_surface *out) {
    size_t n = l->cells.count;
    out->vertex_capacity = n;
    out->vertex = memory_allocate_array(n, 3 * sizeof *out->vertex);
    out->value = memory_allocate_array(n, sizeof *out->value);
    if (!out->vertex || !out->value) return false;
    for (size_t i = 0; i < n; i++) {
        const double *sum = l->crossings[i];
        for (int c = 0; c < 3; c++) out->vertex[3 * i + (size_t)c] = (float)(sum[c] / sum[4]);
        out->value[i] = (float)(sum[3] / sum[4]);
    }
    out->vertex_count = (int64_t)n;
    return true;
}

/* ---- the whole --------------------------------------------------------------------------------------------------- */

static bool finite_point(const float *x) {
    return isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]);
}

static status place_lattice(level *l, const float *position, int64_t count, report *r) {
    double high[3];
    for (int c = 0; c < 3; c++) l->origin[c] = HUGE_VAL, high[c] = -HUGE_VAL;
    for (int64_t i = 0; i < count; i++) {
        const float *x = position + 3 * i;
        for (int c = 0; c < 3 && finite_point(x); c++) {
            l->origin[c] = fmin(l->origin[c], (double)x[c]);
            high[c] = fmax(high[c], (double)x[c]);
        }
    }
    double margin = l->reach + 2 * l->cell;
    for (int c = 0; c < 3; c++) {
        if (!(l->origin[c] <= high[c])) return report_set(r, STATUS_INPUT, "no particle to make a surface of");
        l->origin[c] -= margin;
        if ((high[c] + margin - l->origin[c]) / l->cell < AXIS_LIMIT) continue;
        char found[64];
        snprintf(found, sizeof found, "%.4g, for a body of %.4g", l->cell, high[c] - l->origin[c]);
        return report_input(r, NULL, 0, "cell", "cells of at least a millionth of the body's length", found, NULL);
    }
    return STATUS_OK;
}

status view_surface_make(const float *position, const float *value, int64_t count, const view_surface_options *options, view_surface *out, report *r) {
    double spacing = options->spacing > 0 ? (double)options->spacing : (double)view_particle_radius(position, count) / 0.75;
    level l = {.cell = options->cell > 0 ? (double)options->cell : spacing / 2, .reach = spacing * REACH_TENTHS / 10};
    *out = (view_surface){0};
    if (!(spacing > 0)) return report_set(r, STATUS_INPUT, "too few particles to tell their spacing: say it");
    l.radius = radius_of(spacing, l.reach);
    status code = place_lattice(&l, position, count, r);
    bool good = true;
    for (int64_t i = 0; i < count && good && code == STATUS_OK; i++)
        if (finite_point(position + 3 * i)) good = add_particle(&l, position + 3 * i, value ? (double)value[i] : 0);
    if (code == STATUS_OK && good) good = cross_edges(&l, out) && settle_vertices(&l, out);
    lattice_free(&l.nodes);
    lattice_free(&l.cells);
    memory_free(l.sums, l.sums_capacity * sizeof *l.sums);
    memory_free(l.crossings, l.crossings_capacity * sizeof *l.crossings);
    if (good && code == STATUS_OK) return STATUS_OK;
    view_surface_free(out);
    return code != STATUS_OK ? code : report_set(r, STATUS_SYSTEM, "out of memory for a surface of %lld particles", (long long)count);
}

void view_surface_free(view_surface *s) {
    memory_free(s->vertex, s->vertex_capacity * 3 * sizeof *s->vertex);
    memory_free(s->value, s->vertex_capacity * sizeof *s->value);
    memory_free(s->triangle, s->triangle_capacity * 3 * sizeof *s->triangle);
    *s = (view_surface){0};
}

/* ---- tetrahedra -------------------------------------------------------------------------------------------------- */

/* A face with its corners in ascending order in front, by which the two sides of an inner face are found to be one. */
typedef struct face {
    int32_t sorted[3], corner[3];
} face;

static int compare_faces(const void *a, const void *b) {
    return memcmp(((const face *)a)->sorted, ((const face *)b)->sorted, sizeof ((const face *)a)->sorted);
}

static face make_face(int32_t a, int32_t b, int32_t c) {
    face f = {{a, b, c}, {a, b, c}};
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < 2; i++)
            if (f.sorted[i] > f.sorted[i + 1]) {
                int32_t swap = f.sorted[i];
                f.sorted[i] = f.sorted[i + 1];
                f.sorted[i + 1] = swap;
            }
    return f;
}

status view_surface_tetrahedra(const float *position, const float *value, int64_t count, const int32_t *corner, int64_t element_count, view_surface *out, report *r) {
    static const int sides[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}; /* outward where the volume is positive */
    size_t faces = 4 * (size_t)element_count, n = (size_t)count;
    face *all = memory_allocate_array(faces, sizeof *all);
    *out = (view_surface){.vertex_capacity = n, .vertex_count = count};
    out->vertex = memory_allocate_array(n, 3 * sizeof *out->vertex);
    out->value = memory_allocate_array(n, sizeof *out->value);
    bool good = all && out->vertex && out->value;
    for (size_t i = 0; i < faces && good; i++) {
        const int32_t *c = corner + 4 * (i / 4);
        const int *side = sides[i % 4];
        all[i] = make_face(c[side[0]], c[side[1]], c[side[2]]);
    }
    if (good && faces > 0) qsort(all, faces, sizeof *all, compare_faces);
    for (size_t i = 0; i < faces && good;) {
        size_t same = 1;
        while (i + same < faces && compare_faces(&all[i], &all[i + same]) == 0) same++;
        if (same == 1) good = push_triangle(out, all[i].corner[0], all[i].corner[1], all[i].corner[2]);
        i += same;
    }
    if (good) memcpy(out->vertex, position, n * 3 * sizeof *out->vertex);
    if (good && value) memcpy(out->value, value, n * sizeof *out->value);
    memory_free(all, faces * sizeof *all);
    if (good) return STATUS_OK;
    view_surface_free(out);
    return report_set(r, STATUS_SYSTEM, "out of memory for the surface of %lld tetrahedra", (long long)element_count);
}
