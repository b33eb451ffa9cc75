/* Curves of the marked runs over time, and of one measure against a parameter over all runs that are shown. */
#include "tui/runs.h"

#include "base/memory.h"
#include "tui/chart_draw.h"

#include <stdio.h>
#include <string.h>

/* ---- what is drawn ----------------------------------------------------------------------------------------------- */

static status read_over_time(runs_state *s, report *r) {
    status code = STATUS_OK;
    s->curve_count = s->shown_count;
    for (int i = 0; i < s->shown_count && code == STATUS_OK; i++) code = run_curve_read(s->l, s->shown[i], s->measure, &s->curves[i], r);
    return code;
}

/* From the columns: a query for each run would take too long over thousands. */
static status read_against(runs_state *s, report *r) {
    const run_column *x, *y;
    run_curve *curve = &s->curves[0];
    status code = run_table_column(s->table, s->against, &x, r);
    if (code == STATUS_OK) code = run_table_column(s->table, s->measure, &y, r);
    if (code != STATUS_OK) return code;
    run_curve_free(curve);
    curve->x = memory_allocate_array((size_t)s->row_count, sizeof *curve->x);
    curve->y = memory_allocate_array((size_t)s->row_count, sizeof *curve->y);
    curve->capacity = s->row_count;
    if (!curve->x || !curve->y) {
        run_curve_free(curve);
        return report_set(r, STATUS_SYSTEM, "out of memory for a plot");
    }
    for (int i = 0; i < s->row_count; i++) {
        int row = s->rows[i];
        if (x->number[row] != x->number[row] || y->number[row] != y->number[row]) continue; /* NaN: the run lacks it */
        curve->x[curve->count] = x->number[row];
        curve->y[curve->count++] = y->number[row];
    }
    s->curve_count = 1;
    return STATUS_OK;
}

status runs_read_curves(runs_state *s, report *r) {
    return s->against[0] ? read_against(s, r) : read_over_time(s, r);
}

static status show(tui_app *app, runs_state *s, report *r) {
    status code = s->against[0] ? STATUS_OK : runs_choose_shown(s, 1, r);
    if (code == STATUS_OK) code = runs_read_curves(s, r);
    if (code == STATUS_OK) s->page = RUNS_PLOT;
    app->dirty = true;
    return code;
}

status runs_plot(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    const run_column *c = NULL;
    if (!s->table) return report_set(r, STATUS_INPUT, "%s", s->trouble);
    status code = argument[0] ? run_table_column(s->table, argument, &c, r) : STATUS_OK;
    if (code != STATUS_OK) return code;
    if (argument[0]) snprintf(s->measure, sizeof s->measure, "%s", c->name);
    if (s->page != RUNS_PLOT) s->against[0] = '\0';
    return show(app, s, r);
}

/* The measure after (or before) the one that is shown, in the order of names. */
status runs_next_measure(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    const char *names[512], *name;
    run_column_kind kind;
    int count = 0, now = 0;
    for (int i = 0; s->table && count < 512 && (name = run_table_name(s->table, i, &kind)); i++) {
        if (kind != RUN_COLUMN_MEASURE) continue;
        if (strcmp(name, s->measure) == 0) now = count;
        names[count++] = name;
    }
    if (count == 0) return report_set(r, STATUS_INPUT, "No run has measures yet.");
    now = (now + (strcmp(argument, "back") == 0 ? count - 1 : 1)) % count;
    snprintf(s->measure, sizeof s->measure, "%s", names[now]);
    return show(app, s, r);
}

status runs_against(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    const run_column *c = NULL;
    if (!s->table) return report_set(r, STATUS_INPUT, "%s", s->trouble);
    bool time = strcmp(argument, "time") == 0;
    status code = time ? STATUS_OK : run_table_column(s->table, argument, &c, r);
    if (code == STATUS_OK && !time && !c->numeric) code = report_input(r, NULL, 0, argument, "a column of numbers", "texts", NULL);
    if (code != STATUS_OK) return code;
    snprintf(s->against, sizeof s->against, "%s", time ? "" : c->name);
    return show(app, s, r);
}

status runs_logarithmic(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    (void)argument, (void)r;
    s->log_plot = !s->log_plot;
    app->dirty = true;
    return STATUS_OK;
}

/* ---- drawing ----------------------------------------------------------------------------------------------------- */

static int draw_legend(tui_app *app, const runs_state *s, tui_area area) {
    int rows = s->curve_count > 1 ? (s->curve_count < area.height / 3 ? s->curve_count : area.height / 3) : 0;
    for (int i = 0; i < rows; i++) {
        char text[RUNS_NAME + 8];
        snprintf(text, sizeof text, "%c  %s%s", view_chart_letter(i), s->shown[i], s->curves[i].count ? "" : "  (nothing)");
        draw_ink(&app->theme, area, area.height - rows + i, 2, chart_ink(app, i), text);
        if (i == rows - 1 && rows < s->curve_count) draw_format(&app->theme, area, area.height - 1, 32, STYLE_DIM, "and %d more", s->curve_count - rows);
    }
    return rows;
}

void runs_draw_plot(tui_app *app, runs_state *s, tui_area area) {
    view_chart_series series[RUNS_MARKS];
    bool against = s->against[0] != '\0';
    int column = draw_text(&app->theme, area, 0, 0, STYLE_STRONG, s->measure);
    column = draw_format(&app->theme, area, 0, column, STYLE_DIM, against ? " of the last frame against " : " over time");
    if (against) draw_format(&app->theme, area, 0, column, STYLE_STRONG, "%s (%d runs)", s->against, s->curves[0].count);
    tui_area body = {area.y + 1, area.x, area.height - 1, area.width};
    body.height -= against ? 0 : draw_legend(app, s, body);
    view_chart_options o = {.width = body.width, .height = body.height, .ascii = app->theme.ascii, .log_y = s->log_plot, .x_label = against ? s->against : "time"};
    if (o.width < VIEW_CHART_LEAST_WIDTH || o.height < VIEW_CHART_LEAST_HEIGHT) return;
    size_t n = (size_t)o.width * (size_t)o.height;
    view_chart_cell *cells = memory_allocate_array(n, sizeof *cells);
    if (!cells) return;
    for (int i = 0; i < s->curve_count; i++) series[i] = (view_chart_series){s->curves[i].x, s->curves[i].y, s->curves[i].count, against};
    view_chart(series, s->curve_count, &o, cells);
    chart_draw(app, body, &o, cells);
    memory_free(cells, n * sizeof *cells);
}
