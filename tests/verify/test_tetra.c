/* Bodies of linear tetrahedra (solid paper, Fig. 19; METHOD.md §1), f64 unless said.
 *
 * - Corner forces are minus the gradient of the stored energy, in crumpled and inverted states (central differences).
 * - F of an affine map is that map in every element, and inner vertices feel no force.
 * - Momentum and angular momentum are kept; the energy of a vibrating body too, at the full step limit.
 * - Of a soft body that flies apart the change of F limits the step.
 * - A bar in slow tension between grips gives back E; a vertex falls with gravity.
 * - Recovery: vertices anywhere in a box, or all in one point but for seeds of 1e-6, return to the rest shape with all J > 0, in f32 and f64, with two
 *   families of fibres, γ λ/μ > 1. Without fibres the collapsed body stays collapsed, as METHOD.md says: no force acts at F = 0. */
#include "check.h"
#include "verify/solid_particles.h"

#include "base/random.h"

static const double SIDE = 1;
static const double MATRIX[9] = {1.1, 0.3, -0.2, 0.1, 0.8, 0.25, -0.3, 0.15, 1.2};

static double chance(uint64_t stream, uint64_t i) {
    return 2 * random_unit(77, stream, i) - 1;
}

static const shape *cube(arena *a) {
    return shape_box(a, (const double[]){-0.5 * SIDE, -0.5 * SIDE, -0.5 * SIDE}, (const double[]){0.5 * SIDE, 0.5 * SIDE, 0.5 * SIDE});
}

static scene *cube_of(int cells, double gamma) {
    scene *s = test_scene(cube, 100, 0.3, 1);
    s->bodies[0].discretisation = DISCRETISATION_TETRAHEDRA;
    s->dx = SIDE / cells;
    if (gamma > 0) test_set(s, "fibres", "gamma", gamma), test_set(s, "fibres", "gamma2", gamma);
    if (gamma > 0) s->bodies[0].fibres = (scene_fibres){.families = 2, .direction = {.outputs = 6, .constant = {1, 0, 0, 0, 1, 0}}};
    return s;
}

static status affine(void *context, const double *x, int inputs, double *y, int outputs, report *r) {
    (void)context, (void)inputs, (void)outputs, (void)r;
    for (int i = 0; i < 3; i++) y[i] = MATRIX[3 * i] * x[0] + MATRIX[3 * i + 1] * x[1] + MATRIX[3 * i + 2] * x[2];
    return STATUS_OK;
}

/* A place of its own for every vertex, whatever the lattice: chance by the bits of x. context: how far from rest; NULL: nothing of rest is left. */
static status scattered(void *context, const double *x, int inputs, double *y, int outputs, report *r) {
    (void)inputs, (void)outputs, (void)r;
    uint64_t key = 0;
    for (int c = 0; c < 3; c++) key = random_mix(key ^ (uint64_t)(int64_t)llround(x[c] * 1e6));
    for (int c = 0; c < 3; c++) y[c] = context ? x[c] + *(double *)context * chance((uint64_t)c, key) : 0.5 * chance((uint64_t)c, key);
    return STATUS_OK;
}

static status point_with_seeds(void *context, const double *x, int inputs, double *y, int outputs, report *r) {
    status code = scattered(NULL, x, inputs, y, outputs, r);
    for (int c = 0; c < 3; c++) y[c] *= *(double *)context;
    return code;
}

static void affine_maps_are_exact(void) {
    scene *s = cube_of(4, 3);
    s->bodies[0].start = (scene_function){.outputs = 3, .call = affine};
    simulation *sim = test_simulation(s, 64, "auto", 2);
    report r;
    int64_t n = simulation_get_plan(sim)->particles;
    double *rest = memory_allocate((size_t)n * 24), error = 0, inner = 0, outer = 0;
    solid *state;
    const solid_engine *engine = simulation_engine(sim, &state);
    double *F = particles_get(sim, "deformation_gradient");
    for (int64_t i = 0; i < 9 * n; i++) error = fmax(error, fabs(F[i] - MATRIX[i % 9]));
    CHECK(simulation_step(sim, 1e-6, &r) == STATUS_OK);
    double *v = particles_get(sim, "velocity"), *x = particles_get(sim, "position");
    /* inner vertices: rest place by the inverse map would do; the faces' own are those with a face's coordinate at rest */
    engine->read(state, "volume", rest);
    for (int64_t i = 0; i < n; i++) {
        double speed = fabs(v[3 * i]) + fabs(v[3 * i + 1]) + fabs(v[3 * i + 2]);
        bool inside = rest[i] > 0.9 * pow(SIDE / 4, 3); /* whole cubes of volume around it */
        inner = fmax(inner, inside ? speed : 0), outer = fmax(outer, inside ? 0 : speed);
    }
    CHECK_ROW("METHOD 1", "tetrahedra, affine map: worst error of F", 0, error, 1e-13);
    CHECK_ROW("METHOD 1", "the same: worst force on an inner vertex over the worst on an outer one", 0, inner / outer, 1e-11);
    particles_drop(sim, F), particles_drop(sim, v), particles_drop(sim, x);
    memory_free(rest, (size_t)n * 24);
    simulation_destroy(sim);
    scene_destroy(s);
}

/* The gradient of the stored energy along a random direction, through positions written into a checkpoint, against the forces that a step shows. */
static double force_error(bool corotated, double crumple) {
    scene *s = cube_of(3, 4);
    if (corotated) {
        s->materials[0].effects[EFFECT_elastic].on = false;
        test_set(s, "corotated", "E", 100), test_set(s, "corotated", "nu", 0.3);
    }
    s->bodies[0].start = (scene_function){.outputs = 3, .call = scattered, .context = crumple > 0 ? &crumple : NULL};
    simulation *sim = test_simulation(s, 64, "auto", 2);
    solid *state;
    const solid_engine *engine = simulation_engine(sim, &state);
    int64_t n = simulation_get_plan(sim)->particles;
    report r;
    record_list saved = {0};
    CHECK(engine->save(state, &saved, &r) == STATUS_OK);
    double *x = record_find(&saved, "solid/place")->data, *nodes = record_find(&saved, "solid/nodes")->data, worst = 0, dt = 1e-12;
    solid_fault fault;
    CHECK(engine->step(state, dt, &fault, &r) == STATUS_OK);
    double *v = particles_get(sim, "velocity"), *D = particles_get(sim, "position");
    for (uint64_t k = 0; k < 10; k++) {
        double power = 0, size = 0, energy[2], h = 1e-6;
        for (int64_t i = 0; i < 3 * n; i++) {
            D[i] = chance(30 + k, (uint64_t)i);
            power += D[i] * nodes[4 * (i / 3) + 3] * v[i] / dt;
            size += fabs(nodes[4 * (i / 3) + 3] * v[i] / dt);
        }
        for (int side = 0; side < 2; side++) {
            for (int64_t i = 0; i < 3 * n; i++) x[i] += (side ? -2 : 1) * h * D[i];
            CHECK(engine->restore(state, &saved, &r) == STATUS_OK);
            solid_measures m;
            CHECK(engine->measure(state, &m, &r) == STATUS_OK);
            energy[side] = m.elastic + m.fibre;
        }
        for (int64_t i = 0; i < 3 * n; i++) x[i] += h * D[i];
        worst = fmax(worst, fabs((energy[0] - energy[1]) / (2 * h) + power) / size);
    }
    particles_drop(sim, v), particles_drop(sim, D);
    record_clear(&saved);
    simulation_destroy(sim);
    scene_destroy(s);
    return worst;
}

static void forces_are_the_gradient_of_energy(void) {
    double mild = force_error(false, 0.05), crumpled = force_error(false, 0), corotated = force_error(true, 0.05);
    printf("  %.1e, all vertices anywhere %.1e, corotated %.1e\n", mild, crumpled, corotated);
    CHECK_ROW("METHOD 1", "tetrahedra: corner forces against differences of the energy, elastic and two fibre families", 0, mild, 1e-8);
    CHECK_ROW("METHOD 1", "the same, every vertex anywhere in a box", 0, crumpled, 1e-8);
    CHECK_ROW("METHOD 1", "the same, corotated and two fibre families", 0, corotated, 1e-8);
}

static status spin(void *context, const double *x, int inputs, double *v, int outputs, report *r) {
    (void)context, (void)inputs, (void)outputs, (void)r;
    v[0] = 0.3 - 4 * x[1], v[1] = -0.1 + 4 * x[0] - x[2], v[2] = 0.2 + x[1];
    return STATUS_OK;
}

/* Momenta to round-off; energy, at `part` of the stability limit, to `wavers` after a start from a wrung state. */
static void wring(double part, double *drift, double *wavers) {
    double crumple = 0.03;
    scene *s = cube_of(4, 4);
    s->cfl = part;
    s->bodies[0].start = (scene_function){.outputs = 3, .call = scattered, .context = &crumple};
    s->bodies[0].velocity = (scene_function){.outputs = 3, .call = spin};
    simulation *sim = test_simulation(s, 64, "auto", 2);
    simulation_measures start, m;
    report r;
    simulation_measure(sim, &start, &r);
    double linear = 0, angular = 0, energy = start.solid.kinetic + start.solid.elastic + start.solid.fibre;
    for (int c = 0; c < 3; c++) linear += fabs(start.solid.momentum[c]), angular += fabs(start.solid.angular_momentum[c]);
    *drift = *wavers = 0;
    for (int i = 0; i < 4000; i++) {
        CHECK(simulation_step(sim, 0, &r) == STATUS_OK);
        if (i % 50) continue;
        simulation_measure(sim, &m, &r);
        for (int c = 0; c < 3; c++) {
            *drift = fmax(*drift, fabs(m.solid.momentum[c] - start.solid.momentum[c]) / linear);
            *drift = fmax(*drift, fabs(m.solid.angular_momentum[c] - start.solid.angular_momentum[c]) / angular);
        }
        *wavers = fmax(*wavers, fabs((m.solid.kinetic + m.solid.elastic + m.solid.fibre) / energy - 1));
    }
    simulation_destroy(sim);
    scene_destroy(s);
}

static void momenta_and_energy_are_kept(void) {
    double drift, wavers, full_drift, full;
    wring(0.1, &drift, &wavers);
    wring(1, &full_drift, &full);
    printf("  momenta %.1e, energy wavers %.2e at 0.1 of the limit, %.2e at the limit\n", fmax(drift, full_drift), wavers, full);
    CHECK_ROW("METHOD 3", "tetrahedra, wrung and spinning, 4000 steps: worst relative change of momenta", 0, fmax(drift, full_drift), 1e-12);
    CHECK_ROW("METHOD 3", "the same at a tenth of the step limit: energy wavers by", 0, wavers, 0.02);
    CHECK(full < 1); /* no growth without bound at the limit itself */
}

static status swell(void *context, const double *x, int inputs, double *v, int outputs, report *r) {
    (void)context, (void)inputs, (void)outputs, (void)r;
    for (int c = 0; c < 3; c++) v[c] = 7 * x[c];
    return STATUS_OK;
}

/* A soft body that flies apart: not stiffness but the change of F limits its step, to half of |F|. */
static void fast_change_limits_the_step(void) {
    scene *s = cube_of(3, 0);
    s->materials[0].effects[EFFECT_elastic].value[0][0] = 1e-6;
    s->cfl = 1;
    s->bodies[0].velocity = (scene_function){.outputs = 3, .call = swell};
    simulation *sim = test_simulation(s, 64, "auto", 1);
    CHECK_NEAR(simulation_get_plan(sim)->limits[EFFECT_elastic], 0.5 / 7, 1e-9);
    simulation_destroy(sim);
    scene_destroy(s);
}

static void a_bar_in_tension_gives_back_E(void) {
    double E = 100, nu = 0.3, speed = 2e-3;
    scene *s = test_scene(test_bar, E, nu, 1);
    s->bodies[0].discretisation = DISCRETISATION_TETRAHEDRA;
    s->dx = 0.25;
    s->effects[EFFECT_mass_damping].on = true;
    s->effects[EFFECT_mass_damping].value[0][0] = 1;
    test_pull(s, 1.9, speed);
    simulation *sim = test_simulation(s, 64, "auto", 2);
    report r;
    simulation_measures before, after;
    double *rest = particles_get(sim, "position");
    int64_t n = simulation_get_plan(sim)->particles, used = 0;
    while (simulation_time(sim) < 3) CHECK(simulation_step(sim, 0, &r) == STATUS_OK);
    simulation_measure(sim, &before, &r);
    double from = simulation_time(sim);
    while (simulation_time(sim) < 4) CHECK(simulation_step(sim, 0, &r) == STATUS_OK);
    simulation_measure(sim, &after, &r);
    double parted = 2 * speed * (simulation_time(sim) - from), middle = simulation_time(sim) - 0.5 * (simulation_time(sim) - from);
    double force = (after.solid.grip_work - before.solid.grip_work) / parted, strain = 0;
    double *F = particles_get(sim, "deformation_gradient");
    for (int64_t i = 0; i < n; i++)
        if (fabs(rest[3 * i]) < 0.6) strain += F[9 * i] - 1, used++;
    strain *= middle / simulation_time(sim) / (double)used;
    CHECK_ROW("METHOD 1", "bar of tetrahedra in slow tension between grips: E", E, force / strain, 0.02 * E);
    particles_drop(sim, rest), particles_drop(sim, F);
    simulation_destroy(sim);
    scene_destroy(s);
}

static void gravity_and_damping_act(void) {
    scene *s = cube_of(2, 0);
    s->effects[EFFECT_gravity].on = s->effects[EFFECT_mass_damping].on = true;
    s->effects[EFFECT_gravity].value[0][1] = -9;
    s->effects[EFFECT_mass_damping].value[0][0] = 2;
    simulation *sim = test_simulation(s, 64, "auto", 1);
    report r;
    simulation_measures m;
    for (int i = 0; i < 2000; i++) CHECK(simulation_step(sim, 2.5e-4, &r) == STATUS_OK);
    simulation_measure(sim, &m, &r);
    CHECK_ROW("METHOD 3", "cube of tetrahedra that falls with drag 2 for 0.5: speed", -4.5 * (1 - exp(-1)), m.solid.momentum[1] / m.solid.mass, 2e-3);
    CHECK_NEAR(m.solid.determinant_min, 1, 1e-9);
    CHECK_NEAR(m.solid.mass, 1, 1e-12);
    simulation_destroy(sim);
    scene_destroy(s);
}

/* ---- recovery ---------------------------------------------------------------------------------------------------- */

/* Measures after the body has had `time` to find back, with drag. */
static solid_measures recover(scene_function start, double gamma, int precision, int cells, double time) {
    scene *s = cube_of(cells, gamma);
    s->bodies[0].start = start;
    s->effects[EFFECT_mass_damping].on = true;
    s->effects[EFFECT_mass_damping].value[0][0] = 6;
    simulation *sim = test_simulation(s, precision, "auto", 2);
    report r;
    simulation_measures m;
    simulation_measure(sim, &m, &r);
    double least = m.solid.determinant_min, energy = m.solid.elastic;
    while (simulation_time(sim) < time) CHECK(simulation_step(sim, 0, &r) == STATUS_OK);
    simulation_measure(sim, &m, &r);
    printf("  f%d, gamma %g: J from %.3g at least, energy %.3g, to J %.6f … %.6f, energy %.1e\n", precision, gamma, least, energy, m.solid.determinant_min,
           m.solid.determinant_max, m.solid.elastic + m.solid.fibre);
    simulation_destroy(sim);
    scene_destroy(s);
    return m.solid;
}

static void every_vertex_anywhere_finds_back(void) {
    for (int precision = 32; precision <= 64; precision += 32) {
        solid_measures m = recover((scene_function){.outputs = 3, .call = scattered}, 10, precision, 5, 6);
        CHECK_ROW("METHOD 1", precision == 32 ? "tetrahedra, every vertex anywhere in a box, two fibre families: least J after, f32" : "tetrahedra, every vertex anywhere in a box, two fibre families: least J after, f64", 1, m.determinant_min, 1e-3);
        CHECK_NEAR(m.determinant_max, 1, 1e-3);
        CHECK(m.elastic + m.fibre < 1e-5);
    }
}

static void a_point_with_seeds_opens(void) {
    double seeds = 1e-6;
    for (int precision = 32; precision <= 64; precision += 32) {
        solid_measures m = recover((scene_function){.outputs = 3, .call = point_with_seeds, .context = &seeds}, 10, precision, 5, 6);
        CHECK_ROW("METHOD 1", precision == 32 ? "tetrahedra, all in one point but for seeds of 1e-6, two fibre families: least J after, f32" : "tetrahedra, all in one point but for seeds of 1e-6, two fibre families: least J after, f64", 1, m.determinant_min, 1e-3);
        CHECK_NEAR(m.determinant_max, 1, 1e-3);
        CHECK(m.elastic + m.fibre < 1e-5);
    }
    solid_measures m = recover((scene_function){.outputs = 3, .call = point_with_seeds, .context = &seeds}, 0, 64, 5, 3);
    CHECK_ROW("METHOD 1", "the same without fibres: largest J after (it stays a point)", 0, m.determinant_max, 1e-9);
}

int main(void) {
    RUN(affine_maps_are_exact);
    RUN(forces_are_the_gradient_of_energy);
    RUN(momenta_and_energy_are_kept);
    RUN(fast_change_limits_the_step);
    RUN(a_bar_in_tension_gives_back_E);
    RUN(gravity_and_damping_act);
    RUN(every_vertex_anywhere_finds_back);
    RUN(a_point_with_seeds_opens);
    return check_finish();
}
