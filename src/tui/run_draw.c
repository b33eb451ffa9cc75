/* How the Run screen is laid out: a picture, panels beside or below it as room allows, the line of frames. */
#include "tui/run.h"
#include "tui/widgets.h"

#include <stdio.h>
#include <string.h>

enum {
    BESIDE = 72, /* columns from which a panel stands beside the picture */
    NARROWEST = 36,
    TWO_PANELS = 140,   /* columns from which there are two: numbers, and the one that was chosen */
    ALL_PANELS = 160,   /* and with as many rows as below: all of them */
    ALL_ROWS = 44,
};

timeline run_timeline(const tui_app *app, const run_state *state) {
    static int64_t turns[RUN_TURNS], events[SESSION_EVENTS];
    const session_snapshot *s = app->shot;
    timeline line = {.last = s->frames,
                     .now = s->frame,
                     .chosen = state->chosen,
                     .checkpoints = state->checkpoints,
                     .checkpoint_count = state->checkpoint_count,
                     .turns = turns,
                     .events = events};
    for (int i = 0; i < state->turn_count; i++) turns[line.turn_count++] = state->turns[i].frame;
    for (int i = 0; i < s->event_count; i++) {
        if (strcmp(s->events[i].kind, "knob") != 0) events[line.event_count++] = s->events[i].frame;
    }
    return line;
}

/* ---- where things are -------------------------------------------------------------------------------------------- */

/* Cuts `width` columns off the right, and one more for the rule between. */
static tui_area take_right(tui_area *from, int width) {
    tui_area taken = {from->y, from->x + from->width - width, from->height, width};
    from->width -= width + 3;
    taken.x -= 1;
    return taken;
}

run_layout run_lay_out(const run_state *state, tui_area body) {
    run_layout out = {.timeline = {body.y + body.height - 1, body.x, 1, body.width}};
    tui_area rest = {body.y, body.x, body.height - 1, body.width};
    if (state->whole) {
        out.panel = (tui_area){rest.y, rest.x + 1, rest.height, rest.width - 2};
        return out;
    }
    if (body.width >= ALL_PANELS && body.height >= ALL_ROWS) {
        out.third = take_right(&rest, 50);
        out.panel = take_right(&rest, 44);
        int half = out.third.height * 11 / 20;
        out.second = (tui_area){out.third.y + half, out.third.x, out.third.height - half, out.third.width};
        out.third.height = half;
    } else if (body.width >= TWO_PANELS) {
        out.second = take_right(&rest, 40);
        out.panel = take_right(&rest, NARROWEST);
    } else if (body.width >= BESIDE) {
        int width = body.width * 45 / 100;
        out.panel = take_right(&rest, width < NARROWEST ? NARROWEST : width > 44 ? 44 : width);
    } else {
        int strip = body.height >= 18 ? 13 : body.height >= 12 ? 7 : 3;
        out.panel = (tui_area){rest.y + rest.height - strip, rest.x + 1, strip, rest.width - 2};
        rest.height -= strip;
    }
    out.picture = rest;
    return out;
}

/* ---- panels ------------------------------------------------------------------------------------------------------ */

/* "numbers [knobs] …": which panel it is, and that there are others. */
static int draw_tabs(const tui_app *app, tui_area area, run_panel shown, bool with_numbers) {
    int column = 0;
    for (int i = with_numbers ? 0 : 1; i < RUN_PANELS; i++) {
        bool here = i == (int)shown;
        const char *name = run_panel_name((run_panel)i);
        int width = draw_width(name);
        if (column + width > area.width) break;
        column = draw_text(&app->theme, area, 0, column, here ? STYLE_HEAD : STYLE_DIM, name) + 1;
    }
    if (app->theme.colours == 0) {
        /* Where styles hardly show, brackets do. */
        column = 0;
        for (int i = with_numbers ? 0 : 1; i < (int)shown; i++) column += draw_width(run_panel_name((run_panel)i)) + 1;
        if (column > 0) draw_text(&app->theme, area, 0, column - 1, STYLE_HEAD, "[");
        draw_text(&app->theme, area, 0, column + draw_width(run_panel_name(shown)), STYLE_HEAD, "]");
    }
    return 1;
}

static void draw_panel(tui_app *app, run_state *state, tui_area area, run_panel panel) {
    switch (panel) {
    case RUN_DAMAGE: widget_damage_panel(app, state, area); break;
    case RUN_KNOBS:
        knob_panel_draw(&state->knobs, &app->theme, area);
        widget_pending(app, state, area);
        state->knobs_in_view = true;
        break;
    case RUN_TIME: {
        int used = area.height >= 12 ? widget_pace(app, area, 0) : 0;
        widget_stages(app, area, used, area.height - used);
        break;
    }
    case RUN_EVENTS: widget_events(app, area, 0, area.height); break;
    default: widget_panel(app, state, area); break;
    }
}

static tui_area below(tui_area area, int rows) {
    return (tui_area){area.y + rows, area.x, area.height - rows, area.width};
}

/* Where a rule stands to the left of an area. */
static void draw_rule(const tui_app *app, tui_area area, tui_area body) {
    tui_area line = {body.y, area.x - 2, body.height - 1, 1};
    for (int row = 0; row < line.height; row++) draw_text(&app->theme, line, row, 0, STYLE_DIM, "│");
}

static void draw_all(tui_app *app, run_state *state, const run_layout *at, tui_area body) {
    draw_rule(app, at->panel, body);
    draw_rule(app, at->third, body);
    widget_panel(app, state, at->panel);
    draw_heading(&app->theme, at->third, 0, "knobs", "arrows turn, enter types");
    draw_panel(app, state, below(at->third, 1), RUN_KNOBS);
    int used = widget_stages(app, at->second, 1, at->second.height / 2);
    widget_events(app, at->second, used + 2, at->second.height - used - 2);
}

static void draw_two(tui_app *app, run_state *state, const run_layout *at, tui_area body) {
    run_panel chosen = state->panel == RUN_NUMBERS ? RUN_KNOBS : state->panel;
    draw_rule(app, at->panel, body);
    draw_rule(app, at->second, body);
    widget_panel(app, state, at->panel);
    draw_tabs(app, at->second, chosen, false);
    draw_panel(app, state, below(at->second, 1), chosen);
}

static void draw_one(tui_app *app, run_state *state, const run_layout *at, tui_area body) {
    bool beside = at->panel.y == body.y && !state->whole;
    if (beside) draw_rule(app, at->panel, body);
    if (at->panel.height < 8 && state->panel == RUN_NUMBERS) {
        widget_strip(app, state, at->panel);
        return;
    }
    draw_tabs(app, at->panel, state->panel, true);
    tui_area inner = below(at->panel, 1);
    if (state->panel == RUN_NUMBERS && !beside && !state->whole) widget_strip(app, state, inner);
    else draw_panel(app, state, inner, state->panel);
}

static void draw_picture(tui_app *app, run_state *state, tui_area area) {
    if (area.height < 1 || area.width < 1) return;
    if (app->shot->point_count == 0) {
        const char *text = app->run && app->ended ? "no particles" : "the scene is being set up …";
        draw_text(&app->theme, area, area.height / 2, (area.width - draw_width(text)) / 2, STYLE_DIM, text);
        return;
    }
    particle_points points = run_points(app);
    particle_view_draw(&state->view, &app->theme, area, &points);
}

/* Before the first run. */
static void draw_nothing(const tui_app *app, tui_area body) {
    static const char *const lines[] = {"No run is on.", "F2 shows the scenes: enter there starts one.", "F5 shows past runs and their frames."};
    int count = sizeof lines / sizeof *lines;
    for (int i = 0; i < count; i++) {
        int column = (body.width - draw_width(lines[i])) / 2;
        draw_text(&app->theme, body, (body.height - count) / 2 + i, column > 0 ? column : 0, i == 0 ? STYLE_STRONG : STYLE_DIM, lines[i]);
    }
}

void run_draw(tui_app *app, void *own, tui_area body) {
    run_state *state = own;
    run_layout at = run_lay_out(state, body);
    state->knobs_in_view = false;
    if (!app->run && !app_starting(app)) {
        draw_nothing(app, body);
        return;
    }
    if (at.picture.height > 0) draw_picture(app, state, at.picture);
    if (at.third.height > 0) draw_all(app, state, &at, body);
    else if (at.second.height > 0) draw_two(app, state, &at, body);
    else draw_one(app, state, &at, body);
    timeline line = run_timeline(app, state);
    if (app->run) timeline_draw(&line, &app->theme, at.timeline, 0);
}
