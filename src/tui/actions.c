#include "tui/actions.h"

#include <stddef.h>

static const float turn = 0.1309f; /* rad a key press: 7.5° */

/* ---- the run ----------------------------------------------------------------------------------------------------- */

static void pause_run(tui_app *app, int argument) {
    (void)argument;
    if (app->ended) {
        app_notice(app, "The run has ended.");
        return;
    }
    bool pausing = app->shot->state != SESSION_PAUSED;
    session_pause(app->run, pausing);
    app_notice(app, pausing ? "Pausing after this frame." : "Going on.");
}

static void step_run(tui_app *app, int argument) {
    (void)argument;
    if (app->ended) {
        app_notice(app, "The run has ended.");
    } else if (app->shot->state != SESSION_PAUSED) {
        session_pause(app->run, true);
        app_notice(app, "Pausing after this frame; s again computes one frame at a time.");
    } else {
        session_step_once(app->run);
        app_notice(app, "One frame.");
    }
}

static void stop_run(tui_app *app) {
    app->leave_at_end = true;
    if (app->stopping) return;
    app->stopping = true;
    session_stop(app->run);
}

static void abandon_run(tui_app *app) {
    app->leave_at_end = app->stopping = app->abandoned = true;
    session_abandon(app->run);
}

static void quit(tui_app *app, int argument) {
    (void)argument;
    if (app->ended) {
        app->leaving = true;
    } else {
        app->asking = !app->stopping;
    }
}

static void leave(tui_app *app, int argument) {
    (void)argument;
    if (!app->ended) abandon_run(app);
    app->leaving = true;
}

void actions_interrupt(tui_app *app) {
    if (app->ended) {
        app->leaving = true;
    } else if (app->stopping) {
        abandon_run(app);
    } else {
        stop_run(app);
    }
    app->asking = false;
    app->dirty = true;
}

void actions_terminate(tui_app *app) {
    if (app->ended) {
        app->leaving = true;
    } else {
        stop_run(app);
    }
    app->dirty = true;
}

/* ---- what is seen ------------------------------------------------------------------------------------------------ */

static void turn_camera(tui_app *app, int direction) {
    view_camera_orbit(&app->camera, turn * (float)direction, 0);
    app->picture_old = true;
}

static void tilt_camera(tui_app *app, int direction) {
    view_camera_orbit(&app->camera, 0, turn * (float)direction);
    app->picture_old = true;
}

static void zoom_camera(tui_app *app, int direction) {
    view_camera_zoom(&app->camera, direction > 0 ? 1.25f : 0.8f);
    app->picture_old = true;
}

static void reset_camera(tui_app *app, int argument) {
    (void)argument;
    app->camera = view_camera_default();
    view_camera_fit(&app->camera, app->fit_minimum, app->fit_maximum);
    app->spinning = false;
    app->picture_old = true;
}

static void spin_camera(tui_app *app, int argument) {
    (void)argument;
    app->spinning = !app->spinning;
    app_notice(app, app->spinning ? "The camera turns by itself; a stops it." : "The camera stands still.");
}

static void change_mode(tui_app *app, int argument) {
    (void)argument;
    do {
        app->mode = (view_mode)((app->mode + 1) % VIEW_MODES);
    } while (app->theme.ascii && app->mode != VIEW_ASCII);
    app->picture_old = true;
    if (app->theme.ascii) {
        app_notice(app, "Only ASCII: the locale's character set is not UTF-8.");
    } else {
        app_notice(app, "Particles as %s.", view_mode_name(app->mode));
    }
}

static void change_palette(tui_app *app, int argument) {
    (void)argument;
    app->theme.palette = (view_palette)((app->theme.palette + 1) % VIEW_PALETTES);
    app->picture_old = true;
    app_notice(app, app->theme.colours ? "Colours: %s." : "Colours: %s, but this terminal shows none.",
               view_palette_name(app->theme.palette));
}

static void change_theme(tui_app *app, int argument) {
    (void)argument;
    theme_choose(&app->theme, (tui_theme_kind)((app->theme.kind + 1) % TUI_THEMES));
    app->picture_old = true;
    clearok(curscr, TRUE);
    app_notice(app, "Theme: %s.", theme_name(app->theme.kind));
}

static void change_histogram(tui_app *app, int argument) {
    (void)argument;
    app->log_histogram = !app->log_histogram;
    app_notice(app, app->log_histogram ? "Histogram: logarithmic." : "Histogram: linear.");
}

static void open_page(tui_app *app, int page) {
    app->page = app->page == (tui_page)page ? PAGE_RUN : (tui_page)page;
    app->scroll = 0;
    app->at_end = true;
    app->notice[0] = '\0';
}

static void redraw(tui_app *app, int argument) {
    (void)argument;
    clearok(curscr, TRUE);
    app->picture_old = true;
}

/* ---- the table --------------------------------------------------------------------------------------------------- */

static const tui_action table[] = {
    {"pause", {' '}, "space", "pause", "pause the run after its frame, or go on", pause_run, 0},
    {"step", {'s', '.'}, "s  .", "step", "while paused: compute one frame", step_run, 0},
    {"quit", {'q'}, "q", "quit", "stop after this frame (asks first), or leave", quit, 0},
    {"leave", {'Q'}, "Q", NULL, "leave at once; whole frames are kept", leave, 0},
    {"help", {'?', KEY_F(1)}, "?  F1", "help", "this page", open_page, PAGE_HELP},
    {"log", {'g'}, "g", NULL, "what libraries have printed", open_page, PAGE_LOG},
    {"turn-left", {'h', KEY_LEFT}, "h  left", NULL, "turn the camera to the left", turn_camera, -1},
    {"turn-right", {'l', KEY_RIGHT}, "l  right", NULL, "turn the camera to the right", turn_camera, 1},
    {"tilt-up", {'k', KEY_UP}, "k  up", NULL, "look from higher up", tilt_camera, 1},
    {"tilt-down", {'j', KEY_DOWN}, "j  down", NULL, "look from lower down", tilt_camera, -1},
    {"zoom-in", {'+', '='}, "+", NULL, "closer", zoom_camera, 1},
    {"zoom-out", {'-', '_'}, "-", NULL, "further away", zoom_camera, -1},
    {"reset", {'0'}, "0", NULL, "the camera as it was at the start", reset_camera, 0},
    {"spin", {'a'}, "a", "spin", "let the camera turn by itself", spin_camera, 0},
    {"mode", {'m'}, "m", "mode", "particles as braille, blocks or ASCII", change_mode, 0},
    {"colours", {'c'}, "c", "colours", "the next colour map", change_palette, 0},
    {"theme", {'t'}, "t", "theme", "dark, light or colour-blind", change_theme, 0},
    {"histogram", {'L'}, "L", "log", "histogram linear or logarithmic", change_histogram, 0},
    {"redraw", {'L' - '@'}, "Ctrl-L", NULL, "draw the screen anew", redraw, 0},
};

const tui_action *tui_actions(int *count) {
    *count = (int)(sizeof table / sizeof *table);
    return table;
}

static bool answer(tui_app *app, int key) {
    app->asking = false;
    if (key == 'q' || key == 'y' || key == 'Y') {
        stop_run(app);
        return true;
    }
    /* Any other key is a no, except that leaving at once is a stronger yes. */
    return key != 'Q';
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
    case 'q': app->page = PAGE_RUN; return true;
    default: return false;
    }
}

void actions_press(tui_app *app, int key) {
    app->dirty = true;
    if (app->asking && answer(app, key)) return;
    if (app->page != PAGE_RUN && scroll_page(app, key)) return;
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        for (int k = 0; k < ACTION_KEYS; k++) {
            if (table[i].keys[k] != 0 && table[i].keys[k] == key) {
                table[i].handler(app, table[i].argument);
                return;
            }
        }
    }
}
