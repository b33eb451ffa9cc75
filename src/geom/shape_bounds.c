/* Bounding boxes and volumes. */
#include "geom/shape.h"

#include "geom/shape_tree.h"
#include "geom/vector.h"

#include <stdint.h>

/* ---- bounds -------------------------------------------------------------------------------------------------------
 */

static double support(const shape *s, const double direction[3]);

static double box_support(const shape *s, const double direction[3]) {
    double reach = vector_dot(s->box.center, direction);
    for (int i = 0; i < 3; i++) reach += s->box.half[i] * fabs(direction[i]);
    return reach;
}

/* The cross product gives the sine without the cancellation of √(1 − cos²). */
static double sine(const double axis[3], const double direction[3]) {
    double across[3];
    vector_cross(axis, direction, across);
    return vector_length(across);
}

static double tube_support(const shape_tube_data *t, const double direction[3]) {
    double end = 0.5 * t->length * vector_dot(t->axis, direction), side = t->outer * sine(t->axis, direction);
    return vector_dot(t->center, direction) + fmax(side - end, t->taper * side + end);
}

/* A half-space is bounded along its own normal only; directions that differ by round-off count as the same. */
static double half_space_support(const shape *s, const double direction[3]) {
    bool along_normal =
        vector_dot(s->half_space.normal, direction) > 0.0 && sine(s->half_space.normal, direction) < 1e-12;
    return along_normal ? vector_dot(s->half_space.point, direction) : HUGE_VAL;
}

static double transform_support(const shape *s, const double direction[3]) {
    const double *rotation = s->transform.rotation;
    double local[3];
    for (int i = 0; i < 3; i++)
        local[i] = rotation[i] * direction[0] + rotation[3 + i] * direction[1] + rotation[6 + i] * direction[2];
    return s->transform.scale * support(s->children[0], local) + vector_dot(s->transform.translation, direction);
}

static double union_support(const shape *s, const double direction[3]) {
    double greatest = -HUGE_VAL;
    for (int i = 0; i < s->count; i++) greatest = fmax(greatest, support(s->children[i], direction));
    return greatest;
}

static double intersection_support(const shape *s, const double direction[3]) {
    double least = HUGE_VAL;
    for (int i = 0; i < s->count; i++) least = fmin(least, support(s->children[i], direction));
    return least;
}

/* How far the shape reaches along a unit direction: the maximum of x·direction, or a bound above it. Asked of the axes
 * it gives the bounding box, and it passes through rotations without the growth of a box that is turned. */
static double support(const shape *s, const double direction[3]) {
    switch (s->kind) {
    case SHAPE_SPHERE: return vector_dot(s->sphere.center, direction) + s->sphere.radius;
    case SHAPE_BOX: return box_support(s, direction);
    case SHAPE_TUBE: return tube_support(&s->tube, direction);
    case SHAPE_CAPSULE:
        return vector_dot(s->capsule.from, direction) + fmax(vector_dot(s->capsule.along, direction), 0.0) +
               s->capsule.radius;
    case SHAPE_TORUS:
        return vector_dot(s->torus.center, direction) + s->torus.major * sine(s->torus.axis, direction) +
               s->torus.minor;
    case SHAPE_HALF_SPACE: return half_space_support(s, direction);
    case SHAPE_MESH: return mesh_solid_support(s->mesh.solid, direction);
    case SHAPE_UNION: return union_support(s, direction);
    case SHAPE_INTERSECTION: return intersection_support(s, direction);
    case SHAPE_DIFFERENCE: return support(s->children[0], direction);
    case SHAPE_TRANSFORM: break;
    }
    return transform_support(s, direction);
}

void shape_bounds(const shape *s, double minimum[3], double maximum[3]) {
    bool empty = false;
    for (int i = 0; i < 3; i++) {
        double direction[3] = {0.0, 0.0, 0.0};
        direction[i] = 1.0;
        maximum[i] = support(s, direction);
        direction[i] = -1.0;
        minimum[i] = -support(s, direction);
        if (minimum[i] > maximum[i]) empty = true;
    }
    for (int i = 0; empty && i < 3; i++) minimum[i] = maximum[i] = 0.0;
}

/* ---- volume -------------------------------------------------------------------------------------------------------
 */

/* Splits a box into about `cells` nearly cubic cells. The thinnest side is cut first, so that a side shorter than a
 * cell leaves its share of the cells to the others. */
static void divide_box(const double size[3], double cells, int64_t counts[3]) {
    bool done[3] = {false, false, false};
    for (int left = 3; left > 0; left--) {
        int thinnest = -1;
        double content = 1.0;
        for (int i = 0; i < 3; i++) {
            if (done[i]) continue;
            content *= size[i];
            if (thinnest < 0 || size[i] < size[thinnest]) thinnest = i;
        }
        double edge = pow(content / cells, 1.0 / left);
        counts[thinnest] = (int64_t)fmax(1.0, ceil(size[thinnest] / edge - 1e-6));
        cells = fmax(1.0, cells / (double)counts[thinnest]);
        done[thinnest] = true;
    }
}

/* Full cells, fractions included, in the row of `count` cells along z that starts with the centre x. A cell that the
 * surface cuts counts by how deep its centre lies, over a band `width` wide. The distance to the surface tells how many
 * cells from here on lie beyond that band, all in or all out: they are not looked at. */
static double row_content(const shape *s, double x[3], double step, int64_t count, double width) {
    double content = 0.0, start = x[2];
    for (int64_t i = 0; i < count;) {
        x[2] = start + (double)i * step;
        double distance = shape_distance(s, x);
        double clear = (fabs(distance) - 0.5 * width) / step;
        int64_t run = clear > 1.0 ? (int64_t)fmin(clear, (double)(count - i)) : 1;
        content += (double)run * fmin(fmax(0.5 - distance / width, 0.0), 1.0);
        i += run;
    }
    return content;
}

double shape_volume(const shape *s, int cells) {
    double minimum[3], maximum[3], size[3], step[3];
    shape_bounds(s, minimum, maximum);
    for (int i = 0; i < 3; i++) {
        size[i] = maximum[i] - minimum[i];
        if (!(size[i] > 0.0) || !isfinite(size[i])) return 0.0;
    }
    int64_t counts[3];
    divide_box(size, cells > 0 ? (double)cells : 2e6, counts);
    for (int i = 0; i < 3; i++) step[i] = size[i] / (double)counts[i];
    double width = fmin(step[0], fmin(step[1], step[2])), content = 0.0;
    for (int64_t i = 0; i < counts[0]; i++)
        for (int64_t j = 0; j < counts[1]; j++) {
            double x[3] = {minimum[0] + ((double)i + 0.5) * step[0], minimum[1] + ((double)j + 0.5) * step[1],
                           minimum[2] + 0.5 * step[2]};
            content += row_content(s, x, step[2], counts[2], width);
        }
    return content * step[0] * step[1] * step[2];
}
