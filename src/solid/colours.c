/* Colours: which blocks may write to the grid at the same time.
 *
 * Blocks of one colour never write to the same node: 8 colours, period two blocks, when kernels stay within −1 … 6 of their block; 27 when they
 * reach −2 … 7. Sums into a node go in the order of colours, so they have the same bits at any number of threads. There is no barrier between
 * colours: a block waits for those blocks of lower colours that touch the slots it touches. A slot counts the blocks that are done with it. If one
 * of the same or a higher colour has been counted, that one has waited for all lower ones itself; so as many counted as there are lower ones
 * means that all of them are done. */
#include "base/threads.h"
#include "solid/state.h"

enum { CHUNK = 2 /* blocks */ };

static int colour_of(const solid_block *b, int period) {
    int colour = 0;
    for (int axis = 0; axis < 3; axis++) colour = colour * period + ((b->coordinate[axis] % period) + period) % period;
    return colour;
}

static int32_t touched(const solid *s, int32_t slot) {
    return atomic_load_explicit(&s->slot_touched[slot], memory_order_acquire);
}

static void touch(const solid *s, int32_t slot) {
    (void)atomic_fetch_add_explicit(&s->slot_touched[slot], 1, memory_order_release);
}

static void touch_all(const solid *s, const solid_block *b) {
    for (int n = 0; n < NEIGHBOURS; n++)
        if (b->neighbour[n] >= 0) touch(s, b->neighbour[n]);
}

static void forget_touches(solid *s) {
    for (int32_t i = 0; i < s->slot_count; i++) atomic_store_explicit(&s->slot_touched[i], 0, memory_order_relaxed);
}

/* How many blocks of lower colours each block has to wait for at each of its slots. */
static void assign_turns(solid *s) {
    forget_touches(s);
    for (int colour = 0; colour < s->colour_count; colour++) {
        int32_t begin = s->colour_start[colour], end = s->colour_start[colour + 1];
        for (int32_t i = begin; i < end; i++) {
            solid_block *b = &s->blocks[s->colour_blocks[i]];
            for (int n = 0; n < NEIGHBOURS; n++) b->turn[n] = (uint8_t)(b->neighbour[n] >= 0 ? touched(s, b->neighbour[n]) : 0);
        }
        for (int32_t i = begin; i < end; i++) touch_all(s, &s->blocks[s->colour_blocks[i]]);
    }
}

void colours_assign(solid *s) {
    int period = kernels_have_cubic(s) ? 3 : 2;
    int32_t fill[28] = {0};
    s->colour_count = period * period * period;
    memset(s->colour_start, 0, sizeof s->colour_start);
    for (int32_t b = 0; b < s->block_count; b++) s->colour_start[colour_of(&s->blocks[b], period) + 1]++;
    for (int i = 0; i < s->colour_count; i++) s->colour_start[i + 1] += s->colour_start[i];
    memcpy(fill, s->colour_start, sizeof fill);
    for (int32_t b = 0; b < s->block_count; b++) s->colour_blocks[fill[colour_of(&s->blocks[b], period)]++] = b;
    assign_turns(s);
}

typedef struct colour_context {
    solid *state;
    coloured_pass *pass;
    void *context;
    bool alone;
} colour_context;

static void await_turn(const solid *s, const solid_block *b) {
    for (int n = 0; n < NEIGHBOURS; n++) {
        if (b->neighbour[n] < 0) continue;
        for (int spins = 0; touched(s, b->neighbour[n]) < b->turn[n]; spins++) thread_relax(spins);
    }
}

/* A worker takes chunks in order, and what a block waits for lies before it: whoever holds the first block that is not done can go on. */
static void take_block(void *context, int64_t i, int worker) {
    const colour_context *c = context;
    solid *s = c->state;
    int32_t block = s->colour_blocks[i];
    bool follows = i + 1 < s->block_count && (c->alone || (i + 1) % CHUNK != 0);
    if (!c->alone) await_turn(s, &s->blocks[block]);
    c->pass(c->context, block, follows ? s->colour_blocks[i + 1] : -1, worker);
    if (!c->alone) touch_all(s, &s->blocks[block]);
}

void colours_pass(solid *s, coloured_pass *pass, void *context) {
    colour_context c = {.state = s, .pass = pass, .context = context, .alone = s->threads == 1};
    if (!c.alone) forget_touches(s);
    parallel_for(s->threads, s->block_count, CHUNK, take_block, &c);
}
