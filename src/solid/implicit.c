/* Damage, implicit (AnisoMPM §4.3; METHOD.md §2), multiplied through by η/Δt, so that nothing is divided by η and η = 0 is the
 * rate-independent limit. A particle's backward Euler step is
 *     r_p d_p = b_p + Σ_i w_ip s_i,   r_p = η/Δt + 1 + D̃_p,   b_p = (η/Δt) d_pⁿ + D̃_p,
 * where s_i is diffusion l0² Δd at the nodes: s = −V⁻¹ B d, V_i = Σ V_p w_ip, B_ij = Σ V_p l0² ∇Θ_i·∇Θ_j, ∇Θ_i = D⁻¹ w_ip (x_i − x_p), of
 * the nodes' means d_i = Σ V_p w_ip d_p / V_i. Putting the first into the last, with the mean of w s / r lumped to s_i R_i,
 *     (A + B) d = c,   A_i = V_i/R_i,   c_i = A_i m_i,   R_i = (Σ V_p w_ip r_p^(−1/2) / V_i)²,   m_i = Σ V_p w_ip b_p / r_p / V_i.
 * Symmetric, positive definite, diagonally strong: conjugate gradients with Jacobi's preconditioner, matrix-free, from m + R s of the s that
 * the last two steps lead to expect: near enough, mostly, that B is applied once, to see that it is. Sorting forgets them, and a frame begins
 * with a sort, so that a run resumed has the same bits. Sums over
 * nodes are made slot by slot and added in the order of slots, so the iterations have the same bits at any number of threads. Then each
 * particle takes its step (implicit_damage in state.h) with Σ w_ip R_i s_i / Σ w_ip R_i for its diffusion: of nodes that it shares with held
 * particles (r → ∞, R small there), s is what holds those back, a pull of size l0/dx that is not for it. Where r is even this is Σ w_ip s_i.
 *
 * R is a mean of 1/r that leans to the stiff side: a node of whose particles a share f is free, the others held at d = 1, yields f²/r. With f/r
 * (the harmonic mean of r) nodes that hardly touch free particles yield, and beside a band held at d = 1 the whole profile lies 1.5 cells too
 * far in. Where D̃ is even R is 1/r, whatever the mean: the paper's system, A_i = Σ V_p r_p w_ip. Where it is not, the paper's arithmetic mean
 * of r lets the driven particles speak for all: a node half of whose particles are broken is broken. With its increments handed back (FLIP) and
 * only growth kept, particles near a driven one then follow it, and driven ones pass their own equilibrium D̃/(1 + D̃): a band of D̃ = 20, two
 * cells wide, ended at d = 1 instead of 0.95, half as wide again, at any Δt. */
#include "base/memory.h"
#include "base/threads.h"
#include "solid/records.h"

#include <math.h>

/* Planes of nodes, [slot][PLANES][BLOCK_NODES]. The first four begin as one array of nodes, [BLOCK_NODES][NODE], in which particles' sums are made:
 * V √R, V m, V l0², V. IMAGE is B × SEARCH, SPREAD what it adds up to: B × the solution. In the end SPREAD holds s, BEFORE that of the step
 * before, and PAIR, [BLOCK_NODES][2], R s and R, which is all that particles need. */
enum { DIAGONAL, SOURCE, PRECONDITIONER, VOLUME, SPREAD, RESIDUAL_VECTOR, SEARCH, IMAGE, PLANES = IMPLICIT_PLANES, PAIR = SEARCH, BEFORE = SOURCE };

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
    real dt;
} pass_context;

static bool tile_is_implicit(const solid *s, const solid_tile *tile) {
    return s->material_implicit[tile->material];
}

/* What a particle adds to its nodes: w (V r^(−1/2), V b/r, V l0², V). */
SIMD_INLINE void system_records(const solid *s, const solid_tile *tile, real *records, kernel_kind kind, real dt) {
    const implicit_material *m = &s->implicit_materials[tile->material];
    for (int k = 0; k < tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            int32_t pack = tile->first_pack + k;
            vec volume = vec_load(field_at(&s->fields[FIELD_VOLUME], pack, 0, part)), H = vec_load(field_at(&s->fields[s->history_field], pack, 0, part));
            vec rate = scaled(s, s->viscosity_scale, pack, part, vec_all(m->eta / dt)), inverse = 1 / (rate + 1 + H);
            vec rest = inverse * vec_fma(rate, vec_load(field_at(&s->fields[s->damage_field], pack, 0, part)), H);
            vec values[NODE] = {volume * vec_sqrt(inverse), volume * rest, volume * m->length2, volume};
            plain_records(records, k * PACK + part * VEC_LANES, kind, vec3v_load(&s->fields[FIELD_POSITION], pack, part), values);
        }
}

/* V l0² D⁻² of a tile's particles. */
SIMD_INLINE void diffusion_factors(const solid *s, const solid_tile *tile, kernel_kind kind, real *factors) {
    real gradient = (real)((kind == KERNEL_QUADRATIC ? 4.0 : 3.0) / s->definition.dx); /* D⁻¹ in dx: ∇Θ = this × w × (distance in dx) */
    real factor = s->implicit_materials[tile->material].length2 * gradient * gradient;
    for (int k = 0; k < tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++)
            vec_store(factors + k * PACK + part * VEC_LANES, factor * vec_load(field_at(&s->fields[FIELD_VOLUME], tile->first_pack + k, 0, part)));
}

/* Σ t_n and Σ (n − 1) t_n over three or four nodes: from the second, as near to a particle as nodes are, so that little cancels. */
SIMD_INLINE void sum_and_lean(const vec4 t[4], int nodes, vec4 *sum, vec4 *lean) {
    *sum = t[0] + t[2] + t[1];
    *lean = t[2] - t[0];
    if (nodes == 4) *sum += t[3], *lean += t[3] + t[3];
}

/* factor × Σ w_j (x_j − x_p) of the nodes' values, distances in dx, for one particle whose record kernel_records made; the fourth is no use. */
SIMD_INLINE void gradient(const real *r, real factor, int nodes, const real *values, vec4 *out) {
    const vec4 distance = {-1, 0, 1, 2};
    vec4 plain[4], along_y = {0}, weight, place, sum, along_x, along_z;
    for (int i = 0; i < nodes; i++) {
        vec4 row[4], lean;
        for (int j = 0; j < nodes; j++) {
            vec4_load(&row[j], values + i * STRIDE_X + j * STRIDE_Y);
            row[j] *= r[G2P_WY + j];
        }
        sum_and_lean(row, nodes, &plain[i], &lean);
        plain[i] *= r[G2P_WX + i];
        vec4_add_scaled(&along_y, &lean, r[G2P_WX + i]);
    }
    sum_and_lean(plain, nodes, &sum, &along_x);
    vec4_load(&weight, r + G2P_WZ);
    sum *= weight, along_x *= weight, along_y *= weight;
    along_z = sum * distance;
    vec4_sums(&along_x, &along_y, &along_z, &sum, out);
    vec4_load(&place, r + G2P_OFFSET);
    place -= 1;
    *out = (*out - place * (*out)[3]) * factor;
}

/* image += w_i (x_i − x_p) · g at the particle's nodes. */
SIMD_INLINE void scatter_gradient(const real *r, const vec4 *g, int nodes, real *image) {
    const vec4 distance = {0, 1, 2, 3};
    vec4 weight, place, value, along_x, along_y;
    vec4_load(&weight, r + G2P_WZ);
    vec4_load(&place, r + G2P_OFFSET);
    place *= *g;
    value = (distance * (*g)[2] - (place[0] + place[1] + place[2])) * weight;
    along_x = weight * (*g)[0], along_y = weight * (*g)[1];
    for (int i = 0; i < nodes; i++) {
        vec4 here = value * r[G2P_WX + i], slope = along_y * r[G2P_WX + i];
        for (int j = 0; j < nodes; j++) {
            vec4 row;
            vec4_load(&row, image + i * STRIDE_X + j * STRIDE_Y);
            vec4_add_scaled(&row, &here, r[G2P_WY + j]);
            vec4_store(image + i * STRIDE_X + j * STRIDE_Y, &row);
            here += slope;
        }
        value += along_x;
    }
}

/* One plane of a block's window to or from the grid. */
SIMD_INLINE void exchange_plane(const solid *s, const solid_block *b, real *window, int which, bool to_grid) {
    bool wide = kernels_are_wide(s->definition.kernel, s->definition.laplacian, true);
    exchange_window(b, window, s->implicit_grid + which * BLOCK_NODES, 1, PLANES * BLOCK_NODES, wide, to_grid);
}

SIMD_INLINE void system_block(const pass_context *c, int32_t index, int worker, kernel_kind kind) {
    solid *s = c->state;
    const solid_block *b = &s->blocks[index];
    real *window = s->workers[worker].implicit_window, *records = s->workers[worker].tile.records;
    memset(window, 0, NODE * WINDOW_NODES * sizeof *window);
    for (int32_t t = b->first_tile; t < b->first_tile + b->tile_count; t++) {
        const solid_tile *tile = &s->tiles[t];
        if (!tile_is_implicit(s, tile)) continue;
        system_records(s, tile, records, kind, c->dt);
        scatter_plain(records, tile->count, kind, window);
    }
    bool wide = kernels_are_wide(s->definition.kernel, s->definition.laplacian, true);
    exchange_window(b, window, s->implicit_grid, NODE, PLANES * BLOCK_NODES, wide, true);
}

SIMD_INLINE void diffusion_block(const pass_context *c, int32_t index, int worker, kernel_kind kind) {
    solid *s = c->state;
    const solid_block *b = &s->blocks[index];
    real *x = s->workers[worker].implicit_window, *y = x + WINDOW_NODES, *records = s->workers[worker].tile.records, factors[TILE_PARTICLES];
    memset(x, 0, 2 * WINDOW_NODES * sizeof *x); /* rows are read four nodes long, and what no kernel reaches must be a number */
    exchange_plane(s, b, x, SEARCH, false);
    for (int32_t t = b->first_tile; t < b->first_tile + b->tile_count; t++) {
        const solid_tile *tile = &s->tiles[t];
        if (!tile_is_implicit(s, tile)) continue;
        kernel_records(s, tile, 0, tile->pack_count, records, kind);
        diffusion_factors(s, tile, kind, factors);
        for (int p = 0; p < tile->count; p++) {
            const real *r = records + p * RECORD;
            int node = (int)r[G2P_NODE], nodes = kind == KERNEL_QUADRATIC ? 3 : 4;
            vec4 g;
            gradient(r, factors[p], nodes, x + node, &g);
            scatter_gradient(r, &g, nodes, y + node);
        }
    }
    exchange_plane(s, b, y, IMAGE, true);
}

#define PASSES(name, kind)                                                                                             \
    static void system_##name(void *context, int32_t block, int32_t next, int worker) {                                \
        (void)next;                                                                                                    \
        system_block(context, block, worker, kind);                                                                    \
    }                                                                                                                  \
    static void diffusion_##name(void *context, int32_t block, int32_t next, int worker) {                             \
        (void)next;                                                                                                    \
        diffusion_block(context, block, worker, kind);                                                                 \
    }
PASSES(quadratic, KERNEL_QUADRATIC)
PASSES(cubic, KERNEL_CUBIC)

/* ---- passes over nodes ------------------------------------------------------------------------------------------- */

/* Clears the sums; s as it is to be expected, from the last two steps, to RESIDUAL_VECTOR, where nothing is yet. */
static void begin_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    const solid *s = context;
    const real *last = plane(s, slot, SPREAD), *before = plane(s, slot, BEFORE);
    real *expected = plane(s, slot, RESIDUAL_VECTOR);
    for (int n = 0; n < BLOCK_NODES; n++) expected[n] = s->implicit_known == 0 ? 0 : s->implicit_known == 1 ? last[n] : 2 * last[n] - before[n];
    memset(plane(s, slot, 0), 0, NODE * BLOCK_NODES * sizeof(real));
}

/* B's diagonal over Σ V l0² w/dx² where particles are even: D⁻² 3 ∫ w² x² (∫ w²)², distances in dx. A preconditioner asks for no more. */
static real even_diagonal(const solid *s) {
    return (real)((s->definition.laplacian == KERNEL_QUADRATIC ? 1.115 : 0.537) / (s->definition.dx * s->definition.dx));
}

/* The planes from the sums: A, M⁻¹, and search = x0 = m + R s of the expected s, for B x0. */
static void prepare_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    solid *s = context;
    real sums[BLOCK_NODES * NODE], even = even_diagonal(s);
    real *diagonal = plane(s, slot, DIAGONAL), *before = plane(s, slot, BEFORE), *precondition = plane(s, slot, PRECONDITIONER);
    real *volume = plane(s, slot, VOLUME), *search = plane(s, slot, SEARCH);
    const real *last = plane(s, slot, SPREAD), *expected = plane(s, slot, RESIDUAL_VECTOR);
    double norm = 0;
    memcpy(sums, diagonal, sizeof sums);
    for (int n = 0; n < BLOCK_NODES; n++) {
        const real *sum = sums + NODE * n;
        bool used = sum[0] > 0;
        real inverse = used ? (sum[3] / sum[0]) * (sum[3] / sum[0]) : 0, source = sum[1] * inverse;
        search[n] = used ? sum[1] / sum[3] + expected[n] / inverse : 0;
        volume[n] = sum[3];
        diagonal[n] = sum[3] * inverse;
        precondition[n] = used ? 1 / (diagonal[n] + even * sum[2]) : 0;
        before[n] = last[n];
        norm += (double)source * (double)source;
    }
    memset(plane(s, slot, IMAGE), 0, BLOCK_NODES * sizeof(real));
    s->implicit_sums[2 * slot] = norm;
    s->implicit_sums[2 * slot + 1] = 0;
}

/* From x0, of which A x0 = c + V s of the expected s: r = −V s − B x0. Search ← M⁻¹ r; sums: r·M⁻¹r, r·r. */
static void residual_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    solid *s = context;
    const real *precondition = plane(s, slot, PRECONDITIONER), *volume = plane(s, slot, VOLUME);
    real *r = plane(s, slot, RESIDUAL_VECTOR), *p = plane(s, slot, SEARCH), *spread = plane(s, slot, SPREAD), *image = plane(s, slot, IMAGE);
    double preconditioned = 0, square = 0;
    for (int n = 0; n < BLOCK_NODES; n++) {
        spread[n] = image[n];
        r[n] = precondition[n] > 0 ? -volume[n] * r[n] - image[n] : 0;
        p[n] = precondition[n] * r[n];
        image[n] = 0;
        preconditioned += (double)r[n] * (double)p[n];
        square += (double)r[n] * (double)r[n];
    }
    s->implicit_sums[2 * slot] = preconditioned;
    s->implicit_sums[2 * slot + 1] = square;
}

/* search · (A + B) search */
static void curvature_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    solid *s = context;
    const real *p = plane(s, slot, SEARCH), *image = plane(s, slot, IMAGE), *diagonal = plane(s, slot, DIAGONAL);
    double sum = 0;
    for (int n = 0; n < BLOCK_NODES; n++) sum += (double)p[n] * (double)(image[n] + diagonal[n] * p[n]);
    s->implicit_sums[2 * slot] = sum;
    s->implicit_sums[2 * slot + 1] = 0;
}

typedef struct vector_context {
    solid *state;
    real factor;
} vector_context;

/* r −= α (A + B) p, spread += α B p; sums: r·M⁻¹r, r·r. */
static void advance_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    vector_context *c = context;
    solid *s = c->state;
    const real *p = plane(s, slot, SEARCH), *image = plane(s, slot, IMAGE), *precondition = plane(s, slot, PRECONDITIONER);
    const real *diagonal = plane(s, slot, DIAGONAL);
    real *r = plane(s, slot, RESIDUAL_VECTOR), *spread = plane(s, slot, SPREAD);
    double preconditioned = 0, square = 0;
    for (int n = 0; n < BLOCK_NODES; n++) {
        spread[n] += c->factor * image[n];
        r[n] = precondition[n] > 0 ? r[n] - c->factor * (image[n] + diagonal[n] * p[n]) : 0;
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
    memset(plane(s, slot, IMAGE), 0, BLOCK_NODES * sizeof(real));
}

/* s = −V⁻¹ B d for the next step; R s and R side by side, which is all that particles need. */
static void spread_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    solid *s = context;
    real *spread = plane(s, slot, SPREAD), *pair = plane(s, slot, PAIR);
    const real *diagonal = plane(s, slot, DIAGONAL), *volume = plane(s, slot, VOLUME);
    for (int n = 0; n < BLOCK_NODES; n++) {
        bool used = diagonal[n] > 0;
        real compliance = used ? volume[n] / diagonal[n] : 0;
        spread[n] = used ? -spread[n] / volume[n] : 0;
        pair[2 * n] = compliance * spread[n];
        pair[2 * n + 1] = compliance;
    }
}

static void no_spread_slot(void *context, int64_t slot, int worker) {
    memset(plane(context, slot, SPREAD), 0, BLOCK_NODES * sizeof(real));
    spread_slot(context, slot, worker);
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

/* IMAGE += B × SEARCH */
static void apply_diffusion(solid *s) {
    pass_context c = {.state = s};
    colours_pass(s, s->definition.laplacian == KERNEL_CUBIC ? diffusion_cubic : diffusion_quadratic, &c);
}

status implicit_solve(solid *s, real dt, report *r) {
    if (!s->implicit_on) return STATUS_OK;
    pass_context system = {.state = s, .dt = dt};
    over_slots(s, begin_slot, s);
    colours_pass(s, s->definition.laplacian == KERNEL_CUBIC ? system_cubic : system_quadratic, &system);
    double right, square, rho, next, curvature, unused;
    over_slots(s, prepare_slot, s);
    sum_slots(s, &right, &unused);
    s->implicit_known += s->implicit_known < 2;
    if (right == 0) { /* nothing drives and nothing is damaged: d = 0 is the solution */
        over_slots(s, no_spread_slot, s);
        return STATUS_OK;
    }
    apply_diffusion(s);
    over_slots(s, residual_slot, s);
    sum_slots(s, &rho, &square);
    double enough = s->implicit_tolerance * s->implicit_tolerance * right;
    for (int i = 0; square > enough; i++) {
        if (i == ITERATION_LIMIT || !isfinite(square))
            return report_set(r, STATUS_DIVERGED, "implicit damage (effect damage): %d iterations leave a residual of %.3g of the right-hand side", i,
                              sqrt(square / right));
        apply_diffusion(s);
        over_slots(s, curvature_slot, s);
        sum_slots(s, &curvature, &unused);
        vector_context c = {s, (real)(rho / curvature)};
        over_slots(s, advance_slot, &c);
        sum_slots(s, &next, &square);
        c.factor = (real)(next / rho);
        rho = next;
        over_slots(s, turn_slot, &c);
    }
    over_slots(s, spread_slot, s);
    return STATUS_OK;
}

/* ---- back to particles ------------------------------------------------------------------------------------------- */

void implicit_load_window(const solid *s, const solid_block *b, real *window) {
    bool wide = kernels_are_wide(s->definition.kernel, s->definition.laplacian, true);
    memset(window, 0, 2 * WINDOW_NODES * sizeof *window); /* see diffusion_block */
    exchange_window(b, window, s->implicit_grid + PAIR * BLOCK_NODES, 2, PLANES * BLOCK_NODES, wide, false);
}

/* Σ w_ip a_i / Σ w_ip b_i of one particle whose record kernel_records made, of pairs (a, b). */
SIMD_INLINE real ratio_at(const real *r, int nodes, const real *pairs) {
    real above = 0, below = 0;
    SIMD_UNROLL
    for (int lane = 0; lane < PAIRS; lane += PAIRS_LANES) {
        vec_pairs total = {0};
        for (int i = 0; i < nodes; i++) {
            vec_pairs sum = {0};
            for (int j = 0; j < nodes; j++) sum = pairs_add_scaled(sum, pairs_load(pairs + 2 * (i * STRIDE_X + j * STRIDE_Y) + lane), r[G2P_WY + j]);
            total = pairs_add_scaled(total, sum, r[G2P_WX + i]);
        }
        total *= pairs_double(r + G2P_WZ + lane / 2);
        SIMD_UNROLL
        for (int n = 0; n < PAIRS_LANES; n += 2) above += total[n], below += total[n + 1];
    }
    return above / below;
}

SIMD_INLINE void gather_spread(const tile_work *w, kernel_kind kind, bool weighed, const real *window) {
    int nodes = kind == KERNEL_QUADRATIC ? 3 : 4;
    if (!weighed) kernel_records(w->state, w->tile, 0, w->tile->pack_count, w->scratch->records, kind);
    for (int p = 0; p < w->tile->count; p++) {
        const real *r = w->scratch->records + p * RECORD;
        w->scratch->laplacian[p] = ratio_at(r, nodes, window + 2 * (int)r[G2P_NODE]);
    }
    for (int p = w->tile->count; p < w->tile->pack_count * PACK; p++) w->scratch->laplacian[p] = 0;
}

void implicit_gather(const tile_work *w, bool weighed, const real *window) {
    if (w->state->definition.laplacian == KERNEL_QUADRATIC) gather_spread(w, KERNEL_QUADRATIC, weighed, window);
    else gather_spread(w, KERNEL_CUBIC, weighed, window);
}
