/* Boxes along the axes, grown around points. */
#ifndef SUNDER_GEOM_BOX_H
#define SUNDER_GEOM_BOX_H

#include <math.h>

typedef struct box3 {
    double low[3], high[3];
} box3;

/* Around nothing: low above high. */
static inline box3 box_empty(void) {
    return (box3){{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
}

static inline void box_add(box3 *b, const double x[3]) {
    for (int c = 0; c < 3; c++) b->low[c] = fmin(b->low[c], x[c]), b->high[c] = fmax(b->high[c], x[c]);
}

/* The first of the longest sides, and of the shortest. */
static inline int box_widest(const box3 *b) {
    int widest = 0;
    for (int c = 1; c < 3; c++)
        if (b->high[c] - b->low[c] > b->high[widest] - b->low[widest]) widest = c;
    return widest;
}

static inline int box_narrowest(const box3 *b) {
    int narrowest = 0;
    for (int c = 1; c < 3; c++)
        if (b->high[c] - b->low[c] < b->high[narrowest] - b->low[narrowest]) narrowest = c;
    return narrowest;
}

#endif
