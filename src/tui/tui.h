/* The workbench: screens on a terminal around the run that is on.
 *
 * Curses, keys and signals belong to the calling thread; the session simulates on threads of its own and never waits
 * for the screen. The terminal is given back on every way out: returning, suspending (Ctrl-Z), SIGTERM, SIGHUP, exit()
 * and fatal signals. */
#ifndef SUNDER_TUI_TUI_H
#define SUNDER_TUI_TUI_H

#include "base/status.h"
#include "session/session.h"
#include "view/palette.h"
#include "view/raster.h"

#include <stdbool.h>

typedef enum tui_theme_kind {
    TUI_DARK,
    TUI_LIGHT,
    TUI_COLOUR_BLIND, /* no meaning rests on red against green */
    TUI_THEMES,
    TUI_THEME_AUTO = TUI_THEMES /* light if COLORFGBG says so, else dark */
} tui_theme_kind;

enum { TUI_AUTO = -1, TUI_TRUE_COLOUR = 1 << 24 };

typedef struct tui_options {
    tui_theme_kind theme;
    int palette; /* a view_palette, or TUI_AUTO: the theme's */
    int mode;    /* a view_mode, or TUI_AUTO: the finest that the terminal shows */
    int colours; /* TUI_TRUE_COLOUR, 256, 16, 8, 0, or TUI_AUTO: what TERM says (0 under NO_COLOR) */
    bool ascii;  /* only ASCII characters; always so when the locale's character set is not UTF-8 */
    bool log_histogram;
    bool leave_at_end; /* else the screen stays after the run until its user quits */
    const char *replay;   /* a command log to do again; NULL: none */
    bool headless;        /* no terminal: for a replay, whose end is this function's */
    const char *output;   /* of the runs that are started: the first one's folder, then "FOLDER.2" …; NULL: by their ids */
    const char *database; /* of the ledger, for runs that are started; NULL: the default one */
} tui_options;

/* Everything automatic, a linear histogram, staying at the end. */
tui_options tui_options_default(void);

/* Whether the process has a terminal that the screen can run on. When not, *why (may be NULL) says what is missing, as
 * a phrase that follows "the live view is off: ". */
bool tui_possible(const char **why);

/* Opens the workbench with `*run` in view (NULL: none) until its user leaves. Runs may be started and ended meanwhile:
 * *run is the one in view at the end, ended, and the caller's to destroy (NULL: none); those before it have been. Returns
 * its outcome with its report, as session_outcome does; STATUS_OK without one; what stopped a replay where that was not its
 * log's end. What the process wrote to its standard
 * streams meanwhile is repeated on standard error afterwards. First Ctrl-C, SIGTERM, SIGHUP: the frame is finished, then
 * the screen left; second Ctrl-C: left at the next step. Errors of its own: STATUS_SYSTEM when the terminal cannot be
 * used or memory is out; *run then goes on running. */
status tui_workbench(session **run, const tui_options *options, report *r);

#endif
