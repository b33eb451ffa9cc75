/* Contact of sheets and solids: conservation, balance of forces, friction, no way through (METHOD.md, end of §6). */
#include "check.h"
#include "verify/solid_scene.h"

#include "base/memory.h"

enum { MOST = 20000 };
static double film[3 * MOST], body[3 * MOST];

static const shape *ball(arena *a) {
    return shape_sphere(a, (const double[]){0, 0, 0.27}, 0.15);
}

static const shape *block(arena *a) {
    return shape_box(a, (const double[]){-0.1, -0.1, 0.03}, (const double[]){0.1, 0.1, 0.13});
}

static const shape *rod(arena *a) {
    return shape_cylinder(a, (const double[]){0, 0, 0.095}, (const double[]){0, 1, 0}, 0.07, 0.4);
}

/* A solid above a film in the plane z = dx/2, half sides `x` and `y`: no node of the grid lies in what grips the film. */
static scene *film_and(const shape *(*make)(arena *), double E, double density, double x, double y, double friction) {
    scene *s = test_scene(make, E, 0.3, density);
    int count;
    const effect *const *effects = effect_catalogue(&count);
    s->dx = 0.04;
    s->material_count = 2;
    snprintf(s->materials[1].name, sizeof s->materials[1].name, "film");
    s->materials[1].density = 100;
    for (int e = 0; e < count; e++) effect_values_default(effects[e], &s->materials[1].effects[e]);
    s->sheet_count = 1;
    s->sheets[0] = (scene_sheet){.name = "film", .material = 1, .radius = 1.5, .thickness = 0.02, .spacing = 0.02,
                                 .region = {.shape = shape_box(s->memory, (const double[]){-x, -y, -1}, (const double[]){x, y, 1}), .point = {0, 0, 0.02}, .normal = {0, 0, 1}}};
    test_set_material(s, 1, "linear", "E", 1e4);
    effect_values *contact = &s->effects[effect_index("contact")];
    contact->on = contact->given[0] = true;
    contact->value[0][0] = friction;
    return s;
}

static void pull_down(scene *s, double gx, double gz) {
    effect_values *gravity = &s->effects[effect_index("gravity")];
    gravity->on = gravity->given[0] = true;
    gravity->value[0][0] = gx, gravity->value[0][2] = gz;
}

static void hold(scene *s, double low, double high, double speed) {
    s->grips[s->grip_count++] = (scene_grip){.shape = shape_box(s->memory, (const double[]){low, -9, 0.011}, (const double[]){high, 9, 0.029}), .stop = HUGE_VAL,
                                             .velocity = {.outputs = 3, .constant = {speed, 0, 0}}};
}

static bool advance(simulation *sim, int frames) {
    report r;
    for (int f = 0; sim && f < frames; f++)
        if (simulation_advance(sim, NULL, &r) != STATUS_OK) {
            printf("  %s\n", r.message);
            return false;
        }
    return sim != NULL;
}

static simulation_measures measure(simulation *sim) {
    simulation_measures m = {0};
    report r;
    if (sim) simulation_measure(sim, &m, &r);
    return m;
}

/* ---- conservation ------------------------------------------------------------------------------------------------ */

static status throw_down(void *context, const double *x, int inputs, double *out, int outputs, report *r) {
    (void)context, (void)inputs, (void)outputs, (void)r;
    out[0] = 0.6 - 3 * x[1], out[1] = 0.2 + 3 * x[0], out[2] = -2;
    return STATUS_OK;
}

/* A body whose particles weigh differently. */
static status weigh(void *context, const double *x, int inputs, double *out, int outputs, report *r) {
    (void)context, (void)inputs, (void)outputs, (void)r;
    out[0] = 50 + 150 * x[0];
    return STATUS_OK;
}

static scene *thrown(double friction) {
    scene *s = film_and(ball, 2e3, 50, 0.3, 0.3, friction);
    s->materials[0].variations[s->materials[0].variation_count++] = (scene_variation){.effect = -1, .function = {.outputs = 1, .call = weigh}};
    s->bodies[0].sampling = SAMPLING_JITTERED;
    s->bodies[0].velocity = (scene_function){.outputs = 3, .call = throw_down};
    s->fps = 100;
    return s;
}

static double length(const double a[3]) {
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

static void nothing_is_lost(void) {
    scene *s = thrown(0.4);
    simulation *sim = test_simulation(s, 64, "auto", 2);
    CHECK(advance(sim, 1)); /* the affine velocities are there */
    simulation_measures a = measure(sim), b;
    CHECK(advance(sim, 14));
    b = measure(sim);
    double p[3], l[3], passed = 0;
    for (int c = 0; c < 3; c++) p[c] = b.solid.momentum[c] - a.solid.momentum[c], l[c] = b.solid.angular_momentum[c] - a.solid.angular_momentum[c];
    CHECK_ROW("METHOD 6", "spinning ball on a free film, friction 0.4: relative change of momentum", 0, length(p) / length(a.solid.momentum), 1e-12);
    CHECK_ROW("METHOD 6", "the same: of angular momentum", 0, length(l) / length(a.solid.angular_momentum), 1e-12);
    if (sim) passed = b.sheet.momentum[2] / a.solid.momentum[2];
    CHECK(passed > 0.2); /* the film has taken its part */
    double before = a.solid.kinetic + a.solid.elastic, after = b.solid.kinetic + b.solid.elastic;
    CHECK(after < before);
    simulation_destroy(sim);
    scene_destroy(s);
}

static uint64_t hash_of_throw(int threads, int precision, double friction, bool apart, bool on) {
    scene *s = thrown(friction);
    report r;
    uint64_t hash = 0;
    if (apart) s->bodies[0].velocity = (scene_function){0};
    s->effects[effect_index("contact")].on = on;
    simulation *sim = test_simulation(s, precision, "auto", threads);
    CHECK(advance(sim, 8) && simulation_hash(sim, &hash, &r) == STATUS_OK);
    simulation_destroy(sim);
    scene_destroy(s);
    return hash;
}

static void bits_do_not_depend_on_threads(void) {
    for (int precision = 32; precision <= 64; precision += 32) {
        uint64_t one = hash_of_throw(1, precision, 0.4, false, true);
        CHECK(one == hash_of_throw(3, precision, 0.4, false, true));
        CHECK(one != hash_of_throw(1, precision, 0, false, true));
        CHECK(one != hash_of_throw(1, precision, 0.4, false, false));
        CHECK(hash_of_throw(1, precision, 0.4, true, true) == hash_of_throw(1, precision, 0.4, true, false)); /* apart they feel nothing */
    }
}

static const shape *ball_below(arena *a) {
    return shape_sphere(a, (const double[]){0, 0, 0.04 - 0.27}, 0.15);
}

static status meet(void *context, const double *x, int inputs, double *out, int outputs, report *r) {
    (void)inputs, (void)outputs, (void)r;
    out[0] = 0.6 - 3 * x[1], out[1] = 0.2 + 3 * x[0], out[2] = -2 * *(const double *)context;
    return STATUS_OK;
}

/* Momentum along z that a film has taken from a ball that comes from one side of it. */
static double taken_from(const shape *(*make)(arena *), double side) {
    scene *s = film_and(make, 2e3, 50, 0.3, 0.3, 0.4);
    s->bodies[0].velocity = (scene_function){.outputs = 3, .call = meet, .context = &side};
    s->fps = 100;
    simulation *sim = test_simulation(s, 64, "auto", 1);
    CHECK(advance(sim, 15));
    simulation_measures m = measure(sim);
    simulation_destroy(sim);
    scene_destroy(s);
    return m.sheet.momentum[2];
}

/* But for the order in which groups of particles are gone through, which goes by blocks of the grid: those are not mirrored. */
static void both_sides_of_a_film_are_alike(void) {
    double above = taken_from(ball, 1), below = taken_from(ball_below, -1);
    CHECK(above < -0.01);
    CHECK_ROW("METHOD 6", "the same from below a film, over that from above: momentum that it takes", 1, -below / above, 2e-3);
}

/* ---- balance ----------------------------------------------------------------------------------------------------- */

/* A film between two held ends carries a rod at rest: each half is straight, stretched by ε, and leans by θ: W = 2 T sin θ, T = E h b ε,
 * 1 + ε = 1/cos θ between where the rod begins to touch and the ends; a slender rod touches nearly on a line. */
static void a_film_carries_a_rod(void) {
    scene *s = film_and(rod, 1e4, 200, 0.4, 0.2, 0.3);
    double g = 5, W, theta = 0.1, b = 0.4 + 0.02, half = 0.38;
    s->fps = 10;
    effect_values *damping = &s->effects[effect_index("mass_damping")];
    damping->on = damping->given[0] = true;
    damping->value[0][0] = 6;
    test_set_material(s, 1, "damping", "rate", 6);
    pull_down(s, 0, -g);
    hold(s, -9, -half, 0);
    hold(s, half, 9, 0);
    simulation *sim = test_simulation(s, 64, "auto", 2);
    CHECK(advance(sim, 25));
    simulation_measures m = measure(sim), later;
    uint64_t allocations = memory_allocation_count();
    CHECK(advance(sim, 5));
    CHECK(memory_allocation_count() == allocations); /* nothing new is near */
    later = measure(sim);
    double low = 0;
    W = (m.solid.mass - m.sheet.mass) * g;
    double weight = (later.solid.grip_impulse[2] - m.solid.grip_impulse[2]) / 0.5;
    CHECK_ROW("METHOD 6", "rod at rest on a held film: force on the grips over the weight of both", 1, weight / (m.solid.mass * g), 0.01);
    CHECK(m.solid.kinetic < 1e-3 * W * 0.1);
    /* the film's own weight hangs from it too: half of it as if in the middle */
    W += 0.5 * m.sheet.mass * g;
    double from = 0, to = 1.2; /* 2 T sin θ grows with θ */
    for (int k = 0; k < 100; k++) {
        theta = 0.5 * (from + to);
        if (2 * 1e4 * 0.02 * b * (1 / cos(theta) - 1) * sin(theta) < W) from = theta;
        else to = theta;
    }
    if (sim) {
        simulation_read(sim, "position", film);
        int64_t solids = simulation_get_plan(sim)->particles - simulation_get_plan(sim)->sheet_particles, sheets = simulation_get_plan(sim)->sheet_particles;
        for (int64_t i = solids; i < solids + sheets; i++) low = fmin(low, film[3 * i + 2] - 0.02);
    }
    CHECK_ROW("METHOD 6", "the same: how far it sags, over what the film's stretch says", 1, -low / (half * tan(theta)), 0.04);
    simulation_destroy(sim);
    scene_destroy(s);
}

/* ---- friction ---------------------------------------------------------------------------------------------------- */

/* A block on a film that is held everywhere, gravity leaning by the slope 0.5: acceleration along it, and the speed after a while. */
static double slide(double friction, double crowd, double *speed) {
    scene *s = film_and(block, 5e3, 100, 0.5, 0.2, friction);
    s->fps = 20;
    s->seed = 3;
    s->particles_per_cell = crowd;
    pull_down(s, 2, -4);
    hold(s, -9, 9, 0);
    simulation *sim = test_simulation(s, 64, "auto", 2);
    CHECK(advance(sim, 3));
    simulation_measures a = measure(sim), b;
    CHECK(advance(sim, 5));
    b = measure(sim);
    double mass = a.solid.mass - a.sheet.mass;
    *speed = b.solid.momentum[0] / mass;
    simulation_destroy(sim);
    scene_destroy(s);
    return (b.solid.momentum[0] - a.solid.momentum[0]) / mass / 0.25;
}

static void friction_is_coulombs(void) {
    double speed;
    CHECK_ROW("METHOD 6", "block on a held film, slope 1/2, no friction: acceleration", 2, slide(0, 8, &speed), 0.05);
    CHECK_ROW("METHOD 6", "the same, friction 0.3", 2 - 0.3 * 4, slide(0.3, 8, &speed), 0.08);
    (void)slide(0.8, 8, &speed);
    CHECK_ROW("METHOD 6", "the same, friction 0.8: speed after it has come to rest", 0, speed, 0.02);
    CHECK_ROW("METHOD 6", "the same, friction 0.3, 216 particles a cell (880 in a film particle's reach)", 2 - 0.3 * 4, slide(0.3, 216, &speed), 0.08);
}

/* A strip drawn over a cylinder that is held: the tensions to both sides differ by exp(μ θ), θ being the angle that it lies on (Euler, Eytelwein). The cylinder is pressed
 * into the strip while the strip's ends come nearer, then both ends move the same way. Angles and tensions come from straight pieces of the strip, whose middles are 0.78 apart at rest; the
 * film's own damping, ρ h · rate · speed, adds to the tension between them. */
typedef struct capstan_motion {
    double way[3];
    double speed; /* along x, once it is pressed */
} capstan_motion;

static status move_capstan(void *context, const double *t, int inputs, double *out, int outputs, report *r) {
    (void)inputs, (void)outputs, (void)r;
    static const double till = 0.6;
    const capstan_motion *m = context;
    double pace = t[0] < till ? M_PI / (2 * till) * sin(M_PI * t[0] / till) : 0;
    for (int c = 0; c < 3; c++) out[c] = m->way[c] * pace;
    if (t[0] > till) out[0] += m->speed * fmin(1, (t[0] - till) / 0.2);
    return STATUS_OK;
}

static const shape *drum(arena *a) {
    return shape_cylinder(a, (const double[]){0, 0, 0.151}, (const double[]){0, 1, 0}, 0.12, 0.24);
}

static scene *capstan(double friction, capstan_motion motions[3]) {
    scene *s = film_and(drum, 1e5, 200, 0.6, 0.06, friction);
    s->fps = 50;
    s->dx = 0.03;
    s->cfl = 0.8;
    test_set_material(s, 1, "damping", "rate", 4);
    hold(s, -9, -0.55, 0);
    hold(s, 0.55, 9, 0);
    s->grips[s->grip_count++] = (scene_grip){.shape = shape_cylinder(s->memory, (const double[]){0, 0, 0.151}, (const double[]){0, 1, 0}, 0.09, 0.4), .stop = HUGE_VAL};
    motions[0] = (capstan_motion){{0.095, 0, 0}, 0.03};
    motions[1] = (capstan_motion){{-0.095, 0, 0}, 0.03};
    motions[2] = (capstan_motion){{0, 0, -0.35}, 0};
    for (int g = 0; g < 3; g++) s->grips[g].velocity = (scene_function){.outputs = 3, .call = move_capstan, .context = &motions[g]};
    return s;
}

/* Mean places of the film's columns at rest within a spacing of x. */
static void middle_of(const double *rest, const double *now, int64_t count, double x, double from[3], double to[3]) {
    double found = 0;
    for (int c = 0; c < 3; c++) from[c] = to[c] = 0;
    for (int64_t i = 0; i < count; i++) {
        if (fabs(rest[3 * i] - x) > 0.021) continue;
        for (int c = 0; c < 3; c++) from[c] += rest[3 * i + c], to[c] += now[3 * i + c];
        found++;
    }
    for (int c = 0; c < 3; c++) from[c] /= found, to[c] /= found;
}

/* ln(T2/T1) less what damping adds, and θ: means of the last frames. */
static void draw_over(double friction, double *ratio, double *angle) {
    capstan_motion motions[3];
    scene *s = capstan(friction, motions);
    simulation *sim = test_simulation(s, 64, "auto", 2);
    int64_t sheets = sim ? simulation_get_plan(sim)->sheet_particles : 0, solids = sim ? simulation_get_plan(sim)->particles - sheets : 0;
    static double rest[3 * MOST];
    *ratio = *angle = 0;
    if (sim) simulation_read(sim, "position", rest);
    for (int f = 0; f < 110; f++) {
        CHECK(advance(sim, 1));
        if (f < 80) continue;
        double stretch[2];
        simulation_read(sim, "position", film);
        for (int side = 0; side < 2; side++) {
            double sign = side ? 1 : -1, a[3], b[3], p[3], q[3];
            middle_of(rest + 3 * solids, film + 3 * solids, sheets, sign * 0.28, a, p);
            middle_of(rest + 3 * solids, film + 3 * solids, sheets, sign * 0.50, b, q);
            double way[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
            stretch[side] = length(way) / fabs(b[0] - a[0]) - 1;
            *angle += atan2(way[2], fabs(way[0])) / 30;
        }
        double tension = 1e4 * 0.5 * (stretch[0] + stretch[1]), drag = 100 * 4 * 0.03 * 0.78; /* both over the thickness */
        *ratio += (log(stretch[1] / stretch[0]) - drag / tension) / 30;
    }
    simulation_destroy(sim);
    scene_destroy(s);
}

static void a_strip_is_drawn_over_a_capstan(void) {
    static const double coefficients[] = {0, 0.2, 0.4};
    for (int k = 0; k < 3; k++) {
        double ratio, angle;
        char text[128];
        draw_over(coefficients[k], &ratio, &angle);
        CHECK(angle > 1.2);
        snprintf(text, sizeof text, "strip drawn over a held cylinder, friction %.1f: ln(T2/T1) over the angle", coefficients[k]);
        CHECK_ROW("METHOD 6", text, coefficients[k], ratio / angle, 0.01);
    }
}

/* ---- no way through ---------------------------------------------------------------------------------------------- */

static status fall(void *context, const double *x, int inputs, double *out, int outputs, report *r) {
    (void)x, (void)inputs, (void)outputs, (void)r;
    out[0] = out[1] = 0, out[2] = -*(const double *)context;
    return STATUS_OK;
}

static void a_fast_ball_does_not_pass(void) {
    static double speed = 5;
    scene *s = film_and(ball, 5e4, 50, 0.4, 0.4, 0.3);
    s->bodies[0].velocity = (scene_function){.outputs = 3, .call = fall, .context = &speed};
    s->fps = 200;
    hold(s, -9, -0.36, 0);
    hold(s, 0.36, 9, 0);
    simulation *sim = test_simulation(s, 64, "auto", 2);
    double deepest = 0;
    for (int f = 0; sim && f < 30 && advance(sim, 1); f++) {
        int64_t all = simulation_get_plan(sim)->particles, solids = all - simulation_get_plan(sim)->sheet_particles;
        double middle[3] = {0};
        simulation_read(sim, "position", body);
        for (int64_t i = 0; i < 3 * solids; i++) middle[i % 3] += body[i] / (double)solids;
        for (int64_t i = solids; i < all; i++) {
            double away[3] = {body[3 * i] - middle[0], body[3 * i + 1] - middle[1], body[3 * i + 2] - middle[2]};
            deepest = fmax(deepest, 0.15 - length(away));
        }
    }
    CHECK_ROW("METHOD 6", "fast ball (2/3 of its radius a frame's tenth) on a held film: deepest film particle in it, over dx", 0, deepest / 0.04, 0.5);
    simulation_measures m = measure(sim);
    CHECK(m.solid.momentum[2] > -0.5 * 5 * (m.solid.mass - m.sheet.mass)); /* it has been stopped, at least by half */
    simulation_destroy(sim);
    scene_destroy(s);
}

static void gaps_are_warned_of(void) {
    for (int k = 0; k < 2; k++) {
        scene *s = thrown(0.4);
        s->sheets[0].spacing = k ? 0.051 : 0.049; /* dx is 0.04 */
        simulation *sim = test_simulation(s, 64, "auto", 1);
        const char *said = sim ? simulation_take_warning(sim) : NULL;
        CHECK(sim && (said && said[0] != '\0') == (k == 1));
        simulation_destroy(sim);
        scene_destroy(s);
    }
}

int main(void) {
    RUN(gaps_are_warned_of);
    RUN(nothing_is_lost);
    RUN(both_sides_of_a_film_are_alike);
    RUN(bits_do_not_depend_on_threads);
    RUN(friction_is_coulombs);
    RUN(a_strip_is_drawn_over_a_capstan);
    RUN(a_fast_ball_does_not_pass);
    RUN(a_film_carries_a_rod);
    return check_finish();
}
