/* The workbench's loop: signals, keys, the run's state, time, drawing. */
#include "base/clock.h"
#include "base/memory.h"
#include "script/library.h"
#include "tui/actions.h"
#include "tui/capture.h"
#include "tui/pace.h"
#include "tui/shell.h"
#include "tui/signals.h"
#include "tui/start_words.h"
#include "tui/terminal.h"
#include "tui/widgets.h"

#include <math.h>
#include <poll.h>
#include <stdio.h>
#include <sys/eventfd.h>
#include <unistd.h>

static const double replay_time = 0.002;   /* s between two looks while a log is done again */
enum { KEYS_A_TURN = 256 };

tui_options tui_options_default(void) {
    return (tui_options){.theme = TUI_THEME_AUTO, .palette = TUI_AUTO, .mode = TUI_AUTO, .colours = TUI_AUTO};
}

typedef struct pace {
    tui_pace draw; /* in seconds of clock_seconds */
    bool hung_up;  /* the terminal is gone */
} pace;

/* ---- what comes in ----------------------------------------------------------------------------------------------- */

static void wait_for_input(const tui_app *app, pace *p) {
    double now = clock_seconds(), wait = app->shell->replay.active ? replay_time : pace_frame;
    if (app->notice[0]) wait = fmin(wait, app->notice_until - now);
    wait = pace_wait(&p->draw, now, wait, app->dirty);
    struct pollfd inputs[3] = {{.fd = signals_descriptor(), .events = POLLIN},
                               {.fd = p->hung_up || app->headless ? -1 : STDIN_FILENO, .events = POLLIN},
                               {.fd = app->shell->wake, .events = POLLIN}};
    if (poll(inputs, 3, (int)ceil(wait * 1e3)) > 0 && (inputs[1].revents & (POLLHUP | POLLERR | POLLNVAL)))
        p->hung_up = true;
    uint64_t count;
    if (inputs[2].revents & POLLIN && read(app->shell->wake, &count, sizeof count) < 0) return;
}

static void take_signals(tui_app *app) {
    char event;
    while (read(signals_descriptor(), &event, 1) == 1) {
        switch ((signal_event)event) {
        case SIGNAL_INTERRUPT: actions_interrupt(app); break;
        case SIGNAL_TERMINATE: actions_terminate(app); break;
        case SIGNAL_SUSPEND:
            if (app->headless) signals_stop_self();
            else terminal_suspend();
            break;
        case SIGNAL_CONTINUE:
            if (!app->headless) terminal_retake();
            break;
        case SIGNAL_RESIZE:
            if (!app->headless) terminal_resize();
            break;
        }
        app->dirty = true;
    }
}

/* Clicks and the wheel, within what the screen was given. */
static void take_mouse(tui_app *app) {
    MEVENT event;
    report unused;
    if (getmouse(&event) != OK || !app->screen->mouse || app->page != PAGE_NONE || app->shell->prompt.open) return;
    int row = event.y - app->body.y, column = event.x - app->body.x, wheel = 0;
    if (row < 0 || row >= app->body.height || column < 0 || column >= app->body.width) return;
    if (event.bstate & BUTTON4_PRESSED) wheel = -1;
    else if (event.bstate & BUTTON5_PRESSED) wheel = 1;
    else if (!(event.bstate & (BUTTON1_PRESSED | BUTTON1_CLICKED))) return;
    app->screen->mouse(app, screen_state(app, app->screen, &unused), app->body, row, column, wheel);
}

static void want_mouse(tui_app *app) {
    if (app->mouse == app->mouse_on) return;
    mousemask(app->mouse ? BUTTON1_PRESSED | BUTTON1_CLICKED | BUTTON4_PRESSED | BUTTON5_PRESSED : 0, NULL);
    mouseinterval(0);
    app->mouse_on = app->mouse;
}

static void take_keys(tui_app *app, pace *p) {
    if (app->headless) return;
    if (p->hung_up) {
        actions_terminate(app);
        return;
    }
    for (int i = 0; i < KEYS_A_TURN && !app->leaving; i++) {
        int key = getch();
        if (key == ERR) return;
        app->dirty = true;
        if (key == KEY_RESIZE) continue;
        if (key == KEY_MOUSE) take_mouse(app);
        else actions_press(app, key);
        pace_key(&p->draw, clock_seconds());
    }
}

static void tell_screens(tui_app *app) {
    int count;
    const tui_screen *const *list = tui_screens(&count);
    for (int i = 0; i < count; i++)
        if (app->opened[i] && list[i]->follow) list[i]->follow(app, app->states[i], false);
}

static void take_state(tui_app *app) {
    if (!app->run) {
        app->ended = true;
    } else {
        /* Asked before polling: a session that has ended has published its last state. */
        bool ended = session_wait(app->run, 0);
        bool news = session_poll(app->run, app->shot);
        log_attach(app); /* a run may have ended before its first poll here: no news, but a folder */
        if (news) {
            tell_screens(app);
            app->dirty = true;
        }
        if (ended && !app->ended) {
            app->ended = app->dirty = true;
            log_settle(app);
        }
    }
    start_tick(app);
    replay_tick(app);
    if (app->ended && app->leave_at_end && !app_starting(app)) app->leaving = true;
}

static void take_time(tui_app *app) {
    double now = clock_seconds();
    int count;
    const tui_screen *const *list = tui_screens(&count);
    if (app->notice[0] && now >= app->notice_until) {
        app->notice[0] = '\0';
        app->dirty = true;
    }
    for (int i = 0; i < count; i++)
        if (app->opened[i] && list[i]->tick) list[i]->tick(app, app->states[i], now);
    int64_t printed = capture_size();
    if (printed > app->printed && app->page != PAGE_LOG)
        app_notice(app, "A library has printed something; g shows it.");
    if (printed != app->printed) app->dirty = true;
    app->printed = printed;
}

static void draw_if_due(tui_app *app, pace *p) {
    double start = clock_seconds();
    if (!app->dirty || !pace_due(&p->draw, start) || app->headless) return;
    app->dirty = false;
    if (app->redraw) clearok(curscr, TRUE);
    app->redraw = false;
    want_mouse(app);
    workbench_draw(app);
    pace_drawn(&p->draw, start, clock_seconds());
}

static void loop(tui_app *app) {
    pace p = {0};
    app->dirty = true;
    while (!app->leaving) {
        take_signals(app);
        take_keys(app, &p);
        take_state(app);
        take_time(app);
        if (app->leaving) break;
        draw_if_due(app, &p);
        wait_for_input(app, &p);
    }
}

/* ---- beginning and end ------------------------------------------------------------------------------------------- */

/* A run that the command line has started is noted as if it had been started here. One that goes on from another's frames is the same as one from
 * the beginning with all the turns up to there. */
static void log_start(tui_app *app, session *run) {
    knob_turn turns[START_TURNS_SAID];
    session_options asked;
    char words[START_TEXT], name[LIBRARY_PATH];
    session_request(run, &asked);
    asked.turn_count = session_turns(run, turns, START_TURNS_SAID);
    asked.turns = turns;
    library_name_scene(asked.scene_path, name);
    asked.scene_path = name;
    bool fits = asked.turn_count <= START_TURNS_SAID && start_print(&asked, words);
    log_line(app, -1, "start", fits ? words : "# more settings and turns than a line holds: not to be replayed");
}

static status app_open(tui_app *app, session *run, bool unicode, const user_config *config, report *config_trouble, report *r) {
    int colours = app->headless ? 0 : app->options.colours;
    status s = theme_open(&app->theme, app->options.theme, colours, app->options.ascii || !unicode, r);
    if (s != STATUS_OK) return s;
    app->shot = memory_allocate(sizeof *app->shot);
    app->shell = memory_allocate(sizeof *app->shell);
    if (!app->shot || !app->shell) return report_set(r, STATUS_SYSTEM, "out of memory for the workbench");
    app->shell->wake = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (app->shell->wake < 0) return report_set(r, STATUS_SYSTEM, "no descriptor to wake the workbench by");
    if (app->options.palette != TUI_AUTO) app->theme.palette = (view_palette)app->options.palette;
    app->leave_at_end = app->options.leave_at_end && run;
    if (app->options.database) snprintf(app->database, sizeof app->database, "%s", app->options.database);
    log_open(app);
    if (run) log_start(app, run);
    app_switch_run(app, run);
    app_show(app, run ? &screen_run : &screen_scenes);
    if (!app->screen) return report_set(r, STATUS_SYSTEM, "%s", app->notice);
    if (!app->headless && terminal_colour_trouble()) app_notice(app, "%s", terminal_colour_trouble());
    config_apply(app, config, config_trouble);
    if (app->options.replay) return replay_open(app, app->options.replay, r);
    return STATUS_OK;
}

static void close_screens(tui_app *app) {
    int count;
    const tui_screen *const *list = tui_screens(&count);
    for (int i = 0; i < count; i++)
        if (app->opened[i] && list[i]->close) list[i]->close(app, app->states[i]);
}

/* The terminal has been given back: what the run still does is waited for without it. */
static void app_close(tui_app *app, status *outcome, report *r) {
    if (app->shell) start_close(app);
    if (app->run) {
        session_wait(app->run, -1);
        session_poll(app->run, app->shot);
        log_attach(app);
        app->ended = true;
        *outcome = session_outcome(app->run, r);
    }
    close_screens(app);
    if (app->shell) {
        if (app->shell->replay.outcome.code != STATUS_OK) {
            *r = app->shell->replay.outcome;
            *outcome = r->code;
        }
        replay_close(app);
        log_close(app);
        if (app->shell->wake > 0) close(app->shell->wake);
    }
    if (app->shot) session_snapshot_free(app->shot);
    memory_free(app->shot, sizeof *app->shot);
    memory_free(app->shell, sizeof *app->shell);
    theme_close(&app->theme);
}

/* Without a terminal there is none to give back. */
static void nothing(void) {
}

status tui_workbench(session **run, const tui_options *options, report *r) {
    tui_app app = {.options = *options, .headless = options->headless};
    static user_config config; /* large */
    report config_trouble;
    bool unicode = true;
    report_clear(r);
    config_read(&app, &config, &config_trouble);
    status failed = app.headless ? signals_install(nothing, r) : terminal_open(app.options.colours == TUI_TRUE_COLOUR, &unicode, r);
    status outcome = STATUS_OK;
    if (failed != STATUS_OK) return failed;
    failed = app_open(&app, *run, unicode, &config, &config_trouble, r);
    if (failed == STATUS_OK) loop(&app);
    if (app.headless) signals_remove();
    else terminal_close();
    report ended;
    report_clear(&ended);
    app_close(&app, &outcome, &ended);
    if (failed == STATUS_OK) *run = app.run;
    if (!app.headless) {
        capture_replay();
        capture_forget();
    }
    if (failed != STATUS_OK) return failed;
    *r = ended;
    return outcome;
}
