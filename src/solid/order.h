/* Putting particles in order: blocks, materials and cells from keys. Shared by loading (from world positions) and sorting
 * (from the engine's own). */
#ifndef SUNDER_SOLID_ORDER_H
#define SUNDER_SOLID_ORDER_H

#include "solid/state.h"

/* A block's coordinates fit 21 bits a direction; particles beyond have left the domain. */
enum { BLOCK_LIMIT = 1 << 20 };

/* Where a kernel starts relative to floor(x / dx): the first node of a particle at x (in dx) is floor(x − shift). */
SIMD_INLINE double kernel_shift(kernel_kind kernel) {
    return kernel == KERNEL_QUADRATIC ? 0.5 : 1.0;
}

/* Lexicographic order of keys is that of coordinates, x first. */
static inline uint64_t block_key(const int32_t c[3]) {
    return ((uint64_t)(c[0] + BLOCK_LIMIT) << 42) | ((uint64_t)(c[1] + BLOCK_LIMIT) << 21) | (uint64_t)(c[2] + BLOCK_LIMIT);
}

static inline void block_coordinate(uint64_t key, int32_t c[3]) {
    c[0] = (int32_t)((key >> 42) & 0x1fffff) - BLOCK_LIMIT;
    c[1] = (int32_t)((key >> 21) & 0x1fffff) - BLOCK_LIMIT;
    c[2] = (int32_t)(key & 0x1fffff) - BLOCK_LIMIT;
}

/* A set of block keys with their ranks; capacity is a power of two, empty entries hold key 0 (no valid key is 0, since
 * coordinates stay above −BLOCK_LIMIT). */
status order_reserve_hash(solid *s, int64_t keys, report *r);
void order_clear_hash(solid *s);
/* Inserts a key; returns its entry, or −1 when the table is half full (reserve more, clear, start again). */
int64_t order_insert(solid *s, uint64_t key);
/* The rank of a key, or −1 when it is not in the set. */
int32_t order_rank(const solid *s, uint64_t key);
/* Ranks all keys ascending, leaving them in s->block_list, and says how many there are. */
status order_rank_all(solid *s, int32_t *count, report *r);

/* keys[i] = entry << 43 | material << 38 | cell << 32 | source: replaces entries by ranks and sorts by all but the source, stably. `keys` has
 * room for 2 · count; the result is in the first half. */
void order_sort_keys(const solid *s, uint64_t *keys, int64_t count, int32_t blocks);

/* Cuts the sorted keys into blocks and tiles (s->tiles, s->blocks, s->pack_count). */
status order_build_tiles(solid *s, const uint64_t *keys, int64_t count, report *r);

/* The same one by one, where there is room: a block by its key, then runs of its particles of one material, materials ascending. */
void order_add_block(solid *s, uint64_t key);
void order_add_run(solid *s, int32_t material, int64_t particles);

/* Room for that many tiles and blocks. */
status order_reserve_tiles(solid *s, int32_t tiles, int32_t blocks, report *r);

/* Grows an array of `size`-byte elements to hold `need` of them; keeps contents. */
status order_grow(void **array, int32_t *capacity, int32_t need, size_t size, const char *what, report *r);

#define ORDER_MATERIAL(key) ((int32_t)((key) >> 38 & 31))
#define ORDER_BLOCK(key) ((int32_t)((key) >> 43))
#define ORDER_SOURCE(key) ((int32_t)((key)&0xffffffffu))

#endif
