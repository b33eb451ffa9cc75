#include "tui/widgets.h"

#include "tui/format.h"

#include <stdio.h>

/* Rows for the histogram's bars: the finest division of the bins that fits. */
static int bars_that_fit(int rows) {
    static const int divisions[] = {25, 10, 5};
    for (size_t i = 0; i < sizeof divisions / sizeof *divisions; i++) {
        if (divisions[i] <= rows) return divisions[i];
    }
    return 0;
}

void widget_panel(tui_app *app, const run_state *view, tui_area area) {
    enum { FIXED = 5 + 4 + 4 + 1, GAPS = 4, WORK = 1, PACE = 3, EFFECTS = 4, HISTORY = 9 }; /* numbers, energy, damage, a heading */
    bool roomy = area.height >= 34, damaged = app_has_damage(app);
    int fixed = FIXED + (roomy ? WORK + PACE + EFFECTS : 0), history = roomy && damaged ? HISTORY : 0;
    int bars = damaged ? bars_that_fit(area.height - fixed - history) : 0;
    int spare = area.height - fixed - history - bars;
    bool gap[GAPS];
    for (int i = 0; i < GAPS; i++) gap[i] = spare-- > 0;

    int row = widget_numbers(app, area, 0) + gap[0];
    row += widget_energy(app, area, row, roomy) + gap[1];
    row += widget_damage(app, area, row) + gap[2];
    if (roomy) row += widget_pace(app, area, row) + gap[3];
    if (bars > 0) row += widget_histogram(app, view, area, row, bars);
    if (history > 0) row += widget_history(app, view, area, row, history + (spare > 4 ? 4 : spare > 0 ? spare : 0));
    if (roomy) widget_effects(app, area, row, area.height - row);
}

void widget_strip(tui_app *app, const run_state *view, tui_area area) {
    const session_snapshot *s = app->shot;
    char a[FORMAT_BYTES], b[FORMAT_BYTES];
    int row = widget_progress(app, area, 0);
    format_clock(s->seconds_left, a);
    format_seconds(s->seconds_per_frame, b);
    int column = draw_format(&app->theme, area, row, 0, STYLE_TEXT, "frame %lld/%lld", (long long)s->frame,
                             (long long)s->frames);
    if (area.width >= 46) column = draw_format(&app->theme, area, row, column + 2, STYLE_TEXT, "%s each", b);
    draw_format(&app->theme, area, row, column + 2, STYLE_TEXT, "left %s", s->state == SESSION_ENDED ? "0:00:00" : a);
    widget_broken_line(app, area, row + 1);
    row += 2;
    if (area.height >= row + 4) row += widget_energy(app, area, row, false);
    int bars = app_has_damage(app) ? bars_that_fit(area.height - row - 1) : 0;
    if (bars > 0) widget_histogram(app, view, area, row, bars);
}
