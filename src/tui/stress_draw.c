/* The list of hard cases with their verdicts, and the figures of the one under the cursor. */
#include "tui/stresses.h"

#include <stdio.h>
#include <string.h>

enum { WIDE = 120, LIST_WIDTH = 62, DETAIL_ROWS = 9 };

static tui_style state_style(stress_state state) {
    switch (state) {
    case STATE_HOLDS:
    case STATE_STOPS: return STYLE_GOOD;
    case STATE_KNOWN: return STYLE_WARN;
    case STATE_FAILS: return STYLE_BAD;
    case STATE_GOING: return STYLE_STRONG;
    case STATE_NOT_RUN:
    case STATES: break;
    }
    return STYLE_DIM;
}

static void draw_head(tui_app *app, const stresses *s, tui_area area) {
    const tui_theme *t = &app->theme;
    int column = draw_text(t, area, 0, 0, STYLE_STRONG, "Hard cases  ");
    int good = stresses_count(s, STATE_HOLDS) + stresses_count(s, STATE_STOPS), known = stresses_count(s, STATE_KNOWN), bad = stresses_count(s, STATE_FAILS);
    column = draw_format(t, area, 0, column, STYLE_GOOD, "%d hold", good);
    if (known) column = draw_format(t, area, 0, column, STYLE_WARN, "  %d known limits", known);
    if (bad) column = draw_format(t, area, 0, column, STYLE_BAD, "  %d FAIL", bad);
    column = draw_format(t, area, 0, column, STYLE_DIM, "  of %d  %s", s->count, s->precision);
    int marks = 0;
    for (int i = 0; i < s->count; i++) marks += s->rows[i].marked;
    if (marks) column = draw_format(t, area, 0, column, STYLE_STRONG, "  %d marked", marks);
    if (s->effect[0] || s->trouble) column = draw_format(t, area, 0, column, STYLE_HEAD, "  only %s%s", s->effect, s->trouble ? (s->effect[0] ? ", failing" : "failing") : "");
    if (s->listing) draw_text(t, area, 0, column, STYLE_DIM, "  looking");
    else if (s->going) draw_format(t, area, 0, column, STYLE_STRONG, "  running %d", stresses_count(s, STATE_GOING));
}

static void draw_list(tui_app *app, stresses *s, tui_area area) {
    const tui_theme *t = &app->theme;
    s->page_rows = area.height > 1 ? area.height - 1 : 1;
    int top = s->cursor >= area.height ? s->cursor - area.height + 1 : 0;
    if (s->shown_count == 0 && !s->listing) draw_text(t, area, 0, 2, STYLE_DIM, s->count ? "No case fits: e and f choose others." : "No hard cases: Lua files with expect in scenes/stress.");
    for (int i = 0; i < area.height && top + i < s->shown_count; i++) {
        const stress_row *row = &s->rows[s->shown[top + i]];
        tui_area line = {area.y + i, area.x, 1, area.width};
        bool here = top + i == s->cursor;
        if (here) draw_blank(t, line, 0, STYLE_BAR);
        draw_text(t, line, 0, 0, here ? STYLE_BAR_STRONG : STYLE_STRONG, row->marked ? (app->theme.ascii ? "*" : "●") : " ");
        draw_text(t, line, 0, 2, here ? STYLE_BAR_STRONG : state_style(row->state), stress_state_word(row->state));
        draw_text(t, (tui_area){line.y, line.x, 1, area.width - 7}, 0, 15, here ? STYLE_BAR_STRONG : STYLE_TEXT, row->name);
        draw_right(t, line, 0, area.width - 1, here ? STYLE_BAR : STYLE_DIM, row->precision);
    }
}

/* One figure a line; those that do not hold begin with "! ". */
static void draw_figures(const tui_app *app, const stress_row *row, tui_area area, int line) {
    const char *at = row->text;
    while (*at && line < area.height) {
        const char *end = strstr(at, "; ");
        size_t length = end ? (size_t)(end - at) : strlen(at);
        char text[1024];
        snprintf(text, sizeof text, "%.*s", (int)length, at);
        bool bad = strncmp(text, "! ", 2) == 0;
        draw_text(&app->theme, area, line, 0, bad ? (row->state == STATE_KNOWN ? STYLE_WARN : STYLE_BAD) : STYLE_GOOD, bad ? "no " : "ok ");
        tui_area rest = {area.y, area.x + 3, area.height, area.width - 3};
        line += draw_paragraph(&app->theme, rest, line, area.height - line, bad ? STYLE_STRONG : STYLE_TEXT, bad ? text + 2 : text);
        at += length + (end ? 2 : 0);
    }
}

static void draw_detail(tui_app *app, const stresses *s, tui_area area) {
    if (s->cursor >= s->shown_count) return;
    const stress_row *row = &s->rows[s->shown[s->cursor]];
    draw_heading(&app->theme, area, 0, row->name, row->id[0] ? row->id : NULL);
    int line = 1;
    if (area.height > 6 && row->remark[0]) line += draw_paragraph(&app->theme, area, line, 2, STYLE_TEXT, row->remark);
    if (area.height > 4) line += draw_paragraph(&app->theme, area, line, 1, STYLE_DIM, row->effects);
    draw_figures(app, row, area, line);
}

void stresses_draw(tui_app *app, void *state, tui_area area) {
    stresses *s = state;
    area = draw_inset(area);
    draw_head(app, s, area);
    if (area.width >= WIDE) {
        draw_list(app, s, (tui_area){area.y + 1, area.x, area.height - 1, LIST_WIDTH});
        draw_detail(app, s, (tui_area){area.y + 1, area.x + LIST_WIDTH + 2, area.height - 1, area.width - LIST_WIDTH - 2});
        return;
    }
    int detail = area.height > 2 * DETAIL_ROWS ? DETAIL_ROWS : area.height / 3;
    draw_list(app, s, (tui_area){area.y + 1, area.x, area.height - 1 - detail, area.width});
    if (detail > 1) draw_detail(app, s, (tui_area){area.y + area.height - detail, area.x, detail, area.width});
}
