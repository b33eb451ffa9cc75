/* Charts (view/chart.h) in the workbench. */
#ifndef SUNDER_TUI_CHART_DRAW_H
#define SUNDER_TUI_CHART_DRAW_H

#include "tui/app.h"
#include "view/chart.h"

/* Colours far apart from each other on dark and light, for terminals of 256, 16 or 8. */
tui_ink chart_ink(tui_app *app, int curve);

/* What view_chart drew: cells [o->height][o->width]. */
void chart_draw(tui_app *app, tui_area area, const view_chart_options *o, const view_chart_cell *cells);

#endif
