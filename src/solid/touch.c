/* Blocks of particles as contact sees them (src/sim/contact.c): which lie near a place, where their particles are, how those move. */
#include "solid/order.h"

#include <math.h>

/* Kernels start in base_low … base_high until particles are sorted again, and the step that was the last has moved none by a cell: in cells. */
static void block_box(const solid *s, int32_t block, double low[3], double high[3]) {
    const solid_block *b = &s->blocks[block];
    double shift = kernel_shift(s->definition.kernel);
    for (int c = 0; c < 3; c++) {
        low[c] = (double)b->coordinate[c] * BLOCK + b->base_low[c] + shift - 1;
        high[c] = (double)b->coordinate[c] * BLOCK + b->base_high[c] + shift + 2;
    }
}

static int32_t blocks(const solid *s, double low[3], double high[3]) {
    double l[3], h[3];
    for (int c = 0; c < 3; c++) low[c] = HUGE_VAL, high[c] = -HUGE_VAL;
    for (int32_t b = 0; b < s->block_count; b++) {
        block_box(s, b, l, h);
        for (int c = 0; c < 3; c++) low[c] = fmin(low[c], s->definition.dx * l[c]), high[c] = fmax(high[c], s->definition.dx * h[c]);
    }
    return s->block_count;
}

/* low, high: in cells. */
static bool mark_block(const solid *s, int32_t block, const double low[3], const double high[3], _Atomic uint8_t *marks) {
    double l[3], h[3];
    block_box(s, block, l, h);
    for (int c = 0; c < 3; c++)
        if (l[c] > high[c] || h[c] < low[c]) return false;
    atomic_store_explicit(&marks[block], 1, memory_order_relaxed);
    return true;
}

/* A block's box reaches from two cells before its first node to two behind its last kernel's start. */
static bool mark(const solid *s, const double low[3], const double high[3], _Atomic uint8_t *marks) {
    double l[3], h[3], shift = kernel_shift(s->definition.kernel), all = 1;
    int32_t first[3], last[3], at[3];
    bool any = false;
    for (int c = 0; c < 3; c++) {
        l[c] = low[c] / s->definition.dx, h[c] = high[c] / s->definition.dx;
        double from = floor((l[c] - shift - BLOCK - 2) / BLOCK), to = floor((h[c] - shift + 2) / BLOCK);
        first[c] = (int32_t)fmax(from, -BLOCK_LIMIT + 1), last[c] = (int32_t)fmin(to, BLOCK_LIMIT - 1);
        all *= fmax(0, to - from + 1);
    }
    if (all > s->block_count) {
        for (int32_t b = 0; b < s->block_count; b++) any |= mark_block(s, b, l, h, marks);
        return any;
    }
    for (at[0] = first[0]; at[0] <= last[0]; at[0]++)
        for (at[1] = first[1]; at[1] <= last[1]; at[1]++)
            for (at[2] = first[2]; at[2] <= last[2]; at[2]++) {
                int32_t slot = order_rank(s, block_key(at));
                if (slot >= 0 && s->slot_block[slot] >= 0) any |= mark_block(s, s->slot_block[slot], l, h, marks);
            }
    return any;
}

static int32_t population(const solid *s, int32_t block) {
    int32_t count = 0;
    for (int32_t t = 0; t < s->blocks[block].tile_count; t++) count += s->tiles[s->blocks[block].first_tile + t].count;
    return count;
}

static void places(const solid *s, int32_t block, double *place, int32_t *at, int32_t *id) {
    const solid_block *b = &s->blocks[block];
    for (int32_t t = b->first_tile; t < b->first_tile + b->tile_count; t++)
        for (int32_t p = 0; p < s->tiles[t].count; p++, place += 3) {
            int32_t pack = s->tiles[t].first_pack + p / PACK, lane = p % PACK;
            for (int c = 0; c < 3; c++)
                place[c] = s->definition.dx * ((double)field_at(&s->fields[FIELD_POSITION], pack, c, 0)[lane] + (double)b->coordinate[c] * BLOCK);
            *at++ = pack * PACK + lane;
            *id++ = s->id[pack * PACK + lane];
        }
}

static void motion(const solid *s, int32_t at, double motion[12]) {
    for (int c = 0; c < 3; c++) motion[c] = (double)field_at(&s->fields[FIELD_VELOCITY], at / PACK, c, 0)[at % PACK];
    for (int c = 0; c < 9; c++) motion[3 + c] = (double)field_at(&s->fields[FIELD_AFFINE], at / PACK, c, 0)[at % PACK];
}

static void move(solid *s, int32_t at, const double motion[12]) {
    for (int c = 0; c < 3; c++) field_at(&s->fields[FIELD_VELOCITY], at / PACK, c, 0)[at % PACK] = (real)motion[c];
    for (int c = 0; c < 9; c++) field_at(&s->fields[FIELD_AFFINE], at / PACK, c, 0)[at % PACK] = (real)motion[3 + c];
}

const solid_touch solid_touch_table = {.blocks = blocks, .mark = mark, .population = population, .places = places, .motion = motion, .move = move};
