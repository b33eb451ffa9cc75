/* Scenes built in C, for tests that need no Lua. */
#ifndef SUNDER_TESTS_SOLID_SCENE_H
#define SUNDER_TESTS_SOLID_SCENE_H

#include "sim/simulation.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Bodies: a cube of edge 1, a bar of 4 × 1 × 1 along x; about the origin. */
static inline const shape *test_cube(arena *a) {
    return shape_box(a, (const double[]){-0.5, -0.5, -0.5}, (const double[]){0.5, 0.5, 0.5});
}

static inline const shape *test_bar(arena *a) {
    return shape_box(a, (const double[]){-2, -0.5, -0.5}, (const double[]){2, 0.5, 0.5});
}

/* Grips that hold all with |x| > `from` and part at `speed` each. */
static inline void test_pull(scene *s, double from, double speed) {
    for (int side = -1; side <= 1; side += 2) {
        double low[3] = {side < 0 ? -3 : from, -2, -2}, high[3] = {side < 0 ? -from : 3, 2, 2};
        s->grips[s->grip_count++] = (scene_grip){.shape = shape_box(s->memory, low, high), .stop = HUGE_VAL,
                                                 .velocity = {.outputs = 3, .constant = {side * speed, 0, 0}}};
    }
}

/* A scene with one material of the given elasticity and one body; no gravity, no boundaries. */
static inline scene *test_scene(const shape *(*make)(arena *), double E, double nu, double density) {
    scene *s = scene_create();
    int count;
    const effect *const *effects = effect_catalogue(&count);
    snprintf(s->file, sizeof s->file, "test");
    s->fps = 100;
    s->material_count = 1;
    scene_material *m = &s->materials[0];
    snprintf(m->name, sizeof m->name, "block");
    m->density = density;
    for (int e = 0; e < count; e++) effect_values_default(effects[e], &m->effects[e]);
    effect_values *elastic = &m->effects[effect_index("elastic")];
    elastic->on = true;
    elastic->value[0][0] = E, elastic->given[0] = true;
    elastic->value[1][0] = nu, elastic->given[1] = true;
    s->body_count = 1;
    s->bodies[0] = (scene_body){.name = "block", .shape = make(s->memory)};
    return s;
}

/* Switches an effect of a material on and gives it a value by key. */
static inline void test_set_material(scene *s, int material, const char *effect_name, const char *key, double value) {
    bool of_sheet = false;
    for (int k = 0; k < s->sheet_count; k++) of_sheet |= s->sheets[k].material == material;
    int count, e = effect_index_of(of_sheet ? ENGINE_SHEET : ENGINE_SOLID, effect_name);
    if (e < 0) e = effect_index(effect_name);
    const effect *table = effect_catalogue(&count)[e];
    effect_values *v = &s->materials[material].effects[e];
    v->on = true;
    if (!key) return;
    int p = effect_parameter(table, key);
    v->value[p][0] = value;
    v->given[p] = true;
}

static inline void test_set(scene *s, const char *effect_name, const char *key, double value) {
    test_set_material(s, 0, effect_name, key, value);
}

static inline simulation *test_simulation(scene *s, int precision, const char *simd, int threads) {
    report r;
    simulation *out = NULL;
    simulation_options o = {.threads = threads, .precision = precision, .simd = simd};
    if (scene_validate(s, &r) == STATUS_OK && simulation_create(s, &o, &out, &r) == STATUS_OK) return out;
    char text[1024];
    report_format(&r, text, sizeof text);
    printf("  %s\n", text);
    return NULL;
}

#endif
