#include "study/accuracy.h"

#include "base/memory.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

void accuracy_note(accuracy_study *s, const char *format, ...) {
    va_list arguments;
    if (s->note_count == ACCURACY_NOTES) return;
    va_start(arguments, format);
    vsnprintf(s->notes[s->note_count++], ACCURACY_TEXT, format, arguments);
    va_end(arguments);
}

void accuracy_run_name(const accuracy_study *s, int run, char text[96]) {
    const accuracy_run *q = &s->runs[run];
    if (q->axis < 0) snprintf(text, 96, "the scene's own");
    else snprintf(text, 96, "%.48s %s", s->axes[q->axis].key, s->axes[q->axis].level[q->level].value);
}

double accuracy_predicted(const accuracy_study *s, int *runs) {
    double sum = 0;
    *runs = 0;
    for (int i = 0; i < s->run_count; i++) {
        if (s->runs[i].state != ACCURACY_WAITING) continue;
        sum += s->runs[i].predicted;
        ++*runs;
    }
    return sum;
}

typedef struct maker {
    accuracy_study *study;
    int run[ACCURACY_RUNS]; /* of each request */
    study_teller tell;
    void *context;
    report *report;
    status trouble;
} maker;

static void told(void *context, int index, const study_result *result, bool ended) {
    maker *m = context;
    accuracy_run *run = &m->study->runs[m->run[index]];
    run->state = !ended ? ACCURACY_GOING : result->outcome == STATUS_OK ? ACCURACY_DONE : result->outcome == STATUS_INTERRUPTED ? ACCURACY_WAITING : ACCURACY_FAILED;
    run->result = *result;
    run->timed = 1;
    if (ended && result->begun) snprintf(run->folder, sizeof run->folder, "%s", result->folder);
    if (run->state == ACCURACY_DONE && m->trouble == STATUS_OK)
        m->trouble = (m->study->options.jobs > 1 ? accuracy_mark_together(m->study, run, m->report) : accuracy_time_again(m->study, run, m->report));
    m->tell(m->context, m->run[index], &run->result, ended);
}

/* A folder of its own under --out; one that is there already is another run's. */
static void name_folder(const accuracy_study *s, accuracy_run *run) {
    char name[96];
    accuracy_run_name(s, (int)(run - s->runs), name);
    for (char *c = name; *c; c++)
        if (*c == ' ' || *c == '/' || *c == '\'') *c = '-';
    for (int i = 1; i < 100; i++) {
        char end[16] = "";
        if (i > 1) snprintf(end, sizeof end, "-%d", i);
        snprintf(run->folder, sizeof run->folder, "%.800s/%s%s", s->options.output, run->axis < 0 ? "own" : name, end);
        if (access(run->folder, F_OK) != 0) return;
    }
}

status accuracy_make(accuracy_study *s, study_teller tell, void *context, report *r) {
    maker m = {.study = s, .tell = tell, .context = context, .report = r};
    study_request requests[ACCURACY_RUNS];
    study_result results[ACCURACY_RUNS];
    const accuracy_options *o = &s->options;
    int count = 0;
    for (int i = 0; i < s->run_count; i++) {
        accuracy_run *run = &s->runs[i];
        if (run->state != ACCURACY_WAITING) continue;
        if (o->output) name_folder(s, run);
        requests[count] = (study_request){.scene = o->scene, .recipe = o->recipe, .settings = run->settings, .setting_count = run->setting_count,
                                          .precision = run->axis < 0 ? o->precision : s->axes[run->axis].level[run->level].precision,
                                          .frames = s->frames, .output = o->output ? run->folder : NULL};
        m.run[count++] = i;
    }
    study_common common = {.database = o->database, .tag = s->tag, .command = o->command, .simd = o->simd, .threads = s->threads, .jobs = o->jobs};
    status code = study_runs_make(&common, requests, results, count, told, &m, r);
    if (m.trouble != STATUS_OK) return m.trouble;
    return code;
}

void accuracy_free(accuracy_study *s) {
    if (!s) return;
    for (int i = 0; i < s->run_count; i++) {
        accuracy_run *run = &s->runs[i];
        memory_free(run->settings, (size_t)run->setting_count * sizeof *run->settings);
        for (int m = 0; m < ACCURACY_MEASURES; m++)
            for (int c = 0; c < ACCURACY_CURVES; c++) memory_free(run->curve[m][c], (size_t)run->frames * sizeof(double));
    }
    memory_free(s, sizeof *s);
}
