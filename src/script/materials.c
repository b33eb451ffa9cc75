/* Materials and the parameters of effects, read by the effects' own tables. */
#include "script/internal.h"

#include "base/names.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Where the parts of a material were written: the table itself, and the overrides that a recipe was called with. */
typedef struct material_origin {
    place base;
    place call;
    int overrides; /* stack slot, 0 for none */
    char name[64]; /* the recipe's, or empty */
} material_origin;

static const effect *catalogue_entry(int index) {
    int count;
    return effect_catalogue(&count)[index];
}

/* Of bodies of one kind: an effect of their engine before one of the same name of the other. */
static int find_effect(engine_kind engine, const char *name) {
    int own = effect_index_of(engine, name);
    return own >= 0 ? own : effect_index(name);
}

/* ---- one parameter ----------------------------------------------------------------------------------------------- */

static plain_rule parameter_rule(const parameter *p) {
    plain_rule rule = {.kind = PLAIN_NUMBER, .minimum = p->minimum, .maximum = p->maximum};
    if (p->kind == PARAMETER_VECTOR) rule.kind = PLAIN_VECTOR;
    if (p->kind == PARAMETER_BOOLEAN) rule.kind = PLAIN_BOOLEAN;
    if (p->kind == PARAMETER_CHOICE) rule.kind = PLAIN_TEXT, rule.choices = p->choices;
    return rule;
}

bool set_effect_parameter(const effect *e, int key, plain_value *v, effect_values *values, char *expected, size_t size,
                          const char **nearest) {
    plain_rule rule = parameter_rule(&e->parameters[key]);
    if (!plain_fit(v, &rule, expected, size, nearest)) return false;
    memcpy(values->value[key], v->number, sizeof values->value[key]);
    values->given[key] = true;
    return true;
}

/* Whether a parameter, or the density, is written as a function of place; it is then kept with its material. */
static bool read_variation(script *s, int index, const place *p, int effect_at, int key, scene_material *m) {
    if (!m || !lua_isfunction(s->L, index)) return false;
    if (m->variation_count == SCENE_VARIATIONS) {
        problem_place(s, p, "at most 8 functions of place in a material", "more", NULL);
        return true;
    }
    scene_variation *v = &m->variations[m->variation_count++];
    *v = (scene_variation){.effect = effect_at, .key = key};
    make_callback(s, index, p, 1, &v->function);
    return true;
}

static void read_parameter(script *s, int index, const place *p, const effect *e, int key, effect_values *values, scene_material *m) {
    values->given[key] = true; /* wrong or not, it was said: it is not missing as well */
    if (e->parameters[key].scale && read_variation(s, index, p, effect_index_of(e->engine, e->name), key, m)) return;
    plain_value v = plain_from_lua(s->L, index);
    char expected[256];
    const char *nearest;
    if (!set_effect_parameter(e, key, &v, values, expected, sizeof expected, &nearest))
        problem_place(s, p, expected, v.found, nearest);
}

/* ---- one effect -------------------------------------------------------------------------------------------------- */

static int short_form(const effect *e) {
    for (int i = 0; i < e->parameter_count; i++)
        if (e->parameters[i].short_form) return i;
    return -1;
}

static void list_keys(const effect *e, char *text, size_t size) {
    size_t used = (size_t)snprintf(text, size, "a table with keys of '%s' (", e->name);
    for (int i = 0; i < e->parameter_count && used < size; i++)
        used += (size_t)snprintf(text + used, size - used, "%s%s", i ? ", " : "", e->parameters[i].key);
    if (used < size) snprintf(text + used, size - used, "), true or false");
}

/* The keys of a table, by name. `origin` tells which of them came as overrides; NULL when there are none. */
static void read_effect_table(script *s, int index, const place *p, const material_origin *origin, const effect *e,
                              effect_values *values, scene_material *m) {
    lua_State *L = s->L;
    int names = push_sorted_names(s, index, p), list = lua_gettop(L);
    const char *keys[PARAMETER_LIMIT];
    for (int i = 0; i < e->parameter_count; i++) keys[i] = e->parameters[i].key;
    for (int i = 1; i <= names; i++) {
        lua_rawgeti(L, list, i);
        const char *name = lua_tostring(L, -1);
        place at = place_key(p, name);
        if (origin && origin->overrides) {
            bool overridden = lua_getfield(L, origin->overrides, e->name) == LUA_TTABLE &&
                              (lua_pushstring(L, name), lua_rawget(L, -2)) != LUA_TNIL;
            lua_settop(L, list + 1);
            place call = place_key(&origin->call, e->name);
            if (overridden) at = place_key(&call, name);
        }
        int key = effect_parameter(e, name);
        char expected[256];
        list_keys(e, expected, sizeof expected);
        lua_pushvalue(L, -1);
        lua_rawget(L, index);
        if (key >= 0)
            read_parameter(s, -1, &at, e, key, values, m);
        else
            problem_place(s, &at, expected, "a key that does not exist", name_nearest(name, keys, e->parameter_count));
        lua_settop(L, list);
    }
    lua_settop(L, list - 1);
}

static void read_effect_from(script *s, int index, const place *p, const material_origin *origin, const effect *e,
                             effect_values *values, effect_site *site, scene_material *m) {
    lua_State *L = s->L;
    index = lua_absindex(L, index);
    *site = (effect_site){p->file, place_line(s, p)};
    plain_value v = plain_from_lua(L, index);
    int bare = short_form(e);
    bool listed = lua_istable(L, index) && lua_rawgeti(L, index, 1) != LUA_TNIL;
    lua_settop(L, lua_gettop(L) - lua_istable(L, index));
    values->on = true;
    if (v.kind == PLAIN_BOOLEAN) {
        values->on = v.number[0] != 0;
    } else if (bare >= 0 && (!lua_istable(L, index) || listed)) {
        read_parameter(s, index, p, e, bare, values, m);
    } else {
        char expected[256];
        list_keys(e, expected, sizeof expected);
        if (read_table(s, index, p, expected)) read_effect_table(s, index, p, origin, e, values, m);
    }
}

void read_effect(script *s, int index, const place *p, const effect *e, effect_values *values, effect_site *site) {
    read_effect_from(s, index, p, NULL, e, values, site, NULL);
}

/* ---- one material ------------------------------------------------------------------------------------------------ */

/* Records a key that no material has: the nearest among effects and, as "effect.key", among their keys. */
static void report_unknown(script *s, const place *p, const char *name) {
    const char *candidates[2 + EFFECT_LIMIT * (PARAMETER_LIMIT + 1)] = {"density", "name"};
    const effect *owners[2 + EFFECT_LIMIT * (PARAMETER_LIMIT + 1)] = {NULL};
    int count = 2, effects;
    const effect *const *all = effect_catalogue(&effects);
    for (int e = 0; e < effects; e++) {
        if (all[e]->scope != SCOPE_MATERIAL) continue;
        candidates[count++] = all[e]->name;
        for (int k = 0; k < all[e]->parameter_count; k++)
            owners[count] = all[e], candidates[count++] = all[e]->parameters[k].key;
    }
    const char *nearest = name_nearest(name, candidates, count);
    char dotted[128] = "";
    for (int i = 0; nearest && i < count; i++)
        if (candidates[i] == nearest && owners[i]) snprintf(dotted, sizeof dotted, "%s.%s", owners[i]->name, nearest);
    int scene_effect = effect_index(name);
    if (scene_effect >= 0)
        problem_place(s, p, "an effect of materials", "an effect that belongs to the scene itself", NULL);
    else
        problem_place(s, p, "density, name, or an effect of materials", "a key that does not exist",
                      *dotted ? dotted : nearest);
}

static void read_density(script *s, int index, const place *p, scene_material *m) {
    if (read_variation(s, index, p, -1, 0, m)) return;
    plain_rule rule = {.kind = PLAIN_NUMBER, .minimum = 0, .maximum = HUGE_VAL, .above = true};
    plain_value v;
    if (read_plain(s, index, p, &rule, &v)) m->density = v.number[0];
}

/* The place of a key of the material: in the overrides if they say it. */
static place material_place(script *s, const material_origin *o, const char *key) {
    bool overridden = o->overrides && lua_getfield(s->L, o->overrides, key) != LUA_TNIL;
    if (o->overrides) lua_pop(s->L, 1);
    return place_key(overridden ? &o->call : &o->base, key);
}

static bool name_taken(const scene *sc, const char *name) {
    for (int i = 0; i < sc->material_count; i++)
        if (strcmp(sc->materials[i].name, name) == 0) return true;
    return false;
}

/* A name of its own for dotted paths: "tube", "tube_2" … Dots and blanks would not be paths. */
static void name_material(const scene *sc, scene_material *m, const char *wanted) {
    char base[48];
    snprintf(base, sizeof base, "%.47s", *wanted ? wanted : "material");
    for (char *c = base; *c; c++)
        if (strchr(". =,", *c)) *c = '_';
    snprintf(m->name, sizeof m->name, "%s", base);
    for (int number = 2; name_taken(sc, m->name); number++) snprintf(m->name, sizeof m->name, "%s_%d", base, number);
}

static void read_material_key(script *s, const char *name, engine_kind engine, const material_origin *o, scene_material *m, int index,
                              char wanted[SCRIPT_TEXT]) {
    lua_State *L = s->L;
    place p = material_place(s, o, name);
    lua_pushstring(L, name);
    lua_rawget(L, index);
    int e = find_effect(engine, name), row = (int)(m - s->scene->materials);
    if (strcmp(name, "density") == 0) {
        read_density(s, -1, &p, m);
    } else if (strcmp(name, "name") == 0) {
        plain_rule rule = {.kind = PLAIN_TEXT};
        plain_value v;
        if (read_plain(s, -1, &p, &rule, &v)) snprintf(wanted, SCRIPT_TEXT, "%s", v.text);
    } else if (e >= 0 && catalogue_entry(e)->scope == SCOPE_MATERIAL) {
        read_effect_from(s, -1, &p, o, catalogue_entry(e), &m->effects[e], &s->sites[row][e], m);
    } else {
        report_unknown(s, &p, name);
    }
    lua_pop(L, 1);
}

/* What push_recipe noted about the table at `index`; pushes the overrides if there are any. */
static material_origin find_origin(script *s, int index, const place *p) {
    lua_State *L = s->L;
    material_origin o = {.base = *p};
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_ORIGINS);
    lua_pushvalue(L, index);
    if (lua_rawget(L, -2) == LUA_TNIL) {
        lua_pop(L, 2);
        return o;
    }
    int origin = lua_gettop(L);
    lua_getfield(L, origin, "name");
    lua_getfield(L, origin, "file");
    lua_getfield(L, origin, "caller");
    lua_getfield(L, origin, "line");
    snprintf(o.name, sizeof o.name, "%s", lua_tostring(L, origin + 1));
    const source_file *file = find_source(s, lua_tostring(L, origin + 2));
    const source_file *caller = lua_isnil(L, origin + 3) ? NULL : find_source(s, lua_tostring(L, origin + 3));
    o.base = (place){.file = file->display};
    o.call =
        (place){.file = caller ? caller->display : NULL, .line = (int)lua_tointeger(L, origin + 4), .call = "recipe"};
    lua_settop(L, origin);
    if (lua_getfield(L, origin, "overrides") == LUA_TTABLE) o.overrides = lua_gettop(L);
    return o;
}

/* The table at `index` becomes the next material of the scene. */
static int add_material(script *s, int index, const place *p, engine_kind engine, const char *body) {
    lua_State *L = s->L;
    scene *sc = s->scene;
    int top = lua_gettop(L), effects, row = sc->material_count;
    if (row == SCENE_MATERIALS) {
        problem_place(s, p, "at most 16 materials in a scene", "more", NULL);
        return -1;
    }
    if (!read_table(s, index, p, "a material: a table, or the name of a recipe")) return -1;
    scene_material *m = &sc->materials[row];
    const effect *const *all = effect_catalogue(&effects);
    for (int e = 0; e < effects; e++) effect_values_default(all[e], &m->effects[e]);
    material_origin origin = find_origin(s, index, p);
    snprintf(m->file, sizeof m->file, "%s", origin.base.file);
    m->line = place_line(s, &origin.base);
    char wanted[SCRIPT_TEXT];
    snprintf(wanted, sizeof wanted, "%s", *origin.name ? origin.name : body);
    int names = push_sorted_names(s, index, &origin.base), list = lua_gettop(L);
    bool density = false;
    for (int i = 1; i <= names; i++) {
        lua_rawgeti(L, list, i);
        const char *name = lua_tostring(L, -1);
        density = density || strcmp(name, "density") == 0;
        read_material_key(s, name, engine, &origin, m, index, wanted);
        lua_settop(L, list);
    }
    place missing = place_key(&origin.base, "density");
    if (!density) problem_place(s, &missing, "a number above 0: this key is required", "nothing", NULL);
    lua_settop(L, top);
    name_material(sc, m, wanted);
    return sc->material_count++;
}

/* Replaces a recipe's name on top of the stack by its table: the same one each time, so that it is one material. */
static void replace_by_recipe(script *s, const place *p) {
    lua_State *L = s->L;
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_MATERIALS);
    lua_pushvalue(L, -2);
    if (lua_rawget(L, -2) == LUA_TNIL) {
        lua_pop(L, 1);
        push_recipe(L, lua_tostring(L, -2), p);
        lua_pushvalue(L, -3);
        lua_pushvalue(L, -2);
        lua_rawset(L, -4);
    }
    lua_replace(L, -3);
    lua_pop(L, 1);
}

int read_material(script *s, int index, const place *p, engine_kind engine, const char *body) {
    lua_State *L = s->L;
    lua_pushvalue(L, index);
    if (lua_type(L, -1) == LUA_TSTRING) replace_by_recipe(s, p);
    int value = lua_gettop(L);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_MATERIALS);
    lua_pushvalue(L, value);
    int material = -1;
    if (lua_rawget(L, -2) != LUA_TNIL) {
        material = (int)lua_tointeger(L, -1);
    } else {
        material = add_material(s, value, p, engine, body);
        if (lua_istable(L, value)) {
            lua_pushvalue(L, value);
            lua_pushinteger(L, material);
            lua_rawset(L, value + 1);
        }
    }
    lua_settop(L, value - 1);
    return material;
}

/* ---- after reading ----------------------------------------------------------------------------------------------- */

void check_effects(script *s) {
    int count;
    const effect *const *all = effect_catalogue(&count);
    for (int row = 0; row <= SCENE_SITE; row++) {
        if (row < SCENE_SITE && row >= s->scene->material_count) continue;
        effect_values *values = row == SCENE_SITE ? s->scene->effects : s->scene->materials[row].effects;
        for (int e = 0; e < count; e++) {
            const effect_site *site = &s->sites[row][e];
            report r;
            if (values[e].on &&
                effect_values_check(all[e], &values[e], values, site->file, site->line, &r) != STATUS_OK)
                problem_report(s, &r);
        }
    }
}
