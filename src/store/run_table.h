/* The ledger's runs as a table in memory: filtered and sorted by any column while a user types, whatever their number.
 *
 * Columns are the run's own (id, status, title …), its parameters, and the measures of its last frame, all by name; those of the
 * latter two kinds are read when they are first asked for. Rows are in the order in which runs began. */
#ifndef SUNDER_STORE_RUN_TABLE_H
#define SUNDER_STORE_RUN_TABLE_H

#include "store/ledger.h"

typedef struct run_table run_table;

typedef enum run_column_kind { RUN_COLUMN_OWN, RUN_COLUMN_PARAMETER, RUN_COLUMN_MEASURE } run_column_kind;

typedef struct run_column {
    const char *name;
    run_column_kind kind;
    bool numeric;       /* every run that has it has a number */
    double *number;     /* [rows]; NaN: none */
    const char **text;  /* [rows]; NULL: none, or a number */
} run_column;

/* Reads all runs; those whose process is gone are marked dead first. Free with run_table_free; the ledger must outlive it. */
status run_table_read(ledger *l, run_table **out, report *r);
void run_table_free(run_table *t);

/* Whether the ledger has changed since the table was read, by another connection or by this one. Cheap: ask as often as you like. */
bool run_table_is_old(const run_table *t);

int run_table_rows(const run_table *t);
const char *run_table_id(const run_table *t, int row);
/* The row of a run, −1 when it is not there. */
int run_table_find(const run_table *t, const char *id);

/* Names of all columns in order: the run's own, parameters, measures; NULL at the end. */
const char *run_table_name(const run_table *t, int index, run_column_kind *kind);

/* A column by its name, or by the end of a dotted one ("eta" of "tube.damage.eta") when only one name ends so; a parameter goes before a
 * measure of the same name. STATUS_INPUT with the nearest. It lives as long as the table. */
status run_table_column(run_table *t, const char *name, const run_column **out, report *r);

/* The rows that fit, newest first: rows [run_table_rows] of which *count are set. A filter is words and conditions, all of which must hold:
 * a word is looked for (whatever its case) in id, status, title, variant, scene, tags, notes and message; a condition is
 * NAME<VALUE, <=, >, >=, =, != or ~ (contains); ! before either turns it round. Unknown names are input errors with the nearest. */
status run_table_filter(run_table *t, const char *filter, int *rows, int *count, report *r);

/* Sorts rows by a column; runs without a value stand last whatever the direction, and ties keep their order. */
status run_table_sort(run_table *t, const char *name, bool descending, int *rows, int count, report *r);

#endif
