#include "tui/tui.h"

#include "base/memory.h"
#include "tui/actions.h"
#include "tui/capture.h"
#include "tui/signals.h"
#include "tui/terminal.h"
#include "tui/widgets.h"

#include <errno.h>
#include <math.h>
#include <poll.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const double frame_time = 1.0 / 30; /* s; at most 30 redraws a second, and as many looks at the session */
static const double key_delay = 0.045;     /* s; the longest that a key's effect may wait for its redraw */
static const double load_share = 0.1;      /* of a core that drawing may take from the simulation */
static const double notice_time = 4;       /* s */
static const float spin_speed = 0.5f;      /* rad/s */
enum { KEYS_A_TURN = 256 };

tui_options tui_options_default(void) {
    return (tui_options){.theme = TUI_THEME_AUTO, .palette = TUI_AUTO, .mode = TUI_AUTO, .colours = TUI_AUTO};
}

double app_clock(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void app_notice(tui_app *app, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(app->notice, sizeof app->notice, format, arguments);
    va_end(arguments);
    app->notice_until = app_clock() + notice_time;
    app->dirty = true;
}

/* When things happen, in seconds of app_clock. */
typedef struct pace {
    double next_draw, last_turn; /* of the camera */
    bool hung_up;                /* the terminal is gone */
} pace;

/* ---- what comes in ----------------------------------------------------------------------------------------------- */

static void wait_for_input(const tui_app *app, pace *p) {
    double now = app_clock(), wait = app->ended ? 1.0 : frame_time;
    if (app->spinning) wait = fmin(wait, frame_time);
    if (app->notice[0]) wait = fmin(wait, app->notice_until - now);
    if (app->dirty) wait = fmin(wait, p->next_draw - now);
    struct pollfd inputs[2] = {{.fd = signals_descriptor(), .events = POLLIN},
                               {.fd = p->hung_up ? -1 : STDIN_FILENO, .events = POLLIN}};
    if (poll(inputs, 2, (int)ceil(fmax(wait, 0) * 1e3)) > 0 && (inputs[1].revents & (POLLHUP | POLLERR | POLLNVAL)))
        p->hung_up = true;
}

static void take_signals(tui_app *app) {
    char event;
    while (read(signals_descriptor(), &event, 1) == 1) {
        switch ((signal_event)event) {
        case SIGNAL_INTERRUPT: actions_interrupt(app); break;
        case SIGNAL_TERMINATE: actions_terminate(app); break;
        case SIGNAL_SUSPEND: terminal_suspend(); break;
        case SIGNAL_CONTINUE: terminal_retake(); break;
        case SIGNAL_RESIZE: terminal_resize(); break;
        }
        app->dirty = app->picture_old = true;
    }
}

static void take_keys(tui_app *app, pace *p) {
    if (p->hung_up) {
        actions_terminate(app);
        return;
    }
    for (int i = 0; i < KEYS_A_TURN && !app->leaving; i++) {
        int key = getch();
        if (key == ERR) return;
        if (key == KEY_RESIZE) {
            app->dirty = app->picture_old = true;
        } else {
            actions_press(app, key);
            p->next_draw = fmin(p->next_draw, app_clock() + key_delay);
        }
    }
}

static void take_state(tui_app *app) {
    /* Asked before polling: a session that has ended has published its last state. */
    bool ended = session_wait(app->run, 0);
    if (session_poll(app->run, app->shot)) {
        particles_follow(app);
        app->dirty = app->picture_old = true;
    }
    if (ended && !app->ended) {
        app->ended = app->dirty = true;
        app->asking = false;
    }
    if (app->ended && app->leave_at_end) app->leaving = true;
}

static void take_time(tui_app *app, pace *p) {
    double now = app_clock();
    if (app->notice[0] && now >= app->notice_until) {
        app->notice[0] = '\0';
        app->dirty = true;
    }
    if (app->spinning && now - p->last_turn >= frame_time) {
        view_camera_orbit(&app->camera, spin_speed * (float)fmin(now - p->last_turn, 0.5), 0);
        app->dirty = app->picture_old = true;
        p->last_turn = now;
    } else if (!app->spinning) {
        p->last_turn = now;
    }
    int64_t printed = capture_size();
    if (printed > app->printed && app->page != PAGE_LOG)
        app_notice(app, "A library has printed something; g shows it.");
    if (printed != app->printed) app->dirty = true;
    app->printed = printed;
}

static void draw_if_due(tui_app *app, pace *p) {
    double start = app_clock();
    if (!app->dirty || start < p->next_draw) return;
    app->dirty = false;
    screen_draw(app);
    double cost = app_clock() - start;
    p->next_draw = start + fmax(frame_time, cost / load_share);
}

static void loop(tui_app *app) {
    pace p = {.last_turn = app_clock()};
    app->dirty = true;
    while (!app->leaving) {
        take_signals(app);
        take_keys(app, &p);
        take_state(app);
        take_time(app, &p);
        if (app->leaving) break;
        draw_if_due(app, &p);
        wait_for_input(app, &p);
    }
}

/* ---- beginning and end ------------------------------------------------------------------------------------------- */

static view_mode finest_mode(void) {
    const char *name = getenv("TERM");
    /* The Linux console's fonts have blocks but no braille. */
    return name && strcmp(name, "linux") == 0 ? VIEW_HALF : VIEW_BRAILLE;
}

static status app_open(tui_app *app, const tui_options *options, bool unicode, report *r) {
    bool ascii = options->ascii || !unicode;
    status s = theme_open(&app->theme, options->theme, options->colours, ascii, r);
    if (s != STATUS_OK) return s;
    app->shot = memory_allocate(sizeof *app->shot);
    if (!app->shot) return report_set(r, STATUS_SYSTEM, "out of memory for the live view");
    app->mode = ascii ? VIEW_ASCII : options->mode == TUI_AUTO ? finest_mode() : (view_mode)options->mode;
    if (options->palette != TUI_AUTO) app->theme.palette = (view_palette)options->palette;
    app->camera = view_camera_default();
    app->log_histogram = options->log_histogram;
    app->leave_at_end = options->leave_at_end;
    app->picture_old = true;
    return STATUS_OK;
}

static void app_close(tui_app *app) {
    if (app->shot) session_snapshot_free(app->shot);
    memory_free(app->shot, sizeof *app->shot);
    memory_free(app->cells, app->cell_capacity * sizeof(view_cell));
    view_canvas_free(&app->canvas);
    theme_close(&app->theme);
}

status tui_watch(session *s, const tui_options *options, report *r) {
    tui_app app = {.run = s};
    bool unicode;
    status failed = terminal_open(&unicode, r);
    if (failed != STATUS_OK) return failed;
    failed = app_open(&app, options, unicode, r);
    if (failed == STATUS_OK) loop(&app);
    terminal_close();
    app_close(&app);
    capture_replay();
    capture_forget();
    if (failed != STATUS_OK) return failed;
    session_wait(s, -1);
    return session_outcome(s, r);
}
