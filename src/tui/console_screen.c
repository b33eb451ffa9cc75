/* The Console screen: Lua on the live run and the ledger. */
#include "tui/console.h"

#include "base/memory.h"
#include "tui/shell.h"
#include "tui/typing.h"

#include <stdio.h>
#include <string.h>

static console_state *state_of(tui_app *app) {
    report unused;
    return screen_state(app, &screen_console, &unused);
}

/* ---- lines ------------------------------------------------------------------------------------------------------- */

static void add_line(console_state *c, tui_style style, const char *text, size_t size) {
    if (c->line_count == CONSOLE_LINES) {
        memmove(c->lines, c->lines + 1, (CONSOLE_LINES - 1) * sizeof *c->lines);
        c->line_count--;
    }
    console_line *line = &c->lines[c->line_count++];
    line->style = style;
    snprintf(line->text, sizeof line->text, "%.*s", (int)size, text);
}

static void say(console_state *c, tui_style style, const char *text) {
    while (*text) {
        size_t length = strcspn(text, "\n"), most = CONSOLE_WIDTH - 1;
        add_line(c, style, text, length < most ? length : most);
        text += length < most ? length + (text[length] == '\n') : most;
    }
    c->scroll = 0;
}

static void remember(console_state *c, const char *text) {
    if (c->history_count > 0 && strcmp(c->history[c->history_count - 1], text) == 0) return;
    if (c->history_count == CONSOLE_HISTORY) {
        memmove(c->history[0], c->history[1], sizeof c->history - sizeof c->history[0]);
        c->history_count--;
    }
    snprintf(c->history[c->history_count++], sizeof c->history[0], "%s", text);
}

/* ---- actions ----------------------------------------------------------------------------------------------------- */

static status run(tui_app *app, const char *argument, report *r) {
    console_state *c = state_of(app);
    char echo[ACTION_ARGUMENT + 4];
    if (!c->worker) return report_set(r, STATUS_INPUT, "The console needs a terminal.");
    if (console_busy(c->worker)) return report_set(r, STATUS_INPUT, "The line before is still running; Esc stops it.");
    snprintf(echo, sizeof echo, "> %s", argument);
    say(c, STYLE_HEAD, echo);
    remember(c, argument);
    c->history_at = c->history_count;
    console_ask(c->worker, argument);
    return STATUS_OK;
}

static status interrupt(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    console_state *c = state_of(app);
    if (c->worker && console_busy(c->worker)) console_stop(c->worker);
    else c->text[c->cursor = 0] = '\0';
    return STATUS_OK;
}

static status clear_lines(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    state_of(app)->line_count = 0;
    return STATUS_OK;
}

static status scroll_lines(tui_app *app, const char *argument, report *r) {
    (void)r;
    console_state *c = state_of(app);
    c->scroll += strcmp(argument, "up") == 0 ? 10 : -10;
    if (c->scroll > c->line_count) c->scroll = c->line_count;
    if (c->scroll < 0) c->scroll = 0;
    return STATUS_OK;
}

static status recall(tui_app *app, const char *argument, report *r) {
    (void)r;
    console_state *c = state_of(app);
    int at = c->history_at + (strcmp(argument, "next") == 0 ? 1 : -1);
    if (at < 0 || at > c->history_count) return STATUS_OK;
    c->history_at = at;
    snprintf(c->text, sizeof c->text, "%s", at == c->history_count ? "" : c->history[at]);
    c->cursor = strlen(c->text);
    return STATUS_OK;
}

static status complete(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    console_complete(app, state_of(app));
    return STATUS_OK;
}

static const tui_action actions[] = {
    {.name = "run", .keys_shown = "Enter", .hint = "run", .help = "run a line of Lua; help() says what there is", .handler = run,
     .argument = ARGUMENT_TEXT, .asks = "LUA", .unlogged = true},
    {.name = "complete", .keys = {'\t'}, .keys_shown = "Tab", .hint = "complete", .help = "complete a function or a knob", .handler = complete,
     .unlogged = true},
    {.name = "interrupt", .keys = {27}, .keys_shown = "Esc", .hint = "stop", .help = "stop what runs, or clear the line", .handler = interrupt,
     .unlogged = true},
    {.name = "previous", .keys = {KEY_UP}, .keys_shown = "up", .help = "the line before, from the history", .handler = recall,
     .argument = ARGUMENT_MAY, .asks = "next", .unlogged = true},
    {.name = "next", .keys = {KEY_DOWN}, .keys_shown = "down", .help = "the line after", .handler = recall, .argument = ARGUMENT_MAY, .preset = "next",
     .unlogged = true},
    {.name = "scroll-up", .keys = {KEY_PPAGE}, .keys_shown = "PgUp", .help = "older lines", .handler = scroll_lines, .argument = ARGUMENT_MAY, .preset = "up",
     .unlogged = true},
    {.name = "scroll-down", .keys = {KEY_NPAGE}, .keys_shown = "PgDn", .help = "newer lines", .handler = scroll_lines, .argument = ARGUMENT_MAY,
     .preset = "down", .unlogged = true},
    {.name = "clear", .keys = {'K' - '@'}, .keys_shown = "Ctrl-K", .help = "forget the lines shown", .handler = clear_lines, .unlogged = true},
};

/* ---- typing ------------------------------------------------------------------------------------------------------ */

void console_insert(console_state *c, const char *text) {
    typing_insert(c->text, sizeof c->text, &c->cursor, text);
}

static void enter(tui_app *app, console_state *c) {
    char line[ACTION_ARGUMENT];
    report unused;
    snprintf(line, sizeof line, "%s", c->text);
    if (line[strspn(line, " ")] == '\0') return;
    if (app_do(app, "console.run", line, &unused) == STATUS_OK) c->text[c->cursor = 0] = '\0';
}

/* ':' and '?' begin no line of Lua: on an empty line they are what they are on every screen. */
static bool type(tui_app *app, void *state, int key) {
    console_state *c = state;
    if (!c->text[0] && (key == ':' || key == '?')) return false;
    switch (key) {
    case '\r':
    case '\n':
    case KEY_ENTER: enter(app, c); return true;
    case KEY_LEFT: typing_step(c->text, &c->cursor, -1); return true;
    case KEY_RIGHT: typing_step(c->text, &c->cursor, 1); return true;
    case KEY_HOME:
    case 'A' - '@': c->cursor = 0; return true;
    case KEY_END:
    case 'E' - '@': c->cursor = strlen(c->text); return true;
    case 'U' - '@': c->text[c->cursor = 0] = '\0'; return true;
    case KEY_BACKSPACE:
    case 127:
    case 8: typing_erase_before(c->text, &c->cursor); return true;
    case KEY_DC:
        if (c->text[c->cursor]) {
            typing_step(c->text, &c->cursor, 1);
            typing_erase_before(c->text, &c->cursor);
        }
        return true;
    default: break;
    }
    if (key < ' ' || key > 255) return false;
    console_insert(c, (char[2]){(char)key, '\0'});
    return true;
}

/* ---- the screen -------------------------------------------------------------------------------------------------- */

static status open_console(tui_app *app, void **state, report *r) {
    console_state *c = *state = memory_allocate(sizeof *c);
    if (!c) return report_set(r, STATUS_SYSTEM, "out of memory for the console");
    say(c, STYLE_DIM, "Lua on the live run and the ledger, with what scenes have. help() says what there is; Tab completes.");
    if (app->headless) return STATUS_OK;
    status failed = console_work_open(app, &c->worker, r);
    if (failed != STATUS_OK) memory_free(c, sizeof *c);
    return failed;
}

static void close_console(tui_app *app, void *state) {
    (void)app;
    console_state *c = state;
    if (c->worker) console_work_close(c->worker);
    memory_free(c, sizeof *c);
}

static void tick(tui_app *app, void *state, double now) {
    console_state *c = state;
    (void)now;
    if (!c->worker) return;
    status outcome;
    if (console_serve(app, c->worker)) app->dirty = true;
    if (!console_take(c->worker, c->answer, sizeof c->answer, &outcome, c->trouble, sizeof c->trouble)) return;
    say(c, STYLE_TEXT, c->answer);
    if (outcome != STATUS_OK) say(c, STYLE_BAD, c->trouble);
    app->dirty = true;
}

/* Folds a line at spaces where that wastes little: where each part begins. */
static int fold(const char *text, int width, int starts[CONSOLE_PARTS]) {
    int count = 1, length = (int)strlen(text), at = 0;
    starts[0] = 0;
    while (width > 0 && length - at > width && count < CONSOLE_PARTS) {
        int cut = width;
        while (cut > width / 2 && text[at + cut] != ' ') cut--;
        if (text[at + cut] != ' ') cut = width;
        at += cut + (text[at + cut] == ' ');
        starts[count++] = at;
    }
    return count;
}

static void draw(tui_app *app, void *state, tui_area area) {
    console_state *c = state;
    draw_heading(&app->theme, area, 0, "console", c->worker && console_busy(c->worker) ? "running; Esc stops" : NULL);
    /* Long lines are folded: rows are counted from the newest up. */
    int bottom = area.height - 2, width = area.width - 2, skip = c->scroll;
    for (int i = c->line_count - 1; i >= 0 && bottom >= 1; i--) {
        const console_line *line = &c->lines[i];
        int starts[CONSOLE_PARTS], rows = fold(line->text, width, starts);
        for (int part = rows - 1; part >= 0 && bottom >= 1; part--) {
            char text[CONSOLE_WIDTH];
            if (skip-- > 0) continue;
            int size = part + 1 < rows ? starts[part + 1] - starts[part] : width;
            snprintf(text, sizeof text, "%.*s", size < width ? size : width, line->text + starts[part]);
            draw_text(&app->theme, area, bottom--, 1, line->style, text);
        }
    }
    typing_draw(&app->theme, area, area.height - 1, "> ", c->text, c->cursor);
}

const tui_screen screen_console = {
    .name = "console",
    .title = "Console",
    .help = "Lua on the live run and the ledger",
    .actions = actions,
    .action_count = sizeof actions / sizeof *actions,
    .open = open_console,
    .close = close_console,
    .tick = tick,
    .draw = draw,
    .key = type,
};
