/* Fibre directions: constant, by a function of place, or laid around an axis. */
#include "script/internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef enum fibre_kind { FIBRES_WRONG, FIBRES_DIRECTION, FIBRES_FIELD, FIBRES_AROUND } fibre_kind;

/* Directions around an axis: `along` of the axis, `around` of the circle, `outward` of the radius. Lives in the scene's
 * arena. */
typedef struct around {
    double center[3], axis[3], substitute[3]; /* unit vectors; substitute is perpendicular to the axis */
    double along, around, outward;
} around;

/* The value that s.fibres.… makes; a function is its user value. */
typedef struct fibre_value {
    fibre_kind kind;
    int families;
    double vectors[6];
    const around *around;
    place where;
} fibre_value;

static fibre_value *push_fibres(lua_State *L, fibre_kind kind) {
    fibre_value *v = lua_newuserdatauv(L, sizeof *v, 1);
    *v = (fibre_value){.kind = kind, .where = script_of(L)->here};
    v->where.depth = 0;
    luaL_setmetatable(L, META_FIBRES);
    return v;
}

/* ---- constructors ------------------------------------------------------------------------------------------------ */

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
    scene_charge(L, 4);
    around *kept = arena_allocate(s->scene->memory, sizeof *kept);
    if (!kept) throw_memory(L);
    *kept = a;
    fibre_value *v = push_fibres(L, FIBRES_AROUND);
    v->families = 1, v->around = kept;
    return 1;
}

/* core.fibres(kind, …) */
int api_fibres(lua_State *L) {
    const char *kind = luaL_checkstring(L, 1);
    luaL_checkstack(L, API_STACK, "fibres");
    if (strcmp(kind, "direction") == 0) return make_direction(L);
    if (strcmp(kind, "field") == 0) return make_field(L);
    return make_around(L, kind);
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

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

void read_fibres(script *s, int index, const place *p, scene_fibres *out) {
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
    case FIBRES_AROUND:
        out->direction.call = direction_around;
        out->direction.context = (void *)v->around;
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
