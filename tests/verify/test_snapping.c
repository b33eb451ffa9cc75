/* Fibres that snap (METHOD.md §1, beyond the paper).
 *
 * - A free block without stiffness to speak of, set off with v = k x along its fibres, stretches evenly: ℓ = 1 + k t. Then d_f = 0 until t0 = s/k and
 *   d_f = 1 − exp(−k (t − t0)²/(2 s T)) after; the error falls at first order with the step. With T = 0 all is whole before t0 and broken
 *   after. Across the fibres the same start breaks nothing.
 *   (In the middle: particles are set off without an affine part, which is felt at the ends.)
 * - A bundle of stiff fibres in a matrix of next to nothing, pulled slowly by its ends with T = 0: the largest strain that a whole fibre ever has is s
 *   (seen every 0.01: 3 %); then the bundle parts and the fibres store nothing. With a snap_strain out of reach it stays whole and goes on
 *   stretching. */
#include "check.h"
#include "verify/solid_particles.h"

#include "base/memory.h"

static const double RATE = 1, STRAIN = 0.1, TIME = 0.05;

static const shape *block(arena *a) {
    return shape_box(a, (const double[]){-0.5, -0.2, -0.2}, (const double[]){0.5, 0.2, 0.2});
}

static status stretching(void *context, const double *x, int inputs, double *v, int outputs, report *r) {
    (void)context, (void)inputs, (void)outputs, (void)r;
    v[0] = RATE * x[0], v[1] = v[2] = 0;
    return STATUS_OK;
}

typedef struct bundle_state {
    double damage, least, most; /* d_f: mean of the middle; extremes there */
    double anywhere;            /* the largest */
    double strain;              /* along x, mean of the middle */
    double held;                /* the largest along x of a fibre that is whole, anywhere */
} bundle_state;

static bundle_state look(simulation *sim, const double *rest) {
    double *d = particles_get(sim, "fibre_damage"), *F = particles_get(sim, "deformation_gradient"), used = 0;
    bundle_state out = {.least = 1};
    for (int64_t i = 0; i < simulation_get_plan(sim)->particles; i++) {
        out.anywhere = fmax(out.anywhere, d[i]);
        if (d[i] < 0.5) out.held = fmax(out.held, sqrt(F[9 * i] * F[9 * i] + F[9 * i + 3] * F[9 * i + 3] + F[9 * i + 6] * F[9 * i + 6]) - 1);
        if (fabs(rest[3 * i]) > 0.2) continue;
        out.least = fmin(out.least, d[i]), out.most = fmax(out.most, d[i]);
        out.damage += d[i], out.strain += F[9 * i] - 1, used++;
    }
    out.damage /= used, out.strain /= used;
    particles_drop(sim, d), particles_drop(sim, F);
    return out;
}

/* The free block at a time; `across`: its fibres lie across the stretching. */
static bundle_state free_block(double time, double dt, double snap_time, bool across, int precision) {
    scene *s = test_scene(block, 1e-6, 0.3, 1);
    s->particles = 4000;
    s->bodies[0].velocity = (scene_function){.outputs = 3, .call = stretching};
    s->bodies[0].fibres = (scene_fibres){.families = 1, .direction = {.outputs = 3, .constant = {!across, across, 0}}};
    test_set(s, "fibres", "gamma", 1);
    test_set(s, "snapping", "snap_strain", STRAIN);
    test_set(s, "snapping", "snap_time", snap_time);
    simulation *sim = test_simulation(s, precision, "auto", 2);
    report r;
    double *rest = particles_get(sim, "position");
    while (simulation_time(sim) < time - 0.5 * dt) CHECK(simulation_step(sim, dt, &r) == STATUS_OK);
    bundle_state out = look(sim, rest);
    particles_drop(sim, rest);
    simulation_destroy(sim);
    scene_destroy(s);
    return out;
}

static void an_even_stretch_breaks_them_in_its_time(void) {
    double start = STRAIN / RATE, end = start + 0.05, exact = 0, error[2];
    bundle_state b = free_block(0.95 * start, 1e-3, TIME, false, 64);
    CHECK(b.anywhere == 0 && b.strain > 0.9 * STRAIN);
    for (int i = 0; i < 2; i++) {
        b = free_block(end, i ? 1e-3 : 2e-3, TIME, false, 64);
        double rate = b.strain / end, late = end - STRAIN / rate; /* the rate that the start left */
        exact = 1 - exp(-rate * late * late / (2 * STRAIN * TIME));
        error[i] = fabs(b.damage - exact);
        printf("  step %g: %.6f (%.6f to %.6f), exact %.6f\n", i ? 1e-3 : 2e-3, b.damage, b.least, b.most, exact);
    }
    CHECK_ROW("METHOD 1", "fibres stretched at a constant rate: mean d_f against its closed form, step 1e-3", exact, b.damage, 0.015 * exact);
    CHECK_ROW("METHOD 1", "the same: its error over that of twice the step", 0.5, error[1] / error[0], 0.15);
    b = free_block(end, 1e-3, TIME, false, 32);
    CHECK(fabs(b.damage - exact) < 0.02 * exact);
    b = free_block(end, 1e-3, TIME, true, 64);
    CHECK(b.anywhere == 0);
}

static void without_a_time_they_break_at_once(void) {
    for (int precision = 32; precision <= 64; precision += 32) {
        CHECK(free_block(0.95 * STRAIN / RATE, 1e-3, 0, false, precision).anywhere == 0);
        bundle_state b = free_block(1.1 * STRAIN / RATE, 1e-3, 0, false, precision);
        CHECK(b.least > 0.999 && b.anywhere <= 1);
    }
}

/* Pulls it by 6 %. `held`: the largest strain of a whole fibre at any time; energy: the fibres' at most and at the end, and the grips' work. */
static bundle_state bundle(double snap_strain, double *held, double energy[3]) {
    scene *s = test_scene(block, 0.26, 0.3, 1);
    s->particles = 1500;
    s->transfer = TRANSFER_RPIC;
    s->bodies[0].fibres = (scene_fibres){.families = 1, .direction = {.outputs = 3, .constant = {1, 0, 0}}};
    test_set(s, "fibres", "gamma", 1000);
    test_set(s, "snapping", "snap_strain", snap_strain);
    s->effects[effect_index("boundary")].on = true;
    for (int side = -1; side <= 1; side += 2) {
        const double low[3] = {side < 0 ? -1 : 0.42, -1, -1}, high[3] = {side < 0 ? -0.42 : 1, 1, 1};
        s->grips[s->grip_count++] = (scene_grip){.shape = shape_box(s->memory, low, high), .stop = HUGE_VAL,
                                                 .velocity = {.outputs = 3, .constant = {side * 0.025, 0, 0}}};
    }
    simulation *sim = test_simulation(s, 32, "auto", 2);
    double *rest = particles_get(sim, "position");
    bundle_state b = {0};
    simulation_measures m;
    report r;
    *held = energy[0] = 0;
    while (simulation_time(sim) < 1) {
        CHECK(simulation_advance(sim, NULL, &r) == STATUS_OK);
        CHECK(simulation_measure(sim, &m, &r) == STATUS_OK);
        b = look(sim, rest);
        *held = fmax(*held, b.held);
        energy[1] = m.solid.fibre;
        energy[0] = fmax(energy[0], energy[1]);
        energy[2] = m.solid.grip_work;
    }
    particles_drop(sim, rest);
    simulation_destroy(sim);
    scene_destroy(s);
    return b;
}

static void a_bundle_parts_at_its_stretch(void) {
    double held, energy[3];
    bundle_state b = bundle(0.03, &held, energy);
    printf("  whole up to a strain of %.5f; fibres store %.4g at most, then %.4g; the grips' work %.4g\n", held, energy[0], energy[1], energy[2]);
    CHECK_ROW("METHOD 1", "bundle of fibres pulled until it parts: largest strain of a whole fibre, snap_strain 0.03", 0.03, held, 1e-3);
    CHECK(b.anywhere > 0.999 && energy[1] < 0.05 * energy[0] && energy[2] < 2 * energy[0]);
    b = bundle(1, &held, energy);
    CHECK(b.anywhere == 0 && b.strain > 0.045 && held > 0.05 && fabs(energy[2] / energy[0] - 1) < 0.1 && energy[1] == energy[0]);
}

int main(void) {
    RUN(an_even_stretch_breaks_them_in_its_time);
    RUN(without_a_time_they_break_at_once);
    RUN(a_bundle_parts_at_its_stretch);
    CHECK(memory_live_bytes() == 0);
    return check_finish();
}
