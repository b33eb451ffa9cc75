/* What every engine owes, of bodies of tetrahedra: the same bits at any number of threads and after a restart, no allocation in a step, errors where memory
 * is out, a diagnosis where a state is not finite, input that is wrong named; vector builds agree with plain. */
#include "check.h"
#include "verify/engine_contract.h"
#include "verify/solid_particles.h"

enum { FRAMES = 4 };

static const shape *ball(arena *a) {
    return shape_sphere(a, (const double[]){0, 0, 0}, 0.6);
}

static status twisted(void *context, const double *x, int inputs, double *y, int outputs, report *r) {
    (void)context, (void)inputs, (void)outputs, (void)r;
    double angle = 2 * x[2];
    y[0] = 1.2 * (cos(angle) * x[0] - sin(angle) * x[1]), y[1] = sin(angle) * x[0] + cos(angle) * x[1], y[2] = -0.3 * x[2];
    return STATUS_OK;
}

/* Two materials, fibres, gravity, a grip that turns, a wall. */
static scene *two_balls(void) {
    scene *s = test_scene(ball, 50, 0.3, 1);
    s->dx = 0.13;
    s->fps = 40;
    s->bodies[0].discretisation = DISCRETISATION_TETRAHEDRA;
    s->bodies[0].start = (scene_function){.outputs = 3, .call = twisted};
    s->bodies[0].fibres = (scene_fibres){.families = 2, .direction = {.outputs = 6, .constant = {1, 0, 1, 0, 1, 0}}};
    test_set(s, "fibres", "gamma", 3), test_set(s, "fibres", "gamma2", 3);
    s->materials[1] = s->materials[0];
    s->materials[1].effects[EFFECT_elastic].on = s->materials[1].effects[EFFECT_fibres].on = false;
    s->materials[1].effects[EFFECT_corotated].on = true;
    s->materials[1].effects[EFFECT_corotated].value[0][0] = 20, s->materials[1].effects[EFFECT_corotated].value[1][0] = 0.3;
    s->materials[1].effects[EFFECT_corotated].given[0] = s->materials[1].effects[EFFECT_corotated].given[1] = true;
    s->material_count = s->body_count = 2;
    s->bodies[1] = s->bodies[0];
    s->bodies[1].material = 1;
    s->bodies[1].start.outputs = 0;
    s->bodies[1].shape = shape_sphere(s->memory, (const double[]){2, 0, 0}, 0.6);
    s->effects[EFFECT_gravity].on = s->effects[EFFECT_mass_damping].on = true;
    s->effects[EFFECT_gravity].value[0][1] = -3, s->effects[EFFECT_mass_damping].value[0][0] = 0.5;
    s->grips[s->grip_count++] = (scene_grip){.shape = shape_sphere(s->memory, (const double[]){2, 0.6, 0}, 0.4), .stop = HUGE_VAL, .pivot = {2, 0, 0},
                                             .velocity = {.outputs = 3}, .spin = {.outputs = 3, .constant = {0, 2, 0}}};
    s->colliders[s->collider_count++] = (scene_collider){.shape = shape_half_space(s->memory, (const double[]){0, -0.65, 0}, (const double[]){0, 1, 0}),
                                                         .stop = HUGE_VAL, .contact = CONTACT_SEPARATE, .friction = 0.2};
    return s;
}

static void threads_do_not_change_bits(void) {
    static const int threads[] = {1, 2, 3, 7};
    for (int precision = 32; precision <= 64; precision += 32) {
        uint64_t first = 0;
        double fastest = 0;
        for (int t = 0; t < 4; t++) {
            scene *s = two_balls();
            simulation *sim = test_simulation(s, precision, "auto", threads[t]);
            uint64_t hash = contract_frames(sim, FRAMES);
            simulation_measures m;
            report r;
            simulation_measure(sim, &m, &r);
            fastest = m.solid.speed_max;
            if (t == 0) first = hash;
            CHECK(hash == first && m.solid.grip_work != 0);
            simulation_destroy(sim);
            scene_destroy(s);
        }
        printf("  f%d: %016llx, speed up to %.3g\n", precision, (unsigned long long)first, fastest);
        CHECK(fastest > 0.1);
    }
}

static void restarts_do_not_change_bits(void) {
    scene *s = two_balls();
    contract_restarts(s, FRAMES);
    scene_destroy(s);
}

static void steps_allocate_nothing(void) {
    scene *s = two_balls();
    contract_no_allocation(s);
    scene_destroy(s);
}

static void allocation_failures_are_errors(void) {
    scene *s = two_balls();
    contract_memory_out(s, 30);
    scene_destroy(s);
}

static void a_runaway_is_diagnosed(void) {
    report r;
    scene *s = two_balls();
    s->dt = 0.025;
    simulation *sim = test_simulation(s, 32, "auto", 2);
    status code = STATUS_OK;
    for (int f = 0; f < 300 && code == STATUS_OK; f++) code = simulation_advance(sim, NULL, &r);
    CHECK(code == STATUS_DIVERGED && strstr(r.message, "tetrahedron") && strstr(r.message, "step"));
    CHECK(strstr(simulation_take_warning(sim), "exceeds the limit"));
    printf("  %s\n", r.message);
    simulation_destroy(sim);
    scene_destroy(s);
}

static void vector_builds_agree_with_plain(void) {
    static const char *const simds[] = {"plain", "avx2", "avx512"};
    double *first = NULL;
    size_t bytes = 0;
    for (int k = 0; k < 6; k++) {
        int precision = k < 3 ? 64 : 32;
        if (!solid_tetra_find(precision, simds[k % 3])) continue;
        scene *s = two_balls();
        simulation *sim = test_simulation(s, precision, simds[k % 3], 2);
        report r;
        for (int i = 0; i < 100; i++) CHECK(simulation_step(sim, 2e-4, &r) == STATUS_OK);
        double *x = particles_get(sim, "position"), worst = 0;
        int64_t n = simulation_get_plan(sim)->particles;
        if (!first) {
            bytes = (size_t)n * 24;
            first = memory_allocate(bytes);
            memcpy(first, x, bytes);
        }
        for (int64_t i = 0; i < 3 * n; i++) worst = fmax(worst, fabs(x[i] - first[i]));
        printf("  f%d %-6s %.2e\n", precision, simds[k % 3], worst);
        CHECK(worst < (precision == 64 ? 1e-11 : 2e-5));
        particles_drop(sim, x);
        simulation_destroy(sim);
        scene_destroy(s);
    }
    memory_free(first, bytes);
}

static void wrong_scenes_are_named(void) {
    report r;
    scene *s = two_balls();
    s->bodies[1].discretisation = DISCRETISATION_PARTICLES;
    CHECK(scene_validate(s, &r) == STATUS_INPUT && strcmp(r.key, "discretisation") == 0);
    scene_destroy(s);
    static const char *const effects[] = {"damage", "plastic", "pff"}, *const keys[] = {"sigma_c", "yield_stress", "toughness"};
    for (int e = 0; e < 3; e++) {
        s = two_balls();
        test_set(s, effects[e], keys[e], 1);
        CHECK(scene_validate(s, &r) == STATUS_INPUT && strcmp(r.key, effects[e]) == 0 && strstr(r.expected, "tetrahedra"));
        scene_destroy(s);
    }
    s = two_balls();
    s->bodies[0].discretisation = s->bodies[1].discretisation = DISCRETISATION_PARTICLES;
    CHECK(scene_validate(s, &r) == STATUS_INPUT && strcmp(r.key, "start") == 0);
    scene_destroy(s);
}

static void frames_carry_the_mesh(void) {
    report r;
    scene *s = two_balls();
    simulation *sim = test_simulation(s, 32, "auto", 2);
    for (int frame = 0; frame < 2; frame++) {
        record_list list = {0};
        CHECK(simulation_frame_records(sim, &list, &r) == STATUS_OK);
        const record *x = record_find(&list, "solid/position"), *t = record_find(&list, "solid/tetrahedra");
        CHECK(x && x->count == simulation_get_plan(sim)->particles && (t != NULL) == (frame == 0));
        if (t) CHECK(t->count == simulation_get_plan(sim)->tetrahedra && t->components == 4);
        for (int64_t i = 0; t && i < 4 * t->count; i++) CHECK(((int32_t *)t->data)[i] >= 0 && ((int32_t *)t->data)[i] < x->count);
        record_clear(&list);
        (void)contract_frames(sim, 1);
    }
    simulation_destroy(sim);
    scene_destroy(s);
}

int main(void) {
    RUN(threads_do_not_change_bits);
    RUN(restarts_do_not_change_bits);
    RUN(steps_allocate_nothing);
    RUN(allocation_failures_are_errors);
    RUN(a_runaway_is_diagnosed);
    RUN(vector_builds_agree_with_plain);
    RUN(wrong_scenes_are_named);
    RUN(frames_carry_the_mesh);
    return check_finish();
}
