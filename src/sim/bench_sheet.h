/* How fast steps of a sheet are: sheets made here, run, and timed. Nothing is printed. */
#ifndef SUNDER_SIM_BENCH_SHEET_H
#define SUNDER_SIM_BENCH_SHEET_H

#include "sheet/sheet.h"

typedef struct sheet_bench_options {
    bool tearing;      /* fracture, diffusion and swelling beside the linear law; else the law alone */
    int neighbours;    /* 8 or 28 */
    int precision, threads;
    int64_t particles; /* about */
    const char *simd;
    double seconds;    /* a repetition takes at least this long */
    int repeat;
} sheet_bench_options;

typedef struct sheet_bench_result {
    int64_t particles, bonds; /* bonds counted from both ends */
    int64_t steps;            /* of one repetition */
    double seconds;           /* of the repetition in the middle */
    double phases[SHEET_PHASES];
    double bytes_per_particle;
    const char *simd;
} sheet_bench_result;

extern const char *const sheet_bench_phase_names[SHEET_PHASES];

/* A square sheet on a square lattice, held at no side, that breathes by 1 %; steps of half the limit. Errors: memory, an unknown instruction
 * set, a sheet that fails. */
status bench_sheet(const sheet_bench_options *o, sheet_bench_result *out, report *r);

#endif
