/* How the knobs look. */
#include "tui/knob_panel.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { DETAIL_ROWS = 6, WIDE = 64, NAME_NARROW = 15, NAME_WIDE = 20, TWIN_NAME = 14, VALUE = 11 };

static bool changed(const knob *k) {
    return memcmp(k->value, k->start, sizeof k->value) != 0;
}

/* "damage · tube": the group that the rows below belong to. */
static void draw_group(tui_theme *theme, tui_area area, int row, const knob *k) {
    char note[64];
    snprintf(note, sizeof note, "%.60s", k->owner[0] && k->effect[0] ? k->owner : "");
    const char *name = k->effect[0] ? k->effect : k->owner[0] ? k->owner : "scene";
    draw_heading(theme, area, row, name, note[0] ? note : NULL);
}

/* ──┼───●───: where the value is, and where it began. */
static void draw_slider(tui_theme *theme, tui_area area, int row, int column, int width, const knob *k, int component) {
    if (width < 4 || k->kind == PARAMETER_CHOICE || k->kind == PARAMETER_BOOLEAN) return;
    int now = (int)lrint(knob_place(k, k->value[component]) * (width - 1));
    int start = (int)lrint(knob_place(k, k->start[component]) * (width - 1));
    for (int i = 0; i < width; i++) draw_text(theme, area, row, column + i, STYLE_DIM, i == start ? "┼" : "─");
    draw_text(theme, area, row, column + now, k->live ? STYLE_PLOT : STYLE_DIM, "●");
}

/* One side of a row: name, value. */
static void draw_side(tui_theme *theme, tui_area area, int row, int name_width, const knob *k, bool chosen) {
    char name[64], value[KNOB_TEXT];
    snprintf(name, sizeof name, "%.*s", name_width, k->key);
    knob_show(k, k->value, value);
    tui_style style = !k->live || k->derived ? STYLE_DIM : STYLE_TEXT;
    draw_text(theme, area, row, 1, chosen ? STYLE_HEAD : style, name);
    if (chosen) draw_text(theme, area, row, 0, STYLE_HEAD, "▸");
    tui_style number = changed(k) ? STYLE_WARN : style == STYLE_DIM ? STYLE_DIM : STYLE_STRONG;
    draw_right(theme, area, row, name_width + 1 + VALUE, number, value);
}

/* The values of twins on a narrow row: whole where they fit beside a few letters of the second name; else the one that is not being turned is
 * rounded. */
static void show_twins(const knob *const sides[2], int chosen, int width, char values[2][KNOB_TEXT]) {
    enum { FRAME = 7, LETTERS = 6 };
    int names = (int)strlen(sides[0]->key), second = (int)strlen(sides[1]->key);
    names = (names < TWIN_NAME ? names : TWIN_NAME) + (second < LETTERS ? second : LETTERS);
    for (int i = 0; i < 2; i++) knob_show(sides[i], sides[i]->value, values[i]);
    for (int k = 0; k < 2 && FRAME + names + draw_width(values[0]) + draw_width(values[1]) > width; k++) {
        int side = chosen == 0 ? 1 - k : k;
        if (k == 1 && chosen >= 0) return;
        snprintf(values[side], KNOB_TEXT, "%.3g", sides[side]->value[0]);
    }
}

/* "sigma_c 3.196e+04 = break_stretch 0.2" where two columns of each do not fit; the second name gives way. */
static void draw_twins(tui_theme *theme, tui_area area, int row, const knob *k, const knob *twin, int chosen) {
    const knob *sides[2] = {k, twin};
    char values[2][KNOB_TEXT], name[64];
    show_twins(sides, chosen, area.width, values);
    int end = area.width - draw_width(values[1]) - 1, column = 1;
    for (int i = 0; i < 2; i++) {
        tui_style style = i == chosen ? STYLE_HEAD : sides[i]->derived || !sides[i]->live ? STYLE_DIM : STYLE_TEXT;
        if (i == chosen) draw_text(theme, area, row, column - 1, STYLE_HEAD, "▸");
        snprintf(name, sizeof name, "%.*s", i == 0 ? TWIN_NAME : end > column ? end - column : 0, sides[i]->key);
        column = draw_text(theme, area, row, column, style, name) + 1;
        tui_style number = changed(sides[i]) ? STYLE_WARN : sides[i]->derived ? STYLE_DIM : STYLE_STRONG;
        if (i == 1) {
            draw_right(theme, area, row, area.width, number, values[i]);
        } else {
            column = draw_text(theme, area, row, column, number, values[i]) + 1;
            column = draw_text(theme, area, row, column, STYLE_DIM, "=") + 1;
        }
    }
}

static void draw_knob(const knob_panel *panel, tui_theme *theme, tui_area area, int row, int index) {
    const knob_row *r = &panel->rows[index];
    bool here = index == panel->cursor;
    int name_width = area.width >= WIDE ? NAME_WIDE : NAME_NARROW, used = name_width + VALUE + 2;
    const knob *k = &panel->list[r->knob];
    int chosen = !here ? -1 : panel->on_twin ? 1 : 0;
    if (r->twin < 0) {
        draw_side(theme, area, row, name_width, k, here);
        if (k->components == 1) draw_slider(theme, area, row, used, area.width - used, k, 0);
        return;
    }
    const knob *twin = &panel->list[r->twin];
    if (area.width < 2 * used + 2) {
        draw_twins(theme, area, row, k, twin, chosen);
        return;
    }
    tui_area right = {area.y, area.x + used + 2, area.height, area.width - used - 2};
    draw_side(theme, area, row, name_width, k, chosen == 0);
    draw_text(theme, area, row, used, STYLE_DIM, "=");
    draw_side(theme, right, row, name_width, twin, chosen == 1);
}

/* ---- the current one --------------------------------------------------------------------------------------------- */

static void range_text(const knob *k, char *text, size_t size) {
    char low[32] = "", high[32] = "", fallback[KNOB_TEXT], start[KNOB_TEXT];
    knob_show(k, k->fallback, fallback);
    knob_show(k, k->start, start);
    if (k->kind == PARAMETER_CHOICE || k->kind == PARAMETER_BOOLEAN) {
        snprintf(text, size, "default %s  start %s", fallback, start);
        return;
    }
    if (isfinite(k->minimum)) snprintf(low, sizeof low, "%.4g", k->minimum);
    if (isfinite(k->maximum)) snprintf(high, sizeof high, "%.4g", k->maximum);
    snprintf(text, size, "%s … %s  default %s  start %s", low[0] ? low : "-", high[0] ? high : "-", fallback, start);
}

/* Name and unit, doc, range, and whether it acts at once. */
static void draw_detail(const knob_panel *panel, tui_theme *theme, tui_area area) {
    const knob *k = knob_panel_current(panel);
    if (!k) return;
    char text[512], value[KNOB_TEXT];
    draw_heading(theme, area, 0, k->path, k->unit[0] && strcmp(k->unit, "1") != 0 ? k->unit : NULL);
    int row = 1;
    if (k->components > 1) {
        knob_show(k, k->value, value);
        row += draw_paragraph(theme, area, row, 1, STYLE_STRONG, value);
        draw_format(theme, area, row - 1, draw_width(value) + 1, STYLE_DIM, "arrows: %c", "xyz"[panel->component]);
    }
    row += draw_paragraph(theme, area, row, area.height - row - 2, STYLE_TEXT, k->doc);
    range_text(k, text, sizeof text);
    row += draw_paragraph(theme, area, row, area.height - row - 1 > 2 ? 2 : 1, STYLE_DIM, text);
    if (k->derived) {
        draw_paragraph(theme, area, row, area.height - row, STYLE_DIM, "follows from its twin; turning it makes that follow");
    } else if (k->live) {
        draw_paragraph(theme, area, row, 1, STYLE_GOOD, "live: acts at the next frame");
    } else {
        snprintf(text, sizeof text, "%.*s; R restarts", 200, k->why_not[0] ? k->why_not : "needs a restart");
        draw_paragraph(theme, area, row, area.height - row, STYLE_WARN, text);
    }
}

void knob_panel_draw(knob_panel *panel, tui_theme *theme, tui_area area) {
    if (panel->row_count == 0) {
        draw_text(theme, area, 0, 0, STYLE_DIM, "no knobs yet");
        return;
    }
    int detail = area.height >= 14 ? DETAIL_ROWS + (area.height >= 30) : area.height >= 8 ? 3 : 0;
    int rows = area.height - detail;
    /* The group's heading stays in view above its first row. */
    int wanted = panel->cursor > 0 && panel->rows[panel->cursor - 1].heading ? panel->cursor - 1 : panel->cursor;
    if (wanted < panel->top) panel->top = wanted;
    if (panel->cursor >= panel->top + rows) panel->top = panel->cursor - rows + 1;
    if (panel->top > panel->row_count - rows) panel->top = panel->row_count > rows ? panel->row_count - rows : 0;
    tui_area list = {area.y, area.x, rows, area.width};
    for (int i = 0; i < rows && panel->top + i < panel->row_count; i++) {
        const knob_row *row = &panel->rows[panel->top + i];
        if (row->heading) draw_group(theme, list, i, &panel->list[row->knob]);
        else draw_knob(panel, theme, list, i, panel->top + i);
    }
    draw_detail(panel, theme, (tui_area){area.y + rows, area.x, detail, area.width});
}
