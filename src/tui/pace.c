#include "tui/pace.h"

#include <math.h>

const double pace_frame = 1.0 / 30, pace_share = 0.03;

bool pace_due(const tui_pace *p, double now) {
    return now >= p->next;
}

void pace_key(tui_pace *p, double now) {
    p->next = fmin(p->next, fmax(now, p->last + pace_frame));
}

void pace_drawn(tui_pace *p, double start, double end) {
    p->last = start;
    p->next = start + fmax(pace_frame, (end - start) / pace_share);
}

double pace_wait(const tui_pace *p, double now, double most, bool dirty) {
    return fmax(dirty ? fmin(most, p->next - now) : most, 0);
}
