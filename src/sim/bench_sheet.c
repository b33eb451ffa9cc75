#include "sim/bench_sheet.h"

#include "base/clock.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

const char *const sheet_bench_phase_names[SHEET_PHASES] = {"bonds", "diffusion", "before", "advance"};

enum { WARM_UP_STEPS = 20, REPEATS = 99 };

typedef struct bench_sheet_state {
    sheet_definition d;
    effect_values values[EFFECT_LIMIT];
    double *rest, *velocity, *area, *diffused;
    const sheet_engine *engine;
    sheet *state;
    double time, dt;
} bench_sheet_state;

static void set(bench_sheet_state *b, const char *name, const char *key, double value) {
    for (int e = 0; e < b->engine->effect_count; e++) {
        const effect *table = b->engine->effects[e];
        if (strcmp(table->name, name) != 0) continue;
        int k = effect_parameter(table, key);
        b->values[e].on = b->values[e].given[k] = true;
        b->values[e].value[k][0] = value;
        b->d.effect_mask |= 1u << e;
    }
}

static status define(bench_sheet_state *b, const sheet_bench_options *o, report *r) {
    int64_t side = (int64_t)llround(sqrt((double)o->particles)), count = side * side;
    double dx = 1.0 / (double)side;
    for (int e = 0; e < b->engine->effect_count; e++) effect_values_default(b->engine->effects[e], &b->values[e]);
    b->rest = memory_allocate_array((size_t)count, 3 * sizeof(double));
    b->velocity = memory_allocate_array((size_t)count, 3 * sizeof(double));
    b->area = memory_allocate_array((size_t)count, sizeof(double));
    b->diffused = memory_allocate_array((size_t)count, sizeof(double));
    b->d = (sheet_definition){.threads = o->threads, .material_count = 1, .body_count = 1, .count = count, .rest = b->rest, .velocity = b->velocity,
                              .area = b->area, .diffused = b->diffused};
    if (!b->rest || !b->velocity || !b->area || !b->diffused) return report_set(r, STATUS_SYSTEM, "out of memory for %lld particles", (long long)count);
    b->d.materials[0] = (sheet_material){.density = 1, .effects = b->values};
    b->d.bodies[0] = (sheet_body){.count = count, .lattice = SHEET_SQUARE, .thickness = 0.01, .spacing = dx, .radius = o->neighbours == 8 ? 1.5 : 3.015};
    for (int64_t i = 0; i < count; i++) {
        double x = ((double)(i % side) + 0.5) * dx, y = ((double)(i / side) + 0.5) * dx;
        b->rest[3 * i] = x, b->rest[3 * i + 1] = y;
        b->velocity[3 * i] = 0.01 * (x - 0.5), b->velocity[3 * i + 1] = 0.01 * (y - 0.5);
        b->area[i] = dx * dx;
        b->diffused[i] = x * y;
    }
    set(b, "linear", "E", 1);
    set(b, "linear", "weight", 2); /* constant: all 28 neighbours are live */
    if (!o->tearing) return STATUS_OK;
    set(b, "fracture", "stretch", 0.5);
    set(b, "diffusion", "k", 0.02 * dx); /* its step limit is then some twenty times the bonds', as in the paper's scenes or less */
    set(b, "swelling", "alpha", 0.01);
    return STATUS_OK;
}

static status run_steps(bench_sheet_state *b, int64_t steps, report *r) {
    sheet_fault fault;
    for (int64_t k = 0; k < steps; k++) {
        status code = b->engine->step(b->state, b->time, b->dt, &fault, r);
        if (code != STATUS_OK) return code;
        b->time += b->dt;
    }
    return STATUS_OK;
}

typedef struct repetition {
    double seconds, phases[SHEET_PHASES];
} repetition;

static status time_steps(bench_sheet_state *b, int64_t steps, repetition *out, report *r) {
    double before[SHEET_PHASES], start = clock_seconds();
    b->engine->phases(b->state, before);
    status code = run_steps(b, steps, r);
    out->seconds = clock_seconds() - start;
    b->engine->phases(b->state, out->phases);
    for (int p = 0; p < SHEET_PHASES; p++) out->phases[p] -= before[p];
    return code;
}

static status measure(bench_sheet_state *b, const sheet_bench_options *o, sheet_bench_result *out, report *r) {
    repetition all[REPEATS], warm;
    status code = time_steps(b, WARM_UP_STEPS, &warm, r);
    out->steps = (int64_t)fmax(5, ceil(o->seconds / (warm.seconds / WARM_UP_STEPS)));
    int count = 0;
    for (; count < o->repeat && count < REPEATS && code == STATUS_OK; count++) {
        code = time_steps(b, out->steps, &all[count], r);
        for (int k = count; k > 0 && all[k].seconds < all[k - 1].seconds; k--) {
            repetition other = all[k];
            all[k] = all[k - 1];
            all[k - 1] = other;
        }
    }
    if (code != STATUS_OK) return code;
    out->particles = b->d.count;
    out->bonds = 2 * b->engine->bonds(b->state, NULL, NULL);
    out->seconds = all[(count - 1) / 2].seconds;
    memcpy(out->phases, all[(count - 1) / 2].phases, sizeof out->phases);
    out->bytes_per_particle = b->engine->bytes_per_particle(b->state);
    out->simd = b->engine->simd;
    return STATUS_OK;
}

status bench_sheet(const sheet_bench_options *o, sheet_bench_result *out, report *r) {
    memset(out, 0, sizeof *out);
    bench_sheet_state *b = memory_allocate(sizeof *b);
    if (!b) return report_set(r, STATUS_SYSTEM, "out of memory for the benchmark");
    b->engine = sheet_engine_find(o->precision, o->simd);
    status code = b->engine ? define(b, o, r) : report_input(r, NULL, 0, "simd", "an instruction set of this processor", o->simd, NULL);
    if (code == STATUS_OK) {
        b->state = b->engine->create(&b->d, r);
        code = b->state ? STATUS_OK : r->code;
    }
    if (code == STATUS_OK) {
        double limits[EFFECT_LIMIT], least = HUGE_VAL;
        b->engine->limits(b->state, limits);
        for (int e = 0; e < b->engine->effect_count; e++) least = fmin(least, limits[e]);
        b->dt = 0.5 * least;
        code = measure(b, o, out, r);
    }
    if (b->state) b->engine->destroy(b->state);
    size_t n = (size_t)b->d.count;
    memory_free(b->rest, n * 3 * sizeof(double));
    memory_free(b->velocity, n * 3 * sizeof(double));
    memory_free(b->area, n * sizeof(double));
    memory_free(b->diffused, n * sizeof(double));
    memory_free(b, sizeof *b);
    return code;
}
