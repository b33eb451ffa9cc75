#include "tui/chart_draw.h"

tui_ink chart_ink(tui_app *app, int curve) {
    static const short wide[] = {39, 208, 170, 71, 203, 141, 178, 80, 167, 109, 245, 133}, narrow[] = {6, 3, 5, 2, 1, 4};
    if (app->theme.colours == 0) return app->theme.styles[STYLE_TEXT];
    int colour = app->theme.colours >= 256 ? wide[curve % 12] : narrow[curve % 6];
    return theme_pair(&app->theme, colour, -1);
}

void chart_draw(tui_app *app, tui_area area, const view_chart_options *o, const view_chart_cell *cells) {
    for (int row = 0; row < o->height; row++)
        for (int column = 0; column < o->width; column++) {
            const view_chart_cell *cell = &cells[row * o->width + column];
            if (cell->glyph == ' ') continue;
            draw_glyph(area, row, column, cell->series < 0 ? app->theme.styles[STYLE_DIM] : chart_ink(app, cell->series), cell->glyph);
        }
}
