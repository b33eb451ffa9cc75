/* Work shared out over threads. Results must not depend on who does what: each item writes only what is its own. */
#ifndef SUNDER_BASE_THREADS_H
#define SUNDER_BASE_THREADS_H

#include <stdint.h>

/* Calls body(context, i, worker) for i in 0 … count−1 on `threads` threads (the caller's among them), in chunks of `grain` items,
 * and returns when all are done. worker is in 0 … threads−1 and never shared by two running calls. A worker starts with the same stretch in every
 * call over as many items; it takes chunks from the ends of others' when it has none left. Nothing is allocated
 * after the first call with this many threads. */
void parallel_for(int threads, int64_t count, int64_t grain, void (*body)(void *context, int64_t i, int worker),
                  void *context);

/* The same for items in stages, where a body may wait for items of lower stages: of stage k worker w starts with items bounds[k (threads+1) + w] up to
 * the next bound; a stage begins where the one before it ends. A worker goes on to a stage when all items of those below have been taken. */
enum { PARALLEL_STAGES = 27 };
void parallel_stages(int threads, int stages, const int32_t *bounds, void (*body)(void *context, int64_t i, int worker), void *context);

/* The calling thread is going to compute for a while beside parallel loops, and has done so. Meanwhile these take one thread less where processors would
 * be short: a worker that loses its processor in the midst of an item holds all others up. Results do not depend on it. */
void parallel_make_room(void);
void parallel_take_room(void);

/* Passes the time of the `spins`th look at what another thread will have done soon; after many looks the processor is lent to others. */
void thread_relax(int spins);

/* Processors that this process may run on. */
int processor_count(void);

#endif
