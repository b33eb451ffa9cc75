#include "tui/widgets.h"

enum { PANEL_BESIDE = 72, PANEL_NARROWEST = 36, PANEL_WIDEST = 60 };

static void draw_small(const tui_app *app, tui_area all) {
    static const char *const lines[] = {"too small", "40 x 10 needed", "q quits"};
    const char *question = "stop? q/y";
    int rows = (int)(sizeof lines / sizeof *lines), top = all.height > rows ? (all.height - rows) / 2 : 0;
    for (int i = 0; i < rows && top + i < all.height; i++) {
        const char *text = app->asking && i == rows - 1 ? question : lines[i];
        int column = (all.width - draw_width(text)) / 2;
        draw_text(&app->theme, all, top + i, column > 0 ? column : 0, i == 0 ? STYLE_WARN : STYLE_TEXT, text);
    }
    if (all.height <= 2 && app->asking) draw_text(&app->theme, all, 0, 0, STYLE_WARN, question);
}

/* The panel stands beside the picture where there is room for both, else it lies below. */
static void draw_run(tui_app *app, tui_area body) {
    if (body.width >= PANEL_BESIDE) {
        int panel = body.width * 3 / 10;
        panel = panel < PANEL_NARROWEST ? PANEL_NARROWEST : panel > PANEL_WIDEST ? PANEL_WIDEST : panel;
        tui_area picture = {body.y, body.x, body.height, body.width - panel - 3};
        tui_area side = {body.y, body.x + body.width - panel - 1, body.height, panel};
        for (int row = 0; row < body.height; row++) draw_text(&app->theme, body, row, picture.width, STYLE_DIM, "│");
        widget_particles(app, picture);
        widget_panel(app, side);
        return;
    }
    int strip = body.height >= 18 ? 13 : body.height >= 12 ? 7 : 3;
    tui_area picture = {body.y, body.x, body.height - strip, body.width};
    tui_area below = {body.y + picture.height, body.x + 1, strip, body.width - 2};
    widget_particles(app, picture);
    widget_strip(app, below);
}

void screen_draw(tui_app *app) {
    tui_area all = {0, 0, LINES, COLS};
    erase();
    if (all.width < SCREEN_MINIMUM_WIDTH || all.height < SCREEN_MINIMUM_HEIGHT) {
        draw_small(app, all);
    } else {
        int message = app->page == PAGE_RUN ? message_rows(app, all.width) : 1;
        tui_area body = {1, 0, all.height - 2 - message, all.width};
        widget_title(app, (tui_area){0, 0, 1, all.width});
        switch (app->page) {
        case PAGE_HELP: widget_help(app, body); break;
        case PAGE_LOG: widget_log(app, body); break;
        default: draw_run(app, body); break;
        }
        widget_message(app, (tui_area){all.height - 1 - message, 0, message, all.width});
        widget_keys(app, (tui_area){all.height - 1, 0, 1, all.width});
    }
    refresh();
}
