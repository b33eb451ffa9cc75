/* Starting runs without making the screen wait: the old run's last frame, loading the scene and sampling it take
 * seconds. */
#include "tui/shell.h"

#include <stdio.h>
#include <string.h>

/* Copies a string into the start's own memory; NULL stays NULL, and `full` is set when it does not fit. */
static const char *keep(run_start *start, const char *text, bool *full) {
    if (!text) return NULL;
    size_t size = strlen(text) + 1;
    if (start->used + size > sizeof start->text) {
        *full = true;
        return NULL;
    }
    char *copy = memcpy(start->text + start->used, text, size);
    start->used += size;
    return copy;
}

static status keep_options(tui_app *app, run_start *start, const session_options *options, report *r) {
    start->options = *options;
    start->used = 0;
    session_options *o = &start->options;
    bool full = options->script.setting_count > START_SETTINGS;
    o->scene_path = keep(start, options->scene_path, &full);
    o->output = keep(start, options->output, &full);
    o->database = keep(start, app->database[0] ? app->database : options->database, &full);
    o->resume = keep(start, options->resume, &full);
    o->simd = keep(start, options->simd, &full);
    o->command = keep(start, options->command, &full);
    o->script.recipe = keep(start, options->script.recipe, &full);
    o->script.resolved = keep(start, options->script.resolved, &full);
    for (int i = 0; !full && i < options->script.setting_count; i++)
        start->settings[i] = (script_setting){keep(start, options->script.settings[i].key, &full),
                                              keep(start, options->script.settings[i].value, &full)};
    o->script.settings = start->settings;
    o->branch_of = keep(start, options->branch_of, &full);
    full = full || options->turn_count > START_TURNS;
    if (!full && options->turn_count > 0) memcpy(start->turns, options->turns, (size_t)options->turn_count * sizeof *options->turns);
    o->turns = start->turns;
    if (app->shell->replay.active) o->start_paused = true; /* until its first line's frame is known */
    if (app->options.output) {
        char folder[TUI_PATH];
        int count = app->shell->runs_started + 1;
        snprintf(folder, sizeof folder, count == 1 ? "%s" : "%s.%d", app->options.output, count);
        o->output = keep(start, folder, &full);
    }
    if (full) return report_set(r, STATUS_INPUT, "too many settings or turns for one run");
    return STATUS_OK;
}

bool app_starting(const tui_app *app) {
    return app->shell->start.active;
}

status app_start_run(tui_app *app, const session_options *options, report *r) {
    run_start *start = &app->shell->start;
    if (start->active) return report_set(r, STATUS_INPUT, "A run is being started already.");
    status s = keep_options(app, start, options, r);
    if (s != STATUS_OK) return s;
    app->shell->runs_started++;
    start->active = true;
    start->threaded = false;
    start->made = NULL;
    log_defer(app);
    app_end_run(app);
    app_notice(app, "Starting %s …", options->scene_path && options->scene_path[0] ? options->scene_path : "a run");
    return STATUS_OK;
}

static void *make_run(void *argument) {
    run_start *start = argument;
    start->outcome = session_start(&start->options, &start->made, &start->reports);
    atomic_store(&start->finished, 1);
    return NULL;
}

void start_tick(tui_app *app) {
    run_start *start = &app->shell->start;
    if (!start->active || !app->ended) return;
    report r;
    if (!start->threaded) {
        atomic_store(&start->finished, 0);
        if (pthread_create(&start->thread, NULL, make_run, start) != 0) {
            start->active = false;
            (void)report_set(&r, STATUS_SYSTEM, "no thread to start the run");
            app_fail(app, &r);
        } else {
            start->threaded = true;
        }
        return;
    }
    if (!atomic_load(&start->finished)) return;
    pthread_join(start->thread, NULL);
    start->active = start->threaded = false;
    app->dirty = true;
    if (start->outcome != STATUS_OK) {
        app_fail(app, &start->reports.items[0]);
        replay_fail(app, &start->reports.items[0]);
        return;
    }
    app->notice[0] = '\0';
    app_switch_run(app, start->made);
    bool failed = app->headless && app->shell->replay.outcome.code != STATUS_OK; /* the replay, after it had asked for this run */
    if (app->shell->quitting || failed) app_end_run(app);
}

void start_close(tui_app *app) {
    run_start *start = &app->shell->start;
    if (start->threaded) {
        pthread_join(start->thread, NULL);
        if (start->outcome == STATUS_OK) session_destroy(start->made);
    }
    start->active = start->threaded = false;
}
