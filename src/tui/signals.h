/* Signals while the screen is up. Handlers write one byte into a pipe that the screen's loop reads; fatal signals give
 * the terminal back first and are then raised again. */
#ifndef SUNDER_TUI_SIGNALS_H
#define SUNDER_TUI_SIGNALS_H

#include "base/status.h"

/* What the pipe carries. */
typedef enum signal_event {
    SIGNAL_INTERRUPT = 'I', /* SIGINT */
    SIGNAL_TERMINATE = 'T', /* SIGTERM, SIGHUP */
    SIGNAL_SUSPEND = 'Z',   /* SIGTSTP */
    SIGNAL_CONTINUE = 'C',  /* SIGCONT */
    SIGNAL_RESIZE = 'W',    /* SIGWINCH */
} signal_event;

/* Installs all handlers, keeping those that were there. `emergency` is called from the fatal ones and at exit(), and
 * must be async-signal-safe. Errors: STATUS_SYSTEM. */
status signals_install(void (*emergency)(void), report *r);

/* Puts the previous handlers back. */
void signals_remove(void);

/* The pipe's reading end, non-blocking; −1 when none is installed. */
int signals_descriptor(void);

/* Stops the process as Ctrl-Z would have, and returns when it goes on. */
void signals_stop_self(void);

#endif
