/* The momentum limit is one that steps may be taken at (METHOD.md §3): a body of random particles, shaken at random, at fixed shares of dx/c.
 *
 * - Where particles lie as in a body, at the default share of a half and at 0.7, with every transfer, the energy never exceeds what it was shaken
 *   with, but for what symplectic Euler's wavers by; at 1.6 every transfer blows up, so the limit is no more than 2.3 times stricter than it must be.
 * - For any arrangement, particles alone in their cells among them, quadratic kernels have ω² ≤ 4 c'²/dx², c' of all velocity gradients and not
 *   of waves only: Σ_p V C L:L ≤ Σ_p V C D⁻¹ Σ_i w_ip |v_i|², because (x_i − x_p)/√D are orthonormal in the weights w_ip. Near rest ρ c'² is three
 *   times the bulk modulus, ρ c² the P wave's: c'/c < √3. With APIC and FLIP a step may be 2/ω long, so a half of dx/c is safe. */
#include "check.h"
#include "verify/solid_particles.h"

#include "base/random.h"

#include <stdlib.h>

static const double E = 100, NU = 0.45, DX = 0.1;
enum { STEPS = 400 };
static const transfer_kind transfers[] = {TRANSFER_APIC, TRANSFER_RPIC, TRANSFER_PIC, TRANSFER_FLIP};

static const shape *block(arena *a) {
    return shape_box(a, (const double[]){0, 0, 0}, (const double[]){1, 1, 1});
}

/* Energy at its largest over what it was at first; HUGE_VAL where the run broke off. */
static double growth(transfer_kind transfer, double particles_per_cell, double share) {
    scene *s = test_scene(block, E, NU, 1);
    s->dx = DX;
    s->particles_per_cell = particles_per_cell;
    s->transfer = transfer;
    s->transfer_ratio = transfer == TRANSFER_FLIP ? 1 : 0;
    simulation *sim = test_simulation(s, 64, "auto", 1);
    int64_t count = simulation_get_plan(sim)->particles;
    double bulk = E / (3 * (1 - 2 * NU)), mu = E / (2 * (1 + NU)), c = sqrt(bulk + mu * 4 / 3), worst = 0;
    double *kick = malloc(3 * (size_t)count * sizeof *kick);
    for (int64_t i = 0; i < 3 * count; i++) kick[i] = 2 * random_unit(60, 0, (uint64_t)i) - 1;
    particles_kick(sim, 1e-4 * c, kick);
    simulation_measures m;
    report r;
    simulation_measure(sim, &m, &r);
    double first = m.solid.kinetic;
    for (int step = 0; step < STEPS && isfinite(worst); step++) {
        if (simulation_step(sim, share * DX / c, &r) != STATUS_OK) worst = HUGE_VAL;
        simulation_measure(sim, &m, &r);
        worst = fmax(worst, isfinite(m.solid.kinetic) ? (m.solid.kinetic + m.solid.elastic) / first : HUGE_VAL);
    }
    free(kick);
    simulation_destroy(sim);
    scene_destroy(s);
    return worst;
}

static double largest_growth(int count, double particles_per_cell, double share) {
    double worst = 0;
    for (int t = 0; t < count; t++) {
        double here = growth(transfers[t], particles_per_cell, share);
        printf("  transfer %d, %g particles a cell, %g dx/c: %.3g\n", (int)transfers[t], particles_per_cell, share, here);
        worst = fmax(worst, here);
    }
    return worst;
}

static void bodies_are_stable_at_the_limit(void) {
    CHECK_ROW("METHOD 3", "body of random particles shaken at random, a half of dx/c, any transfer: largest energy over the first", 0.5, largest_growth(4, 8, 0.5), 0.55);
    CHECK_ROW("METHOD 3", "the same at 0.7 of dx/c", 0.5, largest_growth(4, 8, 0.7), 0.55);
}

static void beyond_the_limit_all_blow_up(void) {
    for (int t = 0; t < 4; t++) CHECK(growth(transfers[t], 8, 1.6) > 1e3);
}

static void sparse_particles_are_stable_where_nothing_is_damped(void) {
    CHECK_ROW("METHOD 3", "sparse particles (one in four cells), a half of dx/c, APIC: largest energy over the first", 0.5, growth(TRANSFER_APIC, 0.25, 0.5), 0.55);
    CHECK_ROW("METHOD 3", "the same, FLIP", 0.5, growth(TRANSFER_FLIP, 0.25, 0.5), 0.55);
}

int main(void) {
    RUN(bodies_are_stable_at_the_limit);
    RUN(beyond_the_limit_all_blow_up);
    RUN(sparse_particles_are_stable_where_nothing_is_damped);
    return check_finish();
}
