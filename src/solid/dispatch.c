/* Which variant runs: the best instruction set that this processor has, unless one is asked for by name. */
#include "solid/solid.h"

#include "base/processor.h"

#include <stdlib.h>
#include <string.h>

#define DECLARE(simd)                                                                                                  \
    extern const solid_engine solid_engine_table_f32_##simd, solid_engine_table_f64_##simd;                            \
    extern const solid_engine solid_tetra_table_f32_##simd, solid_tetra_table_f64_##simd;
DECLARE(plain)
#ifdef SUNDER_HAS_X86
DECLARE(avx2)
DECLARE(avx512)
#define EACH(table) &table##_f32_avx512, &table##_f64_avx512, &table##_f32_avx2, &table##_f64_avx2, &table##_f32_plain, &table##_f64_plain
#else
#define EACH(table) &table##_f32_plain, &table##_f64_plain
#endif

static const solid_engine *const points[] = {EACH(solid_engine_table)};
static const solid_engine *const meshes[] = {EACH(solid_tetra_table)};
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
