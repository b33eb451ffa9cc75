#include "tui/widgets.h"

#include "tui/actions.h"
#include "tui/capture.h"

#include <string.h>

/* Keeps the first shown line within 0 … total − rows. */
static void clamp_scroll(tui_app *app, int total, int rows) {
    int last = total > rows ? total - rows : 0;
    if (app->scroll > last) app->scroll = last;
    if (app->scroll < 0) app->scroll = 0;
}

void widget_help(tui_app *app, tui_area area) {
    int count;
    const tui_action *actions = tui_actions(&count);
    bool more = count > area.height - 1;
    draw_heading(&app->theme, area, 0, "keys", more ? "up and down scroll, q closes" : "q closes");
    int rows = area.height - 1;
    clamp_scroll(app, count, rows);
    for (int i = 0; i < rows && i + app->scroll < count; i++) {
        const tui_action *a = &actions[i + app->scroll];
        draw_text(&app->theme, area, i + 1, 1, STYLE_STRONG, a->keys_shown);
        draw_text(&app->theme, area, i + 1, 11, STYLE_TEXT, a->help);
        if (area.width >= 70) draw_right(&app->theme, area, i + 1, area.width - 1, STYLE_DIM, a->name);
    }
}

static int count_lines(const char *text) {
    int lines = 0;
    for (; *text; text++) {
        if (*text == '\n' || text[1] == '\0') lines++;
    }
    return lines;
}

void widget_log(tui_app *app, tui_area area) {
    static char text[CAPTURE_KEPT + 1];
    capture_tail(text);
    draw_heading(&app->theme, area, 0, "printed by libraries", "up and down scroll, q closes");
    if (!text[0]) {
        draw_text(&app->theme, area, 1, 1, STYLE_DIM, "Nothing so far.");
        return;
    }
    int total = count_lines(text), rows = area.height - 1;
    if (app->at_end) app->scroll = total;
    clamp_scroll(app, total, rows);
    app->at_end = app->scroll >= total - rows;
    int line = 0;
    for (char *start = text; *start && line - app->scroll < rows; line++) {
        size_t length = strcspn(start, "\n");
        char *next = start + length + (start[length] == '\n');
        start[length] = '\0';
        if (line >= app->scroll) draw_text(&app->theme, area, line - app->scroll + 1, 1, STYLE_TEXT, start);
        start = next;
    }
}
