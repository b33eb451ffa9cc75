/* From a calibrated network to packs and slots. */
#include "base/memory.h"
#include "sheet/state.h"

#include <math.h>
#include <stdlib.h>

/* ---- order ------------------------------------------------------------------------------------------------------- */

/* Cells begin so much before the lowest particle, in cells: those of a lattice then have no particle on their edges. */
static const double EDGE = 0.125;

enum { CELL = 2, CELL_BITS = 20 }; /* of 2 × 2 quarters; cells along an axis */

/* Particles are ordered by cells of four spacings, row by row of them, the rows across the longest side; within a cell by its quarters. A pack is a patch
 * of about 4 × 4, its neighbours are the packs before and after and those of the next rows, which are read as they come. */
typedef struct ordered {
    uint64_t key;
    int32_t particle;
} ordered;

static int compare_ordered(const void *a, const void *b) {
    const ordered *x = a, *y = b;
    if (x->key != y->key) return x->key < y->key ? -1 : 1;
    return x->particle < y->particle ? -1 : x->particle > y->particle;
}

/* Axes from the shortest side to the longest. */
static void order_axes(const double side[3], int axis[3]) {
    for (int c = 0; c < 3; c++) {
        int rank = 0;
        for (int other = 0; other < 3; other++) rank += side[other] < side[c] || (side[other] == side[c] && other < c);
        axis[rank] = c;
    }
}

static void order_body(const sheet *s, const sheet_body *b, ordered *order) {
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, side[3] = {0}, quarter = 2 * b->spacing;
    const double *rest = s->definition.rest;
    int axis[3];
    for (int64_t i = b->first; i < b->first + b->count; i++)
        for (int c = 0; c < 3; c++) low[c] = fmin(low[c], rest[3 * i + c]);
    for (int64_t i = b->first; i < b->first + b->count; i++)
        for (int c = 0; c < 3; c++) side[c] = fmax(side[c], rest[3 * i + c] - low[c]);
    order_axes(side, axis);
    for (int64_t i = 0; i < b->count; i++) {
        order[i] = (ordered){.particle = (int32_t)(b->first + i)};
        for (int c = 0; c < 3; c++) {
            double at = fmin((rest[3 * (b->first + i) + axis[c]] - low[axis[c]]) / quarter + EDGE, (CELL << CELL_BITS) - 1);
            order[i].key |= (uint64_t)at / CELL << (3 + CELL_BITS * c) | (uint64_t)at % CELL << c;
        }
    }
    qsort(order, (size_t)b->count, sizeof *order, compare_ordered);
}

/* ---- particles --------------------------------------------------------------------------------------------------- */

static void load_particle(sheet *s, int32_t pack, int lane, int64_t i, bool alive) {
    const sheet_definition *d = &s->definition;
    const double *x = (d->position ? d->position : d->rest) + 3 * i;
    real *node = node_at(s, pack, lane);
    int64_t at = (int64_t)pack * PACK + lane;
    s->id[at] = alive ? (int32_t)i : -1;
    if (alive) s->place[i] = (int32_t)at;
    for (int c = 0; c < 3; c++) {
        node[c] = (real)x[c];
        node[NODE_LOW + c] = (real)(x[c] - (double)node[c]);
        s->velocity[((int64_t)pack * 3 + c) * PACK + lane] = alive && d->velocity ? (real)d->velocity[3 * i + c] : 0;
    }
    const sheet_plan *p = &s->plans[d->bodies[s->packs[pack].body].material];
    node[3] = !alive ? 0 : d->diffused ? (real)d->diffused[i] : p->diffuses ? (real)p->initial : 0;
    s->area[at] = alive ? (real)d->area[i] : 0;
}

static void load_body(sheet *s, const sheet_network *n, int body, int32_t first_pack, const ordered *order) {
    const sheet_body *b = &s->definition.bodies[body];
    int32_t packs = (int32_t)((b->count + PACK - 1) / PACK);
    for (int32_t p = 0; p < packs; p++) {
        sheet_pack *pack = &s->packs[first_pack + p];
        int64_t left = b->count - (int64_t)p * PACK;
        *pack = (sheet_pack){.body = body, .count = left < PACK ? (int32_t)left : PACK};
        for (int lane = 0; lane < PACK; lane++) {
            bool alive = lane < pack->count;
            int64_t i = order[alive ? (int64_t)p * PACK + lane : (int64_t)p * PACK].particle;
            load_particle(s, first_pack + p, lane, i, alive);
            int32_t bonds = 0;
            for (int64_t k = n->start[i]; k < n->start[i + 1]; k++) bonds += n->weight[k] > 0;
            if (alive && bonds > pack->slots) pack->slots = bonds;
        }
    }
}

static status place_particles(sheet *s, const sheet_network *n, report *r) {
    int64_t most = 0;
    for (int b = 0; b < s->definition.body_count; b++)
        if (s->definition.bodies[b].count > most) most = s->definition.bodies[b].count;
    ordered *order = memory_allocate_array((size_t)most, sizeof *order);
    if (!order) return report_set(r, STATUS_SYSTEM, "out of memory for the order of %lld particles", (long long)most);
    int32_t first_pack = 0;
    for (int b = 0; b < s->definition.body_count; b++) {
        order_body(s, &s->definition.bodies[b], order);
        load_body(s, n, b, first_pack, order);
        first_pack += (int32_t)((s->definition.bodies[b].count + PACK - 1) / PACK);
    }
    memory_free(order, (size_t)most * sizeof *order);
    int64_t slots = 0;
    for (int32_t p = 0; p < s->pack_count; p++) {
        s->packs[p].first_slot = (int32_t)slots;
        slots += s->packs[p].slots;
    }
    if (slots > INT32_MAX / PACK) return report_set(r, STATUS_INPUT, "more than 2e9 bonds");
    s->slot_count = (int32_t)slots;
    return STATUS_OK;
}

/* ---- bonds ------------------------------------------------------------------------------------------------------- */

static void clear_bond(sheet *s, int64_t at, int32_t self) {
    s->neighbour[at] = self;
    s->inverse[at] = (real)1e15; /* a stretch of 1 at the length that the loop gives a bond to itself */
}

static void load_bond(sheet *s, const sheet_network *n, int64_t at, int64_t k) {
    bool broken = n->cut[k] || (s->history && s->history[at] == BROKEN);
    s->neighbour[at] = s->place[n->neighbour[k]];
    s->inverse[at] = (real)(1 / n->length[k]);
    s->stiffness[at] = broken ? 0 : (real)n->stiffness[k];
    if (s->limit) s->limit[at] = (real)n->limit[k];
    if (s->history && broken) s->history[at] = BROKEN;
    if (s->conduct) s->conduct[at] = broken ? 0 : (real)n->conduct[k];
    if (s->laplace) s->laplace[at] = broken || !n->laplace ? 0 : (real)n->laplace[k];
    if (s->coupling && n->coupling) {
        s->coupling[at] = (real)n->coupling[k];
        s->dilation[at] = broken ? 0 : (real)n->dilation[k];
    }
}

/* Curvature is known where bonds lie evenly, Σ laplace r⁰ = 0, and as long as all of them are left: `whole` is Σ laplace, as the loop adds it. */
static void mark_whole(sheet *s, const sheet_network *n, int32_t p, int lane) {
    int64_t i = s->id[(int64_t)p * PACK + lane];
    real *whole = &s->whole[(int64_t)p * PACK + lane];
    double moment[3] = {0}, scale = 0;
    real sum = 0;
    *whole = -1;
    if (i < 0 || !n->laplace) return;
    const double *rest = s->definition.rest;
    for (int64_t k = n->start[i]; k < n->start[i + 1]; k++) {
        for (int c = 0; c < 3; c++) moment[c] += n->laplace[k] * (rest[3 * n->neighbour[k] + c] - rest[3 * i + c]);
        scale += n->laplace[k] * n->length[k];
    }
    for (int64_t k = n->start[i]; k < n->start[i + 1]; k++)
        if (n->weight[k] > 0) sum += (real)n->laplace[k];
    if (fabs(moment[0]) + fabs(moment[1]) + fabs(moment[2]) < 1e-6 * scale) *whole = sum;
}

static void fill_bonds(sheet *s, const sheet_network *n) {
    for (int32_t p = 0; p < s->pack_count; p++)
        for (int lane = 0; lane < PACK; lane++) {
            int64_t at = (int64_t)s->packs[p].first_slot * PACK + lane, i = s->id[(int64_t)p * PACK + lane];
            int32_t self = p * PACK + lane, used = 0;
            for (int64_t k = i < 0 ? 0 : n->start[i]; i >= 0 && k < n->start[i + 1]; k++)
                if (n->weight[k] > 0) load_bond(s, n, at + (int64_t)used++ * PACK, k);
            for (; used < s->packs[p].slots; used++) clear_bond(s, at + (int64_t)used * PACK, self);
            if (s->whole) mark_whole(s, n, p, lane);
            if (s->weight_sum) s->weight_sum[self] = i < 0 ? 1 : n->sum[i];
        }
}

/* ---- memory ------------------------------------------------------------------------------------------------------ */

/* Every array with its size: what is allocated, freed and counted. */
typedef struct array_row {
    void **array;
    size_t count, size;
    bool wanted;
} array_row;

enum { ARRAYS = 22 };

static void list_arrays(sheet *s, const sheet_network *n, array_row rows[ARRAYS]) {
    size_t packs = (size_t)s->pack_count, lanes = packs * PACK, bonds = (size_t)s->slot_count * PACK;
    bool history = false;
    if (n) {
        history = n->limit != NULL || (s->mask >> SHEET_EFFECT_elastoplastic & 1);
        for (int64_t k = 0; k < n->bond_count && !history; k++) history = n->cut[k];
    }
    const array_row all[ARRAYS] = {
        {(void **)&s->packs, packs, sizeof *s->packs, true},
        {(void **)&s->id, lanes, sizeof *s->id, true},
        {(void **)&s->place, (size_t)s->count, sizeof *s->place, true},
        {(void **)&s->node, lanes * NODE, sizeof(real), true},
        {(void **)&s->velocity, lanes * 3, sizeof(real), true},
        {(void **)&s->area, lanes, sizeof(real), true},
        {(void **)&s->holder, lanes, 1, true},
        {(void **)&s->results, (size_t)s->group_count, sizeof *s->results, true},
        {(void **)&s->diffused_next, lanes, sizeof(real), n && n->conduct},
        {(void **)&s->dilatation, lanes, sizeof(real), n && n->coupling},
        {(void **)&s->weight_sum, lanes, sizeof(double), n && n->coupling},
        {(void **)&s->curvature, lanes * 4, sizeof(real), n && n->laplace},
        {(void **)&s->whole, lanes, sizeof(real), n && n->laplace},
        {(void **)&s->neighbour, bonds, sizeof *s->neighbour, true},
        {(void **)&s->inverse, bonds, sizeof(real), true},
        {(void **)&s->stiffness, bonds, sizeof(real), true},
        {(void **)&s->limit, bonds, sizeof(real), n && n->limit},
        {(void **)&s->history, bonds, sizeof(real), history},
        {(void **)&s->conduct, bonds, sizeof(real), n && n->conduct},
        {(void **)&s->coupling, bonds, sizeof(real), n && n->coupling},
        {(void **)&s->dilation, bonds, sizeof(real), n && n->coupling},
        {(void **)&s->laplace, bonds, sizeof(real), n && n->laplace},
    };
    memcpy(rows, all, sizeof all);
}

static status allocate_rows(array_row *rows, int from, int to, report *r) {
    for (int i = from; i < to; i++) {
        if (!rows[i].wanted || *rows[i].array) continue;
        *rows[i].array = memory_allocate_array(rows[i].count, rows[i].size);
        if (!*rows[i].array) return report_set(r, STATUS_SYSTEM, "out of memory for a sheet's particles and bonds");
    }
    return STATUS_OK;
}

enum { BOND_ROWS = 13 };

status sheet_layout(sheet *s, const sheet_network *n, report *r) {
    array_row rows[ARRAYS];
    for (int b = 0; b < s->definition.body_count; b++) s->pack_count += (int32_t)((s->definition.bodies[b].count + PACK - 1) / PACK);
    s->group_count = (s->pack_count + GROUP_PACKS - 1) / GROUP_PACKS;
    list_arrays(s, n, rows);
    status code = allocate_rows(rows, 0, BOND_ROWS, r);
    if (code == STATUS_OK) code = place_particles(s, n, r);
    if (code != STATUS_OK) return code;
    list_arrays(s, n, rows);
    code = allocate_rows(rows, BOND_ROWS, ARRAYS, r);
    if (code == STATUS_OK) fill_bonds(s, n);
    return code;
}

status sheet_refill(sheet *s, const sheet_network *n, report *r) {
    array_row rows[ARRAYS];
    list_arrays(s, n, rows);
    status code = allocate_rows(rows, 0, ARRAYS, r); /* what a knob has turned on */
    if (code == STATUS_OK) fill_bonds(s, n);
    return code;
}

void sheet_layout_free(sheet *s) {
    array_row rows[ARRAYS];
    list_arrays(s, NULL, rows);
    for (int i = 0; i < ARRAYS; i++) memory_free(*rows[i].array, rows[i].count * rows[i].size);
}
