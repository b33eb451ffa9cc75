/* The table of runs. */
#include "tui/runs.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum { WIDEST = 26, GAP = 1, MARK_WIDTH = 2 };

/* ---- cells ------------------------------------------------------------------------------------------------------- */

static void format_instant(double seconds, char text[RUNS_CELL]) {
    time_t whole = (time_t)seconds;
    struct tm local;
    localtime_r(&whole, &local);
    strftime(text, RUNS_CELL, "%Y-%m-%d %H:%M", &local);
}

static void format_span(double seconds, char text[RUNS_CELL]) {
    int64_t whole = (int64_t)seconds;
    if (seconds < 60) snprintf(text, RUNS_CELL, "%.1f s", seconds);
    else if (whole < 3600) snprintf(text, RUNS_CELL, "%" PRId64 ":%02" PRId64, whole / 60, whole % 60);
    else snprintf(text, RUNS_CELL, "%" PRId64 ":%02" PRId64 ":%02" PRId64, whole / 3600, whole / 60 % 60, whole % 60);
}

/* A cell as people read it. */
static void format_cell(const run_column *c, int row, char text[RUNS_CELL]) {
    double number = c->number[row];
    bool own = c->kind == RUN_COLUMN_OWN;
    if (c->text[row]) snprintf(text, RUNS_CELL, "%s", c->text[row]);
    else if (isnan(number)) snprintf(text, RUNS_CELL, "%s", "");
    else if (own && strcmp(c->name, "started") == 0) format_instant(number, text);
    else if (own && strcmp(c->name, "wall_s") == 0) format_span(number, text);
    else if (fabs(number) < 1e9 && number == rint(number)) snprintf(text, RUNS_CELL, "%.0f", number);
    else snprintf(text, RUNS_CELL, "%.5g", number);
}

static tui_style style_of(const run_column *c, int row) {
    if (c->kind != RUN_COLUMN_OWN || strcmp(c->name, "status") != 0 || !c->text[row]) return STYLE_TEXT;
    const char *word = c->text[row];
    return strcmp(word, "done") == 0 ? STYLE_GOOD : strcmp(word, "running") == 0 ? STYLE_STRONG : strcmp(word, "interrupted") == 0 ? STYLE_WARN : STYLE_BAD;
}

/* ---- columns ----------------------------------------------------------------------------------------------------- */

/* A column's name as short as it can be said: "eta" for "tube.damage.eta" when no other ends so. */
static const char *title_of(const runs_state *s, const run_column *c) {
    const char *dot = strrchr(c->name, '.');
    const run_column *meant;
    report unused;
    return dot && run_table_column(s->table, dot + 1, &meant, &unused) == STATUS_OK && meant == c ? dot + 1 : c->name;
}

/* What a column takes: its widest cell in view, or its title with the arrow of sorting. */
static int column_width(const runs_state *s, const run_column *c, int rows) {
    int width = draw_width(title_of(s, c)) + 2;
    for (int i = s->top; i < s->top + rows && i < s->row_count; i++) {
        char text[RUNS_CELL];
        format_cell(c, s->rows[i], text);
        int here = draw_width(text);
        if (here > width) width = here;
    }
    return width < WIDEST ? width : WIDEST;
}

typedef struct shown_column {
    const run_column *column;
    int at, width, index; /* index: in the state's columns */
} shown_column;

/* The columns that fit: the first, and those from one on that leaves the cursor's in view; how many. */
static int lay_columns(runs_state *s, int rows, int width, shown_column out[RUNS_COLUMNS]) {
    int widths[RUNS_COLUMNS];
    const run_column *columns[RUNS_COLUMNS];
    report unused;
    for (int i = 0; i < s->column_count; i++) {
        if (run_table_column(s->table, s->columns[i], &columns[i], &unused) != STATUS_OK) columns[i] = NULL;
        widths[i] = columns[i] ? column_width(s, columns[i], rows) : 1;
    }
    int first = 1, taken = 0, count = 0, at = 0;
    for (int i = 0; i <= s->column && i < s->column_count; i++) taken += widths[i] + GAP;
    while (first < s->column && taken > width) taken -= widths[first++] + GAP;
    for (int i = 0; i < s->column_count && at < width; i = i == 0 ? first : i + 1) {
        int here = at + widths[i] <= width ? widths[i] : width - at;
        if (columns[i]) out[count++] = (shown_column){columns[i], at, here, i};
        at += widths[i] + GAP;
    }
    return count;
}

static void draw_titles(tui_app *app, const runs_state *s, tui_area line, const shown_column *columns, int count) {
    for (int i = 0; i < count; i++) {
        const shown_column *c = &columns[i];
        bool sorted = strcmp(c->column->name, s->sort) == 0;
        const char *arrow = !sorted ? "" : app->theme.ascii ? (s->descending ? " v" : " ^") : s->descending ? " ▼" : " ▲";
        char text[RUNS_NAME + 8];
        snprintf(text, sizeof text, "%s%s", title_of(s, c->column), arrow);
        tui_area cell = {line.y, line.x + MARK_WIDTH + c->at, 1, c->width};
        tui_style style = c->index == s->column ? STYLE_BAR_STRONG : STYLE_HEAD;
        if (c->index == s->column) draw_blank(&app->theme, cell, 0, style);
        if (c->column->numeric) draw_right(&app->theme, cell, 0, c->width, style, text);
        else draw_text(&app->theme, cell, 0, 0, style, text);
    }
}

static void draw_row(tui_app *app, const runs_state *s, tui_area line, int index, const shown_column *columns, int count) {
    int row = s->rows[index];
    bool here = index == s->cursor, marked = runs_is_marked(s, run_table_id(s->table, row));
    if (here) draw_blank(&app->theme, line, 0, STYLE_BAR);
    if (marked) draw_text(&app->theme, line, 0, 0, here ? STYLE_BAR_STRONG : STYLE_STRONG, app->theme.ascii ? "*" : "●");
    for (int i = 0; i < count; i++) {
        const shown_column *c = &columns[i];
        char text[RUNS_CELL];
        format_cell(c->column, row, text);
        tui_area cell = {line.y, line.x + MARK_WIDTH + c->at, 1, c->width};
        tui_style style = here ? STYLE_BAR_STRONG : marked && c->index == 0 ? STYLE_STRONG : style_of(c->column, row);
        if (c->column->numeric) draw_right(&app->theme, cell, 0, c->width, style, text);
        else draw_text(&app->theme, cell, 0, 0, style, text);
    }
}

static void draw_head(tui_app *app, const runs_state *s, tui_area area) {
    int column = draw_format(&app->theme, area, 0, 0, STYLE_STRONG, "%d", s->row_count);
    column = draw_format(&app->theme, area, 0, column, STYLE_DIM, " of %d runs", run_table_rows(s->table));
    if (s->filter[0]) {
        column = draw_text(&app->theme, area, 0, column, STYLE_DIM, "  that fit ");
        column = draw_text(&app->theme, area, 0, column, STYLE_STRONG, s->filter);
    }
    if (s->mark_count) draw_format(&app->theme, area, 0, column, STYLE_DIM, "  %d marked", s->mark_count);
}

static void draw_table(tui_app *app, runs_state *s, tui_area area) {
    shown_column columns[RUNS_COLUMNS];
    int rows = area.height - 2;
    s->page_rows = rows;
    if (s->cursor < s->top) s->top = s->cursor;
    if (s->cursor >= s->top + rows) s->top = s->cursor - rows + 1;
    if (s->top > 0 && s->top + rows > s->row_count) s->top = s->row_count > rows ? s->row_count - rows : 0;
    int count = lay_columns(s, rows, area.width - MARK_WIDTH, columns);
    draw_head(app, s, area);
    draw_titles(app, s, (tui_area){area.y + 1, area.x, 1, area.width}, columns, count);
    for (int i = 0; i < rows && s->top + i < s->row_count; i++)
        draw_row(app, s, (tui_area){area.y + 2 + i, area.x, 1, area.width}, s->top + i, columns, count);
    if (s->row_count > 0) return;
    draw_text(&app->theme, area, 3, 2, STYLE_DIM, s->filter[0] ? "No run fits: A shows all." : "No run yet: start one on the screen Scenes, or with sunder run.");
}

void runs_draw(tui_app *app, void *state, tui_area area) {
    runs_state *s = state;
    if (!s->table) {
        draw_text(&app->theme, area, 1, 2, STYLE_BAD, s->trouble);
        return;
    }
    switch (s->page) {
    case RUNS_TABLE: draw_table(app, s, draw_inset(area)); break;
    case RUNS_DETAIL: runs_draw_detail(app, s, draw_inset(area)); break;
    case RUNS_PLOT: runs_draw_plot(app, s, draw_inset(area)); break;
    case RUNS_PLAYER: runs_draw_player(app, s, area); break;
    }
}
