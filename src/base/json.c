#include "base/json.h"

#include "base/memory.h"

#include <assert.h>
#include <inttypes.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST_CAPACITY = 1024 };

void json_begin(json_writer *w, int indent) {
    memset(w, 0, sizeof *w);
    w->indent = indent;
}

void json_free(json_writer *w) {
    memory_free(w->text, w->capacity);
    json_begin(w, w->indent);
}

/* ---- raw output -------------------------------------------------------------------------------------------------- */

static bool reserve(json_writer *w, size_t more) {
    if (w->out_of_memory) return false;
    if (w->capacity - w->size > more) return true; /* one byte is kept for the closing NUL */
    size_t capacity = w->capacity ? w->capacity : FIRST_CAPACITY;
    while (capacity - w->size <= more) capacity *= 2;
    char *text = memory_resize(w->text, w->capacity, capacity);
    if (!text) {
        w->out_of_memory = true;
        return false;
    }
    w->text = text;
    w->capacity = capacity;
    return true;
}

static void put(json_writer *w, const char *text, size_t size) {
    if (!reserve(w, size)) return;
    memcpy(w->text + w->size, text, size);
    w->size += size;
}

static void put_text(json_writer *w, const char *text) {
    put(w, text, strlen(text));
}

static void new_line(json_writer *w) {
    if (w->indent == 0) return;
    put(w, "\n", 1);
    for (int i = 0; i < w->indent * w->depth; i++) put(w, " ", 1);
}

/* What stands before a value or key: a comma between members, a line of its own. */
static void separate(json_writer *w) {
    if (w->after_key) {
        w->after_key = false;
        return;
    }
    if (w->filled[w->depth]) put(w, ",", 1);
    if (w->filled[w->depth] && w->indent == 0) put(w, " ", 1);
    if (w->depth > 0) new_line(w);
    w->filled[w->depth] = true;
}

/* ---- structure --------------------------------------------------------------------------------------------------- */

static void open_level(json_writer *w, const char *bracket) {
    assert(w->depth < JSON_DEPTH);
    separate(w);
    put_text(w, bracket);
    w->depth++;
    w->filled[w->depth] = false;
}

static void close_level(json_writer *w, const char *bracket) {
    assert(w->depth > 0 && !w->after_key);
    bool filled = w->filled[w->depth];
    w->depth--;
    if (filled) new_line(w);
    put_text(w, bracket);
}

void json_object(json_writer *w) {
    open_level(w, "{");
}

void json_object_end(json_writer *w) {
    close_level(w, "}");
}

void json_array(json_writer *w) {
    open_level(w, "[");
}

void json_array_end(json_writer *w) {
    close_level(w, "]");
}

/* ---- strings ----------------------------------------------------------------------------------------------------- */

/* Length of the valid UTF-8 sequence at s (no overlong forms, no surrogates, at most U+10FFFF), or 0. */
static size_t sequence_length(const unsigned char *s) {
    if (s[0] < 0x80) return 1;
    size_t length = s[0] >= 0xc2 && s[0] <= 0xdf ? 2 : (s[0] & 0xf0) == 0xe0 ? 3 : s[0] >= 0xf0 && s[0] <= 0xf4 ? 4 : 0;
    for (size_t i = 1; i < length; i++)
        if ((s[i] & 0xc0) != 0x80) return 0;
    if (s[0] == 0xe0 && s[1] < 0xa0) return 0;
    if (s[0] == 0xed && s[1] > 0x9f) return 0;
    if (s[0] == 0xf0 && s[1] < 0x90) return 0;
    if (s[0] == 0xf4 && s[1] > 0x8f) return 0;
    return length;
}

static void put_escaped(json_writer *w, unsigned char c) {
    static const char from[] = "\"\\\b\f\n\r\t", to[] = "\"\\bfnrt";
    const char *known = c ? strchr(from, c) : NULL;
    char text[8];
    if (known)
        snprintf(text, sizeof text, "\\%c", to[known - from]);
    else
        snprintf(text, sizeof text, "\\u%04x", c);
    put_text(w, text);
}

static void put_string(json_writer *w, const char *text) {
    put(w, "\"", 1);
    for (const unsigned char *s = (const unsigned char *)text; *s;) {
        size_t length = sequence_length(s);
        if (length == 0)
            put_text(w, "\xef\xbf\xbd");
        else if (*s < 0x20 || *s == 0x7f || *s == '"' || *s == '\\')
            put_escaped(w, *s);
        else
            put(w, (const char *)s, length);
        s += length ? length : 1;
    }
    put(w, "\"", 1);
}

void json_key(json_writer *w, const char *name) {
    assert(w->depth > 0 && !w->after_key);
    separate(w);
    put_string(w, name);
    put(w, ": ", 2);
    w->after_key = true;
}

void json_string(json_writer *w, const char *text) {
    separate(w);
    if (text)
        put_string(w, text);
    else
        put_text(w, "null");
}

/* ---- numbers and the rest ---------------------------------------------------------------------------------------- */

void json_format_number(double value, char text[JSON_NUMBER]) {
    if (!isfinite(value)) {
        snprintf(text, JSON_NUMBER, "null");
        return;
    }
    static const char *const formats[] = {"%.15g", "%.16g", "%.17g"};
    for (int i = 0; i < 3; i++) {
        snprintf(text, JSON_NUMBER, formats[i], value);
        if (strtod(text, NULL) == value) break;
    }
    /* A workbench that has called setlocale may write a comma, or more than one byte, for the point. */
    const char *point = localeconv()->decimal_point;
    char *found = strcmp(point, ".") != 0 ? strstr(text, point) : NULL;
    if (!found) return;
    *found = '.';
    memmove(found + 1, found + strlen(point), strlen(found + strlen(point)) + 1);
}

void json_number(json_writer *w, double value) {
    char text[JSON_NUMBER];
    json_format_number(value, text);
    separate(w);
    put_text(w, text);
}

void json_integer(json_writer *w, int64_t value) {
    char text[JSON_NUMBER];
    snprintf(text, sizeof text, "%" PRId64, value);
    separate(w);
    put_text(w, text);
}

void json_boolean(json_writer *w, bool value) {
    separate(w);
    put_text(w, value ? "true" : "false");
}

void json_null(json_writer *w) {
    separate(w);
    put_text(w, "null");
}

void json_raw(json_writer *w, const char *json) {
    separate(w);
    put_text(w, json && json[0] ? json : "null");
}

void json_member_object(json_writer *w, const char *name) {
    json_key(w, name);
    json_object(w);
}

void json_member_array(json_writer *w, const char *name) {
    json_key(w, name);
    json_array(w);
}

void json_member_string(json_writer *w, const char *name, const char *text) {
    json_key(w, name);
    json_string(w, text);
}

void json_member_number(json_writer *w, const char *name, double value) {
    json_key(w, name);
    json_number(w, value);
}

void json_member_integer(json_writer *w, const char *name, int64_t value) {
    json_key(w, name);
    json_integer(w, value);
}

void json_member_boolean(json_writer *w, const char *name, bool value) {
    json_key(w, name);
    json_boolean(w, value);
}

status json_finish(json_writer *w, report *r) {
    assert(w->depth == 0 && !w->after_key);
    if (!reserve(w, 0)) return report_set(r, STATUS_SYSTEM, "out of memory for a JSON text of %zu bytes", w->size);
    w->text[w->size] = '\0';
    return STATUS_OK;
}
