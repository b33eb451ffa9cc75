#include "script/console.h"

#include "base/memory.h"
#include "script/internal.h"

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ARGUMENTS = 8, SHOWN_DEPTH = 3, SHOWN_ITEMS = 200, JSON_NESTING = 16 };

struct console {
    script *script;
    console_host host;
    script_reports reports;
    json_writer reply; /* of the last call: kept here because a Lua error may jump over any frame */
    bool replied;
    atomic_int interrupted;
};

static const char KEY_CONSOLE = 'c';

static console *console_of(lua_State *L) {
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_CONSOLE);
    console *c = lua_touserdata(L, -1);
    lua_pop(L, 1);
    return c;
}

/* ---- from JSON --------------------------------------------------------------------------------------------------- */

static const char *push_json(lua_State *L, const char *p, int depth);

static const char *skip(const char *p) {
    return p + strspn(p, " \t\r\n");
}

/* The writer's own escapes: \" \\ \n … and \u00XX. */
static const char *push_json_text(lua_State *L, const char *p) {
    luaL_Buffer buffer;
    luaL_buffinit(L, &buffer);
    for (p++; *p && *p != '"'; p++) {
        if (*p != '\\') {
            luaL_addchar(&buffer, *p);
            continue;
        }
        static const char letters[] = "nrtbf", meant[] = "\n\r\t\b\f";
        const char *letter = strchr(letters, *++p);
        if (*p == 'u') {
            char digits[5] = {p[1], p[2], p[3], p[4], 0};
            luaL_addchar(&buffer, (char)strtol(digits, NULL, 16));
            p += 4;
        } else {
            luaL_addchar(&buffer, letter && *p ? meant[letter - letters] : *p);
        }
    }
    luaL_pushresult(&buffer);
    return *p ? p + 1 : p;
}

static const char *push_json_table(lua_State *L, const char *p, int depth) {
    bool object = *p == '{';
    lua_Integer next = 1;
    luaL_checkstack(L, 6, "nested too deep");
    lua_newtable(L);
    for (p = skip(p + 1); *p && *p != '}' && *p != ']'; p = skip(p + (*p == ','))) {
        if (object) {
            p = skip(push_json_text(L, p));
            p = skip(p + (*p == ':'));
        }
        p = skip(push_json(L, p, depth + 1));
        if (object) lua_rawset(L, -3);
        else lua_rawseti(L, -2, next++);
    }
    return *p ? p + 1 : p;
}

/* Pushes one value of a JSON text that this program wrote; returns what follows it. */
static const char *push_json(lua_State *L, const char *p, int depth) {
    p = skip(p);
    if (depth > JSON_NESTING) luaL_error(L, "a reply nested too deep");
    if (*p == '{' || *p == '[') return push_json_table(L, p, depth);
    if (*p == '"') return push_json_text(L, p);
    if (*p == 't' || *p == 'f') {
        lua_pushboolean(L, *p == 't');
        return p + (*p == 't' ? 4 : 5);
    }
    if (*p == 'n' || !*p) {
        lua_pushnil(L);
        return *p ? p + 4 : p;
    }
    size_t size = strspn(p, "+-0123456789.eE");
    lua_pushlstring(L, p, size);
    if (size == 0 || lua_stringtonumber(L, lua_tostring(L, -1)) == 0) luaL_error(L, "a reply that is no JSON");
    lua_remove(L, -2);
    return p + size;
}

/* ---- the host's functions ---------------------------------------------------------------------------------------- */

static int call_host(lua_State *L) {
    console *c = console_of(L);
    const console_function *f = lua_touserdata(L, lua_upvalueindex(1));
    const char *arguments[ARGUMENTS];
    report r;
    int count = lua_gettop(L);
    luaL_checkstack(L, ARGUMENTS + 4, "calling");
    if (count > ARGUMENTS) return luaL_error(L, "%s: at most %d arguments", f->name, ARGUMENTS);
    while (count > 0 && lua_isnil(L, count)) lua_settop(L, --count);
    for (int i = 1; i <= count; i++) {
        char number[40];
        if (lua_type(L, i) == LUA_TNUMBER && !lua_isinteger(L, i)) {
            snprintf(number, sizeof number, "%.17g", lua_tonumber(L, i));
            lua_pushstring(L, number);
        } else {
            push_text(L, i);
        }
        lua_replace(L, i);
        arguments[i - 1] = lua_tostring(L, i);
    }
    if (c->replied) json_free(&c->reply);
    json_begin(&c->reply, 0);
    c->replied = true;
    report_clear(&r);
    status s = c->host.call(c->host.context, f->name, arguments, count, &c->reply, &r);
    if (s == STATUS_OK && c->reply.size > 0) s = json_finish(&c->reply, &r);
    guard_raise(L);
    if (s != STATUS_OK) {
        char text[1200];
        report_format(&r, text, sizeof text);
        return luaL_error(L, "%s", text);
    }
    if (c->reply.size == 0) return 0;
    (void)push_json(L, c->reply.text, 0);
    return 1;
}

static int print_help(lua_State *L) {
    const console *c = console_of(L);
    for (int i = 0; i < c->host.function_count; i++) {
        char line[320];
        const console_function *f = &c->host.functions[i];
        int size = snprintf(line, sizeof line, "%-26s %s\n", f->usage, f->doc);
        log_text(c->script, line, size < (int)sizeof line ? (size_t)size : sizeof line - 1);
    }
    return 0;
}

static void give_functions(lua_State *L, const console *c) {
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_GLOBALS);
    for (int i = 0; i < c->host.function_count; i++) {
        lua_pushlightuserdata(L, (void *)&c->host.functions[i]);
        lua_pushcclosure(L, strcmp(c->host.functions[i].name, "help") == 0 ? print_help : call_host, 1);
        lua_setfield(L, -2, c->host.functions[i].name);
    }
    /* The module without its require: one types s.box or sunder.box. */
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_MODULES);
    lua_getfield(L, -1, "sunder");
    lua_setfield(L, -3, "sunder");
    lua_pop(L, 2);
}

/* ---- showing values ---------------------------------------------------------------------------------------------- */

static void show(lua_State *L, int index, int depth);

static void add(lua_State *L, const char *text) {
    log_text(script_of(L), text, strlen(text));
}

static int compare_names(const void *a, const void *b) {
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Names in order; the strings stay in the table. */
static int names_of(lua_State *L, int table, const char *names[SHOWN_ITEMS]) {
    int count = 0;
    for (lua_pushnil(L); lua_next(L, table) != 0; lua_pop(L, 1))
        if (lua_type(L, -2) == LUA_TSTRING && count < SHOWN_ITEMS) names[count++] = lua_tostring(L, -2);
    qsort(names, (size_t)count, sizeof *names, compare_names);
    return count;
}

static void show_table(lua_State *L, int index, int depth) {
    const char *names[SHOWN_ITEMS];
    luaL_checkstack(L, 8, "nested too deep");
    push_contents(L, index);
    int table = lua_gettop(L), count = names_of(L, table, names), shown = 0;
    lua_Integer length = (lua_Integer)lua_rawlen(L, table);
    bool rows = depth == 0; /* of the outermost list each item has a line */
    add(L, rows && length > 0 ? "" : "{");
    for (lua_Integer i = 1; i <= length && shown < SHOWN_ITEMS; i++, shown++) {
        if (shown) add(L, rows ? "\n" : ", ");
        lua_rawgeti(L, table, i);
        show(L, -1, depth + 1);
        lua_pop(L, 1);
    }
    for (int i = 0; i < count && shown < SHOWN_ITEMS; i++, shown++) {
        if (shown) add(L, ", ");
        add(L, names[i]);
        add(L, " = ");
        lua_getfield(L, table, names[i]);
        show(L, -1, depth + 1);
        lua_pop(L, 1);
    }
    add(L, rows && length > 0 ? "" : "}");
    lua_pop(L, 1);
}

/* A table that says itself how it looks is left to it. */
static bool is_plain_table(lua_State *L, int index) {
    if (lua_type(L, index) != LUA_TTABLE) return false;
    if (luaL_getmetafield(L, index, "__tostring") == LUA_TNIL) return true;
    lua_pop(L, 1);
    return false;
}

static void show(lua_State *L, int index, int depth) {
    char number[40], described[160];
    index = lua_absindex(L, index);
    const shape_value *form = luaL_testudata(L, index, META_SHAPE);
    if (form && form->shape) {
        shape_describe(form->shape, described, sizeof described);
        add(L, described);
    } else if (depth < SHOWN_DEPTH && is_plain_table(L, index)) {
        show_table(L, index, depth);
    } else if (lua_type(L, index) == LUA_TNUMBER && !lua_isinteger(L, index)) {
        snprintf(number, sizeof number, "%.10g", lua_tonumber(L, index));
        add(L, number);
    } else {
        push_text(L, index);
        add(L, lua_tostring(L, -1));
        lua_pop(L, 1);
    }
}

/* ---- running ----------------------------------------------------------------------------------------------------- */

/* As an expression first, then as statements. */
static int load_line(lua_State *L, const char *text) {
    lua_pushfstring(L, "return %s", text);
    if (luaL_loadbufferx(L, lua_tostring(L, -1), strlen(lua_tostring(L, -1)), "=console", "t") == LUA_OK) return LUA_OK;
    lua_settop(L, 1);
    return luaL_loadbufferx(L, text, strlen(text), "=console", "t");
}

static int run_line(lua_State *L) {
    const char *text = lua_touserdata(L, 1);
    luaL_checkstack(L, 2 * API_STACK, "running");
    if (load_line(L, text) != LUA_OK) return lua_error(L);
    lua_rawgetp(L, LUA_REGISTRYINDEX, &KEY_ENVIRONMENT);
    if (!lua_setupvalue(L, -2, 1)) lua_pop(L, 1);
    int function = lua_gettop(L);
    lua_call(L, 0, LUA_MULTRET);
    for (int i = function; i <= lua_gettop(L); i++) {
        if (i > function) add(L, "\n");
        show(L, i, 0);
    }
    return 0;
}

static int open_protected(lua_State *L) {
    console *c = lua_touserdata(L, 1);
    luaL_checkstack(L, 4 * API_STACK, "opening");
    lua_pushlightuserdata(L, c);
    lua_rawsetp(L, LUA_REGISTRYINDEX, &KEY_CONSOLE);
    sandbox_open(L);
    give_functions(L, c);
    return 0;
}

/* What went wrong, without the console's own name for its lines. */
static status take_error(console *c, int outcome, report *r) {
    status s = error_take(c->script, outcome, r);
    if (atomic_load(&c->interrupted)) return report_set(r, STATUS_INPUT, "stopped");
    if (strcmp(r->expected, "Lua that runs") == 0) {
        /* An error as Lua words it: of a line just typed neither its name nor its number is news. */
        static const char own[] = "console:1: ";
        char text[sizeof r->found];
        snprintf(text, sizeof text, "%s", r->found + (strncmp(r->found, own, sizeof own - 1) == 0 ? sizeof own - 1 : 0));
        return report_set(r, STATUS_INPUT, "%s", text);
    }
    return s == STATUS_OK ? STATUS_INPUT : s;
}

static status protected_call(console *c, lua_CFunction function, void *argument, report *r) {
    script *s = c->script;
    lua_State *L = s->L;
    s->guard.reason = GUARD_FINE;
    s->guard.refusing = false;
    guard_arm(&s->guard, L);
    guard_begin(&s->guard);
    lua_settop(L, 0);
    lua_pushcfunction(L, error_handler);
    lua_pushcfunction(L, function);
    lua_pushlightuserdata(L, argument);
    int outcome = lua_pcall(L, 1, 0, 1);
    status code = outcome == LUA_OK ? STATUS_OK : take_error(c, outcome, r);
    lua_settop(L, 0);
    return code;
}

status console_run(console *c, const char *text, char *out, size_t size, report *r) {
    atomic_store(&c->interrupted, 0);
    atomic_store(&c->script->guard.interrupted, 0);
    report_clear(r);
    c->script->log_used = 0;
    c->script->reports = &c->reports;
    c->script->problem_count = c->reports.count = 0;
    status s = protected_call(c, run_line, (void *)text, r);
    /* The scenes' functions note what is wrong and go on: here the first of it is the answer. */
    if (s == STATUS_OK && c->script->problem_count > 0) {
        *r = c->reports.items[0];
        s = r->code;
    }
    c->script->log[c->script->log_used] = '\0';
    snprintf(out, size, "%s", c->script->log);
    return s;
}

void console_interrupt(console *c) {
    atomic_store(&c->interrupted, 1);
    guard_interrupt(&c->script->guard);
}

status console_open(const console_host *host, console **out, report *r) {
    console *c = *out = memory_allocate(sizeof *c);
    script_options options = script_options_default();
    if (c) c->script = script_create(&options, &c->reports);
    if (!c || !c->script) {
        memory_free(c, c ? sizeof *c : 0);
        *out = NULL;
        return report_set(r, STATUS_SYSTEM, "out of memory for the console");
    }
    c->host = *host;
    c->script->folder = c->script->working = "./";
    status s = protected_call(c, open_protected, c, r);
    if (s == STATUS_OK) return s;
    console_close(c);
    *out = NULL;
    return s;
}

void console_close(console *c) {
    if (!c) return;
    if (c->replied) json_free(&c->reply);
    script_close(c->script);
    memory_free(c, sizeof *c);
}
