/* pairs, next and the table library, made for scenes: the same order every time, and no call that runs for ever.
 *
 * Lua's own order of names depends on a random seed, and its sort picks pivots by the clock. Here pairs and next go
 * through numbers first, then names, then booleans, each in ascending order, and sort is a stable merge sort. Ranges
 * are limited, because a table may claim any length. */
#include "script/internal.h"

#include <stdlib.h>
#include <string.h>

enum { RANGE_LIMIT = 1 << 24 };

/* ---- ordered keys ------------------------------------------------------------------------------------------------ */

typedef enum key_rank { RANK_NUMBER, RANK_NAME, RANK_BOOLEAN } key_rank;

typedef struct ordered_key {
    key_rank rank;
    bool whole;
    double number;
    lua_Integer integer;
    const char *text;
    size_t size;
} ordered_key;

static ordered_key read_key(lua_State *L, int index) {
    ordered_key k = {.rank = RANK_NAME};
    switch (lua_type(L, index)) {
    case LUA_TNUMBER:
        k.rank = RANK_NUMBER;
        k.whole = lua_isinteger(L, index);
        k.number = lua_tonumber(L, index);
        k.integer = k.whole ? lua_tointeger(L, index) : 0;
        break;
    case LUA_TSTRING: k.text = lua_tolstring(L, index, &k.size); break;
    case LUA_TBOOLEAN:
        k.rank = RANK_BOOLEAN;
        k.number = lua_toboolean(L, index);
        break;
    default:
        luaL_error(L, "cannot go through a table with a %s as key: the order would differ from run to run",
                   luaL_typename(L, index));
    }
    return k;
}

static int compare_keys(const ordered_key *a, const ordered_key *b) {
    if (a->rank != b->rank) return a->rank < b->rank ? -1 : 1;
    if (a->rank == RANK_NAME) {
        int order = memcmp(a->text, b->text, a->size < b->size ? a->size : b->size);
        return order ? order : (a->size > b->size) - (a->size < b->size);
    }
    if (a->whole && b->whole) return (a->integer > b->integer) - (a->integer < b->integer);
    return (a->number > b->number) - (a->number < b->number);
}

static int compare_for_sorting(const void *a, const void *b) {
    return compare_keys(a, b);
}

/* Pushes the key in its Lua form. Names are still in the table, so nothing new is made. */
static void push_key(lua_State *L, const ordered_key *k) {
    if (k->rank == RANK_NAME)
        lua_pushlstring(L, k->text, k->size);
    else if (k->rank == RANK_BOOLEAN)
        lua_pushboolean(L, k->number != 0);
    else if (k->whole)
        lua_pushinteger(L, k->integer);
    else
        lua_pushnumber(L, k->number);
}

/* Pushes a list of the table's keys in order; returns how many. */
static lua_Integer push_ordered_keys(lua_State *L, int table) {
    lua_Integer count = 0;
    lua_pushnil(L);
    for (; lua_next(L, table); lua_pop(L, 1)) count++;
    guard_spend(L, (size_t)count);
    ordered_key *keys = lua_newuserdatauv(L, (size_t)count * sizeof *keys, 0);
    lua_pushnil(L);
    for (lua_Integer i = 0; lua_next(L, table); lua_pop(L, 1)) keys[i++] = read_key(L, -2);
    guard_spend(L, (size_t)count * 16);
    qsort(keys, (size_t)count, sizeof *keys, compare_for_sorting);
    lua_createtable(L, (int)count, 0);
    for (lua_Integer i = 0; i < count; i++) {
        push_key(L, &keys[i]);
        lua_rawseti(L, -2, i + 1);
    }
    lua_remove(L, -2);
    return count;
}

/* Upvalues: list of keys, contents, position. Keys whose values have gone meanwhile are passed over. */
int pairs_step(lua_State *L) {
    lua_Integer at = lua_tointeger(L, lua_upvalueindex(3));
    for (;;) {
        at++;
        if (lua_rawgeti(L, lua_upvalueindex(1), at) == LUA_TNIL) return 1;
        lua_pushvalue(L, -1);
        if (lua_rawget(L, lua_upvalueindex(2)) != LUA_TNIL) break;
        lua_pop(L, 2);
        guard_spend(L, 1);
    }
    lua_pushinteger(L, at);
    lua_replace(L, lua_upvalueindex(3));
    return 2;
}

static int sandbox_pairs(lua_State *L) {
    luaL_checkany(L, 1);
    lua_settop(L, 1);
    if (luaL_getmetafield(L, 1, "__pairs") != LUA_TNIL) {
        lua_pushvalue(L, 1);
        lua_call(L, 1, 3);
        return 3;
    }
    luaL_checktype(L, 1, LUA_TTABLE);
    push_contents(L, 1);
    push_ordered_keys(L, 2);
    lua_pushvalue(L, 2);
    lua_pushinteger(L, 0);
    lua_pushcclosure(L, pairs_step, 3);
    lua_pushvalue(L, 1);
    lua_pushnil(L);
    return 3;
}

/* The least key above the given one. */
static int sandbox_next(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    lua_settop(L, 2);
    push_contents(L, 1);
    bool first = lua_isnil(L, 2), found = false;
    ordered_key from = {0}, best = {0};
    if (!first) from = read_key(L, 2);
    lua_pushnil(L);
    for (; lua_next(L, 3); lua_pop(L, 1)) {
        guard_spend(L, 1);
        ordered_key k = read_key(L, 4);
        if (!first && compare_keys(&k, &from) <= 0) continue;
        if (found && compare_keys(&k, &best) >= 0) continue;
        best = k, found = true;
    }
    if (!found) {
        lua_pushnil(L);
        return 1;
    }
    push_key(L, &best);
    lua_pushvalue(L, -1);
    lua_rawget(L, 3);
    return 2;
}

/* ---- the table library ------------------------------------------------------------------------------------------- */

static lua_Integer checked_length(lua_State *L, int index) {
    luaL_checktype(L, index, LUA_TTABLE);
    lua_Integer length = luaL_len(L, index);
    if (length < 0 || length > RANGE_LIMIT) luaL_error(L, "a table of length %I is too long here", (LUAI_UACINT)length);
    return length;
}

static void check_range(lua_State *L, lua_Integer first, lua_Integer last) {
    if (first > last) return;
    if ((lua_Unsigned)last - (lua_Unsigned)first >= RANGE_LIMIT)
        luaL_error(L, "the range from %I to %I is too long", (LUAI_UACINT)first, (LUAI_UACINT)last);
    guard_spend(L, (size_t)(last - first));
}

static int table_insert(lua_State *L) {
    lua_Integer end = checked_length(L, 1) + 1, position = end;
    int arguments = lua_gettop(L);
    if (arguments == 3) {
        position = luaL_checkinteger(L, 2);
        luaL_argcheck(L, position >= 1 && position <= end, 2, "position out of bounds");
    } else if (arguments != 2) {
        return luaL_error(L, "wrong number of arguments to 'insert'");
    }
    guard_spend(L, (size_t)(end - position) + 1);
    for (lua_Integer i = end; i > position; i--) {
        lua_geti(L, 1, i - 1);
        lua_seti(L, 1, i);
    }
    lua_settop(L, arguments);
    lua_seti(L, 1, position);
    return 0;
}

static int table_remove(lua_State *L) {
    lua_Integer length = checked_length(L, 1), position = luaL_optinteger(L, 2, length);
    if (lua_gettop(L) > 1)
        luaL_argcheck(L, position == length || (position >= 1 && position <= length + 1), 2, "position out of bounds");
    lua_geti(L, 1, position);
    check_range(L, position, length);
    for (; position < length; position++) {
        lua_geti(L, 1, position + 1);
        lua_seti(L, 1, position);
    }
    lua_pushnil(L);
    lua_seti(L, 1, position);
    return 1;
}

static int table_move(lua_State *L) {
    luaL_checktype(L, 1, LUA_TTABLE);
    lua_Integer first = luaL_checkinteger(L, 2), last = luaL_checkinteger(L, 3), to = luaL_checkinteger(L, 4);
    int target = lua_isnoneornil(L, 5) ? 1 : 5;
    luaL_checktype(L, target, LUA_TTABLE);
    check_range(L, first, last);
    lua_Integer count = first > last ? 0 : last - first + 1;
    luaL_argcheck(L, count == 0 || to <= LUA_MAXINTEGER - count + 1, 4, "destination wrap around");
    /* From the end when the ranges overlap upwards in one table. */
    bool backwards = to > first && to <= last && lua_compare(L, 1, target, LUA_OPEQ);
    for (lua_Integer i = 0; i < count; i++) {
        lua_Integer k = backwards ? count - 1 - i : i;
        lua_geti(L, 1, first + k);
        lua_seti(L, target, to + k);
    }
    lua_pushvalue(L, target);
    return 1;
}

static int table_concat(lua_State *L) {
    lua_Integer length = checked_length(L, 1);
    size_t size;
    const char *separator = luaL_optlstring(L, 2, "", &size);
    lua_Integer first = luaL_optinteger(L, 3, 1), last = luaL_optinteger(L, 4, length);
    check_range(L, first, last);
    luaL_Buffer buffer;
    luaL_buffinit(L, &buffer);
    for (lua_Integer i = first; i <= last; i++) {
        lua_geti(L, 1, i);
        if (!lua_isstring(L, -1))
            return luaL_error(L, "invalid value (at index %I) in table for 'concat'", (LUAI_UACINT)i);
        luaL_addvalue(&buffer);
        if (i < last) luaL_addlstring(&buffer, separator, size);
        if (i == LUA_MAXINTEGER) break;
    }
    luaL_pushresult(&buffer);
    return 1;
}

static int table_unpack(lua_State *L) {
    lua_Integer first = luaL_optinteger(L, 2, 1);
    lua_Integer last = lua_isnoneornil(L, 3) ? checked_length(L, 1) : luaL_checkinteger(L, 3);
    if (first > last) return 0;
    check_range(L, first, last);
    int count = (int)(last - first) + 1;
    if (!lua_checkstack(L, count)) return luaL_error(L, "too many results to unpack");
    for (int i = 0; i < count; i++) lua_geti(L, 1, first + i);
    return count;
}

/* ---- sort -------------------------------------------------------------------------------------------------------- */

enum { SORT_TABLE = 1, SORT_COMPARE, SORT_FROM, SORT_TO }; /* stack slots */

/* Whether the value on top comes strictly before the one below it. */
static bool comes_before(lua_State *L) {
    if (lua_isnil(L, SORT_COMPARE)) {
        bool texts = lua_type(L, -1) == LUA_TSTRING && lua_type(L, -2) == LUA_TSTRING;
        guard_spend(L, texts ? lua_rawlen(L, -1) / 64 + 1 : 1);
        return lua_compare(L, -1, -2, LUA_OPLT);
    }
    guard_spend(L, 1);
    lua_pushvalue(L, SORT_COMPARE);
    lua_pushvalue(L, -2);
    lua_pushvalue(L, -4);
    lua_call(L, 2, 1);
    bool before = lua_toboolean(L, -1);
    lua_pop(L, 1);
    return before;
}

/* Merges [left, middle) and [middle, right) of list `from` into list `to`. */
static void merge(lua_State *L, int from, int to, lua_Integer left, lua_Integer middle, lua_Integer right) {
    lua_Integer a = left, b = middle;
    for (lua_Integer out = left; out < right; out++) {
        bool take_right = a >= middle;
        if (a < middle && b < right) {
            lua_rawgeti(L, from, a);
            lua_rawgeti(L, from, b);
            take_right = comes_before(L); /* equal ones keep their order */
            lua_pop(L, 2);
        }
        lua_rawgeti(L, from, take_right ? b++ : a++);
        lua_rawseti(L, to, out);
    }
}

static int table_sort(lua_State *L) {
    lua_Integer length = checked_length(L, SORT_TABLE);
    if (!lua_isnoneornil(L, SORT_COMPARE)) luaL_checktype(L, SORT_COMPARE, LUA_TFUNCTION);
    lua_settop(L, SORT_COMPARE);
    guard_spend(L, (size_t)length);
    lua_createtable(L, (int)length, 0);
    lua_createtable(L, (int)length, 0);
    for (lua_Integer i = 1; i <= length; i++) {
        lua_geti(L, SORT_TABLE, i);
        lua_rawseti(L, SORT_FROM, i);
    }
    int from = SORT_FROM, to = SORT_TO;
    for (lua_Integer width = 1; width < length; width *= 2) {
        for (lua_Integer left = 1; left <= length; left += 2 * width) {
            lua_Integer middle = left + width, right = left + 2 * width;
            if (middle > length + 1) middle = length + 1;
            if (right > length + 1) right = length + 1;
            merge(L, from, to, left, middle, right);
        }
        int swap = from;
        from = to, to = swap;
    }
    for (lua_Integer i = 1; i <= length; i++) {
        lua_rawgeti(L, from, i);
        lua_seti(L, SORT_TABLE, i);
    }
    return 0;
}

void tables_open(lua_State *L, int library, int base) {
    static const luaL_Reg functions[] = {
        {"insert", table_insert}, {"remove", table_remove}, {"move", table_move}, {"concat", table_concat},
        {"unpack", table_unpack}, {"sort", table_sort},     {NULL, NULL},
    };
    static const luaL_Reg walkers[] = {{"pairs", sandbox_pairs}, {"next", sandbox_next}, {NULL, NULL}};
    lua_pushvalue(L, library);
    luaL_setfuncs(L, functions, 0);
    lua_pushvalue(L, base);
    luaL_setfuncs(L, walkers, 0);
    lua_pop(L, 2);
}
