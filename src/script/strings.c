/* The string library for scenes: searches that count their steps, repetition that knows its size. */
#include "script/internal.h"

#include "script/pattern.h"

#include <stdint.h>
#include <string.h>

static bool go_on(void *context, size_t steps) {
    return guard_may_go_on(context, steps);
}

static pattern prepare(lua_State *L, const char *subject, size_t size, const char *text, size_t length) {
    return (pattern){.subject = subject,
                     .subject_end = subject + size,
                     .end = text + length,
                     .go_on = go_on,
                     .context = guard_of(L)};
}

/* One try at s; errors of the pattern, and the end of the script's time, are raised. */
static const char *try_at(lua_State *L, pattern *m, const char *s, const char *p) {
    const char *end = pattern_match(m, s, p);
    guard_raise(L);
    if (m->error) luaL_error(L, "%s", m->error);
    return end;
}

static void push_capture(lua_State *L, const pattern *m, int index, const char *start, const char *end) {
    if (index == 0 && m->capture_count == 0) {
        lua_pushlstring(L, start, (size_t)(end - start));
        return;
    }
    if (index >= m->capture_count) luaL_error(L, "invalid capture index %%%d", index + 1);
    const pattern_capture *c = &m->captures[index];
    if (c->length == PATTERN_OPEN) luaL_error(L, "unfinished capture");
    if (c->length == PATTERN_POSITION)
        lua_pushinteger(L, c->start - m->subject + 1);
    else
        lua_pushlstring(L, c->start, (size_t)c->length);
}

/* All captures; the whole match when there are none and `whole`. */
static int push_captures(lua_State *L, const pattern *m, const char *start, const char *end, bool whole) {
    int count = m->capture_count == 0 && whole ? 1 : m->capture_count;
    luaL_checkstack(L, count, "too many captures");
    for (int i = 0; i < count; i++) push_capture(L, m, i, start, end);
    return count;
}

/* An index as Lua counts (from 1, negative from the end) as an offset; size + 1 when it lies behind the end. */
static size_t start_offset(lua_Integer index, size_t size) {
    if (index > 0) return (lua_Unsigned)index > size + 1 ? size + 1 : (size_t)index - 1;
    if (index == 0 || index < -(lua_Integer)size) return 0;
    return size - (size_t)(-index);
}

static int plain_find(lua_State *L, const char *subject, size_t size, size_t from, const char *text, size_t length) {
    guard_spend(L, (size - from) / 16 + 1);
    const char *at = length == 0 ? subject + from : memmem(subject + from, size - from, text, length);
    if (!at) {
        luaL_pushfail(L);
        return 1;
    }
    lua_pushinteger(L, at - subject + 1);
    lua_pushinteger(L, at - subject + (lua_Integer)length);
    return 2;
}

static int search(lua_State *L, bool find) {
    size_t size, length;
    const char *subject = luaL_checklstring(L, 1, &size), *text = luaL_checklstring(L, 2, &length);
    size_t from = start_offset(luaL_optinteger(L, 3, 1), size);
    if (from > size) {
        luaL_pushfail(L);
        return 1;
    }
    bool plain = find && (lua_toboolean(L, 4) || (strcspn(text, "^$*+?.([%-") == length));
    if (plain) return plain_find(L, subject, size, from, text, length);
    pattern m = prepare(L, subject, size, text, length);
    bool anchored = length > 0 && *text == '^';
    const char *s = subject + from;
    do {
        const char *end = try_at(L, &m, s, text + anchored);
        if (!end) continue;
        if (!find) return push_captures(L, &m, s, end, true);
        lua_pushinteger(L, s - subject + 1);
        lua_pushinteger(L, end - subject);
        return push_captures(L, &m, s, end, false) + 2;
    } while (s++ < m.subject_end && !anchored);
    luaL_pushfail(L);
    return 1;
}

static int string_find(lua_State *L) {
    return search(L, true);
}

static int string_match(lua_State *L) {
    return search(L, false);
}

/* ---- gmatch: upvalues subject, pattern, offset to start from, end of the last match (−1: none) ---------------------
 */

int gmatch_step(lua_State *L) {
    size_t size, length;
    const char *subject = lua_tolstring(L, lua_upvalueindex(1), &size);
    const char *text = lua_tolstring(L, lua_upvalueindex(2), &length);
    lua_Integer from = lua_tointeger(L, lua_upvalueindex(3)), last = lua_tointeger(L, lua_upvalueindex(4));
    pattern m = prepare(L, subject, size, text, length);
    for (; from <= (lua_Integer)size; from++) {
        const char *end = try_at(L, &m, subject + from, text);
        if (!end || end - subject == last) continue;
        lua_pushinteger(L, end - subject);
        lua_pushvalue(L, -1);
        lua_replace(L, lua_upvalueindex(3));
        lua_replace(L, lua_upvalueindex(4));
        return push_captures(L, &m, subject + from, end, true);
    }
    return 0;
}

static int string_gmatch(lua_State *L) {
    size_t size;
    luaL_checklstring(L, 1, &size);
    luaL_checkstring(L, 2);
    size_t from = start_offset(luaL_optinteger(L, 3, 1), size);
    lua_settop(L, 2);
    lua_pushinteger(L, (lua_Integer)from);
    lua_pushinteger(L, -1);
    lua_pushcclosure(L, gmatch_step, 4);
    return 1;
}

/* ---- gsub -------------------------------------------------------------------------------------------------------- */

/* Adds the replacement text with its "%1" filled in. */
static void add_template(lua_State *L, luaL_Buffer *out, const pattern *m, const char *start, const char *end) {
    size_t length;
    const char *text = lua_tolstring(L, 3, &length), *text_end = text + length;
    for (const char *p = text; p < text_end;) {
        const char *percent = memchr(p, '%', (size_t)(text_end - p));
        if (!percent) percent = text_end;
        luaL_addlstring(out, p, (size_t)(percent - p));
        p = percent;
        if (p == text_end) return;
        char c = ++p < text_end ? *p++ : '\0';
        if (c == '%') {
            luaL_addchar(out, '%');
        } else if (c == '0') {
            luaL_addlstring(out, start, (size_t)(end - start));
        } else if (c >= '1' && c <= '9') {
            push_capture(L, m, c - '1', start, end);
            luaL_tolstring(L, -1, NULL);
            lua_remove(L, -2);
            luaL_addvalue(out);
        } else {
            luaL_error(L, "invalid use of '%%' in replacement string");
        }
    }
}

/* Adds what stands for one match; false or nil keep the original. */
static void add_replacement(lua_State *L, luaL_Buffer *out, const pattern *m, const char *start, const char *end,
                            int kind) {
    if (kind == LUA_TFUNCTION) {
        lua_pushvalue(L, 3);
        lua_call(L, push_captures(L, m, start, end, true), 1);
    } else if (kind == LUA_TTABLE) {
        push_capture(L, m, 0, start, end);
        lua_gettable(L, 3);
    } else {
        add_template(L, out, m, start, end);
        return;
    }
    if (!lua_toboolean(L, -1)) {
        lua_pop(L, 1);
        luaL_addlstring(out, start, (size_t)(end - start));
        return;
    }
    if (!lua_isstring(L, -1)) luaL_error(L, "invalid replacement value (a %s)", luaL_typename(L, -1));
    luaL_addvalue(out);
}

static int string_gsub(lua_State *L) {
    size_t size, length;
    const char *subject = luaL_checklstring(L, 1, &size), *text = luaL_checklstring(L, 2, &length);
    int kind = lua_type(L, 3);
    luaL_argexpected(L, kind == LUA_TNUMBER || kind == LUA_TSTRING || kind == LUA_TFUNCTION || kind == LUA_TTABLE, 3,
                     "string/function/table");
    lua_Integer limit = luaL_optinteger(L, 4, (lua_Integer)size + 1), count = 0;
    bool anchored = length > 0 && *text == '^';
    pattern m = prepare(L, subject, size, text, length);
    const char *s = subject, *last = NULL;
    lua_settop(L, 4);
    luaL_Buffer out;
    luaL_buffinit(L, &out);
    while (count < limit) {
        const char *end = try_at(L, &m, s, text + anchored);
        if (end && end != last) {
            count++;
            add_replacement(L, &out, &m, s, end, kind);
            s = last = end;
        } else if (s < m.subject_end) {
            luaL_addchar(&out, *s++);
        } else {
            break;
        }
        if (anchored) break;
    }
    luaL_addlstring(&out, s, (size_t)(m.subject_end - s));
    luaL_pushresult(&out);
    lua_pushinteger(L, count);
    return 2;
}

/* ---- rep --------------------------------------------------------------------------------------------------------- */

static int string_rep(lua_State *L) {
    size_t size, gap;
    const char *text = luaL_checklstring(L, 1, &size);
    lua_Integer count = luaL_checkinteger(L, 2);
    const char *separator = luaL_optlstring(L, 3, "", &gap);
    if (count <= 0 || size + gap == 0) {
        lua_pushliteral(L, "");
        return 1;
    }
    if (size + gap > GUARD_STRING_LIMIT / (size_t)count) return luaL_error(L, "resulting string too large");
    luaL_Buffer out;
    char *at = luaL_buffinitsize(L, &out, (size_t)count * (size + gap) - gap);
    for (lua_Integer i = 0; i < count; i++) {
        if ((i & 0xffff) == 0xffff) guard_spend(L, 0x10000);
        memcpy(at, text, size);
        at += size;
        if (i + 1 < count) memcpy(at, separator, gap), at += gap;
    }
    luaL_pushresultsize(&out, (size_t)count * (size + gap) - gap);
    return 1;
}

/* ---- format ------------------------------------------------------------------------------------------------------ */

/* Addresses differ from run to run: "%p" is refused, and what has no text of its own prints as its type. */
static int string_format(lua_State *L) {
    size_t length;
    const char *text = luaL_checklstring(L, 1, &length), *end = text + length;
    for (const char *p = text; p < end; p++) {
        if (*p != '%') continue;
        for (p++; p < end && strchr("-+ #0123456789.", *p) && *p; p++) {
        }
        if (p < end && *p == 'p')
            return luaL_error(L, "invalid conversion '%%p' to 'format': addresses differ from run to run");
    }
    int top = lua_gettop(L);
    for (int i = 2; i <= top; i++) {
        push_text(L, i);
        if (lua_type(L, i) == LUA_TTABLE || lua_type(L, i) == LUA_TFUNCTION)
            lua_replace(L, i);
        else
            lua_pop(L, 1);
    }
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, top, 1);
    return 1;
}

void strings_open(lua_State *L, int library) {
    static const luaL_Reg functions[] = {
        {"find", string_find}, {"match", string_match}, {"gmatch", string_gmatch},
        {"gsub", string_gsub}, {"rep", string_rep},     {NULL, NULL},
    };
    /* dump makes binary chunks, which nothing here may load; packing is for files, which a scene has not. */
    static const char *const removed[] = {"dump", "pack", "unpack", "packsize"};
    lua_pushvalue(L, library);
    luaL_setfuncs(L, functions, 0);
    lua_getfield(L, -1, "format");
    lua_pushcclosure(L, string_format, 1);
    lua_setfield(L, -2, "format");
    for (size_t i = 0; i < sizeof removed / sizeof *removed; i++) {
        lua_pushnil(L);
        lua_setfield(L, -2, removed[i]);
    }
    lua_pop(L, 1);
    lua_pushliteral(L, "");
    lua_getmetatable(L, -1);
    lua_pushboolean(L, 0);
    lua_setfield(L, -2, "__metatable");
    lua_pop(L, 2);
}
