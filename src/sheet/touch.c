/* Packs of particles as contact sees them (src/sim/contact.c). */
#include "sheet/state.h"

static int32_t packs(const sheet *s) {
    return s->pack_count;
}

static int places(const sheet *s, int32_t pack, double place[SHEET_PACK][3], int32_t id[SHEET_PACK]) {
    for (int lane = 0; lane < s->packs[pack].count; lane++) {
        for (int c = 0; c < 3; c++) place[lane][c] = coordinate_of(node_at(s, pack, lane), c);
        id[lane] = s->id[pack * PACK + lane];
    }
    return s->packs[pack].count;
}

static void motion(const sheet *s, int32_t pack, double velocity[SHEET_PACK][3], bool held[SHEET_PACK]) {
    for (int lane = 0; lane < s->packs[pack].count; lane++) {
        for (int c = 0; c < 3; c++) velocity[lane][c] = (double)s->velocity[((int64_t)pack * 3 + c) * PACK + lane];
        held[lane] = s->holder[pack * PACK + lane] > 0;
    }
}

static void push(sheet *s, int32_t pack, const double change[SHEET_PACK][3]) {
    for (int lane = 0; lane < s->packs[pack].count; lane++)
        for (int c = 0; c < 3; c++) s->velocity[((int64_t)pack * 3 + c) * PACK + lane] += (real)change[lane][c];
}

const sheet_touch sheet_touch_table = {.packs = packs, .places = places, .motion = motion, .push = push};
