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

/* Second derivatives of the same. */
SIMD_INLINE void quadratic_curvatures(vec w[4]) {
    w[0] = vec_all(1);
    w[1] = vec_all(-2);
    w[2] = vec_all(1);
    w[3] = vec_all(0);
}

SIMD_INLINE void cubic_curvatures(vec u, vec w[4]) {
    vec t = u - 1, s = 1 - t;
    w[0] = s;
    w[1] = 3 * t - 2;
    w[2] = 3 * s - 2;
    w[3] = t;
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

/* Index of the first node within the window, as a real (exact: below 1000). */
SIMD_INLINE vec window_index(vec3v base) {
    return (base.x - (real)WINDOW_LOW) * (real)STRIDE_X + (base.y - (real)WINDOW_LOW) * (real)STRIDE_Y + (base.z - (real)WINDOW_LOW);
}

/* Exchanges a block's window with the grid, node row by node row: `to_grid` adds, else loads. Only −1 … 6 or −2 … 7 is
 * touched: what colouring keeps apart. */
SIMD_INLINE void exchange_window(const solid_block *b, real *window, real *grid, int reals, int slot_reals, bool wide, bool to_grid) {
    int low = wide ? WINDOW_LOW : WINDOW_LOW + 1, high = wide ? WINDOW_LOW + WINDOW : WINDOW_LOW + WINDOW - 1;
    for (int n = 0; n < NEIGHBOURS; n++) {
        if (b->neighbour[n] < 0) continue;
        int begin[3], end[3], o[3] = {n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1};
        for (int c = 0; c < 3; c++) {
            begin[c] = o[c] * BLOCK > low ? o[c] * BLOCK : low;
            end[c] = o[c] * BLOCK + BLOCK < high ? o[c] * BLOCK + BLOCK : high;
        }
        real *slot = grid + (int64_t)b->neighbour[n] * slot_reals;
        for (int x = begin[0]; x < end[0]; x++)
            for (int y = begin[1]; y < end[1]; y++) {
                real *in_window = window + (((x - WINDOW_LOW) * WINDOW + y - WINDOW_LOW) * WINDOW + begin[2] - WINDOW_LOW) * reals;
                real *in_grid = slot + ((x - o[0] * BLOCK) * BLOCK * BLOCK + (y - o[1] * BLOCK) * BLOCK + begin[2] - o[2] * BLOCK) * reals;
                int count = (end[2] - begin[2]) * reals;
                if (to_grid)
                    for (int i = 0; i < count; i++) in_grid[i] += in_window[i];
                else
                    for (int i = 0; i < count; i++) in_window[i] = in_grid[i];
            }
    }
}

/* Whether a pass with these kernels reaches −2 … 7 rather than −1 … 6. */
SIMD_INLINE bool kernels_are_wide(kernel_kind kernel, kernel_kind laplacian, bool damage) {
    return kernel == KERNEL_CUBIC || (damage && laplacian == KERNEL_CUBIC);
}

#endif
