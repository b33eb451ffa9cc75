/* Sorting: particles back into the blocks, materials and cells where they now are.
 *
 * Order after a sort depends on the order before it and on positions alone. Done lazily: when a particle leaves its block's
 * margin, and at the start of every frame. */
#include "base/memory.h"
#include "solid/order.h"

#include <math.h>

/* The cell of a particle that sits `offset` (in dx) from its old block's first node, and its new block. */
SIMD_INLINE int32_t settle(real offset, real shift, int32_t *block) {
    int32_t base = (int32_t)floor((double)(offset - shift));
    int32_t step = base >= 0 ? base / BLOCK : -((BLOCK - 1 - base) / BLOCK);
    *block += step;
    return base - step * BLOCK;
}

static status make_keys(solid *s, report *r) {
    const solid_field *position = &s->fields[FIELD_POSITION];
    real shift = (real)kernel_shift(s->definition.kernel);
    order_clear_hash(s);
    int64_t n = 0;
    uint64_t last_key = 0, last_entry = 0;
    for (int32_t t = 0; t < s->tile_count; t++) {
        const solid_tile *tile = &s->tiles[t];
        for (int32_t p = 0; p < tile->count; p++) {
            int32_t pack = tile->first_pack + p / PACK, block[3], cell[3];
            memcpy(block, s->blocks[tile->block].coordinate, sizeof block);
            for (int c = 0; c < 3; c++) {
                cell[c] = settle(field_at(position, pack, c, 0)[p % PACK], shift, &block[c]);
                if (block[c] <= -BLOCK_LIMIT + 2 || block[c] >= BLOCK_LIMIT - 2)
                    return report_set(r, STATUS_DIVERGED, "particle %d has left the grid", s->id[pack * PACK + p % PACK]);
            }
            uint64_t key = block_key(block);
            if (key != last_key) last_key = key, last_entry = (uint64_t)order_insert(s, key);
            s->sort_keys[n++] = last_entry << 43 | (uint64_t)tile->material << 38 |
                                (uint64_t)((cell[0] * BLOCK + cell[1]) * BLOCK + cell[2]) << 32 | (uint64_t)(pack * PACK + p % PACK);
        }
    }
    return STATUS_OK;
}

/* Moves one component of a field into the new order; padding repeats its tile's first particle, or is 0. */
static void permute_component(solid *s, const solid_field *f, int component, bool keep_padding) {
    const uint64_t *keys = s->sort_keys;
    for (int64_t i = 0; i < s->count; i++) {
        int32_t source = ORDER_SOURCE(keys[i]);
        s->permute[i] = field_at(f, source / PACK, component, 0)[source % PACK];
    }
    int64_t next = 0;
    for (int32_t t = 0; t < s->tile_count; t++) {
        const solid_tile *tile = &s->tiles[t];
        real padding = keep_padding ? s->permute[next] : 0;
        for (int32_t p = 0; p < tile->pack_count * PACK; p++)
            field_at(f, tile->first_pack + p / PACK, component, 0)[p % PACK] = p < tile->count ? s->permute[next++] : padding;
    }
}

/* Positions change their origin to that of the new block: a whole number of cells, so no digit is lost going inwards. */
static void rebase_positions(solid *s) {
    const solid_field *f = &s->fields[FIELD_POSITION];
    real shift = (real)kernel_shift(s->definition.kernel);
    for (int32_t p = 0; p < s->pack_count * PACK; p++)
        for (int c = 0; c < 3; c++) {
            int32_t step = 0;
            real *x = &field_at(f, p / PACK, c, 0)[p % PACK];
            settle(*x, shift, &step);
            *x -= (real)(step * BLOCK);
        }
}

static void permute_ids(solid *s) {
    int32_t *order = (int32_t *)s->sort_keys2; /* free after the radix sort */
    for (int64_t i = 0; i < s->count; i++) order[i] = s->id[ORDER_SOURCE(s->sort_keys[i])];
    int64_t next = 0;
    for (int32_t t = 0; t < s->tile_count; t++) {
        const solid_tile *tile = &s->tiles[t];
        for (int32_t p = 0; p < tile->pack_count * PACK; p++)
            s->id[tile->first_pack * PACK + p] = p < tile->count ? order[next++] : -1;
    }
}

status particles_sort(solid *s, report *r) {
    status code = order_reserve_hash(s, 8 * (int64_t)s->block_count, r);
    if (code != STATUS_OK) return code;
    if ((code = make_keys(s, r)) != STATUS_OK) return code;
    int32_t blocks;
    if ((code = order_rank_all(s, &blocks, r)) != STATUS_OK) return code;
    order_sort_keys(s, s->count, blocks);
    code = order_build_tiles(s, s->count, r);
    if (code == STATUS_OK) code = particles_reserve(s, s->pack_count, r);
    if (code != STATUS_OK) return code;
    permute_ids(s);
    for (int i = 0; i < s->field_count; i++) {
        bool keep = i != FIELD_VOLUME && i != FIELD_VELOCITY && i != FIELD_AFFINE;
        for (int c = 0; c < s->fields[i].components; c++) permute_component(s, &s->fields[i], c, keep);
    }
    rebase_positions(s);
    if ((code = grid_build(s, r)) != STATUS_OK) return code;
    s->sorted = true;
    return STATUS_OK;
}
