/* Nested dissection: an order of all cells, in which elimination fills in less than in the order that they came in. */
#include "base/dissection.h"
#include "base/memory.h"
#include "check.h"

#include <stdlib.h>
#include <string.h>

enum { MOST = 1024 };

typedef int32_t place[3];

static bool coupled(const int32_t *a, const int32_t *b, int reach) {
    for (int axis = 0; axis < 3; axis++)
        if (abs(a[axis] - b[axis]) > reach) return false;
    return true;
}

/* Entries below the diagonal of the factor, by elimination on the graph itself. */
static int64_t filled(const place *cells, int32_t count, int reach, const int32_t *order) {
    bool(*joined)[MOST] = memory_allocate_array(MOST, sizeof *joined);
    for (int32_t i = 0; i < count; i++)
        for (int32_t j = 0; j < count; j++) joined[i][j] = coupled(cells[order[i]], cells[order[j]], reach);
    int64_t entries = 0;
    for (int32_t k = 0; k < count; k++)
        for (int32_t i = k + 1; i < count; i++) {
            if (!joined[k][i]) continue;
            entries++;
            for (int32_t j = k + 1; j < count; j++) joined[i][j] |= joined[k][j];
        }
    memory_free(joined, MOST * sizeof *joined);
    return entries;
}

/* Every index once, whatever the cells; returns the fill. */
static int64_t order_of(const place *cells, int32_t count, int reach) {
    int32_t order[MOST], seen[MOST] = {0};
    CHECK(dissection_order(cells, count, reach, order));
    for (int32_t i = 0; i < count; i++) seen[order[i]]++;
    for (int32_t i = 0; i < count; i++) CHECK(seen[i] == 1);
    return filled(cells, count, reach, order);
}

static int64_t as_they_come(const place *cells, int32_t count, int reach) {
    int32_t order[MOST];
    for (int32_t i = 0; i < count; i++) order[i] = i;
    return filled(cells, count, reach, order);
}

static int32_t box(place *cells, int32_t width, int32_t depth, int32_t height) {
    int32_t count = 0;
    for (int32_t i = 0; i < width; i++)
        for (int32_t j = 0; j < depth; j++)
            for (int32_t k = 0; k < height; k++) cells[count][0] = i - 7, cells[count][1] = j, cells[count++][2] = k + 100;
    return count;
}

/* A plate of n² cells fills in n² log n with a dissection and n³ line by line. */
static void fills_in_less(void) {
    static place cells[MOST];
    int32_t count = box(cells, 32, 32, 1);
    int64_t dissected = order_of(cells, count, 1), lines = as_they_come(cells, count, 1);
    printf("  plate: %lld entries, %lld line by line\n", (long long)dissected, (long long)lines);
    CHECK(dissected < 0.8 * (double)lines);
}

/* A rope that lies across the order that its cells come in: its length is cut first, and the fill grows with its length, not its square. */
static void cuts_ropes_across(void) {
    static place cells[MOST];
    int32_t count = box(cells, 3, 3, 112);
    int64_t whole = order_of(cells, count, 3), half = order_of(cells, box(cells, 3, 3, 56), 3);
    box(cells, 3, 3, 112);
    printf("  rope: %lld entries, of half its length %lld, as they come %lld\n", (long long)whole, (long long)half, (long long)as_they_come(cells, count, 3));
    CHECK(whole < 2.5 * (double)half);
    CHECK(5 * whole < 2 * as_they_come(cells, count, 3));
}

static void takes_what_cannot_be_cut(void) {
    static place cells[MOST];
    order_of(cells, 0, 3);
    order_of(cells, box(cells, 1, 1, 1), 3);
    order_of(cells, box(cells, 6, 6, 6), 7); /* no layer of that thickness leaves a half */
    for (int32_t i = 0; i < 500; i++) cells[i][0] = cells[i][1] = cells[i][2] = 5; /* all in one place */
    order_of(cells, 500, 3);
    for (int32_t i = 0; i < 500; i++) cells[i][2] = i % 2 ? 1000 + i : i; /* two that nothing joins */
    order_of(cells, 500, 3);
}

int main(void) {
    RUN(fills_in_less);
    RUN(cuts_ropes_across);
    RUN(takes_what_cannot_be_cut);
    return check_finish();
}
