#include "tui/widgets.h"

#include "tui/actions.h"
#include "tui/capture.h"
#include "tui/shell.h"

#include <stdio.h>
#include <string.h>

/* Keeps the first shown line within 0 … total − rows. */
static void clamp_scroll(tui_app *app, int total, int rows) {
    int last = total > rows ? total - rows : 0;
    if (app->scroll > last) app->scroll = last;
    if (app->scroll < 0) app->scroll = 0;
}

/* A line of the help page: of an action, or a heading. */
static int help_lines(const tui_app *app, int line, tui_area area, int row) {
    int count;
    const tui_action *global = tui_actions(&count), *a = NULL;
    const tui_screen *s = app->screen;
    if (line >= 0 && line < s->action_count) a = &s->actions[line];
    int beyond = line - s->action_count - 1;
    if (beyond >= 0 && beyond < count) a = &global[beyond];
    if (a && row >= 0) {
        char name[64];
        draw_text(&app->theme, area, row, 1, STYLE_STRONG, a->keys_shown);
        draw_text(&app->theme, area, row, 11, STYLE_TEXT, a->help);
        if (beyond >= 0) snprintf(name, sizeof name, "%s", a->name);
        else snprintf(name, sizeof name, "%s.%s", s->name, a->name);
        if (area.width >= 70) draw_right(&app->theme, area, row, area.width - 1, STYLE_DIM, name);
    } else if (row >= 0 && beyond < count) {
        draw_heading(&app->theme, area, row, "on every screen", NULL);
    } else if (row >= 0 && beyond == count) {
        draw_heading(&app->theme, area, row, "your own, from config.lua", NULL);
    } else if (row >= 0) {
        const tui_binding *own = &app->shell->bindings[beyond - count - 1];
        draw_text(&app->theme, area, row, 1, STYLE_STRONG, own->shown);
        draw_format(&app->theme, area, row, 11, STYLE_TEXT, "%s %s", own->name[0] ? own->name : "nothing", own->argument);
    }
    int own = app->shell->binding_count;
    return s->action_count + 1 + count + (own > 0 ? own + 1 : 0);
}

static void draw_help(tui_app *app, tui_area area) {
    int total = help_lines(app, -1, area, -1), rows = area.height - 1;
    char heading[64];
    snprintf(heading, sizeof heading, "keys · %s", app->screen->title);
    draw_heading(&app->theme, area, 0, heading, total > rows ? "up and down scroll, q closes" : "q closes");
    clamp_scroll(app, total, rows);
    for (int i = 0; i < rows && i + app->scroll < total; i++) help_lines(app, i + app->scroll, area, i + 1);
}

static int count_lines(const char *text) {
    int lines = 0;
    for (; *text; text++) {
        if (*text == '\n' || text[1] == '\0') lines++;
    }
    return lines;
}

/* Lines of text, which is cut into them; the page follows its end until it is scrolled. */
static void draw_lines(tui_app *app, tui_area area, char *text) {
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

static void draw_printed(tui_app *app, tui_area area) {
    static char text[CAPTURE_KEPT + 1];
    capture_tail(text);
    draw_heading(&app->theme, area, 0, "printed by libraries", "up and down scroll, q closes");
    if (text[0]) draw_lines(app, area, text);
    else draw_text(&app->theme, area, 1, 1, STYLE_DIM, "Nothing so far.");
}

/* The last part of the log: all of it is in the file. */
static void draw_commands(tui_app *app, tui_area area) {
    static char text[CAPTURE_KEPT + 1];
    const command_log *log = &app->shell->log;
    const char *from = log->used > CAPTURE_KEPT ? log->text + log->used - CAPTURE_KEPT : log->text;
    snprintf(text, sizeof text, "%s", from);
    draw_heading(&app->theme, area, 0, "commands", "up and down scroll, q closes");
    draw_lines(app, area, text);
}

void widget_page(tui_app *app, tui_area area) {
    switch (app->page) {
    case PAGE_HELP: draw_help(app, area); break;
    case PAGE_LOG: draw_printed(app, area); break;
    case PAGE_COMMANDS: draw_commands(app, area); break;
    case PAGE_NONE: break;
    }
}
