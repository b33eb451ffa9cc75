/* Runs for studies: a list of them, made in this process one after another or some at a time, each into the ledger with a tag. */
#ifndef SUNDER_STUDY_RUN_H
#define SUNDER_STUDY_RUN_H

#include "base/status.h"
#include "script/script.h"
#include "store/ledger.h"

#include <stdbool.h>
#include <stdint.h>

enum { STUDY_TAG = 64, STUDY_JOBS = 16, STUDY_MESSAGE = 512 };

/* What all runs of a study have in common. */
typedef struct study_common {
    const char *database; /* the ledger's path */
    const char *tag;      /* every run gets it as soon as it has begun; NULL: none */
    const char *command;  /* the command line, for the ledger */
    const char *simd;     /* "auto" or a name */
    int threads;          /* of each run; 0: all processors */
    int jobs;             /* so many at a time, 1 to STUDY_JOBS */
} study_common;

typedef struct study_request {
    const char *scene, *recipe;      /* recipe may be NULL */
    const script_setting *settings;  /* [setting_count] */
    int setting_count, precision;    /* 32 or 64 */
    int64_t frames;                  /* −1: the scene's */
    const char *output;              /* the run's folder; NULL: the ledger's own */
} study_request;

typedef struct study_result {
    bool begun;                  /* it has a row in the ledger */
    status outcome;              /* STATUS_INTERRUPTED too when it never began because the study was stopped */
    char id[LEDGER_ID], message[STUDY_MESSAGE]; /* message: why it failed; "" */
    char folder[1024];
    int64_t particles, steps;
    double step_seconds, seconds; /* of steps alone; of the whole run */
} study_result;

/* Told before a run begins and after it has ended. */
typedef void (*study_teller)(void *context, int index, const study_result *result, bool ended);

/* Makes requests [count], which give results [count]. A run that fails does not stop the others: its result says so. Interrupted by
 * study_stop: those going on end after their frame, the others never begin, and STATUS_INTERRUPTED is returned. Other errors: none. */
status study_runs_make(const study_common *common, const study_request *requests, study_result *results, int count, study_teller tell, void *context, report *r);

/* Stops the study that is going on in this process, after the frames that are being made; a second call, after their steps. May be called from a
 * signal handler and from any thread. */
void study_stop(void);
bool study_stopped(void);

/* A path's last part without its ending, as a tag may have it: "tube_pull" of "scenes/solid/tube_pull.lua". */
void study_name(const char *path, char name[48]);

#endif
