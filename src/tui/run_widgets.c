/* The Run screen's lists: where the time goes, what has happened, how the histogram came about, what waits for a restart. */
#include "tui/format.h"
#include "tui/heat_map.h"
#include "tui/widgets.h"
#include "view/heat.h"
#include "view/plot.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { WIDEST_HISTORY = 256, TALLEST_HISTORY = 64, AXIS = 5, STAGE_NAME = 20, STAGE_NUMBER = 8, WIDEST_BAR = 60 };

/* ---- time -------------------------------------------------------------------------------------------------------- */

int widget_stages(tui_app *app, tui_area area, int row, int rows) {
    const session_snapshot *s = app->shot;
    if (rows < 2) return 0;
    draw_heading(&app->theme, area, row, "time of steps", NULL);
    if (s->stage_count == 0) {
        draw_text(&app->theme, area, row + 1, 0, STYLE_DIM, "nothing has been timed yet");
        return 2;
    }
    int used = 1, width = area.width - STAGE_NAME - STAGE_NUMBER - 2;
    width = width > WIDEST_BAR ? WIDEST_BAR : width;
    for (int i = 0; i < s->stage_count && used < rows; i++, used++) {
        const session_stage *stage = &s->stages[i];
        char bar[VIEW_PLOT_BYTES(WIDEST_BAR)], percent[FORMAT_BYTES], name[STAGE_NAME + 1];
        snprintf(name, sizeof name, "%s%.*s", stage->part ? "  " : "", STAGE_NAME - 2, stage->name);
        draw_text(&app->theme, area, row + used, 0, stage->part ? STYLE_DIM : STYLE_TEXT, name);
        format_percent(stage->share, percent);
        draw_right(&app->theme, area, row + used, STAGE_NAME + STAGE_NUMBER, stage->part ? STYLE_DIM : STYLE_STRONG, percent);
        if (width < 1) continue;
        view_bar(stage->share, width, app->theme.ascii, bar);
        draw_text(&app->theme, area, row + used, STAGE_NAME + STAGE_NUMBER + 2, stage->part ? STYLE_DIM : STYLE_PLOT, bar);
    }
    return used;
}

/* ---- events ------------------------------------------------------------------------------------------------------ */

static tui_style style_of(const session_event *event) {
    if (strcmp(event->kind, "warning") == 0) return STYLE_WARN;
    if (strcmp(event->kind, "first_crack") == 0) return STYLE_BAD;
    return strcmp(event->kind, "knob") == 0 ? STYLE_GOOD : STYLE_TEXT;
}

int widget_events(tui_app *app, tui_area area, int row, int rows) {
    const session_snapshot *s = app->shot;
    if (rows < 2) return 0;
    draw_heading(&app->theme, area, row, "events", s->event_count > rows - 1 ? "newest first" : NULL);
    if (s->event_count == 0) {
        draw_text(&app->theme, area, row + 1, 0, STYLE_DIM, "nothing has happened yet");
        return 2;
    }
    int used = 1;
    for (int i = s->event_count - 1; i >= 0 && used < rows; i--) {
        const session_event *event = &s->events[i];
        char frame[24];
        snprintf(frame, sizeof frame, "%" PRId64, event->frame);
        draw_right(&app->theme, area, row + used, 6, STYLE_DIM, frame);
        tui_area text = {area.y, area.x + 7, area.height, area.width - 7};
        used += draw_paragraph(&app->theme, text, row + used, rows - used > 3 ? 3 : rows - used, style_of(event), event->text);
    }
    return used;
}

/* ---- the histogram's history ------------------------------------------------------------------------------------- */

int widget_history(tui_app *app, const run_state *state, tui_area area, int row, int rows) {
    static double values[SESSION_BINS * SESSION_HISTORY], places[TALLEST_HISTORY * WIDEST_HISTORY];
    const session_snapshot *s = app->shot;
    int count = s->history_count, each = heat_map_rows(&app->theme);
    int height = (rows - 2) * each, width = area.width - AXIS;
    if (rows < 4 || width < 8 || count == 0) return 0;
    height = height > TALLEST_HISTORY ? TALLEST_HISTORY : height;
    width = width > WIDEST_HISTORY ? WIDEST_HISTORY : width;
    for (int bin = 0; bin < SESSION_BINS; bin++) {
        for (int i = 0; i < count; i++) values[bin * count + i] = s->history[i].histogram[SESSION_BINS - 1 - bin];
    }
    view_heat_resample(values, SESSION_BINS, count, places, height, width);
    double floor = 0.5 / (double)(s->particles > 0 ? s->particles : 1);
    view_heat_scale(places, height * width, state->log_histogram, floor);
    draw_heading(&app->theme, area, row, "damage over time", state->log_histogram ? "log" : "linear");
    draw_text(&app->theme, area, row + 1, 0, STYLE_DIM, "1.00");
    draw_text(&app->theme, area, row + height / each, 0, STYLE_DIM, "0.00");
    heat_map_draw(&app->theme, area, row + 1, AXIS, places, height, width);
    char last[32];
    draw_format(&app->theme, area, row + 1 + height / each, AXIS, STYLE_DIM, "%" PRId64, s->history[0].frame);
    snprintf(last, sizeof last, "frame %" PRId64, s->history[count - 1].frame);
    draw_right(&app->theme, area, row + 1 + height / each, AXIS + width, STYLE_DIM, last);
    return height / each + 2;
}

void widget_damage_panel(tui_app *app, const run_state *state, tui_area area) {
    static const int divisions[] = {50, 25, 10, 5};
    if (!app_has_damage(app)) {
        draw_text(&app->theme, area, 0, 0, STYLE_DIM, "this scene does not damage anything");
        return;
    }
    int history = area.height >= 14 ? area.height * 9 / 20 : 0, bins = 0;
    for (int i = 3; i >= 0; i--) {
        if (divisions[i] + 2 + history <= area.height) bins = divisions[i];
    }
    if (bins > 25 && area.height < 70) bins = 25;
    int used = bins > 0 ? widget_histogram(app, state, area, 0, bins) : 0;
    widget_history(app, state, area, used + 1, area.height - used - 1);
}

/* ---- what waits for a restart ------------------------------------------------------------------------------------ */

void widget_pending(tui_app *app, const run_state *state, tui_area area) {
    if (state->pending_count == 0) return;
    char text[320];
    snprintf(text, sizeof text, " %d for a restart (R): %s=%s%s ", state->pending_count, state->pending[0].path, state->pending[0].value,
             state->pending_count > 1 ? " …" : "");
    draw_blank(&app->theme, (tui_area){area.y, area.x, area.height, area.width}, area.height - 1, STYLE_TEXT);
    draw_text(&app->theme, area, area.height - 1, 0, STYLE_WARN, text);
}
