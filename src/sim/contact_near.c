/* First packs of sheets' particles and blocks of solids' that come near each other; then, of those, particles by cell. What costs is done by all
 * threads, each writing what is its own; cells and chains are made by one, in the order of storage. */
#include "sim/contact_near.h"

#include "base/memory.h"
#include "base/random.h"
#include "base/threads.h"

#include <math.h>
#include <string.h>

static const double SIDE = 2.01; /* of a cell, in reaches */

/* ---- memory ------------------------------------------------------------------------------------------------------ */

typedef struct near_array {
    void *address; /* where the array's address is kept */
    size_t size;
} near_array;

enum { PACK_ARRAYS = 8, BLOCK_ARRAYS = 3, SOLID_ARRAYS = 7, GROUP_ARRAYS = 2, CELL_ARRAYS = 1 };

static void list_pack_arrays(contact_near *n, near_array list[PACK_ARRAYS]) {
    const near_array all[PACK_ARRAYS] = {{&n->near_packs, sizeof *n->near_packs}, {&n->pack_is_near, sizeof *n->pack_is_near},
                                         {&n->pack_population, sizeof *n->pack_population}, {&n->sheet_place, SHEET_PACK * sizeof *n->sheet_place},
                                         {&n->sheet_velocity, SHEET_PACK * sizeof *n->sheet_velocity}, {&n->sheet_id, SHEET_PACK * sizeof *n->sheet_id},
                                         {&n->sheet_next, SHEET_PACK * sizeof *n->sheet_next}, {&n->sheet_held, SHEET_PACK * sizeof *n->sheet_held}};
    memcpy(list, all, sizeof all);
}

static void list_block_arrays(contact_near *n, near_array list[BLOCK_ARRAYS]) {
    const near_array all[BLOCK_ARRAYS] = {{&n->marks, sizeof *n->marks}, {&n->blocks, sizeof *n->blocks}, {&n->block_start, sizeof *n->block_start}};
    memcpy(list, all, sizeof all);
}

static void list_solid_arrays(contact_near *n, near_array list[SOLID_ARRAYS]) {
    const near_array all[SOLID_ARRAYS] = {{&n->solid_place, sizeof *n->solid_place}, {&n->solid_motion, sizeof *n->solid_motion}, {&n->solid_at, sizeof *n->solid_at},
                                          {&n->solid_id, sizeof *n->solid_id}, {&n->solid_cell, sizeof *n->solid_cell}, {&n->solid_next, sizeof *n->solid_next},
                                          {&n->solid_moved, sizeof *n->solid_moved}};
    memcpy(list, all, sizeof all);
}

static void list_group_arrays(contact_near *n, near_array list[GROUP_ARRAYS]) {
    const near_array all[GROUP_ARRAYS] = {{&n->groups, sizeof *n->groups}, {&n->order, sizeof *n->order}};
    memcpy(list, all, sizeof all);
}

static void list_cell_arrays(contact_near *n, near_array list[CELL_ARRAYS]) {
    list[0] = (near_array){&n->cells, sizeof *n->cells};
}

/* Arrays of one length grow together, with room to spare and with what is in them; on failure some have grown, and the rest is as it was. */
static bool grow(const near_array *list, int arrays, int32_t *capacity, int32_t need) {
    if (need <= *capacity) return true;
    int32_t wanted = need + need / 2 + 64;
    void *fresh[PACK_ARRAYS];
    for (int i = 0; i < arrays; i++) {
        fresh[i] = memory_allocate_array((size_t)wanted, list[i].size);
        if (fresh[i]) continue;
        while (--i >= 0) memory_free(fresh[i], (size_t)wanted * list[i].size);
        return false;
    }
    for (int i = 0; i < arrays; i++) {
        void *old;
        memcpy(&old, list[i].address, sizeof old);
        if (old) memcpy(fresh[i], old, (size_t)*capacity * list[i].size);
        memory_free(old, (size_t)*capacity * list[i].size);
        memcpy(list[i].address, &fresh[i], sizeof old);
    }
    *capacity = wanted;
    return true;
}

static void release(const near_array *list, int arrays, int32_t capacity) {
    for (int i = 0; i < arrays; i++) {
        void *data;
        memcpy(&data, list[i].address, sizeof data);
        memory_free(data, (size_t)capacity * list[i].size);
    }
}

bool contact_near_create(contact_near *n, const simulation *s, double reach, int threads) {
    near_array list[PACK_ARRAYS];
    *n = (contact_near){.reach = reach, .threads = threads};
    list_pack_arrays(n, list);
    n->pack_count = s->sheets->touch->packs(s->sheet);
    return grow(list, PACK_ARRAYS, &n->pack_capacity, n->pack_count);
}

void contact_near_free(contact_near *n) {
    near_array list[PACK_ARRAYS];
    list_pack_arrays(n, list);
    release(list, PACK_ARRAYS, n->pack_capacity);
    list_block_arrays(n, list);
    release(list, BLOCK_ARRAYS, n->block_capacity);
    list_solid_arrays(n, list);
    release(list, SOLID_ARRAYS, n->solid_capacity);
    list_group_arrays(n, list);
    release(list, GROUP_ARRAYS, n->group_capacity);
    list_cell_arrays(n, list);
    release(list, CELL_ARRAYS, n->cell_capacity);
    memory_free(n->table, (size_t)n->table_size * sizeof *n->table);
}

/* ---- packs and blocks -------------------------------------------------------------------------------------------- */

typedef struct near_work {
    contact_near *near;
    const simulation *state;
    double low[3], high[3]; /* all solids, and the reach around them */
} near_work;

static void widen(double low[3], double high[3], const double x[3], double by) {
    for (int k = 0; k < 3; k++) {
        if (x[k] - by < low[k]) low[k] = x[k] - by;
        if (x[k] + by > high[k]) high[k] = x[k] + by;
    }
}

static bool overlap(const double low[3], const double high[3], const double other_low[3], const double other_high[3]) {
    for (int k = 0; k < 3; k++)
        if (low[k] > other_high[k] || high[k] < other_low[k]) return false;
    return true;
}

static void look_at_pack(void *context, int64_t pack, int worker) {
    (void)worker;
    near_work *w = context;
    contact_near *n = w->near;
    const simulation *s = w->state;
    double place[SHEET_PACK][3], low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    int32_t id[SHEET_PACK];
    int64_t first = pack * SHEET_PACK;
    int count = s->sheets->touch->places(s->sheet, (int32_t)pack, place, id);
    for (int lane = 0; lane < count; lane++) widen(low, high, place[lane], n->reach);
    n->pack_population[pack] = count;
    n->pack_is_near[pack] = overlap(low, high, w->low, w->high) && s->engine->touch->mark(s->solid, low, high, n->marks);
    if (!n->pack_is_near[pack]) return;
    memcpy(n->sheet_place + first, place, (size_t)count * sizeof *place);
    memcpy(n->sheet_id + first, id, (size_t)count * sizeof *id);
    s->sheets->touch->motion(s->sheet, (int32_t)pack, n->sheet_velocity + first, n->sheet_held + first);
}

static status find_packs(contact_near *n, const simulation *s, report *r) {
    near_work w = {.near = n, .state = s};
    near_array list[BLOCK_ARRAYS];
    int32_t blocks = s->engine->touch->blocks(s->solid, w.low, w.high);
    list_block_arrays(n, list);
    if (!grow(list, BLOCK_ARRAYS, &n->block_capacity, blocks + 1)) return report_set(r, STATUS_SYSTEM, "out of memory for contact");
    memset((void *)n->marks, 0, (size_t)blocks * sizeof *n->marks);
    parallel_for(n->threads, n->pack_count, 8, look_at_pack, &w);
    n->near_pack_count = n->block_count = 0;
    for (int32_t p = 0; p < n->pack_count; p++)
        if (n->pack_is_near[p]) n->near_packs[n->near_pack_count++] = p;
    for (int32_t b = 0; b < blocks; b++)
        if (n->marks[b]) n->blocks[n->block_count++] = b;
    return STATUS_OK;
}

/* ---- cells and groups -------------------------------------------------------------------------------------------- */

static void cell_of(const contact_near *n, const double x[3], int32_t place[3]) {
    for (int k = 0; k < 3; k++) place[k] = (int32_t)floor(x[k] / (SIDE * n->reach));
}

/* Where a cell is in the table, or where it would be. */
static int64_t find_slot(const contact_near *n, const int32_t place[3]) {
    uint64_t key = random_mix((uint64_t)(uint32_t)place[0] | (uint64_t)(uint32_t)place[1] << 32) ^ (uint32_t)place[2];
    int64_t slot = (int64_t)(random_mix(key) & (uint64_t)(n->table_size - 1));
    while (n->table[slot] >= 0 && memcmp(n->cells[n->table[slot]].place, place, sizeof n->cells->place) != 0) slot = (slot + 1) & (n->table_size - 1);
    return slot;
}

static bool grow_table(contact_near *n) {
    int64_t size = n->table_size ? 2 * n->table_size : 1024;
    int32_t *fresh = memory_allocate_array((size_t)size, sizeof *fresh);
    if (!fresh) return false;
    memory_free(n->table, (size_t)n->table_size * sizeof *n->table);
    n->table = fresh;
    n->table_size = size;
    memset(fresh, 0xff, (size_t)size * sizeof *fresh);
    for (int32_t c = 0; c < n->cell_count; c++) {
        n->cells[c].slot = find_slot(n, n->cells[c].place);
        n->table[n->cells[c].slot] = c;
    }
    return true;
}

/* The cell at a place, a new one if need be; −1 without memory. */
static int32_t have_cell(contact_near *n, const int32_t place[3]) {
    near_array list[CELL_ARRAYS];
    list_cell_arrays(n, list);
    if (2 * ((int64_t)n->cell_count + 1) > n->table_size && !grow_table(n)) return -1;
    int64_t slot = find_slot(n, place);
    if (n->table[slot] >= 0) return n->table[slot];
    if (!grow(list, CELL_ARRAYS, &n->cell_capacity, n->cell_count + 1)) return -1;
    n->cells[n->cell_count] = (contact_cell){.slot = slot, .place = {place[0], place[1], place[2]}, .group = -1, .first = -1};
    n->table[slot] = n->cell_count;
    return n->cell_count++;
}

static bool add_to_group(contact_near *n, int32_t particle) {
    int32_t place[3];
    near_array list[GROUP_ARRAYS];
    cell_of(n, n->sheet_place[particle], place);
    int32_t cell = have_cell(n, place);
    list_group_arrays(n, list);
    if (cell < 0 || !grow(list, GROUP_ARRAYS, &n->group_capacity, n->group_count + 1)) return false;
    if (n->cells[cell].group < 0) {
        n->cells[cell].group = n->group_count;
        n->groups[n->group_count++] = (contact_group){.cell = cell, .first = particle, .last = -1, .low = {HUGE_VAL, HUGE_VAL, HUGE_VAL},
                                                      .high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    }
    contact_group *g = &n->groups[n->cells[cell].group];
    if (g->last >= 0) n->sheet_next[g->last] = particle;
    g->last = particle;
    n->sheet_next[particle] = -1;
    widen(g->low, g->high, n->sheet_place[particle], n->reach);
    return true;
}

/* A group's particles fill at most a cell, so with their reach they meet three cells a direction. */
static bool surround_group(contact_near *n, contact_group *g) {
    int32_t low[3], high[3], at[3];
    cell_of(n, g->low, low);
    cell_of(n, g->high, high);
    for (at[0] = low[0]; at[0] <= high[0]; at[0]++)
        for (at[1] = low[1]; at[1] <= high[1]; at[1]++)
            for (at[2] = low[2]; at[2] <= high[2]; at[2]++) {
                int32_t cell = have_cell(n, at);
                if (cell < 0) return false;
                g->near[g->near_count++] = cell;
            }
    return true;
}

static int colour_of(const contact_near *n, int32_t group) {
    const int32_t *place = n->cells[n->groups[group].cell].place;
    return (place[0] & 1) | (place[1] & 1) << 1 | (place[2] & 1) << 2;
}

static void order_groups(contact_near *n) {
    int32_t fill[CONTACT_COLOURS];
    memset(n->colour_start, 0, sizeof n->colour_start);
    for (int32_t g = 0; g < n->group_count; g++) n->colour_start[colour_of(n, g) + 1]++;
    for (int k = 0; k < CONTACT_COLOURS; k++) n->colour_start[k + 1] += n->colour_start[k];
    memcpy(fill, n->colour_start, sizeof fill);
    for (int32_t g = 0; g < n->group_count; g++) n->order[fill[colour_of(n, g)]++] = g;
}

static status make_groups(contact_near *n, report *r) {
    for (int32_t c = 0; c < n->cell_count; c++) n->table[n->cells[c].slot] = -1;
    n->cell_count = n->group_count = 0;
    bool fits = true;
    for (int32_t i = 0; i < n->near_pack_count; i++)
        for (int lane = 0; fits && lane < n->pack_population[n->near_packs[i]]; lane++) fits = add_to_group(n, n->near_packs[i] * SHEET_PACK + lane);
    for (int32_t g = 0; fits && g < n->group_count; g++) fits = surround_group(n, &n->groups[g]);
    if (!fits) return report_set(r, STATUS_SYSTEM, "out of memory for contact");
    order_groups(n);
    return STATUS_OK;
}

/* ---- solids ------------------------------------------------------------------------------------------------------ */

static void look_at_block(void *context, int64_t i, int worker) {
    (void)worker;
    near_work *w = context;
    contact_near *n = w->near;
    const simulation *s = w->state;
    int32_t first = n->block_start[i], end = n->block_start[i + 1], cell = -1, place[3], last[3] = {INT32_MIN, INT32_MIN, INT32_MIN};
    s->engine->touch->places(s->solid, n->blocks[i], n->solid_place[first], n->solid_at + first, n->solid_id + first);
    for (int32_t q = first; q < end; q++) {
        cell_of(n, n->solid_place[q], place);
        if (memcmp(place, last, sizeof place) != 0) cell = n->table[find_slot(n, place)]; /* neighbours lie side by side */
        memcpy(last, place, sizeof place);
        n->solid_cell[q] = cell;
        n->solid_moved[q] = 0;
        if (cell >= 0) s->engine->touch->motion(s->solid, n->solid_at[q], n->solid_motion[q]);
    }
}

static status find_solids(contact_near *n, const simulation *s, report *r) {
    near_work w = {.near = n, .state = s};
    near_array list[SOLID_ARRAYS];
    int32_t count = 0;
    for (int32_t i = 0; i < n->block_count; i++) {
        n->block_start[i] = count;
        count += s->engine->touch->population(s->solid, n->blocks[i]);
    }
    n->block_start[n->block_count] = count;
    list_solid_arrays(n, list);
    if (!grow(list, SOLID_ARRAYS, &n->solid_capacity, count)) return report_set(r, STATUS_SYSTEM, "out of memory for contact");
    parallel_for(n->threads, n->block_count, 1, look_at_block, &w);
    for (int32_t q = count - 1; q >= 0; q--) {
        if (n->solid_cell[q] < 0) continue;
        contact_cell *cell = &n->cells[n->solid_cell[q]];
        n->solid_next[q] = cell->first;
        cell->first = q;
        cell->count++;
    }
    n->most = 0;
    for (int32_t g = 0; g < n->group_count; g++) {
        int32_t around = 0;
        for (int32_t k = 0; k < n->groups[g].near_count; k++) around += n->cells[n->groups[g].near[k]].count;
        n->most = around > n->most ? around : n->most;
    }
    return STATUS_OK;
}

status contact_near_find(contact_near *n, const simulation *s, report *r) {
    status code = find_packs(n, s, r);
    if (code == STATUS_OK) code = make_groups(n, r);
    if (code == STATUS_OK && n->group_count > 0) code = find_solids(n, s, r);
    return code;
}
