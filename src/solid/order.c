#include "solid/order.h"

#include "base/compare.h"
#include "base/memory.h"
#include "base/random.h"

#include <stdlib.h>

status order_reserve_hash(solid *s, int64_t keys, report *r) {
    int64_t capacity = s->hash_capacity ? s->hash_capacity : 1024;
    while (capacity < 4 * keys) capacity *= 2;
    if (capacity == s->hash_capacity) return STATUS_OK;
    memory_free(s->block_keys, (size_t)s->hash_capacity * sizeof *s->block_keys);
    memory_free(s->block_ranks, (size_t)s->hash_capacity * sizeof *s->block_ranks);
    s->hash_capacity = 0;
    s->block_keys = memory_allocate_array((size_t)capacity, sizeof *s->block_keys);
    s->block_ranks = memory_allocate_array((size_t)capacity, sizeof *s->block_ranks);
    if (!s->block_keys || !s->block_ranks) {
        memory_free(s->block_keys, (size_t)capacity * sizeof *s->block_keys);
        memory_free(s->block_ranks, (size_t)capacity * sizeof *s->block_ranks);
        s->block_keys = NULL, s->block_ranks = NULL;
        return report_set(r, STATUS_SYSTEM, "out of memory for the block table");
    }
    s->hash_capacity = capacity;
    return STATUS_OK;
}

void order_clear_hash(solid *s) {
    memset(s->block_keys, 0, (size_t)s->hash_capacity * sizeof *s->block_keys);
    s->hash_used = 0;
}

static int64_t find_entry(const solid *s, uint64_t key) {
    int64_t mask = s->hash_capacity - 1, entry = (int64_t)(random_mix(key) & (uint64_t)mask);
    while (s->block_keys[entry] != 0 && s->block_keys[entry] != key) entry = (entry + 1) & mask;
    return entry;
}

int64_t order_insert(solid *s, uint64_t key) {
    int64_t entry = find_entry(s, key);
    if (s->block_keys[entry] == key) return entry;
    if (2 * s->hash_used >= s->hash_capacity) return -1;
    s->hash_used++;
    s->block_keys[entry] = key;
    return entry;
}

int32_t order_rank(const solid *s, uint64_t key) {
    int64_t entry = find_entry(s, key);
    return s->block_keys[entry] ? s->block_ranks[entry] : -1;
}

status order_grow(void **array, int32_t *capacity, int32_t need, size_t size, const char *what, report *r) {
    if (need <= *capacity) return STATUS_OK;
    int32_t wanted = need + need / 8 + 16;
    void *fresh = memory_resize(*array, (size_t)*capacity * size, (size_t)wanted * size);
    if (!fresh) return report_set(r, STATUS_SYSTEM, "out of memory for %s", what);
    *array = fresh;
    *capacity = wanted;
    return STATUS_OK;
}

status order_rank_all(solid *s, int32_t *count, report *r) {
    status code = order_grow((void **)&s->block_list, &s->block_list_capacity, (int32_t)s->hash_used, sizeof *s->block_list,
                             "the block list", r);
    if (code != STATUS_OK) return code;
    int32_t n = 0;
    for (int64_t i = 0; i < s->hash_capacity; i++)
        if (s->block_keys[i]) s->block_list[n++] = s->block_keys[i];
    qsort(s->block_list, (size_t)n, sizeof *s->block_list, compare_u64);
    for (int32_t i = 0; i < n; i++) s->block_ranks[find_entry(s, s->block_list[i])] = i;
    *count = n;
    return STATUS_OK;
}

enum { DIGIT_BITS = 11, DIGITS = 1 << DIGIT_BITS };

/* One stable pass of a least-significant-digit radix sort. */
static void radix_pass(const uint64_t *from, uint64_t *to, int64_t count, int shift) {
    int64_t start[DIGITS] = {0};
    for (int64_t i = 0; i < count; i++) start[(from[i] >> shift) & (DIGITS - 1)]++;
    int64_t total = 0;
    for (int d = 0; d < DIGITS; d++) {
        int64_t here = start[d];
        start[d] = total;
        total += here;
    }
    for (int64_t i = 0; i < count; i++) to[start[(from[i] >> shift) & (DIGITS - 1)]++] = from[i];
}

void order_sort_keys(const solid *s, uint64_t *keys, int64_t count, int32_t blocks) {
    for (int64_t i = 0; i < count; i++) keys[i] = (keys[i] & 0x7ffffffffffu) | (uint64_t)s->block_ranks[keys[i] >> 43] << 43;
    uint64_t *from = keys, *to = keys + count;
    int bits = 11;
    while ((int64_t)1 << (bits - 11) < blocks) bits++;
    for (int done = 0; done < bits; done += DIGIT_BITS) {
        radix_pass(from, to, count, 32 + done);
        uint64_t *swap = from;
        from = to;
        to = swap;
    }
    if (from != keys) memcpy(keys, from, (size_t)count * sizeof *keys);
}

status order_reserve_tiles(solid *s, int32_t tiles, int32_t blocks, report *r) {
    status code = order_grow((void **)&s->tile_results, &s->result_capacity, tiles, sizeof *s->tile_results, "tiles", r);
    if (code == STATUS_OK) code = order_grow((void **)&s->tiles, &s->tile_capacity, tiles, sizeof *s->tiles, "tiles", r);
    if (code == STATUS_OK)
        code = order_grow((void **)&s->colour_blocks, &s->colour_capacity, blocks, sizeof *s->colour_blocks, "blocks", r);
    if (code == STATUS_OK) code = order_grow((void **)&s->blocks, &s->block_capacity, blocks, sizeof *s->blocks, "blocks", r);
    return code;
}

/* Particles of key i's block and material that follow it, itself included. */
static int64_t run_length(const uint64_t *keys, int64_t i, int64_t count) {
    int64_t end = i;
    while (end < count && keys[end] >> 38 == keys[i] >> 38) end++;
    return end - i;
}

void order_add_block(solid *s, uint64_t key) {
    solid_block *block = &s->blocks[s->block_count++];
    *block = (solid_block){.first_tile = s->tile_count};
    block_coordinate(key, block->coordinate);
}

void order_add_run(solid *s, int32_t material, int64_t particles) {
    for (int64_t done = 0; done < particles; done += TILE_PARTICLES) {
        int32_t here = (int32_t)(particles - done < TILE_PARTICLES ? particles - done : TILE_PARTICLES);
        int32_t packs = (here + PACK - 1) / PACK;
        s->tiles[s->tile_count++] = (solid_tile){.block = s->block_count - 1, .material = material,
                                                 .first_pack = s->pack_count, .pack_count = packs, .count = here};
        s->pack_count += packs;
    }
    s->blocks[s->block_count - 1].tile_count = s->tile_count - s->blocks[s->block_count - 1].first_tile;
}

status order_build_tiles(solid *s, const uint64_t *keys, int64_t count, report *r) {
    int32_t tiles = 0, blocks = 0;
    for (int64_t i = 0, n; i < count; i += n) {
        n = run_length(keys, i, count);
        tiles += (int32_t)((n + TILE_PARTICLES - 1) / TILE_PARTICLES);
        blocks += i == 0 || ORDER_BLOCK(keys[i]) != ORDER_BLOCK(keys[i - 1]);
    }
    status code = order_reserve_tiles(s, tiles, blocks, r);
    if (code != STATUS_OK) return code;
    s->tile_count = s->block_count = s->pack_count = 0;
    for (int64_t i = 0, n; i < count; i += n) {
        n = run_length(keys, i, count);
        if (i == 0 || ORDER_BLOCK(keys[i]) != ORDER_BLOCK(keys[i - 1])) order_add_block(s, s->block_list[ORDER_BLOCK(keys[i])]);
        order_add_run(s, ORDER_MATERIAL(keys[i]), n);
    }
    return STATUS_OK;
}
