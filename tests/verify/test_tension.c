/* A bar pulled slowly by its ends gives back E and ν (METHOD.md §1: to 1 %, with the consistent λ).
 *
 * Bar of 4 × 1 × 1, E = 100, ν = 0.3, strain about 0.4 %. The axial force is the work of the grips over the distance that
 * they part; strains are those of the particles in the middle, where the ends' grip is not felt. */
#include "check.h"
#include "verify/solid_scene.h"

#include "base/memory.h"

static void mean_strain(simulation *sim, const double *rest, double strain[3]) {
    solid *state;
    const solid_engine *engine = simulation_engine(sim, &state);
    int64_t n = simulation_get_plan(sim)->particles, used = 0;
    double *F = memory_allocate((size_t)n * 72);
    engine->read(state, "deformation_gradient", F);
    strain[0] = strain[1] = strain[2] = 0;
    for (int64_t i = 0; i < n; i++) {
        if (fabs(rest[3 * i]) > 0.5) continue;
        for (int c = 0; c < 3; c++) strain[c] += F[9 * i + 4 * c] - 1;
        used++;
    }
    for (int c = 0; c < 3; c++) strain[c] /= (double)used;
    memory_free(F, (size_t)n * 72);
}

static void tension_gives_back_the_moduli(void) {
    double E = 100, nu = 0.3, speed = 2e-3;
    scene *s = test_scene(test_bar, E, nu, 1);
    s->particles = 4000;
    s->transfer = TRANSFER_RPIC; /* damps the waves that the start sends out */
    test_pull(s, 1.75, speed);
    simulation *sim = test_simulation(s, 64, "auto", 2);
    report r;
    int64_t n = simulation_get_plan(sim)->particles;
    double *rest = memory_allocate((size_t)n * 24);
    solid *state;
    simulation_engine(sim, &state)->read(state, "position", rest);
    simulation_measures before, after;
    double strain[3], parted = 0;
    while (simulation_time(sim) < 3) CHECK(simulation_step(sim, 0, &r) == STATUS_OK);
    simulation_measure(sim, &before, &r);
    double from = simulation_time(sim);
    while (simulation_time(sim) < 4) CHECK(simulation_step(sim, 0, &r) == STATUS_OK);
    simulation_measure(sim, &after, &r);
    mean_strain(sim, rest, strain);
    parted = 2 * speed * (simulation_time(sim) - from);
    /* Work over a stretch of the linear loading is the force in its middle; the strain there is in proportion. */
    double middle = (from + 0.5 * (simulation_time(sim) - from)) / simulation_time(sim);
    double force = (after.solid.grip_work - before.solid.grip_work) / parted;
    printf("  E = %.3f of %g, nu = %.4f, %.4f of %g (strain %.4f)\n", force / (strain[0] * middle), E, -strain[1] / strain[0],
           -strain[2] / strain[0], nu, strain[0]);
    CHECK_ROW("METHOD 1", "bar in slow tension: E", E, force / (strain[0] * middle), 0.01 * E);
    CHECK_ROW("METHOD 1", "bar in slow tension: Poisson's ratio", nu, -strain[1] / strain[0], 0.01 * nu);
    CHECK_NEAR(-strain[2] / strain[0] / nu, 1, 0.01);
    memory_free(rest, (size_t)n * 24);
    simulation_destroy(sim);
    scene_destroy(s);
}

int main(void) {
    RUN(tension_gives_back_the_moduli);
    return check_finish();
}
