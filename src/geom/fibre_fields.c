/* Curves and random cones. */
#include "geom/fibre_fields.h"

#include "base/random.h"
#include "geom/vector.h"

#include <assert.h>
#include <string.h>

enum { STREAM_DIRECTION = 0xf1b3 };

/* ---- curves ------------------------------------------------------------------------------------------------------ */

struct fibre_curve {
    int segments;
    double blend;           /* a segment this much further than the nearest has no say */
    double (*point)[3];     // [segments + 1]
    double (*direction)[3]; // [segments + 1] unit, at the points: halfway between the segments there
};

/* The unit vector from one point to the next. */
static void segment_direction(const fibre_curve *c, int segment, double direction[3]) {
    vector_subtract(c->point[segment + 1], c->point[segment], direction);
    bool apart = vector_normalise(direction);
    assert(apart && "a curve's neighbours must lie apart");
    (void)apart;
}

static void set_directions(fibre_curve *c) {
    bool closed = memcmp(c->point[0], c->point[c->segments], sizeof *c->point) == 0;
    for (int i = 0; i <= c->segments; i++) {
        int before = i > 0 ? i - 1 : closed ? c->segments - 1 : 0, after = i < c->segments ? i : closed ? 0 : i - 1;
        double from[3], to[3];
        segment_direction(c, before, from);
        segment_direction(c, after, to);
        for (int a = 0; a < 3; a++) c->direction[i][a] = from[a] + to[a];
        /* Where the curve turns back on itself either segment's direction will do: as fibres they are the same. */
        if (!vector_normalise(c->direction[i])) memcpy(c->direction[i], to, sizeof to);
    }
}

const fibre_curve *fibre_curve_create(arena *a, const double *points, int count) {
    assert(count >= 2 && count <= FIBRE_CURVE_POINTS);
    fibre_curve *c = arena_allocate(a, sizeof *c);
    if (!c) return NULL;
    *c = (fibre_curve){.segments = count - 1};
    c->point = arena_allocate(a, (size_t)count * sizeof *c->point);
    c->direction = arena_allocate(a, (size_t)count * sizeof *c->direction);
    if (!c->point || !c->direction) return NULL;
    memcpy(c->point, points, (size_t)count * sizeof *c->point);
    for (int i = 0; i < c->segments; i++) {
        double along[3];
        vector_subtract(c->point[i + 1], c->point[i], along);
        c->blend += 0.5 * vector_length(along) / c->segments;
    }
    set_directions(c);
    return c;
}

/* The distance of x from a segment, and where along it (0 … 1) the nearest point is. */
static double segment_distance(const fibre_curve *c, int segment, const double x[3], double *place) {
    double along[3], offset[3];
    vector_subtract(c->point[segment + 1], c->point[segment], along);
    vector_subtract(x, c->point[segment], offset);
    *place = fmin(fmax(vector_dot(offset, along) / vector_dot(along, along), 0.0), 1.0);
    for (int a = 0; a < 3; a++) offset[a] -= *place * along[a];
    return vector_length(offset);
}

static void direction_on(const fibre_curve *c, int segment, double place, double direction[3]) {
    for (int a = 0; a < 3; a++)
        direction[a] = (1.0 - place) * c->direction[segment][a] + place * c->direction[segment + 1][a];
    if (!vector_normalise(direction)) memcpy(direction, c->direction[segment], 3 * sizeof *direction);
}

void fibre_curve_direction(const fibre_curve *c, const double x[3], double direction[3]) {
    double least = HUGE_VAL, place, nearest[3] = {0, 0, 0}, sum[3] = {0, 0, 0};
    for (int i = 0; i < c->segments; i++) {
        double distance = segment_distance(c, i, x, &place);
        if (distance >= least) continue;
        least = distance;
        direction_on(c, i, place, nearest);
    }
    for (int i = 0; i < c->segments; i++) {
        double late = (segment_distance(c, i, x, &place) - least) / c->blend, here[3];
        if (late >= 1.0) continue;
        direction_on(c, i, place, here);
        for (int a = 0; a < 3; a++) sum[a] += (1.0 - late) * (1.0 - late) * here[a];
    }
    /* Halfway between stretches that run against each other there is nothing to follow but one of them. */
    memcpy(direction, vector_length(sum) > 1e-6 && vector_normalise(sum) ? sum : nearest, sizeof sum);
}

/* ---- random ------------------------------------------------------------------------------------------------------ */

static uint64_t place_key(const double x[3]) {
    uint64_t key = 0;
    for (int i = 0; i < 3; i++) {
        double value = x[i] + 0.0; /* −0 is the same place */
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        key = random_mix(key ^ bits);
    }
    return key;
}

void fibre_random_direction(const double mean[3], double spread, uint64_t seed, const double x[3], double direction[3]) {
    const double turn = 2.0 * acos(-1.0), half = sin(0.5 * spread);
    uint64_t key = place_key(x);
    /* 1 − cos of the angle to the mean is uniform, as is the angle around it. */
    double rise = 2.0 * half * half * random_unit(seed, STREAM_DIRECTION, key);
    double around = turn * random_unit(seed, STREAM_DIRECTION + 1, key), across = sqrt(rise * (2.0 - rise));
    int least = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(mean[i]) < fabs(mean[least])) least = i;
    double axis[3] = {least == 0, least == 1, least == 2}, u[3], v[3];
    vector_cross(mean, axis, u);
    vector_normalise(u);
    vector_cross(mean, u, v);
    for (int i = 0; i < 3; i++)
        direction[i] = (1.0 - rise) * mean[i] + across * (cos(around) * u[i] + sin(around) * v[i]);
}
