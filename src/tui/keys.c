#include "tui/widgets.h"

#include "tui/actions.h"

#include <stdio.h>
#include <string.h>

/* The first word of "s  .": one key stands for all that an action has. */
static void first_key(const char *shown, char key[16]) {
    size_t length = strcspn(shown, " ");
    snprintf(key, 16, "%.*s", (int)length, shown);
}

/* Of the screen's own actions, or of the global ones, whose word is always the same. */
static int draw_hints(const tui_app *app, tui_area area, int column, const tui_screen *screen, const void *state, const tui_action *actions, int count) {
    for (int i = 0; i < count; i++) {
        char key[16];
        const char *word = screen && screen->hint ? screen->hint(state, &actions[i]) : actions[i].hint;
        if (!word) continue;
        first_key(actions[i].keys_shown, key);
        int width = draw_width(key) + 1 + draw_width(word);
        if (column + width > area.width - 1) continue;
        column = draw_text(&app->theme, area, 0, column, STYLE_BAR_STRONG, key);
        column = draw_text(&app->theme, area, 0, column + 1, STYLE_BAR, word) + 2;
    }
    return column;
}

/* The global ones last, but they have their place: room for them is kept. */
void widget_keys(tui_app *app, tui_area area) {
    report unused;
    int count, width = 0;
    const tui_action *global = tui_actions(&count);
    draw_blank(&app->theme, area, 0, STYLE_BAR);
    for (int i = 0; i < count; i++) {
        char key[16];
        if (!global[i].hint) continue;
        first_key(global[i].keys_shown, key);
        width += draw_width(key) + draw_width(global[i].hint) + 3;
    }
    tui_area own = area;
    own.width -= width;
    int column = draw_hints(app, own, 1, app->screen, screen_state(app, app->screen, &unused), app->screen->actions, app->screen->action_count);
    draw_hints(app, area, column, NULL, NULL, global, count);
}
