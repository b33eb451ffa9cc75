/* The limits that a script runs under: processor time and memory.
 *
 * Both are sticky. A count hook reads the clock; once the time is over it fires at every instruction and raises again,
 * and pcall and xpcall are our own and pass the abort on, so that no loop of protected calls survives it. The allocator
 * reads the clock as well (a few huge strings fill seconds between two hook calls) and refuses to grow once a limit is
 * passed. C functions that loop without allocating tell how much they did (guard_spend). Finalisers never run under
 * hooks, so the sandbox has none. */
#ifndef SUNDER_SCRIPT_GUARD_H
#define SUNDER_SCRIPT_GUARD_H

#include <lua.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

enum { GUARD_STRING_LIMIT = 16 << 20 /* bytes: what runs over one string in one call of C stays short */ };

typedef enum guard_reason {
    GUARD_FINE,
    GUARD_TIME,   /* over the time limit */
    GUARD_MEMORY, /* over the memory limit */
    GUARD_STRING, /* a string over GUARD_STRING_LIMIT */
    GUARD_SYSTEM, /* the machine has no more memory */
} guard_reason;

typedef struct guard {
    lua_State *L;         /* NULL until the state exists */
    double time_limit;    /* seconds of this thread's processor time for one batch: the loading, or one callback */
    size_t memory_limit;  /* bytes */
    size_t used;          /* bytes that the Lua state holds, rounded up to whole cache lines */
    double started;       /* processor time at the batch's first look at the clock; negative: not looked yet */
    size_t unlooked;      /* bytes asked for since the last look */
    size_t unspent;       /* work told to guard_spend since the last look */
    guard_reason refused; /* why the allocator last said no */
    bool refusing;        /* it has not said yes since */
    atomic_int interrupted; /* set from any thread: the time is over */
    guard_reason reason;  /* sticky: why the script was stopped */
    char file[256];       /* where it was stopped, empty if unknown */
    int line;
} guard;

/* A lua_Alloc over base/memory.h; `context` is the guard. */
void *guard_allocate(void *context, void *block, size_t old_size, size_t new_size);

/* Binds the guard to a fresh state and sets the count hook. */
void guard_arm(guard *g, lua_State *L);

/* Starts a new batch: its clock starts when it is first read. */
void guard_begin(guard *g);

/* Counts `work` small operations of a C function; raises the abort when the time is over. */
void guard_spend(lua_State *L, size_t work);

/* The same without raising, for code that must first give something back: false when the time is over. */
bool guard_may_go_on(guard *g, size_t work);

/* To be called after every lua_pcall: turns LUA_ERRMEM into the sticky reason. */
void guard_settle(guard *g, int lua_status);

/* Raises the abort if there is a sticky reason. */
void guard_raise(lua_State *L);

/* For work in C that has limits of its own (reading a mesh, solving for fibres): the processor time between the two calls
 * is not the script's. */
double guard_pause(void);
void guard_resume(guard *g, double paused);

/* Stops what runs, from any thread, as if its time were over. */
void guard_interrupt(guard *g);

/* The guard of a state. */
guard *guard_of(lua_State *L);

/* pcall and xpcall that cannot swallow an abort. */
int guard_pcall(lua_State *L);
int guard_xpcall(lua_State *L);

#endif
