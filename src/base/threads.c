/* One pool for the process. The caller works too, and waits only for workers that have taken a chunk: a worker that the
 * system has not scheduled yet delays nobody, so a busy machine slows a run down in proportion and no more. */
#include "base/threads.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>

enum { WORKERS_LIMIT = 256, SPINS = 2000 };

typedef struct job {
    int64_t count, grain;
    int threads;
    void (*body)(void *context, int64_t i, int worker);
    void *context;
} job;

static pthread_mutex_t owner = PTHREAD_MUTEX_INITIALIZER; /* held by the caller whose job runs */
static pthread_mutex_t sleep_lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t wake = PTHREAD_COND_INITIALIZER;
static int worker_count; /* started so far; guarded by owner */
static int sleepers;     /* guarded by sleep_lock */
static job current;      /* written while `open` is 0 and nobody is inside */
static atomic_int open_for_work, inside;
static _Atomic uint64_t generation;
static _Atomic int64_t next_item;

static void relax(void) {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#else
    sched_yield();
#endif
}

void thread_relax(int spins) {
    if (spins < SPINS) relax();
    else sched_yield();
}

static void take_chunks(int worker) {
    for (;;) {
        int64_t first = atomic_fetch_add(&next_item, current.grain);
        if (first >= current.count) return;
        int64_t end = first + current.grain < current.count ? first + current.grain : current.count;
        for (int64_t i = first; i < end; i++) current.body(current.context, i, worker);
    }
}

/* Waits for a generation other than `seen`: a short spin, because steps follow each other within microseconds, then sleep. */
static uint64_t await_generation(uint64_t seen) {
    for (int i = 0; i < SPINS; i++) {
        if (atomic_load(&generation) != seen) return atomic_load(&generation);
        relax();
    }
    pthread_mutex_lock(&sleep_lock);
    sleepers++;
    while (atomic_load(&generation) == seen) pthread_cond_wait(&wake, &sleep_lock);
    sleepers--;
    pthread_mutex_unlock(&sleep_lock);
    return atomic_load(&generation);
}

static void *worker_main(void *argument) {
    int worker = (int)(intptr_t)argument;
    uint64_t seen = 0;
    for (;;) {
        seen = await_generation(seen);
        /* Enter first, look then: the caller closes the job and waits for everyone inside before it changes it. */
        atomic_fetch_add(&inside, 1);
        if (atomic_load(&open_for_work) && worker < current.threads) take_chunks(worker);
        atomic_fetch_sub(&inside, 1);
    }
    return NULL;
}

/* A forked child has none of its parent's workers. */
static void forget_workers(void) {
    worker_count = 0;
    sleepers = 0;
    atomic_store(&inside, 0);
    atomic_store(&open_for_work, 0);
    pthread_mutex_init(&owner, NULL);
    pthread_mutex_init(&sleep_lock, NULL);
    pthread_cond_init(&wake, NULL);
}

static void start_workers(int threads) {
    if (worker_count == 0) {
        static bool registered;
        if (!registered) pthread_atfork(NULL, NULL, forget_workers);
        registered = true;
    }
    pthread_attr_t detached;
    pthread_attr_init(&detached);
    pthread_attr_setdetachstate(&detached, PTHREAD_CREATE_DETACHED);
    while (worker_count < threads - 1 && worker_count < WORKERS_LIMIT) {
        pthread_t thread;
        if (pthread_create(&thread, &detached, worker_main, (void *)(intptr_t)(worker_count + 1)) != 0) break;
        worker_count++;
    }
    pthread_attr_destroy(&detached);
}

static void announce(void) {
    atomic_fetch_add(&generation, 1);
    pthread_mutex_lock(&sleep_lock);
    if (sleepers > 0) pthread_cond_broadcast(&wake);
    pthread_mutex_unlock(&sleep_lock);
}

void parallel_for(int threads, int64_t count, int64_t grain, void (*body)(void *context, int64_t i, int worker),
                  void *context) {
    /* Another caller's job has the pool: this one runs alone, with the same result. */
    if (threads <= 1 || count <= grain || pthread_mutex_trylock(&owner) != 0) {
        for (int64_t i = 0; i < count; i++) body(context, i, 0);
        return;
    }
    start_workers(threads);
    current = (job){count, grain, threads, body, context};
    atomic_store(&next_item, 0);
    atomic_store(&open_for_work, 1);
    announce();
    take_chunks(0);
    atomic_store(&open_for_work, 0);
    for (int spins = 0; atomic_load(&inside) > 0; spins++) thread_relax(spins);
    pthread_mutex_unlock(&owner);
}

int processor_count(void) {
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) != 0) return 1;
    return CPU_COUNT(&set);
}
