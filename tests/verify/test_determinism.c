/* Same input, same bits: over threads, and over a stop and a restart (DESIGN.md, "Same bits").
 *
 * A tube that cracks, small, in every kernel and precision: the hash of (x, v, F, d) at 1, 2, 3 and 7 threads is one; a simulation restored from
 * the records saved at any frame reaches the same hash, dt and energies as the one that was never interrupted. */
#include "check.h"
#include "verify/engine_contract.h"

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

static void threads_do_not_change_bits(void) {
    static const kernel_kind kernels[][2] = {{KERNEL_QUADRATIC, KERNEL_QUADRATIC}, {KERNEL_QUADRATIC, KERNEL_CUBIC}, {KERNEL_CUBIC, KERNEL_CUBIC}};
    static const int threads[] = {1, 2, 3, 7};
    for (int k = 0; k < 3; k++)
        for (int precision = 32; precision <= 64; precision += 32) {
            uint64_t first = 0;
            for (int t = 0; t < 4; t++) {
                scene *s = cracking_tube(kernels[k][0], kernels[k][1]);
                simulation *sim = test_simulation(s, precision, "auto", threads[t]);
                report r;
                simulation_measures m;
                uint64_t hash = contract_frames(sim, FRAMES);
                simulation_measure(sim, &m, &r);
                if (t == 0) first = hash;
                CHECK(hash == first);
                CHECK(m.solid.damage_max > 0.5);
                simulation_destroy(sim);
                scene_destroy(s);
            }
            printf("  kernels %d %d, f%d: %016llx\n", (int)kernels[k][0], (int)kernels[k][1], precision, (unsigned long long)first);
        }
}

static void restarts_do_not_change_bits(void) {
    scene *s = cracking_tube(KERNEL_QUADRATIC, KERNEL_CUBIC);
    contract_restarts(s, FRAMES);
    scene_destroy(s);
}

static void steps_allocate_nothing(void) {
    scene *s = cracking_tube(KERNEL_QUADRATIC, KERNEL_CUBIC);
    contract_no_allocation(s);
    scene_destroy(s);
}

static void allocation_failures_are_errors(void) {
    scene *s = cracking_tube(KERNEL_QUADRATIC, KERNEL_CUBIC);
    s->particles = 300;
    contract_memory_out(s, 10);
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
