/* The loop of a run: a frame, its measures, its file, its ledger row. */
#include "base/clock.h"
#include "session/internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

static void show_event(session *s, int64_t frame, const char *kind, const char *text) {
    pthread_mutex_lock(&s->lock);
    session_snapshot *p = &s->shown;
    if (p->event_count == SESSION_EVENTS) memmove(p->events, p->events + 1, (SESSION_EVENTS - 1) * sizeof p->events[0]);
    else p->event_count++;
    p->event_total++;
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
    pthread_mutex_lock(&s->ledger_lock);
    status code = ledger_event(s->ledger, s->id, frame, kind, text, &r);
    pthread_mutex_unlock(&s->ledger_lock);
    session_tolerate(s, code, &r);
}

/* Returns whether it is another than the last one; *frame: the one shown. */
static bool set_warning(session *s, const char *text, int64_t *frame) {
    pthread_mutex_lock(&s->lock);
    bool another = strcmp(s->warning, text) != 0;
    snprintf(s->warning, sizeof s->warning, "%s", text);
    *frame = s->shown.frame;
    pthread_mutex_unlock(&s->lock);
    return another;
}

void session_warn(session *s, int64_t frame, const char *text) {
    report ignored;
    int64_t shown;
    (void)set_warning(s, text, &shown);
    show_event(s, frame, "warning", text);
    pthread_mutex_lock(&s->ledger_lock);
    (void)ledger_event(s->ledger, s->id, frame, "warning", text, &ignored);
    pthread_mutex_unlock(&s->ledger_lock);
}

void session_tolerate(session *s, status code, const report *r) {
    if (code == STATUS_OK) return;
    char text[sizeof s->warning] = "ledger: ";
    size_t used = strlen(text);
    report_format(r, text + used, sizeof text - used);
    int64_t frame;
    if (set_warning(s, text, &frame)) show_event(s, frame, "warning", text);
}

static void take_sample(session *s, double seconds) {
    const solid_measures *m = &s->measures.solid;
    s->sample = (session_sample){.frame = s->measures.frame, .step = s->measures.steps, .time = s->measures.time, .seconds = seconds,
                                 .wall = clock_seconds() - s->wall_start, .kinetic = m->kinetic,
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

static status gather_checkpoint(session *s, filing_work *w, report *r) {
    w->parts |= FILING_CHECKPOINT;
    s->checkpointed = w->header.frame;
    s->checkpointed_steps = w->header.step;
    status code = simulation_save(s->simulation, &w->checkpoint, r);
    return code == STATUS_OK ? turns_save(s, &w->checkpoint, r) : code;
}

/* A branch has its past from its parent: its frames are there, and its rows. What it needs of its own is a checkpoint where it begins. */
static int past_parts(const session *s) {
    int64_t frame = s->measures.frame;
    bool due = s->options.checkpoint_every != 0 && (frame == s->past_from || frame == s->past_until) && !checkpoint_exists(s->folder, frame);
    return (frame_exists(s->folder, frame) ? 0 : FILING_FRAME) | (due ? FILING_CHECKPOINT : 0);
}

static bool checkpoint_due(const session *s) {
    const session_options *o = &s->options;
    if (o->checkpoint_every == 0) return false;
    if (s->measures.frame == s->target || atomic_load(&s->stop)) return true;
    if (o->checkpoint_every > 0) return s->measures.frame % o->checkpoint_every == 0;
    bool to_resume_only = o->keep > 0 && o->keep_bytes <= 0;
    return !to_resume_only || s->checkpointed < 0 || s->measures.steps - s->checkpointed_steps >= SESSION_CHECKPOINT_STEPS;
}

static int due_parts(const session *s) {
    if (s->measures.frame <= s->past_until) return past_parts(s);
    return FILING_FRAME | FILING_LOG | (checkpoint_due(s) ? FILING_CHECKPOINT : 0);
}

static status gather(session *s, int parts, filing_work *w, report *r) {
    w->parts = (parts & ~FILING_CHECKPOINT) | FILING_PICTURE;
    status code = parts & FILING_FRAME ? simulation_frame_records(s->simulation, &w->frame, r) : STATUS_OK;
    if (code == STATUS_OK && parts & FILING_CHECKPOINT) code = gather_checkpoint(s, w, r);
    return code == STATUS_OK ? picture_take(s, &w->picture, r) : code;
}

/* Measures the state that has been reached and hands it over to be filed (unless a resumed run's folder has it) and shown. */
static status settle_frame(session *s, double seconds, bool file, report *r) {
    status code = simulation_measure(s->simulation, &s->measures, r);
    if (code != STATUS_OK) return code;
    const char *warning = simulation_take_warning(s->simulation);
    if (warning[0]) session_warn(s, s->measures.frame, warning);
    take_sample(s, seconds);
    if (!file) s->checkpointed = s->measures.frame, s->checkpointed_steps = s->measures.steps; /* a resumed run comes from there */
    filing_work w = {.header = header_of(s), .measures = s->measures, .seconds = seconds};
    code = gather(s, file ? due_parts(s) : 0, &w, r);
    if (code == STATUS_OK) return filing_hand_over(s, &w, r);
    filing_clear(&w);
    return code;
}

/* A run that is stopped between two checkpoints leaves one where it stops. */
static status settle_stop(session *s, report *r) {
    int64_t frame = simulation_frame(s->simulation);
    if (s->options.checkpoint_every == 0 || atomic_load(&s->abandon) || s->checkpointed == frame || frame <= s->past_until) return STATUS_OK;
    filing_work w = {.header = header_of(s), .measures = s->measures};
    status code = gather_checkpoint(s, &w, r);
    if (code == STATUS_OK) return filing_hand_over(s, &w, r);
    filing_clear(&w);
    return code;
}

/* While paused: waits for a step, an end of the pause, or a stop. True when a frame should be made. Who finds a run paused finds its frame filed. */
static bool may_go_on(session *s, status *filed, report *r) {
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
        if (!told && (*filed = filing_wait(s, r)) != STATUS_OK) return false;
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
        if (!may_go_on(s, &code, r)) {
            if (code == STATUS_OK) code = settle_stop(s, r);
            if (code != STATUS_OK) return code;
            return report_set(r, STATUS_INTERRUPTED, "interrupted after frame %lld of %lld", (long long)simulation_frame(s->simulation),
                              (long long)s->target);
        }
        code = turns_act(s, r);
        if (code != STATUS_OK) return code;
        double start = clock_seconds();
        code = simulation_advance(s->simulation, &s->abandon, r);
        double seconds = clock_seconds() - start;
        s->step_wall += seconds;
        if (s->last_frame_wall == 0) s->last_frame_wall = seconds; /* the first frame's, until its writing is known too */
        if (code == STATUS_INTERRUPTED)
            s->unfinished = (session_unfinished){.steps = simulation_steps(s->simulation) - s->measures.steps,
                                                 .time = simulation_time(s->simulation) - s->measures.time, .seconds = seconds};
        if (code == STATUS_OK) code = settle_frame(s, seconds, true, r);
        s->last_frame_wall = clock_seconds() - start;
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
                         clock_seconds() - s->wall_start, message[0] ? message : NULL, s->summary.text, &r);
    if (code != STATUS_OK && s->outcome == STATUS_OK) s->outcome = code, s->report = r;
}

void *session_loop(void *argument) {
    session *s = argument;
    report trouble;
    report_clear(&s->report);
    s->outcome = filing_start(s, &s->report);
    if (s->outcome == STATUS_OK) s->outcome = run_frames(s, &s->report);
    status filed = filing_wait(s, &trouble);
    if (filed != STATUS_OK && (s->outcome == STATUS_OK || s->outcome == STATUS_INTERRUPTED)) s->outcome = filed, s->report = trouble;
    filing_end(s);
    finish(s);
    session_release_folder(s);
    publish_state(s, SESSION_ENDED);
    atomic_store(&s->ended, 1);
    return NULL;
}
