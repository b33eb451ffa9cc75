/* Curves and points in a terminal's cells: braille dots between axes with round figures; knows nothing of curses. */
#ifndef SUNDER_VIEW_CHART_H
#define SUNDER_VIEW_CHART_H

#include <stdbool.h>
#include <stdint.h>

enum { VIEW_CHART_LEAST_WIDTH = 24, VIEW_CHART_LEAST_HEIGHT = 5 };

typedef struct view_chart_series {
    const double *x, *y; /* [count]; pairs with one that is not finite are left out */
    int count;
    bool points; /* marks instead of a line */
} view_chart_series;

typedef struct view_chart_options {
    int width, height;    /* cells, axes and figures included; at least the limits above */
    bool ascii;           /* no braille, no box drawing */
    bool log_x, log_y;    /* logarithmic; values ≤ 0 are left out */
    const char *x_label;  /* at the right end below; may be NULL */
} view_chart_options;

typedef struct view_chart_cell {
    uint32_t glyph;
    int series; /* whose it is; −1: an axis, a figure, or nothing */
} view_chart_cell;

/* The letter that marks a series' newest point, and its line in a legend: A, B … Z, then lower case. */
char view_chart_letter(int series);

/* Draws series [count] into cells[height][width]. Where lines cross, the later series is seen. With nothing to draw, the axes alone. */
void view_chart(const view_chart_series *series, int count, const view_chart_options *options, view_chart_cell *cells);

#endif
