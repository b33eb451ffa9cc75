/* The screen's state, shared by its widgets, its actions and its loop. All of it belongs to one thread. */
#ifndef SUNDER_TUI_APP_H
#define SUNDER_TUI_APP_H

#include "session/session.h"
#include "tui/draw.h"
#include "tui/theme.h"
#include "view/camera.h"
#include "view/raster.h"

typedef enum tui_page { PAGE_RUN, PAGE_HELP, PAGE_LOG, PAGES } tui_page;

typedef struct tui_app {
    session *run;
    session_snapshot *shot; /* the newest state, never NULL */
    tui_theme theme;

    tui_page page;
    int scroll;        /* first line shown, on pages that have more than fit */
    bool at_end;       /* the log page shows its newest lines and follows them */
    bool asking;       /* "stop the run?" is on the message line */
    bool stopping;     /* session_stop or session_abandon was called */
    bool abandoned;    /* session_abandon was */
    bool leave_at_end; /* leave as soon as the session has ended */
    bool ended;        /* the session has */
    bool leaving;      /* the loop's last turn */
    bool log_histogram;
    bool spinning; /* the camera turns by itself */

    view_camera camera;
    float fit_minimum[3], fit_maximum[3]; /* the box that the camera fits; grows with the material, never shrinks */
    bool fitted;                          /* the box is that of a snapshot */
    float radius;                         /* length; drawn size of a particle */
    view_mode mode;
    view_canvas canvas;
    view_cell *cells; /* [cell_capacity], those of the last picture in rows of cells_width */
    size_t cell_capacity;
    int cells_width, cells_height;
    bool picture_old; /* the picture no longer shows the snapshot, the camera or the mode */

    char notice[192];    /* passing answer to a key, on the message line */
    double notice_until; /* s, monotonic clock */
    int64_t printed;     /* bytes of captured output seen so far */

    bool dirty; /* something on the screen changed */
} tui_app;

/* Shows a passing message for a few seconds. */
void app_notice(tui_app *app, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Seconds on the monotonic clock. */
double app_clock(void);

#endif
