/* What the ledger has of a study: runs of earlier ones, and how often short runs were timed. */
#include "study/accuracy.h"

#include "base/clock.h"
#include "session/session.h"
#include "store/frames.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>

static const double LONG_ENOUGH = 1; /* seconds of steps that are timed in all */
enum { TIMED_MOST = 5 };

static status take_past(void *context, const ledger_cell *cells, int count, report *r) {
    accuracy_run *run = context;
    (void)count, (void)r;
    char *end = NULL;
    snprintf(run->result.id, sizeof run->result.id, "%s", cells[0].text ? cells[0].text : "");
    snprintf(run->folder, sizeof run->folder, "%s", cells[1].text ? cells[1].text : "");
    run->result.particles = (int64_t)cells[2].number;
    run->result.steps = (int64_t)cells[3].number;
    run->result.seconds = cells[4].number;
    run->result.step_seconds = cells[5].number;
    run->timed = 1;
    double least = cells[6].text ? strtod(cells[6].text, &end) : NAN;
    if (end && end != cells[6].text && strncmp(end, " of ", 4) == 0) {
        run->result.step_seconds = least;
        run->timed = atoi(end + 4);
    }
    return STATUS_OK;
}

status accuracy_find_past(accuracy_study *s, accuracy_run *run, report *r) {
    static const char sql[] =
        "SELECT id, output, particles, steps, wall_seconds, summary ->> 'step_wall_s', "
        "(SELECT text FROM events WHERE events.run = runs.run AND kind = 'timing' ORDER BY event DESC LIMIT 1) FROM runs "
        "WHERE scene_hash = :hash AND status = 'done' AND frames_wanted = CAST(:frames AS INTEGER) AND precision = :precision AND simd = :simd "
        "AND threads = CAST(:threads AS INTEGER) AND host = :host AND run NOT IN (SELECT run FROM knob_turns) "
        "AND run IN (SELECT run FROM tags WHERE tag LIKE 'accuracy:%') "
        "AND (CAST(:jobs AS INTEGER) > 1 OR run NOT IN (SELECT run FROM events WHERE kind = 'timing' AND text = 'together')) ORDER BY run DESC LIMIT 1";
    struct utsname name;
    char text[7][300];
    const char *const arguments[] = {text[0], text[1], text[2], text[3], text[4], text[5], text[6]};
    ledger *l = NULL;
    uname(&name);
    snprintf(text[0], sizeof text[0], "hash=%s", run->hash);
    snprintf(text[1], sizeof text[1], "frames=%lld", (long long)s->frames);
    snprintf(text[2], sizeof text[2], "precision=f%d", run->axis < 0 ? s->options.precision : s->axes[run->axis].level[run->level].precision);
    snprintf(text[3], sizeof text[3], "simd=%s", s->simd);
    snprintf(text[4], sizeof text[4], "threads=%d", s->threads);
    snprintf(text[5], sizeof text[5], "host=%s", name.nodename);
    snprintf(text[6], sizeof text[6], "jobs=%d", s->options.jobs);
    status code = ledger_open(s->options.database, &l, r);
    if (code != STATUS_OK) return code;
    code = ledger_each_row(l, sql, arguments, 7, take_past, run, r);
    /* Its frames are compared too: a run whose folder is gone is made again. */
    if (code == STATUS_OK && run->result.id[0] && frame_exists(run->folder, s->frames)) run->state = ACCURACY_BEFORE;
    if (code == STATUS_OK && run->state == ACCURACY_BEFORE) code = ledger_tag(l, run->result.id, s->tag, true, r);
    if (run->state != ACCURACY_BEFORE) run->result = (study_result){0}, run->folder[0] = '\0';
    ledger_close(l);
    return code;
}

static status remember(const accuracy_study *s, const accuracy_run *run, const char *text, report *r) {
    ledger *l = NULL;
    status code = ledger_open(s->options.database, &l, r);
    if (code == STATUS_OK) code = ledger_event(l, run->result.id, s->frames, "timing", text, r);
    if (l) ledger_close(l);
    return code;
}

status accuracy_mark_together(accuracy_study *s, const accuracy_run *run, report *r) {
    return remember(s, run, "together", r);
}

/* The steps of the whole run, without measures and files. */
static status time_steps(const accuracy_study *s, const accuracy_run *run, script *from, double *seconds, report *r) {
    simulation *state = NULL;
    simulation_options engine = {.threads = s->threads, .precision = run->axis < 0 ? s->options.precision : s->axes[run->axis].level[run->level].precision,
                                 .simd = s->options.simd};
    status code = simulation_create(script_scene(from), &engine, &state, r);
    *seconds = 0;
    for (int64_t frame = 0; frame < s->frames && code == STATUS_OK && !study_stopped(); frame++) {
        double start = clock_seconds();
        code = simulation_advance(state, NULL, r);
        *seconds += clock_seconds() - start;
    }
    simulation_destroy(state);
    return code;
}

status accuracy_time_again(accuracy_study *s, accuracy_run *run, report *r) {
    static script_reports reports;
    double sum = run->result.step_seconds, seconds;
    if (sum >= LONG_ENOUGH) return STATUS_OK;
    script_options o = script_options_default();
    script *from;
    o.recipe = s->options.recipe;
    o.settings = run->settings;
    o.setting_count = run->setting_count;
    status code = script_load(s->options.scene, &o, &from, &reports);
    if (code != STATUS_OK) return *r = reports.items[0], code;
    while (code == STATUS_OK && sum < LONG_ENOUGH && run->timed < TIMED_MOST && !study_stopped()) {
        code = time_steps(s, run, from, &seconds, r);
        if (code != STATUS_OK || study_stopped()) break;
        run->result.step_seconds = fmin(run->result.step_seconds, seconds);
        run->timed++;
        sum += seconds;
    }
    script_close(from);
    char text[64];
    snprintf(text, sizeof text, "%.17g of %d", run->result.step_seconds, run->timed);
    return code == STATUS_OK ? remember(s, run, text, r) : code;
}
