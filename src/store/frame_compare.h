/* Whether two runs' frames are the same to the bit, and where they are not. */
#ifndef SUNDER_STORE_FRAME_COMPARE_H
#define SUNDER_STORE_FRAME_COMPARE_H

#include "base/record.h"

#include <stdbool.h>

typedef struct frame_difference {
    bool same;
    char array[RECORD_NAME]; /* the first array that differs */
    double largest;          /* of |a − b| over it; NaN when its shapes differ or one run lacks it */
} frame_difference;

/* Compares frame `frame` of two runs' folders, all arrays, byte by byte. Errors as frame_read's. */
status frame_compare(const char *a, const char *b, int64_t frame, frame_difference *out, report *r);

/* The first frame of those up to `last` that both runs have and that differs, −1 when none does. */
status frame_first_difference(const char *a, const char *b, int64_t last, int64_t *frame, frame_difference *out, report *r);

#endif
