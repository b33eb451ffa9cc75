/* Bonds within reach, their weights, and those that notches cut. */
#include "sheet/network.h"

#include "base/memory.h"
#include "base/random.h"
#include "geom/vector.h"

#include <math.h>
#include <string.h>

/* Cells of one body in a hash table: chains of particles. */
typedef struct cell_table {
    double size, origin[3];
    int64_t capacity;
    int32_t *head; // [capacity], −1: none
    int32_t *next; // [body count]
} cell_table;

static int64_t cell_slot(const cell_table *t, const int64_t cell[3]) {
    uint64_t key = random_mix((uint64_t)cell[0] ^ random_mix((uint64_t)cell[1] ^ random_mix((uint64_t)cell[2])));
    return (int64_t)(key & (uint64_t)(t->capacity - 1));
}

static void cell_of(const cell_table *t, const double x[3], int64_t cell[3]) {
    for (int c = 0; c < 3; c++) cell[c] = (int64_t)floor((x[c] - t->origin[c]) / t->size);
}

static void free_cells(cell_table *t, int64_t count) {
    memory_free(t->head, (size_t)t->capacity * sizeof *t->head);
    memory_free(t->next, (size_t)count * sizeof *t->next);
}

static status fill_cells(const sheet_definition *d, const sheet_body *b, cell_table *t, report *r) {
    *t = (cell_table){.size = b->radius * b->spacing * 1.0001, .capacity = 1024};
    while (t->capacity < 2 * b->count) t->capacity *= 2;
    t->head = memory_allocate_array((size_t)t->capacity, sizeof *t->head);
    t->next = memory_allocate_array((size_t)b->count, sizeof *t->next);
    if (!t->head || !t->next) {
        free_cells(t, b->count);
        return report_set(r, STATUS_SYSTEM, "out of memory for the bonds of %lld particles", (long long)b->count);
    }
    memcpy(t->origin, d->rest + 3 * b->first, sizeof t->origin);
    memset(t->head, 0xff, (size_t)t->capacity * sizeof *t->head);
    for (int64_t i = b->count - 1; i >= 0; i--) {
        int64_t cell[3];
        cell_of(t, d->rest + 3 * (b->first + i), cell);
        int64_t slot = cell_slot(t, cell);
        t->next[i] = t->head[slot];
        t->head[slot] = (int32_t)i;
    }
    return STATUS_OK;
}

enum { FOUND_LIMIT = 512 };

/* Particles within reach of particle i, ascending. Different cells may share a chain, so cells are compared too. */
static int find_near(const sheet_definition *d, const sheet_body *b, const cell_table *t, int64_t i, int32_t *found) {
    const double *x = d->rest + 3 * i;
    double reach = b->radius * b->spacing * (1 + 1e-9);
    int64_t middle[3], cell[3], other[3];
    int count = 0;
    cell_of(t, x, middle);
    for (int k = 0; k < 27; k++) {
        cell[0] = middle[0] + k / 9 - 1, cell[1] = middle[1] + k / 3 % 3 - 1, cell[2] = middle[2] + k % 3 - 1;
        for (int32_t p = t->head[cell_slot(t, cell)]; p >= 0; p = t->next[p]) {
            int64_t j = b->first + p;
            double difference[3];
            vector_subtract(d->rest + 3 * j, x, difference);
            if (j == i || vector_dot(difference, difference) > reach * reach) continue;
            cell_of(t, d->rest + 3 * j, other);
            if (memcmp(cell, other, sizeof cell) != 0) continue;
            if (count == FOUND_LIMIT) return -1;
            int place = count++;
            for (; place > 0 && found[place - 1] > j; place--) found[place] = found[place - 1];
            found[place] = (int32_t)j;
        }
    }
    return count;
}

static status find_body(const sheet_definition *d, int body, sheet_network *n, bool count_only, report *r) {
    const sheet_body *b = &d->bodies[body];
    cell_table t;
    status code = fill_cells(d, b, &t, r);
    if (code != STATUS_OK) return code;
    int32_t found[FOUND_LIMIT];
    for (int64_t i = b->first; i < b->first + b->count && code == STATUS_OK; i++) {
        int count = find_near(d, b, &t, i, found);
        if (count < 0) {
            code = report_set(r, STATUS_INPUT, "a particle of sheet %d has over %d neighbours: its radius is too large for its spacing", body + 1, FOUND_LIMIT);
        } else if (count_only) {
            n->body[i] = (uint8_t)body;
            n->start[i + 1] = count;
        } else {
            memcpy(n->neighbour + n->start[i], found, (size_t)count * sizeof *found);
        }
    }
    free_cells(&t, b->count);
    return code;
}

/* ---- weights ----------------------------------------------------------------------------------------------------- */

/* Weights by length, for a lattice: shells of equal length. */
typedef struct weight_table {
    int count;
    double length[LATTICE_LIMIT], weight[LATTICE_LIMIT]; /* in spacings */
} weight_table;

static status make_table(const sheet_body *b, sheet_weight kind, weight_table *t, report *r) {
    double xy[LATTICE_LIMIT][2];
    t->count = b->lattice == SHEET_SCATTERED ? 0 : lattice_neighbours(b->lattice, b->radius, xy);
    for (int k = 0; k < t->count; k++) t->length[k] = hypot(xy[k][0], xy[k][1]);
    return t->count ? lattice_weights(kind, b->radius, (const double(*)[2])xy, t->count, t->weight, r) : STATUS_OK;
}

static double weigh(const sheet_body *b, sheet_weight kind, const weight_table *t, double length) {
    double x = length / b->spacing, gap = HUGE_VAL, weight = 0;
    if (t->count == 0) return kind == WEIGHT_CONSTANT ? 1 : fmax(0, 1 - x / b->radius);
    for (int k = 0; k < t->count; k++)
        if (fabs(t->length[k] - x) < gap) gap = fabs(t->length[k] - x), weight = t->weight[k];
    return weight;
}

/* ---- notches ----------------------------------------------------------------------------------------------------- */

/* Whether the line from a to b enters the shape: steps by the distance, which is never more than the true one. */
static bool enters(const shape *s, const double a[3], const double b[3]) {
    double along[3], x[3];
    vector_subtract(b, a, along);
    double length = vector_length(along), least = 1e-3 * length;
    for (double at = 0; at <= length;) {
        for (int c = 0; c < 3; c++) x[c] = a[c] + along[c] * at / length;
        double distance = shape_distance(s, x);
        if (distance < 0) return true;
        at += fmax(distance, least);
    }
    return false;
}

/* Whether a and b lie on two sides of the notch's line, seen along its normal, and the bond crosses it between its ends. */
static bool crosses(const sheet_notch *n, const double a[3], const double b[3]) {
    double line[3], side[3], from_a[3], from_b[3];
    vector_subtract(n->to, n->from, line);
    vector_cross(n->normal, line, side);
    vector_subtract(a, n->from, from_a);
    vector_subtract(b, n->from, from_b);
    double sa = vector_dot(from_a, side), sb = vector_dot(from_b, side);
    if ((sa >= 0) == (sb >= 0)) return false;
    double share = sa / (sa - sb), length2 = vector_dot(line, line);
    double at = (1 - share) * vector_dot(from_a, line) + share * vector_dot(from_b, line);
    return at >= 0 && at <= length2;
}

static bool is_cut(const sheet_definition *d, int body, const double *low, const double *high) {
    for (int k = 0; k < d->notch_count; k++) {
        const sheet_notch *n = &d->notches[k];
        if (n->body >= 0 && n->body != body) continue;
        if (n->shape ? enters(n->shape, low, high) : crosses(n, low, high)) return true;
    }
    return false;
}

/* ---- building ---------------------------------------------------------------------------------------------------- */

static status measure_bonds(const sheet_definition *d, const sheet_plan *plans, int body, sheet_network *n, report *r) {
    const sheet_body *b = &d->bodies[body];
    sheet_weight kind = plans[b->material].weight;
    weight_table t;
    status code = make_table(b, kind, &t, r);
    for (int64_t i = b->first; i < b->first + b->count && code == STATUS_OK; i++)
        for (int64_t k = n->start[i]; k < n->start[i + 1]; k++) {
            int64_t j = n->neighbour[k], low = i < j ? i : j, high = i < j ? j : i; /* the same bits from both ends */
            double difference[3];
            vector_subtract(d->rest + 3 * high, d->rest + 3 * low, difference);
            n->length[k] = vector_length(difference);
            if (!(n->length[k] > 1e-6 * b->spacing))
                return report_set(r, STATUS_INPUT, "two particles of sheet %d lie on one another", body + 1);
            n->weight[k] = weigh(b, kind, &t, n->length[k]);
            n->cut[k] = is_cut(d, body, d->rest + 3 * low, d->rest + 3 * high);
        }
    return code;
}

static status allocate_bonds(const sheet_definition *d, const sheet_plan *plans, sheet_network *n, report *r) {
    size_t m = (size_t)n->bond_count;
    bool breaks = false, diffuses = false, state = false, bends = false;
    for (int b = 0; b < d->body_count; b++) {
        const sheet_plan *p = &plans[d->bodies[b].material];
        breaks |= p->fractures, diffuses |= p->diffuses, state |= p->state, bends |= p->bending > 0;
    }
    n->neighbour = memory_allocate_array(m, sizeof *n->neighbour);
    n->cut = memory_allocate_array(m, 1);
    double **const needed[] = {&n->length, &n->weight, &n->stiffness, breaks ? &n->limit : NULL, diffuses ? &n->conduct : NULL,
                               state ? &n->coupling : NULL, state ? &n->dilation : NULL, bends ? &n->laplace : NULL};
    bool good = n->neighbour && n->cut;
    for (size_t i = 0; i < sizeof needed / sizeof *needed; i++) {
        if (!needed[i]) continue;
        *needed[i] = memory_allocate_array(m, sizeof(double));
        good &= *needed[i] != NULL;
    }
    return good ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for %lld bonds", (long long)m / 2);
}

status network_build(const sheet_definition *d, const sheet_plan *plans, sheet_network *n, report *r) {
    *n = (sheet_network){.count = d->count};
    n->start = memory_allocate_array((size_t)d->count + 1, sizeof *n->start);
    n->body = memory_allocate_array((size_t)d->count, 1);
    n->sum = memory_allocate_array((size_t)d->count, sizeof *n->sum);
    n->pace = memory_allocate_array((size_t)d->count, sizeof *n->pace);
    status code = n->start && n->body && n->sum && n->pace ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for the bonds of a sheet");
    for (int b = 0; b < d->body_count && code == STATUS_OK; b++) code = find_body(d, b, n, true, r);
    for (int64_t i = 0; i < d->count && code == STATUS_OK; i++) n->start[i + 1] += n->start[i];
    n->bond_count = code == STATUS_OK ? n->start[d->count] : 0;
    if (code == STATUS_OK) code = allocate_bonds(d, plans, n, r);
    for (int b = 0; b < d->body_count && code == STATUS_OK; b++) code = find_body(d, b, n, false, r);
    for (int b = 0; b < d->body_count && code == STATUS_OK; b++) code = measure_bonds(d, plans, b, n, r);
    if (code != STATUS_OK) network_free(n);
    return code;
}

void network_free(sheet_network *n) {
    size_t m = (size_t)n->bond_count, bytes = m * sizeof(double);
    memory_free(n->start, ((size_t)n->count + 1) * sizeof *n->start);
    memory_free(n->body, (size_t)n->count);
    memory_free(n->sum, (size_t)n->count * sizeof *n->sum);
    memory_free(n->pace, (size_t)n->count * sizeof *n->pace);
    memory_free(n->neighbour, m * sizeof *n->neighbour);
    memory_free(n->cut, m);
    double *const arrays[] = {n->length, n->weight, n->stiffness, n->limit, n->conduct, n->coupling, n->dilation, n->laplace};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) memory_free(arrays[i], bytes);
    *n = (sheet_network){0};
}
