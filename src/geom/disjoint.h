/* Disjoint sets of numbers: parent has shape [count]; a set's root is its own parent. */
#ifndef SUNDER_GEOM_DISJOINT_H
#define SUNDER_GEOM_DISJOINT_H

#include <stdbool.h>
#include <stdint.h>

static inline int32_t disjoint_root(int32_t *parent, int32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

#endif
