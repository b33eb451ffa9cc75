/* Particles on surfaces. */
#include "geom/sampling_sheet.h"

#include "base/random.h"
#include "geom/sampling_cells.h"
#include "geom/vector.h"

#include <math.h>
#include <string.h>

enum { STREAM_SHEET = 0x5b01, AREA_CELLS = 600, DRAWS = 40 };

static const double POINT_LIMIT = 2e8, APART = 0.8;

/* Two unit vectors in the plane of `normal`, right-handed with it: the first is x, or y where the normal is x, laid into the plane. */
static void plane_axes(const double normal[3], double first[3], double second[3]) {
    double along = normal[0];
    for (int c = 0; c < 3; c++) first[c] = (c == 0) - along * normal[c];
    if (fabs(along) > 0.9)
        for (int c = 0; c < 3; c++) first[c] = (c == 1) - normal[1] * normal[c];
    (void)vector_normalise(first);
    vector_cross(normal, first, second);
}

/* The region's extent along the plane's axes, from the corners of the shape's bounds. */
typedef struct extent {
    double first[3], second[3], origin[3], low[2], high[2];
} extent;

static bool measure_extent(const sheet_region *region, extent *e) {
    double minimum[3], maximum[3];
    shape_bounds(region->shape, minimum, maximum);
    for (int c = 0; c < 3; c++)
        if (!isfinite(minimum[c]) || !isfinite(maximum[c])) return false;
    plane_axes(region->normal, e->first, e->second);
    memcpy(e->origin, region->point, sizeof e->origin);
    for (int a = 0; a < 2; a++) e->low[a] = HUGE_VAL, e->high[a] = -HUGE_VAL;
    for (int corner = 0; corner < 8; corner++) {
        double x[3];
        for (int c = 0; c < 3; c++) x[c] = (corner >> c & 1 ? maximum[c] : minimum[c]) - e->origin[c];
        double at[2] = {vector_dot(x, e->first), vector_dot(x, e->second)};
        for (int a = 0; a < 2; a++) e->low[a] = fmin(e->low[a], at[a]), e->high[a] = fmax(e->high[a], at[a]);
    }
    return true;
}

static void place_at(const extent *e, double u, double v, double x[3]) {
    for (int c = 0; c < 3; c++) x[c] = e->origin[c] + u * e->first[c] + v * e->second[c];
}

static double planar_area(const sheet_region *region, const extent *e) {
    double cell[2], count = 0, x[3];
    for (int a = 0; a < 2; a++) cell[a] = (e->high[a] - e->low[a]) / AREA_CELLS;
    for (int i = 0; i < AREA_CELLS; i++)
        for (int j = 0; j < AREA_CELLS; j++) {
            place_at(e, e->low[0] + (i + 0.5) * cell[0], e->low[1] + (j + 0.5) * cell[1], x);
            count += shape_distance(region->shape, x) < 0;
        }
    return count * cell[0] * cell[1];
}

/* A counted point of the box around a shape, and whether it lies within `reach` of the surface. */
static bool draw_near(const shape *s, const double minimum[3], const double maximum[3], double reach, uint64_t seed, uint64_t counter, double x[3]) {
    for (int c = 0; c < 3; c++)
        x[c] = minimum[c] - reach + (maximum[c] - minimum[c] + 2 * reach) * random_unit(seed, STREAM_SHEET + (uint64_t)c, counter);
    return fabs(shape_distance(s, x)) < reach;
}

/* Steps along the distance's gradient to the surface. */
static void project(const shape *s, double reach, double x[3]) {
    for (int step = 0; step < 8; step++) {
        double n[3], d = shape_distance(s, x);
        shape_normal(s, x, 1e-3 * reach, n);
        for (int c = 0; c < 3; c++) x[c] -= d * n[c];
    }
}

/* Volume of a thin layer on both sides over its thickness. */
static double curved_area(const shape *s) {
    double minimum[3], maximum[3], volume = 1, size = 0, x[3];
    shape_bounds(s, minimum, maximum);
    for (int c = 0; c < 3; c++) size = fmax(size, maximum[c] - minimum[c]);
    double reach = 0.01 * size;
    for (int c = 0; c < 3; c++) volume *= maximum[c] - minimum[c] + 2 * reach;
    enum { TRIES = 1000000 };
    double hits = 0;
    for (uint64_t k = 0; k < TRIES; k++) hits += draw_near(s, minimum, maximum, reach, 1, k, x);
    return hits / TRIES * volume / (2 * reach);
}

double sheet_area(const sheet_region *region) {
    extent e;
    if (!measure_extent(region, &e)) return 0;
    return region->surface ? curved_area(region->shape) : planar_area(region, &e);
}

static status sample_lattice(const sheet_region *region, const extent *e, bool hexagonal, double spacing, point_set *points, report *r) {
    double rise = hexagonal ? sqrt(0.75) * spacing : spacing, middle[2], x[3];
    int64_t half[2];
    for (int a = 0; a < 2; a++) {
        double width = e->high[a] - e->low[a], step = a ? rise : spacing;
        middle[a] = 0.5 * (e->low[a] + e->high[a]);
        half[a] = (int64_t)fmax(1, round(width / step)); /* cells over the region */
    }
    for (int64_t j = -1; j <= half[1]; j++)
        for (int64_t i = -1; i <= half[0]; i++) {
            double shift = hexagonal ? (j % 2 ? 0.25 : -0.25) : 0;
            place_at(e, middle[0] + ((double)i + 0.5 + shift - 0.5 * (double)half[0]) * spacing, middle[1] + ((double)j + 0.5 - 0.5 * (double)half[1]) * rise, x);
            if (shape_distance(region->shape, x) >= 0) continue;
            status code = point_set_add(points, x, r);
            if (code != STATUS_OK) return code;
        }
    return STATUS_OK;
}

/* Points kept so far by cell, so that those too near a new one are found. */
typedef struct near_table {
    int64_t capacity, next_capacity;
    int32_t *head, *next;
    double size;
} near_table;

static int64_t near_slot(const near_table *t, const int64_t cell[3]) {
    return (int64_t)(cell_key(cell) & (uint64_t)(t->capacity - 1));
}

static bool is_free(const near_table *t, const point_set *points, const double x[3]) {
    for (int k = 0; k < 27; k++) {
        int64_t cell[3] = {(int64_t)floor(x[0] / t->size) + k / 9 - 1, (int64_t)floor(x[1] / t->size) + k / 3 % 3 - 1,
                           (int64_t)floor(x[2] / t->size) + k % 3 - 1};
        for (int32_t p = t->head[near_slot(t, cell)]; p >= 0; p = t->next[p]) {
            double difference[3];
            vector_subtract(points->position + 3 * p, x, difference);
            if (vector_dot(difference, difference) < t->size * t->size) return false;
        }
    }
    return true;
}

static status keep(near_table *t, point_set *points, const double x[3], report *r) {
    int64_t cell[3];
    for (int c = 0; c < 3; c++) cell[c] = (int64_t)floor(x[c] / t->size);
    if (points->count == t->next_capacity) return STATUS_OK; /* full: more than could fit */
    status code = point_set_add(points, x, r);
    if (code != STATUS_OK) return code;
    int64_t slot = near_slot(t, cell);
    t->next[points->count - 1] = t->head[slot];
    t->head[slot] = (int32_t)(points->count - 1);
    return STATUS_OK;
}

static status throw_darts(const sheet_region *region, const extent *e, double spacing, double area, uint64_t seed, near_table *t, point_set *points, report *r) {
    double minimum[3], maximum[3], box = (e->high[0] - e->low[0]) * (e->high[1] - e->low[1]), reach = 0.25 * spacing, x[3];
    shape_bounds(region->shape, minimum, maximum);
    double layer = 2 * reach * area, volume = 1;
    for (int c = 0; c < 3; c++) volume *= maximum[c] - minimum[c] + 2 * reach;
    uint64_t draws = (uint64_t)(DRAWS * area / (spacing * spacing) * (region->surface ? volume / layer : box / area));
    for (uint64_t k = 0; k < draws; k++) {
        if (region->surface) {
            if (!draw_near(region->shape, minimum, maximum, reach, seed, k, x)) continue;
            project(region->shape, reach, x);
        } else {
            place_at(e, e->low[0] + (e->high[0] - e->low[0]) * random_unit(seed, STREAM_SHEET, k),
                     e->low[1] + (e->high[1] - e->low[1]) * random_unit(seed, STREAM_SHEET + 1, k), x);
            if (shape_distance(region->shape, x) >= 0) continue;
        }
        if (!is_free(t, points, x)) continue;
        status code = keep(t, points, x, r);
        if (code != STATUS_OK) return code;
    }
    return STATUS_OK;
}

static status sample_poisson(const sheet_region *region, const extent *e, double spacing, double area, uint64_t seed, point_set *points, report *r) {
    near_table t = {.capacity = 1024, .next_capacity = (int64_t)(4 * area / (spacing * spacing)) + 16, .size = APART * spacing};
    while (t.capacity < t.next_capacity) t.capacity *= 2;
    t.head = memory_allocate_array((size_t)t.capacity, sizeof *t.head);
    t.next = memory_allocate_array((size_t)t.next_capacity, sizeof *t.next);
    status code = t.head && t.next ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for the particles of a sheet");
    if (code == STATUS_OK) {
        memset(t.head, 0xff, (size_t)t.capacity * sizeof *t.head);
        code = throw_darts(region, e, spacing, area, seed, &t, points, r);
    }
    memory_free(t.head, (size_t)t.capacity * sizeof *t.head);
    memory_free(t.next, (size_t)t.next_capacity * sizeof *t.next);
    return code;
}

status sheet_sample(const sheet_region *region, sheet_sampling kind, double spacing, uint64_t seed, point_set *points, double *area, report *r) {
    extent e;
    *points = (point_set){0};
    if (!measure_extent(region, &e)) return report_input(r, NULL, 0, "shape", "a bounded shape for a sheet", "one without bounds", NULL);
    if (region->surface && kind != SHEET_SAMPLING_POISSON)
        return report_input(r, NULL, 0, "lattice", "\"scattered\" on the surface of a shape", "a lattice", NULL);
    double whole = sheet_area(region);
    if (!(spacing > 0) || !(whole / (spacing * spacing) < POINT_LIMIT))
        return report_input(r, NULL, 0, "spacing", "a spacing above 0 that gives fewer than 2e8 particles", "a smaller one", NULL);
    bool hexagonal = kind == SHEET_SAMPLING_HEXAGONAL;
    status code = kind == SHEET_SAMPLING_POISSON ? sample_poisson(region, &e, spacing, whole, seed, points, r)
                                                 : sample_lattice(region, &e, hexagonal, spacing, points, r);
    if (code == STATUS_OK && points->count == 0) code = report_input(r, NULL, 0, "shape", "a sheet that holds particles", "none at this spacing", NULL);
    *area = kind == SHEET_SAMPLING_POISSON ? whole / (double)points->count : spacing * spacing * (hexagonal ? sqrt(0.75) : 1);
    if (code != STATUS_OK) point_set_free(points);
    return code;
}
