/* What the ledger's own files share. */
#ifndef SUNDER_STORE_LEDGER_INTERNAL_H
#define SUNDER_STORE_LEDGER_INTERNAL_H

#include "store/files.h"
#include "store/ledger.h"

#include <sqlite3.h>

enum { STATEMENT_LIMIT = 48 };

struct ledger {
    sqlite3 *database;
    char path[FILE_PATH];
    int batch; /* open ledger_batch_begin calls */
    int statement_count;
    struct {
        const char *sql; /* compared by address: statements are string constants */
        sqlite3_stmt *statement;
    } statements[STATEMENT_LIMIT];
};

/* Runs SQL without results. */
status ledger_execute(ledger *l, const char *sql, const char *doing, report *r);

/* The prepared statement of a string constant, reset and unbound; kept until ledger_close. */
status ledger_statement(ledger *l, const char *sql, sqlite3_stmt **statement, report *r);

/* Binds: NULL text, and numbers that are not finite, become NULL. Texts must live until the statement is reset. */
void bind_text(sqlite3_stmt *statement, int index, const char *text);
void bind_number(sqlite3_stmt *statement, int index, double number);
void bind_integer(sqlite3_stmt *statement, int index, int64_t value);

/* Steps a statement that has no rows to its end and resets it. */
status ledger_run_statement(ledger *l, sqlite3_stmt *statement, const char *doing, report *r);

/* Steps a query: *row tells whether there is one. At the end, and on an error, the statement is reset. */
status ledger_next(ledger *l, sqlite3_stmt *statement, bool *row, const char *doing, report *r);

/* A write: BEGIN IMMEDIATE … COMMIT, or ROLLBACK when `outcome` is an error. Within a batch both leave the transaction
 * to it. ledger_write_end returns `outcome`, or COMMIT's own trouble. */
status ledger_write_begin(ledger *l, const char *doing, report *r);
status ledger_write_end(ledger *l, status outcome, const char *doing, report *r);

/* The key of a run in the table of runs. STATUS_INPUT with the nearest id when there is none. */
status ledger_key(ledger *l, const char *id, int64_t *run, report *r);

/* Marks as dead the runs that say 'running' but whose process is gone. */
status ledger_bury(ledger *l, report *r);

/* STATUS_SYSTEM when writing to `out` has failed (a full disk, a closed pipe). */
status output_check(FILE *out, report *r);

#endif
