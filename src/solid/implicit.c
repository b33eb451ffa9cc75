/* Damage, implicit (AnisoMPM §4.3; METHOD.md §2), multiplied through by η/Δt, so that nothing is divided by η and η = 0 is the
 * rate-independent limit. A particle's backward Euler step is
 *     r_p d_p = b_p + Σ_i w_ip s_i,   r_p = η/Δt + 1 + D̃_p,   b_p = (η/Δt) d_pⁿ + D̃_p,
 * where s_i is diffusion l0² Δd at the nodes: s = −V⁻¹ B d, V_i = Σ V_p w_ip, B_ij = Σ V_p l0² ∇Θ_i·∇Θ_j, ∇Θ_i = D⁻¹ w_ip (x_i − x_p), of
 * the nodes' means d_i = Σ V_p w_ip d_p / V_i. Putting the first into the last, with the mean of w s / r lumped to s_i R_i,
 *     (A + B) d = c,   A_i = V_i/R_i,   c_i = A_i m_i,   R_i = Σ V_p w_ip / r_p / V_i,   m_i = Σ V_p w_ip b_p / r_p / V_i.
 * Symmetric, positive definite, diagonally strong: conjugate gradients with Jacobi's preconditioner, matrix-free, from m. Sums over
 * nodes are made slot by slot and added in the order of slots, so the iterations have the same bits at any number of threads. Then each
 * particle takes its step (implicit_damage in state.h).
 *
 * Where D̃ is even this is the paper's system, A_i = Σ V_p r_p w_ip. Where it is not, the paper's arithmetic mean of r lets the driven
 * particles speak for all: a node half of whose particles are broken is broken. With its increments handed back (FLIP) and only growth
 * kept, particles near a driven one then follow it, and driven ones pass their own equilibrium D̃/(1 + D̃): a band of D̃ = 20, two cells
 * wide, ended at d = 1 instead of 0.95, half as wide again, at any Δt. */
#include "base/memory.h"
#include "base/threads.h"
#include "solid/kernels.h"

#include <math.h>

/* Planes of nodes, [slot][PLANES][BLOCK_NODES]. The first four are scattered together: DIAGONAL starts as V R, SOURCE as V m,
 * PRECONDITIONER as B's diagonal. */
enum { DIAGONAL, SOURCE, PRECONDITIONER, VOLUME, SPREAD, SOLUTION, RESIDUAL_VECTOR, SEARCH, IMAGE, PLANES, SCATTERED = IMPLICIT_WINDOWS };

enum { ITERATION_LIMIT = 1000 };

status implicit_reserve(solid *s, int32_t slots, report *r) {
    if (!s->implicit_on || slots <= s->implicit_capacity) return STATUS_OK;
    implicit_free(s);
    s->implicit_grid = memory_allocate_array((size_t)slots, PLANES * BLOCK_NODES * sizeof(real));
    s->implicit_sums = memory_allocate_array((size_t)slots, 2 * sizeof *s->implicit_sums);
    s->implicit_capacity = slots;
    if (s->implicit_grid && s->implicit_sums) return STATUS_OK;
    implicit_free(s);
    return report_set(r, STATUS_SYSTEM, "out of memory for implicit damage on %d grid blocks", slots);
}

void implicit_free(solid *s) {
    size_t slots = (size_t)s->implicit_capacity;
    memory_free(s->implicit_grid, s->implicit_grid ? slots * PLANES * BLOCK_NODES * sizeof(real) : 0);
    memory_free(s->implicit_sums, s->implicit_sums ? slots * 2 * sizeof *s->implicit_sums : 0);
    s->implicit_grid = NULL, s->implicit_sums = NULL;
    s->implicit_capacity = 0;
}

static real *plane(const solid *s, int64_t slot, int which) {
    return s->implicit_grid + (slot * PLANES + which) * BLOCK_NODES;
}

/* ---- passes over particles --------------------------------------------------------------------------------------- */

typedef struct pass_context {
    solid *state;
    const int32_t *blocks;
    real dt;
} pass_context;

/* One particle's kernel: weights and distances of the nodes along each axis, and where they begin in the window. */
typedef struct particle_kernel {
    real w[3][4], x[3][4];
    int node;
} particle_kernel;

/* Calls body(kernel, particle) for each particle of a tile; kernels are made a vector at a time. */
#define FOR_EACH_KERNEL(s, tile, kernel_of, k_, body)                                                                  \
    for (int k_ = 0; k_ < (tile)->pack_count; k_++)                                                                    \
        for (int part = 0; part < PACK_PARTS; part++) {                                                                \
            kernel_place at = kernel_locate(kernel_of, vec3v_load(&(s)->fields[FIELD_POSITION], (tile)->first_pack + k_, part)); \
            vec u[3] = {at.u.x, at.u.y, at.u.z}, weight[3][4], first_node = window_index(at.base);                     \
            for (int axis = 0; axis < 3; axis++) kernel_weights(kernel_of, u[axis], weight[axis]);                     \
            for (int lane = 0; lane < VEC_LANES; lane++) {                                                             \
                if (k_ * PACK + part * VEC_LANES + lane >= (tile)->count) break;                                       \
                particle_kernel kernel = {.node = (int)first_node[lane]};                                              \
                for (int axis = 0; axis < 3; axis++)                                                                   \
                    for (int n = 0; n < 4; n++) {                                                                      \
                        kernel.w[axis][n] = weight[axis][n][lane];                                                     \
                        kernel.x[axis][n] = (real)n - u[axis][lane];                                                   \
                    }                                                                                                  \
                int32_t pack = (tile)->first_pack + k_;                                                                \
                int within = part * VEC_LANES + lane;                                                                  \
                body;                                                                                                  \
            }                                                                                                          \
        }

static bool tile_is_implicit(const solid *s, const solid_tile *tile) {
    return s->material_implicit[tile->material];
}

/* D⁻¹ in dx: ∇Θ = this × w × (distance in dx). */
SIMD_INLINE real gradient_scale(const solid *s) {
    return (real)((s->definition.laplacian == KERNEL_QUADRATIC ? 4.0 : 3.0) / s->definition.dx);
}

SIMD_INLINE void scatter_system(const particle_kernel *k, int nodes, real volume, real mobility, real own, real spread, real *window) {
    for (int i = 0; i < nodes; i++)
        for (int j = 0; j < nodes; j++) {
            real wij = k->w[0][i] * k->w[1][j], reach = k->x[0][i] * k->x[0][i] + k->x[1][j] * k->x[1][j];
            real *to = window + k->node + (i * WINDOW + j) * WINDOW;
            for (int n = 0; n < nodes; n++) {
                real w = wij * k->w[2][n], distance2 = reach + k->x[2][n] * k->x[2][n];
                to[DIAGONAL * WINDOW_NODES + n] += volume * mobility * w;
                to[SOURCE * WINDOW_NODES + n] += volume * own * w;
                to[PRECONDITIONER * WINDOW_NODES + n] += volume * spread * w * w * distance2;
                to[VOLUME * WINDOW_NODES + n] += volume * w;
            }
        }
}

/* y += V l0² ∇Θ (Σ ∇Θ_j x_j): a gather, then a scatter, of one particle. */
SIMD_INLINE void apply_particle(const particle_kernel *k, int nodes, real factor, const real *x, real *y) {
    real g[3] = {0, 0, 0};
    for (int i = 0; i < nodes; i++)
        for (int j = 0; j < nodes; j++) {
            const real *from = x + k->node + (i * WINDOW + j) * WINDOW;
            real plain = 0, along = 0, wij = k->w[0][i] * k->w[1][j];
            for (int n = 0; n < nodes; n++) {
                real value = k->w[2][n] * from[n];
                plain += value;
                along += value * k->x[2][n];
            }
            g[0] += wij * k->x[0][i] * plain;
            g[1] += wij * k->x[1][j] * plain;
            g[2] += wij * along;
        }
    for (int i = 0; i < nodes; i++)
        for (int j = 0; j < nodes; j++) {
            real *to = y + k->node + (i * WINDOW + j) * WINDOW;
            real wij = factor * k->w[0][i] * k->w[1][j], flat = g[0] * k->x[0][i] + g[1] * k->x[1][j];
            for (int n = 0; n < nodes; n++) to[n] += wij * k->w[2][n] * (flat + g[2] * k->x[2][n]);
        }
}

/* Planes of one block's window to or from the grid. */
SIMD_INLINE void exchange_plane(const solid *s, const solid_block *b, real *window, int which, bool to_grid) {
    bool wide = kernels_are_wide(s->definition.kernel, s->definition.laplacian, true);
    exchange_window(b, window, s->implicit_grid + which * BLOCK_NODES, 1, PLANES * BLOCK_NODES, wide, to_grid);
}

SIMD_INLINE void system_block(pass_context *c, int32_t index, int worker, kernel_kind kind) {
    solid *s = c->state;
    const solid_block *b = &s->blocks[index];
    real *window = s->workers[worker].implicit_window;
    int nodes = kind == KERNEL_QUADRATIC ? 3 : 4;
    real scale = gradient_scale(s), gradient2 = scale * scale;
    memset(window, 0, SCATTERED * WINDOW_NODES * sizeof *window);
    for (int32_t t = b->first_tile; t < b->first_tile + b->tile_count; t++) {
        const solid_tile *tile = &s->tiles[t];
        if (!tile_is_implicit(s, tile)) continue;
        const implicit_material *m = &s->implicit_materials[tile->material];
        real rate = m->eta / c->dt, spread = m->length2 * gradient2;
        FOR_EACH_KERNEL(s, tile, kind, k,
                        real history = field_at(&s->fields[s->history_field], pack, 0, 0)[within];
                        real here = rate * (real)scale_of(s, s->viscosity_scale, pack, within);
                        real mobility = 1 / (here + 1 + history);
                        real own = mobility * (here * field_at(&s->fields[s->damage_field], pack, 0, 0)[within] + history);
                        scatter_system(&kernel, nodes, field_at(&s->fields[FIELD_VOLUME], pack, 0, 0)[within], mobility, own, spread, window))
    }
    for (int which = 0; which < SCATTERED; which++) exchange_plane(s, b, window + which * WINDOW_NODES, which, true);
}

SIMD_INLINE void apply_block(pass_context *c, int32_t index, int worker, kernel_kind kind) {
    solid *s = c->state;
    const solid_block *b = &s->blocks[index];
    real *x = s->workers[worker].implicit_window, *y = x + WINDOW_NODES;
    int nodes = kind == KERNEL_QUADRATIC ? 3 : 4;
    real scale = gradient_scale(s), gradient2 = scale * scale;
    exchange_plane(s, b, x, SEARCH, false);
    memset(y, 0, WINDOW_NODES * sizeof *y);
    for (int32_t t = b->first_tile; t < b->first_tile + b->tile_count; t++) {
        const solid_tile *tile = &s->tiles[t];
        if (!tile_is_implicit(s, tile)) continue;
        real spread = s->implicit_materials[tile->material].length2 * gradient2;
        FOR_EACH_KERNEL(s, tile, kind, k,
                        apply_particle(&kernel, nodes, spread * field_at(&s->fields[FIELD_VOLUME], pack, 0, 0)[within], x, y))
    }
    exchange_plane(s, b, y, IMAGE, true);
}

#define PASSES(name, kind)                                                                                             \
    static void system_##name(void *context, int64_t i, int worker) {                                                  \
        pass_context *c = context;                                                                                     \
        system_block(c, c->blocks[i], worker, kind);                                                                   \
    }                                                                                                                  \
    static void apply_##name(void *context, int64_t i, int worker) {                                                   \
        pass_context *c = context;                                                                                     \
        apply_block(c, c->blocks[i], worker, kind);                                                                    \
    }
PASSES(quadratic, KERNEL_QUADRATIC)
PASSES(cubic, KERNEL_CUBIC)

static void by_colour(solid *s, real dt, void (*pass)(void *, int64_t, int)) {
    pass_context c = {.state = s, .dt = dt};
    for (int colour = 0; colour < s->colour_count; colour++) {
        c.blocks = s->colour_blocks + s->colour_start[colour];
        parallel_for(s->threads, s->colour_start[colour + 1] - s->colour_start[colour], 1, pass, &c);
    }
}

/* ---- passes over nodes ------------------------------------------------------------------------------------------- */

static void clear_planes(void *context, int64_t slot, int worker) {
    (void)worker;
    memset(plane(context, slot, 0), 0, SCATTERED * BLOCK_NODES * sizeof(real));
}

/* A, c, and the start: solution = search = m, for B x. */
static void prepare_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    solid *s = context;
    real *diagonal = plane(s, slot, DIAGONAL), *source = plane(s, slot, SOURCE), *precondition = plane(s, slot, PRECONDITIONER);
    real *x = plane(s, slot, SOLUTION);
    const real *volume = plane(s, slot, VOLUME);
    double norm = 0;
    for (int n = 0; n < BLOCK_NODES; n++) {
        bool used = diagonal[n] > 0;
        real inverse = used ? volume[n] / diagonal[n] : 0;
        x[n] = used ? source[n] / volume[n] : 0;
        diagonal[n] = volume[n] * inverse;
        source[n] *= inverse;
        precondition[n] = used ? 1 / (diagonal[n] + precondition[n]) : 0;
        norm += (double)source[n] * (double)source[n];
    }
    memcpy(plane(s, slot, SEARCH), x, BLOCK_NODES * sizeof *x);
    s->implicit_sums[2 * slot] = norm;
    s->implicit_sums[2 * slot + 1] = 0;
}

/* IMAGE ← A search; B's share is added by the pass over particles. */
static void diagonal_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    solid *s = context;
    const real *diagonal = plane(s, slot, DIAGONAL), *p = plane(s, slot, SEARCH);
    real *image = plane(s, slot, IMAGE);
    for (int n = 0; n < BLOCK_NODES; n++) image[n] = diagonal[n] * p[n];
}

/* r ← c − (A + B) x, search ← M⁻¹ r; sums: r·M⁻¹r, r·r. */
static void residual_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    solid *s = context;
    const real *source = plane(s, slot, SOURCE), *image = plane(s, slot, IMAGE), *precondition = plane(s, slot, PRECONDITIONER);
    real *r = plane(s, slot, RESIDUAL_VECTOR), *p = plane(s, slot, SEARCH);
    double preconditioned = 0, square = 0;
    for (int n = 0; n < BLOCK_NODES; n++) {
        r[n] = precondition[n] > 0 ? source[n] - image[n] : 0;
        p[n] = precondition[n] * r[n];
        preconditioned += (double)r[n] * (double)p[n];
        square += (double)r[n] * (double)r[n];
    }
    s->implicit_sums[2 * slot] = preconditioned;
    s->implicit_sums[2 * slot + 1] = square;
}

/* search · image */
static void curvature_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    solid *s = context;
    const real *p = plane(s, slot, SEARCH), *image = plane(s, slot, IMAGE);
    double sum = 0;
    for (int n = 0; n < BLOCK_NODES; n++) sum += (double)p[n] * (double)image[n];
    s->implicit_sums[2 * slot] = sum;
    s->implicit_sums[2 * slot + 1] = 0;
}

typedef struct vector_context {
    solid *state;
    real factor;
} vector_context;

/* x += α p, r −= α q; sums: r·M⁻¹r, r·r. */
static void advance_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    vector_context *c = context;
    solid *s = c->state;
    const real *p = plane(s, slot, SEARCH), *image = plane(s, slot, IMAGE), *precondition = plane(s, slot, PRECONDITIONER);
    real *x = plane(s, slot, SOLUTION), *r = plane(s, slot, RESIDUAL_VECTOR);
    double preconditioned = 0, square = 0;
    for (int n = 0; n < BLOCK_NODES; n++) {
        x[n] += c->factor * p[n];
        r[n] = precondition[n] > 0 ? r[n] - c->factor * image[n] : 0;
        preconditioned += (double)r[n] * (double)(precondition[n] * r[n]);
        square += (double)r[n] * (double)r[n];
    }
    s->implicit_sums[2 * slot] = preconditioned;
    s->implicit_sums[2 * slot + 1] = square;
}

/* p ← M⁻¹ r + β p */
static void turn_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    vector_context *c = context;
    solid *s = c->state;
    const real *r = plane(s, slot, RESIDUAL_VECTOR), *precondition = plane(s, slot, PRECONDITIONER);
    real *p = plane(s, slot, SEARCH);
    for (int n = 0; n < BLOCK_NODES; n++) p[n] = precondition[n] * r[n] + c->factor * p[n];
}

/* search ← d, image ← 0: B d alone comes next. */
static void solved_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    memcpy(plane(context, slot, SEARCH), plane(context, slot, SOLUTION), BLOCK_NODES * sizeof(real));
    memset(plane(context, slot, IMAGE), 0, BLOCK_NODES * sizeof(real));
}

/* Diffusion at the nodes, where the way back to the particles looks for it. */
static void spread_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    solid *s = context;
    real *spread = plane(s, slot, SPREAD);
    const real *image = plane(s, slot, IMAGE), *volume = plane(s, slot, VOLUME);
    for (int n = 0; n < BLOCK_NODES; n++) spread[n] = volume[n] > 0 ? -image[n] / volume[n] : 0;
}

static void no_spread_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    memset(plane(context, slot, SPREAD), 0, BLOCK_NODES * sizeof(real));
}

static void over_slots(solid *s, void (*pass)(void *, int64_t, int), void *context) {
    parallel_for(s->threads, s->slot_count, 32, pass, context);
}

static void sum_slots(const solid *s, double *first, double *second) {
    *first = *second = 0;
    for (int32_t i = 0; i < s->slot_count; i++) {
        *first += s->implicit_sums[2 * i];
        *second += s->implicit_sums[2 * i + 1];
    }
}

/* ---- conjugate gradients ----------------------------------------------------------------------------------------- */

static void add_diffusion(solid *s) {
    by_colour(s, 0, s->definition.laplacian == KERNEL_CUBIC ? apply_cubic : apply_quadratic);
}

static void apply_operator(solid *s) {
    over_slots(s, diagonal_slot, s);
    add_diffusion(s);
}

status implicit_solve(solid *s, real dt, report *r) {
    if (!s->implicit_on) return STATUS_OK;
    over_slots(s, clear_planes, s);
    by_colour(s, dt, s->definition.laplacian == KERNEL_CUBIC ? system_cubic : system_quadratic);
    double right, square, rho, next, curvature, unused;
    over_slots(s, prepare_slot, s);
    sum_slots(s, &right, &unused);
    s->implicit_solves++;
    if (right == 0) { /* nothing drives and nothing is damaged: d = 0 is the solution */
        over_slots(s, no_spread_slot, s);
        return STATUS_OK;
    }
    apply_operator(s);
    over_slots(s, residual_slot, s);
    sum_slots(s, &rho, &square);
    double enough = s->implicit_tolerance * s->implicit_tolerance * right;
    for (int i = 0; square > enough; i++) {
        if (i == ITERATION_LIMIT || !isfinite(square))
            return report_set(r, STATUS_DIVERGED, "implicit damage (effect damage): %d iterations leave a residual of %.3g of the right-hand side", i,
                              sqrt(square / right));
        apply_operator(s);
        over_slots(s, curvature_slot, s);
        sum_slots(s, &curvature, &unused);
        vector_context c = {s, (real)(rho / curvature)};
        over_slots(s, advance_slot, &c);
        sum_slots(s, &next, &square);
        c.factor = (real)(next / rho);
        rho = next;
        over_slots(s, turn_slot, &c);
        s->implicit_iterations++;
    }
    over_slots(s, solved_slot, s);
    add_diffusion(s);
    over_slots(s, spread_slot, s);
    return STATUS_OK;
}

/* ---- back to particles ------------------------------------------------------------------------------------------- */

void implicit_load_window(const solid *s, const solid_block *b, real *window) {
    exchange_plane(s, b, window, SPREAD, false);
}

SIMD_INLINE real gather_spread(const particle_kernel *k, int nodes, const real *window) {
    real total = 0;
    for (int i = 0; i < nodes; i++)
        for (int j = 0; j < nodes; j++) {
            const real *from = window + k->node + (i * WINDOW + j) * WINDOW;
            real plain = 0;
            for (int n = 0; n < nodes; n++) plain += k->w[2][n] * from[n];
            total += k->w[0][i] * k->w[1][j] * plain;
        }
    return total;
}

void implicit_gather(const tile_work *w, const real *window) {
    const solid *s = w->state;
    if (s->definition.laplacian == KERNEL_QUADRATIC) {
        FOR_EACH_KERNEL(s, w->tile, KERNEL_QUADRATIC, k,
                        (void)pack; scratch_at(w->scratch->laplacian, 1, k, 0, 0)[within] = gather_spread(&kernel, 3, window))
    } else {
        FOR_EACH_KERNEL(s, w->tile, KERNEL_CUBIC, k,
                        (void)pack; scratch_at(w->scratch->laplacian, 1, k, 0, 0)[within] = gather_spread(&kernel, 4, window))
    }
}
