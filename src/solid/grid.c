/* The sparse grid: which blocks of nodes are reached, their colours, and the update of their velocities. */
#include "base/memory.h"
#include "base/threads.h"
#include "solid/inextensible.h"
#include "solid/kernels.h"
#include "solid/order.h"

#include <math.h>

/* The kernels' first nodes as they are, and one cell of drift to either side: what a block promises until the next sort. */
static void allow_drift(void *context, int64_t block, int worker) {
    (void)worker;
    solid *s = context;
    solid_block *b = &s->blocks[block];
    double shift = kernel_shift(s->definition.kernel);
    for (int c = 0; c < 3; c++) {
        vec least = vec_all(1000), most = vec_all(-1000); /* padding repeats particles */
        for (int32_t t = b->first_tile; t < b->first_tile + b->tile_count; t++)
            for (int32_t k = 0; k < s->tiles[t].pack_count; k++)
                for (int part = 0; part < PACK_PARTS; part++) {
                    vec x = vec_load(field_at(&s->fields[FIELD_POSITION], s->tiles[t].first_pack + k, c, part));
                    least = vec_min(x, least), most = vec_max(x, most);
                }
        b->base_low[c] = (int32_t)floor(-(double)vec_largest(-least) - shift) - 1;
        b->base_high[c] = (int32_t)floor((double)vec_largest(most) - shift) + 1;
    }
}

/* First and last node that a block's kernels can touch. A cubic Laplacian beside a quadratic momentum kernel starts up to one node
 * earlier. */
static void reach(const solid *s, const solid_block *b, int32_t low[3], int32_t high[3]) {
    bool mixed = s->definition.kernel == KERNEL_QUADRATIC && kernels_have_cubic(s);
    for (int c = 0; c < 3; c++) {
        low[c] = b->base_low[c] - (mixed ? 1 : 0);
        high[c] = b->base_high[c] + (kernels_have_cubic(s) ? 3 : 2);
    }
}

/* Offsets −1, 0, +1 of a neighbour number. */
static void neighbour_offset(int n, int32_t o[3]) {
    o[0] = n / 9 - 1;
    o[1] = n / 3 % 3 - 1;
    o[2] = n % 3 - 1;
}

static bool reaches(const int32_t o[3], const int32_t low[3], const int32_t high[3]) {
    for (int c = 0; c < 3; c++) {
        if (o[c] < 0 && low[c] >= 0) return false;
        if (o[c] > 0 && high[c] < BLOCK) return false;
    }
    return true;
}

static uint64_t neighbour_key(const solid_block *b, const int32_t o[3]) {
    int32_t c[3] = {b->coordinate[0] + o[0], b->coordinate[1] + o[1], b->coordinate[2] + o[2]};
    return block_key(c);
}

static status reserve_slots(solid *s, int32_t slots, report *r) {
    if (slots <= s->slot_capacity) return STATUS_OK;
    int32_t capacity = slots + slots / 16 + 32;
    size_t fresh = (size_t)capacity;
    size_t node_bytes = BLOCK_NODES * NODE * sizeof(real), damage_bytes = BLOCK_NODES * DAMAGE_NODE * sizeof(real);
    grid_free(s);
    status code = implicit_reserve(s, capacity, r);
    if (code == STATUS_OK) code = diffusion_reserve(s, capacity, r);
    if (code == STATUS_OK) code = constraint_reserve(s, capacity, r);
    if (code != STATUS_OK) return code;
    s->slot_coordinate = memory_allocate_array(fresh, sizeof *s->slot_coordinate);
    s->grid = memory_allocate_array(fresh, node_bytes);
    s->slot_results = memory_allocate_array(fresh, sizeof *s->slot_results);
    s->slot_block = memory_allocate_array(fresh, sizeof *s->slot_block);
    s->slot_damaged = memory_allocate_array(fresh, sizeof *s->slot_damaged);
    if (s->explicit_on) s->damage_grid = memory_allocate_array(fresh, damage_bytes);
    bool flip = s->definition.transfer == TRANSFER_FLIP;
    if (flip) s->old_grid = memory_allocate_array(fresh, node_bytes);
    s->slot_capacity = capacity;
    if (!s->slot_coordinate || !s->grid || !s->slot_results || !s->slot_block || !s->slot_damaged || (s->explicit_on && !s->damage_grid) ||
        (flip && !s->old_grid))
        return report_set(r, STATUS_SYSTEM, "out of memory for %d grid blocks", capacity);
    return STATUS_OK;
}

void grid_free(solid *s) {
    implicit_free(s);
    diffusion_free(s);
    constraint_free(s);
    size_t slots = (size_t)s->slot_capacity;
    memory_free(s->slot_coordinate, s->slot_coordinate ? slots * sizeof *s->slot_coordinate : 0);
    memory_free(s->grid, s->grid ? slots * BLOCK_NODES * NODE * sizeof(real) : 0);
    memory_free(s->old_grid, s->old_grid ? slots * BLOCK_NODES * NODE * sizeof(real) : 0);
    memory_free(s->slot_results, s->slot_results ? slots * sizeof *s->slot_results : 0);
    memory_free(s->slot_block, s->slot_block ? slots * sizeof *s->slot_block : 0);
    memory_free(s->slot_damaged, s->slot_damaged ? slots * sizeof *s->slot_damaged : 0);
    memory_free(s->damage_grid, s->damage_grid ? slots * BLOCK_NODES * DAMAGE_NODE * sizeof(real) : 0);
    s->slot_coordinate = NULL, s->grid = NULL, s->old_grid = NULL, s->slot_results = NULL, s->damage_grid = NULL, s->slot_block = NULL, s->slot_damaged = NULL;
    s->slot_capacity = 0;
}

/* Marks the neighbours that a block's kernels can reach, and notes their keys; false when the table is full. */
static bool note_neighbours(solid *s, solid_block *b) {
    int32_t low[3], high[3], o[3];
    reach(s, b, low, high);
    for (int n = 0; n < NEIGHBOURS; n++) {
        neighbour_offset(n, o);
        b->neighbour[n] = reaches(o, low, high) ? 0 : -1;
        if (b->neighbour[n] == 0 && order_insert(s, neighbour_key(b, o)) < 0) return false;
    }
    return true;
}

static status note_slots(solid *s, report *r) {
    for (int64_t room = 4 * (int64_t)s->block_count;; room *= 2) {
        status code = order_reserve_hash(s, room, r);
        if (code != STATUS_OK) return code;
        order_clear_hash(s);
        bool fits = true;
        for (int32_t b = 0; b < s->block_count && fits; b++) fits = note_neighbours(s, &s->blocks[b]);
        if (fits) return STATUS_OK;
    }
}

status grid_build(solid *s, report *r) {
    parallel_for(s->threads, s->block_count, 8, allow_drift, s);
    status code = note_slots(s, r);
    if (code != STATUS_OK) return code;
    if ((code = order_rank_all(s, &s->slot_count, r)) != STATUS_OK) return code;
    if ((code = reserve_slots(s, s->slot_count, r)) != STATUS_OK) return code;
    for (int32_t i = 0; i < s->slot_count; i++) block_coordinate(s->block_list[i], s->slot_coordinate[i]);
    for (int32_t b = 0; b < s->block_count; b++)
        for (int n = 0; n < NEIGHBOURS; n++) {
            int32_t o[3];
            neighbour_offset(n, o);
            if (s->blocks[b].neighbour[n] == 0) s->blocks[b].neighbour[n] = order_rank(s, neighbour_key(&s->blocks[b], o));
        }
    s->constraint.mapped = false;
    s->implicit_known = 0;
    return colours_assign(s, r);
}

/* ---- the update -------------------------------------------------------------------------------------------------- */

typedef struct update_context {
    solid *state;
    real dt;
} update_context;

static void to_velocity(real *nodes) {
    for (int n = 0; n < BLOCK_NODES; n++) {
        real mass = nodes[n * NODE + 3], inverse = mass > 0 ? 1 / mass : 0;
        for (int c = 0; c < 3; c++) nodes[n * NODE + c] *= inverse;
    }
}

/* Momentum becomes velocity, Σ w d becomes d; then the effects' grid stages in their order. */
static void update_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    update_context *u = context;
    solid *s = u->state;
    real *nodes = s->grid + slot * BLOCK_NODES * NODE;
    to_velocity(nodes);
    if (s->old_grid) to_velocity(s->old_grid + slot * BLOCK_NODES * NODE);
    if (s->damage_grid) damage_from_sums(s->damage_grid + slot * BLOCK_NODES * DAMAGE_NODE);
    grid_work w = {.state = s, .slot = (int32_t)slot, .nodes = nodes, .dt = u->dt, .result = &s->slot_results[slot]};
    if (s->constraint.on) memset(s->constraint.holds + slot * BLOCK_NODES, 0, BLOCK_NODES * sizeof(node_hold));
    for (int e = 0; e < s->effect_count; e++)
        if ((s->mask >> e & 1) && s->effects[e]->stages->grid) s->effects[e]->stages->grid(&w);
}

void grid_collect_results(solid *s) {
    for (int32_t i = 0; i < s->slot_count; i++) {
        s->grip_work += s->slot_results[i].grip_work;
        for (int c = 0; c < 3; c++) s->grip_impulse[c] += s->slot_results[i].grip_impulse[c];
        s->slot_results[i] = (block_result){0};
    }
}

void grid_update(solid *s, real dt) {
    update_context u = {s, dt};
    parallel_for(s->threads, s->slot_count, 16, update_slot, &u);
    grid_collect_results(s);
}
