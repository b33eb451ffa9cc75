/* sunder stress: the hard cases, one verdict each. */
#include "cli/cli.h"

#include "base/json.h"
#include "base/memory.h"
#include "base/names.h"
#include "base/threads.h"
#include "cli/stress_list.h"
#include "solid/solid.h"
#include "study/stress.h"

#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { EFFECTS = 16, WORDS = 64, SIMDS = 3 };
static const double full_scale = 8; /* of particles */
static const char *const simds[SIMDS] = {"plain", "avx2", "avx512"};

typedef struct stress_command {
    const char *words[WORDS], *effects[EFFECTS], *database, *simd;
    int word_count, effect_count;
    bool single, both, full, list, last, json, quiet, verbose, markdown, measures; /* single: f64 alone */
    long jobs, threads, limit;
    char path[1024];
    stress_suite suite;
    stress_run *runs; // [run_count]
    int run_count;
} stress_command;

/* ---- which cases, how --------------------------------------------------------------------------------------------- */

static int wrong_word(const char *key, const char *expected, const char *found, const char *nearest) {
    report r;
    report_input(&r, NULL, 0, key, expected, found, nearest);
    return cli_fail(&r);
}

static int effect_mask(const stress_command *c, uint32_t *mask) {
    int count;
    const effect *const *all = effect_catalogue(&count);
    const char *names[EFFECT_LIMIT];
    *mask = c->effect_count == 0 ? ~0u : 0;
    for (int e = 0; e < count; e++) names[e] = all[e]->name;
    for (int i = 0; i < c->effect_count; i++) {
        uint32_t before = *mask;
        for (int e = 0; e < count; e++)
            if (strcmp(names[e], c->effects[i]) == 0) *mask |= 1u << e;
        if (*mask == before && effect_index(c->effects[i]) < 0)
            return wrong_word("--effect", "an effect (sunder help effects)", c->effects[i], name_nearest(c->effects[i], names, count));
    }
    return 0;
}

/* What a case is compared with is chosen too. */
static int choose(const stress_command *c, bool *chosen) {
    uint32_t mask;
    int code = effect_mask(c, &mask);
    for (int i = 0; i < c->word_count && code == 0; i++)
        if (stress_match(&c->suite, c->words[i], chosen) == 0)
            code = wrong_word("case", "a hard case (sunder stress --list)", c->words[i], stress_nearest(&c->suite, c->words[i]));
    for (int i = 0; i < c->suite.count && code == 0; i++) {
        const stress_case *one = &c->suite.cases[i];
        chosen[i] = (chosen[i] || c->word_count == 0) && (one->effects & mask);
    }
    for (int i = 0; i < c->suite.count && code == 0; i++)
        if (chosen[i] && c->suite.cases[i].like >= 0) chosen[c->suite.cases[i].like] = true;
    return code;
}

static bool has_simd(const char *name) {
    return solid_engine_find(32, name) != NULL;
}

/* Every chosen case in this precision, instruction set and size, each beside the one that it is compared with. */
static void add_runs(stress_command *c, const bool *chosen, int precision, const char *simd, double scale) {
    int *of = memory_allocate_array((size_t)c->suite.count + 1, sizeof *of);
    for (int i = 0; i < c->suite.count && of; i++) {
        of[i] = c->run_count;
        if (!chosen[i]) continue;
        stress_run *run = &c->runs[c->run_count++];
        *run = (stress_run){.which = i, .precision = precision, .scale = scale, .like = -1, .difference = NAN};
        snprintf(run->simd, sizeof run->simd, "%s", simd);
        for (int k = 0; k < HARD_MEASURE_COUNT; k++) run->value[k] = NAN;
    }
    for (int i = 0; i < c->suite.count && of; i++)
        if (chosen[i] && c->suite.cases[i].like >= 0) c->runs[of[i]].like = of[c->suite.cases[i].like];
    memory_free(of, ((size_t)c->suite.count + 1) * sizeof *of);
}

static int plan_runs(stress_command *c) {
    bool chosen[1024] = {false};
    int code = choose(c, chosen), most = c->suite.count * 2 * SIMDS;
    if (code) return code;
    report r;
    c->runs = memory_allocate_array((size_t)most + 1, sizeof *c->runs);
    if (!c->runs) return cli_fail((report_set(&r, STATUS_SYSTEM, "out of memory for %d runs", most), &r));
    double scale = c->full ? full_scale : 1;
    for (int precision = 32; precision <= 64; precision += 32) {
        if (!c->both && (precision == 64) != c->single) continue;
        if (!c->full || c->simd) add_runs(c, chosen, precision, c->simd ? c->simd : "", scale);
        for (int k = 0; k < SIMDS && c->full && !c->simd; k++)
            if (has_simd(simds[k])) add_runs(c, chosen, precision, simds[k], scale);
    }
    return 0;
}

/* ---- telling ------------------------------------------------------------------------------------------------------ */

static void print_line(FILE *out, const stress_command *c, int which) {
    const stress_run *run = &c->runs[which];
    fprintf(out, "%d/%d  %-11s  %s  %s  f%d%s%s  %s\n", which + 1, c->run_count, stress_verdict_word(run->verdict), run->id[0] ? run->id : "-",
            c->suite.cases[run->which].name, run->precision, run->simd[0] ? "/" : "", run->simd, run->text);
    fflush(out);
}

static void tell(void *context, int run) {
    const stress_command *c = context;
    if (c->quiet || (c->runs[run].verdict == STRESS_GOING && !c->verbose)) return;
    print_line(c->json ? stderr : stdout, c, run);
}

static int count_verdict(const stress_command *c, stress_verdict v) {
    int count = 0;
    for (int i = 0; i < c->run_count; i++) count += c->runs[i].verdict == v;
    return count;
}

static void write_figures(json_writer *w, const stress_run *run, const hard_case *h) {
    json_member_array(w, "figures");
    for (int i = 0; i < h->count; i++) {
        const hard_expectation *e = &h->items[i];
        double value = run->value[e->measure];
        json_object(w);
        json_member_string(w, "measure", hard_measure_at(e->measure)->key);
        json_member_number(w, "value", value);
        json_member_number(w, "low", e->low);
        json_member_number(w, "high", e->high);
        json_member_boolean(w, "holds", value >= e->low && value <= e->high);
        json_object_end(w);
    }
    json_array_end(w);
    json_member_object(w, "measures");
    for (int m = 0; m < HARD_MEASURE_COUNT; m++)
        if (!isnan(run->value[m])) json_member_number(w, hard_measure_at(m)->key, run->value[m]);
    json_object_end(w);
}

static void write_run(json_writer *w, const stress_command *c, const stress_run *run) {
    const stress_case *one = &c->suite.cases[run->which];
    json_object(w);
    json_member_string(w, "case", one->name);
    json_member_string(w, "title", one->title);
    json_member_string(w, "scene", one->scene);
    json_member_string(w, "precision", run->precision == 32 ? "f32" : "f64");
    json_member_string(w, "simd", run->simd[0] ? run->simd : "auto");
    json_member_string(w, "verdict", stress_verdict_word(run->verdict));
    json_member_string(w, "run_id", run->id[0] ? run->id : NULL);
    json_member_integer(w, "exit_code", run->exit_code);
    json_member_number(w, "seconds", run->seconds);
    json_member_string(w, "message", run->message[0] ? run->message : NULL);
    json_member_string(w, "text", run->text);
    json_member_string(w, "stop", one->hard.stop[0] ? one->hard.stop : NULL);
    json_member_string(w, "known_limit", one->hard.known_limit[0] ? one->hard.known_limit : NULL);
    if (one->like >= 0) json_member_number(w, "difference", run->difference);
    write_figures(w, run, &one->hard);
    json_object_end(w);
}

static status print_json(const stress_command *c, report *r) {
    json_writer w;
    json_begin(&w, 2);
    json_object(&w);
    json_member_string(&w, "db", c->path);
    json_member_integer(&w, "holds", count_verdict(c, STRESS_HOLDS));
    json_member_integer(&w, "stops", count_verdict(c, STRESS_STOPS));
    json_member_integer(&w, "known_limits", count_verdict(c, STRESS_KNOWN));
    json_member_integer(&w, "fails", count_verdict(c, STRESS_FAILS));
    json_member_integer(&w, "not_run", count_verdict(c, STRESS_WAITING));
    json_member_array(&w, "runs");
    for (int i = 0; i < c->run_count; i++) write_run(&w, c, &c->runs[i]);
    json_array_end(&w);
    json_object_end(&w);
    return cli_print_json(&w, r);
}

/* ---- the command -------------------------------------------------------------------------------------------------- */

enum { OPTION_EFFECT = 256, OPTION_PRECISION, OPTION_SIMD, OPTION_THREADS, OPTION_QUICK, OPTION_FULL, OPTION_LIST, OPTION_LAST, OPTION_JSON, OPTION_QUIET,
       OPTION_VERBOSE, OPTION_DB, OPTION_LIMIT, OPTION_MARKDOWN, OPTION_MEASURES };

static const struct option long_options[] = {
    {"effect", required_argument, NULL, OPTION_EFFECT},   {"precision", required_argument, NULL, OPTION_PRECISION},
    {"simd", required_argument, NULL, OPTION_SIMD},       {"threads", required_argument, NULL, OPTION_THREADS},
    {"quick", no_argument, NULL, OPTION_QUICK},           {"full", no_argument, NULL, OPTION_FULL},
    {"list", no_argument, NULL, OPTION_LIST},             {"last", no_argument, NULL, OPTION_LAST},
    {"json", no_argument, NULL, OPTION_JSON},             {"quiet", no_argument, NULL, OPTION_QUIET},
    {"verbose", no_argument, NULL, OPTION_VERBOSE},       {"db", required_argument, NULL, OPTION_DB},
    {"time-limit", required_argument, NULL, OPTION_LIMIT}, {"markdown", no_argument, NULL, OPTION_MARKDOWN},
    {"measures", no_argument, NULL, OPTION_MEASURES},     {"jobs", required_argument, NULL, 'j'},
    {NULL, 0, NULL, 0}};

static int parse_precision(stress_command *c, const char *text) {
    c->single = strcmp(text, "f64") == 0;
    c->both = strcmp(text, "both") == 0;
    return c->single || c->both || strcmp(text, "f32") == 0 ? 0 : cli_usage("stress", "--precision %s: expected f32, f64 or both", text);
}

static int parse_simd(stress_command *c, const char *text) {
    const char *const *known = simds;
    bool found = false;
    for (int i = 0; i < SIMDS; i++) found = found || strcmp(known[i], text) == 0;
    if (!found && strcmp(text, "auto") != 0) return cli_usage("stress", "--simd %s: expected auto, plain, avx2 or avx512", text);
    c->simd = found ? text : "";
    return 0;
}

static int parse_option(stress_command *c, int option) {
    switch (option) {
    case OPTION_EFFECT:
        if (c->effect_count == EFFECTS) return cli_usage("stress", "--effect: at most %d times", EFFECTS);
        c->effects[c->effect_count++] = optarg;
        return 0;
    case OPTION_PRECISION: return parse_precision(c, optarg);
    case OPTION_SIMD: return parse_simd(c, optarg);
    case OPTION_THREADS: return cli_number("stress", "--threads", optarg, 1, 256, &c->threads);
    case 'j': return cli_number("stress", "-j", optarg, 1, 64, &c->jobs);
    case OPTION_LIMIT: return cli_number("stress", "--time-limit", optarg, 1, 100000, &c->limit);
    case OPTION_QUICK: c->full = false; return 0;
    case OPTION_FULL: c->full = c->both = true; return 0;
    case OPTION_LIST: c->list = true; return 0;
    case OPTION_LAST: c->last = true; return 0;
    case OPTION_JSON: c->json = true; return 0;
    case OPTION_QUIET: c->quiet = true; return 0;
    case OPTION_VERBOSE: c->verbose = true; return 0;
    case OPTION_DB: c->database = optarg; return 0;
    case OPTION_MARKDOWN: c->markdown = true; return 0;
    case OPTION_MEASURES: c->measures = true; return 0;
    default: return cli_usage("stress", "wrong option");
    }
}

static int parse(stress_command *c, int count, char **arguments) {
    int option, code = 0;
    while (code == 0 && (option = getopt_long(count, arguments, "j:", long_options, NULL)) != -1) code = parse_option(c, option);
    for (; code == 0 && optind < count; optind++) {
        if (c->word_count == WORDS) return cli_usage("stress", "at most %d cases", WORDS);
        c->words[c->word_count++] = arguments[optind];
    }
    if (code == 0 && c->measures && c->json) return cli_usage("stress", "--measures is a table for people: without --json");
    if (c->limit == 0) c->limit = c->full ? 3600 : 300;
    if (c->jobs == 0) c->jobs = processor_count() > c->threads ? processor_count() / c->threads : 1;
    return code;
}

/* "case  NAME  damage,elastic  what it is" */
static void print_about(const stress_case *one) {
    int count;
    const effect *const *all = effect_catalogue(&count);
    printf("case  %s  ", one->name);
    for (int e = 0, shown = 0; e < count; e++)
        if (one->effects >> e & 1) printf("%s%s", shown++ ? "," : "", all[e]->name);
    printf("  %s\n", one->remark[0] ? one->remark : one->title);
}

/* The ledger's verdicts of before, printed as lines: what the workbench reads when it opens the screen. */
static int show_last(stress_command *c) {
    report r;
    ledger *l = NULL;
    status code = ledger_open(c->path, &l, &r);
    if (code == STATUS_OK) code = stress_recall(l, &c->suite, c->runs, c->run_count, &r);
    ledger_close(l);
    if (code == STATUS_OK && c->json) code = print_json(c, &r);
    for (int i = 0; i < c->run_count && code == STATUS_OK && !c->json; i++) print_line(stdout, c, i);
    for (int i = 0; i < c->suite.count && code == STATUS_OK && !c->json && c->verbose; i++) print_about(&c->suite.cases[i]);
    return code == STATUS_OK ? 0 : cli_fail(&r);
}

static int make_runs(stress_command *c) {
    report r;
    stress_request q = {.suite = &c->suite, .runs = c->runs, .count = c->run_count, .jobs = (int)c->jobs, .threads = (int)c->threads,
                        .limit = (double)c->limit, .database = c->path, .tell = tell, .context = c};
    status code = stress_work(&q, &r);
    if (code != STATUS_OK && code != STATUS_INTERRUPTED) return cli_fail(&r);
    report own;
    if (c->json && print_json(c, &own) != STATUS_OK) return cli_fail(&own);
    int fails = count_verdict(c, STRESS_FAILS);
    if (!c->json && !c->quiet)
        printf("%d hold, %d stop as they should, %d known limits, %d fail, of %d: sunder runs list --where \"tags LIKE '%%stress:%%'\"\n",
               count_verdict(c, STRESS_HOLDS), count_verdict(c, STRESS_STOPS), count_verdict(c, STRESS_KNOWN), fails, c->run_count);
    return code == STATUS_INTERRUPTED ? 130 : fails ? 1 : 0;
}

int command_stress(int count, char **arguments) {
    static stress_command c = {.threads = 1};
    static script_reports reports;
    report r;
    int code = parse(&c, count, arguments);
    if (code) return code;
    if (c.measures) return stress_print_measures(c.markdown);
    if (stress_find(&c.suite, &reports) != STATUS_OK) {
        stress_free(&c.suite);
        return cli_fail_script(&reports);
    }
    status found = STATUS_OK;
    if (c.database) snprintf(c.path, sizeof c.path, "%s", c.database);
    else found = ledger_default_path(c.path, sizeof c.path, &r);
    code = found != STATUS_OK ? cli_fail(&r) : plan_runs(&c);
    if (code == 0 && c.list) code = stress_print_list(&c.suite, c.json, c.markdown);
    else if (code == 0) code = c.last ? show_last(&c) : make_runs(&c);
    memory_free(c.runs, ((size_t)c.suite.count * 2 * SIMDS + 1) * sizeof *c.runs);
    stress_free(&c.suite);
    return code;
}
