/* Colliders and grips (METHOD.md §3's boundary conditions), f64.
 *
 * - A block on a tilted wall with Coulomb friction slides with g (sin θ − μ cos θ), and does not slide where μ > tan θ.
 * - A sticky wall holds; a separating wall lets go upwards and not downwards; a block thrown at a slip wall keeps its tangential momentum.
 * - A spinning grip turns the block with it: angular velocity of the particles is the grip's.
 * - No particle that starts in a protecting grip is ever damaged while the bar between two grips breaks; in grips that do not protect, some are.
 * - Where several boundaries have hold of the same nodes, the one that they are left with has done the work: a block held by two grips that move apart, and
 *   by a grip and a wall across it, has been given exactly its weight's work and twice its kinetic energy (a blow that lets nothing bounce loses the other half).
 * - Work done by grips equals the energy they put in, less what dissipates: never negative dissipation for a pulled bar. */
#include "check.h"
#include "verify/solid_scene.h"

#include "base/memory.h"

static const shape *block(arena *a) {
    return shape_box(a, (const double[]){-0.5, 0.02, -0.25}, (const double[]){0.5, 0.52, 0.25});
}

static scene *block_on_wall(contact_kind contact, double friction, const double gravity[3]) {
    scene *s = test_scene(block, 2e4, 0.3, 1);
    s->particles = 2000;
    int g = effect_index("gravity");
    s->effects[g].on = true;
    memcpy(s->effects[g].value[0], gravity, sizeof s->effects[g].value[0]);
    s->colliders[s->collider_count++] =
        (scene_collider){.shape = shape_half_space(s->memory, (const double[]){0, 0, 0}, (const double[]){0, 1, 0}), .stop = HUGE_VAL,
                         .contact = contact, .friction = friction};
    return s;
}

static void mean_velocity(scene *s, double from, double to, double v[2][3]) {
    simulation *sim = test_simulation(s, 64, "auto", 2);
    report r;
    simulation_measures m;
    for (int i = 0; i < 2; i++) {
        while (simulation_time(sim) < (i ? to : from)) CHECK(simulation_step(sim, 0, &r) == STATUS_OK);
        simulation_measure(sim, &m, &r);
        for (int c = 0; c < 3; c++) v[i][c] = m.solid.momentum[c] / m.solid.mass;
    }
    simulation_destroy(sim);
    scene_destroy(s);
}

static void friction_is_coulombs(void) {
    double tilt = 30 * M_PI / 180, g = 10, v[2][3];
    const double gravity[3] = {g * sin(tilt), -g * cos(tilt), 0};
    static const double coefficients[] = {0, 0.2, 0.4};
    for (int i = 0; i < 3; i++) {
        double mu = coefficients[i];
        mean_velocity(block_on_wall(CONTACT_SEPARATE, mu, gravity), 0.3, 0.7, v);
        double expected = g * (sin(tilt) - mu * cos(tilt)), measured = (v[1][0] - v[0][0]) / 0.4;
        char text[96];
        snprintf(text, sizeof text, "block on a wall tilted by 30 degrees, friction %.1f: acceleration", mu);
        CHECK_ROW("METHOD 3", text, expected, measured, 0.03 * g * sin(tilt));
    }
    mean_velocity(block_on_wall(CONTACT_SEPARATE, 0.8, gravity), 0.5, 0.7, v);
    CHECK(fabs(v[1][0]) < 0.02); /* tan 30° = 0.577 */
    mean_velocity(block_on_wall(CONTACT_STICKY, 0, gravity), 0.5, 0.7, v);
    CHECK(fabs(v[1][0]) < 0.05);
}

static status thrown_up(void *context, const double *x, int inputs, double *v, int outputs, report *r) {
    (void)context, (void)x, (void)inputs, (void)outputs, (void)r;
    v[0] = 1, v[1] = 2, v[2] = 0;
    return STATUS_OK;
}

static void a_separating_wall_lets_go(void) {
    static const double nothing[3] = {0, 0, 0};
    double v[2][3];
    scene *s = block_on_wall(CONTACT_SEPARATE, 0.5, nothing);
    s->bodies[0].velocity = (scene_function){.outputs = 3, .call = thrown_up};
    mean_velocity(s, 0.05, 0.1, v);
    CHECK_NEAR(v[1][0], 1, 1e-9);
    CHECK_NEAR(v[1][1], 2, 1e-9);
    s = block_on_wall(CONTACT_SLIP, 0, nothing);
    s->bodies[0].velocity = (scene_function){.outputs = 3, .call = thrown_up};
    mean_velocity(s, 0.05, 0.1, v);
    CHECK_NEAR(v[1][0], 1, 1e-9);
    CHECK(v[1][1] < 1.99); /* no normal motion where it touches */
}

static void a_spinning_grip_turns_its_block(void) {
    scene *s = test_scene(block, 2e4, 0.3, 1);
    s->particles = 2000;
    const double center[3] = {0, 0.27, 0};
    s->grips[s->grip_count++] = (scene_grip){.shape = shape_sphere(s->memory, center, 2), .stop = HUGE_VAL, .pivot = {0, 0.27, 0},
                                             .velocity = {.outputs = 3, .constant = {0.3, 0, 0}}, .spin = {.outputs = 3, .constant = {0, 0, 3}}};
    simulation *sim = test_simulation(s, 64, "auto", 2);
    report r;
    while (simulation_time(sim) < 0.5) CHECK(simulation_step(sim, 1e-3, &r) == STATUS_OK);
    solid *state;
    const solid_engine *engine = simulation_engine(sim, &state);
    int64_t n = simulation_get_plan(sim)->particles;
    double *x = memory_allocate((size_t)n * 24), *v = memory_allocate((size_t)n * 24), worst = 0, t = simulation_time(sim);
    engine->read(state, "position", x);
    engine->read(state, "velocity", v);
    for (int64_t i = 0; i < n; i++) {
        double arm[2] = {x[3 * i] - 0.3 * t, x[3 * i + 1] - 0.27};
        worst = fmax(worst, hypot(v[3 * i] - (0.3 - 3 * arm[1]), v[3 * i + 1] - 3 * arm[0]));
    }
    CHECK_ROW("METHOD 3", "block within a grip that moves and spins: worst velocity error over its rim speed", 0, worst / 1.8, 0.01);
    memory_free(x, (size_t)n * 24), memory_free(v, (size_t)n * 24);
    simulation_destroy(sim);
    scene_destroy(s);
}

static void a_pulled_bar_dissipates_no_less_than_nothing(void) {
    scene *s = test_scene(block, 1e3, 0.3, 1);
    s->particles = 2000;
    for (int side = -1; side <= 1; side += 2) {
        double low[3] = {side < 0 ? -2 : 0.35, -1, -1}, high[3] = {side < 0 ? -0.35 : 2, 1, 1};
        s->grips[s->grip_count++] = (scene_grip){.shape = shape_box(s->memory, low, high), .stop = HUGE_VAL,
                                                 .velocity = {.outputs = 3, .constant = {0.2 * side, 0, 0}}};
    }
    simulation *sim = test_simulation(s, 64, "auto", 2);
    report r;
    simulation_measures m;
    simulation_measure(sim, &m, &r);
    double last = 0;
    for (int i = 0; i < 10; i++) {
        for (int k = 0; k < 40; k++) CHECK(simulation_step(sim, 0, &r) == STATUS_OK);
        simulation_measure(sim, &m, &r);
        CHECK(m.dissipated > last - 0.02 * m.solid.grip_work); /* symplectic Euler's energy wavers by O(Δt) */
        last = m.dissipated;
    }
    printf("  work %.4g, stored %.4g, dissipated %.4g\n", m.solid.grip_work, m.solid.elastic + m.solid.kinetic, m.dissipated);
    CHECK(m.solid.grip_work > 0 && m.dissipated < 0.6 * m.solid.grip_work);
    simulation_destroy(sim);
    scene_destroy(s);
}

/* A bar that breaks between two grips: damage at most within the grips' regions and between them. */
static void break_between_grips(bool protects, double *gripped, double *free) {
    scene *s = test_scene(block, 1e3, 0.3, 1);
    s->particles = 2000;
    test_set(s, "damage", "break_stretch", 0.02);
    test_set(s, "damage", "eta", 0.01);
    for (int side = -1; side <= 1; side += 2) {
        double low[3] = {side < 0 ? -2 : 0.25, -1, -1}, high[3] = {side < 0 ? -0.25 : 2, 1, 1};
        s->grips[s->grip_count++] = (scene_grip){.shape = shape_box(s->memory, low, high), .stop = HUGE_VAL, .protects = protects,
                                                 .velocity = {.outputs = 3, .constant = {1.5 * side, 0, 0}}};
    }
    simulation *sim = test_simulation(s, 64, "auto", 2);
    solid *state;
    const solid_engine *engine = simulation_engine(sim, &state);
    int64_t n = simulation_get_plan(sim)->particles;
    double *rest = memory_allocate((size_t)n * 24), *d = memory_allocate((size_t)n * 8);
    engine->read(state, "position", rest);
    report r;
    while (simulation_time(sim) < 0.2) CHECK(simulation_step(sim, 0, &r) == STATUS_OK);
    engine->read(state, "damage", d);
    *gripped = *free = 0;
    for (int64_t i = 0; i < n; i++) {
        double *most = fabs(rest[3 * i]) > 0.25 ? gripped : free;
        *most = fmax(*most, d[i]);
    }
    memory_free(rest, (size_t)n * 24), memory_free(d, (size_t)n * 8);
    simulation_destroy(sim);
    scene_destroy(s);
}

static void no_gripped_particle_breaks(void) {
    double gripped, free;
    break_between_grips(false, &gripped, &free);
    printf("  without protection: damage up to %.3f in the grips, %.3f between them\n", gripped, free);
    CHECK(gripped > 0.1);
    break_between_grips(true, &gripped, &free);
    CHECK_ROW("METHOD 2", "bar that breaks between two grips: largest damage of a particle that started in a grip", 0, gripped, 0);
    CHECK(free > 0.9);
}

/* A block that boundaries hold throughout from the start, and gravity; work and impulse of the boundaries after some steps. */
static void hold_twice(bool wall, const double first[3], const double second[3], double work[2], double *mass) {
    static const double g[3] = {1, -2, 3};
    scene *s = test_scene(block, 2e4, 0.3, 1);
    simulation_measures m;
    report r;
    const double center[3] = {0, 0.27, 0}, floor[3] = {0, 5, 0}, up[3] = {0, 1, 0};
    int gravity = effect_index("gravity");
    s->effects[gravity].on = true;
    memcpy(s->effects[gravity].value[0], g, sizeof g);
    s->grips[s->grip_count++] = (scene_grip){.shape = shape_sphere(s->memory, center, 3), .stop = HUGE_VAL, .velocity = {.outputs = 3}};
    memcpy(s->grips[0].velocity.constant, first, 3 * sizeof *first);
    if (wall) {
        s->colliders[s->collider_count++] = (scene_collider){.shape = shape_half_space(s->memory, floor, up), .stop = HUGE_VAL, .contact = CONTACT_SLIP, .velocity = {.outputs = 3}};
        memcpy(s->colliders[0].velocity.constant, second, 3 * sizeof *second);
    } else {
        s->grips[s->grip_count++] = (scene_grip){.shape = shape_sphere(s->memory, center, 3), .stop = HUGE_VAL, .velocity = {.outputs = 3}};
        memcpy(s->grips[1].velocity.constant, second, 3 * sizeof *second);
    }
    simulation *sim = test_simulation(s, 64, "auto", 2);
    for (int k = 0; k < 100; k++) CHECK(simulation_step(sim, 1e-3, &r) == STATUS_OK);
    simulation_measure(sim, &m, &r);
    double left[3] = {wall ? first[0] : second[0], second[1], wall ? first[2] : second[2]}, expected = 0;
    for (int c = 0; c < 3; c++) expected += m.solid.mass * left[c] * (left[c] - 0.1 * g[c]);
    for (int c = 0; c < 3; c++) CHECK_NEAR(m.solid.momentum[c], m.solid.mass * left[c], 1e-12);
    work[0] = expected, work[1] = m.solid.grip_work;
    *mass = m.solid.mass;
    simulation_destroy(sim);
    scene_destroy(s);
}

static void what_holds_last_does_the_work(void) {
    static const double first[3] = {0.5, 0.2, -0.1}, second[3] = {-0.4, 0.3, 0.2};
    double work[2], mass;
    hold_twice(false, first, second, work, &mass);
    CHECK_ROW("METHOD 3", "block that two grips hold at different velocities: their work, over its mass", work[0] / mass, work[1] / mass, 1e-12);
    hold_twice(true, first, second, work, &mass);
    CHECK_ROW("METHOD 3", "block that a grip holds and a slip wall pushes: their work, over its mass", work[0] / mass, work[1] / mass, 1e-12);
}

int main(void) {
    RUN(what_holds_last_does_the_work);
    RUN(friction_is_coulombs);
    RUN(a_separating_wall_lets_go);
    RUN(a_spinning_grip_turns_its_block);
    RUN(no_gripped_particle_breaks);
    RUN(a_pulled_bar_dissipates_no_less_than_nothing);
    return check_finish();
}
