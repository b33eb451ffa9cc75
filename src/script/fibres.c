/* Fibre directions: constant, by a function of place, laid around an axis, along a curve, at random, from a table, or along
 * a flow. */
#include "script/internal.h"

#include "geom/fibre_fields.h"
#include "geom/fibre_flow.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    BYTES_PER_UNIT = 800, /* of a table's text, for scene_charge: tables have more room than shapes */
    FLOW_UNITS = 20000,   /* a flow holds some 100,000 nodes */
};

typedef enum fibre_kind {
    FIBRES_WRONG,
    FIBRES_DIRECTION,
    FIBRES_FIELD,    /* a Lua function */
    FIBRES_COMPUTED, /* a function of ours */
    FIBRES_FLOW,     /* one that must see the body first */
} fibre_kind;

typedef status (*fibre_call)(void *context, const double *input, int inputs, double *output, int outputs, report *r);

/* Directions around an axis: `along` of the axis, `around` of the circle, `outward` of the radius. Lives in the scene's
 * arena. */
typedef struct around {
    double center[3], axis[3], substitute[3]; /* unit vectors; substitute is perpendicular to the axis */
    double along, around, outward;
} around;

/* The contexts of the other fields, in the scene's arena too. `second` is what a second family is made of: fibres are
 * made orthogonal when particles get them. */
typedef struct along_curve {
    const fibre_curve *curve;
    double second[3];
} along_curve;

typedef struct at_random {
    double mean[3], spread;
    uint64_t seed;
    const scene *seeded_by; /* NULL: the seed above */
} at_random;

typedef struct from_table {
    const fibre_table *table;
    bool blended;
} from_table;

typedef struct along_flow {
    flow_definition definition; /* body NULL: that of whoever has the fibres */
    const fibre_flow *flow;     /* NULL: not solved yet */
    double second[3];
} along_flow;

/* The value that s.fibres.… makes; a Lua function is its user value. */
typedef struct fibre_value {
    fibre_kind kind;
    int families;
    double vectors[6];
    fibre_call call;
    void *context;
    place where;
} fibre_value;

static fibre_value *push_fibres(lua_State *L, fibre_kind kind) {
    fibre_value *v = lua_newuserdatauv(L, sizeof *v, 1);
    *v = (fibre_value){.kind = kind, .where = script_of(L)->here};
    v->where.depth = 0;
    luaL_setmetatable(L, META_FIBRES);
    return v;
}

/* Copies a context into the scene's arena. */
static void *keep(lua_State *L, const void *context, size_t size) {
    scene_charge(L, 4);
    void *kept = arena_allocate(script_of(L)->scene->memory, size);
    if (!kept) throw_memory(L);
    return memcpy(kept, context, size);
}

static int push_computed(lua_State *L, int families, fibre_call call, void *context) {
    fibre_value *v = push_fibres(L, FIBRES_COMPUTED);
    v->families = families, v->call = call, v->context = context;
    return 1;
}

/* ---- directions, functions, axes --------------------------------------------------------------------------------- */

static bool read_direction(script *s, int index, const place *p, double out[3]) {
    plain_rule rule = {.kind = PLAIN_VECTOR, .minimum = -HUGE_VAL, .maximum = HUGE_VAL};
    plain_value v;
    if (!read_plain(s, index, p, &rule, &v)) return false;
    double length = hypot(hypot(v.number[0], v.number[1]), v.number[2]);
    if (!(length > 0) || isinf(length)) {
        problem_place(s, p, "a direction that is not zero", v.found, NULL);
        return false;
    }
    for (int c = 0; c < 3; c++) out[c] = v.number[c] / length;
    return true;
}

/* direction { x, y, z }, direction({…}, {…}) or direction {{…}, {…}} */
static int make_direction(lua_State *L) {
    script *s = script_of(L);
    place here = s->here;
    lua_settop(L, 3);
    bool listed = lua_istable(L, 2) && lua_rawgeti(L, 2, 1) == LUA_TTABLE;
    if (listed) {
        if (read_list(s, 2, &here, 2, "one direction, or two") < 0) return push_fibres(L, FIBRES_WRONG), 1;
        lua_rawgeti(L, 2, 2);
        lua_replace(L, 3);
        lua_rawgeti(L, 2, 1);
        lua_replace(L, 2);
    }
    double vectors[6] = {0};
    int families = lua_isnil(L, 3) ? 1 : 2;
    bool fine = read_direction(s, 2, &here, vectors);
    if (families == 2) fine = read_direction(s, 3, &here, vectors + 3) && fine;
    if (fine && families == 2) {
        const double *a = vectors, *b = vectors + 3;
        if (fabs(fabs(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) - 1) < 1e-9) {
            problem_place(s, &here, "two families of different directions", "parallel ones", NULL);
            fine = false;
        }
    }
    fibre_value *v = push_fibres(L, fine ? FIBRES_DIRECTION : FIBRES_WRONG);
    v->families = families;
    memcpy(v->vectors, vectors, sizeof vectors);
    return 1;
}

static int make_field(lua_State *L) {
    script *s = script_of(L);
    place here = s->here;
    lua_settop(L, 2);
    bool fine = lua_isfunction(L, 2);
    char found[80];
    describe_value(L, 2, found, sizeof found);
    if (!fine) problem_place(s, &here, "a function(x, y, z) that returns dx, dy, dz", found, NULL);
    push_fibres(L, fine ? FIBRES_FIELD : FIBRES_WRONG);
    lua_pushvalue(L, 2);
    lua_setiuservalue(L, -2, 1);
    return 1;
}

/* A unit vector perpendicular to a, from the coordinate axis that a is least along. */
static void perpendicular(const double a[3], double out[3]) {
    int least = 0;
    for (int c = 1; c < 3; c++)
        if (fabs(a[c]) < fabs(a[least])) least = c;
    double length = 0;
    for (int c = 0; c < 3; c++) out[c] = (c == least ? 1 : 0) - a[least] * a[c];
    for (int c = 0; c < 3; c++) length += out[c] * out[c];
    for (int c = 0; c < 3; c++) out[c] /= sqrt(length);
}

/* A scene_function: on the axis itself the radius has no direction, and a fixed perpendicular stands in. */
static status direction_around(void *context, const double *input, int inputs, double *output, int outputs, report *r) {
    (void)inputs, (void)outputs, (void)r;
    const around *a = context;
    double offset[3], height = 0, radius = 0;
    for (int c = 0; c < 3; c++) offset[c] = input[c] - a->center[c];
    for (int c = 0; c < 3; c++) height += offset[c] * a->axis[c];
    for (int c = 0; c < 3; c++) offset[c] -= height * a->axis[c];
    for (int c = 0; c < 3; c++) radius += offset[c] * offset[c];
    radius = sqrt(radius);
    for (int c = 0; c < 3; c++) offset[c] = radius > 1e-12 ? offset[c] / radius : a->substitute[c];
    for (int c = 0; c < 3; c++) {
        int d = (c + 1) % 3, e = (c + 2) % 3;
        double circle = a->axis[d] * offset[e] - a->axis[e] * offset[d];
        output[c] = a->along * a->axis[c] + a->around * circle + a->outward * offset[c];
    }
    return STATUS_OK;
}

/* radial, circumferential: {axis, center}; helical: also angle, in degrees from the circle towards the axis. */
static int make_around(lua_State *L, const char *kind) {
    script *s = script_of(L);
    place here = s->here;
    around a = {.center = {0, 0, 0}};
    double angle = 0;
    field fields[] = {{.key = "axis", .kind = FIELD_AXIS, .required = true, .number = a.axis},
                      {.key = "center", .kind = FIELD_VECTOR, .number = a.center},
                      {.key = "angle", .kind = FIELD_REAL, .required = true, .number = &angle}};
    bool helical = strcmp(kind, "helical") == 0;
    if (!read_fields(s, 2, &here, fields, helical ? 3 : 2)) return push_fibres(L, FIBRES_WRONG), 1;
    perpendicular(a.axis, a.substitute);
    a.outward = strcmp(kind, "radial") == 0;
    if (a.outward == 0) a.around = cos(angle * (acos(-1.0) / 180)), a.along = sin(angle * (acos(-1.0) / 180));
    return push_computed(L, 1, direction_around, keep(L, &a, sizeof a));
}

/* ---- curves ------------------------------------------------------------------------------------------------------ */

static status direction_along_curve(void *context, const double *input, int inputs, double *output, int outputs,
                                    report *r) {
    (void)inputs, (void)r;
    const along_curve *a = context;
    fibre_curve_direction(a->curve, input, output);
    if (outputs == 6) memcpy(output + 3, a->second, sizeof a->second);
    return STATUS_OK;
}

/* Reads the points under "points" of the table at 2 into a buffer that stays on the stack; their number, or 0 after a
 * problem. */
static int read_points(lua_State *L, const place *here, double (**out)[3]) {
    script *s = script_of(L);
    place list = place_key(here, "points");
    lua_pushstring(L, "points");
    lua_rawget(L, 2);
    int index = lua_gettop(L);
    int count = read_list(s, index, &list, FIBRE_CURVE_POINTS, "a list of points: points = { { x, y, z }, … }");
    if (count < 0) return 0;
    double(*points)[3] = lua_newuserdatauv(L, (size_t)(count > 0 ? count : 1) * sizeof *points, 0);
    plain_rule rule = {.kind = PLAIN_VECTOR, .minimum = -HUGE_VAL, .maximum = HUGE_VAL};
    bool fine = true;
    for (int i = 0; i < count; i++) {
        plain_value v;
        place at = place_index(&list, i + 1);
        lua_rawgeti(L, index, i + 1);
        bool read = read_plain(s, -1, &at, &rule, &v);
        lua_pop(L, 1);
        fine = fine && read;
        memcpy(points[i], v.number, sizeof points[i]);
        if (!fine || i == 0 || memcmp(points[i], points[i - 1], sizeof points[i]) != 0) continue;
        problem_place(s, &at, "a point apart from the one before", v.found, NULL);
        fine = false;
    }
    if (count < 2 && fine) problem_place(s, &list, "at least two points", count ? "one" : "none", NULL);
    *out = points;
    return fine && count >= 2 ? count : 0;
}

/* curve {points, second} */
static int make_curve(lua_State *L) {
    script *s = script_of(L);
    place here = s->here;
    along_curve a = {0};
    double(*points)[3];
    field fields[] = {{.key = "points", .kind = FIELD_OTHER, .required = true},
                      {.key = "second", .kind = FIELD_AXIS, .number = a.second}};
    bool fine = read_fields(s, 2, &here, fields, 2);
    int count = fields[0].given ? read_points(L, &here, &points) : 0;
    if (!fine || !count) return push_fibres(L, FIBRES_WRONG), 1;
    scene_charge(L, count);
    a.curve = fibre_curve_create(s->scene->memory, points[0], count);
    if (!a.curve) throw_memory(L);
    return push_computed(L, fields[1].given ? 2 : 1, direction_along_curve, keep(L, &a, sizeof a));
}

/* ---- random ------------------------------------------------------------------------------------------------------ */

static status direction_at_random(void *context, const double *input, int inputs, double *output, int outputs, report *r) {
    (void)inputs, (void)outputs, (void)r;
    const at_random *a = context;
    fibre_random_direction(a->mean, a->spread, a->seeded_by ? a->seeded_by->seed : a->seed, input, output);
    return STATUS_OK;
}

/* random {direction, spread in degrees, seed} */
static int make_random(lua_State *L) {
    script *s = script_of(L);
    place here = s->here;
    at_random a = {.seeded_by = s->scene};
    double degrees = 0, seed = 0;
    field fields[] = {{.key = "direction", .kind = FIELD_AXIS, .required = true, .number = a.mean},
                      {.key = "spread", .kind = FIELD_REAL, .required = true, .number = &degrees, .maximum = 180},
                      {.key = "seed", .kind = FIELD_REAL, .number = &seed, .maximum = 0x1p53}};
    if (!read_fields(s, 2, &here, fields, 3)) return push_fibres(L, FIBRES_WRONG), 1;
    a.spread = degrees * (acos(-1.0) / 180);
    if (fields[2].given) a.seed = (uint64_t)seed, a.seeded_by = NULL;
    return push_computed(L, 1, direction_at_random, keep(L, &a, sizeof a));
}

/* ---- tables ------------------------------------------------------------------------------------------------------ */

static status direction_from_table(void *context, const double *input, int inputs, double *output, int outputs, report *r) {
    (void)inputs, (void)outputs, (void)r;
    const from_table *a = context;
    (a->blended ? fibre_table_blend : fibre_table_nearest)(a->table, input, output);
    return STATUS_OK;
}

/* file {path, method} */
static int make_table(lua_State *L) {
    static const char *const methods[] = {"nearest", "inverse_distance", NULL};
    script *s = script_of(L);
    place here = s->here, at = place_key(&here, "path");
    char path[SCRIPT_TEXT] = "";
    double method = 0;
    field fields[] = {{.key = "path", .kind = FIELD_TEXT, .required = true, .text = path},
                      {.key = "method", .kind = FIELD_CHOICE, .choices = methods, .number = &method}};
    bool fine = read_fields(s, 2, &here, fields, 2);
    const source_file *file = fine ? read_data_file(s, path, ".csv.txt", &at) : NULL;
    if (!file) return push_fibres(L, FIBRES_WRONG), 1;
    from_table a = {.blended = method > 0};
    report r;
    double paused = guard_pause();
    status code = fibre_table_read(s->scene->memory, file->display, file->text, file->size, &a.table, &r);
    guard_resume(&s->guard, paused);
    if (code != STATUS_OK) {
        problem_report(s, &r);
        return push_fibres(L, FIBRES_WRONG), 1;
    }
    scene_charge(L, (int)(file->size / BYTES_PER_UNIT));
    return push_computed(L, fibre_table_families(a.table), direction_from_table, keep(L, &a, sizeof a));
}

/* ---- flows ------------------------------------------------------------------------------------------------------- */

static status direction_along_flow(void *context, const double *input, int inputs, double *output, int outputs, report *r) {
    (void)inputs, (void)r;
    const along_flow *a = context;
    fibre_flow_direction(a->flow, input, output);
    if (outputs == 6) memcpy(output + 3, a->second, sizeof a->second);
    return STATUS_OK;
}

/* The shape under a key of the table at 2; NULL after a problem. */
static const shape *read_flow_shape(lua_State *L, const place *here, const char *key) {
    place at = place_key(here, key);
    lua_pushstring(L, key);
    lua_rawget(L, 2);
    const shape *found = read_shape(script_of(L), -1, &at);
    lua_pop(L, 1);
    return found;
}

/* flow {shape, inflow, outflow, resolution, second} */
static int make_flow(lua_State *L) {
    script *s = script_of(L);
    place here = s->here;
    along_flow a = {0};
    double cubes = 0;
    field fields[] = {{.key = "inflow", .kind = FIELD_OTHER, .required = true},
                      {.key = "outflow", .kind = FIELD_OTHER, .required = true},
                      {.key = "shape", .kind = FIELD_OTHER},
                      {.key = "resolution", .kind = FIELD_REAL, .number = &cubes, .minimum = FLOW_COARSEST,
                       .maximum = FLOW_FINEST},
                      {.key = "second", .kind = FIELD_AXIS, .number = a.second}};
    const shape **shapes[] = {&a.definition.inflow, &a.definition.outflow, &a.definition.body};
    bool fine = read_fields(s, 2, &here, fields, 5);
    for (int i = 0; i < 3; i++) {
        if (!fields[i].given) continue;
        *shapes[i] = read_flow_shape(L, &here, fields[i].key);
        fine = fine && *shapes[i];
    }
    if (!fine) return push_fibres(L, FIBRES_WRONG), 1;
    a.definition.resolution = (int)cubes;
    push_computed(L, fields[4].given ? 2 : 1, direction_along_flow, keep(L, &a, sizeof a));
    ((fibre_value *)lua_touserdata(L, -1))->kind = FIBRES_FLOW;
    return 1;
}

/* Solves a flow in its own shape, or in that of the body which has the fibres. NULL when something was wrong, which has been
 * recorded. */
static along_flow *solve_flow(script *s, const fibre_value *v, const shape *body) {
    along_flow *given = v->context, a = *given;
    if (given->flow) return given;
    if (!a.definition.body) a.definition.body = body;
    if (!a.definition.body) return NULL;
    report r;
    double paused = guard_pause();
    status code = fibre_flow_solve(s->scene->memory, &a.definition, &a.flow, &r);
    guard_resume(&s->guard, paused);
    if (code != STATUS_OK) {
        place at = place_key(&v->where, r.key);
        if (code == STATUS_INPUT) problem_place(s, &at, r.expected, r.found, NULL);
        else problem_report(s, &r);
        return NULL;
    }
    scene_charge(s->L, FLOW_UNITS);
    if (!given->definition.body) return keep(s->L, &a, sizeof a);
    *given = a; /* one solution for all who have these fibres */
    return given;
}

/* core.fibres(kind, …) */
int api_fibres(lua_State *L) {
    const char *kind = luaL_checkstring(L, 1);
    luaL_checkstack(L, API_STACK, "fibres");
    if (strcmp(kind, "direction") == 0) return make_direction(L);
    if (strcmp(kind, "field") == 0) return make_field(L);
    lua_settop(L, 2);
    if (strcmp(kind, "curve") == 0) return make_curve(L);
    if (strcmp(kind, "random") == 0) return make_random(L);
    if (strcmp(kind, "file") == 0) return make_table(L);
    if (strcmp(kind, "flow") == 0) return make_flow(L);
    return make_around(L, kind);
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

void read_fibres(script *s, int index, const place *p, const shape *body, scene_fibres *out) {
    char found[80];
    const fibre_value *v = luaL_testudata(s->L, index, META_FIBRES);
    if (!v) {
        describe_value(s->L, index, found, sizeof found);
        problem_place(s, p, "fibres, such as s.fibres.direction { 1, 0, 0 }", found, NULL);
        return;
    }
    out->direction.outputs = 3 * v->families;
    out->families = v->families;
    switch (v->kind) {
    case FIBRES_WRONG: break;
    case FIBRES_DIRECTION: memcpy(out->direction.constant, v->vectors, sizeof v->vectors); break;
    case FIBRES_COMPUTED: out->direction.call = v->call, out->direction.context = v->context; break;
    case FIBRES_FLOW:
        out->direction.context = solve_flow(s, v, body);
        if (out->direction.context) out->direction.call = v->call;
        break;
    case FIBRES_FIELD:
        lua_getiuservalue(s->L, index, 1);
        make_callback(s, -1, &v->where, 6, &out->direction);
        lua_pop(s->L, 1);
        out->families = FAMILIES_UNKNOWN; /* its results will tell */
        break;
    }
}

void fibres_open(lua_State *L) {
    luaL_newmetatable(L, META_FIBRES);
    lua_pushboolean(L, 0);
    lua_setfield(L, -2, "__metatable");
    lua_pop(L, 1);
}
