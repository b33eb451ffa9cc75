/* The terminal taken and given back: curses, modes, output kept off the screen, signals. */
#ifndef SUNDER_TUI_TERMINAL_H
#define SUNDER_TUI_TERMINAL_H

#include "base/status.h"

#include <stdbool.h>

/* true_colour: by the terminfo entry "TERM-direct" or "xterm-direct", where there is one. Opens curses on standard input and output, installs signals, captures printed text. *unicode: the locale's character
 * set is UTF-8. Errors: STATUS_SYSTEM, with everything as it was. */
status terminal_open(bool true_colour, bool *unicode, report *r);

/* What there is to say about a true colour that was asked for and is not to be had; NULL else. */
const char *terminal_colour_trouble(void);

/* Gives the terminal back. Printed text stays with capture.h until capture_replay. */
void terminal_close(void);

/* Gives the terminal back, stops the process, and takes it again when it goes on. */
void terminal_suspend(void);

/* Takes the terminal's modes again after a stop that could not be foreseen (SIGSTOP, then SIGCONT). */
void terminal_retake(void);

/* Tells curses the terminal's size of now. */
void terminal_resize(void);

#endif
