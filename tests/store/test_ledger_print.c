/* What the ledger prints: lists, one run, two runs beside each other, queries; for people and as JSON (read back with
 * SQLite). */
#include "base/memory.h"
#include "check.h"
#include "ledger_scratch.h"

#include <math.h>

/* Printed text of one call; free() it. `s` is its status. */
typedef struct printed {
    status s;
    char *text;
    size_t size;
} printed;

#define PRINT(result, call)                                                                                            \
    do {                                                                                                               \
        FILE *out = open_memstream(&(result).text, &(result).size);                                                    \
        (result).s = (call);                                                                                           \
        fclose(out);                                                                                                   \
    } while (0)

/* The value at a JSON path of a text, as text; "(no JSON)" when the text is none. */
static const char *json_at(const char *json, const char *path) {
    static char text[4096];
    sqlite3 *database;
    sqlite3_stmt *statement;
    if (sqlite3_open(":memory:", &database)) abort();
    if (sqlite3_prepare_v2(database, "SELECT iif(json_valid(?1), json_extract(?1, ?2), '(no JSON)')", -1, &statement,
                           NULL))
        abort();
    sqlite3_bind_text(statement, 1, json, -1, SQLITE_STATIC);
    sqlite3_bind_text(statement, 2, path, -1, SQLITE_STATIC);
    sqlite3_step(statement);
    const char *value = (const char *)sqlite3_column_text(statement, 0);
    snprintf(text, sizeof text, "%s", value ? value : "");
    sqlite3_finalize(statement);
    sqlite3_close(database);
    return text;
}

static bool json_is(const char *json, const char *path, const char *expected) {
    const char *found = json_at(json, path);
    bool same = strcmp(found, expected) == 0;
    if (!same) printf("  %s is '%s', expected '%s'\n", path, found, expected);
    return same;
}

/* Columns of the widest line (bytes that continue a UTF-8 character do not count). */
static int widest(const char *text) {
    int most = 0, now = 0;
    for (; *text; text++) {
        now = *text == '\n' ? 0 : now + ((*text & 0xc0) != 0x80);
        if (now > most) most = now;
    }
    return most;
}

static bool has(const char *text, const char *part) {
    if (strstr(text, part)) return true;
    printf("  no '%s' in:\n%s\n", part, text);
    return false;
}

/* Three runs: done, failed, and one that this process is still writing. */
static ledger *three_runs(const char *name, char ids[3][LEDGER_ID]) {
    report r;
    ledger *l = open_ledger(name);
    write_run(l, "full", 0.45, 4, "done", ids[0]);
    write_run(l, "isotropic", 0.3, 2, "failed", ids[1]);
    write_run(l, "full", 0.1, 1, "running", ids[2]);
    if (ledger_tag(l, ids[0], "figure 2", true, &r) || ledger_event(l, ids[0], 3, "first_crack", "at x = 0.1", &r) ||
        ledger_note(l, ids[0], "tears\ntoo late", &r))
        abort();
    return l;
}

/* ---- list -------------------------------------------------------------------------------------------------------- */

static void a_list_for_people(void) {
    char ids[3][LEDGER_ID];
    report r;
    printed p;
    ledger *l = three_runs("list.db", ids);
    PRINT(p, ledger_print_list(l, out, false, NULL, 0, &r));
    CHECK(p.s == STATUS_OK && widest(p.text) <= 80);
    char *first = strstr(p.text, ids[0]), *second = strstr(p.text, ids[1]), *third = strstr(p.text, ids[2]);
    CHECK(first && second && third && third < second && second < first); /* the newest first */
    CHECK(has(p.text, "Tube pull / full") && has(p.text, "done") && has(p.text, "failed") && has(p.text, "running"));
    CHECK(has(p.text, " 1/4 ") && has(p.text, "50K") && has(p.text, "figure 2") && has(p.text, "2.0 s"));
    free(p.text);
    PRINT(p, ledger_print_list(l, out, false, "status = 'failed' OR particles < 10 -- and a comment", 0, &r));
    CHECK(p.s == STATUS_OK && has(p.text, ids[1]) && !strstr(p.text, ids[0]));
    free(p.text);
    PRINT(p, ledger_print_list(l, out, false, "parameters ->> 'eta' > 0.2 AND measures ->> 'broken_fraction' > 0.1", 0,
                               &r));
    CHECK(p.s == STATUS_OK && has(p.text, ids[0]) && !strstr(p.text, ids[1]) && !strstr(p.text, ids[2]));
    free(p.text);
    PRINT(p, ledger_print_list(l, out, false, NULL, 1, &r));
    CHECK(p.s == STATUS_OK && has(p.text, ids[2]) && !strstr(p.text, ids[1]));
    free(p.text);
    PRINT(p, ledger_print_list(l, out, false, "particles = 0", 0, &r));
    CHECK(p.s == STATUS_OK && strcmp(p.text, "no runs\n") == 0);
    free(p.text);
    ledger_close(l);
}

static void a_list_fits_the_terminal(void) {
    char id[LEDGER_ID];
    report r;
    printed p;
    ledger *l = open_ledger("narrow.db");
    write_run(l, "a variant with a very long name – and “quotes” – that goes on and on", 1, 4, "interrupted", id);
    CHECK(ledger_tag(l, id, "a tag that is long as well, nearly", true, &r) == STATUS_INPUT);
    CHECK(ledger_tag(l, id, "a tag that is long as well but good", true, &r) == STATUS_OK);
    sql_do("narrow.db", "UPDATE runs SET frames_wanted = 12345, wall_seconds = 86400, particles = 1234567");
    PRINT(p, ledger_print_list(l, out, false, NULL, 0, &r));
    CHECK(widest(p.text) <= 80 && has(p.text, "…") && has(p.text, "1.235M") && has(p.text, "24:00:00") &&
          has(p.text, id));
    free(p.text);
    setenv("COLUMNS", "200", 1);
    PRINT(p, ledger_print_list(l, out, false, NULL, 0, &r));
    CHECK(widest(p.text) <= 200 && has(p.text, "goes on and on") && !strstr(p.text, "…"));
    free(p.text);
    unsetenv("COLUMNS");
    ledger_close(l);
}

static void a_list_for_programs(void) {
    char ids[3][LEDGER_ID];
    report r;
    printed p;
    ledger *l = three_runs("list_json.db", ids);
    PRINT(p, ledger_print_list(l, out, true, NULL, 0, &r));
    CHECK(p.s == STATUS_OK && strchr(p.text, '\n') == p.text + p.size - 1);
    CHECK(json_is(p.text, "$.runs[2].run_id", ids[0]) && json_is(p.text, "$.runs[0].status", "running"));
    CHECK(json_is(p.text, "$.runs[2].tags[0]", "figure 2") && json_is(p.text, "$.runs[2].effects[1]", "fibres"));
    CHECK(json_is(p.text, "$.runs[2].parameters.eta", "0.45") &&
          json_is(p.text, "$.runs[2].parameters.kernel", "cubic"));
    CHECK(json_is(p.text, "$.runs[2].measures.kinetic", "6"));
    CHECK(has(p.text, "0.3333333333333333")); /* all digits */
    CHECK(json_is(p.text, "$.runs[2].summary.energy.kinetic", "3.5") && json_is(p.text, "$.runs[0].summary", ""));
    CHECK(strlen(json_at(p.text, "$.runs[2].started")) == 20);
    free(p.text);
    PRINT(p, ledger_print_list(l, out, true, "0", 0, &r));
    CHECK(json_is(p.text, "$.runs", "[]"));
    free(p.text);
    ledger_close(l);
}

static void wrong_conditions_are_told(void) {
    char ids[3][LEDGER_ID];
    report r;
    printed p;
    ledger *l = three_runs("where.db", ids);
    PRINT(p, ledger_print_list(l, out, false, "precison = 'f64'", 0, &r));
    CHECK(p.s == STATUS_INPUT && strcmp(r.nearest, "precision") == 0 && strstr(r.found, "precison") && p.size == 0);
    free(p.text);
    static const char *const bad[] = {"1); DROP TABLE runs; --", "1) ; DELETE FROM runs WHERE (1", "status =", "'"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        PRINT(p, ledger_print_list(l, out, false, bad[i], 0, &r));
        CHECK(p.s == STATUS_INPUT);
        free(p.text);
    }
    CHECK(sql_is("where.db", "SELECT count(*) FROM runs", "3"));
    ledger_close(l);
}

/* ---- show -------------------------------------------------------------------------------------------------------- */

static void one_run_for_people(void) {
    char ids[3][LEDGER_ID];
    report r;
    printed p;
    ledger *l = three_runs("show.db", ids);
    PRINT(p, ledger_print_show(l, out, false, ids[0], &r));
    CHECK(p.s == STATUS_OK && has(p.text, ids[0]) && has(p.text, "elasticity,fibres,damage") &&
          has(p.text, "/data/runs/x"));
    CHECK(has(p.text, "\nParameters\n") && has(p.text, "eta") && has(p.text, "0.45") && has(p.text, "set") &&
          has(p.text, "cubic"));
    CHECK(has(p.text, "\nMeasures of the last frame\n") && has(p.text, "0.333333") && has(p.text, "broken_fraction"));
    CHECK(has(p.text, "\nEvents\n") && has(p.text, "first_crack") && has(p.text, "at x = 0.1"));
    CHECK(has(p.text, "\nNotes\n") && has(p.text, "tears too late") && has(p.text, "figure 2"));
    CHECK(has(p.text, "4 of 4, to time 0.166667"));
    free(p.text);
    PRINT(p, ledger_print_show(l, out, false, ids[2], &r));
    CHECK(p.s == STATUS_OK && !strstr(p.text, "Events") && !strstr(p.text, "Notes") && !strstr(p.text, "ended"));
    free(p.text);
    PRINT(p, ledger_print_show(l, out, false, "last", &r));
    CHECK(p.s == STATUS_OK);
    free(p.text);
    PRINT(p, ledger_print_show(l, out, false, "nonsense", &r));
    CHECK(p.s == STATUS_INPUT && p.size == 0);
    free(p.text);
    ledger_close(l);
}

static void one_run_for_programs(void) {
    char ids[3][LEDGER_ID];
    report r;
    printed p;
    ledger *l = three_runs("show_json.db", ids);
    PRINT(p, ledger_print_show(l, out, true, ids[0], &r));
    CHECK(p.s == STATUS_OK && json_is(p.text, "$.run_id", ids[0]) && json_is(p.text, "$.seed", "7"));
    CHECK(json_is(p.text, "$.parameter_details[0].name", "eta") &&
          json_is(p.text, "$.parameter_details[0].from_set", "1"));
    CHECK(json_is(p.text, "$.parameter_details[0].unit", "1") &&
          json_is(p.text, "$.parameter_details[2].value", "cubic"));
    CHECK(json_is(p.text, "$.history[4].frame", "4") &&
          json_is(p.text, "$.history[4].measures.broken_fraction", "0.18"));
    CHECK(json_is(p.text, "$.history[5]", "") && json_is(p.text, "$.history[1].steps", "10"));
    CHECK(json_is(p.text, "$.events[0].kind", "first_crack") && json_is(p.text, "$.notes[0].text", "tears\ntoo late"));
    free(p.text);
    CHECK(ledger_finish(l, ids[2], "done", 1, 1, 1, NULL, "{not JSON", &r) == STATUS_OK);
    CHECK(ledger_frame(l, ids[1], 3, 1, 1, 1, NULL, 0, &r) == STATUS_OK); /* a frame without measures */
    PRINT(p, ledger_print_show(l, out, true, ids[2], &r));
    CHECK(p.s == STATUS_OK && json_is(p.text, "$.summary", "") && json_is(p.text, "$.status", "done"));
    free(p.text);
    PRINT(p, ledger_print_show(l, out, true, ids[1], &r));
    CHECK(p.s == STATUS_OK && json_is(p.text, "$.history[3].measures", "{}") && json_is(p.text, "$.measures", "{}"));
    free(p.text);
    ledger_close(l);
}

static void odd_texts_do_no_harm(void) {
    char id[LEDGER_ID];
    report r;
    printed p;
    ledger *l = open_ledger("odd.db");
    ledger_run run = sample_run("\x1b[31mred\x1b[0m\n\"quoted\" \\ \xff");
    CHECK(ledger_begin(l, &run, id, &r) == STATUS_OK);
    PRINT(p, ledger_print_list(l, out, false, NULL, 0, &r));
    CHECK(p.s == STATUS_OK && !strchr(p.text, 0x1b) && widest(p.text) <= 80);
    free(p.text);
    PRINT(p, ledger_print_show(l, out, false, id, &r));
    CHECK(p.s == STATUS_OK && !strchr(p.text, 0x1b));
    free(p.text);
    PRINT(p, ledger_print_list(l, out, true, NULL, 0, &r));
    CHECK(p.s == STATUS_OK && strstr(json_at(p.text, "$.runs[0].variant"), "\"quoted\" \\ ") != NULL);
    free(p.text);
    ledger_close(l);
}

/* ---- diff -------------------------------------------------------------------------------------------------------- */

static void two_runs_for_people(void) {
    char ids[3][LEDGER_ID];
    report r;
    printed p;
    ledger *l = three_runs("diff.db", ids);
    PRINT(p, ledger_print_diff(l, out, false, ids[0], ids[1], &r));
    CHECK(p.s == STATUS_OK && widest(p.text) <= 80);
    char *parameters = strstr(p.text, "Parameters\n"), *measures = strstr(p.text, "Measures of the last frame\n");
    CHECK(parameters && measures && parameters < measures);
    CHECK(has(p.text, "eta") && has(p.text, "0.45") && has(p.text, "0.3") && !strstr(p.text, "gamma") &&
          !strstr(p.text, "kernel"));
    CHECK(has(p.text, "isotropic") && has(p.text, "-50 %") && has(p.text, "-66.7 %")); /* 6 → 3, .18 → .06 */
    CHECK(!strstr(p.text, "steady") && !strstr(p.text, "started") && !strstr(p.text, "wall"));
    free(p.text);
    PRINT(p, ledger_print_diff(l, out, false, ids[0], ids[0], &r));
    CHECK(p.s == STATUS_OK && has(p.text, "no differences"));
    free(p.text);
    PRINT(p, ledger_print_diff(l, out, false, ids[0], "nonsense", &r));
    CHECK(p.s == STATUS_INPUT);
    free(p.text);
    ledger_close(l);
}

static void small_and_one_sided_differences(void) {
    char a[LEDGER_ID], b[LEDGER_ID];
    report r;
    printed p;
    ledger *l = open_ledger("small.db");
    write_run(l, "v", 0.25, 1, "done", a);
    write_run(l, "v", nextafter(0.25, 1), 1, "done", b);
    CHECK(ledger_parameter(l, b, "alpha", "rad", 1, NULL, false, &r) == STATUS_OK);
    PRINT(p, ledger_print_diff(l, out, false, a, b, &r));
    CHECK(has(p.text, "0.25000000000000006") && has(p.text, "alpha") && has(p.text, "rad"));
    free(p.text);
    PRINT(p, ledger_print_diff(l, out, true, a, b, &r));
    CHECK(json_is(p.text, "$.a", a) && json_is(p.text, "$.b", b));
    CHECK(json_is(p.text, "$.parameters[0].name", "alpha") && json_is(p.text, "$.parameters[0].a", "") &&
          json_is(p.text, "$.parameters[0].unit", "rad"));
    CHECK(has(p.text, "0.25000000000000006") && json_is(p.text, "$.parameters[1].name", "eta"));
    CHECK(json_is(p.text, "$.run", "[]") && json_is(p.text, "$.measures[0].name", "broken_fraction"));
    CHECK(strtod(json_at(p.text, "$.measures[0].relative"), NULL) > 0);
    free(p.text);
    ledger_close(l);
}

/* ---- queries ----------------------------------------------------------------------------------------------------- */

static void queries_only_read(void) {
    char ids[3][LEDGER_ID];
    report r;
    printed p;
    ledger *l = three_runs("sql.db", ids);
    static const char *const bad[] = {"DELETE FROM runs",
                                      "SELECT 1; SELECT 2",
                                      "",
                                      "SELEC 1",
                                      "PRAGMA user_version = 7",
                                      "BEGIN",
                                      "DROP VIEW runs_view",
                                      "WITH x AS (SELECT 1) DELETE FROM runs",
                                      "DELETE FROM runs RETURNING id"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        PRINT(p, ledger_print_sql(l, out, false, bad[i], NULL, 0, &r));
        CHECK(p.s == STATUS_INPUT);
        free(p.text);
    }
    CHECK(sql_is("sql.db", "SELECT count(*) FROM runs", "3") && sql_is("sql.db", "PRAGMA user_version", "4"));
    PRINT(p,
          ledger_print_sql(l, out, false, "SELECT id, particles, NULL AS none FROM runs ORDER BY run; ", NULL, 0, &r));
    CHECK(p.s == STATUS_OK && has(p.text, "particles") && has(p.text, "none") && has(p.text, "50000") &&
          has(p.text, ids[2]));
    free(p.text);
    PRINT(p, ledger_print_sql(l, out, true, "SELECT 9007199254740993 AS big, 0.1 AS x, 'a\"' AS t, NULL AS n", NULL, 0,
                              &r));
    CHECK(
        p.s == STATUS_OK &&
        strcmp(
            p.text,
            "{\"columns\": [\"big\", \"x\", \"t\", \"n\"], \"rows\": [[9007199254740993, 0.1, \"a\\\"\", null]]}\n") ==
            0);
    free(p.text);
    char id[LEDGER_ID];
    write_run(l, "after", 1, 0, "done", id); /* the ledger can be written again */
    ledger_close(l);
}

static status count_row(void *context, const ledger_cell *cells, int count, report *r) {
    int *rows = context;
    (void)r;
    CHECK(count == 2 && strcmp(cells[0].name, "id") == 0 && isnan(cells[0].number) && cells[1].number == 50000);
    return ++*rows == 2 ? STATUS_INTERRUPTED : STATUS_OK;
}

static void rows_can_be_read_one_by_one(void) {
    char ids[3][LEDGER_ID];
    report r;
    int rows = 0;
    ledger *l = three_runs("rows.db", ids);
    const char *const arguments[] = {"least=100"}, *const wrong[] = {"lest=100"}, *const bare[] = {"least"};
    const char *sql = "SELECT id, particles FROM runs WHERE particles > :least";
    CHECK(ledger_each_row(l, sql, arguments, 1, count_row, &rows, &r) == STATUS_INTERRUPTED && rows == 2);
    CHECK(ledger_each_row(l, sql, wrong, 1, count_row, &rows, &r) == STATUS_INPUT && strcmp(r.nearest, "least") == 0);
    CHECK(ledger_each_row(l, sql, bare, 1, count_row, &rows, &r) == STATUS_INPUT);
    CHECK(ledger_each_row(l, sql, NULL, 0, count_row, &rows, &r) == STATUS_INPUT && strcmp(r.key, "least") == 0);
    CHECK(rows == 2); /* not an empty answer, which NULL would give */
    ledger_close(l);
}

static void ready_made_queries_run(void) {
    char ids[3][LEDGER_ID];
    report r;
    printed p;
    int count = 0;
    ledger *l = three_runs("queries.db", ids);
    for (const char *name; (name = ledger_query_name(count)); count++) {
        const char *sql;
        CHECK(ledger_query(name, &sql, &r) == STATUS_OK && strncmp(sql, "-- ", 3) == 0);
        const char *const needed[] = {"parameter=eta", "run=x"}, *const *given = NULL; /* what has no default */
        if (strcmp(name, "effect_of") == 0) given = needed;
        if (strcmp(name, "history") == 0) given = needed + 1;
        for (int json = 0; json < 2; json++) {
            PRINT(p, ledger_print_sql(l, out, json != 0, sql, NULL, 0, &r));
            CHECK((p.s == STATUS_INPUT) == (given != NULL));
            free(p.text);
            PRINT(p, ledger_print_sql(l, out, json != 0, sql, given, given ? 1 : 0, &r));
            CHECK(p.s == STATUS_OK && p.size > 0);
            if (p.s) printf("  %s: %s %s\n", name, r.message, r.found);
            free(p.text);
        }
    }
    CHECK(count >= 6 && ledger_query_name(-1) == NULL);
    const char *sql;
    CHECK(ledger_query("bset", &sql, &r) == STATUS_INPUT && strcmp(r.nearest, "best") == 0);
    const char *const best[] = {"measure=kinetic", "most=1", "scene=TUBE"};
    CHECK(ledger_query("best", &sql, &r) == STATUS_OK);
    PRINT(p, ledger_print_sql(l, out, true, sql, best, 3, &r));
    CHECK(json_is(p.text, "$.rows[0][0]", ids[0]) && json_is(p.text, "$.rows[1][0]", ids[2]) &&
          json_is(p.text, "$.rows[2]", ""));
    free(p.text);
    const char *const effect[] = {"parameter=eta"};
    CHECK(ledger_query("effect_of", &sql, &r) == STATUS_OK);
    PRINT(p, ledger_print_sql(l, out, true, sql, effect, 1, &r));
    CHECK(json_is(p.text, "$.rows[0][0]", "0.45") && json_is(p.text, "$.rows[0][4]", "0.18"));
    free(p.text);
    char run[64];
    snprintf(run, sizeof run, "run=%s", ids[0]);
    const char *const history[] = {run, "measure=kinetic"};
    CHECK(ledger_query("history", &sql, &r) == STATUS_OK);
    PRINT(p, ledger_print_sql(l, out, true, sql, history, 2, &r));
    CHECK(json_is(p.text, "$.rows[4][0]", "4") && json_is(p.text, "$.rows[5]", ""));
    free(p.text);
    ledger_close(l);
}

/* ---- faults ------------------------------------------------------------------------------------------------------ */

static void a_full_output_is_told(void) {
    char ids[3][LEDGER_ID];
    report r;
    ledger *l = three_runs("output.db", ids);
    FILE *full = fopen("/dev/full", "w");
    if (full) {
        CHECK(ledger_print_list(l, full, false, NULL, 0, &r) == STATUS_SYSTEM && strstr(r.message, "No space"));
        clearerr(full);
        CHECK(ledger_print_show(l, full, true, ids[0], &r) == STATUS_SYSTEM);
        clearerr(full);
        CHECK(ledger_print_diff(l, full, false, ids[0], ids[1], &r) == STATUS_SYSTEM);
        fclose(full);
    }
    ledger_close(l);
}

static status print_everything(ledger *l, FILE *out, char ids[3][LEDGER_ID], report *r) {
    status s = STATUS_OK;
    for (int json = 0; json < 2 && !s; json++) {
        s = ledger_print_list(l, out, json != 0, NULL, 0, r);
        if (!s) s = ledger_print_show(l, out, json != 0, ids[0], r);
        if (!s) s = ledger_print_diff(l, out, json != 0, ids[0], ids[1], r);
        if (!s) s = ledger_print_sql(l, out, json != 0, "SELECT * FROM runs_view", NULL, 0, r);
    }
    return s;
}

static void memory_may_run_out(void) {
    char ids[3][LEDGER_ID];
    report r;
    ledger *l = three_runs("memory.db", ids);
    size_t before = memory_live_bytes();
    int failures = 0;
    for (int nth = 1;; nth++) {
        printed p;
        memory_fail_after(nth, 1);
        PRINT(p, print_everything(l, out, ids, &r));
        memory_fail_after(0, 0);
        free(p.text);
        CHECK(memory_live_bytes() == before);
        if (!p.s) break;
        CHECK(p.s == STATUS_SYSTEM && strstr(r.message, "memory"));
        failures++;
    }
    CHECK(failures > 10);
    CHECK(ledger_event(l, ids[0], 0, "still", "usable", &r) == STATUS_OK);
    ledger_close(l);
}

int main(void) {
    scratch_make();
    unsetenv("COLUMNS");
    RUN(a_list_for_people);
    RUN(a_list_fits_the_terminal);
    RUN(a_list_for_programs);
    RUN(wrong_conditions_are_told);
    RUN(one_run_for_people);
    RUN(one_run_for_programs);
    RUN(odd_texts_do_no_harm);
    RUN(two_runs_for_people);
    RUN(small_and_one_sided_differences);
    RUN(queries_only_read);
    RUN(rows_can_be_read_one_by_one);
    RUN(ready_made_queries_run);
    RUN(a_full_output_is_told);
    RUN(memory_may_run_out);
    CHECK(memory_live_bytes() == 0);
    return check_finish();
}
