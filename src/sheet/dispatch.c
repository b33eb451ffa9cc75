/* Which variant runs: the best instruction set that this processor has, unless one is asked for by name. */
#include "sheet/sheet.h"

#include "base/processor.h"

#include <stdlib.h>
#include <string.h>

extern const sheet_engine sheet_engine_table_f32_plain, sheet_engine_table_f64_plain;
#ifdef SUNDER_HAS_AVX2
extern const sheet_engine sheet_engine_table_f32_avx2, sheet_engine_table_f64_avx2;
#endif
#ifdef SUNDER_HAS_AVX512
extern const sheet_engine sheet_engine_table_f32_avx512, sheet_engine_table_f64_avx512;
#endif

const sheet_engine *sheet_engine_find(int precision, const char *simd) {
    static const sheet_engine *const engines[] = {
#ifdef SUNDER_HAS_AVX512
        &sheet_engine_table_f32_avx512, &sheet_engine_table_f64_avx512,
#endif
#ifdef SUNDER_HAS_AVX2
        &sheet_engine_table_f32_avx2, &sheet_engine_table_f64_avx2,
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
