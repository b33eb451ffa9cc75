/* What this processor can run. */
#ifndef SUNDER_BASE_PROCESSOR_H
#define SUNDER_BASE_PROCESSOR_H

#include <stdbool.h>
#include <string.h>

/* Whether it runs code that was compiled for an instruction set ("plain", "avx2", "avx512": cmake/engine.cmake has the flags). */
static inline bool processor_has(const char *simd) {
    if (strcmp(simd, "plain") == 0) return true;
#if defined(__x86_64__)
    if (strcmp(simd, "avx2") == 0) return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    if (strcmp(simd, "avx512") == 0)
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
               __builtin_cpu_supports("avx512vl");
#endif
    return false;
}

#endif
