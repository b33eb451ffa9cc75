/* The Sweep screen: a scene over lists of values; its grid, how far it is, and a measure of each run. The runs are made by `sunder sweep`
 * in a process of its own, whose lines say what has become of each. */
#include "tui/sweeps.h"

#include "base/memory.h"
#include "base/threads.h"
#include "script/library.h"
#include "store/ledger_names.h"

#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static sweep_state *state_of(tui_app *app) {
    report unused;
    return screen_state(app, &screen_sweep, &unused);
}

/* ---- scripts ----------------------------------------------------------------------------------------------------- */

static void add_script(sweep_state *s, const char *path) {
    for (int i = 0; i < s->script_count; i++)
        if (strcmp(s->scripts[i], path) == 0) return;
    if (s->script_count < SWEEPS_SCRIPTS && strlen(path) < SWEEP_PATH) snprintf(s->scripts[s->script_count++], SWEEP_PATH, "%s", path);
}

static void add_folder(sweep_state *s, const char *folder) {
    char pattern[LIBRARY_PATH + 32];
    glob_t found;
    snprintf(pattern, sizeof pattern, "%s/sweeps/*.lua", folder);
    if (glob(pattern, 0, NULL, &found) != 0) return;
    for (size_t i = 0; i < found.gl_pathc; i++) add_script(s, found.gl_pathv[i]);
    globfree(&found);
}

/* Sweeps lie in a folder of that name beside the scenes. */
static void find_scripts(sweep_state *s) {
    enum { SCENES = 256 };
    library_scene *scenes = memory_allocate_array(SCENES, sizeof *scenes);
    s->script_count = 0;
    add_folder(s, ".");
    int count = scenes ? library_scenes(scenes, SCENES) : 0;
    for (int i = 0; i < count; i++) {
        char *slash = strrchr(scenes[i].path, '/');
        if (slash) *slash = '\0';
        add_folder(s, slash ? scenes[i].path : ".");
    }
    memory_free(scenes, SCENES * sizeof *scenes);
    if (s->script >= s->script_count) s->script = 0;
}

/* ---- the grid ---------------------------------------------------------------------------------------------------- */

int sweep_extent(const sweep_state *s, int which) {
    return s->axis[which] >= 0 ? s->plan.axes[s->axis[which]].count : 1;
}

int sweep_run_at(const sweep_state *s, int down, int across) {
    int run = 0;
    for (int a = 0; a < s->plan.axis_count; a++) {
        int value = a == s->axis[0] ? down : a == s->axis[1] ? across : s->held[a];
        run = run * s->plan.axes[a].count + value;
    }
    return run < s->count ? run : -1;
}

static void forget_plan(sweep_state *s) {
    child_close(&s->child);
    if (s->cells) memory_free(s->cells, (size_t)s->count * sizeof *s->cells);
    s->cells = NULL;
    s->count = 0;
    s->loaded = s->going = s->listing = false;
    memset(s->held, 0, sizeof s->held);
    memset(s->at, 0, sizeof s->at);
    s->said[0] = '\0';
}

/* ---- values ------------------------------------------------------------------------------------------------------ */

static status take_value(void *context, const ledger_cell *cells, int count, report *r) {
    (void)count, (void)r;
    *(double *)context = cells[0].number;
    return STATUS_OK;
}

static void read_value(tui_app *app, sweep_state *s, sweep_cell_result *cell) {
    char run[LEDGER_ID + 4], measure[SWEEPS_NAME + 16];
    const char *const arguments[] = {run, measure};
    report unused;
    cell->value = NAN;
    if (!cell->last.id[0] || (!s->l && app_open_ledger(app, &s->l, &unused) != STATUS_OK)) return;
    snprintf(run, sizeof run, "id=%s", cell->last.id);
    snprintf(measure, sizeof measure, "measure=%s", s->measure);
    (void)ledger_each_row(s->l, "SELECT value FROM final_measures WHERE id = :id AND name = :measure", arguments, 2, take_value, &cell->value, &unused);
}

static void read_values(tui_app *app, sweep_state *s) {
    for (int i = 0; i < s->count; i++) read_value(app, s, &s->cells[i]);
    app->dirty = true;
}

/* ---- the child --------------------------------------------------------------------------------------------------- */

static void take_line(tui_app *app, sweep_state *s, const char *line) {
    sweep_line said;
    if (!sweep_line_read(line, &said) || said.count != s->count) {
        snprintf(s->said, sizeof s->said, "%s", line);
        return;
    }
    s->cells[said.run].known = true;
    s->cells[said.run].last = said;
    read_value(app, s, &s->cells[said.run]);
}

static status start_child(tui_app *app, sweep_state *s, bool list, const char *jobs, report *r) {
    char *arguments[12] = {(char *)"sunder", (char *)"sweep", s->scripts[s->script]};
    int count = 3;
    arguments[count++] = (char *)"--lines";
    if (list) arguments[count++] = (char *)"--list";
    if (!list) arguments[count++] = (char *)"-j", arguments[count++] = (char *)jobs;
    if (app->database[0]) arguments[count++] = (char *)"--db", arguments[count++] = app->database;
    child_close(&s->child);
    status code = child_start(&s->child, arguments, r);
    s->listing = code == STATUS_OK && list;
    s->going = code == STATUS_OK && !list;
    s->said[0] = '\0';
    app->dirty = true;
    return code;
}

static void tick_sweep(tui_app *app, void *state, double now) {
    sweep_state *s = state;
    char line[CHILD_LINE];
    (void)now;
    if (!s->going && !s->listing) return;
    for (int i = 0; i < 16 && child_line(&s->child, line); i++) {
        take_line(app, s, line);
        app->dirty = true;
    }
    if (!s->child.ended || s->child.used > 0) return;
    if (s->child.exit_code == 2) app_notice(app, "%s", s->said);
    else if (s->going) app_notice(app, "The sweep has ended%s", s->child.exit_code == 0 ? "" : s->child.exit_code == 130 ? ": stopped" : ": some runs failed");
    for (int i = 0; i < s->count; i++)
        if (s->cells[i].last.state == SWEEP_GOING) s->cells[i].last.state = SWEEP_WAITING;
    s->going = s->listing = false;
    app->dirty = true;
}

/* ---- actions ----------------------------------------------------------------------------------------------------- */

static status load(tui_app *app, sweep_state *s, report *r) {
    static script_reports reports;
    forget_plan(s);
    if (sweep_load(s->scripts[s->script], &s->plan, &reports) != STATUS_OK) {
        *r = reports.items[0];
        return r->code;
    }
    s->count = sweep_count(&s->plan);
    s->cells = memory_allocate_array((size_t)s->count, sizeof *s->cells);
    if (!s->cells) return report_set(r, STATUS_SYSTEM, "out of memory for %d runs", s->count);
    for (int i = 0; i < s->count; i++) s->cells[i].value = NAN;
    s->axis[0] = s->plan.axis_count > 1 ? 0 : -1;
    s->axis[1] = s->plan.axis_count > 1 ? 1 : 0;
    s->loaded = true;
    return start_child(app, s, true, NULL, r);
}

/* The script under the cursor, or the one at hand whose path ends so. */
static status open_script(tui_app *app, const char *argument, report *r) {
    sweep_state *s = state_of(app);
    if (s->going) return report_set(r, STATUS_INPUT, "A sweep is going on: S stops it.");
    size_t length = strlen(argument);
    bool found = length == 0;
    for (int i = 0; i < s->script_count && length > 0 && !found; i++) {
        size_t whole = strlen(s->scripts[i]);
        found = whole >= length && strcmp(s->scripts[i] + whole - length, argument) == 0;
        if (found) s->script = i;
    }
    if (!found && s->script_count < SWEEPS_SCRIPTS) {
        add_script(s, argument);
        s->script = s->script_count - 1;
    }
    if (s->script_count == 0) return report_set(r, STATUS_INPUT, "There is no sweep at hand: Lua files in sweeps/ beside scenes.");
    app_log_argument(app, "%s", s->scripts[s->script]);
    return load(app, s, r);
}

/* What is under the cursor: a script, or of a grid a run's frames. The log has what that was. */
static status choose(tui_app *app, const char *argument, report *r) {
    sweep_state *s = state_of(app);
    if (!s->loaded || argument[0]) return app_do(app, "sweep.open", argument, r);
    int run = sweep_run_at(s, s->at[0], s->at[1]);
    if (run < 0 || !s->cells[run].last.id[0]) return report_set(r, STATUS_INPUT, "There is no run here yet.");
    app_show(app, &screen_runs);
    return app_do(app, "runs.open", s->cells[run].last.id, r);
}

static status run_sweep(tui_app *app, const char *argument, report *r) {
    sweep_state *s = state_of(app);
    char jobs[16];
    if (!s->loaded) return report_set(r, STATUS_INPUT, "Choose a sweep with enter first.");
    if (s->going) return report_set(r, STATUS_INPUT, "It is going on already: S stops it.");
    long wanted = argument[0] ? atol(argument) : 1;
    if (wanted < 1 || wanted > 64) return report_input(r, NULL, 0, "jobs", "from 1 to 64 runs at a time", argument, NULL);
    snprintf(jobs, sizeof jobs, "%ld", wanted);
    return start_child(app, s, false, jobs, r);
}

static status stop_sweep(tui_app *app, const char *argument, report *r) {
    sweep_state *s = state_of(app);
    (void)argument;
    if (!s->going) return report_set(r, STATUS_INPUT, "No sweep is going on.");
    child_stop(&s->child);
    app_notice(app, "stopping: runs end after their frame");
    return STATUS_OK;
}

typedef struct names {
    char list[256][SWEEPS_NAME];
    int count;
} names;

static void take_name(void *context, const char *name) {
    names *n = context;
    if (n->count < 256) snprintf(n->list[n->count++], SWEEPS_NAME, "%s", name);
}

static status choose_measure(tui_app *app, const char *argument, report *r) {
    sweep_state *s = state_of(app);
    static names known;
    known.count = 0;
    status code = s->l ? STATUS_OK : app_open_ledger(app, &s->l, r);
    if (code == STATUS_OK && argument[0]) code = ledger_check_measure(s->l, argument, r);
    if (code == STATUS_OK) code = ledger_each_measure(s->l, take_name, &known, r);
    if (code != STATUS_OK) return code;
    int now = -1;
    for (int i = 0; i < known.count; i++)
        if (strcmp(known.list[i], s->measure) == 0) now = i;
    if (argument[0]) snprintf(s->measure, sizeof s->measure, "%s", argument);
    else if (known.count > 0) memcpy(s->measure, known.list[(now + 1) % known.count], sizeof s->measure);
    read_values(app, s);
    app_log_argument(app, "%s", s->measure);
    return STATUS_OK;
}

/* Another pair of axes: every axis across in turn, then every one down. */
static status turn_axes(tui_app *app, const char *argument, report *r) {
    sweep_state *s = state_of(app);
    int n = s->plan.axis_count;
    (void)argument;
    if (!s->loaded || n < 2) return report_set(r, STATUS_INPUT, "There is no other pair of axes.");
    do {
        s->axis[1] = (s->axis[1] + 1) % n;
        if (s->axis[1] == 0) s->axis[0] = (s->axis[0] + 1) % n;
    } while (s->axis[0] == s->axis[1]);
    memset(s->at, 0, sizeof s->at);
    app->dirty = true;
    return STATUS_OK;
}

/* The next combination of the axes that are not shown. */
static status next_slice(tui_app *app, const char *argument, report *r) {
    sweep_state *s = state_of(app);
    (void)argument;
    if (!s->loaded || s->plan.axis_count < 3) return report_set(r, STATUS_INPUT, "All axes are shown.");
    for (int a = s->plan.axis_count - 1; a >= 0; a--) {
        if (a == s->axis[0] || a == s->axis[1]) continue;
        s->held[a] = (s->held[a] + 1) % s->plan.axes[a].count;
        if (s->held[a] != 0) break;
    }
    app->dirty = true;
    return STATUS_OK;
}

static status move_by(tui_app *app, int down, int across) {
    sweep_state *s = state_of(app);
    app->dirty = true;
    if (!s->loaded) {
        s->script = cursor_within(s->script + down, s->script_count);
        return STATUS_OK;
    }
    const int by[2] = {down, across};
    for (int k = 0; k < 2; k++) {
        int to = s->at[k] + by[k];
        if (to >= 0 && to < sweep_extent(s, k)) s->at[k] = to;
    }
    return STATUS_OK;
}

static status go_up(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    return move_by(app, -1, 0);
}

static status go_down(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    return move_by(app, 1, 0);
}

static status go_left(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    return move_by(app, 0, -1);
}

static status go_right(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    return move_by(app, 0, 1);
}

static status go_back(tui_app *app, const char *argument, report *r) {
    sweep_state *s = state_of(app);
    (void)argument;
    if (s->going) return report_set(r, STATUS_INPUT, "A sweep is going on: S stops it.");
    forget_plan(s);
    app->dirty = true;
    return STATUS_OK;
}

static bool complete_script(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    sweep_state *s = state_of(app);
    for (int i = 0; i < s->script_count; i++)
        if (complete_word(s->scripts[i], text, &index, out)) return true;
    return false;
}

static const tui_action actions[] = {
    {"up", {KEY_UP, 'k'}, "up", NULL, "the sweep, or the value, above", .handler = go_up, .unlogged = true},
    {"down", {KEY_DOWN, 'j'}, "down", NULL, "the sweep, or the value, below", .handler = go_down, .unlogged = true},
    {"left", {KEY_LEFT, 'h'}, "left", NULL, "the value to the left", .handler = go_left, .unlogged = true},
    {"right", {KEY_RIGHT, 'l'}, "right", NULL, "the value to the right", .handler = go_right, .unlogged = true},
    {"choose", {'\r', '\n', KEY_ENTER}, "enter", "open", "open the sweep; of a grid: the run's frames", .handler = choose, .argument = ARGUMENT_MAY, .asks = "FILE.lua",
     .complete = complete_script, .unlogged = true},
    {"open", {0}, ":", NULL, "open a sweep", .handler = open_script, .argument = ARGUMENT_MAY, .asks = "FILE.lua", .complete = complete_script},
    {"run", {'r'}, "r", "run", "make the runs that are missing, so many at a time", .handler = run_sweep, .argument = ARGUMENT_MAY, .asks = "jobs"},
    {"stop", {'S'}, "S", "stop", "stop it: what is done stays", .handler = stop_sweep},
    {"measure", {'m'}, "m", "measure", "show the next measure of the runs' last frames", .handler = choose_measure, .argument = ARGUMENT_MAY, .asks = "MEASURE"},
    {"axes", {'a'}, "a", "axes", "show another pair of parameters", .handler = turn_axes},
    {"slice", {'n'}, "n", NULL, "the next values of the parameters that are not shown", .handler = next_slice},
    {"back", {27, KEY_BACKSPACE, 127}, "Esc", "list", "back to the list of sweeps", .handler = go_back},
};

/* ---- the screen -------------------------------------------------------------------------------------------------- */

static status open_sweep(tui_app *app, void **state, report *r) {
    (void)app;
    sweep_state *s = *state = memory_allocate(sizeof *s);
    if (!s) return report_set(r, STATUS_SYSTEM, "out of memory for the Sweep screen");
    s->child.fd = -1;
    snprintf(s->measure, sizeof s->measure, "broken_fraction");
    find_scripts(s);
    return STATUS_OK;
}

static void close_sweep(tui_app *app, void *state) {
    sweep_state *s = state;
    (void)app;
    forget_plan(s);
    ledger_close(s->l);
    memory_free(s, sizeof *s);
}

static void enter_sweep(tui_app *app, void *state) {
    sweep_state *s = state;
    if (!s->loaded) find_scripts(s);
    app->dirty = true;
}

const tui_screen screen_sweep = {
    .name = "sweep",
    .title = "Sweep",
    .help = "a scene over lists of values, and what came of it",
    .actions = actions,
    .action_count = sizeof actions / sizeof *actions,
    .open = open_sweep,
    .close = close_sweep,
    .enter = enter_sweep,
    .tick = tick_sweep,
    .draw = sweep_draw,
};
