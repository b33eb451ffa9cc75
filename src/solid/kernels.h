/* B-spline kernels on vectors of particles, and the window through which a block's passes see the grid. */
#ifndef SUNDER_SOLID_KERNELS_H
#define SUNDER_SOLID_KERNELS_H

#include "solid/tensor.h"

enum { STRIDE_X = WINDOW * WINDOW, STRIDE_Y = WINDOW };

/* B-spline weights of the nodes 0…n−1 for a particle at distance u (in dx) from the first of them. */
SIMD_INLINE void quadratic_weights(vec u, vec w[4]) {
    vec a = (real)1.5 - u, b = u - 1, c = u - (real)0.5;
    w[0] = (real)0.5 * a * a;
    w[1] = (real)0.75 - b * b;
    w[2] = (real)0.5 * c * c;
    w[3] = vec_all(0);
}

SIMD_INLINE void cubic_weights(vec u, vec w[4]) {
    vec t = u - 1, s = 1 - t;
    const real sixth = (real)(1.0 / 6.0);
    w[0] = sixth * s * s * s;
    w[1] = (real)(2.0 / 3.0) - t * t * (1 - (real)0.5 * t);
    w[2] = (real)(2.0 / 3.0) - s * s * (1 - (real)0.5 * s);
    w[3] = sixth * t * t * t;
}

SIMD_INLINE void kernel_weights(kernel_kind kernel, vec u, vec w[4]) {
    if (kernel == KERNEL_QUADRATIC) quadratic_weights(u, w);
    else cubic_weights(u, w);
}

/* The first node of each axis (in block coordinates) and the distances from it. */
typedef struct kernel_place {
    vec3v base, u;
} kernel_place;

SIMD_INLINE kernel_place kernel_locate(kernel_kind kernel, vec3v x) {
    real shift = kernel == KERNEL_QUADRATIC ? (real)0.5 : 1;
    vec3v base = {vec_floor(x.x - shift), vec_floor(x.y - shift), vec_floor(x.z - shift)};
    return (kernel_place){base, {x.x - base.x, x.y - base.y, x.z - base.z}};
}

/* Rows of four nodes along z begin where a vector of theirs is aligned in the window: with quadratic kernels, which need three nodes, at an even one where a
 * vector holds two. Stores that cross a vector's boundary take two turns, and a quarter of all accesses would cross a cache line. */
SIMD_INLINE bool rows_are_even(kernel_kind kernel) {
    return kernel == KERNEL_QUADRATIC && VEC_LANES == 2 * 4;
}

/* A place that kernel_locate found, along z from the first node of the row. */
SIMD_INLINE kernel_place kernel_row(kernel_kind kernel, kernel_place at) {
    if (!rows_are_even(kernel)) return at;
    vec even = 2 * vec_floor((real)0.5 * at.base.z);
    at.u.z += at.base.z - even, at.base.z = even;
    return at;
}

/* Weights of a row's four nodes, u from kernel_row. */
SIMD_INLINE void kernel_row_weights(kernel_kind kernel, vec u, vec w[4]) {
    if (!rows_are_even(kernel)) {
        kernel_weights(kernel, u, w);
        return;
    }
    vec_mask odd = u >= (real)1.5;
    const vec zero = vec_all(0);
    quadratic_weights(vec_select(odd, u - 1, u), w);
    w[3] = vec_select(odd, w[2], zero), w[2] = vec_select(odd, w[1], w[2]), w[1] = vec_select(odd, w[0], w[1]), w[0] = vec_select(odd, zero, w[0]);
}

/* Index of the first node within the window, as a real (exact: below 1000). */
SIMD_INLINE vec window_index(vec3v base) {
    return (base.x - (real)WINDOW_LOW) * (real)STRIDE_X + (base.y - (real)WINDOW_LOW) * (real)STRIDE_Y + (base.z - (real)WINDOW_LOW);
}

typedef enum row_exchange { ROW_ADD, ROW_LOAD, ROW_PREFETCH } row_exchange;

/* `count` reals of a row: added to the grid, loaded from it, or their cache line called for. Fours are loaded before they are stored: what is
 * exchanged does not overlap, which the compiler cannot know. */
SIMD_INLINE void exchange_reals(real *window, real *grid, int count, row_exchange what) {
    if (what == ROW_PREFETCH) {
        __builtin_prefetch(grid, 1);
        return;
    }
    int fours = count / 4 * 4;
    for (int i = 0; i < fours; i += 4) {
        vec4 in_window, in_grid;
        vec4_load(&in_window, window + i);
        vec4_load(&in_grid, grid + i);
        in_window += in_grid;
        if (what == ROW_ADD) vec4_store(grid + i, &in_window);
        else vec4_store(window + i, &in_grid);
    }
    for (int i = fours; i < count; i++) {
        if (what == ROW_ADD) grid[i] += window[i];
        else window[i] = grid[i];
    }
}

/* Goes through a block's window row by row along z, each in the grid slots of three neighbours. Only −1 … 6 or −2 … 7 is touched: what
 * colouring keeps apart. */
SIMD_INLINE void exchange_rows(const solid_block *b, real *window, real *grid, int reals, int slot_reals, bool wide, row_exchange what) {
    int low = wide ? WINDOW_LOW : WINDOW_LOW + 1, high = wide ? WINDOW_LOW + WINDOW : WINDOW_LOW + WINDOW - 1;
    for (int x = low; x < high; x++)
        for (int y = low; y < high; y++) {
            int slot_x = (x + BLOCK) / BLOCK, slot_y = (y + BLOCK) / BLOCK, row = ((x & (BLOCK - 1)) * BLOCK + (y & (BLOCK - 1))) * BLOCK;
            const int32_t *slot = b->neighbour + (slot_x * 3 + slot_y) * 3;
            real *in_window = window + ((x - WINDOW_LOW) * STRIDE_X + (y - WINDOW_LOW) * STRIDE_Y - WINDOW_LOW) * reals;
            real *in_grid = grid + row * reals;
            if (slot[0] >= 0) exchange_reals(in_window + low * reals, in_grid + (int64_t)slot[0] * slot_reals + (BLOCK + low) * reals, -low * reals, what);
            if (slot[1] >= 0) exchange_reals(in_window, in_grid + (int64_t)slot[1] * slot_reals, BLOCK * reals, what);
            if (slot[2] >= 0) exchange_reals(in_window + BLOCK * reals, in_grid + (int64_t)slot[2] * slot_reals, (high - BLOCK) * reals, what);
        }
}

/* Exchanges a block's window with the grid: `to_grid` adds, else loads. */
SIMD_INLINE void exchange_window(const solid_block *b, real *window, real *grid, int reals, int slot_reals, bool wide, bool to_grid) {
    if (wide) exchange_rows(b, window, grid, reals, slot_reals, true, to_grid ? ROW_ADD : ROW_LOAD);
    else exchange_rows(b, window, grid, reals, slot_reals, false, to_grid ? ROW_ADD : ROW_LOAD);
}

/* A slot's Σ w d and Σ w, side by side, become its nodes' d in a row. */
SIMD_INLINE void damage_from_sums(real *slot) {
    real sums[BLOCK_NODES * DAMAGE_NODE];
    memcpy(sums, slot, sizeof sums);
    for (int n = 0; n < BLOCK_NODES; n++) slot[n] = sums[2 * n + 1] > 0 ? sums[2 * n] / sums[2 * n + 1] : 0;
}

/* Whether a pass with these kernels reaches −2 … 7 rather than −1 … 6. */
SIMD_INLINE bool kernels_are_wide(kernel_kind kernel, kernel_kind laplacian, bool damage) {
    return kernel == KERNEL_CUBIC || (damage && laplacian == KERNEL_CUBIC);
}

#endif
