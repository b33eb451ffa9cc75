/* One 3×3 matrix in f64, for analysis (kernels have their own, src/solid/tensor.h). */
#ifndef SUNDER_BASE_EIGEN_H
#define SUNDER_BASE_EIGEN_H

/* a has shape [3][3] and is read by its upper half. value descends; vector[i] is the unit eigenvector of value[i]. */
void eigen_symmetric(const double a[9], double value[3], double vector[3][3]);

/* F has shape [3][3]. */
static inline double matrix_determinant(const double F[9]) {
    return F[0] * (F[4] * F[8] - F[5] * F[7]) + F[1] * (F[5] * F[6] - F[3] * F[8]) + F[2] * (F[3] * F[7] - F[4] * F[6]);
}

/* b = F Fᵀ; not in place. */
static inline void matrix_gram(const double F[9], double b[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) b[3 * i + j] = F[3 * i] * F[3 * j] + F[3 * i + 1] * F[3 * j + 1] + F[3 * i + 2] * F[3 * j + 2];
}

#endif
