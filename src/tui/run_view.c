/* The Run screen's handlers for what is seen. */
#include "tui/run.h"

#include "base/clock.h"
#include "base/names.h"

#include <string.h>

static status act(tui_app *app, const char *verb, const char *argument, report *r) {
    char text[96];
    status s = particle_view_act(&run_state_of(app)->view, verb, argument, text, r);
    if (s == STATUS_OK && text[0]) app_notice(app, "%s", text);
    return s;
}

/* Handlers that are no more than a camera's verb. */
#define RUN_VIEW(name, verb)                                                                                                               \
    status name(tui_app *app, const char *argument, report *r) {                                                                           \
        return act(app, verb, argument, r);                                                                                                \
    }
RUN_VIEW(run_turn_left, "turn-left")
RUN_VIEW(run_turn_right, "turn-right")
RUN_VIEW(run_tilt_up, "tilt-up")
RUN_VIEW(run_tilt_down, "tilt-down")
RUN_VIEW(run_zoom_in, "zoom-in")
RUN_VIEW(run_zoom_out, "zoom-out")
RUN_VIEW(run_pan_left, "pan-left")
RUN_VIEW(run_pan_right, "pan-right")
RUN_VIEW(run_pan_up, "pan-up")
RUN_VIEW(run_pan_down, "pan-down")
RUN_VIEW(run_look, "look")
RUN_VIEW(run_cut, "cut")
RUN_VIEW(run_cut_in, "cut-in")
RUN_VIEW(run_cut_out, "cut-out")
RUN_VIEW(run_cut_flip, "cut-flip")
RUN_VIEW(run_scale, "scale")
#undef RUN_VIEW

status run_reset_camera(tui_app *app, const char *argument, report *r) {
    run_state_of(app)->spinning = false;
    return act(app, "reset", argument, r);
}

status run_spin(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    run_state *state = run_state_of(app);
    state->spinning = !state->spinning;
    state->last_turn = clock_seconds();
    app_notice(app, state->spinning ? "The camera turns by itself; a stops it." : "The camera stands still.");
    return STATUS_OK;
}

status run_mode(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    particle_view *view = &run_state_of(app)->view;
    do {
        view->mode = (view_mode)((view->mode + 1) % VIEW_MODES);
    } while (app->theme.ascii && view->mode != VIEW_ASCII);
    view->old = true;
    if (app->theme.ascii) app_notice(app, "Only ASCII: the locale's character set is not UTF-8.");
    else app_notice(app, "Particles as %s.", view_mode_name(view->mode));
    return STATUS_OK;
}

status run_palette(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    app->theme.palette = (view_palette)((app->theme.palette + 1) % VIEW_PALETTES);
    app_notice(app, app->theme.colours ? "Colours: %s." : "Colours: %s, but this terminal shows none.",
               view_palette_name(app->theme.palette));
    return STATUS_OK;
}

status run_histogram(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    run_state *state = run_state_of(app);
    state->log_histogram = !state->log_histogram;
    app_notice(app, state->log_histogram ? "Histogram: logarithmic." : "Histogram: linear.");
    return STATUS_OK;
}

/* ---- colours ----------------------------------------------------------------------------------------------------- */

bool run_complete_colour(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    char names[SESSION_COLOURS][32];
    int count = app->run ? session_colours(app->run, names, SESSION_COLOURS) : 0;
    for (int i = 0; i < count && i < SESSION_COLOURS; i++)
        if (complete_word(names[i], text, &index, out)) return true;
    return false;
}

status run_colour(tui_app *app, const char *argument, report *r) {
    if (!app->run) return run_needed(app, r);
    char names[SESSION_COLOURS][32], name[32];
    int count = session_colours(app->run, names, SESSION_COLOURS);
    if (count > SESSION_COLOURS) count = SESSION_COLOURS;
    if (!argument[0]) {
        if (count == 0) return report_set(r, STATUS_INPUT, "This run has nothing to colour by.");
        const char *asked = run_state_of(app)->colour, *now = asked[0] ? asked : app->shot->colour;
        int at = -1;
        for (int i = 0; i < count; i++) {
            if (strcmp(names[i], now) == 0) at = i;
        }
        argument = names[(at + 1) % count];
    }
    snprintf(name, sizeof name, "%.31s", argument);
    status s = session_colour(app->run, name, r);
    if (s != STATUS_OK) return s;
    snprintf(run_state_of(app)->colour, sizeof name, "%s", name);
    app_log_argument(app, "%s", name);
    app_notice(app, "Coloured by %s.", name);
    return STATUS_OK;
}

/* ---- the panel --------------------------------------------------------------------------------------------------- */

static const char *const panel_names[RUN_PANELS] = {"numbers", "damage", "knobs", "time", "events"};

const char *run_panel_name(run_panel panel) {
    return panel_names[panel];
}

bool run_complete_panel(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    (void)app;
    for (int i = 0; i < RUN_PANELS; i++)
        if (complete_word(panel_names[i], text, &index, out)) return true;
    return false;
}

status run_next_panel(tui_app *app, const char *argument, report *r) {
    run_state *state = run_state_of(app);
    int next = ((int)state->panel + 1) % RUN_PANELS;
    if (argument[0]) {
        for (next = 0; next < RUN_PANELS && strcmp(panel_names[next], argument) != 0;) next++;
        if (next == RUN_PANELS)
            return report_input(r, NULL, 0, "panel", "numbers, damage, knobs, time or events", argument,
                                name_nearest(argument, panel_names, RUN_PANELS));
    }
    state->panel = (run_panel)next;
    return STATUS_OK;
}

status run_whole(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    run_state *state = run_state_of(app);
    state->whole = !state->whole;
    state->view.old = true;
    return STATUS_OK;
}
