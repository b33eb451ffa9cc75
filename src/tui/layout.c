#include "tui/shell.h"
#include "tui/widgets.h"

static void draw_small(const tui_app *app, tui_area all) {
    static const char *const lines[] = {"too small", "40 x 10 needed", "q quits"};
    const char *question = "stop? q/y";
    int rows = (int)(sizeof lines / sizeof *lines), top = all.height > rows ? (all.height - rows) / 2 : 0;
    for (int i = 0; i < rows && top + i < all.height; i++) {
        const char *text = app->shell->asking && i == rows - 1 ? question : lines[i];
        int column = (all.width - draw_width(text)) / 2;
        draw_text(&app->theme, all, top + i, column > 0 ? column : 0, i == 0 ? STYLE_WARN : STYLE_TEXT, text);
    }
    if (all.height <= 2 && app->shell->asking) draw_text(&app->theme, all, 0, 0, STYLE_WARN, question);
}

void workbench_draw(tui_app *app) {
    tui_area all = {0, 0, LINES, COLS};
    report unused;
    erase();
    app->small = all.width < SCREEN_MINIMUM_WIDTH || all.height < SCREEN_MINIMUM_HEIGHT;
    if (app->small) {
        draw_small(app, all);
    } else {
        bool typing = app->shell->prompt.open;
        int message = app->page == PAGE_NONE && !typing ? message_rows(app, all.width) : 1;
        tui_area body = {1, 0, all.height - 2 - message, all.width}, last = {all.height - 1, 0, 1, all.width};
        app->body = body;
        widget_title(app, (tui_area){0, 0, 1, all.width});
        if (app->page != PAGE_NONE) {
            widget_page(app, body);
        } else {
            app->screen->draw(app, screen_state(app, app->screen, &unused), body);
        }
        tui_area line = {all.height - 1 - message, 0, message, all.width};
        if (typing) {
            widget_candidates(app, line);
            widget_prompt(app, last);
        } else {
            widget_message(app, line);
            widget_keys(app, last);
        }
    }
    refresh();
}
