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
#include "solid/inextensible_lanes.h"
#include "solid/records.h"

#include <math.h>

/* Planes of cells, [slot][PLANES][BLOCK_NODES]. */
enum { TENSION, WEIGHT, RELAXATION, STRAIN, RESIDUAL, PRECONDITIONER, SEARCH, IMAGE, PRECONDITIONED, PLANES, STARTED = 4 };

enum { ITERATION_LIMIT = 2000, SET_ROUNDS = 4 };

/* Tensions that alternate from cell to cell pull at nothing: left alone they grow without bound, keep conjugate gradients busy and
 * shorten the step. This share of the diagonal damps them; what it lets through of the others, the correction below takes back. */
#define REGULARISATION ((real)5e-5)

/* A fibre's stretch is taken back within a fraction of the time that the matrix needs to carry a wave over a cell (`recovery`), so that what tolerance and time
 * steps let through does not add up; at most this share in one step, and beyond the most that is corrected at once it is pulled back gently. (A
 * share of each step alone runs away: tension shortens the step, which raises the tension that a share asks for.) It is the cells'
 * mean that is taken back: what single particles stretch beside it is in nobody's power, and asking for it drives tension
 * without bound. */
#define CORRECTION ((real)0.25)
#define CORRECTED_MOST ((real)0.05)

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

static real *plane(const solid *s, int64_t slot, int which) {
    return s->constraint.cells + (slot * PLANES + which) * BLOCK_NODES;
}

static real *vectors(const solid *s, int64_t slot) {
    return s->constraint.nodes + slot * BLOCK_NODES * NODE;
}

/* ---- particles --------------------------------------------------------------------------------------------------- */

typedef struct pass_context {
    solid *state;
    const int32_t *blocks;
    real dt;
} pass_context;

SIMD_INLINE real cells_gather(const fibre_lanes *l, int lane, const real *window) {
    real weight[8], sum = 0;
    cell_weights(l, lane, weight);
    const real *from = window + (int)l->cell[lane];
    for (int i = 0; i < 8; i++) sum += weight[i] * from[cell_step[i]];
    return sum;
}

SIMD_INLINE void cells_scatter(const fibre_lanes *l, int lane, real value, real *window) {
    real weight[8];
    cell_weights(l, lane, weight);
    real *to = window + (int)l->cell[lane];
    for (int i = 0; i < 8; i++) to[cell_step[i]] += weight[i] * value;
}

static bool block_is_inextensible(const solid *s, const solid_block *b) {
    for (int32_t t = b->first_tile; t < b->first_tile + b->tile_count; t++)
        if (tile_is_inextensible(s, &s->tiles[t])) return true;
    return false;
}

/* D⁻¹ times dx: G = this × w × (distance in dx). */
SIMD_INLINE real gradient_scale(const solid *s, kernel_kind kernel) {
    return (real)((kernel == KERNEL_QUADRATIC ? 4.0 : 3.0) / s->definition.dx);
}

/* One plane of a block's cells to or from the grid. */
static void exchange_plane(const solid *s, const solid_block *b, real *window, int which, bool to_grid) {
    bool wide = kernels_are_wide(s->definition.kernel, s->definition.laplacian, s->transfers_damage);
    exchange_window(b, window, s->constraint.cells + which * BLOCK_NODES, 1, PLANES * BLOCK_NODES, wide, to_grid);
}

static void exchange_vectors(const solid *s, const solid_block *b, real *window, bool to_grid) {
    bool wide = kernels_are_wide(s->definition.kernel, s->definition.laplacian, s->transfers_damage);
    exchange_window(b, window, s->constraint.nodes, NODE, BLOCK_NODES * NODE, wide, to_grid);
}

/* The particles' tensions, weights, relaxations and strain rates asked for to the cells: the start of a solve. */
SIMD_INLINE void start_block(pass_context *c, int32_t index, int worker, kernel_kind kernel) {
    solid *s = c->state;
    const solid_block *b = &s->blocks[index];
    if (!block_is_inextensible(s, b)) return;
    real *window = s->workers[worker].implicit_window;
    memset(window, 0, STARTED * WINDOW_NODES * sizeof *window);
    FOR_EACH_PART(s, b, {
        fibre_lanes l = lanes_load(s, kernel, pack, part);
        vec tension = s->constraint.warm ? vec_load(field_at(&s->fields[s->tension_field], pack, 0, part)) : vec_all(0);
        vec strain = vec_max(vec_min(l.stretch - 1, vec_all(CORRECTED_MOST)), vec_all(-CORRECTED_MOST));
        real relaxation = s->constraint.relaxation[t->material] / c->dt, most = CORRECTION / c->dt;
        real rate = s->constraint.recovery[t->material] < most ? s->constraint.recovery[t->material] : most;
        for (int lane = 0; lane < LANES_OF(t, first); lane++) {
            cells_scatter(&l, lane, l.volume[lane] * tension[lane], window + TENSION * WINDOW_NODES);
            cells_scatter(&l, lane, l.volume[lane], window + WEIGHT * WINDOW_NODES);
            cells_scatter(&l, lane, l.volume[lane] * relaxation, window + RELAXATION * WINDOW_NODES);
            cells_scatter(&l, lane, l.volume[lane] * strain[lane] * rate, window + STRAIN * WINDOW_NODES);
        }
    })
    for (int which = 0; which < STARTED; which++) exchange_plane(s, b, window + which * WINDOW_NODES, which, true);
}

/* Nodes ← Bᵀ SEARCH. */
SIMD_INLINE void spread_block(pass_context *c, int32_t index, int worker, kernel_kind kernel) {
    solid *s = c->state;
    const solid_block *b = &s->blocks[index];
    if (!block_is_inextensible(s, b)) return;
    solid_worker *own = &s->workers[worker];
    real *cells = own->implicit_window, *records = own->tile.records;
    const real offsets[4] = {0, 1, 2, 3};
    node_row node_offset = row_spread(offsets);
    real scale = gradient_scale(s, kernel);
    int nodes = kernel == KERNEL_QUADRATIC ? 3 : 4;
    exchange_plane(s, b, cells, SEARCH, false);
    memset(own->window, 0, sizeof own->window);
    FOR_EACH_PART(s, b, {
        fibre_lanes l = lanes_load(s, kernel, pack, part);
        vec q = vec_all(0);
        for (int lane = 0; lane < LANES_OF(t, first); lane++) q[lane] = cells_gather(&l, lane, cells);
        q *= l.volume * scale;
        const vec a[3] = {l.a.x, l.a.y, l.a.z};
        const vec u[3] = {l.at.u.x, l.at.u.y, l.at.u.z};
        vec along = vec_fma(a[0], u[0], vec_fma(a[1], u[1], a[2] * u[2]));
        vec columns[RECORD] = {vec_all(0)};
        static const int weight_slot[3] = {P2G_WX, P2G_WY, P2G_WZ};
        for (int axis = 0; axis < 3; axis++) {
            kernel_weights(kernel, u[axis], columns + weight_slot[axis]);
            columns[P2G_BASE + axis] = -(q * a[axis] * along);
            for (int column = 0; column < 3; column++) columns[P2G_X + 4 * column + axis] = q * a[axis] * a[column];
        }
        columns[P2G_NODE] = window_index(l.at.base);
        records_store(records, first, 0, columns, RECORD);
        if (k + 1 == t->pack_count && part + 1 == PACK_PARTS)
            for (int p = 0; p < t->count;) p = scatter_run(records, p, t->count, nodes, node_offset, own->window);
    })
    exchange_vectors(s, b, own->window, true);
}

/* a · (Σ_i w_i v_i (x_i − x_p)ᵀ) a of the lanes of one part, from gathered records. */
SIMD_INLINE vec stretching(const fibre_lanes *l, const real *records, int first) {
    const vec a[3] = {l->a.x, l->a.y, l->a.z};
    vec rate = vec_all(0), out[RECORD - G2P_OUT];
    records_load(records, first, G2P_OUT, out, RECORD - G2P_OUT);
    for (int column = 0; column < 3; column++) {
        vec along = vec_all(0);
        for (int c = 0; c < 3; c++) along = vec_fma(a[c], out[4 + 4 * column + c], along);
        rate = vec_fma(along, a[column], rate);
    }
    return rate;
}

SIMD_INLINE void gather_records(real *records, int first, int lanes, const fibre_lanes *l, kernel_kind kernel, const node_row node_offset,
                                const real *window) {
    const vec u[3] = {l->at.u.x, l->at.u.y, l->at.u.z};
    static const int weight_slot[3] = {G2P_WX, G2P_WY, G2P_WZ};
    vec columns[G2P_OUT];
    for (int axis = 0; axis < 3; axis++) {
        kernel_weights(kernel, u[axis], columns + weight_slot[axis]);
        columns[G2P_OFFSET + axis] = u[axis];
    }
    columns[G2P_NODE] = window_index(l->at.base);
    records_store(records, first, 0, columns, G2P_OUT);
    for (int lane = 0; lane < lanes; lane++)
        gather_particle(records + (first + lane) * RECORD, kernel == KERNEL_QUADRATIC ? 3 : 4, node_offset, window);
    for (int lane = lanes; lane < VEC_LANES; lane++) memset(records + (first + lane) * RECORD + G2P_OUT, 0, 16 * sizeof(real));
}

/* A plane of cells += B nodes; the right-hand side also asks for what fibres have stretched so far. */
SIMD_INLINE void collect_block(pass_context *c, int32_t index, int worker, kernel_kind kernel, int into) {
    solid *s = c->state;
    const solid_block *b = &s->blocks[index];
    if (!block_is_inextensible(s, b)) return;
    solid_worker *own = &s->workers[worker];
    real *cells = own->implicit_window, scale = gradient_scale(s, kernel);
    const real offsets[4] = {0, 1, 2, 3};
    node_row node_offset = row_spread(offsets);
    exchange_vectors(s, b, own->window, false);
    memset(cells, 0, WINDOW_NODES * sizeof *cells);
    if (into == RESIDUAL) exchange_plane(s, b, cells + WINDOW_NODES, STRAIN, false);
    FOR_EACH_PART(s, b, {
        fibre_lanes l = lanes_load(s, kernel, pack, part);
        gather_records(own->tile.records, first, LANES_OF(t, first), &l, kernel, node_offset, own->window);
        vec value = l.volume * scale * stretching(&l, own->tile.records, first);
        if (into == RESIDUAL)
            for (int lane = 0; lane < LANES_OF(t, first); lane++)
                value[lane] += l.volume[lane] * cells_gather(&l, lane, cells + WINDOW_NODES);
        for (int lane = 0; lane < LANES_OF(t, first); lane++) cells_scatter(&l, lane, value[lane], cells);
    })
    exchange_plane(s, b, cells, into, true);
}

/* Σ_i (Δt/m_i) (a · G_ip)² of one lane; the inverse masses are the fourth component of the node vectors. */
SIMD_INLINE real response(const fibre_lanes *l, int lane, kernel_kind kernel, real scale, const real *window) {
    const vec u[3] = {l->at.u.x, l->at.u.y, l->at.u.z};
    const real a[3] = {l->a.x[lane], l->a.y[lane], l->a.z[lane]};
    int nodes = kernel == KERNEL_QUADRATIC ? 3 : 4;
    real w[3][4], x[3][4], sum = 0;
    for (int axis = 0; axis < 3; axis++) {
        vec weight[4];
        kernel_weights(kernel, u[axis], weight);
        for (int n = 0; n < nodes; n++) {
            w[axis][n] = weight[n][lane];
            x[axis][n] = a[axis] * ((real)n - u[axis][lane]);
        }
    }
    const real *from = window + (int)window_index(l->at.base)[lane] * NODE;
    for (int i = 0; i < nodes; i++)
        for (int j = 0; j < nodes; j++)
            for (int n = 0; n < nodes; n++) {
                real gradient = scale * w[0][i] * w[1][j] * w[2][n] * (x[0][i] + x[1][j] + x[2][n]);
                sum += gradient * gradient * from[(i * STRIDE_X + j * STRIDE_Y + n) * NODE + 3];
            }
    return sum;
}

SIMD_INLINE void precondition_block(pass_context *c, int32_t index, int worker, kernel_kind kernel) {
    solid *s = c->state;
    const solid_block *b = &s->blocks[index];
    if (!block_is_inextensible(s, b)) return;
    solid_worker *own = &s->workers[worker];
    real *cells = own->implicit_window, scale = gradient_scale(s, kernel);
    exchange_vectors(s, b, own->window, false);
    memset(cells, 0, WINDOW_NODES * sizeof *cells);
    FOR_EACH_PART(s, b, {
        fibre_lanes l = lanes_load(s, kernel, pack, part);
        for (int lane = 0; lane < LANES_OF(t, first); lane++)
            cells_scatter(&l, lane, l.volume[lane] * response(&l, lane, kernel, scale, own->window), cells);
    })
    exchange_plane(s, b, cells, PRECONDITIONER, true);
}

/* The cells' tensions back to the particles: the next solve starts from them. */
SIMD_INLINE void keep_block(pass_context *c, int32_t index, int worker, kernel_kind kernel) {
    solid *s = c->state;
    const solid_block *b = &s->blocks[index];
    if (!block_is_inextensible(s, b)) return;
    real *cells = s->workers[worker].implicit_window;
    exchange_plane(s, b, cells, TENSION, false);
    FOR_EACH_PART(s, b, {
        fibre_lanes l = lanes_load(s, kernel, pack, part);
        real *tension = field_at(&s->fields[s->tension_field], pack, 0, part);
        for (int lane = 0; lane < LANES_OF(t, first); lane++) tension[lane] = cells_gather(&l, lane, cells);
    })
}

#define PASSES(name, kernel)                                                                                           \
    static void start_##name(void *context, int64_t i, int worker) {                                                   \
        pass_context *c = context;                                                                                     \
        start_block(c, c->blocks[i], worker, kernel);                                                                  \
    }                                                                                                                  \
    static void spread_##name(void *context, int64_t i, int worker) {                                                  \
        pass_context *c = context;                                                                                     \
        spread_block(c, c->blocks[i], worker, kernel);                                                                 \
    }                                                                                                                  \
    static void image_##name(void *context, int64_t i, int worker) {                                                   \
        pass_context *c = context;                                                                                     \
        collect_block(c, c->blocks[i], worker, kernel, IMAGE);                                                         \
    }                                                                                                                  \
    static void right_##name(void *context, int64_t i, int worker) {                                                   \
        pass_context *c = context;                                                                                     \
        collect_block(c, c->blocks[i], worker, kernel, RESIDUAL);                                                      \
    }                                                                                                                  \
    static void precondition_##name(void *context, int64_t i, int worker) {                                            \
        pass_context *c = context;                                                                                     \
        precondition_block(c, c->blocks[i], worker, kernel);                                                           \
    }                                                                                                                  \
    static void keep_##name(void *context, int64_t i, int worker) {                                                    \
        pass_context *c = context;                                                                                     \
        keep_block(c, c->blocks[i], worker, kernel);                                                                   \
    }
PASSES(quadratic, KERNEL_QUADRATIC)
PASSES(cubic, KERNEL_CUBIC)

typedef void block_pass(void *context, int64_t i, int worker);
#define PASS(s, name) ((s)->definition.kernel == KERNEL_CUBIC ? name##_cubic : name##_quadratic)

static void by_colour(solid *s, real dt, block_pass *pass) {
    pass_context c = {.state = s, .dt = dt};
    for (int colour = 0; colour < s->colour_count; colour++) {
        c.blocks = s->colour_blocks + s->colour_start[colour];
        parallel_for(s->threads, s->colour_start[colour + 1] - s->colour_start[colour], 1, pass, &c);
    }
}

/* ---- nodes and cells, slot by slot ------------------------------------------------------------------------------- */

typedef struct slot_context {
    solid *state;
    real dt, factor;
    block_pass *pass;
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

static void over_slots(solid *s, block_pass *pass, slot_context *context) {
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
        search[n] = tension[n];
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

/* Adds the share of the diagonal that keeps the operator definite. Sums: first Σ (Bv*)². */
static void regularise_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    slot_context *c = context;
    solid *s = c->state;
    const real *r = plane(s, slot, RESIDUAL), *weight = plane(s, slot, WEIGHT), *response = plane(s, slot, PRECONDITIONER);
    real *relaxation = plane(s, slot, RELAXATION);
    constraint_sums sums = {0};
    for (int n = 0; n < BLOCK_NODES; n++) {
        relaxation[n] += REGULARISATION * weight[n] * response[n];
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
        z[n] = answer && number[n] >= 0 && jacobi[n] > 0 ? (real)answer[number[n]] : jacobi[n] * r[n];
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

double constraint_relaxation(const solid *s, int32_t slot, int n) {
    return (double)plane(s, slot, RELAXATION)[n];
}

/* ---- the solve --------------------------------------------------------------------------------------------------- */

/* IMAGE ← (B M⁻¹ Bᵀ + ε) SEARCH */
static void apply_operator(solid *s, slot_context *c) {
    over_slots(s, clear_vectors, c);
    by_colour(s, c->dt, PASS(s, spread));
    over_slots(s, respond_slot, c);
    by_colour(s, c->dt, PASS(s, image));
}

/* Sets up right-hand side, preconditioner and first residual; *enough is the square of the residual to reach. */
static constraint_sums begin(solid *s, slot_context *c, double *enough) {
    over_slots(s, clear_cells, c);
    by_colour(s, c->dt, PASS(s, start));
    over_slots(s, prepare_slot, c);
    constraint_sums size = sum_slots(s);
    by_colour(s, c->dt, PASS(s, right));
    by_colour(s, c->dt, PASS(s, precondition));
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
                if (number[n] >= 0) own->vector[number[n]] = (double)residual[n];
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
    for (int i = 0, since = 0, built = 0; code == STATUS_OK && square > enough && i < ITERATION_LIMIT; i++, since++) {
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
    s->constraint.solves++;
    over_slots(s, search_tension_slot, c);
    over_slots(s, clear_vectors, c);
    by_colour(s, c->dt, PASS(s, spread));
    by_colour(s, c->dt, PASS(s, keep));
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
