/* Inextensible fibres, block by block: what passes between particles and the grid's cells and nodes in a solve (inextensible.c). */
#include "solid/inextensible_planes.h"
#include "solid/records.h"

/* A fibre's stretch is taken back within a fraction of the time that the matrix needs to carry a wave over a cell (`recovery`), so that what tolerance and time
 * steps let through does not add up; at most this share in one step, and beyond the most that is corrected at once it is pulled back gently. (A
 * share of each step alone runs away: tension shortens the step, which raises the tension that a share asks for.) It is the cells'
 * mean that is taken back: what single particles stretch beside it is in nobody's power, and asking for it drives tension
 * without bound. */
#define CORRECTION ((real)0.25)
#define CORRECTED_MOST ((real)0.05)

typedef struct pass_context {
    solid *state;
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

/* Nodes ← Bᵀ SEARCH, and as their fourth component Σ_p w_ip V_p |λ_p| with the tension λ of SEARCH. */
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
        vec strength = l.volume * vec_abs(q);
        q *= l.volume * scale;
        const vec a[3] = {l.a.x, l.a.y, l.a.z};
        kernel_place at = kernel_row(kernel, l.at);
        const vec u[3] = {at.u.x, at.u.y, at.u.z};
        vec along = vec_fma(a[0], u[0], vec_fma(a[1], u[1], a[2] * u[2]));
        vec columns[RECORD] = {vec_all(0)};
        kernel_weights(kernel, u[0], columns + P2G_WX);
        kernel_weights(kernel, u[1], columns + P2G_WY);
        kernel_row_weights(kernel, u[2], columns + P2G_WZ);
        for (int axis = 0; axis < 3; axis++) {
            columns[P2G_BASE + axis] = -(q * a[axis] * along);
            for (int column = 0; column < 3; column++) columns[P2G_X + 4 * column + axis] = q * a[axis] * a[column];
        }
        columns[P2G_BASE + 3] = strength;
        columns[P2G_NODE] = window_index(at.base);
        records_store(records, first, 0, columns, RECORD);
        if (k + 1 == t->pack_count && part + 1 == PACK_PARTS)
            scatter_particles(records, 0, t->count, t->count, nodes, node_offset, own->window);
    })
    exchange_vectors(s, b, own->window, true);
}

/* A particle's fibre in a field of velocities: the rate of its stretching a · L a, and |L a|² beside it. */
typedef struct fibre_rate {
    vec along, across_square;
} fibre_rate;

/* Of the lanes of one part, from gathered records; `scale` is gradient_scale's. */
SIMD_INLINE fibre_rate rate_of(kernel_kind kernel, const fibre_lanes *l, const real *records, int first, real scale) {
    vec out[RECORD - G2P_OUT];
    records_load(records, first, G2P_OUT, out, RECORD - G2P_OUT);
    vec3v turn = vec3v_scale(vec_all(scale), mat3v_times(gathered_moments(kernel, out, l->at), l->a));
    vec along = vec3v_dot(turn, l->a), square = vec3v_dot(turn, turn);
    return (fibre_rate){along, vec_max(square - along * along, vec_all(0))};
}

SIMD_INLINE void gather_records(real *records, int first, int lanes, const fibre_lanes *l, kernel_kind kernel, const real *window) {
    vec columns[G2P_OUT];
    gather_columns(kernel, l->at, columns);
    records_store(records, first, 0, columns, G2P_OUT);
    gather_particles(records, first, first + lanes, kernel == KERNEL_QUADRATIC ? 3 : 4, window);
    for (int lane = lanes; lane < VEC_LANES; lane++) memset(records + (first + lane) * RECORD + G2P_OUT, 0, 16 * sizeof(real));
}

/* A plane of cells += B nodes; the right-hand side also asks for what fibres have stretched so far, and for what turning will: after a step |a + Δt L a| is
 * one where a · L a = −Δt |L a − a (a · L a)|²/2, to third order, and tension changes the part along a only. */
SIMD_INLINE void collect_block(pass_context *c, int32_t index, int worker, kernel_kind kernel, int into) {
    solid *s = c->state;
    const solid_block *b = &s->blocks[index];
    if (!block_is_inextensible(s, b)) return;
    solid_worker *own = &s->workers[worker];
    real *cells = own->implicit_window, scale = gradient_scale(s, kernel);
    exchange_vectors(s, b, own->window, false);
    memset(cells, 0, WINDOW_NODES * sizeof *cells);
    if (into == RESIDUAL) exchange_plane(s, b, cells + WINDOW_NODES, STRAIN, false);
    FOR_EACH_PART(s, b, {
        fibre_lanes l = lanes_load(s, kernel, pack, part);
        gather_records(own->tile.records, first, LANES_OF(t, first), &l, kernel, own->window);
        fibre_rate rate = rate_of(kernel, &l, own->tile.records, first, scale);
        vec value = l.volume * rate.along;
        if (into == RESIDUAL) {
            value += l.volume * vec_min((real)0.5 * c->dt * rate.across_square, vec_all(CORRECTED_MOST / c->dt));
            for (int lane = 0; lane < LANES_OF(t, first); lane++)
                value[lane] += l.volume[lane] * cells_gather(&l, lane, cells + WINDOW_NODES);
        }
        for (int lane = 0; lane < LANES_OF(t, first); lane++) cells_scatter(&l, lane, value[lane], cells);
    })
    exchange_plane(s, b, cells, into, true);
}

/* The first of the window's nodes around one lane; along each axis their weights, and how far they lie along the fibre. */
SIMD_INLINE const real *nodes_around(const fibre_lanes *l, int lane, kernel_kind kernel, const real *window, real w[3][4], real x[3][4]) {
    const vec u[3] = {l->at.u.x, l->at.u.y, l->at.u.z}, a[3] = {l->a.x, l->a.y, l->a.z};
    for (int axis = 0; axis < 3; axis++) {
        vec weight[4];
        kernel_weights(kernel, u[axis], weight);
        for (int n = 0; n < (kernel == KERNEL_QUADRATIC ? 3 : 4); n++) {
            w[axis][n] = weight[n][lane];
            x[axis][n] = a[axis][lane] * ((real)n - u[axis][lane]);
        }
    }
    return window + (int)window_index(l->at.base)[lane] * NODE;
}

/* What a tension of one at a lane's particle does: Σ_i (Δt/m_i) |P_i a|² (a · G_ip)², and Σ_i (a · G_ip)² with and without what holds leave of
 * it. */
typedef struct lane_response {
    real rate, all, free;
} lane_response;

/* The window's nodes are the normals of holds and Δt/m_i (hold_normals_slot). */
SIMD_INLINE lane_response response(const fibre_lanes *l, int lane, kernel_kind kernel, real scale, const real *window) {
    const real a[3] = {l->a.x[lane], l->a.y[lane], l->a.z[lane]};
    int nodes = kernel == KERNEL_QUADRATIC ? 3 : 4;
    real w[3][4], x[3][4];
    lane_response sum = {0};
    const real *from = nodes_around(l, lane, kernel, window, w, x);
    for (int i = 0; i < nodes; i++)
        for (int j = 0; j < nodes; j++)
            for (int n = 0; n < nodes; n++) {
                const real *node = from + (i * STRIDE_X + j * STRIDE_Y + n) * NODE;
                real gradient = scale * w[0][i] * w[1][j] * w[2][n] * (x[0][i] + x[1][j] + x[2][n]), square = gradient * gradient;
                real normal = node[0] * a[0] + node[1] * a[1] + node[2] * a[2], left = square * (1 - normal * normal);
                sum.all += square;
                sum.free += node[3] > 0 ? left : 0;
                sum.rate += left * node[3];
            }
    return sum;
}

SIMD_INLINE void respond_block(pass_context *c, int32_t index, int worker, kernel_kind kernel) {
    solid *s = c->state;
    const solid_block *b = &s->blocks[index];
    if (!block_is_inextensible(s, b)) return;
    solid_worker *own = &s->workers[worker];
    real *cells = own->implicit_window, scale = gradient_scale(s, kernel);
    exchange_vectors(s, b, own->window, false);
    memset(cells, 0, 3 * WINDOW_NODES * sizeof *cells);
    FOR_EACH_PART(s, b, {
        fibre_lanes l = lanes_load(s, kernel, pack, part);
        for (int lane = 0; lane < LANES_OF(t, first); lane++) {
            lane_response one = response(&l, lane, kernel, scale, own->window);
            cells_scatter(&l, lane, l.volume[lane] * one.rate, cells);
            cells_scatter(&l, lane, l.volume[lane] * one.all, cells + WINDOW_NODES);
            cells_scatter(&l, lane, l.volume[lane] * one.free, cells + 2 * WINDOW_NODES);
        }
    })
    exchange_plane(s, b, cells, PRECONDITIONER, true);
    exchange_plane(s, b, cells + WINDOW_NODES, PULL, true);
    exchange_plane(s, b, cells + 2 * WINDOW_NODES, FREE_PULL, true);
}

/* D⁻¹ Σ_i w_ip (a · (x_i − x_p))² T_i of one lane; T is the fourth component of the node vectors (wave_slot). */
SIMD_INLINE real wave_square(const fibre_lanes *l, int lane, kernel_kind kernel, const real *window) {
    int nodes = kernel == KERNEL_QUADRATIC ? 3 : 4;
    real w[3][4], x[3][4], sum = 0;
    const real *from = nodes_around(l, lane, kernel, window, w, x);
    for (int i = 0; i < nodes; i++)
        for (int j = 0; j < nodes; j++)
            for (int n = 0; n < nodes; n++) {
                real along = x[0][i] + x[1][j] + x[2][n];
                sum += w[0][i] * w[1][j] * w[2][n] * along * along * from[(i * STRIDE_X + j * STRIDE_Y + n) * NODE + 3];
            }
    return sum * (real)(kernel == KERNEL_QUADRATIC ? 4 : 3);
}

/* The cells' tensions back to the particles: the next solve starts from them. And ρ0 c² of the transverse waves that they carry, for the step's
 * limit: with K = Σ_p V_p |λ_p| g_p g_pᵀ, g_ip = a · G_ip, no frequency of M ü = −K u is above
 * max_p Σ_i g_ip² (Σ_q w_iq V_q |λ_q|)/(w_ip m_i), which is element by element with each node's mass shared out by w V |λ|. */
SIMD_INLINE void keep_block(pass_context *c, int32_t index, int worker, kernel_kind kernel) {
    solid *s = c->state;
    const solid_block *b = &s->blocks[index];
    if (!block_is_inextensible(s, b)) return;
    solid_worker *own = &s->workers[worker];
    real *cells = own->implicit_window;
    exchange_plane(s, b, cells, TENSION, false);
    exchange_vectors(s, b, own->window, false);
    FOR_EACH_PART(s, b, {
        fibre_lanes l = lanes_load(s, kernel, pack, part);
        real *tension = field_at(&s->fields[s->tension_field], pack, 0, part);
        vec wave = vec_all(0);
        for (int lane = 0; lane < LANES_OF(t, first); lane++) {
            tension[lane] = cells_gather(&l, lane, cells);
            wave[lane] = wave_square(&l, lane, kernel, own->window);
        }
        wave *= (real)s->definition.materials[t->material].density;
        vec_store(field_at(&s->fields[s->fibre_wave_field], pack, 0, part), scaled(s, s->density_scale, pack, part, wave));
    })
}

#define PASSES(name, kernel)                                                                                           \
    static void start_##name(void *context, int32_t block, int32_t next, int worker) {                                 \
        (void)next;                                                                                                    \
        start_block(context, block, worker, kernel);                                                                   \
    }                                                                                                                  \
    static void spread_##name(void *context, int32_t block, int32_t next, int worker) {                                \
        (void)next;                                                                                                    \
        spread_block(context, block, worker, kernel);                                                                  \
    }                                                                                                                  \
    static void image_##name(void *context, int32_t block, int32_t next, int worker) {                                 \
        (void)next;                                                                                                    \
        collect_block(context, block, worker, kernel, IMAGE);                                                          \
    }                                                                                                                  \
    static void right_##name(void *context, int32_t block, int32_t next, int worker) {                                 \
        (void)next;                                                                                                    \
        collect_block(context, block, worker, kernel, RESIDUAL);                                                       \
    }                                                                                                                  \
    static void respond_##name(void *context, int32_t block, int32_t next, int worker) {                               \
        (void)next;                                                                                                    \
        respond_block(context, block, worker, kernel);                                                                 \
    }                                                                                                                  \
    static void keep_##name(void *context, int32_t block, int32_t next, int worker) {                                  \
        (void)next;                                                                                                    \
        keep_block(context, block, worker, kernel);                                                                    \
    }                                                                                                                  \
    static coloured_pass *const passes_##name[] = {[SWEEP_START] = start_##name,     [SWEEP_SPREAD] = spread_##name,   \
        [SWEEP_IMAGE] = image_##name, [SWEEP_RIGHT] = right_##name, [SWEEP_RESPOND] = respond_##name, [SWEEP_KEEP] = keep_##name};
PASSES(quadratic, KERNEL_QUADRATIC)
PASSES(cubic, KERNEL_CUBIC)

void constraint_sweep(solid *s, real dt, constraint_sweep_kind kind) {
    pass_context c = {.state = s, .dt = dt};
    colours_pass(s, s->definition.kernel == KERNEL_CUBIC ? passes_cubic[kind] : passes_quadratic[kind], &c);
}
