/* The app's own functions: notices, questions, the run in view, screens. */
#include "tui/app.h"

#include "base/clock.h"
#include "store/ledger.h"
#include "tui/actions.h"
#include "tui/shell.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const double notice_time = 4; /* s */

status app_open_ledger(const tui_app *app, ledger **out, report *r) {
    char path[TUI_PATH];
    return ledger_open_given(app->database[0] ? app->database : NULL, path, sizeof path, out, r);
}

void app_wake(tui_app *app) {
    uint64_t one = 1;
    ssize_t written = write(app->shell->wake, &one, sizeof one);
    (void)written; /* it is awake already when the counter is full */
}

/* ---- the message line -------------------------------------------------------------------------------------------- */

static void set_notice(tui_app *app, bool bad, double seconds) {
    app->notice_bad = bad;
    app->notice_until = clock_seconds() + seconds;
    app->dirty = true;
}

void app_notice(tui_app *app, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(app->notice, sizeof app->notice, format, arguments);
    va_end(arguments);
    set_notice(app, false, notice_time);
}

void app_fail(tui_app *app, const report *r) {
    char text[1600];
    report_format(r, text, sizeof text);
    snprintf(app->notice, sizeof app->notice, "%.*s", (int)sizeof app->notice - 1, text);
    set_notice(app, true, 2 * notice_time);
}

void app_ask(tui_app *app, const char *name, const char *argument, int yes_key, const char *format, ...) {
    tui_shell *shell = app->shell;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(shell->question, sizeof shell->question, format, arguments);
    va_end(arguments);
    snprintf(shell->yes_action, sizeof shell->yes_action, "%s", name);
    snprintf(shell->yes_argument, sizeof shell->yes_argument, "%s", argument);
    shell->yes_key = yes_key;
    shell->asking = true;
    app_log_nothing(app);
    app->dirty = true;
}

void app_prompt(tui_app *app, const char *name, const char *text) {
    char line[ACTION_ARGUMENT + SHELL_NAME];
    snprintf(line, sizeof line, "%s %s", name, text);
    prompt_open(app, line);
}

/* ---- screens ----------------------------------------------------------------------------------------------------- */

static const tui_screen *const screens[] = {
#define TUI_SCREEN_ADDRESS(name) &screen_##name,
    TUI_SCREENS(TUI_SCREEN_ADDRESS)
#undef TUI_SCREEN_ADDRESS
};
_Static_assert(sizeof screens / sizeof *screens <= TUI_SCREEN_LIMIT, "more screens than an app holds");

const tui_screen *const *tui_screens(int *count) {
    *count = (int)(sizeof screens / sizeof *screens);
    return screens;
}

const tui_screen *tui_screen_find(const char *name) {
    for (size_t i = 0; i < sizeof screens / sizeof *screens; i++)
        if (strcmp(screens[i]->name, name) == 0) return screens[i];
    return NULL;
}

void *screen_state(tui_app *app, const tui_screen *screen, report *r) {
    int i = 0;
    while (screens[i] != screen) i++;
    if (!app->opened[i]) {
        report_clear(r);
        if (screen->open && screen->open(app, &app->states[i], r) != STATUS_OK) return NULL;
        app->opened[i] = true;
        if (screen->follow) screen->follow(app, app->states[i], true);
    }
    return app->states[i];
}

static void *state_of(tui_app *app, const tui_screen *screen) {
    report unused;
    return screen_state(app, screen, &unused);
}

void app_show(tui_app *app, const tui_screen *screen) {
    report r = {0};
    app->page = PAGE_NONE;
    app->dirty = true;
    if (screen == app->screen) return;
    void *state = screen_state(app, screen, &r);
    if (r.code != STATUS_OK) {
        app_fail(app, &r);
        return;
    }
    if (app->screen && app->screen->leave) app->screen->leave(app, state_of(app, app->screen));
    app->screen = screen;
    if (screen->enter) screen->enter(app, state);
}

/* ---- the run ----------------------------------------------------------------------------------------------------- */

void app_end_run(tui_app *app) {
    log_defer(app);
    if (!app->run || app->ended || app->stopping) return;
    app->stopping = true;
    session_stop(app->run);
}

void app_switch_run(tui_app *app, session *run) {
    if (app->run) session_destroy(app->run);
    app->run = run;
    app->stopping = app->abandoned = false;
    app->ended = run == NULL;
    /* Nothing of the run before: the new one's first publication may be yet to come. */
    app->shot->version = 0;
    app->shot->state = SESSION_STARTING;
    app->shot->frame = app->shot->step = 0;
    app->shot->history_count = app->shot->event_count = 0;
    app->shot->point_count = 0;
    app->shot->run_id[0] = app->shot->output[0] = app->shot->message[0] = app->shot->parent[0] = '\0';
    log_detach(app);
    if (run) session_poll(run, app->shot);
    for (size_t i = 0; i < sizeof screens / sizeof *screens; i++)
        if (app->opened[i] && screens[i]->follow) screens[i]->follow(app, app->states[i], true);
    app->dirty = true;
}

status app_turn(tui_app *app, const char *path, const char *value, report *r) {
    if (!app->run) return report_set(r, STATUS_INPUT, "There is no run whose knobs could be turned.");
    status s = session_turn_text(app->run, path, value, r);
    if (s == STATUS_OK) app_log_frame(app, session_turn_frame(app->run));
    return s;
}
