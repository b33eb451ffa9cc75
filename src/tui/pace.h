/* When the screen is drawn: at most 30 times a second, seldom enough that drawing takes little from the cores that simulate, and soon after a key.
 * Times are seconds of one clock, which the caller reads. */
#ifndef SUNDER_TUI_PACE_H
#define SUNDER_TUI_PACE_H

#include <stdbool.h>

typedef struct tui_pace {
    double last; /* when it was drawn last; 0: never */
    double next; /* when it may be drawn again, unless a key comes */
} tui_pace;

extern const double pace_frame; /* s; the least between two redraws */
extern const double pace_share; /* of a core that drawing may take when nobody presses keys: a step waits for its slowest thread */

/* Something is to be drawn: whether now. */
bool pace_due(const tui_pace *p, double now);

/* A key has come: its effect waits for no share, only for the redraw that may just have been. */
void pace_key(tui_pace *p, double now);

/* It was drawn from `start` to `end`. */
void pace_drawn(tui_pace *p, double start, double end);

/* Seconds to wait for input: no longer than `most`, and when something is to be drawn no longer than until that is due. */
double pace_wait(const tui_pace *p, double now, double most, bool dirty);

#endif
