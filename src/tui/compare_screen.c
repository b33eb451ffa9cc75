/* The Compare screen: two runs at the same frame, with the same colours and camera, and how their histograms differ. */
#include "tui/compare.h"

#include "base/clock.h"
#include "base/memory.h"

#include <ctype.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CACHE_BYTES = 96 << 20 };
static const double play_time = 0.1; /* s a frame */

static compare_state *state_of(tui_app *app) {
    report unused;
    return screen_state(app, &screen_compare, &unused);
}

/* ---- which runs -------------------------------------------------------------------------------------------------- */

static status take_id(void *context, const ledger_cell *cells, int count, report *r) {
    compare_state *state = context;
    (void)count, (void)r;
    if (state->run_count < COMPARE_RUNS && cells[0].text) snprintf(state->runs[state->run_count++], LEDGER_ID, "%s", cells[0].text);
    return STATUS_OK;
}

static void find_runs(tui_app *app, compare_state *state) {
    report unused;
    ledger *l = NULL;
    state->run_count = 0;
    if (app_open_ledger(app, &l, &unused) == STATUS_OK)
        (void)ledger_each_row(l, "SELECT id FROM runs ORDER BY started DESC LIMIT 100", NULL, 0, take_id, state, &unused);
    if (l) ledger_close(l);
}

/* All candidates are asked for, one after the other: the ledger is read at the first. */
static bool complete_run(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    compare_state *state = state_of(app);
    if (index == 0) find_runs(app, state);
    for (int i = 0; i < state->run_count; i++)
        if (complete_word(state->runs[i], text, &index, out)) return true;
    return false;
}

static status choose(tui_app *app, int side, const char *run, report *r) {
    compare_state *state = state_of(app);
    status s = compare_choose(app, state, side, run, r);
    if (s == STATUS_OK) app_log_argument(app, "%s", state->sides[side].id);
    return s;
}

static status choose_left(tui_app *app, const char *argument, report *r) {
    return choose(app, 0, argument, r);
}

static status choose_right(tui_app *app, const char *argument, report *r) {
    return choose(app, 1, argument, r);
}

/* The run in view on the right; on the left what it is a branch of. */
static status choose_branch(tui_app *app, const char *argument, report *r) {
    (void)argument;
    if (!app->run) return report_set(r, STATUS_INPUT, "There is no run; A and B choose runs of the ledger.");
    compare_state *state = state_of(app);
    if (!app->shot->parent[0]) return report_set(r, STATUS_INPUT, "This run is no branch; A chooses what to compare it with.");
    status s = compare_choose(app, state, 1, app->shot->run_id, r);
    return s == STATUS_OK ? compare_choose(app, state, 0, app->shot->parent, r) : s;
}

static status swap(tui_app *app, const char *argument, report *r) {
    (void)argument;
    compare_state *state = state_of(app);
    char ids[COMPARE_SIDES][LEDGER_ID];
    for (int i = 0; i < COMPARE_SIDES; i++) memcpy(ids[i], state->sides[i].id, LEDGER_ID);
    if (!ids[0][0] || !ids[1][0]) return report_set(r, STATUS_INPUT, "There are no two runs; A and B choose them.");
    status s = compare_choose(app, state, 0, ids[1], r);
    return s == STATUS_OK ? compare_choose(app, state, 1, ids[0], r) : s;
}

/* ---- which frame ------------------------------------------------------------------------------------------------- */

static status show_frame(tui_app *app, int64_t frame, report *r) {
    compare_state *state = state_of(app);
    int64_t first, last;
    if (!state->sides[0].id[0] && !state->sides[1].id[0]) return report_set(r, STATUS_INPUT, "There are no frames; A and B choose runs.");
    if (compare_range(state, &first, &last)) frame = frame < first ? first : frame > last ? last : frame;
    state->follows = false;
    state->frame = frame < 0 ? 0 : frame;
    state->stale = true;
    app_log_argument(app, "%" PRId64, state->frame);
    return STATUS_OK;
}

static status by_frames(tui_app *app, const char *argument, int by, report *r) {
    if (argument[0]) return show_frame(app, atoll(argument), r);
    return show_frame(app, state_of(app)->frame + by, r);
}

static status next_frame(tui_app *app, const char *argument, report *r) {
    return by_frames(app, argument, 1, r);
}

static status previous_frame(tui_app *app, const char *argument, report *r) {
    return by_frames(app, argument, -1, r);
}

static status many_on(tui_app *app, const char *argument, report *r) {
    return by_frames(app, argument, 10, r);
}

static status many_back(tui_app *app, const char *argument, report *r) {
    return by_frames(app, argument, -10, r);
}

static status first_frame(tui_app *app, const char *argument, report *r) {
    (void)argument;
    return show_frame(app, 0, r);
}

static status last_frame(tui_app *app, const char *argument, report *r) {
    (void)argument;
    status s = show_frame(app, INT64_MAX, r);
    if (s == STATUS_OK) state_of(app)->follows = true;
    return s;
}

static status go_to_frame(tui_app *app, const char *argument, report *r) {
    char *end;
    double number = strtod(argument, &end);
    if (end == argument || number < 0 || number != floor(number))
        return report_input(r, NULL, 0, "frame", "the number of a frame", argument, NULL);
    return show_frame(app, (int64_t)fmin(number, 1e15), r);
}

static status play(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    compare_state *state = state_of(app);
    int64_t first, last;
    state->plays = !state->plays;
    state->next = clock_seconds() + play_time;
    if (state->plays && compare_range(state, &first, &last) && state->frame >= last) state->frame = first, state->stale = true;
    app_notice(app, state->plays ? "Playing; space stops." : "Stopped.");
    return STATUS_OK;
}

/* ---- what is seen ------------------------------------------------------------------------------------------------ */

static status act(tui_app *app, const char *verb, const char *argument, report *r) {
    compare_state *state = state_of(app);
    char text[96];
    status s = particle_view_act(&state->sides[0].view, verb, argument, text, r);
    particle_view_match(&state->sides[1].view, &state->sides[0].view);
    if (s == STATUS_OK && text[0]) app_notice(app, "%s", text);
    return s;
}

#define COMPARE_VIEW(name, verb)                                                                                                           \
    static status name(tui_app *app, const char *argument, report *r) {                                                                    \
        return act(app, verb, argument, r);                                                                                                \
    }
COMPARE_VIEW(turn_left, "turn-left")
COMPARE_VIEW(turn_right, "turn-right")
COMPARE_VIEW(tilt_up, "tilt-up")
COMPARE_VIEW(tilt_down, "tilt-down")
COMPARE_VIEW(zoom_in, "zoom-in")
COMPARE_VIEW(zoom_out, "zoom-out")
COMPARE_VIEW(look, "look")
COMPARE_VIEW(cut, "cut")
COMPARE_VIEW(cut_in, "cut-in")
COMPARE_VIEW(cut_out, "cut-out")
COMPARE_VIEW(cut_flip, "cut-flip")
COMPARE_VIEW(reset, "reset")
COMPARE_VIEW(set_scale, "scale")
#undef COMPARE_VIEW

static status change_mode(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    particle_view *view = &state_of(app)->sides[0].view;
    if (app->theme.ascii) return report_set(r, STATUS_INPUT, "Only ASCII: the locale's character set is not UTF-8.");
    view->mode = (view_mode)((view->mode + 1) % VIEW_MODES);
    particle_view_match(&state_of(app)->sides[1].view, view);
    view->old = true;
    app_notice(app, "Particles as %s.", view_mode_name(view->mode));
    return STATUS_OK;
}

/* A run whose quantities are known; NULL while there is none. */
static const frame_page *any_page(const compare_state *state) {
    for (int i = 0; i < COMPARE_SIDES; i++) {
        const frame_page *page = compare_page(&state->sides[i]);
        if (page && page->field_count > 0) return page;
    }
    return NULL;
}

static bool complete_colour(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]) {
    const frame_page *page = any_page(state_of(app));
    for (int i = 0; page && i < page->field_count; i++)
        if (complete_word(page->fields[i], text, &index, out)) return true;
    return false;
}

static status change_colour(tui_app *app, const char *argument, report *r) {
    compare_state *state = state_of(app);
    const frame_page *page = any_page(state);
    if (!page && !argument[0]) return report_set(r, STATUS_INPUT, "There are no frames yet; A and B choose runs.");
    if (page && argument[0] && !frame_page_has(page, argument))
        return report_input(r, NULL, 0, "colour", "a quantity of these runs", argument, page->fields[0]);
    int next = 0;
    for (int i = 0; page && i < page->field_count; i++)
        if (strcmp(page->fields[i], state->colour) == 0) next = (i + 1) % page->field_count;
    snprintf(state->colour, sizeof state->colour, "%.31s", argument[0] || !page ? argument : page->fields[next]);
    state->scale = (view_scale){0, 0};
    state->stale = true;
    app_log_argument(app, "%s", state->colour);
    app_notice(app, "Coloured by %s.", state->colour);
    return STATUS_OK;
}

static status change_histogram(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    compare_state *state = state_of(app);
    state->log_histogram = !state->log_histogram;
    app_notice(app, state->log_histogram ? "Histogram: logarithmic." : "Histogram: linear.");
    return STATUS_OK;
}

static const tui_action actions[] = {
    {"left", {'A'}, "A", "left", "choose the run on the left", .handler = choose_left, .argument = ARGUMENT_TEXT, .asks = "RUN", .complete = complete_run},
    {"right", {'B'}, "B", "right", "choose the run on the right", .handler = choose_right, .argument = ARGUMENT_TEXT, .asks = "RUN", .complete = complete_run},
    {"branch", {'b'}, "b", "branch", "the run in view beside the one that it is a branch of", .handler = choose_branch},
    {"swap", {'w'}, "w", NULL, "left to right and right to left", .handler = swap},
    {"play", {' '}, "space", "play", "let the frames go on by themselves", .handler = play},
    {"next", {KEY_RIGHT, '.'}, "right", "frame", "the next frame", .handler = next_frame, .argument = ARGUMENT_MAY, .asks = "frame"},
    {"previous", {KEY_LEFT, ','}, "left", NULL, "the frame before", .handler = previous_frame, .argument = ARGUMENT_MAY, .asks = "frame"},
    {"on", {KEY_NPAGE, KEY_DOWN}, "PgDn", NULL, "ten frames on", .handler = many_on, .argument = ARGUMENT_MAY, .asks = "frame"},
    {"back", {KEY_PPAGE, KEY_UP}, "PgUp", NULL, "ten frames back", .handler = many_back, .argument = ARGUMENT_MAY, .asks = "frame"},
    {"first", {KEY_HOME, '['}, "home", NULL, "the first frame", .handler = first_frame},
    {"last", {KEY_END, ']'}, "end", NULL, "the last frame that both have, and those that come", .handler = last_frame},
    {"frame", {'r'}, "r", NULL, "go to a frame", .handler = go_to_frame, .argument = ARGUMENT_NUMBER, .asks = "frame"},
    {"colour", {'v'}, "v", "colour", "colour by the next quantity", .handler = change_colour, .argument = ARGUMENT_MAY, .asks = "field", .complete = complete_colour},
    {"scale", {0}, ":", NULL, "what the colours run over", .handler = set_scale, .argument = ARGUMENT_MAY, .asks = "LOW HIGH|auto"},
    {"histogram", {'n'}, "n", "log", "histograms linear or logarithmic", .handler = change_histogram},
    {"turn-left", {'h'}, "h", NULL, "turn the camera to the left", .handler = turn_left},
    {"turn-right", {'l'}, "l", NULL, "turn the camera to the right", .handler = turn_right},
    {"tilt-up", {'k'}, "k", NULL, "look from higher up", .handler = tilt_up},
    {"tilt-down", {'j'}, "j", NULL, "look from lower down", .handler = tilt_down},
    {"zoom-in", {'+', '='}, "+", NULL, "closer", .handler = zoom_in},
    {"zoom-out", {'-', '_'}, "-", NULL, "further away", .handler = zoom_out},
    {"look", {'i'}, "i", NULL, "look from the corner, the front, the side, the top", .handler = look, .argument = ARGUMENT_MAY, .asks = "corner|front|side|top"},
    {"reset", {'0'}, "0", NULL, "the camera as it was at the start", .handler = reset},
    {"cut", {'x'}, "x", "cut", "cut the bodies open across x, y, z, or not", .handler = cut, .argument = ARGUMENT_MAY, .asks = "x|y|z|off"},
    {"cut-in", {'('}, "(", NULL, "move the cut down its axis", .handler = cut_in},
    {"cut-out", {')'}, ")", NULL, "move the cut up its axis", .handler = cut_out},
    {"cut-flip", {'X'}, "X", NULL, "leave out the other side of the cut", .handler = cut_flip},
    {"mode", {'m'}, "m", NULL, "particles as braille, blocks or ASCII", .handler = change_mode},
};

/* ---- the screen -------------------------------------------------------------------------------------------------- */

static void wake(void *context) {
    app_wake(context);
}

static void close_compare(tui_app *app, void *own) {
    compare_state *state = own;
    (void)app;
    for (int i = 0; i < COMPARE_SIDES; i++) {
        frame_reader_close(state->sides[i].reader);
        particle_view_close(&state->sides[i].view);
    }
    memory_free(state, sizeof *state);
}

static status open_compare(tui_app *app, void **own, report *r) {
    compare_state *state = *own = memory_allocate(sizeof *state);
    if (!state) return report_set(r, STATUS_SYSTEM, "out of memory for the Compare screen");
    const char *term = getenv("TERM");
    view_mode finest = term && strcmp(term, "linux") == 0 ? VIEW_HALF : VIEW_BRAILLE;
    view_mode mode = app->theme.ascii ? VIEW_ASCII : app->options.mode == TUI_AUTO ? finest : (view_mode)app->options.mode;
    status s = STATUS_OK;
    for (int i = 0; i < COMPARE_SIDES; i++) {
        particle_view_open(&state->sides[i].view, mode);
        if (s == STATUS_OK) s = frame_reader_open(CACHE_BYTES, wake, app, &state->sides[i].reader, r);
    }
    state->follows = true;
    if (s == STATUS_OK) return s;
    close_compare(app, state);
    *own = NULL;
    return s;
}

/* When nothing was chosen: the run in view, and beside it what it is a branch of. */
static void enter_compare(tui_app *app, void *own) {
    compare_state *state = own;
    report unused;
    state->stale = true;
    if (!app->run || state->sides[0].id[0] || state->sides[1].id[0]) return;
    (void)compare_choose(app, state, 1, app->shot->run_id, &unused);
    (void)compare_choose(app, state, 0, app->shot->parent[0] ? app->shot->parent : app->shot->run_id, &unused);
}

/* The run in view has a new frame: a side that shows it looks for it. */
static void follow_compare(tui_app *app, void *own, bool fresh) {
    compare_state *state = own;
    (void)fresh;
    for (int i = 0; i < COMPARE_SIDES; i++) {
        compare_side *side = &state->sides[i];
        if (app->run && strcmp(side->id, app->shot->run_id) == 0) side->grown = state->stale = true;
    }
}

static bool is_reading(compare_state *state) {
    return frame_reader_busy(state->sides[0].reader) || frame_reader_busy(state->sides[1].reader);
}

static void tick_compare(tui_app *app, void *own, double now) {
    compare_state *state = own;
    int64_t first, last;
    if (app->screen != &screen_compare) return;
    if (compare_take(state)) app->dirty = true;
    if (state->plays && now >= state->next && !is_reading(state) && compare_range(state, &first, &last)) {
        state->next = now + play_time;
        if (state->frame >= last) state->plays = false;
        else state->frame++, state->stale = true;
        app->dirty = true;
    }
    compare_ask(state);
}

const tui_screen screen_compare = {
    .name = "compare",
    .title = "Compare",
    .help = "two runs side by side, and how they differ",
    .actions = actions,
    .action_count = sizeof actions / sizeof *actions,
    .open = open_compare,
    .close = close_compare,
    .enter = enter_compare,
    .follow = follow_compare,
    .tick = tick_compare,
    .draw = compare_draw,
};
