/* Every effect of solids beyond elasticity with explicit damage (those: test_determinism.c, test_transfer.c): the same bits at any number of threads, and
 * vector builds that agree with plain f64 to round-off. A step of each goes through kernels of its own, in every build. */
#include "check.h"
#include "verify/solid_scene.h"

#include "base/memory.h"
#include "solid/solid.h"

enum { STEPS = 40 };

static const shape *bar(arena *a) {
    return shape_box(a, (const double[]){-0.6, -0.2, -0.2}, (const double[]){0.6, 0.2, 0.2});
}

/* Pulled and sheared by two grips. */
static scene *pulled(const char *elasticity, int families) {
    scene *s = test_scene(bar, 2e3, 0.3, 10);
    s->particles = 2000;
    s->fps = 60;
    s->bodies[0].sampling = SAMPLING_JITTERED;
    s->bodies[0].fibres = (scene_fibres){.families = families, .direction = {.outputs = 3 * families, .constant = {1, 1, 0, -1, 1, 0}}};
    s->materials[0].effects[effect_index("elastic")].on = strcmp(elasticity, "elastic") == 0;
    test_set(s, elasticity, "E", 2e3);
    test_set(s, elasticity, "nu", 0.3);
    for (int side = -1; side <= 1; side += 2) {
        double low[3] = {side < 0 ? -5 : 0.45, -5, -5}, high[3] = {side < 0 ? -0.45 : 5, 5, 5};
        s->grips[s->grip_count++] = (scene_grip){.shape = shape_box(s->memory, low, high), .stop = HUGE_VAL, .protects = true,
                                                 .velocity = {.outputs = 3, .constant = {side * 2, 0.4 * side, 0}}};
    }
    return s;
}

static scene *implicit_damage(void) {
    scene *s = pulled("elastic", 1);
    test_set(s, "fibres", "gamma", 5);
    test_set(s, "damage", "sigma_c", 40);
    test_set(s, "damage", "form", 1);
    test_set(s, "damage", "eta", 0.05);
    test_set(s, "damage", "tolerance", 1e-6);
    return s;
}

static scene *phase_field(void) {
    scene *s = pulled("corotated", 0);
    test_set(s, "pff", "toughness", 0.05);
    test_set(s, "pff", "mobility", 50);
    test_set(s, "pff", "tolerance", 1e-6);
    return s;
}

static scene *plastic(void) {
    scene *s = pulled("elastic", 0);
    test_set(s, "plastic", "yield_stress", 30);
    test_set(s, "plastic", "hardening", 50);
    return s;
}

static scene *snapping(void) {
    scene *s = pulled("elastic", 2);
    test_set(s, "fibres", "gamma", 5);
    test_set(s, "fibres", "gamma2", 2);
    test_set(s, "snapping", "snap_strain", 0.01);
    test_set(s, "snapping", "snap_time", 0.1);
    return s;
}

static scene *diffusing(void) {
    scene *s = pulled("elastic", 0);
    scene_body *b = &s->bodies[0];
    test_set(s, "diffusion", "k", 0.5);
    test_set(s, "swelling", "alpha", 0.05);
    test_set(s, "softening", "stiffness", 0.3);
    b->sources[b->source_count++] = (scene_source){.shape = shape_sphere(s->memory, (const double[]){0, 0.2, 0}, 0.2), .fixed = true, .strength = 1, .on = 1,
                                                   .value = {.outputs = 1, .constant = {1}}, .stop = HUGE_VAL};
    return s;
}

static scene *inextensible(void) {
    scene *s = pulled("elastic", 1);
    s->particles = 300;
    s->grip_count = 1;
    test_set(s, "inextensible", "solver", 1); /* Jacobi's: in this build whatever libraries it has */
    return s;
}

/* `field`: what shows that the effect has acted, above `least` somewhere (NULL: its own tests say that, test_inextensible.c, and that threads do not matter
 * to it); what f64 and f32 may differ by from plain f64, in the field and in velocities, which are up to 2. Its solve's tolerance limits the last. */
static const struct {
    const char *name;
    scene *(*make)(void);
    const char *field;
    double least, wide, narrow;
} cases[] = {
    {"implicit damage", implicit_damage, "damage", 0.05, 1e-12, 1e-4},
    {"phase field, corotated", phase_field, "damage", 0.05, 1e-12, 1e-4},
    {"plasticity", plastic, "plastic_strain", 0.01, 1e-12, 1e-4},
    {"snapping fibres", snapping, "fibre_damage", 0.05, 1e-12, 1e-4},
    {"diffusion, swelling, softening", diffusing, "diffused", 0.5, 1e-12, 1e-4},
    {"inextensible fibres", inextensible, NULL, 0, 2e-4, 2e-3},
};
enum { CASES = sizeof cases / sizeof *cases };

static status run_steps(simulation *sim, report *r) {
    status code = STATUS_OK;
    for (int i = 0; i < STEPS && code == STATUS_OK; i++) code = simulation_step(sim, 0, r);
    if (code != STATUS_OK) printf("  %s\n", r->message);
    return code;
}

static uint64_t hash_at(int k, int precision, int threads) {
    report r;
    uint64_t hash = 0;
    scene *s = cases[k].make();
    simulation *sim = test_simulation(s, precision, "auto", threads);
    CHECK(sim && run_steps(sim, &r) == STATUS_OK && simulation_hash(sim, &hash, &r) == STATUS_OK);
    simulation_destroy(sim);
    scene_destroy(s);
    return hash;
}

static void threads_do_not_change_bits(void) {
    static const int threads[] = {2, 3, 7};
    for (int k = 0; k < CASES; k++)
        for (int precision = 32; cases[k].field && precision <= 64; precision += 32) {
            uint64_t one = hash_at(k, precision, 1);
            for (int t = 0; t < 3; t++) CHECK(hash_at(k, precision, threads[t]) == one);
        }
}

/* Velocities [n, 3] and the field [n] after STEPS steps of the same size, one behind the other; the caller's. */
static double *outcome(int k, int precision, const char *simd, int64_t *count) {
    report r;
    scene *s = cases[k].make();
    s->dt = 2e-4;
    simulation *sim = test_simulation(s, precision, simd, 2);
    CHECK(sim && run_steps(sim, &r) == STATUS_OK);
    int64_t n = *count = simulation_get_plan(sim)->particles;
    double *x = memory_allocate((size_t)n * 32), *field = x + 3 * n, most = -HUGE_VAL;
    CHECK(simulation_read(sim, "velocity", x) == 3);
    if (cases[k].field) {
        CHECK(simulation_read(sim, cases[k].field, field) == 1);
        for (int64_t i = 0; i < n; i++) most = fmax(most, field[i]);
        CHECK(most > cases[k].least);
    }
    simulation_destroy(sim);
    scene_destroy(s);
    return x;
}

static double difference(int k, int precision, const char *simd, const double *plain) {
    int64_t n;
    double *x = outcome(k, precision, simd, &n), worst = 0;
    for (int64_t i = 0; i < 4 * n; i++) worst = fmax(worst, fabs(x[i] - plain[i]));
    memory_free(x, (size_t)n * 32);
    return worst;
}

static void vector_builds_agree_with_plain(void) {
    static const char *const simds[] = {"plain", "avx2", "avx512"};
    for (int k = 0; k < CASES; k++) {
        int64_t n;
        double *plain = outcome(k, 64, "plain", &n);
        for (int i = 0; i < 3; i++) {
            if (!solid_engine_find(64, simds[i])) continue;
            double wide = i > 0 ? difference(k, 64, simds[i], plain) : 0, narrow = difference(k, 32, simds[i], plain);
            printf("  %-31s %-6s f64 %.2e, f32 %.2e\n", cases[k].name, simds[i], wide, narrow);
            CHECK(wide < cases[k].wide && narrow < cases[k].narrow);
        }
        memory_free(plain, (size_t)n * 32);
    }
}

int main(void) {
    RUN(threads_do_not_change_bits);
    RUN(vector_builds_agree_with_plain);
    return check_finish();
}
