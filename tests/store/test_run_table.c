/* The table of runs: its cells are the ledger's, and filters and orders are what SQL says they are. */
#include "base/clock.h"
#include "ledger_scratch.h"
#include "check.h"

#include "base/memory.h"
#include "store/run_curves.h"
#include "store/run_table.h"


/* Three runs of different eta, the last one still going. */
static ledger *three_runs(const char *name, char ids[3][LEDGER_ID]) {
    ledger *l = open_ledger(name);
    report r;
    write_run(l, "full", 0.5, 4, "done", ids[0]);
    write_run(l, "isotropic", 0.1, 2, "failed", ids[1]);
    write_run(l, NULL, 0.3, 1, "running", ids[2]);
    CHECK(ledger_tag(l, ids[0], "paper", true, &r) == STATUS_OK);
    CHECK(ledger_note(l, ids[1], "fell apart", &r) == STATUS_OK);
    return l;
}

static const run_column *column(run_table *t, const char *name) {
    const run_column *c = NULL;
    report r;
    CHECK(run_table_column(t, name, &c, &r) == STATUS_OK);
    return c;
}

static void test_cells(void) {
    char ids[3][LEDGER_ID];
    ledger *l = three_runs("cells.db", ids);
    run_table *t;
    report r;
    CHECK(run_table_read(l, &t, &r) == STATUS_OK);
    CHECK(run_table_rows(t) == 3 && run_table_find(t, ids[1]) == 1 && run_table_find(t, "nobody") == -1);
    CHECK(strcmp(run_table_id(t, 2), ids[2]) == 0);
    CHECK(strcmp(column(t, "variant")->text[0], "full") == 0 && !column(t, "variant")->text[2]);
    CHECK(strcmp(column(t, "status")->text[1], "failed") == 0);
    CHECK(column(t, "eta")->numeric && column(t, "eta")->kind == RUN_COLUMN_PARAMETER && column(t, "eta")->number[1] == 0.1);
    CHECK(!column(t, "kernel")->numeric && strcmp(column(t, "kernel")->text[0], "cubic") == 0);
    /* Of the last frame: broken_fraction = eta frame / 10. */
    CHECK_NEAR(column(t, "broken_fraction")->number[0], 0.2, 1e-15);
    CHECK_NEAR(column(t, "broken_fraction")->number[2], 0.03, 1e-15);
    /* What a run that goes on has so far. */
    CHECK(column(t, "frames")->number[2] == 1 && column(t, "steps")->number[2] == 10 && column(t, "frames_wanted")->number[2] == 4);
    CHECK(strcmp(column(t, "tags")->text[0], "paper") == 0 && strcmp(column(t, "notes")->text[1], "fell apart") == 0);
    const run_column *c = NULL;
    /* A dotted name by its end, as long as that is one's alone. */
    CHECK(ledger_parameter(l, ids[0], "tube.damage.alpha", "1", -1, NULL, false, &r) == STATUS_OK);
    run_table_free(t);
    CHECK(run_table_read(l, &t, &r) == STATUS_OK && column(t, "alpha")->number[0] == -1 && strcmp(column(t, "alpha")->name, "tube.damage.alpha") == 0);
    CHECK(column(t, "alpha") == column(t, "tube.damage.alpha"));
    CHECK(run_table_column(t, "lpha", &c, &r) == STATUS_INPUT);
    CHECK(ledger_parameter(l, ids[0], "rope.damage.alpha", "1", -2, NULL, false, &r) == STATUS_OK);
    run_table_free(t);
    CHECK(run_table_read(l, &t, &r) == STATUS_OK);
    CHECK(run_table_column(t, "alpha", &c, &r) == STATUS_INPUT && strcmp(r.nearest, "rope.damage.alpha") == 0);
    CHECK(run_table_column(t, "brokn_fraction", &c, &r) == STATUS_INPUT && strcmp(r.nearest, "broken_fraction") == 0);
    run_table_free(t);
    ledger_close(l);
}

/* The rows that a filter leaves, as a word of run numbers, the newest first. */
static const char *filtered(run_table *t, const char *filter) {
    static char text[64];
    int rows[16], count = 0;
    report r;
    text[0] = '\0';
    if (run_table_filter(t, filter, rows, &count, &r) != STATUS_OK) {
        snprintf(text, sizeof text, "%.60s", r.nearest[0] ? r.nearest : "wrong");
        return text;
    }
    for (int i = 0; i < count; i++) snprintf(text + i, sizeof text - (size_t)i, "%d", rows[i]);
    return text;
}

static void test_filters(void) {
    char ids[3][LEDGER_ID];
    ledger *l = three_runs("filters.db", ids);
    run_table *t;
    report r;
    CHECK(run_table_read(l, &t, &r) == STATUS_OK);
    static const struct {
        const char *filter, *rows;
    } cases[] = {{"", "210"}, {"tube", "210"}, {"TUBE", "210"}, {"paper", "0"}, {"apart", "1"}, {"!paper", "21"}, {"eta<0.3", "1"}, {"eta<=0.3", "21"},
                 {"eta>0.3", "0"}, {"eta>=0.3", "20"}, {"eta=0.3", "2"}, {"eta!=0.3", "10"}, {"!eta=0.3", "10"}, {"status=done", "0"}, {"status!=done", "21"},
                 {"variant=FULL", "0"}, {"variant~iso", "1"}, {"variant!=full", "21"}, {"eta<0.4 tube status=failed", "1"}, {"broken_fraction>0.1", "0"},
                 {"frames_wanted=4", "210"}, {"gamma~1", "210"}, {"nothing", ""}, {"etta<1", "eta"}, {"eta<x", "wrong"}, {"eta<", "wrong"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const char *found = filtered(t, cases[i].filter);
        if (strcmp(found, cases[i].rows) != 0) printf("  '%s' gave '%s', expected '%s'\n", cases[i].filter, found, cases[i].rows);
        CHECK(strcmp(found, cases[i].rows) == 0);
    }
    run_table_free(t);
    ledger_close(l);
}

static void test_order(void) {
    char ids[3][LEDGER_ID];
    ledger *l = three_runs("order.db", ids);
    run_table *t;
    report r;
    int rows[3], count;
    CHECK(run_table_read(l, &t, &r) == STATUS_OK);
    CHECK(run_table_filter(t, "", rows, &count, &r) == STATUS_OK && count == 3);
    CHECK(run_table_sort(t, "eta", false, rows, 3, &r) == STATUS_OK && rows[0] == 1 && rows[1] == 2 && rows[2] == 0);
    CHECK(run_table_sort(t, "eta", true, rows, 3, &r) == STATUS_OK && rows[0] == 0 && rows[2] == 1);
    /* Without a variant: last, whichever way. */
    CHECK(run_table_sort(t, "variant", false, rows, 3, &r) == STATUS_OK && rows[0] == 0 && rows[2] == 2);
    CHECK(run_table_sort(t, "variant", true, rows, 3, &r) == STATUS_OK && rows[0] == 1 && rows[2] == 2);
    /* Ties: the newest first. */
    CHECK(run_table_sort(t, "gamma", true, rows, 3, &r) == STATUS_OK && rows[0] == 2 && rows[1] == 1 && rows[2] == 0);
    CHECK(run_table_sort(t, "nobody", true, rows, 3, &r) == STATUS_INPUT);
    run_table_free(t);
    ledger_close(l);
}

/* Another connection's writes and one's own are both seen. */
static void test_age(void) {
    char ids[3][LEDGER_ID], id[LEDGER_ID];
    ledger *l = three_runs("age.db", ids), *other = open_ledger("age.db");
    run_table *t;
    report r;
    CHECK(run_table_read(l, &t, &r) == STATUS_OK);
    CHECK(!run_table_is_old(t));
    write_run(other, "new", 1, 1, "done", id);
    CHECK(run_table_is_old(t));
    run_table_free(t);
    CHECK(run_table_read(l, &t, &r) == STATUS_OK && run_table_rows(t) == 4 && !run_table_is_old(t));
    CHECK(ledger_tag(l, ids[0], "mine", true, &r) == STATUS_OK && run_table_is_old(t));
    run_table_free(t);
    ledger_close(other);
    ledger_close(l);
}

static void test_curves(void) {
    char ids[3][LEDGER_ID];
    ledger *l = three_runs("curves.db", ids);
    run_curve curve = {0};
    report r;
    CHECK(run_curve_read(l, ids[0], "kinetic", &curve, &r) == STATUS_OK && curve.count == 5);
    CHECK(curve.count == 5 && curve.y[4] == 6.0 && fabs(curve.x[4] - 4.0 / 24) < 1e-15);
    curve.count = 0;
    for (int i = 0; i < 3; i++) CHECK(run_curve_point(l, ids[i], "eta", "broken_fraction", &curve, &r) == STATUS_OK);
    run_curve_sort(&curve);
    CHECK(curve.count == 3 && curve.x[0] == 0.1 && curve.x[2] == 0.5 && fabs(curve.y[0] - 0.02) < 1e-15);
    CHECK(run_curve_point(l, ids[0], "kernel", "broken_fraction", &curve, &r) == STATUS_OK && curve.count == 3); /* a text is no place on an axis */
    run_curve_free(&curve);
    ledger_close(l);
}

/* Ten thousand runs of thirty parameters: what a filter takes is printed, for people; that it is right is checked. */
static void test_many(void) {
    ledger *l = open_ledger("many.db");
    run_table *t;
    report r;
    char id[LEDGER_ID];
    enum { MANY = 10000 };
    write_run(l, "first", 0, 2, "done", id);
    sql_do("many.db",
           "WITH RECURSIVE n(i) AS (VALUES (2) UNION ALL SELECT i + 1 FROM n WHERE i < 10000) INSERT INTO runs (id, status, started, scene_path, scene_title, scene_hash, "
           "variant, command, output, precision, simd, version, effects, threads, particles, frames_wanted, seed, host, boot, pid_space, pid, pid_started) "
           "SELECT printf('20261122-%06d-abcd', i), 'done', 1e9 + i, 's.lua', 'Tube ' || (i % 7), 'h', 'v' || (i % 3), 'c', 'o', 'f32', 'avx2', '1', 'e', 2, 1000 * i, 10, 1, "
           "'h', '', '', 1, 0 FROM n;"
           "INSERT INTO run_parameters SELECT run, 'p' || k, '1', run * k, NULL, 0 FROM runs, (WITH RECURSIVE m(k) AS (VALUES (1) UNION ALL SELECT k + 1 FROM m WHERE k < 30) "
           "SELECT k FROM m);"
           "INSERT INTO frames SELECT run, f, f * 0.1, f, f FROM runs, (SELECT 0 AS f UNION SELECT 1 UNION SELECT 2) WHERE run > 1;"
           "INSERT INTO run_measures SELECT run, frame, measure, run * 0.001 * frame FROM frames, measures WHERE run > 1;");
    double start = clock_seconds();
    CHECK(run_table_read(l, &t, &r) == STATUS_OK && run_table_rows(t) == MANY);
    double read = clock_seconds();
    int *rows = memory_allocate_array(MANY, sizeof *rows), count;
    CHECK(run_table_filter(t, "p7<7000 broken_fraction>0.5 tube", rows, &count, &r) == STATUS_OK);
    double first = clock_seconds();
    CHECK(count == 749); /* runs 251 … 999: 7 run < 7000 and 0.002 run > 0.5 */
    CHECK(run_table_filter(t, "p7<7000 broken_fraction>0.5 tube", rows, &count, &r) == STATUS_OK && count == 749);
    double again = clock_seconds();
    CHECK(run_table_filter(t, "", rows, &count, &r) == STATUS_OK && count == MANY);
    CHECK(run_table_sort(t, "p3", true, rows, count, &r) == STATUS_OK && strcmp(run_table_id(t, rows[0]), "20261122-010000-abcd") == 0);
    double sorted = clock_seconds();
    printf("  10000 runs: read %.0f ms, first filter with two new columns %.0f ms, again %.1f ms, sort %.1f ms\n", 1e3 * (read - start), 1e3 * (first - read),
           1e3 * (again - first), 1e3 * (sorted - again));
    memory_free(rows, MANY * sizeof *rows);
    run_table_free(t);
    ledger_close(l);
}

int main(void) {
    scratch_make();
    RUN(test_cells);
    RUN(test_filters);
    RUN(test_order);
    RUN(test_age);
    RUN(test_curves);
    RUN(test_many);
    return check_finish();
}
