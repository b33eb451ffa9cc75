#include "script/sweep.h"

#include "base/json.h"
#include "script/internal.h"

#include <stdio.h>
#include <string.h>

typedef struct sweep_words {
    char title[SCRIPT_TEXT], scene[SCRIPT_TEXT], recipe[SCRIPT_TEXT];
    double frames;
} sweep_words;

int sweep_count(const sweep *s) {
    int count = 1;
    for (int a = 0; a < s->axis_count; a++) count *= s->axes[a].count;
    return count;
}

void sweep_cell(const sweep *s, int run, int which[SWEEP_AXES]) {
    for (int a = s->axis_count - 1; a >= 0; a--) {
        which[a] = run % s->axes[a].count;
        run /= s->axes[a].count;
    }
}

/* A value as --set takes it. */
static bool read_setting(script *s, int index, const place *p, char text[SWEEP_TEXT]) {
    plain_value v = plain_from_lua(s->L, index);
    if (v.kind == PLAIN_NUMBER) {
        json_format_number(v.number[0], text);
    } else if (v.kind == PLAIN_BOOLEAN) {
        snprintf(text, SWEEP_TEXT, "%s", v.number[0] != 0 ? "true" : "false");
    } else if (v.kind == PLAIN_TEXT) {
        snprintf(text, SWEEP_TEXT, "%s", v.text);
    } else {
        problem_place(s, p, "a number, a text, true or false", v.found, NULL);
        return false;
    }
    return true;
}

/* Pushes the table under `key` and a sorted list of its names; how many there are, −1 after a problem. */
static int push_named(script *s, int index, const place *p, const char *key, const char *expected, int limit) {
    lua_State *L = s->L;
    lua_pushstring(L, key);
    lua_rawget(L, index);
    if (!read_table(s, lua_gettop(L), p, expected)) return -1;
    int count = push_sorted_names(s, lua_gettop(L), p);
    if (count <= limit) return count;
    problem_place(s, p, expected, "too many names", NULL);
    return -1;
}

static void read_fixed(script *s, int index, const place *p, sweep *out) {
    lua_State *L = s->L;
    int top = lua_gettop(L), count = push_named(s, index, p, "set", "a table of at most 24 settings: set = { eta = 0.1, … }", SWEEP_SETTINGS);
    for (int i = 1; i <= count; i++) {
        sweep_axis *a = &out->fixed[out->fixed_count++];
        lua_rawgeti(L, top + 2, i);
        snprintf(a->name, sizeof a->name, "%s", lua_tostring(L, -1));
        place at = place_key(p, a->name);
        lua_rawget(L, top + 1);
        a->count = read_setting(s, -1, &at, a->value[0]);
        lua_pop(L, 1);
    }
    lua_settop(L, top);
}

static void read_axis(script *s, const place *p, sweep_axis *a) {
    lua_State *L = s->L;
    int list = lua_gettop(L), count = read_list(s, list, p, SWEEP_VALUES, "a list of values: sigma_c = { 10, 20, 40 }");
    for (int i = 1; i <= count; i++) {
        place at = place_index(p, i);
        lua_rawgeti(L, list, i);
        a->count += read_setting(s, -1, &at, a->value[i - 1]);
        lua_pop(L, 1);
    }
    if (count == 0) problem_place(s, p, "a list of at least one value", "none", NULL);
}

static void read_axes(script *s, int index, const place *p, sweep *out) {
    lua_State *L = s->L;
    int top = lua_gettop(L), count = push_named(s, index, p, "over", "a table of at most 8 lists: over = { sigma_c = { 10, 20 }, … }", SWEEP_AXES);
    if (count == 0) problem_place(s, p, "at least one list of values", "none", NULL);
    double runs = 1;
    for (int i = 1; i <= count; i++) {
        sweep_axis *a = &out->axes[out->axis_count++];
        lua_rawgeti(L, top + 2, i);
        snprintf(a->name, sizeof a->name, "%s", lua_tostring(L, -1));
        place at = place_key(p, a->name);
        lua_rawget(L, top + 1);
        read_axis(s, &at, a);
        lua_pop(L, 1);
        runs *= a->count;
    }
    if (runs > SWEEP_RUNS) problem_place(s, p, "at most 4096 runs", "more", NULL);
    lua_settop(L, top);
}

/* A path of the script's folder, unless it says where it is. */
static void place_scene(const char *file, const char *name, char out[SWEEP_PATH]) {
    const char *slash = strrchr(file, '/');
    if (name[0] == '/' || !slash) snprintf(out, SWEEP_PATH, "%s", name);
    else snprintf(out, SWEEP_PATH, "%.*s/%s", (int)(slash - file), file, name);
}

void read_sweep(lua_State *L, const char *path, const char *file, void *to) {
    sweep *out = to;
    script *s = script_of(L);
    int table = lua_gettop(L);
    char found[80];
    place returned = {.file = file};
    describe_value(L, table, found, sizeof found);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_SWEEP);
    lua_pushvalue(L, table);
    if (lua_isnil(L, table) || lua_rawget(L, -2) == LUA_TNIL) throw_place(L, &returned, "a file that returns s.sweep { … }", found, NULL);
    place p = {.file = file, .line = (int)lua_tointeger(L, -1), .call = "sweep"};
    lua_settop(L, table);
    sweep_words w = {.frames = -1};
    field fields[] = {{.key = "scene", .kind = FIELD_TEXT, .required = true, .text = w.scene},
                      {.key = "over", .kind = FIELD_OTHER, .required = true},
                      {.key = "set", .kind = FIELD_OTHER},
                      {.key = "title", .kind = FIELD_TEXT, .text = w.title},
                      {.key = "recipe", .kind = FIELD_TEXT, .text = w.recipe},
                      {.key = "frames", .kind = FIELD_REAL, .number = &w.frames, .minimum = 0, .maximum = 1e9}};
    *out = (sweep){.frames = -1};
    bool fine = read_fields(s, table, &p, fields, 6);
    place over = place_key(&p, "over"), set = place_key(&p, "set");
    if (fields[1].given) read_axes(s, table, &over, out);
    if (fields[2].given) read_fixed(s, table, &set, out);
    if (!fine) return;
    snprintf(out->title, sizeof out->title, "%s", w.title);
    snprintf(out->recipe, sizeof out->recipe, "%s", w.recipe);
    place_scene(path, w.scene, out->scene);
    if (fields[5].given) out->frames = (int64_t)w.frames;
}
