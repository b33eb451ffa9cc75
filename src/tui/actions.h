/* Everything that a key can do, in one table: the keys, the key line and the help page are read from it. */
#ifndef SUNDER_TUI_ACTIONS_H
#define SUNDER_TUI_ACTIONS_H

#include "tui/app.h"

enum { ACTION_KEYS = 3 };

typedef struct tui_action {
    const char *name;      /* unique; what a command log says */
    int keys[ACTION_KEYS]; /* as curses gives them; 0: none */
    const char *keys_shown;
    const char *hint; /* a word for the key line, or NULL */
    const char *help; /* a line for the help page */
    void (*handler)(tui_app *app, int argument);
    int argument;
} tui_action;

/* The table, in the order of the help page. */
const tui_action *tui_actions(int *count);

/* Does what `key` stands for now: an answer to a question, scrolling on a page, else its action. Unknown keys do
 * nothing. */
void actions_press(tui_app *app, int key);

/* What SIGINT does (finish the frame and leave; the second time leave at the next step), and SIGTERM and SIGHUP (the
 * former). */
void actions_interrupt(tui_app *app);
void actions_terminate(tui_app *app);

#endif
