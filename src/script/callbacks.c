/* Lua functions of time and place, as the simulation calls them. */
#include "script/internal.h"

#include "base/random.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum {
    OUTPUTS_MOST = 6,
    TIME_TRIES = 17,    /* times at which a function of time is tried, ends included */
    PLACE_TRIES = 2000, /* random points, to find some inside a body */
    PLACE_CALLS = 8,    /* points at which a function of place is tried */
    TRY_STREAM = 0x7a11,
};

/* Lives in the scene's arena. */
typedef struct callback {
    script *owner;
    int slot; /* in the registry's list of functions */
    char key[128];
    const char *file; /* where the function begins */
    int line;
} callback;

typedef struct request {
    const callback *callback;
    const double *input;
    int inputs;
    double *output; /* [OUTPUTS_MOST] */
    int outputs;    /* −1: as many as the function gives, but 3 or 6 */
    int results;
} request;

static void throw_results(lua_State *L, const request *q, const char *expected, const char *found) {
    const callback *c = q->callback;
    char where[256];
    size_t used = (size_t)snprintf(where, sizeof where, "%s at (", found);
    for (int i = 0; i < q->inputs && used < sizeof where; i++)
        used += (size_t)snprintf(where + used, sizeof where - used, i ? ", %.9g" : "%.9g", q->input[i]);
    if (used < sizeof where) snprintf(where + used, sizeof where - used, ")");
    report r;
    report_input(&r, c->file, c->line, c->key, expected, where, NULL);
    throw_report(L, &r);
}

/* A vector as the one result counts as its components. The results are on the stack from `first`. */
static int spread_vector(lua_State *L, int first) {
    if (lua_gettop(L) != first || !lua_istable(L, first)) return lua_gettop(L) - first + 1;
    int count = (int)lua_rawlen(L, first);
    if (count > OUTPUTS_MOST) count = OUTPUTS_MOST + 1;
    for (int i = 1; i <= count; i++) lua_rawgeti(L, first, i);
    lua_remove(L, first);
    return count;
}

static void read_results(lua_State *L, request *q, int first) {
    char expected[96], found[160];
    q->results = spread_vector(L, first);
    bool any = q->outputs < 0;
    snprintf(expected, sizeof expected, any ? "three numbers, or six for two families" : q->outputs == 1 ? "a finite number" : "%d finite numbers",
             q->outputs);
    if (any ? q->results != 3 && q->results != 6 : q->results != q->outputs) {
        snprintf(found, sizeof found, "%d result%s", q->results, q->results == 1 ? "" : "s");
        throw_results(L, q, expected, found);
    }
    for (int i = 0; i < q->results; i++) {
        double x = lua_type(L, first + i) == LUA_TNUMBER ? lua_tonumber(L, first + i) : NAN;
        char value[80];
        describe_value(L, first + i, value, sizeof value);
        snprintf(found, sizeof found, "%s as result %d", value, i + 1);
        if (!isfinite(x)) throw_results(L, q, expected, found);
        q->output[i] = x;
    }
}

/* Runs in protected mode. */
static int run_request(lua_State *L) {
    request *q = lua_touserdata(L, 1);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_FUNCTIONS);
    lua_rawgeti(L, -1, q->callback->slot);
    for (int i = 0; i < q->inputs; i++) lua_pushnumber(L, q->input[i]);
    int first = lua_gettop(L) - q->inputs;
    lua_call(L, q->inputs, LUA_MULTRET);
    luaL_checkstack(L, LUA_MINSTACK, "results");
    read_results(L, q, first);
    const char *changed = purity_broken(L);
    if (!changed) return 0;
    char found[128];
    snprintf(found, sizeof found, "a write to the upvalue '%.80s'", changed);
    throw_results(L, q, "a pure function of time or place: the same result whenever it is asked", found);
    return 0;
}

static status call_request(request *q, report *r) {
    script *s = q->callback->owner;
    lua_State *L = s->L;
    int top = lua_gettop(L);
    guard_begin(&s->guard);
    if (!lua_checkstack(L, 8)) return report_set(r, STATUS_SYSTEM, "no room on the script's stack");
    lua_pushcfunction(L, error_handler);
    lua_pushcfunction(L, run_request);
    lua_pushlightuserdata(L, q);
    int outcome = lua_pcall(L, 1, 0, top + 1);
    status code = outcome == LUA_OK ? STATUS_OK : error_take(s, outcome, r);
    lua_settop(L, top);
    return code;
}

static status call_callback(void *context, const double *input, int inputs, double *output, int outputs, report *r) {
    double results[OUTPUTS_MOST];
    request q = {.callback = context, .input = input, .inputs = inputs, .output = results, .outputs = outputs};
    status code = call_request(&q, r);
    if (code == STATUS_OK) memcpy(output, results, (size_t)outputs * sizeof *output);
    return code;
}

void make_callback(script *s, int index, const place *p, int outputs, scene_function *out) {
    lua_State *L = s->L;
    lua_pushvalue(L, index);
    callback *c = arena_allocate(s->scene->memory, sizeof *c);
    if (!c) throw_memory(L);
    *c = (callback){.owner = s, .file = p->file, .line = place_line(s, p)};
    place_text(p, c->key, sizeof c->key);
    lua_Debug about;
    lua_pushvalue(L, -1);
    lua_getinfo(L, ">S", &about);
    const source_file *file = about.source[0] == '@' ? find_source(s, about.source + 1) : NULL;
    if (file) c->file = file->display, c->line = about.linedefined;
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_FUNCTIONS);
    lua_insert(L, -2);
    c->slot = (int)lua_rawlen(L, -2) + 1;
    lua_rawseti(L, -2, c->slot);
    lua_pop(L, 1);
    *out = (scene_function){.outputs = outputs, .call = call_callback, .context = c};
}

void read_function(script *s, int index, const place *p, scene_function *out) {
    index = lua_absindex(s->L, index);
    if (lua_isfunction(s->L, index)) {
        make_callback(s, index, p, 3, out);
        return;
    }
    plain_value v = plain_from_lua(s->L, index);
    if (v.kind == PLAIN_VECTOR && isfinite(v.number[0]) && isfinite(v.number[1]) && isfinite(v.number[2])) {
        out->outputs = 3;
        memcpy(out->constant, v.number, sizeof v.number);
        return;
    }
    problem_place(s, p, "three finite numbers {x, y, z}, or a function that returns them", v.found, NULL);
}

void read_scalar_function(script *s, int index, const place *p, scene_function *out) {
    index = lua_absindex(s->L, index);
    if (lua_isfunction(s->L, index)) {
        make_callback(s, index, p, 1, out);
        return;
    }
    plain_value v = plain_from_lua(s->L, index);
    *out = (scene_function){.outputs = 1, .constant = {v.number[0]}};
    if (v.kind != PLAIN_NUMBER || !isfinite(v.number[0])) problem_place(s, p, "a finite number, or a function of place that returns one", v.found, NULL);
}

/* ---- trying ------------------------------------------------------------------------------------------------------ */

static bool is_lua(const scene_function *f) {
    return f->outputs != 0 && f->call == call_callback;
}

/* One call; false with a recorded problem when it fails. */
static bool try_once(script *s, const scene_function *f, const double *input, int inputs) {
    double output[OUTPUTS_MOST];
    report r;
    if (f->call(f->context, input, inputs, output, f->outputs, &r) == STATUS_OK) return true;
    problem_report(s, &r);
    return false;
}

static void try_times(script *s, const scene_function *f, double start, double stop) {
    if (!is_lua(f)) return;
    double end = stop < s->scene->duration ? stop : s->scene->duration;
    for (int i = 0; i < TIME_TRIES; i++) {
        double t = start + (end - start) * i / (TIME_TRIES - 1);
        if (i > 0 && !(t > start)) return; /* never held within the scene's duration */
        if (!try_once(s, f, &t, 1)) return;
    }
}

/* Up to PLACE_CALLS points inside a shape; fewer when it is thin. */
static int points_inside(const shape *body, double points[PLACE_CALLS][3]) {
    double low[3], high[3];
    int count = 0;
    shape_bounds(body, low, high);
    for (uint64_t i = 0; i < PLACE_TRIES && count < PLACE_CALLS; i++) {
        double *x = points[count];
        for (uint64_t c = 0; c < 3; c++) x[c] = low[c] + (high[c] - low[c]) * random_unit(0, TRY_STREAM, 3 * i + c);
        if (shape_distance(body, x) < 0) count++;
    }
    return count;
}

static void try_fibres(script *s, scene_fibres *f, double points[PLACE_CALLS][3], int count) {
    if (!is_lua(&f->direction)) return;
    double output[OUTPUTS_MOST];
    static const double origin[3];
    request q = {.callback = f->direction.context,
                 .input = count ? points[0] : origin,
                 .inputs = 3,
                 .output = output,
                 .outputs = -1};
    report r;
    if (call_request(&q, &r) != STATUS_OK) {
        problem_report(s, &r);
        return;
    }
    f->families = q.results / 3;
    f->direction.outputs = q.results;
    for (int i = 1; i < count; i++)
        if (!try_once(s, &f->direction, points[i], 3)) return;
}

static void try_places(script *s, const scene_function *f, double points[PLACE_CALLS][3], int count) {
    if (!is_lua(f)) return;
    for (int i = 0; i < count; i++)
        if (!try_once(s, f, points[i], 3)) return;
}

/* The material's own value: the largest that the function gives at some points of a body. */
static void try_variation(script *s, scene_material *m, const scene_variation *v, double points[PLACE_CALLS][3], int count) {
    double *own = v->effect < 0 ? &m->density : m->effects[v->effect].value[v->key], value, largest = 0;
    for (int i = 0; i < count; i++) {
        report r;
        if (v->function.call(v->function.context, points[i], 3, &value, 1, &r) != STATUS_OK) {
            problem_report(s, &r);
            return;
        }
        if (value > largest) largest = value;
    }
    if (largest > 0) {
        *own = largest;
        return;
    }
    const callback *c = v->function.context;
    report r;
    report_input(&r, c->file, c->line, c->key, "a function that is above 0", "one that is not, inside the body", NULL);
    problem_report(s, &r);
}

static void try_variations(script *s) {
    scene *sc = s->scene;
    bool done[SCENE_MATERIALS] = {false};
    for (int i = 0; i < sc->body_count; i++) {
        const scene_body *b = &sc->bodies[i];
        if (!b->shape || b->material < 0 || done[b->material]) continue;
        scene_material *m = &sc->materials[b->material];
        done[b->material] = true;
        if (m->variation_count == 0) continue;
        double points[PLACE_CALLS][3];
        int count = points_inside(b->shape, points);
        for (int v = 0; v < m->variation_count; v++) try_variation(s, m, &m->variations[v], points, count);
    }
    for (int i = 0; i < sc->sheet_count; i++) {
        int row = sc->sheets[i].material;
        if (row < 0 || sc->materials[row].variation_count == 0) continue;
        const callback *c = sc->materials[row].variations[0].function.context;
        report r;
        report_input(&r, c->file, c->line, c->key, "a number: parameters of sheets do not vary in place", "a function", NULL);
        problem_report(s, &r);
    }
}

void try_functions(script *s) {
    scene *sc = s->scene;
    try_variations(s);
    for (int i = 0; i < sc->body_count; i++) {
        scene_body *b = &sc->bodies[i];
        bool fed = false;
        for (int k = 0; k < b->source_count; k++) fed |= is_lua(&b->sources[k].value);
        if (!b->shape || (!fed && !is_lua(&b->velocity) && !is_lua(&b->start) && !is_lua(&b->fibres.direction))) continue;
        double points[PLACE_CALLS][3];
        int count = points_inside(b->shape, points);
        try_fibres(s, &b->fibres, points, count);
        try_places(s, &b->velocity, points, count);
        try_places(s, &b->start, points, count);
        for (int k = 0; k < b->source_count; k++) try_places(s, &b->sources[k].value, points, count);
    }
    for (int i = 0; i < sc->sheet_count; i++) {
        scene_sheet *b = &sc->sheets[i];
        if (!b->region.shape) continue;
        double points[PLACE_CALLS][3];
        int count = points_inside(b->region.shape, points);
        try_fibres(s, &b->grain, points, count);
        try_places(s, &b->velocity, points, count);
        for (int k = 0; k < b->source_count; k++) try_places(s, &b->sources[k].value, points, count);
    }
    for (int i = 0; i < sc->grip_count; i++) {
        scene_grip *g = &sc->grips[i];
        try_times(s, &g->velocity, g->start, g->stop);
        try_times(s, &g->spin, g->start, g->stop);
    }
    for (int i = 0; i < sc->collider_count; i++) {
        scene_collider *c = &sc->colliders[i];
        try_times(s, &c->velocity, c->start, c->stop);
        try_times(s, &c->spin, c->start, c->stop);
    }
}
