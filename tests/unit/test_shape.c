/* Shapes: distances against closed forms and brute force, volumes against formulas, trees against their identities. */
#include "base/random.h"
#include "check.h"
#include "geom/shape.h"

#include <stdlib.h>

#define PI 3.14159265358979323846

static const double ORIGIN[3] = {0.0, 0.0, 0.0}, X_AXIS[3] = {1.0, 0.0, 0.0}, Z_AXIS[3] = {0.0, 0.0, 1.0};
/* Two unit vectors with no zeros, and rotations that are easy to check by hand. */
static const double OBLIQUE[3] = {2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0};
static const double IDENTITY[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
static const double QUARTER_ABOUT_Z[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1};
static const double TURNED[9] = {2.0 / 3, -1.0 / 3, 2.0 / 3, 2.0 / 3, 2.0 / 3, -1.0 / 3, -1.0 / 3, 2.0 / 3, 2.0 / 3};

static arena *shapes;

/* Point number n of a cloud in the cube of half side `reach`. */
static void cloud_point(uint64_t n, double reach, double x[3]) {
    for (uint64_t i = 0; i < 3; i++) x[i] = reach * (2.0 * random_unit(11, 1, 3 * n + i) - 1.0);
}

static double distance_at(const shape *s, double x, double y, double z) {
    return shape_distance(s, (double[3]){x, y, z});
}

/* ---- distances ----------------------------------------------------------------------------------------------------
 */

static void sphere_closed_form(void) {
    const shape *s = shape_sphere(shapes, (double[3]){1.0, 2.0, 3.0}, 0.5);
    CHECK_NEAR(distance_at(s, 1.0, 2.0, 3.0), -0.5, 0.0);
    CHECK_NEAR(distance_at(s, 4.0, 6.0, 3.0), 4.5, 1e-15);
}

static void box_closed_form(void) {
    const shape *s = shape_box(shapes, (double[3]){-1.0, 0.0, 2.0}, (double[3]){1.0, 1.0, 6.0});
    CHECK_NEAR(distance_at(s, 0.0, 0.5, 4.0), -0.5, 1e-15);
    CHECK_NEAR(distance_at(s, 0.9, 0.5, 4.0), -0.1, 1e-15);
    CHECK_NEAR(distance_at(s, 3.0, 0.5, 4.0), 2.0, 1e-15);
    CHECK_NEAR(distance_at(s, 4.0, 5.0, 3.0), 5.0, 1e-15);
    CHECK_NEAR(distance_at(s, 3.0, 2.0, 0.0), 3.0, 1e-15);
}

static void cylinder_closed_form(void) {
    const shape *s = shape_cylinder(shapes, (double[3]){1.0, 0.0, 0.0}, X_AXIS, 0.5, 4.0);
    CHECK_NEAR(distance_at(s, 1.0, 0.0, 0.0), -0.5, 1e-15);
    CHECK_NEAR(distance_at(s, 2.9, 0.0, 0.1), -0.1, 1e-15);
    CHECK_NEAR(distance_at(s, 3.5, 0.0, 0.3), 0.5, 1e-15);
    CHECK_NEAR(distance_at(s, 0.0, 1.2, 0.0), 0.7, 1e-15);
    CHECK_NEAR(distance_at(s, 6.0, 4.5, 0.0), 5.0, 1e-15);
    CHECK_NEAR(distance_at(s, -4.0, 0.0, 4.5), 5.0, 1e-15);
}

static void tube_closed_form(void) {
    const shape *s = shape_tube(shapes, ORIGIN, Z_AXIS, 3.0, 1.0, 4.0, 1.0);
    CHECK_NEAR(distance_at(s, 0.0, 0.0, 0.0), 1.0, 1e-15);
    CHECK_NEAR(distance_at(s, 2.0, 0.0, 0.0), -1.0, 1e-15);
    CHECK_NEAR(distance_at(s, 0.0, 1.25, 0.5), -0.25, 1e-15);
    CHECK_NEAR(distance_at(s, 0.0, 0.0, 2.0), 1.0, 1e-15);
    CHECK_NEAR(distance_at(s, 0.0, 0.25, 3.0), 1.25, 1e-15);
    CHECK_NEAR(distance_at(s, 0.0, 4.0, -2.0), 1.0, 1e-15);
}

/* A cone's frustum with slope 1: radii 3 → 1 over length 2. */
static void tapered_closed_form(void) {
    const shape *s = shape_tube(shapes, ORIGIN, Z_AXIS, 3.0, 0.0, 2.0, 1.0 / 3.0);
    CHECK_NEAR(distance_at(s, 0.0, 0.0, 0.0), -1.0, 1e-15);
    CHECK_NEAR(distance_at(s, 2.0, 0.0, 0.0), 0.0, 1e-15);
    CHECK_NEAR(distance_at(s, 0.0, 3.0, 1.0), sqrt(2.0), 1e-15);
    CHECK_NEAR(distance_at(s, 0.0, 0.5, 3.0), 2.0, 1e-15);
    CHECK_NEAR(distance_at(s, 0.0, 1.5, 0.0), -sqrt(0.125), 1e-15);
    CHECK_NEAR(distance_at(s, 0.0, 0.0, -0.75), -0.25, 1e-15);
}

static void capsule_torus_half_space_closed_form(void) {
    const shape *capsule = shape_capsule(shapes, (double[3]){0.0, 0.0, 0.0}, (double[3]){0.0, 2.0, 0.0}, 0.25);
    CHECK_NEAR(distance_at(capsule, 1.0, 1.0, 0.0), 0.75, 1e-15);
    CHECK_NEAR(distance_at(capsule, 3.0, 6.0, 0.0), 4.75, 1e-15);
    CHECK_NEAR(distance_at(capsule, 0.0, -1.0, 0.0), 0.75, 1e-15);
    CHECK_NEAR(distance_at(capsule, 0.0, 1.5, 0.0), -0.25, 1e-15);
    const shape *dot = shape_capsule(shapes, X_AXIS, X_AXIS, 0.25);
    CHECK_NEAR(distance_at(dot, 1.0, 1.0, 0.0), 0.75, 1e-15);
    const shape *torus = shape_torus(shapes, ORIGIN, Z_AXIS, 2.0, 0.5);
    CHECK_NEAR(distance_at(torus, 0.0, 0.0, 0.0), 1.5, 1e-15);
    CHECK_NEAR(distance_at(torus, 0.0, -2.0, 0.0), -0.5, 1e-15);
    CHECK_NEAR(distance_at(torus, 0.0, 5.0, 4.0), 4.5, 1e-15);
    const shape *half_space = shape_half_space(shapes, (double[3]){1.0, 1.0, 1.0}, (double[3]){0.0, 3.0, 4.0});
    CHECK_NEAR(distance_at(half_space, 9.0, 1.0, 1.0), 0.0, 1e-15);
    CHECK_NEAR(distance_at(half_space, 9.0, 4.0, 5.0), 5.0, 1e-15);
    CHECK_NEAR(distance_at(half_space, 9.0, -2.0, -3.0), -5.0, 1e-15);
}

enum { EXACT_SHAPES = 9 };

static void make_exact_shapes(const shape *exact[EXACT_SHAPES]) {
    double center[3] = {0.1, -0.2, 0.05};
    exact[0] = shape_sphere(shapes, center, 0.7);
    exact[1] = shape_box(shapes, (double[3]){-0.6, -0.3, -0.9}, (double[3]){0.4, 0.5, 0.2});
    exact[2] = shape_cylinder(shapes, center, OBLIQUE, 0.4, 1.1);
    exact[3] = shape_tube(shapes, center, OBLIQUE, 0.6, 0.25, 0.9, 1.0);
    exact[4] = shape_tube(shapes, center, OBLIQUE, 0.6, 0.25, 0.9, 0.5);
    exact[5] = shape_capsule(shapes, center, (double[3]){0.5, 0.4, -0.3}, 0.3);
    exact[6] = shape_torus(shapes, center, OBLIQUE, 0.6, 0.2);
    exact[7] = shape_half_space(shapes, center, OBLIQUE);
    exact[8] = shape_transform(shapes, exact[1], TURNED, 0.8, center);
}

/* The gradient of an exact distance has length 1 but on the medial axis, which a cloud of points all but misses. */
static void exact_shapes_are_eikonal(void) {
    const shape *exact[EXACT_SHAPES];
    make_exact_shapes(exact);
    enum { POINTS = 4000 };
    const double h = 1e-5;
    for (int k = 0; k < EXACT_SHAPES; k++) {
        int off = 0;
        for (uint64_t n = 0; n < POINTS; n++) {
            double x[3], square = 0.0;
            cloud_point(n, 1.5, x);
            for (int i = 0; i < 3; i++) {
                double ahead[3] = {x[0], x[1], x[2]}, behind[3] = {x[0], x[1], x[2]};
                ahead[i] += h, behind[i] -= h;
                double slope = (shape_distance(exact[k], ahead) - shape_distance(exact[k], behind)) / (2.0 * h);
                square += slope * slope;
            }
            if (!(fabs(square - 1.0) < 1e-4)) off++;
        }
        CHECK(off < POINTS / 500);
    }
}

/* The distance of p to a meridian polygon's outline [4][2], by walking along it. */
static double walked_distance(const double p[2], double corners[4][2], int steps) {
    double least = HUGE_VAL;
    for (int side = 0; side < 4; side++)
        for (int i = 0; i <= steps; i++) {
            double t = (double)i / steps, *a = corners[side], *b = corners[(side + 1) % 4];
            least = fmin(least, hypot(a[0] + t * (b[0] - a[0]) - p[0], a[1] + t * (b[1] - a[1]) - p[1]));
        }
    return least;
}

static void tapered_tube_against_brute_force(void) {
    const double length = 1.4, outer = 0.5, inner = 0.2, taper = 1.6;
    const shape *s = shape_tube(shapes, ORIGIN, Z_AXIS, outer, inner, length, taper);
    double corners[4][2] = {
        {-length / 2, inner}, {length / 2, inner * taper}, {length / 2, outer * taper}, {-length / 2, outer}};
    for (uint64_t n = 0; n < 500; n++) {
        double x[3];
        cloud_point(n, 1.2, x);
        double p[2] = {x[2], hypot(x[0], x[1])};
        double scale = 1.0 + (taper - 1.0) * (p[0] / length + 0.5);
        bool inside = fabs(p[0]) < length / 2 && p[1] < outer * scale && p[1] > inner * scale;
        double distance = shape_distance(s, x);
        CHECK_NEAR(fabs(distance), walked_distance(p, corners, 2000), 1e-3);
        CHECK((distance < 0.0) == inside);
    }
}

static void normals(void) {
    double normal[3];
    const shape *s = shape_sphere(shapes, X_AXIS, 0.5);
    shape_normal(s, (double[3]){3.0, 2.0, -1.0}, 1e-4, normal);
    for (int i = 0; i < 3; i++) CHECK_NEAR(normal[i], ((double[3]){2.0, 2.0, -1.0})[i] / 3.0, 1e-7);
    /* In the middle of a thing there is no normal, though round-off has a direction. */
    double middle[3] = {1.1, -0.7, 1.3};
    shape_normal(shape_sphere(shapes, middle, 0.01), middle, 1e-5, normal);
    CHECK(normal[0] == 0.0 && normal[1] == 0.0 && normal[2] == 0.0);
    shape_normal(shape_capsule(shapes, ORIGIN, middle, 0.01), (double[3]){0.55, -0.35, 0.65}, 1e-5, normal);
    CHECK(normal[0] == 0.0 && normal[1] == 0.0 && normal[2] == 0.0);
    const shape *hole = shape_difference(shapes, shape_sphere(shapes, X_AXIS, 2.0), &s, 1);
    shape_normal(hole, (double[3]){1.6, 0.0, 0.0}, 1e-4, normal);
    CHECK_NEAR(normal[0], -1.0, 1e-7);
}

/* ---- volumes and bounds -------------------------------------------------------------------------------------------
 */

static void check_volume(const shape *s, int cells, double expected, double relative) {
    CHECK_NEAR(shape_volume(s, cells) / expected, 1.0, relative);
}

static void volumes(void) {
    double center[3] = {3.0, -1.0, 0.3};
    check_volume(shape_sphere(shapes, center, 0.7), 0, 4.0 / 3.0 * PI * 0.343, 5e-3);
    check_volume(shape_sphere(shapes, center, 0.7), 20000, 4.0 / 3.0 * PI * 0.343, 5e-3);
    check_volume(shape_box(shapes, (double[3]){0, 0, 0}, (double[3]){100.0, 1.0, 1e-4}), 1000, 1e-2, 1e-9);
    check_volume(shape_cylinder(shapes, center, OBLIQUE, 0.3, 2.0), 0, PI * 0.18, 5e-3);
    check_volume(shape_tube(shapes, center, X_AXIS, 0.30, 0.12, 2.0, 1.0), 0, PI * 2.0 * (0.09 - 0.0144), 5e-3);
    check_volume(shape_tube(shapes, center, OBLIQUE, 0.30, 0.12, 2.0, 1.0), 0, PI * 2.0 * (0.09 - 0.0144), 5e-3);
    /* A frustum's volume: the mean of s² for s from 1 to t is (1 + t + t²)/3. */
    double taper = 0.5, mean = (1.0 + taper + taper * taper) / 3.0;
    check_volume(shape_tube(shapes, center, OBLIQUE, 0.6, 0.2, 1.5, taper), 0, PI * 1.5 * mean * (0.36 - 0.04), 5e-3);
    check_volume(shape_tube(shapes, center, X_AXIS, 0.6, 0.0, 1.5, taper), 0, PI * 1.5 * mean * 0.36, 5e-3);
    check_volume(shape_torus(shapes, center, OBLIQUE, 0.8, 0.2), 0, 2.0 * PI * PI * 0.8 * 0.04, 5e-3);
    check_volume(shape_capsule(shapes, center, ORIGIN, 0.4), 0, PI * 0.16 * sqrt(10.09) + 4.0 / 3.0 * PI * 0.064, 5e-3);
    CHECK(shape_volume(shape_half_space(shapes, center, X_AXIS), 0) == 0.0);
}

static void volumes_of_trees(void) {
    const shape *ball = shape_sphere(shapes, ORIGIN, 1.0), *below = shape_half_space(shapes, ORIGIN, OBLIQUE);
    check_volume(shape_intersection(shapes, (const shape *[]){ball, below}, 2), 0, 2.0 / 3.0 * PI, 5e-3);
    check_volume(shape_transform(shapes, ball, TURNED, 2.0, X_AXIS), 0, 32.0 / 3.0 * PI, 5e-3);
    const shape *core = shape_sphere(shapes, ORIGIN, 0.5);
    check_volume(shape_difference(shapes, ball, &core, 1), 0, 4.0 / 3.0 * PI * 0.875, 5e-3);
    const shape *apart[] = {ball, shape_sphere(shapes, (double[3]){5.0, 0.0, 0.0}, 1.0)};
    check_volume(shape_union(shapes, apart, 2), 0, 8.0 / 3.0 * PI, 5e-3);
    CHECK(shape_volume(shape_intersection(shapes, apart, 2), 0) == 0.0);
}

static void check_bounds(const shape *s, const double low[3], const double high[3]) {
    double minimum[3], maximum[3];
    shape_bounds(s, minimum, maximum);
    for (int i = 0; i < 3; i++) {
        CHECK(minimum[i] == low[i] || fabs(minimum[i] - low[i]) < 1e-12);
        CHECK(maximum[i] == high[i] || fabs(maximum[i] - high[i]) < 1e-12);
    }
}

static void bounds_closed_form(void) {
    const double h = HUGE_VAL, d = sqrt(0.5);
    check_bounds(shape_cylinder(shapes, X_AXIS, X_AXIS, 0.5, 4.0), (double[]){-1, -0.5, -0.5}, (double[]){3, 0.5, 0.5});
    check_bounds(shape_tube(shapes, ORIGIN, Z_AXIS, 1, 0.5, 2, 3), (double[]){-3, -3, -1}, (double[]){3, 3, 1});
    check_bounds(shape_cylinder(shapes, ORIGIN, (double[]){1, 1, 0}, 1, 2), (double[]){-2 * d, -2 * d, -1},
                 (double[]){2 * d, 2 * d, 1});
    check_bounds(shape_torus(shapes, ORIGIN, Z_AXIS, 2, 0.5), (double[]){-2.5, -2.5, -0.5}, (double[]){2.5, 2.5, 0.5});
    check_bounds(shape_capsule(shapes, X_AXIS, Z_AXIS, 0.5), (double[]){-0.5, -0.5, -0.5}, (double[]){1.5, 0.5, 1.5});
    check_bounds(shape_half_space(shapes, X_AXIS, X_AXIS), (double[]){-h, -h, -h}, (double[]){1, h, h});
    check_bounds(shape_half_space(shapes, X_AXIS, OBLIQUE), (double[]){-h, -h, -h}, (double[]){h, h, h});
    const shape *box = shape_box(shapes, (double[]){0, 0, 0}, (double[]){1, 2, 3});
    const shape *parts[] = {box, shape_half_space(shapes, (double[]){0, 0, 2}, Z_AXIS)};
    check_bounds(shape_intersection(shapes, parts, 2), (double[]){0, 0, 0}, (double[]){1, 2, 2});
    check_bounds(shape_union(shapes, parts, 2), (double[]){-h, -h, -h}, (double[]){h, h, 3});
    check_bounds(shape_difference(shapes, box, parts + 1, 1), (double[]){0, 0, 0}, (double[]){1, 2, 3});
    check_bounds(shape_transform(shapes, box, QUARTER_ABOUT_Z, 2.0, X_AXIS), (double[]){-3, 0, 0}, (double[]){1, 2, 6});
    const shape *turned_sphere = shape_transform(shapes, shape_sphere(shapes, ORIGIN, 1), TURNED, 1.0, ORIGIN);
    check_bounds(turned_sphere, (double[]){-1, -1, -1}, (double[]){1, 1, 1});
    const shape *disjoint[] = {box, shape_sphere(shapes, (double[]){9, 9, 9}, 1)};
    check_bounds(shape_intersection(shapes, disjoint, 2), ORIGIN, ORIGIN);
}

static void bounds_contain(void) {
    const shape *exact[EXACT_SHAPES];
    make_exact_shapes(exact);
    for (int k = 0; k < EXACT_SHAPES; k++) {
        double minimum[3], maximum[3];
        int inside = 0, escaped = 0;
        shape_bounds(exact[k], minimum, maximum);
        for (uint64_t n = 0; n < 20000; n++) {
            double x[3];
            cloud_point(n, 1.5, x);
            if (shape_distance(exact[k], x) >= 0.0) continue;
            inside++;
            for (int i = 0; i < 3; i++) escaped += x[i] < minimum[i] || x[i] > maximum[i];
        }
        CHECK(inside > 100);
        CHECK(escaped == 0);
    }
}

/* ---- trees --------------------------------------------------------------------------------------------------------
 */

static void set_identities(void) {
    const shape *exact[EXACT_SHAPES];
    make_exact_shapes(exact);
    const shape *u = shape_union(shapes, exact, EXACT_SHAPES), *n = shape_intersection(shapes, exact, 2);
    const shape *difference = shape_difference(shapes, exact[0], exact + 1, 3);
    const shape *uncut = shape_difference(shapes, exact[0], NULL, 0);
    for (uint64_t point = 0; point < 1000; point++) {
        double x[3], d[EXACT_SHAPES], least = HUGE_VAL;
        cloud_point(point, 1.5, x);
        for (int i = 0; i < EXACT_SHAPES; i++) {
            d[i] = shape_distance(exact[i], x);
            least = d[i] < least ? d[i] : least;
        }
        CHECK(shape_distance(u, x) == least);
        CHECK(shape_distance(n, x) == (d[0] > d[1] ? d[0] : d[1]));
        double outside_all = -fmin(d[1], fmin(d[2], d[3]));
        CHECK(shape_distance(difference, x) == (d[0] > outside_all ? d[0] : outside_all));
        CHECK(shape_distance(uncut, x) == d[0]);
    }
}

static void transform_identities(void) {
    const shape *s = shape_tube(shapes, X_AXIS, OBLIQUE, 0.6, 0.25, 0.9, 0.5);
    const double shift[3] = {0.3, -0.1, 0.7}, scale = 1.7;
    const shape *moved = shape_transform(shapes, s, TURNED, scale, shift);
    const shape *same = shape_transform(shapes, s, IDENTITY, 1.0, ORIGIN);
    for (uint64_t n = 0; n < 1000; n++) {
        double x[3], y[3];
        cloud_point(n, 1.5, x);
        for (int i = 0; i < 3; i++)
            y[i] = scale * (TURNED[3 * i] * x[0] + TURNED[3 * i + 1] * x[1] + TURNED[3 * i + 2] * x[2]) + shift[i];
        CHECK_NEAR(shape_distance(moved, y), scale * shape_distance(s, x), 1e-14);
        CHECK_NEAR(shape_distance(same, x), shape_distance(s, x), 0.0);
    }
    const shape *x_box = shape_box(shapes, (double[]){1, 0, 0}, (double[]){2, 1, 1});
    const shape *y_box = shape_transform(shapes, x_box, QUARTER_ABOUT_Z, 1.0, ORIGIN);
    CHECK(distance_at(y_box, -0.5, 1.5, 0.5) < 0.0);
    CHECK(distance_at(y_box, 0.5, 1.5, 0.5) > 0.0);
}

static void children_are_copied(void) {
    const shape *children[] = {shape_sphere(shapes, ORIGIN, 1.0), shape_sphere(shapes, X_AXIS, 1.0)};
    const shape *u = shape_union(shapes, children, 2);
    children[0] = children[1] = NULL;
    CHECK_NEAR(distance_at(u, -2.0, 0.0, 0.0), 1.0, 1e-15);
}

static void missing_children_and_depth(void) {
    const shape *ball = shape_sphere(shapes, ORIGIN, 1.0), *some[] = {ball, NULL};
    CHECK(!shape_union(shapes, some, 2));
    CHECK(!shape_intersection(shapes, some, 2));
    CHECK(!shape_difference(shapes, NULL, some, 1));
    CHECK(!shape_difference(shapes, ball, some, 2));
    CHECK(!shape_transform(shapes, NULL, IDENTITY, 1.0, ORIGIN));
    const shape *deep = ball;
    for (int depth = 2; depth <= SHAPE_DEPTH_LIMIT; depth++) {
        deep = shape_transform(shapes, deep, IDENTITY, 1.0, ORIGIN);
        CHECK(deep && shape_depth(deep) == depth);
    }
    CHECK(!shape_union(shapes, &deep, 1));
    CHECK_NEAR(distance_at(deep, 3.0, 0.0, 0.0), 2.0, 1e-15);
}

static void descriptions(void) {
    char text[200], cut[16];
    const shape *tree[] = {shape_tube(shapes, ORIGIN, X_AXIS, 0.3, 0.12, 2.0, 0.5), shape_sphere(shapes, ORIGIN, 0.25),
                           shape_box(shapes, ORIGIN, (double[]){1, 2, 3}), shape_torus(shapes, ORIGIN, Z_AXIS, 2, 0.5)};
    const shape *cylinder = shape_cylinder(shapes, ORIGIN, X_AXIS, 0.3, 2.0);
    const shape *s = shape_difference(shapes, cylinder, tree, 2);
    shape_describe(s, text, sizeof text);
    CHECK(strcmp(text, "difference(cylinder r=0.3 l=2, tube r=0.3 hole=0.12 l=2 taper=0.5, sphere r=0.25)") == 0);
    shape_describe(shape_union(shapes, tree + 2, 2), text, sizeof text);
    CHECK(strcmp(text, "union(box 1 x 2 x 3, torus R=2 r=0.5)") == 0);
    memset(text, 'x', sizeof text);
    shape_describe(s, text, 23);
    CHECK(strcmp(text, "difference(cylinder…") == 0);
    for (size_t n = 23; n < sizeof text; n++) CHECK(text[n] == 'x');
    shape_describe(tree[1], cut, sizeof "sphere r=0.25");
    CHECK(strcmp(cut, "sphere r=0.25") == 0);
}

/* Builds a tree whose nodes and lists of children each need blocks of their own; false when memory ran out on the way.
 */
static bool build_tree(void) {
    enum { MANY = 20000 };
    static const shape *all[MANY];
    arena *a = arena_create("test");
    if (!a) return false;
    for (int i = 0; i < MANY; i++) all[i] = i < 400 ? shape_torus(a, ORIGIN, X_AXIS, 2.0, 0.1 + i) : all[i % 400];
    const shape *u = shape_union(a, all, MANY), *n = shape_intersection(a, all, MANY);
    const shape *s = shape_transform(a, shape_difference(a, u, all, 400), IDENTITY, 2.0, X_AXIS);
    arena_destroy(a);
    return s && n;
}

static void every_allocation_may_fail(void) {
    size_t before = memory_live_bytes();
    int failed = 0;
    bool built = false;
    for (int n = 1; n < 100 && !built; n++) {
        memory_fail_after(n, 0);
        built = build_tree();
        memory_fail_after(0, 0);
        CHECK(memory_live_bytes() == before);
        failed += !built;
    }
    CHECK(built);
    CHECK(failed >= 5);
}

int main(void) {
    shapes = arena_create("test shapes");
    if (!shapes) return 1;
    RUN(sphere_closed_form);
    RUN(box_closed_form);
    RUN(cylinder_closed_form);
    RUN(tube_closed_form);
    RUN(tapered_closed_form);
    RUN(capsule_torus_half_space_closed_form);
    RUN(exact_shapes_are_eikonal);
    RUN(tapered_tube_against_brute_force);
    RUN(normals);
    RUN(volumes);
    RUN(volumes_of_trees);
    RUN(bounds_closed_form);
    RUN(bounds_contain);
    RUN(set_identities);
    RUN(transform_identities);
    RUN(children_are_copied);
    RUN(missing_children_and_depth);
    RUN(descriptions);
    RUN(every_allocation_may_fail);
    arena_destroy(shapes);
    CHECK(memory_live_bytes() == 0);
    return check_finish();
}
