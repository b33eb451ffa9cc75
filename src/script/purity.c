/* Keeping functions of time and place pure.
 *
 * A run is reproducible only if a function gives the same answer whenever it is asked. After loading, therefore,
 *   - globals cannot be written (sandbox.c);
 *   - every table that a callback can reach, through upvalues, globals, other functions' upvalues or other tables, is
 *     frozen: its contents move to a hidden table, and the table itself only reads through to it;
 *   - the upvalues of every Lua function that a callback can reach, and the states of the iterators that pairs and
 * gmatch make, are compared with what they were, after each call. What a call makes for itself (local variables, new
 * tables, new closures) it may change. Functions of the module sunder and of the libraries keep no state and are not
 * looked at. */
#include "script/internal.h"

#include <string.h>

/* Stack slots of the walk. */
enum { WALK_TODO = 1, WALK_SEEN, WALK_FROZEN, WALK_WATCHED };

/* Puts the value on top on the list of what is to be visited, once; pops it. */
static void enqueue(lua_State *L) {
    int kind = lua_type(L, -1);
    if (kind != LUA_TTABLE && kind != LUA_TFUNCTION) {
        lua_pop(L, 1);
        return;
    }
    lua_pushvalue(L, -1);
    if (lua_rawget(L, WALK_SEEN) != LUA_TNIL) {
        lua_pop(L, 2);
        return;
    }
    lua_pop(L, 1);
    lua_pushvalue(L, -1);
    lua_pushboolean(L, 1);
    lua_rawset(L, WALK_SEEN);
    lua_rawseti(L, WALK_TODO, (lua_Integer)lua_rawlen(L, WALK_TODO) + 1);
}

static void enqueue_contents(lua_State *L, int table) {
    lua_pushnil(L);
    while (lua_next(L, table)) {
        guard_spend(L, 4);
        enqueue(L);
        lua_pushvalue(L, -1);
        enqueue(L);
    }
}

/* ---- frozen tables ----------------------------------------------------------------------------------------------- */

static int refuse_frozen(lua_State *L) {
    char key[80];
    describe_value(L, 2, key, sizeof key);
    throw_here(L, key, "a pure function: no write to a table that was made while loading", "an assignment", NULL);
}

static int frozen_length(lua_State *L) {
    push_contents(L, 1);
    lua_pushinteger(L, luaL_len(L, -1));
    return 1;
}

/* Upvalues: contents, the original __index. */
static int frozen_index(lua_State *L) {
    lua_pushvalue(L, 2);
    if (lua_rawget(L, lua_upvalueindex(1)) != LUA_TNIL) return 1;
    lua_settop(L, 2);
    if (lua_isfunction(L, lua_upvalueindex(2))) {
        lua_pushvalue(L, lua_upvalueindex(2));
        lua_insert(L, 1);
        lua_call(L, 2, 1);
    } else {
        lua_gettable(L, lua_upvalueindex(2));
    }
    return 1;
}

/* Moves the pairs of the table at `from` to the table at `to`. */
static void move_contents(lua_State *L, int from, int to) {
    lua_pushnil(L);
    while (lua_next(L, from)) {
        guard_spend(L, 4);
        lua_pushvalue(L, -2);
        lua_insert(L, -2);
        lua_rawset(L, to);
    }
    lua_pushnil(L);
    while (lua_next(L, to)) {
        lua_pop(L, 1);
        lua_pushvalue(L, -1);
        lua_pushnil(L);
        lua_rawset(L, from);
    }
}

/* Gives the table at `table` the metatable of a frozen one, keeping the other metamethods that it had. */
static void set_frozen_metatable(lua_State *L, int table, int contents) {
    lua_newtable(L);
    int fresh = lua_gettop(L);
    bool had = lua_getmetatable(L, table);
    if (!had) lua_pushboolean(L, 0);
    int old = lua_gettop(L);
    lua_pushnil(L);
    while (had && lua_next(L, old)) {
        lua_pushvalue(L, -2);
        lua_insert(L, -2);
        lua_rawset(L, fresh);
    }
    lua_pushvalue(L, contents);
    if (luaL_getmetafield(L, table, "__index") != LUA_TNIL) lua_pushcclosure(L, frozen_index, 2);
    lua_setfield(L, fresh, "__index");
    lua_pushcfunction(L, refuse_frozen);
    lua_setfield(L, fresh, "__newindex");
    if (luaL_getmetafield(L, table, "__len") == LUA_TNIL) lua_pushcfunction(L, frozen_length);
    lua_setfield(L, fresh, "__len");
    if (luaL_getmetafield(L, table, "__metatable") == LUA_TNIL) lua_pushvalue(L, old);
    lua_setfield(L, fresh, "__metatable");
    if (had) {
        lua_pushvalue(L, old);
        enqueue(L);
    }
    lua_settop(L, fresh);
    lua_setmetatable(L, table);
}

static void freeze_table(lua_State *L, int table) {
    lua_pushvalue(L, table);
    bool wrapped = lua_rawget(L, WALK_FROZEN) != LUA_TNIL;
    if (wrapped) {
        /* A library, the module or the globals: these keep what they hold elsewhere and refuse writes already. */
        enqueue_contents(L, lua_gettop(L));
        return;
    }
    lua_newtable(L);
    int contents = lua_gettop(L);
    move_contents(L, table, contents);
    set_frozen_metatable(L, table, contents);
    lua_pushvalue(L, table);
    lua_pushvalue(L, contents);
    lua_rawset(L, WALK_FROZEN);
    enqueue_contents(L, contents);
}

/* ---- watched upvalues -------------------------------------------------------------------------------------------- */

/* Each upvalue once, though many functions may share it. */
static bool first_sight(lua_State *L, int function, int upvalue) {
    lua_pushlightuserdata(L, lua_upvalueid(L, function, upvalue));
    lua_pushvalue(L, -1);
    bool first = lua_rawget(L, WALK_SEEN) == LUA_TNIL;
    lua_pop(L, 1);
    lua_pushboolean(L, 1);
    lua_rawset(L, WALK_SEEN);
    return first;
}

/* The upvalue's value is on top: kept beside its function and number. */
static void watch(lua_State *L, int function, int upvalue) {
    lua_Integer at = (lua_Integer)lua_rawlen(L, WALK_WATCHED);
    lua_pushvalue(L, function);
    lua_rawseti(L, WALK_WATCHED, at + 1);
    lua_pushinteger(L, upvalue);
    lua_rawseti(L, WALK_WATCHED, at + 2);
    /* A list cannot hold nil: the list itself stands for it. */
    if (lua_isnil(L, -1))
        lua_pushvalue(L, WALK_WATCHED);
    else
        lua_pushvalue(L, -1);
    lua_rawseti(L, WALK_WATCHED, at + 3);
}

static void watch_function(lua_State *L, int function) {
    lua_Debug about;
    lua_CFunction ours = lua_tocfunction(L, function);
    lua_pushvalue(L, function);
    lua_getinfo(L, ">S", &about);
    bool scripted = !ours && (about.source[0] == '@' || strcmp(about.source, "=(load)") == 0);
    if (!scripted && ours != gmatch_step && ours != pairs_step) return;
    for (int i = 1; lua_getupvalue(L, function, i); i++) {
        if (first_sight(L, function, i)) watch(L, function, i);
        enqueue(L);
    }
}

static int walk(lua_State *L) {
    lua_settop(L, 0);
    luaL_checkstack(L, API_STACK, "freezing");
    lua_newtable(L);
    lua_newtable(L);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_FROZEN);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_WATCHED);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_FUNCTIONS);
    if (lua_rawlen(L, -1) == 0) return 0; /* nothing will ever be called */
    enqueue_contents(L, lua_gettop(L));
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_MODULES); /* `require` gives them out at any time */
    enqueue_contents(L, lua_gettop(L));
    for (lua_Integer at = 1; lua_rawgeti(L, WALK_TODO, at) != LUA_TNIL; at++) {
        int value = lua_gettop(L);
        if (lua_type(L, value) == LUA_TFUNCTION)
            watch_function(L, value);
        else
            freeze_table(L, value);
        lua_settop(L, value - 1);
    }
    return 0;
}

void purity_freeze(lua_State *L) {
    lua_pushcfunction(L, walk); /* a frame of its own: the walk counts its stack slots from 1 */
    lua_call(L, 0, 0);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_WATCHED);
    script_of(L)->watch_count = (int)(lua_rawlen(L, -1) / 3);
    lua_pop(L, 1);
}

/* Equal, nan with nan included. */
static bool same_value(lua_State *L, int a, int b) {
    if (lua_rawequal(L, a, b)) return true;
    return lua_type(L, a) == LUA_TNUMBER && lua_type(L, b) == LUA_TNUMBER && !lua_rawequal(L, a, a) &&
           !lua_rawequal(L, b, b);
}

const char *purity_broken(lua_State *L) {
    int count = script_of(L)->watch_count;
    const char *changed = NULL;
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_WATCHED);
    int watched = lua_gettop(L);
    for (int i = 0; i < count && !changed; i++) {
        lua_rawgeti(L, watched, 3 * i + 1);
        lua_rawgeti(L, watched, 3 * i + 2);
        const char *name = lua_getupvalue(L, -2, (int)lua_tointeger(L, -1));
        lua_rawgeti(L, watched, 3 * i + 3);
        bool was_nil = lua_rawequal(L, -1, watched);
        if (was_nil ? !lua_isnil(L, -2) : !same_value(L, -1, -2)) changed = *name ? name : "an iterator";
        lua_settop(L, watched);
    }
    lua_settop(L, watched - 1);
    return changed;
}
