/* From a quantity with a unit to the [0,1] of a colour map, and back to the numbers of its legend. */
#ifndef SUNDER_VIEW_SCALE_H
#define SUNDER_VIEW_SCALE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct view_scale {
    double low, high; /* what 0 and 1 of the colour map stand for */
} view_scale;

/* The scale that holds the finite ones of values[count], but for the lowest and highest half per cent of them: one particle that flies
 * off must not make all others one colour. `none` (low and high 0) when none is finite. A constant quantity gets a scale around it. */
view_scale view_scale_fit(const float *values, int64_t count);

/* The smallest scale that holds both; one whose high is not above its low holds nothing. */
view_scale view_scale_join(view_scale a, view_scale b);

/* The value's place on the scale, clamped to [0,1]; NaN stays NaN. */
float view_scale_place(view_scale scale, double value);

/* As view_scale_place for an array; `to` may be `from`. */
void view_scale_apply(view_scale scale, const float *from, float *to, int64_t count);

/* The value at a place in [0,1]. */
double view_scale_value(view_scale scale, double place);

#endif
