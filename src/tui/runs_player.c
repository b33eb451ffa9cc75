/* A past run's frames, one after the other. */
#include "tui/runs.h"

#include "base/names.h"
#include "store/frames.h"
#include "tui/timeline.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double frame_time = 1. / 24; /* s between two frames that are played */

/* ---- the player -------------------------------------------------------------------------------------------------- */

/* What has been read of the run whose frames are shown; NULL while there is nothing. */
static const frame_page *page_of(const runs_state *s) {
    const frame_page *page = s->reader ? frame_reader_page(s->reader) : NULL;
    return page && strcmp(page->folder, s->frames_of) == 0 ? page : NULL;
}

static status need_frames(const runs_state *s, report *r) {
    return s->page == RUNS_PLAYER ? STATUS_OK : report_set(r, STATUS_INPUT, "Open a run's frames with enter first.");
}

static particle_points points_of(const frame_page *page) {
    return (particle_points){.position = page->view.position, .scalar = page->view.value, .count = page->view.count, .name = page->field, .unit = "",
                             .natural = {(double)page->view.low, (double)page->view.high}};
}

static void ask(tui_app *app, runs_state *s) {
    frame_reader_ask(s->reader, s->frames_of, s->frame, s->field, false);
    app->dirty = true;
}

status runs_show_frame(tui_app *app, runs_state *s, int64_t frame, report *r) {
    status code = need_frames(s, r);
    if (code != STATUS_OK) return code;
    s->frame = frame < 0 ? 0 : frame;
    ask(app, s);
    return STATUS_OK;
}

/* Beyond the last one there may be more by now: a run that goes on. */
status runs_show_further(tui_app *app, runs_state *s, int by, report *r) {
    const frame_page *page = page_of(s);
    status code = need_frames(s, r);
    if (code != STATUS_OK || !page || page->frame_count == 0) return code;
    int index = frame_page_index(page, s->frame) + by, last = page->frame_count - 1;
    return runs_show_frame(app, s, index > last ? page->frames[last] + 1 : page->frames[index < 0 ? 0 : index], r);
}

static void wake(void *context) {
    app_wake(context);
}

status runs_open(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    char id[LEDGER_ID], folder[READER_PATH];
    status code = runs_named(app, s, argument, id, folder, r);
    if (code == STATUS_OK && frame_last(folder) < 0)
        code = report_input(r, folder, 0, NULL, "a run's folder with frames in it", "none", NULL);
    if (code == STATUS_OK && !s->reader) code = frame_reader_open(0, wake, app, &s->reader, r);
    if (code != STATUS_OK) return code;
    memcpy(s->frames_of, folder, sizeof folder);
    snprintf(s->shown[0], LEDGER_ID, "%s", id);
    s->shown_count = 1;
    s->field[0] = '\0';
    s->playing = false;
    s->page = RUNS_PLAYER;
    particle_view_forget(&s->view);
    app_log_argument(app, "%s", id);
    return runs_show_frame(app, s, 0, r);
}

status runs_frame(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    s->playing = false;
    return runs_show_frame(app, s, atoll(argument), r);
}

/* A quantity that the run does not have. */
static status refuse_field(const frame_page *page, const char *field, report *r) {
    const char *names[READER_FIELDS];
    for (int i = 0; i < page->field_count; i++) names[i] = page->fields[i];
    return report_input(r, page->folder, 0, "field", "a quantity of this run's particles", field, name_nearest(field, names, page->field_count));
}

status runs_colour(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    const frame_page *page = page_of(s);
    status code = need_frames(s, r);
    if (code != STATUS_OK) return code;
    if (argument[0] && page && !frame_page_has(page, argument)) return refuse_field(page, argument, r);
    if (argument[0]) snprintf(s->field, sizeof s->field, "%.31s", argument);
    else if (page && page->field_count > 0) {
        int next = 0;
        for (int i = 0; i < page->field_count; i++)
            if (strcmp(page->fields[i], s->field) == 0) next = i + 1;
        memcpy(s->field, page->fields[next < page->field_count ? next : 0], sizeof s->field);
    }
    app_log_argument(app, "%s", s->field);
    ask(app, s);
    return STATUS_OK;
}

/* A page has come: what was asked for is now known to be there, or not. */
static void take_page(tui_app *app, runs_state *s, const frame_page *page) {
    report r;
    app->dirty = true;
    if (!page->has_frame) {
        app_notice(app, "%s", page->problem);
        s->playing = false;
        return;
    }
    if (s->field[0] && strcmp(s->field, page->field) != 0 && !frame_page_has(page, s->field)) {
        (void)refuse_field(page, s->field, &r);
        app_fail(app, &r);
        s->field[0] = '\0';
        ask(app, s);
        return;
    }
    if (!s->field[0]) memcpy(s->field, page->field, sizeof s->field);
    if (page->asked == s->frame && page->view.frame < s->frame) {
        s->frame = page->view.frame;
        s->playing = false; /* there are no more */
    }
    particle_points points = points_of(page);
    particle_view_follow(&s->view, &points, page->low, page->high);
}

void runs_tick_player(tui_app *app, runs_state *s, double now) {
    report unused;
    if (s->page != RUNS_PLAYER || !s->reader) return;
    if (frame_reader_poll(s->reader) && page_of(s)) take_page(app, s, page_of(s));
    if (!s->playing || now < s->next_frame || frame_reader_busy(s->reader)) return;
    s->next_frame = now + frame_time;
    (void)runs_show_further(app, s, 1, &unused);
}

status runs_beside(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    (void)argument;
    if (s->mark_count != 2) return report_set(r, STATUS_INPUT, "Mark two runs with space first.");
    app_show(app, &screen_compare);
    status code = app_do(app, "compare.left", s->marks[0], r);
    return code == STATUS_OK ? app_do(app, "compare.right", s->marks[1], r) : code;
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
    const frame_page *page = page_of(s);
    int column = draw_text(&app->theme, area, 0, 1, STYLE_STRONG, s->shown[0]);
    if (!page || !page->has_frame) {
        bool wrong = page && page->problem[0];
        draw_paragraph(&app->theme, (tui_area){area.y + 1, area.x + 1, area.height - 1, area.width - 2}, area.height / 2 - 1, 3, wrong ? STYLE_BAD : STYLE_DIM,
                       wrong ? page->problem : "reading its frames …");
        return;
    }
    int64_t last = page->frames[page->frame_count - 1];
    const char *doing = s->frame != page->view.frame && frame_reader_busy(s->reader) ? "   reading" : s->playing ? "   playing" : "";
    draw_format(&app->theme, area, 0, column, STYLE_DIM, "  frame %lld of %lld   t = %.4g   %s%s", (long long)page->view.frame, (long long)last, page->view.time,
                page->field, doing);
    timeline line = {.first = page->frames[0], .last = last, .now = page->view.frame, .chosen = -1};
    timeline_draw(&line, &app->theme, area, area.height - 1);
    particle_points points = points_of(page);
    particle_view_draw(&s->view, &app->theme, (tui_area){area.y + 1, area.x, area.height - 2, area.width}, &points);
}
