/* Signed distances and normals. */
#include "geom/shape.h"

#include "geom/shape_tree.h"
#include "geom/vector.h"

/* Below this length the central difference of a distance, 1 wherever it is smooth, is round-off. */
static const double NORMAL_FLOOR = 1e-6;

/* ---- primitives ---------------------------------------------------------------------------------------------------
 */

/* Of numbers: fmax and fmin, which ask what else it might be, are calls, and a distance makes several. */
static inline double larger(double a, double b) {
    return a > b ? a : b;
}

static inline double smaller(double a, double b) {
    return a < b ? a : b;
}

static double box_distance(const shape *s, const double x[3]) {
    double outside = 0.0, nearest_face = -HUGE_VAL;
    for (int i = 0; i < 3; i++) {
        double beyond = fabs(x[i] - s->box.center[i]) - s->box.half[i];
        if (beyond > 0.0) outside += beyond * beyond;
        nearest_face = larger(nearest_face, beyond);
    }
    return outside > 0.0 ? sqrt(outside) : nearest_face;
}

/* Where x lies in the half-plane through the axis: section[0] along the axis, section[1] ≥ 0 away from it. The nearest
 * surface point of a solid of revolution lies in the same half-plane, so distances there are distances in space. */
static void axial_and_radial(const double x[3], const double center[3], const double axis[3], double section[2]) {
    double d[3], across[3];
    vector_subtract(x, center, d);
    section[0] = vector_dot(d, axis);
    for (int i = 0; i < 3; i++) across[i] = d[i] - section[0] * axis[i];
    section[1] = vector_length(across);
}

static double rectangle_distance(double beyond_end, double beyond_side) {
    if (beyond_end > 0.0 && beyond_side > 0.0) return hypot(beyond_end, beyond_side);
    return larger(beyond_end, beyond_side);
}

static double segment_distance_squared(const double p[2], const double a[2], const double b[2]) {
    double along[2] = {b[0] - a[0], b[1] - a[1]}, d[2] = {p[0] - a[0], p[1] - a[1]};
    double t = (d[0] * along[0] + d[1] * along[1]) / (along[0] * along[0] + along[1] * along[1]);
    t = smaller(larger(t, 0.0), 1.0);
    double u = d[0] - t * along[0], v = d[1] - t * along[1];
    return u * u + v * v;
}

/* Signed distance to a convex quadrilateral with corners [4][2], counter-clockwise. */
static double quadrilateral_distance(const double p[2], const double corners[4][2]) {
    double nearest = HUGE_VAL;
    bool inside = true;
    for (int i = 0; i < 4; i++) {
        const double *a = corners[i], *b = corners[(i + 1) % 4];
        nearest = smaller(nearest, segment_distance_squared(p, a, b));
        if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) < 0.0) inside = false;
    }
    return inside ? -sqrt(nearest) : sqrt(nearest);
}

static double tube_distance(const shape_tube_data *t, const double x[3]) {
    double p[2];
    axial_and_radial(x, t->center, t->axis, p);
    if (t->taper != 1.0) return quadrilateral_distance(p, t->section);
    double beyond_side = larger(p[1] - t->outer, t->inner > 0.0 ? t->inner - p[1] : -HUGE_VAL);
    return rectangle_distance(fabs(p[0]) - 0.5 * t->length, beyond_side);
}

static double sphere_distance(const shape *s, const double x[3]) {
    double d[3];
    vector_subtract(x, s->sphere.center, d);
    return vector_length(d) - s->sphere.radius;
}

static double capsule_distance(const shape *s, const double x[3]) {
    const double *along = s->capsule.along;
    double d[3], length_squared = vector_dot(along, along);
    vector_subtract(x, s->capsule.from, d);
    double t = length_squared > 0.0 ? smaller(larger(vector_dot(d, along) / length_squared, 0.0), 1.0) : 0.0;
    for (int i = 0; i < 3; i++) d[i] -= t * along[i];
    return vector_length(d) - s->capsule.radius;
}

static double torus_distance(const shape *s, const double x[3]) {
    double p[2];
    axial_and_radial(x, s->torus.center, s->torus.axis, p);
    return hypot(p[0], p[1] - s->torus.major) - s->torus.minor;
}

static double half_space_distance(const shape *s, const double x[3]) {
    double d[3];
    vector_subtract(x, s->half_space.point, d);
    return vector_dot(d, s->half_space.normal);
}

/* ---- trees --------------------------------------------------------------------------------------------------------
 */

static double transform_distance(const shape *s, const double x[3]) {
    const double *rotation = s->transform.rotation;
    double d[3], local[3];
    vector_subtract(x, s->transform.translation, d);
    for (int i = 0; i < 3; i++)
        local[i] = (rotation[i] * d[0] + rotation[3 + i] * d[1] + rotation[6 + i] * d[2]) / s->transform.scale;
    return s->transform.scale * shape_distance(s->children[0], local);
}

static double union_distance(const shape *s, const double x[3]) {
    double least = HUGE_VAL;
    for (int i = 0; i < s->count; i++) least = smaller(least, shape_distance(s->children[i], x));
    return least;
}

static double intersection_distance(const shape *s, const double x[3]) {
    double greatest = -HUGE_VAL;
    for (int i = 0; i < s->count; i++) greatest = larger(greatest, shape_distance(s->children[i], x));
    return greatest;
}

static double difference_distance(const shape *s, const double x[3]) {
    double greatest = shape_distance(s->children[0], x);
    for (int i = 1; i < s->count; i++) greatest = larger(greatest, -shape_distance(s->children[i], x));
    return greatest;
}

double shape_distance(const shape *s, const double x[3]) {
    switch (s->kind) {
    case SHAPE_SPHERE: return sphere_distance(s, x);
    case SHAPE_BOX: return box_distance(s, x);
    case SHAPE_TUBE: return tube_distance(&s->tube, x);
    case SHAPE_CAPSULE: return capsule_distance(s, x);
    case SHAPE_TORUS: return torus_distance(s, x);
    case SHAPE_HALF_SPACE: return half_space_distance(s, x);
    case SHAPE_MESH: return mesh_solid_distance(s->mesh.solid, x);
    case SHAPE_UNION: return union_distance(s, x);
    case SHAPE_INTERSECTION: return intersection_distance(s, x);
    case SHAPE_DIFFERENCE: return difference_distance(s, x);
    case SHAPE_TRANSFORM: break;
    }
    return transform_distance(s, x);
}

void shape_normal(const shape *s, const double x[3], double h, double normal[3]) {
    for (int i = 0; i < 3; i++) {
        double ahead[3] = {x[0], x[1], x[2]}, behind[3] = {x[0], x[1], x[2]};
        ahead[i] += h;
        behind[i] -= h;
        normal[i] = (shape_distance(s, ahead) - shape_distance(s, behind)) / (2.0 * h);
    }
    if (vector_length(normal) < NORMAL_FLOOR || !vector_normalise(normal)) normal[0] = normal[1] = normal[2] = 0.0;
}
