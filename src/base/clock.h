/* Time that passes, for whoever measures it. */
#ifndef SUNDER_BASE_CLOCK_H
#define SUNDER_BASE_CLOCK_H

/* Seconds of a clock that only goes forwards; its zero is arbitrary. Any thread. */
double clock_seconds(void);

#endif
