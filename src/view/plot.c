#include "view/plot.h"

#include <assert.h>
#include <math.h>
#include <string.h>

enum { BLOCKS = 8, ASCII_LEVELS = 7 };

static const char *const rising[BLOCKS] = {"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
static const char *const growing[BLOCKS + 1] = {"", "▏", "▎", "▍", "▌", "▋", "▊", "▉", "█"};
static const char *const ascii_rising[ASCII_LEVELS] = {"_", ".", "-", "=", "+", "*", "#"};

static char *append(char *to, const char *glyph) {
    size_t length = strlen(glyph);
    memcpy(to, glyph, length);
    return to + length;
}

static const char *level_glyph(double value, double low, double high, bool ascii) {
    if (!isfinite(value)) return " ";
    double fraction = high > low ? (value - low) / (high - low) : 0;
    int levels = ascii ? ASCII_LEVELS : BLOCKS;
    int level = (int)(fmin(fmax(fraction, 0), 1) * levels);
    if (level > levels - 1) level = levels - 1;
    return ascii ? ascii_rising[level] : rising[level];
}

/* The mean of values[from..to), NaN when none is finite. */
static double share(const double *values, int from, int to) {
    double sum = 0;
    int finite = 0;
    for (int i = from; i < to; i++) {
        if (!isfinite(values[i])) continue;
        sum += values[i];
        finite++;
    }
    return finite ? sum / finite : NAN;
}

void view_sparkline(const double *values, int count, double low, double high, int width, bool ascii, char *text) {
    assert(count >= 0 && width >= 0);
    int blank = count < width ? width - count : 0, columns = width - blank;
    for (int i = 0; i < blank; i++) text = append(text, " ");
    for (int i = 0; i < columns; i++) {
        int from = (int)((long)i * count / columns), to = (int)((long)(i + 1) * count / columns);
        text = append(text, level_glyph(share(values, from, to), low, high, ascii));
    }
    *text = '\0';
}

void view_bar(double fraction, int width, bool ascii, char *text) {
    assert(width >= 0);
    int parts = ascii ? 1 : BLOCKS;
    double filled = isnan(fraction) ? 0 : fmin(fmax(fraction, 0), 1) * width * parts;
    int marks = (int)lrint(filled);
    if (marks == 0 && filled > 0) marks = 1;
    for (int i = 0; i < width; i++, marks -= parts) {
        if (marks <= 0) {
            text = append(text, " ");
        } else if (ascii) {
            text = append(text, "#");
        } else {
            text = append(text, growing[marks < BLOCKS ? marks : BLOCKS]);
        }
    }
    *text = '\0';
}

double view_log_fraction(double value, double floor, double top) {
    assert(floor > 0);
    if (!(value > floor) || !(top > floor)) return 0;
    return fmin(log(value / floor) / log(top / floor), 1);
}

void view_rebin(const double *from, int bins, double *to, int groups) {
    assert(groups > 0 && bins % groups == 0);
    int each = bins / groups;
    for (int g = 0; g < groups; g++) {
        to[g] = 0;
        for (int i = 0; i < each; i++) to[g] += from[g * each + i];
    }
}
