/* The whole state as records, bit for bit: storage order, block origins and all, so that a restored engine goes on exactly as
 * the saved one would have. */
#include "base/memory.h"
#include "solid/order.h"

#include <stdio.h>

enum { TILE_INTEGERS = 5, BLOCK_INTEGERS = 5, SCALARS = 4 + EFFECT_LIMIT };
static const record_type real_type = SUNDER_PRECISION == 32 ? RECORD_F32 : RECORD_F64;

static status save_tables(const solid *s, record_list *list, report *r) {
    int32_t *tiles = NULL, *blocks = NULL;
    double *scalars = NULL;
    status code = record_add(list, "solid/tiles", RECORD_I32, s->tile_count, TILE_INTEGERS, NULL, (void **)&tiles, r);
    if (code == STATUS_OK)
        code = record_add(list, "solid/blocks", RECORD_I32, s->block_count, BLOCK_INTEGERS, NULL, (void **)&blocks, r);
    if (code == STATUS_OK) code = record_add(list, "solid/scalars", RECORD_F64, SCALARS, 1, NULL, (void **)&scalars, r);
    if (code != STATUS_OK) return code;
    for (int32_t t = 0; t < s->tile_count; t++) {
        const solid_tile *tile = &s->tiles[t];
        int32_t row[TILE_INTEGERS] = {tile->block, tile->material, tile->first_pack, tile->pack_count, tile->count};
        memcpy(tiles + t * TILE_INTEGERS, row, sizeof row);
    }
    for (int32_t b = 0; b < s->block_count; b++) {
        const solid_block *block = &s->blocks[b];
        int32_t row[BLOCK_INTEGERS] = {block->coordinate[0], block->coordinate[1], block->coordinate[2], block->first_tile,
                                       block->tile_count};
        memcpy(blocks + b * BLOCK_INTEGERS, row, sizeof row);
    }
    scalars[0] = s->grip_work;
    memcpy(scalars + 1, s->grip_impulse, sizeof s->grip_impulse);
    memcpy(scalars + 4, s->limits, sizeof s->limits); /* the next step's length depends on them */
    return STATUS_OK;
}

status solid_save(const solid *s, record_list *list, report *r) {
    status code = save_tables(s, list, r);
    if (code != STATUS_OK) return code;
    void *data;
    code = record_add(list, "solid/id", RECORD_I32, (int64_t)s->pack_count * PACK, 1, NULL, &data, r);
    if (code != STATUS_OK) return code;
    memcpy(data, s->id, (size_t)s->pack_count * PACK * sizeof *s->id);
    for (int i = 0; i < s->field_count; i++) {
        char name[RECORD_NAME];
        snprintf(name, sizeof name, "solid/%s", s->fields[i].name);
        code = record_add(list, name, real_type, s->pack_count, s->fields[i].components * PACK, NULL, &data, r);
        if (code != STATUS_OK) return code;
        memcpy(data, s->fields[i].data, (size_t)s->pack_count * (size_t)s->fields[i].components * PACK * sizeof(real));
    }
    if (s->diffusion.field < 0) return STATUS_OK;
    code = record_add(list, "solid/diffusion_clocks", RECORD_F64, 2, 1, NULL, &data, r);
    if (code == STATUS_OK) memcpy(data, (double[]){s->diffusion.clock, s->diffusion.until}, 2 * sizeof(double));
    return code;
}

static status restore_tables(solid *s, const record_list *list, report *r) {
    const record *tiles = record_find(list, "solid/tiles"), *blocks = record_find(list, "solid/blocks");
    if (!tiles || !blocks || tiles->components != TILE_INTEGERS || blocks->components != BLOCK_INTEGERS)
        return report_set(r, STATUS_SYSTEM, "the checkpoint has no tile tables of this version");
    double *scalars;
    status code = record_require(list, "solid/scalars", RECORD_F64, SCALARS, 1, (void **)&scalars, r);
    if (code == STATUS_OK) code = order_reserve_tiles(s, (int32_t)tiles->count, (int32_t)blocks->count, r);
    if (code != STATUS_OK) return code;
    s->tile_count = (int32_t)tiles->count;
    s->block_count = (int32_t)blocks->count;
    s->pack_count = 0;
    int64_t particles = 0;
    for (int32_t t = 0; t < s->tile_count; t++) {
        const int32_t *row = (const int32_t *)tiles->data + t * TILE_INTEGERS;
        s->tiles[t] = (solid_tile){row[0], row[1], row[2], row[3], row[4]};
        s->pack_count += row[3];
        particles += row[4];
    }
    for (int32_t b = 0; b < s->block_count; b++) {
        const int32_t *row = (const int32_t *)blocks->data + b * BLOCK_INTEGERS;
        s->blocks[b] = (solid_block){.coordinate = {row[0], row[1], row[2]}, .first_tile = row[3], .tile_count = row[4]};
    }
    if (particles != s->count)
        return report_set(r, STATUS_SYSTEM, "the checkpoint holds %lld particles, the scene %lld", (long long)particles, (long long)s->count);
    s->grip_work = scalars[0];
    memcpy(s->grip_impulse, scalars + 1, sizeof s->grip_impulse);
    memcpy(s->limits, scalars + 4, sizeof s->limits);
    return STATUS_OK;
}

status solid_restore(solid *s, const record_list *list, report *r) {
    status code = restore_tables(s, list, r);
    if (code == STATUS_OK) code = particles_reserve(s, s->pack_count, r);
    void *data;
    if (code == STATUS_OK) code = record_require(list, "solid/id", RECORD_I32, (int64_t)s->pack_count * PACK, 1, &data, r);
    if (code != STATUS_OK) return code;
    memcpy(s->id, data, (size_t)s->pack_count * PACK * sizeof *s->id);
    for (int i = 0; i < s->field_count; i++) {
        char name[RECORD_NAME];
        snprintf(name, sizeof name, "solid/%s", s->fields[i].name);
        code = record_require(list, name, real_type, s->pack_count, s->fields[i].components * PACK, &data, r);
        if (code != STATUS_OK) return code;
        memcpy(s->fields[i].data, data, (size_t)s->pack_count * (size_t)s->fields[i].components * PACK * sizeof(real));
    }
    double *clocks;
    code = s->diffusion.field < 0 ? STATUS_OK : record_require(list, "solid/diffusion_clocks", RECORD_F64, 2, 1, (void **)&clocks, r);
    if (code != STATUS_OK) return code;
    if (s->diffusion.field >= 0) s->diffusion.clock = clocks[0], s->diffusion.until = clocks[1];
    s->sorted = false; /* the grid's tables are rebuilt with the sort that opens every frame */
    return STATUS_OK;
}
