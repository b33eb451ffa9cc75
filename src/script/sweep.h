/* Sweeps: one scene run over lists of values, read from a Lua file that returns s.sweep { … }. */
#ifndef SUNDER_SCRIPT_SWEEP_H
#define SUNDER_SCRIPT_SWEEP_H

#include "script/script.h"

#include <stdio.h>

enum { SWEEP_AXES = 8, SWEEP_VALUES = 64, SWEEP_SETTINGS = 24, SWEEP_TEXT = 128, SWEEP_PATH = 1024, SWEEP_RUNS = 4096, SWEEP_ID = 40, SWEEP_MESSAGE = 400 };

/* One name and the values that it takes in turn, as --set would write them. */
typedef struct sweep_axis {
    char name[SWEEP_TEXT];
    int count;
    char value[SWEEP_VALUES][SWEEP_TEXT];
} sweep_axis;

typedef struct sweep {
    char title[SWEEP_TEXT], scene[SWEEP_PATH], recipe[SWEEP_TEXT]; /* scene: a path that holds from the working folder; recipe may be empty */
    int64_t frames;                                                /* −1: the scene's */
    int fixed_count, axis_count;
    sweep_axis fixed[SWEEP_SETTINGS]; /* one value each: the same in every run */
    sweep_axis axes[SWEEP_AXES];      /* by name; the last varies fastest */
} sweep;

/* Reads a sweep. Errors as script_load's: a file that returns something else, misspelt or missing keys, no values, over SWEEP_RUNS
 * runs. */
status sweep_load(const char *path, sweep *out, script_reports *reports);

/* How many runs it has, and the value of each axis in one of them: which[axis] < axes[axis].count. */
int sweep_count(const sweep *s);
void sweep_cell(const sweep *s, int run, int which[SWEEP_AXES]);

/* What has become of a run: waiting, going on, done now, failed, or left out because it was done before. */
typedef enum sweep_run_state { SWEEP_WAITING, SWEEP_GOING, SWEEP_DONE, SWEEP_FAILED, SWEEP_SKIPPED } sweep_run_state;

/* A line of `sunder sweep --lines`: tabs between run, count, the state's word, id and message. */
typedef struct sweep_line {
    int run, count; /* from 0; of how many */
    sweep_run_state state;
    char id[SWEEP_ID], message[SWEEP_MESSAGE]; /* of the run in the ledger, and what went wrong; "" for none */
} sweep_line;

void sweep_line_write(const sweep_line *line, FILE *out);
/* Without the newline. False when it is no such line. */
bool sweep_line_read(const char *text, sweep_line *out);

#endif
