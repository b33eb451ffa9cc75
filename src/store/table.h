/* Aligned columns of text for people. Internal to this floor. */
#ifndef SUNDER_STORE_TABLE_H
#define SUNDER_STORE_TABLE_H

#include "base/status.h"

#include <stdbool.h>
#include <stdio.h>

typedef struct table table;

typedef struct table_column {
    const char *title;
    bool right; /* figures stand to the right */
    int least;  /* the width it may be cut to when room is short; 0: never cut */
    bool keep;  /* shown even when no row has anything in it */
} table_column;

/* A table of `count` columns, which are copied. NULL when out of memory. */
table *table_create(const table_column *columns, int count);
void table_destroy(table *t);

/* Adds a row of copies of the cells [count]; NULL is an empty cell. Control characters become spaces. */
status table_add(table *t, const char *const *cells, report *r);

/* Rows added so far. */
int table_rows(const table *t);

/* Prints the table (and its titles, unless all are empty) within `width` columns where its cut-able columns allow that.
 * Columns without any content are left out, but those that say `keep`. */
void table_print(const table *t, FILE *out, int width, const char *indent);

/* Columns of the terminal behind `out`: $COLUMNS, else the terminal's own word, else 80. */
int table_terminal_width(FILE *out);

#endif
