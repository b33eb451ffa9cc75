/* A synthetic session behind session.h: a tube that is pulled, tears and parts, without a simulation. */
#ifndef SUNDER_TESTS_TUI_FAKE_SESSION_H
#define SUNDER_TESTS_TUI_FAKE_SESSION_H

#include "session/session.h"

typedef struct fake_options {
    int64_t particles, frames;
    double frame_seconds; /* wall time of one frame */
    const char *hold;     /* a file: as long as it exists, no frame but the initial one is finished; NULL: none */
    int64_t fail_at;      /* frame at which it diverges; −1: never */
    int64_t crash_at;     /* frame at which the simulating thread raises crash_signal; −1: never */
    int crash_signal;
    bool prints; /* writes a line to standard error and one to standard output each frame, as a library might */
    bool start_paused;
    bool warns;     /* carries a warning from the fifth frame on */
    bool torn;      /* is torn from the first frame on */
    bool undamaged; /* a scene without the damage effect */
} fake_options;

/* Starts it; NULL when out of memory. */
session *fake_session_start(const fake_options *options);

#endif
