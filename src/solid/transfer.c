/* The transfers: particles to grid and back (AnisoMPM §4; METHOD.md §3), one block at a time.
 *
 * One gradient operator is used everywhere, the moving-least-squares one G_ip = D⁻¹ w_ip (x_i − x_p): force and affine velocity
 * then share one matrix. With Q = m C − Δt V0 D⁻¹ τ a particle gives node i
 *     w_ip (m v + Q (x_i − x_p), m),
 * and takes back v = Σ w v_i, L = D⁻¹ Σ w v_i (x_i − x_p)ᵀ. Distances are in units of dx; the four momenta-and-mass of four nodes along z
 * are one row. The damage channel, Σ w d and Σ w, rides along with its own kernel. */
#include "base/clock.h"
#include "base/threads.h"
#include "solid/order.h"
#include "solid/records.h"

#include <stddef.h>

/* ---- particles to grid ------------------------------------------------------------------------------------------- */

typedef struct transfer_context {
    solid *state;
    real dt;
} transfer_context;

/* The packs of a block, and of the one that comes next, so that they are on their way to the cache when their turn comes. */
typedef struct pack_stream {
    const solid *state;
    int32_t first, count, next_first, next_count;
} pack_stream;

static int32_t block_packs(const solid *s, int32_t block, int32_t *first) {
    if (block < 0) return *first = 0;
    const solid_block *b = &s->blocks[block];
    const solid_tile *last = &s->tiles[b->first_tile + b->tile_count - 1];
    *first = s->tiles[b->first_tile].first_pack;
    return last->first_pack + last->pack_count - *first;
}

static pack_stream stream_packs(const solid *s, int32_t block, int32_t next) {
    pack_stream stream = {.state = s};
    stream.count = block_packs(s, block, &stream.first);
    stream.next_count = block_packs(s, next, &stream.next_first);
    return stream;
}

enum { CACHE_LINE = 64 };

/* Calls for the pack that comes a tile's length after this one. */
SIMD_INLINE void read_ahead(const pack_stream *stream, int32_t pack) {
    int32_t ahead = pack - stream->first + TILE_PACKS;
    if (ahead >= stream->count + stream->next_count) return;
    pack = ahead < stream->count ? stream->first + ahead : stream->next_first + ahead - stream->count;
    for (int i = 0; i < stream->state->field_count; i++) {
        const solid_field *f = &stream->state->fields[i];
        const char *at = (const char *)field_at(f, pack, 0, 0), *end = at + f->components * PACK * (int)sizeof(real);
        for (; at < end; at += CACHE_LINE) __builtin_prefetch(at, 0, 2);
    }
}

/* Packs of a tile whose records are made and used before the next ones': few, so that they stay in the first cache beside the window; all, where runs of particles are
 * scattered together, which the end of a chunk would cut. */
enum { CHUNK_PACKS = ROWS_FIT_REGISTERS ? TILE_PACKS : 1 };

typedef struct pack_chunk {
    int first, end;   /* packs of the tile */
    int from, until;  /* its particles */
} pack_chunk;

SIMD_INLINE pack_chunk chunk_at(const solid_tile *tile, int first, int packs) {
    int end = first + packs < tile->pack_count ? first + packs : tile->pack_count, until = end * PACK;
    return (pack_chunk){first, end, first * PACK, until < tile->count ? until : tile->count};
}

/* Momentum records: base value at the kernel's first node and its slope along each axis; `forces` 0 leaves the stress out. With `damage` also
 * what scatter_damage takes. */
SIMD_INLINE void momentum_records(const tile_work *w, pack_chunk chunk, kernel_kind kernel, real density, real forces, bool damage) {
    const solid *s = w->state;
    const solid_definition *d = &s->definition;
    real dx = (real)d->dx, inverse_d = (real)((kernel == KERNEL_QUADRATIC ? 4.0 : 3.0) / (d->dx * d->dx));
    real force_scale = -forces * w->dt * inverse_d * dx;
    for (int k = chunk.first; k < chunk.end; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            int32_t pack = w->tile->first_pack + k;
            int first = (k - chunk.first) * PACK + part * VEC_LANES;
            vec volume = vec_load(field_at(&s->fields[FIELD_VOLUME], pack, 0, part));
            vec mass = scaled(s, s->density_scale, pack, part, volume * density), force = volume * force_scale, carry = mass * dx;
            mat3v C = mat3v_load(&s->fields[FIELD_AFFINE], pack, part);
            real *tau = w->scratch->kirchhoff;
            vec t[6];
            for (int c = 0; c < 6; c++) t[c] = force * vec_load(scratch_at(tau, 6, k, c, part));
            mat3v Q = {vec_fma(carry, C.xx, t[0]), vec_fma(carry, C.xy, t[3]), vec_fma(carry, C.xz, t[5]),
                       vec_fma(carry, C.yx, t[3]), vec_fma(carry, C.yy, t[1]), vec_fma(carry, C.yz, t[4]),
                       vec_fma(carry, C.zx, t[5]), vec_fma(carry, C.zy, t[4]), vec_fma(carry, C.zz, t[2])};
            vec3v v = vec3v_load(&s->fields[FIELD_VELOCITY], pack, part);
            kernel_place at = kernel_row(kernel, kernel_locate(kernel, vec3v_load(&s->fields[FIELD_POSITION], pack, part)));
            vec3v slope = mat3v_times(Q, at.u);
            const vec zero = vec_all(0);
            vec columns[RECORD]; /* without an initialiser: the compiler would clear what it leaves out by an instruction of forty cycles */
            columns[P2G_BASE] = vec_fma(mass, v.x, -slope.x), columns[P2G_BASE + 1] = vec_fma(mass, v.y, -slope.y);
            columns[P2G_BASE + 2] = vec_fma(mass, v.z, -slope.z), columns[P2G_BASE + 3] = mass;
            columns[P2G_X] = Q.xx, columns[P2G_X + 1] = Q.yx, columns[P2G_X + 2] = Q.zx, columns[P2G_X + 3] = zero;
            columns[P2G_Y] = Q.xy, columns[P2G_Y + 1] = Q.yy, columns[P2G_Y + 2] = Q.zy, columns[P2G_Y + 3] = zero;
            columns[P2G_Z] = Q.xz, columns[P2G_Z + 1] = Q.yz, columns[P2G_Z + 2] = Q.zz, columns[P2G_Z + 3] = zero;
            kernel_weights(kernel, at.u.x, columns + P2G_WX);
            kernel_weights(kernel, at.u.y, columns + P2G_WY);
            kernel_row_weights(kernel, at.u.z, columns + P2G_WZ);
            columns[P2G_NODE] = window_index(at.base);
            columns[P2G_DAMAGE] = damage ? vec_load(field_at(&s->fields[s->damage_field], pack, 0, part)) : zero;
            columns[P2G_DAMAGE + 1] = vec_all(1), columns[P2G_DAMAGE + 2] = zero;
            records_store(w->scratch->records, first, 0, columns, RECORD);
        }
}

SIMD_INLINE void scatter_momentum(const tile_work *w, const pack_stream *stream, pack_chunk chunk, int nodes, real *window) {
    const real offsets[4] = {0, 1, 2, 3};
    node_row node_offset = row_spread(offsets);
    int count = chunk.until - chunk.from;
    for (int k = chunk.first, p = 0; k < chunk.end; k++) {
        read_ahead(stream, w->tile->first_pack + k);
        p = scatter_particles(w->scratch->records, p, (k + 1 - chunk.first) * PACK, count, nodes, node_offset, window);
    }
}

/* The damage channel's own records: weights where the momentum's are, and what brings particles into an order by z. */
enum { P2G_PLANE = P2G_DAMAGE + 2 };

SIMD_INLINE void damage_records(const tile_work *w, kernel_kind kernel) {
    const solid *s = w->state;
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            int32_t pack = w->tile->first_pack + k;
            kernel_place at = kernel_locate(kernel, vec3v_load(&s->fields[FIELD_POSITION], pack, part));
            vec columns[RECORD];
            kernel_weights(kernel, at.u.z, columns + P2G_WZ);
            kernel_weights(kernel, at.u.x, columns + P2G_WX);
            kernel_weights(kernel, at.u.y, columns + P2G_WY);
            columns[P2G_NODE] = window_index(at.base);
            columns[P2G_DAMAGE] = vec_load(field_at(&s->fields[s->damage_field], pack, 0, part));
            columns[P2G_DAMAGE + 1] = vec_all(1);
            columns[P2G_PLANE] = at.base.z - (real)WINDOW_LOW;
            records_store(w->scratch->records, k * PACK + part * VEC_LANES, P2G_WZ, columns + P2G_WZ, RECORD - P2G_WZ);
        }
}

/* Adds to Σ w d and Σ w, side by side, of particles that share a first node: in registers, as many rows of nodes at once as there are registers for. */
SIMD_INLINE int scatter_damage_run(const real *records, int p, int count, int nodes, real *window) {
    real node = records[p * RECORD + P2G_NODE], *first = window + (int)node * DAMAGE_NODE;
    int planes = nodes * nodes + 4 <= VEC_REGISTERS ? nodes : nodes / 2, next = p;
    for (int lane = 0; lane < PAIRS; lane += PAIRS_LANES)
        for (int from = 0; from < nodes; from += planes) {
            vec_pairs sum[16];
            real *to = first + from * STRIDE_X * DAMAGE_NODE + lane;
            for (int i = 0; i < planes; i++)
                for (int j = 0; j < nodes; j++) sum[i * nodes + j] = pairs_load(to + (i * STRIDE_X + j * STRIDE_Y) * DAMAGE_NODE);
            for (next = p; next < count && records[next * RECORD + P2G_NODE] == node; next++) {
                const real *r = records + next * RECORD;
                vec_pairs row = pairs_double(r + P2G_WZ + lane / 2) * pairs_repeat(r + P2G_DAMAGE);
                for (int i = 0; i < planes; i++) {
                    vec_pairs here = row * r[P2G_WX + from + i];
                    for (int j = 0; j < nodes; j++) sum[i * nodes + j] = pairs_add_scaled(sum[i * nodes + j], here, r[P2G_WY + j]);
                }
            }
            for (int i = 0; i < planes; i++)
                for (int j = 0; j < nodes; j++) pairs_store(to + (i * STRIDE_X + j * STRIDE_Y) * DAMAGE_NODE, sum[i * nodes + j]);
        }
    return next;
}

/* The same of one particle, in memory. */
SIMD_INLINE void scatter_damage_particle(const real *r, int nodes, real *window) {
    real *first = window + (int)r[P2G_NODE] * DAMAGE_NODE;
    for (int lane = 0; lane < PAIRS; lane += PAIRS_LANES) {
        vec_pairs row = pairs_double(r + P2G_WZ + lane / 2) * pairs_repeat(r + P2G_DAMAGE);
        for (int i = 0; i < nodes; i++) {
            vec_pairs here = row * r[P2G_WX + i];
            for (int j = 0; j < nodes; j++) {
                real *to = first + (i * STRIDE_X + j * STRIDE_Y) * DAMAGE_NODE + lane;
                pairs_store(to, pairs_add_scaled(pairs_load(to), here, r[P2G_WY + j]));
            }
        }
    }
}

/* Particles whose kernel is not that which they are sorted by seldom follow one that has the same nodes, but often one whose rows are a node further
 * along z; and to load what two stores before have written waits until both are in the cache. So they go by planes of z. */
SIMD_INLINE void scatter_damage_planes(const real *records, int count, int nodes, real *window) {
    uint8_t plane[WINDOW][TILE_PARTICLES];
    int length[WINDOW] = {0};
    for (int p = 0; p < count; p++) {
        int z = (int)records[p * RECORD + P2G_PLANE];
        plane[z][length[z]++] = (uint8_t)p;
    }
    for (int z = 0; z < WINDOW; z++)
        for (int n = 0; n < length[z]; n++) scatter_damage_particle(records + plane[z][n] * RECORD, nodes, window);
}

/* Of a chunk whose momentum records serve both, the kernel being the same. */
SIMD_INLINE void scatter_damage_chunk(const tile_work *w, pack_chunk chunk, int nodes, real *window) {
    int count = chunk.until - chunk.from;
    for (int p = 0; p < count;) p = scatter_damage_run(w->scratch->records, p, count, nodes, window);
}

/* Where nothing is damaged, d and Δd are 0 and need no transfer: slots that damaged particles can reach are marked, and blocks at such slots
 * take part. */
static void find_damage(void *context, int64_t block, int worker) {
    (void)worker;
    solid *s = context;
    solid_block *b = &s->blocks[block];
    const solid_field *damage = &s->fields[s->damage_field];
    vec_mask found = vec_all(0) != 0;
    for (int32_t t = b->first_tile; t < b->first_tile + b->tile_count; t++)
        for (int32_t pack = s->tiles[t].first_pack; pack < s->tiles[t].first_pack + s->tiles[t].pack_count; pack++)
            for (int part = 0; part < PACK_PARTS; part++) found |= vec_load(field_at(damage, pack, 0, part)) != 0;
    b->damaged = vec_any(found);
}

static void mark_damage(solid *s) {
    parallel_for(s->threads, s->block_count, 16, find_damage, s);
    memset(s->slot_damaged, 0, (size_t)s->slot_count * sizeof *s->slot_damaged);
    for (int32_t b = 0; b < s->block_count; b++)
        for (int n = 0; s->blocks[b].damaged && n < NEIGHBOURS; n++)
            if (s->blocks[b].neighbour[n] >= 0) s->slot_damaged[s->blocks[b].neighbour[n]] = true;
}

static bool sees_damage(const solid *s, const solid_block *b) {
    if (!s->damage_grid) return false;
    for (int n = 0; n < NEIGHBOURS; n++)
        if (b->neighbour[n] >= 0 && s->slot_damaged[b->neighbour[n]]) return true;
    return false;
}

/* Whether a block looks at the clock; what it starts from. */
static double start_look(solid *s, int64_t block, int worker, int pass) {
    if ((block + s->looks) % BLOCKS_A_LOOK != 0) return 0;
    s->workers[worker].tile.lap = s->workers[worker].clocks[pass].effect;
    return clock_seconds();
}

static void end_look(solid *s, int worker, int pass, double start) {
    if (start == 0) return;
    s->workers[worker].clocks[pass].all += clock_seconds() - start;
    s->workers[worker].tile.lap = NULL;
}

static void call_stage(tile_work *w, size_t stage_offset) {
    const solid *s = w->state;
    for (int e = 0; e < s->effect_count; e++) {
        if (!(s->material_mask[w->tile->material] >> e & 1)) continue;
        void (*stage)(tile_work *);
        memcpy(&stage, (const char *)s->effects[e]->stages + stage_offset, sizeof stage);
        if (!stage) continue;
        w->effect = e;
        w->constants = s->constants[w->tile->material][e];
        double *lap = w->scratch->lap, start = lap ? clock_seconds() : 0;
        stage(w);
        if (lap) lap[e] += clock_seconds() - start;
    }
}

#define CALL_STAGE(w, stage) call_stage(w, offsetof(solid_stages, stage))

static void fill(real *to, int count, real value) {
    for (int i = 0; i < count; i++) to[i] = value;
}

static tile_work begin_tile(solid *s, int32_t t, int worker, real dt) {
    tile_work w = {.state = s, .tile = &s->tiles[t], .scratch = &s->workers[worker].tile, .result = &s->tile_results[t], .dt = dt};
    fill(w.scratch->degradation, w.tile->pack_count * PACK, 1);
    CALL_STAGE(&w, degrade);
    return w;
}

SIMD_INLINE void block_to_grid(const transfer_context *t, int32_t block_index, int32_t next, int worker, kernel_kind kernel, kernel_kind laplacian, bool damage) {
    solid *s = t->state;
    const solid_block *b = &s->blocks[block_index];
    solid_worker *own = &s->workers[worker];
    bool wide = kernels_are_wide(kernel, laplacian, damage);
    int nodes = kernel == KERNEL_QUADRATIC ? 3 : 4;
    pack_stream stream = stream_packs(s, block_index, next);
    exchange_rows(b, own->window, s->grid, NODE, BLOCK_NODES * NODE, wide, ROW_PREFETCH);
    memset(own->window, 0, sizeof own->window);
    if (s->old_grid) memset(own->old_window, 0, sizeof own->old_window);
    bool channel = damage && sees_damage(s, b);
    if (channel) memset(own->damage_window, 0, sizeof own->damage_window);
    for (int32_t i = b->first_tile; i < b->first_tile + b->tile_count; i++) {
        tile_work w = begin_tile(s, i, worker, t->dt);
        fill(w.scratch->kirchhoff, w.tile->pack_count * 6 * PACK, 0);
        CALL_STAGE(&w, stress);
        real density = (real)s->definition.materials[w.tile->material].density;
        bool takes_part = channel && s->material_damaged[w.tile->material];
        for (int first = 0; first < w.tile->pack_count; first += CHUNK_PACKS) {
            pack_chunk chunk = chunk_at(w.tile, first, CHUNK_PACKS);
            if (s->old_grid) {
                momentum_records(&w, chunk, kernel, density, 0, false);
                scatter_momentum(&w, &stream, chunk, nodes, own->old_window);
            }
            momentum_records(&w, chunk, kernel, density, 1, takes_part && kernel == laplacian);
            scatter_momentum(&w, &stream, chunk, nodes, own->window);
            if (takes_part && kernel == laplacian) scatter_damage_chunk(&w, chunk, nodes, own->damage_window);
        }
        if (takes_part && kernel != laplacian) {
            damage_records(&w, laplacian);
            scatter_damage_planes(w.scratch->records, w.tile->count, laplacian == KERNEL_QUADRATIC ? 3 : 4, own->damage_window);
        }
    }
    exchange_window(b, own->window, s->grid, NODE, BLOCK_NODES * NODE, wide, true);
    if (s->old_grid) exchange_window(b, own->old_window, s->old_grid, NODE, BLOCK_NODES * NODE, wide, true);
    if (!channel) return;
    exchange_window(b, own->damage_window, s->damage_grid, DAMAGE_NODE, BLOCK_NODES * DAMAGE_NODE, wide, true);
}

/* ---- grid to particles ------------------------------------------------------------------------------------------- */

SIMD_INLINE void gather_chunk(const tile_work *w, const pack_stream *stream, pack_chunk chunk, kernel_kind kernel, const real *window) {
    real *records = w->scratch->records;
    int count = chunk.until - chunk.from;
    for (int k = chunk.first; k < chunk.end; k++) {
        int p = (k - chunk.first) * PACK, end = p + PACK < count ? p + PACK : count;
        read_ahead(stream, w->tile->first_pack + k);
        gather_particles(records, p, end, kernel == KERNEL_QUADRATIC ? 3 : 4, window);
    }
    for (int p = count; p < (chunk.end - chunk.first) * PACK; p++) memset(records + p * RECORD + G2P_OUT, 0, 16 * sizeof(real));
}

SIMD_INLINE void keep_old_velocity(const tile_work *w, pack_chunk chunk) {
    for (int k = chunk.first; k < chunk.end; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            vec out[RECORD - G2P_OUT];
            records_load(w->scratch->records, (k - chunk.first) * PACK + part * VEC_LANES, G2P_OUT, out, RECORD - G2P_OUT);
            for (int c = 0; c < 3; c++) vec_store(scratch_at(w->scratch->old_velocity, 3, k, c, part), out[c]);
        }
}

/* FLIP: the particle's own velocity plus what the grid gained, blended with the grid's by the ratio. */
SIMD_INLINE vec3v flip_velocity(const tile_work *w, int k, int part, vec3v grid) {
    real ratio = (real)w->state->definition.transfer_ratio;
    vec3v own = vec3v_load(&w->state->fields[FIELD_VELOCITY], w->tile->first_pack + k, part);
    vec old[3];
    for (int c = 0; c < 3; c++) old[c] = vec_load(scratch_at(w->scratch->old_velocity, 3, k, c, part));
    return (vec3v){grid.x + ratio * (own.x - old[0]), grid.y + ratio * (own.y - old[1]), grid.z + ratio * (own.z - old[2])};
}

/* What a quadratic kernel's Laplacian takes from the nodes of particles that share the first of them: second differences along x, y and z, in rows
 * along z (those that records tell of), z and y. Its N'' are the same for all of them, so that is all that depends on d. */
typedef struct second_differences {
    vec4 x[3], y[3], z[3];
} second_differences;

/* a − 2 b + c */
SIMD_INLINE void second_difference(const vec4 *a, const vec4 *b, const vec4 *c, vec4 *out) {
    *out = *a + *c;
    vec4_add_scaled(out, b, -2);
}

/* From the row's first node and from the kernel's, which is `shift` further. */
SIMD_INLINE void differ_nodes(const real *first, int shift, second_differences *to) {
    vec4 d[3][3];
    SIMD_UNROLL
    for (int i = 0; i < 3; i++) {
        vec4 along_z[3];
        SIMD_UNROLL
        for (int j = 0; j < 3; j++) {
            const real *row = first + i * STRIDE_X + j * STRIDE_Y;
            vec4 start, middle, last;
            vec4_load(&d[i][j], row);
            vec4_load(&start, row + shift);
            vec4_load(&middle, row + shift + 1);
            vec4_load(&last, row + shift + 2);
            second_difference(&start, &middle, &last, &along_z[j]);
        }
        second_difference(&d[i][0], &d[i][1], &d[i][2], &to->y[i]);
        vec4 pair = __builtin_shufflevector(along_z[0], along_z[1], 0, 4, 0, 4);
        to->z[i] = __builtin_shufflevector(pair, along_z[2], 0, 1, 4, 4);
    }
    SIMD_UNROLL
    for (int j = 0; j < 3; j++) second_difference(&d[0][j], &d[1][j], &d[2][j], &to->x[j]);
}

/* Δd dx² of one particle, whose record kernel_records made. */
SIMD_INLINE real quadratic_laplacian(const real *r, const second_differences *d) {
    vec4 across = {0}, along_z = {0}, weight_z, weight_y;
    SIMD_UNROLL
    for (int i = 0; i < 3; i++) {
        vec4_add_scaled(&across, &d->x[i], r[G2P_WY + i]);
        vec4_add_scaled(&along_z, &d->z[i], r[G2P_WX + i]);
    }
    SIMD_UNROLL
    for (int i = 0; i < 3; i++) vec4_add_scaled(&across, &d->y[i], r[G2P_WX + i]);
    vec4_load(&weight_z, r + G2P_WZ);
    vec4_load(&weight_y, r + G2P_WY);
    vec4 total = across * weight_z + along_z * weight_y;
    return vec4_sum(&total);
}

/* How far the kernel's first node along z is from its row's: kernel_row_weights parts them at the same place. */
SIMD_INLINE int row_shift(const real *r) {
    return rows_are_even(KERNEL_QUADRATIC) && r[G2P_OFFSET + 2] >= (real)1.5;
}

/* Of particles that share a first node. */
SIMD_INLINE int quadratic_laplacian_run(const real *records, int p, int count, real scale, const real *window, real *out) {
    const real *r = records + p * RECORD;
    real node = r[G2P_NODE];
    int shift = row_shift(r);
    second_differences d;
    differ_nodes(window + (int)node, shift, &d);
    for (; p < count && r[G2P_NODE] == node && row_shift(r) == shift; p++, r += RECORD) out[p] = quadratic_laplacian(r, &d) * scale;
    return p;
}

/* A cubic kernel's N'' runs from (1, −2, 1, 0), where its first node's cell begins, to (0, 1, −2, 1), where that ends. */
SIMD_INLINE void cubic_curve(const vec4 rows[4], real t, vec4 *out) {
    vec4 end;
    second_difference(&rows[0], &rows[1], &rows[2], out);
    second_difference(&rows[1], &rows[2], &rows[3], &end);
    end -= *out;
    vec4_add_scaled(out, &end, t);
}

/* Slots of a particle's record for it. */
enum { CURVE_WX = 0, CURVE_WY = 4, CURVE_WZ = 8, CURVE_T = 12 /* how far it is in its cell */, CURVE_NODE = 15 };

SIMD_INLINE void curve_records(const tile_work *w) {
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            kernel_place at = kernel_locate(KERNEL_CUBIC, vec3v_load(&w->state->fields[FIELD_POSITION], w->tile->first_pack + k, part));
            vec columns[CURVE_NODE + 1];
            cubic_weights(at.u.x, columns + CURVE_WX);
            cubic_weights(at.u.y, columns + CURVE_WY);
            cubic_weights(at.u.z, columns + CURVE_WZ);
            columns[CURVE_T] = at.u.x - 1, columns[CURVE_T + 1] = at.u.y - 1, columns[CURVE_T + 2] = at.u.z - 1;
            columns[CURVE_NODE] = window_index(at.base);
            records_store(w->scratch->records, k * PACK + part * VEC_LANES, 0, columns, CURVE_NODE + 1);
        }
}

SIMD_INLINE real cubic_laplacian(const real *r, const real *window) {
    const real *first = window + (int)r[CURVE_NODE];
    vec4 sum[4], plain = {0}, curved, along_y = {0}, weight, bend = {1, -2, 1, 0};
    const vec4 slope = {-1, 3, -3, 1};
    SIMD_UNROLL
    for (int i = 0; i < 4; i++) {
        vec4 d[4], curve;
        SIMD_UNROLL
        for (int j = 0; j < 4; j++) vec4_load(&d[j], first + i * STRIDE_X + j * STRIDE_Y);
        sum[i] = d[0] * r[CURVE_WY];
        SIMD_UNROLL
        for (int j = 1; j < 4; j++) vec4_add_scaled(&sum[i], &d[j], r[CURVE_WY + j]);
        cubic_curve(d, r[CURVE_T + 1], &curve);
        vec4_add_scaled(&plain, &sum[i], r[CURVE_WX + i]);
        vec4_add_scaled(&along_y, &curve, r[CURVE_WX + i]);
    }
    cubic_curve(sum, r[CURVE_T], &curved);
    curved += along_y;
    vec4_add_scaled(&bend, &slope, r[CURVE_T + 2]);
    vec4_load(&weight, r + CURVE_WZ);
    vec4 total = plain * bend + curved * weight; /* what multiplies N'' and N along z */
    return vec4_sum(&total);
}

/* Δd at a chunk's particles from the nodal damage: N'' of one axis times N of the others. Their records are kernel_records' of the quadratic kernel. */
SIMD_INLINE void quadratic_laplacians(const tile_work *w, pack_chunk chunk, const real *window) {
    real scale = (real)(1 / (w->state->definition.dx * w->state->definition.dx)), *out = w->scratch->laplacian + chunk.from;
    int count = chunk.until - chunk.from, padded = (chunk.end - chunk.first) * PACK;
    for (int p = 0; p < count;) p = quadratic_laplacian_run(w->scratch->records, p, count, scale, window, out);
    for (int p = count; p < padded; p++) out[p] = 0;
}

/* Of a whole tile, whose gather has another kernel. */
SIMD_INLINE void gather_laplacian(const tile_work *w, kernel_kind kernel, const real *window) {
    real scale = (real)(1 / (w->state->definition.dx * w->state->definition.dx)), *records = w->scratch->records, *out = w->scratch->laplacian;
    int count = w->tile->count, packs = w->tile->pack_count;
    if (kernel == KERNEL_QUADRATIC) {
        kernel_records(w->state, w->tile, 0, packs, records, kernel);
        quadratic_laplacians(w, chunk_at(w->tile, 0, packs), window);
        return;
    }
    curve_records(w);
    for (int p = 0; p < count; p++) out[p] = cubic_laplacian(records + p * RECORD, window) * scale;
    for (int p = count; p < packs * PACK; p++) out[p] = 0;
}

/* What of L the particle carries on as C (METHOD.md §3): all of it, its skew part and a share of the rest, or nothing. */
SIMD_INLINE mat3v project_affine(const solid_definition *d, mat3v L) {
    if (d->transfer == TRANSFER_APIC) return L;
    if (d->transfer != TRANSFER_RPIC) return (mat3v){0};
    real same = (real)(0.5 * (1 + d->transfer_ratio)), across = (real)(0.5 * (d->transfer_ratio - 1)), ratio = (real)d->transfer_ratio;
    return (mat3v){ratio * L.xx, same * L.xy + across * L.yx, same * L.xz + across * L.zx,
                   same * L.yx + across * L.xy, ratio * L.yy, same * L.yz + across * L.zy,
                   same * L.zx + across * L.xz, same * L.zy + across * L.yz, ratio * L.zz};
}

/* F ← (I + Δt L) F */
SIMD_INLINE mat3v advance_deformation(mat3v L, real dt, mat3v F) {
    vec h = vec_all(dt);
#define ROW_OF(lx, ly, lz, fx, fy, fz, f) vec_fma(h, vec_fma(lx, fx, vec_fma(ly, fy, lz * fz)), f)
    return (mat3v){ROW_OF(L.xx, L.xy, L.xz, F.xx, F.yx, F.zx, F.xx), ROW_OF(L.xx, L.xy, L.xz, F.xy, F.yy, F.zy, F.xy),
                   ROW_OF(L.xx, L.xy, L.xz, F.xz, F.yz, F.zz, F.xz), ROW_OF(L.yx, L.yy, L.yz, F.xx, F.yx, F.zx, F.yx),
                   ROW_OF(L.yx, L.yy, L.yz, F.xy, F.yy, F.zy, F.yy), ROW_OF(L.yx, L.yy, L.yz, F.xz, F.yz, F.zz, F.yz),
                   ROW_OF(L.zx, L.zy, L.zz, F.xx, F.yx, F.zx, F.zx), ROW_OF(L.zx, L.zy, L.zz, F.xy, F.yy, F.zy, F.zy),
                   ROW_OF(L.zx, L.zy, L.zz, F.xz, F.yz, F.zz, F.zz)};
#undef ROW_OF
}

/* Lane by lane, whether a vector is finite and moves less than a cell a step. */
SIMD_INLINE vec_mask is_sound(vec3v step, mat3v F) {
    vec sum = F.xx + F.xy + F.xz + F.yx + F.yy + F.yz + F.zx + F.zy + F.zz;
    vec most = vec_max(vec_max(vec_abs(step.x), vec_abs(step.y)), vec_abs(step.z));
    /* Comparisons with a NaN are false; the product with 0 turns infinities into NaN. */
    return (sum * 0 == 0) & (most < 1) & (step.x * 0 == 0) & (step.y * 0 == 0) & (step.z * 0 == 0);
}

/* Moves the particles on; reports the first unsound one and whether any has left its block's margin. */
SIMD_INLINE void advance_particles(const tile_work *w, pack_chunk chunk, kernel_kind kernel) {
    const solid *s = w->state;
    const solid_definition *d = &s->definition;
    const solid_block *b = &s->blocks[w->tile->block];
    real inverse_d = (real)((kernel == KERNEL_QUADRATIC ? 4.0 : 3.0) / d->dx), per_cell = (real)((double)w->dt / d->dx);
    real shift = (real)kernel_shift(kernel);
    vec_mask inside = vec_all(0) == 0;
    for (int k = chunk.first; k < chunk.end; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            int32_t pack = w->tile->first_pack + k;
            int first = k * PACK + part * VEC_LANES;
            const real *records = w->scratch->records;
            vec out[RECORD - G2P_OUT];
            records_load(records, first - chunk.from, G2P_OUT, out, RECORD - G2P_OUT);
            vec3v v = {out[0], out[1], out[2]};
            vec3v x = vec3v_load(&s->fields[FIELD_POSITION], pack, part);
            mat3v L = mat3v_scale(vec_all(inverse_d), gathered_moments(kernel, out, kernel_locate(kernel, x)));
            mat3v F = advance_deformation(L, w->dt, mat3v_load(&s->fields[FIELD_DEFORMATION], pack, part));
            vec3v step = {per_cell * v.x, per_cell * v.y, per_cell * v.z};
            x = (vec3v){x.x + step.x, x.y + step.y, x.z + step.z};
            vec_mask sound = is_sound(step, F);
            for (int lane = 0; vec_any(~sound) && lane < VEC_LANES; lane++)
                if (!sound[lane] && !w->result->fault && first + lane < w->tile->count) w->result->fault = first + lane + 1;
            inside &= (x.x >= (real)b->base_low[0] + shift) & (x.x < (real)(b->base_high[0] + 1) + shift) &
                      (x.y >= (real)b->base_low[1] + shift) & (x.y < (real)(b->base_high[1] + 1) + shift) &
                      (x.z >= (real)b->base_low[2] + shift) & (x.z < (real)(b->base_high[2] + 1) + shift);
            mat3v_store(&s->fields[FIELD_DEFORMATION], pack, part, F);
            mat3v_store(&s->fields[FIELD_AFFINE], pack, part, project_affine(d, L));
            vec3v_store(&s->fields[FIELD_VELOCITY], pack, part, s->old_grid ? flip_velocity(w, k, part, v) : v);
            vec3v_store(&s->fields[FIELD_POSITION], pack, part, x);
        }
    w->result->unsorted |= vec_any(~inside);
}

/* The momentum limit: speed of sound of the state that has just been reached, and speed. */
static void limit_momentum(tile_work *w) {
    const solid *s = w->state;
    fill(w->scratch->degradation, w->tile->pack_count * PACK, 1);
    CALL_STAGE(w, degrade); /* of the new damage */
    fill(w->scratch->wave_tensor, w->tile->pack_count * 6 * PACK, 0);
    fill(w->scratch->wave_modulus, w->tile->pack_count * PACK, 0);
    CALL_STAGE(w, wave);
    vec fastest = vec_all(0);
    real inverse_density = (real)(1 / s->definition.materials[w->tile->material].density);
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            int32_t pack = w->tile->first_pack + k;
            vec3v v = vec3v_load(&s->fields[FIELD_VELOCITY], pack, part);
            vec modulus = vec_load(scratch_at(w->scratch->wave_modulus, 1, k, 0, part)) + sym3v_largest(sym3v_scratch(w->scratch->wave_tensor, k, part));
            vec square = scaled_down(s, s->density_scale, pack, part, modulus * inverse_density);
            vec speed = vec_sqrt(square) + vec_sqrt(vec3v_dot(v, v));
            vec volume = vec_load(field_at(&s->fields[FIELD_VOLUME], pack, 0, part));
            fastest = vec_max(vec_select(volume > 0, speed, vec_all(0)), fastest);
        }
    w->result->limit[EFFECT_elastic] = vec_largest(fastest) * (real)(1 / s->definition.dx);
}

SIMD_INLINE void block_to_particles(const transfer_context *t, int32_t block_index, int worker, kernel_kind kernel, kernel_kind laplacian, bool damage) {
    solid *s = t->state;
    const solid_block *b = &s->blocks[block_index];
    solid_worker *own = &s->workers[worker];
    bool wide = kernels_are_wide(kernel, laplacian, damage);
    bool follows = block_index + 1 < s->block_shares[worker + 1] && block_index >= s->block_shares[worker];
    pack_stream stream = stream_packs(s, block_index, follows ? block_index + 1 : -1);
    exchange_window(b, own->window, s->grid, NODE, BLOCK_NODES * NODE, wide, false);
    if (s->old_grid) exchange_window(b, own->old_window, s->old_grid, NODE, BLOCK_NODES * NODE, wide, false);
    bool channel = damage && sees_damage(s, b);
    if (channel) exchange_window(b, own->damage_window, s->damage_grid, 1, BLOCK_NODES * DAMAGE_NODE, wide, false);
    if (damage && s->implicit_on) implicit_load_window(s, b, own->implicit_window);
    if (follows) exchange_rows(&s->blocks[block_index + 1], own->window, s->grid, NODE, BLOCK_NODES * NODE, wide, ROW_PREFETCH);
    for (int32_t i = b->first_tile; i < b->first_tile + b->tile_count; i++) {
        tile_work w = {.state = s, .tile = &s->tiles[i], .scratch = &own->tile, .result = &s->tile_results[i], .dt = t->dt};
        memset(w.result, 0, sizeof *w.result);
        bool weighed = damage && kernel == KERNEL_QUADRATIC && laplacian == KERNEL_QUADRATIC; /* the gather's records serve damage too */
        bool solved = damage && s->material_implicit[w.tile->material], takes_part = channel && s->material_damaged[w.tile->material] && !solved;
        if (takes_part && !weighed) gather_laplacian(&w, laplacian, own->damage_window);
        else if (solved && !weighed) implicit_gather(&w, false, own->implicit_window);
        else if (damage && !takes_part && !solved) fill(w.scratch->laplacian, w.tile->pack_count * PACK, 0);
        int packs = weighed && solved ? TILE_PACKS : CHUNK_PACKS;
        for (int first = 0; first < w.tile->pack_count; first += packs) {
            pack_chunk chunk = chunk_at(w.tile, first, packs);
            kernel_records(s, w.tile, chunk.first, chunk.end, w.scratch->records, kernel);
            if (takes_part && weighed) quadratic_laplacians(&w, chunk, own->damage_window);
            if (solved && weighed) implicit_gather(&w, true, own->implicit_window);
            if (s->old_grid) {
                gather_chunk(&w, &stream, chunk, kernel, own->old_window);
                keep_old_velocity(&w, chunk);
            }
            gather_chunk(&w, &stream, chunk, kernel, own->window);
            advance_particles(&w, chunk, kernel);
        }
        CALL_STAGE(&w, update);
        limit_momentum(&w);
    }
}

/* ---- one instance a combination of kernels ----------------------------------------------------------------------- */

#define INSTANCE(name, kernel, laplacian, damage)                                                                      \
    static void p2g_##name(void *t, int32_t block, int32_t next, int worker) {                                         \
        transfer_context *c = t;                                                                                       \
        double start = start_look(c->state, block, worker, PASS_P2G);                                                  \
        block_to_grid(c, block, next, worker, kernel, laplacian, damage);                                              \
        end_look(c->state, worker, PASS_P2G, start);                                                                   \
    }                                                                                                                  \
    static void g2p_##name(void *t, int64_t i, int worker) {                                                           \
        transfer_context *c = t;                                                                                       \
        double start = start_look(c->state, i, worker, PASS_G2P);                                                      \
        block_to_particles(t, (int32_t)i, worker, kernel, laplacian, damage);                                          \
        end_look(c->state, worker, PASS_G2P, start);                                                                   \
    }

INSTANCE(quadratic, KERNEL_QUADRATIC, KERNEL_QUADRATIC, false)
INSTANCE(cubic, KERNEL_CUBIC, KERNEL_CUBIC, false)
INSTANCE(quadratic_quadratic, KERNEL_QUADRATIC, KERNEL_QUADRATIC, true)
INSTANCE(quadratic_cubic, KERNEL_QUADRATIC, KERNEL_CUBIC, true)
INSTANCE(cubic_cubic, KERNEL_CUBIC, KERNEL_CUBIC, true)
INSTANCE(cubic_quadratic, KERNEL_CUBIC, KERNEL_QUADRATIC, true)

static coloured_pass *const to_grid[2][3] = {{p2g_quadratic, p2g_quadratic_quadratic, p2g_quadratic_cubic},
                                          {p2g_cubic, p2g_cubic_quadratic, p2g_cubic_cubic}};
static void (*const to_particles[2][3])(void *, int64_t, int) = {{g2p_quadratic, g2p_quadratic_quadratic, g2p_quadratic_cubic},
                                               {g2p_cubic, g2p_cubic_quadratic, g2p_cubic_cubic}};

static int damage_instance(const solid *s) {
    if (!s->transfers_damage) return 0;
    return s->definition.laplacian == KERNEL_QUADRATIC ? 1 : 2;
}

static void clear_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    solid *s = context;
    memset(s->grid + slot * BLOCK_NODES * NODE, 0, BLOCK_NODES * NODE * sizeof(real));
    if (s->old_grid) memset(s->old_grid + slot * BLOCK_NODES * NODE, 0, BLOCK_NODES * NODE * sizeof(real));
    if (s->damage_grid) memset(s->damage_grid + slot * BLOCK_NODES * DAMAGE_NODE, 0, BLOCK_NODES * DAMAGE_NODE * sizeof(real));
}

void transfer_to_grid(solid *s, real dt) {
    parallel_for(s->threads, s->slot_count, 16, clear_slot, s);
    s->looks++;
    if (s->damage_grid) mark_damage(s);
    transfer_context t = {.state = s, .dt = dt};
    colours_pass(s, to_grid[s->definition.kernel == KERNEL_CUBIC][damage_instance(s)], &t);
}

void transfer_to_particles(solid *s, real dt) {
    transfer_context t = {.state = s, .dt = dt};
    parallel_stages(s->threads, 1, s->block_shares, to_particles[s->definition.kernel == KERNEL_CUBIC][damage_instance(s)], &t);
}

static void limit_tile(void *context, int64_t i, int worker) {
    solid *s = context;
    tile_work w = {.state = s, .tile = &s->tiles[i], .scratch = &s->workers[worker].tile, .result = &s->tile_results[i]};
    w.result->limit[EFFECT_elastic] = 0;
    limit_momentum(&w);
}

void transfer_limits(solid *s) {
    parallel_for(s->threads, s->tile_count, 8, limit_tile, s);
}
