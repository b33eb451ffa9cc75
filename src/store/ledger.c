/* The ledger's ground: paths, opening, migrating, statements, transactions. */
#include "store/ledger.h"

#include "base/memory.h"
#include "base/names.h"
#include "store/ledger_internal.h"
#include "store/sql.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <pwd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum {
    BUSY_MILLISECONDS = 10000,
    APPLICATION_ID = 0x736e6472, /* as in 001_initial.sql */
};

/* ---- paths ------------------------------------------------------------------------------------------------------- */

/* The user's data folder for sunder, by the XDG base directory rules: a relative $XDG_DATA_HOME is ignored. */
static status data_folder(char path[FILE_PATH], report *r) {
    const char *data = getenv("XDG_DATA_HOME"), *home = getenv("HOME");
    if (data && data[0] == '/') return path_format(path, r, "%s/sunder", data);
    if (!home || home[0] != '/') {
        const struct passwd *user = getpwuid(getuid());
        home = user ? user->pw_dir : NULL;
    }
    if (home && home[0] == '/') return path_format(path, r, "%s/.local/share/sunder", home);
    return report_input(r, NULL, 0, "HOME", "a home folder, or --db and --out", "none", NULL);
}

static status copy_path(char *path, size_t size, const char *from, report *r) {
    if (strlen(from) < size) return memcpy(path, from, strlen(from) + 1), STATUS_OK;
    return report_input(r, from, 0, NULL, "a shorter path", "one that does not fit", NULL);
}

status ledger_default_path(char *path, size_t size, report *r) {
    const char *database = getenv("SUNDER_DB");
    if (database && database[0]) return copy_path(path, size, database, r);
    char folder[FILE_PATH], full[FILE_PATH];
    status s = data_folder(folder, r);
    if (!s) s = path_format(full, r, "%s/ledger.db", folder);
    return s ? s : copy_path(path, size, full, r);
}

status ledger_runs_folder(char *path, size_t size, report *r) {
    char folder[FILE_PATH], full[FILE_PATH];
    status s = data_folder(folder, r);
    if (!s) s = path_format(full, r, "%s/runs", folder);
    return s ? s : copy_path(path, size, full, r);
}

/* ---- statements -------------------------------------------------------------------------------------------------- */

/* Fills `r` with STATUS_SYSTEM: "PATH: cannot DOING: SQLite's message". */
static status fail(ledger *l, const char *doing, report *r) {
    int code = l->database ? sqlite3_errcode(l->database) : SQLITE_NOMEM;
    const char *message = l->database ? sqlite3_errmsg(l->database) : "out of memory";
    if ((code & 0xff) == SQLITE_BUSY) message = "another process has kept it locked for ten seconds";
    report_set(r, STATUS_SYSTEM, "cannot %s: %s", doing, message);
    report_file(r, l->path);
    return STATUS_SYSTEM;
}

status ledger_execute(ledger *l, const char *sql, const char *doing, report *r) {
    return sqlite3_exec(l->database, sql, NULL, NULL, NULL) == SQLITE_OK ? STATUS_OK : fail(l, doing, r);
}

status ledger_statement(ledger *l, const char *sql, sqlite3_stmt **statement, report *r) {
    for (int i = 0; i < l->statement_count; i++) {
        if (l->statements[i].sql != sql) continue;
        *statement = l->statements[i].statement;
        sqlite3_reset(*statement);
        sqlite3_clear_bindings(*statement);
        return STATUS_OK;
    }
    assert(l->statement_count < STATEMENT_LIMIT);
    if (sqlite3_prepare_v3(l->database, sql, -1, SQLITE_PREPARE_PERSISTENT, statement, NULL) != SQLITE_OK)
        return fail(l, "prepare a statement", r);
    l->statements[l->statement_count].sql = sql;
    l->statements[l->statement_count++].statement = *statement;
    return STATUS_OK;
}

void bind_text(sqlite3_stmt *statement, int index, const char *text) {
    sqlite3_bind_text(statement, index, text, -1, SQLITE_STATIC);
}

void bind_number(sqlite3_stmt *statement, int index, double number) {
    if (isfinite(number))
        sqlite3_bind_double(statement, index, number);
    else
        sqlite3_bind_null(statement, index);
}

void bind_integer(sqlite3_stmt *statement, int index, int64_t value) {
    sqlite3_bind_int64(statement, index, value);
}

status ledger_next(ledger *l, sqlite3_stmt *statement, bool *row, const char *doing, report *r) {
    int code = sqlite3_step(statement);
    *row = code == SQLITE_ROW;
    if (*row) return STATUS_OK;
    status s = code == SQLITE_DONE ? STATUS_OK : fail(l, doing, r);
    sqlite3_reset(statement);
    return s;
}

status ledger_run_statement(ledger *l, sqlite3_stmt *statement, const char *doing, report *r) {
    bool row = true;
    status s = STATUS_OK;
    while (!s && row) s = ledger_next(l, statement, &row, doing, r);
    return s;
}

/* ---- transactions ------------------------------------------------------------------------------------------------ */

/* IMMEDIATE: a deferred transaction that reads before it writes fails at once when another writer came between, and no
 * busy timeout helps it. */
status ledger_write_begin(ledger *l, const char *doing, report *r) {
    return l->batch > 0 ? STATUS_OK : ledger_execute(l, "BEGIN IMMEDIATE", doing, r);
}

status ledger_write_end(ledger *l, status outcome, const char *doing, report *r) {
    if (l->batch > 0) return outcome;
    if (!outcome) outcome = ledger_execute(l, "COMMIT", doing, r);
    if (outcome && !sqlite3_get_autocommit(l->database)) sqlite3_exec(l->database, "ROLLBACK", NULL, NULL, NULL);
    return outcome;
}

status ledger_batch_begin(ledger *l, report *r) {
    status s = ledger_write_begin(l, "begin a batch", r);
    if (!s) l->batch++;
    return s;
}

status ledger_batch_end(ledger *l, status outcome, report *r) {
    assert(l->batch > 0);
    l->batch--;
    return ledger_write_end(l, outcome, "commit a batch", r);
}

/* ---- opening ----------------------------------------------------------------------------------------------------- */

typedef struct identity {
    int64_t application, version, tables;
} identity;

/* In one statement, so that another process that makes the schema meanwhile is seen before or after, not halfway. */
static status read_identity(ledger *l, identity *found, report *r) {
    static const char sql[] = "SELECT application_id, user_version, (SELECT count(*) FROM sqlite_schema) "
                              "FROM pragma_application_id, pragma_user_version";
    sqlite3_stmt *statement;
    int code = sqlite3_prepare_v2(l->database, sql, -1, &statement, NULL);
    if (code == SQLITE_OK) code = sqlite3_step(statement);
    status s = code == SQLITE_ROW ? STATUS_OK : fail(l, "read it", r);
    if (!s)
        *found = (identity){sqlite3_column_int64(statement, 0), sqlite3_column_int64(statement, 1),
                            sqlite3_column_int64(statement, 2)};
    sqlite3_finalize(statement);
    if (code == SQLITE_NOTADB)
        return report_input(r, l->path, 0, NULL, "a sunder ledger", "a file that is no SQLite database", NULL);
    return s;
}

/* Refuses other programs' databases and schemas from the future; tells which version this is (0: empty). */
static status check_identity(ledger *l, int64_t *version, report *r) {
    identity found_here = {0};
    status s = read_identity(l, &found_here, r);
    if (s) return s;
    *version = found_here.version;
    if (found_here.tables == 0 && found_here.application == 0) return STATUS_OK;
    if (found_here.application != APPLICATION_ID)
        return report_input(r, l->path, 0, NULL, "a sunder ledger", "another program's SQLite database", NULL);
    if (*version <= sql_schema_count) return STATUS_OK;
    char expected[64], found[64];
    snprintf(expected, sizeof expected, "a ledger of schema %d or older", sql_schema_count);
    snprintf(found, sizeof found, "schema %lld, made by a newer sunder", (long long)*version);
    return report_input(r, l->path, 0, NULL, expected, found, NULL);
}

static status apply_migration(ledger *l, int version, report *r) {
    const sql_file *file = &sql_schema[version - 1];
    char text[256], doing[128];
    snprintf(doing, sizeof doing, "bring its schema to version %d (%s)", version, file->name);
    snprintf(text, sizeof text,
             "INSERT INTO migrations VALUES (%d, '%s', strftime('%%Y-%%m-%%dT%%H:%%M:%%SZ')); PRAGMA user_version = %d",
             version, file->name, version);
    status s = ledger_execute(l, file->text, doing, r);
    return s ? s : ledger_execute(l, text, doing, r);
}

static status migrate(ledger *l, report *r) {
    int64_t version = 0;
    status s = ledger_write_begin(l, "begin to write to it", r);
    if (s) return s;
    s = check_identity(l, &version, r); /* again, now that nobody else can be at it */
    for (int next = (int)version + 1; !s && next <= sql_schema_count; next++) s = apply_migration(l, next, r);
    return ledger_write_end(l, s, "commit its schema", r);
}

/* SQLite answers "busy" at once, without its timeout, when two processes turn the write-ahead log on together. On a
 * file system that cannot have one, the rollback journal stays, and everything works but slower. */
static status use_write_ahead_log(ledger *l, report *r) {
    const struct timespec pause = {.tv_nsec = 10 * 1000 * 1000};
    for (int tries = 0;; tries++) {
        int code = sqlite3_exec(l->database, "PRAGMA journal_mode = WAL", NULL, NULL, NULL);
        if (code == SQLITE_OK) return STATUS_OK;
        if (code != SQLITE_BUSY || tries == BUSY_MILLISECONDS / 10)
            return fail(l, "turn its write-ahead log on", r);
        nanosleep(&pause, NULL);
    }
}

/* No automatic checkpoints: before version 3.51.3 two connections that checkpoint at once could, rarely, lose a reset
 * log. The last connection to close checkpoints alone, with the file locked. */
static status configure(ledger *l, report *r) {
    status s = use_write_ahead_log(l, r);
    return s ? s
             : ledger_execute(l, "PRAGMA foreign_keys = ON; PRAGMA wal_autocheckpoint = 0; PRAGMA synchronous = FULL",
                              "configure it", r);
}

/* What SQLite says too late or too vaguely. */
static status check_path(const char *path, report *r) {
    struct stat info;
    if (!path[0]) return report_input(r, NULL, 0, "--db", "the path of a ledger", "an empty one", NULL);
    if (stat(path, &info) == 0 && S_ISDIR(info.st_mode))
        return report_input(r, path, 0, NULL, "a ledger file", "a folder", NULL);
    char folder[FILE_PATH];
    status s = path_format(folder, r, "%s", path);
    char *slash = s ? NULL : strrchr(folder, '/');
    if (!slash || slash == folder) return s;
    *slash = '\0';
    return folder_create(folder, r);
}

/* SQLite tries again to read only when it may not write, and then tells the second trouble. */
static status cannot_open(ledger *l, report *r) {
    char folder[FILE_PATH];
    snprintf(folder, sizeof folder, "%s", l->path);
    char *slash = strrchr(folder, '/');
    if (slash) slash[slash == folder] = '\0';
    const char *probe = access(l->path, F_OK) == 0 ? l->path : slash ? folder : ".";
    return access(probe, W_OK) != 0 ? file_fail(r, l->path, "open the ledger", errno)
                                    : fail(l, "open the ledger", r);
}

static status open_database(ledger *l, report *r) {
    int64_t version;
    if (sqlite3_open_v2(l->path, &l->database, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_FULLMUTEX,
                        NULL))
        return cannot_open(l, r);
    sqlite3_busy_timeout(l->database, BUSY_MILLISECONDS);
    status s = check_identity(l, &version, r);
    if (s) return s;
    if (sqlite3_db_readonly(l->database, "main") == 1) return file_fail(r, l->path, "write to the ledger", EACCES);
    s = configure(l, r);
    return s || version == sql_schema_count ? s : migrate(l, r);
}

status ledger_open(const char *path, ledger **out, report *r) {
    *out = NULL;
    status s = check_path(path, r);
    if (s) return s;
    ledger *l = memory_allocate(sizeof *l);
    if (!l) return report_set(r, STATUS_SYSTEM, "out of memory for the ledger");
    s = path_format(l->path, r, "%s", path);
    if (!s) s = open_database(l, r);
    if (s)
        ledger_close(l);
    else
        *out = l;
    return s;
}

status ledger_open_given(const char *given, char *path, size_t size, ledger **out, report *r) {
    *out = NULL;
    status s = given ? copy_path(path, size, given, r) : ledger_default_path(path, size, r);
    return s ? s : ledger_open(path, out, r);
}

status ledger_open_past(const char *given, char *path, size_t size, ledger **out, report *r) {
    *out = NULL;
    if (given && *given && access(given, F_OK) != 0 && errno == ENOENT)
        return report_input(r, given, 0, "--db", "a ledger that is there", "none", NULL);
    return ledger_open_given(given, path, size, out, r);
}

void ledger_close(ledger *l) {
    if (!l) return;
    for (int i = 0; i < l->statement_count; i++) sqlite3_finalize(l->statements[i].statement);
    sqlite3_close(l->database);
    memory_free(l, sizeof *l);
}

/* ---- finding runs ------------------------------------------------------------------------------------------------ */

/* The id nearest to what was typed, among the newest runs. */
static void nearest_id(ledger *l, const char *name, char nearest[LEDGER_ID]) {
    enum { CANDIDATES = 256 };
    char ids[CANDIDATES][LEDGER_ID];
    const char *pointers[CANDIDATES];
    int count = 0;
    sqlite3_stmt *statement;
    report ignored;
    bool row = true;
    nearest[0] = '\0';
    if (ledger_statement(l, "SELECT id FROM runs ORDER BY run DESC LIMIT 256", &statement, &ignored)) return;
    while (count < CANDIDATES && !ledger_next(l, statement, &row, "read the ids", &ignored) && row) {
        snprintf(ids[count], LEDGER_ID, "%s", (const char *)sqlite3_column_text(statement, 0));
        pointers[count] = ids[count];
        count++;
    }
    sqlite3_reset(statement);
    const char *found = name_nearest(name, pointers, count);
    if (found) snprintf(nearest, LEDGER_ID, "%s", found);
}

static status unknown_run(ledger *l, const char *name, report *r) {
    char nearest[LEDGER_ID], found[96];
    nearest_id(l, name, nearest);
    snprintf(found, sizeof found, "'%.80s'", name);
    return report_input(r, l->path, 0, "run", "the id of a run (or its unique beginning or end, or 'last')", found,
                        nearest[0] ? nearest : NULL);
}

status ledger_key(ledger *l, const char *id, int64_t *run, report *r) {
    sqlite3_stmt *statement;
    bool row = false;
    status s = ledger_statement(l, "SELECT run FROM runs WHERE id = ?1", &statement, r);
    if (s) return s;
    bind_text(statement, 1, id);
    s = ledger_next(l, statement, &row, "look a run up", r);
    if (row) *run = sqlite3_column_int64(statement, 0);
    sqlite3_reset(statement);
    return s || row ? s : unknown_run(l, id, r);
}

/* Runs that `sql` finds for `name`: how many there are, the newest first. */
static status find_runs(ledger *l, const char *sql, const char *name, int *count, char id[LEDGER_ID],
                        char output[FILE_PATH], report *r) {
    sqlite3_stmt *statement;
    bool row = true;
    *count = 0;
    status s = ledger_statement(l, sql, &statement, r);
    if (s) return s;
    bind_text(statement, 1, name);
    while (!(s = ledger_next(l, statement, &row, "look a run up", r)) && row) {
        if ((*count)++ > 0) continue;
        snprintf(id, LEDGER_ID, "%s", (const char *)sqlite3_column_text(statement, 0));
        snprintf(output, FILE_PATH, "%s", (const char *)sqlite3_column_text(statement, 1));
    }
    return s;
}

status ledger_resolve(ledger *l, const char *name, char id[LEDGER_ID], char *output, size_t size, report *r) {
    static const char *const ways[] = {
        "SELECT id, output FROM runs WHERE id = ?1",
        "SELECT id, output FROM runs WHERE ?1 = 'last' ORDER BY started DESC, run DESC LIMIT 1",
        "SELECT id, output FROM runs WHERE ?1 <> '' AND substr(id, 1, length(?1)) = ?1 ORDER BY started DESC, run DESC",
        "SELECT id, output FROM runs WHERE ?1 <> '' AND substr(id, -length(?1)) = ?1 ORDER BY started DESC, run DESC",
    };
    char folder[FILE_PATH] = "";
    int count = 0;
    status s = STATUS_OK;
    for (size_t i = 0; i < sizeof ways / sizeof ways[0] && !s && count == 0; i++)
        s = find_runs(l, ways[i], name, &count, id, folder, r);
    if (s) return s;
    if (count == 0) return unknown_run(l, name, r);
    if (count == 1) return output ? copy_path(output, size, folder, r) : STATUS_OK;
    char found[128];
    snprintf(found, sizeof found, "'%.64s', which fits %d runs", name, count);
    return report_input(r, l->path, 0, "run", "the id of one run", found, id);
}
