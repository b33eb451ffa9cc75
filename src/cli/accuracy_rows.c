/* A study as JSON and as rows for other programs. */
#include "cli/accuracy_print.h"

#include "base/json.h"
#include "cli/cli.h"

#include <math.h>

const char *accuracy_state_name(accuracy_state state) {
    static const char *const names[] = {"not started", "interrupted", "done before", "done", "failed", "left out"};
    return names[state];
}

/* ---- rows -------------------------------------------------------------------------------------------------------- */

static void row_number(FILE *out, double value) {
    if (isfinite(value)) fprintf(out, ",%.9g", value);
    else fputc(',', out);
}

/* What is beyond the study's own settings, as `sunder run` takes it. */
static void print_settings(const accuracy_study *s, int axis, int level, FILE *out) {
    const axis_level *l = &s->axes[axis].level[level];
    if (s->run_of[axis][level] == 0) return;
    for (int i = 0; i < l->settings; i++) fprintf(out, "%s--set %s=%s", i ? " " : "", l->key[i], l->text[i]);
    if (l->precision != s->options.precision) fprintf(out, "%s--precision f%d", l->settings ? " " : "", l->precision);
}

static void print_row(const accuracy_study *s, int axis, int level, FILE *out) {
    const accuracy_point *p = &s->results[axis].point[level];
    const accuracy_run *run = &s->runs[s->run_of[axis][level]];
    char other[96] = "";
    if (p->dominated_by >= 0) accuracy_run_name(s, p->dominated_by, other);
    fprintf(out, "%s,%s,%s,%s%s,%s,%s,%lld,%lld", s->axes[axis].name, s->axes[axis].key, s->axes[axis].level[level].value,
            s->run_of[axis][level] == 0 ? "own" : "", level == s->results[axis].reference ? "reference" : "", accuracy_state_name(run->state), run->result.id,
            (long long)run->result.particles, (long long)run->result.steps);
    bool done = run->state == ACCURACY_DONE || run->state == ACCURACY_BEFORE;
    row_number(out, p->h);
    row_number(out, done ? run->result.step_seconds : NAN);
    row_number(out, done ? run->result.seconds : NAN);
    row_number(out, done ? NAN : run->predicted);
    row_number(out, p->worst);
    row_number(out, p->worst_early);
    row_number(out, s->results[axis].worst_order);
    row_number(out, level == s->results[axis].reference ? s->results[axis].worst_left : NAN);
    row_number(out, p->estimate);
    fprintf(out, ",%d,%s,%d,", p->frontier, other, s->axes[axis].unasked);
    print_settings(s, axis, level, out);
    for (int m = 0; m < s->measure_count; m++) row_number(out, p->error[m]);
    fputc('\n', out);
}

void accuracy_print_rows(const accuracy_study *s, FILE *out) {
    fputs("axis,key,value,role,status,run,particles,steps,h,step_s,wall_s,predicted_s,error,error_to_crack,order,left,estimate,frontier,dominated_by,usual,settings", out);
    for (int m = 0; m < s->measure_count; m++) fprintf(out, ",%s", s->measures[m].name);
    fputc('\n', out);
    for (int a = 0; a < s->axis_count; a++)
        for (int l = 0; l < s->axes[a].count; l++)
            if (s->run_of[a][l] >= 0) print_row(s, a, l, out);
    for (int i = 0; i < s->note_count; i++) fprintf(out, "# %s\n", s->notes[i]);
}

/* ---- JSON -------------------------------------------------------------------------------------------------------- */

static void json_measures(json_writer *w, const accuracy_study *s, const char *key, const double *values) {
    json_member_object(w, key);
    for (int m = 0; m < s->measure_count; m++)
        if (isfinite(values[m])) json_member_number(w, s->measures[m].name, values[m]);
    json_object_end(w);
}

static void json_settings(json_writer *w, const axis_level *l, bool own) {
    json_member_object(w, "settings");
    for (int i = 0; i < l->settings && !own; i++) json_member_string(w, l->key[i], l->text[i]);
    json_object_end(w);
}

static void json_level(json_writer *w, const accuracy_study *s, int axis, int level) {
    const accuracy_point *p = &s->results[axis].point[level];
    const accuracy_run *run = &s->runs[s->run_of[axis][level]];
    const axis_level *l = &s->axes[axis].level[level];
    bool own = s->run_of[axis][level] == 0, done = run->state == ACCURACY_DONE || run->state == ACCURACY_BEFORE;
    char name[96];
    json_object(w);
    json_member_string(w, "value", l->value);
    json_member_boolean(w, "own", own);
    json_member_boolean(w, "reference", level == s->results[axis].reference);
    json_member_string(w, "status", accuracy_state_name(run->state));
    json_member_string(w, "message", run->result.message[0] ? run->result.message : NULL);
    json_member_string(w, "run_id", run->result.id[0] ? run->result.id : NULL);
    json_settings(w, l, own);
    json_member_integer(w, "precision", l->precision);
    json_member_integer(w, "particles", run->result.particles);
    json_member_integer(w, "steps", run->result.steps);
    json_member_number(w, "h", p->h);
    json_member_number(w, "step_s", done ? run->result.step_seconds : NAN);
    json_member_number(w, "wall_s", done ? run->result.seconds : NAN);
    json_member_integer(w, "timed", run->timed);
    json_member_number(w, "predicted_s", done ? NAN : run->predicted);
    json_member_number(w, "first_crack", run->crack_time);
    json_member_number(w, "error", p->worst);
    json_member_string(w, "error_of", p->worst_measure >= 0 ? s->measures[p->worst_measure].name : NULL);
    json_member_number(w, "error_to_crack", p->worst_early);
    json_measures(w, s, "errors", p->error);
    json_measures(w, s, "errors_to_crack", p->early);
    json_member_number(w, "estimate", p->estimate);
    json_member_boolean(w, "frontier", p->frontier);
    if (p->dominated_by >= 0) accuracy_run_name(s, p->dominated_by, name);
    json_member_string(w, "dominated_by", p->dominated_by >= 0 ? name : NULL);
    json_object_end(w);
}

static void json_axis(json_writer *w, const accuracy_study *s, int axis) {
    const accuracy_axis *a = &s->axes[axis];
    const accuracy_result *x = &s->results[axis];
    json_object(w);
    json_member_string(w, "name", a->name);
    json_member_string(w, "key", a->key);
    json_member_string(w, "doc", a->doc);
    json_member_boolean(w, "same_particles", a->same_particles);
    json_member_number(w, "order", x->worst_order);
    json_measures(w, s, "orders", x->order);
    json_measures(w, s, "left", x->left);
    json_member_number(w, "first_crack", x->crack);
    json_member_array(w, "levels");
    for (int l = 0; l < a->count; l++)
        if (s->run_of[axis][l] >= 0) json_level(w, s, axis, l);
    json_array_end(w);
    json_object_end(w);
}

static int count_state(const accuracy_study *s, accuracy_state state) {
    int count = 0;
    for (int i = 0; i < s->run_count; i++) count += s->runs[i].state == state;
    return count;
}

static void json_notes(json_writer *w, const accuracy_study *s, const char *key, int from, int to) {
    json_member_array(w, key);
    for (int i = from; i < to; i++) json_string(w, s->notes[i]);
    json_array_end(w);
}

status accuracy_print_json(const accuracy_study *s, report *r) {
    json_writer w;
    int waiting;
    json_begin(&w, 2);
    json_object(&w);
    json_member_string(&w, "title", s->title);
    json_member_string(&w, "scene", s->options.scene);
    json_member_string(&w, "tag", s->tag);
    json_member_string(&w, "db", s->options.database);
    json_member_integer(&w, "frames", s->frames);
    json_member_integer(&w, "particles", s->particles);
    json_member_integer(&w, "threads", s->threads);
    json_member_string(&w, "precision", s->options.precision == 64 ? "f64" : "f32");
    json_member_string(&w, "simd", s->simd);
    json_member_boolean(&w, "times_comparable", s->options.jobs == 1);
    json_member_integer(&w, "done", count_state(s, ACCURACY_DONE));
    json_member_integer(&w, "done_before", count_state(s, ACCURACY_BEFORE));
    json_member_integer(&w, "failed", count_state(s, ACCURACY_FAILED));
    double predicted = accuracy_predicted(s, &waiting);
    json_member_integer(&w, "not_started", waiting);
    json_member_number(&w, "predicted_s", predicted);
    json_member_array(&w, "axes");
    for (int a = 0; a < s->axis_count; a++) json_axis(&w, s, a);
    json_array_end(&w);
    int advice = s->advice > 0 || s->note_count == 0 ? s->advice : 0;
    json_notes(&w, s, "notes", 0, advice);
    json_notes(&w, s, "advice", advice, s->note_count);
    json_object_end(&w);
    return cli_print_json(&w, r);
}
