/* The inextensible solve's preconditioner: when to make one, of what, and which cells it knows. */
#include "base/dissection.h"
#include "base/memory.h"
#include "solid/inextensible.h"
#include "solid/order.h"

#include <math.h>
#include <string.h>

enum {
    PATIENCE = 40, /* iterations with Jacobi's before AUTO looks for better */
    EAGER = 12,    /* solves that make theirs at once, after one that was no good for a second solve */
};

/* Nanoseconds, roughly: an iteration a particle, and assembling a matrix an entry. Only what one is of the other counts. */
static const double ITERATING = 100, ASSEMBLING = 60;

/* Multiplications that a factorisation may take: a second with a BLAS that is made for the processor, some four with the reference one. */
static const double WORK_LIMIT = 2e10;

/* What the diagonal of the scaled matrix, one at the most, grows by, so that rounding leaves the matrix definite. */
static const double SHIFT = 1e-9;

static int stale_iterations(const fibre_constraint *c, int since) {
    return c->stale + (since > c->fresh ? since - c->fresh : 0);
}

/* A library's is made anew when the iterations that it took beyond those of its first solve add up to the price of a new one: never more than twice
 * what would have been best. */
bool constraint_is_slow(const solid *s, int since, int built) {
    const fibre_constraint *c = &s->constraint;
    if (c->refused || c->solver == CONSTRAINT_JACOBI || built > 0) return false;
    if (!c->preconditioner) return since == (c->solver == CONSTRAINT_AUTO ? PATIENCE : 0);
    return c->eager > 0 || stale_iterations(c, since) >= c->price;
}

void constraint_solved(solid *s, int since, int built) {
    fibre_constraint *c = &s->constraint;
    c->stale = built > 0 ? 0 : stale_iterations(c, since);
    c->uses = built > 0 ? 0 : c->uses + 1;
    if (built > 0) c->fresh = since;
}

void constraint_forget(solid *s) {
    fibre_constraint *c = &s->constraint;
    sparse_destroy(c->preconditioner);
    memory_free(c->vector, c->vector ? 2 * (size_t)c->vector_size * sizeof *c->vector : 0);
    memory_free(c->unknown, c->unknown ? (size_t)c->vector_size * sizeof *c->unknown : 0);
    c->preconditioner = NULL, c->vector = NULL, c->unknown = NULL;
    c->vector_size = c->unknowns = 0;
    c->refused = false;
}

void constraint_begin_frame(solid *s) {
    constraint_forget(s);
    s->constraint.eager = s->constraint.stale = s->constraint.fresh = s->constraint.uses = 0;
}

static int32_t count_unknowns(const solid *s) {
    int32_t count = 0;
    for (int32_t i = 0; i < s->constraint.slot_count; i++)
        for (int n = 0; n < BLOCK_NODES; n++) count += constraint_weight(s, s->constraint.slots[i], n) > 0;
    return count;
}

void constraint_map(solid *s) {
    fibre_constraint *c = &s->constraint;
    if (c->mapped || c->unknowns == 0) return;
    for (int64_t i = 0; i < (int64_t)s->slot_count * BLOCK_NODES; i++) c->number[i] = -1;
    for (int32_t i = 0; i < c->unknowns; i++) {
        int32_t block[3], node = 0;
        for (int axis = 0; axis < 3; axis++) {
            block[axis] = (c->unknown[i][axis] + 4 * BLOCK_LIMIT) / BLOCK - BLOCK_LIMIT;
            node = node * BLOCK + c->unknown[i][axis] - block[axis] * BLOCK;
        }
        int32_t slot = order_rank(s, block_key(block));
        if (slot >= 0) c->number[(int64_t)slot * BLOCK_NODES + node] = i;
    }
    c->mapped = true;
}

/* Renumbers them in the order of a dissection. */
static status order_unknowns(solid *s, report *r) {
    fibre_constraint *c = &s->constraint;
    size_t count = (size_t)c->unknowns;
    int32_t *order = memory_allocate_array(count, sizeof *order), (*cells)[3] = memory_allocate_array(count, sizeof *cells);
    bool fine = order && cells && dissection_order((const int32_t(*)[3])c->unknown, c->unknowns, constraint_reach(s), order);
    for (int32_t i = 0; fine && i < c->unknowns; i++) memcpy(cells[i], c->unknown[order[i]], sizeof cells[i]);
    if (fine) memcpy(c->unknown, cells, count * sizeof *cells);
    memory_free(order, order ? count * sizeof *order : 0);
    memory_free(cells, cells ? count * sizeof *cells : 0);
    if (!fine) return report_set(r, STATUS_SYSTEM, "out of memory for the order of %d cells of inextensible fibres", c->unknowns);
    c->mapped = false;
    constraint_map(s);
    return STATUS_OK;
}

/* Numbers the cells that hold fibres so that a factorisation fills in little. */
static status number_unknowns(solid *s, report *r) {
    fibre_constraint *c = &s->constraint;
    constraint_forget(s);
    size_t count = (size_t)count_unknowns(s);
    c->vector = memory_allocate_array(2 * count, sizeof *c->vector);
    c->unknown = memory_allocate_array(count, sizeof *c->unknown);
    c->vector_size = (int32_t)count;
    if (!c->vector || !c->unknown) return report_set(r, STATUS_SYSTEM, "out of memory for %d cells of inextensible fibres", (int)count);
    for (int32_t i = 0; i < c->slot_count; i++)
        for (int n = 0; n < BLOCK_NODES; n++) {
            if (!(constraint_weight(s, c->slots[i], n) > 0)) continue;
            const int32_t *block = s->slot_coordinate[c->slots[i]], at[3] = {n / 16, n / 4 % 4, n % 4};
            for (int axis = 0; axis < 3; axis++) c->unknown[c->unknowns][axis] = block[axis] * BLOCK + at[axis];
            c->unknowns++;
        }
    return order_unknowns(s, r);
}

/* What a new preconditioner costs, in iterations. */
static int price(const solid *s, int64_t entries) {
    double making, applying, particles = 0;
    sparse_price(s->constraint.preconditioner, &making, &applying);
    for (int32_t t = 0; t < s->tile_count; t++)
        if (s->constraint.material[s->tiles[t].material]) particles += s->tiles[t].count;
    return 1 + (int)((making + ASSEMBLING * (double)entries) / (applying + ITERATING * particles));
}

/* The matrix ← S A S, S² Jacobi's preconditioner; the vector of unknowns serves as room for S. A cell's row grows with its weight, by many orders of
 * magnitude from the rim of a fibre to its middle: scaled, all count alike. Cells that have no say get a row of their own. */
static void scale_matrix(solid *s, sparse_matrix *m) {
    fibre_constraint *c = &s->constraint;
    for (int32_t i = 0; i < c->slot_count; i++)
        for (int n = 0; n < BLOCK_NODES; n++) {
            int32_t number = c->number[(int64_t)c->slots[i] * BLOCK_NODES + n];
            if (number >= 0) c->vector[number] = constraint_scale(s, c->slots[i], n);
        }
    for (int32_t column = 0; column < m->size; column++)
        for (int32_t e = m->start[column]; e < m->start[column + 1]; e++) {
            m->value[e] *= c->vector[column] * c->vector[m->row[e]];
            if (m->row[e] == column) m->value[e] += c->vector[column] > 0 ? SHIFT : 1;
        }
}

status constraint_precondition(solid *s, real dt, report *r) {
    fibre_constraint *c = &s->constraint;
    c->eager = c->eager > 0 ? c->eager - 1 : c->preconditioner && c->uses == 0 ? EAGER : 0;
    sparse_matrix m = {0};
    status code = number_unknowns(s, r);
    if (code == STATUS_OK) code = constraint_assemble(s, dt, c->number, c->unknowns, &m, r);
    if (code == STATUS_OK) {
        scale_matrix(s, &m);
        m.ordered = true;
        bool automatic = c->solver == CONSTRAINT_AUTO;
        if (c->solver == CONSTRAINT_DIRECT || (automatic && sparse_available(SPARSE_DIRECT)))
            code = sparse_create(SPARSE_DIRECT, &m, automatic ? WORK_LIMIT : 0, &c->preconditioner, r);
        if (code == STATUS_OK && !c->preconditioner && (c->solver == CONSTRAINT_AMG || (automatic && sparse_available(SPARSE_AMG))))
            code = sparse_create(SPARSE_AMG, &m, 0, &c->preconditioner, r);
    }
    if (c->preconditioner) c->price = price(s, m.start[m.size]);
    sparse_free(&m);
    if (code != STATUS_OK) return code;
    c->refused = !c->preconditioner;
    c->factorisations++;
    return STATUS_OK;
}
