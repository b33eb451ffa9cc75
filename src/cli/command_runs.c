/* sunder runs: what the ledger remembers, asked and changed. */
#include "cli/runs.h"

#include "base/names.h"

#include <getopt.h>
#include <string.h>

status runs_find(ledger *l, const char *name, char id[LEDGER_ID], char *output, report *r) {
    char ignored[1024];
    return ledger_resolve(l, name, id, output ? output : ignored, 1024, r);
}

static const struct {
    const char *name;
    runs_verb *call;
} verbs[] = {{"list", verb_list}, {"show", verb_show}, {"diff", verb_diff}, {"best", verb_best}, {"query", verb_query}, {"sql", verb_sql},
             {"tag", verb_tag},   {"note", verb_note}, {"rm", verb_rm},     {"reproduce", verb_reproduce}};
enum { VERBS = sizeof verbs / sizeof *verbs };

static runs_verb *find_verb(const char *name, report *r) {
    const char *known[VERBS + 1];
    for (int i = 0; i < VERBS; i++) {
        known[i] = verbs[i].name;
        if (strcmp(verbs[i].name, name) == 0) return verbs[i].call;
    }
    known[VERBS] = "plot";
    report_input(r, NULL, 0, "runs", "list, show, diff, best, query, sql, plot, tag, note, rm or reproduce", name, name_nearest(name, known, VERBS + 1));
    return NULL;
}

enum { OPTION_DB = 256, OPTION_JSON, OPTION_WHERE, OPTION_LIMIT, OPTION_SCENE, OPTION_MOST, OPTION_YES, OPTION_KEEP_FILES, OPTION_REMOVE, OPTION_OUT, OPTION_THREADS };

static const struct option long_options[] = {
    {"db", required_argument, NULL, OPTION_DB},       {"json", no_argument, NULL, OPTION_JSON},
    {"where", required_argument, NULL, OPTION_WHERE}, {"limit", required_argument, NULL, OPTION_LIMIT},
    {"scene", required_argument, NULL, OPTION_SCENE}, {"most", no_argument, NULL, OPTION_MOST},
    {"yes", no_argument, NULL, OPTION_YES},           {"keep-files", no_argument, NULL, OPTION_KEEP_FILES},
    {"remove", no_argument, NULL, OPTION_REMOVE},     {"out", required_argument, NULL, OPTION_OUT},
    {"threads", required_argument, NULL, OPTION_THREADS}, {NULL, 0, NULL, 0}};

static int parse(runs_options *o, int count, char **arguments) {
    int option, code = 0;
    while (code == 0 && (option = getopt_long(count, arguments, "y", long_options, NULL)) != -1) {
        switch (option) {
        case OPTION_DB: o->database = optarg; break;
        case OPTION_JSON: o->json = true; break;
        case OPTION_WHERE: o->where = optarg; break;
        case OPTION_LIMIT: code = cli_number("runs", "--limit", optarg, 1, 1000000000, &o->limit); break;
        case OPTION_SCENE: o->scene = optarg; break;
        case OPTION_MOST: o->most = true; break;
        case 'y':
        case OPTION_YES: o->yes = true; break;
        case OPTION_KEEP_FILES: o->keep_files = true; break;
        case OPTION_REMOVE: o->remove = true; break;
        case OPTION_OUT: o->out = optarg; break;
        case OPTION_THREADS: code = cli_number("runs", "--threads", optarg, 1, 256, &o->threads); break;
        default: return cli_usage("runs", "wrong option");
        }
    }
    return code;
}

int command_runs(int count, char **arguments) {
    /* `runs plot` is `plot`, with its own options. */
    if (count > 1 && strcmp(arguments[1], "plot") == 0) return command_plot(count - 1, arguments + 1);
    runs_options o = {.limit = -1};
    int exit = parse(&o, count, arguments);
    if (exit) return exit;
    report r;
    ledger *l = NULL;
    runs_verb *verb = find_verb(optind < count ? arguments[optind++] : "list", &r);
    if (!verb) return cli_fail(&r);
    status code = ledger_open_past(o.database, o.path, sizeof o.path, &l, &r);
    if (code == STATUS_OK) code = verb(l, &o, count - optind, arguments + optind, &exit, &r);
    if (l) ledger_close(l);
    return code == STATUS_OK ? exit : cli_fail(&r);
}
