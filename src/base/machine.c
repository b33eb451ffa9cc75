#include "base/machine.h"

#include "base/clock.h"
#include "base/memory.h"
#include "base/processor.h"
#include "base/threads.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

/* ---- what the system says ---------------------------------------------------------------------------------------- */

static void read_processor(char name[128]) {
    struct utsname system;
    snprintf(name, 128, "%s", uname(&system) == 0 ? system.machine : "unknown");
    FILE *f = fopen("/proc/cpuinfo", "r");
    if (!f) return;
    char line[512];
    while (fgets(line, sizeof line, f)) {
        const char *value = strchr(line, ':');
        if (strncmp(line, "model name", 10) != 0 || !value) continue;
        snprintf(name, 128, "%.*s", (int)strcspn(value + 2, "\n"), value + 2);
        break;
    }
    fclose(f);
}

/* The first line of a file of /sys that describes one cache; "" when there is none. */
static void read_cache_file(int index, const char *what, char text[64]) {
    char path[128];
    snprintf(path, sizeof path, "/sys/devices/system/cpu/cpu0/cache/index%d/%s", index, what);
    text[0] = '\0';
    FILE *f = fopen(path, "r");
    if (!f) return;
    if (!fgets(text, 64, f)) text[0] = '\0';
    fclose(f);
}

static void read_caches(int64_t bytes[MACHINE_CACHE_LEVELS]) {
    for (int index = 0; index < 8; index++) {
        char level[64], type[64], size[64], *unit;
        read_cache_file(index, "level", level);
        read_cache_file(index, "type", type);
        read_cache_file(index, "size", size);
        long which = strtol(level, NULL, 10);
        if (which < 1 || which > MACHINE_CACHE_LEVELS || strncmp(type, "Instruction", 11) == 0) continue;
        int64_t value = strtol(size, &unit, 10);
        bytes[which - 1] = value * (*unit == 'K' ? 1024 : *unit == 'M' ? 1024 * 1024 : 1);
    }
}

void machine_describe(machine *m) {
    memset(m, 0, sizeof *m);
    read_processor(m->processor);
    read_caches(m->cache_bytes);
    m->processors = processor_count();
}

/* ---- memory ------------------------------------------------------------------------------------------------------ */

enum { TRIAD_PASSES = 12, TRIAD_CHUNKS = 8 }; /* chunks a thread: a thread that starts late leaves some to the others */

typedef struct triad {
    double *a, *b, *c;
    int64_t chunk; /* elements */
} triad;

/* Touched first by the threads that use it, which decides where its pages are. */
static void triad_fill(void *context, int64_t i, int worker) {
    (void)worker;
    triad *t = context;
    for (int64_t k = i * t->chunk; k < (i + 1) * t->chunk; k++) t->a[k] = 0, t->b[k] = 1, t->c[k] = 2;
}

static void triad_pass(void *context, int64_t i, int worker) {
    (void)worker;
    const triad *t = context;
    double *restrict a = t->a + i * t->chunk;
    const double *restrict b = t->b + i * t->chunk, *restrict c = t->c + i * t->chunk;
    for (int64_t k = 0; k < t->chunk; k++) a[k] = b[k] + 3 * c[k];
}

/* Bytes of one array: STREAM's rule, within what a small machine has and a large one needs. */
static int64_t triad_bytes(void) {
    machine m;
    machine_describe(&m);
    int64_t last = 0;
    for (int level = 0; level < MACHINE_CACHE_LEVELS; level++) last = m.cache_bytes[level] > last ? m.cache_bytes[level] : last;
    int64_t bytes = 4 * last, least = 64LL << 20, most = 1LL << 30;
    return bytes < least ? least : bytes > most ? most : bytes;
}

status machine_triad(int threads, double *gb_s, report *r) {
    int64_t chunks = (int64_t)threads * TRIAD_CHUNKS;
    triad t = {.chunk = triad_bytes() / (int64_t)sizeof(double) / chunks};
    size_t bytes = (size_t)(t.chunk * chunks) * sizeof(double);
    t.a = memory_allocate(bytes);
    t.b = memory_allocate(bytes);
    t.c = memory_allocate(bytes);
    status code = t.a && t.b && t.c ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for three arrays of %zu bytes", bytes);
    if (code == STATUS_OK) {
        parallel_for(threads, chunks, 1, triad_fill, &t);
        double best = HUGE_VAL;
        for (int pass = 0; pass < TRIAD_PASSES; pass++) {
            double start = clock_seconds();
            parallel_for(threads, chunks, 1, triad_pass, &t);
            best = fmin(best, clock_seconds() - start);
        }
        *gb_s = 3e-9 * (double)bytes / best;
    }
    memory_free(t.a, bytes);
    memory_free(t.b, bytes);
    memory_free(t.c, bytes);
    return code;
}

/* ---- arithmetic -------------------------------------------------------------------------------------------------- */

/* `chains` independent sums s ← s f + t, enough to hide the latency and few enough to stay in registers. The sums tend to
 * t/(1 − f) and no compiler may shorten them; what is returned keeps them alive. */
#define FMA_KERNEL(name, target, type, real, chains, multiply_add)                                                     \
    target static double name(int64_t rounds) {                                                                        \
        type sum[chains], factor = (real)0.999 - (type){0}, term = (real)0.001 - (type){0};                            \
        for (int c = 0; c < chains; c++) sum[c] = (real)c - (type){0};                                                 \
        for (int64_t i = 0; i < rounds; i++)                                                                           \
            for (int c = 0; c < chains; c++) sum[c] = multiply_add(sum[c], factor, term);                              \
        double total = 0;                                                                                              \
        for (int c = 0; c < chains; c++) total += (double)sum[c][0];                                                   \
        return total;                                                                                                  \
    }

typedef float f32x4 __attribute__((vector_size(16)));
typedef double f64x2 __attribute__((vector_size(16)));
#define PLAIN_MULTIPLY_ADD(a, b, c) ((a) * (b) + (c))
FMA_KERNEL(fma_f32_plain, , f32x4, float, 12, PLAIN_MULTIPLY_ADD)
FMA_KERNEL(fma_f64_plain, , f64x2, double, 12, PLAIN_MULTIPLY_ADD)
#if defined(__x86_64__)
#define AVX2 __attribute__((target("avx2,fma")))
#define AVX512 __attribute__((target("avx512f")))
FMA_KERNEL(fma_f32_avx2, AVX2, __m256, float, 12, _mm256_fmadd_ps)
FMA_KERNEL(fma_f64_avx2, AVX2, __m256d, double, 12, _mm256_fmadd_pd)
FMA_KERNEL(fma_f32_avx512, AVX512, __m512, float, 16, _mm512_fmadd_ps)
FMA_KERNEL(fma_f64_avx512, AVX512, __m512d, double, 16, _mm512_fmadd_pd)
#endif

typedef struct fma_kernel {
    const char *simd;
    double (*run[2])(int64_t rounds); /* f32, f64 */
    double flops[2];                  /* a round */
} fma_kernel;

static fma_kernel best_kernel(void) {
#if defined(__x86_64__)
    if (processor_has("avx512")) return (fma_kernel){"avx512", {fma_f32_avx512, fma_f64_avx512}, {2 * 16 * 16, 2 * 16 * 8}};
    if (processor_has("avx2")) return (fma_kernel){"avx2", {fma_f32_avx2, fma_f64_avx2}, {2 * 12 * 8, 2 * 12 * 4}};
#endif
    return (fma_kernel){"plain", {fma_f32_plain, fma_f64_plain}, {2 * 12 * 4, 2 * 12 * 2}};
}

double machine_fma(int precision, const char **simd) {
    enum { PASSES = 100 };
    const int64_t rounds = 200000; /* under a millisecond: on a busy machine some passes are then left alone */
    fma_kernel kernel = best_kernel();
    int which = precision == 64;
    *simd = kernel.simd;
    double best = HUGE_VAL;
    for (int pass = 0; pass < PASSES; pass++) {
        double start = clock_seconds();
        double sum = kernel.run[which](rounds);
        __asm__ volatile("" : : "m"(sum)); /* it is wanted */
        best = fmin(best, clock_seconds() - start);
    }
    return 1e-9 * kernel.flops[which] * (double)rounds / best;
}
