/* Eigenvectors of one symmetric 3×3 matrix in f64, for analysis (kernels have their own, src/solid/tensor.h). */
#ifndef SUNDER_BASE_EIGEN_H
#define SUNDER_BASE_EIGEN_H

/* a has shape [3][3] and is read by its upper half. value descends; vector[i] is the unit eigenvector of value[i]. */
void eigen_symmetric(const double a[9], double value[3], double vector[3][3]);

#endif
