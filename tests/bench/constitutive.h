/* What constitutive.c asks of constitutive_kernels.c, which is compiled once a precision. */
#ifndef SUNDER_BENCH_CONSTITUTIVE_H
#define SUNDER_BENCH_CONSTITUTIVE_H

#include <stdint.h>

enum bench_row { BEST_CLOSED, BEST_COROTATED, PLAIN_CLOSED, PLAIN_COROTATED, SCALAR_CLOSED, SCALAR_QR, SCALAR_COROTATED, BENCH_ROWS };

typedef struct bench_result {
    double nanoseconds[BENCH_ROWS]; /* for one stress from one F */
    double difference[BENCH_ROWS];  /* largest |τ − τ_scalar| of the same model over 1 + |τ_scalar| */
    const char *simd;               /* of the best build */
} bench_result;

bench_result bench_constitutive_f32(int64_t count);
bench_result bench_constitutive_f64(int64_t count);

#endif
