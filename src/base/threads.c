#include "base/threads.h"

#include <omp.h>

void parallel_for(int threads, int64_t count, int64_t grain, void (*body)(void *context, int64_t i, int worker),
                  void *context) {
    if (threads <= 1 || count <= grain) {
        for (int64_t i = 0; i < count; i++) body(context, i, 0);
        return;
    }
#pragma omp parallel for schedule(dynamic, grain) num_threads(threads)
    for (int64_t i = 0; i < count; i++) body(context, i, omp_get_thread_num());
}

int processor_count(void) {
    return omp_get_num_procs();
}
