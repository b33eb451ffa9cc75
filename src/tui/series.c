#include "tui/widgets.h"

#include "tui/format.h"
#include "view/plot.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

enum { LABEL = 9, NUMBER = 10, WIDEST = 200 };

/* One figure of every sample in the history; offset is that of a double in session_sample. */
static int gather(const session_snapshot *s, size_t offset, double values[SESSION_HISTORY]) {
    int count = s->history_count < SESSION_HISTORY ? s->history_count : SESSION_HISTORY;
    for (int i = 0; i < count; i++) memcpy(&values[i], (const char *)&s->history[i] + offset, sizeof(double));
    return count;
}

/* The lowest and highest finite value, with 0 always within. */
static void range(const double *values, int count, double *low, double *high) {
    *low = *high = 0;
    for (int i = 0; i < count; i++) {
        if (!isfinite(values[i])) continue;
        *low = fmin(*low, values[i]);
        *high = fmax(*high, values[i]);
    }
}

/* "label  number ▁▂▃▅": the newest at the right end. */
static void line(const tui_app *app, tui_area area, int row, const char *label, const char *number, size_t offset) {
    double values[SESSION_HISTORY], low, high;
    int count = gather(app->shot, offset, values);
    range(values, count, &low, &high);
    draw_text(&app->theme, area, row, 0, STYLE_DIM, label);
    draw_right(&app->theme, area, row, LABEL + NUMBER, STYLE_STRONG, number);
    int width = area.width - LABEL - NUMBER - 2;
    if (width < 1) return;
    if (width > WIDEST) width = WIDEST;
    /* Few values are stretched to the left edge's side only as far as they reach: history grows from the left. */
    char text[VIEW_PLOT_BYTES(WIDEST)];
    int shown = count < width ? count : width;
    view_sparkline(values, count, low, high, shown, app->theme.ascii, text);
    draw_text(&app->theme, area, row, LABEL + NUMBER + 2, STYLE_PLOT, text);
}

int widget_energy(const tui_app *app, tui_area area, int row, bool with_work) {
    const session_sample *now = &app->shot->now;
    const struct {
        const char *label;
        double value;
        size_t offset;
    } rows[] = {{"kinetic", now->kinetic, offsetof(session_sample, kinetic)},
                {"elastic", now->elastic, offsetof(session_sample, elastic)},
                {"fibre", now->fibre, offsetof(session_sample, fibre)},
                {"work", now->work, offsetof(session_sample, work)}};
    int count = with_work ? 4 : 3;
    draw_heading(&app->theme, area, row, "energy", NULL);
    for (int i = 0; i < count; i++) {
        char number[FORMAT_BYTES];
        format_real(rows[i].value, number);
        line(app, area, row + 1 + i, rows[i].label, number, rows[i].offset);
    }
    return count + 1;
}

bool app_has_damage(const tui_app *app) {
    const session_snapshot *s = app->shot;
    for (int i = 0; i < s->effect_count; i++) {
        if (strstr(s->effects[i], "damage") || strstr(s->effects[i], "fracture")) return true;
    }
    return s->effect_count == 0 || s->now.damage_max > 0 || s->now.broken_fraction > 0;
}

void widget_broken_line(const tui_app *app, tui_area area, int row) {
    char number[FORMAT_BYTES];
    format_percent(app->shot->now.broken_fraction, number);
    line(app, area, row, "broken", number, offsetof(session_sample, broken_fraction));
}

int widget_damage(const tui_app *app, tui_area area, int row) {
    draw_heading(&app->theme, area, row, "damage", NULL);
    if (!app_has_damage(app)) {
        draw_text(&app->theme, area, row + 1, 0, STYLE_DIM, "this scene does not damage anything");
        return 2;
    }
    char text[64];
    widget_broken_line(app, area, row + 1);
    snprintf(text, sizeof text, "%.4f", app->shot->now.damage_mean);
    line(app, area, row + 2, "mean", text, offsetof(session_sample, damage_mean));
    snprintf(text, sizeof text, "%.4f", app->shot->now.damage_max);
    line(app, area, row + 3, "largest", text, offsetof(session_sample, damage_max));
    return 4;
}

int widget_pace(const tui_app *app, tui_area area, int row) {
    char number[FORMAT_BYTES];
    draw_heading(&app->theme, area, row, "pace", NULL);
    format_real(app->shot->now.dt, number);
    line(app, area, row + 1, "dt", number, offsetof(session_sample, dt));
    format_seconds(app->shot->now.seconds, number);
    line(app, area, row + 2, "frame", number, offsetof(session_sample, seconds));
    return 3;
}
