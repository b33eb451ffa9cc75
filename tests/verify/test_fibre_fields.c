/* Fibre fields (METHOD.md section 5) against directions that are known.
 *
 * Flow: in a pipe φ is linear along the axis, in a ring cut open it is the angle around it, between concentric spheres it
 * is 1/r; so the fibres are the axis, the circumference and the radius. Held to 1° everywhere outside inflow and outflow,
 * walls and edges included, on lattices that no axis of the body follows. */
#include "base/random.h"
#include "check.h"
#include "geom/fibre_fields.h"
#include "geom/fibre_flow.h"
#include "geom/vector.h"
#include "unit/mesh_files.h"

#define PI 3.14159265358979323846

static const double ORIGIN[3] = {0, 0, 0}, AXIS[3] = {2.0 / 3, -1.0 / 3, 2.0 / 3}, BACK[3] = {-2.0 / 3, 1.0 / 3, -2.0 / 3},
                    Z_AXIS[3] = {0, 0, 1};

static arena *memory;
static report trouble;

static double angle_between(const double a[3], const double b[3]) {
    double across[3];
    vector_cross(a, b, across);
    return atan2(vector_length(across), fabs(vector_dot(a, b))) * 180 / PI;
}

static void box_point(const double low[3], const double high[3], uint64_t n, double x[3]) {
    for (uint64_t c = 0; c < 3; c++) x[c] = low[c] + (high[c] - low[c]) * random_unit(2, 9, 3 * n + c);
}

/* ---- flow -------------------------------------------------------------------------------------------------------- */

typedef void (*known_field)(const double x[3], double direction[3]);

static void along_axis(const double x[3], double direction[3]) {
    (void)x;
    memcpy(direction, AXIS, 3 * sizeof *direction);
}

static void around_z(const double x[3], double direction[3]) {
    direction[0] = -x[1], direction[1] = x[0], direction[2] = 0;
}

static void outward(const double x[3], double direction[3]) {
    memcpy(direction, x, 3 * sizeof *direction);
}

static const fibre_flow *solved(const flow_definition *d) {
    const fibre_flow *f = NULL;
    char text[900];
    status code = fibre_flow_solve(memory, d, &f, &trouble);
    report_format(&trouble, text, sizeof text);
    CHECK(code == STATUS_OK);
    if (code != STATUS_OK) printf("  %s\n", text);
    return f;
}

/* Largest angles in degrees to what is known: in the free body, of that within 2 % of the surface, and where φ is held. */
typedef struct flow_angles {
    double free, wall, held, mean;
    int count, walls;
} flow_angles;

static flow_angles measure(const flow_definition *d, known_field known) {
    flow_angles a = {0};
    const fibre_flow *f = solved(d);
    if (!f) return a;
    double low[3], high[3], reach = 0;
    shape_bounds(d->body, low, high);
    for (int c = 0; c < 3; c++) reach = fmax(reach, 0.02 * (high[c] - low[c]));
    for (uint64_t n = 0; a.count < 20000 && n < 2000000; n++) {
        double x[3], got[3], want[3];
        box_point(low, high, n, x);
        double depth = shape_distance(d->body, x);
        if (depth >= 0) continue;
        fibre_flow_direction(f, x, got);
        known(x, want);
        CHECK(fabs(vector_length(got) - 1) < 1e-12);
        double angle = angle_between(got, want);
        a.count++;
        if (shape_distance(d->inflow, x) < 0 || shape_distance(d->outflow, x) < 0) {
            a.held = fmax(a.held, angle);
            continue;
        }
        a.free = fmax(a.free, angle);
        a.mean += angle / 20000;
        if (depth > -reach) a.wall = fmax(a.wall, angle), a.walls++;
    }
    return a;
}

static void check_flow(const char *name, const flow_definition *d, known_field known, double free, double held) {
    flow_angles a = measure(d, known);
    printf("  %-24s mean %.3f, worst %.3f, near walls %.3f, where held %.2f degrees\n", name, a.mean, a.free, a.wall, a.held);
    CHECK(a.count == 20000 && (a.walls > 1000 || known == outward)); /* the ball's surface is held */
    char row[128];
    snprintf(row, sizeof row, "flow-generated fibres, %s: worst angle where nothing holds them, degrees", name);
    CHECK_ROW("METHOD 5", row, 0, a.free, free);
    CHECK(a.free > 0);
    CHECK(a.held < held);
}

static void a_pipe_gives_its_axis(void) {
    double end[3], start[3];
    for (int c = 0; c < 3; c++) end[c] = 0.85 * AXIS[c], start[c] = -0.85 * AXIS[c];
    flow_definition d = {.inflow = shape_half_space(memory, start, AXIS), .outflow = shape_half_space(memory, end, BACK)};
    d.body = shape_cylinder(memory, ORIGIN, AXIS, 0.4, 2);
    check_flow("cylinder", &d, along_axis, 1, 3);
    d.body = shape_tube(memory, ORIGIN, AXIS, 0.4, 0.2, 2, 1);
    check_flow("tube", &d, along_axis, 1, 3);
    d.resolution = 40;
    check_flow("tube, 40 cubes long", &d, along_axis, 1, 3);
    d.resolution = 0;
    d.body = shape_tube(memory, ORIGIN, AXIS, 0.4, 0.34, 2, 1);
    check_flow("tube with a thin wall", &d, along_axis, 1, 4);
}

/* A ring without the wedge |y| < x tan(0.2); held where |y| < x tan(0.35). */
static flow_definition cut_ring(const shape *ring) {
    double s = sin(0.2), c = cos(0.2), S = sin(0.35), C = cos(0.35);
    const shape *wedge[] = {shape_half_space(memory, ORIGIN, (double[]){-s, c, 0}),
                            shape_half_space(memory, ORIGIN, (double[]){-s, -c, 0})};
    const shape *in[] = {shape_half_space(memory, ORIGIN, (double[]){-S, C, 0}),
                         shape_half_space(memory, ORIGIN, (double[]){0, -1, 0})};
    const shape *out[] = {shape_half_space(memory, ORIGIN, (double[]){-S, -C, 0}),
                          shape_half_space(memory, ORIGIN, (double[]){0, 1, 0})};
    const shape *gap = shape_intersection(memory, wedge, 2);
    return (flow_definition){.body = shape_difference(memory, ring, &gap, 1), .inflow = shape_intersection(memory, in, 2),
                             .outflow = shape_intersection(memory, out, 2)};
}

static void a_cut_ring_gives_its_circumference(void) {
    flow_definition d = cut_ring(shape_tube(memory, ORIGIN, Z_AXIS, 1, 0.5, 0.5, 1));
    check_flow("cut ring", &d, around_z, 1, 4);
    d.resolution = 40;
    check_flow("cut ring, 40 cubes wide", &d, around_z, 1, 4);
    /* Inflow and outflow in an uncut ring, back to back. */
    d.body = shape_tube(memory, ORIGIN, Z_AXIS, 1, 0.5, 0.5, 1);
    check_flow("uncut ring", &d, around_z, 1, 8);
}

static void a_mesh_may_carry_a_flow(void) {
    static made_mesh made;
    made_torus(&made, 1, 0.3, 120, 60);
    made_file f = made_obj(&made);
    mesh m;
    mesh_report facts;
    CHECK(mesh_read("ring.obj", f.data, f.size, &m, &trouble) == STATUS_OK);
    CHECK(mesh_make_solid("ring.obj", &m, &facts, &trouble) == STATUS_OK);
    flow_definition d = cut_ring(shape_mesh(memory, &m, "ring.obj"));
    check_flow("cut torus, a mesh", &d, around_z, 1, 4);
    mesh_free(&m);
    free(f.data);
}

static void a_ball_with_a_core_gives_its_radius(void) {
    const shape *cube = shape_box(memory, (double[]){-2, -2, -2}, (double[]){2, 2, 2});
    const shape *inner = shape_sphere(memory, ORIGIN, 0.85);
    flow_definition d = {.body = shape_sphere(memory, ORIGIN, 1), .inflow = shape_sphere(memory, ORIGIN, 0.3),
                         .outflow = shape_difference(memory, cube, &inner, 1)};
    check_flow("ball with a core", &d, outward, 1, 90);
}

/* The same problem a thousand times as large and far from the origin has the same directions. */
static void size_and_place_do_not_matter(void) {
    const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, shift[3] = {5000, -3000, 100};
    flow_definition d = cut_ring(shape_tube(memory, ORIGIN, Z_AXIS, 1, 0.5, 0.5, 1)), moved = {.resolution = 30};
    d.resolution = 30;
    moved.body = shape_transform(memory, d.body, identity, 1000, shift);
    moved.inflow = shape_transform(memory, d.inflow, identity, 1000, shift);
    moved.outflow = shape_transform(memory, d.outflow, identity, 1000, shift);
    const fibre_flow *f = solved(&d), *g = solved(&moved), *again = solved(&d);
    double worst = 0;
    for (uint64_t n = 0; f && g && again && n < 5000; n++) {
        double x[3], y[3], a[3], b[3], c[3];
        box_point((double[]){-1, -1, -0.25}, (double[]){1, 1, 0.25}, n, x);
        for (int k = 0; k < 3; k++) y[k] = 1000 * x[k] + shift[k];
        if (shape_distance(d.body, x) >= 0) continue;
        fibre_flow_direction(f, x, a);
        fibre_flow_direction(g, y, b);
        fibre_flow_direction(again, x, c);
        worst = fmax(worst, angle_between(a, b));
        CHECK(memcmp(a, c, sizeof a) == 0);
    }
    CHECK_NEAR(worst, 0, 1e-3);
}

/* A second piece that no flow reaches, and a place outside: some direction of length 1, from what is nearest. */
static void what_no_flow_reaches_continues_it(void) {
    const shape *parts[] = {shape_box(memory, (double[]){0, 0, 0}, (double[]){3, 0.6, 0.6}),
                            shape_box(memory, (double[]){0, 2, 0}, (double[]){3, 2.6, 0.6})};
    flow_definition d = {.body = shape_union(memory, parts, 2), .resolution = 30};
    d.inflow = shape_box(memory, (double[]){-1, -1, -1}, (double[]){0.3, 1, 1});
    d.outflow = shape_box(memory, (double[]){2.7, -1, -1}, (double[]){4, 1, 1});
    const fibre_flow *f = solved(&d);
    const double places[][3] = {{1.5, 2.3, 0.3}, {1.5, 9, 9}, {-50, 0, 0}, {0.1, 0.3, 0.3}, {2.9, 0.1, 0.5}};
    for (int k = 0; f && k < 5; k++) {
        double a[3];
        fibre_flow_direction(f, places[k], a);
        CHECK_NEAR(a[0], 1, 1e-3); /* from inflow to outflow */
    }
}

static void refused(const flow_definition *d, const char *key, const char *expected) {
    const fibre_flow *f;
    CHECK(fibre_flow_solve(memory, d, &f, &trouble) == STATUS_INPUT && f == NULL);
    CHECK(strcmp(trouble.key, key) == 0 && strstr(trouble.expected, expected));
    if (strcmp(trouble.key, key) != 0 || !strstr(trouble.expected, expected)) printf("  said: %s: %s\n", trouble.key, trouble.expected);
}

static void wrong_flows(void) {
    const shape *bar = shape_box(memory, ORIGIN, (double[]){2, 0.5, 0.5});
    const shape *left = shape_box(memory, (double[]){-1, -1, -1}, (double[]){0.2, 1, 1});
    const shape *right = shape_box(memory, (double[]){1.8, -1, -1}, (double[]){3, 1, 1});
    const shape *away = shape_sphere(memory, (double[]){9, 9, 9}, 1);
    flow_definition d = {bar, left, away, 20};
    refused(&d, "outflow", "a shape that holds a part of the body");
    d = (flow_definition){bar, away, right, 20};
    refused(&d, "inflow", "a shape that holds a part of the body");
    d = (flow_definition){bar, shape_sphere(memory, ORIGIN, 9), right, 20};
    refused(&d, "inflow", "a shape that holds a part of the body, and not all of it");
    d = (flow_definition){shape_half_space(memory, ORIGIN, AXIS), left, right, 20};
    refused(&d, "shape", "a bounded shape");
    d = (flow_definition){bar, left, shape_box(memory, (double[]){0.25, -1, -1}, (double[]){3, 1, 1}), 10};
    refused(&d, "resolution", "cubes smaller than what lies between inflow and outflow");
    const shape *cut = shape_box(memory, (double[]){0.8, -1, -1}, (double[]){1.2, 1, 1});
    d = (flow_definition){shape_difference(memory, bar, &cut, 1), left, right, 20};
    refused(&d, "outflow", "inflow and outflow that the body joins");
    d = (flow_definition){shape_box(memory, ORIGIN, (double[]){1, 1, 1}), left, right, 256};
    refused(&d, "resolution", "a lattice of at most 8 million nodes");
}

static void every_allocation_of_a_flow_may_fail(void) {
    flow_definition d = {shape_box(memory, ORIGIN, (double[]){2, 0.5, 0.5}),
                         shape_box(memory, (double[]){-1, -1, -1}, (double[]){0.2, 1, 1}),
                         shape_box(memory, (double[]){1.8, -1, -1}, (double[]){3, 1, 1}), 12};
    size_t before = memory_live_bytes();
    int failed = 0;
    status code = STATUS_SYSTEM;
    for (int n = 1; n < 100 && code != STATUS_OK; n++) {
        memory_fail_after(n, 0);
        arena *a = arena_create("flow");
        const fibre_flow *f = NULL;
        code = a ? fibre_flow_solve(a, &d, &f, &trouble) : STATUS_SYSTEM;
        memory_fail_after(0, 0);
        CHECK((code == STATUS_OK) == (f != NULL) && (code == STATUS_OK || code == STATUS_SYSTEM));
        arena_destroy(a);
        CHECK(memory_live_bytes() == before);
        failed += code != STATUS_OK;
    }
    CHECK(code == STATUS_OK && failed >= 15);
}

/* ---- curves ------------------------------------------------------------------------------------------------------ */

static void a_curve_is_followed(void) {
    enum { POINTS = 49 };
    double points[POINTS][3], x[3], a[3], want[3];
    const double line[2][3] = {{0, 0, 0}, {4, -2, 4}};
    const fibre_curve *c = fibre_curve_create(memory, line[0], 2);
    for (uint64_t n = 0; n < 100; n++) {
        box_point((double[]){-9, -9, -9}, (double[]){9, 9, 9}, n, x);
        fibre_curve_direction(c, x, a);
        CHECK(angle_between(a, AXIS) < 1e-6);
    }
    /* A circle of 48 chords of 7.5°: the direction turns along each chord, so that what is left is far below that. */
    for (int i = 0; i < POINTS; i++) points[i][0] = cos(2 * PI * i / 48), points[i][1] = sin(2 * PI * i / 48), points[i][2] = 0;
    memcpy(points[POINTS - 1], points[0], sizeof points[0]);
    c = fibre_curve_create(memory, points[0], POINTS);
    double worst = 0;
    for (uint64_t n = 0; n < 4000; n++) {
        box_point((double[]){-1.3, -1.3, -0.3}, (double[]){1.3, 1.3, 0.3}, n, x);
        double radius = hypot(x[0], x[1]);
        if (radius < 0.7 || radius > 1.3) continue;
        fibre_curve_direction(c, x, a);
        around_z(x, want);
        worst = fmax(worst, angle_between(a, want));
    }
    printf("  circle of 48 chords: worst %.3f degrees\n", worst);
    CHECK(worst > 0 && worst < 1);
}

/* Around the inside of a corner the nearest segment changes at once; the direction must not. */
static void a_curve_turns_corners_smoothly(void) {
    const double corner[3][3] = {{0, 1, 0}, {0, 0, 0}, {1, 0, 0}};
    const fibre_curve *c = fibre_curve_create(memory, corner[0], 3);
    double before[3], a[3], sharpest = 0;
    for (int i = 0; i <= 4000; i++) {
        double u = -0.2 + 0.9 * i / 4000, x[3] = {u, 0.5 - u, 0.1};
        fibre_curve_direction(c, x, a);
        CHECK(fabs(vector_length(a) - 1) < 1e-12);
        if (i > 0) sharpest = fmax(sharpest, angle_between(a, before));
        memcpy(before, a, sizeof a);
    }
    CHECK(sharpest < 0.2); /* 90° in 4000 steps that were even would be 0.02° each */
    const double diagonal[3] = {0.3, 0.3, 0}, want[3] = {1, -1, 0};
    fibre_curve_direction(c, diagonal, a);
    CHECK(angle_between(a, want) < 1e-6);
    fibre_curve_direction(c, (double[]){0, 1, 0}, a);
    CHECK(angle_between(a, (double[]){0, 1, 0}) < 1e-6);
    const double back[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}}; /* there and back */
    c = fibre_curve_create(memory, back[0], 3);
    fibre_curve_direction(c, (double[]){0.5, 0.1, 0}, a);
    CHECK(angle_between(a, (double[]){1, 0, 0}) < 1e-6);
}

/* ---- random ------------------------------------------------------------------------------------------------------ */

static void random_cones(void) {
    static const double spreads[] = {0.05, 0.6, 0.5 * PI, PI};
    for (int k = 0; k < 4; k++) {
        enum { MANY = 40000 };
        double s = spreads[k], least = 1, mean = 0, across[3] = {0, 0, 0};
        int different = 0;
        for (uint64_t n = 0; n < MANY; n++) {
            double x[3], a[3], b[3];
            box_point((double[]){-1, -1, -1}, (double[]){1, 1, 1}, n, x);
            fibre_random_direction(AXIS, s, 7, x, a);
            fibre_random_direction(AXIS, s, 8, x, b);
            different += memcmp(a, b, sizeof a) != 0;
            fibre_random_direction(AXIS, s, 7, x, b);
            CHECK(memcmp(a, b, sizeof a) == 0);
            CHECK(fabs(vector_length(a) - 1) < 1e-12);
            double cosine = vector_dot(a, AXIS);
            least = fmin(least, cosine), mean += cosine / MANY;
            for (int c = 0; c < 3; c++) across[c] += (a[c] - cosine * AXIS[c]) / MANY;
        }
        /* cos is even over [cos s, 1]: its mean is known, and its standard error (1 − cos s)/√(12 n). */
        CHECK(least >= cos(s) - 1e-12 && least < cos(s) + 0.01 * (1 - cos(s)));
        CHECK_NEAR(mean, 0.5 * (1 + cos(s)), 5 * (1 - cos(s)) / sqrt(12.0 * MANY));
        CHECK(vector_length(across) < 5 * sin(fmin(s, 1.0)) / sqrt((double)MANY));
        CHECK(different == MANY);
    }
    double a[3], b[3];
    fibre_random_direction(AXIS, 0, 7, ORIGIN, a);
    CHECK(angle_between(a, AXIS) < 1e-6);
    fibre_random_direction(AXIS, 1, 7, ORIGIN, a);
    fibre_random_direction(AXIS, 1, 7, (double[]){-0.0, 0, -0.0}, b);
    CHECK(memcmp(a, b, sizeof a) == 0);
}

/* ---- tables ------------------------------------------------------------------------------------------------------ */

static const fibre_table *table_of(const char *text) {
    const fibre_table *t;
    char said[900];
    status code = fibre_table_read(memory, "t.csv", text, strlen(text), &t, &trouble);
    report_format(&trouble, said, sizeof said);
    CHECK(code == STATUS_OK);
    if (code != STATUS_OK) printf("  %s\n", said);
    return t;
}

static void tables_are_read(void) {
    double a[6];
    const fibre_table *t = table_of("\xef\xbb\xbfx,y,z,dx,dy,dz\r\n# a comment\r\n0,0,0,1,0,0\r\n\r\n2, 0, 0, 0, 3, 0 # last\r\n");
    if (!t) return;
    CHECK(fibre_table_families(t) == 1);
    fibre_table_nearest(t, (double[]){1.1, 5, 5}, a);
    CHECK(a[0] == 0 && a[1] == 3 && a[2] == 0);
    fibre_table_nearest(t, (double[]){0.9, 5, 5}, a);
    CHECK(a[0] == 1 && a[1] == 0);
    t = table_of("0;0;0;1;0;0;0;1;0\n1\t0 0 0 1 0 0 0 1e0");
    if (!t) return;
    CHECK(fibre_table_families(t) == 2);
    fibre_table_blend(t, (double[]){1, 0, 0}, a);
    CHECK(a[0] == 0 && a[1] == 1 && a[2] == 0 && a[3] == 0 && a[4] == 0 && a[5] == 1);
    fibre_table_blend(t, (double[]){0.5, 0, 0}, a);
    CHECK(angle_between(a, (double[]){1, 1, 0}) < 1e-6 && angle_between(a + 3, (double[]){0, 1, 1}) < 1e-6);
}

static void table_refused(const char *text, const char *words) {
    const fibre_table *t;
    char said[900];
    CHECK(fibre_table_read(memory, "t.csv", text, strlen(text), &t, &trouble) == STATUS_INPUT && !t);
    report_format(&trouble, said, sizeof said);
    CHECK(strstr(said, words) == said);
    if (strstr(said, words) != said) printf("  said: %s\n", said);
}

static void wrong_tables(void) {
    table_refused("x,y,z,dx,dy,dz\n0,0,0,1,0,0\n0,0,0,1,0\n", "t.csv:3: expected 6 numbers, as in the rows before, found 5 numbers");
    table_refused("0,0,0,1\n", "t.csv:1: expected x, y, z, dx, dy, dz, or three numbers more, found 4 numbers");
    table_refused("0 0 0 1 0 0 0 0 1 1 1 1\n", "t.csv:1: expected x, y, z, dx, dy, dz, or three numbers more, found more than 9");
    table_refused("0,0,0,1,0,0\n0,0,zero,1,0,0\n", "t.csv:2: expected a number, found 'zero'");
    table_refused("0,0,0,1,0,0\nx,y,z,dx,dy,dz\n", "t.csv:2: expected a number, found 'x'");
    table_refused("# c\n0,0,nan,1,0,0\n", "t.csv:2: expected a number, found 'nan'");
    table_refused("0,0,0,1,0,0\n\n0,0,0,0,0,0\n", "t.csv:3: expected directions of some length, found 0 0 0");
    table_refused("x,y,z,dx,dy,dz\n# nothing\n", "t.csv: expected rows of x, y, z, dx, dy, dz, found none");
    table_refused("", "t.csv: expected rows");
    table_refused("a\nb\n", "t.csv:2: expected a number, found 'b'");
}

/* Rows of a swirl, some turned the other way round, in an order of their own. */
static const fibre_table *swirl(int rows, double (*kept)[6]) {
    char *text = malloc((size_t)rows * 200);
    size_t used = 0;
    for (int n = 0; n < rows; n++) {
        double *v = kept[n], sign = random_unit(1, 1, (uint64_t)n) < 0.5 ? -1 : 1;
        box_point((double[]){-1, -1, -1}, (double[]){1, 1, 1}, (uint64_t)n + 777, v);
        v[3] = sign * (2 - v[1]), v[4] = sign * v[0], v[5] = sign * 0.3 * v[2];
        used += (size_t)sprintf(text + used, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", v[0], v[1], v[2], v[3], v[4], v[5]);
    }
    const fibre_table *t = table_of(text);
    free(text);
    return t;
}

static void tables_against_brute_force(void) {
    enum { ROWS = 3000 };
    static double rows[ROWS][6];
    const fibre_table *t = swirl(ROWS, rows);
    double worst = 0;
    for (uint64_t n = 0; t && n < 2000; n++) {
        double x[3], a[3], best = HUGE_VAL;
        int nearest = 0;
        box_point((double[]){-1, -1, -1}, (double[]){1, 1, 1}, n, x);
        for (int k = 0; k < ROWS; k++) {
            double d[3];
            vector_subtract(x, rows[k], d);
            if (vector_dot(d, d) < best) best = vector_dot(d, d), nearest = k;
        }
        fibre_table_nearest(t, x, a);
        CHECK(memcmp(a, rows[nearest] + 3, sizeof a) == 0);
        const double want[3] = {2 - x[1], x[0], 0.3 * x[2]};
        fibre_table_blend(t, x, a);
        worst = fmax(worst, angle_between(a, want));
    }
    printf("  3000 rows of a swirl: blend worst %.2f degrees\n", worst);
    CHECK(worst > 0 && worst < 8);
    double before[3], sharpest = 0; /* along a line rows come and go: without a jump */
    for (int i = 0; t && i <= 20000; i++) {
        double x[3] = {-1 + 2.0 * i / 20000, 0.31, -0.2}, a[3];
        fibre_table_blend(t, x, a);
        if (i > 0) sharpest = fmax(sharpest, angle_between(a, before));
        memcpy(before, a, sizeof a);
    }
    CHECK(sharpest < 0.1);
}

static void table_garbage_and_memory(void) {
    static const char spice[] = "0123456789-+.e ,;\n#x\xff";
    const char *text = "x,y,z,dx,dy,dz\n0,0,0,1,0,0\n1,0,0,0.5,1e-3,0\n0,1,0,0,0,-2\n";
    const size_t size = strlen(text), before = memory_live_bytes();
    for (uint64_t n = 0; n < 20000; n++) {
        char *copy = malloc(size); /* of just this size: sanitizers see what is read behind it */
        memcpy(copy, text, size);
        for (uint64_t c = 0; c < 1 + n % 5; c++)
            copy[random_bits(1, c, n) % size] = spice[random_bits(2, c, n) % (sizeof spice - 1)];
        arena *a = arena_create("table");
        const fibre_table *t;
        double v[6] = {0};
        status code = fibre_table_read(a, "t.csv", copy, size - n % 3, &t, &trouble);
        if (code == STATUS_OK) fibre_table_blend(t, ORIGIN, v);
        CHECK(code == STATUS_OK ? isfinite(v[0] + v[1] + v[2]) : code == STATUS_INPUT);
        arena_destroy(a);
        free(copy);
    }
    CHECK(memory_live_bytes() == before);
    int failed = 0;
    status code = STATUS_SYSTEM;
    for (int n = 1; n < 20 && code != STATUS_OK; n++) {
        arena *a = arena_create("table");
        const fibre_table *t;
        memory_fail_after(n, 0);
        code = fibre_table_read(a, "t.csv", text, size, &t, &trouble);
        memory_fail_after(0, 0);
        arena_destroy(a);
        failed += code == STATUS_SYSTEM;
        CHECK(memory_live_bytes() == before);
    }
    CHECK(code == STATUS_OK && failed >= 2);
}

int main(void) {
    memory = arena_create("test fields");
    if (!memory) return 1;
    RUN(a_pipe_gives_its_axis);
    RUN(a_cut_ring_gives_its_circumference);
    RUN(a_mesh_may_carry_a_flow);
    RUN(a_ball_with_a_core_gives_its_radius);
    RUN(size_and_place_do_not_matter);
    RUN(what_no_flow_reaches_continues_it);
    RUN(wrong_flows);
    RUN(every_allocation_of_a_flow_may_fail);
    RUN(a_curve_is_followed);
    RUN(a_curve_turns_corners_smoothly);
    RUN(random_cones);
    RUN(tables_are_read);
    RUN(wrong_tables);
    RUN(tables_against_brute_force);
    RUN(table_garbage_and_memory);
    arena_destroy(memory);
    CHECK(memory_live_bytes() == 0);
    return check_finish();
}
