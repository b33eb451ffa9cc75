/* Our exponential and logarithm against the C library's in long double: relative error over the whole range and, densely,
 * where cancellation would show (around 1 for the logarithm, around 0 for e^x − 1). Compiled once a precision and instruction set
 * (cmake/tests_effects.cmake). Limits: those that src/base/simd_math.h states. */
#ifndef SUNDER_PRECISION
#define SUNDER_PRECISION 64
#define SUNDER_SIMD 0
#endif
#include "check.h"

#include "base/processor.h"
#include "base/random.h"
#include "base/simd_math.h"

static const double log_limit = SUNDER_PRECISION == 32 ? 1e-7 : 3e-16, expm1_limit = SUNDER_PRECISION == 32 ? 2e-7 : 4e-16;
enum { SAMPLES = 2000000 };

static double relative_error(real actual, long double expected) {
    if (expected == 0) return actual == 0 ? 0 : HUGE_VAL;
    long double error = fabsl(((long double)actual - expected) / expected);
    return isnan(error) ? HUGE_VAL : (double)error;
}

typedef struct case_function {
    vec (*ours)(vec);
    long double (*reference)(long double);
} case_function;

static vec our_log(vec x) {
    return vec_log(x);
}

static vec our_exp(vec x) {
    return vec_exp(x);
}

static vec our_expm1(vec x) {
    return vec_expm1(x);
}

/* The worst over samples from low to high, uniform or (both positive) uniform in the exponent. */
static double worst_error(case_function f, double low, double high, bool by_exponent) {
    double worst = 0;
    for (uint64_t i = 0; i < SAMPLES; i += (uint64_t)VEC_LANES) {
        vec x = vec_all(0);
        for (int lane = 0; lane < VEC_LANES; lane++) {
            double u = random_unit(31, 0, i + (uint64_t)lane);
            x[lane] = (real)(by_exponent ? exp(log(low) + (log(high) - log(low)) * u) : low + (high - low) * u);
        }
        vec y = f.ours(x);
        for (int lane = 0; lane < VEC_LANES; lane++) worst = fmax(worst, relative_error(y[lane], f.reference((long double)x[lane])));
    }
    return worst;
}

static void logarithm(void) {
    case_function f = {our_log, logl};
    double least = SUNDER_PRECISION == 32 ? 1.2e-38 : 2.3e-308, most = SUNDER_PRECISION == 32 ? 3.4e38 : 1.7e308;
    double whole = worst_error(f, least, most, true), near = worst_error(f, 0.5, 2, false);
    double close = worst_error(f, 0.999, 1.001, false), branch = worst_error(f, 0.707, 0.7072, false);
    printf("  ln: %.2e everywhere, %.2e in 0.5 … 2, %.2e around 1, %.2e around sqrt(1/2)\n", whole, near, close, branch);
    CHECK(fmax(fmax(whole, near), fmax(close, branch)) < log_limit);
    const real points[] = {1, 2, (real)0.5, (real)1e-8};
    for (size_t i = 0; i < sizeof points / sizeof *points; i++)
        CHECK(relative_error(vec_log(vec_all(points[i]))[0], logl((long double)points[i])) < log_limit);
    CHECK(isnan(vec_log(vec_all((real)NAN))[0]));
}

static void exponential(void) {
    case_function f = {our_exp, expl};
    double end = SUNDER_PRECISION == 32 ? 87 : 708, most = SUNDER_PRECISION == 32 ? 88 : 709;
    double whole = worst_error(f, -end, most, false), near = worst_error(f, -1, 1, false);
    printf("  exp: %.2e everywhere, %.2e in -1 … 1\n", whole, near);
    CHECK(fmax(whole, near) < log_limit);
    CHECK(vec_exp(vec_all(0))[0] == 1);
    /* Beyond the ends the ends' values: finite, positive, normal. */
    CHECK(vec_exp(vec_all((real)1e6))[0] == vec_exp(vec_all((real)most))[0] && isnormal(vec_exp(vec_all((real)1e6))[0]));
    CHECK(vec_exp(vec_all((real)-1e6))[0] == vec_exp(vec_all((real)-end))[0] && isnormal(vec_exp(vec_all((real)-1e6))[0]));
    CHECK(isnan(vec_exp(vec_all((real)NAN))[0]));
}

static void exponential_less_one(void) {
    case_function f = {our_expm1, expm1l};
    double end = SUNDER_PRECISION == 32 ? 87 : 708;
    double whole = worst_error(f, -end, end, false), near = worst_error(f, -1, 1, false);
    double small = worst_error(f, 1e-12, 1e-3, true);
    printf("  exp - 1: %.2e everywhere, %.2e in -1 … 1, %.2e in 1e-12 … 1e-3\n", whole, near, small);
    CHECK(fmax(fmax(whole, near), small) < expm1_limit);
    CHECK(vec_expm1(vec_all(0))[0] == 0);
    CHECK(isnan(vec_expm1(vec_all((real)NAN))[0]));
}

/* Lanes do not see each other: each lane of a mixed vector has the bits that it has alone. */
static void lanes_are_independent(void) {
    vec mixed = vec_all(0);
    for (int lane = 0; lane < VEC_LANES; lane++) mixed[lane] = (real)0.3 * (real)(lane + 1);
    vec logs = vec_log(mixed), powers = vec_exp(mixed);
    for (int lane = 0; lane < VEC_LANES; lane++) {
        CHECK(logs[lane] == vec_log(vec_all(mixed[lane]))[0]);
        CHECK(powers[lane] == vec_exp(vec_all(mixed[lane]))[0]);
    }
}

int main(void) {
#if SUNDER_SIMD == 2
    if (!processor_has("avx512")) return 77;
#elif SUNDER_SIMD == 1
    if (!processor_has("avx2")) return 77;
#endif
    RUN(logarithm);
    RUN(exponential);
    RUN(exponential_less_one);
    RUN(lanes_are_independent);
    return check_finish();
}
