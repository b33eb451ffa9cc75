/* The world that a scene sees: safe libraries, globals that know their names, nothing that reaches outside.
 *
 * Library tables are wrapped: an empty table whose metatable reads through to the contents and refuses writes. The
 * globals are wrapped the same way, except that writes go through until the scene is loaded. Reading a name that does
 * not exist is an error with the nearest one. No finalisers (they run without hooks), no weak tables (what is left in
 * them depends on the collector), no coroutines (each would need the hooks again). */
#include "script/internal.h"

#include "base/names.h"
#include "base/random.h"

#include <lualib.h>
#include <stdio.h>
#include <string.h>

const char KEY_FROZEN, KEY_ENVIRONMENT, KEY_GLOBALS, KEY_MODULES, KEY_RECIPES, KEY_ORIGINS, KEY_MATERIALS, KEY_SCENE, KEY_SWEEP,
    KEY_FUNCTIONS, KEY_WATCHED;

/* ---- wrapped tables ---------------------------------------------------------------------------------------------- */

void push_contents(lua_State *L, int index) {
    index = lua_absindex(L, index);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_FROZEN);
    lua_pushvalue(L, index);
    if (lua_rawget(L, -2) == LUA_TNIL) {
        lua_pop(L, 1);
        lua_pushvalue(L, index);
    }
    lua_remove(L, -2);
}

static bool is_wrapped(lua_State *L, int index) {
    push_contents(L, index);
    bool wrapped = !lua_rawequal(L, index, -1);
    lua_pop(L, 1);
    return wrapped;
}

/* Nearest name among the string keys of the table at `index`. */
static const char *nearest_key(lua_State *L, int index, const char *name) {
    enum { MOST = 256 };
    const char *names[MOST];
    int count = 0;
    lua_pushnil(L);
    while (lua_next(L, index)) {
        lua_pop(L, 1);
        if (lua_type(L, -1) == LUA_TSTRING && count < MOST) names[count++] = lua_tostring(L, -1);
    }
    return name_nearest(name, names, count);
}

/* __index of contents: (contents, key) for a key that is not there. Upvalue 1: what the table is. */
static int missing_name(lua_State *L) {
    static const char *const absent[] = {"os", "io", "debug", "package", "coroutine", "dofile", "loadfile"};
    const char *what = lua_tostring(L, lua_upvalueindex(1));
    char expected[160], found[160];
    snprintf(expected, sizeof expected, "a name that exists in %s", what);
    describe_value(L, 2, found, sizeof found);
    if (lua_type(L, 2) != LUA_TSTRING) throw_here(L, what, expected, found, NULL);
    const char *name = lua_tostring(L, 2);
    for (size_t i = 0; i < sizeof absent / sizeof *absent; i++)
        if (strcmp(name, absent[i]) == 0)
            throw_here(L, name, "what a scene may use: string, table, math, utf8, sunder",
                       "a library that the sandbox has not", NULL);
    throw_here(L, name, expected, found, nearest_key(L, 1, name));
}

static int refuse_write(lua_State *L) {
    char expected[160], key[80];
    snprintf(expected, sizeof expected, "no write to %s: it is read-only", lua_tostring(L, lua_upvalueindex(1)));
    describe_value(L, 2, key, sizeof key);
    throw_here(L, key, expected, "an assignment", NULL);
}

void push_read_only(lua_State *L, const char *what) {
    int contents = lua_gettop(L);
    lua_newtable(L); /* the contents' metatable */
    lua_pushstring(L, what);
    lua_pushcclosure(L, missing_name, 1);
    lua_setfield(L, -2, "__index");
    lua_setmetatable(L, contents);

    lua_newtable(L); /* the wrapper */
    lua_newtable(L);
    lua_pushvalue(L, contents);
    lua_setfield(L, -2, "__index");
    lua_pushstring(L, what);
    lua_pushcclosure(L, refuse_write, 1);
    lua_setfield(L, -2, "__newindex");
    lua_pushboolean(L, 0);
    lua_setfield(L, -2, "__metatable");
    lua_setmetatable(L, -2);

    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_FROZEN);
    lua_pushvalue(L, -2);
    lua_pushvalue(L, contents);
    lua_rawset(L, -3);
    lua_pop(L, 1);
    lua_replace(L, contents);
}

/* ---- base library ------------------------------------------------------------------------------------------------ */

static int sandbox_setmetatable(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    int kind = lua_type(L, 2);
    luaL_argexpected(L, kind == LUA_TNIL || kind == LUA_TTABLE, 2, "nil or table");
    if (luaL_getmetafield(L, 1, "__metatable") != LUA_TNIL) return luaL_error(L, "cannot change a protected metatable");
    static const char *const refused[] = {"__gc", "__mode"};
    for (size_t i = 0; kind == LUA_TTABLE && i < sizeof refused / sizeof *refused; i++) {
        lua_pushstring(L, refused[i]);
        if (lua_rawget(L, 2) != LUA_TNIL) return luaL_error(L, "a scene's metatables have no '%s'", refused[i]);
        lua_pop(L, 1);
    }
    lua_settop(L, 2);
    lua_setmetatable(L, 1);
    return 1;
}

static int sandbox_rawget(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    luaL_checkany(L, 2);
    lua_settop(L, 2);
    push_contents(L, 1);
    lua_replace(L, 1);
    lua_rawget(L, 1);
    return 1;
}

static int sandbox_rawset(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    luaL_checkany(L, 2);
    luaL_checkany(L, 3);
    lua_settop(L, 3);
    if (is_wrapped(L, 1)) return luaL_error(L, "this table is read-only");
    lua_rawset(L, 1);
    return 1;
}

static int sandbox_rawlen(lua_State *L) {
    int kind = lua_type(L, 1);
    luaL_argexpected(L, kind == LUA_TTABLE || kind == LUA_TSTRING, 1, "table or string");
    push_contents(L, 1);
    lua_pushinteger(L, (lua_Integer)lua_rawlen(L, -1));
    return 1;
}

/* Text only, with the sandbox's globals unless an environment is given. The parser runs without hooks: not for ever. */
static int sandbox_load(lua_State *L) {
    enum { TEXT_LIMIT = 1 << 20 };
    size_t size;
    const char *text = luaL_checklstring(L, 1, &size);
    luaL_argcheck(L, size <= TEXT_LIMIT, 1, "text over 1 MiB");
    bool own_environment = !lua_isnone(L, 4);
    lua_settop(L, 4);
    int outcome = luaL_loadbufferx(L, text, size, "=(load)", "t");
    guard_settle(guard_of(L), outcome);
    guard_raise(L);
    if (outcome != LUA_OK) {
        luaL_pushfail(L);
        lua_insert(L, -2);
        return 2;
    }
    if (own_environment)
        lua_pushvalue(L, 4);
    else
        lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_ENVIRONMENT);
    if (!lua_setupvalue(L, -2, 1)) lua_pop(L, 1);
    return 1;
}

void push_text(lua_State *L, int index) {
    int kind = lua_type(L, index);
    bool plain = kind == LUA_TNIL || kind == LUA_TBOOLEAN || kind == LUA_TNUMBER || kind == LUA_TSTRING;
    if (plain || luaL_getmetafield(L, index, "__tostring") != LUA_TNIL) {
        if (!plain) lua_pop(L, 1);
        luaL_tolstring(L, index, NULL);
    } else {
        lua_pushstring(L, luaL_typename(L, index));
    }
}

static int sandbox_tostring(lua_State *L) {
    luaL_checkany(L, 1);
    push_text(L, 1);
    return 1;
}

static int sandbox_print(lua_State *L) {
    int count = lua_gettop(L);
    for (int i = 1; i <= count; i++) {
        size_t size;
        push_text(L, i);
        const char *text = lua_tolstring(L, -1, &size);
        if (i > 1) log_text(script_of(L), "\t", 1);
        log_text(script_of(L), text, size);
        lua_pop(L, 1);
    }
    log_text(script_of(L), "\n", 1);
    return 0;
}

static int sandbox_collectgarbage(lua_State *L) {
    const char *option = luaL_optstring(L, 1, "collect");
    if (strcmp(option, "count") != 0) return luaL_error(L, "collectgarbage knows only \"count\" in a scene");
    if (script_of(L)->loaded)
        throw_here(L, "collectgarbage", "a pure function of time or place", "a look at memory", NULL);
    lua_pushnumber(L, (double)guard_of(L)->used / 1024.0);
    return 1;
}

/* ---- math.random ------------------------------------------------------------------------------------------------- */

enum { RANDOM_STREAM = 0x5c3a };

/* Counter-based, so that the nth draw depends on the seed alone. Not after loading: a function of time or place that
 * draws would depend on how often it was called. */
static int sandbox_random(lua_State *L) {
    script *s = script_of(L);
    if (s->loaded)
        throw_here(L, "math.random", "a pure function of time or place", "a random draw after loading", NULL);
    uint64_t bits = random_bits(s->scene->seed, RANDOM_STREAM, s->random_count++);
    int arguments = lua_gettop(L);
    if (arguments == 0) {
        lua_pushnumber(L, (double)(bits >> 11) * 0x1p-53);
        return 1;
    }
    lua_Integer low = arguments > 1 ? luaL_checkinteger(L, 1) : 1;
    lua_Integer high = luaL_checkinteger(L, arguments > 1 ? 2 : 1);
    luaL_argcheck(L, low <= high, arguments > 1 ? 2 : 1, "interval is empty");
    uint64_t span = (uint64_t)high - (uint64_t)low + 1; /* 0: all 2^64 */
    uint64_t offset = span == 0 ? bits : (uint64_t)(((unsigned __int128)bits * span) >> 64);
    lua_pushinteger(L, (lua_Integer)((uint64_t)low + offset));
    return 1;
}

/* ---- putting it together ----------------------------------------------------------------------------------------- */

/* __newindex of the globals. */
static int write_global(lua_State *L) {
    if (script_of(L)->loaded) {
        char key[80];
        describe_value(L, 2, key, sizeof key);
        throw_here(L, key, "a pure function: no write to a global after loading", "an assignment", NULL);
    }
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_GLOBALS);
    lua_replace(L, 1);
    lua_rawset(L, 1);
    return 0;
}

static int report_to_string(lua_State *L) {
    const report *r = luaL_checkudata(L, 1, META_REPORT);
    char text[1024];
    report_format(r, text, sizeof text);
    lua_pushstring(L, text);
    return 1;
}

static void open_metatables(lua_State *L) {
    luaL_newmetatable(L, META_REPORT);
    lua_pushcfunction(L, report_to_string);
    lua_setfield(L, -2, "__tostring");
    lua_pushboolean(L, 0);
    lua_setfield(L, -2, "__metatable");
    luaL_newmetatable(L, META_CHOICE);
    lua_pushboolean(L, 0);
    lua_setfield(L, -2, "__metatable");
    lua_pop(L, 2);
}

static void open_registry(lua_State *L) {
    const char *const plain[] = {&KEY_MODULES, &KEY_RECIPES, &KEY_MATERIALS, &KEY_FUNCTIONS, &KEY_WATCHED};
    const char *const weak[] = {&KEY_FROZEN, &KEY_ORIGINS};
    for (size_t i = 0; i < sizeof plain / sizeof *plain; i++) {
        lua_newtable(L);
        lua_rawsetp(L, LUA_REGISTRYINDEX, plain[i]);
    }
    for (size_t i = 0; i < sizeof weak / sizeof *weak; i++) {
        lua_newtable(L);
        lua_newtable(L);
        lua_pushliteral(L, "k");
        lua_setfield(L, -2, "__mode");
        lua_setmetatable(L, -2);
        lua_rawsetp(L, LUA_REGISTRYINDEX, weak[i]);
    }
}

static void copy_names(lua_State *L, int from, int to, const char *const *names) {
    for (int i = 0; names[i]; i++) {
        lua_getfield(L, from, names[i]);
        lua_setfield(L, to, names[i]);
    }
}

static void open_libraries(lua_State *L, int globals) {
    luaL_requiref(L, "string", luaopen_string, 0);
    strings_open(L, lua_gettop(L));
    push_read_only(L, "string");
    lua_setfield(L, globals, "string");

    luaL_requiref(L, "table", luaopen_table, 0);
    tables_open(L, lua_gettop(L), globals);
    push_read_only(L, "table");
    lua_setfield(L, globals, "table");

    luaL_requiref(L, "math", luaopen_math, 0);
    lua_pushcfunction(L, sandbox_random);
    lua_setfield(L, -2, "random");
    lua_pushnil(L);
    lua_setfield(L, -2, "randomseed");
    push_read_only(L, "math");
    lua_setfield(L, globals, "math");

    luaL_requiref(L, "utf8", luaopen_utf8, 0);
    push_read_only(L, "utf8");
    lua_setfield(L, globals, "utf8");
}

/* The wrapper of the globals: strict on reading, open to writes until the scene is loaded. */
static void open_environment(lua_State *L, int globals) {
    lua_newtable(L);
    lua_pushliteral(L, "the globals");
    lua_pushcclosure(L, missing_name, 1);
    lua_setfield(L, -2, "__index");
    lua_setmetatable(L, globals);

    lua_newtable(L);
    lua_newtable(L);
    lua_pushvalue(L, globals);
    lua_setfield(L, -2, "__index");
    lua_pushcfunction(L, write_global);
    lua_setfield(L, -2, "__newindex");
    lua_pushboolean(L, 0);
    lua_setfield(L, -2, "__metatable");
    lua_setmetatable(L, -2);
    lua_pushvalue(L, -1);
    lua_setfield(L, globals, "_G");
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_FROZEN);
    lua_pushvalue(L, -2);
    lua_pushvalue(L, globals);
    lua_rawset(L, -3);
    lua_pop(L, 1);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &KEY_ENVIRONMENT);
    lua_pushvalue(L, globals);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &KEY_GLOBALS);
}

void sandbox_open(lua_State *L) {
    static const char *const kept[] = {"assert", "error",    "getmetatable", "ipairs",   "rawequal",
                                       "select", "tonumber", "type",         "_VERSION", NULL};
    static const luaL_Reg own[] = {
        {"setmetatable", sandbox_setmetatable},
        {"rawget", sandbox_rawget},
        {"rawset", sandbox_rawset},
        {"rawlen", sandbox_rawlen},
        {"load", sandbox_load},
        {"print", sandbox_print},
        {"pcall", guard_pcall},
        {"xpcall", guard_xpcall},
        {"require", sandbox_require},
        {"collectgarbage", sandbox_collectgarbage},
        {"tostring", sandbox_tostring},
        {NULL, NULL},
    };
    open_metatables(L);
    open_registry(L);
    luaL_requiref(L, "_G", luaopen_base, 0);
    int base = lua_gettop(L);
    lua_newtable(L);
    int globals = lua_gettop(L);
    copy_names(L, base, globals, kept);
    luaL_setfuncs(L, own, 0);
    open_libraries(L, globals);
    open_environment(L, globals);
    shapes_open(L);
    fibres_open(L);
    module_open(L);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_MODULES);
    lua_insert(L, -2);
    lua_setfield(L, -2, "sunder");
    lua_settop(L, base - 1);
}
