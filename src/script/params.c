/* s.params, s.choice, and the values that --set and a resolved-parameters text bring. */
#include "script/internal.h"

#include "base/names.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- overrides --------------------------------------------------------------------------------------------------- */

static void throw_setting(lua_State *L, const char *key, const char *expected, const char *found) {
    script *s = script_of(L);
    char name[128];
    snprintf(name, sizeof name, "--set %.100s", key);
    report r;
    report_input(&r, s->sources[0].display, 0, name, expected, found, NULL);
    throw_report(L, &r);
}

static void add_override(lua_State *L, const char *key, const char *value, bool pinned) {
    script *s = script_of(L);
    if (s->override_count == SCRIPT_SETTINGS) throw_setting(L, key, "at most 512 settings", "more");
    if (strlen(key) >= SCRIPT_TEXT) throw_setting(L, key, "a key of at most 127 bytes", "a longer one");
    if (strlen(value) >= SCRIPT_TEXT) throw_setting(L, key, "a value of at most 127 bytes", "a longer one");
    script_override *o = &s->overrides[s->override_count];
    *o = (script_override){arena_copy_string(s->memory, key), arena_copy_string(s->memory, value), pinned, false};
    if (!o->key || !o->value) throw_memory(L);
    s->override_count++;
}

/* The text of script_resolved: a table of numbers and texts, read in a world without names. */
static void add_pinned(lua_State *L, const char *text) {
    script *s = script_of(L);
    int top = lua_gettop(L);
    place p = {.file = s->sources[0].display, .call = "resolved parameters"};
    int outcome = luaL_loadbufferx(L, text, strlen(text), "=resolved", "t");
    guard_settle(&s->guard, outcome);
    guard_raise(L);
    if (outcome != LUA_OK) throw_place(L, &p, "valid Lua", lua_tostring(L, -1), NULL);
    lua_newtable(L);
    lua_setupvalue(L, -2, 1);
    lua_call(L, 0, 1);
    if (lua_type(L, -1) != LUA_TTABLE) throw_place(L, &p, "a table of values", luaL_typename(L, -1), NULL);
    int table = lua_gettop(L), count = push_sorted_names(s, table, &p);
    for (int i = 1; i <= count; i++) {
        lua_rawgeti(L, table + 1, i);
        lua_pushvalue(L, -1);
        lua_rawget(L, table);
        char number[40];
        snprintf(number, sizeof number, "%.17g", lua_tonumber(L, -1));
        bool is_number = lua_type(L, -1) == LUA_TNUMBER;
        if (!is_number && lua_type(L, -1) != LUA_TSTRING)
            throw_place(L, &p, "a number or a text", luaL_typename(L, -1), NULL);
        add_override(L, lua_tostring(L, -2), is_number ? number : lua_tostring(L, -1), true);
        lua_pop(L, 2);
    }
    lua_settop(L, top);
}

void overrides_prepare(lua_State *L, const script_options *options) {
    script *s = script_of(L);
    if (options->resolved) add_pinned(L, options->resolved);
    for (int i = 0; i < options->setting_count; i++)
        add_override(L, options->settings[i].key, options->settings[i].value, false);
    /* math.random may be called before the scene's seed is read. */
    for (int i = 0; i < s->override_count; i++) {
        if (strcmp(s->overrides[i].key, "seed") != 0) continue;
        plain_value v = plain_from_text(s->overrides[i].value);
        char expected[256];
        const char *nearest;
        scene_key_set(s->scene, scene_key_find("seed"), &v, expected, sizeof expected, &nearest);
    }
}

/* ---- s.choice ---------------------------------------------------------------------------------------------------- */

/* core.choice(names): the same table, marked. */
int api_choice(lua_State *L) {
    script *s = script_of(L);
    luaL_checkstack(L, API_STACK, "choices");
    place here = s->here;
    lua_settop(L, 1);
    int count = read_list(s, 1, &here, 64, "a list of names");
    if (count == 0) problem_place(s, &here, "at least one name", "none", NULL);
    for (int i = 1; i <= count; i++) {
        place at = place_index(&here, i);
        plain_rule rule = {.kind = PLAIN_TEXT};
        plain_value v;
        lua_rawgeti(L, 1, i);
        if (!read_plain(s, -1, &at, &rule, &v)) count = -1;
        lua_pop(L, 1);
    }
    if (count <= 0) {
        lua_settop(L, 0);
        lua_newtable(L);
        lua_pushliteral(L, "");
        lua_rawseti(L, 1, 1);
    }
    luaL_setmetatable(L, META_CHOICE);
    return 1;
}

static bool is_choice(lua_State *L, int index) {
    if (!lua_istable(L, index) || !lua_getmetatable(L, index)) return false;
    luaL_getmetatable(L, META_CHOICE);
    bool same = lua_rawequal(L, -1, -2);
    lua_pop(L, 2);
    return same;
}

/* The names of a choice at `index`, copied to the arena, NULL-terminated. */
static const char *const *copy_choices(script *s, int index, int *count) {
    *count = (int)lua_rawlen(s->L, index);
    const char **names = arena_allocate(s->memory, ((size_t)*count + 1) * sizeof *names);
    if (!names) throw_memory(s->L);
    for (int i = 0; i < *count; i++) {
        lua_rawgeti(s->L, index, i + 1);
        names[i] = arena_copy_string(s->memory, lua_tostring(s->L, -1));
        if (!names[i]) throw_memory(s->L);
        lua_pop(s->L, 1);
    }
    return names;
}

/* ---- s.params ---------------------------------------------------------------------------------------------------- */

/* { default, unit =, doc =, min =, max = } on top of the stack: leaves the default there. */
static bool read_description(script *s, declaration *d, const place *p) {
    lua_State *L = s->L;
    int table = lua_gettop(L);
    char unit[SCRIPT_TEXT] = "", doc[SCRIPT_TEXT] = "";
    /* The default is the one item without a name: read_fields sees the rest. */
    lua_rawgeti(L, table, 1);
    int value = lua_gettop(L);
    lua_newtable(L);
    lua_pushnil(L);
    while (lua_next(L, table)) {
        bool item = lua_isinteger(L, -2) && lua_tointeger(L, -2) == 1;
        lua_pushvalue(L, -2);
        lua_insert(L, -2);
        if (item)
            lua_pop(L, 2);
        else
            lua_rawset(L, value + 1);
    }
    field fields[] = {{.key = "unit", .kind = FIELD_TEXT, .text = unit},
                      {.key = "doc", .kind = FIELD_TEXT, .text = doc},
                      {.key = "min", .kind = FIELD_REAL, .number = &d->minimum},
                      {.key = "max", .kind = FIELD_REAL, .number = &d->maximum}};
    bool fine = read_fields(s, -1, p, fields, 4);
    lua_pop(L, 1);
    lua_replace(L, table);
    snprintf(d->shown.unit, sizeof d->shown.unit, "%s", unit);
    snprintf(d->shown.doc, sizeof d->shown.doc, "%s", doc);
    if (fine && d->minimum > d->maximum) {
        problem_place(s, p, "min at most max", "min above max", NULL);
        fine = false;
    }
    return fine;
}

static plain_rule declared_rule(const declaration *d) {
    return (plain_rule){.kind = d->kind, .minimum = d->minimum, .maximum = d->maximum, .choices = d->choices};
}

static void keep_value(declaration *d, const plain_value *v) {
    d->shown.is_text = d->kind != PLAIN_NUMBER;
    d->shown.number = v->number[0];
    if (d->kind == PLAIN_TEXT) snprintf(d->shown.text, sizeof d->shown.text, "%s", v->text);
    if (d->kind == PLAIN_BOOLEAN)
        snprintf(d->shown.text, sizeof d->shown.text, "%s", v->number[0] != 0 ? "true" : "false");
}

/* The default on top of the stack: what kind the parameter is. */
static bool read_default(script *s, declaration *d, const place *p) {
    lua_State *L = s->L;
    if (is_choice(L, -1)) {
        d->choices = copy_choices(s, lua_gettop(L), &d->choice_count);
        lua_rawgeti(L, -1, 1);
        lua_replace(L, -2);
    }
    plain_value v = plain_from_lua(L, -1);
    if (v.kind != PLAIN_NUMBER && v.kind != PLAIN_BOOLEAN && v.kind != PLAIN_TEXT) {
        problem_place(s, p, "a number, a text, true, false, s.choice { … } or { default, unit =, doc =, min =, max = }",
                      v.found, NULL);
        return false;
    }
    d->kind = v.kind;
    plain_rule rule = declared_rule(d);
    plain_value fitted;
    if (!read_plain(s, -1, p, &rule, &fitted)) return false;
    keep_value(d, &fitted);
    return true;
}

/* Applies the last override of this name, if there is one. */
static void apply_overrides(script *s, declaration *d) {
    for (int i = 0; i < s->override_count; i++) {
        script_override *o = &s->overrides[i];
        if (strcmp(o->key, d->name) != 0) continue;
        o->used = true;
        plain_value v = plain_from_text(o->value);
        plain_rule rule = declared_rule(d);
        char expected[256], key[160];
        const char *nearest;
        if (plain_fit(&v, &rule, expected, sizeof expected, &nearest)) {
            keep_value(d, &v);
            d->shown.from_set = d->shown.from_set || !o->pinned;
            continue;
        }
        snprintf(key, sizeof key, "%s %s", o->pinned ? "resolved" : "--set", o->key);
        report r;
        report_input(&r, d->file, d->line, key, expected, v.found, nearest);
        problem_report(s, &r);
    }
}

/* Leaves the value, in the default's Lua type, in place of what is on top. */
static void replace_by_value(lua_State *L, const declaration *d) {
    bool whole = lua_isinteger(L, -1) && floor(d->shown.number) == d->shown.number && fabs(d->shown.number) < 9e15;
    lua_pop(L, 1);
    switch (d->kind) {
    case PLAIN_BOOLEAN: lua_pushboolean(L, strcmp(d->shown.text, "true") == 0); break;
    case PLAIN_TEXT: lua_pushstring(L, d->shown.text); break;
    default:
        if (whole)
            lua_pushinteger(L, (lua_Integer)d->shown.number);
        else
            lua_pushnumber(L, d->shown.number);
    }
}

/* A standard name in s.params acts on the scene. */
static void apply_to_scene(script *s, const declaration *d, const place *p) {
    int key = scene_key_find(d->name);
    if (key < 0) return;
    plain_value v = {.kind = d->kind, .number = {d->shown.number}};
    snprintf(v.text, sizeof v.text, "%s", d->shown.text);
    if (d->kind == PLAIN_NUMBER)
        snprintf(v.found, sizeof v.found, "%.14g", d->shown.number);
    else
        snprintf(v.found, sizeof v.found, "'%s'", d->shown.text);
    char expected[256];
    const char *nearest;
    if (!scene_key_set(s->scene, key, &v, expected, sizeof expected, &nearest))
        problem_place(s, p, expected, v.found, nearest);
    s->scene_keys_declared |= (uint64_t)1 << key;
}

static bool name_fits(const char *name) {
    size_t good = strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_");
    return good == strlen(name) && good > 0 && good < 64 && !(name[0] >= '0' && name[0] <= '9');
}

/* The entry on top of the stack becomes its value. */
static void declare(script *s, const char *name, const place *p) {
    lua_State *L = s->L;
    for (int i = 0; i < s->declared_count; i++)
        if (strcmp(s->declared[i].name, name) == 0)
            throw_place(L, p, "a parameter that is declared once", "a second declaration", NULL);
    if (s->declared_count == SCRIPT_DECLARED) throw_place(L, p, "at most 96 parameters", "more", NULL);
    if (!name_fits(name)) problem_place(s, p, "a name of letters, digits and '_', at most 63", name, NULL);
    declaration *d = &s->declared[s->declared_count];
    *d = (declaration){.minimum = -HUGE_VAL, .maximum = HUGE_VAL, .file = p->file, .line = place_line(s, p)};
    snprintf(d->name, sizeof d->name, "%s", name);
    snprintf(d->shown.name, sizeof d->shown.name, "%s", name);
    bool fine = true;
    if (lua_istable(L, -1) && !is_choice(L, -1)) fine = read_description(s, d, p);
    if (!read_default(s, d, p) || !fine) return;
    s->declared_count++;
    apply_overrides(s, d);
    replace_by_value(L, d);
    apply_to_scene(s, d, p);
}

/* core.params(declared): a read-only table of values. */
int api_params(lua_State *L) {
    script *s = script_of(L);
    luaL_checkstack(L, API_STACK, "parameters");
    place here = s->here;
    lua_settop(L, 1);
    if (!read_table(s, 1, &here, "a table of parameters")) {
        lua_settop(L, 0);
        lua_newtable(L);
    }
    lua_newtable(L);
    int values = lua_gettop(L), count = push_sorted_names(s, 1, &here);
    for (int i = 1; i <= count; i++) {
        lua_rawgeti(L, values + 1, i);
        const char *name = lua_tostring(L, -1);
        place at = place_key(&here, name);
        lua_pushvalue(L, -1);
        lua_pushvalue(L, -1);
        lua_rawget(L, 1);
        declare(s, name, &at);
        lua_rawset(L, values);
        lua_pop(L, 1);
    }
    lua_settop(L, values);
    push_read_only(L, "the declared parameters");
    return 1;
}
