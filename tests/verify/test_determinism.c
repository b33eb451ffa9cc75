/* Same input, same bits: over threads, and over a stop and a restart (DESIGN.md, "Same bits").
 *
 * A tube that cracks, small, in every kernel and precision: the hash of (x, v, F, d) at 1, 2, 3 and 7 threads is one; a simulation restored from
 * the records saved at any frame reaches the same hash, dt and energies as the one that was never interrupted. */
#include "check.h"
#include "verify/solid_scene.h"

#include "base/memory.h"

enum { FRAMES = 6 };

static const shape *tube(arena *a) {
    return shape_tube(a, (const double[]){0, 0, 0}, (const double[]){1, 0, 0}, 0.30, 0.12, 1.2, 1);
}

static scene *cracking_tube(kernel_kind kernel, kernel_kind laplacian) {
    scene *s = test_scene(tube, 4e4, 0.45, 500);
    s->particles = 3000;
    s->fps = 40;
    s->kernel = kernel;
    s->laplacian = laplacian;
    s->seed = 11;
    s->bodies[0].sampling = SAMPLING_JITTERED;
    s->bodies[0].fibres = (scene_fibres){.families = 1, .direction = {.outputs = 3, .constant = {1, 1, 0}}};
    test_set(s, "fibres", "gamma", 10);
    test_set(s, "damage", "break_stretch", 0.05);
    test_set(s, "damage", "alpha", -1);
    for (int side = -1; side <= 1; side += 2) {
        double center[3] = {0.6 * side, 0, 0};
        s->grips[s->grip_count++] = (scene_grip){.shape = shape_sphere(s->memory, center, 0.3), .stop = HUGE_VAL, .protects = true,
                                                 .velocity = {.outputs = 3, .constant = {0.8 * side, 0.1, 0}},
                                                 .spin = {.outputs = 3, .constant = {1.0 * side, 0, 0.2}}, .pivot = {0.6 * side, 0, 0}};
    }
    return s;
}

static uint64_t run_frames(simulation *sim, int frames, double *damage) {
    report r;
    uint64_t hash = 0;
    for (int f = 0; f < frames; f++) {
        status code = simulation_advance(sim, NULL, &r);
        if (code != STATUS_OK) printf("  %s\n", r.message);
        CHECK(code == STATUS_OK);
    }
    simulation_measures m;
    simulation_measure(sim, &m, &r);
    *damage = m.solid.damage_max;
    simulation_hash(sim, &hash, &r);
    return hash;
}

static void threads_do_not_change_bits(void) {
    static const kernel_kind kernels[][2] = {{KERNEL_QUADRATIC, KERNEL_QUADRATIC}, {KERNEL_QUADRATIC, KERNEL_CUBIC}, {KERNEL_CUBIC, KERNEL_CUBIC}};
    static const int threads[] = {1, 2, 3, 7};
    for (int k = 0; k < 3; k++)
        for (int precision = 32; precision <= 64; precision += 32) {
            uint64_t first = 0;
            for (int t = 0; t < 4; t++) {
                scene *s = cracking_tube(kernels[k][0], kernels[k][1]);
                simulation *sim = test_simulation(s, precision, "auto", threads[t]);
                double damage;
                uint64_t hash = run_frames(sim, FRAMES, &damage);
                if (t == 0) first = hash;
                CHECK(hash == first);
                CHECK(damage > 0.5);
                simulation_destroy(sim);
                scene_destroy(s);
            }
            printf("  kernels %d %d, f%d: %016llx\n", (int)kernels[k][0], (int)kernels[k][1], precision, (unsigned long long)first);
        }
}

static void restarts_do_not_change_bits(void) {
    report r;
    double damage;
    scene *s = cracking_tube(KERNEL_QUADRATIC, KERNEL_CUBIC);
    simulation *whole = test_simulation(s, 32, "auto", 2);
    record_list saved[FRAMES + 1] = {0};
    for (int f = 0; f <= FRAMES; f++) {
        CHECK(simulation_save(whole, &saved[f], &r) == STATUS_OK);
        if (f < FRAMES) (void)run_frames(whole, 1, &damage);
    }
    uint64_t expected, hash;
    simulation_hash(whole, &expected, &r);
    simulation_measures a, b;
    simulation_measure(whole, &a, &r);
    for (int f = 0; f <= FRAMES; f++) {
        simulation *again = test_simulation(s, 32, "auto", 1);
        CHECK(simulation_restore(again, &saved[f], &r) == STATUS_OK);
        hash = run_frames(again, FRAMES - f, &damage);
        CHECK(hash == expected);
        simulation_measure(again, &b, &r);
        CHECK(a.steps == b.steps && a.dt_min == b.dt_min && a.solid.kinetic == b.solid.kinetic && a.solid.grip_work == b.solid.grip_work);
        simulation_destroy(again);
        record_clear(&saved[f]);
    }
    simulation_destroy(whole);
    scene_destroy(s);
}

static void steps_allocate_nothing(void) {
    report r;
    scene *s = cracking_tube(KERNEL_QUADRATIC, KERNEL_CUBIC);
    simulation *sim = test_simulation(s, 32, "auto", 2);
    for (int i = 0; i < 20; i++) CHECK(simulation_step(sim, 0, &r) == STATUS_OK);
    uint64_t before = memory_allocation_count();
    for (int i = 0; i < 20; i++) CHECK(simulation_step(sim, 0, &r) == STATUS_OK);
    CHECK(memory_allocation_count() == before);
    simulation_destroy(sim);
    scene_destroy(s);
}

/* Every allocation of a simulation's making is made to fail in turn: an error each time, nothing leaks. */
static void allocation_failures_are_errors(void) {
    report r;
    scene *s = cracking_tube(KERNEL_QUADRATIC, KERNEL_CUBIC);
    CHECK(scene_validate(s, &r) == STATUS_OK);
    s->particles = 300;
    size_t before = memory_live_bytes();
    int failures = 0;
    for (int64_t n = 1; n < 1000; n++) {
        simulation *sim = NULL;
        simulation_options o = {.threads = 1, .precision = 32, .simd = "auto"};
        memory_fail_after(n, 0);
        status code = simulation_create(s, &o, &sim, &r);
        if (code == STATUS_OK) code = simulation_advance(sim, NULL, &r);
        memory_fail_after(0, 0);
        simulation_destroy(sim);
        CHECK(memory_live_bytes() == before);
        if (code == STATUS_OK) break;
        CHECK(code == STATUS_SYSTEM);
        failures++;
    }
    printf("  %d allocations failed in turn\n", failures);
    CHECK(failures > 10);
    scene_destroy(s);
}

/* A step far over the limit must end in a diagnosis, not in NaN: guard of the simulation. */
static void a_runaway_is_diagnosed(void) {
    report r;
    scene *s = cracking_tube(KERNEL_QUADRATIC, KERNEL_QUADRATIC);
    s->dt = 0.0125;
    simulation *sim = test_simulation(s, 32, "auto", 2);
    status code = STATUS_OK;
    for (int f = 0; f < 50 && code == STATUS_OK; f++) code = simulation_advance(sim, NULL, &r);
    CHECK(code == STATUS_DIVERGED);
    CHECK(strstr(r.message, "particle") && strstr(r.message, "step") && strstr(r.message, "elastic"));
    printf("  %s\n", r.message);
    simulation_destroy(sim);
    scene_destroy(s);
}

int main(void) {
    RUN(threads_do_not_change_bits);
    RUN(restarts_do_not_change_bits);
    RUN(steps_allocate_nothing);
    RUN(allocation_failures_are_errors);
    RUN(a_runaway_is_diagnosed);
    return check_finish();
}
