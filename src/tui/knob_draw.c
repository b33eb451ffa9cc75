/* How the knobs look. */
#include "tui/knob_panel.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { DETAIL_ROWS = 6, WIDE = 64, NAME_NARROW = 15, NAME_WIDE = 20, VALUE = 11, INDENT = 2 };

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

static int side_width(int width) {
    return (width >= WIDE ? NAME_WIDE : NAME_NARROW) + VALUE + 2;
}

/* Twins stand side by side where there is room, else the second below the first. */
static bool side_by_side(int width) {
    return width >= 2 * side_width(width) + 2;
}

static void draw_knob(const knob_panel *panel, tui_theme *theme, tui_area area, int row, int index) {
    const knob_row *r = &panel->rows[index];
    bool here = index == panel->cursor, beside = r->twin >= 0 && side_by_side(area.width);
    int used = side_width(area.width), name_width = used - VALUE - 2;
    const knob *k = &panel->list[r->knob];
    int chosen = !here ? -1 : panel->on_twin ? 1 : 0;
    draw_side(theme, area, row, name_width, k, chosen == 0);
    if (k->components == 1 && !beside) draw_slider(theme, area, row, used, area.width - used, k, 0);
    if (r->twin < 0) return;
    const knob *twin = &panel->list[r->twin];
    if (beside) {
        tui_area right = {area.y, area.x + used + 2, area.height, area.width - used - 2};
        draw_text(theme, area, row, used, STYLE_DIM, "=");
        draw_side(theme, right, row, name_width, twin, chosen == 1);
        return;
    }
    tui_area below = {area.y, area.x + INDENT, area.height, area.width - INDENT};
    draw_text(theme, area, row + 1, 1, STYLE_DIM, "=");
    draw_side(theme, below, row + 1, name_width - INDENT, twin, chosen == 1);
    draw_slider(theme, area, row + 1, used, area.width - used, twin, 0);
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

/* The end of a path that fits beside the unit: "tube.damage.eta", "damage.eta" or "eta". */
static const char *fitting_path(const knob *k, const char *unit, int width) {
    const char *name = k->path, *dot;
    int note = unit ? draw_width(unit) + 2 : 1;
    while (draw_width(name) + note > width && (dot = strchr(name, '.')) != NULL) name = dot + 1;
    return name;
}

/* Name and unit, doc, range, and whether it acts at once. */
static void draw_detail(const knob_panel *panel, tui_theme *theme, tui_area area) {
    const knob *k = knob_panel_current(panel);
    if (!k) return;
    char text[512], value[KNOB_TEXT];
    const char *unit = k->unit[0] && strcmp(k->unit, "1") != 0 ? k->unit : NULL;
    draw_heading(theme, area, 0, fitting_path(k, unit, area.width), unit);
    int row = 1;
    if (k->components > 1) {
        knob_show(k, k->value, value);
        row += draw_paragraph(theme, area, row, 1, STYLE_STRONG, value);
        draw_format(theme, area, row - 1, draw_width(value) + 1, STYLE_DIM, "arrows: %c", "xyz"[panel->component]);
    }
    row += draw_paragraph(theme, area, row, area.height - row - 2, STYLE_TEXT, k->doc);
    range_text(k, text, sizeof text);
    int reason = k->live ? 1 : 2; /* what is said below takes as many rows */
    row += draw_paragraph(theme, area, row, area.height - row - reason >= 2 ? 2 : 1, STYLE_DIM, text);
    if (k->derived) {
        draw_paragraph(theme, area, row, area.height - row, STYLE_DIM, "follows its twin until it is turned");
    } else if (k->live) {
        draw_paragraph(theme, area, row, 1, STYLE_GOOD, "live: acts at the next frame");
    } else {
        snprintf(text, sizeof text, "%.*s; R restarts", 200, k->why_not[0] ? k->why_not : "needs a restart");
        draw_paragraph(theme, area, row, area.height - row, STYLE_WARN, text);
    }
}

/* The lines that rows take, from one to before another. */
static int count_lines(const knob_panel *panel, int from, int to, int width) {
    int lines = to - from;
    for (int i = from; i < to; i++) lines += !panel->rows[i].heading && panel->rows[i].twin >= 0 && !side_by_side(width);
    return lines;
}

/* Moves the first row in view so that the cursor's is in view, with the group's heading above its first row, and none is left empty. */
static void scroll_to_cursor(knob_panel *panel, int lines, int width) {
    int wanted = panel->cursor > 0 && panel->rows[panel->cursor - 1].heading ? panel->cursor - 1 : panel->cursor;
    if (wanted < panel->top) panel->top = wanted;
    if (panel->top > panel->row_count - 1) panel->top = panel->row_count - 1;
    while (panel->top < panel->cursor && count_lines(panel, panel->top, panel->cursor + 1, width) > lines) panel->top++;
    while (panel->top > 0 && count_lines(panel, panel->top - 1, panel->row_count, width) <= lines) panel->top--;
}

void knob_panel_draw(knob_panel *panel, tui_theme *theme, tui_area area) {
    if (panel->row_count == 0) {
        draw_text(theme, area, 0, 0, STYLE_DIM, "no knobs yet");
        return;
    }
    int detail = area.height >= 14 ? DETAIL_ROWS + (area.height >= 30) : area.height >= 8 ? 3 : 0;
    tui_area list = {area.y, area.x, area.height - detail, area.width};
    scroll_to_cursor(panel, list.height, list.width);
    for (int i = panel->top, line = 0; i < panel->row_count && line < list.height; line += count_lines(panel, i, i + 1, list.width), i++) {
        const knob_row *row = &panel->rows[i];
        if (row->heading) draw_group(theme, list, line, &panel->list[row->knob]);
        else draw_knob(panel, theme, list, line, i);
    }
    draw_detail(panel, theme, (tui_area){area.y + list.height, area.x, detail, area.width});
}
