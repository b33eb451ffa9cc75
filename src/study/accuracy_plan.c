/* What a study will run: axes, levels, what has been done before, what the rest costs, and what a budget leaves of it. */
#include "study/accuracy.h"

#include "base/memory.h"
#include "base/names.h"
#include "session/session.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double PROBE = 0.1; /* seconds of steps by which a run's cost is predicted */

/* ---- measures ---------------------------------------------------------------------------------------------------- */

static const accuracy_measure usual[] = {
    {.name = "energy", .doc = "kinetic, elastic, fibre and gravitational energy together", .kind = MEASURE_CURVES, .curves = 4,
     .curve = {"kinetic", "elastic", "fibre", "gravitational"}, .judged = true},
    {.name = "shape", .doc = "centre and extents, over the size at the start", .kind = MEASURE_MOMENTS, .curves = 6, .judged = true},
    {.name = "damage", .doc = "mean damage", .kind = MEASURE_CURVES, .curves = 1, .curve = {"damage_mean"}, .judged = true},
    {.name = "cracking", .doc = "when the first particle is broken", .kind = MEASURE_TIME, .curves = 1, .curve = {"damage_max"}, .judged = true},
    {.name = "diffused", .doc = "mean and root mean square of what diffuses", .kind = MEASURE_FIELD, .curves = 2, .curve = {"diffused"}, .judged = true},
    {.name = "broken", .doc = "fraction of particles that are broken", .kind = MEASURE_CURVES, .curves = 1, .curve = {"broken_fraction"}},
    {.name = "work", .doc = "work of the grips", .kind = MEASURE_CURVES, .curves = 1, .curve = {"grip_work"}},
    {.name = "crack_normal", .doc = "angle between the cracks' planes at the end, over a right angle", .kind = MEASURE_NORMAL, .curves = 3,
     .curve = {"crack_normal_x", "crack_normal_y", "crack_normal_z"}},
    {.name = "momentum", .doc = "momentum of all bodies", .kind = MEASURE_CURVES, .curves = 3, .curve = {"momentum_x", "momentum_y", "momentum_z"}},
    {.name = "position", .doc = "particle by particle at the end, over the size at the start", .kind = MEASURE_PARTICLES, .curve = {"position"}},
    {.name = "damage_field", .doc = "particle by particle at the end", .kind = MEASURE_PARTICLES, .curve = {"damage"}},
};

enum { USUAL = sizeof usual / sizeof *usual };

/* Names of the ledger's curves: any of them may be asked for. */
static const char *const curves[] = {"kinetic", "elastic", "fibre", "gravitational", "grip_work", "dissipated", "damage_mean", "damage_max", "broken_fraction",
                                     "determinant_min", "determinant_max", "speed_max", "fibre_stretch_min", "fibre_stretch_max", "angular_momentum_x",
                                     "angular_momentum_y", "angular_momentum_z", "grip_impulse_x", "grip_impulse_y", "grip_impulse_z", "bond_stretch_max", "diffused_total"};
enum { CURVES = sizeof curves / sizeof *curves };

static status add_measure(accuracy_study *s, const char *name, report *r) {
    const char *names[USUAL + CURVES];
    for (int i = 0; i < s->measure_count; i++)
        if (strcmp(s->measures[i].name, name) == 0) {
            s->measures[i].judged = true;
            return STATUS_OK;
        }
    for (int i = 0; i < CURVES; i++)
        if (strcmp(curves[i], name) == 0 && s->measure_count < ACCURACY_MEASURES) {
            accuracy_measure *m = &s->measures[s->measure_count++];
            *m = (accuracy_measure){.kind = MEASURE_CURVES, .curves = 1, .judged = true};
            snprintf(m->name, sizeof m->name, "%s", name);
            snprintf(m->doc, sizeof m->doc, "of the ledger");
            snprintf(m->curve[0], sizeof m->curve[0], "%s", name);
            return STATUS_OK;
        }
    for (int i = 0; i < USUAL; i++) names[i] = usual[i].name;
    for (int i = 0; i < CURVES; i++) names[USUAL + i] = curves[i];
    return report_input(r, NULL, 0, "--measure", "energy, shape, damage, cracking, diffused, broken, work, crack_normal, momentum, position, damage_field, or a measure of the ledger", name,
                        name_nearest(name, names, USUAL + CURVES));
}

static status choose_measures(accuracy_study *s, report *r) {
    const accuracy_options *o = &s->options;
    memcpy(s->measures, usual, sizeof usual);
    s->measure_count = USUAL;
    for (int i = 0; i < USUAL && o->measure_count > 0; i++) s->measures[i].judged = false;
    status code = STATUS_OK;
    for (int i = 0; i < o->measure_count && code == STATUS_OK; i++) code = add_measure(s, o->measures[i], r);
    return code;
}

/* ---- one run's plan ---------------------------------------------------------------------------------------------- */

typedef struct probe {
    int64_t particles;
    double dx, dt;
} probe;

static status list_settings(const accuracy_study *s, accuracy_run *run, report *r) {
    const accuracy_options *o = &s->options;
    const axis_level *l = run->axis >= 0 ? &s->axes[run->axis].level[run->level] : NULL;
    run->setting_count = o->setting_count + (l ? l->settings : 0);
    run->settings = memory_allocate_array((size_t)run->setting_count, sizeof *run->settings);
    if (!run->settings) return report_set(r, STATUS_SYSTEM, "out of memory for a study");
    for (int i = 0; i < o->setting_count; i++) run->settings[i] = o->settings[i];
    for (int i = 0; l && i < l->settings; i++) run->settings[o->setting_count + i] = (script_setting){l->key[i], l->text[i]};
    return STATUS_OK;
}

/* Samples the scene, looks at its first step, makes a few. */
static status try_plan(const accuracy_study *s, const scene *data, int precision, bool cost, probe *out, double *seconds, report *r) {
    simulation *state = NULL;
    simulation_options engine = {.threads = s->threads, .precision = precision, .simd = s->options.simd};
    simulation_cost c = {0};
    status code = simulation_create(data, &engine, &state, r);
    if (code != STATUS_OK) return code;
    const simulation_plan *p = simulation_get_plan(state);
    *out = (probe){.particles = p->particles, .dx = p->dx, .dt = p->dt};
    if (cost) code = simulation_measure_cost(state, data, PROBE, &c, r);
    *seconds = c.seconds_per_step * (double)s->frames / data->fps / out->dt;
    simulation_destroy(state);
    return code;
}

/* A scene may refuse a level: particles beyond what its s.params allow, say. */
static void leave_out(accuracy_study *s, accuracy_run *run, const report *why) {
    char name[96], text[1600];
    accuracy_run_name(s, (int)(run - s->runs), name);
    report_format(why, text, sizeof text);
    accuracy_note(s, "no %s: %.200s", name, text);
    s->run_of[run->axis][run->level] = -1;
    run->state = ACCURACY_LEFT_OUT;
}

/* Whether it was done before, and if not what it costs. A level that cannot even begin is a run that has failed. */
static status plan_run(accuracy_study *s, int axis, int level, script_reports *reports) {
    report *r = &reports->items[0];
    if (study_stopped()) return report_set(r, STATUS_INTERRUPTED, "interrupted before the first run");
    if (s->run_count == ACCURACY_RUNS) return report_input(r, NULL, 0, "--levels", "at most 96 runs", "more", NULL);
    accuracy_run *run = &s->runs[s->run_count];
    *run = (accuracy_run){.axis = axis, .level = level, .crack_time = NAN};
    s->run_of[axis][level] = s->run_count++;
    status code = list_settings(s, run, r);
    if (code != STATUS_OK) return code;
    script_options o = script_options_default();
    o.recipe = s->options.recipe;
    o.settings = run->settings;
    o.setting_count = run->setting_count;
    script *from;
    if (script_load(s->options.scene, &o, &from, reports) != STATUS_OK) {
        leave_out(s, run, r);
        return STATUS_OK;
    }
    sources_hash(from, run->hash);
    code = accuracy_find_past(s, run, r);
    probe found;
    if (code == STATUS_OK && run->state == ACCURACY_WAITING) {
        status tried = try_plan(s, script_scene(from), s->axes[axis].level[level].precision, true, &found, &run->predicted, r);
        if (tried == STATUS_OK) run->result.particles = found.particles;
        else {
            run->state = ACCURACY_FAILED;
            run->result.outcome = tried;
            report_format(r, run->result.message, sizeof run->result.message);
        }
    }
    script_close(from);
    return code;
}

/* ---- the study --------------------------------------------------------------------------------------------------- */

static void name_tag(accuracy_study *s) {
    char name[48];
    study_name(s->options.scene, name);
    snprintf(s->tag, sizeof s->tag, "accuracy:%s-%.6s", name, s->hash);
}

/* Keeps what was asked for, in its order; without words what is taken unasked. */
static status choose_axes(accuracy_study *s, report *r) {
    const accuracy_options *o = &s->options;
    bool keep[AXES] = {0};
    for (int i = 0; i < o->axis_count; i++) {
        if (strcmp(o->axes[i], "all") == 0) {
            for (int a = 0; a < s->axis_count; a++) keep[a] = true;
            continue;
        }
        int found = accuracy_axis_find(s->axes, s->axis_count, o->axes[i], r);
        if (found < 0) return r->code;
        keep[found] = true;
    }
    int kept = 0;
    for (int a = 0; a < s->axis_count; a++) {
        bool chosen = o->axis_count > 0 ? keep[a] : s->axes[a].unasked;
        if (chosen && s->axes[a].wanted < 2) accuracy_note(s, "%s has no other level here", s->axes[a].name);
        else if (chosen) s->axes[kept++] = s->axes[a];
    }
    s->axis_count = kept;
    return STATUS_OK;
}

/* The scene as it is: what all levels are beside. */
static status plan_own(accuracy_study *s, script_reports *reports) {
    report *r = &reports->items[0];
    script_options o = script_options_default();
    o.recipe = s->options.recipe;
    o.settings = s->options.settings;
    o.setting_count = s->options.setting_count;
    script *from;
    status code = script_load(s->options.scene, &o, &from, reports);
    if (code != STATUS_OK) return code;
    const scene *data = script_scene(from);
    s->frames = s->options.frames >= 0 ? s->options.frames : scene_frames(data);
    snprintf(s->title, sizeof s->title, "%.127s", data->title[0] ? data->title : data->file);
    sources_hash(from, s->hash);
    name_tag(s);
    simulation *state = NULL;
    simulation_options engine = {.threads = s->options.threads, .precision = s->options.precision, .simd = s->options.simd};
    reports->count = 1;
    code = simulation_create(data, &engine, &state, r);
    if (code == STATUS_OK) {
        const simulation_plan *p = simulation_get_plan(state);
        s->threads = p->threads;
        s->particles = p->particles;
        s->dimensions = p->solid ? 3 : 2;
        snprintf(s->simd, sizeof s->simd, "%s", p->simd);
        s->axis_count = accuracy_axes(data, p, s->options.precision, s->options.levels, s->axes);
        accuracy_run *own = &s->runs[s->run_count++];
        *own = (accuracy_run){.axis = -1, .crack_time = NAN};
        memcpy(own->hash, s->hash, sizeof own->hash);
        code = list_settings(s, own, r);
        simulation_cost c = {0};
        if (code == STATUS_OK) code = accuracy_find_past(s, own, r);
        if (code == STATUS_OK && own->state == ACCURACY_WAITING) code = simulation_measure_cost(state, data, PROBE, &c, r);
        own->predicted = c.seconds_per_step * (double)s->frames / data->fps / p->dt;
        if (own->state == ACCURACY_WAITING) own->result.particles = p->particles;
    }
    simulation_destroy(state);
    script_close(from);
    return code;
}

/* A scene that says its sheets' spacing itself has no other resolution by what --set reaches. */
static bool level_changes(const accuracy_study *s, int axis) {
    const accuracy_axis *a = &s->axes[axis];
    bool any = false;
    for (int l = 0; l < a->count; l++) any |= s->run_of[axis][l] > 0;
    if (a->same_particles || !any) return true;
    for (int l = 0; l < a->count; l++) {
        int run = s->run_of[axis][l];
        if (run > 0 && s->runs[run].state != ACCURACY_FAILED && s->runs[run].result.particles != s->runs[0].result.particles) return true;
    }
    return false;
}

static void drop_axis(accuracy_study *s, int axis) {
    for (int i = 1; i < s->run_count; i++)
        if (s->runs[i].axis == axis && s->runs[i].state == ACCURACY_WAITING) s->runs[i].state = ACCURACY_LEFT_OUT;
    for (int l = 0; l < AXIS_LEVELS; l++) s->run_of[axis][l] = -1;
    accuracy_note(s, "no axis %s: the scene fixes it where --set does not reach", s->axes[axis].name);
}

static status plan_levels(accuracy_study *s, script_reports *reports) {
    status code = STATUS_OK;
    for (int a = 0; a < s->axis_count && code == STATUS_OK; a++) {
        accuracy_axis *x = &s->axes[a];
        for (int l = x->first; l < x->first + x->wanted && code == STATUS_OK; l++)
            if (l != x->scene) code = plan_run(s, a, l, reports);
            else s->run_of[a][l] = 0;
        if (code == STATUS_OK && !level_changes(s, a)) drop_axis(s, a);
    }
    return code;
}

/* ---- the budget -------------------------------------------------------------------------------------------------- */

/* The run that costs most of those that an axis can do without: its finest level, while two others are left. */
static int dearest(const accuracy_study *s) {
    int found = -1;
    for (int i = 1; i < s->run_count; i++) {
        const accuracy_run *run = &s->runs[i];
        if (run->state != ACCURACY_WAITING || (found >= 0 && run->predicted <= s->runs[found].predicted)) continue;
        found = i;
    }
    return found;
}

static status keep_budget(accuracy_study *s, script_reports *reports) {
    int runs;
    if (s->options.budget <= 0) return STATUS_OK;
    while (accuracy_predicted(s, &runs) > s->options.budget) {
        int out = dearest(s);
        if (out < 0) {
            char expected[96], found[32];
            snprintf(expected, sizeof expected, "at least %.0f s, what the scene's own run takes (or --frames, --set particles=)", ceil(s->runs[0].predicted));
            snprintf(found, sizeof found, "%g", s->options.budget);
            return report_input(&reports->items[0], NULL, 0, "--budget", expected, found, NULL);
        }
        accuracy_run *run = &s->runs[out];
        accuracy_axis *a = &s->axes[run->axis];
        char name[96];
        accuracy_run_name(s, out, name);
        accuracy_note(s, "left out by the budget: %s, about %.0f s", name, run->predicted);
        s->run_of[run->axis][run->level] = -1;
        run->state = ACCURACY_LEFT_OUT;
        if (run->level <= a->scene || a->first == 0) continue;
        status code = plan_run(s, (int)(a - s->axes), --a->first, reports);
        if (code != STATUS_OK) return code;
    }
    return STATUS_OK;
}

/* Axes of which the scene's own level alone is left say nothing. */
static void drop_single_levels(accuracy_study *s) {
    for (int a = 0; a < s->axis_count; a++) {
        int left = 0;
        for (int l = 0; l < AXIS_LEVELS; l++) left += s->run_of[a][l] >= 0;
        if (left == 1)
            for (int l = 0; l < AXIS_LEVELS; l++) s->run_of[a][l] = -1;
    }
}

status accuracy_plan(const accuracy_options *options, accuracy_study **out, script_reports *reports) {
    accuracy_study *s = *out = memory_allocate(sizeof *s);
    reports->count = 1;
    if (!s) return report_set(&reports->items[0], STATUS_SYSTEM, "out of memory for a study");
    s->options = *options;
    for (int a = 0; a < AXES; a++)
        for (int l = 0; l < AXIS_LEVELS; l++) s->run_of[a][l] = -1;
    status code = choose_measures(s, &reports->items[0]);
    if (code == STATUS_OK) code = plan_own(s, reports);
    if (code == STATUS_OK) reports->count = 1, code = choose_axes(s, &reports->items[0]);
    if (code == STATUS_OK) code = plan_levels(s, reports);
    if (code == STATUS_OK) code = keep_budget(s, reports);
    if (code == STATUS_OK) drop_single_levels(s);
    if (code == STATUS_OK) reports->count = 0;
    else if (reports->count == 0) reports->count = 1;
    return code;
}
