#include "tui/widgets.h"

#include "tui/format.h"
#include "view/plot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { GAP = 2, WIDEST_BAR = 200 };

/* A label at the left of one half of the panel, its value at the half's right end. */
static void pair(const tui_app *app, tui_area area, int row, int half, const char *label, const char *value) {
    int width = (area.width - GAP) / 2;
    tui_area part = {area.y, area.x + (half ? area.width - width : 0), area.height, width};
    draw_text(&app->theme, part, row, 0, STYLE_DIM, label);
    draw_right(&app->theme, part, row, width, STYLE_STRONG, value);
}

int widget_progress(const tui_app *app, tui_area area, int row) {
    const session_snapshot *s = app->shot;
    enum { TEXT = 6 };
    double done = s->frames > 0 ? (double)s->frame / (double)s->frames : 0;
    char bar[VIEW_PLOT_BYTES(WIDEST_BAR)];
    int width = area.width - TEXT;
    if (width > WIDEST_BAR) width = WIDEST_BAR;
    if (width < 1 || row >= area.height) return 0;
    view_bar(done, width, app->theme.ascii, bar);
    /* The part to come is a thin line, so that the bar's length can be seen. */
    for (int i = 0; i < width; i++) draw_text(&app->theme, area, row, i, STYLE_DIM, app->theme.ascii ? "." : "─");
    double columns = fmin(done, 1) * width;
    tui_area filled = area;
    filled.width = (int)(app->theme.ascii ? round(columns) : ceil(columns));
    draw_text(&app->theme, filled, row, 0, STYLE_PLOT, bar);
    char percent[16];
    snprintf(percent, sizeof percent, "%3.0f %%", 100 * fmin(done, 1));
    draw_right(&app->theme, area, row, area.width, STYLE_STRONG, percent);
    return 1;
}

static void time_text(const session_snapshot *s, char *text, size_t size) {
    int decimals = s->duration < 10 ? 2 : s->duration < 100 ? 1 : 0;
    if (s->duration < 0.1) {
        snprintf(text, size, "%.4f/%.3g", s->time, s->duration);
    } else {
        snprintf(text, size, "%.*f/%.*f s", decimals, s->time, decimals, s->duration);
    }
}

int widget_numbers(const tui_app *app, tui_area area, int row) {
    const session_snapshot *s = app->shot;
    char text[64], number[FORMAT_BYTES];
    int half = (area.width - GAP) / 2;
    snprintf(text, sizeof text, "%lld/%lld", (long long)s->frame, (long long)s->frames);
    pair(app, area, row, 0, "frame", text);
    time_text(s, text, sizeof text);
    pair(app, area, row, 1, "time", text);
    format_count(s->step, half - 5, number);
    pair(app, area, row + 1, 0, "step", number);
    format_real(s->dt, number);
    pair(app, area, row + 1, 1, "dt", number);
    format_seconds(s->seconds_per_frame, number);
    pair(app, area, row + 2, 0, "per frame", number);
    format_clock(s->state == SESSION_ENDED ? 0 : s->seconds_left, number);
    pair(app, area, row + 2, 1, "left", number);
    format_count(s->particles, half - 10, number);
    pair(app, area, row + 3, 0, "particles", number);
    format_clock(s->wall, number);
    pair(app, area, row + 3, 1, "elapsed", number);
    snprintf(text, sizeof text, "%d", s->threads);
    pair(app, area, row + 4, 0, "threads", text);
    snprintf(text, sizeof text, "%s %s", s->precision, s->simd);
    pair(app, area, row + 4, 1, "kernel", text);
    return 5;
}

int widget_effects(const tui_app *app, tui_area area, int row, int rows) {
    const session_snapshot *s = app->shot;
    if (rows < 2 || s->effect_count == 0) return 0;
    draw_heading(&app->theme, area, row, "effects", NULL);
    int used = 1, column = 0;
    for (int i = 0; i < s->effect_count; i++) {
        int width = draw_width(s->effects[i]);
        if (column > 0 && column + width > area.width) {
            used++;
            column = 0;
        }
        if (used >= rows) break;
        column = draw_text(&app->theme, area, row + used, column, STYLE_TEXT, s->effects[i]) + 2;
    }
    return used + 1 < rows ? used + 1 : rows;
}
