/* The list of sweeps, and the grid of one: a heat map of a measure over two parameters. */
#include "tui/sweeps.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LABEL_WIDTH = 12, CELL_WIDEST = 14 };

static void draw_list(tui_app *app, const sweep_state *s, tui_area area) {
    draw_text(&app->theme, area, 0, 0, STYLE_DIM, "Sweeps at hand: a scene over lists of values");
    if (s->script_count == 0) draw_text(&app->theme, area, 2, 2, STYLE_DIM, "None: Lua files in sweeps/ beside scenes that return s.sweep { ... }.");
    int rows = area.height - 2, top = s->script >= rows ? s->script - rows + 1 : 0;
    for (int i = 0; i < rows && top + i < s->script_count; i++) {
        tui_area line = {area.y + 2 + i, area.x, 1, area.width};
        bool here = top + i == s->script;
        if (here) draw_blank(&app->theme, line, 0, STYLE_BAR);
        draw_text(&app->theme, line, 0, 2, here ? STYLE_BAR_STRONG : STYLE_TEXT, s->scripts[top + i]);
    }
}

static void draw_axis(const tui_app *app, tui_area area, int row, const sweep_axis *axis, bool shown) {
    int column = draw_text(&app->theme, area, row, 2, shown ? STYLE_STRONG : STYLE_DIM, axis->name);
    column = draw_text(&app->theme, area, row, column, STYLE_DIM, "  ");
    for (int i = 0; i < axis->count && column < area.width; i++) column = draw_format(&app->theme, area, row, column, STYLE_TEXT, "%s%s", i ? ", " : "", axis->value[i]);
}

static int count_state(const sweep_state *s, sweep_run_state state) {
    int count = 0;
    for (int i = 0; i < s->count; i++) count += s->cells[i].known && s->cells[i].last.state == state;
    return count;
}

static void draw_head(tui_app *app, const sweep_state *s, tui_area area) {
    int column = draw_text(&app->theme, area, 0, 0, STYLE_STRONG, s->plan.title[0] ? s->plan.title : s->scripts[s->script]);
    const char *slash = strrchr(s->plan.scene, '/');
    column = draw_format(&app->theme, area, 0, column, STYLE_DIM, "  %s  ", slash ? slash + 1 : s->plan.scene);
    column = draw_format(&app->theme, area, 0, column, STYLE_GOOD, "%d done", count_state(s, SWEEP_DONE) + count_state(s, SWEEP_SKIPPED));
    if (count_state(s, SWEEP_FAILED)) column = draw_format(&app->theme, area, 0, column, STYLE_BAD, "  %d failed", count_state(s, SWEEP_FAILED));
    column = draw_format(&app->theme, area, 0, column, STYLE_DIM, "  of %d%s", s->count, s->listing ? "  looking what is done" : s->going ? "  going on" : "");
}

/* The range of the measure over all runs. */
static void find_range(const sweep_state *s, double *low, double *high) {
    *low = HUGE_VAL, *high = -HUGE_VAL;
    for (int i = 0; i < s->count; i++) {
        if (!isfinite(s->cells[i].value)) continue;
        *low = fmin(*low, s->cells[i].value);
        *high = fmax(*high, s->cells[i].value);
    }
}

static const char *state_word(const sweep_cell_result *cell) {
    if (!cell->known) return "";
    switch (cell->last.state) {
    case SWEEP_GOING: return "running";
    case SWEEP_FAILED: return "failed";
    case SWEEP_DONE:
    case SWEEP_SKIPPED: return "done";
    case SWEEP_WAITING: return "-";
    }
    return "";
}

/* Black or white, whichever is read on the colour: palettes grow lighter with the value. */
static tui_ink cell_ink(tui_app *app, double fraction) {
    int colour = theme_colour(&app->theme, (float)fraction, 1);
    if (colour < 0) return app->theme.styles[fraction > 0.5 ? STYLE_STRONG : STYLE_TEXT];
    bool dark_text = (fraction > 0.5) == (app->theme.palette != VIEW_INK);
    return theme_pair(&app->theme, dark_text ? (app->theme.colours >= 256 ? 16 : 0) : (app->theme.colours >= 256 ? 231 : 7), colour);
}

static void draw_cell(tui_app *app, const sweep_cell_result *cell, tui_area area, bool here, double low, double high) {
    char text[32];
    bool valued = isfinite(cell->value);
    double fraction = valued && high > low ? (cell->value - low) / (high - low) : 0.5;
    tui_ink ink = valued ? cell_ink(app, fraction) : app->theme.styles[cell->last.state == SWEEP_FAILED ? STYLE_BAD : cell->last.state == SWEEP_GOING ? STYLE_STRONG : STYLE_DIM];
    if (valued) snprintf(text, sizeof text, "%.3g", cell->value);
    else snprintf(text, sizeof text, "%s", state_word(cell));
    /* A space may be sent as an erasure, which not every terminal does in colour. */
    for (int row = 0; row < area.height; row++)
        for (int column = 0; column < area.width; column++) draw_glyph(area, row, column, ink, app->theme.ascii ? ' ' : 0xa0);
    int width = draw_width(text), at = width < area.width ? (area.width - width) / 2 : 0;
    draw_ink(&app->theme, area, area.height / 2, at, ink, text);
    if (!here) return;
    draw_ink(&app->theme, area, area.height / 2, 0, ink, app->theme.ascii ? ">" : "▸");
    draw_ink(&app->theme, area, area.height / 2, area.width - 1, ink, app->theme.ascii ? "<" : "◂");
}

static void draw_grid(tui_app *app, const sweep_state *s, tui_area area) {
    int rows = sweep_extent(s, 0), columns = sweep_extent(s, 1);
    int width = (area.width - LABEL_WIDTH) / columns, height = (area.height - 1) / rows;
    double low, high;
    find_range(s, &low, &high);
    width = width > CELL_WIDEST ? CELL_WIDEST : width < 2 ? 2 : width;
    height = height > 3 ? 3 : height < 1 ? 1 : height;
    /* What does not fit is seen by moving on: the cursor's cell is always in view. */
    int fit_rows = (area.height - 1) / height, fit_columns = (area.width - LABEL_WIDTH) / width;
    int top = s->at[0] >= fit_rows ? s->at[0] - fit_rows + 1 : 0, left = s->at[1] >= fit_columns ? s->at[1] - fit_columns + 1 : 0;
    for (int across = left; across < columns && across - left < fit_columns; across++) {
        tui_area label = {area.y, area.x + LABEL_WIDTH + (across - left) * width, 1, width};
        const char *text = s->axis[1] >= 0 ? s->plan.axes[s->axis[1]].value[across] : "";
        draw_text(&app->theme, label, 0, draw_width(text) < width ? (width - draw_width(text)) / 2 : 0, across == s->at[1] ? STYLE_STRONG : STYLE_DIM, text);
    }
    for (int down = top; down < rows && down - top < fit_rows; down++) {
        int y = area.y + 1 + (down - top) * height;
        tui_area label = {y + height / 2, area.x, 1, LABEL_WIDTH - 1};
        draw_right(&app->theme, label, 0, LABEL_WIDTH - 1, down == s->at[0] ? STYLE_STRONG : STYLE_DIM, s->axis[0] >= 0 ? s->plan.axes[s->axis[0]].value[down] : "");
        for (int across = left; across < columns && across - left < fit_columns; across++) {
            int run = sweep_run_at(s, down, across);
            tui_area cell = {y, area.x + LABEL_WIDTH + (across - left) * width, height, width};
            if (run >= 0) draw_cell(app, &s->cells[run], cell, down == s->at[0] && across == s->at[1], low, high);
        }
    }
}

static void draw_foot(tui_app *app, const sweep_state *s, tui_area area) {
    int run = sweep_run_at(s, s->at[0], s->at[1]);
    if (run < 0) return;
    const sweep_cell_result *cell = &s->cells[run];
    int column = draw_format(&app->theme, area, 0, 0, STYLE_DIM, "%d/%d ", run + 1, s->count);
    column = draw_format(&app->theme, area, 0, column, STYLE_STRONG, "%s", cell->last.id[0] ? cell->last.id : state_word(cell));
    if (isfinite(cell->value)) column = draw_format(&app->theme, area, 0, column, STYLE_TEXT, "  %s = %.6g", s->measure, cell->value);
    if (cell->last.message[0]) draw_format(&app->theme, area, 0, column, STYLE_BAD, "  %s", cell->last.message);
    else if (s->said[0] && s->child.ended && s->child.exit_code == 2) draw_format(&app->theme, area, 0, column, STYLE_DIM, "  %s", s->said);
}

void sweep_draw(tui_app *app, void *state, tui_area area) {
    sweep_state *s = state;
    area = draw_inset(area);
    if (!s->loaded) {
        draw_list(app, s, area);
        return;
    }
    int row = 1;
    draw_head(app, s, area);
    for (int a = 0; a < s->plan.axis_count && row < area.height / 2; a++, row++) {
        bool shown = a == s->axis[0] || a == s->axis[1];
        draw_axis(app, area, row, &s->plan.axes[a], shown);
        if (!shown) draw_format(&app->theme, area, row, area.width - 24, STYLE_STRONG, "held at %s", s->plan.axes[a].value[s->held[a]]);
    }
    int column = draw_text(&app->theme, area, row, 0, STYLE_HEAD, s->measure);
    if (s->axis[0] >= 0) draw_format(&app->theme, area, row, column, STYLE_DIM, "  of the last frame: %s down, %s across", s->plan.axes[s->axis[0]].name, s->plan.axes[s->axis[1]].name);
    row++;
    if (area.height - row - 1 >= 2) draw_grid(app, s, (tui_area){area.y + row, area.x, area.height - row - 1, area.width});
    draw_foot(app, s, (tui_area){area.y + area.height - 1, area.x, 1, area.width});
}
