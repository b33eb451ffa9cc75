/* Which variant runs: the best instruction set that this processor has, unless one is asked for by name. */
#include "sheet/sheet.h"

#include <stdlib.h>
#include <string.h>

extern const sheet_engine sheet_engine_table_f32_plain, sheet_engine_table_f64_plain;
#ifdef SUNDER_HAS_X86
extern const sheet_engine sheet_engine_table_f32_avx2, sheet_engine_table_f64_avx2;
extern const sheet_engine sheet_engine_table_f32_avx512, sheet_engine_table_f64_avx512;
#endif

static int processor_has(const char *simd) {
    if (strcmp(simd, "plain") == 0) return 1;
#ifdef SUNDER_HAS_X86
    if (strcmp(simd, "avx2") == 0) return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    if (strcmp(simd, "avx512") == 0)
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
               __builtin_cpu_supports("avx512vl");
#endif
    return 0;
}

const sheet_engine *sheet_engine_find(int precision, const char *simd) {
    static const sheet_engine *const engines[] = {
#ifdef SUNDER_HAS_X86
        &sheet_engine_table_f32_avx512, &sheet_engine_table_f64_avx512, &sheet_engine_table_f32_avx2, &sheet_engine_table_f64_avx2,
#endif
        &sheet_engine_table_f32_plain, &sheet_engine_table_f64_plain,
    };
    int any = !simd || strcmp(simd, "auto") == 0;
    for (size_t i = 0; i < sizeof engines / sizeof *engines; i++) {
        if (engines[i]->precision != precision) continue;
        if (!any && strcmp(engines[i]->simd, simd) != 0) continue;
        if (processor_has(engines[i]->simd)) return engines[i];
    }
    return NULL;
}
