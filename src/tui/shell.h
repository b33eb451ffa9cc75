/* The shell around the screens: the prompt, the question, the command log, replays, the start of runs, bindings. Only
 * the shell's own files include it. */
#ifndef SUNDER_TUI_SHELL_H
#define SUNDER_TUI_SHELL_H

#include "script/user_config.h"
#include "tui/app.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>

enum { SHELL_BINDINGS = USER_BINDINGS, SHELL_RUNS = 256 };
enum { PROMPT_HISTORY = 64, START_SETTINGS = 64, START_TURNS = 256, SHELL_NAME = 64 };

/* ---- prompt.c ---------------------------------------------------------------------------------------------------- */

typedef struct tui_prompt {
    bool open;
    char text[ACTION_ARGUMENT + SHELL_NAME];
    size_t cursor; /* byte in text */
    char history[PROMPT_HISTORY][ACTION_ARGUMENT + SHELL_NAME];
    int history_count, history_at;
    char stem[ACTION_ARGUMENT + SHELL_NAME]; /* what Tab completes; while completing */
    int candidate;                           /* −1: not completing */
} tui_prompt;

void prompt_open(tui_app *app, const char *text);
void prompt_key(tui_app *app, int key);
void widget_prompt(tui_app *app, tui_area area);
/* A row of candidates, above the prompt. */
void widget_candidates(tui_app *app, tui_area area);

/* ---- command_log.c ----------------------------------------------------------------------------------------------- */

typedef struct command_log {
    char *text; /* all of it, NUL-terminated */
    size_t used, capacity;
    FILE *file;    /* the run's, or NULL */
    bool attached; /* the run's folder has been tried */
    char pending[4 * ACTION_ARGUMENT]; /* lines for when the run has ended and its last frame is known */
} command_log;

void log_open(tui_app *app);
void log_close(tui_app *app);
/* The frame in view, −1 without a run. */
int64_t log_frame_now(const tui_app *app);
void log_line(tui_app *app, int64_t frame, const char *name, const char *argument);
/* Within a handler that ends the run: its line is written when that has happened, with the run's last frame, so that a
 * replay ends it there. */
void log_defer(tui_app *app);
void log_pend(tui_app *app, const char *name, const char *argument);
/* The run has ended: writes what was pending. */
void log_settle(tui_app *app);
/* Another run comes into view: once its folder is known it gets the whole log, and all that follows. */
void log_detach(tui_app *app);
void log_attach(tui_app *app);
status log_save(tui_app *app, const char *path, report *r);

/* ---- start.c ----------------------------------------------------------------------------------------------------- */

typedef struct run_start {
    bool active, threaded;
    pthread_t thread;
    atomic_int finished;
    session_options options; /* strings point into `text` */
    script_setting settings[START_SETTINGS];
    knob_turn turns[START_TURNS];
    char text[16384];
    size_t used;
    session *made;
    status outcome;
    script_reports reports;
} run_start;

/* Goes on with a start: waits for the old run's end, starts the thread, takes what it made. */
void start_tick(tui_app *app);
/* Waits for a start under way and gives up what it made. */
void start_close(tui_app *app);

/* ---- replay.c ---------------------------------------------------------------------------------------------------- */

typedef struct tui_replay {
    bool active;
    char path[TUI_PATH];
    char *text, *next; /* the log; from where it has not been read */
    size_t capacity;
    int line;
    bool read; /* a line has been read and is to be done at its frame */
    int64_t frame;
    char name[SHELL_NAME], argument[ACTION_ARGUMENT];
    int64_t sent_to; /* the frame that the run was let go on to, and which run */
    const session *sent_run;
    report outcome; /* what stopped it */
} tui_replay;

/* Reads a log, to be done again from now on. Errors: no such file. */
status replay_open(tui_app *app, const char *path, report *r);
void replay_close(tui_app *app);
/* A run that the log has asked for cannot be started. */
void replay_fail(tui_app *app, const report *r);
/* Does what is due. */
void replay_tick(tui_app *app);

/* ---- bindings.c -------------------------------------------------------------------------------------------------- */

typedef struct tui_binding {
    int key;
    char shown[32]; /* the key as the user wrote it */
    char name[SHELL_NAME], argument[USER_TEXT]; /* name "": the key does nothing */
} tui_binding;

/* Reads config.lua and takes over what must be known before the screen opens; what is wrong is left in r. */
void config_read(tui_app *app, user_config *c, report *r);
/* Takes over the rest, and shows what was wrong. */
void config_apply(tui_app *app, const user_config *c, report *r);
const tui_binding *binding_find(const tui_app *app, int key);

/* ---- the whole --------------------------------------------------------------------------------------------------- */

typedef struct tui_shell {
    int wake; /* an eventfd that other threads write: something for `tick` */
    tui_prompt prompt;
    command_log log;
    run_start start;
    tui_replay replay;
    int runs_started;
    tui_binding bindings[SHELL_BINDINGS];
    int binding_count;

    bool quitting; /* a run that is only being started is to be stopped at once */
    bool asking; /* a question is on the message line */
    char question[192], yes_action[SHELL_NAME], yes_argument[ACTION_ARGUMENT];
    int yes_key;

    /* Of the action that is being done: what its log line says. */
    bool log_nothing, log_argument_given, log_frame_given, log_deferred;
    char log_argument[ACTION_ARGUMENT];
    int64_t log_frame;
    char cursor[SHELL_NAME + ACTION_ARGUMENT]; /* where it was before the action, as an action; "" when that does not matter */
    int run_count;
    char runs[SHELL_RUNS][40]; /* ids of this session's runs, in order */
    int depth; /* actions done by actions: only the outermost is logged */
} tui_shell;

#endif
