#include "script/guard.h"

#include "base/memory.h"

#include <lauxlib.h>
#include <stdio.h>
#include <time.h>

enum {
    HOOK_PERIOD = 1000,       /* instructions between two looks at the clock */
    HOOK_PERIOD_SHORT = 50,   /* once there are strings that take milliseconds to compare, convert or parse */
    LONG_STRING = 1 << 20,    /* bytes of such a string */
    LOOK_BYTES = 1024 * 1024, /* allocated bytes between two looks */
    LOOK_WORK = 200 * 1000,   /* spent work between two looks */
};

/* The address is the error value of an abort: raising it needs no memory. */
static const char abort_value;

static double processor_time(void) {
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static size_t charged(size_t bytes) {
    return (bytes + MEMORY_ALIGNMENT - 1) / MEMORY_ALIGNMENT * MEMORY_ALIGNMENT;
}

/* Remembers the line of the innermost function of a scene or recipe. Allocates nothing. */
static void note_place(guard *g) {
    lua_Debug frame;
    g->file[0] = '\0', g->line = 0;
    for (int level = 0; g->L && lua_getstack(g->L, level, &frame); level++) {
        lua_getinfo(g->L, "Sl", &frame);
        if (frame.currentline <= 0 || frame.source[0] != '@') continue;
        snprintf(g->file, sizeof g->file, "%s", frame.source + 1);
        g->line = frame.currentline;
        return;
    }
}

static bool time_over(guard *g) {
    double now = processor_time();
    g->unlooked = g->unspent = 0;
    if (g->started < 0) g->started = now;
    if (atomic_load_explicit(&g->interrupted, memory_order_relaxed)) return true;
    return now - g->started > g->time_limit;
}

void guard_interrupt(guard *g) {
    atomic_store(&g->interrupted, 1);
}

static void on_count(lua_State *L, lua_Debug *event);

static void stop(guard *g, guard_reason reason) {
    if (g->reason != GUARD_FINE) return;
    if (reason == GUARD_TIME) note_place(g);
    g->reason = reason;
    if (g->L) lua_sethook(g->L, on_count, LUA_MASKCOUNT, 1);
}

bool guard_may_go_on(guard *g, size_t work) {
    g->unspent += work;
    if (g->unspent > LOOK_WORK && time_over(g)) stop(g, GUARD_TIME);
    return g->reason == GUARD_FINE;
}

/* Says no. Lua tries again after a collection, and unwinding may ask for memory too: the first place of a series
 * stands. */
static void refuse(guard *g, guard_reason reason) {
    if (!g->refusing) note_place(g);
    g->refusing = true;
    g->refused = reason;
}

/* Strings are told by the kind that Lua gives instead of an old size. */
static bool string_fits(guard *g, size_t size) {
    if (size <= LONG_STRING) return true;
    if (g->L && g->reason == GUARD_FINE) lua_sethook(g->L, on_count, LUA_MASKCOUNT, HOOK_PERIOD_SHORT);
    if (size <= GUARD_STRING_LIMIT) return true;
    refuse(g, GUARD_STRING);
    return false;
}

static bool may_grow(guard *g, size_t more) {
    if (g->reason != GUARD_FINE) return false;
    g->unlooked += more;
    bool fits = more <= g->memory_limit && g->used <= g->memory_limit - more;
    /* At the limit Lua collects garbage before every allocation: the clock is read each time. */
    if ((g->unlooked > LOOK_BYTES || !fits) && time_over(g)) {
        stop(g, GUARD_TIME);
        return false;
    }
    if (fits) return true;
    refuse(g, GUARD_MEMORY);
    return false;
}

void *guard_allocate(void *context, void *block, size_t old_size, size_t new_size) {
    guard *g = context;
    size_t held = block ? charged(old_size) : 0, wanted = charged(new_size);
    if (new_size == 0) {
        memory_free(block, held);
        g->used -= held;
        return NULL;
    }
    if (block && wanted == held) return block;
    if (!block && old_size == LUA_TSTRING && !string_fits(g, new_size)) return NULL;
    if (wanted < new_size || (wanted > held && !may_grow(g, wanted - held))) return NULL;
    void *fresh = block ? memory_resize(block, held, wanted) : memory_allocate(wanted);
    if (!fresh) {
        refuse(g, GUARD_SYSTEM);
        return NULL;
    }
    if (wanted > held) g->refusing = false;
    g->used = g->used - held + wanted;
    return fresh;
}

guard *guard_of(lua_State *L) {
    return *(guard **)lua_getextraspace(L);
}

void guard_arm(guard *g, lua_State *L) {
    g->L = L;
    *(guard **)lua_getextraspace(L) = g;
    lua_sethook(L, on_count, LUA_MASKCOUNT, HOOK_PERIOD);
}

void guard_begin(guard *g) {
    g->started = -1;
    g->unlooked = g->unspent = 0;
}

double guard_pause(void) {
    return processor_time();
}

void guard_resume(guard *g, double paused) {
    if (g->started >= 0) g->started += processor_time() - paused;
}

void guard_raise(lua_State *L) {
    if (guard_of(L)->reason == GUARD_FINE) return;
    lua_pushlightuserdata(L, (void *)&abort_value);
    lua_error(L);
}

static void on_count(lua_State *L, lua_Debug *event) {
    (void)event;
    guard *g = guard_of(L);
    if (g->reason == GUARD_FINE && time_over(g)) stop(g, GUARD_TIME);
    guard_raise(L);
}

void guard_spend(lua_State *L, size_t work) {
    if (!guard_may_go_on(guard_of(L), work)) guard_raise(L);
}

void guard_settle(guard *g, int lua_status) {
    if (lua_status == LUA_ERRMEM) stop(g, g->refused == GUARD_FINE ? GUARD_SYSTEM : g->refused);
}

static int finish_pcall(lua_State *L, int outcome) {
    guard_settle(guard_of(L), outcome);
    guard_raise(L);
    lua_pushboolean(L, outcome == LUA_OK);
    lua_replace(L, 1);
    return lua_gettop(L);
}

/* Both keep slot 1 for the boolean that comes first among the results. */
int guard_pcall(lua_State *L) {
    luaL_checkany(L, 1);
    lua_pushboolean(L, 0);
    lua_insert(L, 1);
    return finish_pcall(L, lua_pcall(L, lua_gettop(L) - 2, LUA_MULTRET, 0));
}

/* The script's own message handler, unless the script is being stopped. */
static int call_handler(lua_State *L) {
    if (guard_of(L)->reason != GUARD_FINE) return 1;
    lua_pushvalue(L, lua_upvalueindex(1));
    lua_insert(L, 1);
    lua_call(L, lua_gettop(L) - 1, 1);
    return 1;
}

int guard_xpcall(lua_State *L) {
    luaL_checktype(L, 2, LUA_TFUNCTION);
    /* (f, handler, …) becomes (room for the boolean, wrapped handler, f, …). */
    lua_pushcclosure(L, (lua_pushvalue(L, 2), call_handler), 1);
    lua_replace(L, 2);
    lua_pushvalue(L, 1);
    lua_insert(L, 3);
    int outcome = lua_pcall(L, lua_gettop(L) - 3, LUA_MULTRET, 2);
    lua_remove(L, 2);
    return finish_pcall(L, outcome);
}
