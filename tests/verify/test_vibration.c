/* Waves in bars and colliding bodies (METHOD.md §3), f64.
 *
 * - A free bar of 10 × 1 × 1, set into its first axial mode, vibrates with f = ½ √(E/ρ)/L, Poisson's ratio 0.3 and free sides, to 0.5 %. Lateral inertia
 *   lowers f by (π ν r/L)²/2, r² = (h² + w²)/12 (Rayleigh and Love): 0.07 %.
 * - The same bar that can move along x only vibrates with the P wave's modulus, (λ + μ) of this energy = E (1 − ν)/((1 + ν)(1 − 2ν)).
 * - Two such bars that meet with ±v: the law is linear there, so they stick for 2L/c, stand still and hold all energy as strain v/c at L/c, and part
 *   with speeds exchanged. What APIC loses at the shocks' fronts shrinks with the grid's spacing.
 * - Two balls that meet: momentum is kept to round-off, energy to 3 % with FLIP; APIC loses less on a finer grid. */
#include "check.h"
#include "verify/solid_particles.h"

static const double E = 100, NU = 0.3;
static double width;

static const shape *bar(arena *a) {
    double w = 0.5 * width;
    return shape_box(a, (const double[]){-5, -w, -w}, (const double[]){5, w, w});
}

static status first_mode(void *context, const double *x, int inputs, double *v, int outputs, report *r) {
    (void)context, (void)inputs, (void)outputs, (void)r;
    v[0] = 0.02 * sin(M_PI * x[0] / 10), v[1] = v[2] = 0;
    return STATUS_OK;
}

/* The mode's share of the momentum: Σ v_x sin(π X/L). */
static double mode_velocity(simulation *sim, const double *rest) {
    int64_t n = simulation_get_plan(sim)->particles;
    double *v = particles_get(sim, "velocity"), sum = 0;
    for (int64_t i = 0; i < n; i++) sum += v[3 * i] * sin(M_PI * rest[3 * i] / 10);
    particles_drop(sim, v);
    return sum / (double)n;
}

/* 1 over the time between the first and the fifth zero of the mode's velocity (two periods). */
static double frequency(bool confined, double dx, double bar_width) {
    width = bar_width;
    scene *s = test_scene(bar, E, NU, 1);
    s->dx = dx;
    s->kernel = KERNEL_CUBIC;
    s->bodies[0].velocity = (scene_function){.outputs = 3, .call = first_mode};
    if (confined) forbid_motion(s, 1), forbid_motion(s, 2);
    simulation *sim = test_simulation(s, 64, "auto", 2);
    double *rest = particles_get(sim, "position"), dt = 0.3 * dx / 12, last = mode_velocity(sim, rest), first_zero = 0, zero = 0;
    report r;
    for (int zeros = 0; zeros < 5 && simulation_time(sim) < 6;) {
        CHECK(simulation_step(sim, dt, &r) == STATUS_OK);
        double now = mode_velocity(sim, rest);
        if (now * last < 0) {
            zero = simulation_time(sim) - dt * now / (now - last);
            if (zeros++ == 0) first_zero = zero;
        }
        last = now;
    }
    particles_drop(sim, rest);
    simulation_destroy(sim);
    scene_destroy(s);
    return 2 / (zero - first_zero);
}

static void a_free_bar_has_its_frequency(void) {
    double f = 0.5 * sqrt(E) / 10, correction = pow(M_PI * NU / 10, 2) / 12;
    double measured = frequency(false, 0.25, 1);
    printf("  %.5f, slender bar %.5f, with lateral inertia %.5f\n", measured, f, f * (1 - correction));
    CHECK_ROW("METHOD 3", "free bar, 10 x 1 x 1, nu 0.3, 4 cells across: first axial frequency", f, measured, 0.005 * f);
}

static void a_confined_bar_has_its_frequency(void) {
    double modulus = E * (1 - NU) / ((1 + NU) * (1 - 2 * NU)), f = 0.5 * sqrt(modulus) / 10;
    double coarse = frequency(true, 0.5, 1), fine = frequency(true, 0.25, 0.5);
    printf("  %.5f, %.5f, exact %.5f\n", coarse, fine, f);
    CHECK_ROW("METHOD 3", "bar held in y and z, 40 cells long: first axial frequency (P wave)", f, fine, 0.005 * f);
}

static const shape *left_bar(arena *a) {
    return shape_box(a, (const double[]){-2, 0, 0}, (const double[]){0, width, width});
}

static status towards_the_middle(void *context, const double *x, int inputs, double *v, int outputs, report *r) {
    (void)context, (void)inputs, (void)outputs, (void)r;
    v[0] = x[0] < 0 ? 0.2 : -0.2, v[1] = v[2] = 0;
    return STATUS_OK;
}

typedef struct collision {
    double kinetic_least, elastic_most, kinetic_after, total_least, total_after, momentum; /* over the kinetic energy at first */
} collision;

/* Runs two bodies into each other. */
static collision collide(scene *s, double end, double dt) {
    simulation *sim = test_simulation(s, 64, "auto", 2);
    simulation_measures m;
    report r;
    simulation_measure(sim, &m, &r);
    double start = m.solid.kinetic, scale = m.solid.mass * 0.2;
    collision c = {.kinetic_least = 1, .total_least = 1};
    for (int64_t step = 0; simulation_time(sim) < end; step++) {
        CHECK(simulation_step(sim, dt, &r) == STATUS_OK);
        if (step % 4) continue;
        simulation_measure(sim, &m, &r);
        c.kinetic_least = fmin(c.kinetic_least, m.solid.kinetic / start);
        c.elastic_most = fmax(c.elastic_most, m.solid.elastic / start);
        c.total_least = fmin(c.total_least, (m.solid.elastic + m.solid.kinetic) / start);
        for (int k = 0; k < 3; k++) c.momentum = fmax(c.momentum, fabs(m.solid.momentum[k]) / scale);
    }
    c.kinetic_after = m.solid.kinetic / start, c.total_after = (m.solid.elastic + m.solid.kinetic) / start;
    simulation_destroy(sim);
    scene_destroy(s);
    return c;
}

static collision collide_bars(double dx) {
    width = 2 * dx;
    scene *s = test_scene(left_bar, E, 0, 1);
    s->dx = dx;
    s->body_count = 2;
    s->bodies[1] = s->bodies[0];
    s->bodies[1].shape = shape_box(s->memory, (const double[]){0.25, 0, 0}, (const double[]){2.25, width, width});
    for (int b = 0; b < 2; b++) s->bodies[b].velocity = (scene_function){.outputs = 3, .call = towards_the_middle};
    forbid_motion(s, 1), forbid_motion(s, 2);
    /* They meet at 0.625 less the reach of the kernels, touch for 2L/c = 0.4. */
    return collide(s, 1.4, 0.3 * dx / 10);
}

static void bars_exchange_their_speeds(void) {
    collision coarse = collide_bars(1.0 / 16), fine = collide_bars(1.0 / 64);
    printf("  strain energy at most %.3f, %.3f; kinetic energy after %.4f, %.4f; total %.4f, %.4f\n", coarse.elastic_most, fine.elastic_most,
           coarse.kinetic_after, fine.kinetic_after, coarse.total_after, fine.total_after);
    CHECK_ROW("METHOD 3", "two bars meet, 128 cells long each: strain energy at the turn over the kinetic energy before", 1, fine.elastic_most, 0.02);
    CHECK_ROW("METHOD 3", "the same: kinetic energy after over before", 1, fine.kinetic_after, 0.03);
    CHECK(1 - fine.total_after < 0.6 * (1 - coarse.total_after));
}

static const shape *left_ball(arena *a) {
    return shape_sphere(a, (const double[]){-0.7, 0, 0}, 0.5);
}

static collision collide_balls(double dx, transfer_kind transfer) {
    scene *s = test_scene(left_ball, E, NU, 1);
    s->dx = dx;
    s->transfer = transfer;
    s->transfer_ratio = transfer == TRANSFER_FLIP ? 1 : 0;
    s->body_count = 2;
    s->bodies[1] = s->bodies[0];
    s->bodies[1].shape = shape_sphere(s->memory, (const double[]){0.7, 0, 0}, 0.5);
    for (int b = 0; b < 2; b++) s->bodies[b].velocity = (scene_function){.outputs = 3, .call = towards_the_middle};
    return collide(s, 3, 0.024 * dx);
}

static void balls_keep_their_energy(void) {
    collision coarse = collide_balls(0.125, TRANSFER_APIC), fine = collide_balls(0.0625, TRANSFER_APIC), flip = collide_balls(0.0625, TRANSFER_FLIP);
    const collision *all[] = {&coarse, &fine, &flip};
    for (int i = 0; i < 3; i++) {
        printf("  kinetic energy at least %.4f, after %.4f; total at least %.4f, after %.4f; momentum %.1e\n", all[i]->kinetic_least,
               all[i]->kinetic_after, all[i]->total_least, all[i]->total_after, all[i]->momentum);
        CHECK(all[i]->kinetic_least < 0.05 && all[i]->momentum < 1e-12);
    }
    CHECK_ROW("METHOD 3", "two balls meet at 0.04 of the wave speed, 16 cells across, FLIP: energy after over before", 1, flip.total_after, 0.03);
    CHECK_ROW("METHOD 3", "the same, APIC", 1, fine.total_after, 0.1);
    CHECK(1 - fine.total_after < 0.7 * (1 - coarse.total_after));
}

int main(void) {
    RUN(a_free_bar_has_its_frequency);
    RUN(a_confined_bar_has_its_frequency);
    RUN(bars_exchange_their_speeds);
    RUN(balls_keep_their_energy);
    return check_finish();
}
