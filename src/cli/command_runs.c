/* sunder runs: list, show and compare what the ledger remembers. */
#include "cli/cli.h"

#include "base/names.h"
#include "store/ledger.h"

#include <getopt.h>
#include <string.h>

static const struct option long_options[] = {
    {"db", required_argument, NULL, 'd'},    {"json", no_argument, NULL, 'j'}, {"where", required_argument, NULL, 'w'},
    {"limit", required_argument, NULL, 'l'}, {NULL, 0, NULL, 0}};

typedef struct runs_options {
    const char *database, *where;
    bool json;
    long limit;
} runs_options;

static status find_run(ledger *l, const char *name, char id[LEDGER_ID], report *r) {
    char output[1024];
    return ledger_resolve(l, name, id, output, sizeof output, r);
}

static status list(ledger *l, const runs_options *o, int count, char **names, report *r) {
    if (count > 0) return report_input(r, NULL, 0, "runs list", "no run names", names[0], NULL);
    return ledger_print_list(l, stdout, o->json, o->where, (int)o->limit, r);
}

static status show(ledger *l, const runs_options *o, int count, char **names, report *r) {
    char id[LEDGER_ID];
    if (count != 1) return report_input(r, NULL, 0, "runs show", "one run (an id, its beginning or end, or last)", count ? "more" : "none", NULL);
    status code = find_run(l, names[0], id, r);
    return code == STATUS_OK ? ledger_print_show(l, stdout, o->json, id, r) : code;
}

static status diff(ledger *l, const runs_options *o, int count, char **names, report *r) {
    char a[LEDGER_ID], b[LEDGER_ID];
    if (count != 2) return report_input(r, NULL, 0, "runs diff", "two runs", count > 2 ? "more" : "fewer", NULL);
    status code = find_run(l, names[0], a, r);
    if (code == STATUS_OK) code = find_run(l, names[1], b, r);
    return code == STATUS_OK ? ledger_print_diff(l, stdout, o->json, a, b, r) : code;
}

static const struct {
    const char *name;
    status (*call)(ledger *l, const runs_options *o, int count, char **names, report *r);
} verbs[] = {{"list", list}, {"show", show}, {"diff", diff}};

static status call_verb(const char *verb, ledger *l, const runs_options *o, int count, char **names, report *r) {
    const char *known[sizeof verbs / sizeof *verbs];
    for (size_t i = 0; i < sizeof verbs / sizeof *verbs; i++) {
        known[i] = verbs[i].name;
        if (strcmp(verbs[i].name, verb) == 0) return verbs[i].call(l, o, count, names, r);
    }
    return report_input(r, NULL, 0, "runs", "list, show or diff", verb, name_nearest(verb, known, (int)(sizeof known / sizeof *known)));
}

int command_runs(int count, char **arguments) {
    runs_options o = {.limit = 50};
    int option;
    while ((option = getopt_long(count, arguments, "", long_options, NULL)) != -1) {
        if (option == 'd') o.database = optarg;
        else if (option == 'w') o.where = optarg;
        else if (option == 'j') o.json = true;
        else if (option == 'l') {
            int code = cli_number("runs", "--limit", optarg, 1, 1000000000, &o.limit);
            if (code) return code;
        } else return cli_usage("runs", "wrong option");
    }
    const char *verb = optind < count ? arguments[optind++] : "list";
    char path[1024];
    report r;
    ledger *l = NULL;
    status code = STATUS_OK;
    if (o.database) snprintf(path, sizeof path, "%s", o.database);
    else code = ledger_default_path(path, sizeof path, &r);
    if (code == STATUS_OK) code = ledger_open(path, &l, &r);
    if (code == STATUS_OK) code = call_verb(verb, l, &o, count - optind, arguments + optind, &r);
    if (l) ledger_close(l);
    return code == STATUS_OK ? 0 : cli_fail(&r);
}
