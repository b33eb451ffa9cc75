/* Where a run's files are: known only after the run has its id, when the folder is named by it. */
#include "store/ledger_internal.h"

status ledger_set_output(ledger *l, const char *id, const char *output, report *r) {
    int64_t run;
    sqlite3_stmt *statement;
    status s = ledger_write_begin(l, "note a run's folder", r);
    if (s) return s;
    s = ledger_key(l, id, &run, r);
    if (!s) s = ledger_statement(l, "UPDATE runs SET output = ?2 WHERE run = ?1", &statement, r);
    if (!s) {
        bind_integer(statement, 1, run);
        bind_text(statement, 2, output);
        s = ledger_run_statement(l, statement, "note a run's folder", r);
    }
    return ledger_write_end(l, s, "note a run's folder", r);
}
