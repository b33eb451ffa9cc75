/* sunder sweep: the runs of a sweep, as child processes side by side; what has been done before is not done again. */
#include "cli/cli.h"

#include "base/json.h"
#include "base/memory.h"
#include "base/threads.h"
#include "script/sweep.h"
#include "session/session.h"
#include "store/ledger.h"
#include "study/worker.h"

#include <getopt.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

enum { JOBS = 64, RUN_TEXT = 400 };
_Static_assert(WORKER_TEXTS >= 3 + CLI_SETTINGS + SWEEP_SETTINGS + SWEEP_AXES, "a run's settings fit among its words");

static const char *const state_names[] = {"not started", "interrupted", "done", "failed", "done before"};

typedef struct sweep_run {
    sweep_run_state state;
    int exit_code;
    char id[SWEEP_ID], message[SWEEP_MESSAGE];
} sweep_run;

typedef struct sweep_command {
    cli_scene_options given; /* .scene is the sweep's file */
    const char *database;
    long jobs, threads, frames;
    bool json, quiet, list, lines; /* list: say what is done, and run nothing; lines: for programs, also when a run starts */
    char path[1024], tag[64]; /* the ledger; the script's name, by which its runs are found again */
    sweep plan;
    int count;
    sweep_run *runs; // [count]
    worker job[JOBS];
} sweep_command;

/* ---- one run's settings ------------------------------------------------------------------------------------------ */

static const char *axis_value(const sweep_command *c, const int which[SWEEP_AXES], int axis) {
    return c->plan.axes[axis].value[which[axis]];
}

/* Fixed settings, then those of the command line, then the axes: the last one said holds. */
static int list_settings(const sweep_command *c, int run, script_setting *out) {
    int which[SWEEP_AXES], count = 0;
    sweep_cell(&c->plan, run, which);
    for (int i = 0; i < c->plan.fixed_count; i++) out[count++] = (script_setting){c->plan.fixed[i].name, c->plan.fixed[i].value[0]};
    for (int i = 0; i < c->given.setting_count; i++) out[count++] = c->given.settings[i];
    for (int a = 0; a < c->plan.axis_count; a++) out[count++] = (script_setting){c->plan.axes[a].name, axis_value(c, which, a)};
    return count;
}

static void describe_run(const sweep_command *c, int run, char text[RUN_TEXT]) {
    int which[SWEEP_AXES];
    size_t used = 0;
    sweep_cell(&c->plan, run, which);
    text[0] = '\0';
    for (int a = 0; a < c->plan.axis_count && used < RUN_TEXT; a++)
        used += (size_t)snprintf(text + used, RUN_TEXT - used, "%s%s=%s", a ? " " : "", c->plan.axes[a].name, axis_value(c, which, a));
}

static void say(const sweep_command *c, int run) {
    char text[RUN_TEXT];
    const sweep_run *r = &c->runs[run];
    if (c->lines) {
        sweep_line line = {.run = run, .count = c->count, .state = r->state};
        memcpy(line.id, r->id, sizeof line.id);
        memcpy(line.message, r->message, sizeof line.message);
        sweep_line_write(&line, stdout);
    }
    if (c->quiet || c->lines) return;
    describe_run(c, run, text);
    fprintf(c->json ? stderr : stdout, "%d/%d  %-11s  %s  %s%s%s\n", run + 1, c->count, state_names[r->state], *r->id ? r->id : "-", text,
            *r->message ? "  " : "", r->message);
    fflush(c->json ? stderr : stdout);
}

/* ---- what has been done before ----------------------------------------------------------------------------------- */

static status take_id(void *context, const ledger_cell *cells, int count, report *r) {
    (void)count, (void)r;
    snprintf(context, LEDGER_ID, "%s", cells[0].text ? cells[0].text : "");
    return STATUS_OK;
}

/* Loads the scene as one run would; false with the reports when it cannot be run. */
static bool identify(const sweep_command *c, int run, char hash[32], int64_t *frames, script_reports *reports) {
    script_setting settings[SWEEP_SETTINGS + CLI_SETTINGS + SWEEP_AXES];
    script_options o = script_options_default();
    o.settings = settings;
    o.setting_count = list_settings(c, run, settings);
    o.recipe = c->plan.recipe[0] ? c->plan.recipe : NULL;
    script *s;
    if (script_load(c->plan.scene, &o, &s, reports) != STATUS_OK) return false;
    sources_hash(s, hash);
    *frames = c->frames >= 0 ? c->frames : c->plan.frames >= 0 ? c->plan.frames : scene_frames(script_scene(s));
    script_close(s);
    return true;
}

static status find_done(ledger *l, const char *hash, int64_t frames, char id[LEDGER_ID], report *r) {
    char hash_argument[48], frames_argument[48];
    snprintf(hash_argument, sizeof hash_argument, "hash=%s", hash);
    snprintf(frames_argument, sizeof frames_argument, "frames=%lld", (long long)frames);
    const char *const arguments[] = {hash_argument, frames_argument};
    return ledger_each_row(l, "SELECT id FROM runs_view WHERE scene_hash = :hash AND status = 'done' AND frames_wanted = CAST(:frames AS INTEGER) "
                              "AND precision = 'f32' AND run NOT IN (SELECT run FROM knob_turns) ORDER BY run DESC LIMIT 1", arguments, 2, take_id, id, r);
}

/* Checks every run and marks those that are in the ledger already. STATUS_INPUT when not one can be run: then `reports` says why
 * the first cannot. */
static status prepare(sweep_command *c, script_reports *reports, report *r) {
    ledger *l = NULL;
    status code = ledger_open(c->path, &l, r);
    int runnable = 0;
    static script_reports own;
    for (int i = 0; i < c->count && code == STATUS_OK; i++) {
        char hash[32];
        int64_t frames;
        if (identify(c, i, hash, &frames, &own)) {
            runnable++;
            code = find_done(l, hash, frames, c->runs[i].id, r);
            if (c->runs[i].id[0]) c->runs[i].state = SWEEP_SKIPPED;
        } else {
            c->runs[i].state = SWEEP_FAILED;
            c->runs[i].exit_code = status_exit_code(own.items[0].code);
            char text[1600];
            report_format(&own.items[0], text, sizeof text);
            snprintf(c->runs[i].message, SWEEP_MESSAGE, "%.*s", SWEEP_MESSAGE - 1, text);
            if (reports->count == 0) *reports = own;
        }
    }
    if (l) ledger_close(l);
    if (code == STATUS_OK && runnable == 0) return STATUS_INPUT;
    reports->count = 0;
    return code;
}

/* ---- children ---------------------------------------------------------------------------------------------------- */

static volatile sig_atomic_t stopped;
static volatile pid_t children[JOBS];

/* A terminal's Ctrl-C reaches the children by itself. */
static void on_signal(int number) {
    stopped = 1;
    for (int i = 0; number != SIGINT && i < JOBS; i++)
        if (children[i] > 0) kill(children[i], number);
}

static void catch_signals(void) {
    struct sigaction action = {.sa_handler = on_signal};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGHUP, &action, NULL);
}

static void list_words(const sweep_command *c, int run, worker_words *w) {
    static script_setting settings[SWEEP_SETTINGS + CLI_SETTINGS + SWEEP_AXES];
    int count = list_settings(c, run, settings);
    const char *const head[] = {"run", c->plan.scene, "--json", "--quiet", "--checkpoint-every", "0", "--db", c->path};
    worker_words_begin(w);
    for (size_t i = 0; i < sizeof head / sizeof *head; i++) worker_word(w, head[i]);
    worker_option(w, "--threads", "%ld", c->threads);
    if (c->frames >= 0 || c->plan.frames >= 0) worker_option(w, "--frames", "%lld", (long long)(c->frames >= 0 ? c->frames : c->plan.frames));
    if (c->plan.recipe[0]) worker_option(w, "--recipe", "%s", c->plan.recipe);
    for (int i = 0; i < count; i++) worker_option(w, "--set", "%.140s=%.140s", settings[i].key, settings[i].value);
}

static status launch(sweep_command *c, int slot, int run, report *r) {
    static worker_words words;
    list_words(c, run, &words);
    status code = worker_start(&c->job[slot], run, &words, r);
    if (code != STATUS_OK) return code;
    children[slot] = c->job[slot].pid;
    c->runs[run].state = SWEEP_GOING;
    return STATUS_OK;
}

static void reap(sweep_command *c, pid_t pid, int outcome) {
    for (int slot = 0; slot < c->jobs; slot++) {
        if (children[slot] != pid) continue;
        children[slot] = 0;
        worker *j = &c->job[slot];
        sweep_run *run = &c->runs[j->run];
        run->exit_code = worker_exit_code(outcome);
        if (run->exit_code != 130) run->state = run->exit_code == 0 ? SWEEP_DONE : SWEEP_FAILED;
        (void)worker_member(j, "run_id", run->id, sizeof run->id);
        if (run->state == SWEEP_FAILED) worker_complaint(j, run->message, sizeof run->message);
        say(c, j->run);
        worker_close(j);
    }
}

static status run_all(sweep_command *c, report *r) {
    int next = 0, going = 0;
    status code = STATUS_OK;
    catch_signals();
    for (int slot = 0; slot < JOBS; slot++) c->job[slot].run = -1;
    for (int i = 0; i < c->count; i++)
        if (c->runs[i].state != SWEEP_WAITING || c->list) say(c, i);
    if (c->list) return STATUS_OK;
    for (;;) {
        for (int slot = 0; slot < c->jobs && !stopped && code == STATUS_OK; slot++) {
            while (next < c->count && c->runs[next].state != SWEEP_WAITING) next++;
            if (next == c->count || c->job[slot].run >= 0) continue;
            code = launch(c, slot, next, r);
            if (code != STATUS_OK) break;
            going++;
            if (c->lines) say(c, next);
        }
        if (going == 0) return code;
        int outcome;
        pid_t pid = waitpid(-1, &outcome, 0);
        if (pid < 0) continue;
        reap(c, pid, outcome);
        going--;
    }
}

/* ---- the end ----------------------------------------------------------------------------------------------------- */

/* Tags what has been done, so that it is found together; a run that has the tag already keeps it. */
static status tag_runs(const sweep_command *c, report *r) {
    ledger *l = NULL;
    status code = ledger_open(c->path, &l, r);
    if (code == STATUS_OK) code = ledger_batch_begin(l, r);
    if (code != STATUS_OK) {
        if (l) ledger_close(l);
        return code;
    }
    for (int i = 0; i < c->count && code == STATUS_OK; i++)
        if (c->runs[i].id[0]) code = ledger_tag(l, c->runs[i].id, c->tag, true, r);
    code = ledger_batch_end(l, code, r);
    ledger_close(l);
    return code;
}

static int count_state(const sweep_command *c, sweep_run_state state) {
    int count = 0;
    for (int i = 0; i < c->count; i++) count += c->runs[i].state == state;
    return count;
}

static void write_run(json_writer *w, const sweep_command *c, int run) {
    int which[SWEEP_AXES];
    sweep_cell(&c->plan, run, which);
    json_object(w);
    json_member_object(w, "settings");
    for (int a = 0; a < c->plan.axis_count; a++) json_member_string(w, c->plan.axes[a].name, axis_value(c, which, a));
    json_object_end(w);
    json_member_string(w, "status", state_names[c->runs[run].state]);
    json_member_string(w, "run_id", c->runs[run].id[0] ? c->runs[run].id : NULL);
    json_member_integer(w, "exit_code", c->runs[run].exit_code);
    json_member_string(w, "message", c->runs[run].message[0] ? c->runs[run].message : NULL);
    json_object_end(w);
}

static status print_json(const sweep_command *c, report *r) {
    json_writer w;
    json_begin(&w, 2);
    json_object(&w);
    json_member_string(&w, "title", c->plan.title);
    json_member_string(&w, "scene", c->plan.scene);
    json_member_string(&w, "tag", c->tag);
    json_member_string(&w, "db", c->path);
    json_member_integer(&w, "done", count_state(c, SWEEP_DONE));
    json_member_integer(&w, "done_before", count_state(c, SWEEP_SKIPPED));
    json_member_integer(&w, "failed", count_state(c, SWEEP_FAILED));
    json_member_array(&w, "runs");
    for (int i = 0; i < c->count; i++) write_run(&w, c, i);
    json_array_end(&w);
    json_object_end(&w);
    return cli_print_json(&w, r);
}

static void name_tag(sweep_command *c) {
    const char *slash = strrchr(c->given.scene, '/'), *name = slash ? slash + 1 : c->given.scene;
    snprintf(c->tag, sizeof c->tag, "%.*s", (int)strcspn(name, ". ,"), name);
}

static int finish(sweep_command *c) {
    report r;
    status code = c->list ? STATUS_OK : tag_runs(c, &r); /* who only looks writes nothing */
    if (code == STATUS_OK && c->json) code = print_json(c, &r);
    if (code != STATUS_OK) return cli_fail(&r);
    int failed = count_state(c, SWEEP_FAILED);
    if (!c->quiet && !c->json && !c->lines)
        printf("%d done, %d done before, %d failed, of %d: sunder runs list --where \"tags LIKE '%%%s%%'\"\n", count_state(c, SWEEP_DONE),
               count_state(c, SWEEP_SKIPPED), failed, c->count, c->tag);
    return stopped ? 130 : failed ? 1 : 0;
}

/* ---- the command ------------------------------------------------------------------------------------------------- */

enum { OPTION_SET = 256, OPTION_FRAMES, OPTION_THREADS, OPTION_DB, OPTION_JSON, OPTION_QUIET, OPTION_LIST, OPTION_LINES };

static const struct option long_options[] = {
    {"set", required_argument, NULL, OPTION_SET},         {"frames", required_argument, NULL, OPTION_FRAMES},
    {"threads", required_argument, NULL, OPTION_THREADS}, {"db", required_argument, NULL, OPTION_DB},
    {"json", no_argument, NULL, OPTION_JSON},             {"quiet", no_argument, NULL, OPTION_QUIET},
    {"list", no_argument, NULL, OPTION_LIST},             {"lines", no_argument, NULL, OPTION_LINES},
    {"jobs", required_argument, NULL, 'j'},               {NULL, 0, NULL, 0}};

static int parse(sweep_command *c, int count, char **arguments) {
    int option, code = 0;
    while (code == 0 && (option = getopt_long(count, arguments, "j:", long_options, NULL)) != -1) {
        if (option == OPTION_SET) code = cli_add_setting(&c->given, "sweep", optarg);
        else if (option == OPTION_FRAMES) code = cli_number("sweep", "--frames", optarg, 0, 1000000000, &c->frames);
        else if (option == OPTION_THREADS) code = cli_number("sweep", "--threads", optarg, 1, 256, &c->threads);
        else if (option == 'j') code = cli_number("sweep", "-j", optarg, 1, JOBS, &c->jobs);
        else if (option == OPTION_DB) c->database = optarg;
        else if (option == OPTION_JSON) c->json = true;
        else if (option == OPTION_QUIET) c->quiet = true;
        else if (option == OPTION_LIST) c->list = true;
        else if (option == OPTION_LINES) c->lines = true;
        else return cli_usage("sweep", "wrong option");
    }
    if (code) return code;
    if (optind < count) c->given.scene = arguments[optind++];
    if (optind < count) return cli_usage("sweep", "one sweep at a time, found '%s' too", arguments[optind]);
    if (!c->given.scene) return cli_usage("sweep", "expected a sweep: a Lua file that returns s.sweep { … }");
    if (c->threads == 0) c->threads = processor_count() > c->jobs ? processor_count() / c->jobs : 1;
    name_tag(c);
    return 0;
}

int command_sweep(int count, char **arguments) {
    static sweep_command c = {.jobs = 1, .frames = -1};
    static script_reports reports;
    report r;
    int code = parse(&c, count, arguments);
    if (code) return code;
    if (sweep_load(c.given.scene, &c.plan, &reports) != STATUS_OK) return cli_fail_script(&reports);
    status found = STATUS_OK;
    if (c.database) snprintf(c.path, sizeof c.path, "%s", c.database);
    else found = ledger_default_path(c.path, sizeof c.path, &r);
    if (found != STATUS_OK) return cli_fail(&r);
    c.count = sweep_count(&c.plan);
    c.runs = memory_allocate_array((size_t)c.count, sizeof *c.runs);
    if (!c.runs) return cli_fail((report_set(&r, STATUS_SYSTEM, "out of memory for %d runs", c.count), &r));
    status prepared = prepare(&c, &reports, &r);
    if (prepared == STATUS_OK) prepared = run_all(&c, &r);
    code = prepared == STATUS_OK ? finish(&c) : reports.count > 0 ? cli_fail_script(&reports) : cli_fail(&r);
    memory_free(c.runs, (size_t)c.count * sizeof *c.runs);
    return code;
}
