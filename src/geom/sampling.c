/* Lattice and jittered sampling, and what all kinds of sampling share. */
#include "geom/sampling.h"

#include "base/random.h"
#include "geom/sampling_cells.h"

#include <math.h>
#include <string.h>

enum { STREAM_JITTER = 0x5a01, FIRST_CAPACITY = 1024 };

static const double JITTER = 0.25;

/* A box of more cells than this is a slip in the spacing: one cell takes 4 bytes or more than a nanosecond. */
static const double CELL_LIMIT = 0x1p31;

/* Further from the origin, in cells, a point's place within its cell would lose digits that matter. */
static const double PLACE_LIMIT = 0x1p31;

double cell_distance(const cell_range *cells, const int64_t index[3]) {
    double x[3];
    for (int i = 0; i < 3; i++) x[i] = ((double)index[i] + 0.5) * cells->spacing;
    return shape_distance(cells->body, x);
}

int64_t cells_within(double clear, double spacing, int64_t left) {
    double cells = ceil(clear / spacing * (1.0 - 1e-9));
    return cells > 1.0 ? (int64_t)fmin(cells, (double)left) : 1;
}

uint64_t cell_key(const int64_t index[3]) {
    return random_mix((uint64_t)index[0] ^ random_mix((uint64_t)index[1] ^ random_mix((uint64_t)index[2])));
}

/* ---- points -------------------------------------------------------------------------------------------------------
 */

static size_t point_bytes(int64_t capacity) {
    return (size_t)capacity * 3 * sizeof(double);
}

status point_set_add(point_set *points, const double x[3], report *r) {
    if (points->count == points->capacity) {
        int64_t capacity = points->capacity ? 2 * points->capacity : FIRST_CAPACITY;
        double *grown = memory_resize(points->position, point_bytes(points->capacity), point_bytes(capacity));
        if (!grown) return report_set(r, STATUS_SYSTEM, "out of memory after %lld particles", (long long)points->count);
        points->position = grown;
        points->capacity = capacity;
    }
    memcpy(points->position + 3 * points->count++, x, 3 * sizeof *x);
    return STATUS_OK;
}

void point_set_free(point_set *points) {
    memory_free(points->position, point_bytes(points->capacity));
    *points = (point_set){0};
}

/* ---- lattice ------------------------------------------------------------------------------------------------------
 */

static void lattice_point(const cell_range *cells, const int64_t index[3], double jitter, uint64_t seed, double x[3]) {
    uint64_t key = jitter > 0.0 ? cell_key(index) : 0;
    for (int i = 0; i < 3; i++) {
        double offset = 0.5;
        if (jitter > 0.0) offset += jitter * (2.0 * random_unit(seed, STREAM_JITTER, key + (uint64_t)i) - 1.0);
        x[i] = ((double)index[i] + offset) * cells->spacing;
    }
}

/* Samples the row of cells along z that starts at `index`. The distance at a cell's centre decides for all the cells
 * that are nearer than the surface; only where a jittered point could cross the surface is the point itself asked. */
static status sample_row(const cell_range *cells, int64_t index[3], double jitter, uint64_t seed, point_set *points,
                         report *r) {
    double x[3], reach = sqrt(3.0) * jitter * cells->spacing;
    int64_t end = cells->low[2] + cells->count[2];
    for (index[2] = cells->low[2]; index[2] < end;) {
        double distance = cell_distance(cells, index), clear = fabs(distance) - reach;
        int64_t run = cells_within(clear, cells->spacing, end - index[2]);
        if (distance > 0.0 && clear > 0.0) {
            index[2] += run;
            continue;
        }
        for (; run > 0; run--, index[2]++) {
            lattice_point(cells, index, jitter, seed, x);
            if (clear <= 0.0 && !(shape_distance(cells->body, x) < 0.0)) continue;
            status code = point_set_add(points, x, r);
            if (code) return code;
        }
    }
    return STATUS_OK;
}

static status sample_lattice(const cell_range *cells, double jitter, uint64_t seed, point_set *points, report *r) {
    for (int64_t i = 0; i < cells->count[0]; i++)
        for (int64_t j = 0; j < cells->count[1]; j++) {
            int64_t index[3] = {cells->low[0] + i, cells->low[1] + j, 0};
            status code = sample_row(cells, index, jitter, seed, points, r);
            if (code) return code;
        }
    return STATUS_OK;
}

/* ---- all kinds ----------------------------------------------------------------------------------------------------
 */

static status cut_into_cells(const shape *s, double spacing, cell_range *cells, report *r) {
    if (!(spacing > 0.0) || !isfinite(spacing))
        return report_set(r, STATUS_INPUT, "the particle spacing must be positive and finite, but is %g", spacing);
    double minimum[3], maximum[3], total = 1.0;
    shape_bounds(s, minimum, maximum);
    *cells = (cell_range){.body = s, .spacing = spacing};
    for (int i = 0; i < 3; i++) {
        if (!isfinite(minimum[i]) || !isfinite(maximum[i]))
            return report_set(r, STATUS_INPUT, "the shape is unbounded: it cannot be filled with particles");
        double low = floor(minimum[i] / spacing), count = fmax(1.0, ceil(maximum[i] / spacing) - low);
        total *= count;
        if (!(total <= CELL_LIMIT) || !(fabs(low) < PLACE_LIMIT))
            return report_set(r, STATUS_INPUT,
                              "a particle spacing of %g is too small for a shape of this size and place", spacing);
        cells->low[i] = (int64_t)low;
        cells->count[i] = (int64_t)count;
    }
    return STATUS_OK;
}

status shape_sample(const shape *s, sampling_kind kind, double spacing, uint64_t seed, point_set *points, report *r) {
    *points = (point_set){0};
    cell_range cells = {0};
    status code = cut_into_cells(s, spacing, &cells, r);
    if (code) return code;
    if (kind == SAMPLING_POISSON)
        code = poisson_sample(&cells, seed, points, r);
    else
        code = sample_lattice(&cells, kind == SAMPLING_JITTERED ? JITTER : 0.0, seed, points, r);
    if (!code && points->count == 0)
        code = report_set(r, STATUS_INPUT, "the shape holds no particle at a spacing of %g: it is empty or too thin",
                          spacing);
    if (code) point_set_free(points);
    return code;
}
