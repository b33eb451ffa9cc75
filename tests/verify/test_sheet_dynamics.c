/* Sheets in motion: frequencies, energy, angular momentum, grips and colliders (METHOD.md §6, "Checks"). */
#include "check.h"
#include "verify/sheet_patch.h"

static const double PI = 3.14159265358979323846;

static const shape *box(arena *a, double x0, double y0, double x1, double y1) {
    return shape_box(a, (const double[]){x0, y0, -1e3}, (const double[]){x1, y1, 1e3});
}

static void add_grip(patch *p, const shape *held, const double velocity[3]) {
    rigid_boundary *b = &p->d.boundaries[p->d.boundary_count++];
    *b = (rigid_boundary){.shape = held, .grip = true, .motion = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .active = true}};
    memcpy(b->motion.velocity, velocity, sizeof b->motion.velocity);
}

/* A rectangle a × b, stretched by e both ways and held at its edges, plucked in the mode (m, n): the period from the mode's zero crossings. */
static double frequency(int m, int n, double stretch, double *tension) {
    enum { A = 48, B = 32 };
    double dx = 1.0 / B, E = 100, h = 0.01;
    arena *memory = arena_create("membrane");
    patch *p = patch_create(SHEET_SQUARE, dx, 1.5, h);
    patch_fill(p, A + 3, B + 3); /* two rows on each side are held: those that are free see full neighbourhoods */
    patch_set(p, "linear", "E", E);
    double a = A * dx, b = B * dx, inner = 1.5 * dx, far = 1e3;
    for (int64_t i = 0; i < p->d.count; i++) {
        double x = p->rest[i][0] - dx, y = p->rest[i][1] - dx;
        bool inside = x > -1e-9 && x < a + 1e-9 && y > -1e-9 && y < b + 1e-9;
        p->position[i][0] = (1 + stretch) * p->rest[i][0], p->position[i][1] = (1 + stretch) * p->rest[i][1];
        p->velocity[i][2] = inside ? 1e-4 * sin(m * PI * x / a) * sin(n * PI * y / b) : 0;
    }
    double s = 1 + stretch, right = s * (a + dx) - 0.5 * dx, top = s * (b + dx) - 0.5 * dx;
    const double still[3] = {0};
    add_grip(p, box(memory, -far, -far, inner, far), still);
    add_grip(p, box(memory, right, -far, far, far), still);
    add_grip(p, box(memory, -far, -far, far, inner), still);
    add_grip(p, box(memory, -far, top, far, far), still);
    CHECK(patch_start(p, 64, "auto", 2));
    /* The stretched membrane: tension P per rest length; mode shapes in rest coordinates. */
    *tension = 1.5 * E * h * stretch / s; /* Σ of bonds: transverse stiffness is f/s */
    double dt = 0.5 * patch_limit(p), last = 0, first_zero = 0, last_zero = 0;
    int zeros = 0;
    double *z = malloc((size_t)p->d.count * 3 * sizeof *z);
    for (int k = 0; k < 60000 && zeros < 9; k++) {
        CHECK(patch_steps(p, 1, dt) == STATUS_OK);
        p->engine->read(p->state, "position", z);
        double amplitude = 0;
        for (int64_t i = 0; i < p->d.count; i++)
            amplitude += z[3 * i + 2] * sin(m * PI * (p->rest[i][0] - dx) / a) * sin(n * PI * (p->rest[i][1] - dx) / b);
        if (last * amplitude < 0) {
            last_zero = p->time - dt * amplitude / (amplitude - last);
            if (zeros++ == 0) first_zero = last_zero;
        }
        last = amplitude;
    }
    free(z);
    patch_free(p);
    arena_destroy(memory);
    return 0.5 * (zeros - 1) / (last_zero - first_zero);
}

/* In rest coordinates ρ h ẅ = P (w_xx + w_yy), P the first Piola tension. */
static void a_taut_membrane_sounds_right(void) {
    static const int modes[][2] = {{1, 1}, {2, 1}, {1, 2}};
    for (int k = 0; k < 3; k++) {
        double T, found = frequency(modes[k][0], modes[k][1], 0.05, &T);
        double expected = 0.5 * sqrt(T / (1.0 * 0.01)) * sqrt(pow(modes[k][0] / 1.5, 2) + pow(modes[k][1] / 1.0, 2));
        char text[96];
        snprintf(text, sizeof text, "taut membrane 1.5 × 1, mode (%d, %d): frequency", modes[k][0], modes[k][1]);
        CHECK_ROW("METHOD 6", text, expected, found, 0.01 * expected);
    }
}

/* A free sheet that spins and shakes: means of 1000 steps at the start and at the end of 10⁵ undamped ones. */
static void energy_and_angular_momentum_last(void) {
    patch *p = patch_create(SHEET_HEXAGONAL, 0.1, 1.5, 0.02);
    patch_fill(p, 12, 10);
    patch_set(p, "linear", "E", 50);
    for (int64_t i = 0; i < p->d.count; i++) {
        for (int k = 0; k < 3; k++) p->velocity[i][k] = 0.02 * patch_random((uint64_t)(3 * i + k));
        p->velocity[i][0] -= 0.3 * p->rest[i][1], p->velocity[i][1] += 0.3 * p->rest[i][0];
    }
    CHECK(patch_start(p, 64, "auto", 1));
    double dt = 0.5 * patch_limit(p), mean[2] = {0};
    sheet_measures start = patch_measure(p);
    for (int end = 0; end < 2; end++) {
        if (end) CHECK(patch_steps(p, 98000, dt) == STATUS_OK);
        for (int k = 0; k < 1000; k++) {
            CHECK(patch_steps(p, 1, dt) == STATUS_OK);
            sheet_measures m = patch_measure(p);
            mean[end] += (m.kinetic + m.elastic) / 1000;
        }
    }
    sheet_measures last = patch_measure(p);
    CHECK_ROW("METHOD 6", "free sheet, 100 000 steps undamped: drift of the mean energy", 0, mean[1] / mean[0] - 1, 1e-3);
    CHECK_ROW("METHOD 6", "the same: relative change of the angular momentum", 0, last.angular_momentum[2] / start.angular_momentum[2] - 1, 1e-10);
    CHECK_NEAR(last.momentum[0], start.momentum[0], 1e-12);
    patch_free(p);
}

/* f32 keeps a motion whose steps are far below the last digit of its coordinates. */
static void slow_motion_is_not_lost_in_f32(void) {
    patch *p = patch_create(SHEET_SQUARE, 0.1, 1.5, 0.02);
    patch_fill(p, 8, 8);
    patch_set(p, "linear", "E", 1e-6);
    for (int64_t i = 0; i < p->d.count; i++) p->rest[i][0] += 1000, p->position[i][0] += 1000, p->velocity[i][0] = 1e-3;
    CHECK(patch_start(p, 32, "auto", 1));
    CHECK(patch_steps(p, 10000, 1e-3) == STATUS_OK); /* 1e-6 a step; the last digit at 1000 is 6e-5 */
    double *x = malloc((size_t)p->d.count * 3 * sizeof *x);
    p->engine->read(p->state, "position", x);
    CHECK_ROW("METHOD 6", "f32 at x = 1000, 10⁴ steps of 1e-6: way", 0.01, x[0] - p->rest[0][0], 1e-5);
    free(x);
    patch_free(p);
}

/* A grip pulls a sheet's end: what its work put in is what the sheet has. A collider stops a falling sheet. */
static void boundaries_hold_and_stop(void) {
    arena *memory = arena_create("boundaries");
    patch *p = patch_create(SHEET_SQUARE, 0.1, 1.5, 0.02);
    patch_fill(p, 20, 6);
    patch_set(p, "linear", "E", 10);
    add_grip(p, box(memory, -1, -1, 0.15, 1), (const double[]){0, 0, 0});
    add_grip(p, box(memory, 1.75, -1, 3, 1), (const double[]){0.1, 0, 0.05});
    CHECK(patch_start(p, 64, "auto", 1));
    double dt = 0.2 * patch_limit(p);
    int64_t steps = 4000;
    CHECK(patch_steps(p, steps, dt) == STATUS_OK);
    sheet_measures m = patch_measure(p);
    double *x = malloc((size_t)p->d.count * 3 * sizeof *x);
    p->engine->read(p->state, "position", x);
    CHECK_NEAR(x[3 * 19], 1.9 + 0.1 * dt * (double)steps, 1e-9);
    CHECK_NEAR(x[3 * 19 + 2], 0.05 * dt * (double)steps, 1e-9);
    CHECK_ROW("METHOD 6", "pulled sheet: (kinetic + elastic) / work of grips", 1, (m.kinetic + m.elastic) / m.grip_work, 0.01);
    patch_free(p);
    p = patch_create(SHEET_SQUARE, 0.1, 1.5, 0.02);
    patch_fill(p, 10, 10);
    patch_set(p, "linear", "E", 10);
    p->d.gravity[2] = -1;
    for (int64_t i = 0; i < p->d.count; i++) p->position[i][2] = 0.2;
    p->d.boundaries[0] = (rigid_boundary){.shape = shape_half_space(memory, (const double[]){0, 0, 0}, (const double[]){0, 0, 1}), .contact = CONTACT_SEPARATE,
                                          .motion = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .active = true}};
    p->d.boundary_count = 1;
    CHECK(patch_start(p, 64, "auto", 1));
    CHECK(patch_steps(p, 3000, 1e-3) == STATUS_OK);
    p->engine->read(p->state, "position", x);
    for (int64_t i = 0; i < p->d.count; i++) CHECK(x[3 * i + 2] > -0.02 && x[3 * i + 2] < 0.01);
    free(x);
    patch_free(p);
    arena_destroy(memory);
}

/* A sheet rolled onto a cylinder without stretching stores B/2 for an area and a squared curvature. The energies of two lengths are compared, so that
 * free edges cancel. */
static void a_rolled_sheet_stores_its_bending(void) {
    double B = 0.3, curvature = 0.05, energy[2], dx = 0.1;
    for (int k = 0; k < 2; k++) {
        double stored[2];
        for (int stiff = 0; stiff < 2; stiff++) {
            patch *p = patch_create(SHEET_HEXAGONAL, dx, 1.5, 0.02);
            patch_fill(p, 30 + 10 * k, 14);
            patch_set(p, "linear", "E", 1);
            if (stiff) patch_set(p, "bending", "stiffness", B);
            for (int64_t i = 0; i < p->d.count; i++) {
                double angle = p->rest[i][0] * curvature;
                p->position[i][0] = sin(angle) / curvature, p->position[i][2] = (1 - cos(angle)) / curvature;
            }
            CHECK(patch_start(p, 64, "auto", 1));
            stored[stiff] = patch_measure(p).elastic;
            patch_free(p);
        }
        energy[k] = stored[1] - stored[0];
    }
    double area = 10 * dx * 12 * dx * sqrt(0.75), expected = 0.5 * B * curvature * curvature * area; /* rows at the edge do not count */
    CHECK_ROW("METHOD 6", "sheet on a cylinder: bending energy of 10 more columns", expected, energy[1] - energy[0], 1e-4 * expected);
}

/* One sheet flies at another: with contact they bounce, without it they pass. */
static double closest_approach(bool contact) {
    patch *p = patch_create(SHEET_SQUARE, 0.1, 1.5, 0.02);
    patch_fill(p, 12, 12);
    patch_set(p, "linear", "E", 20);
    if (contact) patch_set(p, "self_contact", "stiffness", 1);
    /* a second sheet above the first, turned by a third of a spacing, falling on it */
    p->d.body_count = 2;
    p->d.bodies[1] = p->d.bodies[0];
    p->d.bodies[1].first = 144;
    for (int i = 0; i < 144; i++) {
        patch_add(p, p->rest[i][0] + 0.03, p->rest[i][1] + 0.04, 0.3, 0.01);
        p->velocity[144 + i][2] = -0.3;
    }
    p->d.bodies[0].count = p->d.bodies[1].count = 144;
    double closest = HUGE_VAL, (*x)[3] = malloc(288 * sizeof *x);
    CHECK(patch_start(p, 64, "auto", 2));
    sheet_measures start = patch_measure(p);
    double dt = 0.2 * patch_limit(p);
    for (int k = 0; k < 150; k++) {
        CHECK(patch_steps(p, 5, dt) == STATUS_OK);
        p->engine->read(p->state, "position", x[0]);
        for (int i = 0; i < 144; i++)
            for (int j = 144; j < 288; j++) closest = fmin(closest, sqrt(pow(x[i][0] - x[j][0], 2) + pow(x[i][1] - x[j][1], 2) + pow(x[i][2] - x[j][2], 2)));
    }
    sheet_measures end = patch_measure(p);
    CHECK_NEAR(end.momentum[2], start.momentum[2], 1e-12);
    if (contact) CHECK_ROW("METHOD 6", "two sheets that collide: energy after over before", 1, (end.kinetic + end.elastic) / (start.kinetic + start.elastic), 0.01);
    free(x);
    patch_free(p);
    return closest;
}

static void sheets_do_not_pass_through_each_other(void) {
    CHECK(closest_approach(true) > 0.045);
    CHECK(closest_approach(false) < 0.055);
}

int main(void) {
    RUN(a_taut_membrane_sounds_right);
    RUN(energy_and_angular_momentum_last);
    RUN(slow_motion_is_not_lost_in_f32);
    RUN(boundaries_hold_and_stop);
    RUN(a_rolled_sheet_stores_its_bending);
    RUN(sheets_do_not_pass_through_each_other);
    return check_finish();
}
