/* Rigid motions and boundaries. */
#include "geom/rigid.h"

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

contact_outcome rigid_boundary_velocity(const rigid_boundary *b, const double rest[3], double h, const double u[3], double v[3], double normal[3]) {
    if (b->grip || b->contact == CONTACT_STICKY) {
        for (int c = 0; c < 3; c++) v[c] = u[c];
        return OUTCOME_HELD;
    }
    double local[3];
    shape_normal(b->shape, rest, h, local);
    for (int row = 0; row < 3; row++) {
        normal[row] = 0;
        for (int c = 0; c < 3; c++) normal[row] += b->motion.rotation[row * 3 + c] * local[c];
    }
    double relative[3] = {v[0] - u[0], v[1] - u[1], v[2] - u[2]};
    double normal_speed = relative[0] * normal[0] + relative[1] * normal[1] + relative[2] * normal[2];
    if (b->contact == CONTACT_SEPARATE && normal_speed >= 0) return OUTCOME_LEFT;
    double tangent[3], tangent_speed = 0;
    for (int c = 0; c < 3; c++) {
        tangent[c] = relative[c] - normal_speed * normal[c];
        tangent_speed += tangent[c] * tangent[c];
    }
    tangent_speed = sqrt(tangent_speed);
    double lost = b->friction * fabs(normal_speed);
    double keep = tangent_speed > lost ? 1 - lost / tangent_speed : 0;
    for (int c = 0; c < 3; c++) v[c] = u[c] + keep * tangent[c];
    return keep == 0 && b->friction > 0 ? OUTCOME_STUCK : OUTCOME_SLID;
}
