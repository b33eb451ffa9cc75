/* A past run's frames, one after the other. */
#include "tui/runs.h"

#include "tui/timeline.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double frame_time = 1. / 24; /* s between two frames that are played */

/* ---- the player -------------------------------------------------------------------------------------------------- */

void runs_close_player(runs_state *s) {
    frame_player_close(s->player);
    s->player = NULL;
    s->frame = (frame_view){0};
    s->playing = false;
}

static particle_points points_of(const runs_state *s) {
    return (particle_points){.position = s->frame.position, .scalar = s->frame.value, .count = s->frame.count, .name = s->field, .unit = "",
                             .natural = {(double)s->frame.low, (double)s->frame.high}};
}

status runs_show_frame(tui_app *app, runs_state *s, int index, report *r) {
    float low[3], high[3];
    if (!s->player) return report_set(r, STATUS_INPUT, "Open a run's frames with enter first.");
    int last = frame_player_count(s->player) - 1;
    index = index < 0 ? 0 : index > last ? last : index;
    frame_view fresh;
    status code = frame_player_bounds(s->player, low, high, r);
    if (code == STATUS_OK) code = frame_player_read(s->player, frame_player_number(s->player, index), s->field[0] ? s->field : NULL, &fresh, r);
    /* The player's last arrays hold no more, whether this went well or not. */
    s->frame = code == STATUS_OK ? fresh : (frame_view){0};
    s->view.old = true;
    app->dirty = true;
    if (code != STATUS_OK) return code;
    s->frame_index = index;
    particle_points points = points_of(s);
    particle_view_follow(&s->view, &points, low, high);
    return STATUS_OK;
}

status runs_open(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    char id[LEDGER_ID], folder[1024];
    frame_player *player;
    status code = runs_named(app, s, argument, id, folder, r);
    if (code == STATUS_OK) code = frame_player_open(folder, 0, &player, r);
    if (code != STATUS_OK) return code;
    runs_close_player(s);
    s->player = player;
    snprintf(s->shown[0], LEDGER_ID, "%s", id);
    s->shown_count = 1;
    const char *field = frame_player_default_field(player);
    snprintf(s->field, sizeof s->field, "%s", field ? field : "");
    particle_view_forget(&s->view);
    code = runs_show_frame(app, s, 0, r);
    s->page = code == STATUS_OK ? RUNS_PLAYER : RUNS_TABLE;
    if (code != STATUS_OK) runs_close_player(s);
    app_log_argument(app, "%s", id);
    return code;
}

status runs_frame(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    if (!s->player) return report_set(r, STATUS_INPUT, "Open a run's frames with enter first.");
    s->playing = false;
    return runs_show_frame(app, s, frame_player_index(s->player, atoll(argument)), r);
}

status runs_colour(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    char before[RUNS_NAME];
    if (!s->player) return report_set(r, STATUS_INPUT, "Open a run's frames with enter first.");
    memcpy(before, s->field, sizeof before);
    int next = 0;
    for (int i = 0; frame_player_field(s->player, i); i++)
        if (strcmp(frame_player_field(s->player, i), s->field) == 0) next = i + 1;
    const char *field = argument[0] ? argument : frame_player_field(s->player, next);
    if (!field) field = frame_player_field(s->player, 0);
    snprintf(s->field, sizeof s->field, "%s", field ? field : "");
    status code = runs_show_frame(app, s, s->frame_index, r);
    report unused;
    if (code != STATUS_OK) {
        memcpy(s->field, before, sizeof before);
        (void)runs_show_frame(app, s, s->frame_index, &unused);
        return code;
    }
    app_log_argument(app, "%s", s->field);
    return STATUS_OK;
}

status runs_beside(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    (void)argument;
    if (s->mark_count != 2) return report_set(r, STATUS_INPUT, "Mark two runs with space first.");
    app_show(app, &screen_compare);
    status code = app_do(app, "compare.left", s->marks[0], r);
    return code == STATUS_OK ? app_do(app, "compare.right", s->marks[1], r) : code;
}

void runs_tick_player(tui_app *app, runs_state *s, double now) {
    report r;
    if (s->page != RUNS_PLAYER || !s->playing || now < s->next_frame) return;
    s->next_frame = now + frame_time;
    if (s->frame_index + 1 >= frame_player_count(s->player)) (void)frame_player_refresh(s->player, &r); /* a run that goes on */
    if (s->frame_index + 1 >= frame_player_count(s->player)) s->playing = false;
    else if (runs_show_frame(app, s, s->frame_index + 1, &r) != STATUS_OK) {
        s->playing = false;
        app_fail(app, &r);
    }
    app->dirty = true;
}

/* ---- the camera -------------------------------------------------------------------------------------------------- */

static status look(tui_app *app, const char *verb, report *r) {
    runs_state *s = runs_state_of(app);
    char text[96];
    app->dirty = true;
    return particle_view_act(&s->view, verb, NULL, text, r);
}

#define RUNS_LOOK(name, verb)                                              \
    status runs_##name(tui_app *app, const char *argument, report *r) {    \
        (void)argument;                                                    \
        return look(app, verb, r);                                         \
    }
RUNS_LOOK(turn_left, "turn-left")
RUNS_LOOK(turn_right, "turn-right")
RUNS_LOOK(tilt_up, "tilt-up")
RUNS_LOOK(tilt_down, "tilt-down")
RUNS_LOOK(zoom_in, "zoom-in")
RUNS_LOOK(zoom_out, "zoom-out")
RUNS_LOOK(reset, "reset")

/* ---- drawing ----------------------------------------------------------------------------------------------------- */

void runs_draw_player(tui_app *app, runs_state *s, tui_area area) {
    particle_points points = points_of(s);
    int last = frame_player_count(s->player) - 1;
    int column = draw_text(&app->theme, area, 0, 0, STYLE_STRONG, s->shown[0]);
    draw_format(&app->theme, area, 0, column, STYLE_DIM, "  frame %lld of %lld   t = %.4g   %s%s", (long long)s->frame.frame, (long long)frame_player_number(s->player, last),
                s->frame.time, s->field, s->playing ? "   playing" : "");
    timeline line = {.first = frame_player_number(s->player, 0), .last = frame_player_number(s->player, last), .now = s->frame.frame, .chosen = -1};
    timeline_draw(&line, &app->theme, area, area.height - 1);
    if (points.position) particle_view_draw(&s->view, &app->theme, (tui_area){area.y + 1, area.x, area.height - 2, area.width}, &points);
}
