/* Inextensible fibres (AnisoMPM §6; METHOD.md §4): a tension λ on cell centres that takes the stretching along the current fibre a =
 * F a1/|F a1| out of the grid's velocities.
 *
 *     B_z,iα = Σ_p V_p Γ_z(x_p) a_α (a · G_ip),   (B M⁻¹ Bᵀ + ε) λ = B v*,   v = v* − M⁻¹ Bᵀ λ,   M = m_i/Δt
 *
 * Γ is linear between cell centres; the centre of cell (i, j, k) lies half a cell above node (i, j, k), so cells live in the
 * grid's blocks. G is the transfer's own gradient D⁻¹ w (x_i − x_p): an application of Bᵀ is a transfer of the stress λ a aᵀ to the grid, one of
 * B a gather of velocity gradients. Conjugate gradients, matrix-free, from the tension that the particles carry on from
 * the last step. The preconditioner is Jensen's bound of the diagonal, W_z Σ_p V_p Γ_z Σ_i (Δt/m_i)(a · G_ip)² with W_z = Σ V Γ_z: the diagonal
 * itself would need B's rows.
 *
 * Grips and colliders hold: a held node's M⁻¹ is projected (nothing, or the tangent plane). Colliders that material may leave
 * are an active set: nodes join it where the solve would push them in and leave it where it pulls them off.
 *
 * Sums are made slot by slot and added in the order of slots: the same bits at any number of threads. */
#include "base/memory.h"
#include "base/sparse.h"
#include "base/threads.h"
#include "solid/inextensible_planes.h"

#include <math.h>

enum { ITERATION_LIMIT = 2000, SET_ROUNDS = 4 };

/* Tensions that alternate from cell to cell pull at nothing: left alone they grow without bound, keep conjugate gradients busy and
 * shorten the step. This share of the diagonal damps them; what it lets through of the others, the correction below takes back. */
#define REGULARISATION ((real)5e-5)

/* A cell among held nodes has no say: the grip gives it its strain rate, and what is left for its tension to pull at is the rim of its kernel. Where
 * less than this share of its squared weights lies on what may move, it is no unknown and has no tension; left in, its tension grows with the inverse of
 * that share. Along fibres that enter a grip the shares are 0, 3.5 % (the outermost of four planes of nodes is free), 50 %, 96.5 % and 1. */
#define FREE_SHARE ((real)0.1)

/* ---- memory ------------------------------------------------------------------------------------------------------ */

status constraint_reserve(solid *s, int32_t slots, report *r) {
    fibre_constraint *c = &s->constraint;
    if (!c->on || slots <= c->capacity) return STATUS_OK;
    constraint_free(s);
    size_t fresh = (size_t)slots;
    c->cells = memory_allocate_array(fresh, PLANES * BLOCK_NODES * sizeof(real));
    c->nodes = memory_allocate_array(fresh, BLOCK_NODES * NODE * sizeof(real));
    c->holds = memory_allocate_array(fresh, BLOCK_NODES * sizeof *c->holds);
    c->sums = memory_allocate_array(fresh, sizeof *c->sums);
    c->number = memory_allocate_array(fresh, BLOCK_NODES * sizeof *c->number);
    c->slots = memory_allocate_array(fresh, sizeof *c->slots);
    c->reached = memory_allocate_array(fresh, 1);
    c->capacity = slots;
    if (c->cells && c->nodes && c->holds && c->sums && c->number && c->slots && c->reached) return STATUS_OK;
    constraint_free(s);
    return report_set(r, STATUS_SYSTEM, "out of memory for inextensible fibres on %d grid blocks", slots);
}

void constraint_free(solid *s) {
    fibre_constraint *c = &s->constraint;
    size_t slots = (size_t)c->capacity;
    memory_free(c->cells, c->cells ? slots * PLANES * BLOCK_NODES * sizeof(real) : 0);
    memory_free(c->nodes, c->nodes ? slots * BLOCK_NODES * NODE * sizeof(real) : 0);
    memory_free(c->holds, c->holds ? slots * BLOCK_NODES * sizeof *c->holds : 0);
    memory_free(c->sums, c->sums ? slots * sizeof *c->sums : 0);
    memory_free(c->number, c->number ? slots * BLOCK_NODES * sizeof *c->number : 0);
    memory_free(c->slots, c->slots ? slots * sizeof *c->slots : 0);
    memory_free(c->reached, c->reached ? slots : 0);
    c->cells = c->nodes = NULL, c->holds = NULL, c->sums = NULL, c->number = c->slots = NULL, c->reached = NULL;
    c->mapped = false;
    c->capacity = 0;
}

double constraint_bytes(const solid *s) {
    double node = PLANES * sizeof(real) + NODE * sizeof(real) + sizeof(node_hold) + sizeof(int32_t);
    return (double)s->constraint.capacity * BLOCK_NODES * node;
}

/* ---- nodes and cells, slot by slot ------------------------------------------------------------------------------- */

typedef void slot_pass(void *context, int64_t slot, int worker);

typedef struct slot_context {
    solid *state;
    real dt, factor;
    slot_pass *pass;
} slot_context;

static void on_listed_slot(void *context, int64_t i, int worker) {
    slot_context *c = context;
    c->pass(c, c->state->constraint.slots[i], worker);
}

/* Lists the slots that fibres can reach, in order. */
static void list_slots(solid *s) {
    fibre_constraint *c = &s->constraint;
    memset(c->reached, 0, (size_t)s->slot_count);
    for (int32_t i = 0; i < s->block_count; i++)
        for (int n = 0; n < NEIGHBOURS && block_is_inextensible(s, &s->blocks[i]); n++)
            if (s->blocks[i].neighbour[n] >= 0) c->reached[s->blocks[i].neighbour[n]] = 1;
    c->slot_count = 0;
    for (int32_t slot = 0; slot < s->slot_count; slot++)
        if (c->reached[slot]) c->slots[c->slot_count++] = slot;
}

static void over_slots(solid *s, slot_pass *pass, slot_context *context) {
    context->pass = pass;
    parallel_for(s->threads, s->constraint.slot_count, 32, on_listed_slot, context);
}

static constraint_sums sum_slots(const solid *s) {
    constraint_sums total = {0};
    for (int32_t i = 0; i < s->constraint.slot_count; i++) {
        const constraint_sums *part = &s->constraint.sums[s->constraint.slots[i]];
        total.first += part->first;
        total.second += part->second;
        total.largest = fmax(total.largest, part->largest);
    }
    return total;
}

/* Δt/m of a node. */
static real inverse_mass(real mass, real dt) {
    return mass > 0 ? dt / mass : 0;
}

static void clear_cells(void *context, int64_t slot, int worker) {
    (void)worker;
    slot_context *c = context;
    memset(plane(c->state, slot, TENSION), 0, PLANES * BLOCK_NODES * sizeof(real));
}

/* λ from the particles, and velocities and inverse masses as node vectors. Sums: Σ W², the largest speed. */
static void prepare_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    slot_context *c = context;
    solid *s = c->state;
    real *tension = plane(s, slot, TENSION), *weight = plane(s, slot, WEIGHT), *search = plane(s, slot, SEARCH);
    real *strain = plane(s, slot, STRAIN);
    const real *nodes = s->grid + slot * BLOCK_NODES * NODE;
    real *v = vectors(s, slot);
    constraint_sums sums = {0};
    for (int n = 0; n < BLOCK_NODES; n++) {
        tension[n] = weight[n] > 0 ? tension[n] / weight[n] : 0;
        strain[n] = weight[n] > 0 ? strain[n] / weight[n] : 0;
        search[n] = 0;
        sums.first += (double)weight[n] * (double)weight[n];
        double speed2 = 0;
        for (int i = 0; i < 3; i++) {
            v[n * NODE + i] = nodes[n * NODE + i];
            speed2 += (double)nodes[n * NODE + i] * (double)nodes[n * NODE + i];
        }
        sums.largest = fmax(sums.largest, speed2);
        v[n * NODE + 3] = s->constraint.holds[slot * BLOCK_NODES + n].kind == HOLD_FIXED ? 0 : inverse_mass(nodes[n * NODE + 3], c->dt);
    }
    s->constraint.sums[slot] = sums;
}

/* Node vectors ← the normals of holds and Δt/m. */
static void hold_normals_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    slot_context *c = context;
    real *v = vectors(c->state, slot);
    for (int n = 0; n < BLOCK_NODES; n++) {
        const node_hold *h = &c->state->constraint.holds[slot * BLOCK_NODES + n];
        bool in_plane = h->kind == HOLD_PLANE || h->kind == HOLD_TOUCHING;
        for (int i = 0; i < 3; i++) v[n * NODE + i] = in_plane ? h->normal[i] : 0;
        if (h->kind == HOLD_STUCK) v[n * NODE + 3] = 0;
    }
}

/* The nodes' fourth component ← T_i = Σ_q w_iq V_q |λ_q| / m_i; a node whose velocity is prescribed does not swing. */
static void wave_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    slot_context *c = context;
    solid *s = c->state;
    const real *nodes = s->grid + slot * BLOCK_NODES * NODE;
    real *v = vectors(s, slot);
    for (int n = 0; n < BLOCK_NODES; n++) {
        bool swings = nodes[n * NODE + 3] > 0 && s->constraint.holds[slot * BLOCK_NODES + n].kind != HOLD_FIXED;
        v[n * NODE + 3] = swings ? v[n * NODE + 3] / nodes[n * NODE + 3] : 0;
    }
}

static void clear_vectors(void *context, int64_t slot, int worker) {
    (void)worker;
    slot_context *c = context;
    memset(vectors(c->state, slot), 0, BLOCK_NODES * NODE * sizeof(real));
}

/* Node vectors ← P (Δt/m) of themselves; IMAGE ← ε SEARCH, to which B's share is added. */
static void respond_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    slot_context *c = context;
    solid *s = c->state;
    const real *nodes = s->grid + slot * BLOCK_NODES * NODE, *search = plane(s, slot, SEARCH), *relaxation = plane(s, slot, RELAXATION);
    real *v = vectors(s, slot), *image = plane(s, slot, IMAGE);
    for (int n = 0; n < BLOCK_NODES; n++) {
        real inverse = inverse_mass(nodes[n * NODE + 3], c->dt);
        double u[3];
        for (int i = 0; i < 3; i++) u[i] = (double)(v[n * NODE + i] * inverse);
        hold_project(&s->constraint.holds[slot * BLOCK_NODES + n], u);
        for (int i = 0; i < 3; i++) v[n * NODE + i] = (real)u[i];
        image[n] = relaxation[n] * search[n];
    }
}

/* Jacobi's preconditioner and the first residual. Sums: second r·r. */
static void residual_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    slot_context *c = context;
    solid *s = c->state;
    const real *image = plane(s, slot, IMAGE), *weight = plane(s, slot, WEIGHT), *relaxation = plane(s, slot, RELAXATION);
    real *r = plane(s, slot, RESIDUAL), *precondition = plane(s, slot, PRECONDITIONER);
    constraint_sums sums = {0};
    for (int n = 0; n < BLOCK_NODES; n++) {
        real diagonal = weight[n] * precondition[n] + relaxation[n];
        precondition[n] = diagonal > 0 ? 1 / diagonal : 0;
        r[n] = precondition[n] > 0 ? r[n] - image[n] : 0;
        sums.second += (double)r[n] * (double)r[n];
    }
    s->constraint.sums[slot] = sums;
}

/* Drops the cells that pull at little but held nodes, and adds the share of the diagonal that keeps the operator definite. Sums: first
 * Σ (Bv*)². */
static void regularise_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    slot_context *c = context;
    solid *s = c->state;
    real *r = plane(s, slot, RESIDUAL), *weight = plane(s, slot, WEIGHT), *response = plane(s, slot, PRECONDITIONER);
    real *relaxation = plane(s, slot, RELAXATION), *tension = plane(s, slot, TENSION), *search = plane(s, slot, SEARCH);
    const real *pull = plane(s, slot, PULL), *free_pull = plane(s, slot, FREE_PULL);
    constraint_sums sums = {0};
    for (int n = 0; n < BLOCK_NODES; n++) {
        if (!(free_pull[n] > FREE_SHARE * pull[n])) r[n] = weight[n] = response[n] = relaxation[n] = tension[n] = 0;
        relaxation[n] += REGULARISATION * weight[n] * response[n];
        search[n] = tension[n];
        sums.first += (double)r[n] * (double)r[n];
    }
    s->constraint.sums[slot] = sums;
}

/* search · image */
static void curvature_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    slot_context *c = context;
    const real *p = plane(c->state, slot, SEARCH), *image = plane(c->state, slot, IMAGE);
    constraint_sums sums = {0};
    for (int n = 0; n < BLOCK_NODES; n++) sums.first += (double)p[n] * (double)image[n];
    c->state->constraint.sums[slot] = sums;
}

/* λ += α p, r −= α q. Sums: second r·r. */
static void advance_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    slot_context *c = context;
    solid *s = c->state;
    const real *p = plane(s, slot, SEARCH), *image = plane(s, slot, IMAGE), *precondition = plane(s, slot, PRECONDITIONER);
    real *tension = plane(s, slot, TENSION), *r = plane(s, slot, RESIDUAL);
    constraint_sums sums = {0};
    for (int n = 0; n < BLOCK_NODES; n++) {
        tension[n] += c->factor * p[n];
        r[n] = precondition[n] > 0 ? r[n] - c->factor * image[n] : 0;
        sums.second += (double)r[n] * (double)r[n];
    }
    s->constraint.sums[slot] = sums;
}

/* z ← P⁻¹ r: the library's answer where the cell was an unknown of its matrix, Jacobi's elsewhere. Sums: first r·z. */
static void precondition_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    slot_context *c = context;
    solid *s = c->state;
    const fibre_constraint *own = &s->constraint;
    const double *answer = own->preconditioner ? own->vector + own->vector_size : NULL;
    const int32_t *number = own->number + slot * BLOCK_NODES;
    const real *r = plane(s, slot, RESIDUAL), *jacobi = plane(s, slot, PRECONDITIONER);
    real *z = plane(s, slot, PRECONDITIONED);
    constraint_sums sums = {0};
    for (int n = 0; n < BLOCK_NODES; n++) {
        z[n] = answer && number[n] >= 0 ? (real)(constraint_scale(s, (int32_t)slot, n) * answer[number[n]]) : jacobi[n] * r[n];
        sums.first += (double)r[n] * (double)z[n];
    }
    own->sums[slot] = sums;
}

/* p ← z + β p */
static void turn_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    slot_context *c = context;
    const real *z = plane(c->state, slot, PRECONDITIONED);
    real *p = plane(c->state, slot, SEARCH);
    for (int n = 0; n < BLOCK_NODES; n++) p[n] = z[n] + c->factor * p[n];
}

static void search_tension_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    slot_context *c = context;
    memcpy(plane(c->state, slot, SEARCH), plane(c->state, slot, TENSION), BLOCK_NODES * sizeof(real));
}

/* Which candidates the impulses −Δt Bᵀλ (node vectors hold Bᵀλ) push in or pull off; a node that changes starts from its velocity before
 * contact. Sums: how many changed. */
static void change_set_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    slot_context *c = context;
    solid *s = c->state;
    real *nodes = s->grid + slot * BLOCK_NODES * NODE;
    const real *force = vectors(s, slot);
    constraint_sums sums = {0};
    for (int n = 0; n < BLOCK_NODES; n++) {
        node_hold *h = &s->constraint.holds[slot * BLOCK_NODES + n];
        if (h->kind != HOLD_CANDIDATE && h->kind != HOLD_TOUCHING && h->kind != HOLD_STUCK) continue;
        real inverse = inverse_mass(nodes[n * NODE + 3], c->dt), speed = -h->wall, before = -h->wall;
        for (int i = 0; i < 3; i++) {
            before += h->normal[i] * h->before[i];
            speed += h->normal[i] * (h->before[i] - inverse * force[n * NODE + i]);
        }
        bool touches = h->kind != HOLD_CANDIDATE, should = speed < 0;
        if (touches == should) continue;
        h->kind = should ? HOLD_TOUCHING : HOLD_CANDIDATE;
        for (int i = 0; i < 3; i++) nodes[n * NODE + i] = h->before[i] - (should ? before * h->normal[i] : 0);
        sums.first += 1;
    }
    s->constraint.sums[slot] = sums;
}

/* v −= P (Δt/m) Bᵀλ. What a hold takes out of the impulse is the boundary's doing. */
static void finish_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    slot_context *c = context;
    solid *s = c->state;
    real *nodes = s->grid + slot * BLOCK_NODES * NODE;
    const real *force = vectors(s, slot);
    block_result *result = &s->slot_results[slot];
    for (int n = 0; n < BLOCK_NODES; n++) {
        const node_hold *h = &s->constraint.holds[slot * BLOCK_NODES + n];
        real inverse = inverse_mass(nodes[n * NODE + 3], c->dt);
        double change[3];
        for (int i = 0; i < 3; i++) change[i] = -(double)(inverse * force[n * NODE + i]);
        hold_project(h, change);
        for (int i = 0; i < 3; i++) {
            double held = (double)nodes[n * NODE + 3] * change[i] + (double)c->dt * (double)force[n * NODE + i];
            if (h->kind != HOLD_FREE && h->kind != HOLD_CANDIDATE) {
                result->grip_impulse[i] += held;
                result->grip_work += held * (double)nodes[n * NODE + i];
            }
            nodes[n * NODE + i] += (real)change[i];
        }
    }
}

double constraint_weight(const solid *s, int32_t slot, int n) {
    return (double)plane(s, slot, WEIGHT)[n];
}

double constraint_scale(const solid *s, int32_t slot, int n) {
    return sqrt((double)plane(s, slot, PRECONDITIONER)[n]);
}

double constraint_relaxation(const solid *s, int32_t slot, int n) {
    return (double)plane(s, slot, RELAXATION)[n];
}

/* ---- the solve --------------------------------------------------------------------------------------------------- */

/* IMAGE ← (B M⁻¹ Bᵀ + ε) SEARCH */
static void apply_operator(solid *s, slot_context *c) {
    over_slots(s, clear_vectors, c);
    constraint_sweep(s, c->dt, SWEEP_SPREAD);
    over_slots(s, respond_slot, c);
    constraint_sweep(s, c->dt, SWEEP_IMAGE);
}

/* Sets up right-hand side, preconditioner and first residual; *enough is the square of the residual to reach. */
static constraint_sums begin(solid *s, slot_context *c, double *enough) {
    over_slots(s, clear_cells, c);
    constraint_sweep(s, c->dt, SWEEP_START);
    over_slots(s, prepare_slot, c);
    constraint_sums size = sum_slots(s);
    constraint_sweep(s, c->dt, SWEEP_RIGHT);
    over_slots(s, hold_normals_slot, c);
    constraint_sweep(s, c->dt, SWEEP_RESPOND);
    over_slots(s, regularise_slot, c);
    double right = sum_slots(s).first, tolerance = s->constraint.tolerance;
    /* What rounding leaves of velocities that cancel cannot be solved for. */
    double rounding = (sizeof(real) == 4 ? 1e-7 : 1e-16) / s->definition.dx, noise = rounding * rounding * size.largest * size.first;
    *enough = fmax(tolerance * tolerance * right, noise);
    apply_operator(s, c);
    over_slots(s, residual_slot, c);
    return sum_slots(s);
}

/* z ← P⁻¹ r; *rho is r·z. */
static status precondition(solid *s, slot_context *c, double *rho, report *r) {
    fibre_constraint *own = &s->constraint;
    if (own->preconditioner) {
        for (int32_t i = 0; i < own->unknowns; i++) own->vector[i] = 0;
        for (int32_t i = 0; i < own->slot_count; i++) {
            const int32_t *number = own->number + (int64_t)own->slots[i] * BLOCK_NODES;
            const real *residual = plane(s, own->slots[i], RESIDUAL);
            for (int n = 0; n < BLOCK_NODES; n++)
                if (number[n] >= 0) own->vector[number[n]] = constraint_scale(s, own->slots[i], n) * (double)residual[n];
        }
        status code = sparse_apply(own->preconditioner, own->vector, own->vector + own->vector_size, r);
        if (code != STATUS_OK) return code;
    }
    over_slots(s, precondition_slot, c);
    *rho = sum_slots(s).first;
    return STATUS_OK;
}

/* One solve: conjugate gradients until the residual is small enough, with a better preconditioner when Jacobi's is slow. The
 * vectors of the nodes hold Bᵀλ at the end. */
static status iterate(solid *s, slot_context *c, report *r) {
    double enough, rho = 0, next;
    double square = begin(s, c, &enough).second;
    status code = STATUS_OK;
    constraint_map(s);
    bool fresh = true; /* p starts from z */
    int since = 0, built = 0; /* iterations since the solve's start or its own preconditioner */
    for (int i = 0; code == STATUS_OK && square > enough && i < ITERATION_LIMIT; i++, since++) {
        if (!isfinite(square))
            return report_set(r, STATUS_DIVERGED, "inextensible fibres (effect inextensible): iteration %d of the tension is not finite", i);
        if (constraint_is_slow(s, since, built)) {
            code = constraint_precondition(s, c->dt, r);
            since = 0, built++;
            fresh = true;
            if (code != STATUS_OK) return code;
        }
        if ((code = precondition(s, c, &next, r)) != STATUS_OK) return code;
        c->factor = fresh ? 0 : (real)(next / rho);
        rho = next;
        fresh = false;
        over_slots(s, turn_slot, c);
        apply_operator(s, c);
        over_slots(s, curvature_slot, c);
        double curvature = sum_slots(s).first;
        if (!(curvature > 0)) break; /* only directions that B does not see are left */
        c->factor = (real)(rho / curvature);
        over_slots(s, advance_slot, c);
        square = sum_slots(s).second;
        s->constraint.iterations++;
    }
    if (code != STATUS_OK) return code;
    constraint_solved(s, since, built);
    s->constraint.solves++;
    over_slots(s, search_tension_slot, c);
    over_slots(s, clear_vectors, c);
    constraint_sweep(s, c->dt, SWEEP_SPREAD);
    over_slots(s, wave_slot, c);
    constraint_sweep(s, c->dt, SWEEP_KEEP);
    return STATUS_OK;
}

status constraint_solve(solid *s, real dt, report *r) {
    if (!s->constraint.on) return STATUS_OK;
    slot_context c = {.state = s, .dt = dt};
    list_slots(s);
    for (int round = 0;; round++) {
        status code = iterate(s, &c, r);
        if (code != STATUS_OK) return code;
        if (round == SET_ROUNDS) break;
        over_slots(s, change_set_slot, &c);
        if (sum_slots(s).first == 0) break;
    }
    over_slots(s, finish_slot, &c);
    grid_collect_results(s);
    return STATUS_OK;
}
