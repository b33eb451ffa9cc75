/* Two runs beside each other: only what differs. */
#include "store/ledger.h"

#include "store/ledger_detail.h"
#include "store/table.h"

#include <math.h>
#include <string.h>

/* All queries give: name, value of a, value of b, unit; only rows whose values differ. What one run lacks is NULL, and
 * `IS NOT` takes two of those for equal. */
static const char parameters_sql[] =
    "WITH a AS MATERIALIZED (SELECT * FROM run_parameters WHERE run = ?1), "
    "b AS MATERIALIZED (SELECT * FROM run_parameters WHERE run = ?2) "
    "SELECT name, coalesce(a.text, a.number), coalesce(b.text, b.number), coalesce(b.unit, a.unit) "
    "FROM (SELECT name FROM a UNION SELECT name FROM b) LEFT JOIN a USING (name) LEFT JOIN b USING (name) "
    "WHERE a.number IS NOT b.number OR a.text IS NOT b.text ORDER BY name";

static const char measures_sql[] =
    "WITH a AS MATERIALIZED (SELECT name, value FROM final_measures WHERE run = ?1), "
    "b AS MATERIALIZED (SELECT name, value FROM final_measures WHERE run = ?2) "
    "SELECT name, a.value, b.value, '' "
    "FROM (SELECT name FROM a UNION SELECT name FROM b) LEFT JOIN a USING (name) LEFT JOIN b USING (name) "
    "WHERE a.value IS NOT b.value ORDER BY name";

/* Columns that say how a run was made and how it ended; not when, where or by which name. */
#define DIFFERENCE(column)                                                                                             \
    "SELECT '" column "', a." column ", b." column ", '' FROM runs_view AS a, runs_view AS b "                         \
    "WHERE a.run = ?1 AND b.run = ?2 AND a." column " IS NOT b." column
#define AND_ALSO " UNION ALL "

static const char settings_sql[] =
    DIFFERENCE("title") AND_ALSO DIFFERENCE("variant") AND_ALSO DIFFERENCE("scene") AND_ALSO DIFFERENCE("scene_hash")
        AND_ALSO DIFFERENCE("effects") AND_ALSO DIFFERENCE("particles") AND_ALSO DIFFERENCE("seed")
            AND_ALSO DIFFERENCE("precision") AND_ALSO DIFFERENCE("simd") AND_ALSO DIFFERENCE("threads")
                AND_ALSO DIFFERENCE("version") AND_ALSO DIFFERENCE("frames_wanted") AND_ALSO DIFFERENCE("status")
                    AND_ALSO DIFFERENCE("message") AND_ALSO DIFFERENCE("frames") AND_ALSO DIFFERENCE("steps");

typedef struct part {
    const char *title, *key, *sql;
} part;

static const part parts[] = {
    {"Parameters", "parameters", parameters_sql},
    {"Run", "run", settings_sql},
    {"Measures of the last frame", "measures", measures_sql},
};

enum { PARTS = sizeof parts / sizeof parts[0], VALUE = 256 };

/* (b − a) / |a|; NaN where that says nothing. */
static double relative_difference(sqlite3_stmt *row) {
    double a = sqlite3_column_double(row, 1), b = sqlite3_column_double(row, 2);
    bool both = sqlite3_column_type(row, 1) == SQLITE_FLOAT && sqlite3_column_type(row, 2) == SQLITE_FLOAT;
    return both && a != 0.0 ? (b - a) / fabs(a) : (double)NAN;
}

/* Six digits, or all of them (`exact`) where six would hide the difference. */
static void format_cell(sqlite3_stmt *row, int column, bool exact, char text[VALUE]) {
    double number = sqlite3_column_double(row, column);
    char digits[JSON_NUMBER];
    switch (sqlite3_column_type(row, column)) {
    case SQLITE_NULL: snprintf(text, VALUE, "-"); break;
    case SQLITE_FLOAT:
        json_format_number(number, digits);
        if (exact)
            snprintf(text, VALUE, "%s", digits);
        else
            snprintf(text, VALUE, "%.6g", number);
        break;
    default: snprintf(text, VALUE, "%s", detail_text(row, column)); break;
    }
}

static status add_text(void *context, sqlite3_stmt *row, report *r) {
    const char *name = detail_text(row, 0), *unit = detail_text(row, 3);
    bool has_unit = unit[0] && strcmp(unit, "1") != 0;
    char label[VALUE], a[VALUE], b[VALUE], change[32] = "";
    format_cell(row, 1, false, a);
    format_cell(row, 2, false, b);
    if (strcmp(a, b) == 0) {
        format_cell(row, 1, true, a);
        format_cell(row, 2, true, b);
    }
    double relative = relative_difference(row);
    if (isfinite(relative)) snprintf(change, sizeof change, "%+.3g %%", 100.0 * relative);
    snprintf(label, sizeof label, has_unit ? "%s [%s]" : "%s", name, unit);
    const char *const cells[] = {label, a, b, change};
    return table_add(context, cells, r);
}

static status print_text_part(ledger *l, FILE *out, const part *which, const int64_t runs[2], bool *any, report *r) {
    static const table_column columns[] = {{.title = ""},
                                           {.title = "", .right = true, .least = 8},
                                           {.title = "", .right = true, .least = 8},
                                           {.title = "", .right = true}};
    table *rows = table_create(columns, 4);
    if (!rows) return report_set(r, STATUS_SYSTEM, "out of memory for a table");
    status s = detail_each_pair(l, which->sql, runs, add_text, rows, r);
    if (!s && table_rows(rows) > 0) {
        fprintf(out, "%s\n", which->title);
        table_print(rows, out, table_terminal_width(out), "  ");
        *any = true;
    }
    table_destroy(rows);
    return s;
}

static status print_text(ledger *l, FILE *out, const char *a, const char *b, const int64_t runs[2], report *r) {
    bool any = false;
    status s = STATUS_OK;
    fprintf(out, "%s → %s\n", a, b);
    for (int i = 0; i < PARTS && !s; i++) s = print_text_part(l, out, &parts[i], runs, &any, r);
    if (!s && !any) fprintf(out, "no differences\n");
    return s ? s : output_check(out, r);
}

static status add_json(void *context, sqlite3_stmt *row, report *r) {
    (void)r;
    json_writer *w = context;
    json_object(w);
    json_member_string(w, "name", detail_text(row, 0));
    json_key(w, "a");
    detail_json_value(w, row, 1);
    json_key(w, "b");
    detail_json_value(w, row, 2);
    if (detail_text(row, 3)[0]) json_member_string(w, "unit", detail_text(row, 3));
    double relative = relative_difference(row);
    if (isfinite(relative)) json_member_number(w, "relative", relative);
    json_object_end(w);
    return STATUS_OK;
}

static status print_json(ledger *l, FILE *out, const char *a, const char *b, const int64_t runs[2], report *r) {
    json_writer w;
    status s = STATUS_OK;
    json_begin(&w, 0);
    json_object(&w);
    json_member_string(&w, "a", a);
    json_member_string(&w, "b", b);
    for (int i = 0; i < PARTS && !s; i++) {
        json_member_array(&w, parts[i].key);
        s = detail_each_pair(l, parts[i].sql, runs, add_json, &w, r);
        json_array_end(&w);
    }
    json_object_end(&w);
    return detail_json_print(&w, s, out, r);
}

status ledger_print_diff(ledger *l, FILE *out, bool json, const char *a, const char *b, report *r) {
    char ids[2][LEDGER_ID];
    int64_t runs[2];
    status s = ledger_bury(l, r);
    if (!s) s = ledger_resolve(l, a, ids[0], NULL, 0, r);
    if (!s) s = ledger_resolve(l, b, ids[1], NULL, 0, r);
    if (!s) s = ledger_key(l, ids[0], &runs[0], r);
    if (!s) s = ledger_key(l, ids[1], &runs[1], r);
    if (!s) s = ledger_execute(l, "SAVEPOINT difference", "compare runs", r); /* one view of both */
    if (s) return s;
    s = (json ? print_json : print_text)(l, out, ids[0], ids[1], runs, r);
    sqlite3_exec(l->database, "RELEASE difference", NULL, NULL, NULL);
    return s;
}
