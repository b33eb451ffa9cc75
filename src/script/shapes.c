/* Shape constructors. A shape is an immutable value made at once, so that its errors name the line it was made on. */
#include "script/internal.h"

#include "base/names.h"
#include "geom/mesh.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    WEIGHT_LIMIT = 4096,      /* primitives in one shape: each is asked at every grid node near it */
    MESH_WEIGHT = 16,         /* what a mesh costs, in primitives */
    MESH_UNIT = 16,           /* triangles: a unit of a mesh is more than others, so that large ones have room */
    MADE_LIMIT = 1000 * 1000, /* units: the scene's arena does not count as Lua's memory */
};

/* Everything that any constructor may say. */
typedef struct shape_words {
    double center[3], minimum[3], maximum[3], size[3], axis[3], from[3], to[3], point[3], normal[3];
    double radius, length, outer, inner, taper, major, minor;
} shape_words;

void scene_charge(lua_State *L, int units) {
    script *s = script_of(L);
    s->charged += units;
    if (s->charged > MADE_LIMIT) throw_here(L, "shapes", "at most 1000000 shapes, or as much in meshes and fields, in one scene", "more", NULL);
}

/* `nodes`: what the new shape takes in the arena, itself and its pointers to children. */
static int push_shape(lua_State *L, const shape *value, int weight, int nodes) {
    if (!value) throw_memory(L);
    scene_charge(L, nodes);
    shape_value *v = lua_newuserdatauv(L, sizeof *v, 0);
    *v = (shape_value){value, weight};
    luaL_setmetatable(L, META_SHAPE);
    return 1;
}

/* Stands for a shape that has been reported: what is made of it is not reported again. */
static int push_wrong(lua_State *L) {
    shape_value *v = lua_newuserdatauv(L, sizeof *v, 0);
    *v = (shape_value){NULL, 0};
    luaL_setmetatable(L, META_SHAPE);
    return 1;
}

/* ---- primitives -------------------------------------------------------------------------------------------------- */

typedef const shape *(*shape_maker)(script *s, const place *p, shape_words *w, const field *fields);

static const shape *wrong(script *s, const place *p, const char *key, const char *expected, double found) {
    char text[40];
    snprintf(text, sizeof text, "%g", found);
    place at = place_key(p, key);
    problem_place(s, &at, expected, text, NULL);
    return NULL;
}

static const shape *make_sphere(script *s, const place *p, shape_words *w, const field *fields) {
    (void)p, (void)fields;
    return shape_sphere(s->scene->memory, w->center, w->radius);
}

/* {min, max} or {center, size}. */
static const shape *make_box(script *s, const place *p, shape_words *w, const field *fields) {
    bool corners = fields[0].given && fields[1].given && !fields[2].given && !fields[3].given;
    bool middle = fields[3].given && !fields[0].given && !fields[1].given;
    if (!corners && !middle) {
        problem_place(s, p, "either min and max, or size and center", "another set of keys", NULL);
        return NULL;
    }
    for (int c = 0; c < 3; c++) {
        if (middle) w->minimum[c] = w->center[c] - 0.5 * w->size[c], w->maximum[c] = w->center[c] + 0.5 * w->size[c];
        if (w->minimum[c] < w->maximum[c]) continue;
        return middle ? wrong(s, p, "size", "three sizes above 0", w->size[c])
                      : wrong(s, p, "max", "three components above those of min", w->maximum[c]);
    }
    return shape_box(s->scene->memory, w->minimum, w->maximum);
}

static const shape *make_cylinder(script *s, const place *p, shape_words *w, const field *fields) {
    (void)p, (void)fields;
    return shape_cylinder(s->scene->memory, w->center, w->axis, w->radius, w->length);
}

static const shape *make_tube(script *s, const place *p, shape_words *w, const field *fields) {
    (void)fields;
    if (w->inner < 0) return wrong(s, p, "inner", "a radius of at least 0", w->inner);
    if (w->inner >= w->outer) return wrong(s, p, "inner", "a radius below outer", w->inner);
    return shape_tube(s->scene->memory, w->center, w->axis, w->outer, w->inner, w->length, w->taper);
}

static const shape *make_capsule(script *s, const place *p, shape_words *w, const field *fields) {
    (void)fields;
    if (memcmp(w->from, w->to, sizeof w->from) == 0) return wrong(s, p, "to", "a point other than from", w->to[0]);
    return shape_capsule(s->scene->memory, w->from, w->to, w->radius);
}

static const shape *make_torus(script *s, const place *p, shape_words *w, const field *fields) {
    (void)p, (void)fields;
    return shape_torus(s->scene->memory, w->center, w->axis, w->major, w->minor);
}

static const shape *make_half_space(script *s, const place *p, shape_words *w, const field *fields) {
    (void)p, (void)fields;
    return shape_half_space(s->scene->memory, w->point, w->normal);
}

enum { SHAPE_FIELDS = 6 };

/* A field of a description: where in shape_words its value goes. */
typedef struct shape_field {
    const char *key;
    field_kind kind;
    bool required;
    size_t offset;
} shape_field;

typedef struct shape_kind {
    const char *name;
    shape_maker make;
    shape_field fields[SHAPE_FIELDS];
} shape_kind;

#define WORD(member) offsetof(shape_words, member)

static const shape_kind kinds[] = {
    {"sphere",
     make_sphere,
     {{"center", FIELD_VECTOR, false, WORD(center)}, {"radius", FIELD_SIZE, true, WORD(radius)}}},
    {"box",
     make_box,
     {{"min", FIELD_VECTOR, false, WORD(minimum)},
      {"max", FIELD_VECTOR, false, WORD(maximum)},
      {"center", FIELD_VECTOR, false, WORD(center)},
      {"size", FIELD_VECTOR, false, WORD(size)}}},
    {"cylinder",
     make_cylinder,
     {{"axis", FIELD_AXIS, true, WORD(axis)},
      {"radius", FIELD_SIZE, true, WORD(radius)},
      {"length", FIELD_SIZE, true, WORD(length)},
      {"center", FIELD_VECTOR, false, WORD(center)}}},
    {"tube",
     make_tube,
     {{"axis", FIELD_AXIS, true, WORD(axis)},
      {"outer", FIELD_SIZE, true, WORD(outer)},
      {"inner", FIELD_REAL, true, WORD(inner)},
      {"length", FIELD_SIZE, true, WORD(length)},
      {"center", FIELD_VECTOR, false, WORD(center)},
      {"taper", FIELD_SIZE, false, WORD(taper)}}},
    {"capsule",
     make_capsule,
     {{"from", FIELD_VECTOR, true, WORD(from)},
      {"to", FIELD_VECTOR, true, WORD(to)},
      {"radius", FIELD_SIZE, true, WORD(radius)}}},
    {"torus",
     make_torus,
     {{"axis", FIELD_AXIS, true, WORD(axis)},
      {"major", FIELD_SIZE, true, WORD(major)},
      {"minor", FIELD_SIZE, true, WORD(minor)},
      {"center", FIELD_VECTOR, false, WORD(center)}}},
    {"half_space",
     make_half_space,
     {{"point", FIELD_VECTOR, false, WORD(point)}, {"normal", FIELD_AXIS, true, WORD(normal)}}},
};

/* core.shape(kind, fields) */
int api_shape(lua_State *L) {
    script *s = script_of(L);
    luaL_checkstack(L, API_STACK, "shapes");
    const char *name = luaL_checkstring(L, 1);
    lua_settop(L, 2);
    const shape_kind *kind = kinds;
    while (strcmp(kind->name, name) != 0) kind++; /* the Lua side names only kinds that exist */
    shape_words words = {.taper = 1};
    field fields[SHAPE_FIELDS] = {0};
    int count = 0;
    for (; count < SHAPE_FIELDS && kind->fields[count].key; count++) {
        const shape_field *f = &kind->fields[count];
        fields[count] = (field){.key = f->key,
                                .kind = f->kind,
                                .required = f->required,
                                .number = (double *)(void *)((char *)&words + f->offset)};
    }
    place here = s->here;
    if (!read_fields(s, 2, &here, fields, count)) return push_wrong(L);
    int before = s->problem_count;
    const shape *made = kind->make(s, &here, &words, fields);
    return !made && s->problem_count > before ? push_wrong(L) : push_shape(L, made, 1, 1);
}

/* ---- combinations ------------------------------------------------------------------------------------------------ */

static const shape_value *shape_at(lua_State *L, int index) {
    return luaL_testudata(L, index, META_SHAPE);
}

const shape *read_shape(script *s, int index, const place *p) {
    const shape_value *v = shape_at(s->L, index);
    if (v) return v->shape;
    char found[80];
    describe_value(s->L, index, found, sizeof found);
    problem_place(s, p, "a shape, such as s.sphere { radius = 1 }", found, NULL);
    return NULL;
}

/* Adds the shapes of arguments `from` … top, each a shape or a list of shapes, to list[WEIGHT_LIMIT]. False: one was
 * wrong. */
static bool gather(script *s, int from, const place *p, const shape **list, int *count, int *weight) {
    lua_State *L = s->L;
    int top = lua_gettop(L);
    bool fine = true;
    for (int i = from; i <= top; i++) {
        bool is_list = lua_istable(L, i);
        int items = is_list ? read_list(s, i, p, WEIGHT_LIMIT, "shapes, or a list of shapes") : 1;
        if (items < 0) return false;
        for (int k = 1; k <= items; k++) {
            if (is_list)
                lua_rawgeti(L, i, k);
            else
                lua_pushvalue(L, i);
            place at = place_index(p, k);
            const shape_value *v = shape_at(L, -1);
            const shape *item = read_shape(s, -1, is_list ? &at : p);
            lua_pop(L, 1); /* the list keeps it */
            fine = fine && item;
            *weight += v ? v->weight : 0;
            if (*count < WEIGHT_LIMIT && item) list[(*count)++] = item;
        }
    }
    if (*weight <= WEIGHT_LIMIT) return fine;
    problem_place(s, p, "a shape of at most 4096 primitives", "a larger one", NULL);
    return false;
}

/* Records a tree that would be too deep: the constructors would give NULL, as if memory were out. */
static bool too_deep(script *s, const place *p, const shape *const *children, int count) {
    int deepest = 0;
    for (int i = 0; i < count; i++)
        if (shape_depth(children[i]) > deepest) deepest = shape_depth(children[i]);
    if (deepest < SHAPE_DEPTH_LIMIT) return false;
    problem_place(s, p, "shapes nested at most 256 deep (s.union { … } takes a list)", "a deeper one", NULL);
    return true;
}

/* core.combine(kind, …): "union", "intersection" of all, "difference" of the first and the others. */
int api_combine(lua_State *L) {
    script *s = script_of(L);
    luaL_checkstack(L, API_STACK, "shapes");
    place here = s->here;
    const char *kind = luaL_checkstring(L, 1);
    const shape **list = lua_newuserdatauv(L, WEIGHT_LIMIT * sizeof *list, 0);
    lua_replace(L, 1); /* over `kind`, a constant of the Lua side: it stays alive there */
    int count = 0, weight = 0;
    if (!gather(s, 2, &here, list, &count, &weight)) return push_wrong(L);
    bool difference = strcmp(kind, "difference") == 0;
    if (count < (difference ? 2 : 1)) {
        problem_place(s, &here, difference ? "a shape and what to cut from it" : "at least one shape", "fewer", NULL);
        return push_wrong(L);
    }
    if (too_deep(s, &here, list, count)) return push_wrong(L);
    arena *memory = s->scene->memory;
    const shape *made = difference                   ? shape_difference(memory, list[0], list + 1, count - 1)
                        : strcmp(kind, "union") == 0 ? shape_union(memory, list, count)
                                                     : shape_intersection(memory, list, count);
    return push_shape(L, made, weight, count + 1);
}

/* ---- moving ------------------------------------------------------------------------------------------------------ */

static const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

static int push_moved(lua_State *L, const double rotation[9], double scale, const double translation[3]) {
    script *s = script_of(L);
    const shape_value *v = shape_at(L, 1);
    place here = s->here;
    if (too_deep(s, &here, &v->shape, 1)) return push_wrong(L);
    return push_shape(L, shape_transform(s->scene->memory, v->shape, rotation, scale, translation), v->weight, 2);
}

/* core.translate(shape, vector) */
int api_translate(lua_State *L) {
    script *s = script_of(L);
    luaL_checkstack(L, API_STACK, "shapes");
    place here = s->here;
    lua_settop(L, 2);
    plain_rule rule = {.kind = PLAIN_VECTOR, .minimum = -HUGE_VAL, .maximum = HUGE_VAL};
    plain_value v;
    bool fine = read_shape(s, 1, &here) != NULL;
    fine = read_plain(s, 2, &here, &rule, &v) && fine;
    return fine ? push_moved(L, identity, 1, v.number) : push_wrong(L);
}

/* core.scale(shape, factor) */
int api_scale(lua_State *L) {
    script *s = script_of(L);
    luaL_checkstack(L, API_STACK, "shapes");
    place here = s->here;
    lua_settop(L, 2);
    static const double nowhere[3];
    plain_rule rule = {.kind = PLAIN_NUMBER, .minimum = 0, .maximum = HUGE_VAL, .above = true};
    plain_value v;
    bool fine = read_shape(s, 1, &here) != NULL;
    fine = read_plain(s, 2, &here, &rule, &v) && fine;
    return fine ? push_moved(L, identity, v.number[0], nowhere) : push_wrong(L);
}

/* Rodrigues' formula: R = c I + s [a]× + (1 − c) a aᵀ. */
static void rotation_about(const double a[3], double angle, double R[9]) {
    double c = cos(angle), s = sin(angle), t = 1 - c;
    const double cross[9] = {0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) R[i * 3 + k] = (i == k ? c : 0) + s * cross[i * 3 + k] + t * a[i] * a[k];
}

/* core.rotate(shape, {axis, angle in degrees, center}) */
int api_rotate(lua_State *L) {
    script *s = script_of(L);
    luaL_checkstack(L, API_STACK, "shapes");
    place here = s->here;
    lua_settop(L, 2);
    double axis[3], angle, center[3] = {0, 0, 0}, R[9], shift[3];
    field fields[] = {{.key = "axis", .kind = FIELD_AXIS, .required = true, .number = axis},
                      {.key = "angle", .kind = FIELD_REAL, .required = true, .number = &angle},
                      {.key = "center", .kind = FIELD_VECTOR, .number = center}};
    bool fine = read_shape(s, 1, &here) != NULL;
    fine = read_fields(s, 2, &here, fields, 3) && fine;
    if (!fine) return push_wrong(L);
    rotation_about(axis, angle * (acos(-1.0) / 180), R);
    for (int i = 0; i < 3; i++)
        shift[i] = center[i] - (R[i * 3] * center[0] + R[i * 3 + 1] * center[1] + R[i * 3 + 2] * center[2]);
    return push_moved(L, R, 1, shift);
}

/* ---- meshes ------------------------------------------------------------------------------------------------------ */

/* How a mesh comes to lie in the scene. */
typedef struct mesh_words {
    char file[SCRIPT_TEXT];
    double scale, center[3], axis[3], angle;
    bool centered, turned;
} mesh_words;

static bool read_mesh_words(lua_State *L, const place *here, mesh_words *w) {
    script *s = script_of(L);
    *w = (mesh_words){.scale = 1};
    field fields[] = {{.key = "file", .kind = FIELD_TEXT, .required = true, .text = w->file},
                      {.key = "scale", .kind = FIELD_REAL, .number = &w->scale, .minimum = 1e-12, .maximum = 1e12},
                      {.key = "center", .kind = FIELD_VECTOR, .number = w->center},
                      {.key = "rotate", .kind = FIELD_OTHER}};
    bool fine = read_fields(s, 1, here, fields, 4);
    w->centered = fields[2].given, w->turned = fields[3].given;
    if (!w->turned) return fine;
    field turn[] = {{.key = "axis", .kind = FIELD_AXIS, .required = true, .number = w->axis},
                    {.key = "angle", .kind = FIELD_REAL, .required = true, .number = &w->angle}};
    place at = place_key(here, "rotate");
    lua_pushstring(L, "rotate");
    lua_rawget(L, 1);
    fine = read_fields(s, lua_gettop(L), &at, turn, 2) && fine;
    lua_pop(L, 1);
    return fine;
}

/* Scales and turns about the origin; a center is where the middle of the box then goes. False when the mesh ends up where
 * numbers no longer tell its corners apart. */
static bool place_mesh(mesh *m, const mesh_report *facts, const mesh_words *w) {
    double R[9], shift[3] = {0, 0, 0}, middle[3], size = 0, furthest = 0;
    memcpy(R, identity, sizeof R);
    if (w->turned) rotation_about(w->axis, w->angle * (acos(-1.0) / 180), R);
    for (int c = 0; c < 3; c++) {
        middle[c] = w->scale * 0.5 * (facts->minimum[c] + facts->maximum[c]);
        size = fmax(size, w->scale * (facts->maximum[c] - facts->minimum[c]));
    }
    for (int c = 0; c < 3 && w->centered; c++)
        shift[c] = w->center[c] - (R[3 * c] * middle[0] + R[3 * c + 1] * middle[1] + R[3 * c + 2] * middle[2]);
    mesh_transform(m, R, w->scale, shift);
    for (int64_t i = 0; i < 3 * m->vertex_count; i++) furthest = fmax(furthest, fabs(m->vertex[i]));
    return size >= 1e-30 && furthest <= 1e30 && furthest <= 1e9 * size;
}

/* Nothing here calls Lua: the mesh is not the arena's. */
static status make_mesh(script *s, const source_file *file, const mesh_words *w, const shape **out, int64_t *triangles,
                        report *r) {
    mesh m;
    mesh_report facts;
    *out = NULL;
    status code = mesh_read(file->display, file->text, file->size, &m, r);
    if (code == STATUS_OK) code = mesh_make_solid(file->display, &m, &facts, r);
    if (code == STATUS_OK && !place_mesh(&m, &facts, w))
        code = report_input(r, file->display, 0, "center", "a place within a billion of the mesh's sizes of the origin",
                            "one further away", NULL);
    if (code == STATUS_OK) {
        *triangles = m.triangle_count;
        *out = shape_mesh(s->scene->memory, &m, file->name);
        if (!*out) code = report_set(r, STATUS_SYSTEM, "out of memory for the mesh %s", file->display);
    }
    mesh_free(&m);
    return code;
}

/* core.mesh{file, scale, center, rotate} */
int api_mesh(lua_State *L) {
    script *s = script_of(L);
    luaL_checkstack(L, API_STACK, "shapes");
    place here = s->here, at = place_key(&here, "file");
    lua_settop(L, 1);
    mesh_words w;
    const source_file *file = read_mesh_words(L, &here, &w) ? read_data_file(s, w.file, ".obj.ply.stl", &at) : NULL;
    if (!file) return push_wrong(L);
    const shape *made;
    int64_t triangles = 0;
    report r;
    double paused = guard_pause();
    status code = make_mesh(s, file, &w, &made, &triangles, &r);
    guard_resume(&s->guard, paused);
    if (code == STATUS_OK) return push_shape(L, made, MESH_WEIGHT, (int)(triangles / MESH_UNIT) + 1);
    problem_report(s, &r);
    return push_wrong(L);
}

void shapes_open(lua_State *L) {
    luaL_newmetatable(L, META_SHAPE);
    lua_pushboolean(L, 0);
    lua_setfield(L, -2, "__metatable");
    lua_pop(L, 1);
}
