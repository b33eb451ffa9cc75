/* Small plots in a line of text: sparklines and bars. All of them write exactly `width` columns, so that nothing around
 * them moves. Text needs VIEW_PLOT_BYTES(width) bytes. */
#ifndef SUNDER_VIEW_PLOT_H
#define SUNDER_VIEW_PLOT_H

#include <stdbool.h>

#define VIEW_PLOT_BYTES(width) (3 * (size_t)(width) + 1)

/* The newest columns of a series at the right end: values[count], oldest first. With more values than columns each
 * column is the mean of its share; with fewer the left stays blank. Levels run from `low` (lowest glyph) to `high` in
 * eight steps (seven without Unicode); values that are not finite are blank. */
void view_sparkline(const double *values, int count, double low, double high, int width, bool ascii, char *text);

/* A horizontal bar filling `fraction` (clamped to [0,1]; NaN counts as 0) in eighths of a column, or whole ones without
 * Unicode. A fraction above 0 shows at least its smallest mark. */
void view_bar(double fraction, int width, bool ascii, char *text);

/* Where `value` lies between `floor` and `top` on a logarithmic scale, in [0,1]; 0 at and below the floor, which must
 * be > 0. */
double view_log_fraction(double value, double floor, double top);

/* Adds groups of neighbouring bins: from[bins] to to[groups]; bins must be a multiple of groups. */
void view_rebin(const double *from, int bins, double *to, int groups);

#endif
