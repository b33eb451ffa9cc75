/* Keeps the process's standard output and error off the screen while it is up: what libraries print goes to memory, can
 * be read on the log page, and is repeated on standard error when the screen is gone. */
#ifndef SUNDER_TUI_CAPTURE_H
#define SUNDER_TUI_CAPTURE_H

#include "base/status.h"

#include <stdint.h>

enum { CAPTURE_KEPT = 16 * 1024 }; /* bytes at the end that are shown and repeated */

/* Turns descriptors 1 and 2 away from the terminal; those that the user has sent elsewhere are left alone. Errors:
 * STATUS_SYSTEM. */
status capture_begin(report *r);

/* Turns them back; what was written stays readable. Async-signal-safe. */
void capture_end(void);

/* Bytes written so far. */
int64_t capture_size(void);

/* Copies the last bytes, at most CAPTURE_KEPT and from the start of a line on, into text (terminated). Returns their
 * number. */
int capture_tail(char text[CAPTURE_KEPT + 1]);

/* After capture_end: writes what capture_tail gives to standard error. Async-signal-safe. */
void capture_replay(void);

/* After capture_end: gives everything free. */
void capture_forget(void);

#endif
