/* The Scenes screen: which scene, with which recipe and settings; what it contains, and what it will cost. */
#include "tui/scenes.h"

#include "base/clock.h"
#include "base/memory.h"
#include "base/names.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double settle_time = 0.15; /* s that the cursor rests before a scene is looked at */
enum { PLAN_UNASKED = 300000 /* particles of a scene that is planned without being asked for */ };

static scenes_state *state_of(tui_app *app) {
    report unused;
    return screen_state(app, &screen_scenes, &unused);
}

const library_scene *scenes_chosen(const scenes_state *s) {
    return s->shown_count > 0 ? &s->list[s->shown[s->cursor]] : NULL;
}

/* ---- what is chosen ---------------------------------------------------------------------------------------------- */

bool scenes_words(const scenes_state *s, char out[START_TEXT]) {
    const library_scene *chosen = scenes_chosen(s);
    script_setting settings[SCENES_SETTINGS];
    char text[SCENES_SETTINGS][SCENES_SETTING];
    if (!chosen) return false;
    session_options o = session_options_default();
    o.scene_path = chosen->path;
    o.script.recipe = s->recipe[0] ? s->recipe : NULL;
    o.script.settings = settings;
    o.precision = s->precision;
    for (int i = 0; i < s->setting_count; i++) {
        memcpy(text[i], s->settings[i], sizeof text[i]);
        char *equals = strchr(text[i], '=');
        *equals = '\0';
        settings[o.script.setting_count++] = (script_setting){text[i], equals + 1};
    }
    return start_print(&o, out);
}

/* What is shown is no longer what is chosen: it is looked at again in a moment. */
static void changed(tui_app *app, scenes_state *s) {
    s->asked[0] = '\0';
    s->ask_at = clock_seconds() + settle_time;
    s->asked_plan = false;
    app->dirty = true;
}

static void forget_choices(scenes_state *s) {
    s->setting_count = 0;
    s->recipe[0] = '\0';
    s->parameter = 0;
}

static bool contains(const char *text, const char *part) {
    return strcasestr(text, part) != NULL;
}

static void apply_filter(tui_app *app, scenes_state *s) {
    const char *kept = scenes_chosen(s) ? scenes_chosen(s)->path : "";
    int at = 0;
    s->shown_count = 0;
    for (int i = 0; i < s->count; i++) {
        const library_scene *chosen = &s->list[i];
        if (!contains(chosen->path, s->filter) && !contains(chosen->remark, s->filter)) continue;
        if (chosen->path == kept) at = s->shown_count;
        s->shown[s->shown_count++] = i;
    }
    s->cursor = at;
    if (scenes_chosen(s) && scenes_chosen(s)->path != kept) {
        forget_choices(s);
        changed(app, s);
    }
}

/* ---- actions ----------------------------------------------------------------------------------------------------- */

static status move_cursor(tui_app *app, const char *argument, report *r) {
    (void)r;
    scenes_state *s = state_of(app);
    int step = atoi(argument);
    if (s->on_settings) {
        s->parameter = cursor_within(s->parameter + step, scenes_rows(s));
        return STATUS_OK;
    }
    int at = cursor_within(s->cursor + step, s->shown_count);
    if (at == s->cursor) return STATUS_OK;
    s->cursor = at;
    forget_choices(s);
    changed(app, s);
    return STATUS_OK;
}

static status set_filter(tui_app *app, const char *argument, report *r) {
    (void)r;
    scenes_state *s = state_of(app);
    snprintf(s->filter, sizeof s->filter, "%s", argument);
    s->typing = false;
    s->on_settings = false;
    apply_filter(app, s);
    return STATUS_OK;
}

static status type_filter(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    scenes_state *s = state_of(app);
    s->typing = true;
    s->on_settings = false;
    return STATUS_OK;
}

static status choose(tui_app *app, const char *argument, report *r) {
    scenes_state *s = state_of(app);
    s->filter[0] = '\0';
    apply_filter(app, s);
    for (int i = 0; i < s->shown_count; i++) {
        const library_scene *chosen = &s->list[s->shown[i]];
        if (strcmp(chosen->name, argument) != 0 && strcmp(chosen->path, argument) != 0) continue;
        s->cursor = i;
        forget_choices(s);
        changed(app, s);
        return STATUS_OK;
    }
    const char *names[SCENES_LIMIT];
    for (int i = 0; i < s->count; i++) names[i] = s->list[i].name;
    return report_input(r, NULL, 0, "choose", "a scene of the list", argument, name_nearest(argument, names, s->count));
}

static bool complete_scene(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    scenes_state *s = state_of(app);
    for (int i = 0; i < s->count; i++)
        if (complete_word(s->list[i].name, text, &index, out)) return true;
    return false;
}

static status set(tui_app *app, const char *argument, report *r) {
    scenes_state *s = state_of(app);
    const char *equals = strchr(argument, '=');
    if (!equals || equals == argument || strlen(argument) >= SCENES_SETTING)
        return report_input(r, NULL, 0, "set", "KEY=VALUE", argument, NULL);
    size_t key = (size_t)(equals - argument) + 1;
    int at = 0;
    while (at < s->setting_count && strncmp(s->settings[at], argument, key) != 0) at++;
    if (at == SCENES_SETTINGS) return report_input(r, NULL, 0, "set", "at most 24 settings", argument, NULL);
    if (equals[1]) {
        snprintf(s->settings[at], SCENES_SETTING, "%s", argument);
        if (at == s->setting_count) s->setting_count++;
    } else if (at < s->setting_count) {
        memmove(s->settings[at], s->settings[at + 1], (size_t)(s->setting_count - at - 1) * SCENES_SETTING);
        s->setting_count--;
    }
    changed(app, s);
    return STATUS_OK;
}

static bool complete_setting(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    const scenes_state *s = state_of(app);
    const preview_facts *f = &s->facts;
    for (int i = 0; i < f->parameter_count; i++) {
        const preview_parameter *p = &f->parameters[i];
        size_t name = strlen(p->name);
        bool whole = strncmp(text, p->name, name) == 0 && text[name] == '=';
        if (!whole && strncmp(p->name, text, strlen(text)) == 0 && index-- == 0) {
            snprintf(out, ACTION_ARGUMENT, "%s=", p->name);
            return true;
        }
        for (int c = 0; whole && c < p->choice_count; c++) {
            if (strncmp(p->choices[c], text + name + 1, strlen(text + name + 1)) != 0 || index-- > 0) continue;
            snprintf(out, ACTION_ARGUMENT, "%s=%s", p->name, p->choices[c]);
            return true;
        }
    }
    return false;
}

static status recipe(tui_app *app, const char *argument, report *r) {
    (void)r;
    scenes_state *s = state_of(app);
    snprintf(s->recipe, sizeof s->recipe, "%s", strcmp(argument, "none") == 0 ? "" : argument);
    changed(app, s);
    return STATUS_OK;
}

static bool complete_recipe(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    scenes_state *s = state_of(app);
    const library_scene *chosen = scenes_chosen(s);
    /* All candidates are asked for, one after the other: the folders are looked into at the first. */
    if (index == 0) s->recipe_count = library_recipes(chosen ? chosen->path : ".", s->recipes, SCENES_RECIPES);
    for (int i = -1; i < s->recipe_count; i++) {
        const char *name = i < 0 ? "none" : s->recipes[i];
        if (complete_word(name, text, &index, out)) return true;
    }
    return false;
}

/* The choice after the present one of the parameter `name`; false when it has none. */
static bool next_choice(const scenes_state *s, const preview_parameter *p, int step, char out[SCENES_SETTING]) {
    int at = 0;
    (void)s;
    if (p->choice_count == 0) return false;
    while (at < p->choice_count && strcmp(p->choices[at], p->value) != 0) at++;
    snprintf(out, SCENES_SETTING, "%s=%s", p->name, p->choices[(at + step + p->choice_count) % p->choice_count]);
    return true;
}

static status variant(tui_app *app, const char *argument, report *r) {
    scenes_state *s = state_of(app);
    char text[SCENES_SETTING];
    if (!s->facts.loaded || strcmp(s->facts.words, s->asked) != 0) return report_set(r, STATUS_INPUT, "The scene is still being read.");
    for (int i = 0; i < s->facts.parameter_count; i++) {
        const preview_parameter *p = &s->facts.parameters[i];
        if (strcmp(p->name, "variant") != 0) continue;
        if (argument[0]) snprintf(text, sizeof text, "variant=%.64s", argument);
        else if (!next_choice(s, p, 1, text)) break;
        app_log_argument(app, "%s", strchr(text, '=') + 1);
        return set(app, text, r);
    }
    return report_set(r, STATUS_INPUT, "This scene has no variants.");
}

static bool complete_variant(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    char whole[ACTION_ARGUMENT];
    snprintf(whole, sizeof whole, "variant=%s", text);
    if (!complete_setting(app, whole, index, out)) return false;
    memmove(out, out + 8, strlen(out + 8) + 1);
    return true;
}

static status precision(tui_app *app, const char *argument, report *r) {
    scenes_state *s = state_of(app);
    if (argument[0] && strcmp(argument, "f32") != 0 && strcmp(argument, "f64") != 0)
        return report_input(r, NULL, 0, "precision", "f32 or f64", argument, NULL);
    s->precision = argument[0] ? (strcmp(argument, "f64") == 0 ? 64 : 32) : 96 - s->precision;
    changed(app, s);
    return STATUS_OK;
}

static status clear_choices(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    scenes_state *s = state_of(app);
    forget_choices(s);
    changed(app, s);
    return STATUS_OK;
}

static status plan(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    scenes_state *s = state_of(app);
    s->asked_plan = true;
    s->ask_at = clock_seconds();
    return STATUS_OK;
}

static status reload(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    scenes_state *s = state_of(app);
    s->count = library_scenes(s->list, SCENES_LIMIT);
    s->cursor = s->shown_count = 0;
    apply_filter(app, s);
    changed(app, s);
    app_notice(app, "%d scenes.", s->count);
    return STATUS_OK;
}

static status start(tui_app *app, const char *argument, report *r) {
    scenes_state *s = state_of(app);
    char words[START_TEXT];
    (void)argument;
    if (!scenes_chosen(s)) return report_set(r, STATUS_INPUT, "There is no scene to start.");
    if (!scenes_words(s, words)) return report_set(r, STATUS_INPUT, "Too many settings for one run.");
    if (!app->ended) {
        app_ask(app, "start", words, 0, "Stop the run that is on and start %s?", scenes_chosen(s)->name);
        return STATUS_OK;
    }
    return app_do(app, "start", words, r);
}

/* Enter: on a scene it starts; on a setting it asks for its value, or takes the next choice. */
static status enter(tui_app *app, const char *argument, report *r) {
    scenes_state *s = state_of(app);
    char text[SCENES_SETTING];
    if (!s->on_settings) return start(app, argument, r);
    if (s->parameter == 0) {
        app_prompt(app, "scenes.recipe", s->recipe);
        return STATUS_OK;
    }
    if (s->parameter > s->facts.parameter_count) return STATUS_OK;
    const preview_parameter *p = &s->facts.parameters[s->parameter - 1];
    if (next_choice(s, p, 1, text)) return app_do(app, "scenes.set", text, r);
    snprintf(text, sizeof text, "%s=%s", p->name, p->value);
    app_prompt(app, "scenes.set", text);
    return STATUS_OK;
}

static status side(tui_app *app, const char *argument, report *r) {
    (void)r;
    scenes_state *s = state_of(app);
    s->on_settings = argument[0] ? strcmp(argument, "settings") == 0 : !s->on_settings;
    return STATUS_OK;
}

static const tui_action actions[] = {
    {.name = "enter", .keys = {'\r', '\n', KEY_ENTER}, .keys_shown = "Enter", .hint = "start", .help = "start the scene; on a setting: change it",
     .handler = enter, .unlogged = true},
    {.name = "start", .keys = {'S'}, .keys_shown = "S", .help = "start the scene with what is chosen", .handler = start, .unlogged = true},
    {.name = "filter-type", .keys = {'/'}, .keys_shown = "/", .hint = "filter", .help = "type a part of the name; Esc clears", .handler = type_filter,
     .unlogged = true},
    {.name = "filter", .keys_shown = ":", .help = "show the scenes that contain a text", .handler = set_filter, .argument = ARGUMENT_MAY, .asks = "TEXT",
     .unlogged = true},
    {.name = "up", .keys = {KEY_UP, 'k'}, .keys_shown = "k  up", .help = "the scene or setting above", .handler = move_cursor, .argument = ARGUMENT_MAY,
     .asks = "STEPS", .preset = "-1", .unlogged = true},
    {.name = "down", .keys = {KEY_DOWN, 'j'}, .keys_shown = "j  down", .help = "the scene or setting below", .handler = move_cursor, .argument = ARGUMENT_MAY,
     .asks = "STEPS", .preset = "1", .unlogged = true},
    {.name = "page-up", .keys = {KEY_PPAGE}, .keys_shown = "PgUp", .help = "ten up", .handler = move_cursor, .argument = ARGUMENT_MAY, .asks = "STEPS",
     .preset = "-10", .unlogged = true},
    {.name = "page-down", .keys = {KEY_NPAGE}, .keys_shown = "PgDn", .help = "ten down", .handler = move_cursor, .argument = ARGUMENT_MAY, .asks = "STEPS",
     .preset = "10", .unlogged = true},
    {.name = "settings", .keys = {KEY_RIGHT, 'l'}, .keys_shown = "l  right", .hint = "settings", .help = "to the scene's settings", .handler = side,
     .argument = ARGUMENT_MAY, .asks = "settings|list", .preset = "settings", .unlogged = true},
    {.name = "list", .keys = {KEY_LEFT, 'h'}, .keys_shown = "h  left", .help = "to the list of scenes", .handler = side, .argument = ARGUMENT_MAY,
     .asks = "list", .preset = "list", .unlogged = true},
    {.name = "choose", .keys_shown = ":", .help = "go to a scene by name", .handler = choose, .argument = ARGUMENT_TEXT, .asks = "SCENE",
     .complete = complete_scene},
    {.name = "variant", .keys = {'v'}, .keys_shown = "v", .hint = "variant", .help = "the scene's next variant", .handler = variant,
     .argument = ARGUMENT_MAY, .asks = "VARIANT", .complete = complete_variant},
    {.name = "recipe", .keys = {'r'}, .keys_shown = "r", .hint = "recipe", .help = "another recipe for every body; none: the scene's own",
     .handler = recipe, .argument = ARGUMENT_TEXT, .asks = "RECIPE", .complete = complete_recipe},
    {.name = "set", .keys = {'s'}, .keys_shown = "s", .hint = "set", .help = "set a parameter; without a value: as the scene has it", .handler = set,
     .argument = ARGUMENT_TEXT, .asks = "KEY=VALUE", .complete = complete_setting},
    {.name = "precision", .keys = {'d'}, .keys_shown = "d", .help = "single or double precision", .handler = precision, .argument = ARGUMENT_MAY,
     .asks = "f32|f64"},
    {.name = "clear", .keys = {'x'}, .keys_shown = "x", .help = "forget recipe and settings", .handler = clear_choices},
    {.name = "plan", .keys = {'p'}, .keys_shown = "p", .hint = "plan", .help = "find out what the run will cost", .handler = plan, .unlogged = true},
    {.name = "reload", .keys = {'R'}, .keys_shown = "R", .help = "look for scenes again", .handler = reload, .unlogged = true},
};

/* ---- typing the filter ------------------------------------------------------------------------------------------- */

static bool type(tui_app *app, void *state, int key) {
    scenes_state *s = state;
    size_t length = strlen(s->filter);
    if (!s->typing) return false;
    if (key == KEY_UP || key == KEY_DOWN || key == KEY_NPAGE || key == KEY_PPAGE) return false;
    if (key == '\r' || key == '\n' || key == KEY_ENTER) s->typing = false;
    else if (key == 27) s->typing = false, s->filter[0] = '\0';
    else if (key == KEY_BACKSPACE || key == 127 || key == 8) {
        if (length > 0) s->filter[length - 1] = '\0';
        else s->typing = false;
    } else if (key >= ' ' && key < 127 && length + 1 < sizeof s->filter) {
        s->filter[length] = (char)key;
        s->filter[length + 1] = '\0';
    }
    apply_filter(app, s);
    return true;
}

/* ---- the screen -------------------------------------------------------------------------------------------------- */

static void close_scenes(tui_app *app, void *state) {
    (void)app;
    scenes_state *s = state;
    if (s->preview) preview_close(s->preview);
    memory_free(s, sizeof *s);
}

static status open_scenes(tui_app *app, void **state, report *r) {
    scenes_state *s = *state = memory_allocate(sizeof *s);
    if (!s) return report_set(r, STATUS_SYSTEM, "out of memory for the Scenes screen");
    s->precision = 32;
    s->count = library_scenes(s->list, SCENES_LIMIT);
    apply_filter(app, s);
    for (int i = 0; i < s->shown_count; i++)
        if (strcmp(s->list[s->shown[i]].name, "tube_pull") == 0) s->cursor = i;
    changed(app, s);
    if (app->headless) return STATUS_OK;
    status failed = preview_open(&s->preview, r);
    if (failed != STATUS_OK) memory_free(s, sizeof *s);
    return failed;
}

static void tick(tui_app *app, void *state, double now) {
    scenes_state *s = state;
    char words[START_TEXT];
    if (!s->preview || app->screen != &screen_scenes) return;
    if (preview_poll(s->preview, &s->facts)) app->dirty = true;
    bool busy = preview_busy(s->preview);
    if (busy != s->busy) app->dirty = true;
    s->busy = busy;
    if (s->ask_at == 0 || now < s->ask_at || !scenes_words(s, words)) return;
    const preview_facts *f = &s->facts;
    bool known = strcmp(f->words, words) == 0 && (f->loaded || f->failed);
    /* A plan takes every core for a moment: not while a run is on, unless it is asked for. */
    bool plan_it = s->asked_plan || (known && app->ended && !f->planned && !f->failed && f->particles <= PLAN_UNASKED);
    if (plan_it || (!known && strcmp(s->asked, words) != 0)) preview_ask(s->preview, words, plan_it);
    snprintf(s->asked, sizeof s->asked, "%s", words);
    s->ask_at = plan_it || known ? 0 : now + settle_time;
    s->asked_plan = false;
    app->dirty = true;
}

const tui_screen screen_scenes = {
    .name = "scenes",
    .title = "Scenes",
    .help = "scenes and recipes: what they contain and cost; start one",
    .actions = actions,
    .action_count = sizeof actions / sizeof *actions,
    .open = open_scenes,
    .close = close_scenes,
    .tick = tick,
    .draw = scenes_draw,
    .key = type,
};
