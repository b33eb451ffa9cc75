/* What a frame leaves goes to the disk, into the ledger and onto the screen on a thread of its own, in that order, while the next frame is
 * simulated: compressing, hashing and syncing take about as long as stepping. The state is copied first. One frame is on its way while the
 * next is gathered; a disk that is slower than the simulation holds it up then. */
#include "session/internal.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* Of solids and sheets together; NaN where nothing diffuses. */
static double diffused_total(const session *s, const simulation_measures *all) {
    const simulation_plan *p = simulation_get_plan(s->simulation);
    for (int e = 0; e < p->effect_count; e++)
        if ((p->mask >> e & 1) && strcmp(p->effects[e]->name, "diffusion") == 0) return all->solid.diffused_total + (all->has_sheet ? all->sheet.diffused_total : 0);
    return NAN;
}

static void log_frame(session *s, const filing_work *w) {
    const simulation_measures *all = &w->measures;
    const solid_measures *m = &all->solid;
    const ledger_value values[] = {
        {"kinetic", m->kinetic}, {"elastic", m->elastic}, {"fibre", m->fibre}, {"gravitational", m->gravitational},
        {"grip_work", m->grip_work}, {"dissipated", all->dissipated}, {"damage_mean", m->damage_mean},
        {"damage_max", m->damage_max}, {"broken_fraction", m->broken_fraction},
        {"crack_normal_x", all->has_crack ? all->crack_normal[0] : NAN},
        {"crack_normal_y", all->has_crack ? all->crack_normal[1] : NAN},
        {"crack_normal_z", all->has_crack ? all->crack_normal[2] : NAN},
        {"determinant_min", m->determinant_min}, {"determinant_max", m->determinant_max}, {"speed_max", m->speed_max},
        {"fibre_stretch_min", m->stretch_min}, {"fibre_stretch_max", m->stretch_max},
        {"dt_min", all->dt_min}, {"mass", m->mass},
        {"momentum_x", m->momentum[0]}, {"momentum_y", m->momentum[1]}, {"momentum_z", m->momentum[2]},
        {"angular_momentum_x", m->angular_momentum[0]}, {"angular_momentum_y", m->angular_momentum[1]},
        {"angular_momentum_z", m->angular_momentum[2]},
        {"grip_impulse_x", m->grip_impulse[0]}, {"grip_impulse_y", m->grip_impulse[1]}, {"grip_impulse_z", m->grip_impulse[2]},
        {"bond_stretch_max", all->has_sheet ? all->sheet.stretch_max : NAN},
        {"diffused_total", diffused_total(s, all)},
    };
    report r;
    pthread_mutex_lock(&s->ledger_lock);
    status code = ledger_frame(s->ledger, s->id, all->frame, all->time, all->steps, w->seconds, values, sizeof values / sizeof *values, &r);
    pthread_mutex_unlock(&s->ledger_lock);
    session_tolerate(s, code, &r);
    if (m->damage_max > 0.9 && !s->first_crack_told) {
        char text[96];
        snprintf(text, sizeof text, "first particle over 0.9 at t = %.6g", all->time);
        session_tell(s, all->frame, "first_crack", text);
    }
}

/* Thins older checkpoints when the new one is safe. */
static status thin_checkpoints(session *s, int64_t frame, report *r) {
    if (s->options.keep_bytes <= 0) return s->options.keep > 0 ? checkpoint_thin(s->folder, s->options.keep, r) : STATUS_OK;
    int64_t over;
    char text[160];
    status code = checkpoint_ring(s->folder, s->options.keep_bytes, &over, r);
    if (code != STATUS_OK || over == 0 || s->ring_told) return code;
    s->ring_told = true;
    snprintf(text, sizeof text, "the first checkpoint and the two newest are kept, %.0f bytes more than --keep allows", (double)over);
    session_warn(s, frame, text);
    return STATUS_OK;
}

static status file_work(session *s, filing_work *w, report *r) {
    status code = STATUS_OK;
    if (w->parts & FILING_FRAME) code = frame_write(s->folder, &w->header, &w->frame, s->options.deflate, r);
    if (code == STATUS_OK && w->parts & FILING_LOG) log_frame(s, w);
    s->first_crack_told |= w->measures.solid.damage_max > 0.9;
    if (code == STATUS_OK && w->parts & FILING_CHECKPOINT) {
        code = checkpoint_write(s->folder, &w->header, &w->checkpoint, r);
        if (code == STATUS_OK) code = thin_checkpoints(s, w->header.frame, r);
    }
    if (code == STATUS_OK && w->parts & FILING_PICTURE) code = picture_show(s, &w->picture, r);
    return code;
}

void filing_clear(filing_work *w) {
    record_clear(&w->frame);
    record_clear(&w->checkpoint);
    picture_free(&w->picture);
}

static void *filing_loop(void *argument) {
    session *s = argument;
    filing *f = &s->filing;
    report r;
    pthread_mutex_lock(&f->lock);
    for (;;) {
        while (!f->busy && !f->ending) pthread_cond_wait(&f->changed, &f->lock);
        if (!f->busy) break;
        pthread_mutex_unlock(&f->lock);
        status code = file_work(s, &f->work, &r); /* nobody else looks at the work while busy */
        filing_clear(&f->work);
        pthread_mutex_lock(&f->lock);
        if (code != STATUS_OK && f->outcome == STATUS_OK) f->outcome = code, f->report = r;
        f->busy = false;
        pthread_cond_broadcast(&f->changed);
    }
    pthread_mutex_unlock(&f->lock);
    return NULL;
}

status filing_start(session *s, report *r) {
    if (pthread_create(&s->filing.thread, NULL, filing_loop, s) != 0) return report_set(r, STATUS_SYSTEM, "no thread for writing frames");
    s->filing.threaded = true;
    return STATUS_OK;
}

static status await_rest(filing *f, report *r) {
    while (f->busy) pthread_cond_wait(&f->changed, &f->lock);
    if (f->outcome != STATUS_OK) *r = f->report;
    return f->outcome;
}

status filing_wait(session *s, report *r) {
    pthread_mutex_lock(&s->filing.lock);
    status code = await_rest(&s->filing, r);
    pthread_mutex_unlock(&s->filing.lock);
    return code;
}

status filing_hand_over(session *s, filing_work *w, report *r) {
    filing *f = &s->filing;
    pthread_mutex_lock(&f->lock);
    status code = await_rest(f, r);
    if (code == STATUS_OK) {
        f->work = *w;
        f->busy = true;
        pthread_cond_broadcast(&f->changed);
    }
    pthread_mutex_unlock(&f->lock);
    if (code != STATUS_OK) filing_clear(w);
    return code;
}

void filing_end(session *s) {
    filing *f = &s->filing;
    if (!f->threaded) return;
    pthread_mutex_lock(&f->lock);
    f->ending = true;
    pthread_cond_broadcast(&f->changed);
    pthread_mutex_unlock(&f->lock);
    pthread_join(f->thread, NULL);
    f->threaded = false;
}
