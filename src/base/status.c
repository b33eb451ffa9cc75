#include "base/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void report_clear(report *r) {
    memset(r, 0, sizeof *r);
}

status report_set(report *r, status code, const char *format, ...) {
    report_clear(r);
    r->code = code;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(r->message, sizeof r->message, format, arguments);
    va_end(arguments);
    return code;
}

static void copy_text(char *to, size_t size, const char *from) {
    snprintf(to, size, "%s", from ? from : "");
}

status report_input(report *r, const char *file, int line, const char *key, const char *expected, const char *found,
                    const char *nearest) {
    report_clear(r);
    r->code = STATUS_INPUT;
    r->line = line;
    copy_text(r->file, sizeof r->file, file);
    copy_text(r->key, sizeof r->key, key);
    copy_text(r->expected, sizeof r->expected, expected);
    copy_text(r->found, sizeof r->found, found);
    copy_text(r->nearest, sizeof r->nearest, nearest);
    return STATUS_INPUT;
}

/* Appends formatted text at *used, never past size; snprintf's would-be length is clamped. */
static void append(char *text, size_t size, size_t *used, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

static void append(char *text, size_t size, size_t *used, const char *format, ...) {
    if (*used >= size) return;
    va_list arguments;
    va_start(arguments, format);
    int written = vsnprintf(text + *used, size - *used, format, arguments);
    va_end(arguments);
    if (written > 0) *used += (size_t)written;
}

void report_format(const report *r, char *text, size_t size) {
    size_t used = 0;
    if (size > 0) text[0] = '\0';
    if (r->file[0] && r->line > 0)
        append(text, size, &used, "%s:%d: ", r->file, r->line);
    else if (r->file[0])
        append(text, size, &used, "%s: ", r->file);
    if (r->key[0]) append(text, size, &used, "%s: ", r->key);
    if (r->message[0]) append(text, size, &used, "%s", r->message);
    if (r->message[0] && r->expected[0]) append(text, size, &used, "; ");
    if (r->expected[0]) append(text, size, &used, "expected %s", r->expected);
    if (r->found[0]) append(text, size, &used, "%sfound %s", r->expected[0] ? ", " : "", r->found);
    if (r->nearest[0]) append(text, size, &used, " (did you mean '%s'?)", r->nearest);
}

int status_exit_code(status code) {
    switch (code) {
    case STATUS_OK: return 0;
    case STATUS_INPUT: return 2;
    case STATUS_INTERRUPTED: return 130;
    case STATUS_DIVERGED:
    case STATUS_SYSTEM: break;
    }
    return 1;
}
