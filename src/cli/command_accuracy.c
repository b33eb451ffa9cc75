/* sunder accuracy: what accuracy costs in time. */
#include "cli/cli.h"

#include "cli/accuracy_print.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

enum { WORDS = 32 };

typedef struct accuracy_command {
    cli_scene_options given;
    accuracy_options options;
    const char *database, *csv;
    const char *axes[WORDS], *measures[WORDS];
    char path[1024], command[1024];
    bool json, quiet, list;
    accuracy_study *study;
    int number, wanted; /* of the runs that are made now */
} accuracy_command;

enum { OPTION_SET = 256, OPTION_RECIPE, OPTION_AXIS, OPTION_LEVELS, OPTION_MEASURE, OPTION_FRAMES, OPTION_BUDGET, OPTION_THREADS, OPTION_PRECISION, OPTION_SIMD,
       OPTION_OUT, OPTION_CSV, OPTION_DB, OPTION_JSON, OPTION_QUIET, OPTION_LIST };

static const struct option long_options[] = {
    {"set", required_argument, NULL, OPTION_SET},         {"recipe", required_argument, NULL, OPTION_RECIPE},
    {"axis", required_argument, NULL, OPTION_AXIS},       {"levels", required_argument, NULL, OPTION_LEVELS},
    {"measure", required_argument, NULL, OPTION_MEASURE}, {"frames", required_argument, NULL, OPTION_FRAMES},
    {"budget", required_argument, NULL, OPTION_BUDGET},   {"threads", required_argument, NULL, OPTION_THREADS},
    {"precision", required_argument, NULL, OPTION_PRECISION}, {"simd", required_argument, NULL, OPTION_SIMD},
    {"out", required_argument, NULL, OPTION_OUT},         {"csv", required_argument, NULL, OPTION_CSV},
    {"db", required_argument, NULL, OPTION_DB},           {"json", no_argument, NULL, OPTION_JSON},
    {"quiet", no_argument, NULL, OPTION_QUIET},           {"list", no_argument, NULL, OPTION_LIST},
    {"jobs", required_argument, NULL, 'j'},               {NULL, 0, NULL, 0}};

static int add_word(const char *option, const char *words[WORDS], int *count, const char *word) {
    if (*count == WORDS) return cli_usage("accuracy", "%s: at most %d times", option, WORDS);
    words[(*count)++] = word;
    return 0;
}

static int parse_budget(accuracy_options *o, const char *text) {
    char *end;
    errno = 0;
    o->budget = strtod(text, &end);
    if (end != text && *end == '\0' && errno == 0 && o->budget > 0 && isfinite(o->budget)) return 0;
    return cli_usage("accuracy", "--budget %s: expected seconds", text);
}

static int parse_whole(const char *option, const char *text, long low, long high, int *out) {
    long value = 0;
    int code = cli_number("accuracy", option, text, low, high, &value);
    *out = (int)value;
    return code;
}

static int parse_option(accuracy_command *c, int option) {
    accuracy_options *o = &c->options;
    long value = 0;
    int code = 0;
    switch (option) {
    case OPTION_SET: return cli_add_setting(&c->given, "accuracy", optarg);
    case OPTION_RECIPE: o->recipe = optarg; break;
    case OPTION_AXIS: return add_word("--axis", c->axes, &o->axis_count, optarg);
    case OPTION_MEASURE: return add_word("--measure", c->measures, &o->measure_count, optarg);
    case OPTION_LEVELS: return parse_whole("--levels", optarg, 2, AXIS_LEVELS, &o->levels);
    case OPTION_FRAMES:
        code = cli_number("accuracy", "--frames", optarg, 1, 1000000, &value);
        o->frames = value;
        return code;
    case OPTION_BUDGET: return parse_budget(o, optarg);
    case OPTION_THREADS: return parse_whole("--threads", optarg, 1, 256, &o->threads);
    case OPTION_PRECISION:
        if (strcmp(optarg, "f32") != 0 && strcmp(optarg, "f64") != 0) return cli_usage("accuracy", "--precision %s: expected f32 or f64", optarg);
        o->precision = optarg[1] == '6' ? 64 : 32;
        break;
    case OPTION_SIMD: o->simd = optarg; break;
    case OPTION_OUT: o->output = optarg; break;
    case OPTION_CSV: c->csv = optarg; break;
    case OPTION_DB: c->database = optarg; break;
    case OPTION_JSON: c->json = true; break;
    case OPTION_QUIET: c->quiet = true; break;
    case OPTION_LIST: c->list = true; break;
    case 'j': return parse_whole("-j", optarg, 1, STUDY_JOBS, &o->jobs);
    default: return cli_usage("accuracy", "wrong option");
    }
    return 0;
}

static int parse(accuracy_command *c, int count, char **arguments) {
    int option, code = 0;
    snprintf(c->command, sizeof c->command, "sunder");
    for (int i = 0; i < count; i++) {
        size_t used = strlen(c->command);
        snprintf(c->command + used, sizeof c->command - used, " %s", arguments[i]);
    }
    while (code == 0 && (option = getopt_long(count, arguments, "j:", long_options, NULL)) != -1) code = parse_option(c, option);
    if (code) return code;
    if (optind < count) c->given.scene = arguments[optind++];
    if (optind < count) return cli_usage("accuracy", "one scene at a time, found '%s' too", arguments[optind]);
    if (!c->given.scene) return cli_usage("accuracy", "expected a scene");
    c->options.scene = c->given.scene;
    c->options.settings = c->given.settings;
    c->options.setting_count = c->given.setting_count;
    c->options.axes = c->axes;
    c->options.measures = c->measures;
    c->options.command = c->command;
    return 0;
}

/* ---- telling ----------------------------------------------------------------------------------------------------- */

static FILE *people(const accuracy_command *c) {
    return c->json || (c->csv && strcmp(c->csv, "-") == 0) ? stderr : stdout;
}

static void told(void *context, int run, const study_result *result, bool ended) {
    accuracy_command *c = context;
    char name[96];
    if (!ended) c->number++;
    if (c->quiet) return;
    accuracy_run_name(c->study, run, name);
    const char *word = !ended ? "started" : result->outcome == STATUS_INTERRUPTED ? "interrupted" : result->outcome == STATUS_OK ? "done" : "failed";
    fprintf(people(c), "%d/%d  %-11s  %s  %s", c->number, c->wanted, word, result->id[0] ? result->id : "-", name);
    if (ended && result->outcome == STATUS_OK) fprintf(people(c), "  %.2g s, %.2g in all", result->step_seconds, result->seconds);
    if (ended && result->message[0]) fprintf(people(c), "  %s", result->message);
    fputc('\n', people(c));
    fflush(people(c));
}

static void say_plan(accuracy_command *c) {
    const accuracy_study *s = c->study;
    double seconds = accuracy_predicted(s, &c->wanted);
    int before = 0;
    for (int i = 0; i < s->run_count; i++) before += s->runs[i].state == ACCURACY_BEFORE;
    if (c->quiet) return;
    fprintf(people(c), "%s: %lld particles, %lld frames, f%d %s, %d threads\n", s->title, (long long)s->particles, (long long)s->frames, s->options.precision, s->simd,
            s->threads);
    fprintf(people(c), "%d runs, about ", c->wanted);
    if (seconds < 120) fprintf(people(c), "%.2g s", seconds);
    else fprintf(people(c), "%.0f min", seconds / 60);
    if (before) fprintf(people(c), "; %d done before", before);
    fprintf(people(c), "; in the ledger by their tag %s\n", s->tag);
    fflush(people(c));
}

static void on_signal(int number) {
    (void)number;
    study_stop();
}

static void catch_signals(void) {
    struct sigaction action = {.sa_handler = on_signal};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGHUP, &action, NULL);
}

/* ---- the end ----------------------------------------------------------------------------------------------------- */

static status write_rows(const accuracy_command *c, report *r) {
    if (!c->csv) return STATUS_OK;
    FILE *out = strcmp(c->csv, "-") == 0 ? stdout : fopen(c->csv, "w");
    if (!out) return report_set(r, STATUS_SYSTEM, "%s: %s", c->csv, strerror(errno));
    accuracy_print_rows(c->study, out);
    if (out == stdout) return STATUS_OK;
    return fclose(out) == 0 ? STATUS_OK : report_set(r, STATUS_SYSTEM, "%s: %s", c->csv, strerror(errno));
}

static status show(const accuracy_command *c, report *r) {
    status code = write_rows(c, r);
    if (code != STATUS_OK) return code;
    if (c->json) return accuracy_print_json(c->study, r);
    return c->csv && strcmp(c->csv, "-") == 0 ? STATUS_OK : accuracy_print(c->study, r);
}

static int study(accuracy_command *c, script_reports *reports) {
    report r, stopped;
    if (accuracy_plan(&c->options, &c->study, reports) != STATUS_OK) return cli_fail_script(reports);
    say_plan(c);
    status made = c->list ? STATUS_OK : accuracy_make(c->study, told, c, &stopped);
    if (made != STATUS_OK && made != STATUS_INTERRUPTED) return cli_fail(&stopped);
    if (accuracy_judge(c->study, &r) != STATUS_OK || show(c, &r) != STATUS_OK) return cli_fail(&r);
    if (made != STATUS_OK) return cli_fail(&stopped);
    for (int i = 0; i < c->study->run_count; i++)
        if (c->study->runs[i].state == ACCURACY_FAILED) return 1;
    return 0;
}

int command_accuracy(int count, char **arguments) {
    static accuracy_command c = {.options = {.levels = 3, .frames = -1, .precision = 32, .jobs = 1, .simd = "auto"}};
    static script_reports reports;
    report r;
    int code = parse(&c, count, arguments);
    if (code) return code;
    status found = STATUS_OK;
    if (c.database) snprintf(c.path, sizeof c.path, "%s", c.database);
    else found = ledger_default_path(c.path, sizeof c.path, &r);
    if (found != STATUS_OK) return cli_fail(&r);
    c.options.database = c.path;
    catch_signals();
    code = study(&c, &reports);
    accuracy_free(c.study);
    return code;
}
