/* The loop of a run: a frame, its measures, its file, its ledger row. */
#include "session/internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

double session_clock(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void show_event(session *s, int64_t frame, const char *kind, const char *text) {
    pthread_mutex_lock(&s->lock);
    session_snapshot *p = &s->shown;
    if (p->event_count == SESSION_EVENTS) memmove(p->events, p->events + 1, (SESSION_EVENTS - 1) * sizeof p->events[0]);
    else p->event_count++;
    session_event *e = &p->events[p->event_count - 1];
    e->frame = frame;
    snprintf(e->kind, sizeof e->kind, "%s", kind);
    snprintf(e->text, sizeof e->text, "%s", text);
    p->version++;
    pthread_mutex_unlock(&s->lock);
}

void session_tell(session *s, int64_t frame, const char *kind, const char *text) {
    report r;
    show_event(s, frame, kind, text);
    session_tolerate(s, ledger_event(s->ledger, s->id, frame, kind, text, &r), &r);
}

void session_warn(session *s, const char *text) {
    report ignored;
    int64_t frame = simulation_frame(s->simulation);
    snprintf(s->warning, sizeof s->warning, "%s", text);
    show_event(s, frame, "warning", text);
    (void)ledger_event(s->ledger, s->id, frame, "warning", text, &ignored);
}

void session_tolerate(session *s, status code, const report *r) {
    if (code == STATUS_OK) return;
    char text[sizeof s->warning];
    report_format(r, text, sizeof text);
    snprintf(s->warning, sizeof s->warning, "ledger: %.480s", text);
}

static void log_frame(session *s, double seconds) {
    const solid_measures *m = &s->measures.solid;
    const ledger_value values[] = {
        {"kinetic", m->kinetic}, {"elastic", m->elastic}, {"fibre", m->fibre}, {"gravitational", m->gravitational},
        {"grip_work", m->grip_work}, {"dissipated", s->measures.dissipated}, {"damage_mean", m->damage_mean},
        {"damage_max", m->damage_max}, {"broken_fraction", m->broken_fraction},
        {"crack_normal_x", s->measures.has_crack ? s->measures.crack_normal[0] : NAN},
        {"crack_normal_y", s->measures.has_crack ? s->measures.crack_normal[1] : NAN},
        {"crack_normal_z", s->measures.has_crack ? s->measures.crack_normal[2] : NAN},
        {"determinant_min", m->determinant_min}, {"determinant_max", m->determinant_max}, {"speed_max", m->speed_max},
        {"fibre_stretch_min", m->stretch_min}, {"fibre_stretch_max", m->stretch_max},
        {"dt_min", s->measures.dt_min}, {"mass", m->mass},
        {"momentum_x", m->momentum[0]}, {"momentum_y", m->momentum[1]}, {"momentum_z", m->momentum[2]},
        {"angular_momentum_x", m->angular_momentum[0]}, {"angular_momentum_y", m->angular_momentum[1]},
        {"angular_momentum_z", m->angular_momentum[2]},
        {"grip_impulse_x", m->grip_impulse[0]}, {"grip_impulse_y", m->grip_impulse[1]}, {"grip_impulse_z", m->grip_impulse[2]},
        {"bond_stretch_max", s->measures.has_sheet ? s->measures.sheet.stretch_max : NAN},
        {"diffused_total", s->measures.has_sheet ? s->measures.sheet.diffused_total : NAN},
    };
    report r;
    session_tolerate(s, ledger_frame(s->ledger, s->id, s->measures.frame, s->measures.time, s->measures.steps, seconds, values,
                                     sizeof values / sizeof *values, &r), &r);
    if (m->damage_max > 0.9 && !s->first_crack_told) {
        char text[96];
        s->first_crack_told = true;
        snprintf(text, sizeof text, "first particle over 0.9 at t = %.6g", s->measures.time);
        session_tell(s, s->measures.frame, "first_crack", text);
    }
}

static void take_sample(session *s, double seconds) {
    const solid_measures *m = &s->measures.solid;
    s->sample = (session_sample){.frame = s->measures.frame, .step = s->measures.steps, .time = s->measures.time, .seconds = seconds,
                                 .wall = session_clock() - s->wall_start, .kinetic = m->kinetic,
                                 .elastic = m->elastic, .fibre = m->fibre, .work = m->grip_work, .damage_mean = m->damage_mean,
                                 .damage_max = m->damage_max, .broken_fraction = m->broken_fraction, .dt = s->measures.dt_min};
    memcpy(s->sample.histogram, m->histogram, sizeof s->sample.histogram);
}

static frame_header header_of(const session *s) {
    const simulation_plan *plan = simulation_get_plan(s->simulation);
    return (frame_header){.frame = simulation_frame(s->simulation), .step = simulation_steps(s->simulation),
                          .time = simulation_time(s->simulation), .run_id = s->id, .units = s->scene->units,
                          .scene_title = s->scene->title, .scene_hash = s->hash, .version = SUNDER_VERSION,
                          .precision = plan->precision == 32 ? "f32" : "f64", .simd = plan->simd};
}

static status write_frame(session *s, report *r) {
    record_list records = {0};
    frame_header header = header_of(s);
    status code = simulation_frame_records(s->simulation, &records, r);
    if (code == STATUS_OK) code = frame_write(s->folder, &header, &records, s->options.deflate, r);
    record_clear(&records);
    return code;
}

/* Thins older checkpoints when the new one is safe. */
static status thin_checkpoints(session *s, report *r) {
    if (s->options.keep_bytes <= 0) return s->options.keep > 0 ? checkpoint_thin(s->folder, s->options.keep, r) : STATUS_OK;
    int64_t over;
    char text[160];
    status code = checkpoint_ring(s->folder, s->options.keep_bytes, &over, r);
    if (code != STATUS_OK || over == 0 || s->ring_told) return code;
    s->ring_told = true;
    snprintf(text, sizeof text, "the first checkpoint and the two newest are kept, %.0f bytes more than --keep allows", (double)over);
    session_warn(s, text);
    return STATUS_OK;
}

static status write_checkpoint(session *s, report *r) {
    record_list records = {0};
    frame_header header = header_of(s);
    status code = simulation_save(s->simulation, &records, r);
    if (code == STATUS_OK) code = turns_save(s, &records, r);
    if (code == STATUS_OK) code = checkpoint_write(s->folder, &header, &records, r);
    record_clear(&records);
    return code == STATUS_OK ? thin_checkpoints(s, r) : code;
}

/* A branch has its past from its parent: its frames are there, and its rows. What it needs of its own is a checkpoint where it begins. */
static status file_past(session *s, report *r) {
    int64_t frame = s->measures.frame;
    status code = frame_exists(s->folder, frame) ? STATUS_OK : write_frame(s, r);
    bool due = s->options.checkpoint_every > 0 && (frame == s->past_from || frame == s->past_until) && !checkpoint_exists(s->folder, frame);
    return code == STATUS_OK && due ? write_checkpoint(s, r) : code;
}

static status file_frame(session *s, double seconds, report *r) {
    if (s->measures.frame <= s->past_until) return file_past(s, r);
    status code = write_frame(s, r);
    if (code != STATUS_OK) return code;
    log_frame(s, seconds);
    int every = s->options.checkpoint_every;
    bool due = every > 0 && (s->measures.frame % every == 0 || s->measures.frame == s->target || atomic_load(&s->stop));
    return due ? write_checkpoint(s, r) : STATUS_OK;
}

/* Measures the state that has been reached, files it (unless a resumed run's folder has it), shows it. */
static status settle_frame(session *s, double seconds, bool file, report *r) {
    status code = simulation_measure(s->simulation, &s->measures, r);
    if (code != STATUS_OK) return code;
    const char *warning = simulation_take_warning(s->simulation);
    if (warning[0]) session_warn(s, warning);
    take_sample(s, seconds);
    if (!file || s->measures.frame <= s->past_until) s->first_crack_told = s->measures.solid.damage_max > 0.9;
    if (file && (code = file_frame(s, seconds, r)) != STATUS_OK) return code;
    return publish_frame(s, r);
}

/* While paused: waits for a step, an end of the pause, or a stop. True when a frame should be made. */
static bool may_go_on(session *s) {
    bool told = false;
    if (simulation_frame(s->simulation) < s->past_until && !atomic_load(&s->stop) && !atomic_load(&s->abandon))
        return true; /* a branch that was asked to begin paused does so where it begins, not where its parent's checkpoint is */
    int64_t wanted = atomic_load(&s->pause_at);
    if (wanted >= 0 && simulation_frame(s->simulation) >= wanted) {
        atomic_store(&s->paused, 1);
        atomic_store(&s->pause_at, -1);
    }
    while (atomic_load(&s->paused) && !atomic_load(&s->stop) && !atomic_load(&s->abandon)) {
        if (atomic_load(&s->steps_asked) > 0) {
            atomic_fetch_sub(&s->steps_asked, 1);
            return true;
        }
        if (!told) publish_state(s, SESSION_PAUSED);
        told = true;
        report ignored;
        if (colour_wanted(s) != s->colour_shown) (void)colour_renew(s, &ignored);
        nanosleep(&(struct timespec){.tv_nsec = 5000000}, NULL);
    }
    if (told) publish_state(s, SESSION_RUNNING);
    return !atomic_load(&s->stop) && !atomic_load(&s->abandon);
}

static status run_frames(session *s, report *r) {
    bool resumed = s->options.resume != NULL;
    status code = settle_frame(s, 0, !resumed, r);
    while (code == STATUS_OK && simulation_frame(s->simulation) < s->target) {
        if (!may_go_on(s))
            return report_set(r, STATUS_INTERRUPTED, "interrupted after frame %lld of %lld", (long long)simulation_frame(s->simulation),
                              (long long)s->target);
        code = turns_act(s, r);
        if (code != STATUS_OK) return code;
        double start = session_clock();
        code = simulation_advance(s->simulation, &s->abandon, r);
        double seconds = session_clock() - start;
        s->step_wall += seconds;
        if (s->last_frame_wall == 0) s->last_frame_wall = seconds; /* the first frame's, until its writing is known too */
        if (code == STATUS_INTERRUPTED)
            s->unfinished = (session_unfinished){.steps = simulation_steps(s->simulation) - s->measures.steps,
                                                 .time = simulation_time(s->simulation) - s->measures.time, .seconds = seconds};
        if (code == STATUS_OK) code = settle_frame(s, seconds, true, r);
        s->last_frame_wall = session_clock() - start;
    }
    return code;
}

static void finish(session *s) {
    report r;
    char message[768] = "";
    if (s->outcome != STATUS_OK) report_format(&s->report, message, sizeof message);
    const char *word = s->outcome == STATUS_OK ? "done" : s->outcome == STATUS_INTERRUPTED ? "interrupted" : "failed";
    status code = summary_write(s, &r);
    if (code != STATUS_OK && s->outcome == STATUS_OK) s->outcome = code, s->report = r;
    code = ledger_finish(s->ledger, s->id, word, simulation_frame(s->simulation), simulation_steps(s->simulation),
                         session_clock() - s->wall_start, message[0] ? message : NULL, s->summary.text, &r);
    if (code != STATUS_OK && s->outcome == STATUS_OK) s->outcome = code, s->report = r;
}

void *session_loop(void *argument) {
    session *s = argument;
    report_clear(&s->report);
    s->outcome = run_frames(s, &s->report);
    finish(s);
    session_release_folder(s);
    publish_state(s, SESSION_ENDED);
    atomic_store(&s->ended, 1);
    return NULL;
}
