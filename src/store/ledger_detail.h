/* One run as the views tell it: what list, show and diff are made from. Internal to this floor. */
#ifndef SUNDER_STORE_LEDGER_DETAIL_H
#define SUNDER_STORE_LEDGER_DETAIL_H

#include "base/json.h"
#include "store/ledger_internal.h"

/* Columns of the detail statement, in order. */
enum {
    DETAIL_ID,
    DETAIL_STATUS,
    DETAIL_SCENE,
    DETAIL_TITLE,
    DETAIL_VARIANT,
    DETAIL_HASH,
    DETAIL_STARTED, /* seconds since 1970 */
    DETAIL_ENDED,
    DETAIL_WALL,
    DETAIL_PARTICLES,
    DETAIL_FRAMES,
    DETAIL_FRAMES_WANTED,
    DETAIL_STEPS,
    DETAIL_TIME,
    DETAIL_THREADS,
    DETAIL_PRECISION,
    DETAIL_SIMD,
    DETAIL_VERSION,
    DETAIL_EFFECTS,
    DETAIL_SEED,
    DETAIL_MESSAGE,
    DETAIL_PARENT,
    DETAIL_PARENT_FRAME,
    DETAIL_COMMAND,
    DETAIL_OUTPUT,
    DETAIL_HOST,
    DETAIL_PID,
    DETAIL_TAGS,
    DETAIL_SUMMARY,
    DETAIL_COUNT
};

/* The detail statement, standing on the row of this run: its columns may be read until it is reset. */
status detail_select(ledger *l, int64_t run, sqlite3_stmt **statement, report *r);

/* A column's text, "" for NULL. */
const char *detail_text(sqlite3_stmt *statement, int column);

/* Binds `run` to ?1 of `sql` and hands every row to `take`. The statement must not be one that is being read. */
typedef status (*detail_row)(void *context, sqlite3_stmt *statement, report *r);
status detail_each(ledger *l, const char *sql, int64_t run, detail_row take, void *context, report *r);

/* The same with a second run for ?2. */
status detail_each_pair(ledger *l, const char *sql, const int64_t runs[2], detail_row take, void *context, report *r);

/* A value of a statement's row: text, exact number or null. */
void detail_json_value(json_writer *w, sqlite3_stmt *statement, int column);

/* The run as one JSON object with its parameters and final measures; `whole` adds how parameters were given, the
 * history of measures, events and notes. */
status detail_json(ledger *l, json_writer *w, int64_t run, bool whole, report *r);

/* Ends a JSON text, prints it on a line of its own and frees it. */
status detail_json_print(json_writer *w, status outcome, FILE *out, report *r);

extern const char detail_parameters_sql[]; /* name, number, text, unit, from_set; by name */
extern const char detail_measures_sql[];   /* name, value; of the last frame, by name */
extern const char detail_events_sql[];     /* frame, happened, kind, text */
extern const char detail_turns_sql[];      /* frame, path, value; in the order in which they act */
extern const char detail_notes_sql[];      /* written, text */

#endif
