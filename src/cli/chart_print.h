/* Charts on standard output, in colour where that is wanted. */
#ifndef SUNDER_CLI_CHART_PRINT_H
#define SUNDER_CLI_CHART_PRINT_H

#include "view/chart.h"

/* A series' colour as the terminal's escape sequences number it. */
int chart_colour(int series);

/* Prints what view_chart drew: cells [height][width]. */
void chart_print(const view_chart_options *o, const view_chart_cell *cells, bool colour);

#endif
