#include "tui/widgets.h"

#include <stdio.h>

typedef struct state_word {
    const char *word;
    tui_style style;
} state_word;

static state_word describe(const tui_app *app) {
    const session_snapshot *s = app->shot;
    if (s->state == SESSION_ENDED) {
        switch (s->outcome) {
        case STATUS_OK: return (state_word){"done", STYLE_BAR_GOOD};
        case STATUS_INTERRUPTED: return (state_word){"stopped", STYLE_BAR_WARN};
        default: return (state_word){"failed", STYLE_BAR_BAD};
        }
    }
    if (app->stopping) return (state_word){"stopping", STYLE_BAR_WARN};
    switch (s->state) {
    case SESSION_RUNNING: return (state_word){"running", STYLE_BAR_GOOD};
    case SESSION_PAUSED: return (state_word){"paused", STYLE_BAR_WARN};
    default: return (state_word){"starting", STYLE_BAR};
    }
}

void widget_title(const tui_app *app, tui_area area) {
    const session_snapshot *s = app->shot;
    const tui_theme *t = &app->theme;
    draw_blank(t, area, 0, STYLE_BAR);
    state_word state = describe(app);
    int right = area.width - 1;
    draw_right(t, area, 0, right, state.style, state.word);
    right -= 10; /* the longest state and a gap */
    int run_width = draw_width(s->run_id);
    bool show_run = run_width > 0 && area.width >= 36 + run_width;
    if (show_run) {
        draw_right(t, area, 0, right, STYLE_BAR, s->run_id);
        right -= run_width + 2;
    }
    tui_area left = {area.y, area.x, 1, right};
    int column = draw_text(t, left, 0, 1, STYLE_BAR, "sunder");
    column = draw_text(t, left, 0, column + 2, STYLE_BAR_STRONG, s->title[0] ? s->title : "untitled");
    if (s->variant[0]) draw_format(t, left, 0, column, STYLE_BAR, " · %s", s->variant);
}
