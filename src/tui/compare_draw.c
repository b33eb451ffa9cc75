/* How two runs look side by side: their pictures, the histograms of what they are coloured by, and the difference. */
#include "tui/compare.h"
#include "tui/format.h"
#include "tui/timeline.h"
#include "view/plot.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LABEL = 19, NUMBER = 9, WIDEST_BAR = 120 };

static void draw_name(tui_app *app, const compare_side *side, tui_area area, const char *which) {
    int column = draw_text(&app->theme, area, 0, 1, STYLE_HEAD, which) + 1;
    if (!side->id[0]) {
        draw_text(&app->theme, area, 0, column, STYLE_DIM, "no run");
        return;
    }
    column = draw_text(&app->theme, area, 0, column, STYLE_STRONG, side->id) + 1;
    tui_area rest = {area.y, area.x, 1, area.width - 12};
    if (column + draw_width(side->title) <= rest.width) draw_text(&app->theme, rest, 0, column, STYLE_DIM, side->title);
    char frame[32];
    if (side->has_frame) snprintf(frame, sizeof frame, "frame %" PRId64, side->shown.frame);
    else frame[0] = '\0';
    draw_right(&app->theme, area, 0, area.width - 1, STYLE_TEXT, frame);
}

static void draw_side(tui_app *app, compare_state *state, compare_side *side, tui_area area) {
    if (!side->has_frame) {
        const char *text = side->problem[0] ? side->problem : side->id[0] ? "reading its frames …" : "A and B choose a run";
        draw_paragraph(&app->theme, (tui_area){area.y, area.x + 1, area.height, area.width - 2}, area.height / 2, 3, STYLE_DIM, text);
        return;
    }
    particle_points points = {.position = side->shown.position, .scalar = side->shown.value, .count = side->shown.count,
                              .name = state->colour, .natural = state->scale};
    particle_view_draw(&side->view, &app->theme, area, &points);
}

/* ---- the histograms ---------------------------------------------------------------------------------------------- */

static double fraction_of(const compare_state *state, double share, double most) {
    if (most <= 0) return 0;
    return state->log_histogram ? view_log_fraction(share, 1e-6, fmax(most, 2e-6)) : share / most;
}

/* ◂ fewer on the right │ more on the right ▸: a bar from the middle. */
static void draw_difference(tui_app *app, tui_area area, int row, int column, int width, double difference, double most) {
    if (width < 3) return;
    int half = (width - 1) / 2;
    char bar[VIEW_PLOT_BYTES(WIDEST_BAR)];
    draw_text(&app->theme, area, row, column + half, STYLE_DIM, "│");
    if (most <= 0 || difference == 0) return;
    if (difference > 0) {
        view_bar(difference / most, half, app->theme.ascii, bar);
        draw_text(&app->theme, area, row, column + half + 1, STYLE_WARN, bar);
    } else {
        int cells = (int)ceil(-difference / most * half - 1e-9);
        for (int i = 0; i < cells && i < half; i++) draw_text(&app->theme, area, row, column + half - 1 - i, STYLE_PLOT, "█");
    }
}

static void draw_row(tui_app *app, const compare_state *state, tui_area area, int row, int index, int bins, const double *left,
                     const double *right, double most, double most_difference) {
    int bar = (area.width - LABEL - 3 * NUMBER - 4) / 3;
    bar = bar > WIDEST_BAR ? WIDEST_BAR : bar;
    char text[64], drawn[VIEW_PLOT_BYTES(WIDEST_BAR)];
    view_scale scale = state->sides[0].view.scale;
    snprintf(text, sizeof text, "%.3g–%.3g", view_scale_value(scale, (double)index / bins), view_scale_value(scale, (index + 1.0) / bins));
    draw_text(&app->theme, area, row, 0, STYLE_DIM, text);
    const double *values[2] = {left, right};
    int column = LABEL;
    for (int side = 0; side < 2; side++) {
        double share = values[side][index];
        format_percent(share, text);
        draw_right(&app->theme, area, row, column + NUMBER - 1, share > 0 ? STYLE_TEXT : STYLE_DIM, text);
        if (bar > 0) {
            view_bar(fraction_of(state, share, most), bar, app->theme.ascii, drawn);
            draw_ink(&app->theme, area, row, column + NUMBER, theme_value(&app->theme, ((float)index + 0.5f) / (float)bins), drawn);
        }
        column += NUMBER + bar + 2;
    }
    double difference = right[index] - left[index];
    snprintf(text, sizeof text, "%+.2f %%", 100 * difference);
    draw_right(&app->theme, area, row, column + NUMBER - 1, difference != 0 ? STYLE_STRONG : STYLE_DIM, text);
    draw_difference(app, area, row, column + NUMBER, bar, difference, most_difference);
}

static void draw_histograms(tui_app *app, const compare_state *state, tui_area area) {
    static const int divisions[] = {25, 10, 5};
    int bins = 0;
    for (int i = 2; i >= 0; i--) {
        if (divisions[i] + 1 <= area.height) bins = divisions[i];
    }
    if (bins == 0) return;
    double shares[COMPARE_SIDES][COMPARE_BINS], most = 0, most_difference = 0, distance = 0;
    char note[96], percent[FORMAT_BYTES];
    for (int side = 0; side < COMPARE_SIDES; side++) view_rebin(state->sides[side].histogram, COMPARE_BINS, shares[side], bins);
    for (int i = 0; i < bins; i++) {
        most = fmax(most, fmax(shares[0][i], shares[1][i]));
        most_difference = fmax(most_difference, fabs(shares[1][i] - shares[0][i]));
        distance += 0.5 * fabs(shares[1][i] - shares[0][i]); /* the share of particles that would have to change their bin */
    }
    format_percent(distance, percent);
    snprintf(note, sizeof note, "%s  %s differ", state->log_histogram ? "log" : "linear", percent);
    char name[64];
    snprintf(name, sizeof name, "particles by %s: A, B, B %s A", state->colour[0] ? state->colour : "colour", app->theme.ascii ? "-" : "−");
    draw_heading(&app->theme, area, 0, name, note);
    for (int i = 0; i < bins; i++) draw_row(app, state, area, 1 + i, i, bins, shares[0], shares[1], most, most_difference);
}

void compare_draw(tui_app *app, void *own, tui_area area) {
    compare_state *state = own;
    int width = (area.width - 1) / 2, lines = area.height - 3; /* names, what differs, frames */
    int histograms = lines * 9 / 20;
    bool any = state->sides[0].has_frame || state->sides[1].has_frame;
    int fits = !any ? 0 : histograms >= 26 ? 26 : histograms >= 11 ? 11 : histograms >= 6 ? 6 : 0;
    for (int i = 0; i < COMPARE_SIDES; i++) {
        int x = area.x + i * (width + 1);
        draw_name(app, &state->sides[i], (tui_area){area.y, x, 1, width}, i == 0 ? "A" : "B");
        draw_side(app, state, &state->sides[i], (tui_area){area.y + 1, x, lines - fits, width});
    }
    for (int row = 0; row < 1 + lines - fits; row++) draw_text(&app->theme, area, row, width, STYLE_DIM, "│");
    draw_histograms(app, state, (tui_area){area.y + 1 + lines - fits, area.x + 1, fits, area.width - 2});
    bool both = state->sides[0].id[0] && state->sides[1].id[0];
    draw_text(&app->theme, area, area.height - 2, 1, state->differs[0] ? STYLE_WARN : STYLE_DIM,
              state->differs[0] ? state->differs : both ? "no parameter differs" : "A and B choose the runs");
    timeline line = {.now = state->frame, .chosen = -1};
    if (compare_range(state, &line.first, &line.last)) timeline_draw(&line, &app->theme, area, area.height - 1);
}
