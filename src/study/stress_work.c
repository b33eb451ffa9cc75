/* Making the runs: children side by side, each with a limit of time. */
#include "study/stress.h"

#include "base/clock.h"
#include "study/worker.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>

enum { JOBS = 64 };

typedef struct job {
    worker child;
    double start;
} job;

static volatile sig_atomic_t stopped;

/* A terminal's Ctrl-C reaches the children by itself; what else stops them is sent on when `stopped` is seen. */
static void on_signal(int number) {
    stopped = number;
}

/* ---- a child ----------------------------------------------------------------------------------------------------- */

static void list_words(const stress_request *q, const stress_run *run, worker_words *w) {
    const stress_case *c = &q->suite->cases[run->which];
    const char *const head[] = {"run", c->scene, "--json", "--quiet", "--checkpoint-every", "0", "--db", q->database};
    worker_words_begin(w);
    for (size_t i = 0; i < sizeof head / sizeof *head; i++) worker_word(w, head[i]);
    worker_option(w, "--threads", "%d", q->threads);
    worker_option(w, "--precision", "f%d", run->precision);
    if (run->simd[0]) worker_option(w, "--simd", "%s", run->simd);
    if (c->variant[0]) worker_option(w, "--set", "variant=%s", c->variant);
    if (run->scale != 1 && c->particles > 0) worker_option(w, "--set", "particles=%.0f", run->scale * (double)c->particles);
    for (int i = 0; i < c->hard.turn_count; i++)
        worker_option(w, "--turn", "%lld:%s=%s", (long long)c->hard.turns[i].frame, c->hard.turns[i].path, c->hard.turns[i].value);
}

static status launch(const stress_request *q, job *j, int run, report *r) {
    static worker_words words;
    list_words(q, &q->runs[run], &words);
    status code = worker_start(&j->child, run, &words, r);
    if (code != STATUS_OK) return code;
    j->start = clock_seconds();
    q->runs[run].verdict = STRESS_GOING;
    return STATUS_OK;
}

static void read_output(worker *child, stress_run *run) {
    (void)worker_member(child, "run_id", run->id, sizeof run->id);
    (void)worker_member(child, "out", run->folder, sizeof run->folder);
    worker_complaint(child, run->message, sizeof run->message);
}

/* ---- the ledger -------------------------------------------------------------------------------------------------- */

static status note(ledger *l, const stress_case *c, const stress_run *run, report *r) {
    char tag[STRESS_NAME + 8], text[STRESS_TEXT + 32], precision[8];
    snprintf(tag, sizeof tag, "stress:%s", c->name);
    snprintf(text, sizeof text, "%s: %s", stress_verdict_word(run->verdict), run->text);
    snprintf(precision, sizeof precision, "f%d", run->precision);
    if (!run->id[0]) return ledger_refusal(l, c->name, precision, text, r);
    status code = ledger_batch_begin(l, r);
    if (code != STATUS_OK) return code;
    code = ledger_tag(l, run->id, tag, true, r);
    if (code == STATUS_OK) code = ledger_event(l, run->id, 0, "verdict", text, r);
    if (code == STATUS_OK) code = ledger_refusal(l, c->name, precision, NULL, r);
    return ledger_batch_end(l, code, r);
}

static status judge(const stress_request *q, ledger *l, int which, report *r) {
    stress_run *run = &q->runs[which];
    const stress_case *c = &q->suite->cases[run->which];
    const char *other = run->like >= 0 && q->runs[run->like].folder[0] ? q->runs[run->like].folder : NULL;
    status code = stress_judge(l, c, run, other, r);
    if (code == STATUS_OK) code = note(l, c, run, r);
    if (code == STATUS_OK) q->tell(q->context, which);
    return code;
}

/* ---- all of them ------------------------------------------------------------------------------------------------- */

static bool finished(const stress_run *run) {
    return run->verdict != STRESS_WAITING && run->verdict != STRESS_GOING;
}

/* The next that may start, −1: none now. */
static int choose(const stress_request *q) {
    for (int i = 0; i < q->count; i++) {
        const stress_run *run = &q->runs[i];
        if (run->verdict == STRESS_WAITING && (run->like < 0 || finished(&q->runs[run->like]))) return i;
    }
    return -1;
}

static status start_some(const stress_request *q, job *jobs, report *r) {
    for (int slot = 0; slot < q->jobs && !stopped; slot++) {
        if (jobs[slot].child.run >= 0) continue;
        int run = choose(q);
        if (run < 0) break;
        status code = launch(q, &jobs[slot], run, r);
        if (code != STATUS_OK) return code;
        q->tell(q->context, run);
    }
    return STATUS_OK;
}

/* Judges it if it has ended; one that takes too long is killed first. */
static status look_after(const stress_request *q, ledger *l, job *j, report *r) {
    int outcome;
    stress_run *run = &q->runs[j->child.run];
    if (stopped && stopped != SIGINT) kill(j->child.pid, SIGINT);
    if (!run->timed_out && clock_seconds() - j->start > q->limit) {
        run->timed_out = true;
        kill(j->child.pid, SIGKILL);
    }
    pid_t pid = waitpid(j->child.pid, &outcome, WNOHANG);
    if (pid == 0 || (pid < 0 && errno == EINTR)) return STATUS_OK;
    run->exit_code = worker_exit_code(outcome);
    run->seconds = clock_seconds() - j->start;
    read_output(&j->child, run);
    int which = j->child.run;
    worker_close(&j->child);
    if (stopped && run->exit_code == 130) {
        run->verdict = STRESS_WAITING;
        return STATUS_OK;
    }
    return judge(q, l, which, r);
}

static status work(const stress_request *q, ledger *l, job *jobs, report *r) {
    status code = STATUS_OK;
    for (;;) {
        int going = 0;
        if (code == STATUS_OK) code = start_some(q, jobs, r);
        for (int slot = 0; slot < q->jobs; slot++) {
            report own;
            if (jobs[slot].child.run < 0) continue;
            status judged = look_after(q, l, &jobs[slot], code == STATUS_OK ? r : &own);
            if (code == STATUS_OK) code = judged;
            going += jobs[slot].child.run >= 0;
        }
        if (going == 0 && (stopped || code != STATUS_OK || choose(q) < 0)) break;
        if (going > 0) nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
    }
    return code == STATUS_OK && stopped ? report_set(r, STATUS_INTERRUPTED, "interrupted") : code;
}

status stress_work(stress_request *q, report *r) {
    struct sigaction action = {.sa_handler = on_signal};
    job jobs[JOBS];
    ledger *l = NULL;
    for (int i = 0; i < JOBS; i++) jobs[i] = (job){.child = {.run = -1}};
    if (q->jobs > JOBS) q->jobs = JOBS;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGHUP, &action, NULL);
    status code = ledger_open(q->database, &l, r);
    if (code == STATUS_OK) code = work(q, l, jobs, r);
    ledger_close(l);
    return code;
}

/* ---- verdicts of before ------------------------------------------------------------------------------------------ */

static status take_verdict(void *context, const ledger_cell *cells, int count, report *r) {
    stress_run *run = context;
    char word[32];
    (void)count, (void)r;
    const char *text = cells[2].text ? cells[2].text : "", *colon = strchr(text, ':');
    snprintf(word, sizeof word, "%.*s", colon ? (int)(colon - text) : 0, text);
    int verdict = stress_verdict_find(word);
    if (verdict < 0) return STATUS_OK;
    run->verdict = (stress_verdict)verdict;
    snprintf(run->id, sizeof run->id, "%s", cells[0].text ? cells[0].text : "");
    snprintf(run->folder, sizeof run->folder, "%s", cells[1].text ? cells[1].text : "");
    snprintf(run->text, sizeof run->text, "%.*s", STRESS_TEXT - 1, colon + 1 + (colon[1] == ' '));
    run->seconds = cells[3].number;
    return STATUS_OK;
}

status stress_recall(ledger *l, const stress_suite *suite, stress_run *runs, int count, report *r) {
    static const char sql[] = "SELECT runs.id, runs.output, events.text, runs.wall_seconds FROM runs JOIN tags USING (run) JOIN events USING (run) "
                              "WHERE tag = :tag AND precision = :precision AND (:simd = '' OR simd = :simd) AND kind = 'verdict' ORDER BY run DESC LIMIT 1";
    static const char refused[] = "SELECT NULL, NULL, text, 0 FROM refusals WHERE name = :name AND precision = :precision";
    status code = STATUS_OK;
    for (int i = 0; i < count && code == STATUS_OK; i++) {
        char tag[STRESS_NAME + 16], name[STRESS_NAME + 8], precision[24], simd[32];
        const char *const arguments[] = {tag, precision, simd}, *const own[] = {name, precision};
        snprintf(tag, sizeof tag, "tag=stress:%s", suite->cases[runs[i].which].name);
        snprintf(name, sizeof name, "name=%s", suite->cases[runs[i].which].name);
        snprintf(precision, sizeof precision, "precision=f%d", runs[i].precision);
        snprintf(simd, sizeof simd, "simd=%s", runs[i].simd);
        code = ledger_each_row(l, sql, arguments, 3, take_verdict, &runs[i], r);
        if (code == STATUS_OK) code = ledger_each_row(l, refused, own, 2, take_verdict, &runs[i], r);
    }
    return code;
}
