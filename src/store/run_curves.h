/* Numbers of runs as curves: a measure over the frames of a run, or the last frame's measure of each run over one of its parameters. */
#ifndef SUNDER_STORE_RUN_CURVES_H
#define SUNDER_STORE_RUN_CURVES_H

#include "store/ledger.h"

typedef struct run_curve {
    double *x, *y; /* [count] of capacity */
    int count, capacity;
} run_curve;

/* Time and value of a measure, frame by frame; empty when the run does not have it. Start from a zeroed curve. */
status run_curve_read(ledger *l, const char *id, const char *measure, run_curve *out, report *r);

/* The parameter (x) and the last frame's measure (y) of a run, appended; nothing when it lacks one or the parameter is a text. */
status run_curve_point(ledger *l, const char *id, const char *parameter, const char *measure, run_curve *out, report *r);

/* Puts a curve's points in the order of x. */
void run_curve_sort(run_curve *curve);
void run_curve_free(run_curve *curve);

#endif
