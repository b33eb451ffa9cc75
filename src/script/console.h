/* A Lua console in the scenes' sandbox: what is typed runs under the same limits (5 s of processor time a line), keeps its
 * globals from line to line, and reaches the rest of the program through functions that its host gives. */
#ifndef SUNDER_SCRIPT_CONSOLE_H
#define SUNDER_SCRIPT_CONSOLE_H

#include "base/json.h"
#include "base/status.h"

typedef struct console console;

typedef struct console_function {
    const char *name, *usage, *doc; /* "turn", "turn(path, value)", a line for help() */
} console_function;

typedef struct console_host {
    const console_function *functions; /* [function_count] */
    int function_count;
    /* Does a function and writes its result as one JSON value (nothing: nil). Arguments come as text, at most 8 of them. Called on the
     * thread of console_run. A failure becomes a Lua error. */
    status (*call)(void *context, const char *function, const char *const *arguments, int count, json_writer *reply, report *r);
    void *context;
} console_host;

/* Errors: memory. `host` is copied, its functions are not. */
status console_open(const console_host *host, console **out, report *r);
void console_close(console *c);

/* Runs a line: the values of an expression, or what statements print, are written into out [size], cut where it ends. STATUS_INPUT with what
 * is wrong with it; the console can be used on. */
status console_run(console *c, const char *text, char *out, size_t size, report *r);

/* Stops what runs, from any thread. */
void console_interrupt(console *c);

#endif
