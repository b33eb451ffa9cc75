/* Which variant runs: the best instruction set that this processor has, unless one is asked for by name. */
#include "solid/solid.h"

#include "base/processor.h"

#include <stdlib.h>
#include <string.h>

#define DECLARE(simd)                                                                                                  \
    extern const solid_engine solid_engine_table_f32_##simd, solid_engine_table_f64_##simd;                            \
    extern const solid_engine solid_tetra_table_f32_##simd, solid_tetra_table_f64_##simd;
DECLARE(plain)
#ifdef SUNDER_HAS_AVX2
DECLARE(avx2)
#endif
#ifdef SUNDER_HAS_AVX512
DECLARE(avx512)
#endif

static const solid_engine *const points[] = {
#ifdef SUNDER_HAS_AVX512
    &solid_engine_table_f32_avx512, &solid_engine_table_f64_avx512,
#endif
#ifdef SUNDER_HAS_AVX2
    &solid_engine_table_f32_avx2, &solid_engine_table_f64_avx2,
#endif
    &solid_engine_table_f32_plain, &solid_engine_table_f64_plain,
};
static const solid_engine *const meshes[] = {
#ifdef SUNDER_HAS_AVX512
    &solid_tetra_table_f32_avx512, &solid_tetra_table_f64_avx512,
#endif
#ifdef SUNDER_HAS_AVX2
    &solid_tetra_table_f32_avx2, &solid_tetra_table_f64_avx2,
#endif
    &solid_tetra_table_f32_plain, &solid_tetra_table_f64_plain,
};
enum { VARIANTS = sizeof points / sizeof *points };

static const solid_engine *find(const solid_engine *const *engines, int precision, const char *simd) {
    int any = !simd || strcmp(simd, "auto") == 0;
    for (size_t i = 0; i < VARIANTS; i++) {
        if (engines[i]->precision != precision) continue;
        if (!any && strcmp(engines[i]->simd, simd) != 0) continue;
        if (processor_has(engines[i]->simd)) return engines[i];
    }
    return NULL;
}

const solid_engine *solid_engine_find(int precision, const char *simd) {
    return find(points, precision, simd);
}

const solid_engine *solid_tetra_find(int precision, const char *simd) {
    return find(meshes, precision, simd);
}
