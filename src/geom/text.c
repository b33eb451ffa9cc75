#include "geom/text.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SHOWN = 40, EXPONENT_LIMIT = 5000 };

text_reader text_open(const char *file, const void *data, size_t size) {
    return (text_reader){.file = file, .at = data, .end = (const char *)data + size, .line = 1};
}

static bool is_blank(const text_reader *t, char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f' || (t->commas && (c == ',' || c == ';'));
}

/* The length of a backslash and the line end behind it, or 0. */
static size_t joint(const text_reader *t) {
    if (t->at == t->end || *t->at != '\\') return 0;
    const char *next = t->at + 1;
    if (next < t->end && *next == '\r') next++;
    return next < t->end && *next == '\n' ? (size_t)(next - t->at) + 1 : 0;
}

bool text_word_on_line(text_reader *t, text_word *word) {
    for (;;) {
        size_t skipped = joint(t);
        if (skipped) t->line++;
        else if (t->at < t->end && is_blank(t, *t->at)) skipped = 1;
        if (!skipped) break;
        t->at += skipped;
    }
    const char *start = t->at;
    while (t->at < t->end && *t->at != '\n' && !is_blank(t, *t->at) && !joint(t)) t->at++;
    *word = (text_word){start, (size_t)(t->at - start)};
    return word->size > 0;
}

bool text_next_line(text_reader *t) {
    const char *newline = t->at < t->end ? memchr(t->at, '\n', (size_t)(t->end - t->at)) : NULL;
    t->at = newline ? newline + 1 : t->end;
    if (!newline) return false;
    t->line++;
    return true;
}

bool text_next_word(text_reader *t, text_word *word) {
    while (!text_word_on_line(t, word))
        if (!text_next_line(t)) return false;
    return true;
}

bool text_is(const text_word *word, const char *what) {
    return word->size == strlen(what) && memcmp(word->text, what, word->size) == 0;
}

/* ---- numbers ----------------------------------------------------------------------------------------------------- */

/* A number being read: digits × 10^exponent. */
typedef struct decimal {
    uint64_t digits;
    int exponent, count; /* count: digits seen */
} decimal;

static const char *read_digits(const char *at, const char *end, bool fraction, decimal *d) {
    for (; at < end && *at >= '0' && *at <= '9'; at++) {
        bool room = d->digits < UINT64_MAX / 10 - 1;
        if (room) d->digits = d->digits * 10 + (uint64_t)(*at - '0');
        if (fraction && room) d->exponent--;
        if (!fraction && !room) d->exponent++;
        d->count++;
    }
    return at;
}

static const char *read_sign(const char *at, const char *end, bool *negative) {
    *negative = at < end && *at == '-';
    return at < end && (*at == '-' || *at == '+') ? at + 1 : at;
}

/* Powers of ten up to 10^27 are exact in 64 bits of mantissa: what comes out is the nearest double, but for a hair. */
static double scale(const decimal *d) {
    long double value = (long double)d->digits, power = 10.0L;
    int left = d->exponent < 0 ? -d->exponent : d->exponent;
    for (; left; left >>= 1, power *= power) {
        if (!(left & 1)) continue;
        value = d->exponent < 0 ? value / power : value * power;
    }
    return (double)value;
}

bool text_number(const text_word *word, double *value) {
    const char *at = word->text, *end = word->text + word->size;
    bool negative, shrinks;
    decimal d = {0};
    at = read_sign(at, end, &negative);
    at = read_digits(at, end, false, &d);
    if (at < end && *at == '.') at = read_digits(at + 1, end, true, &d);
    if (d.count == 0) return false;
    if (at < end && (*at == 'e' || *at == 'E')) {
        decimal power = {0};
        at = read_sign(at + 1, end, &shrinks);
        at = read_digits(at, end, false, &power);
        if (power.count == 0) return false;
        int size = power.digits < EXPONENT_LIMIT ? (int)power.digits : EXPONENT_LIMIT;
        d.exponent += shrinks ? -size : size;
    }
    if (at != end) return false;
    *value = d.digits == 0 ? 0.0 : scale(&d);
    if (negative) *value = -*value;
    return isfinite(*value);
}

/* ---- messages ---------------------------------------------------------------------------------------------------- */

status text_wrong(const text_reader *t, const char *key, const char *expected, const text_word *found, report *r) {
    char shown[SHOWN + 16];
    size_t size = found && found->size < SHOWN ? found->size : SHOWN;
    if (found) {
        /* What is no plain character would spoil a terminal or a JSON text. */
        char plain[SHOWN];
        for (size_t i = 0; i < size; i++) plain[i] = found->text[i] >= ' ' && found->text[i] <= '~' ? found->text[i] : '?';
        snprintf(shown, sizeof shown, "'%.*s%s'", (int)size, plain, size < found->size ? "…" : "");
    } else {
        snprintf(shown, sizeof shown, "%s", t->at < t->end ? "the end of the line" : "the end of the file");
    }
    return report_input(r, t->file, t->line, key, expected, shown, NULL);
}
