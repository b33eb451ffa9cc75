/* Constructors of shapes. */
#include "geom/shape.h"

#include "geom/shape_tree.h"
#include "geom/vector.h"

#include <assert.h>
#include <string.h>

static shape *new_node(arena *a, shape_kind kind) {
    shape *s = arena_allocate(a, sizeof *s);
    if (s) *s = (shape){.kind = kind, .depth = 1};
    return s;
}

static void copy_vector(double to[3], const double from[3]) {
    memcpy(to, from, 3 * sizeof *to);
}

static void copy_unit_vector(double to[3], const double from[3]) {
    copy_vector(to, from);
    bool ok = vector_normalise(to);
    assert(ok && "an axis or normal must not be zero");
    (void)ok;
}

/* ---- primitives ---------------------------------------------------------------------------------------------------
 */

const shape *shape_sphere(arena *a, const double center[3], double radius) {
    assert(radius > 0.0);
    shape *s = new_node(a, SHAPE_SPHERE);
    if (!s) return NULL;
    copy_vector(s->sphere.center, center);
    s->sphere.radius = radius;
    return s;
}

const shape *shape_box(arena *a, const double minimum[3], const double maximum[3]) {
    shape *s = new_node(a, SHAPE_BOX);
    if (!s) return NULL;
    for (int i = 0; i < 3; i++) {
        assert(maximum[i] > minimum[i]);
        s->box.center[i] = 0.5 * (minimum[i] + maximum[i]);
        s->box.half[i] = 0.5 * (maximum[i] - minimum[i]);
    }
    return s;
}

const shape *shape_tube(arena *a, const double center[3], const double axis[3], double outer, double inner,
                        double length, double taper) {
    assert(outer > inner && inner >= 0.0 && length > 0.0 && taper > 0.0);
    shape *s = new_node(a, SHAPE_TUBE);
    if (!s) return NULL;
    shape_tube_data *t = &s->tube;
    copy_vector(t->center, center);
    copy_unit_vector(t->axis, axis);
    t->outer = outer, t->inner = inner, t->length = length, t->taper = taper;
    double half = 0.5 * length, low = inner > 0.0 ? inner : -outer;
    double section[4][2] = {{-half, low}, {half, low * taper}, {half, outer * taper}, {-half, outer}};
    memcpy(t->section, section, sizeof section);
    return s;
}

const shape *shape_cylinder(arena *a, const double center[3], const double axis[3], double radius, double length) {
    return shape_tube(a, center, axis, radius, 0.0, length, 1.0);
}

const shape *shape_capsule(arena *a, const double from[3], const double to[3], double radius) {
    assert(radius > 0.0);
    shape *s = new_node(a, SHAPE_CAPSULE);
    if (!s) return NULL;
    copy_vector(s->capsule.from, from);
    vector_subtract(to, from, s->capsule.along);
    s->capsule.radius = radius;
    return s;
}

const shape *shape_torus(arena *a, const double center[3], const double axis[3], double major, double minor) {
    assert(major > 0.0 && minor > 0.0);
    shape *s = new_node(a, SHAPE_TORUS);
    if (!s) return NULL;
    copy_vector(s->torus.center, center);
    copy_unit_vector(s->torus.axis, axis);
    s->torus.major = major, s->torus.minor = minor;
    return s;
}

const shape *shape_half_space(arena *a, const double point[3], const double normal[3]) {
    shape *s = new_node(a, SHAPE_HALF_SPACE);
    if (!s) return NULL;
    copy_vector(s->half_space.point, point);
    copy_unit_vector(s->half_space.normal, normal);
    return s;
}

const shape *shape_mesh(arena *a, const mesh *m, const char *name) {
    shape *s = new_node(a, SHAPE_MESH);
    if (!s) return NULL;
    s->mesh.solid = mesh_solid_create(a, m);
    s->mesh.name = arena_copy_string(a, name);
    return s->mesh.solid && s->mesh.name ? s : NULL;
}

bool shape_is_mesh(const shape *s) {
    while (s->kind == SHAPE_TRANSFORM) s = s->children[0];
    return s->kind == SHAPE_MESH;
}

status shape_triangles(const shape *s, mesh *out, report *r) {
    if (s->kind == SHAPE_MESH) return mesh_solid_copy(s->mesh.solid, out, r);
    status code = shape_triangles(s->children[0], out, r);
    if (code == STATUS_OK) mesh_transform(out, s->transform.rotation, s->transform.scale, s->transform.translation);
    return code;
}

/* ---- trees --------------------------------------------------------------------------------------------------------
 */

int shape_depth(const shape *s) {
    return s->depth;
}

/* A node over `first` (where there is one) and others [count]; NULL as the header says. */
static shape *new_parent(arena *a, shape_kind kind, const shape *first, const shape *const *others, int count) {
    int deepest = first ? first->depth : 0;
    for (int i = 0; i < count; i++) {
        if (!others[i]) return NULL;
        if (others[i]->depth > deepest) deepest = others[i]->depth;
    }
    if (deepest >= SHAPE_DEPTH_LIMIT) return NULL;
    shape *s = new_node(a, kind);
    if (!s) return NULL;
    s->count = count + (first ? 1 : 0);
    s->depth = deepest + 1;
    s->children = arena_allocate(a, (size_t)s->count * sizeof *s->children);
    if (!s->children) return NULL;
    if (first) s->children[0] = first;
    for (int i = 0; i < count; i++) s->children[s->count - count + i] = others[i];
    return s;
}

const shape *shape_union(arena *a, const shape *const *children, int count) {
    assert(count >= 1);
    return new_parent(a, SHAPE_UNION, NULL, children, count);
}

const shape *shape_intersection(arena *a, const shape *const *children, int count) {
    assert(count >= 1);
    return new_parent(a, SHAPE_INTERSECTION, NULL, children, count);
}

const shape *shape_difference(arena *a, const shape *base, const shape *const *cuts, int count) {
    assert(count >= 0);
    return base ? new_parent(a, SHAPE_DIFFERENCE, base, cuts, count) : NULL;
}

/* Distances survive a transformation only if its matrix keeps lengths. */
static bool is_orthonormal(const double rotation[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (!(fabs(vector_dot(rotation + 3 * i, rotation + 3 * j) - (i == j ? 1.0 : 0.0)) < 1e-9)) return false;
    return true;
}

const shape *shape_transform(arena *a, const shape *child, const double rotation[9], double scale,
                             const double translation[3]) {
    assert(scale > 0.0 && is_orthonormal(rotation));
    if (!child) return NULL;
    shape *s = new_parent(a, SHAPE_TRANSFORM, child, NULL, 0);
    if (!s) return NULL;
    memcpy(s->transform.rotation, rotation, sizeof s->transform.rotation);
    s->transform.scale = scale;
    copy_vector(s->transform.translation, translation);
    return s;
}
