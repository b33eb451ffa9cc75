/* Curves of a study's runs and how far they lie apart. */
#include "study/accuracy.h"

#include "base/memory.h"
#include "store/frames.h"
#include "store/run_curves.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LOOKS = 32 }; /* frames of a run whose particles are read: evenly spread */
static const char *const positions[] = {"solid/position", "sheet/position"};
static const double BROKEN = 0.9;

/* ---- curves ------------------------------------------------------------------------------------------------------ */

static status allocate_curves(const accuracy_study *s, accuracy_run *run, report *r) {
    run->frames = (int)s->frames + 1;
    for (int m = 0; m < s->measure_count; m++)
        for (int c = 0; c < s->measures[m].curves; c++) {
            double *curve = run->curve[m][c] = memory_allocate_array((size_t)run->frames, sizeof *curve);
            if (!curve) return report_set(r, STATUS_SYSTEM, "out of memory for a study's curves");
            for (int i = 0; i < run->frames; i++) curve[i] = NAN;
        }
    return STATUS_OK;
}

/* Where the curve first exceeds what counts as broken, between two frames. */
static double first_crossing(const run_curve *c) {
    for (int i = 0; i < c->count; i++) {
        if (!(c->y[i] > BROKEN)) continue;
        if (i == 0 || !(c->y[i - 1] <= BROKEN)) return c->x[i];
        return c->x[i - 1] + (c->x[i] - c->x[i - 1]) * (BROKEN - c->y[i - 1]) / (c->y[i] - c->y[i - 1]);
    }
    return NAN;
}

static status read_ledger_curves(const accuracy_study *s, ledger *l, accuracy_run *run, report *r) {
    run_curve c = {0};
    status code = STATUS_OK;
    for (int m = 0; m < s->measure_count; m++) {
        const accuracy_measure *measure = &s->measures[m];
        if (measure->kind != MEASURE_CURVES && measure->kind != MEASURE_TIME && measure->kind != MEASURE_NORMAL) continue;
        for (int k = 0; k < measure->curves && code == STATUS_OK; k++) {
            code = run_curve_read(l, run->result.id, measure->curve[k], &c, r);
            /* A potential has no zero of its own. */
            double zero = strcmp(measure->curve[k], "gravitational") == 0 && c.count > 0 ? c.y[0] : 0;
            for (int i = 0; i < c.count && i < run->frames; i++) run->curve[m][k][i] = c.y[i] - zero;
            if (c.count > 0) run->end = c.x[c.count - 1];
            if (measure->kind == MEASURE_TIME) run->crack_time = first_crossing(&c);
        }
    }
    run_curve_free(&c);
    return code;
}

static double element(const record *a, int64_t i) {
    return a->type == RECORD_F32 ? (double)((const float *)a->data)[i] : ((const double *)a->data)[i];
}

/* Centre and extents of all particles. */
static void measure_moments(const record_list *list, double out[6]) {
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, sum[3] = {0}, count = 0;
    for (int k = 0; k < 2; k++) {
        const record *a = record_find(list, positions[k]);
        for (int64_t i = 0; a && i < a->count; i++, count++)
            for (int c = 0; c < 3; c++) {
                double x = element(a, 3 * i + c);
                sum[c] += x;
                low[c] = fmin(low[c], x), high[c] = fmax(high[c], x);
            }
    }
    for (int c = 0; c < 3; c++) out[c] = sum[c] / count, out[3 + c] = high[c] - low[c];
}

/* Mean and root mean square of a field over all particles that have it; whether any has. */
static bool measure_field(const record_list *list, const char *field, double out[2]) {
    double sum = 0, squares = 0, count = 0;
    for (int k = 0; k < 2; k++) {
        char name[RECORD_NAME];
        snprintf(name, sizeof name, "%s/%s", k ? "sheet" : "solid", field);
        const record *a = record_find(list, name);
        for (int64_t i = 0; a && i < a->count; i++, count++) {
            double x = element(a, i);
            sum += x, squares += x * x;
        }
    }
    out[0] = sum / count, out[1] = sqrt(squares / count);
    return count > 0;
}

static void take_frame(accuracy_study *s, accuracy_run *run, int frame, const record_list *list) {
    double out[6];
    for (int m = 0; m < s->measure_count; m++) {
        const accuracy_measure *measure = &s->measures[m];
        if (measure->kind == MEASURE_MOMENTS) measure_moments(list, out);
        else if (measure->kind != MEASURE_FIELD || !measure_field(list, measure->curve[0], out)) continue;
        for (int c = 0; c < measure->curves; c++) run->curve[m][c][frame] = out[c];
        if (measure->kind == MEASURE_MOMENTS && frame == 0 && s->extent == 0) s->extent = sqrt(out[3] * out[3] + out[4] * out[4] + out[5] * out[5]);
    }
}

static status read_frames(accuracy_study *s, accuracy_run *run, report *r) {
    static const char *const names[] = {"solid/position", "sheet/position", "solid/diffused", "sheet/diffused"};
    int looks = run->frames < LOOKS ? run->frames : LOOKS;
    status code = STATUS_OK;
    for (int i = 0; i < looks && code == STATUS_OK; i++) {
        record_list list = {0};
        double time;
        int64_t step;
        int frame = looks > 1 ? (int)((int64_t)i * (run->frames - 1) / (looks - 1)) : 0;
        code = frame_read_named(run->folder, frame, names, sizeof names / sizeof *names, &list, &time, &step, r);
        if (code == STATUS_OK) take_frame(s, run, frame, &list);
        record_clear(&list);
    }
    return code;
}

status accuracy_read(accuracy_study *s, accuracy_run *run, report *r) {
    ledger *l = NULL;
    if (run->frames > 0) return STATUS_OK;
    status code = allocate_curves(s, run, r);
    if (code == STATUS_OK) code = ledger_open(s->options.database, &l, r);
    if (code == STATUS_OK) code = read_ledger_curves(s, l, run, r);
    if (l) ledger_close(l);
    return code == STATUS_OK ? read_frames(s, run, r) : code;
}

/* ---- distances --------------------------------------------------------------------------------------------------- */

/* √ of the mean over frames of Σ over curves of the square; b NULL: of a alone. */
static double norm(const accuracy_study *s, const accuracy_run *a, const accuracy_run *b, int measure, int last) {
    double sum = 0;
    int frames = 0;
    for (int i = 0; i < a->frames && i <= last; i++) {
        bool any = false;
        for (int c = 0; c < s->measures[measure].curves; c++) {
            double x = a->curve[measure][c][i] - (b ? b->curve[measure][c][i] : 0);
            if (!isfinite(x)) continue;
            sum += x * x;
            any = true;
        }
        frames += any;
    }
    return frames ? sqrt(sum / frames) : NAN;
}

static double between_times(const accuracy_run *a, const accuracy_run *b) {
    if (isnan(a->crack_time) && isnan(b->crack_time)) return NAN;
    /* One that has not cracked yet does so after its end at the earliest. */
    return fabs((isnan(a->crack_time) ? a->end : a->crack_time) - (isnan(b->crack_time) ? b->end : b->crack_time));
}

static double between_normals(const accuracy_run *a, const accuracy_run *b, int measure, int last) {
    double product = 0;
    for (int c = 0; c < 3; c++) product += a->curve[measure][c][last] * b->curve[measure][c][last];
    return isnan(product) ? NAN : acos(fmin(1, fabs(product))) / M_PI_2; /* NAN: one has no crack */
}

static double between_records(const record *a, const record *b, double *count) {
    double sum = 0;
    if (!a || !b || a->count != b->count || a->components != b->components) return 0;
    for (int64_t i = 0; i < a->count * a->components; i++) {
        double x = element(a, i) - element(b, i);
        sum += x * x;
    }
    *count += (double)a->count;
    return sum;
}

/* Root mean square over all particles at a frame. */
static status between_particles(const accuracy_run *a, const accuracy_run *b, const char *field, int frame, double *out, report *r) {
    bool places = strcmp(field, "position") == 0;
    const char *const names[] = {places ? positions[0] : "solid/damage", places ? positions[1] : "sheet/broken"};
    record_list lists[2] = {0};
    double time, sum = 0, count = 0;
    int64_t step;
    status code = frame_read_named(a->folder, frame, names, 2, &lists[0], &time, &step, r);
    if (code == STATUS_OK) code = frame_read_named(b->folder, frame, names, 2, &lists[1], &time, &step, r);
    for (int k = 0; k < 2 && code == STATUS_OK; k++) sum += between_records(record_find(&lists[0], names[k]), record_find(&lists[1], names[k]), &count);
    record_clear(&lists[0]);
    record_clear(&lists[1]);
    *out = count > 0 ? sqrt(sum / count) : NAN;
    return code;
}

status accuracy_distance(const accuracy_study *s, const accuracy_run *a, const accuracy_run *b, int measure, int last, double *out, report *r) {
    const accuracy_measure *m = &s->measures[measure];
    switch (m->kind) {
    case MEASURE_CURVES:
    case MEASURE_MOMENTS:
    case MEASURE_FIELD: *out = norm(s, a, b, measure, last); break;
    case MEASURE_TIME: *out = between_times(a, b); break;
    case MEASURE_NORMAL: *out = between_normals(a, b, measure, last); break;
    case MEASURE_PARTICLES: return between_particles(a, b, m->curve[0], last, out, r);
    }
    return STATUS_OK;
}

double accuracy_scale(const accuracy_study *s, const accuracy_run *reference, int measure, int last) {
    const accuracy_measure *m = &s->measures[measure];
    switch (m->kind) {
    case MEASURE_CURVES:
    case MEASURE_FIELD: return norm(s, reference, NULL, measure, last);
    case MEASURE_MOMENTS: return s->extent;
    case MEASURE_TIME: return isnan(reference->crack_time) ? reference->end : reference->crack_time;
    case MEASURE_NORMAL: break;
    case MEASURE_PARTICLES: return strcmp(m->curve[0], "position") == 0 ? s->extent : 1;
    }
    return 1;
}
