/* The object that `sunder run --json` ends with, and result.json. */
#include "base/clock.h"
#include "session/internal.h"

#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

static const char *outcome_word(status outcome) {
    switch (outcome) {
    case STATUS_OK: return "done";
    case STATUS_INTERRUPTED: return "interrupted";
    case STATUS_DIVERGED:
    case STATUS_INPUT:
    case STATUS_SYSTEM: break;
    }
    return "failed";
}

static void vector(json_writer *w, const char *name, const double v[3]) {
    json_member_array(w, name);
    for (int c = 0; c < 3; c++) json_number(w, v[c]);
    json_array_end(w);
}

static void write_run(session *s, json_writer *w) {
    const simulation_plan *plan = simulation_get_plan(s->simulation);
    double steps = (double)(simulation_steps(s->simulation) - s->steps_before);
    json_member_string(w, "run_id", s->id);
    json_member_string(w, "scene", s->options.resume || s->parent[0] ? s->request.scene : s->options.scene_path);
    if (s->parent[0]) json_member_string(w, "parent", s->parent);
    if (s->parent[0]) json_member_integer(w, "parent_frame", s->past_until);
    json_member_integer(w, "turns", s->knobs.acted);
    json_member_string(w, "title", s->scene->title);
    json_member_string(w, "status", outcome_word(s->outcome));
    char message[1024] = "";
    if (s->outcome != STATUS_OK) report_format(&s->report, message, sizeof message);
    json_member_string(w, "message", message[0] ? message : NULL);
    json_member_integer(w, "frames", simulation_frame(s->simulation));
    json_member_integer(w, "steps", simulation_steps(s->simulation));
    json_member_integer(w, "particles", plan->particles);
    json_member_number(w, "wall_s", clock_seconds() - s->wall_start);
    json_member_number(w, "step_wall_s", s->step_wall);
    json_member_number(w, "particle_steps_per_s", s->step_wall > 0 ? (double)plan->particles * steps / s->step_wall : 0);
    json_member_integer(w, "threads", plan->threads);
    json_member_string(w, "precision", plan->precision == 32 ? "f32" : "f64");
    json_member_string(w, "simd", plan->simd);
    json_member_array(w, "effects");
    for (int e = 0; e < plan->effect_count; e++)
        if (plan->mask >> e & 1) json_string(w, plan->effects[e]->name);
    json_array_end(w);
}

static void write_state(session *s, json_writer *w) {
    const simulation_measures *m = &s->measures;
    const solid_measures *sums = &m->solid;
    json_member_number(w, "dt_min", m->dt_min);
    json_member_number(w, "dt_max", m->dt_max);
    json_member_number(w, "time", m->time);
    json_member_object(w, "energy");
    json_member_number(w, "kinetic", sums->kinetic);
    json_member_number(w, "elastic", sums->elastic);
    json_member_number(w, "fibre", sums->fibre);
    json_member_number(w, "gravitational", sums->gravitational);
    json_member_number(w, "grip_work", sums->grip_work);
    json_member_number(w, "dissipated", m->dissipated);
    json_object_end(w);
    vector(w, "momentum", sums->momentum);
    vector(w, "angular_momentum", sums->angular_momentum);
    json_member_object(w, "damage");
    json_member_number(w, "mean", sums->damage_mean);
    json_member_number(w, "max", sums->damage_max);
    json_member_number(w, "broken_fraction", sums->broken_fraction);
    json_object_end(w);
    if (m->has_sheet) {
        json_member_object(w, "bonds");
        json_member_integer(w, "total", m->sheet.bonds_total);
        json_member_integer(w, "broken", m->sheet.bonds_broken);
        json_object_end(w);
    }
    json_key(w, "crack_normal");
    if (m->has_crack) {
        json_array(w);
        for (int c = 0; c < 3; c++) json_number(w, m->crack_normal[c]);
        json_array_end(w);
    } else {
        json_null(w);
    }
    json_member_number(w, "determinant_min", sums->determinant_min);
    json_member_number(w, "determinant_max", sums->determinant_max);
    json_member_object(w, "fibre_stretch");
    json_member_number(w, "min", sums->stretch_min);
    json_member_number(w, "max", sums->stretch_max);
    json_object_end(w);
    json_member_object(w, "constraint");
    json_member_integer(w, "solves", sums->constraint_solves);
    json_member_integer(w, "iterations", sums->constraint_iterations);
    json_member_integer(w, "factorisations", sums->constraint_factorisations);
    json_object_end(w);
}

status summary_write(session *s, report *r) {
    json_writer *w = &s->summary;
    const simulation_plan *plan = simulation_get_plan(s->simulation);
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    uint64_t hash = 0;
    report ignored;
    char text[32];
    if (simulation_hash(s->simulation, &hash, &ignored) != STATUS_OK) hash = 0;
    snprintf(text, sizeof text, "%016llx", (unsigned long long)hash);
    json_begin(w, 2);
    json_object(w);
    write_run(s, w);
    write_state(s, w);
    json_member_number(w, "bytes_per_particle", plan->bytes_per_particle);
    json_member_integer(w, "peak_rss_bytes", (int64_t)usage.ru_maxrss * 1024);
    json_member_string(w, "state_hash", text);
    json_member_string(w, "out", s->folder);
    json_member_string(w, "db", s->database);
    json_object_end(w);
    status code = json_finish(w, r);
    if (code != STATUS_OK) return code;
    char path[SESSION_PATH + 32];
    snprintf(path, sizeof path, "%s/result.json", s->folder);
    return file_write_atomic(path, w->text, w->size, r);
}
