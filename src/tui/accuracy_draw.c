/* The levels of each axis as a table, and error against seconds as curves: beside it, below it, or in its place. */
#include "tui/accuracy_view.h"

#include "base/memory.h"
#include "tui/chart_draw.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { TABLE_WIDTH = 78, CHART_HEIGHT = 14, BOTH_WIDTH = 130, BOTH_HEIGHT = 40, NOTES = 6 };

static const char *shown_name(const accuracy_view *s) {
    return s->shown >= 0 ? s->measures[s->shown] : s->shown == -2 ? "to crack" : "error";
}

static void share(double value, bool about, char text[24]) {
    if (isnan(value)) text[0] = '\0';
    else if (value >= 0.0995) snprintf(text, 24, "%s%.0f %%", about ? "~" : "", 100 * value);
    else snprintf(text, 24, "%s%.2g %%", about ? "~" : "", 100 * value);
}

static double own_seconds(const accuracy_view *s) {
    for (int i = 0; i < s->level_count; i++)
        if (s->level[i].own && isfinite(s->level[i].number[COLUMN_STEP_SECONDS])) return s->level[i].number[COLUMN_STEP_SECONDS];
    return NAN;
}

/* ---- the table --------------------------------------------------------------------------------------------------- */

/* Columns end at these places. */
enum { END_VALUE = 22, END_SECONDS = 32, END_TIME = 41, END_ERROR = 52, END_ESTIMATE = 62, AT_STATE = 64 };

static void draw_number(tui_app *app, tui_area area, int row, int end, tui_style style, const char *format, double value) {
    char text[32];
    if (isnan(value)) return;
    snprintf(text, sizeof text, format, value);
    draw_right(&app->theme, area, row, end, style, text);
}

static tui_style state_style(const view_level *l) {
    if (strcmp(l->state, "failed") == 0) return STYLE_BAD;
    return strcmp(l->state, "started") == 0 ? STYLE_STRONG : STYLE_DIM;
}

static void draw_level(tui_app *app, const accuracy_view *s, const view_level *l, tui_area area, int row, bool here) {
    char text[24];
    bool about, on = s->axes[l->axis].on;
    tui_style style = here ? STYLE_BAR_STRONG : on ? STYLE_TEXT : STYLE_DIM, dim = here ? STYLE_BAR : STYLE_DIM;
    double seconds = l->number[COLUMN_STEP_SECONDS], error = accuracy_view_error(s, l, &about);
    if (here) draw_blank(&app->theme, area, row, STYLE_BAR);
    draw_text(&app->theme, area, row, 2, l->frontier && !here ? STYLE_GOOD : style, l->frontier ? "+" : " ");
    draw_text(&app->theme, area, row, 4, style, l->own ? "*" : " ");
    draw_right(&app->theme, area, row, END_VALUE, style, l->value);
    if (isnan(seconds)) draw_number(app, area, row, END_SECONDS, dim, "~%.3g", l->number[COLUMN_PREDICTED]);
    else draw_number(app, area, row, END_SECONDS, style, "%.3g", seconds);
    draw_number(app, area, row, END_TIME, style, "%.3gx", seconds / own_seconds(s));
    share(error, about, text);
    draw_right(&app->theme, area, row, END_ERROR, style, text);
    share(l->number[COLUMN_ESTIMATE], true, text);
    draw_right(&app->theme, area, row, END_ESTIMATE, dim, text);
    draw_text(&app->theme, area, row, AT_STATE, here ? STYLE_BAR : state_style(l), l->reference ? "reference" : strcmp(l->state, "done") == 0 ? "" : l->state);
}

static void draw_axis(tui_app *app, const accuracy_view *s, const view_level *l, tui_area area, int row) {
    const view_axis *axis = &s->axes[l->axis];
    tui_ink ink = axis->on ? chart_ink(app, l->axis) : app->theme.styles[STYLE_DIM];
    int column = draw_text(&app->theme, area, row, 0, axis->on ? STYLE_STRONG : STYLE_DIM, axis->on ? "[x] " : "[ ] ");
    column = draw_ink(&app->theme, area, row, column, ink, axis->name);
    if (strcmp(axis->name, l->key) != 0) column = draw_format(&app->theme, area, row, column, STYLE_DIM, ": %s", l->key);
    if (isfinite(l->number[COLUMN_ORDER])) draw_format(&app->theme, area, row, column, STYLE_DIM, "  order %.2g", l->number[COLUMN_ORDER]);
}

/* Rows of the table before level `until`: an axis has one of its own. */
static int rows_before(const accuracy_view *s, int from, int until) {
    int rows = 0;
    for (int i = from; i < until; i++) rows += 1 + (i == from || s->level[i].axis != s->level[i - 1].axis);
    return rows;
}

static void draw_table(tui_app *app, accuracy_view *s, tui_area area) {
    static const char *const heads[] = {"steps s", "time", NULL, "in all"};
    static const int ends[] = {END_SECONDS, END_TIME, END_ERROR, END_ESTIMATE};
    for (int i = 0; i < 4; i++) draw_right(&app->theme, area, 0, ends[i], STYLE_HEAD, heads[i] ? heads[i] : shown_name(s));
    int room = area.height - 1;
    if (s->cursor < s->top) s->top = s->cursor;
    while (s->top < s->cursor && rows_before(s, s->top, s->cursor + 1) > room) s->top++;
    for (int i = s->top, row = 1; i < s->level_count && row < area.height; i++) {
        const view_level *l = &s->level[i];
        if (i == s->top || s->level[i - 1].axis != l->axis) draw_axis(app, s, l, area, row++);
        if (row < area.height) draw_level(app, s, l, area, row++, i == s->cursor);
    }
}

/* ---- the curves -------------------------------------------------------------------------------------------------- */

/* Lines are axes; after them come points for what is worth its time. */
static const char *line_name(const accuracy_view *s, int line) {
    return line < s->axis_count ? s->axes[line].name : "worth its time";
}

static void draw_curves(tui_app *app, const accuracy_view *s, tui_area area) {
    double x[VIEW_AXES + 1][VIEW_ROWS], y[VIEW_AXES + 1][VIEW_ROWS];
    int count[VIEW_AXES + 1] = {0}, lines = s->axis_count + 1;
    view_chart_series series[VIEW_AXES + 1];
    int column = draw_text(&app->theme, area, 0, 0, STYLE_STRONG, shown_name(s));
    draw_text(&app->theme, area, 0, column, STYLE_DIM, " against seconds of steps: down and to the left is better");
    for (int i = 0; i < s->level_count; i++) {
        bool about;
        const view_level *l = &s->level[i];
        double error = accuracy_view_error(s, l, &about);
        if (!(error > 0) || isnan(l->number[COLUMN_STEP_SECONDS])) continue;
        for (int k = 0; k < 1 + l->frontier; k++) {
            int line = k ? s->axis_count : l->axis;
            x[line][count[line]] = l->number[COLUMN_STEP_SECONDS];
            y[line][count[line]++] = error;
        }
    }
    for (int a = 0; a < lines; a++) series[a] = (view_chart_series){x[a], y[a], count[a], a == s->axis_count};
    int legend = 0, at = 0;
    for (int a = 0; a < lines; a++) {
        int width = draw_width(line_name(s, a)) + 4;
        if (count[a] == 0) continue;
        if (at > 0 && at + width > area.width) legend++, at = 0;
        at += width;
    }
    view_chart_options o = {.width = area.width, .height = area.height - 2 - legend, .ascii = app->theme.ascii, .log_x = true, .log_y = true, .x_label = "s"};
    if (o.width < VIEW_CHART_LEAST_WIDTH || o.height < VIEW_CHART_LEAST_HEIGHT) return;
    size_t n = (size_t)o.width * (size_t)o.height;
    view_chart_cell *cells = memory_allocate_array(n, sizeof *cells);
    if (!cells) return;
    view_chart(series, lines, &o, cells);
    chart_draw(app, (tui_area){area.y + 1, area.x, o.height, area.width}, &o, cells);
    memory_free(cells, n * sizeof *cells);
    int row = area.height - 1 - legend;
    at = 0;
    for (int a = 0; a < lines; a++) {
        char text[VIEW_WORD + 8];
        if (count[a] == 0) continue;
        if (at > 0 && at + draw_width(line_name(s, a)) + 4 > area.width) row++, at = 0;
        snprintf(text, sizeof text, "%c %s  ", view_chart_letter(a), line_name(s, a));
        at = draw_ink(&app->theme, area, row, at, chart_ink(app, a), text);
    }
}

/* ---- the rest ---------------------------------------------------------------------------------------------------- */

static void draw_hint(tui_app *app, const accuracy_view *s, tui_area area) {
    static const char *const lines[] = {
        "What accuracy costs in time: a scene is run coarser and finer along each of",
        "its axes, all else equal; every choice is shown with its seconds and its", "error, and with whether it is worth its time.", "",
        "Enter   takes the scene that is chosen on Scenes, with its settings", "c       takes the one of the run in view"};
    draw_text(&app->theme, area, 0, 0, STYLE_HEAD, "Accuracy");
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) draw_text(&app->theme, area, 2 + (int)i, 2, STYLE_DIM, lines[i]);
    if (s->words[0]) draw_format(&app->theme, area, 9, 2, STYLE_TEXT, "%s %s", s->looking ? "Looking at" : "Chosen:", s->words);
    if (s->words[0] && !s->looking && s->said[0]) (void)draw_paragraph(&app->theme, (tui_area){area.y + 11, area.x + 2, area.height - 11, area.width - 2}, 0, 4, STYLE_BAD, s->said);
}

static int draw_head(tui_app *app, const accuracy_view *s, tui_area area) {
    int column = draw_text(&app->theme, area, 0, 0, STYLE_STRONG, s->title[0] ? s->title : s->words);
    draw_text(&app->theme, area, 0, column, STYLE_DIM, s->looking ? "  looking" : s->going ? "  going on" : "");
    column = draw_format(&app->theme, area, 1, 0, STYLE_DIM, "%d levels", s->levels);
    if (s->frames > 0) column = draw_format(&app->theme, area, 1, column, STYLE_DIM, ", %ld frames", s->frames);
    if (s->budget > 0) column = draw_format(&app->theme, area, 1, column, STYLE_DIM, ", at most %ld s", s->budget);
    double seconds = 0;
    int runs = 0;
    bool own = false;
    for (int i = 0; i < s->level_count; i++) {
        const view_level *l = &s->level[i];
        if (!isfinite(l->number[COLUMN_PREDICTED]) || isfinite(l->number[COLUMN_STEP_SECONDS]) || !s->axes[l->axis].on || (l->own && own)) continue;
        own |= l->own;
        seconds += l->number[COLUMN_PREDICTED];
        runs++;
    }
    if (runs > 0) draw_format(&app->theme, area, 1, column, STYLE_TEXT, ": %d runs to make, about %.3g s", runs, seconds);
    return 2;
}

/* What is to be said of the level under the cursor, and what the study advises. */
static int draw_foot(tui_app *app, const accuracy_view *s, tui_area area, int rows) {
    if (s->cursor >= s->level_count) return 0;
    const view_level *l = &s->level[s->cursor];
    tui_area foot = {area.y + area.height - rows, area.x, rows, area.width};
    int column = draw_format(&app->theme, foot, 0, 0, STYLE_STRONG, "%s %s", l->key, l->value);
    column = draw_format(&app->theme, foot, 0, column, STYLE_DIM, "  %s", l->run);
    if (l->message[0]) draw_format(&app->theme, foot, 0, column, STYLE_BAD, "  %s", l->message);
    else if (l->dominated[0]) draw_format(&app->theme, foot, 0, column, STYLE_TEXT, "  %s is faster and better", l->dominated);
    else if (l->frontier) draw_text(&app->theme, foot, 0, column, STYLE_GOOD, "  worth its time");
    int row = 1;
    for (int i = 0; i < s->note_count && row < rows; i++) row += draw_paragraph(&app->theme, foot, row, rows - row, STYLE_DIM, s->notes[i]);
    return rows;
}

void accuracy_view_draw(tui_app *app, void *state, tui_area area) {
    accuracy_view *s = state;
    area = draw_inset(area);
    if (s->level_count == 0) {
        draw_hint(app, s, area);
        return;
    }
    int head = draw_head(app, s, area), foot = area.height >= BOTH_HEIGHT ? NOTES + 2 : s->note_count > 0 && area.height > 14 ? 3 : 1;
    draw_foot(app, s, area, foot);
    tui_area body = {area.y + head, area.x, area.height - head - foot, area.width};
    if (area.width >= BOTH_WIDTH) {
        draw_table(app, s, (tui_area){body.y, body.x, body.height, TABLE_WIDTH});
        draw_curves(app, s, (tui_area){body.y, body.x + TABLE_WIDTH + 2, body.height, body.width - TABLE_WIDTH - 2});
    } else if (area.height >= BOTH_HEIGHT) {
        draw_table(app, s, (tui_area){body.y, body.x, body.height - CHART_HEIGHT, body.width});
        draw_curves(app, s, (tui_area){body.y + body.height - CHART_HEIGHT, body.x, CHART_HEIGHT, body.width});
    } else if (s->plot) {
        draw_curves(app, s, body);
    } else {
        draw_table(app, s, body);
    }
}
