/* Another sunder that works beside the workbench, and what it says, line by line. */
#ifndef SUNDER_TUI_CHILD_H
#define SUNDER_TUI_CHILD_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

enum { CHILD_LINE = 2048 };

typedef struct child {
    pid_t pid; /* 0: none */
    int fd;    /* its output and complaints, never waited for */
    char line[CHILD_LINE];
    size_t used;
    bool ended;
    int exit_code; /* once it has ended */
} child;

/* Starts this program with arguments [NULL-terminated; the first is its name], in a process group of its own, without standard input. */
status child_start(child *c, char *const *arguments, report *r);

/* The next whole line of what it said, without waiting; false when there is none yet. After its last line, `ended` and the exit code are set. */
bool child_line(child *c, char line[CHILD_LINE]);

/* Asks it and its own children to stop, as Ctrl-C does. */
void child_stop(const child *c);

/* Stops it and forgets it. */
void child_close(child *c);

#endif
