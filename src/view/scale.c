#include "view/scale.h"

#include "base/compare.h"

#include <math.h>
#include <stdlib.h>

enum { SAMPLE = 4096 };

view_scale view_scale_fit(const float *values, int64_t count) {
    float sample[SAMPLE];
    int found = 0;
    int64_t stride = count / SAMPLE + 1;
    for (int64_t i = 0; i < count && found < SAMPLE; i += stride) {
        if (isfinite(values[i])) sample[found++] = values[i];
    }
    if (found == 0) return (view_scale){0, 0};
    qsort(sample, (size_t)found, sizeof *sample, compare_f32);
    view_scale scale = {sample[found / 200], sample[found - 1 - found / 200]};
    if (scale.high > scale.low) return scale;
    /* Nearly all are alike: what is not decides. */
    scale = (view_scale){sample[0], sample[found - 1]};
    if (scale.high > scale.low) return scale;
    double around = scale.low == 0 ? 1 : 0.5 * fabs(scale.low);
    return scale.low == 0 ? (view_scale){0, around} : (view_scale){scale.low - around, scale.low + around};
}

view_scale view_scale_join(view_scale a, view_scale b) {
    if (!(a.high > a.low)) return b;
    if (!(b.high > b.low)) return a;
    return (view_scale){fmin(a.low, b.low), fmax(a.high, b.high)};
}

float view_scale_place(view_scale scale, double value) {
    if (isnan(value)) return NAN;
    double place = scale.high > scale.low ? (value - scale.low) / (scale.high - scale.low) : 0;
    return (float)fmin(fmax(place, 0), 1);
}

void view_scale_apply(view_scale scale, const float *from, float *to, int64_t count) {
    for (int64_t i = 0; i < count; i++) to[i] = view_scale_place(scale, (double)from[i]);
}

double view_scale_value(view_scale scale, double place) {
    return scale.low + place * (scale.high - scale.low);
}
