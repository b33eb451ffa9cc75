/* Small maps of numbers over two directions: the histogram over time, a measure over two parameters. */
#ifndef SUNDER_VIEW_HEAT_H
#define SUNDER_VIEW_HEAT_H

#include <stdbool.h>
#include <stdint.h>

/* from[rows][columns] → to[height][width]. Where there are more values than places, a place is the mean of its share (of the finite
 * ones); where there are fewer, a value fills several places. NaN where nothing is. All four numbers must be > 0. */
void view_heat_resample(const double *from, int rows, int columns, double *to, int height, int width);

/* Maps values to [0,1] for a colour map, in place: linear from 0 to the largest, or logarithmic from `floor` (> 0) to the largest. What
 * is not above 0 becomes −1: empty. */
void view_heat_scale(double *values, int count, bool logarithmic, double floor);

/* The character for a value in [0,1] where there is no colour; a space when it is empty. */
char view_heat_ascii(double value);

#endif
