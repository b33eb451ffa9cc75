/* The workbench: the run that is on, the screens, what is on the message line. All of it belongs to one thread. */
#ifndef SUNDER_TUI_APP_H
#define SUNDER_TUI_APP_H

#include "session/session.h"
#include "tui/draw.h"
#include "tui/screen.h"
#include "tui/theme.h"
#include "tui/tui.h"

enum { TUI_SCREEN_LIMIT = 12, TUI_PATH = 1024, TUI_NOTICE = 512 };

typedef enum tui_page { PAGE_NONE, PAGE_HELP, PAGE_LOG, PAGE_COMMANDS } tui_page; /* laid over any screen */

struct tui_app {
    session *run;           /* the run in view, or NULL */
    session_snapshot *shot; /* its newest state; never NULL, zeroed without a run */
    char database[TUI_PATH]; /* of the ledger; "" the default one */
    tui_options options;
    tui_theme theme;
    bool headless; /* no terminal: nothing is drawn, keys do not come */

    const tui_screen *screen; /* in view */
    void *states[TUI_SCREEN_LIMIT];
    bool opened[TUI_SCREEN_LIMIT];

    tui_page page;
    int scroll;  /* first line shown, on pages that have more than fit */
    bool at_end; /* the log page shows its newest lines and follows them */

    bool stopping;     /* session_stop or session_abandon was called for app->run */
    bool abandoned;    /* session_abandon was */
    bool leave_at_end; /* leave as soon as the session has ended */
    bool ended;        /* the session has, or there is none */
    bool leaving;      /* the loop's last turn */

    char notice[TUI_NOTICE]; /* passing answer to a key, on the message line */
    bool notice_bad;         /* it tells a failure */
    double notice_until;     /* s, monotonic clock */
    int64_t printed;         /* bytes of captured output seen so far */

    bool mouse;     /* wanted */
    bool mouse_on;  /* asked of the terminal */
    bool small;     /* the terminal is too small for any screen */
    tui_area body;  /* what the screen in view was given last */

    bool dirty;  /* something on the screen changed */
    bool redraw; /* all of it must be sent to the terminal anew */

    struct tui_shell *shell; /* prompt, question, command log, replay, start of runs, bindings */
};

/* Shows a passing message for a few seconds. app_fail: a failure's. */
void app_notice(tui_app *app, const char *format, ...) __attribute__((format(printf, 2, 3)));
void app_fail(tui_app *app, const report *r);

/* Opens the workbench's ledger; the caller closes it. */
struct ledger;
status app_open_ledger(const tui_app *app, struct ledger **out, report *r);

/* From any thread: lets the loop look at its screens' `tick` at once. */
void app_wake(tui_app *app);

/* Brings a screen into view. */
void app_show(tui_app *app, const tui_screen *screen);

/* ---- actions ----------------------------------------------------------------------------------------------------- */

/* Does an action by its full name ("run.pause", "quit") and notes it in the command log. A failure is shown as the
 * notice and returned. */
status app_do(tui_app *app, const char *name, const char *argument, report *r);

/* Within a handler: what the log shall say instead of the argument that was given, so that a replay needs no cursor;
 * at which frame of the run the action counts, when not at the one in view; that there is nothing to be logged. */
void app_log_argument(tui_app *app, const char *format, ...) __attribute__((format(printf, 2, 3)));
void app_log_frame(tui_app *app, int64_t frame);
void app_log_nothing(tui_app *app);

/* Asks a question on the message line. y: the action `name` is done with `argument` (and logged; the asking is not);
 * any other key: nothing. Replays do not ask. `yes_key` (0: none) is a further key that means yes. */
void app_ask(tui_app *app, const char *name, const char *argument, int yes_key, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/* Opens the prompt with "name text" typed, as for an action whose key was pressed and that needs an argument. */
void app_prompt(tui_app *app, const char *name, const char *text);

/* ---- the run ----------------------------------------------------------------------------------------------------- */

/* Starts a run and, once it has started, brings it into view in place of app->run, which is stopped first at its next
 * whole frame. Returns at once (options are copied, their strings and settings too; the database is the app's);
 * app_starting tells whether it is under way, a failure becomes the notice. Errors: one is being started already;
 * options too long. */
status app_start_run(tui_app *app, const session_options *options, report *r);
bool app_starting(const tui_app *app);

/* Stops app->run after its frame; app->ended tells when that has happened. It stays in view. */
void app_end_run(tui_app *app);

/* Shows another session in place of app->run, which must have ended and is destroyed. NULL: no run. Owned by the app from now on. */
void app_switch_run(tui_app *app, session *run);

/* Within a handler: turns a knob of app->run as session_turn_text does, and has the log say at which frame it acts, so that
 * a replay turns it there. */
status app_turn(tui_app *app, const char *path, const char *value, report *r);

#endif
