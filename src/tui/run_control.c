/* The Run screen's handlers for the run itself: going on, going back, going elsewhere. */
#include "tui/run.h"

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

status run_pause(tui_app *app, const char *argument, report *r) {
    status s = run_needed(app, r);
    if (s != STATUS_OK) return s;
    bool pausing = argument[0] ? strcmp(argument, "off") != 0 : app->shot->state != SESSION_PAUSED;
    session_pause(app->run, pausing);
    app_log_argument(app, "%s", pausing ? "on" : "off");
    app_notice(app, pausing ? "Pausing after this frame." : "Going on.");
    return STATUS_OK;
}

status run_step(tui_app *app, const char *argument, report *r) {
    (void)argument;
    status s = run_needed(app, r);
    if (s != STATUS_OK) return s;
    if (app->shot->state != SESSION_PAUSED) {
        session_pause(app->run, true);
        app_notice(app, "Pausing after this frame; s again computes one frame at a time.");
    } else {
        session_step_once(app->run);
        app_notice(app, "One frame.");
    }
    return STATUS_OK;
}

/* A frame of the run, as a whole number within its first and last. */
static status parse_frame(const tui_app *app, const char *text, int64_t *frame, report *r) {
    char *end, expected[64];
    double number = strtod(text, &end);
    while (isspace((unsigned char)*end)) end++;
    *frame = (int64_t)number;
    if (end != text && !*end && number == floor(number) && number >= 0 && number <= (double)app->shot->frames) return STATUS_OK;
    snprintf(expected, sizeof expected, "a frame from 0 to %" PRId64, app->shot->frames);
    return report_input(r, NULL, 0, "frame", expected, text, NULL);
}

status run_go_to(tui_app *app, const char *argument, report *r) {
    int64_t frame;
    status s = run_needed(app, r);
    if (s == STATUS_OK) s = parse_frame(app, argument, &frame, r);
    if (s != STATUS_OK) return s;
    if (frame <= app->shot->frame)
        return report_set(r, STATUS_INPUT, "Frame %" PRId64 " is past: [ chooses a checkpoint and b goes on from there.", frame);
    session_run_to(app->run, frame);
    app_notice(app, "Going on to frame %" PRId64 ".", frame);
    return STATUS_OK;
}

status run_stop(tui_app *app, const char *argument, report *r) {
    (void)argument;
    status s = run_needed(app, r);
    if (s != STATUS_OK) return s;
    app_end_run(app);
    app_notice(app, "Stopping after this frame.");
    return STATUS_OK;
}

/* ---- the line of frames ------------------------------------------------------------------------------------------ */

static status need_any_run(const tui_app *app, report *r) {
    return app->run ? STATUS_OK : run_needed(app, r);
}

static status choose_next(tui_app *app, int direction, report *r) {
    run_state *state = run_state_of(app);
    status s = need_any_run(app, r);
    if (s != STATUS_OK) return s;
    if (state->checkpoint_count == 0) return report_set(r, STATUS_INPUT, "This run has no checkpoints to go back to.");
    state->chosen = timeline_next(state->checkpoints, state->checkpoint_count, state->chosen, direction);
    if (state->chosen >= 0) app_notice(app, "Frame %" PRId64 ": b goes on from here as a run of its own.", state->chosen);
    return STATUS_OK;
}

status run_choose_earlier(tui_app *app, const char *argument, report *r) {
    (void)argument;
    return choose_next(app, -1, r);
}

status run_choose_later(tui_app *app, const char *argument, report *r) {
    (void)argument;
    return choose_next(app, 1, r);
}

status run_choose(tui_app *app, const char *argument, report *r) {
    int64_t frame;
    status s = need_any_run(app, r);
    if (s == STATUS_OK) s = parse_frame(app, argument, &frame, r);
    if (s != STATUS_OK) return s;
    if (frame > app->shot->frame) return report_set(r, STATUS_INPUT, "Frame %" PRId64 " is yet to come.", frame);
    run_state_of(app)->chosen = frame;
    app_notice(app, "Frame %" PRId64 ": b goes on from here as a run of its own.", frame);
    return STATUS_OK;
}

bool run_complete_checkpoint(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    const run_state *state = run_state_of(app);
    for (int i = state->checkpoint_count; i > 0; i--) {
        char number[32];
        snprintf(number, sizeof number, "%" PRId64, state->checkpoints[i - 1]);
        if (complete_word(number, text, &index, out)) return true;
    }
    return false;
}

/* ---- other runs -------------------------------------------------------------------------------------------------- */

/* The frame that was given, else the one under the cursor, else the newest checkpoint. */
static status branch_frame(const tui_app *app, const run_state *state, const char *argument, int64_t *frame, report *r) {
    if (argument[0]) {
        status s = parse_frame(app, argument, frame, r);
        if (s == STATUS_OK && *frame > app->shot->frame)
            return report_set(r, STATUS_INPUT, "Frame %" PRId64 " is yet to come: r goes on to it.", *frame);
        return s;
    }
    *frame = state->chosen;
    if (*frame < 0 && state->checkpoint_count > 0) *frame = state->checkpoints[state->checkpoint_count - 1];
    if (*frame < 0) return report_set(r, STATUS_INPUT, "This run has no checkpoints to go back to.");
    return STATUS_OK;
}

/* The branch begins paused: it is there to have its knobs turned. */
status run_branch(tui_app *app, const char *argument, report *r) {
    run_state *state = run_state_of(app);
    int64_t frame;
    status s = need_any_run(app, r);
    if (s == STATUS_OK) s = branch_frame(app, state, argument, &frame, r);
    if (s != STATUS_OK) return s;
    session_options options;
    session_request(app->run, &options);
    options.branch_of = app->shot->run_id;
    options.branch_frame = frame;
    options.start_paused = true;
    s = app_start_run(app, &options, r);
    if (s != STATUS_OK) return s;
    app_log_argument(app, "%" PRId64, frame);
    app_notice(app, "Back to frame %" PRId64 ": the run ends here and a branch of it begins, paused.", frame);
    return STATUS_OK;
}

/* Every knob that is not as the run began with it, and those that have waited for this, on top of what the run was asked for. */
static status restart_settings(const run_state *state, const session_options *asked, script_setting *settings,
                               char (*values)[KNOB_TEXT], int limit, int *count, report *r) {
    *count = 0;
    for (int i = 0; i < asked->script.setting_count && *count < limit; i++) settings[(*count)++] = asked->script.settings[i];
    for (int i = 0; i < state->knobs.count + state->pending_count; i++) {
        const knob *k = i < state->knobs.count ? &state->knobs.list[i] : NULL;
        if (k && (k->derived || memcmp(k->value, k->start, sizeof k->value) == 0)) continue;
        if (*count == limit) return report_set(r, STATUS_INPUT, "More than %d settings cannot be given to one run.", limit);
        const run_pending *waiting = k ? NULL : &state->pending[i - state->knobs.count];
        if (k) knob_print(k, k->value, values[*count]);
        settings[*count] = (script_setting){k ? k->path : waiting->path, k ? values[*count] : waiting->value};
        (*count)++;
    }
    return STATUS_OK;
}

status run_restart(tui_app *app, const char *argument, report *r) {
    enum { SETTINGS = 64 };
    run_state *state = run_state_of(app);
    status s = need_any_run(app, r);
    if (s != STATUS_OK) return s;
    if (!app->ended && !argument[0]) {
        app_ask(app, "run.restart", "yes", 'R', "Stop this run and start again with the knobs as they are?");
        return STATUS_OK;
    }
    session_options options;
    script_setting settings[SETTINGS];
    char values[SETTINGS][KNOB_TEXT];
    int count;
    session_request(app->run, &options);
    s = restart_settings(state, &options, settings, values, SETTINGS, &count, r);
    if (s != STATUS_OK) return s;
    options.script.settings = settings;
    options.script.setting_count = count;
    s = app_start_run(app, &options, r);
    if (s == STATUS_OK) app_log_argument(app, "yes");
    return s;
}

/* ---- recipes ----------------------------------------------------------------------------------------------------- */

/* The names of the run's materials, by the knobs that they own. */
static const knob *material_at(const run_state *state, int index) {
    int last = -1;
    for (int i = 0; i < state->knobs.count; i++) {
        const knob *k = &state->knobs.list[i];
        if (k->material <= last) continue;
        last = k->material;
        if (index-- == 0) return k;
    }
    return NULL;
}

/* Recipes are found by name in a folder of that name. */
static const char *recipe_file(void) {
    struct stat about;
    return stat("recipes", &about) == 0 && S_ISDIR(about.st_mode) ? "recipes/tuned.lua" : "tuned.lua";
}

static void tell_recipe(tui_app *app, const char *material, const char *path) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    int length = (int)strlen(name) - (int)strlen(".lua");
    if (strncmp(path, "recipes/", 8) == 0) app_notice(app, "%s is in %s; --recipe %.*s takes it.", material, path, length, name);
    else app_notice(app, "%s is in %s; from a folder recipes/, --recipe %.*s takes it.", material, path, length, name);
}

bool run_complete_material(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    const run_state *state = run_state_of(app);
    const knob *k;
    for (int i = 0; (k = material_at(state, i)) != NULL; i++) {
        if (strncmp(k->owner, text, strlen(text)) != 0 || index-- > 0) continue;
        snprintf(out, ACTION_ARGUMENT, "%s %s", k->owner, recipe_file());
        return true;
    }
    return false;
}

/* "FILE", of the material under the cursor, or "MATERIAL FILE". */
status run_save_recipe(tui_app *app, const char *argument, report *r) {
    run_state *state = run_state_of(app);
    status s = need_any_run(app, r);
    if (s != STATUS_OK) return s;
    const knob *k = knob_panel_current(&state->knobs);
    const knob *material = k && k->material >= 0 ? k : material_at(state, 0);
    if (!material) return report_set(r, STATUS_INPUT, "This run has no material.");
    if (!argument[0]) {
        char line[128];
        snprintf(line, sizeof line, "%s %s", material->owner, recipe_file());
        app_prompt(app, "run.save-recipe", line);
        app_log_nothing(app);
        return STATUS_OK;
    }
    const char *path = argument;
    for (int i = 0; (k = material_at(state, i)) != NULL; i++) {
        size_t length = strlen(k->owner);
        if (length == 0 || strncmp(argument, k->owner, length) != 0 || argument[length] != ' ') continue;
        material = k;
        path = argument + length + 1;
    }
    char file[SESSION_RECIPE];
    s = session_save_recipe(app->run, material->material, path, file, r);
    if (s != STATUS_OK) return s;
    app_log_argument(app, "%s %s", material->owner, file);
    tell_recipe(app, material->owner, file);
    return STATUS_OK;
}
