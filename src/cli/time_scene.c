#include "cli/time_scene.h"

#include "base/compare.h"
#include "session/session.h"
#include "sim/simulation.h"

#include <errno.h>
#include <ftw.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- interruptions ----------------------------------------------------------------------------------------------- */

static session *volatile running;
static volatile sig_atomic_t interrupted;

/* The request stores to an atomic: safe in a handler. */
static void on_interrupt(int signal_number) {
    (void)signal_number;
    interrupted = 1;
    if (running) session_abandon(running);
}

static void catch_interrupts(void) {
    struct sigaction action = {.sa_handler = on_interrupt};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

/* ---- a folder that is thrown away -------------------------------------------------------------------------------- */

static int remove_one(const char *path, const struct stat *info, int kind, struct FTW *place) {
    (void)info, (void)kind, (void)place;
    return remove(path);
}

static status make_folder(char folder[256], report *r) {
    const char *root = getenv("TMPDIR");
    snprintf(folder, 256, "%s/sunder-bench-XXXXXX", root && root[0] ? root : "/tmp");
    return mkdtemp(folder) ? STATUS_OK : report_set(r, STATUS_SYSTEM, "%s: %s", folder, strerror(errno));
}

/* ---- from a run's samples to figures ----------------------------------------------------------------------------- */

static double median(double *values, int count) {
    qsort(values, (size_t)count, sizeof *values, compare_f64);
    return 0.5 * (values[(count - 1) / 2] + values[count / 2]);
}

/* history[0] is the initial state; the last `wanted` frames are timed, or all where there are no more. */
static void take_frames(const session_snapshot *p, int wanted, scene_timing *out) {
    static double seconds[SCENE_TIMING_FRAMES], a_step[SCENE_TIMING_FRAMES], whole[SCENE_TIMING_FRAMES];
    int last = p->history_count - 1, first = last > wanted ? last - wanted : 0;
    out->warm = first;
    out->frames = last - first;
    double sum = 0;
    for (int i = 0; i < out->frames; i++) {
        const session_sample *now = &p->history[first + i + 1], *before = now - 1;
        seconds[i] = now->seconds;
        sum += now->seconds;
        a_step[i] = now->seconds / (double)(now->step - before->step);
        whole[i] = now->wall - before->wall;
    }
    const session_sample *from = &p->history[first], *to = &p->history[last];
    out->seconds = median(seconds, out->frames);
    out->seconds_mean = sum / out->frames;
    out->seconds_a_step = median(a_step, out->frames);
    out->run_seconds = median(whole, out->frames);
    out->steps = (double)(to->step - from->step) / out->frames;
    out->dt = (to->time - from->time) / (double)(to->step - from->step);
    out->damage_max = to->damage_max;
    out->broken_fraction = to->broken_fraction;
}

static void extrapolate(const session_snapshot *p, scene_timing *out) {
    const session_unfinished *u = &p->unfinished;
    double share = u->time * (double)p->frames / p->duration;
    out->extrapolated = true;
    out->seconds = out->seconds_mean = u->seconds / share;
    out->seconds_a_step = u->seconds / (double)u->steps;
    out->run_seconds = NAN;
    out->steps = (double)u->steps / share;
    out->dt = u->time / (double)u->steps;
}

static status take_figures(const session_snapshot *p, const scene_timing_request *q, scene_timing *out, report *r) {
    out->particles = p->particles;
    out->threads = p->threads;
    snprintf(out->simd, sizeof out->simd, "%s", p->simd);
    if (!out->limited) snprintf(out->warning, sizeof out->warning, "%s", p->message);
    out->setup_seconds = p->history_count ? p->history[0].wall : NAN;
    if (p->history_count > 1) {
        take_frames(p, q->frames, out);
        return STATUS_OK;
    }
    if (p->unfinished.steps == 0) return report_set(r, STATUS_SYSTEM, "not one step within the time limit of %g s", q->limit);
    extrapolate(p, out);
    return STATUS_OK;
}

/* ---- running ----------------------------------------------------------------------------------------------------- */

/* Screens copy every particle when they poll: here nobody polls between the initial state and the end, so that nothing but the run is
 * timed. */
static status watch(session *s, const scene_timing_request *q, scene_timing *out, report *r) {
    static session_snapshot snapshot;
    running = s;
    if (interrupted) session_abandon(s);
    memset(&snapshot, 0, sizeof snapshot);
    while (!session_wait(s, 0.002) && snapshot.history_count == 0) session_poll(s, &snapshot);
    out->limited = !session_wait(s, q->limit);
    if (out->limited) {
        session_poll(s, &snapshot); /* a warning, before the end's message takes its place */
        snprintf(out->warning, sizeof out->warning, "%s", snapshot.message);
        session_abandon(s);
    }
    session_wait(s, -1);
    running = NULL;
    status outcome = session_outcome(s, r);
    out->limited = out->limited && outcome == STATUS_INTERRUPTED;
    session_poll(s, &snapshot);
    if (interrupted) outcome = report_set(r, STATUS_INTERRUPTED, "interrupted");
    else if (outcome == STATUS_OK || out->limited) outcome = take_figures(&snapshot, q, out, r);
    session_snapshot_free(&snapshot);
    return outcome;
}

status scene_time(const scene_timing_request *q, scene_timing *out, script_reports *reports) {
    char folder[256], output[280], database[280];
    report *r = &reports->items[0];
    memset(out, 0, sizeof *out);
    catch_interrupts();
    status code = make_folder(folder, r);
    reports->count = 1;
    if (code != STATUS_OK) return code;
    snprintf(output, sizeof output, "%s/run", folder);
    snprintf(database, sizeof database, "%s/runs.db", folder);
    session_options o = session_options_default();
    o.scene_path = q->scene;
    o.script.settings = q->settings;
    o.script.setting_count = q->setting_count;
    o.output = output;
    o.database = database;
    o.command = "sunder bench table1";
    o.threads = q->threads;
    o.precision = q->precision;
    o.frames = q->warm + q->frames;
    session *s = NULL;
    code = session_start(&o, &s, reports);
    if (code == STATUS_OK) {
        reports->count = 1;
        code = watch(s, q, out, r);
        session_destroy(s);
    }
    nftw(folder, remove_one, 16, FTW_DEPTH | FTW_PHYS);
    return code;
}

status scene_step_limit(const scene_timing_request *q, double *dt, const char **limiting, script_reports *reports) {
    script_options options = script_options_default();
    options.settings = q->settings;
    options.setting_count = q->setting_count;
    script *s = NULL;
    status code = script_load(q->scene, &options, &s, reports);
    if (code != STATUS_OK) return code;
    simulation *state = NULL;
    simulation_options engine = {.threads = q->threads, .precision = q->precision, .simd = "auto"};
    code = simulation_create(script_scene(s), &engine, &state, &reports->items[0]);
    reports->count = code != STATUS_OK;
    *dt = HUGE_VAL;
    *limiting = "";
    if (code == STATUS_OK) {
        const simulation_plan *p = simulation_get_plan(state);
        for (int e = 0; e < p->effect_count; e++)
            if (p->limits[e] < *dt) *dt = p->limits[e], *limiting = p->effects[e]->name;
    }
    simulation_destroy(state);
    script_close(s);
    return code;
}
