#include "store/ledger_detail.h"

#include <string.h>
#include <time.h>

const char detail_parameters_sql[] =
    "SELECT name, number, text, unit, from_set FROM run_parameters WHERE run = ?1 ORDER BY name";
const char detail_measures_sql[] = "SELECT name, value FROM final_measures WHERE run = ?1 ORDER BY name";
const char detail_events_sql[] = "SELECT frame, happened, kind, text FROM events WHERE run = ?1 ORDER BY event";
const char detail_turns_sql[] = "SELECT frame, path, value FROM knob_turns WHERE run = ?1 ORDER BY turn";
const char detail_notes_sql[] = "SELECT written, text FROM notes WHERE run = ?1 ORDER BY note";

status detail_select(ledger *l, int64_t run, sqlite3_stmt **statement, report *r) {
    static const char sql[] =
        "SELECT v.id AS run_id, v.status, v.scene, v.title, v.variant, v.scene_hash, r.started, r.ended, "
        "v.wall_seconds AS wall_s, "
        "v.particles, v.frames, v.frames_wanted, v.steps, v.time, v.threads, v.precision, v.simd, v.version, "
        "v.effects, v.seed, "
        "v.message, v.parent, v.parent_frame, v.command, v.output AS out, r.host, r.pid, v.tags, v.summary "
        "FROM runs_view AS v JOIN runs AS r ON r.run = v.run WHERE r.run = ?1";
    bool row;
    status s = ledger_statement(l, sql, statement, r);
    if (s) return s;
    bind_integer(*statement, 1, run);
    s = ledger_next(l, *statement, &row, "read a run", r);
    return s || row ? s : report_set(r, STATUS_SYSTEM, "%s: the run went away while it was read", l->path);
}

const char *detail_text(sqlite3_stmt *statement, int column) {
    const char *text = (const char *)sqlite3_column_text(statement, column);
    return text ? text : "";
}

static status each_row(ledger *l, sqlite3_stmt *statement, detail_row take, void *context, report *r) {
    bool row = true;
    status s = STATUS_OK;
    while (!s && !(s = ledger_next(l, statement, &row, "read a run", r)) && row) s = take(context, statement, r);
    sqlite3_reset(statement);
    return s;
}

status detail_each(ledger *l, const char *sql, int64_t run, detail_row take, void *context, report *r) {
    sqlite3_stmt *statement;
    status s = ledger_statement(l, sql, &statement, r);
    if (s) return s;
    bind_integer(statement, 1, run);
    return each_row(l, statement, take, context, r);
}

status detail_each_pair(ledger *l, const char *sql, const int64_t runs[2], detail_row take, void *context, report *r) {
    sqlite3_stmt *statement;
    status s = ledger_statement(l, sql, &statement, r);
    if (s) return s;
    bind_integer(statement, 1, runs[0]);
    bind_integer(statement, 2, runs[1]);
    return each_row(l, statement, take, context, r);
}

/* ---- JSON -------------------------------------------------------------------------------------------------------- */

void detail_json_value(json_writer *w, sqlite3_stmt *statement, int column) {
    switch (sqlite3_column_type(statement, column)) {
    case SQLITE_INTEGER: json_integer(w, sqlite3_column_int64(statement, column)); break;
    case SQLITE_FLOAT: json_number(w, sqlite3_column_double(statement, column)); break;
    case SQLITE_NULL: json_null(w); break;
    default: json_string(w, (const char *)sqlite3_column_text(statement, column)); break;
    }
}

static void json_instant(json_writer *w, sqlite3_stmt *statement, int column) {
    char text[40];
    if (sqlite3_column_type(statement, column) == SQLITE_NULL) {
        json_null(w);
        return;
    }
    time_t seconds = (time_t)sqlite3_column_double(statement, column);
    struct tm utc;
    gmtime_r(&seconds, &utc);
    strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    json_string(w, text);
}

/* "a,b" as ["a", "b"]. */
static void json_list(json_writer *w, const char *text) {
    json_array(w);
    while (*text) {
        char item[128];
        size_t length = strcspn(text, ",");
        snprintf(item, sizeof item, "%.*s", (int)length, text);
        json_string(w, item);
        text += length + (text[length] == ',');
    }
    json_array_end(w);
}

static status json_parameter(void *context, sqlite3_stmt *statement, report *r) {
    (void)r;
    json_key(context, detail_text(statement, 0));
    detail_json_value(context, statement, sqlite3_column_type(statement, 2) == SQLITE_NULL ? 1 : 2);
    return STATUS_OK;
}

static status json_parameter_detail(void *context, sqlite3_stmt *statement, report *r) {
    (void)r;
    json_object(context);
    json_member_string(context, "name", detail_text(statement, 0));
    json_key(context, "value");
    detail_json_value(context, statement, sqlite3_column_type(statement, 2) == SQLITE_NULL ? 1 : 2);
    json_member_string(context, "unit", detail_text(statement, 3));
    json_member_boolean(context, "from_set", sqlite3_column_int(statement, 4) != 0);
    json_object_end(context);
    return STATUS_OK;
}

static status json_measure(void *context, sqlite3_stmt *statement, report *r) {
    (void)r;
    json_key(context, detail_text(statement, 0));
    detail_json_value(context, statement, 1);
    return STATUS_OK;
}

static status json_event(void *context, sqlite3_stmt *statement, report *r) {
    (void)r;
    json_object(context);
    json_member_integer(context, "frame", sqlite3_column_int64(statement, 0));
    json_key(context, "happened");
    json_instant(context, statement, 1);
    json_member_string(context, "kind", detail_text(statement, 2));
    json_member_string(context, "text", detail_text(statement, 3));
    json_object_end(context);
    return STATUS_OK;
}

static status json_turn(void *context, sqlite3_stmt *statement, report *r) {
    (void)r;
    json_object(context);
    json_member_integer(context, "frame", sqlite3_column_int64(statement, 0));
    json_member_string(context, "path", detail_text(statement, 1));
    json_member_string(context, "value", detail_text(statement, 2));
    json_object_end(context);
    return STATUS_OK;
}

static status json_note(void *context, sqlite3_stmt *statement, report *r) {
    (void)r;
    json_object(context);
    json_key(context, "written");
    json_instant(context, statement, 0);
    json_member_string(context, "text", detail_text(statement, 1));
    json_object_end(context);
    return STATUS_OK;
}

/* The history comes as rows (frame, time, steps, wall, name, value) by frame: an object opens with each new frame. */
typedef struct history {
    json_writer *w;
    int64_t frame;
    bool open;
} history;

static void history_close(history *h) {
    if (!h->open) return;
    json_object_end(h->w);
    json_object_end(h->w);
    h->open = false;
}

static status json_history_row(void *context, sqlite3_stmt *statement, report *r) {
    (void)r;
    history *h = context;
    int64_t frame = sqlite3_column_int64(statement, 0);
    if (!h->open || frame != h->frame) {
        history_close(h);
        json_object(h->w);
        for (int i = 0; i < 4; i++) {
            json_key(h->w, sqlite3_column_name(statement, i));
            detail_json_value(h->w, statement, i);
        }
        json_member_object(h->w, "measures");
        h->open = true;
        h->frame = frame;
    }
    if (sqlite3_column_type(statement, 4) == SQLITE_NULL) return STATUS_OK; /* a frame without measures */
    json_key(h->w, detail_text(statement, 4));
    detail_json_value(h->w, statement, 5);
    return STATUS_OK;
}

static status json_history(ledger *l, json_writer *w, int64_t run, report *r) {
    static const char sql[] =
        "SELECT f.frame, f.time, f.steps, f.wall_seconds AS wall_s, m.name, x.value FROM frames AS f "
        "LEFT JOIN run_measures AS x USING (run, frame) LEFT JOIN measures AS m USING (measure) "
        "WHERE f.run = ?1 ORDER BY f.frame, m.name";
    history h = {.w = w};
    status s = detail_each(l, sql, run, json_history_row, &h, r);
    history_close(&h);
    return s;
}

/* "name": { or [ … rows … } or ]. */
static status json_rows(ledger *l, json_writer *w, const char *name, bool object, const char *sql, int64_t run,
                        detail_row take, report *r) {
    json_key(w, name);
    if (object)
        json_object(w);
    else
        json_array(w);
    status s = detail_each(l, sql, run, take, w, r);
    if (object)
        json_object_end(w);
    else
        json_array_end(w);
    return s;
}

static void json_columns(json_writer *w, sqlite3_stmt *statement) {
    for (int i = 0; i < DETAIL_COUNT; i++) {
        json_key(w, sqlite3_column_name(statement, i));
        switch (i) {
        case DETAIL_STARTED:
        case DETAIL_ENDED: json_instant(w, statement, i); break;
        case DETAIL_EFFECTS:
        case DETAIL_TAGS: json_list(w, detail_text(statement, i)); break;
        case DETAIL_SUMMARY: json_raw(w, detail_text(statement, i)); break;
        default: detail_json_value(w, statement, i); break;
        }
    }
}

status detail_json(ledger *l, json_writer *w, int64_t run, bool whole, report *r) {
    sqlite3_stmt *statement;
    status s = detail_select(l, run, &statement, r);
    json_object(w);
    if (!s) {
        json_columns(w, statement);
        sqlite3_reset(statement);
        s = json_rows(l, w, "parameters", true, detail_parameters_sql, run, json_parameter, r);
    }
    if (!s) s = json_rows(l, w, "measures", true, detail_measures_sql, run, json_measure, r);
    if (!s && whole)
        s = json_rows(l, w, "parameter_details", false, detail_parameters_sql, run, json_parameter_detail, r);
    if (!s && whole) s = json_rows(l, w, "turns", false, detail_turns_sql, run, json_turn, r);
    if (!s && whole) s = json_rows(l, w, "events", false, detail_events_sql, run, json_event, r);
    if (!s && whole) s = json_rows(l, w, "notes", false, detail_notes_sql, run, json_note, r);
    if (!s && whole) {
        json_member_array(w, "history");
        s = json_history(l, w, run, r);
        json_array_end(w);
    }
    json_object_end(w);
    return s;
}

status detail_json_print(json_writer *w, status outcome, FILE *out, report *r) {
    if (!outcome) outcome = json_finish(w, r);
    if (!outcome) {
        fprintf(out, "%s\n", w->text);
        outcome = output_check(out, r);
    }
    json_free(w);
    return outcome;
}
