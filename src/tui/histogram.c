#include "tui/widgets.h"

#include "tui/format.h"
#include "view/plot.h"

#include <math.h>
#include <stdio.h>

enum { LABEL = 10, NUMBER = 9, WIDEST = 200 };

int widget_histogram(tui_app *app, const run_state *view, tui_area area, int row, int bins) {
    double share[SESSION_BINS], most = 0;
    view_rebin(app->shot->now.histogram, SESSION_BINS, share, bins);
    for (int i = 0; i < bins; i++) most = fmax(most, share[i]);
    draw_heading(&app->theme, area, row, "particles by damage", view->log_histogram ? "log" : "linear");
    int width = area.width - LABEL - NUMBER;
    if (width > WIDEST) width = WIDEST;
    /* On the logarithmic scale a single particle is the smallest mark. */
    double floor = 0.5 / (double)(app->shot->particles > 0 ? app->shot->particles : 1);
    for (int i = 0; i < bins; i++) {
        char bar[VIEW_PLOT_BYTES(WIDEST)], percent[FORMAT_BYTES];
        draw_format(&app->theme, area, row + 1 + i, 0, STYLE_DIM, "%.2f–%.2f", (double)i / bins,
                    (double)(i + 1) / bins);
        double fraction = view->log_histogram ? view_log_fraction(share[i], floor, fmax(most, 2 * floor))
                          : most > 0         ? share[i] / most
                                             : 0;
        if (width > 0) {
            /* In the colour that such particles have in the picture: the histogram is the picture's legend. */
            view_bar(fraction, width, app->theme.ascii, bar);
            draw_ink(&app->theme, area, row + 1 + i, LABEL, theme_value(&app->theme, ((float)i + 0.5f) / (float)bins),
                     bar);
        }
        format_percent(share[i], percent);
        draw_right(&app->theme, area, row + 1 + i, area.width, share[i] > 0 ? STYLE_STRONG : STYLE_DIM, percent);
    }
    return bins + 1;
}
