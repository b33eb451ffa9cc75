/* Queries: the user's own, and the ready-made ones. */
#include "store/ledger.h"

#include "base/json.h"
#include "base/memory.h"
#include "base/names.h"
#include "store/ledger_internal.h"
#include "store/sql.h"
#include "store/table.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { COLUMN_LIMIT = 256 };

status output_check(FILE *out, report *r) {
    return fflush(out) == 0 && !ferror(out)
               ? STATUS_OK
               : report_set(r, STATUS_SYSTEM, "cannot write the output: %s", strerror(errno));
}

/* ---- ready-made -------------------------------------------------------------------------------------------------- */

const char *ledger_query_name(int index) {
    return index >= 0 && index < sql_queries_count ? sql_queries[index].name : NULL;
}

status ledger_query(const char *name, const char **sql, report *r) {
    enum { CANDIDATES = 64 };
    const char *names[CANDIDATES];
    int count = 0;
    for (; count < sql_queries_count && count < CANDIDATES; count++) {
        names[count] = sql_queries[count].name;
        if (strcmp(name, names[count]) != 0) continue;
        *sql = sql_queries[count].text;
        return STATUS_OK;
    }
    return report_input(r, NULL, 0, "query", "the name of a ready-made query", name, name_nearest(name, names, count));
}

/* ---- preparing --------------------------------------------------------------------------------------------------- */

static bool only_space(const char *text) {
    while (isspace((unsigned char)*text) || *text == ';') text++;
    return !*text;
}

/* Accepts one statement that only reads. */
static status prepare_query(ledger *l, const char *sql, sqlite3_stmt **statement, report *r) {
    const char *tail = "";
    *statement = NULL;
    if (sqlite3_prepare_v2(l->database, sql, -1, statement, &tail) != SQLITE_OK)
        return report_input(r, l->path, 0, "SQL", "a query that SQLite understands", sqlite3_errmsg(l->database), NULL);
    const char *found = !*statement                             ? "nothing"
                        : !sqlite3_stmt_readonly(*statement)    ? "one that writes"
                        : sqlite3_column_count(*statement) == 0 ? "one without results"
                        : !only_space(tail)                     ? "more than one"
                                                                : NULL;
    if (!found) return STATUS_OK;
    sqlite3_finalize(*statement);
    return report_input(r, l->path, 0, "SQL", "one query that only reads", found, NULL);
}

/* Binds a figure as a figure: comparisons with columns of numbers would be false otherwise. */
static void bind_value(sqlite3_stmt *statement, int index, const char *value) {
    char *end;
    double number = strtod(value, &end);
    if (end != value && !*end && isfinite(number))
        sqlite3_bind_double(statement, index, number);
    else
        sqlite3_bind_text(statement, index, value, -1, SQLITE_TRANSIENT);
}

static status unknown_argument(sqlite3_stmt *statement, const char *name, report *r) {
    enum { CANDIDATES = 32 };
    const char *names[CANDIDATES];
    int count = sqlite3_bind_parameter_count(statement);
    if (count > CANDIDATES) count = CANDIDATES;
    for (int i = 0; i < count; i++) {
        const char *parameter = sqlite3_bind_parameter_name(statement, i + 1);
        names[i] = parameter ? parameter + 1 : NULL;
    }
    return report_input(r, NULL, 0, name, count > 0 ? "a parameter of the query" : "no parameter: the query has none",
                        name, name_nearest(name, names, count));
}

/* Whether the comment that a ready-made query opens with gives the parameter (with its colon) a default: "--   :NAME  what it is (default …)". */
static bool may_be_left_out(const char *sql, const char *parameter) {
    size_t length = strlen(parameter);
    for (; strncmp(sql, "--", 2) == 0; sql += strcspn(sql, "\n"), sql += *sql == '\n') {
        const char *word = sql + 2 + strspn(sql + 2, " "), *end = sql + strcspn(sql, "\n"), *fallback = strstr(sql, "(default");
        if (strncmp(word, parameter, length) == 0 && word[length] == ' ') return fallback && fallback < end;
    }
    return false;
}

/* SQLite takes a parameter without a value for NULL, with which most conditions hold for no row: an empty answer that says nothing. */
static status check_bound(sqlite3_stmt *statement, const bool *bound, int limit, report *r) {
    for (int i = 1; i <= sqlite3_bind_parameter_count(statement) && i < limit; i++) {
        const char *name = sqlite3_bind_parameter_name(statement, i);
        if (bound[i] || (name && may_be_left_out(sqlite3_sql(statement), name))) continue;
        char expected[96];
        snprintf(expected, sizeof expected, "%.48s=VALUE, which the query asks for", name ? name + 1 : "a name (:NAME) and NAME");
        return report_input(r, NULL, 0, name ? name + 1 : "?", expected, "none", NULL);
    }
    return STATUS_OK;
}

static status bind_arguments(sqlite3_stmt *statement, const char *const *arguments, int count, report *r) {
    enum { BOUND = 64 };
    bool bound[BOUND] = {false};
    for (int i = 0; i < count; i++) {
        char name[64];
        const char *equals = strchr(arguments[i], '=');
        if (!equals) return report_input(r, NULL, 0, "query", "NAME=VALUE", arguments[i], NULL);
        snprintf(name, sizeof name, ":%.*s", (int)(equals - arguments[i]), arguments[i]);
        int index = sqlite3_bind_parameter_index(statement, name);
        if (index == 0) return unknown_argument(statement, name + 1, r);
        bind_value(statement, index, equals + 1);
        if (index < BOUND) bound[index] = true;
    }
    return check_bound(statement, bound, BOUND, r);
}

/* ---- rows -------------------------------------------------------------------------------------------------------- */

static int read_cells(sqlite3_stmt *statement, ledger_cell cells[COLUMN_LIMIT]) {
    int count = sqlite3_column_count(statement);
    if (count > COLUMN_LIMIT) count = COLUMN_LIMIT;
    for (int i = 0; i < count; i++) {
        int type = sqlite3_column_type(statement, i);
        bool is_number = type == SQLITE_INTEGER || type == SQLITE_FLOAT;
        cells[i].number = is_number ? sqlite3_column_double(statement, i) : (double)NAN;
        cells[i].text = (const char *)sqlite3_column_text(statement, i);
        cells[i].name = sqlite3_column_name(statement, i);
    }
    return count;
}

static status each_row(ledger *l, sqlite3_stmt *statement, ledger_row row, void *context, report *r) {
    ledger_cell cells[COLUMN_LIMIT];
    bool more = true;
    status s = STATUS_OK;
    while (!s && !(s = ledger_next(l, statement, &more, "run the query", r)) && more)
        s = row(context, cells, read_cells(statement, cells), r);
    return s;
}

/* query_only guards against what sqlite3_stmt_readonly lets pass. */
static status query(ledger *l, const char *sql, const char *const *arguments, int argument_count,
                    status (*take)(ledger *l, sqlite3_stmt *statement, void *context, report *r), void *context,
                    report *r) {
    sqlite3_stmt *statement;
    status s = ledger_bury(l, r);
    if (!s) s = prepare_query(l, sql, &statement, r);
    if (s) return s;
    s = bind_arguments(statement, arguments, argument_count, r);
    if (!s) s = ledger_execute(l, "PRAGMA query_only = ON", "make sure that nothing is written", r);
    if (!s) s = take(l, statement, context, r);
    sqlite3_finalize(statement);
    sqlite3_exec(l->database, "PRAGMA query_only = OFF", NULL, NULL, NULL);
    return s;
}

typedef struct row_call {
    ledger_row row;
    void *context;
} row_call;

static status take_rows(ledger *l, sqlite3_stmt *statement, void *context, report *r) {
    const row_call *call = context;
    return each_row(l, statement, call->row, call->context, r);
}

status ledger_each_row(ledger *l, const char *sql, const char *const *arguments, int argument_count, ledger_row row,
                       void *context, report *r) {
    row_call call = {row, context};
    return query(l, sql, arguments, argument_count, take_rows, &call, r);
}

/* ---- printing ---------------------------------------------------------------------------------------------------- */

static status add_text_row(void *context, const ledger_cell *cells, int count, report *r) {
    const char *texts[COLUMN_LIMIT];
    char numbers[COLUMN_LIMIT][24];
    for (int i = 0; i < count; i++) {
        texts[i] = cells[i].text;
        if (!isfinite(cells[i].number) || cells[i].number == rint(cells[i].number)) continue;
        snprintf(numbers[i], sizeof numbers[i], "%.6g", cells[i].number);
        texts[i] = numbers[i];
    }
    return table_add(context, texts, r);
}

static status print_text(ledger *l, sqlite3_stmt *statement, void *context, report *r) {
    table_column columns[COLUMN_LIMIT];
    int count = sqlite3_column_count(statement);
    if (count > COLUMN_LIMIT) count = COLUMN_LIMIT;
    for (int i = 0; i < count; i++)
        columns[i] = (table_column){.title = sqlite3_column_name(statement, i), .least = 8, .keep = true};
    table *t = table_create(columns, count);
    if (!t) return report_set(r, STATUS_SYSTEM, "out of memory for a table");
    status s = each_row(l, statement, add_text_row, t, r);
    /* In a pipe or a file nothing is cut: what follows there may want all of it. */
    int width = isatty(fileno(context)) ? table_terminal_width(context) : INT_MAX;
    if (!s) table_print(t, context, width, "");
    table_destroy(t);
    return s ? s : output_check(context, r);
}

static status add_json_row(void *context, const ledger_cell *cells, int count, report *r) {
    (void)r;
    json_array(context);
    for (int i = 0; i < count; i++) {
        const char *text = cells[i].text;
        if (isnan(cells[i].number))
            json_string(context, text);
        else if (text && text[strspn(text, "-0123456789")] == '\0')
            json_raw(context, text); /* whole numbers past 2^53 keep all their digits */
        else
            json_number(context, cells[i].number);
    }
    json_array_end(context);
    return STATUS_OK;
}

static status print_json(ledger *l, sqlite3_stmt *statement, void *context, report *r) {
    json_writer w;
    int count = sqlite3_column_count(statement);
    json_begin(&w, 0);
    json_object(&w);
    json_member_array(&w, "columns");
    for (int i = 0; i < count && i < COLUMN_LIMIT; i++) json_string(&w, sqlite3_column_name(statement, i));
    json_array_end(&w);
    json_member_array(&w, "rows");
    status s = each_row(l, statement, add_json_row, &w, r);
    json_array_end(&w);
    json_object_end(&w);
    if (!s) s = json_finish(&w, r);
    if (!s) fprintf(context, "%s\n", w.text);
    json_free(&w);
    return s ? s : output_check(context, r);
}

status ledger_print_sql(ledger *l, FILE *out, bool json, const char *sql, const char *const *arguments,
                        int argument_count, report *r) {
    return query(l, sql, arguments, argument_count, json ? print_json : print_text, out, r);
}
