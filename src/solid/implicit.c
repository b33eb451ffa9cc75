/* Damage, implicit, on the grid (AnisoMPM §4.3; METHOD.md §2). Multiplied through by η/Δt, so that nothing is divided by η and
 * η = 0 is the rate-independent limit:
 *     (A + B) d = c,   A_i = Σ V (η/Δt + D̃ + 1) w_ip,   B_ij = Σ V l0² ∇Θ_i·∇Θ_j,   c_i = Σ V (D̃ + (η/Δt) d_iⁿ) w_ip,
 * ∇Θ_i = D⁻¹ w_ip (x_i − x_p). Symmetric, positive definite, diagonally strong: conjugate gradients with Jacobi's
 * preconditioner, matrix-free, from dⁿ. Sums over nodes are made slot by slot and added in the order of slots, so the iterations have
 * the same bits at any number of threads. Particles take back the nodes' increments. */
#include "base/memory.h"
#include "base/threads.h"
#include "solid/kernels.h"

#include <math.h>

/* Planes of nodes, [slot][PLANES][BLOCK_NODES]. The first four are scattered together. */
enum { DIAGONAL, SOURCE, RATE, PRECONDITIONER, OLD, SOLUTION, RESIDUAL_VECTOR, SEARCH, IMAGE, PLANES, SCATTERED = 4 };

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

SIMD_INLINE void scatter_system(const particle_kernel *k, int nodes, real volume, real history, real rate, real spread, real *window) {
    for (int i = 0; i < nodes; i++)
        for (int j = 0; j < nodes; j++) {
            real wij = k->w[0][i] * k->w[1][j], reach = k->x[0][i] * k->x[0][i] + k->x[1][j] * k->x[1][j];
            real *to = window + k->node + (i * WINDOW + j) * WINDOW;
            for (int n = 0; n < nodes; n++) {
                real w = wij * k->w[2][n], distance2 = reach + k->x[2][n] * k->x[2][n];
                to[DIAGONAL * WINDOW_NODES + n] += volume * (rate + history + 1) * w;
                to[SOURCE * WINDOW_NODES + n] += volume * history * w;
                to[RATE * WINDOW_NODES + n] += volume * rate * w;
                to[PRECONDITIONER * WINDOW_NODES + n] += volume * spread * w * w * distance2;
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
                        scatter_system(&kernel, nodes, field_at(&s->fields[FIELD_VOLUME], pack, 0, 0)[within],
                                       field_at(&s->fields[s->history_field], pack, 0, 0)[within], rate, spread, window))
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

/* d_iⁿ, the right-hand side, and the start: solution, residual's first half (c − A x without B x) and search = solution for B x. */
static void prepare_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    solid *s = context;
    const real *sums = s->damage_grid + slot * BLOCK_NODES * DAMAGE_NODE;
    real *diagonal = plane(s, slot, DIAGONAL), *source = plane(s, slot, SOURCE), *rate = plane(s, slot, RATE);
    real *precondition = plane(s, slot, PRECONDITIONER), *old = plane(s, slot, OLD), *x = plane(s, slot, SOLUTION);
    double norm = 0;
    for (int n = 0; n < BLOCK_NODES; n++) {
        old[n] = sums[BLOCK_NODES + n] > 0 ? sums[n] / sums[BLOCK_NODES + n] : 0;
        source[n] += rate[n] * old[n];
        precondition[n] = diagonal[n] > 0 ? 1 / (diagonal[n] + precondition[n]) : 0;
        x[n] = diagonal[n] > 0 ? old[n] : 0;
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

/* The nodes' increments, where the way back to the particles looks for them. */
static void increment_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    solid *s = context;
    real *old = plane(s, slot, OLD);
    const real *x = plane(s, slot, SOLUTION), *diagonal = plane(s, slot, DIAGONAL);
    for (int n = 0; n < BLOCK_NODES; n++) old[n] = diagonal[n] > 0 ? x[n] - old[n] : 0;
}

static void no_increment_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    memset(plane(context, slot, OLD), 0, BLOCK_NODES * sizeof(real));
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

static void apply_operator(solid *s) {
    over_slots(s, diagonal_slot, s);
    by_colour(s, 0, s->definition.laplacian == KERNEL_CUBIC ? apply_cubic : apply_quadratic);
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
        over_slots(s, no_increment_slot, s);
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
    over_slots(s, increment_slot, s);
    return STATUS_OK;
}

/* ---- back to particles ------------------------------------------------------------------------------------------- */

void implicit_load_window(const solid *s, const solid_block *b, real *window) {
    exchange_plane(s, b, window, OLD, false);
}

SIMD_INLINE real gather_increment(const particle_kernel *k, int nodes, const real *window) {
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
                        (void)pack; scratch_at(w->scratch->laplacian, 1, k, 0, 0)[within] = gather_increment(&kernel, 3, window))
    } else {
        FOR_EACH_KERNEL(s, w->tile, KERNEL_CUBIC, k,
                        (void)pack; scratch_at(w->scratch->laplacian, 1, k, 0, 0)[within] = gather_increment(&kernel, 4, window))
    }
}
