/* The Console screen's own state, and the thread that its Lua runs on. */
#ifndef SUNDER_TUI_CONSOLE_H
#define SUNDER_TUI_CONSOLE_H

#include "tui/app.h"

enum { CONSOLE_LINES = 500, CONSOLE_PARTS = 64, CONSOLE_WIDTH = 400, CONSOLE_HISTORY = 100, CONSOLE_ANSWER = 8192 };

typedef struct console_worker console_worker;

typedef struct console_line {
    tui_style style;
    char text[CONSOLE_WIDTH];
} console_line;

typedef struct console_state {
    console_worker *worker; /* NULL without a terminal */
    console_line lines[CONSOLE_LINES];
    int line_count, scroll; /* scroll: rows hidden below */
    char text[ACTION_ARGUMENT];
    size_t cursor;
    char history[CONSOLE_HISTORY][ACTION_ARGUMENT];
    int history_count, history_at;
    char answer[CONSOLE_ANSWER], trouble[1600];
} console_state;

void console_insert(console_state *c, const char *text);
/* Completes the word before the cursor: a function, or within quotes a knob's path or an action's name. */
void console_complete(tui_app *app, console_state *c);

/* ---- console_work.c: the thread ---------------------------------------------------------------------------------- */

status console_work_open(tui_app *app, console_worker **out, report *r);
void console_work_close(console_worker *w);
void console_ask(console_worker *w, const char *text);
bool console_busy(console_worker *w);
void console_stop(console_worker *w);
/* The answer to the line that was asked for, once. */
bool console_take(console_worker *w, char *answer, size_t size, status *outcome, char *trouble, size_t trouble_size);
/* On the screen's thread: does what the console's thread waits for; whether there was something. */
bool console_serve(tui_app *app, console_worker *w);

#endif
