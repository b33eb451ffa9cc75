#include "view/heat.h"

#include "view/plot.h"

#include <assert.h>
#include <math.h>

/* The values that fall to place `index` of `places`, at least one. */
static void share_of(int index, int places, int count, int *from, int *to) {
    *from = (int)((int64_t)index * count / places);
    *to = (int)((int64_t)(index + 1) * count / places);
    if (*to <= *from) *to = *from + 1;
}

static double mean_of(const double *values, int columns, int y0, int y1, int x0, int x1) {
    double sum = 0;
    int finite = 0;
    for (int y = y0; y < y1; y++) {
        for (int x = x0; x < x1; x++) {
            double value = values[(int64_t)y * columns + x];
            if (!isfinite(value)) continue;
            sum += value;
            finite++;
        }
    }
    return finite ? sum / finite : NAN;
}

void view_heat_resample(const double *from, int rows, int columns, double *to, int height, int width) {
    assert(rows > 0 && columns > 0 && height > 0 && width > 0);
    for (int y = 0; y < height; y++) {
        int y0, y1, x0, x1;
        share_of(y, height, rows, &y0, &y1);
        for (int x = 0; x < width; x++) {
            share_of(x, width, columns, &x0, &x1);
            to[(int64_t)y * width + x] = mean_of(from, columns, y0, y1, x0, x1);
        }
    }
}

void view_heat_scale(double *values, int count, bool logarithmic, double floor) {
    double most = 0;
    for (int i = 0; i < count; i++) {
        if (isfinite(values[i])) most = fmax(most, values[i]);
    }
    for (int i = 0; i < count; i++) {
        if (!(values[i] > 0) || !isfinite(values[i])) {
            values[i] = -1;
        } else {
            values[i] = logarithmic ? view_log_fraction(values[i], floor, fmax(most, 2 * floor)) : values[i] / most;
        }
    }
}

char view_heat_ascii(double value) {
    static const char ramp[] = ".:-=+*#%@";
    enum { LAST = sizeof ramp - 2 };
    if (!(value >= 0)) return ' ';
    int step = (int)(fmin(value, 1) * (LAST + 1));
    return ramp[step > LAST ? LAST : step];
}
