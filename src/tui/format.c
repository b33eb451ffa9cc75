#include "tui/format.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

void format_count(int64_t count, int columns, char text[FORMAT_BYTES]) {
    char digits[FORMAT_BYTES];
    int length = snprintf(digits, sizeof digits, "%lld", (long long)count), to = 0;
    if (length + (length - 1) / 3 > columns) {
        snprintf(text, FORMAT_BYTES, "%.3f M", (double)count * 1e-6);
        return;
    }
    for (int i = 0; i < length; i++) {
        if (i > 0 && (length - i) % 3 == 0) text[to++] = ' ';
        text[to++] = digits[i];
    }
    text[to] = '\0';
}

static bool unknown(double value, char text[FORMAT_BYTES]) {
    if (isfinite(value)) return false;
    snprintf(text, FORMAT_BYTES, "–");
    return true;
}

void format_real(double value, char text[FORMAT_BYTES]) {
    if (!unknown(value, text)) snprintf(text, FORMAT_BYTES, value < 0 ? "%.2e" : "%.3e", value);
}

void format_clock(double seconds, char text[FORMAT_BYTES]) {
    if (unknown(seconds >= 0 && seconds < 1e9 ? seconds : NAN, text)) return;
    long whole = lrint(seconds);
    snprintf(text, FORMAT_BYTES, "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60, whole % 60);
}

void format_seconds(double seconds, char text[FORMAT_BYTES]) {
    if (unknown(seconds >= 0 ? seconds : NAN, text)) return;
    if (seconds < 0.0995) {
        snprintf(text, FORMAT_BYTES, "%.1f ms", seconds * 1e3);
    } else {
        snprintf(text, FORMAT_BYTES, "%.*f s", seconds < 9.9995 ? 3 : seconds < 99.995 ? 2 : 1, seconds);
    }
}

void format_percent(double fraction, char text[FORMAT_BYTES]) {
    if (unknown(fraction, text)) return;
    if (fraction > 0 && fraction < 0.00005) {
        snprintf(text, FORMAT_BYTES, "<0.01 %%");
    } else {
        snprintf(text, FORMAT_BYTES, "%.*f %%", fraction > 0.99995 ? 1 : 2, 100 * fraction);
    }
}
