/* How long a scene's frames take: a run as `sunder run` makes it, into a folder that is thrown away. */
#ifndef SUNDER_CLI_TIME_SCENE_H
#define SUNDER_CLI_TIME_SCENE_H

#include "script/script.h"

#include <stdbool.h>
#include <stdint.h>

enum { SCENE_TIMING_FRAMES = 511 }; /* warm and timed together */

typedef struct scene_timing_request {
    const char *scene;
    const script_setting *settings; /* [setting_count] */
    int setting_count;
    int threads, precision;
    int warm, frames; /* frames passed over; frames timed, at least 1: always the last ones, wherever the limit stops the run */
    double limit;     /* seconds after the initial state is on disk; the run is then left between two steps */
} scene_timing_request;

typedef struct scene_timing {
    int64_t particles;
    int threads;
    char simd[16];
    int warm, frames;       /* whole frames passed over and timed: fewer than wanted when the limit came first */
    bool limited;           /* it did */
    bool extrapolated;      /* before the first whole frame: all below are that frame's steps, over the share of it that they cover */
    double seconds;         /* of a frame's steps: the median of the frames timed */
    double seconds_mean;
    double seconds_a_step;  /* the median of the frames' means */
    double run_seconds;     /* from frame to frame, with measures, files and ledger: the median; NAN when extrapolated */
    double setup_seconds;   /* before the first step: script, sampling, fibres, initial measures */
    double steps, dt;       /* a frame's, on average; simulated time over steps */
    double damage_max, broken_fraction; /* after the last frame timed */
    char warning[768];      /* the simulation's last; "" */
} scene_timing;

/* Runs and times. At a limit without a whole frame the first one's steps are extrapolated. Errors: those of the scene and of the run;
 * a limit before the first step; STATUS_INTERRUPTED after SIGINT or SIGTERM, which are caught from the first call on. */
status scene_time(const scene_timing_request *q, scene_timing *out, script_reports *reports);

/* The step limit of a scene's initial state, cfl included, and the effect that sets it (a constant text). Errors: those of the scene. */
status scene_step_limit(const scene_timing_request *q, double *dt, const char **limiting, script_reports *reports);

#endif
