/* sunder runs list, show, diff, best, query, sql: what only reads. */
#include "cli/runs.h"

#include "base/json.h"
#include "store/ledger_names.h"

#include <string.h>

enum { LIST_LIMIT = 50, BEST_LIMIT = 10, ARGUMENT = 300 };

status verb_list(ledger *l, const runs_options *o, int count, char **names, int *exit, report *r) {
    (void)exit;
    if (count > 0) return report_input(r, NULL, 0, "runs list", "no run names", names[0], NULL);
    return ledger_print_list(l, stdout, o->json, o->where, o->limit > 0 ? (int)o->limit : LIST_LIMIT, r);
}

status verb_show(ledger *l, const runs_options *o, int count, char **names, int *exit, report *r) {
    char id[LEDGER_ID];
    (void)exit;
    if (count != 1) return report_input(r, NULL, 0, "runs show", "one run (an id, its beginning or end, or last)", count ? "more" : "none", NULL);
    status code = runs_find(l, names[0], id, NULL, r);
    return code == STATUS_OK ? ledger_print_show(l, stdout, o->json, id, r) : code;
}

status verb_diff(ledger *l, const runs_options *o, int count, char **names, int *exit, report *r) {
    char a[LEDGER_ID], b[LEDGER_ID];
    (void)exit;
    if (count != 2) return report_input(r, NULL, 0, "runs diff", "two runs", count > 2 ? "more" : "fewer", NULL);
    status code = runs_find(l, names[0], a, NULL, r);
    if (code == STATUS_OK) code = runs_find(l, names[1], b, NULL, r);
    return code == STATUS_OK ? ledger_print_diff(l, stdout, o->json, a, b, r) : code;
}

/* runs best [MEASURE]: the ready-made query of that name. */
status verb_best(ledger *l, const runs_options *o, int count, char **names, int *exit, report *r) {
    char text[4][ARGUMENT];
    const char *arguments[4], *sql;
    int used = 0;
    (void)exit;
    if (count > 1) return report_input(r, NULL, 0, "runs best", "one measure", names[1], NULL);
    status code = count == 1 ? ledger_check_measure(l, names[0], r) : STATUS_OK;
    if (code == STATUS_OK) code = ledger_query("best", &sql, r);
    if (code != STATUS_OK) return code;
    if (count == 1) snprintf(text[used], ARGUMENT, "measure=%s", names[0]), arguments[used] = text[used], used++;
    if (o->most) arguments[used++] = "most=1";
    if (o->scene) snprintf(text[used], ARGUMENT, "scene=%s", o->scene), arguments[used] = text[used], used++;
    snprintf(text[used], ARGUMENT, "limit=%ld", o->limit > 0 ? o->limit : BEST_LIMIT);
    arguments[used] = text[used], used++;
    return ledger_print_sql(l, stdout, o->json, sql, arguments, used, r);
}

/* ---- ready-made queries ------------------------------------------------------------------------------------------ */

/* The comment that a query opens with, without its dashes; `first` stops after a sentence. */
static void describe(const char *sql, bool first, char *text, size_t size) {
    size_t used = 0;
    text[0] = '\0';
    while (strncmp(sql, "--", 2) == 0) {
        sql += 2;
        size_t length = strcspn(sql, "\n");
        if (first && sql[0] == ' ' && sql[1] == ' ') break; /* the parameters follow */
        int wrote = snprintf(text + used, size - used, "%s%.*s", used ? (first ? "" : "\n") : "", (int)length - !used, sql + !used);
        used += (size_t)wrote;
        if (used >= size) return;
        sql += length + (sql[length] == '\n');
    }
}

static status list_queries(bool json, report *r) {
    json_writer w;
    json_begin(&w, 0);
    json_object(&w);
    json_member_array(&w, "queries");
    for (int i = 0; ledger_query_name(i); i++) {
        const char *name = ledger_query_name(i), *sql;
        char text[1024];
        status code = ledger_query(name, &sql, r);
        if (code != STATUS_OK) return json_free(&w), code;
        describe(sql, true, text, sizeof text);
        json_object(&w);
        json_member_string(&w, "name", name);
        json_member_string(&w, "text", text);
        json_member_string(&w, "sql", sql);
        json_object_end(&w);
        if (!json) printf("%-10s %s\n", name, text);
    }
    json_array_end(&w);
    json_object_end(&w);
    status code = json_finish(&w, r);
    if (code == STATUS_OK && json) puts(w.text);
    json_free(&w);
    if (!json) puts("\nsunder runs query NAME [PARAMETER=VALUE]…   (runs query NAME help lists its parameters)");
    return code;
}

status verb_query(ledger *l, const runs_options *o, int count, char **names, int *exit, report *r) {
    const char *sql;
    char text[2048];
    (void)exit;
    if (count == 0) return list_queries(o->json, r);
    status code = ledger_query(names[0], &sql, r);
    if (code != STATUS_OK) return code;
    if (count == 2 && strcmp(names[1], "help") == 0) {
        describe(sql, false, text, sizeof text);
        return puts(text) < 0 ? report_set(r, STATUS_SYSTEM, "cannot write the output") : STATUS_OK;
    }
    return ledger_print_sql(l, stdout, o->json, sql, (const char *const *)(names + 1), count - 1, r);
}

status verb_sql(ledger *l, const runs_options *o, int count, char **names, int *exit, report *r) {
    (void)exit;
    if (count == 0) return report_input(r, NULL, 0, "runs sql", "a query, such as \"SELECT id, parameters ->> 'eta' FROM runs_view\"", "none", NULL);
    return ledger_print_sql(l, stdout, o->json, names[0], (const char *const *)(names + 1), count - 1, r);
}
