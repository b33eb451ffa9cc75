/* How long a stress takes: our closed form, the paper's QR form, and fixed-corotated with a decomposition (AnisoMPM §8, METHOD.md §1), on
 * random F, a few per cent of them inverted. Compiled once a precision. */
#ifndef SUNDER_SIM_BENCH_CONSTITUTIVE_H
#define SUNDER_SIM_BENCH_CONSTITUTIVE_H

#include "base/status.h"

#include <stdint.h>

/* The engine's stress stages, in the best build and in the plain one; scalar code, an F at a time, each function written once. */
typedef enum constitutive_contestant {
    BEST_CLOSED,
    BEST_COROTATED,
    PLAIN_CLOSED,
    PLAIN_COROTATED,
    SCALAR_CLOSED,
    SCALAR_QR,
    SCALAR_COROTATED,
    CONTESTANTS
} constitutive_contestant;

typedef struct constitutive_result {
    int64_t count;                   /* of F that each has had: at least what was asked for */
    double nanoseconds[CONTESTANTS]; /* for one stress from one F */
    double difference[CONTESTANTS];  /* largest |τ − τ_scalar| of the same model over 1 + |τ_scalar|; of the QR form from the closed form */
    const char *simd;                /* of the best build */
} constitutive_result;

/* `count` random F, in each precision. Fails when memory does. */
status bench_constitutive_f32(int64_t count, constitutive_result *out, report *r);
status bench_constitutive_f64(int64_t count, constitutive_result *out, report *r);

#endif
