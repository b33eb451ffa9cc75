/* Records: what one particle gives to the rows of nodes around it, and takes back from them.
 *
 * Vector work (weights, stresses) is done for many particles at once and written to records, one a particle; the row work, four nodes along z
 * at once, reads them particle by particle. */
#ifndef SUNDER_SOLID_RECORDS_H
#define SUNDER_SOLID_RECORDS_H

#include "solid/kernels.h"

/* Slots of a particle's record for scattering momentum and for gathering velocity. */
enum {
    RECORD = 32,
    P2G_BASE = 0, P2G_X = 4, P2G_Y = 8, P2G_Z = 12, P2G_WZ = 16, P2G_WX = 20, P2G_WY = 24, P2G_NODE = 28, P2G_DAMAGE = 29 /* and 1 */,
    G2P_WX = 0, G2P_WY = 4, G2P_WZ = 8, G2P_OFFSET = 12, G2P_NODE = 15, G2P_OUT = 16,
};

/* Writes columns[0 … count) of a part's lanes into slots from `slot` on of their records; count is a multiple of VEC_LANES. The columns are
 * lost. */
SIMD_INLINE void records_store(real *records, int first, int slot, vec *columns, int count) {
    for (int group = 0; group < count; group += VEC_LANES) {
        vec_transpose(columns + group);
        for (int lane = 0; lane < VEC_LANES; lane++) vec_store(records + (first + lane) * RECORD + slot + group, columns[group + lane]);
    }
}

/* The way back. */
SIMD_INLINE void records_load(const real *records, int first, int slot, vec *columns, int count) {
    for (int group = 0; group < count; group += VEC_LANES) {
        for (int lane = 0; lane < VEC_LANES; lane++) columns[group + lane] = vec_load(records + (first + lane) * RECORD + slot + group);
        vec_transpose(columns + group);
    }
}

SIMD_INLINE void gather_columns(kernel_kind kernel, kernel_place at, vec columns[G2P_OUT]) {
    kernel_place row = kernel_row(kernel, at);
    kernel_weights(kernel, row.u.x, columns + G2P_WX);
    kernel_weights(kernel, row.u.y, columns + G2P_WY);
    kernel_row_weights(kernel, row.u.z, columns + G2P_WZ);
    columns[G2P_OFFSET] = row.u.x, columns[G2P_OFFSET + 1] = row.u.y, columns[G2P_OFFSET + 2] = row.u.z;
    columns[G2P_NODE] = window_index(row.base);
}

/* Weights and places of the particles of a tile's packs from `first` to before `end`, as a gather wants them: along z of the row's four nodes. */
SIMD_INLINE void kernel_records(const solid *s, const solid_tile *tile, int first, int end, real *records, kernel_kind kernel) {
    for (int k = first; k < end; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            vec columns[G2P_OUT];
            gather_columns(kernel, kernel_locate(kernel, vec3v_load(&s->fields[FIELD_POSITION], tile->first_pack + k, part)), columns);
            records_store(records, (k - first) * PACK + part * VEC_LANES, 0, columns, G2P_OUT);
        }
}

/* What a particle's record adds to one part of the rows around it: the value at each axis' first node, and its slopes, all times the weight along z. */
typedef struct row_terms {
    vec value, along_x, along_y;
} row_terms;

SIMD_INLINE row_terms row_terms_of(const real *r, const node_row node_offset, int part) {
    vec weight = row_spread(r + P2G_WZ).part[part];
    vec value = vec_fma(row_repeat(r + P2G_Z).part[part], node_offset.part[part], row_repeat(r + P2G_BASE).part[part]);
    return (row_terms){weight * value, weight * row_repeat(r + P2G_X).part[part], weight * row_repeat(r + P2G_Y).part[part]};
}

/* Adds the contribution of one particle to the window, from its first node on. */
SIMD_INLINE void scatter_particle(const real *restrict r, int nodes, const node_row node_offset, real *restrict first) {
    vec weight_y[4];
    for (int j = 0; j < nodes; j++) weight_y[j] = vec_all(r[P2G_WY + j]);
    SIMD_UNROLL for (int part = 0; part < ROW_PARTS; part++) {
        if (!row_needs(part, nodes)) continue;
        row_terms t = row_terms_of(r, node_offset, part);
        for (int i = 0; i < nodes; i++) {
            vec weight_x = vec_all(r[P2G_WX + i]), here = t.value * weight_x, slope = t.along_y * weight_x;
            for (int j = 0; j < nodes; j++) {
                real *to = first + (i * STRIDE_X + j * STRIDE_Y) * NODE + part * VEC_LANES;
                vec_store(to, vec_fma(here, weight_y[j], vec_load(to)));
                here += slope;
            }
            t.value += t.along_x;
        }
    }
}

/* Adds the contributions of particles that share a first node to the window, summed up in registers; returns the first that does not. */
SIMD_INLINE int scatter_run(const real *records, int p, int count, int nodes, const node_row node_offset, real *window) {
    real node = records[p * RECORD + P2G_NODE];
    node_row sum[16];
    real *first = window + (int)node * NODE;
    for (int i = 0; i < nodes; i++)
        for (int j = 0; j < nodes; j++) sum[i * nodes + j] = row_load(first + (i * STRIDE_X + j * STRIDE_Y) * NODE);
    for (; p < count && records[p * RECORD + P2G_NODE] == node; p++) {
        const real *r = records + p * RECORD;
        node_row weight = row_spread(r + P2G_WZ), along_x = row_multiply(weight, row_repeat(r + P2G_X)), along_y = row_multiply(weight, row_repeat(r + P2G_Y));
        node_row value = row_multiply(weight, row_fma(row_repeat(r + P2G_Z), node_offset, row_repeat(r + P2G_BASE)));
        for (int i = 0; i < nodes; i++) {
            node_row here = row_scale(value, r[P2G_WX + i]), slope = row_scale(along_y, r[P2G_WX + i]);
            for (int j = 0; j < nodes; j++) {
                sum[i * nodes + j] = row_scale_add(here, r[P2G_WY + j], sum[i * nodes + j]);
                here = row_add(here, slope);
            }
            value = row_add(value, along_x);
        }
    }
    for (int i = 0; i < nodes; i++)
        for (int j = 0; j < nodes; j++) row_store(first + (i * STRIDE_X + j * STRIDE_Y) * NODE, sum[i * nodes + j]);
    return p;
}

/* A particle's first node in a window; looked up a particle ahead, so that what depends on it need not wait. */
SIMD_INLINE int node_of(const real *records, int p, int count, int slot) {
    return (int)records[(p < count ? p : count - 1) * RECORD + slot] * NODE;
}

/* Adds the contributions of particles from p on to the window, at least until `end`, at most `count`; returns the first that was not. Where registers are too few for
 * the sums of a run, one particle at a time: sums that are spilled cost two stores a row, and the end of a run is hard to foresee. */
SIMD_INLINE int scatter_particles(const real *records, int p, int end, int count, int nodes, const node_row node_offset, real *window) {
    if (end > count) end = count;
    if (ROWS_FIT_REGISTERS) {
        while (p < end) p = scatter_run(records, p, count, nodes, node_offset, window);
        return p;
    }
    for (int next = node_of(records, p, count, P2G_NODE); p < end; p++) {
        real *first = window + next;
        next = node_of(records, p + 1, count, P2G_NODE);
        scatter_particle(records + p * RECORD, nodes, node_offset, first);
    }
    return p;
}

/* Slots of a record of four plain values; weights along y and the first node follow those along x. No more columns than are needed: turning
 * them costs as much as what is done with them. */
enum { PLAIN_VALUE = 0, PLAIN_WZ = 4, PLAIN_WX = 8, PLAIN_COLUMNS = PLAIN_WX + 2 * 4 + VEC_LANES };

SIMD_INLINE void plain_records(real *records, int first, kernel_kind kind, vec3v x, const vec values[NODE]) {
    int nodes = kind == KERNEL_QUADRATIC ? 3 : 4, node = PLAIN_WX + 2 * nodes;
    kernel_place at = kernel_locate(kind, x);
    vec columns[PLAIN_COLUMNS];
    for (int c = 0; c < NODE; c++) columns[PLAIN_VALUE + c] = values[c];
    kernel_weights(kind, at.u.z, columns + PLAIN_WZ);
    kernel_weights(kind, at.u.x, columns + PLAIN_WX);
    kernel_weights(kind, at.u.y, columns + PLAIN_WX + nodes);
    columns[node] = window_index(at.base);
    for (int c = node + 1; c < PLAIN_COLUMNS; c++) columns[c] = vec_all(0);
    records_store(records, first, 0, columns, (node + VEC_LANES) / VEC_LANES * VEC_LANES);
}

/* Adds w times the four values of particles that share a first node. */
SIMD_INLINE int scatter_plain_run(const real *records, int p, int count, int nodes, real *window) {
    int slot = PLAIN_WX + 2 * nodes;
    real node = records[p * RECORD + slot], *first = window + (int)node * NODE;
    node_row sum[16] = {{{{0}}}};
    for (; p < count && records[p * RECORD + slot] == node; p++) {
        const real *r = records + p * RECORD;
        node_row value = row_multiply(row_spread(r + PLAIN_WZ), row_repeat(r + PLAIN_VALUE));
        for (int i = 0; i < nodes; i++) {
            node_row here = row_scale(value, r[PLAIN_WX + i]);
            for (int j = 0; j < nodes; j++) sum[i * nodes + j] = row_scale_add(here, r[PLAIN_WX + nodes + j], sum[i * nodes + j]);
        }
    }
    for (int i = 0; i < nodes; i++)
        for (int j = 0; j < nodes; j++) {
            real *to = first + (i * STRIDE_X + j * STRIDE_Y) * NODE;
            row_store(to, row_add(row_load(to), sum[i * nodes + j]));
        }
    return p;
}

/* The same for one particle, straight to the window. */
SIMD_INLINE void scatter_plain_particle(const real *r, int nodes, real *window) {
    real *first = window + (int)r[PLAIN_WX + 2 * nodes] * NODE;
    node_row value = row_multiply(row_spread(r + PLAIN_WZ), row_repeat(r + PLAIN_VALUE));
    for (int i = 0; i < nodes; i++) {
        node_row here = row_scale(value, r[PLAIN_WX + i]);
        for (int j = 0; j < nodes; j++) row_add_scaled_to(first + (i * STRIDE_X + j * STRIDE_Y) * NODE, here, r[PLAIN_WX + nodes + j], nodes);
    }
}

/* Runs where their sums fit in registers, as with momentum. */
SIMD_INLINE void scatter_plain(const real *records, int count, kernel_kind kind, real *window) {
    int nodes = kind == KERNEL_QUADRATIC ? 3 : 4;
    if (ROWS_FIT_REGISTERS)
        for (int p = 0; p < count;) p = scatter_plain_run(records, p, count, nodes, window);
    else
        for (int p = 0; p < count; p++) scatter_plain_particle(records + p * RECORD, nodes, window);
}

/* Σ w_ip x_i of one particle whose record kernel_records made. */
SIMD_INLINE real mean_at(const real *r, int nodes, const real *x) {
    vec4 total = {0}, weight;
    for (int i = 0; i < nodes; i++) {
        vec4 sum = {0};
        for (int j = 0; j < nodes; j++) {
            vec4 row;
            vec4_load(&row, x + i * STRIDE_X + j * STRIDE_Y);
            vec4_add_scaled(&sum, &row, r[G2P_WY + j]);
        }
        vec4_add_scaled(&total, &sum, r[G2P_WX + i]);
    }
    vec4_load(&weight, r + G2P_WZ);
    total *= weight;
    return (total[0] + total[2]) + (total[1] + total[3]);
}

/* Σ w_n v_n and Σ w_n v_n (n − 1) of the nodes of one axis: of quadratic kernels, three multiplications and two sums. */
typedef struct axis_sums {
    vec plain, lean;
} axis_sums;

SIMD_INLINE axis_sums axis_sum(int nodes, const vec v[4], const vec w[4]) {
    vec first = v[0] * w[0], third = v[2] * w[2];
    axis_sums s = {vec_fma(v[1], w[1], first) + third, third - first};
    if (nodes == 4) {
        vec fourth = v[3] * w[3];
        s.plain += fourth, s.lean = vec_fma(vec_all(2), fourth, s.lean);
    }
    return s;
}

/* One particle, from its first node on: Σ w v_i and Σ w v_i (x_i − x_m)ᵀ, by separable sums, y first, then x, then z. Results in the record: velocity, then the three
 * columns. x_m is the second node along x and y, the row's middle along z: distances are small whole or half numbers, the same for all particles;
 * gathered_moments goes over to the particle. */
SIMD_INLINE void gather_particle(real *restrict r, int nodes, const real *restrict first) {
    const real lean_z[4] = {(real)-1.5, (real)-0.5, (real)0.5, (real)1.5};
    node_row weight_z = row_spread(r + G2P_WZ), weight_lean = row_multiply(weight_z, row_spread(lean_z)), moments[4];
    vec weight_x[4], weight_y[4];
    for (int n = 0; n < nodes; n++) weight_x[n] = vec_all(r[G2P_WX + n]), weight_y[n] = vec_all(r[G2P_WY + n]);
    SIMD_UNROLL for (int part = 0; part < ROW_PARTS; part++) {
        if (!row_needs(part, nodes)) {
            for (int m = 0; m < 4; m++) moments[m].part[part] = vec_all(0);
            continue;
        }
        vec plain[4], lean[4];
        for (int i = 0; i < nodes; i++) {
            vec v[4];
            for (int j = 0; j < nodes; j++) v[j] = vec_load(first + (i * STRIDE_X + j * STRIDE_Y) * NODE + part * VEC_LANES);
            axis_sums along = axis_sum(nodes, v, weight_y);
            plain[i] = along.plain, lean[i] = along.lean;
        }
        axis_sums along = axis_sum(nodes, plain, weight_x);
        vec along_y = axis_sum(nodes, lean, weight_x).plain;
        moments[0].part[part] = along.plain * weight_z.part[part];
        moments[1].part[part] = along.lean * weight_z.part[part];
        moments[2].part[part] = along_y * weight_z.part[part];
        moments[3].part[part] = along.plain * weight_lean.part[part];
    }
    row_fold(moments, r + G2P_OUT);
}

SIMD_INLINE void gather_particles(real *records, int p, int end, int nodes, const real *window) {
    for (int next = node_of(records, p, end, G2P_NODE); p < end; p++) {
        const real *first = window + next;
        next = node_of(records, p + 1, end, G2P_NODE);
        gather_particle(records + p * RECORD, nodes, first);
    }
}

/* From gathered columns, as records_load gives them from G2P_OUT on: Σ w v (x_i − x_p)ᵀ in units of dx, of particles at such places. */
SIMD_INLINE mat3v gathered_moments(kernel_kind kernel, const vec out[16], kernel_place at) {
    vec3v u = kernel_row(kernel, at).u;
    vec x = 1 - u.x, y = 1 - u.y, z = (real)1.5 - u.z;
    return (mat3v){vec_fma(x, out[0], out[4]), vec_fma(y, out[0], out[8]), vec_fma(z, out[0], out[12]),
                   vec_fma(x, out[1], out[5]), vec_fma(y, out[1], out[9]), vec_fma(z, out[1], out[13]),
                   vec_fma(x, out[2], out[6]), vec_fma(y, out[2], out[10]), vec_fma(z, out[2], out[14])};
}

#endif
