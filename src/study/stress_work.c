/* Making the runs: children side by side, each with a limit of time. */
#include "study/stress.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <spawn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

extern char **environ;

enum { JOBS = 64, ARGUMENTS = 24 + 2 * HARD_TURNS, ARGUMENT = 2 * HARD_TEXT + 64 };

typedef struct job {
    int run; /* −1: free */
    pid_t pid;
    double start;
    FILE *out, *error;
} job;

static volatile sig_atomic_t stopped;

/* A terminal's Ctrl-C reaches the children by itself; what else stops them is sent on when `stopped` is seen. */
static void on_signal(int number) {
    stopped = number;
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* ---- a child ----------------------------------------------------------------------------------------------------- */

typedef struct words {
    char *argv[ARGUMENTS + 1];
    char text[ARGUMENTS][ARGUMENT];
    int count, texts;
} words;

static void add(words *w, const char *word) {
    w->argv[w->count++] = (char *)word;
    w->argv[w->count] = NULL;
}

static void add_text(words *w, const char *option, const char *format, ...) __attribute__((format(printf, 3, 4)));

static void add_text(words *w, const char *option, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(w->text[w->texts], ARGUMENT, format, arguments);
    va_end(arguments);
    add(w, option);
    add(w, w->text[w->texts++]);
}

static void list_words(const stress_request *q, const stress_run *run, words *w) {
    const stress_case *c = &q->suite->cases[run->which];
    *w = (words){0};
    add(w, "sunder"), add(w, "run"), add(w, c->scene), add(w, "--json"), add(w, "--quiet");
    add(w, "--checkpoint-every"), add(w, "0");
    add(w, "--db"), add(w, q->database);
    add_text(w, "--threads", "%d", q->threads);
    add_text(w, "--precision", "f%d", run->precision);
    if (run->simd[0]) add_text(w, "--simd", "%s", run->simd);
    if (c->variant[0]) add_text(w, "--set", "variant=%s", c->variant);
    if (run->scale != 1 && c->particles > 0) add_text(w, "--set", "particles=%.0f", run->scale * (double)c->particles);
    for (int i = 0; i < c->hard.turn_count; i++)
        add_text(w, "--turn", "%lld:%s=%s", (long long)c->hard.turns[i].frame, c->hard.turns[i].path, c->hard.turns[i].value);
}

static status launch(const stress_request *q, job *j, int run, report *r) {
    static words w;
    posix_spawn_file_actions_t actions;
    list_words(q, &q->runs[run], &w);
    j->out = tmpfile();
    j->error = tmpfile();
    if (!j->out || !j->error) return report_set(r, STATUS_SYSTEM, "a temporary file for a run's output: %s", strerror(errno));
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, fileno(j->out), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, fileno(j->error), STDERR_FILENO);
    int trouble = posix_spawn(&j->pid, "/proc/self/exe", &actions, NULL, w.argv, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (trouble) return report_set(r, STATUS_SYSTEM, "starting a run: %s", strerror(trouble));
    j->run = run;
    j->start = now();
    q->runs[run].verdict = STRESS_GOING;
    return STATUS_OK;
}

static void close_job(job *j) {
    if (j->out) fclose(j->out);
    if (j->error) fclose(j->error);
    *j = (job){.run = -1};
}

/* A text member of the summary, which has one a line. */
static bool take_member(const char *line, const char *name, char *out, size_t size) {
    char start[64];
    snprintf(start, sizeof start, "\"%s\": \"", name);
    const char *at = strstr(line, start);
    if (!at) return false;
    at += strlen(start);
    size_t used = 0;
    for (; *at && *at != '"' && used + 1 < size; at++) {
        if (*at == '\\' && at[1]) at++;
        out[used++] = *at;
    }
    out[used] = '\0';
    return true;
}

static void read_output(job *j, stress_run *run) {
    char line[4096];
    rewind(j->out), rewind(j->error);
    while (fgets(line, sizeof line, j->out)) {
        (void)take_member(line, "run_id", run->id, sizeof run->id);
        (void)take_member(line, "out", run->folder, sizeof run->folder);
    }
    while (fgets(line, sizeof line, j->error)) {
        line[strcspn(line, "\n")] = '\0';
        const char *text = strncmp(line, "sunder: ", 8) == 0 ? line + 8 : line;
        if (*text) snprintf(run->message, sizeof run->message, "%.*s", STRESS_MESSAGE - 1, text);
    }
}

/* ---- the ledger -------------------------------------------------------------------------------------------------- */

static status note(ledger *l, const stress_case *c, const stress_run *run, report *r) {
    char tag[STRESS_NAME + 8], text[STRESS_TEXT + 32];
    if (!run->id[0]) return STATUS_OK;
    snprintf(tag, sizeof tag, "stress:%s", c->name);
    snprintf(text, sizeof text, "%s: %s", stress_verdict_word(run->verdict), run->text);
    status code = ledger_batch_begin(l, r);
    if (code != STATUS_OK) return code;
    code = ledger_tag(l, run->id, tag, true, r);
    if (code == STATUS_OK) code = ledger_event(l, run->id, 0, "verdict", text, r);
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
        if (jobs[slot].run >= 0) continue;
        int run = choose(q);
        if (run < 0) break;
        status code = launch(q, &jobs[slot], run, r);
        if (code != STATUS_OK) {
            close_job(&jobs[slot]);
            return code;
        }
        q->tell(q->context, run);
    }
    return STATUS_OK;
}

/* Judges it if it has ended; one that takes too long is killed first. */
static status look_after(const stress_request *q, ledger *l, job *j, report *r) {
    int outcome;
    stress_run *run = &q->runs[j->run];
    if (stopped && stopped != SIGINT) kill(j->pid, SIGINT);
    if (!run->timed_out && now() - j->start > q->limit) {
        run->timed_out = true;
        kill(j->pid, SIGKILL);
    }
    pid_t pid = waitpid(j->pid, &outcome, WNOHANG);
    if (pid == 0 || (pid < 0 && errno == EINTR)) return STATUS_OK;
    run->exit_code = WIFEXITED(outcome) ? WEXITSTATUS(outcome) : 128 + WTERMSIG(outcome);
    run->seconds = now() - j->start;
    read_output(j, run);
    int which = j->run;
    close_job(j);
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
            if (jobs[slot].run < 0) continue;
            status judged = look_after(q, l, &jobs[slot], code == STATUS_OK ? r : &own);
            if (code == STATUS_OK) code = judged;
            going += jobs[slot].run >= 0;
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
    for (int i = 0; i < JOBS; i++) jobs[i] = (job){.run = -1};
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
    status code = STATUS_OK;
    for (int i = 0; i < count && code == STATUS_OK; i++) {
        char tag[STRESS_NAME + 16], precision[24], simd[32];
        const char *const arguments[] = {tag, precision, simd};
        snprintf(tag, sizeof tag, "tag=stress:%s", suite->cases[runs[i].which].name);
        snprintf(precision, sizeof precision, "precision=f%d", runs[i].precision);
        snprintf(simd, sizeof simd, "simd=%s", runs[i].simd);
        code = ledger_each_row(l, sql, arguments, 3, take_verdict, &runs[i], r);
    }
    return code;
}
