#include "script/internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

script *script_of(lua_State *L) {
    /* The guard is the first member of the script. */
    _Static_assert(offsetof(script, guard) == 0, "script_of reads the guard's address");
    return (script *)(void *)guard_of(L);
}

void throw_memory(lua_State *L) {
    guard *g = guard_of(L);
    g->refused = GUARD_SYSTEM;
    guard_settle(g, LUA_ERRMEM);
    guard_raise(L);
    abort(); /* not reached: a settled guard raises */
}

static void push_report(lua_State *L, const report *r) {
    report *copy = lua_newuserdatauv(L, sizeof *copy, 0);
    *copy = *r;
    luaL_setmetatable(L, META_REPORT);
}

void throw_report(lua_State *L, const report *r) {
    push_report(L, r);
    lua_error(L);
    abort(); /* not reached */
}

int place_line(script *s, const place *p) {
    const source_file *file = p->file ? find_source(s, p->file) : NULL;
    return file ? place_find(p, file->text, file->size) : p->line;
}

static void report_place(script *s, const place *p, const char *expected, const char *found, const char *nearest,
                         report *r) {
    char key[sizeof r->key];
    place_text(p, key, sizeof key);
    report_input(r, p->file, place_line(s, p), key, expected, found, nearest);
}

void throw_place(lua_State *L, const place *p, const char *expected, const char *found, const char *nearest) {
    report r;
    report_place(script_of(L), p, expected, found, nearest, &r);
    throw_report(L, &r);
}

place place_running(lua_State *L) {
    script *s = script_of(L);
    lua_Debug frame;
    for (int level = 0; lua_getstack(L, level, &frame); level++) {
        lua_getinfo(L, "Sl", &frame);
        if (frame.currentline <= 0 || frame.source[0] != '@') continue;
        const source_file *file = find_source(s, frame.source + 1); /* its name lives as long as the script */
        if (file) return (place){.file = file->display, .line = frame.currentline};
    }
    return (place){.file = s->source_count ? s->sources[0].display : NULL};
}

void throw_here(lua_State *L, const char *key, const char *expected, const char *found, const char *nearest) {
    place p = place_running(L);
    report r;
    report_input(&r, p.file, p.line, key, expected, found, nearest);
    throw_report(L, &r);
}

void problem_report(script *s, const report *r) {
    s->problem_count++;
    for (int i = 0; i < s->reports->count; i++)
        if (memcmp(&s->reports->items[i], r, sizeof *r) == 0) return; /* a mistake in a loop is one mistake */
    if (s->reports->count < SCRIPT_REPORTS) s->reports->items[s->reports->count++] = *r;
}

void problem_place(script *s, const place *p, const char *expected, const char *found, const char *nearest) {
    report r;
    report_place(s, p, expected, found, nearest, &r);
    problem_report(s, &r);
}

/* If `message` starts with "short_src:line:" of a file's frame, fills file and line and returns what follows; else
 * NULL. */
static const char *after_prefix(const lua_Debug *frame, const char *message, report *r) {
    if (frame->source[0] != '@') return NULL;
    size_t length = strlen(frame->short_src);
    if (strncmp(message, frame->short_src, length) != 0 || message[length] != ':') return NULL;
    char *end;
    long line = strtol(message + length + 1, &end, 10);
    if (end == message + length + 1 || *end != ':') return NULL;
    snprintf(r->file, sizeof r->file, "%s", frame->source + 1);
    r->line = (int)line;
    return end[1] == ' ' ? end + 2 : end + 1;
}

/* A Lua error message names its line as text, in a shortened file name: the frames know the full one. */
static void report_message(lua_State *L, const char *message, report *r) {
    const char *text = NULL;
    lua_Debug frame;
    for (int level = 0; !text && lua_getstack(L, level, &frame); level++) {
        lua_getinfo(L, "Sl", &frame);
        text = after_prefix(&frame, message, r);
    }
    if (!text) {
        place p = place_running(L);
        snprintf(r->file, sizeof r->file, "%s", p.file ? p.file : "");
        r->line = p.line;
        text = message;
    }
    snprintf(r->expected, sizeof r->expected, "Lua that runs");
    snprintf(r->found, sizeof r->found, "%s", text);
}

int error_handler(lua_State *L) {
    if (guard_of(L)->reason != GUARD_FINE || luaL_testudata(L, 1, META_REPORT)) return 1;
    report r;
    report_clear(&r);
    r.code = STATUS_INPUT;
    char text[64];
    describe_value(L, 1, text, sizeof text);
    const char *message = lua_type(L, 1) == LUA_TSTRING ? lua_tostring(L, 1) : NULL;
    if (!message && luaL_getmetafield(L, 1, "__tostring") != LUA_TNIL) message = luaL_tolstring(L, 1, NULL);
    report_message(L, message ? message : text, &r);
    push_report(L, &r);
    return 1;
}

static status report_abort(const script *s, report *r) {
    const guard *g = &s->guard;
    char expected[128], found[64];
    if (g->reason == GUARD_SYSTEM) return report_set(r, STATUS_SYSTEM, "out of memory while a script was running");
    const char *file = g->file[0] ? g->file : s->source_count ? s->sources[0].display : "";
    if (g->reason == GUARD_TIME) {
        snprintf(expected, sizeof expected, "a script that ends within %g s of processor time", g->time_limit);
        snprintf(found, sizeof found, "one that was still running");
    } else if (g->reason == GUARD_STRING) {
        snprintf(expected, sizeof expected, "strings of at most %d MiB", GUARD_STRING_LIMIT >> 20);
        snprintf(found, sizeof found, "a longer one");
    } else {
        snprintf(expected, sizeof expected, "a script that stays within %g MiB of memory",
                 (double)g->memory_limit / (1024.0 * 1024.0));
        snprintf(found, sizeof found, "one that asked for more");
    }
    return report_input(r, file, g->file[0] ? g->line : s->scene_line, NULL, expected, found, NULL);
}

status error_take(script *s, int lua_status, report *r) {
    guard_settle(&s->guard, lua_status);
    if (s->guard.reason != GUARD_FINE) {
        lua_pop(s->L, 1);
        return report_abort(s, r);
    }
    /* No luaL_testudata here: outside of protected mode nothing may allocate. Every handled error is our report; what
     * is left is an error within the handler, which Lua gives as a string. */
    if (lua_type(s->L, -1) == LUA_TUSERDATA) {
        *r = *(const report *)lua_touserdata(s->L, -1);
    } else {
        const char *message = lua_type(s->L, -1) == LUA_TSTRING ? lua_tostring(s->L, -1) : "an error within an error";
        report_input(r, s->source_count ? s->sources[0].display : "", 0, NULL, "Lua that runs", message, NULL);
    }
    lua_pop(s->L, 1);
    return r->code;
}

void log_text(script *s, const char *text, size_t size) {
    size_t room = sizeof s->log - 1 - s->log_used;
    if (size > room) size = room;
    memcpy(s->log + s->log_used, text, size);
    s->log_used += size;
}
