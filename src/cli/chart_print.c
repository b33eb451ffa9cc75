#include "cli/chart_print.h"

#include <stdio.h>

static void put_glyph(uint32_t glyph) {
    if (glyph < 0x80) putchar((int)glyph);
    else printf("%c%c%c", 0xe0 | (int)(glyph >> 12), 0x80 | (int)(glyph >> 6 & 0x3f), 0x80 | (int)(glyph & 0x3f));
}

int chart_colour(int series) {
    static const int colours[] = {36, 33, 35, 32, 31, 34};
    return colours[series % 6];
}

void chart_print(const view_chart_options *o, const view_chart_cell *cells, bool colour) {
    for (int row = 0; row < o->height; row++) {
        int now = -1;
        for (int column = 0; column < o->width; column++) {
            const view_chart_cell *cell = &cells[row * o->width + column];
            if (colour && cell->series != now) {
                if (cell->series < 0) printf("\033[0m");
                else printf("\033[%dm", chart_colour(cell->series));
                now = cell->series;
            }
            put_glyph(cell->glyph);
        }
        printf(colour && now >= 0 ? "\033[0m\n" : "\n");
    }
}
