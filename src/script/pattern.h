/* Lua patterns, matched with a budget.
 *
 * A pattern such as ".-.-.-b" backtracks for hours without one call of Lua's count hook. This matcher counts its steps
 * and asks, now and then, whether it may go on. It raises nothing and allocates nothing: errors come back as text. The
 * meaning of patterns is the Lua 5.4 manual's, section 6.4.1; tests compare it with Lua's own library. */
#ifndef SUNDER_SCRIPT_PATTERN_H
#define SUNDER_SCRIPT_PATTERN_H

#include <stdbool.h>
#include <stddef.h>

enum { PATTERN_CAPTURES = 32, PATTERN_DEPTH = 200 };

/* A capture's length when it has none. */
#define PATTERN_OPEN ((ptrdiff_t)-1)     /* still being matched */
#define PATTERN_POSITION ((ptrdiff_t)-2) /* "()": start is a position */

typedef struct pattern_capture {
    const char *start;
    ptrdiff_t length;
} pattern_capture;

typedef struct pattern {
    const char *subject, *subject_end;
    const char *end;                            /* of the pattern's text */
    bool (*go_on)(void *context, size_t steps); /* false stops the match; NULL: never asked */
    void *context;
    size_t steps; /* since go_on was last asked */
    int depth;    /* of nested calls */
    int capture_count;
    pattern_capture captures[PATTERN_CAPTURES];
    const char *error; /* a constant text, when the pattern is malformed or was stopped */
} pattern;

/* Matches the pattern text [p, m->end), its anchor already removed, at s. Returns the end of the match, or NULL: no
 * match, or m->error. Captures are those of this match. */
const char *pattern_match(pattern *m, const char *s, const char *p);

#endif
