/* Exponential and logarithm on vectors, for kernels: ours, so that bits do not depend on the C library, and one source for
 * both precisions.
 *
 * Largest relative error, measured by tests/unit/test_simd_math.c:  vec_exp, vec_log  f32 1e-7, f64 3e-16;  vec_expm1 f32 2e-7,
 * f64 4e-16. A NaN gives a NaN. The series are Taylor's: a few terms longer than a fitted polynomial, and each coefficient says what
 * it is. */
#ifndef SUNDER_BASE_SIMD_MATH_H
#define SUNDER_BASE_SIMD_MATH_H

#include "base/simd.h"

#if SUNDER_PRECISION == 32
typedef uint32_t real_word;
/* ln 2 = high + low, high of so few bits that its products with an exponent are exact. */
#define MATH_LN2_HIGH ((real)0x1.62e4p-1)
#define MATH_LN2_LOW ((real)0x1.7f7d1cf79abcap-20)
#define MATH_ROUND ((real)0x1.8p23) /* added, it leaves the nearest integer in the lowest bits */
#define MATH_EXP_LEAST ((real)-87)
#define MATH_EXP_MOST ((real)88)
enum { MATH_MANTISSA = 23, MATH_LOG_TERMS = 4, MATH_EXP_TERMS = 8 };
static const real_word MATH_ONE = 0x3f800000u, MATH_HALF_ROOT = 0x3f3504f3u; /* 1 and √½ */
#else
typedef uint64_t real_word;
#define MATH_LN2_HIGH ((real)0x1.62e42fefa3p-1)
#define MATH_LN2_LOW ((real)0x1.3de6af278ece6p-42)
#define MATH_ROUND ((real)0x1.8p52)
#define MATH_EXP_LEAST ((real)-708)
#define MATH_EXP_MOST ((real)709)
enum { MATH_MANTISSA = 52, MATH_LOG_TERMS = 9, MATH_EXP_TERMS = 14 };
static const real_word MATH_ONE = 0x3ff0000000000000u, MATH_HALF_ROOT = 0x3fe6a09e667f3bcdu;
#endif

typedef real_word vec_word __attribute__((vector_size(VEC_BYTES)));

/* ln x for positive normal x; of zero, negative numbers, subnormals and infinities callers keep away.
 *
 * x = 2^k (1 + f), √½ ≤ 1 + f < √2. With s = f/(2 + f), ln(1 + f) = 2 artanh s = 2s + R, R = 2 (s³/3 + s⁵/5 + …); and since
 * 2s = f − f²/2 + s f²/2, the leading term f is exact: all that rounds is small beside it. */
SIMD_INLINE vec vec_log(vec x) {
    vec_word word = (vec_word)x + (MATH_ONE - MATH_HALF_ROOT);
    /* The exponent becomes a real by standing in the lowest bits of 2^mantissa. */
    const real unit = (real)((real_word)1 << MATH_MANTISSA), bias = (real)(MATH_ONE >> MATH_MANTISSA);
    vec k = (vec)((word >> MATH_MANTISSA) | (vec_word)vec_all(unit)) - (unit + bias);
    vec f = (vec)((word & (((real_word)1 << MATH_MANTISSA) - 1)) + MATH_HALF_ROOT) - 1;
    vec s = f / (2 + f), z = s * s, half = (real)0.5 * f * f, sum = vec_all(0);
    for (int n = MATH_LOG_TERMS; n > 0; n--) sum = vec_fma(sum, z, vec_all((real)(2.0 / (2 * n + 1))));
    vec small = half - s * vec_fma(sum, z, half);
    /* k ln 2 + f in two parts (|k ln 2| ≥ |f| unless k = 0). */
    vec head = vec_fma(k, vec_all(MATH_LN2_HIGH), f), tail = (k * MATH_LN2_HIGH - head) + f;
    return head + (tail + vec_fma(k, vec_all(MATH_LN2_LOW), -small)) + (x - x);
}

/* e^x = scale (1 + q): scale = 2^n, q = e^r − 1 with r = x − n ln 2, |r| ≤ ln 2/2. x is held within the exponents of normal numbers. */
SIMD_INLINE vec exp_parts(vec x, vec *scale) {
    /* Reciprocals of factorials, from 1/2! on: q = r + r² (1/2! + r/3! + …). */
    static const real series[] = {(real)(1.0 / 2),         (real)(1.0 / 6),          (real)(1.0 / 24),         (real)(1.0 / 120),
                                  (real)(1.0 / 720),       (real)(1.0 / 5040),       (real)(1.0 / 40320),      (real)(1.0 / 362880),
                                  (real)(1.0 / 3628800),   (real)(1.0 / 39916800),   (real)(1.0 / 479001600),  (real)(1.0 / 6227020800),
                                  (real)(1.0 / 87178291200)};
    x = vec_min(vec_all(MATH_EXP_MOST), vec_max(vec_all(MATH_EXP_LEAST), x)); /* NaN second: it survives */
    vec rounded = vec_fma(x, vec_all((real)1.4426950408889634), vec_all(MATH_ROUND)), n = rounded - MATH_ROUND; /* 1/ln 2 */
    vec r = vec_fma(n, vec_all(-MATH_LN2_LOW), vec_fma(n, vec_all(-MATH_LN2_HIGH), x)), sum = vec_all(0);
    for (int term = MATH_EXP_TERMS; term >= 2; term--) sum = vec_fma(sum, r, vec_all(series[term - 2]));
    *scale = (vec)(((vec_word)rounded << MATH_MANTISSA) + MATH_ONE);
    return vec_fma(r * r, sum, r);
}

/* e^x; beyond −708 … 709 (f32: −87 … 88) the value at that end. */
SIMD_INLINE vec vec_exp(vec x) {
    vec scale, q = exp_parts(x, &scale);
    return vec_fma(q, scale, scale);
}

/* e^x − 1, accurate relative to itself also where x is small. */
SIMD_INLINE vec vec_expm1(vec x) {
    vec scale, q = exp_parts(x, &scale);
    return vec_fma(q, scale, scale - 1);
}

#endif
