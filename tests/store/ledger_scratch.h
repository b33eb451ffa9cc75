/* What the ledger's tests share: a run to write, raw SQL beside the ledger's back, output as text. */
#ifndef SUNDER_TESTS_LEDGER_SCRATCH_H
#define SUNDER_TESTS_LEDGER_SCRATCH_H

#include "scratch.h"
#include "store/ledger.h"

#include <sqlite3.h>

static inline ledger_run sample_run(const char *variant) {
    return (ledger_run){.scene_path = "scenes/solid/tube_pull.lua",
                        .scene_title = "Tube pull",
                        .scene_hash = "00ff",
                        .variant = variant,
                        .command = "sunder run scenes/solid/tube_pull.lua",
                        .output = "/data/runs/x",
                        .precision = "f32",
                        .simd = "avx2",
                        .version = "0.1.0",
                        .effects = "elasticity,fibres,damage",
                        .threads = 2,
                        .particles = 50000,
                        .frames_wanted = 4,
                        .seed = 7};
}

static inline ledger *open_ledger(const char *name) {
    ledger *l;
    report r;
    if (ledger_open(in_scratch("%s", name), &l, &r)) {
        printf("  %s: %s expected %s found %s\n", r.file, r.message, r.expected, r.found);
        abort();
    }
    return l;
}

/* The first value that SQL gives on a connection of its own, as text; "" for none. Good until the next call. */
static inline const char *sql_text(const char *name, const char *sql) {
    static char text[65536];
    sqlite3 *database;
    sqlite3_stmt *statement = NULL;
    text[0] = '\0';
    if (sqlite3_open(in_scratch("%s", name), &database)) abort();
    sqlite3_busy_timeout(database, 10000);
    if (sqlite3_prepare_v2(database, sql, -1, &statement, NULL))
        snprintf(text, sizeof text, "%s", sqlite3_errmsg(database));
    if (statement && sqlite3_step(statement) == SQLITE_ROW && sqlite3_column_text(statement, 0))
        snprintf(text, sizeof text, "%s", (const char *)sqlite3_column_text(statement, 0));
    sqlite3_finalize(statement);
    sqlite3_close(database);
    return text;
}

static inline bool sql_is(const char *name, const char *sql, const char *expected) {
    const char *found = sql_text(name, sql);
    bool same = strcmp(found, expected) == 0;
    if (!same) printf("  %s\n  gave '%s', expected '%s'\n", sql, found, expected);
    return same;
}

static inline void sql_do(const char *name, const char *sql) {
    sqlite3 *database;
    char *message = NULL;
    if (sqlite3_open(in_scratch("%s", name), &database)) abort();
    sqlite3_busy_timeout(database, 10000);
    if (sqlite3_exec(database, sql, NULL, NULL, &message)) {
        printf("  %s: %s\n", sql, message);
        abort();
    }
    sqlite3_close(database);
}

/* Writes a run with parameters, `frames` frames of measures and an end ("running": none). */
static inline void write_run(ledger *l, const char *variant, double eta, int frames, const char *end,
                             char id[LEDGER_ID]) {
    report r;
    ledger_run run = sample_run(variant);
    status s = ledger_begin(l, &run, id, &r);
    if (!s) s = ledger_parameter(l, id, "eta", "1", eta, NULL, true, &r);
    if (!s) s = ledger_parameter(l, id, "gamma", "1", 10, NULL, false, &r);
    if (!s) s = ledger_parameter(l, id, "kernel", "", 0, "cubic", false, &r);
    for (int frame = 0; frame <= frames && !s; frame++) {
        const ledger_value values[] = {
            {"kinetic", 1.5 * frame}, {"broken_fraction", eta * frame / 10}, {"steady", 1.0 / 3.0}};
        s = ledger_frame(l, id, frame, frame / 24.0, 10 * frame, 0.5 * frame, values, 3, &r);
    }
    if (!s && strcmp(end, "running") != 0)
        s = ledger_finish(l, id, end, frames, 10 * frames, 0.5 * frames, NULL, "{\"energy\": {\"kinetic\": 3.5}}", &r);
    if (s) {
        printf("  %s: %s\n", r.file, r.message);
        abort();
    }
}

#endif
