/* The contestants: stress stages of the engine's builds, a tile at a time as in a step, and scalar code, an F at a time. The layout of
 * tiles depends on the precision alone, so this file, built plain, drives every instruction set's stages. */
#define SUNDER_SIMD 0
#include "sim/bench_constitutive.h"

#include "base/memory.h"
#include "base/random.h"
#include "solid/state.h"

#include <time.h>

enum { TILES = 32, PACKS = TILES * TILE_PACKS, CHUNK = PACKS * PACK }; /* F and τ of a chunk stay in the second-level cache */

typedef struct scalar_case {
    real F[9], tau[6];
} scalar_case;

typedef struct bench_state {
    solid state;
    tile_scratch scratch;
    tile_result result;
    effect_values values[EFFECT_LIMIT];
    real deformation[CHUNK * 9];
    real tau[CHUNK * 6]; /* [TILES] of scratch->kirchhoff */
    scalar_case cases[CHUNK];
    real mu, lambda, lame_lambda;
} bench_state;

/* Nanoseconds of this thread's own: other programs at work do not count. */
static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

/* ---- scalar code --------------------------------------------------------------------------------------------------- */

static void scalar_closed(const bench_state *b, scalar_case *c) {
    const real *F = c->F, mu = b->mu;
    real J = F[0] * (F[4] * F[8] - F[5] * F[7]) + F[1] * (F[5] * F[6] - F[3] * F[8]) + F[2] * (F[3] * F[7] - F[4] * F[6]);
    real pressure = J * (b->lambda * (J - 1) - mu);
    c->tau[0] = mu * (F[0] * F[0] + F[1] * F[1] + F[2] * F[2]) + pressure;
    c->tau[1] = mu * (F[3] * F[3] + F[4] * F[4] + F[5] * F[5]) + pressure;
    c->tau[2] = mu * (F[6] * F[6] + F[7] * F[7] + F[8] * F[8]) + pressure;
    c->tau[3] = mu * (F[0] * F[3] + F[1] * F[4] + F[2] * F[5]);
    c->tau[4] = mu * (F[3] * F[6] + F[4] * F[7] + F[5] * F[8]);
    c->tau[5] = mu * (F[0] * F[6] + F[1] * F[7] + F[2] * F[8]);
}

/* The paper's form: F = QR by Gram–Schmidt, K = ∂Ψ/∂R, and τ = Q (U + Uᵀ − D) Qᵀ with U the upper triangle of K Rᵀ, D its diagonal. */
static void scalar_qr(const bench_state *b, scalar_case *c) {
    const real *F = c->F;
    real r11 = (real)sqrt((double)(F[0] * F[0] + F[3] * F[3] + F[6] * F[6])), i1 = 1 / r11;
    real q1[3] = {F[0] * i1, F[3] * i1, F[6] * i1};
    real r12 = q1[0] * F[1] + q1[1] * F[4] + q1[2] * F[7], r13 = q1[0] * F[2] + q1[1] * F[5] + q1[2] * F[8];
    real q2[3] = {F[1] - r12 * q1[0], F[4] - r12 * q1[1], F[7] - r12 * q1[2]};
    real r22 = (real)sqrt((double)(q2[0] * q2[0] + q2[1] * q2[1] + q2[2] * q2[2])), i2 = 1 / r22;
    for (int k = 0; k < 3; k++) q2[k] *= i2;
    real q3[3] = {q1[1] * q2[2] - q1[2] * q2[1], q1[2] * q2[0] - q1[0] * q2[2], q1[0] * q2[1] - q1[1] * q2[0]};
    real r23 = q2[0] * F[2] + q2[1] * F[5] + q2[2] * F[8], r33 = q3[0] * F[2] + q3[1] * F[5] + q3[2] * F[8];
    real mu = b->mu, slope = b->lambda * (r11 * r22 * r33 - 1) - mu;
    real k11 = mu * r11 + slope * r22 * r33, k22 = mu * r22 + slope * r11 * r33, k33 = mu * r33 + slope * r11 * r22;
    real u11 = k11 * r11 + mu * (r12 * r12 + r13 * r13), u12 = mu * (r12 * r22 + r13 * r23), u13 = mu * r13 * r33;
    real u22 = k22 * r22 + mu * r23 * r23, u23 = mu * r23 * r33, u33 = k33 * r33;
    static const int rows[6] = {0, 1, 2, 0, 1, 0}, columns[6] = {0, 1, 2, 1, 2, 2};
    for (int k = 0; k < 6; k++) {
        int i = rows[k], j = columns[k];
        c->tau[k] = u11 * q1[i] * q1[j] + u22 * q2[i] * q2[j] + u33 * q3[i] * q3[j] + u12 * (q1[i] * q2[j] + q2[i] * q1[j]) +
                    u13 * (q1[i] * q3[j] + q3[i] * q1[j]) + u23 * (q2[i] * q3[j] + q3[i] * q2[j]);
    }
}

/* One Jacobi rotation of the plane (p, q), r the third axis; columns of v are the eigenvectors. */
static void rotate(real a[3][3], real v[3][3], int p, int q, int r) {
    if (a[p][q] == 0) return;
    real theta = (a[q][q] - a[p][p]) / (2 * a[p][q]), root = (real)sqrt((double)(theta * theta + 1));
    real t = theta >= 0 ? 1 / (theta + root) : 1 / (theta - root), c = 1 / (real)sqrt((double)(t * t + 1)), s = t * c;
    real shift = t * a[p][q], rp = a[r][p], rq = a[r][q];
    a[p][p] -= shift, a[q][q] += shift;
    a[p][q] = a[q][p] = 0;
    a[r][p] = a[p][r] = c * rp - s * rq, a[r][q] = a[q][r] = s * rp + c * rq;
    for (int k = 0; k < 3; k++) {
        real vp = v[k][p], vq = v[k][q];
        v[k][p] = c * vp - s * vq, v[k][q] = s * vp + c * vq;
    }
}

/* Fixed-corotated by the singular values and left axes of F, Jacobi's method run until nothing is left to rotate. */
static void scalar_corotated(const bench_state *b, scalar_case *c) {
    const real *F = c->F, epsilon = sizeof(real) == 4 ? (real)1e-7 : (real)1e-16;
    real a[3][3], v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, s[3];
    real J = F[0] * (F[4] * F[8] - F[5] * F[7]) + F[1] * (F[5] * F[6] - F[3] * F[8]) + F[2] * (F[3] * F[7] - F[4] * F[6]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) a[i][j] = F[3 * i] * F[3 * j] + F[3 * i + 1] * F[3 * j + 1] + F[3 * i + 2] * F[3 * j + 2];
    for (int sweep = 0; sweep < 8; sweep++) {
        real off = a[0][1] * a[0][1] + a[1][2] * a[1][2] + a[0][2] * a[0][2], trace = a[0][0] + a[1][1] + a[2][2];
        if (off <= epsilon * epsilon * trace * trace) break;
        rotate(a, v, 0, 1, 2);
        rotate(a, v, 0, 2, 1);
        rotate(a, v, 1, 2, 0);
    }
    int least = 0;
    for (int i = 0; i < 3; i++) {
        real pulled[3];
        for (int k = 0; k < 3; k++) pulled[k] = F[k] * v[0][i] + F[3 + k] * v[1][i] + F[6 + k] * v[2][i];
        s[i] = (real)sqrt((double)(pulled[0] * pulled[0] + pulled[1] * pulled[1] + pulled[2] * pulled[2]));
        if (s[i] < s[least]) least = i;
    }
    if (J < 0) s[least] = -s[least];
    static const int rows[6] = {0, 1, 2, 0, 1, 0}, columns[6] = {0, 1, 2, 1, 2, 2};
    real pressure = b->lame_lambda * (J - 1) * J, t[3];
    for (int i = 0; i < 3; i++) t[i] = 2 * b->mu * s[i] * (s[i] - 1) + pressure;
    for (int k = 0; k < 6; k++) {
        const real *x = v[rows[k]], *y = v[columns[k]];
        c->tau[k] = t[0] * x[0] * y[0] + t[1] * x[1] * y[1] + t[2] * x[2] * y[2];
    }
}

typedef void scalar_stress(const bench_state *b, scalar_case *c);

static double time_scalar(bench_state *b, scalar_stress *stress) {
    double start = now();
    for (int i = 0; i < CHUNK; i++) stress(b, &b->cases[i]);
    return now() - start;
}

/* ---- stages -------------------------------------------------------------------------------------------------------- */

/* Of one pass over the chunk, in nanoseconds. Passes are repeated where one would be too short to time. */
static double time_stage(bench_state *b, const solid_engine *engine, int e) {
    real constants[CONSTANTS] = {0};
    double start = 0;
    const solid_stages *stages = engine->effects[e]->stages;
    int passes = e == EFFECT_elastic ? 32 : 2;
    b->values[EFFECT_elastic].on = e == EFFECT_elastic;
    b->values[EFFECT_corotated].on = e == EFFECT_corotated;
    stages->constants(b->values, &b->state.definition, false, constants);
    for (int pass = 0; pass <= passes; pass++) { /* the first brings everything into the cache, and is kept to compare */
        if (pass == 1) start = now();
        for (int t = 0; t < TILES; t++) {
            solid_tile tile = {.first_pack = t * TILE_PACKS, .pack_count = TILE_PACKS, .count = TILE_PARTICLES};
            tile_work w = {.state = &b->state, .tile = &tile, .scratch = &b->scratch, .constants = constants, .result = &b->result, .effect = e};
            stages->stress(&w);
            if (pass == 0) memcpy(b->tau + t * TILE_PARTICLES * 6, b->scratch.kirchhoff, sizeof b->scratch.kirchhoff);
        }
    }
    return (now() - start) / passes;
}

static double compare(const bench_state *b, const scalar_case *exact) {
    double worst = 0;
    for (int i = 0; i < CHUNK; i++) {
        double difference = 0, size = 0;
        for (int c = 0; c < 6; c++) {
            double expected = (double)exact[i].tau[c];
            difference = fmax(difference, fabs((double)b->tau[(i / PACK * 6 + c) * PACK + i % PACK] - expected));
            size = fmax(size, fabs(expected));
        }
        worst = fmax(worst, difference / (1 + size));
    }
    return worst;
}

static void copy_scalar(bench_state *b) {
    for (int i = 0; i < CHUNK; i++)
        for (int c = 0; c < 6; c++) b->tau[(i / PACK * 6 + c) * PACK + i % PACK] = b->cases[i].tau[c];
}

/* Random F: identity and up to 0.7 in each component; a few per cent are inverted. */
static void fill(bench_state *b, int64_t chunk) {
    for (int i = 0; i < CHUNK; i++)
        for (int c = 0; c < 9; c++) {
            double u = 2 * random_unit(40, (uint64_t)c, (uint64_t)(chunk * CHUNK + i)) - 1;
            b->cases[i].F[c] = b->deformation[(i / PACK * 9 + c) * PACK + i % PACK] = (real)((c % 4 == 0) + 0.7 * u);
        }
}

static void measure_chunk(bench_state *b, const solid_engine *best, const solid_engine *plain, constitutive_result *out) {
    static scalar_stress *const scalars[] = {scalar_closed, scalar_qr, scalar_corotated};
    double *ns = out->nanoseconds, *difference = out->difference;
    for (int model = 0; model < 2; model++) {
        int e = model ? EFFECT_corotated : EFFECT_elastic;
        time_scalar(b, scalars[2 * model]);
        ns[PLAIN_CLOSED + model] += time_stage(b, plain, e);
        difference[PLAIN_CLOSED + model] = fmax(difference[PLAIN_CLOSED + model], compare(b, b->cases));
        ns[BEST_CLOSED + model] += time_stage(b, best, e);
        difference[BEST_CLOSED + model] = fmax(difference[BEST_CLOSED + model], compare(b, b->cases));
    }
    for (int k = 0; k < 3; k++) ns[SCALAR_CLOSED + k] += time_scalar(b, scalars[k]);
    time_scalar(b, scalar_qr);
    copy_scalar(b);
    time_scalar(b, scalar_closed);
    difference[SCALAR_QR] = fmax(difference[SCALAR_QR], compare(b, b->cases));
}

#if SUNDER_PRECISION == 32
#define BENCH bench_constitutive_f32
#else
#define BENCH bench_constitutive_f64
#endif

static void set_up(bench_state *b, const solid_engine *engine) {
    double E = 100, nu = 0.3, mu = E / (2 * (1 + nu)), lame_lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
    b->mu = (real)mu, b->lame_lambda = (real)lame_lambda, b->lambda = (real)(lame_lambda + mu);
    for (int e = 0; e < engine->effect_count; e++) effect_values_default(engine->effects[e], &b->values[e]);
    for (int k = 0; k < 2; k++) {
        effect_values *v = &b->values[k ? EFFECT_corotated : EFFECT_elastic];
        v->value[0][0] = E, v->value[1][0] = nu;
    }
    b->state.fields[FIELD_DEFORMATION] = (solid_field){"deformation_gradient", 9, b->deformation};
    for (int i = 0; i < TILE_PARTICLES; i++) b->scratch.degradation[i] = 1;
}

status BENCH(int64_t count, constitutive_result *out, report *r) {
    const solid_engine *best = solid_engine_find(SUNDER_PRECISION, "auto"), *plain = solid_engine_find(SUNDER_PRECISION, "plain");
    bench_state *b = memory_allocate(sizeof *b);
    if (!b) return report_set(r, STATUS_SYSTEM, "out of memory for %d deformations", CHUNK);
    set_up(b, best);
    int64_t chunks = (count + CHUNK - 1) / CHUNK;
    *out = (constitutive_result){.simd = best->simd, .count = chunks * CHUNK};
    for (int64_t chunk = 0; chunk < chunks; chunk++) {
        fill(b, chunk);
        measure_chunk(b, best, plain, out);
    }
    for (int i = 0; i < CONTESTANTS; i++) out->nanoseconds[i] /= (double)out->count;
    memory_free(b, sizeof *b);
    return STATUS_OK;
}
