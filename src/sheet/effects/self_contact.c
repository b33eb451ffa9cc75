/* Contact of sheets with themselves and with one another: particles that no bond joins push each other apart below a distance.
 *
 * Pairs near enough to touch soon are listed by particle, ascending, and kept until something has moved by half the margin or a bond has broken.
 * What a listed pair does depends on its places alone, so the bits do not depend on when it was listed. */
#include "base/memory.h"
#include "base/random.h"
#include "base/threads.h"
#include "sheet/state.h"

static const double MARGIN = 0.3; /* of the largest distance */

enum { KEY_DISTANCE, KEY_STIFFNESS, FIRST_WIDTH = 4 };

typedef struct contact_list {
    double reach;       /* the largest distance of a body */
    int64_t cells;      /* of the table, a power of two */
    int32_t *head;      // [cells], −1: none
    int32_t *next;      // [lanes]
    int32_t width;      /* room for pairs of a particle */
    int32_t *count;     // [lanes]
    int32_t *pair;      // [lanes][width]
    real *listed;       // [lanes][3], places when the list was made
    int64_t lanes;
} contact_list;

static void declare(const effect_values *own, sheet_plan *p) {
    p->contact_distance = own->value[KEY_DISTANCE][0];
    p->contact_stiffness = own->value[KEY_STIFFNESS][0];
}

static void release(sheet *s) {
    contact_list *l = s->contacts;
    if (!l) return;
    size_t lanes = (size_t)l->lanes;
    memory_free(l->head, (size_t)l->cells * sizeof *l->head);
    memory_free(l->next, lanes * sizeof *l->next);
    memory_free(l->count, lanes * sizeof *l->count);
    memory_free(l->pair, lanes * (size_t)l->width * sizeof *l->pair);
    memory_free(l->listed, lanes * 3 * sizeof *l->listed);
    memory_free(l, sizeof *l);
    s->contacts = NULL;
}

static status prepare(sheet *s, report *r) {
    if (s->contacts) return STATUS_OK;
    contact_list *l = s->contacts = memory_allocate(sizeof *l);
    if (!l) return report_set(r, STATUS_SYSTEM, "out of memory for contacts");
    *l = (contact_list){.lanes = (int64_t)s->pack_count * PACK, .cells = 1024, .width = FIRST_WIDTH};
    while (l->cells < 2 * l->lanes) l->cells *= 2;
    for (int b = 0; b < s->definition.body_count; b++) l->reach = fmax(l->reach, s->bodies[b].contact_reach);
    size_t lanes = (size_t)l->lanes;
    l->head = memory_allocate_array((size_t)l->cells, sizeof *l->head);
    l->next = memory_allocate_array(lanes, sizeof *l->next);
    l->count = memory_allocate_array(lanes, sizeof *l->count);
    l->pair = memory_allocate_array(lanes * (size_t)l->width, sizeof *l->pair);
    l->listed = memory_allocate_array(lanes, 3 * sizeof *l->listed);
    s->broken_since = 1;
    if (l->head && l->next && l->count && l->pair && l->listed) return STATUS_OK;
    release(s);
    return report_set(r, STATUS_SYSTEM, "out of memory for contacts");
}

/* ---- the list ---------------------------------------------------------------------------------------------------- */

static void cell_of(const contact_list *l, const real *node, int64_t cell[3]) {
    for (int c = 0; c < 3; c++) cell[c] = (int64_t)floor(coordinate_of(node, c) / (l->reach * (1 + MARGIN)));
}

static int64_t slot_of(const contact_list *l, const int64_t cell[3]) {
    return (int64_t)(random_mix((uint64_t)cell[0] ^ random_mix((uint64_t)cell[1] ^ random_mix((uint64_t)cell[2]))) & (uint64_t)(l->cells - 1));
}

static double distance_squared(const real *a, const real *b) {
    double square = 0;
    for (int c = 0; c < 3; c++) {
        double difference = coordinate_of(a, c) - coordinate_of(b, c);
        square += difference * difference;
    }
    return square;
}

static bool is_joined(const sheet *s, int64_t place, int32_t other) {
    const sheet_pack *pack = &s->packs[place / PACK];
    for (int32_t k = 0; k < pack->slots; k++) {
        int64_t at = ((int64_t)pack->first_slot + k) * PACK + place % PACK;
        if (s->neighbour[at] == other && s->stiffness[at] > 0) return true;
    }
    return false;
}

/* Lists a particle's pairs, ascending; counts those beyond the width too. */
static void list_particle(sheet *s, int64_t place) {
    contact_list *l = s->contacts;
    const real *node = s->node + place * NODE;
    double reach = l->reach * (1 + MARGIN);
    int64_t middle[3], cell[3], other[3];
    int32_t found = 0, *pair = l->pair + place * l->width;
    cell_of(l, node, middle);
    for (int k = 0; k < 27; k++) {
        cell[0] = middle[0] + k / 9 - 1, cell[1] = middle[1] + k / 3 % 3 - 1, cell[2] = middle[2] + k % 3 - 1;
        for (int32_t q = l->head[slot_of(l, cell)]; q >= 0; q = l->next[q]) {
            const real *far = s->node + (int64_t)q * NODE;
            if (q == place || distance_squared(node, far) >= reach * reach) continue;
            cell_of(l, far, other);
            if (memcmp(cell, other, sizeof cell) != 0 || is_joined(s, place, q)) continue;
            if (found++ >= l->width) continue;
            int32_t at = found - 1;
            for (; at > 0 && pair[at - 1] > q; at--) pair[at] = pair[at - 1];
            pair[at] = q;
        }
    }
    l->count[place] = found;
}

static void list_pack(const pack_work *w) {
    for (int lane = 0; lane < w->state->packs[w->pack].count; lane++) list_particle(w->state, (int64_t)w->pack * PACK + lane);
}

static void fill_cells(sheet *s) {
    contact_list *l = s->contacts;
    memset(l->head, 0xff, (size_t)l->cells * sizeof *l->head);
    for (int64_t i = l->lanes - 1; i >= 0; i--) {
        l->count[i] = 0;
        if (s->id[i] < 0) continue;
        int64_t cell[3];
        cell_of(l, s->node + i * NODE, cell);
        int64_t slot = slot_of(l, cell);
        l->next[i] = l->head[slot];
        l->head[slot] = (int32_t)i;
        for (int c = 0; c < 3; c++) l->listed[3 * i + c] = s->node[i * NODE + c];
    }
}

static status make_list(sheet *s, report *r) {
    contact_list *l = s->contacts;
    fill_cells(s);
    for (;;) {
        sheet_for_packs(s, 0, list_pack);
        int32_t most = 0;
        for (int64_t i = 0; i < l->lanes; i++) most = l->count[i] > most ? l->count[i] : most;
        if (most <= l->width) break;
        memory_free(l->pair, (size_t)l->lanes * (size_t)l->width * sizeof *l->pair);
        l->width = most + most / 2;
        l->pair = memory_allocate_array((size_t)l->lanes * (size_t)l->width, sizeof *l->pair);
        if (!l->pair) {
            l->width = 0;
            return report_set(r, STATUS_SYSTEM, "out of memory for contacts");
        }
    }
    s->broken_since = 0;
    return STATUS_OK;
}

static bool has_moved(const sheet *s) {
    const contact_list *l = s->contacts;
    double half = 0.5 * MARGIN * l->reach;
    for (int64_t i = 0; i < l->lanes; i++) {
        double square = 0;
        for (int c = 0; c < 3; c++) {
            double way = (double)s->node[i * NODE + c] - (double)l->listed[3 * i + c];
            square += way * way;
        }
        if (s->id[i] >= 0 && square > half * half) return true;
    }
    return false;
}

/* ---- forces ------------------------------------------------------------------------------------------------------ */

/* Of the pair: the mean of its bodies' distances and stiffnesses. */
static void push_apart(const pack_work *w) {
    sheet *s = w->state;
    const contact_list *l = s->contacts;
    for (int lane = 0; lane < s->packs[w->pack].count; lane++) {
        int64_t place = (int64_t)w->pack * PACK + lane;
        const real *node = s->node + place * NODE;
        double impulse = (double)w->dt / ((double)s->area[place] * w->body->surface_density);
        for (int32_t k = 0; k < l->count[place]; k++) {
            int32_t other = l->pair[place * l->width + k];
            const real *far = s->node + (int64_t)other * NODE;
            const body_constants *b = &s->bodies[s->packs[other / PACK].body];
            double reach = 0.5 * (w->body->contact_reach + b->contact_reach), stiffness = 0.5 * (w->body->contact_stiffness + b->contact_stiffness);
            double square = distance_squared(node, far), length = sqrt(square);
            if (length >= reach || !(length > 0)) continue;
            for (int c = 0; c < 3; c++)
                s->velocity[((int64_t)w->pack * 3 + c) * PACK + lane] +=
                    (real)(impulse * stiffness * (reach / length - 1) * (coordinate_of(node, c) - coordinate_of(far, c)));
        }
    }
}

static status before(sheet *s, real dt, report *r) {
    status code = prepare(s, r);
    if (code == STATUS_OK && (s->broken_since > 0 || has_moved(s))) code = make_list(s, r);
    if (code == STATUS_OK) sheet_for_packs(s, dt, push_apart);
    return code;
}

/* Half of each pair's energy: the other end counts the rest. */
static double energy(const sheet *s, int32_t p, int lane) {
    const contact_list *l = s->contacts;
    int64_t place = (int64_t)p * PACK + lane;
    const body_constants *own = &s->bodies[s->packs[p].body];
    double sum = 0;
    for (int32_t k = 0; l && k < l->count[place]; k++) {
        int32_t other = l->pair[place * l->width + k];
        const body_constants *b = &s->bodies[s->packs[other / PACK].body];
        double reach = 0.5 * (own->contact_reach + b->contact_reach), stiffness = 0.5 * (own->contact_stiffness + b->contact_stiffness);
        double approach = fmax(0, reach - sqrt(distance_squared(s->node + place * NODE, s->node + (int64_t)other * NODE)));
        sum += 0.25 * stiffness * approach * approach;
    }
    return sum;
}

static const parameter parameters[] = {
    [KEY_DISTANCE] = PARAMETER_PLAIN("distance", "1", "below which particles push each other, in spacings", 0.1, 1, 0.8),
    [KEY_STIFFNESS] = {.key = "stiffness", .unit = "1", .doc = "force per approach, in units of E h", .minimum = 0, .maximum = 1e3, .fallback = {0.5},
                       .live = true, .logarithmic = true},
};

static const sheet_stages stages = {.declare = declare, .before = before, .release = release, .energy = energy};

const effect SHEET_EFFECT(self_contact) = {
    .name = "self_contact", .engine = ENGINE_SHEET, .scope = SCOPE_MATERIAL, .doc = "sheets do not pass through themselves or one another",
    .reference = "METHOD.md section 6", .parameters = parameters, .parameter_count = 2, .needs = SHEET_ELASTICITY, .sheet = &stages,
};
