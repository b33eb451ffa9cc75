/* How much faster several threads are, and whom to thank or to blame. Speeds of a shared machine wander by more than the difference that is
 * looked for, so what is compared runs in turns, a frame each. */
#include "base/clock.h"
#include "base/memory.h"
#include "sim/bench.h"

#include <pthread.h>
#include <stdlib.h>

enum { ROUNDS = 7 };

/* Simulations that make the same frames: on one thread, on all, and copies on one thread each. */
typedef struct contest {
    int count; /* 2 + threads */
    bench_bar *bars;
    double *seconds; // [count], of the round
} contest;

typedef struct runner {
    bench_bar *bar;
    double *seconds;
    pthread_barrier_t *together;
    status code;
    report report;
} runner;

static status make_frame(bench_bar *bar, double *seconds, report *r) {
    double start = clock_seconds();
    status code = simulation_advance(bar->simulation, NULL, r);
    *seconds = clock_seconds() - start;
    return code;
}

static void *run_copy(void *argument) {
    runner *own = argument;
    pthread_barrier_wait(own->together);
    own->code = make_frame(own->bar, own->seconds, &own->report);
    return NULL;
}

/* A frame of every copy at once. */
static status run_copies(contest *c, report *r) {
    int copies = c->count - 2, started = 0;
    pthread_t threads[BENCH_COPIES];
    runner runners[BENCH_COPIES];
    pthread_barrier_t together;
    pthread_barrier_init(&together, NULL, (unsigned)copies);
    for (int i = 0; i < copies; i++) runners[i] = (runner){.bar = &c->bars[2 + i], .seconds = &c->seconds[2 + i], .together = &together};
    while (started < copies && pthread_create(&threads[started], NULL, run_copy, &runners[started]) == 0) started++;
    if (started < copies) { /* those that wait at the barrier are let go */
        for (int i = started; i < copies; i++) pthread_barrier_wait(&together);
    }
    status code = started < copies ? report_set(r, STATUS_SYSTEM, "no threads for %d copies", copies) : STATUS_OK;
    for (int i = 0; i < started; i++) {
        pthread_join(threads[i], NULL);
        if (code == STATUS_OK && (code = runners[i].code) != STATUS_OK) *r = runners[i].report;
    }
    pthread_barrier_destroy(&together);
    return code;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, int count) {
    qsort(values, (size_t)count, sizeof *values, ascending);
    return values[count / 2];
}

static status run_rounds(contest *c, bench_scaling *out, report *r) {
    double shared[ROUNDS], copies[ROUNDS];
    for (int round = -1; round < ROUNDS; round++) { /* one to warm up */
        status code = STATUS_OK;
        for (int i = 0; i < 2 && code == STATUS_OK; i++) code = make_frame(&c->bars[i], &c->seconds[i], r);
        if (code == STATUS_OK) code = run_copies(c, r);
        if (code != STATUS_OK) return code;
        if (round < 0) continue;
        shared[round] = c->seconds[0] / c->seconds[1];
        copies[round] = 0;
        for (int i = 2; i < c->count; i++) copies[round] += c->seconds[0] / c->seconds[i];
    }
    out->rounds = ROUNDS;
    out->ratio = median(shared, ROUNDS);
    out->copies_ratio = median(copies, ROUNDS);
    out->particles = simulation_get_plan(c->bars[0].simulation)->particles;
    return STATUS_OK;
}

status bench_scale(const bench_options *o, bench_scaling *out, report *r) {
    contest c = {.count = 2 + o->threads};
    if (o->threads > BENCH_COPIES) return report_set(r, STATUS_INPUT, "at most %d threads can be held against copies", BENCH_COPIES);
    c.bars = memory_allocate_array((size_t)c.count, sizeof *c.bars);
    c.seconds = memory_allocate_array((size_t)c.count, sizeof *c.seconds);
    status code = c.bars && c.seconds ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for %d simulations", c.count);
    for (int i = 0; i < c.count && code == STATUS_OK; i++) {
        bench_options own = *o;
        own.threads = i == 1 ? o->threads : 1;
        code = bench_bar_create(&own, &c.bars[i], r);
    }
    if (code == STATUS_OK) code = run_rounds(&c, out, r);
    for (int i = 0; c.bars && i < c.count; i++) bench_bar_destroy(&c.bars[i]);
    memory_free(c.bars, (size_t)c.count * sizeof *c.bars);
    memory_free(c.seconds, (size_t)c.count * sizeof *c.seconds);
    return code;
}
