/* Sampling: against plain loops over all cells, and against what each kind promises about its points. */
#include "base/random.h"
#include "check.h"
#include "geom/sampling.h"

#include <stdlib.h>

static const double ORIGIN[3] = {0.0, 0.0, 0.0};
static const double OBLIQUE[3] = {2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0};

static arena *shapes;

static const shape *cube(double low, double high) {
    return shape_box(shapes, (double[3]){low, low, low}, (double[3]){high, high, high});
}

/* A tree with a corner, a hole and a part far off: whatever skips cells is put to the test. */
static const shape *awkward_shape(void) {
    const shape *ball = shape_sphere(shapes, (double[3]){0.5, 0.5, 0.5}, 0.4), *box = cube(-1.0, 0.5);
    const shape *parts[] = {shape_difference(shapes, box, &ball, 1),
                            shape_tube(shapes, (double[3]){1.0, 2.0, 0.1}, OBLIQUE, 0.5, 0.3, 1.0, 0.7)};
    return shape_union(shapes, parts, 2);
}

static point_set sample(const shape *s, sampling_kind kind, double spacing, uint64_t seed) {
    point_set points;
    report r;
    CHECK(shape_sample(s, kind, spacing, seed, &points, &r) == STATUS_OK);
    return points;
}

static bool same_points(const point_set *a, const point_set *b) {
    return a->count == b->count && memcmp(a->position, b->position, (size_t)a->count * 3 * sizeof(double)) == 0;
}

/* Points that lie outside, and points out of the order of their cells, x slowest. */
static void check_inside_and_order(const shape *s, const point_set *points, double spacing) {
    int64_t outside = 0, disorder = 0;
    for (int64_t n = 0; n < points->count; n++) {
        const double *x = points->position + 3 * n;
        outside += !(shape_distance(s, x) < 0.0);
        for (int i = 0; i < 3 && n > 0; i++) {
            double step = floor(x[i] / spacing) - floor(x[i - 3] / spacing);
            disorder += step < 0.0;
            if (step != 0.0) break;
        }
    }
    CHECK(points->count > 0);
    CHECK(outside == 0);
    CHECK(disorder == 0);
}

/* ---- lattice and jittered -----------------------------------------------------------------------------------------
 */

static void lattice_counts(void) {
    point_set points = sample(cube(0.0, 1.0), SAMPLING_LATTICE, 0.05, 1);
    CHECK(points.count == 8000);
    CHECK_NEAR(points.position[0], 0.025, 1e-15);
    CHECK_NEAR(points.position[5], 0.075, 1e-15);
    CHECK_NEAR(points.position[3 * 400], 0.075, 1e-15);
    point_set_free(&points);
    CHECK(points.count == 0 && !points.position);
    points = sample(cube(-0.5, 1.0), SAMPLING_LATTICE, 0.1, 1);
    CHECK(points.count == 15 * 15 * 15);
    CHECK_NEAR(points.position[0], -0.45, 1e-15);
    point_set_free(&points);
}

/* Every cell of a block that surely holds the shape, one by one: nothing may be skipped, nothing invented. */
static void lattice_against_every_cell(void) {
    const shape *s = awkward_shape();
    const double spacing = 0.06;
    point_set points = sample(s, SAMPLING_LATTICE, spacing, 1);
    int64_t found = 0, wrong = 0;
    for (int i = -60; i < 60; i++)
        for (int j = -60; j < 60; j++)
            for (int k = -60; k < 60; k++) {
                double x[3] = {(i + 0.5) * spacing, (j + 0.5) * spacing, (k + 0.5) * spacing};
                if (!(shape_distance(s, x) < 0.0)) continue;
                if (found >= points.count || memcmp(points.position + 3 * found, x, sizeof x) != 0) wrong++;
                found++;
            }
    CHECK(wrong == 0);
    CHECK(found == points.count);
    CHECK(found > 10000);
    check_inside_and_order(s, &points, spacing);
    point_set_free(&points);
}

/* Jittered points of a part are those of the whole that lie in it: skipped cells and single cells agree. */
static void jittered_points(void) {
    const shape *s = awkward_shape(), *all = cube(-4.0, 4.0);
    const double spacing = 0.06;
    point_set points = sample(s, SAMPLING_JITTERED, spacing, 3), whole = sample(all, SAMPLING_JITTERED, spacing, 3);
    check_inside_and_order(s, &points, spacing);
    double least = 1.0, most = -1.0, sum = 0.0;
    int64_t diagonal = 0;
    for (int64_t n = 0; n < points.count * 3; n++) {
        double offset = points.position[n] / spacing - floor(points.position[n] / spacing) - 0.5;
        least = fmin(least, offset);
        most = fmax(most, offset);
        sum += offset;
    }
    for (int64_t n = 0; n < points.count; n++) {
        double offset[3];
        for (int i = 0; i < 3; i++)
            offset[i] = points.position[3 * n + i] / spacing - floor(points.position[3 * n + i] / spacing);
        diagonal += fabs(offset[0] - offset[1]) < 1e-6 || fabs(offset[1] - offset[2]) < 1e-6;
    }
    CHECK(diagonal < 5);
    CHECK(least >= -0.25 - 1e-9 && least < -0.249);
    CHECK(most <= 0.25 + 1e-9 && most > 0.249);
    CHECK_NEAR(sum / (double)(3 * points.count), 0.0, 4.0 * 0.25 / sqrt(3.0 * 3.0 * (double)points.count));
    int64_t found = 0, wrong = 0;
    for (int64_t n = 0; n < whole.count; n++) {
        const double *x = whole.position + 3 * n;
        if (!(shape_distance(s, x) < 0.0)) continue;
        if (found >= points.count || memcmp(points.position + 3 * found, x, 3 * sizeof *x) != 0) wrong++;
        found++;
    }
    CHECK(wrong == 0);
    CHECK(found == points.count);
    point_set_free(&points);
    point_set_free(&whole);
}

/* Points that two samples share. */
static int64_t common_points(const point_set *a, const point_set *b) {
    int64_t common = 0;
    for (int64_t n = 0; n < a->count; n++)
        for (int64_t m = 0; m < b->count; m++)
            common += !memcmp(a->position + 3 * n, b->position + 3 * m, 3 * sizeof(double));
    return common;
}

static void depends_on_seed_alone(void) {
    const shape *s = awkward_shape();
    for (sampling_kind kind = SAMPLING_LATTICE; kind <= SAMPLING_POISSON; kind++) {
        point_set a = sample(s, kind, 0.08, 7), b = sample(s, kind, 0.08, 7), c = sample(s, kind, 0.08, 8);
        CHECK(same_points(&a, &b));
        CHECK(common_points(&a, &c) == (kind == SAMPLING_LATTICE ? a.count : 0));
        point_set_free(&a);
        point_set_free(&b);
        point_set_free(&c);
    }
}

/* ---- Poisson disk -------------------------------------------------------------------------------------------------
 */

/* The smallest distance between any two points; a window over x, which grows along the list cell by cell, bounds the
 * pairs. */
static double least_distance(const point_set *points, double spacing) {
    double least = HUGE_VAL;
    for (int64_t a = 0; a < points->count; a++) {
        const double *x = points->position + 3 * a;
        for (int64_t b = a + 1; b < points->count; b++) {
            const double *y = points->position + 3 * b;
            if (y[0] - x[0] > 3.0 * spacing) break;
            double square =
                (y[0] - x[0]) * (y[0] - x[0]) + (y[1] - x[1]) * (y[1] - x[1]) + (y[2] - x[2]) * (y[2] - x[2]);
            if (square < least) least = square;
        }
    }
    return sqrt(least);
}

static void poisson_keeps_its_distance(void) {
    const shape *s = awkward_shape();
    const double spacing = 0.07;
    point_set points = sample(s, SAMPLING_POISSON, spacing, 5);
    check_inside_and_order(s, &points, spacing);
    double least = least_distance(&points, spacing) / spacing;
    CHECK(least >= SAMPLING_POISSON_DISTANCE - 1e-6);
    CHECK(least < 1.01 * SAMPLING_POISSON_DISTANCE);
    point_set_free(&points);
}

/* One point per spacing³ as a whole, in the outermost half spacing and for other seeds. */
static void poisson_density(void) {
    const double side = 40.0;
    for (uint64_t seed = 1; seed <= 2; seed++) {
        point_set points = sample(cube(0.5, 0.5 + side), SAMPLING_POISSON, 1.0, seed);
        CHECK_NEAR((double)points.count / (side * side * side), 1.0, 0.02);
        int64_t outer = 0;
        for (int64_t n = 0; n < points.count; n++) {
            const double *x = points.position + 3 * n;
            bool inner = true;
            for (int i = 0; i < 3; i++) inner = inner && x[i] > 1.0 && x[i] < side;
            outer += !inner;
        }
        double layer = side * side * side - pow(side - 1.0, 3.0);
        CHECK_NEAR((double)outer / layer, 1.0, 0.03);
        point_set_free(&points);
    }
}

/* Dart throwing leaves no room for many more: random places in the body have a point near. */
static void poisson_leaves_no_holes(void) {
    point_set points = sample(cube(0.0, 10.0), SAMPLING_POISSON, 1.0, 9);
    double furthest = 0.0;
    int uncovered = 0;
    for (uint64_t n = 0; n < 3000; n++) {
        double x[3], nearest = HUGE_VAL;
        for (uint64_t i = 0; i < 3; i++) x[i] = 1.5 + 7.0 * random_unit(2, 3, 3 * n + i);
        for (int64_t p = 0; p < points.count; p++) {
            const double *y = points.position + 3 * p;
            double square = 0.0;
            for (int i = 0; i < 3; i++) square += (x[i] - y[i]) * (x[i] - y[i]);
            if (square < nearest) nearest = square;
        }
        furthest = fmax(furthest, sqrt(nearest));
        uncovered += sqrt(nearest) > SAMPLING_POISSON_DISTANCE;
    }
    CHECK(furthest < 1.3);
    CHECK(uncovered < 3000 / 20);
    point_set_free(&points);
}

/* A second body far off changes the block of cells and the order in which they are met, but not one point. */
static void poisson_is_local(void) {
    const shape *near = shape_sphere(shapes, ORIGIN, 1.0);
    const shape *both[] = {near, shape_sphere(shapes, (double[3]){-5.0, 6.0, -4.0}, 0.5)};
    point_set alone = sample(near, SAMPLING_POISSON, 0.11, 4);
    point_set together = sample(shape_union(shapes, both, 2), SAMPLING_POISSON, 0.11, 4);
    CHECK(together.count > alone.count);
    int64_t skip = together.count - alone.count;
    CHECK(memcmp(together.position + 3 * skip, alone.position, (size_t)alone.count * 3 * sizeof(double)) == 0);
    point_set_free(&alone);
    point_set_free(&together);
}

/* ---- errors -------------------------------------------------------------------------------------------------------
 */

static void wrong_input(void) {
    const shape *near = shape_sphere(shapes, ORIGIN, 1.0);
    const shape *apart[] = {near, shape_sphere(shapes, (double[3]){5.0, 0.0, 0.0}, 1.0)};
    const shape *speck = shape_sphere(shapes, ORIGIN, 1e-9);
    struct {
        const shape *s;
        double spacing;
        const char *says;
    } cases[] = {
        {shape_half_space(shapes, ORIGIN, OBLIQUE), 0.1, "unbounded"},
        {shape_intersection(shapes, apart, 2), 0.1, "holds no particle"},
        {speck, 1.0, "holds no particle"},
        {near, 0.0, "positive"},
        {near, -1.0, "positive"},
        {near, NAN, "positive"},
        {near, HUGE_VAL, "positive"},
        {near, 1e-6, "too small"},
        {near, 1e-300, "too small"},
        {shape_sphere(shapes, (double[3]){1e12, 0.0, 0.0}, 1.0), 0.5, "too small"},
    };
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++)
        for (sampling_kind kind = SAMPLING_LATTICE; kind <= SAMPLING_POISSON; kind++) {
            point_set points;
            report r;
            report_clear(&r);
            CHECK(shape_sample(cases[n].s, kind, cases[n].spacing, 1, &points, &r) == STATUS_INPUT);
            CHECK(r.code == STATUS_INPUT && strstr(r.message, cases[n].says));
            CHECK(points.count == 0 && !points.position);
        }
}

static void every_allocation_may_fail(void) {
    const shape *s = shape_sphere(shapes, ORIGIN, 1.0);
    size_t before = memory_live_bytes();
    for (sampling_kind kind = SAMPLING_LATTICE; kind <= SAMPLING_POISSON; kind++) {
        status code = STATUS_SYSTEM;
        int failed = 0;
        for (int n = 1; n < 100 && code; n++) {
            point_set points;
            report r;
            memory_fail_after(n, 0);
            code = shape_sample(s, kind, 0.1, 1, &points, &r);
            memory_fail_after(0, 0);
            CHECK(code == STATUS_OK || (code == STATUS_SYSTEM && strstr(r.message, "out of memory")));
            CHECK(code == STATUS_OK || (points.count == 0 && !points.position));
            failed += code != STATUS_OK;
            point_set_free(&points);
            CHECK(memory_live_bytes() == before);
        }
        CHECK(code == STATUS_OK);
        CHECK(failed >= (kind == SAMPLING_POISSON ? 5 : 3));
    }
}

int main(void) {
    shapes = arena_create("test shapes");
    if (!shapes) return 1;
    RUN(lattice_counts);
    RUN(lattice_against_every_cell);
    RUN(jittered_points);
    RUN(depends_on_seed_alone);
    RUN(poisson_keeps_its_distance);
    RUN(poisson_density);
    RUN(poisson_leaves_no_holes);
    RUN(poisson_is_local);
    RUN(wrong_input);
    RUN(every_allocation_may_fail);
    arena_destroy(shapes);
    CHECK(memory_live_bytes() == 0);
    return check_finish();
}
