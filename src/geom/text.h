/* Words and numbers of text files that people or other programs wrote: meshes, tables of directions.
 *
 * The text need not end in a NUL, and numbers are read without the C library's locale, which a terminal program sets. */
#ifndef SUNDER_GEOM_TEXT_H
#define SUNDER_GEOM_TEXT_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* Where a reader is. Words end at blanks and line ends, and at commas and semicolons too when `commas` is set. */
typedef struct text_reader {
    const char *file; /* for messages */
    const char *at, *end;
    int line; /* from 1 */
    bool commas;
} text_reader;

typedef struct text_word {
    const char *text;
    size_t size;
} text_word;

text_reader text_open(const char *file, const void *data, size_t size);

/* The next word of the line; false at its end. A backslash before the line's end joins the next line to it. */
bool text_word_on_line(text_reader *t, text_word *word);

/* The next word, on whatever line; false at the end of the text. */
bool text_next_word(text_reader *t, text_word *word);

/* Goes behind the line's end; false when there is no further line. */
bool text_next_line(text_reader *t);

bool text_is(const text_word *word, const char *what);

/* The whole word as a number; false when it is none or not finite. */
bool text_number(const text_word *word, double *value);

/* Fills `r`: at the reader's line, under `key`, `expected` was wanted and `found` was there (NULL: the end of the line
 * or of the file). Returns STATUS_INPUT. */
status text_wrong(const text_reader *t, const char *key, const char *expected, const text_word *found, report *r);

#endif
