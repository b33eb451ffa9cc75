/* What a run writes of itself into the ledger, and what people write about it afterwards. */
#include "store/ledger.h"

#include "base/names.h"
#include "store/ledger_internal.h"
#include "store/process.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/random.h>
#include <time.h>

static double wall_clock(void) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* ---- dead runs --------------------------------------------------------------------------------------------------- */

static void read_identity(sqlite3_stmt *statement, int column, process_identity *process) {
    snprintf(process->host, sizeof process->host, "%s", (const char *)sqlite3_column_text(statement, column));
    snprintf(process->boot, sizeof process->boot, "%s", (const char *)sqlite3_column_text(statement, column + 1));
    snprintf(process->space, sizeof process->space, "%s", (const char *)sqlite3_column_text(statement, column + 2));
    process->pid = sqlite3_column_int64(statement, column + 3);
    process->started = sqlite3_column_int64(statement, column + 4);
}

/* One dead run, or 0. `after` lets the search go on where it stopped. */
static status find_dead(ledger *l, int64_t after, int64_t *run, report *r) {
    sqlite3_stmt *statement;
    bool row = true;
    *run = 0;
    status s = ledger_statement(l,
                                "SELECT run, host, boot, pid_space, pid, pid_started FROM runs "
                                "WHERE status = 'running' AND run > ?1 ORDER BY run",
                                &statement, r);
    if (s) return s;
    bind_integer(statement, 1, after);
    while (*run == 0 && !(s = ledger_next(l, statement, &row, "look for dead runs", r)) && row) {
        process_identity process;
        read_identity(statement, 1, &process);
        if (process_is_gone(&process)) *run = sqlite3_column_int64(statement, 0);
    }
    sqlite3_reset(statement);
    return s;
}

static status bury_one(ledger *l, int64_t run, report *r) {
    sqlite3_stmt *statement;
    status s = ledger_statement(
        l,
        "UPDATE runs SET status = 'dead', message = 'its process (' || pid || ' on ' || host || ') ended "
        "without a word' WHERE run = ?1 AND status = 'running'",
        &statement, r);
    if (s) return s;
    bind_integer(statement, 1, run);
    return ledger_run_statement(l, statement, "mark a dead run", r);
}

status ledger_bury(ledger *l, report *r) {
    int64_t run;
    status s = find_dead(l, 0, &run, r);
    if (s || run == 0) return s; /* nearly always: a reader then takes no write lock */
    s = ledger_write_begin(l, "mark dead runs", r);
    if (s) return s;
    for (run = 0; !(s = find_dead(l, run, &run, r)) && run != 0 && !(s = bury_one(l, run, r));) {
    }
    return ledger_write_end(l, s, "mark dead runs", r);
}

/* ---- the run ----------------------------------------------------------------------------------------------------- */

/* UTC to the second and four random digits: sorts by time whatever the clock's zone did. */
static void make_id(double now, char id[LEDGER_ID]) {
    time_t seconds = (time_t)now;
    struct tm utc;
    gmtime_r(&seconds, &utc);
    uint16_t random;
    if (getrandom(&random, sizeof random, 0) != (ssize_t)sizeof random) random = (uint16_t)(1e9 * (now - floor(now)));
    size_t used = strftime(id, LEDGER_ID, "%Y%m%d-%H%M%S", &utc);
    snprintf(id + used, LEDGER_ID - used, "-%04x", random);
}

static const char *or_empty(const char *text) {
    return text ? text : "";
}

static void bind_identity(sqlite3_stmt *statement, int index, const process_identity *self) {
    bind_text(statement, index, self->host);
    bind_text(statement, index + 1, self->boot);
    bind_text(statement, index + 2, self->space);
    bind_integer(statement, index + 3, self->pid);
    bind_integer(statement, index + 4, self->started);
}

static void bind_run(sqlite3_stmt *statement, const ledger_run *run) {
    const char *const texts[] = {run->scene_path, run->scene_title, run->scene_hash, run->command, run->output,
                                 run->precision,  run->simd,        run->version,    run->effects};
    const int64_t numbers[] = {run->threads, run->particles, run->frames_wanted, run->seed};
    int index = 3;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) bind_text(statement, index++, or_empty(texts[i]));
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) bind_integer(statement, index++, numbers[i]);
    bind_text(statement, index++, run->variant);
    bind_text(statement, index++, run->parent);
    if (run->parent) bind_integer(statement, index, run->parent_frame);
}

/* Two runs may begin in the same second with the same four digits: nothing is inserted then, and the next id is tried.
 */
static status insert_run(ledger *l, const ledger_run *run, char id[LEDGER_ID], report *r) {
    static const char sql[] =
        "INSERT INTO runs (status, id, started, scene_path, scene_title, scene_hash, command, output, precision, simd, "
        "version, effects, threads, particles, frames_wanted, seed, variant, parent, parent_frame, "
        "host, boot, pid_space, pid, pid_started) "
        "VALUES ('running', ?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18, ?19, ?20, "
        "?21, "
        "?22, ?23) ON CONFLICT (id) DO NOTHING";
    enum { TRIES = 64 };
    process_identity self;
    process_self(&self);
    for (int tries = 0; tries < TRIES; tries++) {
        sqlite3_stmt *statement;
        status s = ledger_statement(l, sql, &statement, r);
        if (s) return s;
        double now = wall_clock();
        make_id(now, id);
        bind_text(statement, 1, id);
        sqlite3_bind_double(statement, 2, now);
        bind_run(statement, run);
        bind_identity(statement, 19, &self);
        s = ledger_run_statement(l, statement, "write a new run", r);
        if (s || sqlite3_changes(l->database) == 1) return s;
    }
    return report_set(r, STATUS_SYSTEM, "%s: no free run id in %d tries", l->path, (int)TRIES);
}

status ledger_begin(ledger *l, const ledger_run *run, char id[LEDGER_ID], report *r) {
    status s = ledger_bury(l, r);
    if (!s) s = ledger_write_begin(l, "write a new run", r);
    return s ? s : ledger_write_end(l, insert_run(l, run, id, r), "write a new run", r);
}

status ledger_parameter(ledger *l, const char *id, const char *name, const char *unit, double number, const char *text,
                        bool from_set, report *r) {
    int64_t run;
    sqlite3_stmt *statement;
    char odd[16];
    if (!text && !isfinite(number)) { /* a stop time of infinity is a value, not a missing one */
        snprintf(odd, sizeof odd, "%s", isnan(number) ? "nan" : number > 0 ? "inf" : "-inf");
        text = odd;
    }
    status s = ledger_write_begin(l, "write a parameter", r);
    if (s) return s;
    s = ledger_key(l, id, &run, r);
    if (!s)
        s = ledger_statement(l, "INSERT OR REPLACE INTO run_parameters VALUES (?1, ?2, ?3, ?4, ?5, ?6)", &statement, r);
    if (!s) {
        bind_integer(statement, 1, run);
        bind_text(statement, 2, name);
        bind_text(statement, 3, or_empty(unit));
        if (!text) bind_number(statement, 4, number);
        bind_text(statement, 5, text);
        bind_integer(statement, 6, from_set);
        s = ledger_run_statement(l, statement, "write a parameter", r);
    }
    return ledger_write_end(l, s, "write a parameter", r);
}

/* ---- frames ------------------------------------------------------------------------------------------------------ */

/* Statements of the form "… run = ?1 AND frame >= ?2". */
static status run_on_frames(ledger *l, const char *sql, int64_t run, int64_t frame, report *r) {
    sqlite3_stmt *statement;
    status s = ledger_statement(l, sql, &statement, r);
    if (s) return s;
    bind_integer(statement, 1, run);
    bind_integer(statement, 2, frame);
    return ledger_run_statement(l, statement, "make room for a frame", r);
}

static status insert_frame(ledger *l, int64_t run, int64_t frame, double time, int64_t steps, double wall_seconds,
                           report *r) {
    sqlite3_stmt *statement;
    status s = ledger_statement(l, "INSERT INTO frames VALUES (?1, ?2, ?3, ?4, ?5)", &statement, r);
    if (s) return s;
    bind_integer(statement, 1, run);
    bind_integer(statement, 2, frame);
    bind_number(statement, 3, time);
    bind_integer(statement, 4, steps);
    bind_number(statement, 5, wall_seconds);
    return ledger_run_statement(l, statement, "write a frame", r);
}

static status insert_value(ledger *l, int64_t run, int64_t frame, const ledger_value *value, report *r) {
    sqlite3_stmt *name, *measure;
    status s = ledger_statement(l, "INSERT INTO measures (name) VALUES (?1) ON CONFLICT (name) DO NOTHING", &name, r);
    if (!s)
        s = ledger_statement(l,
                             "INSERT OR REPLACE INTO run_measures VALUES "
                             "(?1, ?2, (SELECT measure FROM measures WHERE name = ?3), ?4)",
                             &measure, r);
    if (s) return s;
    bind_text(name, 1, value->name);
    s = ledger_run_statement(l, name, "write a measure's name", r);
    if (s) return s;
    bind_integer(measure, 1, run);
    bind_integer(measure, 2, frame);
    bind_text(measure, 3, value->name);
    bind_number(measure, 4, value->value);
    return ledger_run_statement(l, measure, "write a measure", r);
}

status ledger_frame(ledger *l, const char *id, int64_t frame, double time, int64_t steps, double wall_seconds,
                    const ledger_value *values, int count, report *r) {
    int64_t run;
    status s = ledger_write_begin(l, "write a frame", r);
    if (s) return s;
    s = ledger_key(l, id, &run, r);
    if (!s) s = run_on_frames(l, "DELETE FROM frames WHERE run = ?1 AND frame >= ?2", run, frame, r);
    /* Who writes a frame is alive, whatever an onlooker with another view of the processes made of it. */
    if (!s)
        s = run_on_frames(
            l, "UPDATE runs SET status = 'running', message = NULL WHERE run = ?1 AND ?2 >= 0 AND status = 'dead'", run,
            frame, r);
    if (!s) s = insert_frame(l, run, frame, time, steps, wall_seconds, r);
    for (int i = 0; i < count && !s; i++) s = insert_value(l, run, frame, &values[i], r);
    return ledger_write_end(l, s, "write a frame", r);
}

status ledger_event(ledger *l, const char *id, int64_t frame, const char *kind, const char *text, report *r) {
    int64_t run;
    sqlite3_stmt *statement;
    status s = ledger_write_begin(l, "write an event", r);
    if (s) return s;
    s = ledger_key(l, id, &run, r);
    if (!s)
        s = ledger_statement(l, "INSERT INTO events (run, frame, happened, kind, text) VALUES (?1, ?2, ?3, ?4, ?5)",
                             &statement, r);
    if (!s) {
        bind_integer(statement, 1, run);
        bind_integer(statement, 2, frame);
        sqlite3_bind_double(statement, 3, wall_clock());
        bind_text(statement, 4, kind);
        bind_text(statement, 5, or_empty(text));
        s = ledger_run_statement(l, statement, "write an event", r);
    }
    return ledger_write_end(l, s, "write an event", r);
}

/* ---- the end, and a new beginning -------------------------------------------------------------------------------- */

static status check_status(const char *run_status, report *r) {
    static const char *const known[] = {"done", "failed", "interrupted", "dead"};
    enum { KNOWN = sizeof known / sizeof known[0] };
    for (int i = 0; i < KNOWN; i++)
        if (strcmp(run_status, known[i]) == 0) return STATUS_OK;
    return report_input(r, NULL, 0, "status", "done, failed, interrupted or dead", run_status,
                        name_nearest(run_status, known, KNOWN));
}

status ledger_finish(ledger *l, const char *id, const char *run_status, int64_t frames, int64_t steps,
                     double wall_seconds, const char *message, const char *summary_json, report *r) {
    static const char sql[] = "UPDATE runs SET status = ?2, ended = ?3, frames = ?4, steps = ?5, wall_seconds = ?6, "
                              "message = ?7, summary = ?8 WHERE run = ?1";
    int64_t run;
    sqlite3_stmt *statement;
    status s = check_status(run_status, r);
    if (!s) s = ledger_write_begin(l, "end a run", r);
    if (s) return s;
    s = ledger_key(l, id, &run, r);
    if (!s) s = ledger_statement(l, sql, &statement, r);
    if (!s) {
        bind_integer(statement, 1, run);
        bind_text(statement, 2, run_status);
        sqlite3_bind_double(statement, 3, wall_clock());
        bind_integer(statement, 4, frames);
        bind_integer(statement, 5, steps);
        bind_number(statement, 6, wall_seconds);
        bind_text(statement, 7, message);
        bind_text(statement, 8, summary_json);
        s = ledger_run_statement(l, statement, "end a run", r);
    }
    return ledger_write_end(l, s, "end a run", r);
}

/* Whether a process of this host, other than this one, is writing the run. */
static status check_free(ledger *l, int64_t run, const char *id, const char *wanted, report *r) {
    sqlite3_stmt *statement;
    bool row;
    process_identity self, process = {0};
    process_self(&self);
    status s = ledger_statement(
        l, "SELECT host, boot, pid_space, pid, pid_started FROM runs WHERE run = ?1 AND status = 'running'", &statement,
        r);
    if (s) return s;
    bind_integer(statement, 1, run);
    s = ledger_next(l, statement, &row, "look a run up", r);
    if (row) read_identity(statement, 0, &process);
    sqlite3_reset(statement);
    if (s || !row || strcmp(process.host, self.host) != 0) return s;
    if (process.pid == self.pid || process_is_gone(&process)) return STATUS_OK;
    char found[128];
    snprintf(found, sizeof found, "one that process %" PRId64 " is still writing", process.pid);
    return report_input(r, l->path, 0, id, wanted, found, NULL);
}

status ledger_reopen(ledger *l, const char *id, report *r) {
    static const char sql[] =
        "UPDATE runs SET status = 'running', ended = NULL, frames = NULL, steps = NULL, wall_seconds = NULL, message = "
        "NULL, "
        "summary = NULL, host = ?2, boot = ?3, pid_space = ?4, pid = ?5, pid_started = ?6 WHERE run = ?1";
    int64_t run;
    sqlite3_stmt *statement;
    process_identity self;
    process_self(&self);
    status s = ledger_write_begin(l, "reopen a run", r);
    if (s) return s;
    s = ledger_key(l, id, &run, r);
    if (!s) s = check_free(l, run, id, "a run that has ended", r);
    if (!s) s = ledger_statement(l, sql, &statement, r);
    if (!s) {
        bind_integer(statement, 1, run);
        bind_identity(statement, 2, &self);
        s = ledger_run_statement(l, statement, "reopen a run", r);
    }
    return ledger_write_end(l, s, "reopen a run", r);
}

status ledger_remove(ledger *l, const char *id, report *r) {
    int64_t run;
    sqlite3_stmt *statement;
    status s = ledger_write_begin(l, "remove a run", r);
    if (s) return s;
    s = ledger_key(l, id, &run, r);
    if (!s) s = check_free(l, run, id, "a run that has ended", r);
    if (!s) s = ledger_statement(l, "DELETE FROM runs WHERE run = ?1", &statement, r);
    if (!s) {
        bind_integer(statement, 1, run);
        s = ledger_run_statement(l, statement, "remove a run", r);
    }
    return ledger_write_end(l, s, "remove a run", r);
}

/* ---- tags and notes ---------------------------------------------------------------------------------------------- */

static status check_tag(const char *tag, report *r) {
    enum { LONGEST = 64 };
    size_t length = strlen(tag);
    bool good = length > 0 && length <= LONGEST && !strchr(tag, ',');
    for (size_t i = 0; i < length && good; i++) good = (unsigned char)tag[i] >= 0x20 && tag[i] != 0x7f;
    return good ? STATUS_OK
                : report_input(r, NULL, 0, "tag", "1 to 64 bytes without commas or control characters", tag, NULL);
}

/* The report for a tag that the run does not have. */
static status unknown_tag(ledger *l, int64_t run, const char *id, const char *tag, report *r) {
    enum { CANDIDATES = 64 };
    char tags[CANDIDATES][80];
    const char *pointers[CANDIDATES];
    int count = 0;
    sqlite3_stmt *statement;
    bool row = true;
    status s = ledger_statement(l, "SELECT tag FROM tags WHERE run = ?1", &statement, r);
    if (s) return s;
    bind_integer(statement, 1, run);
    while (count < CANDIDATES && !(s = ledger_next(l, statement, &row, "read the tags", r)) && row) {
        snprintf(tags[count], sizeof tags[count], "%s", (const char *)sqlite3_column_text(statement, 0));
        pointers[count] = tags[count];
        count++;
    }
    sqlite3_reset(statement);
    return s ? s : report_input(r, l->path, 0, id, "a tag of this run", tag, name_nearest(tag, pointers, count));
}

status ledger_tag(ledger *l, const char *id, const char *tag, bool on, report *r) {
    int64_t run;
    sqlite3_stmt *statement;
    status s = check_tag(tag, r);
    if (!s) s = ledger_write_begin(l, "write a tag", r);
    if (s) return s;
    s = ledger_key(l, id, &run, r);
    if (!s && on) s = ledger_statement(l, "INSERT OR IGNORE INTO tags VALUES (?1, ?2)", &statement, r);
    if (!s && !on) s = ledger_statement(l, "DELETE FROM tags WHERE run = ?1 AND tag = ?2", &statement, r);
    if (!s) {
        bind_integer(statement, 1, run);
        bind_text(statement, 2, tag);
        s = ledger_run_statement(l, statement, "write a tag", r);
    }
    if (!s && !on && sqlite3_changes(l->database) == 0) s = unknown_tag(l, run, id, tag, r);
    return ledger_write_end(l, s, "write a tag", r);
}

status ledger_note(ledger *l, const char *id, const char *text, report *r) {
    int64_t run;
    sqlite3_stmt *statement;
    status s = ledger_write_begin(l, "write a note", r);
    if (s) return s;
    s = ledger_key(l, id, &run, r);
    if (!s) s = ledger_statement(l, "INSERT INTO notes (run, written, text) VALUES (?1, ?2, ?3)", &statement, r);
    if (!s) {
        bind_integer(statement, 1, run);
        sqlite3_bind_double(statement, 2, wall_clock());
        bind_text(statement, 3, text);
        s = ledger_run_statement(l, statement, "write a note", r);
    }
    return ledger_write_end(l, s, "write a note", r);
}

/* ---- what never began ---------------------------------------------------------------------------------------------- */

status ledger_refusal(ledger *l, const char *name, const char *precision, const char *text, report *r) {
    sqlite3_stmt *statement;
    status s = ledger_write_begin(l, "write a refusal", r);
    if (s) return s;
    if (text) s = ledger_statement(l, "INSERT OR REPLACE INTO refusals VALUES (?1, ?2, ?3, ?4)", &statement, r);
    else s = ledger_statement(l, "DELETE FROM refusals WHERE name = ?1 AND precision = ?2", &statement, r);
    if (!s) {
        bind_text(statement, 1, name);
        bind_text(statement, 2, precision);
        if (text) sqlite3_bind_double(statement, 3, wall_clock());
        if (text) bind_text(statement, 4, text);
        s = ledger_run_statement(l, statement, "write a refusal", r);
    }
    return ledger_write_end(l, s, "write a refusal", r);
}
