#include "tui/shell.h"
#include "tui/widgets.h"

#include <stdio.h>
#include <string.h>

enum { MESSAGE_BYTES = 768 + 512, MESSAGE_ROWS = 3 };

static tui_style ended_text(const session_snapshot *s, char *text) {
    switch (s->outcome) {
    case STATUS_OK:
        snprintf(text, MESSAGE_BYTES, "Done.%s%s  b branches off, R runs again.", s->output[0] ? " Frames are in " : "", s->output);
        return STYLE_GOOD;
    case STATUS_INTERRUPTED:
        snprintf(text, MESSAGE_BYTES, "Stopped; kept up to frame %lld. %s", (long long)s->frame, s->message);
        return STYLE_WARN;
    default: snprintf(text, MESSAGE_BYTES, "%s", s->message[0] ? s->message : "The run failed."); return STYLE_BAD;
    }
}

/* What there is to say, the most pressing first. Writes it into text[MESSAGE_BYTES]. */
static tui_style compose(tui_app *app, int width, char *text) {
    const tui_shell *shell = app->shell;
    tui_style style = STYLE_TEXT;
    report unused;
    text[0] = '\0';
    if (shell->asking) {
        const char *also = shell->yes_key ? "%s  %c or y: yes   other keys: no" : "%s  y: yes   other keys: no";
        if (shell->yes_key) snprintf(text, MESSAGE_BYTES, also, shell->question, shell->yes_key);
        else snprintf(text, MESSAGE_BYTES, also, shell->question);
        return STYLE_WARN;
    }
    if (app->notice[0]) {
        snprintf(text, MESSAGE_BYTES, "%s", app->notice);
        return app->notice_bad ? STYLE_BAD : STYLE_TEXT;
    }
    if (shell->replay.active) {
        snprintf(text, MESSAGE_BYTES, "Doing again %s, line %d.  Q leaves", shell->replay.path, shell->replay.line);
        return STYLE_WARN;
    }
    if (app_starting(app)) {
        snprintf(text, MESSAGE_BYTES, "%s", app->ended ? "The run is being set up …" : "The run before is finishing its frame …");
        return STYLE_WARN;
    }
    if (app->screen->message && app->screen->message(app, screen_state(app, app->screen, &unused), text, MESSAGE_BYTES, &style))
        return style;
    if (!app->run) return STYLE_TEXT;
    if (app->ended) return ended_text(app->shot, text);
    if (app->abandoned) {
        snprintf(text, MESSAGE_BYTES, "Leaving at the next step.");
        return STYLE_WARN;
    }
    if (app->stopping) {
        snprintf(text, MESSAGE_BYTES, "%s",
                 width >= 70 ? "Finishing the frame, then leaving.  Ctrl-C or Q: leave without it"
                      : "Finishing the frame.  Ctrl-C: now");
        return STYLE_WARN;
    }
    snprintf(text, MESSAGE_BYTES, "%s", app->shot->message);
    return STYLE_WARN;
}

/* Breaks text at spaces into lines of at most `width` columns, in place; returns their number. What is beyond the last
 * line is left on it, to be cut. */
static int wrap(char *text, int width, char *lines[MESSAGE_ROWS]) {
    int count = 0;
    lines[count++] = text;
    char *space = NULL;
    for (char *p = text; *p && count < MESSAGE_ROWS; p++) {
        if (*p != ' ') continue;
        *p = '\0';
        bool fits = draw_width(lines[count - 1]) <= width;
        *p = ' ';
        if (!fits && space) {
            *space = '\0';
            lines[count++] = space + 1;
        }
        space = p;
    }
    if (count < MESSAGE_ROWS && space && space > lines[count - 1] && draw_width(lines[count - 1]) > width) {
        *space = '\0';
        lines[count++] = space + 1;
    }
    return count;
}

int message_rows(tui_app *app, int width) {
    char text[MESSAGE_BYTES], *lines[MESSAGE_ROWS];
    compose(app, width, text);
    return wrap(text, width - 2, lines);
}

void widget_message(tui_app *app, tui_area area) {
    char text[MESSAGE_BYTES], *lines[MESSAGE_ROWS];
    tui_style style = compose(app, area.width, text);
    int count = wrap(text, area.width - 2, lines);
    for (int i = 0; i < count; i++) draw_text(&app->theme, area, i, 1, style, lines[i]);
}
