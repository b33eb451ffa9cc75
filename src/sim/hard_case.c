#include "sim/hard_case.h"

#include <string.h>

#define ROW(key, unit, sense, doc) {#key, unit, doc, sense},
static const hard_measure_row rows[] = {HARD_MEASURES(ROW)};
#undef ROW

const hard_measure_row *hard_measure_at(int measure) {
    return &rows[measure];
}

int hard_measure_find(const char *key) {
    for (int i = 0; i < HARD_MEASURE_COUNT; i++)
        if (strcmp(rows[i].key, key) == 0) return i;
    return -1;
}
