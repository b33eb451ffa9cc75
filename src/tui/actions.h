/* The global actions, and how keys and names find theirs. */
#ifndef SUNDER_TUI_ACTIONS_H
#define SUNDER_TUI_ACTIONS_H

#include "tui/app.h"

/* The actions that every screen has, in the order of the help page. */
const tui_action *tui_actions(int *count);

/* An action and whose it is (NULL: global). */
typedef struct action_place {
    const tui_screen *screen;
    const tui_action *action;
} action_place;

/* All actions of all screens and the global ones, by index; false after the last. */
bool actions_at(int index, action_place *out);
/* "run.pause", "quit", or the bare name of an action of the screen in view. */
bool actions_find(const tui_app *app, const char *name, action_place *out);
/* The name nearest to one that is none; NULL when none is near. out[64] holds it. */
const char *actions_nearest(const char *name, char out[64]);
/* "run.pause" or "quit". */
void action_name(const action_place *place, char *out, size_t size);

/* Does what `key` stands for now: an answer to a question, typing, scrolling on a page, else its action. Unknown keys
 * do nothing. */
void actions_press(tui_app *app, int key);

/* What SIGINT does (finish the frame and leave; the second time leave at the next step), and SIGTERM and SIGHUP (the
 * former). */
void actions_interrupt(tui_app *app);
void actions_terminate(tui_app *app);

#endif
