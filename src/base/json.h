/* A small JSON writer: text grows in memory, so that a half-made object is never seen by anyone.
 *
 * Commas and indentation are the writer's business. Strings are escaped and made valid UTF-8 (a bad byte becomes
 * U+FFFD); doubles are written with 15 to 17 digits, as few as read back to the same bits, whatever the locale; NaN and
 * ±∞, which JSON lacks, become null. Trouble (out of memory) is remembered and told once, by json_finish. */
#ifndef SUNDER_BASE_JSON_H
#define SUNDER_BASE_JSON_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

enum { JSON_DEPTH = 32, JSON_NUMBER = 40 };

typedef struct json_writer {
    char *text;                  /* NUL-terminated once json_finish has said STATUS_OK */
    size_t size, capacity;       /* bytes used, bytes allocated */
    int indent;                  /* spaces a level; 0: everything on one line */
    int depth;                   /* open objects and arrays */
    bool filled[JSON_DEPTH + 1]; /* whether the value at this depth has had a member */
    bool after_key;
    bool out_of_memory;
} json_writer;

/* Starts an empty text. Pair with json_free. */
void json_begin(json_writer *w, int indent);
void json_free(json_writer *w);

/* Objects and arrays; nested at most JSON_DEPTH deep (a programmer's error beyond). */
void json_object(json_writer *w);
void json_object_end(json_writer *w);
void json_array(json_writer *w);
void json_array_end(json_writer *w);

/* A member's name: the next value written is its value. */
void json_key(json_writer *w, const char *name);

/* Values. A NULL string is written as null. */
void json_string(json_writer *w, const char *text);
void json_number(json_writer *w, double value);
void json_integer(json_writer *w, int64_t value);
void json_boolean(json_writer *w, bool value);
void json_null(json_writer *w);

/* Text that is JSON already, taken as it is; NULL or empty is written as null. */
void json_raw(json_writer *w, const char *json);

/* A member in one call: json_key and the value, or the beginning of one. */
void json_member_object(json_writer *w, const char *name);
void json_member_array(json_writer *w, const char *name);
void json_member_string(json_writer *w, const char *name, const char *text);
void json_member_number(json_writer *w, const char *name, double value);
void json_member_integer(json_writer *w, const char *name, int64_t value);
void json_member_boolean(json_writer *w, const char *name, bool value);

/* Ends the text: everything opened must be closed. STATUS_SYSTEM when memory ran out on the way. */
status json_finish(json_writer *w, report *r);

/* Writes the first of 15, 16 and 17 significant digits that read back to `value` exactly; "null" when it is not finite.
 */
void json_format_number(double value, char text[JSON_NUMBER]);

#endif
