/* Figures by gnuplot. */
#ifndef SUNDER_CLI_GNUPLOT_H
#define SUNDER_CLI_GNUPLOT_H

#include "base/status.h"

#include <stdbool.h>

typedef struct gnuplot_figure {
    const char *title, *x_label, *y_label;
    bool log_x, log_y, points;
    int width, height; /* pixels, or a hundredth of an inch for .pdf */
    int count;
    const char *const *names; /* [count] */
    const double *const *x, *const *y; /* [count][sizes[i]] */
    const int *sizes;         /* [count] */
} gnuplot_figure;

/* Writes a figure; the suffix says as what: .png, .svg, .pdf, or .gp, the script itself with its data, which needs no gnuplot.
 * Errors: STATUS_INPUT for another suffix; STATUS_SYSTEM when gnuplot is not there (with its package) or fails (with its words). */
status gnuplot_write(const char *path, const gnuplot_figure *figure, report *r);

#endif
