/* What diffuses in solids, swells and softens them: closed forms, conservation, cracks that let nothing through (METHOD.md, end of §6). */
#include "check.h"
#include "verify/solid_scene.h"

#include "base/random.h"

static const double PI = 3.14159265358979323846;

typedef struct slab {
    scene *s;
    simulation *sim;
} slab;

static double width_of_bar = 0.2, length_of_bar = 1;

static const shape *bar(arena *a) {
    double half = 0.5 * width_of_bar;
    return shape_box(a, (const double[]){0, -half, -half}, (const double[]){length_of_bar, half, half});
}

/* A bar along x, 1/n the grid's spacing, that the mechanics leave alone, of density 2 and C 3. */
static scene *still_bar(int n, double length, double width, double k) {
    width_of_bar = width, length_of_bar = length;
    scene *s = test_scene(bar, 1e-9, 0.3, 2);
    s->dx = 1.0 / n;
    s->bodies[0].sampling = SAMPLING_LATTICE;
    test_set(s, "diffusion", "k", k);
    test_set(s, "diffusion", "C", 3);
    return s;
}

static scene_source *add_source(scene *s) {
    scene_source *from = &s->bodies[0].sources[s->bodies[0].source_count++];
    *from = (scene_source){.value = {.outputs = 1}, .stop = HUGE_VAL, .strength = 1, .on = 1};
    return from;
}

static void hold_within(scene *s, double low, double high, double value) {
    scene_source *from = add_source(s);
    from->fixed = true;
    from->value.constant[0] = value;
    from->shape = shape_box(s->memory, (const double[]){low, -9, -9}, (const double[]){high, 9, 9});
}

/* θ at the start alone. */
static void start_with(scene *s, status (*call)(void *, const double *, int, double *, int, report *)) {
    scene_source *from = add_source(s);
    from->fixed = true;
    from->value.call = call;
    from->stop = 1e-12;
}

static status cosine(void *context, const double *x, int inputs, double *out, int outputs, report *r) {
    (void)context, (void)inputs, (void)outputs, (void)r;
    *out = cos(PI * x[0]);
    return STATUS_OK;
}

static status noise(void *context, const double *x, int inputs, double *out, int outputs, report *r) {
    (void)context, (void)inputs, (void)outputs, (void)r;
    *out = random_unit(3, (uint64_t)(1e9 * x[0]), (uint64_t)(1e9 * (x[1] + 7 * x[2] + 20))) < 0.5 ? 0 : 1;
    return STATUS_OK;
}

/* One frame of length `until`, in steps of a share of diffusion's own limit; θ and places in order of id. */
static int64_t run(scene *s, double until, double share, int threads, double *theta, double *x, simulation_measures *m) {
    report r;
    s->fps = 1 / until;
    simulation *sim = test_simulation(s, 64, "auto", threads);
    CHECK(sim != NULL);
    if (!sim) return 0;
    const simulation_plan *plan = simulation_get_plan(sim);
    double limit = plan->limits[effect_index_of(ENGINE_SOLID, "diffusion")];
    int64_t count = plan->particles;
    simulation_read(sim, "position", x); /* they hardly move */
    if (share > 0) {
        simulation_destroy(sim);
        s->dt = share * limit;
        sim = test_simulation(s, 64, "auto", threads);
    }
    CHECK(simulation_measure(sim, &m[0], &r) == STATUS_OK);
    CHECK(simulation_advance(sim, NULL, &r) == STATUS_OK);
    CHECK(simulation_measure(sim, &m[1], &r) == STATUS_OK);
    CHECK(simulation_read(sim, "diffused", theta) == 1);
    simulation_destroy(sim);
    return count;
}

enum { MOST = 60000 };
static double theta[MOST], place[3 * MOST];

/* ---- closed forms ------------------------------------------------------------------------------------------------ */

static double insulated_error(int n) {
    scene *s = still_bar(n, 1, 4.0 / n, 6); /* diffusivity 1 */
    simulation_measures m[2];
    double worst = 0, until = 0.1;
    start_with(s, cosine);
    int64_t count = run(s, until, 0.4, 2, theta, place, m);
    for (int64_t i = 0; i < count; i++) worst = fmax(worst, fabs(theta[i] - cos(PI * place[3 * i]) * exp(-PI * PI * until)));
    scene_destroy(s);
    return worst;
}

static void an_insulated_bar_forgets_its_cosine(void) {
    double error[3];
    for (int k = 0; k < 3; k++) error[k] = insulated_error(10 << k);
    CHECK_ROW("METHOD 6", "solid: insulated bar from a cosine, t = 0.1, N = 40: largest error", 0, error[2], 2.5e-4);
    CHECK_ROW("METHOD 6", "the same: order from N = 10 to 20", 2, log2(error[0] / error[1]), 0.1);
    CHECK_ROW("METHOD 6", "the same: order from N = 20 to 40", 2, log2(error[1] / error[2]), 0.1);
}

static double slab_error(int n) {
    double dx = 1.0 / n, until = 0.1, worst = 0;
    scene *s = still_bar(n, 1 + 6 * dx, 4 * dx, 6);
    simulation_measures m[2];
    double low = 3 * dx, high = 1 + 3 * dx;
    hold_within(s, -1, low, 1);
    hold_within(s, high, 9, 0);
    int64_t count = run(s, until, 0.4, 2, theta, place, m);
    for (int64_t i = 0; i < count; i++) {
        double x = place[3 * i] - low, expected = 1 - x;
        if (x < 0 || x > 1) continue;
        for (int k = 1; k < 60; k++) expected -= 2 * sin(k * PI * x) * exp(-k * k * PI * PI * until) / (k * PI);
        worst = fmax(worst, fabs(theta[i] - expected));
    }
    scene_destroy(s);
    return worst;
}

/* A held face is known to a part of a cell: first order, however smooth the rest. */
static void a_slab_follows_its_fourier_series(void) {
    double error[2] = {slab_error(20), slab_error(40)};
    CHECK_ROW("METHOD 6", "solid: slab between 1 and 0, t = 0.1, N = 20: largest error over dx", 0, error[0] * 20, 0.3);
    CHECK_ROW("METHOD 6", "the same: N = 40", 0, error[1] * 40, 0.3);
    CHECK_ROW("METHOD 6", "the same: order", 1, log2(error[0] / error[1]), 0.15);
}

static void sources_and_decay_add_up(void) {
    scene *s = still_bar(10, 1, 0.4, 0.01);
    simulation_measures m[2];
    scene_source *from = add_source(s);
    from->value.constant[0] = 5;
    from->start = 0.0101, from->stop = 0.0473;
    s->dt = 0.001;
    (void)run(s, 0.1, 0, 1, theta, place, m);
    CHECK_ROW("METHOD 6", "solid: a source on for a while: sum of rho C V theta", 6 * 0.16 * 5 * (0.0473 - 0.0101), m[1].solid.diffused_total, 1e-14);
    scene_destroy(s);
    s = still_bar(10, 1, 0.4, 0.01);
    test_set(s, "diffusion", "decay", 3);
    test_set(s, "diffusion", "initial", 2);
    (void)run(s, 0.5, 0, 1, theta, place, m);
    CHECK_ROW("METHOD 6", "solid: decay at rate 3 for 0.5: theta", 2 * exp(-1.5), theta[17], 1e-12);
    scene_destroy(s);
}

/* ---- conservation, cracks, the limit ----------------------------------------------------------------------------- */

static void make_breakable(scene *s) {
    test_set(s, "damage", "sigma_c", 1);
    test_set(s, "damage", "eta", 1e6);
}

/* Places, densities, conductivities and damage without any order. */
static void nothing_is_lost(void) {
    scene *s = still_bar(12, 1, 0.5, 6);
    simulation_measures m[2];
    s->bodies[0].sampling = SAMPLING_JITTERED;
    make_breakable(s);
    s->bodies[0].notches = shape_sphere(s->memory, (const double[]){0.5, 0, 0}, 0.2);
    s->materials[1] = s->materials[0];
    snprintf(s->materials[1].name, sizeof s->materials[1].name, "other");
    s->materials[1].density = 0.7;
    s->material_count = 2;
    test_set_material(s, 1, "diffusion", "k", 0.3);
    s->bodies[1] = s->bodies[0];
    s->bodies[1].material = 1;
    s->bodies[1].notches = NULL;
    s->bodies[1].shape = shape_box(s->memory, (const double[]){0, 0.25, -0.25}, (const double[]){1, 0.6, 0.25});
    s->body_count = 2;
    start_with(s, noise);
    (void)run(s, 0.05, 0.4, 3, theta, place, m);
    CHECK_ROW("METHOD 6", "solid: jittered, broken in part, two materials: relative change of the sum of rho C V theta", 0,
              m[1].solid.diffused_total / m[0].solid.diffused_total - 1, 1e-13);
    scene_destroy(s);
}

/* What has gone from a hot part to the cold half. */
static double passed(double cut) {
    scene *s = still_bar(20, 1, 0.2, 6);
    simulation_measures m[2];
    make_breakable(s);
    double half = 0.5 * cut / 20, sum = 0;
    s->bodies[0].notches = cut > 0 ? shape_box(s->memory, (const double[]){0.51 - half, -1, -1}, (const double[]){0.51 + half, 1, 1}) : NULL;
    hold_within(s, -1, 0.3, 1);
    s->bodies[0].sources[0].stop = 1e-12;
    int64_t count = run(s, 0.1, 0.4, 2, theta, place, m);
    for (int64_t i = 0; i < count; i++) sum += place[3 * i] > 0.6 ? theta[i] : 0;
    scene_destroy(s);
    return sum / (double)count;
}

static void a_crack_lets_nothing_through(void) {
    double whole = passed(0);
    CHECK(whole > 0.05);
    CHECK_ROW("METHOD 6", "solid: crack 3 dx wide: what has passed", 0, passed(3), 0);
    CHECK_ROW("METHOD 6", "the same 2 dx wide: over what passes without", 0, passed(2) / whole, 1e-3);
    CHECK_ROW("METHOD 6", "the same 1 dx wide", 0, passed(1) / whole, 0.1);
}

static void the_limit_keeps_extremes(void) {
    double worst[2];
    for (int k = 0; k < 2; k++) {
        scene *s = still_bar(10, 1, 0.4, 6);
        simulation_measures m[2];
        s->bodies[0].sampling = SAMPLING_JITTERED;
        start_with(s, noise);
        int64_t count = run(s, 0.05, k ? 3 : 1, 1, theta, place, m);
        worst[k] = 0;
        for (int64_t i = 0; i < count; i++) worst[k] = fmax(worst[k], fmax(theta[i] - 1, -theta[i]));
        scene_destroy(s);
    }
    CHECK_ROW("METHOD 6", "solid: random 0 and 1 at the step limit: how far theta leaves [0, 1]", 0, worst[0], 1e-12);
    CHECK(worst[1] > 1); /* and beyond it it does */
}

/* ---- swelling ---------------------------------------------------------------------------------------------------- */

static status outwards(void *context, const double *x, int inputs, double *out, int outputs, report *r) {
    (void)inputs, (void)outputs, (void)r;
    const double *rate = context;
    for (int c = 0; c < 3; c++) out[c] = rate[c] * x[c];
    return STATUS_OK;
}

/* Of all particles: the largest entry of τ. */
static double largest_stress(const simulation *sim) {
    static double tau[6 * MOST];
    double worst = 0;
    CHECK(simulation_read(sim, "kirchhoff_stress", tau) == 6);
    for (int64_t i = 0; i < 6 * simulation_get_plan(sim)->particles; i++) worst = fmax(worst, fabs(tau[i]));
    return worst;
}

/* The velocity's gradient, which particles carry and a scene cannot give. */
static void set_affine(simulation *sim, const double rate[3]) {
    record_list list = {0};
    report r;
    CHECK(simulation_save(sim, &list, &r) == STATUS_OK);
    const record *affine = record_find(&list, "solid/affine_velocity");
    double *data = affine->data;
    for (int64_t i = 0; i < affine->count * affine->components; i++) data[i] = i / 16 % 9 % 4 == 0 ? rate[i / 16 % 9 / 4] : 0;
    CHECK(simulation_restore(sim, &list, &r) == STATUS_OK);
    record_clear(&list);
}

/* θ grows at a rate of 1 and the body moves as it swells: nothing may press, but for what a transfer makes of a velocity gradient that
 * changes, which is of second order in α. `along` apart from alpha along the fibres, which lie along x. */
static double stress_of_free_swelling(double alpha, double along, bool fibres) {
    static double rate[3];
    rate[0] = along, rate[1] = rate[2] = alpha;
    width_of_bar = 0.4, length_of_bar = 1;
    scene *s = test_scene(bar, 100, 0.3, 2);
    report r;
    s->dx = 0.1;
    s->dt = 2e-3; /* θ is brought up to date in every step */
    s->fps = 1;
    test_set(s, "diffusion", "k", 1.4);
    test_set(s, "swelling", "alpha", alpha);
    if (fibres) {
        test_set(s, "swelling", "along", along);
        s->bodies[0].fibres = (scene_fibres){.families = 1, .direction = {.outputs = 3, .constant = {1, 0, 0}}};
    }
    s->bodies[0].velocity = (scene_function){.outputs = 3, .call = outwards, .context = rate};
    add_source(s)->value.constant[0] = 1;
    simulation *sim = test_simulation(s, 64, "auto", 1);
    CHECK(sim != NULL);
    if (sim) set_affine(sim, rate);
    CHECK(sim && simulation_advance(sim, NULL, &r) == STATUS_OK);
    double worst = sim ? largest_stress(sim) : NAN;
    simulation_destroy(sim);
    scene_destroy(s);
    return worst / 100 / alpha;
}

/* Everything held, θ = 1. */
static simulation *clamped(double alpha, scene **s) {
    width_of_bar = 0.4, length_of_bar = 1;
    *s = test_scene(bar, 100, 0.3, 2);
    report r;
    (*s)->dx = 0.1;
    (*s)->fps = 1e3;
    test_set(*s, "diffusion", "k", 0.01);
    test_set(*s, "diffusion", "initial", 1);
    test_set(*s, "swelling", "alpha", alpha);
    (*s)->grips[(*s)->grip_count++] = (scene_grip){.shape = shape_sphere((*s)->memory, (const double[]){0, 0, 0}, 9), .stop = HUGE_VAL,
                                                   .velocity = {.outputs = 3}};
    simulation *sim = test_simulation(*s, 64, "auto", 1);
    CHECK(sim && simulation_advance(sim, NULL, &r) == STATUS_OK);
    return sim;
}

static void swelling_is_stress_or_strain(void) {
    CHECK_ROW("METHOD 6", "solid: swelling freely to alpha theta = 1e-4: largest stress over E alpha theta", 0, stress_of_free_swelling(1e-4, 1e-4, false), 1e-7);
    CHECK_ROW("METHOD 6", "the same, -2e-5 along fibres", 0, stress_of_free_swelling(1e-4, -2e-5, true), 1e-7);
    for (int k = 0; k < 2; k++) {
        double alpha = k ? 1e-6 : 0.1, F = 1 / (1 + alpha), J = F * F * F, mu = 100 / 2.6, lambda = 100 * 0.3 / (1.3 * 0.4) + mu;
        scene *s;
        simulation *sim = clamped(alpha, &s);
        double exact = mu * F * F + (lambda * (J - 1) - mu) * J, linear = -100 * alpha / (1 - 2 * 0.3);
        if (sim && !k) CHECK_ROW("METHOD 6", "solid: clamped, alpha theta = 0.1: stress, from the energy", exact, -largest_stress(sim), 1e-11);
        if (sim && k) CHECK_ROW("METHOD 6", "the same, 1e-6: stress over -E alpha theta/(1 - 2 nu)", 1, -largest_stress(sim) / linear, 1e-5);
        simulation_destroy(sim);
        scene_destroy(s);
    }
}

/* ---- softening --------------------------------------------------------------------------------------------------- */

/* A bar pulled apart, part of it wet from the start, until something is broken: where that is, and the energy that was needed. */
static double pull(double strength, double *where) {
    width_of_bar = 0.3, length_of_bar = 1.2;
    scene *s = test_scene(bar, 1e3, 0.3, 1);
    report r;
    s->particles = 3000;
    s->fps = 120;
    test_set(s, "diffusion", "k", 1e-4);
    test_set(s, "softening", "strength", strength);
    test_set(s, "damage", "break_stretch", 0.1);
    test_set(s, "damage", "eta", 0.01);
    hold_within(s, 0.3, 0.5, 1);
    for (int side = 0; side < 2; side++)
        s->grips[s->grip_count++] = (scene_grip){.shape = shape_box(s->memory, (const double[]){side ? 1.1 : -1, -9, -9}, (const double[]){side ? 9 : 0.1, 9, 9}),
                                                 .protects = true, .stop = HUGE_VAL, .velocity = {.outputs = 3, .constant = {side ? 0.3 : -0.3, 0, 0}}};
    simulation *sim = test_simulation(s, 64, "auto", 2);
    simulation_measures m = {0};
    double most = 0, sum = 0, weight = 0;
    if (sim) simulation_read(sim, "position", place);
    for (int f = 0; sim && f < 200 && m.solid.damage_max < 0.9; f++) {
        CHECK(simulation_advance(sim, NULL, &r) == STATUS_OK && simulation_measure(sim, &m, &r) == STATUS_OK);
        most = fmax(most, m.solid.elastic);
    }
    if (sim) simulation_read(sim, "damage", theta);
    for (int64_t i = 0; sim && i < simulation_get_plan(sim)->particles; i++)
        if (theta[i] > 0.5) sum += place[3 * i], weight += 1;
    *where = sum / weight;
    simulation_destroy(sim);
    scene_destroy(s);
    return most;
}

static void what_is_wet_breaks_first(void) {
    double dry, wet, energy = pull(0, &dry), energy_wet = pull(0.6, &wet);
    CHECK_ROW("METHOD 6", "solid: bar wet from 0.3 to 0.5, where it keeps 0.4 of sigma_c: where it breaks", 0.4, wet, 0.1);
    CHECK(energy_wet < 0.5 * energy && fabs(dry - 0.4) > 0.1); /* which it would not do by itself */
}

int main(void) {
    RUN(an_insulated_bar_forgets_its_cosine);
    RUN(a_slab_follows_its_fourier_series);
    RUN(sources_and_decay_add_up);
    RUN(nothing_is_lost);
    RUN(a_crack_lets_nothing_through);
    RUN(the_limit_keeps_extremes);
    RUN(swelling_is_stress_or_strain);
    RUN(what_is_wet_breaks_first);
    return check_finish();
}
