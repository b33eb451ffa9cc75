/* What a run was told while it went on, and what a branch has from its parent. */
#include "store/ledger.h"
#include "store/ledger_internal.h"

/* ---- turns ------------------------------------------------------------------------------------------------------- */

static status insert_turn(ledger *l, int64_t run, int number, const ledger_turn *turn, report *r) {
    sqlite3_stmt *statement;
    status s = ledger_statement(l, "INSERT INTO knob_turns VALUES (?1, ?2, ?3, ?4, ?5)", &statement, r);
    if (s) return s;
    bind_integer(statement, 1, run);
    bind_integer(statement, 2, number);
    bind_integer(statement, 3, turn->frame);
    bind_text(statement, 4, turn->path);
    bind_text(statement, 5, turn->value);
    return ledger_run_statement(l, statement, "write a turn", r);
}

static status forget_turns(ledger *l, int64_t run, report *r) {
    sqlite3_stmt *statement;
    status s = ledger_statement(l, "DELETE FROM knob_turns WHERE run = ?1", &statement, r);
    if (s) return s;
    bind_integer(statement, 1, run);
    return ledger_run_statement(l, statement, "write the turns", r);
}

status ledger_turns(ledger *l, const char *id, const ledger_turn *turns, int count, report *r) {
    int64_t run;
    status s = ledger_write_begin(l, "write the turns", r);
    if (s) return s;
    s = ledger_key(l, id, &run, r);
    if (!s) s = forget_turns(l, run, r);
    for (int i = 0; i < count && !s; i++) s = insert_turn(l, run, i, &turns[i], r);
    return ledger_write_end(l, s, "write the turns", r);
}

status ledger_each_turn(ledger *l, const char *id, ledger_turn_taker take, void *context, report *r) {
    int64_t run;
    sqlite3_stmt *statement;
    bool row = true;
    status s = ledger_key(l, id, &run, r);
    if (!s) s = ledger_statement(l, "SELECT frame, path, value FROM knob_turns WHERE run = ?1 ORDER BY turn", &statement, r);
    if (s) return s;
    bind_integer(statement, 1, run);
    while (!(s = ledger_next(l, statement, &row, "read the turns", r)) && row) {
        ledger_turn turn = {sqlite3_column_int64(statement, 0), (const char *)sqlite3_column_text(statement, 1),
                            (const char *)sqlite3_column_text(statement, 2)};
        s = take(context, &turn, r);
        if (s) break;
    }
    sqlite3_reset(statement);
    return s;
}

/* ---- a branch's past --------------------------------------------------------------------------------------------- */

static status copy_rows(ledger *l, const char *sql, int64_t from, int64_t to, int64_t frame, report *r) {
    sqlite3_stmt *statement;
    status s = ledger_statement(l, sql, &statement, r);
    if (s) return s;
    bind_integer(statement, 1, from);
    bind_integer(statement, 2, to);
    bind_integer(statement, 3, frame);
    return ledger_run_statement(l, statement, "copy a run's past", r);
}

status ledger_copy_past(ledger *l, const char *from, const char *id, int64_t frame, report *r) {
    int64_t source = 0, target = 0;
    status s = ledger_write_begin(l, "copy a run's past", r);
    if (s) return s;
    s = ledger_key(l, from, &source, r);
    if (!s) s = ledger_key(l, id, &target, r);
    if (!s)
        s = copy_rows(l, "INSERT INTO frames SELECT ?2, frame, time, steps, wall_seconds FROM frames WHERE run = ?1 AND frame <= ?3", source, target, frame, r);
    if (!s)
        s = copy_rows(l, "INSERT INTO run_measures SELECT ?2, frame, measure, value FROM run_measures WHERE run = ?1 AND frame <= ?3", source, target, frame, r);
    if (!s)
        s = copy_rows(l,
                      "INSERT INTO events (run, frame, happened, kind, text) SELECT ?2, frame, happened, kind, text FROM events "
                      "WHERE run = ?1 AND (frame < ?3 OR (frame = ?3 AND kind <> 'knob')) ORDER BY event",
                      source, target, frame, r);
    if (!s)
        s = copy_rows(l, "UPDATE runs SET scene_path = (SELECT scene_path FROM runs WHERE run = ?1) WHERE run = ?2 AND ?3 >= 0", source, target, frame, r);
    return ledger_write_end(l, s, "copy a run's past", r);
}

status ledger_cut_events(ledger *l, const char *id, int64_t frame, report *r) {
    int64_t run = 0;
    sqlite3_stmt *statement;
    status s = ledger_write_begin(l, "forget events", r);
    if (s) return s;
    s = ledger_key(l, id, &run, r);
    if (!s) s = ledger_statement(l, "DELETE FROM events WHERE run = ?1 AND (frame > ?2 OR (frame = ?2 AND kind = 'knob'))", &statement, r);
    if (!s) {
        bind_integer(statement, 1, run);
        bind_integer(statement, 2, frame);
        s = ledger_run_statement(l, statement, "forget events", r);
    }
    return ledger_write_end(l, s, "forget events", r);
}
