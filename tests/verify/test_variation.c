/* Parameters that vary in place (docs/scenes.md), f64.
 *
 * - A function that gives twice the material's value everywhere is the material with twice the value: E (and with it sigma_c, where a
 *   break_stretch is given), density, sigma_c, eta, gamma; explicit and implicit damage; positions after a swing to 1e-9,
 *   damage to 1e-7.
 * - Where sigma_c is large nothing breaks; beside it everything does.
 * - A scene without functions has none of the fields; a value out of range is refused with its place. */
#include "check.h"
#include "verify/solid_scene.h"

#include "base/memory.h"

static status swell(void *context, const double *x, int inputs, double *v, int outputs, report *r) {
    (void)context, (void)inputs, (void)outputs, (void)r;
    const double rate[3] = {0.9, -0.2, 0.3};
    for (int c = 0; c < 3; c++) v[c] = rate[c] * x[c];
    return STATUS_OK;
}

static scene *swinging_cube(bool implicit) {
    scene *s = test_scene(test_cube, 10, 0.3, 1);
    s->particles = 512;
    s->bodies[0].velocity = (scene_function){.outputs = 3, .call = swell};
    s->bodies[0].fibres = (scene_fibres){.families = 1, .direction = {.outputs = 3, .constant = {1, 0.5, 0}}};
    test_set(s, "fibres", "gamma", 2);
    test_set(s, "damage", "break_stretch", 0.02);
    test_set(s, "damage", "eta", 0.3);
    test_set(s, "damage", "alpha", -0.5);
    test_set(s, "damage", "form", implicit ? 1 : 0);
    test_set(s, "damage", "tolerance", 1e-12);
    test_set(s, "plastic", "yield_stress", 3);
    return s;
}

/* Field `name` after 60 steps, in order of id; the particles' number in *n. */
static double *swung(scene *s, const char *name, int components, int64_t *n) {
    simulation *sim = test_simulation(s, 64, "plain", 1);
    report r;
    for (int i = 0; i < 60; i++) CHECK(simulation_step(sim, 4e-3, &r) == STATUS_OK);
    solid *state;
    const solid_engine *engine = simulation_engine(sim, &state);
    *n = simulation_get_plan(sim)->particles * components;
    double *out = memory_allocate((size_t)*n * sizeof *out);
    CHECK(engine->read(state, name, out) == components);
    simulation_destroy(sim);
    return out;
}

/* Effect NULL: the density. */
static double *value_of(scene *s, const char *effect_name, const char *key) {
    scene_material *m = &s->materials[0];
    if (!effect_name) return &m->density;
    int count, e = effect_index(effect_name);
    const effect *table = effect_catalogue(&count)[e];
    return m->effects[e].value[effect_parameter(table, key)];
}

static void vary(scene *s, const char *effect_name, const char *key, scene_function f) {
    scene_material *m = &s->materials[0];
    int count, e = effect_name ? effect_index(effect_name) : -1;
    int k = effect_name ? effect_parameter(effect_catalogue(&count)[e], key) : 0;
    m->variations[m->variation_count++] = (scene_variation){.effect = e, .key = k, .function = f};
}

static double difference(const char *effect_name, const char *key, bool implicit, const char *field, int components) {
    scene *plain = swinging_cube(implicit), *varied = swinging_cube(implicit);
    if (key && strcmp(key, "sigma_c") == 0) {
        scene *both[] = {plain, varied};
        for (int i = 0; i < 2; i++) {
            both[i]->materials[0].effects[effect_index("damage")].given[1] = false; /* break_stretch */
            test_set(both[i], "damage", "sigma_c", 0.3);
        }
    }
    double twice = 2 * *value_of(plain, effect_name, key);
    *value_of(plain, effect_name, key) = twice;
    vary(varied, effect_name, key, (scene_function){.outputs = 1, .constant = {twice}});
    int64_t n, m;
    double *a = swung(plain, field, components, &n), *b = swung(varied, field, components, &m), worst = 0, moved = 0;
    CHECK(n == m);
    for (int64_t i = 0; i < n; i++) worst = fmax(worst, fabs(a[i] - b[i])), moved = fmax(moved, fabs(a[i]));
    CHECK(moved > 0.01);
    memory_free(a, (size_t)n * sizeof *a), memory_free(b, (size_t)m * sizeof *b);
    scene_destroy(plain), scene_destroy(varied);
    return worst;
}

static void twice_is_twice(void) {
    static const struct {
        const char *effect_name, *key;
        bool implicit;
    } rows[] = {{"elastic", "E", false}, {NULL, NULL, false}, {"damage", "sigma_c", false}, {"damage", "break_stretch", false},
                {"damage", "eta", false}, {"damage", "eta", true}, {"fibres", "gamma", false}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char text[128];
        snprintf(text, sizeof text, "%s twice by a function of place, or by its value%s: largest difference of",
                 rows[i].key ? rows[i].key : "density", rows[i].implicit ? ", implicit" : "");
        double places = difference(rows[i].effect_name, rows[i].key, rows[i].implicit, "position", 3);
        double damages = difference(rows[i].effect_name, rows[i].key, rows[i].implicit, "damage", 1);
        char full[192];
        snprintf(full, sizeof full, "%s places", text);
        CHECK_ROW("scenes.md", full, 0, places, 1e-9);
        snprintf(full, sizeof full, "%s damage", text);
        CHECK_ROW("scenes.md", full, 0, damages, 1e-7); /* the ratio of two sigma_c is rounded, and squared */
    }
}

static status tough_on_the_right(void *context, const double *x, int inputs, double *v, int outputs, report *r) {
    (void)context, (void)inputs, (void)outputs, (void)r;
    v[0] = x[0] > 0 ? 100 : 0.1;
    return STATUS_OK;
}

static void only_the_weak_half_breaks(void) {
    scene *s = swinging_cube(false);
    s->materials[0].effects[effect_index("damage")].given[1] = false;
    test_set(s, "damage", "sigma_c", 1);
    test_set(s, "damage", "length_scale", 1e-6);
    *value_of(s, "damage", "sigma_c") = 100;
    scene_function f = {.outputs = 1, .call = tough_on_the_right};
    vary(s, "damage", "sigma_c", f);
    int64_t n, m;
    double *d = swung(s, "damage", 1, &n), *scale = swung(s, "toughness_scale", 1, &m), weak = 1, tough = 0;
    int weak_count = 0;
    for (int64_t i = 0; i < n; i++) {
        if (scale[i] < 0.1) weak = fmin(weak, d[i]), weak_count++;
        else tough = fmax(tough, d[i]);
    }
    CHECK(weak_count > n / 3 && weak_count < n);
    CHECK(weak > 0.05);
    CHECK_ROW("scenes.md", "sigma_c by a function of place, 1000 times larger on one side: largest damage there", 0, tough, 1e-6);
    memory_free(d, (size_t)n * sizeof *d), memory_free(scale, (size_t)m * sizeof *scale);
    scene_destroy(s);
}

static status below_zero_at_the_top(void *context, const double *x, int inputs, double *v, int outputs, report *r) {
    (void)context, (void)inputs, (void)outputs, (void)r;
    v[0] = 0.3 - x[1];
    return STATUS_OK;
}

static void none_without_functions_and_none_out_of_range(void) {
    scene *s = swinging_cube(false);
    simulation *sim = test_simulation(s, 32, "auto", 1);
    solid *state;
    const solid_engine *engine = simulation_engine(sim, &state);
    static const char *const fields[] = {"density_scale", "stiffness_scale", "toughness_scale", "viscosity_scale", "gamma_scale"};
    for (int i = 0; i < 5; i++) CHECK(engine->components(state, fields[i]) == 0);
    simulation_destroy(sim);
    scene_function f = {.outputs = 1, .call = below_zero_at_the_top};
    vary(s, "damage", "eta", f);
    simulation_options o = {.threads = 1, .precision = 32, .simd = "plain"};
    report r;
    CHECK(simulation_create(s, &o, &sim, &r) == STATUS_INPUT);
    CHECK(strcmp(r.key, "damage.eta") == 0 && strstr(r.found, " at (") != NULL);
    scene_destroy(s);
}

int main(void) {
    RUN(twice_is_twice);
    RUN(only_the_weak_half_breaks);
    RUN(none_without_functions_and_none_out_of_range);
    return check_finish();
}
