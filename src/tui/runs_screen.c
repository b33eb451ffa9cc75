/* The Runs screen: what the ledger remembers, as a table that is filtered, sorted and marked. */
#include "tui/runs.h"

#include "base/clock.h"
#include "base/memory.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

static const double look_time = 1; /* s between two looks at whether the ledger has changed */

runs_state *runs_state_of(tui_app *app) {
    report unused;
    return screen_state(app, &screen_runs, &unused);
}

/* ---- which runs -------------------------------------------------------------------------------------------------- */

/* The run under the cursor; NULL when there is none. */
static const char *chosen_run(const runs_state *s) {
    return s->table && s->cursor < s->row_count ? run_table_id(s->table, s->rows[s->cursor]) : NULL;
}

status runs_named(tui_app *app, runs_state *s, const char *argument, char id[LEDGER_ID], char folder[1024], report *r) {
    (void)app;
    const char *name = argument[0] ? argument : s->page == RUNS_TABLE || s->shown_count == 0 ? chosen_run(s) : s->shown[0];
    if (!s->l) return report_set(r, STATUS_INPUT, "%s", s->trouble);
    if (!name) return report_set(r, STATUS_INPUT, "There is no run here.");
    return ledger_resolve(s->l, name, id, folder, 1024, r);
}

static int find_mark(const runs_state *s, const char *id) {
    for (int i = 0; i < s->mark_count; i++)
        if (strcmp(s->marks[i], id) == 0) return i;
    return -1;
}

bool runs_is_marked(const runs_state *s, const char *id) {
    return find_mark(s, id) >= 0;
}

status runs_choose_shown(runs_state *s, int least, report *r) {
    const char *chosen = chosen_run(s);
    if (s->mark_count >= least) {
        memcpy(s->shown, s->marks, sizeof s->shown);
        s->shown_count = s->mark_count;
        return STATUS_OK;
    }
    if (least > 1) return report_set(r, STATUS_INPUT, "Mark two runs or more with space first.");
    if (!chosen) return report_set(r, STATUS_INPUT, "There is no run here.");
    snprintf(s->shown[0], LEDGER_ID, "%s", chosen);
    s->shown_count = 1;
    return STATUS_OK;
}

/* ---- the table --------------------------------------------------------------------------------------------------- */

/* Applies filter and sorting to the table as it is. */
static status arrange(runs_state *s, report *r) {
    char kept[LEDGER_ID] = "";
    if (!s->table) return report_set(r, STATUS_INPUT, "%s", s->trouble);
    if (chosen_run(s)) snprintf(kept, sizeof kept, "%s", chosen_run(s));
    status code = run_table_filter(s->table, s->filter, s->rows, &s->row_count, r);
    if (code == STATUS_OK && s->sort[0]) code = run_table_sort(s->table, s->sort, s->descending, s->rows, s->row_count, r);
    if (code != STATUS_OK) return code;
    int row = kept[0] ? run_table_find(s->table, kept) : -1;
    for (int i = 0; i < s->row_count && row >= 0; i++)
        if (s->rows[i] == row) s->cursor = i;
    if (s->cursor >= s->row_count) s->cursor = s->row_count > 0 ? s->row_count - 1 : 0;
    return STATUS_OK;
}

static bool reserve_rows(runs_state *s, int count) {
    if (count <= s->row_capacity) return true;
    int *rows = memory_allocate_array((size_t)count + 64, sizeof *rows);
    if (!rows) return false;
    if (s->row_count > 0) memcpy(rows, s->rows, (size_t)s->row_count * sizeof *rows);
    memory_free(s->rows, (size_t)s->row_capacity * sizeof *s->rows);
    s->rows = rows;
    s->row_capacity = count + 64;
    return true;
}

static status read_table(tui_app *app, runs_state *s, report *r) {
    run_table *fresh;
    char kept[LEDGER_ID] = "";
    status code = s->l ? STATUS_OK : app_open_ledger(app, &s->l, r);
    if (code == STATUS_OK) code = run_table_read(s->l, &fresh, r);
    if (code != STATUS_OK) return code;
    if (chosen_run(s)) snprintf(kept, sizeof kept, "%s", chosen_run(s));
    if (!reserve_rows(s, run_table_rows(fresh))) {
        run_table_free(fresh);
        return report_set(r, STATUS_SYSTEM, "out of memory for the table of runs");
    }
    run_table_free(s->table);
    s->table = fresh;
    int row = kept[0] ? run_table_find(fresh, kept) : -1; /* the old order's cursor, by name */
    s->row_count = 0;
    code = arrange(s, r);
    if (code == STATUS_INPUT) { /* a filter by a column that is gone */
        s->filter[0] = s->sort[0] = '\0';
        code = arrange(s, r);
    }
    for (int i = 0; i < s->row_count && row >= 0; i++)
        if (s->rows[i] == row) s->cursor = i;
    return code;
}

void runs_reload(tui_app *app, runs_state *s, bool force) {
    report r;
    double now = clock_seconds();
    if (!force && (now < s->next_look || (s->table && !run_table_is_old(s->table)))) return;
    if (read_table(app, s, &r) != STATUS_OK) report_format(&r, s->trouble, sizeof s->trouble);
    /* A ledger of very many runs is read less often: this must not take the screen's time. */
    double took = clock_seconds() - now;
    s->next_look = now + (20 * took > look_time ? 20 * took : look_time);
    for (int i = s->mark_count - 1; i >= 0 && s->table; i--) {
        if (run_table_find(s->table, s->marks[i]) >= 0) continue;
        memmove(s->marks[i], s->marks[i + 1], (size_t)(s->mark_count - i - 1) * sizeof s->marks[0]);
        s->mark_count--;
    }
    if (s->page == RUNS_PLOT) (void)runs_read_curves(s, &r);
    app->dirty = true;
}

/* ---- moving ------------------------------------------------------------------------------------------------------ */

static void move_cursor(tui_app *app, int by) {
    runs_state *s = runs_state_of(app);
    int *at = s->page == RUNS_DETAIL ? &s->line_top : &s->cursor;
    int count = s->page == RUNS_DETAIL ? s->line_count : s->row_count;
    *at = by > 0 && *at > count - 1 - by ? count - 1 : *at + by;
    if (*at < 0) *at = 0;
    app->dirty = true;
}

status runs_up(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    move_cursor(app, -1);
    return STATUS_OK;
}

status runs_down(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    move_cursor(app, 1);
    return STATUS_OK;
}

static int page_of(tui_app *app) {
    int rows = runs_state_of(app)->page_rows;
    return rows > 1 ? rows - 1 : 1;
}

status runs_page_up(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    move_cursor(app, -page_of(app));
    return STATUS_OK;
}

status runs_page_down(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    move_cursor(app, page_of(app));
    return STATUS_OK;
}

status runs_home(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    (void)argument;
    if (s->page == RUNS_PLAYER) return runs_show_frame(app, s, 0, r);
    move_cursor(app, -1000000000);
    return STATUS_OK;
}

status runs_end(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    (void)argument;
    if (s->page == RUNS_PLAYER) return runs_show_frame(app, s, INT64_MAX, r);
    move_cursor(app, 1000000000);
    return STATUS_OK;
}

static status sideways(tui_app *app, int by, report *r) {
    runs_state *s = runs_state_of(app);
    if (s->page == RUNS_PLAYER) return runs_show_further(app, s, by, r);
    s->column = cursor_within(s->column + by, s->column_count);
    app->dirty = true;
    return STATUS_OK;
}

status runs_left(tui_app *app, const char *argument, report *r) {
    (void)argument;
    return sideways(app, -1, r);
}

status runs_right(tui_app *app, const char *argument, report *r) {
    (void)argument;
    return sideways(app, 1, r);
}

status runs_back(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    (void)argument, (void)r;
    s->page = RUNS_TABLE;
    s->playing = false;
    app->dirty = true;
    return STATUS_OK;
}

/* Puts the cursor on a run. */
status runs_choose(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    char id[LEDGER_ID], folder[1024];
    status code = runs_named(app, s, argument, id, folder, r);
    if (code != STATUS_OK) return code;
    if (!s->table || run_table_find(s->table, id) < 0) runs_reload(app, s, true); /* one that is newer than the table */
    int row = s->table ? run_table_find(s->table, id) : -1, at = -1;
    for (int i = 0; i < s->row_count; i++)
        if (s->rows[i] == row) at = i;
    if (row < 0 || at < 0) return report_set(r, STATUS_INPUT, "%s is not among the runs that are shown: A shows all.", id);
    s->cursor = at;
    app_log_argument(app, "%s", id);
    app->dirty = true;
    return STATUS_OK;
}

static bool cursor_of_runs(const tui_app *app, const void *state, char *action, size_t size) {
    const runs_state *s = state;
    const char *chosen = chosen_run(s);
    (void)app;
    if (s->page != RUNS_TABLE || !chosen) return false;
    snprintf(action, size, "choose %s", chosen);
    return true;
}

/* ---- filter, order, columns, marks ------------------------------------------------------------------------------- */

status runs_filter(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    char before[sizeof s->filter];
    memcpy(before, s->filter, sizeof before);
    snprintf(s->filter, sizeof s->filter, "%s", argument);
    status code = arrange(s, r);
    if (code != STATUS_OK) {
        memcpy(s->filter, before, sizeof before);
        report unused;
        (void)arrange(s, &unused);
        return code;
    }
    s->page = RUNS_TABLE;
    app_notice(app, "%d of %d runs", s->row_count, run_table_rows(s->table));
    return STATUS_OK;
}

status runs_show_all(tui_app *app, const char *argument, report *r) {
    (void)argument;
    return runs_filter(app, "", r);
}

/* sort: by the column under the cursor, the other way round when it is sorted by already; "NAME" ascending, "-NAME" descending. */
status runs_sort(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    char name[RUNS_NAME];
    bool descending = argument[0] == '-';
    snprintf(name, sizeof name, "%s", argument[0] ? argument + descending : s->column_count ? s->columns[s->column] : "");
    if (!argument[0]) descending = strcmp(name, s->sort) == 0 && !s->descending;
    const run_column *c = NULL;
    if (!s->table) return report_set(r, STATUS_INPUT, "%s", s->trouble);
    status code = name[0] ? run_table_column(s->table, name, &c, r) : STATUS_OK;
    if (code != STATUS_OK) return code;
    snprintf(s->sort, sizeof s->sort, "%s", name[0] ? c->name : "");
    s->descending = descending;
    app_log_argument(app, "%s%s", descending ? "-" : "", name);
    app->dirty = true;
    return arrange(s, r);
}

static int find_column(const runs_state *s, const char *name) {
    for (int i = 0; i < s->column_count; i++)
        if (strcmp(s->columns[i], name) == 0) return i;
    return -1;
}

static void remove_column(runs_state *s, int at) {
    memmove(s->columns[at], s->columns[at + 1], (size_t)(s->column_count - at - 1) * sizeof s->columns[0]);
    s->column_count--;
    if (s->column >= s->column_count && s->column > 0) s->column--;
}

static status toggle_column(runs_state *s, const char *name, report *r) {
    const run_column *c;
    status code = run_table_column(s->table, name, &c, r);
    if (code != STATUS_OK) return code;
    int at = find_column(s, c->name);
    if (at >= 0) {
        if (s->column_count > 1) remove_column(s, at);
        return STATUS_OK;
    }
    if (s->column_count == RUNS_COLUMNS) return report_input(r, NULL, 0, name, "at most 24 columns", "one more", NULL);
    snprintf(s->columns[s->column_count++], RUNS_NAME, "%s", c->name);
    s->column = s->column_count - 1;
    return STATUS_OK;
}

/* columns: names that are there are taken away, others are added. */
status runs_columns(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    status code = s->table ? STATUS_OK : report_set(r, STATUS_INPUT, "%s", s->trouble);
    for (const char *at = argument; *at && code == STATUS_OK;) {
        char name[RUNS_NAME];
        size_t length = strcspn(at, " ,");
        snprintf(name, sizeof name, "%.*s", (int)(length < RUNS_NAME ? length : RUNS_NAME - 1), at);
        if (length > 0) code = toggle_column(s, name, r);
        at += length;
        at += strspn(at, " ,");
    }
    s->page = RUNS_TABLE;
    app->dirty = true;
    return code;
}

status runs_drop_column(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    int at = argument[0] ? find_column(s, argument) : s->column;
    if (at < 0) return report_input(r, NULL, 0, "drop-column", "a column that is shown", argument, s->columns[0]);
    if (s->column_count < 2) return report_set(r, STATUS_INPUT, "The last column stays.");
    app_log_argument(app, "%s", s->columns[at]);
    remove_column(s, at);
    app->dirty = true;
    return STATUS_OK;
}

/* Marks a run or takes its mark away, and goes on to the next; in the player it plays and halts. */
status runs_mark(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    char id[LEDGER_ID], folder[1024];
    app->dirty = true;
    if (s->page == RUNS_PLAYER && !argument[0]) {
        s->playing = !s->playing;
        s->next_frame = clock_seconds();
        app_log_nothing(app);
        return STATUS_OK;
    }
    status code = runs_named(app, s, argument, id, folder, r);
    if (code != STATUS_OK) return code;
    int at = find_mark(s, id);
    if (at < 0 && s->mark_count == RUNS_MARKS) return report_set(r, STATUS_INPUT, "At most %d runs are marked at a time: u takes all marks away.", (int)RUNS_MARKS);
    if (at < 0) snprintf(s->marks[s->mark_count++], LEDGER_ID, "%s", id);
    else {
        memmove(s->marks[at], s->marks[at + 1], (size_t)(s->mark_count - at - 1) * sizeof s->marks[0]);
        s->mark_count--;
    }
    app_log_argument(app, "%s", id);
    if (!argument[0] && s->page == RUNS_TABLE) move_cursor(app, 1);
    return STATUS_OK;
}

status runs_unmark(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    runs_state_of(app)->mark_count = 0;
    app->dirty = true;
    return STATUS_OK;
}

/* ---- completion -------------------------------------------------------------------------------------------------- */

/* The index-th name that begins with the last word of `text`; the words before it stay. */
static bool complete_name(runs_state *s, const char *text, int index, bool parameters, bool measures, bool own, char out[ACTION_ARGUMENT]) {
    const char *space = strrchr(text, ' '), *word = space ? space + 1 : text, *name;
    run_column_kind kind;
    for (int i = 0; s->table && (name = run_table_name(s->table, i, &kind)); i++) {
        bool wanted = kind == RUN_COLUMN_OWN ? own : kind == RUN_COLUMN_PARAMETER ? parameters : measures;
        const char *dot = strrchr(name, '.');
        bool begins = strncmp(name, word, strlen(word)) == 0 || (dot && strncmp(dot + 1, word, strlen(word)) == 0);
        if (!wanted || !begins || index-- > 0) continue;
        snprintf(out, ACTION_ARGUMENT, "%.*s%s", (int)(word - text), text, name);
        return true;
    }
    return false;
}

bool runs_complete_column(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    return complete_name(runs_state_of(app), text, index, true, true, true, out);
}

bool runs_complete_measure(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    return complete_name(runs_state_of(app), text, index, false, true, false, out);
}

bool runs_complete_parameter(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    return complete_name(runs_state_of(app), text, index, true, false, false, out);
}

bool runs_complete_run(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    const runs_state *s = runs_state_of(app);
    for (int i = 0; i < s->row_count; i++) {
        const char *id = run_table_id(s->table, s->rows[i]);
        if (complete_word(id, text, &index, out)) return true;
    }
    return false;
}

/* ---- the screen -------------------------------------------------------------------------------------------------- */

static const tui_action actions[] = {
    {"up", {KEY_UP}, "up", NULL, "the run above", .handler = runs_up, .unlogged = true},
    {"down", {KEY_DOWN}, "down", NULL, "the run below", .handler = runs_down, .unlogged = true},
    {"page-up", {KEY_PPAGE}, "PgUp", NULL, "a page up", .handler = runs_page_up, .unlogged = true},
    {"page-down", {KEY_NPAGE}, "PgDn", NULL, "a page down", .handler = runs_page_down, .unlogged = true},
    {"home", {KEY_HOME, '<'}, "<  Home", NULL, "the first run; of frames, the first", .handler = runs_home, .unlogged = true},
    {"end", {KEY_END, '>'}, ">  End", NULL, "the last run; of frames, the last", .handler = runs_end, .unlogged = true},
    {"left", {KEY_LEFT}, "left", NULL, "the column before; of frames, the one before", .handler = runs_left, .unlogged = true},
    {"right", {KEY_RIGHT}, "right", NULL, "the next column; of frames, the next", .handler = runs_right, .unlogged = true},
    {"choose", {0}, ":", NULL, "put the cursor on a run", .handler = runs_choose, .argument = ARGUMENT_TEXT, .asks = "RUN", .complete = runs_complete_run},
    {"open", {'\r', '\n', KEY_ENTER}, "enter", "frames", "look at the run's frames", .handler = runs_open, .argument = ARGUMENT_MAY, .asks = "RUN",
     .complete = runs_complete_run},
    {"mark", {' '}, "space", "mark", "mark the run, or not; of frames, play and halt", .handler = runs_mark, .argument = ARGUMENT_MAY, .asks = "RUN",
     .complete = runs_complete_run},
    {"unmark", {'u'}, "u", NULL, "take all marks away", .handler = runs_unmark},
    {"filter", {'/'}, "/", "filter", "show runs that fit: words, and conditions as eta<0.1 status=done title~tube !tags~old", .handler = runs_filter,
     .argument = ARGUMENT_TEXT, .asks = "WORDS CONDITIONS", .complete = runs_complete_column},
    {"all", {'A'}, "A", NULL, "show all runs again", .handler = runs_show_all},
    {"sort", {'s'}, "s", "sort", "sort by this column, again: the other way round", .handler = runs_sort, .argument = ARGUMENT_MAY, .asks = "[-]COLUMN",
     .complete = runs_complete_column},
    {"columns", {'c'}, "c", "columns", "add columns, or take them away, by name: parameters and measures too", .handler = runs_columns,
     .argument = ARGUMENT_TEXT, .asks = "NAME…", .complete = runs_complete_column},
    {"drop-column", {'x'}, "x", NULL, "take this column away", .handler = runs_drop_column, .argument = ARGUMENT_MAY, .asks = "COLUMN"},
    {"diff", {'d'}, "d", "differ", "what differs between the marked runs", .handler = runs_diff},
    {"beside", {'b'}, "b", NULL, "two marked runs beside each other, frame by frame", .handler = runs_beside},
    {"detail", {'i'}, "i", "all", "all that is known of the run", .handler = runs_detail, .here = true, .argument = ARGUMENT_MAY, .asks = "RUN", .complete = runs_complete_run},
    {"plot", {'p'}, "p", "plot", "a measure of the marked runs over time", .handler = runs_plot, .here = true, .argument = ARGUMENT_MAY, .asks = "MEASURE",
     .complete = runs_complete_measure},
    {"measure", {'m'}, "m", NULL, "plot the next measure", .handler = runs_next_measure, .argument = ARGUMENT_MAY, .asks = "back"},
    {"against", {'v'}, "v", NULL, "plot against a parameter, over all runs that are shown; time for time", .handler = runs_against,
     .argument = ARGUMENT_TEXT, .asks = "PARAMETER", .complete = runs_complete_parameter},
    {"logarithmic", {'n'}, "n", NULL, "plot logarithmically, or not", .handler = runs_logarithmic},
    {"tag", {'T'}, "T", "tag", "tag the marked runs, or this one; -TAG takes it away", .handler = runs_tag, .here = true, .argument = ARGUMENT_TEXT, .asks = "[-]TAG"},
    {"note", {'N'}, "N", NULL, "write a remark about the run", .handler = runs_note, .here = true, .argument = ARGUMENT_TEXT, .asks = "TEXT"},
    {"reproduce", {'R'}, "R", NULL, "run it again, and compare the bits", .handler = runs_reproduce, .argument = ARGUMENT_MAY, .asks = "RUN",
     .complete = runs_complete_run},
    {"delete", {'D', KEY_DC}, "D", NULL, "take the run and its frames away (asks first)", .handler = runs_delete, .unlogged = true},
    {"delete-now", {0}, "", NULL, "take a run and its frames away", .handler = runs_delete_now, .argument = ARGUMENT_TEXT, .asks = "RUN", .complete = runs_complete_run},
    {"frame", {'f'}, "f", NULL, "go to a frame", .handler = runs_frame, .argument = ARGUMENT_NUMBER, .asks = "frame"},
    {"colour", {'w'}, "w", NULL, "colour frames by the next quantity", .handler = runs_colour, .argument = ARGUMENT_MAY, .asks = "quantity"},
    {"turn-left", {'h'}, "h", NULL, "of frames: turn the camera to the left", .handler = runs_turn_left},
    {"turn-right", {'l'}, "l", NULL, "of frames: turn the camera to the right", .handler = runs_turn_right},
    {"tilt-up", {'k'}, "k", NULL, "of frames: look from higher up", .handler = runs_tilt_up},
    {"tilt-down", {'j'}, "j", NULL, "of frames: look from lower down", .handler = runs_tilt_down},
    {"zoom-in", {'+', '='}, "+", NULL, "of frames: closer", .handler = runs_zoom_in},
    {"zoom-out", {'-', '_'}, "-", NULL, "of frames: further away", .handler = runs_zoom_out},
    {"reset", {'0'}, "0", NULL, "of frames: the camera as it was", .handler = runs_reset},
    {"back", {27, KEY_BACKSPACE, 127}, "Esc", "table", "back to the table", .handler = runs_back},
};

static status open_runs(tui_app *app, void **state, report *r) {
    static const char *const columns[] = {"id", "status", "title", "variant", "frames", "particles", "started", "wall_s", "tags"};
    runs_state *s = *state = memory_allocate(sizeof *s);
    if (!s) return report_set(r, STATUS_SYSTEM, "out of memory for the Runs screen");
    for (size_t i = 0; i < sizeof columns / sizeof *columns; i++) snprintf(s->columns[s->column_count++], RUNS_NAME, "%s", columns[i]);
    snprintf(s->measure, sizeof s->measure, "broken_fraction");
    view_mode mode = app->theme.ascii ? VIEW_ASCII : app->options.mode == TUI_AUTO ? VIEW_BRAILLE : (view_mode)app->options.mode;
    particle_view_open(&s->view, mode);
    runs_reload(app, s, true);
    return STATUS_OK;
}

static void close_runs(tui_app *app, void *state) {
    runs_state *s = state;
    (void)app;
    frame_reader_close(s->reader);
    particle_view_close(&s->view);
    for (int i = 0; i < RUNS_MARKS; i++) run_curve_free(&s->curves[i]);
    run_table_free(s->table);
    ledger_close(s->l);
    memory_free(s->rows, (size_t)s->row_capacity * sizeof *s->rows);
    if (s->lines) memory_free(s->lines, RUNS_LINES * sizeof *s->lines);
    memory_free(s, sizeof *s);
}

static void enter_runs(tui_app *app, void *state) {
    runs_reload(app, state, ((runs_state *)state)->table == NULL);
}

static void tick_runs(tui_app *app, void *state, double now) {
    runs_state *s = state;
    runs_tick_reproduction(app, s);
    if (app->screen != &screen_runs) return;
    runs_tick_player(app, s, now);
    if (s->page == RUNS_TABLE || s->page == RUNS_PLOT) runs_reload(app, s, false);
}

/* The key line of the pages other than the table. */
static const char *hint_of_runs(const void *state, const tui_action *action) {
    static const struct {
        runs_page page;
        const char *action, *word;
    } words[] = {
        {RUNS_PLAYER, "mark", "play"}, {RUNS_PLAYER, "right", "frame"}, {RUNS_PLAYER, "home", "first"}, {RUNS_PLAYER, "end", "last"},
        {RUNS_PLAYER, "colour", "colour"}, {RUNS_PLAYER, "back", "table"}, {RUNS_PLOT, "measure", "measure"}, {RUNS_PLOT, "against", "against"},
        {RUNS_PLOT, "logarithmic", "log"}, {RUNS_PLOT, "back", "table"}, {RUNS_DETAIL, "down", "scroll"}, {RUNS_DETAIL, "open", "frames"},
        {RUNS_DETAIL, "tag", "tag"}, {RUNS_DETAIL, "note", "note"}, {RUNS_DETAIL, "back", "table"},
    };
    const runs_state *s = state;
    if (s->page == RUNS_TABLE) return strcmp(action->name, "back") == 0 ? NULL : action->hint;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (words[i].page == s->page && strcmp(words[i].action, action->name) == 0) return words[i].word;
    return NULL;
}

static void mouse_runs(tui_app *app, void *state, tui_area area, int row, int column, int wheel) {
    runs_state *s = state;
    (void)area, (void)column;
    if (s->page == RUNS_PLAYER) {
        report unused;
        if (wheel) (void)app_do(app, wheel < 0 ? "runs.zoom-in" : "runs.zoom-out", "", &unused);
    } else if (wheel) move_cursor(app, wheel);
    else if (s->page == RUNS_TABLE && row >= 2 && s->top + row - 2 < s->row_count) s->cursor = s->top + row - 2;
    app->dirty = true;
}

const tui_screen screen_runs = {
    .name = "runs",
    .title = "Runs",
    .help = "past runs: compare, plot, look at their frames, run again",
    .actions = actions,
    .action_count = sizeof actions / sizeof *actions,
    .open = open_runs,
    .close = close_runs,
    .enter = enter_runs,
    .tick = tick_runs,
    .cursor = cursor_of_runs,
    .hint = hint_of_runs,
    .draw = runs_draw,
    .mouse = mouse_runs,
};
