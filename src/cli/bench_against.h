/* Other programs on the same sheet, for `bench sheet --against`. */
#ifndef SUNDER_CLI_BENCH_AGAINST_H
#define SUNDER_CLI_BENCH_AGAINST_H

#include "base/status.h"

#include <stdint.h>

typedef struct against_result {
    char version[96];
    int64_t particles, bonds; /* bonds counted from both ends, as it counts them */
    int64_t steps;
    double seconds;           /* of the steps alone, as it says */
} against_result;

/* Whether LAMMPS is in the path. Errors: STATUS_INPUT that says what is missing. */
status lammps_find(report *r);

/* A square sheet of `particles` on a square lattice of spacing 1/side, bonds within 1.5 or 3.015 spacings (8 or 28 neighbours), by LAMMPS'
 * peri/pmb on one thread in f64, as a child process. Errors: it is missing, lacks that pair style, or fails; with its own last word. */
status lammps_sheet(int64_t particles, int neighbours, double seconds, against_result *out, report *r);

#endif
