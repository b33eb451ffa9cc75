/* The Run screen's handlers for knobs. A turn is logged as "KNOB=VALUE", whatever key made it: a replay needs no cursor. */
#include "tui/run.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

/* ---- the list ---------------------------------------------------------------------------------------------------- */

static void reload(tui_app *app, run_state *state) {
    knob_panel_arrange(&state->knobs, session_knobs(app->run, state->knobs.list, KNOB_LIMIT));
}

void run_knobs_follow(tui_app *app, run_state *state) {
    if (state->knob_version == app->shot->knob_version && state->knobs.count > 0) return;
    state->knob_version = app->shot->knob_version;
    reload(app, state);
}

bool run_complete_knob(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    const knob_panel *panel = &run_state_of(app)->knobs;
    for (int i = 0; i < panel->count; i++) {
        /* The effect and key alone are enough for whoever begins with them. */
        const char *path = panel->list[i].path;
        bool begins = strncmp(path, text, strlen(text)) == 0;
        for (const char *dot = strchr(path, '.'); dot && !begins; dot = strchr(dot + 1, '.'))
            begins = strncmp(dot + 1, text, strlen(text)) == 0;
        if (!begins || index-- > 0) continue;
        snprintf(out, ACTION_ARGUMENT, "%s", path);
        return true;
    }
    return false;
}

/* Keys that turn what cannot be seen would surprise: the first press shows the knobs. */
static bool shown(tui_app *app, run_state *state) {
    if (state->knobs_in_view || app->headless) return true;
    state->panel = RUN_KNOBS;
    app_log_nothing(app);
    return false;
}

static status move_by(tui_app *app, int by) {
    run_state *state = run_state_of(app);
    if (shown(app, state)) knob_panel_move(&state->knobs, by);
    return STATUS_OK;
}

status run_knob_up(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    return move_by(app, -1);
}

status run_knob_down(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    return move_by(app, 1);
}

status run_knob_page_up(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    return move_by(app, -10);
}

status run_knob_page_down(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    return move_by(app, 10);
}

status run_knob_other(tui_app *app, const char *argument, report *r) {
    (void)argument;
    run_state *state = run_state_of(app);
    if (!shown(app, state)) return STATUS_OK;
    if (!knob_panel_other(&state->knobs)) return report_set(r, STATUS_INPUT, "This knob has no twin, and is no vector.");
    return STATUS_OK;
}

status run_knob_find(tui_app *app, const char *argument, report *r) {
    run_state *state = run_state_of(app);
    int index = knob_find(state->knobs.list, state->knobs.count, argument, r);
    if (index < 0) return r->code;
    state->panel = RUN_KNOBS;
    knob_panel_go(&state->knobs, index);
    return STATUS_OK;
}

/* ---- turning ----------------------------------------------------------------------------------------------------- */

/* Remembers a value for a knob that needs a restart; what it began with takes it back. */
static status wait_for_restart(tui_app *app, run_state *state, const knob *k, const double value[3], report *r) {
    char text[KNOB_TEXT];
    int at = 0;
    while (at < state->pending_count && strcmp(state->pending[at].path, k->path) != 0) at++;
    if (memcmp(value, k->start, sizeof k->start) == 0) {
        if (at < state->pending_count) state->pending[at] = state->pending[--state->pending_count];
        app_notice(app, "%s stays as it is.", k->path);
        return STATUS_OK;
    }
    if (at == RUN_PENDING) return report_set(r, STATUS_INPUT, "%d knobs wait for a restart already: R restarts.", at);
    if (at == state->pending_count) state->pending_count++;
    snprintf(state->pending[at].path, sizeof state->pending[at].path, "%s", k->path);
    knob_print(k, value, state->pending[at].value);
    knob_show(k, value, text);
    app_notice(app, "%s = %s at a restart (%s). R restarts the run with it.", k->path, text, k->why_not);
    return STATUS_OK;
}

static status turn_live(tui_app *app, run_state *state, int index, const double value[3], report *r) {
    const knob *k = &state->knobs.list[index];
    char text[KNOB_TEXT], shown_text[KNOB_TEXT], path[KNOB_PATH];
    knob_print(k, value, text);
    knob_show(k, value, shown_text);
    snprintf(path, sizeof path, "%s", k->path);
    status s = app_turn(app, path, text, r);
    if (s != STATUS_OK) return s;
    knob_panel_note(&state->knobs, state->knobs.list, index, text);
    reload(app, state);
    app_log_argument(app, "%s=%s", path, text);
    app_notice(app, "%s = %s from the next frame on.", path, shown_text);
    return STATUS_OK;
}

/* Turns a knob, in view of whoever typed its name. */
static status turn_to(tui_app *app, int index, const double value[3], report *r) {
    run_state *state = run_state_of(app);
    state->panel = RUN_KNOBS;
    const knob *k = &state->knobs.list[index];
    if (k->live) return turn_live(app, state, index, value, r);
    char text[KNOB_TEXT];
    knob_print(k, value, text);
    app_log_argument(app, "%s=%s", k->path, text);
    return wait_for_restart(app, state, k, value, r);
}

/* "KNOB=VALUE", blanks around either allowed. */
status run_turn(tui_app *app, const char *argument, report *r) {
    status s = run_needed(app, r);
    if (s != STATUS_OK) return s;
    const char *equals = strchr(argument, '=');
    char word[KNOB_PATH];
    if (!equals) return report_input(r, NULL, 0, "turn", "KNOB=VALUE", argument, NULL);
    snprintf(word, sizeof word, "%.*s", (int)(equals - argument), argument);
    for (size_t end = strlen(word); end > 0 && isspace((unsigned char)word[end - 1]);) word[--end] = '\0';
    do equals++;
    while (isspace((unsigned char)*equals));
    run_state *state = run_state_of(app);
    reload(app, state);
    int index = knob_find(state->knobs.list, state->knobs.count, word, r);
    if (index < 0) return r->code;
    double value[3];
    s = knob_parse(&state->knobs.list[index], equals, value, r);
    if (s != STATUS_OK) return s;
    knob_panel_go(&state->knobs, index);
    return turn_to(app, index, value, r);
}

static status step(tui_app *app, const char *argument, int direction, bool fine, report *r) {
    if (argument[0]) return run_turn(app, argument, r);
    run_state *state = run_state_of(app);
    if (!shown(app, state)) return STATUS_OK;
    status s = run_needed(app, r);
    if (s != STATUS_OK) return s;
    reload(app, state);
    const knob *k = knob_panel_current(&state->knobs);
    double value[3];
    if (!k) return report_set(r, STATUS_INPUT, "This run has no knobs.");
    knob now = *k;
    for (int i = 0; i < state->pending_count && !k->live; i++) {
        if (strcmp(state->pending[i].path, k->path) == 0) (void)knob_parse(k, state->pending[i].value, now.value, r);
    }
    if (!knob_step(&now, state->knobs.component, direction, fine, value))
        return report_set(r, STATUS_INPUT, "%s cannot go further: it is at the end of its range.", k->path);
    return turn_to(app, (int)(k - state->knobs.list), value, r);
}

status run_knob_more(tui_app *app, const char *argument, report *r) {
    return step(app, argument, 1, false, r);
}

status run_knob_less(tui_app *app, const char *argument, report *r) {
    return step(app, argument, -1, false, r);
}

status run_knob_more_fine(tui_app *app, const char *argument, report *r) {
    return step(app, argument, 1, true, r);
}

status run_knob_less_fine(tui_app *app, const char *argument, report *r) {
    return step(app, argument, -1, true, r);
}

/* Opens the prompt with the knob's name and value, ready to be changed. */
status run_knob_type(tui_app *app, const char *argument, report *r) {
    (void)argument;
    run_state *state = run_state_of(app);
    if (!shown(app, state)) return STATUS_OK;
    status s = run_needed(app, r);
    const knob *k = knob_panel_current(&state->knobs);
    if (s != STATUS_OK || !k) return s;
    char text[KNOB_TEXT], line[KNOB_PATH + KNOB_TEXT + 2];
    knob_print(k, k->value, text);
    snprintf(line, sizeof line, "%s=%s", k->path, text);
    app_prompt(app, "run.turn", line);
    return STATUS_OK;
}

/* ---- back -------------------------------------------------------------------------------------------------------- */

/* A turn that is no new one: it is not noted among what can be undone. */
static status turn_back(tui_app *app, run_state *state, const char *path, const char *value, int by, report *r) {
    status s = app_turn(app, path, value, r);
    if (s != STATUS_OK) return s;
    knob_panel_undone(&state->knobs, by);
    state->panel = RUN_KNOBS;
    reload(app, state);
    int index = knob_find(state->knobs.list, state->knobs.count, path, r);
    if (index >= 0) knob_panel_go(&state->knobs, index);
    app_notice(app, "%s = %s again, from the next frame on.", path, value);
    return STATUS_OK;
}

status run_undo(tui_app *app, const char *argument, report *r) {
    (void)argument;
    run_state *state = run_state_of(app);
    status s = run_needed(app, r);
    if (s != STATUS_OK) return s;
    const knob_change *change = knob_panel_undo(&state->knobs);
    if (!change) return report_set(r, STATUS_INPUT, "No knob has been turned.");
    return turn_back(app, state, change->from_path, change->from, -1, r);
}

status run_redo(tui_app *app, const char *argument, report *r) {
    (void)argument;
    run_state *state = run_state_of(app);
    status s = run_needed(app, r);
    if (s != STATUS_OK) return s;
    const knob_change *change = knob_panel_redo(&state->knobs);
    if (!change) return report_set(r, STATUS_INPUT, "Nothing has been undone.");
    return turn_back(app, state, change->to_path, change->to, 1, r);
}

status run_reset_knob(tui_app *app, const char *argument, report *r) {
    run_state *state = run_state_of(app);
    status s = run_needed(app, r);
    if (s != STATUS_OK) return s;
    if (!argument[0] && !shown(app, state)) return STATUS_OK;
    reload(app, state);
    const knob *k = knob_panel_current(&state->knobs);
    if (argument[0]) {
        int index = knob_find(state->knobs.list, state->knobs.count, argument, r);
        if (index < 0) return r->code;
        k = &state->knobs.list[index];
    }
    if (!k) return report_set(r, STATUS_INPUT, "This run has no knobs.");
    char path[KNOB_PATH];
    snprintf(path, sizeof path, "%s", k->path);
    double start[3];
    memcpy(start, k->start, sizeof start);
    s = turn_to(app, (int)(k - state->knobs.list), start, r);
    if (s == STATUS_OK) app_log_argument(app, "%s", path);
    return s;
}

/* Twins go once: the side that is said now. */
status run_reset_knobs(tui_app *app, const char *argument, report *r) {
    (void)argument;
    run_state *state = run_state_of(app);
    status s = run_needed(app, r);
    if (s != STATUS_OK) return s;
    state->pending_count = 0;
    reload(app, state);
    int reset = 0;
    for (int i = 0; i < state->knobs.count; i++) {
        const knob *k = &state->knobs.list[i];
        if (!k->live || k->derived || memcmp(k->value, k->start, sizeof k->value) == 0) continue;
        double start[3];
        memcpy(start, k->start, sizeof start);
        s = turn_live(app, state, i, start, r);
        if (s != STATUS_OK) return s;
        reset++;
    }
    app_log_argument(app, "%s", "");
    app_notice(app, reset ? "%d knobs are as the recipe has them, from the next frame on." : "All knobs are as the recipe has them.", reset);
    return STATUS_OK;
}
