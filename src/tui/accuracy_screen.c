/* The Accuracy screen: what accuracy costs in time, for the scene chosen on Scenes or that of the run in view. */
#include "tui/accuracy_view.h"

#include "base/memory.h"
#include "base/names.h"
#include "tui/scenes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static accuracy_view *state_of(tui_app *app) {
    report unused;
    return screen_state(app, &screen_accuracy, &unused);
}

/* ---- the child --------------------------------------------------------------------------------------------------- */

typedef struct arguments {
    char *word[START_WORDS];
    int count;
    start_words words;
    char text[START_WORDS / 2][256];
    int texts;
} arguments;

static void add(arguments *a, const char *word) {
    if (a->count < START_WORDS - 1) a->word[a->count++] = (char *)word;
    a->word[a->count] = NULL;
}

static void add_option(arguments *a, const char *option, const char *value) {
    if (!value) return;
    add(a, option);
    add(a, value);
}

static void add_number(arguments *a, const char *option, long value) {
    if (value <= 0 || a->texts == START_WORDS / 2) return;
    snprintf(a->text[a->texts], sizeof a->text[0], "%ld", value);
    add_option(a, option, a->text[a->texts++]);
}

static void add_scene(arguments *a) {
    const session_options *o = &a->words.options;
    add(a, "sunder");
    add(a, "accuracy");
    add(a, o->scene_path);
    add_option(a, "--recipe", o->script.recipe);
    for (int i = 0; i < o->script.setting_count && a->texts < START_WORDS / 2; i++) {
        snprintf(a->text[a->texts], sizeof a->text[0], "%.120s=%.120s", o->script.settings[i].key, o->script.settings[i].value);
        add_option(a, "--set", a->text[a->texts++]);
    }
    if (o->precision == 64) add_option(a, "--precision", "f64");
    if (strcmp(o->simd, "auto") != 0) add_option(a, "--simd", o->simd);
    add_number(a, "--threads", o->threads);
}

static status start_child(tui_app *app, accuracy_view *s, bool look, const char *jobs, report *r) {
    arguments *a = memory_allocate(sizeof *a);
    if (!a) return report_set(r, STATUS_SYSTEM, "out of memory for a study");
    status code = start_parse(s->words, &a->words, r);
    if (code == STATUS_OK) {
        long frames = s->frames > 0 ? s->frames : a->words.options.frames > 0 ? (long)a->words.options.frames : 0;
        add_scene(a);
        add_option(a, "--csv", "-");
        add_number(a, "--levels", s->levels);
        add_number(a, "--frames", frames);
        add_number(a, "--budget", s->budget);
        if (app->database[0]) add_option(a, "--db", app->database);
        if (look) add(a, "--list"), add_option(a, "--axis", "all");
        else if (jobs[0]) add_option(a, "-j", jobs);
        for (int i = 0; i < s->axis_count && !look; i++)
            if (s->axes[i].on) add_option(a, "--axis", s->axes[i].name);
        child_close(&s->child);
        code = child_start(&s->child, a->word, r);
    }
    memory_free(a, sizeof *a);
    s->looking = code == STATUS_OK && look;
    s->going = code == STATUS_OK && !look;
    s->table = false;
    s->said[0] = '\0';
    app->dirty = true;
    return code;
}

static void tick(tui_app *app, void *state, double now) {
    accuracy_view *s = state;
    char line[CHILD_LINE];
    (void)now;
    if (!s->going && !s->looking) return;
    for (int i = 0; i < 64 && child_line(&s->child, line); i++) {
        accuracy_view_take(s, line);
        app->dirty = true;
    }
    if (!s->child.ended || s->child.used > 0) return;
    if (s->child.exit_code == 2) app_notice(app, "%s", s->said);
    else if (s->going) app_notice(app, "The study has ended%s", s->child.exit_code == 0 ? "" : s->child.exit_code == 130 ? ": stopped" : ": some runs failed");
    s->going = s->looking = false;
    accuracy_view_order(s);
    if (s->cursor >= s->level_count) s->cursor = s->level_count > 0 ? s->level_count - 1 : 0;
    app->dirty = true;
}

/* ---- which scene ------------------------------------------------------------------------------------------------- */

static void forget(accuracy_view *s) {
    child_close(&s->child);
    s->axis_count = s->level_count = s->measure_count = s->note_count = s->cursor = s->top = 0;
    s->going = s->looking = s->table = false;
    s->words[0] = s->title[0] = s->tag[0] = s->said[0] = '\0';
    s->shown = -1;
}

static status refuse_going(const accuracy_view *s, report *r) {
    return s->going ? report_set(r, STATUS_INPUT, "A study is going on: S stops it.") : STATUS_OK;
}

static status take_scene(tui_app *app, const char *words, report *r) {
    accuracy_view *s = state_of(app);
    if (refuse_going(s, r) != STATUS_OK) return r->code;
    forget(s);
    snprintf(s->words, sizeof s->words, "%s", words);
    status code = start_child(app, s, true, "", r);
    if (code != STATUS_OK) s->words[0] = '\0';
    return code;
}

static const view_level *level_here(const accuracy_view *s) {
    return s->cursor < s->level_count ? &s->level[s->cursor] : NULL;
}

static status open_run(tui_app *app, const accuracy_view *s, report *r) {
    const view_level *l = level_here(s);
    if (!l || !l->run[0]) return report_set(r, STATUS_INPUT, "There is no run here yet.");
    char run[LEDGER_ID];
    memcpy(run, l->run, sizeof run);
    app_log_nothing(app); /* where the cursor was is not in the log */
    app_show(app, &screen_runs);
    return app_do(app, "runs.open", run, r);
}

static status choose(tui_app *app, const char *argument, report *r) {
    accuracy_view *s = state_of(app);
    char words[START_TEXT];
    if (argument[0]) return take_scene(app, argument, r);
    if (s->level_count > 0) return open_run(app, s, r);
    report unused;
    const scenes_state *scenes = screen_state(app, &screen_scenes, &unused);
    if (!scenes || !scenes_words(scenes, words)) return report_set(r, STATUS_INPUT, "No scene is chosen on Scenes.");
    app_log_argument(app, "%s", words);
    return take_scene(app, words, r);
}

static status of_run(tui_app *app, const char *argument, report *r) {
    session_options o;
    char words[START_TEXT];
    (void)argument;
    if (!app->run) return report_set(r, STATUS_INPUT, "There is no run in view.");
    session_request(app->run, &o);
    if (!start_print(&o, words)) return report_set(r, STATUS_INPUT, "This run has too many settings.");
    return take_scene(app, words, r);
}

static status go_back(tui_app *app, const char *argument, report *r) {
    accuracy_view *s = state_of(app);
    (void)argument;
    if (refuse_going(s, r) != STATUS_OK) return r->code;
    forget(s);
    app->dirty = true;
    return STATUS_OK;
}

/* ---- what is to be run ------------------------------------------------------------------------------------------- */

static status look_again(tui_app *app, accuracy_view *s, report *r) {
    if (refuse_going(s, r) != STATUS_OK) return r->code;
    return s->words[0] ? start_child(app, s, true, "", r) : STATUS_OK;
}

static status turn_axis(tui_app *app, const char *argument, report *r) {
    accuracy_view *s = state_of(app);
    const view_level *l = level_here(s);
    const char *names[VIEW_AXES];
    int found = l && !argument[0] ? l->axis : -1;
    if (s->level_count == 0) return report_set(r, STATUS_INPUT, "Take a scene with Enter first.");
    for (int a = 0; a < s->axis_count; a++) {
        names[a] = s->axes[a].name;
        if (strcmp(names[a], argument) == 0) found = a;
    }
    if (found < 0) return report_input(r, NULL, 0, "axis", "an axis of this scene", argument, name_nearest(argument, names, s->axis_count));
    if (refuse_going(s, r) != STATUS_OK) return r->code;
    s->axes[found].on = !s->axes[found].on;
    app_log_argument(app, "%s", s->axes[found].name);
    app->dirty = true;
    return STATUS_OK;
}

static bool complete_axis(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    const accuracy_view *s = state_of(app);
    for (int a = 0; a < s->axis_count; a++)
        if (complete_word(s->axes[a].name, text, &index, out)) return true;
    return false;
}

static status whole(const char *key, const char *text, long low, long high, long *out, report *r) {
    char *end, expected[64];
    *out = strtol(text, &end, 10);
    if (end != text && !*end && *out >= low && *out <= high) return STATUS_OK;
    snprintf(expected, sizeof expected, "a whole number from %ld to %ld", low, high);
    return report_input(r, NULL, 0, key, expected, text, NULL);
}

static status set_levels(tui_app *app, const char *argument, report *r) {
    accuracy_view *s = state_of(app);
    long value;
    if (refuse_going(s, r) != STATUS_OK || whole("levels", argument, 2, 9, &value, r) != STATUS_OK) return r->code;
    s->levels = (int)value;
    return look_again(app, s, r);
}

static status set_frames(tui_app *app, const char *argument, report *r) {
    accuracy_view *s = state_of(app);
    if (refuse_going(s, r) != STATUS_OK || whole("frames", argument, 0, 1000000, &s->frames, r) != STATUS_OK) return r->code;
    return look_again(app, s, r);
}

static status set_budget(tui_app *app, const char *argument, report *r) {
    accuracy_view *s = state_of(app);
    if (refuse_going(s, r) != STATUS_OK || whole("budget", argument, 0, 1000000, &s->budget, r) != STATUS_OK) return r->code;
    return look_again(app, s, r);
}

static status run_study(tui_app *app, const char *argument, report *r) {
    accuracy_view *s = state_of(app);
    long jobs = 1;
    int on = 0;
    if (s->level_count == 0) return report_set(r, STATUS_INPUT, s->looking ? "The scene is still being looked at." : "Take a scene with Enter first.");
    if (refuse_going(s, r) != STATUS_OK) return r->code;
    if (argument[0] && whole("jobs", argument, 1, 16, &jobs, r) != STATUS_OK) return r->code;
    for (int a = 0; a < s->axis_count; a++) on += s->axes[a].on;
    if (on == 0) return report_set(r, STATUS_INPUT, "No axis is marked: the space bar marks the one under the cursor.");
    return start_child(app, s, false, argument, r);
}

static status stop_study(tui_app *app, const char *argument, report *r) {
    accuracy_view *s = state_of(app);
    (void)argument;
    if (!s->going) return report_set(r, STATUS_INPUT, "No study is going on.");
    child_stop(&s->child);
    app_notice(app, "stopping: the run ends after its frame, and what is done stays");
    return STATUS_OK;
}

/* ---- what is seen ------------------------------------------------------------------------------------------------ */

/* The largest, up to the first crack, then each measure that some level has. */
static bool has_values(const accuracy_view *s, int measure) {
    for (int i = 0; i < s->level_count; i++) {
        const view_level *l = &s->level[i];
        if (isfinite(measure == -2 ? l->number[COLUMN_EARLY] : measure == -1 ? 0 : l->measure[measure])) return true;
    }
    return false;
}

static status show_error(tui_app *app, const char *argument, report *r) {
    accuracy_view *s = state_of(app);
    const char *names[VIEW_MEASURES];
    int found = -3;
    if (s->measure_count == 0) return report_set(r, STATUS_INPUT, "Take a scene with Enter first.");
    for (int m = 0; m < s->measure_count; m++) {
        names[m] = s->measures[m];
        if (strcmp(names[m], argument) == 0) found = m;
    }
    if (strcmp(argument, "error") == 0) found = -1;
    if (argument[0] && found == -3) return report_input(r, NULL, 0, "error", "error, or a measure of the study", argument, name_nearest(argument, names, s->measure_count));
    if (!argument[0]) {
        found = s->shown;
        do found = found + 1 < s->measure_count ? found + 1 : -2;
        while (!has_values(s, found));
    }
    s->shown = found;
    app->dirty = true;
    return STATUS_OK;
}

static status turn_plot(tui_app *app, const char *argument, report *r) {
    accuracy_view *s = state_of(app);
    (void)argument, (void)r;
    s->plot = !s->plot;
    app->dirty = true;
    return STATUS_OK;
}

/* The level under the cursor becomes what is run. */
static status adopt(tui_app *app, const char *argument, report *r) {
    const accuracy_view *s = state_of(app);
    const view_level *l = level_here(s);
    char words[2 * START_TEXT];
    (void)argument;
    if (!l) return report_set(r, STATUS_INPUT, "Take a scene with Enter first.");
    snprintf(words, sizeof words, "%s%s%s", s->words, l->settings[0] ? " " : "", l->settings);
    if (strlen(words) >= ACTION_ARGUMENT) return report_set(r, STATUS_INPUT, "Too many settings for one run.");
    if (!app->ended) {
        app_ask(app, "start", words, 0, "Stop the run that is on and start one with %s %s?", l->key, l->value);
        return STATUS_OK;
    }
    return app_do(app, "start", words, r);
}

static status move_cursor(tui_app *app, const char *argument, report *r) {
    accuracy_view *s = state_of(app);
    (void)r;
    s->cursor = cursor_within(s->cursor + atoi(argument), s->level_count);
    app->dirty = true;
    return STATUS_OK;
}

static status go_up(tui_app *app, const char *argument, report *r) {
    (void)argument;
    return move_cursor(app, "-1", r);
}

static status go_down(tui_app *app, const char *argument, report *r) {
    (void)argument;
    return move_cursor(app, "1", r);
}

static const tui_action actions[] = {
    {"up", {KEY_UP, 'k'}, "up", NULL, "the level above", .handler = go_up, .unlogged = true},
    {"down", {KEY_DOWN, 'j'}, "down", NULL, "the level below", .handler = go_down, .unlogged = true},
    {"choose", {'\r', '\n', KEY_ENTER}, "Enter", "open", "take the scene chosen on Scenes; on a level: its run's frames", .handler = choose, .argument = ARGUMENT_MAY,
     .asks = "SCENE [--set KEY=VALUE]"},
    {"of-run", {'c'}, "c", NULL, "take the scene of the run in view", .handler = of_run},
    {"axis", {' '}, "Space", "mark", "mark the axis, or take its mark away: marked ones are run", .handler = turn_axis, .argument = ARGUMENT_MAY, .asks = "AXIS",
     .complete = complete_axis},
    {"levels", {'l'}, "l", "levels", "how many levels an axis has", .handler = set_levels, .argument = ARGUMENT_NUMBER, .asks = "levels"},
    {"frames", {'f'}, "f", NULL, "how many frames are run; 0: the scene's", .handler = set_frames, .argument = ARGUMENT_NUMBER, .asks = "frames"},
    {"budget", {'b'}, "b", NULL, "how many seconds all runs may take; 0: no limit", .handler = set_budget, .argument = ARGUMENT_NUMBER, .asks = "seconds"},
    {"run", {'r'}, "r", "run", "make the runs that are missing, one after another (at once: times are then no measure)", .handler = run_study, .argument = ARGUMENT_MAY,
     .asks = "jobs"},
    {"stop", {'S'}, "S", "stop", "stop it: what is done stays", .handler = stop_study},
    {"error", {'e'}, "e", "error", "show the next measure's error", .handler = show_error, .argument = ARGUMENT_MAY, .asks = "MEASURE"},
    {"plot", {'p'}, "p", "plot", "the curves in the table's place, and back", .handler = turn_plot},
    {"adopt", {'a'}, "a", "adopt", "start a run with the level under the cursor", .handler = adopt, .unlogged = true},
    {"back", {27, KEY_BACKSPACE, 127}, "Esc", NULL, "forget the scene, for another one", .handler = go_back},
};

/* ---- the screen -------------------------------------------------------------------------------------------------- */

static status open_view(tui_app *app, void **state, report *r) {
    (void)app;
    accuracy_view *s = *state = memory_allocate(sizeof *s);
    view_level *levels = memory_allocate_array(VIEW_ROWS, sizeof *levels);
    if (!s || !levels) {
        memory_free(s, sizeof *s);
        memory_free(levels, VIEW_ROWS * sizeof *levels);
        return report_set(r, STATUS_SYSTEM, "out of memory for the Accuracy screen");
    }
    s->level = levels;
    s->levels = 3;
    s->child.fd = -1;
    s->shown = -1;
    return STATUS_OK;
}

static void close_view(tui_app *app, void *state) {
    accuracy_view *s = state;
    (void)app;
    child_close(&s->child);
    memory_free(s->level, VIEW_ROWS * sizeof *s->level);
    memory_free(s, sizeof *s);
}

const tui_screen screen_accuracy = {
    .name = "accuracy",
    .title = "Accuracy",
    .help = "what accuracy costs in time",
    .actions = actions,
    .action_count = sizeof actions / sizeof *actions,
    .open = open_view,
    .close = close_view,
    .tick = tick,
    .draw = accuracy_view_draw,
};
