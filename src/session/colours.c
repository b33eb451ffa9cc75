/* What pictures are coloured by: chosen from any thread, read by the simulation's. */
#include "base/memory.h"
#include "base/names.h"
#include "session/internal.h"

#include <stdio.h>
#include <string.h>

int session_colours(session *s, char (*names)[32], int limit) {
    for (int i = 0; i < s->scalar_count && i < limit; i++) memcpy(names[i], s->scalars[i].name, sizeof names[i]);
    return s->scalar_count;
}

status session_colour(session *s, const char *name, report *r) {
    const char *names[SESSION_COLOURS];
    for (int i = 0; i < s->scalar_count; i++) {
        names[i] = s->scalars[i].name;
        if (strcmp(names[i], name) != 0) continue;
        pthread_mutex_lock(&s->lock);
        s->colour_wanted = i;
        pthread_mutex_unlock(&s->lock);
        /* The simulation is nobody's any more: whoever asks may read it. */
        return atomic_load(&s->ended) ? colour_renew(s, r) : STATUS_OK;
    }
    return report_input(r, NULL, 0, "colour", "a field with one number a particle that this run has", name, name_nearest(name, names, s->scalar_count));
}

void colour_begin(session *s) {
    s->scalar_count = simulation_scalars(s->simulation, s->scalars, SESSION_COLOURS);
    if (s->scalar_count > SESSION_COLOURS) s->scalar_count = SESSION_COLOURS;
    s->colour_shown = -1;
}

int colour_wanted(session *s) {
    pthread_mutex_lock(&s->lock);
    int wanted = s->colour_wanted;
    pthread_mutex_unlock(&s->lock);
    return wanted;
}

status colour_read(session *s, int which, double *out, report *r) {
    return simulation_read_scalar(s->simulation, s->scalars[which].name, out, r);
}

/* What colours run over grows with what is seen, so that they do not flicker from frame to frame. */
static void widen(session_snapshot *p, const simulation_scalar *scalar, bool fresh) {
    snprintf(p->colour, sizeof p->colour, "%s", scalar->name);
    snprintf(p->colour_unit, sizeof p->colour_unit, "%s", scalar->unit);
    if (fresh || p->scalar_minimum < p->colour_minimum) p->colour_minimum = p->scalar_minimum;
    if (fresh || p->scalar_maximum > p->colour_maximum) p->colour_maximum = p->scalar_maximum;
    if (scalar->share) p->colour_minimum = 0, p->colour_maximum = 1;
}

void colour_fill(session *s, int which, const double *values) {
    session_snapshot *p = &s->shown;
    for (int64_t i = 0; i < p->point_count; i++) {
        float value = (float)values[i];
        p->scalar[i] = value;
        if (i == 0 || value < p->scalar_minimum) p->scalar_minimum = value;
        if (i == 0 || value > p->scalar_maximum) p->scalar_maximum = value;
    }
    widen(p, &s->scalars[which], which != s->colour_shown);
    s->colour_shown = which;
}

status colour_renew(session *s, report *r) {
    int which = colour_wanted(s);
    size_t bytes = (size_t)s->shown.particles * sizeof(double);
    double *values = memory_allocate(bytes);
    status code = values ? colour_read(s, which, values, r) : report_set(r, STATUS_SYSTEM, "out of memory for the picture's colours");
    if (code == STATUS_OK) {
        pthread_mutex_lock(&s->lock);
        if (s->shown.point_count == s->shown.particles) colour_fill(s, which, values);
        s->shown.version++;
        pthread_mutex_unlock(&s->lock);
    }
    memory_free(values, bytes);
    return code;
}
