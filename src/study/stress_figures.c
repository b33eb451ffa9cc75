/* What is measured of a hard case's run: from its rows in the ledger (energies, momentum, steps) and from its frames (places, F, damage). */
#include "study/stress.h"

#include "base/memory.h"
#include "store/frames.h"
#include "store/run_curves.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- the ledger's rows ------------------------------------------------------------------------------------------- */

typedef enum row_name {
    ROW_KINETIC, ROW_ELASTIC, ROW_FIBRE, ROW_GRAVITATIONAL, ROW_WORK, ROW_MASS, ROW_SPEED, ROW_DETERMINANT_MIN, ROW_DETERMINANT_MAX, ROW_FIBRE_MIN,
    ROW_FIBRE_MAX, ROW_BOND, ROW_DIFFUSED, ROW_DAMAGE_MEAN, ROW_BROKEN, ROW_STEP, ROW_MOMENTUM, ROW_ANGULAR = ROW_MOMENTUM + 3, ROW_IMPULSE = ROW_ANGULAR + 3,
    ROWS = ROW_IMPULSE + 3,
} row_name;

static const char *const row_names[ROWS] = {
    "kinetic", "elastic", "fibre", "gravitational", "grip_work", "mass", "speed_max", "determinant_min", "determinant_max", "fibre_stretch_min",
    "fibre_stretch_max", "bond_stretch_max", "diffused_total", "damage_mean", "broken_fraction", "dt_min", "momentum_x", "momentum_y", "momentum_z",
    "angular_momentum_x", "angular_momentum_y", "angular_momentum_z", "grip_impulse_x", "grip_impulse_y", "grip_impulse_z",
};

typedef struct run_rows {
    run_curve row[ROWS];
    int count; /* frames */
} run_rows;

static status read_rows(ledger *l, const char *id, run_rows *rows, report *r) {
    status code = STATUS_OK;
    for (int i = 0; i < ROWS && code == STATUS_OK; i++) {
        code = run_curve_read(l, id, row_names[i], &rows->row[i], r);
        rows->count = rows->row[i].count > rows->count ? rows->row[i].count : rows->count;
    }
    return code;
}

static void free_rows(run_rows *rows) {
    for (int i = 0; i < ROWS; i++) run_curve_free(&rows->row[i]);
}

/* NaN where a run has no such row in this frame. */
static double at(const run_rows *rows, row_name name, int frame) {
    return frame < rows->row[name].count ? rows->row[name].y[frame] : NAN;
}

static double last(const run_rows *rows, row_name name) {
    return rows->row[name].count > 0 ? rows->row[name].y[rows->row[name].count - 1] : NAN;
}

/* A figure that is not a number stays one: it is within no bounds. */
static double larger(double a, double b) {
    return isnan(a) || isnan(b) ? NAN : fmax(a, b);
}

static double most(const run_rows *rows, row_name name, double sign) {
    double found = rows->row[name].count > 0 ? -HUGE_VAL : NAN;
    for (int k = 0; k < rows->row[name].count; k++) found = larger(found, sign * rows->row[name].y[k]);
    return sign * found;
}

static double stored(const run_rows *rows, int k) {
    return at(rows, ROW_ELASTIC, k) + at(rows, ROW_FIBRE, k);
}

/* Of nothing, no change is none; any other is all. */
static double share(double change, double whole) {
    if (isnan(change) || isnan(whole)) return NAN;
    return whole > 0 ? change / whole : change > 0 ? HUGE_VAL : 0;
}

static void take_energies(const run_rows *rows, double *value) {
    double start = 0, high = 0, gain = 0, drift = 0, highest = 0, store = 0;
    for (int k = 0; k < rows->count; k++) {
        double inner = at(rows, ROW_KINETIC, k) + stored(rows, k);
        double balance = inner + at(rows, ROW_GRAVITATIONAL, k) - at(rows, ROW_WORK, k);
        if (k == 0) start = balance;
        high = larger(high, fabs(inner));
        highest = larger(highest, inner);
        store = larger(store, stored(rows, k));
        gain = larger(gain, balance - start);
        drift = larger(drift, fabs(balance - start));
    }
    int end = rows->count - 1;
    value[HARD_energy_gain] = share(gain, high);
    value[HARD_energy_drift] = share(drift, high);
    value[HARD_energy_left] = end < 0 ? NAN : share(at(rows, ROW_KINETIC, end) + stored(rows, end), highest);
    value[HARD_stored_left] = end < 0 ? NAN : share(stored(rows, end), store);
}

static void take_momenta(const run_rows *rows, const double gravity[3], double *value) {
    double drift = 0, turn = 0, spin = 0, scale = most(rows, ROW_MASS, 1) * most(rows, ROW_SPEED, 1);
    for (int k = 0; k < rows->count; k++) {
        double change = 0, twist = 0;
        for (int c = 0; c < 3; c++) {
            double given = at(rows, ROW_IMPULSE + (row_name)c, k) + at(rows, ROW_MASS, k) * gravity[c] * (rows->row[ROW_MASS].x[k] - rows->row[ROW_MASS].x[0]);
            change += pow(at(rows, ROW_MOMENTUM + (row_name)c, k) - at(rows, ROW_MOMENTUM + (row_name)c, 0) - given, 2);
            twist += pow(at(rows, ROW_ANGULAR + (row_name)c, k) - at(rows, ROW_ANGULAR + (row_name)c, 0), 2);
            if (k == 0) spin += pow(at(rows, ROW_ANGULAR + (row_name)c, 0), 2);
        }
        drift = larger(drift, sqrt(change));
        turn = larger(turn, sqrt(twist));
    }
    value[HARD_momentum_drift] = share(drift, scale);
    value[HARD_angular_drift] = share(turn, sqrt(spin));
}

static void take_rows(const run_rows *rows, double *value) {
    value[HARD_speed_max] = most(rows, ROW_SPEED, 1);
    value[HARD_speed_end] = last(rows, ROW_SPEED);
    value[HARD_determinant_min] = most(rows, ROW_DETERMINANT_MIN, -1);
    value[HARD_determinant_end] = last(rows, ROW_DETERMINANT_MIN);
    value[HARD_determinant_max] = most(rows, ROW_DETERMINANT_MAX, 1);
    value[HARD_fibre_stretch_min] = most(rows, ROW_FIBRE_MIN, -1);
    value[HARD_fibre_stretch_max] = most(rows, ROW_FIBRE_MAX, 1);
    value[HARD_bond_stretch_max] = most(rows, ROW_BOND, 1);
    value[HARD_damage_mean] = last(rows, ROW_DAMAGE_MEAN);
    value[HARD_broken_fraction] = last(rows, ROW_BROKEN);
    const run_curve *heat = &rows->row[ROW_DIFFUSED], *step = &rows->row[ROW_STEP];
    for (int k = 0; k < heat->count; k++)
        value[HARD_diffused_drift] = larger(k ? value[HARD_diffused_drift] : 0, share(fabs(heat->y[k] - heat->y[0]), fabs(heat->y[0])));
    double first = NAN, least = NAN;
    for (int k = 0; k < step->count; k++) {
        if (!(step->y[k] > 0) || !isfinite(step->y[k])) continue; /* frame 0 has none */
        if (isnan(first)) first = step->y[k];
        if (!(least <= step->y[k])) least = step->y[k];
    }
    value[HARD_step_shrink] = first / least;
}

static status take_steps(void *context, const ledger_cell *cells, int count, report *r) {
    (void)count, (void)r;
    ((double *)context)[HARD_steps] = cells[0].number;
    return STATUS_OK;
}

/* ---- the frames -------------------------------------------------------------------------------------------------- */

/* One array of a frame, as doubles. */
static double element(const record *of, int64_t i) {
    return of->type == RECORD_F32 ? (double)((const float *)of->data)[i] : of->type == RECORD_F64 ? ((const double *)of->data)[i] : NAN;
}

typedef struct frame_walk {
    stress_figures *out;
    const char *part; /* "solid", "sheet" */
    int64_t frame;
    bool first, last;
    double low[3], high[3], sum[3]; /* of all parts of this frame */
    int64_t count, start_count;
    double start_diagonal;
    double *damage;   /* [damage_count] of the frame before, by id; solids, then sheets */
    int64_t damage_count, damage_at;
} frame_walk;

static void complain(frame_walk *w, const char *what, int64_t row, double value) {
    if (w->out->broken[0]) return;
    snprintf(w->out->broken, sizeof w->out->broken, "%s %s: %g of %s particle %lld in frame %lld", w->part, what, value, w->part, (long long)row, (long long)w->frame);
}

static void check_finite(frame_walk *w, const record *of, const char *what) {
    for (int64_t i = 0; of && i < of->count * of->components; i++)
        if (!isfinite(element(of, i))) complain(w, what, i / of->components, element(of, i));
}

static void widen(double *least, double *largest, double value) {
    if (least && !(*least <= value)) *least = value;
    if (largest && !(*largest >= value)) *largest = value;
}

static void take_places(frame_walk *w, const record *places) {
    double *value = w->out->value;
    for (int64_t i = 0; places && i < places->count; i++)
        for (int c = 0; c < 3; c++) {
            double x = element(places, 3 * i + c);
            widen(&w->low[c], &w->high[c], x);
            widen(&value[HARD_low_x + c], &value[HARD_high_x + c], x);
            w->sum[c] += x;
        }
    w->count += places ? places->count : 0;
}

static void take_deformation(frame_walk *w, const record *F) {
    double largest = NAN;
    for (int64_t i = 0; F && i < F->count; i++) {
        double sum = 0;
        for (int c = 0; c < 9; c++) sum += pow(element(F, 9 * i + c), 2);
        widen(NULL, &largest, sqrt(sum / 3));
    }
    if (!F || F->count == 0) return;
    widen(NULL, &w->out->value[HARD_deformation_max], largest);
    if (w->last) w->out->value[HARD_deformation_end] = largest;
}

/* Damage lies in [0, 1] and never goes back; round-off of its own precision is allowed for. */
static status take_damage(frame_walk *w, const record *d, report *r) {
    for (int64_t i = 0; d && i < d->count; i++) {
        double now = element(d, i);
        if (!(now >= 0 && now <= 1)) complain(w, "damage is out of [0, 1]", i, now);
        widen(NULL, &w->out->value[HARD_damage_max], now);
        if (w->damage_at + i < w->damage_count && now < w->damage[w->damage_at + i] - 1e-6) complain(w, "damage has healed", i, now);
    }
    if (!d || !w->first) {
        for (int64_t i = 0; d && i < d->count && w->damage_at + i < w->damage_count; i++) w->damage[w->damage_at + i] = element(d, i);
        w->damage_at += d ? d->count : 0;
        return STATUS_OK;
    }
    size_t before = (size_t)w->damage_count * sizeof *w->damage, after = before + (size_t)d->count * sizeof *w->damage;
    double *larger = memory_resize(w->damage, before, after);
    if (!larger) return report_set(r, STATUS_SYSTEM, "out of memory for %lld particles' damage", (long long)d->count);
    w->damage = larger;
    for (int64_t i = 0; i < d->count; i++) w->damage[w->damage_count + i] = element(d, i);
    w->damage_count += d->count;
    return STATUS_OK;
}

static status take_part(frame_walk *w, const record_list *list, const char *part, report *r) {
    char name[RECORD_NAME];
    const record *of[5];
    static const char *const fields[] = {"position", "velocity", "deformation_gradient", "damage", "diffused"};
    for (int i = 0; i < 5; i++) {
        snprintf(name, sizeof name, "%s/%s", part, fields[i]);
        of[i] = record_find(list, name);
    }
    w->part = part;
    check_finite(w, of[0], "position");
    check_finite(w, of[1], "velocity");
    check_finite(w, of[2], "deformation");
    check_finite(w, of[3], "damage");
    check_finite(w, of[4], "diffused quantity");
    take_places(w, of[0]);
    take_deformation(w, of[2]);
    for (int64_t i = 0; of[4] && i < of[4]->count; i++) widen(&w->out->value[HARD_diffused_min], &w->out->value[HARD_diffused_max], element(of[4], i));
    return take_damage(w, of[3], r);
}

static void end_frame(frame_walk *w) {
    double *value = w->out->value, diagonal = 0;
    for (int c = 0; c < 3; c++) diagonal += pow(w->high[c] - w->low[c], 2);
    diagonal = sqrt(diagonal);
    if (w->first) w->start_diagonal = diagonal, w->start_count = w->count;
    w->part = "of all bodies";
    if (w->count != w->start_count) complain(w, "particles got lost", 0, (double)(w->start_count - w->count));
    if (!w->last) return;
    value[HARD_spread] = share(diagonal, w->start_diagonal);
    for (int c = 0; c < 3; c++) value[HARD_centre_x + c] = w->sum[c] / (double)w->count;
}

static status take_frame(frame_walk *w, const char *folder, report *r) {
    static const char *const names[] = {"solid/position", "solid/velocity", "solid/deformation_gradient", "solid/damage", "solid/diffused",
                                        "sheet/position", "sheet/velocity", "sheet/damage", "sheet/diffused"};
    record_list list = {0};
    double time;
    int64_t step;
    for (int c = 0; c < 3; c++) w->low[c] = w->high[c] = NAN, w->sum[c] = 0;
    w->count = w->damage_at = 0;
    status code = frame_read_named(folder, w->frame, names, sizeof names / sizeof *names, &list, &time, &step, r);
    if (code == STATUS_OK) code = take_part(w, &list, "solid", r);
    if (code == STATUS_OK) code = take_part(w, &list, "sheet", r);
    if (code == STATUS_OK) end_frame(w);
    record_clear(&list);
    return code;
}

static status take_frames(const char *folder, stress_figures *out, report *r) {
    int64_t *frames = NULL;
    int count = 0;
    frame_walk w = {.out = out};
    status code = frame_list(folder, &frames, &count, r);
    for (int i = 0; i < count && code == STATUS_OK; i++) {
        w.frame = frames[i];
        w.first = i == 0, w.last = i == count - 1;
        code = take_frame(&w, folder, r);
    }
    memory_free(w.damage, (size_t)w.damage_count * sizeof *w.damage);
    memory_free(frames, (size_t)count * sizeof *frames);
    return code;
}

status stress_measure(ledger *l, const char *id, const char *folder, const double gravity[3], stress_figures *out, report *r) {
    static const char sql[] = "SELECT f.steps FROM frames AS f JOIN runs USING (run) WHERE id = :id ORDER BY f.frame DESC LIMIT 1";
    run_rows rows = {0};
    char argument[LEDGER_ID + 4];
    const char *const arguments[] = {argument};
    out->broken[0] = '\0';
    for (int i = 0; i < HARD_MEASURE_COUNT; i++) out->value[i] = NAN;
    snprintf(argument, sizeof argument, "id=%s", id);
    status code = read_rows(l, id, &rows, r);
    if (code == STATUS_OK) code = ledger_each_row(l, sql, arguments, 1, take_steps, out->value, r);
    if (code == STATUS_OK && rows.count > 0) {
        take_energies(&rows, out->value);
        take_momenta(&rows, gravity, out->value);
        take_rows(&rows, out->value);
    }
    free_rows(&rows);
    return code == STATUS_OK ? take_frames(folder, out, r) : code;
}

/* ---- two runs ---------------------------------------------------------------------------------------------------- */

static status read_last(const char *folder, record_list *list, report *r) {
    static const char *const names[] = {"solid/position", "sheet/position"};
    double time;
    int64_t step;
    return frame_read_named(folder, frame_last(folder), names, 2, list, &time, &step, r);
}

status stress_difference(const char *folder, const char *other, const hard_likeness *how, double *out, report *r) {
    record_list a = {0}, b = {0};
    status code = read_last(folder, &a, r);
    if (code == STATUS_OK) code = read_last(other, &b, r);
    *out = a.count > 0 && a.count == b.count ? 0 : HUGE_VAL;
    for (int k = 0; code == STATUS_OK && k < a.count && k < b.count; k++) {
        const record *x = &a.items[k], *y = record_find(&b, x->name);
        if (!y || y->count != x->count) *out = HUGE_VAL;
        for (int64_t i = 0; y && y->count == x->count && i < 3 * x->count; i++)
            *out = fmax(*out, fabs((element(x, i) - how->shift[i % 3]) / how->length - element(y, i)));
    }
    record_clear(&a);
    record_clear(&b);
    return code;
}
