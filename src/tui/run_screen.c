/* The Run screen: the particles, the run's figures, what the run can be told. */
#include "tui/run.h"

#include "base/memory.h"
#include "tui/widgets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const float turn = 0.1309f;      /* rad a key press: 7.5° */
static const float spin_speed = 0.5f;   /* rad/s */
static const double spin_time = 1. / 30; /* s between two turns of the camera */

static run_state *view_of(tui_app *app) {
    report unused;
    return screen_state(app, &screen_run, &unused);
}

/* ---- the run ----------------------------------------------------------------------------------------------------- */

static status need_run(const tui_app *app, report *r) {
    if (!app->run) return report_set(r, STATUS_INPUT, "There is no run: start one on the screen Scenes (F2).");
    if (app->ended) return report_set(r, STATUS_INPUT, "The run has ended.");
    return STATUS_OK;
}

static status pause_run(tui_app *app, const char *argument, report *r) {
    status s = need_run(app, r);
    if (s != STATUS_OK) return s;
    bool pausing = argument[0] ? strcmp(argument, "off") != 0 : app->shot->state != SESSION_PAUSED;
    session_pause(app->run, pausing);
    app_log_argument(app, "%s", pausing ? "on" : "off");
    app_notice(app, pausing ? "Pausing after this frame." : "Going on.");
    return STATUS_OK;
}

static status step_run(tui_app *app, const char *argument, report *r) {
    (void)argument;
    status s = need_run(app, r);
    if (s != STATUS_OK) return s;
    if (app->shot->state != SESSION_PAUSED) {
        session_pause(app->run, true);
        app_notice(app, "Pausing after this frame; s again computes one frame at a time.");
    } else {
        session_step_once(app->run);
        app_notice(app, "One frame.");
    }
    return STATUS_OK;
}

/* ---- what is seen ------------------------------------------------------------------------------------------------ */

static status turn_camera(tui_app *app, const char *argument, report *r) {
    (void)r;
    run_state *view = view_of(app);
    view_camera_orbit(&view->camera, turn * (float)atof(argument), 0);
    view->picture_old = true;
    return STATUS_OK;
}

static status tilt_camera(tui_app *app, const char *argument, report *r) {
    (void)r;
    run_state *view = view_of(app);
    view_camera_orbit(&view->camera, 0, turn * (float)atof(argument));
    view->picture_old = true;
    return STATUS_OK;
}

static status zoom_camera(tui_app *app, const char *argument, report *r) {
    (void)r;
    run_state *view = view_of(app);
    view_camera_zoom(&view->camera, atof(argument) > 0 ? 1.25f : 0.8f);
    view->picture_old = true;
    return STATUS_OK;
}

static status reset_camera(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    run_state *view = view_of(app);
    view->camera = view_camera_default();
    view_camera_fit(&view->camera, view->fit_minimum, view->fit_maximum);
    view->spinning = false;
    view->picture_old = true;
    return STATUS_OK;
}

static status spin_camera(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    run_state *view = view_of(app);
    view->spinning = !view->spinning;
    view->last_turn = app_clock();
    app_notice(app, view->spinning ? "The camera turns by itself; a stops it." : "The camera stands still.");
    return STATUS_OK;
}

static status change_mode(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    run_state *view = view_of(app);
    do {
        view->mode = (view_mode)((view->mode + 1) % VIEW_MODES);
    } while (app->theme.ascii && view->mode != VIEW_ASCII);
    view->picture_old = true;
    if (app->theme.ascii) {
        app_notice(app, "Only ASCII: the locale's character set is not UTF-8.");
    } else {
        app_notice(app, "Particles as %s.", view_mode_name(view->mode));
    }
    return STATUS_OK;
}

static status change_palette(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    app->theme.palette = (view_palette)((app->theme.palette + 1) % VIEW_PALETTES);
    view_of(app)->picture_old = true;
    app_notice(app, app->theme.colours ? "Colours: %s." : "Colours: %s, but this terminal shows none.",
               view_palette_name(app->theme.palette));
    return STATUS_OK;
}

static status change_histogram(tui_app *app, const char *argument, report *r) {
    (void)argument, (void)r;
    run_state *view = view_of(app);
    view->log_histogram = !view->log_histogram;
    app_notice(app, view->log_histogram ? "Histogram: logarithmic." : "Histogram: linear.");
    return STATUS_OK;
}

static const tui_action actions[] = {
    {.name = "pause", .keys = {' '}, .keys_shown = "space", .hint = "pause", .help = "pause the run after its frame, or go on", .handler = pause_run,
     .argument = ARGUMENT_MAY, .asks = "on|off"},
    {.name = "step", .keys = {'s', '.'}, .keys_shown = "s  .", .hint = "step", .help = "while paused: compute one frame", .handler = step_run},
    {.name = "turn-left", .keys = {'h', KEY_LEFT}, .keys_shown = "h  left", .help = "turn the camera to the left", .handler = turn_camera,
     .argument = ARGUMENT_MAY, .asks = "STEPS", .preset = "-1"},
    {.name = "turn-right", .keys = {'l', KEY_RIGHT}, .keys_shown = "l  right", .help = "turn the camera to the right", .handler = turn_camera,
     .argument = ARGUMENT_MAY, .asks = "STEPS", .preset = "1"},
    {.name = "tilt-up", .keys = {'k', KEY_UP}, .keys_shown = "k  up", .help = "look from higher up", .handler = tilt_camera,
     .argument = ARGUMENT_MAY, .asks = "STEPS", .preset = "1"},
    {.name = "tilt-down", .keys = {'j', KEY_DOWN}, .keys_shown = "j  down", .help = "look from lower down", .handler = tilt_camera,
     .argument = ARGUMENT_MAY, .asks = "STEPS", .preset = "-1"},
    {.name = "zoom-in", .keys = {'+', '='}, .keys_shown = "+", .help = "closer", .handler = zoom_camera,
     .argument = ARGUMENT_MAY, .asks = "STEPS", .preset = "1"},
    {.name = "zoom-out", .keys = {'-', '_'}, .keys_shown = "-", .help = "further away", .handler = zoom_camera,
     .argument = ARGUMENT_MAY, .asks = "STEPS", .preset = "-1"},
    {.name = "reset", .keys = {'0'}, .keys_shown = "0", .help = "the camera as it was at the start", .handler = reset_camera},
    {.name = "spin", .keys = {'a'}, .keys_shown = "a", .hint = "spin", .help = "let the camera turn by itself", .handler = spin_camera},
    {.name = "mode", .keys = {'m'}, .keys_shown = "m", .hint = "mode", .help = "particles as braille, blocks or ASCII", .handler = change_mode},
    {.name = "colours", .keys = {'c'}, .keys_shown = "c", .hint = "colours", .help = "the next colour map", .handler = change_palette},
    {.name = "histogram", .keys = {'L'}, .keys_shown = "L", .hint = "log", .help = "histogram linear or logarithmic", .handler = change_histogram},
};

/* ---- the screen -------------------------------------------------------------------------------------------------- */

static view_mode finest_mode(void) {
    const char *name = getenv("TERM");
    /* The Linux console's fonts have blocks but no braille. */
    return name && strcmp(name, "linux") == 0 ? VIEW_HALF : VIEW_BRAILLE;
}

static status open_run(tui_app *app, void **state, report *r) {
    run_state *view = *state = memory_allocate(sizeof *view);
    if (!view) return report_set(r, STATUS_SYSTEM, "out of memory for the Run screen");
    view->mode = app->theme.ascii ? VIEW_ASCII : app->options.mode == TUI_AUTO ? finest_mode() : (view_mode)app->options.mode;
    view->camera = view_camera_default();
    view->log_histogram = app->options.log_histogram;
    view->picture_old = true;
    return STATUS_OK;
}

static void close_run(tui_app *app, void *state) {
    (void)app;
    run_state *view = state;
    memory_free(view->cells, view->cell_capacity * sizeof(view_cell));
    view_canvas_free(&view->canvas);
    memory_free(view, sizeof *view);
}

static void follow_run(tui_app *app, void *state, bool fresh) {
    run_state *view = state;
    if (fresh) view->fitted = false;
    particles_follow(app, view);
    view->picture_old = true;
}

static void tick_run(tui_app *app, void *state, double now) {
    run_state *view = state;
    if (!view->spinning || now - view->last_turn < spin_time) return;
    view_camera_orbit(&view->camera, spin_speed * (float)fmin(now - view->last_turn, 0.5), 0);
    view->last_turn = now;
    view->picture_old = true;
    if (app->screen == &screen_run) app->dirty = true;
}

enum { PANEL_BESIDE = 72, PANEL_NARROWEST = 36, PANEL_WIDEST = 60 };

/* The panel stands beside the picture where there is room for both, else it lies below. */
static void draw_run(tui_app *app, void *state, tui_area body) {
    run_state *view = state;
    if (body.width >= PANEL_BESIDE) {
        int panel = body.width * 3 / 10;
        panel = panel < PANEL_NARROWEST ? PANEL_NARROWEST : panel > PANEL_WIDEST ? PANEL_WIDEST : panel;
        tui_area picture = {body.y, body.x, body.height, body.width - panel - 3};
        tui_area side = {body.y, body.x + body.width - panel - 1, body.height, panel};
        for (int row = 0; row < body.height; row++) draw_text(&app->theme, body, row, picture.width, STYLE_DIM, "│");
        widget_particles(app, view, picture);
        widget_panel(app, view, side);
        return;
    }
    int strip = body.height >= 18 ? 13 : body.height >= 12 ? 7 : 3;
    tui_area picture = {body.y, body.x, body.height - strip, body.width};
    tui_area below = {body.y + picture.height, body.x + 1, strip, body.width - 2};
    widget_particles(app, view, picture);
    widget_strip(app, view, below);
}

const tui_screen screen_run = {
    .name = "run",
    .title = "Run",
    .help = "the run: its particles, its figures",
    .actions = actions,
    .action_count = sizeof actions / sizeof *actions,
    .open = open_run,
    .close = close_run,
    .follow = follow_run,
    .tick = tick_run,
    .draw = draw_run,
};
