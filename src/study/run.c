#include "study/run.h"

#include "session/session.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>

typedef struct job {
    session *session; /* NULL: free */
    int run;
} job;

static session *volatile going[STUDY_JOBS];
static volatile sig_atomic_t stopped;

/* Both requests store to an atomic: safe in a handler. */
void study_stop(void) {
    bool again = stopped;
    stopped = 1;
    for (int i = 0; i < STUDY_JOBS; i++) {
        session *s = going[i];
        if (s && again) session_abandon(s);
        else if (s) session_stop(s);
    }
}

bool study_stopped(void) {
    return stopped;
}

void study_name(const char *path, char name[48]) {
    const char *slash = strrchr(path, '/'), *last = slash ? slash + 1 : path;
    snprintf(name, 48, "%.*s", (int)strcspn(last, ". ,"), last);
}

static void keep_report(study_result *result, const report *r) {
    char text[1600];
    report_format(r, text, sizeof text);
    result->outcome = r->code;
    snprintf(result->message, sizeof result->message, "%.*s", STUDY_MESSAGE - 1, text);
}

/* A tag that cannot be written costs the study its name in the ledger, not its runs. */
static void tag_run(const study_common *c, const char *id) {
    ledger *l;
    report ignored;
    if (!c->tag || ledger_open(c->database, &l, &ignored) != STATUS_OK) return;
    (void)ledger_tag(l, id, c->tag, true, &ignored);
    ledger_close(l);
}

static bool begin(const study_common *c, const study_request *q, study_result *result, session **out) {
    static script_reports reports;
    session_options o = session_options_default();
    o.scene_path = q->scene;
    o.script.recipe = q->recipe;
    o.script.settings = q->settings;
    o.script.setting_count = q->setting_count;
    o.output = q->output;
    o.database = c->database;
    o.command = c->command;
    o.simd = c->simd;
    o.threads = c->threads;
    o.precision = q->precision;
    o.frames = q->frames;
    o.checkpoint_every = 0;
    if (session_start(&o, out, &reports) == STATUS_OK) return true;
    keep_report(result, &reports.items[0]);
    return false;
}

/* What is known when a run has ended. Nobody polls before: a copy of every particle would be in its time. */
static void take(session *s, study_result *result) {
    static session_snapshot shot;
    report r;
    result->outcome = session_outcome(s, &r);
    if (result->outcome != STATUS_OK) keep_report(result, &r);
    memset(&shot, 0, sizeof shot);
    session_poll(s, &shot);
    snprintf(result->id, sizeof result->id, "%s", shot.run_id);
    snprintf(result->folder, sizeof result->folder, "%s", shot.output);
    result->begun = true;
    result->particles = shot.particles;
    result->steps = shot.step;
    result->step_seconds = shot.step_wall;
    result->seconds = shot.wall;
    session_snapshot_free(&shot);
}

static bool start_next(const study_common *c, const study_request *requests, study_result *results, int run, int slot, job *j, study_teller tell, void *context) {
    results[run] = (study_result){0};
    tell(context, run, &results[run], false);
    if (!begin(c, &requests[run], &results[run], &j->session)) {
        tell(context, run, &results[run], true);
        return false;
    }
    j->run = run;
    going[slot] = j->session;
    if (stopped) session_stop(j->session);
    return true;
}

static void end(const study_common *c, study_result *results, int slot, job *j, study_teller tell, void *context) {
    session_wait(j->session, -1);
    take(j->session, &results[j->run]);
    going[slot] = NULL;
    session_destroy(j->session);
    j->session = NULL;
    tag_run(c, results[j->run].id);
    tell(context, j->run, &results[j->run], true);
}

status study_runs_make(const study_common *c, const study_request *requests, study_result *results, int count, study_teller tell, void *context, report *r) {
    job jobs[STUDY_JOBS] = {0};
    int next = 0, open = 0;
    for (int i = 0; i < count; i++) results[i] = (study_result){.outcome = STATUS_INTERRUPTED};
    while (next < count || open > 0) {
        for (int slot = 0; slot < c->jobs && next < count && !stopped; slot++)
            while (!jobs[slot].session && next < count && !stopped) open += start_next(c, requests, results, next++, slot, &jobs[slot], tell, context);
        if (stopped) next = count;
        for (int slot = 0; slot < c->jobs; slot++)
            if (jobs[slot].session && session_wait(jobs[slot].session, 0.01)) {
                end(c, results, slot, &jobs[slot], tell, context);
                open--;
            }
    }
    return stopped ? report_set(r, STATUS_INTERRUPTED, "interrupted: what has been done is kept, and the same command goes on from there") : STATUS_OK;
}
