/* Rigid motions: compiled once, in f64, for all variants. */
#include "solid/solid.h"

#include <math.h>
#include <string.h>

void rigid_motion_to_rest(const rigid_motion *m, const double x[3], double rest[3]) {
    double arm[3];
    for (int c = 0; c < 3; c++) arm[c] = x[c] - m->pivot[c] - m->translation[c];
    for (int c = 0; c < 3; c++) /* Rᵀ */
        rest[c] = m->pivot[c] + m->rotation[c] * arm[0] + m->rotation[3 + c] * arm[1] + m->rotation[6 + c] * arm[2];
}

void rigid_motion_velocity(const rigid_motion *m, const double x[3], double velocity[3]) {
    double arm[3];
    for (int c = 0; c < 3; c++) arm[c] = x[c] - m->pivot[c] - m->translation[c];
    velocity[0] = m->velocity[0] + m->spin[1] * arm[2] - m->spin[2] * arm[1];
    velocity[1] = m->velocity[1] + m->spin[2] * arm[0] - m->spin[0] * arm[2];
    velocity[2] = m->velocity[2] + m->spin[0] * arm[1] - m->spin[1] * arm[0];
}

/* Rodrigues' formula for the rotation vector spin·dt: an exact rotation, so the matrix drifts by round-off only. */
static void rotation_of(const double vector[3], double R[9]) {
    double angle = sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
    double a = angle > 1e-8 ? sin(angle) / angle : 1 - angle * angle / 6;
    double b = angle > 1e-8 ? (1 - cos(angle)) / (angle * angle) : 0.5;
    double x = vector[0], y = vector[1], z = vector[2];
    double K[9] = {0, -z, y, z, 0, -x, -y, x, 0};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double square = 0;
            for (int k = 0; k < 3; k++) square += K[3 * i + k] * K[3 * k + j];
            R[3 * i + j] = (i == j) + a * K[3 * i + j] + b * square;
        }
}

void rigid_motion_advance(rigid_motion *m, double dt) {
    for (int c = 0; c < 3; c++) m->translation[c] += dt * m->velocity[c];
    if (m->spin[0] == 0 && m->spin[1] == 0 && m->spin[2] == 0) return;
    double vector[3] = {m->spin[0] * dt, m->spin[1] * dt, m->spin[2] * dt}, step[9], next[9];
    rotation_of(vector, step);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            next[3 * i + j] = step[3 * i] * m->rotation[j] + step[3 * i + 1] * m->rotation[3 + j] + step[3 * i + 2] * m->rotation[6 + j];
    memcpy(m->rotation, next, sizeof next);
}
