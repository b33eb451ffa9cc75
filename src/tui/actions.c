#include "tui/actions.h"

#include "base/clock.h"
#include "base/names.h"
#include "script/library.h"
#include "tui/shell.h"
#include "tui/start_words.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- leaving ----------------------------------------------------------------------------------------------------- */

static void stop_run(tui_app *app) {
    app->leave_at_end = app->shell->quitting = true;
    app_end_run(app);
}

static void abandon_run(tui_app *app) {
    app->leave_at_end = app->stopping = app->abandoned = true;
    session_abandon(app->run);
}

static status quit(tui_app *app, const char *argument, report *r) {
    if (argument[0] && strcmp(argument, "stop") != 0)
        return report_input(r, NULL, 0, "quit", "nothing, or \"stop\"", argument, "stop");
    if (app->ended && !app_starting(app)) {
        app->leaving = true;
    } else if (strcmp(argument, "stop") == 0) {
        log_defer(app);
        stop_run(app);
    } else if (!app->stopping || !app->leave_at_end) {
        app_ask(app, "quit", "stop", 'q', "Stop the run after this frame?");
    }
    return STATUS_OK;
}

static status leave(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    if (!app->ended) {
        log_defer(app);
        abandon_run(app);
    }
    app->leaving = true;
    return STATUS_OK;
}

void actions_interrupt(tui_app *app) {
    app->shell->asking = false;
    app->dirty = true;
    report unused;
    if (app->ended) {
        app->leaving = true;
    } else if (app->stopping && app->leave_at_end) {
        abandon_run(app);
    } else {
        (void)app_do(app, "quit", "stop", &unused);
    }
}

void actions_terminate(tui_app *app) {
    app->dirty = true;
    report unused;
    if (app->ended) {
        app->leaving = true;
    } else if (!app->leave_at_end || !app->stopping) {
        (void)app_do(app, "quit", "stop", &unused);
    }
}

/* ---- what is seen ------------------------------------------------------------------------------------------------ */

static void open_page(tui_app *app, tui_page page) {
    app->page = app->page == page ? PAGE_NONE : page;
    app->scroll = 0;
    app->at_end = true;
    app->notice[0] = '\0';
}

static status show_help(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    open_page(app, PAGE_HELP);
    return STATUS_OK;
}

static status show_log(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    open_page(app, PAGE_LOG);
    return STATUS_OK;
}

static status show_commands(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    open_page(app, PAGE_COMMANDS);
    return STATUS_OK;
}

bool complete_word(const char *word, const char *text, int *index, char out[ACTION_ARGUMENT]) {
    if (strncmp(word, text, strlen(text)) != 0 || (*index)-- > 0) return false;
    snprintf(out, ACTION_ARGUMENT, "%.1000s", word);
    return true;
}

int cursor_within(int at, int count) {
    return at < 0 || count == 0 ? 0 : at < count ? at : count - 1;
}

static bool complete_theme(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    (void)app;
    for (int i = 0; i < TUI_THEMES; i++)
        if (complete_word(theme_name((tui_theme_kind)i), text, &index, out)) return true;
    return false;
}

static status change_theme(tui_app *app, const char *argument, report *r) {
    tui_theme_kind kind = (tui_theme_kind)((app->theme.kind + 1) % TUI_THEMES);
    if (argument[0]) {
        const char *names[TUI_THEMES];
        for (int i = 0; i < TUI_THEMES; i++) names[i] = theme_name((tui_theme_kind)i);
        for (kind = 0; kind < TUI_THEMES && strcmp(names[kind], argument) != 0;) kind++;
        if (kind == TUI_THEMES)
            return report_input(r, NULL, 0, "theme", "dark, light or colour-blind", argument,
                                name_nearest(argument, names, TUI_THEMES));
    }
    theme_choose(&app->theme, kind);
    app->redraw = true;
    app_notice(app, "Theme: %s.", theme_name(app->theme.kind));
    return STATUS_OK;
}

static status use_mouse(tui_app *app, const char *argument, report *r) {
    (void)r;
    app->mouse = argument[0] ? strcmp(argument, "off") != 0 : !app->mouse;
    app_notice(app, app->mouse ? "The mouse is the workbench's." : "The mouse is the terminal's.");
    return STATUS_OK;
}

static status redraw(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    app->redraw = true;
    return STATUS_OK;
}

static status palette(tui_app *app, const char *argument, report *r) {
    (void)r;
    prompt_open(app, argument);
    return STATUS_OK;
}

/* ---- screens ----------------------------------------------------------------------------------------------------- */

static bool complete_screen(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    (void)app;
    int count;
    const tui_screen *const *list = tui_screens(&count);
    for (int i = 0; i < count; i++)
        if (complete_word(list[i]->name, text, &index, out)) return true;
    return false;
}

static status show_screen(tui_app *app, const char *argument, report *r) {
    const tui_screen *screen = tui_screen_find(argument);
    if (!screen) {
        int count;
        const tui_screen *const *list = tui_screens(&count);
        const char *names[TUI_SCREEN_LIMIT];
        for (int i = 0; i < count; i++) names[i] = list[i]->name;
        return report_input(r, NULL, 0, "screen", "a screen's name", argument, name_nearest(argument, names, count));
    }
    app_show(app, screen);
    return STATUS_OK;
}

static status next_screen(tui_app *app, const char *argument, report *r) {
    (void)r;
    int count, at = 0, step = strcmp(argument, "back") == 0 ? -1 : 1;
    const tui_screen *const *list = tui_screens(&count);
    while (list[at] != app->screen) at++;
    app_show(app, list[(at + step + count) % count]);
    return STATUS_OK;
}

/* ---- runs -------------------------------------------------------------------------------------------------------- */

static status start_run(tui_app *app, const char *argument, report *r) {
    static start_words words; /* large; used within this call only */
    char text[START_TEXT], name[LIBRARY_PATH];
    status s = start_parse(argument, &words, r);
    if (s != STATUS_OK) return s;
    s = app_start_run(app, &words.options, r);
    library_name_scene(words.options.scene_path, name);
    words.options.scene_path = name;
    if (start_print(&words.options, text)) app_log_argument(app, "%s", text);
    if (s == STATUS_OK) app_show(app, &screen_run);
    return s;
}

static bool complete_start(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    (void)app;
    enum { MOST = 256 };
    static library_scene list[MOST]; /* kept for a moment: all candidates are asked for at every key */
    static double looked;
    static int count;
    if (looked == 0 || clock_seconds() - looked > 2) count = library_scenes(list, MOST);
    looked = clock_seconds();
    for (int i = 0; i < count; i++) {
        bool begins = strncmp(list[i].name, text, strlen(text)) == 0 || strncmp(list[i].path, text, strlen(text)) == 0;
        if (!begins || index-- > 0) continue;
        snprintf(out, ACTION_ARGUMENT, "%s", list[i].path);
        return true;
    }
    return false;
}

/* ---- the command log --------------------------------------------------------------------------------------------- */

static status save_commands(tui_app *app, const char *argument, report *r) {
    status s = log_save(app, argument, r);
    if (s == STATUS_OK) app_notice(app, "The commands so far are in %s; sunder --replay does them again.", argument);
    return s;
}

/* ---- the table --------------------------------------------------------------------------------------------------- */

static const tui_action table[] = {
    {.name = "help", .keys = {'?', KEY_F(1)}, .keys_shown = "?  F1", .hint = "help", .help = "this page", .handler = show_help,
     .unlogged = true},
    {.name = "palette", .keys = {':'}, .keys_shown = ":", .hint = "do", .help = "type an action; Tab completes", .handler = palette,
     .argument = ARGUMENT_MAY, .asks = "ACTION", .unlogged = true},
    {.name = "screen", .keys_shown = "F2 …", .help = "go to a screen", .handler = show_screen,
     .argument = ARGUMENT_TEXT, .asks = "SCREEN", .complete = complete_screen, .unlogged = true},
    {.name = "next-screen", .keys = {'\t', KEY_BTAB}, .keys_shown = "Tab", .help = "the next screen", .handler = next_screen,
     .argument = ARGUMENT_MAY, .asks = "back", .unlogged = true},
    {.name = "start", .keys_shown = ":", .help = "start a run, in the words of sunder run", .handler = start_run, .argument = ARGUMENT_TEXT,
     .asks = "SCENE [--set KEY=VALUE] [--recipe NAME]", .complete = complete_start},
    {.name = "quit", .keys = {'q'}, .keys_shown = "q", .hint = "quit", .help = "stop after this frame (asks first), or leave", .handler = quit,
     .argument = ARGUMENT_MAY, .asks = "stop"},
    {.name = "leave", .keys = {'Q'}, .keys_shown = "Q", .help = "leave at once; whole frames are kept", .handler = leave},
    {.name = "theme", .keys = {'t'}, .keys_shown = "t", .help = "dark, light or colour-blind", .handler = change_theme,
     .argument = ARGUMENT_MAY, .asks = "THEME", .complete = complete_theme},
    {.name = "mouse", .keys = {'M'}, .keys_shown = "M", .help = "the mouse for the workbench, or for the terminal", .handler = use_mouse,
     .argument = ARGUMENT_MAY, .asks = "on|off", .unlogged = true},
    {.name = "log", .keys = {'g'}, .keys_shown = "g", .help = "what libraries have printed", .handler = show_log,
     .unlogged = true},
    {.name = "commands", .keys = {'G'}, .keys_shown = "G", .help = "what has been done: the command log", .handler = show_commands,
     .unlogged = true},
    {.name = "save-commands", .keys_shown = ":", .help = "write the command log to a file, for sunder --replay", .handler = save_commands,
     .argument = ARGUMENT_TEXT, .asks = "FILE", .unlogged = true},
    {.name = "redraw", .keys = {'L' - '@'}, .keys_shown = "Ctrl-L", .help = "draw the screen anew", .handler = redraw,
     .unlogged = true},
};

const tui_action *tui_actions(int *count) {
    *count = (int)(sizeof table / sizeof *table);
    return table;
}

/* ---- finding ----------------------------------------------------------------------------------------------------- */

bool actions_at(int index, action_place *out) {
    int globals = (int)(sizeof table / sizeof *table), count;
    if (index < globals) {
        *out = (action_place){NULL, &table[index]};
        return true;
    }
    index -= globals;
    const tui_screen *const *list = tui_screens(&count);
    for (int i = 0; i < count; i++) {
        if (index < list[i]->action_count) {
            *out = (action_place){list[i], &list[i]->actions[index]};
            return true;
        }
        index -= list[i]->action_count;
    }
    return false;
}

void action_name(const action_place *place, char *out, size_t size) {
    if (place->screen) snprintf(out, size, "%s.%s", place->screen->name, place->action->name);
    else snprintf(out, size, "%s", place->action->name);
}

bool actions_find(const tui_app *app, const char *name, action_place *out) {
    for (int i = 0; actions_at(i, out); i++) {
        char full[SHELL_NAME];
        action_name(out, full, sizeof full);
        if (strcmp(full, name) == 0 || (out->screen && out->screen == app->screen && strcmp(out->action->name, name) == 0))
            return true;
    }
    return false;
}

const char *actions_nearest(const char *name, char out[SHELL_NAME]) {
    enum { MOST = 256 };
    char names[MOST][SHELL_NAME];
    const char *list[MOST];
    action_place place;
    int count = 0;
    for (; count < MOST && actions_at(count, &place); count++) {
        action_name(&place, names[count], SHELL_NAME);
        list[count] = names[count];
    }
    const char *nearest = name_nearest(name, list, count);
    if (!nearest) return NULL;
    snprintf(out, SHELL_NAME, "%s", nearest);
    return out;
}

/* ---- doing ------------------------------------------------------------------------------------------------------- */

void app_log_argument(tui_app *app, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(app->shell->log_argument, sizeof app->shell->log_argument, format, arguments);
    va_end(arguments);
    app->shell->log_argument_given = true;
}

void app_log_frame(tui_app *app, int64_t frame) {
    app->shell->log_frame = frame;
    app->shell->log_frame_given = true;
}

void app_log_nothing(tui_app *app) {
    app->shell->log_nothing = true;
}

static status check_argument(const action_place *place, const char *argument, report *r) {
    const tui_action *a = place->action;
    char name[SHELL_NAME], *end;
    action_name(place, name, sizeof name);
    if (a->argument == ARGUMENT_NONE && argument[0]) return report_input(r, NULL, 0, name, "no argument", argument, NULL);
    if (a->argument >= ARGUMENT_TEXT && !argument[0])
        return report_input(r, NULL, 0, name, a->asks ? a->asks : "an argument", "nothing", NULL);
    if (a->argument == ARGUMENT_NUMBER && (strtod(argument, &end), end == argument || *end))
        return report_input(r, NULL, 0, name, "a number", argument, NULL);
    return STATUS_OK;
}

/* A run of this session is "@2" in the log, by their order: a replay's runs have other ids. */
static const char *say_run(const tui_app *app, const char *id, char out[16]) {
    for (int i = 0; i < app->shell->run_count; i++) {
        if (strcmp(app->shell->runs[i], id) != 0) continue;
        snprintf(out, 16, "@%d", i + 1);
        return out;
    }
    return id;
}

static const char *find_run(const tui_app *app, const char *name) {
    int number = name[0] == '@' ? atoi(name + 1) : 0;
    return number >= 1 && number <= app->shell->run_count ? app->shell->runs[number - 1] : name;
}

static bool takes_run(const tui_action *action) {
    return action->asks && strcmp(action->asks, "RUN") == 0;
}

/* Where the cursor is before an action that depends on it. */
static void look_at_cursor(tui_app *app, const action_place *place, const char *argument) {
    char *cursor = app->shell->cursor, action[ACTION_ARGUMENT];
    report unused;
    cursor[0] = '\0';
    if (!place->action->here || (takes_run(place->action) && argument[0])) return;
    if (!place->screen->cursor || !place->screen->cursor(app, screen_state(app, place->screen, &unused), action, sizeof action)) return;
    snprintf(cursor, sizeof app->shell->cursor, "%s.%s", place->screen->name, action);
}

static void note_cursor(tui_app *app) {
    char *cursor = app->shell->cursor, *space = strchr(cursor, ' '), said[16];
    if (!cursor[0] || !space) return;
    *space = '\0';
    log_line(app, log_frame_now(app), cursor, say_run(app, space + 1, said));
}

static void note(tui_app *app, const action_place *place, const char *argument) {
    tui_shell *shell = app->shell;
    if (place->action->unlogged || shell->log_nothing) return;
    char name[SHELL_NAME];
    action_name(place, name, sizeof name);
    note_cursor(app);
    char said[16];
    const char *text = shell->log_argument_given ? shell->log_argument : argument;
    if (takes_run(place->action)) text = say_run(app, text, said);
    if (shell->log_deferred) {
        log_pend(app, name, text);
    } else {
        log_line(app, shell->log_frame_given ? shell->log_frame : log_frame_now(app), name, text);
    }
}

static status do_place(tui_app *app, const action_place *place, const char *argument, report *r) {
    tui_shell *shell = app->shell;
    report_clear(r);
    if (!argument[0] && place->action->preset) argument = place->action->preset;
    status s = check_argument(place, argument, r);
    int deeper = !place->action->unlogged; /* what an action that is not logged does itself is logged as its own */
    bool outermost = shell->depth == 0;
    shell->depth += deeper;
    if (outermost) shell->log_nothing = shell->log_argument_given = shell->log_frame_given = shell->log_deferred = false;
    if (s == STATUS_OK && place->screen) {
        (void)screen_state(app, place->screen, r);
        s = r->code;
    }
    if (takes_run(place->action)) argument = find_run(app, argument);
    if (s == STATUS_OK && outermost) look_at_cursor(app, place, argument);
    if (s == STATUS_OK) s = place->action->handler(app, argument, r);
    if (s == STATUS_OK && outermost) note(app, place, argument);
    shell->depth -= deeper;
    if (s != STATUS_OK) app_fail(app, r);
    app->dirty = true;
    return s;
}

status app_do(tui_app *app, const char *name, const char *argument, report *r) {
    action_place place;
    if (actions_find(app, name, &place)) return do_place(app, &place, argument, r);
    char near[SHELL_NAME];
    status s = report_input(r, NULL, 0, name, "an action (? lists them)", "none of that name", actions_nearest(name, near));
    app_fail(app, r);
    return s;
}

/* ---- keys -------------------------------------------------------------------------------------------------------- */

static void answer(tui_app *app, int key) {
    tui_shell *shell = app->shell;
    report unused;
    shell->asking = false;
    app->dirty = true;
    if (key == 'y' || key == 'Y' || (shell->yes_key && key == shell->yes_key))
        (void)app_do(app, shell->yes_action, shell->yes_argument, &unused);
}

static void scroll_by(tui_app *app, int lines) {
    app->scroll += lines; /* drawing keeps it within the page */
    app->at_end = false;
}

static bool scroll_page(tui_app *app, int key) {
    switch (key) {
    case KEY_UP:
    case 'k': scroll_by(app, -1); return true;
    case KEY_DOWN:
    case 'j': scroll_by(app, 1); return true;
    case KEY_PPAGE: scroll_by(app, -10); return true;
    case KEY_NPAGE: scroll_by(app, 10); return true;
    case 27:
    case 'q': app->page = PAGE_NONE; return true;
    default: return false;
    }
}

static bool action_has_key(const tui_action *action, int key) {
    for (int k = 0; k < ACTION_KEYS; k++)
        if (action->keys[k] != 0 && action->keys[k] == key) return true;
    return false;
}

/* The screen's own keys first: a screen may use a global action's key for what matters more there. */
static bool find_key(const tui_app *app, int key, action_place *out) {
    for (int i = 0; i < app->screen->action_count && !app->small; i++) {
        *out = (action_place){app->screen, &app->screen->actions[i]};
        if (action_has_key(out->action, key)) return true;
    }
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        *out = (action_place){NULL, &table[i]};
        if (action_has_key(out->action, key)) return true;
    }
    return false;
}

static bool screen_key(tui_app *app, int key) {
    int count, index = key - KEY_F(2);
    const tui_screen *const *list = tui_screens(&count);
    if (index < 0 || index >= count) return false;
    app_show(app, list[index]);
    return true;
}

/* A key of the user's own. */
static void press_bound(tui_app *app, const tui_binding *own) {
    action_place place;
    report unused;
    if (!own->name[0] || !actions_find(app, own->name, &place)) return;
    if (place.action->argument >= ARGUMENT_TEXT && !place.action->preset && !own->argument[0]) app_prompt(app, own->name, "");
    else (void)app_do(app, own->name, own->argument, &unused);
}

void actions_press(tui_app *app, int key) {
    app->dirty = true;
    report r;
    if (app->shell->asking) {
        /* Any other key is a no, except that leaving at once is a stronger yes. */
        answer(app, key);
        if (key != 'Q') return;
    }
    if (app->shell->prompt.open && !app->small) {
        prompt_key(app, key);
        return;
    }
    if (app->page != PAGE_NONE && !app->small && scroll_page(app, key)) return;
    if (app->page == PAGE_NONE && !app->small && app->screen->key && app->screen->key(app, screen_state(app, app->screen, &r), key)) return;
    const tui_binding *own = binding_find(app, key);
    if (own) {
        press_bound(app, own);
        return;
    }
    action_place place;
    if (screen_key(app, key) || !find_key(app, key, &place)) return;
    if (place.action->argument >= ARGUMENT_TEXT && !place.action->preset) {
        char name[SHELL_NAME];
        action_name(&place, name, sizeof name);
        app_prompt(app, name, "");
        return;
    }
    (void)do_place(app, &place, place.action->handler == next_screen && key == KEY_BTAB ? "back" : "", &r);
}
