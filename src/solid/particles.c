/* Particle storage: reserving, loading from a definition, reading back in order of id. */
#include "base/memory.h"
#include "solid/order.h"

#include <math.h>

static size_t field_bytes(const solid_field *f, int32_t packs) {
    return (size_t)packs * (size_t)f->components * PACK * sizeof(real);
}

/* Every array that holds packs: where its address is kept, and bytes a pack. */
typedef struct pack_array {
    void *address;
    size_t bytes;
} pack_array;

enum { SORT_ARRAYS = 4, PACK_ARRAYS = FIELD_LIMIT + SORT_ARRAYS };

static int list_pack_arrays(solid *s, pack_array list[PACK_ARRAYS]) {
    int count = 0;
    list[count++] = (pack_array){&s->id, PACK * sizeof *s->id};
    list[count++] = (pack_array){&s->sort_codes, PACK * sizeof *s->sort_codes};
    list[count++] = (pack_array){&s->sort_order, PACK * sizeof *s->sort_order};
    list[count++] = (pack_array){&s->permute, PACK * sizeof *s->permute};
    for (int i = 0; i < s->field_count; i++) list[count++] = (pack_array){&s->fields[i].data, field_bytes(&s->fields[i], 1)};
    return count;
}

size_t particles_bytes(const solid *s) {
    size_t bytes = PACK * (sizeof *s->id + sizeof *s->sort_codes + sizeof *s->sort_order + sizeof *s->permute);
    for (int i = 0; i < s->field_count; i++) bytes += field_bytes(&s->fields[i], 1);
    return bytes * (size_t)s->pack_capacity;
}

/* Pointers of several types are copied, not cast. */
static void *array_of(const pack_array *a) {
    void *data;
    memcpy(&data, a->address, sizeof data);
    return data;
}

static void set_array(const pack_array *a, void *data) {
    memcpy(a->address, &data, sizeof data);
}

static void free_packs(const pack_array *list, int begin, int end, int32_t capacity) {
    for (int i = begin; i < end; i++) {
        memory_free(array_of(&list[i]), list[i].bytes * (size_t)capacity);
        set_array(&list[i], NULL);
    }
}

status particles_reserve(solid *s, int32_t packs, report *r) {
    if (packs <= s->pack_capacity) return STATUS_OK;
    int32_t capacity = packs + packs / 32 + 8;
    pack_array list[PACK_ARRAYS];
    int count = list_pack_arrays(s, list);
    for (int i = 0; i < count; i++) {
        void *data = memory_resize(array_of(&list[i]), list[i].bytes * (size_t)s->pack_capacity, list[i].bytes * (size_t)capacity);
        if (!data) { /* every array must have the size that pack_capacity says, or sized frees would lie */
            free_packs(list, 0, i, capacity);
            free_packs(list, i, count, s->pack_capacity);
            s->pack_capacity = s->pack_count = s->tile_count = s->block_count = 0;
            return report_set(r, STATUS_SYSTEM, "out of memory for %d packs of particles", capacity);
        }
        set_array(&list[i], data);
    }
    s->pack_capacity = capacity;
    return STATUS_OK;
}

void particles_free(solid *s) {
    pack_array list[PACK_ARRAYS];
    free_packs(list, 0, list_pack_arrays(s, list), s->pack_capacity);
    memory_free(s->tiles, (size_t)s->tile_capacity * sizeof *s->tiles);
    memory_free(s->tile_results, (size_t)s->result_capacity * sizeof *s->tile_results);
    memory_free(s->blocks, (size_t)s->block_capacity * sizeof *s->blocks);
    memory_free(s->colour_blocks, (size_t)s->colour_capacity * sizeof *s->colour_blocks);
    memory_free(s->waits, (size_t)s->wait_capacity * sizeof *s->waits);
    memory_free((void *)s->block_done, (size_t)s->done_capacity * sizeof *s->block_done);
    memory_free(s->block_keys, (size_t)s->hash_capacity * sizeof *s->block_keys);
    memory_free(s->block_ranks, (size_t)s->hash_capacity * sizeof *s->block_ranks);
    memory_free(s->block_list, (size_t)s->block_list_capacity * sizeof *s->block_list);
    memory_free(s->sort_moves, (size_t)s->sort_move_capacity * sizeof *s->sort_moves);
    memory_free(s->sort_starts, (size_t)s->sort_start_capacity * sizeof *s->sort_starts);
    memory_free(s->sort_materials, (size_t)s->sort_material_capacity * sizeof *s->sort_materials);
}

/* Splits a world coordinate into the block that owns it, the first node of its kernel within the block, and its distance (in
 * dx) from the block's first node. */
static status place(double x, double dx, double shift, int32_t *block, int32_t *cell, double *offset) {
    double cells = x / dx, base = floor(cells - shift), owner = floor(base / BLOCK);
    if (!(fabs(owner) < BLOCK_LIMIT - 2)) return STATUS_INPUT;
    *block = (int32_t)owner;
    *cell = (int32_t)(base - owner * BLOCK);
    *offset = cells - owner * BLOCK;
    return STATUS_OK;
}

static status load_keys(solid *s, uint64_t *keys, bool *full, report *r) {
    const solid_definition *d = &s->definition;
    double shift = kernel_shift(d->kernel), offset;
    order_clear_hash(s);
    for (int64_t i = 0; i < s->count; i++) {
        int32_t block[3], cell[3];
        for (int c = 0; c < 3; c++)
            if (place(d->position[3 * i + c], d->dx, shift, &block[c], &cell[c], &offset) != STATUS_OK)
                return report_set(r, STATUS_INPUT, "particle %lld lies too far from the origin for this grid spacing", (long long)i);
        int64_t entry = order_insert(s, block_key(block));
        if ((*full = entry < 0)) return STATUS_OK;
        keys[i] = (uint64_t)entry << 43 | (uint64_t)d->material[i] << 38 |
                          (uint64_t)((cell[0] * BLOCK + cell[1]) * BLOCK + cell[2]) << 32 | (uint64_t)i;
    }
    return STATUS_OK;
}

/* Damage at the start, with the driving that holds it: d = H/(1 + H). Undriven, the implicit form would let it relax on the nodes. */
static void load_damage(solid *s, int32_t pack, int lane, double damage) {
    field_at(&s->fields[s->damage_field], pack, 0, 0)[lane] = (real)damage;
    field_at(&s->fields[s->history_field], pack, 0, 0)[lane] = (real)fmin(damage / fmax(1 - damage, 1e-6), 1e6);
}

/* Writes particle i of the definition into a slot; `alive` false makes it padding. */
static void load_particle(solid *s, int32_t pack, int lane, int64_t i, bool alive) {
    const solid_definition *d = &s->definition;
    double shift = kernel_shift(d->kernel);
    s->id[pack * PACK + lane] = alive ? (int32_t)i : -1;
    for (int c = 0; c < 3; c++) {
        int32_t block, cell;
        double offset = 0;
        (void)place(d->position[3 * i + c], d->dx, shift, &block, &cell, &offset); /* checked by load_keys */
        field_at(&s->fields[FIELD_POSITION], pack, c, 0)[lane] = (real)offset;
        field_at(&s->fields[FIELD_VELOCITY], pack, c, 0)[lane] = alive ? (real)d->velocity[3 * i + c] : 0;
        field_at(&s->fields[FIELD_DEFORMATION], pack, 4 * c, 0)[lane] = 1;
        if (s->fibre_field >= 0) field_at(&s->fields[s->fibre_field], pack, c, 0)[lane] = (real)d->fibre1[3 * i + c];
        if (s->fibre2_field >= 0) field_at(&s->fields[s->fibre2_field], pack, c, 0)[lane] = (real)d->fibre2[3 * i + c];
    }
    for (int g = 0; g < d->given_count; g++)
        for (int f = FIELD_BUILT_IN; f < s->field_count; f++)
            if (strcmp(s->fields[f].name, d->given[g].field) == 0) field_at(&s->fields[f], pack, 0, 0)[lane] = (real)d->given[g].value[i];
    if (s->damage_field >= 0 && d->damage) load_damage(s, pack, lane, alive ? d->damage[i] : 0);
    field_at(&s->fields[FIELD_VOLUME], pack, 0, 0)[lane] = alive ? (real)d->volume[i] : 0;
}

/* Keys of all particles; the block table grows until they fit. */
static status load_all_keys(solid *s, uint64_t *keys, report *r) {
    int64_t guess = 1024;
    for (;;) {
        status code = order_reserve_hash(s, guess, r);
        if (code != STATUS_OK) return code;
        bool full = false;
        if ((code = load_keys(s, keys, &full, r)) != STATUS_OK) return code;
        if (!full) return STATUS_OK;
        guess *= 4;
    }
}

/* keys: two arrays of `count`. */
static status load_in_order(solid *s, uint64_t *keys, report *r) {
    status code = load_all_keys(s, keys, r);
    if (code != STATUS_OK) return code;
    int32_t blocks;
    if ((code = order_rank_all(s, &blocks, r)) != STATUS_OK) return code;
    order_sort_keys(s, keys, s->count, blocks);
    code = order_build_tiles(s, keys, s->count, r);
    if (code == STATUS_OK) code = particles_reserve(s, s->pack_count, r);
    if (code != STATUS_OK) return code;
    int64_t next = 0;
    for (int32_t t = 0; t < s->tile_count; t++) {
        const solid_tile *tile = &s->tiles[t];
        int64_t first = next;
        for (int32_t p = 0; p < tile->pack_count * PACK; p++) {
            bool alive = p < tile->count;
            load_particle(s, tile->first_pack + p / PACK, p % PACK, ORDER_SOURCE(keys[alive ? next++ : first]), alive);
        }
    }
    return STATUS_OK;
}

status particles_load(solid *s, report *r) {
    uint64_t *keys = memory_allocate_array((size_t)s->count, 2 * sizeof *keys);
    if (!keys) return report_set(r, STATUS_SYSTEM, "out of memory for %lld particles", (long long)s->count);
    status code = load_in_order(s, keys, r);
    memory_free(keys, (size_t)s->count * 2 * sizeof *keys);
    return code;
}

static const solid_field *find_field(const solid *s, const char *name) {
    for (int i = 0; i < s->field_count; i++)
        if (strcmp(s->fields[i].name, name) == 0) return &s->fields[i];
    return NULL;
}

int particles_read(const solid *s, const char *name, double *out) {
    const solid_field *f = find_field(s, name);
    if (!f) return 0;
    if (!out) return f->components;
    bool position = f == &s->fields[FIELD_POSITION];
    for (int32_t t = 0; t < s->tile_count; t++) {
        const solid_tile *tile = &s->tiles[t];
        const int32_t *block = s->blocks[tile->block].coordinate;
        for (int32_t p = 0; p < tile->count; p++) {
            int32_t pack = tile->first_pack + p / PACK;
            double *row = out + (int64_t)s->id[pack * PACK + p % PACK] * f->components;
            for (int c = 0; c < f->components; c++) {
                double value = (double)field_at(f, pack, c, 0)[p % PACK];
                row[c] = position ? s->definition.dx * (value + (double)block[c] * BLOCK) : value;
            }
        }
    }
    return f->components;
}
