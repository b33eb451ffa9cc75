/* sunder run: a session with a live screen, a progress line, or neither. */
#include "cli/cli.h"

#include "base/threads.h"
#include "session/session.h"
#include "tui/tui.h"

#include <errno.h>
#include <getopt.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { TURN_LIMIT = 256 };

typedef struct run_options {
    cli_scene_options scene;
    session_options session;
    bool tui, paused, json, quiet, keep_given;
    char command[1024], branch[512];
    int turn_count;
    knob_turn turns[TURN_LIMIT];
} run_options;

enum { OPTION_SET = 256, OPTION_RECIPE, OPTION_FRAMES, OPTION_THREADS, OPTION_PRECISION, OPTION_OUT, OPTION_DB, OPTION_TUI,
       OPTION_JSON, OPTION_QUIET, OPTION_RESUME, OPTION_SIMD, OPTION_CHECKPOINT_EVERY, OPTION_KEEP, OPTION_TURN, OPTION_BRANCH, OPTION_PAUSED };

static const struct option long_options[] = {
    {"set", required_argument, NULL, OPTION_SET},
    {"recipe", required_argument, NULL, OPTION_RECIPE},
    {"frames", required_argument, NULL, OPTION_FRAMES},
    {"threads", required_argument, NULL, OPTION_THREADS},
    {"precision", required_argument, NULL, OPTION_PRECISION},
    {"out", required_argument, NULL, OPTION_OUT},
    {"db", required_argument, NULL, OPTION_DB},
    {"tui", no_argument, NULL, OPTION_TUI},
    {"paused", no_argument, NULL, OPTION_PAUSED},
    {"json", no_argument, NULL, OPTION_JSON},
    {"quiet", no_argument, NULL, OPTION_QUIET},
    {"resume", required_argument, NULL, OPTION_RESUME},
    {"simd", required_argument, NULL, OPTION_SIMD},
    {"checkpoint-every", required_argument, NULL, OPTION_CHECKPOINT_EVERY},
    {"keep", required_argument, NULL, OPTION_KEEP},
    {"turn", required_argument, NULL, OPTION_TURN},
    {"branch", required_argument, NULL, OPTION_BRANCH},
    {NULL, 0, NULL, 0},
};

static const int64_t workbench_ring = (int64_t)2 << 30; /* bytes of checkpoints */

static int parse_precision(run_options *o, const char *text) {
    if (strcmp(text, "f32") == 0) o->session.precision = 32;
    else if (strcmp(text, "f64") == 0) o->session.precision = 64;
    else return cli_usage("run", "--precision %s: expected f32 or f64", text);
    return 0;
}

static int parse_keep(run_options *o, const char *text) {
    long value;
    o->keep_given = true;
    if (strcmp(text, "all") == 0) {
        o->session.keep = 0;
        return 0;
    }
    static const char units[] = "KMGT";
    size_t digits = strspn(text, "0123456789");
    const char *unit = digits > 0 && digits < 10 && text[digits] && !text[digits + 1] ? strchr(units, text[digits]) : NULL;
    if (unit) {
        o->session.keep_bytes = atoll(text) << 10 * (unit - units + 1);
        return o->session.keep_bytes > 0 ? 0 : cli_usage("run", "--keep %s: expected more than nothing", text);
    }
    if (digits == 0 || text[digits]) return cli_usage("run", "--keep %s: expected a number of checkpoints, all, or a size such as 500M or 2G", text);
    int code = cli_number("run", "--keep", text, 1, 1000000, &value);
    o->session.keep = (int)value;
    return code;
}

/* FRAME:PATH=VALUE */
static int parse_turn(run_options *o, const char *text) {
    knob_turn *turn = &o->turns[o->turn_count];
    char *end;
    errno = 0;
    long long frame = strtoll(text, &end, 10);
    const char *path = end + 1, *equals = *end ? strchr(path, '=') : NULL;
    if (end == text || *end != ':' || errno || frame < 0 || !equals || equals == path)
        return cli_usage("run", "--turn %s: expected FRAME:PATH=VALUE, as in 24:tube.damage.eta=0.05", text);
    if (o->turn_count == TURN_LIMIT) return cli_usage("run", "--turn: at most %d turns", TURN_LIMIT);
    if (equals - path >= KNOB_PATH || strlen(equals + 1) >= KNOB_TEXT) return cli_usage("run", "--turn %s: too long a path or value", text);
    *turn = (knob_turn){.frame = frame};
    snprintf(turn->path, sizeof turn->path, "%.*s", (int)(equals - path), path);
    snprintf(turn->value, sizeof turn->value, "%s", equals + 1);
    o->turn_count++;
    return 0;
}

/* RUN@FRAME */
static int parse_branch(run_options *o, const char *text) {
    const char *at = strrchr(text, '@');
    long frame;
    if (!at || at == text || (size_t)(at - text) >= sizeof o->branch) return cli_usage("run", "--branch %s: expected RUN@FRAME, as in last@48", text);
    snprintf(o->branch, sizeof o->branch, "%.*s", (int)(at - text), text);
    o->session.branch_of = o->branch;
    int code = cli_number("run", "--branch", at + 1, 0, 1000000000, &frame);
    o->session.branch_frame = frame;
    return code;
}

static int parse_count(const char *option, long low, long high, long *value) {
    return cli_number("run", option, optarg, low, high, value);
}

static int parse_option(run_options *o, int option) {
    long value = 0;
    int code = 0;
    switch (option) {
    case OPTION_SET: return cli_add_setting(&o->scene, "run", optarg);
    case OPTION_RECIPE: o->scene.recipe = optarg; break;
    case OPTION_FRAMES:
        code = parse_count("--frames", 0, 1000000000, &value);
        o->session.frames = value;
        break;
    case OPTION_THREADS:
        code = parse_count("--threads", 1, 256, &value);
        o->session.threads = (int)value;
        break;
    case OPTION_PRECISION: return parse_precision(o, optarg);
    case OPTION_OUT: o->session.output = optarg; break;
    case OPTION_DB: o->session.database = optarg; break;
    case OPTION_TUI: o->tui = true; break;
    case OPTION_PAUSED: o->paused = true; break;
    case OPTION_JSON: o->json = true; break;
    case OPTION_QUIET: o->quiet = true; break;
    case OPTION_RESUME: o->session.resume = optarg; break;
    case OPTION_SIMD: o->session.simd = optarg; break;
    case OPTION_CHECKPOINT_EVERY:
        code = parse_count("--checkpoint-every", 0, 1000000000, &value);
        o->session.checkpoint_every = (int)value;
        break;
    case OPTION_KEEP: return parse_keep(o, optarg);
    case OPTION_TURN: return parse_turn(o, optarg);
    case OPTION_BRANCH: return parse_branch(o, optarg);
    default: return cli_usage("run", "wrong option");
    }
    return code;
}

/* A branch is its parent, but for what is turned: it has the parent's scene and all that was said of it. */
static int check_branch(const run_options *o) {
    if (!o->session.branch_of) return 0;
    if (o->session.resume) return cli_usage("run", "--branch or --resume, not both");
    if (o->scene.scene) return cli_usage("run", "--branch has its scene from the run, found '%s' too", o->scene.scene);
    if (o->scene.recipe || o->scene.setting_count > 0)
        return cli_usage("run", "--branch has its parameters from the run: turn live ones (--turn FRAME:PATH=VALUE), or start the scene anew for the others");
    return 0;
}

static int parse(run_options *o, int count, char **arguments) {
    size_t used = 0;
    for (int i = 0; i < count && used < sizeof o->command; i++)
        used += (size_t)snprintf(o->command + used, sizeof o->command - used, "%s%s", i ? " " : "sunder ", arguments[i]);
    int option;
    while ((option = getopt_long(count, arguments, "", long_options, NULL)) != -1) {
        int code = parse_option(o, option);
        if (code) return code;
    }
    if (optind < count) o->scene.scene = arguments[optind++];
    if (optind < count) return cli_usage("run", "one scene at a time, found '%s' too", arguments[optind]);
    if (!o->scene.scene && !o->session.resume && !o->session.branch_of) return cli_usage("run", "expected a scene");
    if (o->paused && !o->tui) return cli_usage("run", "--paused waits for a key of the workbench: expected --tui with it");
    o->session.scene_path = o->scene.scene ? o->scene.scene : "";
    o->session.command = o->command;
    o->session.turns = o->turns;
    o->session.turn_count = o->turn_count;
    int code = check_branch(o);
    if (code) return code;
    o->session.script.recipe = o->scene.recipe;
    o->session.script.settings = o->scene.settings;
    o->session.script.setting_count = o->scene.setting_count;
    return 0;
}

/* ---- plain progress ---------------------------------------------------------------------------------------------- */

static _Atomic(session *) interrupted_session;
static volatile sig_atomic_t interruptions;

/* Both requests store to an atomic: safe in a handler. */
static void on_interrupt(int signal_number) {
    (void)signal_number;
    interruptions++;
    session *s = atomic_load(&interrupted_session);
    if (s && interruptions == 1) session_stop(s);
    else if (s) session_abandon(s);
}

/* Before the session starts: from its first line in the ledger on, a run that is asked to stop shall say so there. */
static void catch_interrupts(void) {
    struct sigaction action = {.sa_handler = on_interrupt};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGHUP, &action, NULL);
}

static void format_duration(double seconds, char text[32]) {
    if (seconds < 60) snprintf(text, 32, "%.0f s", seconds);
    else if (seconds < 3600) snprintf(text, 32, "%d:%02d min", (int)seconds / 60, (int)seconds % 60);
    else snprintf(text, 32, "%d:%02d h", (int)seconds / 3600, (int)seconds / 60 % 60);
}

/* What has come before there was a session counts too. */
static void pass_interrupts_to(session *s) {
    atomic_store(&interrupted_session, s);
    if (interruptions > 0) session_stop(s);
    if (interruptions > 1) session_abandon(s);
}

static void print_progress(const session_snapshot *p, FILE *out, bool terminal) {
    char left[32];
    format_duration(p->seconds_left, left);
    fprintf(out, "%sframe %lld/%lld  t %.3f  %.2f s/frame  left %s  kinetic %.3g  elastic %.3g  broken %.2f %%%s", terminal ? "\r\033[K" : "",
            (long long)p->frame, (long long)p->frames, p->time, p->seconds_per_frame, left, p->now.kinetic,
            p->now.elastic + p->now.fibre, 100 * p->now.broken_fraction, terminal ? "" : "\n");
    fflush(out);
}

/* The warnings since the last call, also those that came and went between two looks; `told`: how many events there were by then. */
static void print_warnings(const session_snapshot *p, int64_t *told, FILE *out, bool terminal) {
    int64_t new_ones = p->event_total - *told;
    for (int i = new_ones < p->event_count ? p->event_count - (int)new_ones : 0; i < p->event_count; i++)
        if (strcmp(p->events[i].kind, "warning") == 0) fprintf(out, "%swarning: %s\n", terminal ? "\r\033[K" : "", p->events[i].text);
    *told = p->event_total;
}

static void watch_plainly(session *s, FILE *out, bool quiet) {
    session_snapshot snapshot = {0};
    bool terminal = isatty(fileno(out));
    int64_t shown = -1, told = 0;
    for (bool ended = false; !ended;) {
        ended = session_wait(s, 0.1);
        if (quiet || !session_poll(s, &snapshot)) continue;
        print_warnings(&snapshot, &told, out, terminal);
        if (snapshot.frame != shown) print_progress(&snapshot, out, terminal);
        shown = snapshot.frame;
    }
    if (!quiet && terminal) fputc('\n', out);
    session_snapshot_free(&snapshot);
}

void cli_print_end(session *s, FILE *out) {
    session_snapshot p = {0};
    session_poll(s, &p);
    fprintf(out, "%s: %lld frames, %lld steps of %lld particles in %.1f s (%.1f M particle-steps/s)\n  %s\n", p.run_id,
            (long long)p.frame, (long long)p.step, (long long)p.particles, p.wall,
            p.step_wall > 0 ? 1e-6 * (double)p.particles * (double)p.step / p.step_wall : 0.0, p.output);
    session_snapshot_free(&p);
}

int command_run(int count, char **arguments) {
    static run_options o;
    o.session = session_options_default();
    int code = parse(&o, count, arguments);
    if (code) return code;
    const char *why = NULL;
    bool screen = o.tui && tui_possible(&why);
    /* What can be gone back to is a screen's timeline. */
    if (screen && !o.keep_given) o.session.keep_bytes = workbench_ring;
    o.session.start_paused = screen && o.paused; /* without a screen nobody could let it go on */
    if (o.tui && !screen) fprintf(stderr, "sunder: the live view is off: %s\n", why);
    if (!screen) catch_interrupts();
    static script_reports reports;
    session *s = NULL;
    if (session_start(&o.session, &s, &reports) != STATUS_OK) return cli_fail_script(&reports);
    report r;
    if (screen) {
        tui_options look = tui_options_default();
        look.database = o.session.database;
        (void)tui_workbench(&s, &look, &r);
        if (!s) return 0;
    } else {
        pass_interrupts_to(s);
        watch_plainly(s, o.json ? stderr : stdout, o.quiet);
    }
    session_wait(s, -1);
    status outcome = session_outcome(s, &r);
    if (outcome != STATUS_OK) (void)cli_fail(&r);
    if (o.json && session_summary(s)) printf("%s\n", session_summary(s));
    else if (!o.quiet && !o.json) cli_print_end(s, stdout);
    if (!o.json && fflush(stdout) != 0) clearerr(stdout); /* a run whose progress nobody could read has not failed */
    session_destroy(s);
    return status_exit_code(outcome);
}
