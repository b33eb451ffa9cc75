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

/* Weights and places of a tile's particles, as a gather wants them. */
SIMD_INLINE void kernel_records(const solid *s, const solid_tile *tile, real *records, kernel_kind kernel) {
    for (int k = 0; k < tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            kernel_place at = kernel_locate(kernel, vec3v_load(&s->fields[FIELD_POSITION], tile->first_pack + k, part));
            vec columns[G2P_OUT];
            kernel_weights(kernel, at.u.x, columns + G2P_WX);
            kernel_weights(kernel, at.u.y, columns + G2P_WY);
            kernel_weights(kernel, at.u.z, columns + G2P_WZ);
            columns[G2P_OFFSET] = at.u.x, columns[G2P_OFFSET + 1] = at.u.y, columns[G2P_OFFSET + 2] = at.u.z;
            columns[G2P_NODE] = window_index(at.base);
            records_store(records, k * PACK + part * VEC_LANES, 0, columns, G2P_OUT);
        }
}

/* Adds the contributions of particles that share a first node to the window: accumulated in registers, stored once. */
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

/* Adds w times four reals at P2G_BASE of particles that share a first node. */
SIMD_INLINE int scatter_plain_run(const real *records, int p, int count, int nodes, real *window) {
    real node = records[p * RECORD + P2G_NODE], *first = window + (int)node * NODE;
    node_row sum[16] = {{{{0}}}};
    for (; p < count && records[p * RECORD + P2G_NODE] == node; p++) {
        const real *r = records + p * RECORD;
        node_row value = row_multiply(row_spread(r + P2G_WZ), row_repeat(r + P2G_BASE));
        for (int i = 0; i < nodes; i++) {
            node_row here = row_scale(value, r[P2G_WX + i]);
            for (int j = 0; j < nodes; j++) sum[i * nodes + j] = row_scale_add(here, r[P2G_WY + j], sum[i * nodes + j]);
        }
    }
    for (int i = 0; i < nodes; i++)
        for (int j = 0; j < nodes; j++) {
            real *to = first + (i * STRIDE_X + j * STRIDE_Y) * NODE;
            row_store(to, row_add(row_load(to), sum[i * nodes + j]));
        }
    return p;
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

/* One particle: Σ w v_i and Σ w v_i (x_i − x_p)ᵀ by separable sums, y first, then x, then z. Results in the record: velocity, then the three
 * columns. */
SIMD_INLINE void gather_particle(real *r, int nodes, const node_row node_offset, const real *window) {
    const real *first = window + (int)r[G2P_NODE] * NODE;
    node_row plain = {0}, along_x = {0}, along_y = {0};
    for (int i = 0; i < nodes; i++) {
        node_row sum = {0}, moment = {0};
        for (int j = 0; j < nodes; j++) {
            node_row v = row_load(first + (i * STRIDE_X + j * STRIDE_Y) * NODE);
            real weight = r[G2P_WY + j];
            sum = row_scale_add(v, weight, sum);
            moment = row_scale_add(v, weight * ((real)j - r[G2P_OFFSET + 1]), moment);
        }
        real weight = r[G2P_WX + i];
        plain = row_scale_add(sum, weight, plain);
        along_x = row_scale_add(sum, weight * ((real)i - r[G2P_OFFSET + 0]), along_x);
        along_y = row_scale_add(moment, weight, along_y);
    }
    node_row weight_z = row_spread(r + G2P_WZ);
    const real z[4] = {r[G2P_OFFSET + 2], r[G2P_OFFSET + 2], r[G2P_OFFSET + 2], r[G2P_OFFSET + 2]};
    node_row distance_z = row_scale_add(row_repeat(z), -1, node_offset);
    node_row weighted = row_multiply(plain, weight_z);
    const node_row moments[4] = {weighted, row_multiply(along_x, weight_z), row_multiply(along_y, weight_z), row_multiply(weighted, distance_z)};
    row_fold(moments, r + G2P_OUT);
}

#endif
