#include "tui/terminal.h"

#include "tui/capture.h"
#include "tui/signals.h"
#include "tui/theme.h"
#include "tui/tui.h"

#include <errno.h>
#include <fcntl.h>
#include <langinfo.h>
#include <locale.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <term.h>
#include <termios.h>
#include <unistd.h>

/* term.h names every capability with a macro; these would get in the way. */
#undef lines
#undef columns

enum { RESTORE_BYTES = 256 };

static struct {
    SCREEN *screen;
    FILE *output;   /* curses' own duplicate of descriptor 1, which itself is captured */
    int descriptor; /* output's */
    int spare;      /* a further duplicate, for giving back while another thread is inside curses */
    int nowhere;    /* /dev/null */
    locale_t locale, old_locale;
    struct termios modes;        /* as they were */
    char restore[RESTORE_BYTES]; /* what brings the terminal back, ready to write */
    size_t restore_length;
    const char *colour_trouble;
    atomic_bool taken; /* curses has the terminal now */
} state;

bool tui_possible(const char **why) {
    const char *unused;
    if (!why) why = &unused;
    const char *name = getenv("TERM");
    if (!isatty(STDIN_FILENO)) {
        *why = "standard input is not a terminal";
    } else if (!isatty(STDOUT_FILENO)) {
        *why = "standard output is not a terminal";
    } else if (!name || !name[0]) {
        *why = "TERM is not set";
    } else if (strcmp(name, "dumb") == 0) {
        *why = "TERM is \"dumb\": the terminal cannot place text";
    } else {
        int found = 0;
        if (setupterm(NULL, STDOUT_FILENO, &found) != OK) {
            *why = "no terminfo entry for the terminal named by TERM";
            return false;
        }
        bool able = tigetstr("cup") != NULL && tigetstr("clear") != NULL;
        del_curterm(cur_term);
        *why = able ? "" : "the terminal named by TERM cannot place text";
        return able;
    }
    return false;
}

/* ---- giving back ------------------------------------------------------------------------------------------------- */

/* Appends a capability's text without its padding marks "$<…>". */
static void append_capability(const char *name) {
    const char *text = tigetstr((char *)name);
    if (!text || text == (char *)-1) return;
    for (; *text && state.restore_length + 1 < RESTORE_BYTES; text++) {
        if (text[0] == '$' && text[1] == '<' && strchr(text, '>')) {
            text = strchr(text, '>');
            continue;
        }
        state.restore[state.restore_length++] = *text;
    }
}

static void prepare_restore(void) {
    state.restore_length = 0;
    append_capability("sgr0");
    append_capability("op");
    append_capability("cnorm");
    append_capability("rmkx");
    const char *mouse = tigetstr("kmous"), off[] = "\033[?1000l\033[?1006l";
    if (mouse && mouse != (char *)-1 && state.restore_length + sizeof off < RESTORE_BYTES) {
        memcpy(state.restore + state.restore_length, off, sizeof off - 1);
        state.restore_length += sizeof off - 1;
    }
    append_capability("rmcup");
    if (!tigetstr("rmcup")) state.restore[state.restore_length++] = '\n';
    state.restore[state.restore_length++] = '\r';
}

/* Async-signal-safe: raw writes of what was prepared, and the modes that were there at the start. The signal may have
 * struck in a thread of the simulation, or another thread may be in exit(): what the screen's thread still draws goes
 * nowhere. */
static void give_back_now(void) {
    if (atomic_exchange(&state.taken, false)) {
        dup2(state.nowhere, state.descriptor);
        tcflush(state.spare, TCIFLUSH);
        ssize_t written = write(state.spare, state.restore, state.restore_length);
        (void)written; /* a dead terminal needs no restoring */
        tcsetattr(state.spare, TCSANOW, &state.modes);
    }
    capture_end();
    capture_replay();
}

/* ---- taking ------------------------------------------------------------------------------------------------------ */

static void set_modes(void) {
    cbreak();
    noecho();
    nonl();
    keypad(stdscr, TRUE);
    nodelay(stdscr, TRUE);
    intrflush(stdscr, FALSE);
    curs_set(0);
    set_escdelay(25);
    /* What tmux, PuTTY and the Linux console send for these keys, whatever TERM says. */
    define_key("\033[1~", KEY_HOME);
    define_key("\033[4~", KEY_END);
}

static void close_output(void) {
    if (state.output) fclose(state.output); /* closes its descriptor */
    if (state.spare >= 0) close(state.spare);
    if (state.nowhere >= 0) close(state.nowhere);
    state.output = NULL;
    state.spare = state.nowhere = -1;
}

static status open_output(report *r) {
    state.descriptor = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
    state.spare = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
    state.nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (state.descriptor >= 0 && state.spare >= 0 && state.nowhere >= 0) state.output = fdopen(state.descriptor, "w");
    if (state.output) return STATUS_OK;
    int cause = errno;
    if (state.descriptor >= 0) close(state.descriptor);
    close_output();
    return report_set(r, STATUS_SYSTEM, "cannot open the terminal: %s", strerror(cause));
}

/* The user's characters, for this thread only: the process's locale is not a library's to change. */
static bool enter_locale(void) {
    state.locale = newlocale(LC_CTYPE_MASK, "", (locale_t)0);
    if (!state.locale) return false;
    state.old_locale = uselocale(state.locale);
    return strcmp(nl_langinfo_l(CODESET, state.locale), "UTF-8") == 0;
}

static void leave_locale(void) {
    if (!state.locale) return;
    uselocale(state.old_locale);
    freelocale(state.locale);
    state.locale = (locale_t)0;
}

static bool has_entry(const char *name) {
    int found = 0;
    if (setupterm(name, STDOUT_FILENO, &found) != OK) return false;
    bool direct = tigetflag("RGB") > 0;
    del_curterm(cur_term);
    return direct;
}

/* The terminal's name for curses: NULL for TERM's own. */
static const char *choose_entry(bool true_colour, char direct[64]) {
    state.colour_trouble = NULL;
    if (!true_colour) return NULL;
    snprintf(direct, 64, "%.50s-direct", getenv("TERM"));
    if (has_entry(direct)) return direct;
    if (has_entry("xterm-direct")) return "xterm-direct";
    state.colour_trouble = "True colour needs the terminfo entry xterm-direct (Debian: the package ncurses-term).";
    return NULL;
}

const char *terminal_colour_trouble(void) {
    return state.colour_trouble;
}

/* Signals first: whatever goes wrong later is undone by their emergency as well. */
static status take(const char *entry, report *r) {
    status s = capture_begin(r);
    if (s != STATUS_OK) return s;
    s = signals_install(give_back_now, r);
    if (s == STATUS_OK) {
        state.screen = newterm(entry, state.output, stdin);
        if (state.screen) {
            prepare_restore();
            state.taken = true;
            set_modes();
            return STATUS_OK;
        }
        signals_remove();
        s = report_set(r, STATUS_SYSTEM, "curses cannot start on the terminal \"%s\"", getenv("TERM"));
    }
    capture_end();
    capture_replay();
    capture_forget();
    return s;
}

status terminal_open(bool true_colour, bool *unicode, report *r) {
    char direct[64];
    const char *why;
    if (!tui_possible(&why)) return report_set(r, STATUS_SYSTEM, "the live view is off: %s", why);
    if (tcgetattr(STDIN_FILENO, &state.modes) != 0)
        return report_set(r, STATUS_SYSTEM, "cannot read the terminal's modes: %s", strerror(errno));
    status s = open_output(r);
    if (s != STATUS_OK) return s;
    *unicode = enter_locale();
    s = take(choose_entry(true_colour, direct), r);
    if (s == STATUS_OK) return s;
    leave_locale();
    close_output();
    return s;
}

void terminal_close(void) {
    endwin();
    state.taken = false;
    /* Keys pressed in the last moment are not meant for the shell. */
    tcflush(STDIN_FILENO, TCIFLUSH);
    delscreen(state.screen);
    state.screen = NULL;
    signals_remove();
    fflush(stdout);
    capture_end();
    leave_locale();
    close_output();
}

void terminal_suspend(void) {
    endwin();
    state.taken = false;
    signals_stop_self();
    terminal_retake();
}

void terminal_retake(void) {
    state.taken = true;
    reset_prog_mode();
    terminal_resize();
    clearok(curscr, TRUE);
    refresh();
    curs_set(0);
}

void terminal_resize(void) {
    struct winsize size;
    if (ioctl(state.descriptor, TIOCGWINSZ, &size) != 0) return;
    int lines = size.ws_row > 0 ? size.ws_row : 1, columns = size.ws_col > 0 ? size.ws_col : 1;
    resizeterm(lines, columns);
}
