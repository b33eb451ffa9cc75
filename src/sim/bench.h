/* How fast whole steps are: scenes made here, run, and timed. Nothing is printed.
 *
 * Every case is one bar with a grip at each end that is pulled and carried along, so that whole steps hold what steps of a scene hold:
 * both transfers, the grid's update with its boundaries, the limits, sorting at each frame and whenever particles have
 * drifted, and the measures of each frame. Frames are some 25 steps, as in the scenes. */
#ifndef SUNDER_SIM_BENCH_H
#define SUNDER_SIM_BENCH_H

#include "sim/simulation.h"

typedef struct bench_case {
    const char *name, *doc;
    bool fibres, damage, plastic; /* effects beside elasticity */
    bool cracking;                /* the critical stress lies below the bar's, and the result is checked for it */
    bool implicit;
} bench_case;

/* The cases that this build's effects allow. Returns their number. */
int bench_cases(const bench_case **cases);

typedef struct bench_options {
    const bench_case *which;
    kernel_kind kernel, laplacian; /* the momentum's; the damage's */
    int precision, threads;
    int64_t particles;
    const char *simd;
    double seconds; /* a repetition takes at least this long, within 1 to BENCH_FRAMES frames */
    double limit;   /* no repetition is begun after this many seconds; one is always made */
    int repeat;
} bench_options;

enum { BENCH_FRAMES = 4, BENCH_REPEATS = 99 };

bench_options bench_options_default(void);

/* The engine's phases, then these two. */
enum { BENCH_MEASURE = SOLID_PHASES, BENCH_OTHER, BENCH_PHASES };
extern const char *const bench_phase_names[BENCH_PHASES]; /* sort, p2g, grid, g2p, measure, other */

typedef struct bench_result {
    int64_t particles, steps; /* of one repetition */
    int repetitions;
    double seconds;                 /* of the repetition in the middle */
    double phases[BENCH_PHASES];    /* seconds of that repetition; they sum to `seconds` */
    double bytes_per_particle;      /* memory held: fields, grid, tables, sort buffers */
    double bytes_moved;             /* a particle and step, at least: see bench.c */
    double above_critical;          /* fraction of particles with Φ > 1, the least of before and after; NAN without damage */
    double evaluated;               /* fraction that no early out passes over, likewise */
    double yielded;                 /* fraction with plastic strain; NAN without plasticity */
    const char *simd;
} bench_result;

/* Builds a case, warms it up and times repetitions that all start from the same bits. Errors: memory; a simulation that fails; a cracking case
 * with under 2 % of its particles above the critical stress. */
status bench_step(const bench_options *o, bench_result *out, report *r);

/* A case, ready to run. */
typedef struct bench_bar {
    struct scene *scene;
    simulation *simulation;
    double rate, drift; /* its motion at the start: it stretches along x, thins as it does, and drifts along y */
} bench_bar;

/* bench_bar_destroy also takes one that could not be made, or is all 0. Errors: memory. */
status bench_bar_create(const bench_options *o, bench_bar *bar, report *r);
void bench_bar_destroy(bench_bar *bar);

typedef struct bench_scaling {
    int64_t particles;
    int rounds;
    double ratio;        /* how many times faster a simulation is on o->threads threads than on one: the rounds' median */
    double copies_ratio; /* what as many independent simulations on one thread each do together, likewise: what this machine's processors, caches and
                          * memory let as many threads do at best */
} bench_scaling;

/* Holds o->threads threads (at most BENCH_COPIES) against one and against copies, a frame each in turns. Errors: memory, threads; a simulation that fails. */
enum { BENCH_COPIES = 64 };
status bench_scale(const bench_options *o, bench_scaling *out, report *r);

#endif
