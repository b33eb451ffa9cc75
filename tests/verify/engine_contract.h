/* What every engine owes, whatever it simulates: the same bits after a restart, no allocation in a step, errors where memory is out. */
#ifndef SUNDER_TESTS_ENGINE_CONTRACT_H
#define SUNDER_TESTS_ENGINE_CONTRACT_H

#include "check.h"
#include "verify/solid_scene.h"

#include "base/memory.h"

/* Steps some frames; the state's hash. */
static inline uint64_t contract_frames(simulation *sim, int frames) {
    report r;
    uint64_t hash = 0;
    for (int f = 0; f < frames; f++) {
        status code = simulation_advance(sim, NULL, &r);
        if (code != STATUS_OK) printf("  %s\n", r.message);
        CHECK(code == STATUS_OK);
    }
    CHECK(simulation_hash(sim, &hash, &r) == STATUS_OK);
    return hash;
}

/* Saved at any of the frames and restored into a fresh simulation on another number of threads, a run ends with the same bits, step and energies. */
static inline void contract_restarts(scene *s, int frames) {
    enum { MOST = 8 };
    report r;
    simulation *whole = test_simulation(s, 32, "auto", 2);
    record_list saved[MOST + 1] = {0};
    uint64_t expected = 0;
    CHECK(frames <= MOST);
    for (int f = 0; f <= frames; f++) {
        CHECK(simulation_save(whole, &saved[f], &r) == STATUS_OK);
        expected = contract_frames(whole, f < frames);
    }
    simulation_measures a, b;
    simulation_measure(whole, &a, &r);
    for (int f = 0; f <= frames; f++) {
        simulation *again = test_simulation(s, 32, "auto", 1);
        CHECK(simulation_restore(again, &saved[f], &r) == STATUS_OK);
        CHECK(contract_frames(again, frames - f) == expected);
        simulation_measure(again, &b, &r);
        CHECK(a.steps == b.steps && a.dt_min == b.dt_min && a.solid.kinetic == b.solid.kinetic && a.solid.grip_work == b.solid.grip_work);
        simulation_destroy(again);
        record_clear(&saved[f]);
    }
    simulation_destroy(whole);
}

static inline void contract_no_allocation(scene *s) {
    report r;
    simulation *sim = test_simulation(s, 32, "auto", 2);
    for (int i = 0; i < 20; i++) CHECK(simulation_step(sim, 0, &r) == STATUS_OK);
    uint64_t before = memory_allocation_count();
    for (int i = 0; i < 20; i++) CHECK(simulation_step(sim, 0, &r) == STATUS_OK);
    CHECK(memory_allocation_count() == before);
    simulation_destroy(sim);
}

/* Every allocation of a simulation's making and first frame is made to fail in turn: an error each time, nothing leaks. `least`: of them there are
 * more. */
static inline void contract_memory_out(scene *s, int least) {
    report r;
    CHECK(scene_validate(s, &r) == STATUS_OK);
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
    CHECK(failures > least);
}

#endif
