#include "tui/heat_map.h"

#include "view/heat.h"

static bool in_halves(const tui_theme *theme) {
    return !theme->ascii && theme->colours >= 8;
}

int heat_map_rows(const tui_theme *theme) {
    return in_halves(theme) ? 2 : 1;
}

static void draw_halves(tui_theme *theme, tui_area area, int row, int column, double upper, double lower) {
    int above = upper < 0 ? -1 : theme_colour(theme, (float)upper, 1), below = lower < 0 ? -1 : theme_colour(theme, (float)lower, 1);
    if (above < 0 && below < 0) return;
    if (above < 0) draw_glyph(area, row, column, theme_pair(theme, below, -1), 0x2584);
    else draw_glyph(area, row, column, theme_pair(theme, above, below), 0x2580);
}

void heat_map_draw(tui_theme *theme, tui_area area, int row, int column, const double *values, int height, int width) {
    int each = heat_map_rows(theme);
    for (int y = 0; y < height; y += each) {
        for (int x = 0; x < width; x++) {
            double value = values[(long)y * width + x];
            if (each == 2) {
                draw_halves(theme, area, row + y / 2, column + x, value, values[(long)(y + 1) * width + x]);
            } else if (value >= 0) {
                draw_glyph(area, row + y, column + x, theme_value(theme, (float)value), (uint32_t)(unsigned char)view_heat_ascii(value));
            }
        }
    }
}
