/* Status codes and the message record that travels with them.
 *
 * Every function that can fail returns a `status` and fills a caller-owned `report`. Libraries never print or exit:
 * only src/cli does. There are three kinds of trouble, never mixed: a programmer's (assert), a user's, script's or disk's
 * (status + report) and a numerical one (STATUS_DIVERGED). */
#ifndef SUNDER_BASE_STATUS_H
#define SUNDER_BASE_STATUS_H

#include <stddef.h>

typedef enum status {
    STATUS_OK = 0,
    STATUS_DIVERGED,    /* the simulation failed: exit code 1 */
    STATUS_INPUT,       /* the user's input is wrong: exit code 2 */
    STATUS_SYSTEM,      /* disk, memory, database, a missing library: exit code 1 */
    STATUS_INTERRUPTED, /* stopped on request: exit code 130 */
} status;

/* What went wrong, field by field, so that people get a sentence and `check --json` gets an object. Empty strings and
 * line 0 mean "does not apply". All strings are NUL-terminated and truncated to fit. */
typedef struct report {
    status code;
    int line;
    char file[256];
    char key[128];
    char expected[256];
    char found[256];
    char nearest[128];
    char message[512]; /* free text: the cause where the fields above do not say it */
} report;

/* Clears `r` to STATUS_OK. */
void report_clear(report *r);

/* Fills `r` with a code and a formatted message; returns `code`, so that `return report_set(...)` reads well. */
status report_set(report *r, status code, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Fills `r` for wrong input: what was expected at file:line under `key`, what was found, and the nearest valid name
 * (each may be NULL). Returns STATUS_INPUT. */
status report_input(report *r, const char *file, int line, const char *key, const char *expected, const char *found,
                    const char *nearest);

/* Writes one sentence for people into text[size]: "file:line: key: expected …, found … (did you mean …?)". */
void report_format(const report *r, char *text, size_t size);

/* The process exit code that the command-line contract assigns to a status. */
int status_exit_code(status code);

#endif
