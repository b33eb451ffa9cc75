#include "base/eigen.h"

#include <math.h>
#include <string.h>

/* One Jacobi rotation in the plane (p, q); m is symmetric and full, v collects rows of eigenvectors. */
static void rotate(double m[3][3], double v[3][3], int p, int q) {
    if (m[p][q] == 0) return;
    double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
    double t = (theta >= 0 ? 1 : -1) / (fabs(theta) + sqrt(theta * theta + 1)), c = 1 / sqrt(t * t + 1), s = t * c;
    for (int k = 0; k < 3; k++) {
        double mp = m[k][p], mq = m[k][q];
        m[k][p] = c * mp - s * mq;
        m[k][q] = s * mp + c * mq;
    }
    for (int k = 0; k < 3; k++) {
        double mp = m[p][k], mq = m[q][k], vp = v[p][k], vq = v[q][k];
        m[p][k] = c * mp - s * mq;
        m[q][k] = s * mp + c * mq;
        v[p][k] = c * vp - s * vq;
        v[q][k] = s * vp + c * vq;
    }
}

void eigen_symmetric(const double a[9], double value[3], double vector[3][3]) {
    double m[3][3] = {{a[0], a[1], a[2]}, {a[1], a[4], a[5]}, {a[2], a[5], a[8]}};
    double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int sweep = 0; sweep < 12; sweep++)
        for (int p = 0; p < 2; p++)
            for (int q = p + 1; q < 3; q++) rotate(m, v, p, q);
    int order[3] = {0, 1, 2};
    for (int i = 0; i < 2; i++)
        for (int j = i + 1; j < 3; j++)
            if (m[order[j]][order[j]] > m[order[i]][order[i]]) {
                int swap = order[i];
                order[i] = order[j];
                order[j] = swap;
            }
    for (int i = 0; i < 3; i++) {
        value[i] = m[order[i]][order[i]];
        memcpy(vector[i], v[order[i]], sizeof v[0]);
    }
}
