/* Runs for people and for programs: list and show. */
#include "store/ledger.h"

#include "base/names.h"
#include "store/ledger_detail.h"
#include "store/table.h"

#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { CELL = 64 };

/* ---- figures for people ------------------------------------------------------------------------------------------ */

static void format_span(double seconds, char text[CELL]) {
    static const struct {
        double seconds;
        const char *unit;
    } units[] = {{86400 * 365, "y"}, {86400 * 7, "w"}, {86400, "d"}, {3600, "h"}, {60, "min"}};
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++) {
        if (seconds < units[i].seconds) continue;
        snprintf(text, CELL, "%.0f %s", floor(seconds / units[i].seconds), units[i].unit);
        return;
    }
    snprintf(text, CELL, "%.0f s", seconds > 0 ? floor(seconds) : 0.0);
}

static void format_wall(double seconds, char text[CELL]) {
    int64_t whole = (int64_t)seconds;
    if (seconds < 60)
        snprintf(text, CELL, "%.1f s", seconds);
    else if (whole < 3600)
        snprintf(text, CELL, "%" PRId64 ":%02" PRId64, whole / 60, whole % 60);
    else
        snprintf(text, CELL, "%" PRId64 ":%02" PRId64 ":%02" PRId64, whole / 3600, whole / 60 % 60, whole % 60);
}

static void format_count(int64_t count, char text[CELL]) {
    if (count < 10000)
        snprintf(text, CELL, "%" PRId64, count);
    else if (count < 1000000)
        snprintf(text, CELL, "%.3gK", (double)count / 1e3);
    else
        snprintf(text, CELL, "%.4gM", (double)count / 1e6);
}

static void format_instant(double seconds, char text[CELL]) {
    time_t whole = (time_t)seconds;
    struct tm local;
    localtime_r(&whole, &local);
    strftime(text, CELL, "%Y-%m-%d %H:%M:%S", &local);
}

/* A value as people read it: six digits of a figure, text as it is. */
static void format_value(sqlite3_stmt *statement, int column, char text[256]) {
    if (sqlite3_column_type(statement, column) == SQLITE_FLOAT)
        snprintf(text, 256, "%.6g", sqlite3_column_double(statement, column));
    else
        snprintf(text, 256, "%s",
                 sqlite3_column_type(statement, column) == SQLITE_NULL ? "-" : detail_text(statement, column));
}

/* ---- list -------------------------------------------------------------------------------------------------------- */

/* An SQL condition that names an unknown column is told the nearest column. */
static status wrong_condition(ledger *l, const char *where, report *r) {
    enum { CANDIDATES = 64 };
    static const char unknown[] = "no such column: ";
    const char *message = sqlite3_errmsg(l->database), *nearest = NULL;
    char columns[CANDIDATES][32], text[256];
    const char *names[CANDIDATES];
    int count = 0;
    sqlite3_stmt *statement;
    report ignored;
    bool row = true;
    snprintf(text, sizeof text, "%s", message);
    if (strncmp(text, unknown, sizeof unknown - 1) == 0 &&
        !ledger_statement(l, "SELECT name FROM pragma_table_info('runs_view')", &statement, &ignored)) {
        while (count < CANDIDATES && !ledger_next(l, statement, &row, "read the columns", &ignored) && row) {
            snprintf(columns[count], sizeof columns[count], "%s", detail_text(statement, 0));
            names[count] = columns[count];
            count++;
        }
        sqlite3_reset(statement);
        nearest = name_nearest(text + sizeof unknown - 1, names, count);
    }
    report_input(r, NULL, 0, where, "an SQL condition over runs_view", text, nearest);
    return STATUS_INPUT;
}

/* Prepares "the keys of the runs that fit, the newest first". The condition stands on lines of its own, so that a
 * comment at its end stays one. */
static status prepare_list(ledger *l, const char *where, int limit, sqlite3_stmt **statement, report *r) {
    char *sql = sqlite3_mprintf("SELECT run FROM runs_view WHERE (\n%s\n) ORDER BY run DESC LIMIT %d",
                                where && where[0] ? where : "1", limit > 0 ? limit : -1);
    if (!sql) return report_set(r, STATUS_SYSTEM, "out of memory for a condition");
    const char *tail = "";
    int code = sqlite3_prepare_v2(l->database, sql, -1, statement, &tail);
    status s = STATUS_OK;
    if (code != SQLITE_OK)
        s = wrong_condition(l, where ? where : "", r);
    else if (*tail || !sqlite3_stmt_readonly(*statement))
        s = report_input(r, NULL, 0, where, "an SQL condition over runs_view", "more than a condition", NULL);
    if (s) sqlite3_finalize(*statement);
    sqlite3_free(sql);
    return s;
}

static status list_row(ledger *l, table *t, int64_t run, double now, report *r) {
    sqlite3_stmt *row;
    status s = detail_select(l, run, &row, r);
    if (s) return s;
    char scene[256], frames[CELL], particles[CELL], ago[CELL], wall[CELL];
    const char *variant = detail_text(row, DETAIL_VARIANT);
    int64_t done = sqlite3_column_int64(row, DETAIL_FRAMES), wanted = sqlite3_column_int64(row, DETAIL_FRAMES_WANTED);
    snprintf(scene, sizeof scene, "%s%s%s", detail_text(row, DETAIL_TITLE), variant[0] ? " / " : "", variant);
    if (done >= wanted)
        snprintf(frames, sizeof frames, "%" PRId64, done);
    else
        snprintf(frames, sizeof frames, "%" PRId64 "/%" PRId64, done, wanted);
    format_count(sqlite3_column_int64(row, DETAIL_PARTICLES), particles);
    format_span(now - sqlite3_column_double(row, DETAIL_STARTED), ago);
    format_wall(sqlite3_column_double(row, DETAIL_WALL), wall);
    const char *const cells[] = {
        detail_text(row, DETAIL_ID),  detail_text(row, DETAIL_STATUS), scene, frames, particles, ago, wall,
        detail_text(row, DETAIL_TAGS)};
    s = table_add(t, cells, r);
    sqlite3_reset(row);
    return s;
}

static status list_text(ledger *l, FILE *out, sqlite3_stmt *keys, report *r) {
    static const table_column columns[] = {
        {.title = "run"},
        {.title = "status"},
        {.title = "scene", .least = 10},
        {.title = "frames", .right = true},
        {.title = "size", .right = true},
        {.title = "ago", .right = true},
        {.title = "wall", .right = true},
        {.title = "tags", .least = 4},
    };
    table *t = table_create(columns, sizeof columns / sizeof columns[0]);
    if (!t) return report_set(r, STATUS_SYSTEM, "out of memory for a table");
    bool row = true, any = false;
    double now = (double)time(NULL);
    status s = STATUS_OK;
    while (!s && !(s = ledger_next(l, keys, &row, "list the runs", r)) && row) {
        s = list_row(l, t, sqlite3_column_int64(keys, 0), now, r);
        any = true;
    }
    if (!s && !any) fprintf(out, "no runs\n");
    if (!s) table_print(t, out, table_terminal_width(out), "");
    table_destroy(t);
    return s ? s : output_check(out, r);
}

static status list_json(ledger *l, FILE *out, sqlite3_stmt *keys, report *r) {
    json_writer w;
    bool row = true;
    status s = STATUS_OK;
    json_begin(&w, 0);
    json_object(&w);
    json_member_array(&w, "runs");
    while (!s && !(s = ledger_next(l, keys, &row, "list the runs", r)) && row)
        s = detail_json(l, &w, sqlite3_column_int64(keys, 0), false, r);
    json_array_end(&w);
    json_object_end(&w);
    return detail_json_print(&w, s, out, r);
}

status ledger_print_list(ledger *l, FILE *out, bool json, const char *where, int limit, report *r) {
    sqlite3_stmt *keys = NULL;
    status s = ledger_bury(l, r);
    if (!s) s = prepare_list(l, where, limit, &keys, r);
    if (s) return s;
    /* While `keys` is open its read transaction holds the view of all the others. */
    s = json ? list_json(l, out, keys, r) : list_text(l, out, keys, r);
    sqlite3_finalize(keys);
    return s;
}

/* ---- show -------------------------------------------------------------------------------------------------------- */

static status add_pair(table *t, const char *name, report *r, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* A line "name  value"; an empty value makes none. */
static status add_pair(table *t, const char *name, report *r, const char *format, ...) {
    char value[2048];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(value, sizeof value, format, arguments);
    va_end(arguments);
    const char *const cells[] = {name, value};
    return value[0] ? table_add(t, cells, r) : STATUS_OK;
}

static status add_settings(table *t, sqlite3_stmt *row, report *r) {
    static const struct {
        const char *name;
        int column;
    } lines[] = {
        {"scene", DETAIL_SCENE},     {"hash", DETAIL_HASH},           {"variant", DETAIL_VARIANT},
        {"effects", DETAIL_EFFECTS}, {"particles", DETAIL_PARTICLES}, {"precision", DETAIL_PRECISION},
        {"simd", DETAIL_SIMD},       {"threads", DETAIL_THREADS},     {"seed", DETAIL_SEED},
        {"version", DETAIL_VERSION}, {"command", DETAIL_COMMAND},     {"folder", DETAIL_OUTPUT},
    };
    status s = STATUS_OK;
    for (size_t i = 0; i < sizeof lines / sizeof lines[0] && !s; i++)
        s = add_pair(t, lines[i].name, r, "%s", detail_text(row, lines[i].column));
    if (!s && detail_text(row, DETAIL_PARENT)[0])
        s = add_pair(t, "parent", r, "%s, frame %s", detail_text(row, DETAIL_PARENT),
                     detail_text(row, DETAIL_PARENT_FRAME));
    return s;
}

static status add_progress(table *t, sqlite3_stmt *row, report *r) {
    char started[CELL], ended[CELL] = "", wall[CELL], time_text[256];
    format_instant(sqlite3_column_double(row, DETAIL_STARTED), started);
    if (sqlite3_column_type(row, DETAIL_ENDED) != SQLITE_NULL)
        format_instant(sqlite3_column_double(row, DETAIL_ENDED), ended);
    format_wall(sqlite3_column_double(row, DETAIL_WALL), wall);
    format_value(row, DETAIL_TIME, time_text);
    status s = add_pair(t, "message", r, "%s", detail_text(row, DETAIL_MESSAGE));
    if (!s)
        s = add_pair(t, "started", r, "%s by process %s on %s", started, detail_text(row, DETAIL_PID),
                     detail_text(row, DETAIL_HOST));
    if (!s) s = add_pair(t, "ended", r, "%s", ended);
    if (!s)
        s = add_pair(t, "frames", r, "%s of %s, to time %s", detail_text(row, DETAIL_FRAMES),
                     detail_text(row, DETAIL_FRAMES_WANTED), time_text);
    if (!s) s = add_pair(t, "steps", r, "%s", detail_text(row, DETAIL_STEPS));
    if (!s) s = add_pair(t, "wall", r, "%s", wall);
    return s ? s : add_pair(t, "tags", r, "%s", detail_text(row, DETAIL_TAGS));
}

static status show_head(ledger *l, FILE *out, int64_t run, report *r) {
    static const table_column columns[] = {{.title = ""}, {.title = ""}};
    sqlite3_stmt *row;
    table *t = table_create(columns, 2);
    if (!t) return report_set(r, STATUS_SYSTEM, "out of memory for a table");
    status s = detail_select(l, run, &row, r);
    if (!s) {
        fprintf(out, "%s  %s  %s\n", detail_text(row, DETAIL_ID), detail_text(row, DETAIL_STATUS),
                detail_text(row, DETAIL_TITLE));
        s = add_progress(t, row, r);
        if (!s) s = add_settings(t, row, r);
        sqlite3_reset(row);
    }
    if (!s) table_print(t, out, INT_MAX, "  "); /* nothing here is cut or squeezed: paths are for copying */
    table_destroy(t);
    return s;
}

static status add_parameter(void *context, sqlite3_stmt *row, report *r) {
    char value[256];
    format_value(row, sqlite3_column_type(row, 2) == SQLITE_NULL ? 1 : 2, value);
    const char *unit = detail_text(row, 3);
    const char *const cells[] = {detail_text(row, 0), value, strcmp(unit, "1") == 0 ? "" : unit,
                                 sqlite3_column_int(row, 4) ? "set" : ""};
    return table_add(context, cells, r);
}

static status add_measure(void *context, sqlite3_stmt *row, report *r) {
    char value[256];
    format_value(row, 1, value);
    const char *const cells[] = {detail_text(row, 0), value, "", ""};
    return table_add(context, cells, r);
}

static status add_event(void *context, sqlite3_stmt *row, report *r) {
    char instant[CELL];
    format_instant(sqlite3_column_double(row, 1), instant);
    const char *const cells[] = {detail_text(row, 0), instant, detail_text(row, 2), detail_text(row, 3)};
    return table_add(context, cells, r);
}

static status add_note(void *context, sqlite3_stmt *row, report *r) {
    char instant[CELL];
    format_instant(sqlite3_column_double(row, 0), instant);
    const char *const cells[] = {instant, detail_text(row, 1), "", ""};
    return table_add(context, cells, r);
}

typedef struct section {
    const char *title, *sql;
    detail_row add;
    table_column columns[4];
} section;

static status show_section(ledger *l, FILE *out, const section *part, int64_t run, report *r) {
    table *t = table_create(part->columns, 4);
    if (!t) return report_set(r, STATUS_SYSTEM, "out of memory for a table");
    status s = detail_each(l, part->sql, run, part->add, t, r);
    if (!s && table_rows(t) > 0) {
        fprintf(out, "\n%s\n", part->title);
        table_print(t, out, table_terminal_width(out), "  ");
    }
    table_destroy(t);
    return s;
}

static status show_text(ledger *l, FILE *out, int64_t run, report *r) {
    const section sections[] = {
        {"Parameters",
         detail_parameters_sql,
         add_parameter,
         {{.title = ""}, {.title = "", .right = true}, {.title = ""}, {.title = ""}}},
        {"Measures of the last frame",
         detail_measures_sql,
         add_measure,
         {{.title = ""}, {.title = "", .right = true}, {.title = ""}, {.title = ""}}},
        {"Events",
         detail_events_sql,
         add_event,
         {{.title = "frame", .right = true}, {.title = "when"}, {.title = "what"}, {.title = ""}}},
        {"Notes", detail_notes_sql, add_note, {{.title = ""}, {.title = ""}, {.title = ""}, {.title = ""}}},
    };
    status s = show_head(l, out, run, r);
    for (size_t i = 0; i < sizeof sections / sizeof sections[0] && !s; i++)
        s = show_section(l, out, &sections[i], run, r);
    return s ? s : output_check(out, r);
}

status ledger_print_show(ledger *l, FILE *out, bool json, const char *id, report *r) {
    char full[LEDGER_ID];
    int64_t run;
    json_writer w;
    status s = ledger_bury(l, r);
    if (!s) s = ledger_resolve(l, id, full, NULL, 0, r);
    if (!s) s = ledger_key(l, full, &run, r);
    if (!s) s = ledger_execute(l, "SAVEPOINT show", "read a run", r); /* one view of the run for all its parts */
    if (s) return s;
    if (json) {
        json_begin(&w, 0);
        s = detail_json_print(&w, detail_json(l, &w, run, true, r), out, r);
    } else {
        s = show_text(l, out, run, r);
    }
    sqlite3_exec(l->database, "RELEASE show", NULL, NULL, NULL);
    return s;
}
