#include "session/turns_file.h"

#include "base/json.h"
#include "base/memory.h"

#include <ctype.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- writing ----------------------------------------------------------------------------------------------------- */

static void write_turn(json_writer *w, const knob_turn *turn) {
    json_object(w);
    json_member_integer(w, "frame", turn->frame);
    json_member_string(w, "path", turn->path);
    json_member_string(w, "value", turn->value);
    json_object_end(w);
}

status turns_format(const knob_turn *turns, int count, char **text, size_t *size, report *r) {
    enum { LINE = 64 + 6 * (KNOB_PATH + KNOB_TEXT), FRAME = 32 };
    size_t room = FRAME + (size_t)count * LINE, used;
    char *all = memory_allocate(room);
    if (!all) return report_set(r, STATUS_SYSTEM, "out of memory for the turns of knobs");
    used = (size_t)snprintf(all, room, "{\"turns\": [");
    status code = STATUS_OK;
    for (int i = 0; i < count && code == STATUS_OK; i++) {
        json_writer w;
        json_begin(&w, 0);
        write_turn(&w, &turns[i]);
        code = json_finish(&w, r);
        if (code == STATUS_OK) used += (size_t)snprintf(all + used, room - used, "%s\n  %s", i ? "," : "", w.text);
        json_free(&w);
    }
    used += (size_t)snprintf(all + used, room - used, "\n]}\n");
    *text = code == STATUS_OK ? memory_allocate(used + 1) : NULL;
    if (*text) memcpy(*text, all, used + 1);
    else if (code == STATUS_OK) code = report_set(r, STATUS_SYSTEM, "out of memory for the turns of knobs");
    *size = used;
    memory_free(all, room);
    return code;
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

typedef struct reader {
    const char *path, *at, *end;
    int line;
} reader;

static void skip_space(reader *q) {
    for (; q->at < q->end && isspace((unsigned char)*q->at); q->at++) q->line += *q->at == '\n';
}

static bool take(reader *q, char mark) {
    skip_space(q);
    if (q->at == q->end || *q->at != mark) return false;
    q->at++;
    return true;
}

/* \u00e4 as UTF-8; pairs of surrogates are not made by the writer. */
static size_t put_code(unsigned code, char *out) {
    if (code < 0x80) return out[0] = (char)code, 1;
    if (code < 0x800) return out[0] = (char)(0xc0 | code >> 6), out[1] = (char)(0x80 | (code & 0x3f)), 2;
    out[0] = (char)(0xe0 | code >> 12);
    out[1] = (char)(0x80 | (code >> 6 & 0x3f));
    out[2] = (char)(0x80 | (code & 0x3f));
    return 3;
}

static bool take_escape(reader *q, char *out, size_t *length) {
    static const char marks[] = "\"\\/bfnrt", meant[] = "\"\\/\b\f\n\r\t";
    if (q->at == q->end) return false;
    char mark = *q->at++;
    const char *found = mark ? strchr(marks, mark) : NULL;
    if (found) return *out = meant[found - marks], *length = 1, true;
    unsigned code;
    if (mark != 'u' || q->end - q->at < 4 || sscanf(q->at, "%4x", &code) != 1 || code == 0) return false;
    q->at += 4;
    *length = put_code(code, out);
    return true;
}

static bool take_string(reader *q, char *out, size_t size) {
    size_t used = 0;
    if (!take(q, '"')) return false;
    while (q->at < q->end && *q->at != '"') {
        char piece[4];
        size_t length = 1;
        piece[0] = *q->at++;
        if (piece[0] == '\\' && !take_escape(q, piece, &length)) return false;
        if (used + length >= size) return false;
        memcpy(out + used, piece, length);
        used += length;
    }
    out[used] = '\0';
    return take(q, '"');
}

/* A number, true or false without quotes is taken as its text. */
static bool take_value(reader *q, char *out, size_t size) {
    skip_space(q);
    if (q->at < q->end && *q->at == '"') return take_string(q, out, size);
    size_t length = strspn(q->at, "+-.0123456789abcdefghijklmnopqrstuvwxyzE");
    if (length == 0 || length >= size) return false;
    memcpy(out, q->at, length);
    out[length] = '\0';
    q->at += length;
    return true;
}

static bool take_member(reader *q, knob_turn *turn, unsigned *seen) {
    char key[16], number[24], *end;
    if (!take_string(q, key, sizeof key) || !take(q, ':')) return false;
    if (strcmp(key, "path") == 0) return *seen |= 1u, take_string(q, turn->path, sizeof turn->path);
    if (strcmp(key, "value") == 0) return *seen |= 2u, take_value(q, turn->value, sizeof turn->value);
    if (strcmp(key, "frame") != 0 || !take_value(q, number, sizeof number)) return false;
    *seen |= 4u;
    turn->frame = strtoll(number, &end, 10);
    return *end == '\0' && turn->frame >= 0;
}

static bool take_turn(reader *q, knob_turn *turn) {
    unsigned seen = 0;
    *turn = (knob_turn){0};
    if (!take(q, '{')) return false;
    do
        if (!take_member(q, turn, &seen)) return false;
    while (take(q, ','));
    return take(q, '}') && seen == 7u;
}

static status wrong(const reader *q, report *r) {
    return report_input(r, q->path, q->line, "turns", "{\"turns\": [{\"frame\": 12, \"path\": \"…\", \"value\": \"…\"}, …]}", "something else", NULL);
}

static status take_all(reader *q, knob_turn *turns, int limit, int *count, report *r) {
    char key[16];
    if (!take(q, '{') || !take_string(q, key, sizeof key) || strcmp(key, "turns") != 0 || !take(q, ':') || !take(q, '[')) return wrong(q, r);
    *count = 0;
    if (!take(q, ']')) {
        do
            if (*count == limit || !take_turn(q, &turns[(*count)++])) return wrong(q, r);
        while (take(q, ','));
        if (!take(q, ']')) return wrong(q, r);
    }
    if (!take(q, '}')) return wrong(q, r);
    skip_space(q);
    return q->at == q->end ? STATUS_OK : wrong(q, r);
}

status turns_parse(const char *path, const char *text, size_t size, knob_turn **turns, int *count, report *r) {
    int limit = 0;
    for (size_t i = 0; i < size; i++) limit += text[i] == '{';
    knob_turn *all = memory_allocate_array((size_t)limit + 1, sizeof *all);
    *turns = NULL;
    *count = 0;
    if (!all) return report_set(r, STATUS_SYSTEM, "out of memory for the turns of knobs");
    reader q = {path, text, text + size, 1};
    int found = 0;
    status code = take_all(&q, all, limit, &found, r);
    if (code == STATUS_OK && found > 0) {
        *turns = memory_allocate_array((size_t)found, sizeof **turns);
        if (*turns) memcpy(*turns, all, (size_t)found * sizeof **turns), *count = found;
        else code = report_set(r, STATUS_SYSTEM, "out of memory for the turns of knobs");
    }
    memory_free(all, ((size_t)limit + 1) * sizeof *all);
    return code;
}
