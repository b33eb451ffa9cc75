/* A small map of numbers in colours: half-blocks where the terminal has colours and Unicode, characters of growing density elsewhere. */
#ifndef SUNDER_TUI_HEAT_MAP_H
#define SUNDER_TUI_HEAT_MAP_H

#include "tui/draw.h"
#include "tui/theme.h"

/* Rows of values that a row of cells shows: 2 or 1. */
int heat_map_rows(const tui_theme *theme);

/* Draws values[height][width] in [0,1] (below 0: empty), the first row at the top, into the area from (row, column) on. height must be a
 * multiple of heat_map_rows. */
void heat_map_draw(tui_theme *theme, tui_area area, int row, int column, const double *values, int height, int width);

#endif
