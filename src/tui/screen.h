/* What a screen of the workbench is made of, and what its actions are: tables, from which the keys, the key line, the
 * help page, the palette, the users' bindings and the command log are read.
 *
 * Everything that a user does goes through an action by name and argument, so that a command log of them is the whole
 * session. Handlers and `open`, `tick` and `follow` must not call curses: a log is also replayed without a terminal.
 * Only `draw` may. All of it belongs to one thread. */
#ifndef SUNDER_TUI_SCREEN_H
#define SUNDER_TUI_SCREEN_H

#include "base/status.h"
#include "tui/draw.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct tui_app tui_app;

enum { ACTION_KEYS = 3, ACTION_ARGUMENT = 1024 /* bytes of an argument, terminator included */ };

typedef enum tui_argument {
    ARGUMENT_NONE,   /* takes none */
    ARGUMENT_MAY,    /* has a meaning without, and another with a text */
    ARGUMENT_TEXT,   /* needs a text: a key without a preset opens the prompt for it */
    ARGUMENT_NUMBER, /* needs a real number: the same */
} tui_argument;

typedef struct tui_action {
    const char *name;      /* unique within its table; "SCREEN.name" in logs and bindings, "name" for global ones */
    int keys[ACTION_KEYS]; /* as curses gives them; 0: none */
    const char *keys_shown;
    const char *hint; /* a word for the key line, or NULL */
    const char *help; /* a line for the help page */
    /* Does it. argument is never NULL; "" is none. A failure's report becomes the notice. */
    status (*handler)(tui_app *app, const char *argument, report *r);
    tui_argument argument;
    const char *asks;   /* what the argument is, in a word or two: "frame", "KEY=VALUE"; NULL when there is none */
    const char *preset; /* what its keys give as argument; NULL: nothing */
    /* Completion: writes the index-th candidate for the argument that begins with `text` into out; false when there is
     * none. NULL: no completion. */
    bool (*complete)(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]);
    bool paces; /* it only says when the run goes on: a replay, which sees to that itself, leaves it out */
    bool here;  /* without an argument it acts on the row under the screen's cursor, which the log then says first */
    bool unlogged; /* neither a run's bits nor what is seen later depends on it (moves within a list, say) */
} tui_action;

typedef struct tui_screen {
    const char *name;  /* "run": in front of its actions' names */
    const char *title; /* "Run": on the bar of screens */
    const char *help;  /* a line for the help page */
    const tui_action *actions;
    int action_count;

    /* Makes the screen's state, once, before anything else here is called; NULL: it has none. Errors: memory. */
    status (*open)(tui_app *app, void **state, report *r);
    void (*close)(tui_app *app, void *state);
    /* When it comes into view and goes out of it; may be NULL, as all below but draw. */
    void (*enter)(tui_app *app, void *state);
    void (*leave)(tui_app *app, void *state);
    /* Once a turn of the loop (up to 30 a second), in view or not, of screens that are open: what has a thread of its
     * own is asked here, what moves by itself moves here. Sets app->dirty when what is seen has changed. Must take no
     * longer than a few milliseconds. */
    void (*tick)(tui_app *app, void *state, double now);
    /* After a new snapshot of the run (app->shot), and after another run has become app->run (`fresh`). */
    void (*follow)(tui_app *app, void *state, bool fresh);
    /* Draws into the area between the title and the message line: 40 columns and 7 rows at least. */
    void (*draw)(tui_app *app, void *state, tui_area area);
    /* Where the cursor is, as an action ("choose RUN"): noted before an action that acts `here`. False: nowhere that matters. */
    bool (*cursor)(const tui_app *app, const void *state, char *action, size_t size);
    /* An action's word on the key line, where that depends on what the screen shows; NULL: it is not on it. Without this function: its hint. */
    const char *(*hint)(const void *state, const tui_action *action);
    /* A line for the message row when there is nothing more pressing; false: none. */
    bool (*message)(tui_app *app, void *state, char *text, size_t size, tui_style *style);
    /* Keys before they become actions, for typing into a field: true when the key was taken. */
    bool (*key)(tui_app *app, void *state, int key);
    /* The mouse: a press of the left button at a cell of the area that `draw` was given; wheel −1, 0, 1. */
    void (*mouse)(tui_app *app, void *state, tui_area area, int row, int column, int wheel);
} tui_screen;

/* The screens in the order of their keys: F2 is the first. */
const tui_screen *const *tui_screens(int *count);
const tui_screen *tui_screen_find(const char *name);

/* The state of a screen, made by its `open` when there is none yet; NULL with a report when that fails. */
void *screen_state(tui_app *app, const tui_screen *screen, report *r);

/* For a tui_action's `complete`: a word is a candidate when it begins with the text; the one that `index` counts down to is copied. */
bool complete_word(const char *word, const char *text, int *index, char out[ACTION_ARGUMENT]);

/* The place nearest to `at` in a list of `count`; 0 of an empty one. */
int cursor_within(int at, int count);

/* Every screen is one line here: a constant tui_screen named screen_NAME in a file of its own. */
#define TUI_SCREENS(X) X(scenes) X(run) X(compare) X(runs) X(sweep) X(accuracy) X(stress) X(console)

#define TUI_SCREEN_DECLARE(name) extern const tui_screen screen_##name;
TUI_SCREENS(TUI_SCREEN_DECLARE)
#undef TUI_SCREEN_DECLARE

#endif
