/* The Run screen: the particles, the run's figures, its knobs, and the line of its frames. */
#include "tui/run.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float spin_speed = 0.5f;    /* rad/s */
static const double spin_time = 1. / 30; /* s between two turns of the camera */

run_state *run_state_of(tui_app *app) {
    report unused;
    return screen_state(app, &screen_run, &unused);
}

status run_needed(const tui_app *app, report *r) {
    if (!app->run) return report_set(r, STATUS_INPUT, "There is no run: start one on the screen Scenes (F2).");
    if (app->ended) return report_set(r, STATUS_INPUT, "The run has ended. b goes on from a checkpoint, R starts again.");
    return STATUS_OK;
}

particle_points run_points(const tui_app *app) {
    const session_snapshot *s = app->shot;
    return (particle_points){.position = s->position,
                             .scalar = s->scalar,
                             .count = s->point_count,
                             .name = s->colour,
                             .unit = s->colour_unit,
                             .natural = {(double)s->colour_minimum, (double)s->colour_maximum}};
}

static const tui_action actions[] = {
    {"pause", {' '}, "space", "pause", "pause the run after its frame, or go on", .handler = run_pause, .argument = ARGUMENT_MAY, .asks = "on|off", .paces = true},
    {"step", {'s'}, "s", "step", "while paused: compute one frame", .handler = run_step, .paces = true},
    {"panel", {'p'}, "p", "panel", "what the panel shows: numbers, damage, knobs, time, events", .handler = run_next_panel, .argument = ARGUMENT_MAY, .asks = "panel",
     .complete = run_complete_panel},
    {"knob-more", {KEY_RIGHT}, "right", "turn", "turn the knob up", .handler = run_knob_more, .argument = ARGUMENT_MAY, .asks = "KNOB=VALUE"},
    {"knob-up", {KEY_UP}, "up", NULL, "the knob above", .handler = run_knob_up, .unlogged = true},
    {"knob-down", {KEY_DOWN}, "down", NULL, "the knob below", .handler = run_knob_down, .unlogged = true},
    {"knob-less", {KEY_LEFT}, "left", NULL, "turn the knob down", .handler = run_knob_less, .argument = ARGUMENT_MAY, .asks = "KNOB=VALUE"},
    {"knob-more-fine", {'.', '>', KEY_SRIGHT}, ".  >", NULL, "turn the knob up a little", .handler = run_knob_more_fine, .argument = ARGUMENT_MAY, .asks = "KNOB=VALUE"},
    {"knob-less-fine", {',', '<', KEY_SLEFT}, ",  <", NULL, "turn the knob down a little", .handler = run_knob_less_fine, .argument = ARGUMENT_MAY, .asks = "KNOB=VALUE"},
    {"knob-type", {'\r', '\n', KEY_ENTER}, "enter", NULL, "type a value for the knob", .handler = run_knob_type, .unlogged = true},
    {"turn", {0}, ":", NULL, "turn a knob to a value", .handler = run_turn, .argument = ARGUMENT_TEXT, .asks = "KNOB=VALUE", .complete = run_complete_knob},
    {"knob", {'/'}, "/", NULL, "find a knob by its name", .handler = run_knob_find, .argument = ARGUMENT_TEXT, .asks = "KNOB", .complete = run_complete_knob, .unlogged = true},
    {"knob-other", {'o'}, "o", NULL, "the twin that says the same, or a vector's next component", .handler = run_knob_other, .unlogged = true},
    {"knob-page-up", {KEY_PPAGE}, "PgUp", NULL, "ten knobs up", .handler = run_knob_page_up, .unlogged = true},
    {"knob-page-down", {KEY_NPAGE}, "PgDn", NULL, "ten knobs down", .handler = run_knob_page_down, .unlogged = true},
    {"branch", {'b'}, "b", "branch", "go on from the chosen frame as a run of its own", .handler = run_branch, .argument = ARGUMENT_MAY, .asks = "frame",
     .complete = run_complete_checkpoint},
    {"colour", {'v'}, "v", "colour", "colour by the next field: damage, stress, speed …", .handler = run_colour, .argument = ARGUMENT_MAY, .asks = "field",
     .complete = run_complete_colour},
    {"undo", {'u'}, "u", "undo", "undo the last turn", .handler = run_undo},
    {"redo", {'U'}, "U", NULL, "do the turn again that was undone", .handler = run_redo},
    {"knob-reset", {KEY_BACKSPACE, 127, KEY_DC}, "del", NULL, "the knob as the recipe has it", .handler = run_reset_knob, .argument = ARGUMENT_MAY, .asks = "KNOB",
     .complete = run_complete_knob},
    {"knobs-reset", {'Z'}, "Z", NULL, "all knobs as the recipe has them", .handler = run_reset_knobs},
    {"save-recipe", {'w'}, "w", "save", "write a tuned material as a recipe", .handler = run_save_recipe, .argument = ARGUMENT_MAY, .asks = "[MATERIAL] FILE[.lua]",
     .complete = run_complete_material},
    {"run-to", {'r'}, "r", NULL, "go on to a frame and pause there", .handler = run_go_to, .argument = ARGUMENT_NUMBER, .asks = "frame", .paces = true},
    {"earlier", {'['}, "[", "past", "choose an earlier checkpoint on the line of frames", .handler = run_choose_earlier, .unlogged = true},
    {"later", {']'}, "]", NULL, "choose a later checkpoint", .handler = run_choose_later, .unlogged = true},
    {"choose", {0}, ":", NULL, "choose a frame on the line of frames", .handler = run_choose, .argument = ARGUMENT_NUMBER, .asks = "frame",
     .complete = run_complete_checkpoint, .unlogged = true},
    {"restart", {'R'}, "R", NULL, "run again from the start with all knobs as they are now", .handler = run_restart, .argument = ARGUMENT_MAY, .asks = "yes"},
    {"stop", {'S'}, "S", NULL, "stop the run after this frame, and stay", .handler = run_stop},
    {"whole", {'z'}, "z", NULL, "the panel over the whole screen, and back", .handler = run_whole},
    {"scale", {0}, ":", NULL, "what the colours run over", .handler = run_scale, .argument = ARGUMENT_MAY, .asks = "LOW HIGH|auto"},
    {"turn-left", {'h'}, "h", NULL, "turn the camera to the left", .handler = run_turn_left},
    {"turn-right", {'l'}, "l", NULL, "turn the camera to the right", .handler = run_turn_right},
    {"tilt-up", {'k'}, "k", NULL, "look from higher up", .handler = run_tilt_up},
    {"tilt-down", {'j'}, "j", NULL, "look from lower down", .handler = run_tilt_down},
    {"zoom-in", {'+', '='}, "+", NULL, "closer", .handler = run_zoom_in},
    {"zoom-out", {'-', '_'}, "-", NULL, "further away", .handler = run_zoom_out},
    {"pan-left", {'H'}, "H", NULL, "move the picture to the left", .handler = run_pan_left},
    {"pan-right", {'L'}, "L", NULL, "move the picture to the right", .handler = run_pan_right},
    {"pan-up", {'K'}, "K", NULL, "move the picture up", .handler = run_pan_up},
    {"pan-down", {'J'}, "J", NULL, "move the picture down", .handler = run_pan_down},
    {"look", {'i'}, "i", NULL, "look from the corner, the front, the side, the top", .handler = run_look, .argument = ARGUMENT_MAY, .asks = "corner|front|side|top"},
    {"reset", {'0'}, "0", NULL, "the camera as it was at the start", .handler = run_reset_camera},
    {"spin", {'a'}, "a", NULL, "let the camera turn by itself", .handler = run_spin},
    {"cut", {'x'}, "x", NULL, "cut the body open across x, y, z, or not", .handler = run_cut, .argument = ARGUMENT_MAY, .asks = "x|y|z|off"},
    {"cut-in", {'('}, "(", NULL, "move the cut down its axis", .handler = run_cut_in},
    {"cut-out", {')'}, ")", NULL, "move the cut up its axis", .handler = run_cut_out},
    {"cut-flip", {'X'}, "X", NULL, "leave out the other side of the cut", .handler = run_cut_flip},
    {"mode", {'m'}, "m", NULL, "particles as braille, blocks or ASCII", .handler = run_mode},
    {"colours", {'c'}, "c", NULL, "the next colour map", .handler = run_palette},
    {"histogram", {'n'}, "n", NULL, "histogram linear or logarithmic", .handler = run_histogram},
};

/* ---- the screen -------------------------------------------------------------------------------------------------- */

static view_mode finest_mode(void) {
    const char *name = getenv("TERM");
    /* The Linux console's fonts have blocks but no braille. */
    return name && strcmp(name, "linux") == 0 ? VIEW_HALF : VIEW_BRAILLE;
}

static void close_run(tui_app *app, void *state) {
    (void)app;
    run_state *own = state;
    particle_view_close(&own->view);
    knob_panel_close(&own->knobs);
    memory_free(own, sizeof *own);
}

static status open_run(tui_app *app, void **state, report *r) {
    run_state *own = *state = memory_allocate(sizeof *own);
    if (!own) return report_set(r, STATUS_SYSTEM, "out of memory for the Run screen");
    status s = knob_panel_open(&own->knobs, r);
    if (s != STATUS_OK) {
        close_run(app, own);
        *state = NULL;
        return s;
    }
    view_mode mode = app->theme.ascii ? VIEW_ASCII : app->options.mode == TUI_AUTO ? finest_mode() : (view_mode)app->options.mode;
    particle_view_open(&own->view, mode);
    own->log_histogram = app->options.log_histogram;
    own->knob_version = -1;
    own->chosen = -1;
    return STATUS_OK;
}

static void follow_run(tui_app *app, void *state, bool fresh) {
    run_state *own = state;
    if (fresh) {
        /* A branch is the same body: the camera stays, the box is fitted anew. */
        particle_view_forget(&own->view);
        knob_panel_forget(&own->knobs);
        own->knob_version = -1;
        own->pending_count = 0;
        own->chosen = -1;
        own->colour[0] = '\0';
        own->checkpoint_count = own->turn_count = 0;
    }
    if (!app->run) return;
    particle_points points = run_points(app);
    particle_view_follow(&own->view, &points, app->shot->bounds_minimum, app->shot->bounds_maximum);
    run_knobs_follow(app, own);
    int count = session_checkpoints(app->run, own->checkpoints, RUN_CHECKPOINTS);
    own->checkpoint_count = count < RUN_CHECKPOINTS ? count : RUN_CHECKPOINTS;
    count = session_turns(app->run, own->turns, RUN_TURNS);
    own->turn_count = count < RUN_TURNS ? count : RUN_TURNS;
}

static void tick_run(tui_app *app, void *state, double now) {
    run_state *own = state;
    if (!own->spinning || now - own->last_turn < spin_time) return;
    view_camera_orbit(&own->view.camera, spin_speed * (float)fmin(now - own->last_turn, 0.5), 0);
    own->last_turn = now;
    own->view.old = true;
    if (app->screen == &screen_run) app->dirty = true;
}

static bool inside(tui_area area, int y, int x) {
    return y >= area.y && y < area.y + area.height && x >= area.x && x < area.x + area.width;
}

/* A press on the line of frames chooses a frame, the wheel over the picture zooms, over the knobs it turns. */
static void mouse_run(tui_app *app, void *state, tui_area area, int row, int column, int wheel) {
    run_state *own = state;
    run_layout layout = run_lay_out(own, area);
    int y = area.y + row, x = area.x + column;
    report unused;
    if (wheel == 0 && inside(layout.timeline, y, x)) {
        timeline line = run_timeline(app, own);
        int64_t frame = timeline_frame_at(&line, layout.timeline, x - layout.timeline.x);
        char text[32];
        snprintf(text, sizeof text, "%lld", (long long)frame);
        if (frame >= 0) (void)app_do(app, "run.choose", text, &unused);
    } else if (wheel != 0 && inside(layout.picture, y, x)) {
        (void)app_do(app, wheel < 0 ? "run.zoom-in" : "run.zoom-out", "", &unused);
    } else if (wheel != 0) {
        (void)app_do(app, wheel < 0 ? "run.knob-up" : "run.knob-down", "", &unused);
    }
}

const tui_screen screen_run = {
    .name = "run",
    .title = "Run",
    .help = "the run: its particles, its figures, its knobs",
    .actions = actions,
    .action_count = sizeof actions / sizeof *actions,
    .open = open_run,
    .close = close_run,
    .follow = follow_run,
    .tick = tick_run,
    .draw = run_draw,
    .mouse = mouse_run,
};
