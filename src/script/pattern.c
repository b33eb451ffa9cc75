#include "script/pattern.h"

#include <ctype.h>
#include <string.h>

enum { STEPS_BETWEEN_QUESTIONS = 10000 };

static const char *match(pattern *m, const char *s, const char *p);

static const char *fail(pattern *m, const char *error) {
    if (!m->error) m->error = error;
    return NULL;
}

/* Counts one step; false when the match must end. */
static bool step(pattern *m) {
    if (m->error) return false;
    if (++m->steps < STEPS_BETWEEN_QUESTIONS) return true;
    size_t steps = m->steps;
    m->steps = 0;
    if (!m->go_on || m->go_on(m->context, steps)) return true;
    fail(m, "stopped");
    return false;
}

/* ---- one character ----------------------------------------------------------------------------------------------- */

/* The end of the single-character item that starts at p, or NULL and an error. */
static const char *item_end(pattern *m, const char *p) {
    char first = *p++;
    if (first == '%') {
        if (p == m->end) return fail(m, "malformed pattern (ends with '%')");
        return p + 1;
    }
    if (first != '[') return p;
    if (p < m->end && *p == '^') p++;
    do { /* a ']' that comes first stands for itself */
        if (p == m->end) return fail(m, "malformed pattern (missing ']')");
        if (*p++ == '%') {
            if (p == m->end) return fail(m, "malformed pattern (missing ']')");
            p++;
        }
    } while (p == m->end || *p != ']');
    return p + 1;
}

static bool in_class(int c, int class) {
    bool in;
    switch (tolower(class)) {
    case 'a': in = isalpha(c); break;
    case 'c': in = iscntrl(c); break;
    case 'd': in = isdigit(c); break;
    case 'g': in = isgraph(c); break;
    case 'l': in = islower(c); break;
    case 'p': in = ispunct(c); break;
    case 's': in = isspace(c); break;
    case 'u': in = isupper(c); break;
    case 'w': in = isalnum(c); break;
    case 'x': in = isxdigit(c); break;
    default: return class == c;
    }
    return isupper(class) ? !in : in;
}

/* Whether c is in the set that starts at p ('[') and whose closing bracket is at `close`. */
static bool in_set(int c, const char *p, const char *close) {
    bool member = true;
    p++;
    if (*p == '^') member = false, p++;
    while (p < close) {
        if (*p == '%') {
            if (in_class(c, (unsigned char)p[1])) return member;
            p += 2;
        } else if (p + 2 < close && p[1] == '-') {
            if ((unsigned char)p[0] <= c && c <= (unsigned char)p[2]) return member;
            p += 3;
        } else {
            if ((unsigned char)*p == c) return member;
            p++;
        }
    }
    return !member;
}

/* Whether the item [p, end) takes the character at s. */
static bool item_takes(const pattern *m, const char *s, const char *p, const char *end) {
    if (s >= m->subject_end) return false;
    int c = (unsigned char)*s;
    switch (*p) {
    case '.': return true;
    case '%': return in_class(c, (unsigned char)p[1]);
    case '[': return in_set(c, p, end - 1);
    default: return (unsigned char)*p == c;
    }
}

/* ---- repetition -------------------------------------------------------------------------------------------------- */

/* As many as possible, at least `least`, then the rest of the pattern. */
static const char *match_longest(pattern *m, const char *s, const char *p, const char *end, ptrdiff_t least) {
    ptrdiff_t count = 0;
    while (item_takes(m, s + count, p, end)) {
        if (!step(m)) return NULL;
        count++;
    }
    for (; count >= least; count--) {
        const char *result = match(m, s + count, end + 1);
        if (result || m->error) return result;
    }
    return NULL;
}

/* As few as possible. */
static const char *match_shortest(pattern *m, const char *s, const char *p, const char *end) {
    for (;;) {
        const char *result = match(m, s, end + 1);
        if (result || m->error || !item_takes(m, s, p, end)) return result;
        if (!step(m)) return NULL;
        s++;
    }
}

/* ---- captures and special items ---------------------------------------------------------------------------------- */

static const char *open_capture(pattern *m, const char *s, const char *p, ptrdiff_t length) {
    if (m->capture_count >= PATTERN_CAPTURES) return fail(m, "too many captures");
    m->captures[m->capture_count++] = (pattern_capture){s, length};
    const char *result = match(m, s, p);
    if (!result) m->capture_count--;
    return result;
}

static const char *close_capture(pattern *m, const char *s, const char *p) {
    int open = m->capture_count - 1;
    while (open >= 0 && m->captures[open].length != PATTERN_OPEN) open--;
    if (open < 0) return fail(m, "invalid pattern capture");
    m->captures[open].length = s - m->captures[open].start;
    const char *result = match(m, s, p);
    if (!result) m->captures[open].length = PATTERN_OPEN;
    return result;
}

/* "%b()": p is behind the b. */
static const char *match_balanced(pattern *m, const char *s, const char *p) {
    if (m->end - p < 2) return fail(m, "malformed pattern (missing arguments to '%b')");
    if (s >= m->subject_end || *s != *p) return NULL;
    int depth = 1;
    for (const char *at = s + 1; at < m->subject_end; at++) {
        if (!step(m)) return NULL;
        if (*at == p[1]) {
            if (--depth == 0) return match(m, at + 1, p + 2);
        } else if (*at == p[0]) {
            depth++;
        }
    }
    return NULL;
}

/* "%f[set]": p is behind the f. */
static const char *match_frontier(pattern *m, const char *s, const char *p) {
    if (p == m->end || *p != '[') return fail(m, "missing '[' after '%f' in pattern");
    const char *end = item_end(m, p);
    if (!end) return NULL;
    int before = s == m->subject ? '\0' : (unsigned char)s[-1];
    int after = s < m->subject_end ? (unsigned char)*s : '\0';
    if (in_set(before, p, end - 1) || !in_set(after, p, end - 1)) return NULL;
    return match(m, s, end);
}

/* "%1": what an earlier capture held. */
static const char *match_again(pattern *m, const char *s, const char *p) {
    int index = *p - '1';
    if (index < 0 || index >= m->capture_count || m->captures[index].length == PATTERN_OPEN)
        return fail(m, "invalid capture index in pattern");
    ptrdiff_t length = m->captures[index].length;
    if (length == PATTERN_POSITION) return NULL; /* as in Lua: a position is nothing that could come again */
    m->steps += (size_t)length / 16;
    if (m->subject_end - s < length || memcmp(s, m->captures[index].start, (size_t)length) != 0) return NULL;
    return match(m, s + length, p + 1);
}

/* An item of one character and what may follow it. */
static const char *match_item(pattern *m, const char *s, const char *p) {
    const char *end = item_end(m, p);
    if (!end) return NULL;
    char suffix = end < m->end ? *end : '\0';
    switch (suffix) {
    case '*': return match_longest(m, s, p, end, 0);
    case '+': return match_longest(m, s, p, end, 1);
    case '-': return match_shortest(m, s, p, end);
    case '?':
        if (item_takes(m, s, p, end)) {
            const char *result = match(m, s + 1, end + 1);
            if (result || m->error) return result;
        }
        return match(m, s, end + 1);
    default: return NULL;
    }
}

static const char *match_special(pattern *m, const char *s, const char *p) {
    if (*p == '(') {
        bool position = p + 1 < m->end && p[1] == ')';
        return position ? open_capture(m, s, p + 2, PATTERN_POSITION) : open_capture(m, s, p + 1, PATTERN_OPEN);
    }
    if (*p == ')') return close_capture(m, s, p + 1);
    if (*p == '$') return s == m->subject_end ? s : NULL;
    if (p[1] == 'b') return match_balanced(m, s, p + 2);
    if (p[1] == 'f') return match_frontier(m, s, p + 2);
    return match_again(m, s, p + 1);
}

static bool is_special(const pattern *m, const char *p) {
    if (*p == '(' || *p == ')') return true;
    if (*p == '$') return p + 1 == m->end;
    return *p == '%' && p + 1 < m->end && (p[1] == 'b' || p[1] == 'f' || isdigit((unsigned char)p[1]));
}

/* Plain items are taken one after the other here; whatever may have to be undone goes one call deeper. */
static const char *match(pattern *m, const char *s, const char *p) {
    if (!step(m)) return NULL;
    if (m->depth >= PATTERN_DEPTH) return fail(m, "pattern too complex");
    m->depth++;
    const char *result = NULL;
    for (;;) {
        if (p == m->end) {
            result = s;
            break;
        }
        if (is_special(m, p)) {
            result = match_special(m, s, p);
            break;
        }
        const char *end = item_end(m, p);
        if (!end) break;
        if (end < m->end && strchr("*+-?", *end) && *end) {
            result = match_item(m, s, p);
            break;
        }
        if (!item_takes(m, s, p, end) || !step(m)) break;
        s++, p = end;
    }
    m->depth--;
    return result;
}

const char *pattern_match(pattern *m, const char *s, const char *p) {
    m->depth = m->capture_count = 0;
    return match(m, s, p);
}
