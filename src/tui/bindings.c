/* The user's own keys, theme and colours, from config.lua. */
#include "tui/actions.h"
#include "tui/shell.h"

#include "base/names.h"
#include "script/user_config.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const struct {
    const char *name;
    int key;
} named_keys[] = {{"space", ' '},        {"enter", '\r'},         {"tab", '\t'},          {"shift-tab", KEY_BTAB}, {"esc", 27},
                  {"up", KEY_UP},        {"down", KEY_DOWN},      {"left", KEY_LEFT},     {"right", KEY_RIGHT},    {"home", KEY_HOME},
                  {"end", KEY_END},      {"pgup", KEY_PPAGE},     {"pgdn", KEY_NPAGE},    {"insert", KEY_IC},      {"delete", KEY_DC},
                  {"backspace", KEY_BACKSPACE}, {"shift-left", KEY_SLEFT}, {"shift-right", KEY_SRIGHT}};
enum { NAMED_KEYS = sizeof named_keys / sizeof *named_keys };

/* The code of a key's name; 0: not one. */
static int binding_key(const char *name) {
    if (name[0] && !name[1]) return (unsigned char)name[0];
    for (int i = 0; i < NAMED_KEYS; i++)
        if (strcasecmp(named_keys[i].name, name) == 0) return named_keys[i].key;
    if (strncasecmp(name, "ctrl-", 5) == 0 && name[5] && !name[6] && ((name[5] | 32) >= 'a' && (name[5] | 32) <= 'z'))
        return (name[5] | 32) - 'a' + 1;
    char *end;
    long number = name[0] == 'f' || name[0] == 'F' ? strtol(name + 1, &end, 10) : 0;
    return number >= 1 && number <= 63 && !*end ? KEY_F((int)number) : 0;
}

/* The first mistake is the one that is told. */
static void complain(report *r, const user_config *c, int line, const char *key, const char *expected, const char *found, const char *nearest) {
    if (r->code == STATUS_OK) (void)report_input(r, c->file, line, key, expected, found, nearest);
}

static void bind_key(tui_app *app, const user_config *c, const user_binding *b, report *r) {
    tui_shell *shell = app->shell;
    tui_binding *to = &shell->bindings[shell->binding_count];
    char name[SHELL_NAME];
    action_place place;
    int key = binding_key(b->key);
    size_t length = strcspn(b->action, " ");
    if (key == 0) {
        complain(r, c, b->line, b->key, "a key: \"x\", \"ctrl-x\", \"f5\", \"space\", \"shift-left\" …", b->key, NULL);
        return;
    }
    snprintf(name, sizeof name, "%.*s", (int)(length < sizeof name ? length : sizeof name - 1), b->action);
    if (name[0] && !actions_find(app, name, &place)) {
        char nearest[SHELL_NAME];
        complain(r, c, b->line, b->key, "an action (sunder help actions lists them)", name, actions_nearest(name, nearest));
        return;
    }
    to->key = key;
    snprintf(to->shown, sizeof to->shown, "%s", b->key);
    snprintf(to->name, sizeof to->name, "%s", name);
    snprintf(to->argument, sizeof to->argument, "%s", b->action + length + (b->action[length] == ' '));
    shell->binding_count++;
}

static void choose_theme(tui_app *app, const user_config *c, report *r) {
    const char *names[TUI_THEMES];
    for (int i = 0; i < TUI_THEMES; i++) {
        names[i] = theme_name((tui_theme_kind)i);
        if (app->options.theme == TUI_THEME_AUTO && strcmp(names[i], c->theme) == 0) {
            app->options.theme = (tui_theme_kind)i;
            return;
        }
    }
    if (app->options.theme == TUI_THEME_AUTO)
        complain(r, c, c->theme_line, "theme", "dark, light or colour-blind", c->theme, name_nearest(c->theme, names, TUI_THEMES));
}

static void choose_map(tui_app *app, const user_config *c, report *r) {
    const char *names[VIEW_PALETTES];
    for (int i = 0; i < VIEW_PALETTES; i++) names[i] = view_palette_name((view_palette)i);
    for (int i = 0; i < VIEW_PALETTES; i++)
        if (strcmp(names[i], c->map) == 0) {
            app->options.palette = i;
            return;
        }
    complain(r, c, c->map_line, "map", "a colour map's name", c->map, name_nearest(c->map, names, VIEW_PALETTES));
}

static void choose_mode(tui_app *app, const user_config *c, report *r) {
    const char *names[VIEW_MODES];
    for (int i = 0; i < VIEW_MODES; i++) names[i] = view_mode_name((view_mode)i);
    for (int i = 0; i < VIEW_MODES; i++)
        if (strcmp(names[i], c->mode) == 0) {
            app->options.mode = i;
            return;
        }
    complain(r, c, c->mode_line, "mode", "braille, blocks or ascii", c->mode, name_nearest(c->mode, names, VIEW_MODES));
}

/* The first report of the file itself counts before what is wrong with its words. */
void config_read(tui_app *app, user_config *c, report *r) {
    static script_reports reports; /* large */
    char path[512];
    report_clear(r);
    if (app->headless || !user_config_path(path)) {
        *c = (user_config){.colours = -1, .ascii = -1, .mouse = -1};
        return;
    }
    if (user_config_load(path, c, &reports) != STATUS_OK) *r = reports.items[0];
    if (c->theme[0]) choose_theme(app, c, r);
    if (c->map[0]) choose_map(app, c, r);
    if (c->mode[0]) choose_mode(app, c, r);
    if (c->colours >= 0 && app->options.colours == TUI_AUTO) app->options.colours = c->colours;
    if (c->ascii == 1) app->options.ascii = true;
    app->mouse = c->mouse == 1;
}

void config_apply(tui_app *app, const user_config *c, report *r) {
    for (int i = 0; i < c->binding_count && app->shell->binding_count < SHELL_BINDINGS; i++) bind_key(app, c, &c->bindings[i], r);
    for (int i = 0; i < c->style_count; i++) {
        const char *nearest;
        if (!theme_override(&app->theme, c->styles[i].name, c->styles[i].colour, &nearest))
            complain(r, c, c->styles[i].line, c->styles[i].name, "a style's name (text, dim, good, bar …)", "none of that name", nearest);
    }
    if (r->code != STATUS_OK) app_fail(app, r);
}

const tui_binding *binding_find(const tui_app *app, int key) {
    for (int i = 0; i < app->shell->binding_count; i++)
        if (app->shell->bindings[i].key == key) return &app->shell->bindings[i];
    return NULL;
}
