#include "tui/widgets.h"

#include <stdio.h>

typedef struct state_word {
    const char *word;
    tui_style style;
} state_word;

static state_word describe(const tui_app *app) {
    const session_snapshot *s = app->shot;
    if (app_starting(app)) return (state_word){"starting", STYLE_BAR};
    if (app->run && s->state == SESSION_ENDED) {
        switch (s->outcome) {
        case STATUS_OK: return (state_word){"done", STYLE_BAR_GOOD};
        case STATUS_INTERRUPTED: return (state_word){"stopped", STYLE_BAR_WARN};
        default: return (state_word){"failed", STYLE_BAR_BAD};
        }
    }
    if (!app->run) return (state_word){"", STYLE_BAR};
    if (app->stopping) return (state_word){"stopping", STYLE_BAR_WARN};
    switch (s->state) {
    case SESSION_RUNNING: return (state_word){"running", STYLE_BAR_GOOD};
    case SESSION_PAUSED: return (state_word){"paused", STYLE_BAR_WARN};
    default: return (state_word){"starting", STYLE_BAR};
    }
}

static int tab_width(const tui_screen *screen) {
    return draw_width(screen->title) + 2;
}

/* Which screens' names fit beside the run's title: the one in view, those that Tab goes to next, and then those before it. */
static void choose_tabs(const tui_app *app, int room, int *first, int *last) {
    int count, used;
    const tui_screen *const *list = tui_screens(&count);
    for (*first = 0; *first < count - 1 && list[*first] != app->screen;) (*first)++;
    *last = *first;
    used = tab_width(list[*first]);
    while (*last + 1 < count && used + tab_width(list[*last + 1]) <= room) used += tab_width(list[++*last]);
    while (*first > 0 && used + tab_width(list[*first - 1]) <= room) used += tab_width(list[--*first]);
}

/* The screens' names, the one in view marked. */
static int draw_screens(const tui_app *app, tui_area area, int column) {
    enum { TITLE = 17 }; /* a gap, "Tube pull · full" */
    int count, first, last;
    const tui_screen *const *list = tui_screens(&count);
    choose_tabs(app, area.width - column - TITLE, &first, &last);
    for (int i = first; i <= last; i++) {
        bool here = list[i] == app->screen;
        const char *open = here ? "[" : i == first && i > 0 ? "<" : " ", *close = here ? "]" : i == last && i + 1 < count ? ">" : " ";
        column = draw_text(&app->theme, area, 0, column, here ? STYLE_BAR_STRONG : STYLE_BAR, open);
        column = draw_text(&app->theme, area, 0, column, here ? STYLE_BAR_STRONG : STYLE_BAR, list[i]->title);
        column = draw_text(&app->theme, area, 0, column, here ? STYLE_BAR_STRONG : STYLE_BAR, close);
    }
    return column;
}

void widget_title(const tui_app *app, tui_area area) {
    const session_snapshot *s = app->shot;
    const tui_theme *t = &app->theme;
    draw_blank(t, area, 0, STYLE_BAR);
    state_word state = describe(app);
    int right = area.width - 1;
    draw_right(t, area, 0, right, state.style, state.word);
    right -= 10; /* the longest state and a gap */
    tui_area left = {area.y, area.x, 1, right};
    int column = draw_text(t, left, 0, 1, STYLE_BAR, "sunder") + 1;
    column = draw_screens(app, left, column) + 1;
    if (!app->run) return;
    int run_width = draw_width(s->run_id), title_width = draw_width(s->title) + draw_width(s->variant) + 3;
    if (run_width > 0 && column + title_width + run_width + 2 <= right) {
        draw_right(t, area, 0, right, STYLE_BAR, s->run_id);
        left.width -= run_width + 2;
    }
    column = draw_text(t, left, 0, column, STYLE_BAR_STRONG, s->title[0] ? s->title : "untitled");
    if (s->variant[0]) draw_format(t, left, 0, column, STYLE_BAR, " · %s", s->variant);
}
