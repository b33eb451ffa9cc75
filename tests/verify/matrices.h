/* 3 × 3 matrices for checks at one point: row-major f64, written for clearness, not for speed. */
#ifndef SUNDER_TESTS_VERIFY_MATRICES_H
#define SUNDER_TESTS_VERIFY_MATRICES_H

#include "base/eigen.h"
#include "base/random.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

static inline double norm(const double *v, int n) {
    double sum = 0;
    for (int i = 0; i < n; i++) sum += v[i] * v[i];
    return sqrt(sum);
}

/* C may be A or B. */
static inline void multiply(const double A[9], const double B[9], double C[9]) {
    double out[9];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            out[3 * i + j] = 0;
            for (int k = 0; k < 3; k++) out[3 * i + j] += A[3 * i + k] * B[3 * k + j];
        }
    memcpy(C, out, sizeof out);
}

/* In −1 … 1. */
static inline double random_sign(uint64_t seed, uint64_t stream, uint64_t i) {
    return 2 * random_unit(seed, stream, i) - 1;
}

/* Entries of up to `scale`, about the identity where the scale is under 1. */
static inline void random_matrix(uint64_t seed, uint64_t i, double scale, double F[9]) {
    for (int c = 0; c < 9; c++) F[c] = (c % 4 == 0 && scale < 1) + scale * random_sign(seed, (uint64_t)c, i);
}

/* A rotation from a random unit quaternion. */
static inline void random_rotation(uint64_t seed, uint64_t i, double R[9]) {
    double q[4];
    do {
        for (int c = 0; c < 4; c++) q[c] = random_sign(seed, 100 + (uint64_t)c, i);
        i += 1000003;
    } while (norm(q, 4) < 0.1);
    double n = norm(q, 4), w = q[0] / n, x = q[1] / n, y = q[2] / n, z = q[3] / n;
    const double r[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z), 1 - 2 * (x * x + z * z),
                         2 * (y * z - w * x), 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)};
    memcpy(R, r, sizeof r);
}

/* R of F = R S by Newton's iteration R ← (R + R⁻ᵀ)/2. */
static inline void polar_rotation(const double F[9], double R[9]) {
    memcpy(R, F, 9 * sizeof *R);
    for (int n = 0; n < 100; n++) {
        double J = matrix_determinant(R);
        const double C[9] = {R[4] * R[8] - R[5] * R[7], R[5] * R[6] - R[3] * R[8], R[3] * R[7] - R[4] * R[6],
                             R[2] * R[7] - R[1] * R[8], R[0] * R[8] - R[2] * R[6], R[1] * R[6] - R[0] * R[7],
                             R[1] * R[5] - R[2] * R[4], R[2] * R[3] - R[0] * R[5], R[0] * R[4] - R[1] * R[3]};
        for (int c = 0; c < 9; c++) R[c] = 0.5 * (R[c] + C[c] / J);
    }
}

#endif
