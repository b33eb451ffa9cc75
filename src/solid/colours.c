/* Colours: which blocks may write to the grid at the same time.
 *
 * Blocks of one colour never write to the same node: 8 colours, period two blocks, when kernels stay within −1 … 6 of their block; 27 when they
 * reach −2 … 7. Sums into a node go in the order of colours, so they have the same bits at any number of threads. There is no barrier between
 * colours: a block waits for those blocks of lower colours that are near enough to share nodes with it. */
#include "base/threads.h"
#include "solid/order.h"

static int colour_period(const solid *s) {
    return kernels_have_cubic(s) ? 3 : 2;
}

static int colour_of(const int32_t coordinate[3], int period) {
    int colour = 0;
    for (int axis = 0; axis < 3; axis++) colour = colour * period + ((coordinate[axis] % period) + period) % period;
    return colour;
}

/* The blocks of lower colours that are less than a period away. */
static void list_waits(void *context, int64_t block, int worker) {
    (void)worker;
    solid *s = context;
    int period = colour_period(s), own = colour_of(s->blocks[block].coordinate, period), side = 2 * period - 1;
    const int32_t *at = s->blocks[block].coordinate;
    int32_t *waits = s->waits + block * s->wait_limit, count = 0;
    for (int n = 0; n < side * side * side; n++) {
        const int32_t c[3] = {at[0] + n / (side * side) - period + 1, at[1] + n / side % side - period + 1, at[2] + n % side - period + 1};
        if (colour_of(c, period) >= own) continue;
        int32_t slot = order_rank(s, block_key(c));
        if (slot >= 0 && s->slot_block[slot] >= 0) waits[count++] = s->slot_block[slot];
    }
    s->blocks[block].waits = count;
}

/* Each worker's own blocks, the same in every pass: as many packs for each, in the order of blocks. */
static void share_blocks(solid *s) {
    int32_t block = 0;
    for (int w = 0; w <= s->threads; w++) {
        int64_t packs = (int64_t)s->pack_count * w / s->threads;
        while (block < s->block_count && s->tiles[s->blocks[block].first_tile].first_pack < packs) block++;
        s->block_shares[w] = w == s->threads ? s->block_count : block;
    }
}

static void share_colours(solid *s) {
    for (int colour = 0; colour < s->colour_count; colour++) {
        int32_t at = s->colour_start[colour], end = s->colour_start[colour + 1];
        for (int w = 0; w <= s->threads; w++) {
            while (at < end && s->colour_blocks[at] < s->block_shares[w]) at++;
            s->colour_shares[colour * (s->threads + 1) + w] = at;
        }
    }
}

status colours_assign(solid *s, report *r) {
    int period = colour_period(s);
    int32_t fill[28] = {0};
    s->colour_count = period * period * period;
    memset(s->colour_start, 0, sizeof s->colour_start);
    for (int32_t b = 0; b < s->block_count; b++) s->colour_start[colour_of(s->blocks[b].coordinate, period) + 1]++;
    for (int i = 0; i < s->colour_count; i++) s->colour_start[i + 1] += s->colour_start[i];
    memcpy(fill, s->colour_start, sizeof fill);
    for (int32_t b = 0; b < s->block_count; b++) s->colour_blocks[fill[colour_of(s->blocks[b].coordinate, period)]++] = b;
    share_blocks(s);
    share_colours(s);
    for (int32_t slot = 0; slot < s->slot_count; slot++) s->slot_block[slot] = -1;
    for (int32_t b = 0; b < s->block_count; b++) s->slot_block[s->blocks[b].neighbour[NEIGHBOURS / 2]] = b;
    if (s->threads == 1) return STATUS_OK;
    s->wait_limit = period == 2 ? 26 : 124;
    status code = order_grow((void **)&s->waits, &s->wait_capacity, s->block_count * s->wait_limit, sizeof *s->waits, "the order of blocks", r);
    if (code == STATUS_OK)
        code = order_grow((void **)&s->block_done, &s->done_capacity, s->block_count, sizeof *s->block_done, "the order of blocks", r);
    if (code != STATUS_OK) return code;
    parallel_for(s->threads, s->block_count, 8, list_waits, s);
    return STATUS_OK;
}

typedef struct colour_context {
    solid *state;
    coloured_pass *pass;
    void *context;
    bool alone;
} colour_context;

/* Whether a block is done in this pass is the number of the last pass it was done in. */
static void await_turn(const solid *s, int32_t block) {
    const int32_t *waits = s->waits + (int64_t)block * s->wait_limit;
    for (int32_t i = 0; i < s->blocks[block].waits; i++)
        for (int spins = 0; atomic_load_explicit(&s->block_done[waits[i]], memory_order_acquire) != s->pass; spins++) thread_relax(spins);
}

static void take_block(void *context, int64_t i, int worker) {
    const colour_context *c = context;
    solid *s = c->state;
    int32_t block = s->colour_blocks[i];
    int32_t next = i + 1 < s->block_count ? s->colour_blocks[i + 1] : -1;
    bool follows = next >= s->block_shares[worker] && next < s->block_shares[worker + 1];
    if (!c->alone) await_turn(s, block);
    c->pass(c->context, block, follows || c->alone ? next : -1, worker);
    if (!c->alone) atomic_store_explicit(&s->block_done[block], s->pass, memory_order_release);
}

/* A worker takes blocks in order, and what a block waits for is taken before it: whoever holds the first block that is not done can go on. */
void colours_pass(solid *s, coloured_pass *pass, void *context) {
    colour_context c = {.state = s, .pass = pass, .context = context, .alone = s->threads == 1};
    s->pass++;
    parallel_stages(s->threads, s->colour_count, s->colour_shares, take_block, &c);
}
