/* Orders of plain numbers for qsort, ascending. */
#ifndef SUNDER_BASE_COMPARE_H
#define SUNDER_BASE_COMPARE_H

#include <stdint.h>

#define COMPARE_ASCENDING(name, type)                      \
    static inline int name(const void *a, const void *b) { \
        type x = *(const type *)a, y = *(const type *)b;   \
        return (x > y) - (x < y);                          \
    }

COMPARE_ASCENDING(compare_f32, float)
COMPARE_ASCENDING(compare_f64, double)
COMPARE_ASCENDING(compare_i64, int64_t)
COMPARE_ASCENDING(compare_u64, uint64_t)

#undef COMPARE_ASCENDING

#endif
