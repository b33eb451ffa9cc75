#include "store/ledger_names.h"

#include "base/names.h"
#include "store/ledger_internal.h"

#include <string.h>

static const char measures_sql[] = "SELECT name FROM measures ORDER BY name";
/* Steps from one name to the next in the index: a plain DISTINCT would read every row of it. */
static const char parameters_sql[] =
    "WITH RECURSIVE names(name) AS (SELECT min(name) FROM run_parameters UNION ALL "
    "SELECT (SELECT min(name) FROM run_parameters AS p WHERE p.name > names.name) FROM names WHERE name IS NOT NULL) "
    "SELECT name FROM names WHERE name IS NOT NULL";

static status each_name(ledger *l, const char *sql, void (*take)(void *context, const char *name), void *context, report *r) {
    sqlite3_stmt *statement;
    bool row = true;
    status s = ledger_statement(l, sql, &statement, r);
    while (!s && !(s = ledger_next(l, statement, &row, "read the names of measures", r)) && row)
        take(context, (const char *)sqlite3_column_text(statement, 0));
    return s;
}

status ledger_each_measure(ledger *l, void (*take)(void *context, const char *name), void *context, report *r) {
    return each_name(l, measures_sql, take, context, r);
}

status ledger_each_parameter(ledger *l, void (*take)(void *context, const char *name), void *context, report *r) {
    return each_name(l, parameters_sql, take, context, r);
}

typedef struct search {
    const char *wanted;
    bool whole; /* the name itself was met */
    int ends;   /* names that end in it, after a dot */
    double distance;
    char found[LEDGER_NAME], nearest[LEDGER_NAME];
} search;

static void remember_nearest(search *s, const char *name, const char *part) {
    if (!name_nearest(s->wanted, &part, 1)) return;
    double distance = name_distance(s->wanted, part);
    if (s->nearest[0] && distance >= s->distance) return;
    s->distance = distance;
    snprintf(s->nearest, sizeof s->nearest, "%s", name);
}

static void compare(void *context, const char *name) {
    search *s = context;
    size_t length = strlen(name), back = strlen(s->wanted);
    const char *dot = strrchr(name, '.');
    bool whole = strcmp(name, s->wanted) == 0;
    bool end = back > 0 && length > back && name[length - back - 1] == '.' && strcmp(name + length - back, s->wanted) == 0;
    if (whole || (end && !s->whole)) snprintf(s->found, sizeof s->found, "%s", name);
    s->whole |= whole;
    s->ends += end;
    remember_nearest(s, name, name);
    if (dot) remember_nearest(s, dot + 1, dot + 1);
}

status ledger_check_measure(ledger *l, const char *name, report *r) {
    search s = {.wanted = name};
    status code = each_name(l, measures_sql, compare, &s, r);
    if (code || s.whole) return code;
    return report_input(r, NULL, 0, "measure", "a measure that some run has", name, s.nearest[0] ? s.nearest : NULL);
}

status ledger_find_parameter(ledger *l, const char *word, char name[LEDGER_NAME], report *r) {
    search s = {.wanted = word};
    status code = each_name(l, parameters_sql, compare, &s, r);
    snprintf(name, LEDGER_NAME, "%s", s.found);
    if (code || s.whole || s.ends == 1) return code;
    if (s.ends > 1) return report_input(r, NULL, 0, "parameter", "the name of one parameter", "the end of several names", s.found);
    return report_input(r, NULL, 0, "parameter", "a parameter that some run has", word, s.nearest[0] ? s.nearest : NULL);
}
