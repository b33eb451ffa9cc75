/* Errors, orders, the frontier, and what is to be advised. */
#include "study/accuracy.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double FASTER = 0.97;       /* times closer than that are the same */
static const double SAME_ERROR = 1.05;   /* so are errors */
static const double ORDER_MOST = 8, ORDER_LEAST = 0.5; /* beyond these the levels are not yet where an order shows */

static bool made(const accuracy_run *run) {
    return run->state == ACCURACY_DONE || run->state == ACCURACY_BEFORE;
}

/* The numbers of an axis' levels that were made, coarsest first. */
static int levels_made(const accuracy_study *s, int axis, int out[AXIS_LEVELS]) {
    int count = 0;
    for (int l = 0; l < s->axes[axis].count; l++)
        if (s->run_of[axis][l] >= 0 && made(&s->runs[s->run_of[axis][l]])) out[count++] = l;
    return count;
}

static const accuracy_run *run_at(const accuracy_study *s, int axis, int level) {
    return &s->runs[s->run_of[axis][level]];
}

/* ---- one axis ---------------------------------------------------------------------------------------------------- */

/* The size that an order is in: spacing, step, or the value itself. */
static double size_of(const accuracy_study *s, int axis, int level) {
    const accuracy_axis *a = &s->axes[axis];
    const accuracy_run *run = run_at(s, axis, level);
    if (!a->ordered) return NAN;
    if (!a->same_particles) return pow((double)run->result.particles, -1.0 / s->dimensions);
    return strcmp(a->name, "step") == 0 ? run->end / (double)run->result.steps : a->level[level].number;
}

/* Frames that end before the first crack of any of the runs; the last frame where there is none. */
static int last_early(const accuracy_study *s, int axis, const int *levels, int count, double *crack) {
    *crack = NAN;
    for (int i = 0; i < count; i++) *crack = fmin(*crack, run_at(s, axis, levels[i])->crack_time);
    double end = run_at(s, axis, levels[0])->end;
    if (isnan(*crack) || end <= 0) return (int)s->frames;
    int last = (int)ceil(*crack / end * (double)s->frames - 1e-9) - 1;
    return last < 0 ? 0 : last;
}

/* d01/d12 = (h0^p − h1^p)/(h1^p − h2^p), by bisection: the right side grows with p. (Richardson's extrapolation on grids that need not be
 * evenly refined: Roache 1994.) */
static double observed_order(double d01, double d12, const double h[3]) {
    double low = ORDER_LEAST, high = ORDER_MOST, ratio = d01 / d12;
    if (!(d12 > 0) || !isfinite(ratio) || !(h[0] > h[1] * 1.01 && h[1] > h[2] * 1.01)) return NAN;
    for (int i = 0; i < 60; i++) {
        double p = 0.5 * (low + high);
        if ((pow(h[0], p) - pow(h[1], p)) / (pow(h[1], p) - pow(h[2], p)) < ratio) low = p;
        else high = p;
    }
    return low > ORDER_LEAST && high < ORDER_MOST ? 0.5 * (low + high) : NAN;
}

/* What the three finest levels say of a measure: the order from frames before the first crack, and with it what is left over all frames. */
static status find_order(accuracy_study *s, int axis, int measure, const int *levels, int count, int last, report *r) {
    accuracy_result *x = &s->results[axis];
    if (!s->axes[axis].ordered || count < 3 || last < 1) return STATUS_OK;
    const int *l = &levels[count - 3];
    double h[3], d01, d12, all, scale = accuracy_scale(s, run_at(s, axis, l[2]), measure, (int)s->frames);
    for (int i = 0; i < 3; i++) h[i] = x->point[l[i]].h;
    status code = accuracy_distance(s, run_at(s, axis, l[0]), run_at(s, axis, l[1]), measure, last, &d01, r);
    if (code == STATUS_OK) code = accuracy_distance(s, run_at(s, axis, l[1]), run_at(s, axis, l[2]), measure, last, &d12, r);
    if (code == STATUS_OK) code = accuracy_distance(s, run_at(s, axis, l[1]), run_at(s, axis, l[2]), measure, (int)s->frames, &all, r);
    if (code != STATUS_OK) return code;
    double p = x->order[measure] = observed_order(d01, d12, h);
    x->left[measure] = all / scale / (isfinite(p) ? pow(h[1] / h[2], p) - 1 : 1);
    return STATUS_OK;
}

static status judge_measure(accuracy_study *s, int axis, int measure, const int *levels, int count, int early, report *r) {
    accuracy_result *x = &s->results[axis];
    accuracy_measure *m = &s->measures[measure];
    const accuracy_run *reference = run_at(s, axis, x->reference);
    status code = STATUS_OK;
    if (m->kind == MEASURE_PARTICLES && !s->axes[axis].same_particles) return STATUS_OK;
    for (int i = 0; i < count && code == STATUS_OK; i++) {
        accuracy_point *p = &x->point[levels[i]];
        double d, e, scale = accuracy_scale(s, reference, measure, (int)s->frames);
        code = accuracy_distance(s, run_at(s, axis, levels[i]), reference, measure, (int)s->frames, &d, r);
        if (code == STATUS_OK) code = accuracy_distance(s, run_at(s, axis, levels[i]), reference, measure, early, &e, r);
        p->error[measure] = scale > 0 ? d / scale : NAN;
        p->early[measure] = scale > 0 ? e / scale : NAN;
        m->occurs |= isfinite(p->error[measure]);
    }
    return code == STATUS_OK ? find_order(s, axis, measure, levels, count, early, r) : code;
}

static void find_worst(const accuracy_study *s, accuracy_point *p) {
    p->worst = p->worst_early = NAN;
    p->worst_measure = -1;
    for (int m = 0; m < s->measure_count; m++) {
        if (!s->measures[m].judged) continue;
        if (!(p->error[m] <= p->worst) && isfinite(p->error[m])) p->worst = p->error[m], p->worst_measure = m;
        if (s->measures[m].kind != MEASURE_TIME) p->worst_early = fmax(p->worst_early, p->early[m]);
    }
}

static void clear_result(accuracy_result *x) {
    *x = (accuracy_result){.reference = -1, .worst_order = NAN, .worst_left = NAN, .crack = NAN};
    for (int m = 0; m < ACCURACY_MEASURES; m++) x->order[m] = x->left[m] = NAN;
    for (int l = 0; l < AXIS_LEVELS; l++) {
        accuracy_point *p = &x->point[l];
        *p = (accuracy_point){.run = -1, .h = NAN, .worst = NAN, .worst_early = NAN, .worst_measure = -1, .estimate = NAN, .dominated_by = -1};
        for (int m = 0; m < ACCURACY_MEASURES; m++) p->error[m] = p->early[m] = NAN;
    }
}

static status judge_axis(accuracy_study *s, int axis, report *r) {
    accuracy_result *x = &s->results[axis];
    int levels[AXIS_LEVELS], count = levels_made(s, axis, levels);
    clear_result(x);
    for (int i = 0; i < count; i++) {
        x->point[levels[i]].run = s->run_of[axis][levels[i]];
        x->point[levels[i]].h = size_of(s, axis, levels[i]);
    }
    if (count < 2) return STATUS_OK;
    x->reference = levels[count - 1];
    int early = last_early(s, axis, levels, count, &x->crack);
    status code = STATUS_OK;
    for (int m = 0; m < s->measure_count && code == STATUS_OK; m++) code = judge_measure(s, axis, m, levels, count, early, r);
    for (int i = 0; i < count; i++) find_worst(s, &x->point[levels[i]]);
    const accuracy_point *own = &x->point[s->axes[axis].scene];
    int m = own->run >= 0 && own->worst > 0 ? own->worst_measure : x->point[levels[count - 2]].worst_measure;
    if (m >= 0) x->worst_order = x->order[m], x->worst_left = x->left[m];
    return code;
}

/* ---- all of them together ---------------------------------------------------------------------------------------- */

/* What an axis leaves at one of its levels: to its finest, and what that still lacks. */
static double leaves(const accuracy_study *s, int axis, int level) {
    const accuracy_result *x = &s->results[axis];
    if (x->reference < 0 || x->point[level].run < 0 || isnan(x->point[level].worst)) return 0;
    return x->point[level].worst + (isfinite(x->worst_left) ? x->worst_left : 0);
}

static void estimate_all(accuracy_study *s) {
    for (int a = 0; a < s->axis_count; a++) {
        double others = 0;
        for (int b = 0; b < s->axis_count; b++)
            if (b != a) others += leaves(s, b, s->axes[b].scene);
        for (int l = 0; l < s->axes[a].count; l++) {
            accuracy_point *p = &s->results[a].point[l];
            if (p->run >= 0 && s->results[a].reference >= 0) p->estimate = leaves(s, a, l) + others;
        }
    }
}

static bool better(const accuracy_study *s, const accuracy_point *a, const accuracy_point *b) {
    const accuracy_run *x = &s->runs[a->run], *y = &s->runs[b->run];
    return x->result.step_seconds < FASTER * y->result.step_seconds && a->estimate <= b->estimate;
}

static void draw_frontier(accuracy_study *s) {
    for (int a = 0; a < s->axis_count; a++)
        for (int l = 0; l < s->axes[a].count; l++) {
            accuracy_point *p = &s->results[a].point[l];
            if (isnan(p->estimate)) continue;
            for (int i = 0; i < s->axis_count * AXIS_LEVELS && p->dominated_by < 0; i++) {
                const accuracy_point *q = &s->results[i / AXIS_LEVELS].point[i % AXIS_LEVELS];
                if (!isnan(q->estimate) && better(s, q, p)) p->dominated_by = q->run;
            }
            p->frontier = p->dominated_by < 0;
        }
}

/* ---- advice ------------------------------------------------------------------------------------------------------ */

static void percent(double share, char text[24]) {
    if (share >= 0.9995) snprintf(text, 24, "%.0f %%", 100 * share);
    else snprintf(text, 24, "%.2g %%", 100 * share);
}

/* The next finer level beside the scene's own, or from the one before it where that is the finest. */
static void advise_axis(accuracy_study *s, int axis) {
    const accuracy_result *x = &s->results[axis];
    const accuracy_axis *a = &s->axes[axis];
    int levels[AXIS_LEVELS] = {0}, count = levels_made(s, axis, levels), at = 0;
    if (x->reference < 0) return;
    while (at < count - 2 && levels[at] != a->scene) at++;
    const accuracy_point *from = &x->point[levels[at]], *to = &x->point[levels[at + 1]];
    int m = from->worst_measure;
    if (m < 0) return;
    double ratio = s->runs[to->run].result.step_seconds / s->runs[from->run].result.step_seconds, change;
    report ignored;
    if (accuracy_distance(s, &s->runs[from->run], &s->runs[to->run], m, (int)s->frames, &change, &ignored) != STATUS_OK) return;
    char text[24];
    percent(change / accuracy_scale(s, &s->runs[to->run], m, (int)s->frames), text);
    accuracy_note(s, "%s from %s to %s takes %.2g times as long and changes %s by %s", a->key, a->level[levels[at]].value, a->level[levels[at + 1]].value, ratio,
                  s->measures[m].name, text);
}

/* Cheaper for about the same error; else where more time does most. */
static void advise_best(accuracy_study *s, const accuracy_point *own) {
    const accuracy_point *cheap = NULL, *fine = NULL;
    double seconds = s->runs[0].result.step_seconds, gain = 0;
    for (int i = 0; i < s->axis_count * AXIS_LEVELS; i++) {
        const accuracy_point *p = &s->results[i / AXIS_LEVELS].point[i % AXIS_LEVELS];
        if (isnan(p->estimate) || p->run == 0) continue;
        double time = s->runs[p->run].result.step_seconds;
        if (time < FASTER * seconds && p->estimate <= SAME_ERROR * own->estimate && (!cheap || time < s->runs[cheap->run].result.step_seconds)) cheap = p;
        double worth = time > seconds ? log(own->estimate / p->estimate) / log(time / seconds) : 0;
        if (p->estimate * SAME_ERROR < own->estimate && worth > gain) gain = worth, fine = p;
    }
    char name[96], was[24], now[24];
    percent(own->estimate, was);
    for (int k = 0; k < 2; k++) {
        const accuracy_point *p = k ? fine : cheap;
        if (!p) continue;
        accuracy_run_name(s, p->run, name);
        percent(p->estimate, now);
        double time = s->runs[p->run].result.step_seconds / seconds;
        if (k) accuracy_note(s, "More time does most for %s: %.2g times as long, estimated error %s instead of %s", name, time, now, was);
        else accuracy_note(s, "Time is to be saved by %s: %.2g of the time, estimated error %s instead of %s", name, time, now, was);
    }
    if (!cheap && !fine) accuracy_note(s, "The scene's own setting is as good as its time allows: estimated error %s", was);
}

static void advise(accuracy_study *s) {
    const accuracy_point *own = NULL;
    bool apart = false;
    s->advice = s->note_count;
    for (int a = 0; a < s->axis_count; a++) {
        const accuracy_result *x = &s->results[a];
        const accuracy_point *p = &x->point[s->axes[a].scene];
        if (x->reference >= 0 && p->run == 0) own = p;
        for (int l = 0; l < s->axes[a].count; l++) apart |= isfinite(x->crack) && x->point[l].worst_early < 0.3 * x->point[l].worst;
    }
    if (own && isfinite(own->estimate)) advise_best(s, own);
    for (int a = 0; a < s->axis_count; a++) advise_axis(s, a);
    if (apart) accuracy_note(s, "After the first crack small differences grow: errors up to it ('to crack') say what a setting does");
}

status accuracy_judge(accuracy_study *s, report *r) {
    status code = STATUS_OK;
    for (int i = 0; i < s->run_count && code == STATUS_OK; i++)
        if (made(&s->runs[i])) code = accuracy_read(s, &s->runs[i], r);
    for (int a = 0; a < s->axis_count && code == STATUS_OK; a++) code = judge_axis(s, a, r);
    if (code != STATUS_OK) return code;
    estimate_all(s);
    draw_frontier(s);
    advise(s);
    return STATUS_OK;
}
