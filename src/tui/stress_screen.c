/* The Stress screen: the hard cases, one verdict each, and the figures that decided it. The runs are made by `sunder stress` in a process of its own,
 * whose lines say what has become of each. */
#include "tui/stresses.h"

#include "base/memory.h"
#include "sim/scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const state_words[STATES] = {"not run", "started", "holds", "stops", "known limit", "FAILS"};

static stresses *stresses_of(tui_app *app) {
    report unused;
    return screen_state(app, &screen_stress, &unused);
}

const char *stress_state_word(stress_state state) {
    return state_words[state];
}

int stresses_count(const stresses *s, stress_state state) {
    int count = 0;
    for (int i = 0; i < s->count; i++) count += s->rows[i].state == state;
    return count;
}

/* ---- which are shown --------------------------------------------------------------------------------------------- */

/* Whether a name stands in "a, b, c". */
static bool lists(const char *names, const char *name) {
    size_t length = strlen(name);
    for (const char *at = names; (at = strstr(at, name)); at += length)
        if ((at == names || at[-1] == ',') && (at[length] == '\0' || at[length] == ',')) return true;
    return false;
}

static bool fits(const stresses *s, const stress_row *row) {
    if (s->effect[0] && !lists(row->effects, s->effect)) return false;
    return !s->trouble || row->state == STATE_FAILS || row->state == STATE_KNOWN;
}

static void arrange(stresses *s) {
    const stress_row *here = s->cursor < s->shown_count ? &s->rows[s->shown[s->cursor]] : NULL;
    s->shown_count = s->cursor = 0;
    for (int i = 0; i < s->count; i++) {
        if (!fits(s, &s->rows[i])) continue;
        if (&s->rows[i] == here) s->cursor = s->shown_count;
        s->shown[s->shown_count++] = i;
    }
}

static stress_row *chosen(const stresses *s) {
    return s->cursor < s->shown_count ? &s->rows[s->shown[s->cursor]] : NULL;
}

/* ---- the child --------------------------------------------------------------------------------------------------- */

static stress_row *row_of(stresses *s, const char *name, const char *precision, bool make) {
    for (int i = 0; i < s->count; i++)
        if (strcmp(s->rows[i].name, name) == 0 && (!precision || strcmp(s->rows[i].precision, precision) == 0)) return &s->rows[i];
    if (!make || s->count == STRESSES) return NULL;
    stress_row *row = &s->rows[s->count++];
    *row = (stress_row){.state = STATE_NOT_RUN};
    snprintf(row->name, sizeof row->name, "%s", name);
    snprintf(row->precision, sizeof row->precision, "%s", precision ? precision : "");
    return row;
}

static int state_of_word(const char *word) {
    for (int i = 0; i < STATES; i++)
        if (strcmp(state_words[i], word) == 0) return i;
    return -1;
}

/* "case  NAME  damage,elastic  what it is": before the lines of runs. */
static void take_case(stresses *s, const char *line) {
    char name[STRESSES_NAME], effects[STRESSES_EFFECTS];
    int after = 0;
    if (sscanf(line, "case  %191s  %191s  %n", name, effects, &after) < 2 || after == 0) return;
    for (int i = 0; i < s->count; i++) {
        stress_row *row = &s->rows[i];
        if (strcmp(row->name, name) != 0) continue;
        snprintf(row->effects, sizeof row->effects, "%s", effects);
        snprintf(row->remark, sizeof row->remark, "%.*s", STRESSES_REMARK - 1, line + after);
    }
}

/* "3/80  holds        20261122-…  inversion/random  f32  energy_gain …": what has become of a run. */
static void take_line(stresses *s, const char *line) {
    int number, of, after = 0;
    char word[24], id[LEDGER_ID], name[STRESSES_NAME], precision[24];
    if (strncmp(line, "case  ", 6) == 0) {
        take_case(s, line);
        return;
    }
    if (sscanf(line, "%d/%d  %23[A-Za-z ]%n", &number, &of, word, &after) < 3) {
        snprintf(s->said, sizeof s->said, "%s", line);
        return;
    }
    size_t end = strlen(word);
    while (end > 0 && word[end - 1] == ' ') word[--end] = '\0';
    int state = state_of_word(word), text = 0;
    if (state < 0 || sscanf(line + after, "%39s %191s %23s %n", id, name, precision, &text) < 3) return;
    stress_row *row = row_of(s, name, precision, s->listing);
    if (!row) return;
    row->state = (stress_state)state;
    snprintf(row->id, sizeof row->id, "%s", strcmp(id, "-") == 0 ? "" : id);
    if (state != STATE_GOING) snprintf(row->text, sizeof row->text, "%.*s", (int)sizeof row->text - 1, text > 0 ? line + after + text : "");
}

static status start_child(tui_app *app, stresses *s, char *const *names, int count, report *r) {
    char *arguments[STRESSES_MARKS + 12] = {(char *)"sunder", (char *)"stress", (char *)"--verbose", (char *)"--precision", s->precision};
    int used = 5;
    if (app->database[0]) arguments[used++] = (char *)"--db", arguments[used++] = app->database;
    if (!names) arguments[used++] = (char *)"--last";
    for (int i = 0; i < count; i++) arguments[used++] = names[i];
    child_close(&s->child);
    status code = child_start(&s->child, arguments, r);
    s->listing = code == STATUS_OK && !names;
    s->going = code == STATUS_OK && names;
    s->said[0] = '\0';
    app->dirty = true;
    return code;
}

static status list_cases(tui_app *app, stresses *s, report *r) {
    s->count = s->shown_count = s->cursor = 0;
    return start_child(app, s, NULL, 0, r);
}

static void say_end(tui_app *app, const stresses *s) {
    if (s->child.exit_code == 2) app_notice(app, "%s", s->said);
    else if (s->child.exit_code == 130) app_notice(app, "The hard cases have ended: stopped");
    else if (s->going) app_notice(app, "The hard cases have ended: %s", s->child.exit_code ? "some FAIL" : "all as they should be");
}

static void tick_stress(tui_app *app, void *state, double now) {
    stresses *s = state;
    char line[CHILD_LINE];
    (void)now;
    if (!s->going && !s->listing) return;
    bool news = false;
    for (int i = 0; i < 64 && child_line(&s->child, line); i++) {
        take_line(s, line);
        news = app->dirty = true;
    }
    if (s->child.ended && s->child.used == 0) {
        say_end(app, s);
        for (int i = 0; i < s->count; i++)
            if (s->rows[i].state == STATE_GOING) s->rows[i].state = STATE_NOT_RUN;
        s->going = s->listing = false;
        news = app->dirty = true;
    }
    if (news) arrange(s);
}

/* ---- actions ----------------------------------------------------------------------------------------------------- */

static status move_by(tui_app *app, int by) {
    stresses *s = stresses_of(app);
    s->cursor = cursor_within(s->cursor + by, s->shown_count);
    app->dirty = true;
    return STATUS_OK;
}

static status go_up(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    return move_by(app, -1);
}

static status go_down(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    return move_by(app, 1);
}

static status go_page_up(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    return move_by(app, -stresses_of(app)->page_rows);
}

static status go_page_down(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    return move_by(app, stresses_of(app)->page_rows);
}

static status start_runs(tui_app *app, stresses *s, char *const *names, int count, report *r) {
    if (s->going) return report_set(r, STATUS_INPUT, "Cases are being run already: S stops them.");
    if (s->listing) return report_set(r, STATUS_INPUT, "The cases are still being listed.");
    return start_child(app, s, names, count, r);
}

/* run: the cases that are named, else the marked ones, else the one under the cursor. */
static status run_some(tui_app *app, const char *argument, report *r) {
    stresses *s = stresses_of(app);
    static char text[ACTION_ARGUMENT];
    char *names[STRESSES_MARKS], *rest = NULL;
    int count = 0;
    snprintf(text, sizeof text, "%s", argument);
    for (char *word = strtok_r(text, " ", &rest); word && count < STRESSES_MARKS; word = strtok_r(NULL, " ", &rest)) names[count++] = word;
    for (int i = 0; i < s->count && !argument[0] && count < STRESSES_MARKS; i++)
        if (s->rows[i].marked) names[count++] = s->rows[i].name;
    if (count == 0 && chosen(s)) names[count++] = chosen(s)->name;
    if (count == 0) return report_set(r, STATUS_INPUT, "There is no case here.");
    char said[ACTION_ARGUMENT] = "";
    for (int i = 0, used = 0; i < count && used < ACTION_ARGUMENT; i++) used += snprintf(said + used, sizeof said - (size_t)used, "%s%s", i ? " " : "", names[i]);
    app_log_argument(app, "%s", said);
    return start_runs(app, s, names, count, r);
}

static status run_all(tui_app *app, const char *argument, report *r) {
    stresses *s = stresses_of(app);
    char *none[1] = {NULL};
    (void)argument;
    return start_runs(app, s, none, 0, r);
}

static status stop_runs(tui_app *app, const char *argument, report *r) {
    stresses *s = stresses_of(app);
    (void)argument;
    if (!s->going) return report_set(r, STATUS_INPUT, "No cases are being run.");
    child_stop(&s->child);
    app_notice(app, "stopping: runs end after their frame");
    return STATUS_OK;
}

static status mark(tui_app *app, const char *argument, report *r) {
    stresses *s = stresses_of(app);
    stress_row *row = argument[0] ? row_of(s, argument, NULL, false) : chosen(s);
    if (!row) return report_set(r, STATUS_INPUT, "There is no case %s.", argument[0] ? argument : "here");
    int marks = 0;
    for (int i = 0; i < s->count; i++) marks += s->rows[i].marked;
    if (!row->marked && marks == STRESSES_MARKS) return report_set(r, STATUS_INPUT, "At most %d cases may be marked.", STRESSES_MARKS);
    row->marked = !row->marked;
    app_log_argument(app, "%s", row->name);
    return argument[0] ? STATUS_OK : move_by(app, 1);
}

static status unmark(tui_app *app, const char *argument, report *r) {
    stresses *s = stresses_of(app);
    (void)argument, (void)r;
    for (int i = 0; i < s->count; i++) s->rows[i].marked = false;
    app->dirty = true;
    return STATUS_OK;
}

/* The index of an effect by name, -1 for none. */
static int effect_place(const char *name) {
    int count;
    const effect *const *all = effect_catalogue(&count);
    for (int e = 0; e < count; e++)
        if (strcmp(all[e]->name, name) == 0) return e;
    return -1;
}

/* effect: that one's cases; without a name the next effect's, after the last all. */
static status choose_effect(tui_app *app, const char *argument, report *r) {
    stresses *s = stresses_of(app);
    int count;
    const effect *const *all = effect_catalogue(&count);
    if (argument[0] && strcmp(argument, "all") != 0 && effect_place(argument) < 0) return report_input(r, NULL, 0, "effect", "an effect, or all", argument, NULL);
    if (!argument[0]) {
        int next = effect_place(s->effect) + 1; /* of no effect: the first */
        snprintf(s->effect, sizeof s->effect, "%s", next < count ? all[next]->name : "");
    } else {
        snprintf(s->effect, sizeof s->effect, "%s", strcmp(argument, "all") == 0 ? "" : argument);
    }
    app_log_argument(app, "%s", s->effect[0] ? s->effect : "all");
    arrange(s);
    app->dirty = true;
    return STATUS_OK;
}

static status show_trouble(tui_app *app, const char *argument, report *r) {
    stresses *s = stresses_of(app);
    (void)argument, (void)r;
    s->trouble = !s->trouble;
    arrange(s);
    app->dirty = true;
    return STATUS_OK;
}

static status choose_precision(tui_app *app, const char *argument, report *r) {
    stresses *s = stresses_of(app);
    static const char *const known[] = {"f32", "f64", "both"};
    int at = -1, now = 0;
    if (s->going) return report_set(r, STATUS_INPUT, "Cases are being run: S stops them.");
    for (int i = 0; i < 3; i++) {
        if (strcmp(known[i], argument) == 0) at = i;
        if (strcmp(known[i], s->precision) == 0) now = i;
    }
    if (argument[0] && at < 0) return report_input(r, NULL, 0, "precision", "f32, f64 or both", argument, NULL);
    snprintf(s->precision, sizeof s->precision, "%s", known[at >= 0 ? at : (now + 1) % 3]);
    app_log_argument(app, "%s", s->precision);
    return list_cases(app, s, r);
}

/* open: the frames of the run of the case under the cursor, or of the one that is named. */
static status open_run(tui_app *app, const char *argument, report *r) {
    stresses *s = stresses_of(app);
    const stress_row *row = argument[0] ? row_of(s, argument, NULL, false) : chosen(s);
    if (!row || !row->id[0]) return report_set(r, STATUS_INPUT, "There is no run of it yet: r makes one.");
    app_log_argument(app, "%s", row->name);
    app_show(app, &screen_runs);
    return app_do(app, "runs.open", row->id, r);
}

static bool complete_effect(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    int count;
    const effect *const *all = effect_catalogue(&count);
    (void)app;
    for (int e = 0; e < count; e++)
        if (complete_word(all[e]->name, text, &index, out)) return true;
    return false;
}

static bool complete_case(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    const stresses *s = stresses_of(app);
    for (int i = 0; i < s->count; i++)
        if (complete_word(s->rows[i].name, text, &index, out)) return true;
    return false;
}

static const tui_action actions[] = {
    {"up", {KEY_UP, 'k'}, "up", NULL, "the case above", .handler = go_up, .unlogged = true},
    {"down", {KEY_DOWN, 'j'}, "down", NULL, "the case below", .handler = go_down, .unlogged = true},
    {"page-up", {KEY_PPAGE}, "PgUp", NULL, "a page up", .handler = go_page_up, .unlogged = true},
    {"page-down", {KEY_NPAGE}, "PgDn", NULL, "a page down", .handler = go_page_down, .unlogged = true},
    {"run", {'r'}, "r", "run", "run the marked cases, or the one under the cursor", .handler = run_some, .argument = ARGUMENT_MAY, .asks = "CASE …", .complete = complete_case},
    {"run-all", {'R'}, "R", "all", "run all cases", .handler = run_all},
    {"stop", {'S'}, "S", "stop", "stop running: what is done stays", .handler = stop_runs},
    {"mark", {' '}, "space", "mark", "mark the case, or take its mark away", .handler = mark, .argument = ARGUMENT_MAY, .asks = "CASE", .complete = complete_case},
    {"unmark", {'u'}, "u", NULL, "take all marks away", .handler = unmark},
    {"effect", {'e'}, "e", "effect", "only cases of the next effect, or of one by name", .handler = choose_effect, .argument = ARGUMENT_MAY, .asks = "EFFECT", .complete = complete_effect},
    {"trouble", {'f'}, "f", "failing", "only cases that fail or are known limits, or all again", .handler = show_trouble},
    {"precision", {'p'}, "p", NULL, "f32, f64 or both", .handler = choose_precision, .argument = ARGUMENT_MAY, .asks = "f32|f64|both"},
    {"open", {'\r', '\n', KEY_ENTER}, "enter", "frames", "the frames of the case's run", .handler = open_run, .argument = ARGUMENT_MAY, .asks = "CASE", .complete = complete_case},
};

/* ---- the screen -------------------------------------------------------------------------------------------------- */

static void close_stress(tui_app *app, void *state) {
    stresses *s = state;
    (void)app;
    child_close(&s->child);
    memory_free(s->rows, STRESSES * sizeof *s->rows);
    memory_free(s->shown, STRESSES * sizeof *s->shown);
    memory_free(s, sizeof *s);
}

static status open_stress(tui_app *app, void **state, report *r) {
    stresses *s = *state = memory_allocate(sizeof *s);
    if (!s) return report_set(r, STATUS_SYSTEM, "out of memory for the Stress screen");
    s->child.fd = -1;
    snprintf(s->precision, sizeof s->precision, "f32");
    s->rows = memory_allocate_array(STRESSES, sizeof *s->rows);
    s->shown = memory_allocate_array(STRESSES, sizeof *s->shown);
    if (!s->rows || !s->shown) {
        close_stress(app, s);
        *state = NULL;
        return report_set(r, STATUS_SYSTEM, "out of memory for the Stress screen");
    }
    return STATUS_OK;
}

static void enter_stress(tui_app *app, void *state) {
    stresses *s = state;
    report unused;
    if (!s->going && !s->listing && s->count == 0) (void)list_cases(app, s, &unused);
    app->dirty = true;
}

const tui_screen screen_stress = {
    .name = "stress",
    .title = "Stress",
    .help = "the hard cases: what each must come to, and whether it does",
    .actions = actions,
    .action_count = sizeof actions / sizeof *actions,
    .open = open_stress,
    .close = close_stress,
    .enter = enter_stress,
    .tick = tick_stress,
    .draw = stresses_draw,
};
