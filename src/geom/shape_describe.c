/* One line of text about a shape's tree. */
#include "geom/shape.h"

#include "geom/shape_tree.h"
#include "geom/vector.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* A caller's buffer: `used` counts what was wanted, so that it tells a cut line from a whole one. */
typedef struct line {
    char *text;
    size_t size, used;
} line;

static void append(line *out, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void append(line *out, const char *format, ...) {
    if (out->used >= out->size) return;
    va_list arguments;
    va_start(arguments, format);
    int written = vsnprintf(out->text + out->used, out->size - out->used, format, arguments);
    va_end(arguments);
    if (written > 0) out->used += (size_t)written;
}

static void describe(line *out, const shape *s);

static void describe_children(line *out, const char *name, const shape *s) {
    append(out, "%s(", name);
    for (int i = 0; i < s->count && out->used < out->size; i++) {
        if (i > 0) append(out, ", ");
        describe(out, s->children[i]);
    }
    append(out, ")");
}

static void describe_tube(line *out, const shape_tube_data *t) {
    append(out, t->inner > 0.0 ? "tube" : "cylinder");
    append(out, " r=%g", t->outer);
    if (t->inner > 0.0) append(out, " hole=%g", t->inner);
    append(out, " l=%g", t->length);
    if (t->taper != 1.0) append(out, " taper=%g", t->taper);
}

static void describe(line *out, const shape *s) {
    switch (s->kind) {
    case SHAPE_SPHERE: append(out, "sphere r=%g", s->sphere.radius); return;
    case SHAPE_BOX:
        append(out, "box %g x %g x %g", 2.0 * s->box.half[0], 2.0 * s->box.half[1], 2.0 * s->box.half[2]);
        return;
    case SHAPE_TUBE: describe_tube(out, &s->tube); return;
    case SHAPE_CAPSULE: append(out, "capsule r=%g l=%g", s->capsule.radius, vector_length(s->capsule.along)); return;
    case SHAPE_TORUS: append(out, "torus R=%g r=%g", s->torus.major, s->torus.minor); return;
    case SHAPE_HALF_SPACE:
        append(out, "half_space n=(%g, %g, %g)", s->half_space.normal[0], s->half_space.normal[1],
               s->half_space.normal[2]);
        return;
    case SHAPE_MESH:
        append(out, "mesh '%s' of %lld triangles", s->mesh.name, (long long)mesh_solid_triangles(s->mesh.solid));
        return;
    case SHAPE_UNION: describe_children(out, "union", s); return;
    case SHAPE_INTERSECTION: describe_children(out, "intersection", s); return;
    case SHAPE_DIFFERENCE: describe_children(out, "difference", s); return;
    case SHAPE_TRANSFORM: break;
    }
    describe_children(out, "transform", s);
}

void shape_describe(const shape *s, char *text, size_t size) {
    static const char cut[] = "…";
    if (size == 0) return;
    text[0] = '\0';
    line out = {.text = text, .size = size};
    describe(&out, s);
    if (out.used >= size && size >= sizeof cut) memcpy(text + size - sizeof cut, cut, sizeof cut);
}
