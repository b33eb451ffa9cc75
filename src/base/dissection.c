#include "base/dissection.h"

#include "base/memory.h"

#include <string.h>

/* Fewer cells than these are one dense block of the factor anyway. */
enum { SMALLEST = 96 };

typedef struct dissection {
    const int32_t (*cells)[3];
    int reach;
    int32_t *other;     /* [count], room to sort into */
    int32_t *histogram; /* [longest extent of all + reach] */
} dissection;

typedef struct extent {
    int axis;
    int32_t low, length;
} extent;

static extent longest(const dissection *d, const int32_t *order, int32_t count) {
    extent most = {0};
    for (int axis = 0; axis < 3; axis++) {
        int32_t low = INT32_MAX, high = INT32_MIN;
        for (int32_t i = 0; i < count; i++) {
            int32_t at = d->cells[order[i]][axis];
            if (at < low) low = at;
            if (at > high) high = at;
        }
        if (high - low + 1 > most.length) most = (extent){axis, low, high - low + 1};
    }
    return most;
}

/* Where the layer between the halves begins, from `low`: the one with the fewest cells in it where the smaller half has at least a third, else the
 * one whose halves are most alike. False when every layer leaves one side empty. */
static bool choose_layer(const dissection *d, extent along, int32_t count, int32_t *begin) {
    const int32_t *cells = d->histogram;
    int32_t below = 0, between = 0, best_between = INT32_MAX, best_smaller = 0;
    for (int32_t i = 0; i < d->reach; i++) between += cells[i];
    for (int32_t i = 0; i + d->reach <= along.length; i++) {
        int32_t above = count - below - between, smaller = below < above ? below : above;
        bool balanced = 3 * smaller >= count - between, best_balanced = 3 * best_smaller >= count - best_between;
        bool better = balanced ? !best_balanced || between < best_between || (between == best_between && smaller > best_smaller)
                               : !best_balanced && smaller > best_smaller;
        if (smaller > 0 && better) *begin = i, best_between = between, best_smaller = smaller;
        below += cells[i];
        between += (i + d->reach < along.length ? cells[i + d->reach] : 0) - cells[i];
    }
    return best_smaller > 0;
}

static void dissect(const dissection *d, int32_t *order, int32_t count) {
    if (count <= SMALLEST) return;
    extent along = longest(d, order, count);
    memset(d->histogram, 0, (size_t)(along.length + d->reach) * sizeof *d->histogram);
    for (int32_t i = 0; i < count; i++) d->histogram[d->cells[order[i]][along.axis] - along.low]++;
    int32_t begin = 0, ends[4] = {0};
    if (!choose_layer(d, along, count, &begin)) return;
    for (int part = 0; part < 3; part++) { /* below, above, between: each in the sequence that it has */
        ends[part + 1] = ends[part];
        for (int32_t i = 0; i < count; i++) {
            int32_t at = d->cells[order[i]][along.axis] - along.low;
            if ((at < begin ? 0 : at >= begin + d->reach ? 1 : 2) == part) d->other[ends[part + 1]++] = order[i];
        }
    }
    memcpy(order, d->other, (size_t)count * sizeof *order);
    dissect(d, order, ends[1]);
    dissect(d, order + ends[1], ends[2] - ends[1]);
    dissect(d, order + ends[2], ends[3] - ends[2]);
}

bool dissection_order(const int32_t (*cells)[3], int32_t count, int reach, int32_t *order) {
    if (count == 0) return true;
    for (int32_t i = 0; i < count; i++) order[i] = i;
    dissection d = {.cells = cells, .reach = reach};
    size_t room = (size_t)longest(&d, order, count).length + (size_t)reach;
    d.other = memory_allocate_array((size_t)count, sizeof *d.other);
    d.histogram = memory_allocate_array(room, sizeof *d.histogram);
    bool fine = d.other && d.histogram;
    if (fine) dissect(&d, order, count);
    memory_free(d.other, d.other ? (size_t)count * sizeof *d.other : 0);
    memory_free(d.histogram, d.histogram ? room * sizeof *d.histogram : 0);
    return fine;
}
