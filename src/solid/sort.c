/* Sorting: particles back into the blocks, materials and cells where they now are.
 *
 * Order after a sort depends on the order before it and on positions alone. Done lazily: when a particle leaves its block's
 * margin, and at the start of every frame. Until then no particle gets past the blocks around its own. So each old block says how many of its
 * particles go to which of 27 neighbours, which gives each of them its share of the new block; and then each new block sorts its own by material
 * and cell. What takes time works on all threads, block by block, and no two write to the same place. */
#include "base/memory.h"
#include "base/threads.h"
#include "solid/order.h"
#include "solid/tensor.h"

enum { CELLS = BLOCK * BLOCK * BLOCK, CELL_BITS = 6, MATERIAL_BITS = 5, PACKS_AT_ONCE = 64 };
_Static_assert(CELLS == 1 << CELL_BITS && SOLID_MATERIALS <= 1 << MATERIAL_BITS, "a particle's code has these fields");

/* code = neighbour << 11 | material << 6 | cell */
static int code_neighbour(uint16_t code) {
    return code >> (MATERIAL_BITS + CELL_BITS);
}

static int code_bin(uint16_t code) {
    return code & ((1 << (MATERIAL_BITS + CELL_BITS)) - 1);
}

/* ---- where particles go ------------------------------------------------------------------------------------------ */

/* A NaN becomes `low`: the numbers index tables, whatever the state is like. */
SIMD_INLINE vec bounded(vec x, real low, real high) {
    return vec_min(vec_max(x, vec_all(low)), vec_all(high));
}

/* Along one axis: adds the step to the neighbouring block (0, 1, 2) and the cell there to what is packed so far. */
SIMD_INLINE void settle(vec x, real shift, vec *neighbour, vec *cell) {
    vec base = vec_floor(x - shift), block = vec_floor(base * (real)(1.0 / BLOCK));
    *neighbour = *neighbour * 3 + bounded(block + 1, 0, 2);
    *cell = *cell * (real)BLOCK + bounded(base - block * (real)BLOCK, 0, BLOCK - 1);
}

static void code_pack(solid *s, const solid_tile *tile, int32_t pack, real shift, int32_t count, int32_t *moves) {
    for (int part = 0; part < PACK_PARTS; part++) {
        vec neighbour = vec_all(0), cell = vec_all(0);
        vec3v x = vec3v_load(&s->fields[FIELD_POSITION], pack, part);
        settle(x.x, shift, &neighbour, &cell);
        settle(x.y, shift, &neighbour, &cell);
        settle(x.z, shift, &neighbour, &cell);
        for (int lane = 0; lane < VEC_LANES && part * VEC_LANES + lane < count; lane++) {
            int n = (int)neighbour[lane];
            s->sort_codes[pack * PACK + part * VEC_LANES + lane] =
                (uint16_t)(n << (MATERIAL_BITS + CELL_BITS) | tile->material << CELL_BITS | (int)cell[lane]);
            moves[n]++;
        }
    }
}

static void code_block(void *context, int64_t block, int worker) {
    (void)worker;
    solid *s = context;
    const solid_block *b = &s->blocks[block];
    real shift = (real)kernel_shift(s->definition.kernel);
    int32_t *moves = s->sort_moves[block];
    memset(moves, 0, sizeof s->sort_moves[block]);
    for (int32_t t = b->first_tile; t < b->first_tile + b->tile_count; t++)
        for (int32_t k = 0; k < s->tiles[t].pack_count; k++)
            code_pack(s, &s->tiles[t], s->tiles[t].first_pack + k, shift, s->tiles[t].count - k * PACK, moves);
}

/* ---- the new blocks ---------------------------------------------------------------------------------------------- */

static uint64_t neighbour_key(const solid_block *b, int n) {
    const int32_t c[3] = {b->coordinate[0] + n / 9 - 1, b->coordinate[1] + n / 3 % 3 - 1, b->coordinate[2] + n % 3 - 1};
    return block_key(c);
}

static status check_domain(const solid *s, report *r) {
    for (int32_t b = 0; b < s->block_count; b++)
        for (int c = 0; c < 3; c++)
            if (s->blocks[b].coordinate[c] <= -BLOCK_LIMIT + 2 || s->blocks[b].coordinate[c] >= BLOCK_LIMIT - 2)
                return report_set(r, STATUS_DIVERGED, "particle %d has left the grid", s->id[s->tiles[s->blocks[b].first_tile].first_pack * PACK]);
    return STATUS_OK;
}

static status find_blocks(solid *s, int32_t *blocks, report *r) {
    status code = check_domain(s, r);
    if (code != STATUS_OK) return code;
    for (int64_t room = 2 * (int64_t)s->block_count;; room *= 2) {
        bool full = false;
        if ((code = order_reserve_hash(s, room, r)) != STATUS_OK) return code;
        order_clear_hash(s);
        for (int32_t b = 0; b < s->block_count && !full; b++)
            for (int n = 0; n < NEIGHBOURS && !full; n++)
                full = s->sort_moves[b][n] > 0 && order_insert(s, neighbour_key(&s->blocks[b], n)) < 0;
        if (!full) return order_rank_all(s, blocks, r);
    }
}

/* Counts become places: new blocks in order of rank, in each the particles of old blocks in their order. */
static status share_out(solid *s, int32_t blocks, report *r) {
    status code = order_grow((void **)&s->sort_starts, &s->sort_start_capacity, blocks + 1, sizeof *s->sort_starts, "sorting", r);
    if (code != STATUS_OK) return code;
    memset(s->sort_starts, 0, ((size_t)blocks + 1) * sizeof *s->sort_starts);
    for (int32_t b = 0; b < s->block_count; b++)
        for (int n = 0; n < NEIGHBOURS; n++)
            if (s->sort_moves[b][n] > 0) s->sort_starts[order_rank(s, neighbour_key(&s->blocks[b], n)) + 1] += s->sort_moves[b][n];
    for (int32_t i = 0; i < blocks; i++) s->sort_starts[i + 1] += s->sort_starts[i];
    for (int32_t b = 0; b < s->block_count; b++)
        for (int n = 0; n < NEIGHBOURS; n++) {
            int32_t count = s->sort_moves[b][n];
            if (count == 0) continue;
            int32_t *start = &s->sort_starts[order_rank(s, neighbour_key(&s->blocks[b], n))];
            s->sort_moves[b][n] = *start;
            *start += count;
        }
    for (int32_t i = blocks; i > 0; i--) s->sort_starts[i] = s->sort_starts[i - 1];
    s->sort_starts[0] = 0;
    return STATUS_OK;
}

/* sort_order[place] = source */
static void move_block(void *context, int64_t block, int worker) {
    (void)worker;
    solid *s = context;
    const solid_block *b = &s->blocks[block];
    int32_t *place = s->sort_moves[block];
    for (int32_t t = b->first_tile; t < b->first_tile + b->tile_count; t++)
        for (int32_t p = s->tiles[t].first_pack * PACK; p < s->tiles[t].first_pack * PACK + s->tiles[t].count; p++)
            s->sort_order[place[code_neighbour(s->sort_codes[p])]++] = p;
}

/* A new block's particles by material and cell, stably, into the permutation's buffer; and how many there are of each material. */
static void sort_block(void *context, int64_t block, int worker) {
    (void)worker;
    solid *s = context;
    int32_t begin = s->sort_starts[block], end = s->sort_starts[block + 1], total = 0, *sorted = (int32_t *)(void *)s->permute + begin;
    int32_t place[SOLID_MATERIALS * CELLS], bins = s->definition.material_count * CELLS;
    memset(place, 0, (size_t)bins * sizeof *place);
    for (int32_t i = begin; i < end; i++) place[code_bin(s->sort_codes[s->sort_order[i]])]++;
    for (int32_t bin = 0; bin < bins; bin++) {
        int32_t here = place[bin];
        place[bin] = total;
        total += here;
        if ((bin + 1) % CELLS == 0) s->sort_materials[block * s->definition.material_count + bin / CELLS] = total;
    }
    for (int32_t i = begin; i < end; i++) sorted[place[code_bin(s->sort_codes[s->sort_order[i]])]++] = s->sort_order[i];
}

static status build_tiles(solid *s, int32_t blocks, report *r) {
    int32_t materials = s->definition.material_count;
    status code = order_reserve_tiles(s, (int32_t)(s->count / TILE_PARTICLES) + blocks * materials, blocks, r);
    if (code != STATUS_OK) return code;
    s->tile_count = s->block_count = s->pack_count = 0;
    for (int32_t b = 0; b < blocks; b++) {
        order_add_block(s, s->block_list[b]);
        for (int32_t m = 0, done = 0; m < materials; m++) {
            order_add_run(s, m, s->sort_materials[b * materials + m] - done);
            done = s->sort_materials[b * materials + m];
        }
    }
    return STATUS_OK;
}

/* ---- moving ------------------------------------------------------------------------------------------------------ */

/* sort_order in the new packs: each lane's source; of padding ~source, that of its tile's first particle. */
static void spread_block(void *context, int64_t block, int worker) {
    (void)worker;
    solid *s = context;
    const solid_block *b = &s->blocks[block];
    const int32_t *source = (const int32_t *)(const void *)s->permute + s->sort_starts[block];
    for (int32_t t = b->first_tile; t < b->first_tile + b->tile_count; source += s->tiles[t++].count) {
        int32_t *to = s->sort_order + s->tiles[t].first_pack * PACK;
        for (int32_t p = 0; p < s->tiles[t].pack_count * PACK; p++) to[p] = p < s->tiles[t].count ? source[p] : ~source[0];
    }
}

typedef struct move_context {
    solid *state;
    const solid_field *field;
    int component;
    bool keep_padding;
} move_context;

static int64_t chunk_end(const solid *s, int64_t chunk) {
    int64_t end = (chunk + 1) * PACKS_AT_ONCE;
    return (end < s->pack_count ? end : s->pack_count) * PACK;
}

enum { AHEAD = 48 /* particles whose sources are called for before they are read */ };

static uint32_t source_of(int32_t entry) {
    return (uint32_t)(entry < 0 ? ~entry : entry);
}

static void collect(void *context, int64_t chunk, int worker) {
    (void)worker;
    const move_context *c = context;
    const int32_t *order = c->state->sort_order;
    real *out = c->state->permute;
    int64_t stride = (int64_t)c->field->components * PACK, end = chunk_end(c->state, chunk);
    const real *from = c->field->data + c->component * PACK;
    for (int64_t i = chunk * PACKS_AT_ONCE * PACK; i < end; i++) {
        uint32_t source = source_of(order[i]);
        if (i + AHEAD < end) __builtin_prefetch(from + source_of(order[i + AHEAD]) / PACK * stride);
        real value = from[source / PACK * stride + source % PACK];
        out[i] = order[i] < 0 && !c->keep_padding ? 0 : value;
    }
}

static void put_back(void *context, int64_t chunk, int worker) {
    (void)worker;
    const move_context *c = context;
    int64_t end = chunk_end(c->state, chunk) / PACK;
    for (int64_t pack = chunk * PACKS_AT_ONCE; pack < end; pack++)
        memcpy(field_at(c->field, (int32_t)pack, c->component, 0), c->state->permute + pack * PACK, PACK * sizeof(real));
}

static void collect_ids(void *context, int64_t chunk, int worker) {
    (void)worker;
    solid *s = context;
    int32_t *out = (int32_t *)(void *)s->permute;
    int64_t end = chunk_end(s, chunk);
    for (int64_t i = chunk * PACKS_AT_ONCE * PACK; i < end; i++) out[i] = s->sort_order[i] < 0 ? -1 : s->id[s->sort_order[i]];
}

/* Positions change their origin to that of the new block: a whole number of cells, so no digit is lost going inwards. */
static void rebase(void *context, int64_t chunk, int worker) {
    (void)worker;
    solid *s = context;
    const solid_field *f = &s->fields[FIELD_POSITION];
    real shift = (real)kernel_shift(s->definition.kernel);
    int64_t end = chunk_end(s, chunk) / PACK;
    for (int64_t pack = chunk * PACKS_AT_ONCE; pack < end; pack++)
        for (int c = 0; c < 3; c++)
            for (int part = 0; part < PACK_PARTS; part++) {
                real *to = field_at(f, (int32_t)pack, c, part);
                vec x = vec_load(to), block = vec_floor(vec_floor(x - shift) * (real)(1.0 / BLOCK));
                vec_store(to, x - block * (real)BLOCK);
            }
}

static void move_all(solid *s) {
    int64_t chunks = (s->pack_count + PACKS_AT_ONCE - 1) / PACKS_AT_ONCE;
    parallel_for(s->threads, chunks, 1, collect_ids, s);
    memcpy(s->id, s->permute, (size_t)s->pack_count * PACK * sizeof *s->id);
    for (int i = 0; i < s->field_count; i++) {
        bool keep = i != FIELD_VOLUME && i != FIELD_VELOCITY && i != FIELD_AFFINE;
        for (int c = 0; c < s->fields[i].components; c++) {
            move_context move = {s, &s->fields[i], c, keep};
            parallel_for(s->threads, chunks, 1, collect, &move);
            parallel_for(s->threads, chunks, 1, put_back, &move);
        }
    }
    parallel_for(s->threads, chunks, 1, rebase, s);
}

status particles_sort(solid *s, report *r) {
    int32_t blocks;
    status code = order_grow((void **)&s->sort_moves, &s->sort_move_capacity, s->block_count, sizeof *s->sort_moves, "sorting", r);
    if (code != STATUS_OK) return code;
    parallel_for(s->threads, s->block_count, 4, code_block, s);
    if ((code = find_blocks(s, &blocks, r)) != STATUS_OK) return code;
    if ((code = share_out(s, blocks, r)) != STATUS_OK) return code;
    code = order_grow((void **)&s->sort_materials, &s->sort_material_capacity, blocks * s->definition.material_count, sizeof *s->sort_materials, "sorting", r);
    if (code != STATUS_OK) return code;
    parallel_for(s->threads, s->block_count, 4, move_block, s);
    parallel_for(s->threads, blocks, 4, sort_block, s);
    if ((code = build_tiles(s, blocks, r)) != STATUS_OK) return code;
    if ((code = particles_reserve(s, s->pack_count, r)) != STATUS_OK) return code;
    parallel_for(s->threads, s->block_count, 4, spread_block, s);
    move_all(s);
    if ((code = grid_build(s, r)) != STATUS_OK) return code;
    s->sorted = true;
    return STATUS_OK;
}
