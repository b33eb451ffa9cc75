#include "store/run_curves.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

void run_curve_free(run_curve *c) {
    memory_free(c->x, (size_t)c->capacity * sizeof *c->x);
    memory_free(c->y, (size_t)c->capacity * sizeof *c->y);
    *c = (run_curve){0};
}

static status grow(run_curve *c, report *r) {
    int wanted = c->capacity ? 2 * c->capacity : 64;
    run_curve larger = {.x = memory_allocate_array((size_t)wanted, sizeof *c->x), .y = memory_allocate_array((size_t)wanted, sizeof *c->y),
                        .count = c->count, .capacity = wanted};
    if (!larger.x || !larger.y) {
        run_curve_free(&larger);
        return report_set(r, STATUS_SYSTEM, "out of memory for a curve");
    }
    if (c->count) memcpy(larger.x, c->x, (size_t)c->count * sizeof *c->x);
    if (c->count) memcpy(larger.y, c->y, (size_t)c->count * sizeof *c->y);
    run_curve_free(c);
    *c = larger;
    return STATUS_OK;
}

static status take_pair(void *context, const ledger_cell *cells, int count, report *r) {
    run_curve *c = context;
    (void)count;
    if (c->count == c->capacity) {
        status code = grow(c, r);
        if (code != STATUS_OK) return code;
    }
    c->x[c->count] = cells[0].number;
    c->y[c->count++] = cells[1].number;
    return STATUS_OK;
}

status run_curve_read(ledger *l, const char *id, const char *measure, run_curve *out, report *r) {
    char run[LEDGER_ID + 8], name[160];
    const char *const arguments[] = {run, name};
    snprintf(run, sizeof run, "run=%s", id);
    snprintf(name, sizeof name, "measure=%s", measure);
    /* By the keys: the view with the names would read all measures of the run. */
    static const char sql[] =
        "SELECT f.time, x.value FROM runs AS r JOIN frames AS f ON f.run = r.run JOIN run_measures AS x ON x.run = f.run AND x.frame = f.frame "
        "AND x.measure = (SELECT measure FROM measures WHERE name = :measure) WHERE r.id = :run ORDER BY f.frame";
    out->count = 0;
    return ledger_each_row(l, sql, arguments, 2, take_pair, out, r);
}

status run_curve_point(ledger *l, const char *id, const char *parameter, const char *measure, run_curve *out, report *r) {
    char run[LEDGER_ID + 8], name[160], key[160];
    const char *const arguments[] = {run, name, key};
    snprintf(run, sizeof run, "run=%s", id);
    snprintf(name, sizeof name, "measure=%s", measure);
    snprintf(key, sizeof key, "parameter=%s", parameter);
    static const char sql[] = "SELECT p.number, m.value FROM final_measures AS m JOIN run_parameters AS p ON p.run = m.run "
                              "WHERE m.id = :run AND m.name = :measure AND p.name = :parameter AND p.number IS NOT NULL AND m.value IS NOT NULL";
    return ledger_each_row(l, sql, arguments, 3, take_pair, out, r);
}

typedef struct pair {
    double x, y;
} pair;

static int compare_pairs(const void *a, const void *b) {
    double x = ((const pair *)a)->x, y = ((const pair *)b)->x;
    return (x > y) - (x < y);
}

void run_curve_sort(run_curve *c) {
    pair *pairs = memory_allocate_array((size_t)c->count, sizeof *pairs);
    if (!pairs) return; /* an unsorted curve is drawn as it came */
    for (int i = 0; i < c->count; i++) pairs[i] = (pair){c->x[i], c->y[i]};
    if (c->count > 1) qsort(pairs, (size_t)c->count, sizeof *pairs, compare_pairs);
    for (int i = 0; i < c->count; i++) c->x[i] = pairs[i].x, c->y[i] = pairs[i].y;
    memory_free(pairs, (size_t)c->count * sizeof *pairs);
}
