#include "view/chart.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

enum { FIGURE = 16, FIGURE_WIDTH = 9 /* columns left of the axis */ };

/* An axis in the coordinates that are drawn: logarithms where it is logarithmic. */
typedef struct axis {
    double low, high, step; /* step: between figures; 0 where there is none to be had */
    bool log;
} axis;

typedef struct chart {
    const view_chart_options *o;
    view_chart_cell *cells;
    int left, bottom; /* columns before the plot; rows below it */
    int width, height; /* cells of the plot */
    axis x, y;
} chart;

char view_chart_letter(int series) {
    return (char)(series < 26 ? 'A' + series : 'a' + (series - 26) % 26);
}

/* ---- axes -------------------------------------------------------------------------------------------------------- */

static double coordinate(const axis *a, double value) {
    return a->log ? (value > 0 ? log10(value) : (double)NAN) : value;
}

static void widen(axis *a, double value) {
    double v = coordinate(a, value);
    if (!isfinite(v)) return;
    a->low = fmin(a->low, v);
    a->high = fmax(a->high, v);
}

/* The least of 1, 2, 5 × 10ⁿ that is no less than `least`. */
static double round_step(double least) {
    double power = pow(10, floor(log10(least)));
    double m = least / power;
    return power * (m <= 1.0000001 ? 1 : m <= 2.0000001 ? 2 : m <= 5.0000001 ? 5 : 10);
}

/* A logarithm, down to that of the next 1, 2 or 5 × 10ⁿ (of 1, 5, 2 for what is turned round: 1/5 and 1/2 are 2 and 5 tenths). */
static double round_down(double v) {
    double whole = floor(v + 1e-9), part = v - whole + 1e-9;
    return whole + (part >= 0.69897000433601880 ? 0.69897000433601880 : part >= 0.30102999566398120 ? 0.30102999566398120 : 0);
}

/* Widens the axis to whole steps, at most `figures` of them. */
static void settle(axis *a, int figures, bool round) {
    if (!(a->low <= a->high)) a->low = 0, a->high = 1;
    if (a->low == a->high) {
        double half = a->low == 0 ? 0.5 : 0.05 * fabs(a->low);
        a->low -= half;
        a->high += half;
    }
    a->step = round_step((a->high - a->low) / (figures > 1 ? figures - 1 : 1));
    if (a->log && a->step < 1) a->step = a->high - a->low >= 1 ? 1 : a->step;
    if (!round) return;
    if (a->log && a->high - a->low < 3) {
        a->low = round_down(a->low);
        a->high = -round_down(-a->high);
        return;
    }
    a->low = a->step * floor(a->low / a->step + 1e-9);
    a->high = a->step * ceil(a->high / a->step - 1e-9);
}

/* The index-th place of a figure, in the axis' coordinates; false after the last. Logarithmic axes of under three decades have 1, 2 and 5 of each. */
static bool tick(const axis *a, int index, double *at) {
    static const double parts[] = {0, 0.30102999566398120, 0.69897000433601880};
    if (a->log && a->high - a->low < 3) {
        int first = 3 * (int)floor(a->low);
        while (floor((double)first / 3) + parts[(first % 3 + 3) % 3] < a->low - 1e-9) first++;
        int k = first + index;
        *at = floor((double)k / 3) + parts[(k % 3 + 3) % 3];
        return *at <= a->high + 1e-9;
    }
    *at = a->step * ceil(a->low / a->step - 1e-9) + index * a->step;
    return *at <= a->high + 1e-9 * a->step;
}

static void figure(const axis *a, double at, char text[FIGURE]) {
    if (fabs(at) < 1e-9 * a->step) at = 0;
    snprintf(text, FIGURE, "%.4g", a->log ? pow(10, at) : at);
}

/* ---- cells ------------------------------------------------------------------------------------------------------- */

static void put(const chart *c, int row, int column, uint32_t glyph) {
    if (row >= 0 && row < c->o->height && column >= 0 && column < c->o->width)
        c->cells[row * c->o->width + column] = (view_chart_cell){glyph, -1};
}

static void put_text(const chart *c, int row, int column, const char *text) {
    for (int i = 0; text[i]; i++) put(c, row, column + i, (unsigned char)text[i]);
}

static void draw_y_axis(const chart *c) {
    bool ascii = c->o->ascii;
    for (int row = 0; row < c->height; row++) put(c, row, c->left - 1, ascii ? '|' : 0x2502);
    int last = c->height + 1;
    double at;
    for (int i = 0; tick(&c->y, i, &at); i++) {
        int row = (int)lrint((c->y.high - at) / (c->y.high - c->y.low) * (c->height - 1));
        if (last - row < 2) continue;
        char text[FIGURE];
        figure(&c->y, at, text);
        int length = (int)strlen(text);
        put_text(c, row, length < c->left - 1 ? c->left - 1 - length : 0, text);
        put(c, row, c->left - 1, ascii ? '+' : 0x2524);
        last = row;
    }
}

static void draw_x_axis(const chart *c) {
    bool ascii = c->o->ascii;
    int row = c->height, end = 0;
    int label = c->o->x_label ? (int)strlen(c->o->x_label) : 0;
    put(c, row, c->left - 1, ascii ? '+' : 0x2514);
    for (int column = 0; column < c->width; column++) put(c, row, c->left + column, ascii ? '-' : 0x2500);
    double at;
    for (int i = 0; tick(&c->x, i, &at); i++) {
        int column = c->left + (int)lrint((at - c->x.low) / (c->x.high - c->x.low) * (c->width - 1));
        char text[FIGURE];
        figure(&c->x, at, text);
        int length = (int)strlen(text), from = column - length / 2;
        if (from < end || from + length > c->o->width - (label ? label + 1 : 0)) continue;
        put(c, row, column, ascii ? '+' : 0x252c);
        put_text(c, row + 1, from, text);
        end = from + length + 1;
    }
    if (label && label < c->width) put_text(c, row + 1, c->o->width - label, c->o->x_label);
}

/* ---- dots -------------------------------------------------------------------------------------------------------- */

/* Sets one dot of the braille raster (2 × 4 a cell), or the cell where there is no braille. */
static void dot(const chart *c, int series, int x, int y) {
    static const uint8_t bits[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
    if (x < 0 || y < 0 || x >= 2 * c->width || y >= 4 * c->height) return;
    view_chart_cell *cell = &c->cells[(y / 4) * c->o->width + c->left + x / 2];
    if (c->o->ascii) {
        *cell = (view_chart_cell){'*', series};
        return;
    }
    uint32_t before = cell->glyph >= 0x2800 && cell->glyph <= 0x28ff ? cell->glyph : 0x2800;
    *cell = (view_chart_cell){before | bits[y % 4][x % 2], series};
}

static void line(const chart *c, int series, const double from[2], const double to[2]) {
    double dx = to[0] - from[0], dy = to[1] - from[1];
    int steps = (int)ceil(fmax(fabs(dx), fabs(dy)));
    for (int i = 0; i <= steps; i++) {
        double t = steps ? (double)i / steps : 0;
        dot(c, series, (int)lrint(from[0] + t * dx), (int)lrint(from[1] + t * dy));
    }
}

/* A cross of five dots. */
static void mark(const chart *c, int series, const double at[2]) {
    int x = (int)lrint(at[0]), y = (int)lrint(at[1]);
    for (int i = -1; i <= 1; i++) {
        dot(c, series, x + i, y);
        dot(c, series, x, y + i);
    }
}

/* Where a pair lies in dots; false for one that is not drawn. */
static bool locate(const chart *c, double x, double y, double at[2]) {
    double u = coordinate(&c->x, x), v = coordinate(&c->y, y);
    if (!isfinite(u) || !isfinite(v)) return false;
    at[0] = (u - c->x.low) / (c->x.high - c->x.low) * (2 * c->width - 1);
    at[1] = (c->y.high - v) / (c->y.high - c->y.low) * (4 * c->height - 1);
    return true;
}

static void draw_series(const chart *c, int which, const view_chart_series *s) {
    double before[2], at[2];
    bool joined = false;
    for (int i = 0; i < s->count; i++) {
        bool here = locate(c, s->x[i], s->y[i], at);
        if (here && s->points) mark(c, which, at);
        else if (here) line(c, which, joined ? before : at, at);
        joined = here;
        memcpy(before, at, sizeof before);
    }
}

/* The letter stands at the newest point; where another letter stands, as near to it as there is room. */
static void draw_letter(const chart *c, int which, const view_chart_series *s) {
    double last[2];
    int newest = s->count - 1;
    while (newest >= 0 && !locate(c, s->x[newest], s->y[newest], last)) newest--;
    if (newest < 0) return;
    int column = c->left + (int)lrint(last[0]) / 2, row = (int)lrint(last[1]) / 4;
    for (int shift = 0; shift < 2 * c->height; shift++) {
        int at = row + (shift % 2 ? (shift + 1) / 2 : -shift / 2);
        if (at < 0 || at >= c->height) continue;
        view_chart_cell *cell = &c->cells[at * c->o->width + column];
        if (cell->glyph < 0x80 && cell->glyph != ' ' && cell->glyph != '*') continue;
        *cell = (view_chart_cell){(unsigned char)view_chart_letter(which), which};
        return;
    }
}

void view_chart(const view_chart_series *series, int count, const view_chart_options *o, view_chart_cell *cells) {
    assert(o->width >= VIEW_CHART_LEAST_WIDTH && o->height >= VIEW_CHART_LEAST_HEIGHT);
    chart c = {.o = o, .cells = cells, .left = FIGURE_WIDTH + 1, .bottom = 2, .x = {HUGE_VAL, -HUGE_VAL, 0, o->log_x},
               .y = {HUGE_VAL, -HUGE_VAL, 0, o->log_y}};
    c.width = o->width - c.left;
    c.height = o->height - c.bottom;
    for (int i = 0; i < o->width * o->height; i++) cells[i] = (view_chart_cell){' ', -1};
    for (int s = 0; s < count; s++)
        for (int i = 0; i < series[s].count; i++) {
            if (!isfinite(coordinate(&c.x, series[s].x[i])) || !isfinite(coordinate(&c.y, series[s].y[i]))) continue;
            widen(&c.x, series[s].x[i]);
            widen(&c.y, series[s].y[i]);
        }
    settle(&c.x, c.width / 12 + 1, false);
    settle(&c.y, c.height / 3 + 1, true);
    for (int s = 0; s < count; s++) draw_series(&c, s, &series[s]);
    for (int s = 0; s < count && count > 1; s++) draw_letter(&c, s, &series[s]); /* above all lines */
    draw_y_axis(&c);
    draw_x_axis(&c);
}
