/* Sheets for the tests: patches of lattices with materials set by name. */
#ifndef SUNDER_TESTS_SHEET_PATCH_H
#define SUNDER_TESTS_SHEET_PATCH_H

#include "check.h"

#include "base/memory.h"
#include "base/random.h"
#include "sheet/sheet.h"

enum { PATCH_LIMIT = 40000 };

typedef struct patch {
    sheet_definition d;
    effect_values values[EFFECT_LIMIT];
    double rest[PATCH_LIMIT][3], position[PATCH_LIMIT][3], velocity[PATCH_LIMIT][3], area[PATCH_LIMIT], grain[PATCH_LIMIT][3], diffused[PATCH_LIMIT];
    uint8_t protected[PATCH_LIMIT];
    const sheet_engine *engine;
    sheet *state;
    double time;
} patch;

static inline const effect *patch_effect(const char *name, int *index) {
    const sheet_engine *engine = sheet_engine_find(64, "plain");
    for (*index = 0; *index < engine->effect_count; ++*index)
        if (strcmp(engine->effects[*index]->name, name) == 0) return engine->effects[*index];
    printf("  no effect '%s'\n", name);
    exit(1);
}

static inline void patch_set(patch *p, const char *name, const char *key, double value) {
    int e;
    const effect *table = patch_effect(name, &e);
    int k = effect_parameter(table, key);
    if (k < 0) printf("  no parameter '%s.%s'\n", name, key), exit(1);
    p->values[e].on = p->values[e].given[k] = true;
    p->values[e].value[k][0] = value;
    p->d.effect_mask |= 1u << e;
}

/* An empty patch of one body; density 1, thickness h. */
static inline patch *patch_create(sheet_lattice lattice, double spacing, double radius, double thickness) {
    patch *p = calloc(1, sizeof *p);
    const sheet_engine *engine = sheet_engine_find(64, "plain");
    for (int e = 0; e < engine->effect_count; e++) effect_values_default(engine->effects[e], &p->values[e]);
    p->d = (sheet_definition){.threads = 1, .material_count = 1, .body_count = 1, .rest = p->rest[0], .position = p->position[0],
                              .velocity = p->velocity[0], .area = p->area, .grain = p->grain[0], .diffused = p->diffused, .protected = p->protected};
    p->d.materials[0] = (sheet_material){.density = 1, .effects = p->values};
    p->d.bodies[0] = (sheet_body){.lattice = lattice, .thickness = thickness, .spacing = spacing, .radius = radius};
    return p;
}

static inline void patch_add(patch *p, double x, double y, double z, double area) {
    int64_t i = p->d.count++;
    if (i >= PATCH_LIMIT) printf("  the patch is full\n"), exit(1);
    p->rest[i][0] = x, p->rest[i][1] = y, p->rest[i][2] = z;
    memcpy(p->position[i], p->rest[i], sizeof p->rest[i]);
    p->grain[i][0] = 1;
    p->area[i] = area;
    p->d.bodies[0].count = p->d.count;
}

/* nx × ny particles in rows along x; hexagonal rows are √¾ apart and every other is shifted. */
static inline void patch_fill(patch *p, int nx, int ny) {
    double dx = p->d.bodies[0].spacing;
    bool hexagonal = p->d.bodies[0].lattice == SHEET_HEXAGONAL;
    double rise = hexagonal ? sqrt(0.75) : 1;
    for (int j = 0; j < ny; j++)
        for (int i = 0; i < nx; i++) patch_add(p, dx * (i + (hexagonal && j % 2 ? 0.5 : 0)), dx * rise * j, 0, dx * dx * rise);
}

static inline bool patch_start(patch *p, int precision, const char *simd, int threads) {
    report r;
    report_clear(&r);
    p->engine = sheet_engine_find(precision, simd);
    p->d.threads = threads;
    p->time = 0;
    p->state = p->engine ? p->engine->create(&p->d, &r) : NULL;
    char text[1024];
    if (!p->state) report_format(&r, text, sizeof text), printf("  %s\n", p->engine ? text : "no such engine");
    return p->state != NULL;
}

static inline void patch_stop(patch *p) {
    if (p->state) p->engine->destroy(p->state);
    p->state = NULL;
}

static inline void patch_free(patch *p) {
    patch_stop(p);
    free(p);
}

static inline status patch_steps(patch *p, int64_t steps, double dt) {
    report r;
    sheet_fault fault;
    for (int64_t k = 0; k < steps; k++) {
        status code = p->engine->step(p->state, p->time, dt, &fault, &r);
        if (code != STATUS_OK) {
            printf("  step %lld: %s\n", (long long)k, r.message);
            return code;
        }
        p->time += dt;
    }
    return STATUS_OK;
}

static inline double patch_limit(const patch *p) {
    double limits[EFFECT_LIMIT], least = HUGE_VAL;
    p->engine->limits(p->state, limits);
    for (int e = 0; e < p->engine->effect_count; e++) least = fmin(least, limits[e]);
    return least;
}

static inline sheet_measures patch_measure(const patch *p) {
    sheet_measures m;
    report r;
    if (p->engine->measure(p->state, &m, &r) != STATUS_OK) printf("  %s\n", r.message), exit(1);
    return m;
}

/* Forces of a configuration at rest, [count][3]: velocities after one step over the step, times masses. */
static inline bool patch_forces(patch *p, double *force) {
    if (!patch_start(p, 64, "auto", 1)) return false;
    double dt = 1e-6 * patch_limit(p), mass = p->d.materials[0].density * p->d.bodies[0].thickness;
    bool good = patch_steps(p, 1, dt) == STATUS_OK;
    p->engine->read(p->state, "velocity", force);
    for (int64_t i = 0; i < p->d.count; i++)
        for (int c = 0; c < 3; c++) force[3 * i + c] *= mass * p->area[i] / dt;
    patch_stop(p);
    return good;
}

static inline double patch_random(uint64_t counter) {
    return 2 * random_unit(7, 1, counter) - 1;
}

#endif
