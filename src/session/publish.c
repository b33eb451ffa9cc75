/* What screens see: a snapshot that the loop refreshes and anyone may copy. */
#include "base/clock.h"
#include "base/memory.h"
#include "session/internal.h"

#include <stdio.h>
#include <string.h>

void publish_start(session *s) {
    session_snapshot *p = &s->shown;
    const simulation_plan *plan = simulation_get_plan(s->simulation);
    snprintf(p->run_id, sizeof p->run_id, "%s", s->id);
    snprintf(p->title, sizeof p->title, "%s", s->scene->title);
    snprintf(p->output, sizeof p->output, "%.511s", s->folder);
    snprintf(p->precision, sizeof p->precision, "f%d", plan->precision);
    snprintf(p->simd, sizeof p->simd, "%s", plan->simd);
    for (int i = 0; i < s->scene->parameter_count; i++)
        if (strcmp(s->scene->parameters[i].name, "variant") == 0)
            snprintf(p->variant, sizeof p->variant, "%.63s", s->scene->parameters[i].text);
    for (int e = 0; e < plan->effect_count && p->effect_count < SESSION_EFFECTS; e++)
        if (plan->mask >> e & 1) snprintf(p->effects[p->effect_count++], sizeof p->effects[0], "%s", plan->effects[e]->name);
    colour_begin(s);
    p->pause_at = -1;
    snprintf(p->parent, sizeof p->parent, "%.39s", s->parent);
    p->parent_frame = s->past_until;
    p->threads = plan->threads;
    p->particles = plan->particles;
    p->frames = s->target;
    p->duration = (double)s->target / s->scene->fps;
}

/* Everything of the snapshot that changes between frames but what the simulation's thread alone knows; the caller holds the lock. */
static void refresh(session *s, session_state state) {
    session_snapshot *p = &s->shown;
    p->version++;
    p->state = state;
    snprintf(p->message, sizeof p->message, "%s", s->warning);
    p->wall = clock_seconds() - s->wall_start;
    p->pause_at = atomic_load(&s->pause_at);
    p->knob_version = s->knobs.version;
}

void publish_state(session *s, session_state state) {
    pthread_mutex_lock(&s->lock);
    session_snapshot *p = &s->shown;
    refresh(s, state);
    p->outcome = s->outcome;
    if (state == SESSION_ENDED && s->outcome != STATUS_OK) report_format(&s->report, p->message, sizeof p->message);
    p->step_wall = s->step_wall;
    p->unfinished = s->unfinished;
    p->turn_count = s->knobs.acted;
    pthread_mutex_unlock(&s->lock);
}

static status reserve_points(session_snapshot *p, int64_t count, report *r) {
    if (count <= p->point_capacity) return STATUS_OK;
    session_snapshot_free(p);
    size_t n = (size_t)count;
    p->point_capacity = count;
    p->position = memory_allocate_array(n, 3 * sizeof *p->position);
    p->scalar = memory_allocate_array(n, sizeof *p->scalar);
    p->body = memory_allocate_array(n, sizeof *p->body);
    if (p->position && p->scalar && p->body) return STATUS_OK;
    session_snapshot_free(p);
    return report_set(r, STATUS_SYSTEM, "out of memory for the picture of %lld points", (long long)count);
}

void session_snapshot_free(session_snapshot *p) {
    size_t n = (size_t)p->point_capacity;
    memory_free(p->position, n * 3 * sizeof *p->position);
    memory_free(p->scalar, n * sizeof *p->scalar);
    memory_free(p->body, n * sizeof *p->body);
    p->position = p->scalar = NULL;
    p->body = NULL;
    p->point_capacity = p->point_count = 0;
}

static void push_history(session_snapshot *p, const session_sample *sample) {
    if (p->history_count == SESSION_HISTORY)
        memmove(p->history, p->history + 1, (SESSION_HISTORY - 1) * sizeof p->history[0]);
    else
        p->history_count++;
    p->history[p->history_count - 1] = *sample;
}

static void fill_bounds(session_snapshot *p) {
    for (int c = 0; c < 3; c++) p->bounds_minimum[c] = p->bounds_maximum[c] = p->position[c];
    for (int64_t i = 0; i < p->point_count; i++)
        for (int c = 0; c < 3; c++) {
            float x = p->position[3 * i + c];
            if (x < p->bounds_minimum[c]) p->bounds_minimum[c] = x;
            if (x > p->bounds_maximum[c]) p->bounds_maximum[c] = x;
        }
}

static void fill_points(session *s, const double *position) {
    session_snapshot *p = &s->shown;
    bool first = p->point_count == 0;
    p->point_count = p->particles;
    const uint8_t *body = simulation_bodies(s->simulation);
    for (int64_t i = 0; i < p->point_count; i++) {
        for (int c = 0; c < 3; c++) p->position[3 * i + c] = (float)position[3 * i + c];
        p->body[i] = body[i];
    }
    if (first) fill_bounds(p);
}

static void take_stages(const session *s, session_picture *p) {
    simulation_effort all[SESSION_STAGES];
    int count = simulation_efforts(s->simulation, all, SESSION_STAGES);
    double sum = 0;
    p->stage_count = count < SESSION_STAGES ? count : SESSION_STAGES;
    for (int i = 0; i < p->stage_count; i++) sum += all[i].part ? 0 : all[i].seconds;
    for (int i = 0; i < p->stage_count; i++) {
        p->stages[i] = (session_stage){.seconds = all[i].seconds, .share = sum > 0 ? all[i].seconds / sum : 0, .part = all[i].part};
        memcpy(p->stages[i].name, all[i].name, sizeof all[i].name);
    }
}

status picture_take(session *s, session_picture *p, report *r) {
    size_t n = (size_t)simulation_get_plan(s->simulation)->particles;
    *p = (session_picture){.particles = (int64_t)n, .colour = colour_wanted(s), .frame = simulation_frame(s->simulation),
                           .state = atomic_load(&s->paused) ? SESSION_PAUSED : SESSION_RUNNING, .step = simulation_steps(s->simulation),
                           .time = simulation_time(s->simulation), .dt_min = s->measures.dt_min, .dt_max = s->measures.dt_max,
                           .seconds_per_frame = s->last_frame_wall, .step_wall = s->step_wall, .turns = s->knobs.acted, .sample = s->sample};
    p->position = memory_allocate_array(n, 3 * sizeof *p->position);
    p->scalar = memory_allocate_array(n, sizeof *p->scalar);
    if (!p->position || !p->scalar) return report_set(r, STATUS_SYSTEM, "out of memory for the picture");
    simulation_read(s->simulation, "position", p->position);
    take_stages(s, p);
    return colour_read(s, p->colour, p->scalar, r);
}

void picture_free(session_picture *p) {
    size_t n = (size_t)p->particles;
    memory_free(p->position, n * 3 * sizeof *p->position);
    memory_free(p->scalar, n * sizeof *p->scalar);
    p->position = p->scalar = NULL;
}

static void fill_numbers(session *s, const session_picture *from) {
    session_snapshot *p = &s->shown;
    p->frame = from->frame;
    p->step = from->step;
    p->time = from->time;
    p->dt = from->sample.dt;
    p->dt_min = from->dt_min;
    p->dt_max = from->dt_max;
    p->now = from->sample;
    p->seconds_per_frame = from->seconds_per_frame;
    p->seconds_left = from->seconds_per_frame * (double)(s->target - p->frame);
    p->step_wall = from->step_wall;
    p->turn_count = from->turns;
    p->stage_count = from->stage_count;
    memcpy(p->stages, from->stages, sizeof p->stages);
}

status picture_show(session *s, const session_picture *p, report *r) {
    pthread_mutex_lock(&s->lock);
    status code = reserve_points(&s->shown, s->shown.particles, r);
    if (code == STATUS_OK) {
        fill_points(s, p->position);
        colour_fill(s, p->colour, p->scalar);
    }
    fill_numbers(s, p);
    push_history(&s->shown, &p->sample);
    refresh(s, p->state);
    pthread_mutex_unlock(&s->lock);
    return code;
}

/* Copies arrays into the reader's own, which keep their capacity from poll to poll. */
static bool copy_points(session_snapshot *to, const session_snapshot *from, session_snapshot kept) {
    to->position = kept.position;
    to->scalar = kept.scalar;
    to->body = kept.body;
    to->point_capacity = kept.point_capacity;
    report r;
    if (reserve_points(to, from->point_count, &r) != STATUS_OK) {
        to->point_count = 0;
        return false;
    }
    memcpy(to->position, from->position, (size_t)from->point_count * 3 * sizeof *to->position);
    memcpy(to->scalar, from->scalar, (size_t)from->point_count * sizeof *to->scalar);
    memcpy(to->body, from->body, (size_t)from->point_count * sizeof *to->body);
    to->point_count = from->point_count;
    return true;
}

bool session_poll(session *s, session_snapshot *snapshot) {
    pthread_mutex_lock(&s->lock);
    bool fresh = s->shown.version != snapshot->version;
    if (fresh) {
        session_snapshot kept = *snapshot;
        *snapshot = s->shown;
        if (s->shown.point_count > 0) copy_points(snapshot, &s->shown, kept);
        else snapshot->position = kept.position, snapshot->scalar = kept.scalar, snapshot->body = kept.body, snapshot->point_capacity = kept.point_capacity;
    }
    pthread_mutex_unlock(&s->lock);
    return fresh;
}
