/* One pool for the process. The caller works too, and waits only for workers that have taken a chunk: a worker that the
 * system has not scheduled yet delays nobody, so a busy machine slows a run down in proportion and no more.
 *
 * A worker begins with a stretch of its own, the same in every call over as many items: what it wrote in one pass is in its own cache in the
 * next. When that is done it takes chunks from the ends of others' stretches. */
#include "base/threads.h"

#include "base/clock.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>

enum { WORKERS_LIMIT = 256, SPINS = 2000, APART = 4096 /* bytes: prefetchers of two processors that meet in a page slow both down */ };

static const double AWAKE = 3e-4; /* seconds */

typedef struct job {
    int64_t count, grain;
    int threads, stages;
    void (*body)(void *context, int64_t i, int worker);
    void *context;
} job;

/* What is left of a worker's stretches: the first chunk and the one after the last, in one word. */
typedef struct stretch {
    _Alignas(APART) _Atomic uint64_t left[PARALLEL_STAGES];
} stretch;

static pthread_mutex_t owner = PTHREAD_MUTEX_INITIALIZER; /* held by the caller whose job runs */
static pthread_mutex_t sleep_lock = PTHREAD_MUTEX_INITIALIZER;
static pthread_cond_t wake = PTHREAD_COND_INITIALIZER;
static int worker_count; /* started so far; guarded by owner */
static int sleepers;     /* guarded by sleep_lock */
static _Alignas(APART) job current;      /* written while `open` is 0 and nobody is inside */
static _Alignas(APART) atomic_int inside;
static _Alignas(APART) atomic_int open_for_work;
static _Atomic uint64_t generation;
static stretch stretches[WORKERS_LIMIT + 1];
static atomic_int guests; /* threads that compute beside the pool's */
static int processors;    /* guarded by owner */

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

static uint64_t pack_range(int64_t begin, int64_t end) {
    return (uint64_t)begin << 32 | (uint64_t)end;
}

/* The first chunk of one's own, or the last of another's; −1: none is left. */
static int64_t take_chunk(int worker, int stage, bool own) {
    _Atomic uint64_t *left = &stretches[worker].left[stage];
    uint64_t range = atomic_load_explicit(left, memory_order_relaxed);
    for (;;) {
        uint64_t begin = range >> 32, end = range & UINT32_MAX;
        if (begin >= end) return -1;
        uint64_t rest = own ? (begin + 1) << 32 | end : begin << 32 | (end - 1);
        if (atomic_compare_exchange_weak(left, &range, rest)) return (int64_t)(own ? begin : end - 1);
    }
}

static void run_chunk(int64_t chunk, int worker) {
    int64_t first = chunk * current.grain;
    int64_t end = first + current.grain < current.count ? first + current.grain : current.count;
    for (int64_t i = first; i < end; i++) current.body(current.context, i, worker);
}

static void take_chunks(int worker) {
    for (int stage = 0; stage < current.stages; stage++)
        for (int other = 0; other < current.threads; other++) {
            int64_t chunk, victim = worker + other < current.threads ? worker + other : worker + other - current.threads;
            while ((chunk = take_chunk((int)victim, stage, other == 0)) >= 0) run_chunk(chunk, worker);
        }
}

/* Passes follow each other within some 100 µs, and to be woken takes as long: a worker stays awake for a while, lending its processor to whoever
 * wants it. Whether there is a generation other than `seen` by then. */
static bool look_out(uint64_t seen) {
    for (int i = 0; i < SPINS; i++, relax())
        if (atomic_load(&generation) != seen) return true;
    for (double until = clock_seconds() + AWAKE; clock_seconds() < until; sched_yield())
        if (atomic_load(&generation) != seen) return true;
    return false;
}

static uint64_t await_generation(uint64_t seen) {
    if (look_out(seen)) return atomic_load(&generation);
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
    atomic_store(&guests, 0);
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

static void work_alone(int64_t count, void (*body)(void *context, int64_t i, int worker), void *context) {
    for (int64_t i = 0; i < count; i++) body(context, i, 0);
}

/* Opens the pool to the job whose stretches are set, and works on it until it is done. */
static void work_together(const job *j) {
    current = *j;
    atomic_store(&open_for_work, 1);
    announce();
    take_chunks(0);
    atomic_store(&open_for_work, 0);
    for (int spins = 0; atomic_load(&inside) > 0; spins++) thread_relax(spins);
    pthread_mutex_unlock(&owner);
}

void parallel_make_room(void) {
    atomic_fetch_add(&guests, 1);
}

void parallel_take_room(void) {
    atomic_fetch_sub(&guests, 1);
}

/* How many threads there are processors for. More threads than processors that were asked for are the user's wish. */
static int threads_with_room(int threads) {
    if (processors == 0) processors = processor_count();
    int most = threads < processors ? threads : processors, left = processors - atomic_load(&guests);
    if (left >= most) return threads;
    return left > 1 ? left : 1;
}

/* Returns how many threads to work with: 1 without the pool, which another caller's job may have; the result is the same. */
static int enter_pool(int threads) {
    if (threads <= 1 || threads > WORKERS_LIMIT || pthread_mutex_trylock(&owner) != 0) return 1;
    int present = threads_with_room(threads);
    if (present == 1) pthread_mutex_unlock(&owner);
    else start_workers(threads);
    return present;
}

void parallel_for(int threads, int64_t count, int64_t grain, void (*body)(void *context, int64_t i, int worker),
                  void *context) {
    int64_t chunks = (count + grain - 1) / grain;
    int present = chunks > 1 && chunks <= INT32_MAX ? enter_pool(threads) : 1;
    if (present == 1) {
        work_alone(count, body, context);
        return;
    }
    for (int w = 0; w < present; w++)
        atomic_store_explicit(&stretches[w].left[0], pack_range(chunks * w / present, chunks * (w + 1) / present), memory_order_relaxed);
    work_together(&(job){count, grain, present, 1, body, context});
}

void parallel_stages(int threads, int stages, const int32_t *bounds, void (*body)(void *context, int64_t i, int worker), void *context) {
    int32_t count = bounds[stages * (threads + 1) - 1];
    int present = count > 1 ? enter_pool(threads) : 1;
    if (present == 1) {
        work_alone(count, body, context);
        return;
    }
    for (int w = 0; w < present; w++)
        for (int stage = 0; stage < stages; stage++) {
            const int32_t *of_stage = bounds + stage * (threads + 1);
            uint64_t range = pack_range(of_stage[threads * w / present], of_stage[threads * (w + 1) / present]);
            atomic_store_explicit(&stretches[w].left[stage], range, memory_order_relaxed);
        }
    work_together(&(job){count, 1, present, stages, body, context});
}

int processor_count(void) {
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) != 0) return 1;
    return CPU_COUNT(&set);
}
