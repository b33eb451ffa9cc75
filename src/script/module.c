/* The module `sunder`: lua/sunder.lua, compiled into the program, over the functions of this floor. */
#include "script/internal.h"

#include <stdio.h>
#include <string.h>

/* The text of lua/sunder.lua, made by CMake. */
extern const unsigned char sunder_lua[];
extern const unsigned long sunder_lua_size;

/* Remembers the table at 1, as what its key says, and the line it was made on; gives it back. */
static int mark_table(lua_State *L, const void *key, const char *expected) {
    script *s = script_of(L);
    char found[80];
    describe_value(L, 1, found, sizeof found);
    if (lua_type(L, 1) != LUA_TTABLE) throw_place(L, &s->here, expected, found, NULL);
    lua_settop(L, 1);
    lua_rawgetp(L, LUA_REGISTRYINDEX, key);
    lua_pushvalue(L, 1);
    lua_pushinteger(L, s->here.line);
    lua_rawset(L, 2);
    lua_settop(L, 1);
    return 1;
}

/* core.scene(table) */
static int api_scene(lua_State *L) {
    return mark_table(L, &KEY_SCENE, "a table with the scene's keys");
}

/* core.sweep(table) */
static int api_sweep(lua_State *L) {
    return mark_table(L, &KEY_SWEEP, "a table with the sweep's keys");
}

/* core.twin(effect, key): the key of the same effect that says the same thing, or nil. */
static int api_twin(lua_State *L) {
    if (lua_type(L, 1) != LUA_TSTRING || lua_type(L, 2) != LUA_TSTRING) return 0;
    int count;
    const effect *const *all = effect_catalogue(&count);
    for (int e = 0; e < count; e++) {
        int key = strcmp(all[e]->name, lua_tostring(L, 1)) == 0 ? effect_parameter(all[e], lua_tostring(L, 2)) : -1;
        if (key < 0 || !all[e]->parameters[key].twin) continue;
        lua_pushstring(L, all[e]->parameters[key].twin);
        return 1;
    }
    return 0;
}

/* What a scene calls. Upvalues: name, the Lua function. The C frame keeps the caller's frame alive below it: `return
 * s.scene {…}` would otherwise be a tail call that leaves no line to name. */
static int call_from_scene(lua_State *L) {
    script *s = script_of(L);
    const char *name = lua_tostring(L, lua_upvalueindex(1));
    if (s->loaded) throw_here(L, name, "a pure function of time or place", "a call into sunder after loading", NULL);
    s->here = place_running(L);
    s->here.call = name;
    lua_pushvalue(L, lua_upvalueindex(2));
    lua_insert(L, 1);
    lua_call(L, lua_gettop(L) - 1, LUA_MULTRET);
    return lua_gettop(L);
}

/* Wraps every function of the table on top, and of the tables in it; the table becomes read-only. */
static void wrap_functions(lua_State *L, const char *what) {
    int module = lua_gettop(L);
    lua_newtable(L);
    lua_pushnil(L);
    while (lua_next(L, module)) {
        lua_pushvalue(L, -2);
        lua_insert(L, -2);
        if (lua_type(L, -1) == LUA_TFUNCTION) {
            lua_pushvalue(L, -2);
            lua_insert(L, -2);
            lua_pushcclosure(L, call_from_scene, 2);
        } else if (lua_type(L, -1) == LUA_TTABLE) {
            char name[64];
            snprintf(name, sizeof name, "%s.%s", what, lua_tostring(L, -2));
            wrap_functions(L, name);
        }
        lua_rawset(L, module + 1);
    }
    push_read_only(L, what);
    lua_replace(L, module);
}

/* a + b, a * b, a - b, and methods: the module's functions that take a shape first. */
static void set_operators(lua_State *L, int module) {
    static const char *const operators[][2] = {{"__add", "union"}, {"__mul", "intersection"}, {"__sub", "difference"}};
    static const char *const methods[] = {"union", "intersection", "difference", "translate", "rotate", "scale"};
    luaL_getmetatable(L, META_SHAPE);
    for (size_t i = 0; i < sizeof operators / sizeof *operators; i++) {
        lua_getfield(L, module, operators[i][1]);
        lua_setfield(L, -2, operators[i][0]);
    }
    lua_newtable(L);
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        lua_getfield(L, module, methods[i]);
        lua_setfield(L, -2, methods[i]);
    }
    push_read_only(L, "shapes");
    lua_setfield(L, -2, "__index");
    lua_pop(L, 1);
}

void module_open(lua_State *L) {
    static const luaL_Reg core[] = {
        {"params", api_params}, {"choice", api_choice}, {"scene", api_scene},     {"recipe", api_recipe},
        {"twin", api_twin},     {"shape", api_shape},   {"combine", api_combine}, {"translate", api_translate},
        {"rotate", api_rotate}, {"scale", api_scale},   {"fibres", api_fibres},   {"mesh", api_mesh},
        {"sweep", api_sweep},
        {NULL, NULL},
    };
    int base = lua_gettop(L);
    lua_newtable(L);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &KEY_SCENE);
    lua_newtable(L);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &KEY_SWEEP);
    int outcome = luaL_loadbufferx(L, (const char *)sunder_lua, sunder_lua_size, "=sunder", "t");
    if (outcome == LUA_ERRMEM) throw_memory(L);
    if (outcome != LUA_OK) lua_error(L);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_ENVIRONMENT);
    lua_setupvalue(L, -2, 1);
    luaL_newlib(L, core);
    lua_call(L, 1, 1);
    wrap_functions(L, "sunder");
    set_operators(L, base + 1);
}
