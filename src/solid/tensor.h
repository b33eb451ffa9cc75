/* Small tensors on vectors of particles: nine or six named components, never arrays of vectors, so that they stay in
 * registers. */
#ifndef SUNDER_SOLID_TENSOR_H
#define SUNDER_SOLID_TENSOR_H

#include "solid/state.h"

typedef struct mat3v {
    vec xx, xy, xz, yx, yy, yz, zx, zy, zz;
} mat3v;

typedef struct sym3v {
    vec xx, yy, zz, xy, yz, xz;
} sym3v;

typedef struct vec3v {
    vec x, y, z;
} vec3v;

SIMD_INLINE mat3v mat3v_load(const solid_field *f, int32_t pack, int part) {
    return (mat3v){vec_load(field_at(f, pack, 0, part)), vec_load(field_at(f, pack, 1, part)),
                   vec_load(field_at(f, pack, 2, part)), vec_load(field_at(f, pack, 3, part)),
                   vec_load(field_at(f, pack, 4, part)), vec_load(field_at(f, pack, 5, part)),
                   vec_load(field_at(f, pack, 6, part)), vec_load(field_at(f, pack, 7, part)),
                   vec_load(field_at(f, pack, 8, part))};
}

SIMD_INLINE void mat3v_store(const solid_field *f, int32_t pack, int part, mat3v m) {
    vec_store(field_at(f, pack, 0, part), m.xx);
    vec_store(field_at(f, pack, 1, part), m.xy);
    vec_store(field_at(f, pack, 2, part), m.xz);
    vec_store(field_at(f, pack, 3, part), m.yx);
    vec_store(field_at(f, pack, 4, part), m.yy);
    vec_store(field_at(f, pack, 5, part), m.yz);
    vec_store(field_at(f, pack, 6, part), m.zx);
    vec_store(field_at(f, pack, 7, part), m.zy);
    vec_store(field_at(f, pack, 8, part), m.zz);
}

SIMD_INLINE vec3v vec3v_load(const solid_field *f, int32_t pack, int part) {
    return (vec3v){vec_load(field_at(f, pack, 0, part)), vec_load(field_at(f, pack, 1, part)),
                   vec_load(field_at(f, pack, 2, part))};
}

SIMD_INLINE void vec3v_store(const solid_field *f, int32_t pack, int part, vec3v v) {
    vec_store(field_at(f, pack, 0, part), v.x);
    vec_store(field_at(f, pack, 1, part), v.y);
    vec_store(field_at(f, pack, 2, part), v.z);
}

SIMD_INLINE vec vec3v_dot(vec3v a, vec3v b) {
    return vec_fma(a.x, b.x, vec_fma(a.y, b.y, a.z * b.z));
}

SIMD_INLINE vec3v vec3v_cross(vec3v a, vec3v b) {
    return (vec3v){vec_fma(a.y, b.z, -(a.z * b.y)), vec_fma(a.z, b.x, -(a.x * b.z)), vec_fma(a.x, b.y, -(a.y * b.x))};
}

SIMD_INLINE vec3v vec3v_select(vec_mask mask, vec3v a, vec3v b) {
    return (vec3v){vec_select(mask, a.x, b.x), vec_select(mask, a.y, b.y), vec_select(mask, a.z, b.z)};
}

SIMD_INLINE vec3v vec3v_scale(vec s, vec3v a) {
    return (vec3v){s * a.x, s * a.y, s * a.z};
}

SIMD_INLINE vec3v mat3v_times(mat3v m, vec3v v) {
    return (vec3v){vec_fma(m.xx, v.x, vec_fma(m.xy, v.y, m.xz * v.z)), vec_fma(m.yx, v.x, vec_fma(m.yy, v.y, m.yz * v.z)),
                   vec_fma(m.zx, v.x, vec_fma(m.zy, v.y, m.zz * v.z))};
}

SIMD_INLINE vec mat3v_determinant(mat3v m) {
    vec cx = vec_fma(m.yy, m.zz, -(m.yz * m.zy));
    vec cy = vec_fma(m.yz, m.zx, -(m.yx * m.zz));
    vec cz = vec_fma(m.yx, m.zy, -(m.yy * m.zx));
    return vec_fma(m.xx, cx, vec_fma(m.xy, cy, m.xz * cz));
}

/* J F⁻ᵀ without a division: defined for every F. */
SIMD_INLINE mat3v mat3v_cofactor(mat3v m) {
    return (mat3v){
        .xx = vec_fma(m.yy, m.zz, -(m.yz * m.zy)), .xy = vec_fma(m.yz, m.zx, -(m.yx * m.zz)), .xz = vec_fma(m.yx, m.zy, -(m.yy * m.zx)),
        .yx = vec_fma(m.zy, m.xz, -(m.zz * m.xy)), .yy = vec_fma(m.zz, m.xx, -(m.zx * m.xz)), .yz = vec_fma(m.zx, m.xy, -(m.zy * m.xx)),
        .zx = vec_fma(m.xy, m.yz, -(m.xz * m.yy)), .zy = vec_fma(m.xz, m.yx, -(m.xx * m.yz)), .zz = vec_fma(m.xx, m.yy, -(m.xy * m.yx)),
    };
}

SIMD_INLINE vec mat3v_square_sum(mat3v m) {
    vec x = vec_fma(m.xx, m.xx, vec_fma(m.xy, m.xy, m.xz * m.xz)), y = vec_fma(m.yx, m.yx, vec_fma(m.yy, m.yy, m.yz * m.yz));
    return x + y + vec_fma(m.zx, m.zx, vec_fma(m.zy, m.zy, m.zz * m.zz));
}

/* Nine components at `base` [TILE_PACKS][9][PACK] += a A + b B. */
SIMD_INLINE void mat3v_add_to(real *base, int k, int part, vec a, mat3v A, vec b, mat3v B) {
    const vec first[9] = {A.xx, A.xy, A.xz, A.yx, A.yy, A.yz, A.zx, A.zy, A.zz};
    const vec second[9] = {B.xx, B.xy, B.xz, B.yx, B.yy, B.yz, B.zx, B.zy, B.zz};
    for (int c = 0; c < 9; c++) {
        real *to = scratch_at(base, 9, k, c, part);
        vec_store(to, vec_fma(a, first[c], vec_fma(b, second[c], vec_load(to))));
    }
}

/* A bound of the spectral norm of ∂(cof F)/∂F = ∂²J/∂F²: its eigenvalues are ± the singular values of F, and those of a symmetric tensor without
 * trace and of norm √2 |F|, none of which exceeds √⅔ of that norm. */
SIMD_INLINE vec mat3v_cofactor_slope(mat3v m) {
    return (real)1.1547005383792515 * vec_sqrt(mat3v_square_sum(m));
}

/* M Mᵀ */
SIMD_INLINE sym3v mat3v_gram(mat3v m) {
    return (sym3v){
        .xx = vec_fma(m.xx, m.xx, vec_fma(m.xy, m.xy, m.xz * m.xz)),
        .yy = vec_fma(m.yx, m.yx, vec_fma(m.yy, m.yy, m.yz * m.yz)),
        .zz = vec_fma(m.zx, m.zx, vec_fma(m.zy, m.zy, m.zz * m.zz)),
        .xy = vec_fma(m.xx, m.yx, vec_fma(m.xy, m.yy, m.xz * m.yz)),
        .yz = vec_fma(m.yx, m.zx, vec_fma(m.yy, m.zy, m.yz * m.zz)),
        .xz = vec_fma(m.xx, m.zx, vec_fma(m.xy, m.zy, m.xz * m.zz)),
    };
}

/* An upper bound of the largest eigenvalue of a positive semi-definite tensor: the lesser of trace and largest row sum. */
SIMD_INLINE vec sym3v_largest_bound(sym3v s) {
    vec xy = vec_abs(s.xy), yz = vec_abs(s.yz), xz = vec_abs(s.xz);
    vec rows = vec_max(vec_max(s.xx + xy + xz, s.yy + xy + yz), s.zz + yz + xz);
    return vec_min(rows, s.xx + s.yy + s.zz);
}

SIMD_INLINE vec sym3v_square_sum(sym3v s) {
    vec off = vec_fma(s.xy, s.xy, vec_fma(s.yz, s.yz, s.xz * s.xz));
    return vec_fma(s.xx, s.xx, vec_fma(s.yy, s.yy, vec_fma(s.zz, s.zz, off + off)));
}

typedef struct eigen3v {
    vec3v value;          /* not ordered */
    vec3v first, second, third; /* unit eigenvectors of value.x, .y, .z */
} eigen3v;

/* One Jacobi rotation that annihilates the element pq (Golub & Van Loan §8.5): t = tan of the smaller angle, written
 * without a division by the element, so that a zero element costs nothing and breaks nothing. */
#define JACOBI_ROTATE(pp, qq, pq, pr, qr, vp, vq)                                                                      \
    do {                                                                                                               \
        vec theta2 = (qq) - (pp), element2 = (pq) + (pq);                                                              \
        vec root = vec_sqrt(vec_fma(theta2, theta2, element2 * element2));                                            \
        vec sign = vec_select(theta2 < 0, vec_all(-1), vec_all(1));                                                    \
        vec down = vec_fma(sign, theta2, root);                                                                        \
        vec t = sign * element2 / vec_max(down, vec_all((real)JACOBI_TINY));                                           \
        vec c = 1 / vec_sqrt(vec_fma(t, t, vec_all(1))), s = t * c;                                                   \
        vec shift = t * (pq);                                                                                          \
        (pp) = (pp) - shift;                                                                                           \
        (qq) = (qq) + shift;                                                                                           \
        (pq) = vec_all(0);                                                                                             \
        vec old_pr = (pr), old_qr = (qr);                                                                              \
        (pr) = vec_fma(c, old_pr, -(s * old_qr));                                                                      \
        (qr) = vec_fma(s, old_pr, c * old_qr);                                                                         \
        vec3v old_p = (vp), old_q = (vq);                                                                              \
        (vp).x = vec_fma(c, old_p.x, -(s * old_q.x));                                                                  \
        (vq).x = vec_fma(s, old_p.x, c * old_q.x);                                                                     \
        (vp).y = vec_fma(c, old_p.y, -(s * old_q.y));                                                                  \
        (vq).y = vec_fma(s, old_p.y, c * old_q.y);                                                                     \
        (vp).z = vec_fma(c, old_p.z, -(s * old_q.z));                                                                  \
        (vq).z = vec_fma(s, old_p.z, c * old_q.z);                                                                     \
    } while (0)

#if SUNDER_PRECISION == 32
#define JACOBI_TINY 1e-30
enum { JACOBI_SWEEPS = 4 };
#else
#define JACOBI_TINY 1e-290
enum { JACOBI_SWEEPS = 5 };
#endif

/* Eigenvalues and orthonormal eigenvectors of a symmetric tensor by cyclic Jacobi: exact for repeated and nearly repeated
 * eigenvalues alike, where closed forms and non-symmetric solvers fail (FACTS.md §1). */
SIMD_INLINE eigen3v sym3v_eigen(sym3v a) {
    vec one = vec_all(1), zero = vec_all(0);
    vec3v p = {one, zero, zero}, q = {zero, one, zero}, r = {zero, zero, one};
    for (int sweep = 0; sweep < JACOBI_SWEEPS; sweep++) {
        JACOBI_ROTATE(a.xx, a.yy, a.xy, a.xz, a.yz, p, q);
        JACOBI_ROTATE(a.xx, a.zz, a.xz, a.xy, a.yz, p, r);
        JACOBI_ROTATE(a.yy, a.zz, a.yz, a.xy, a.xz, q, r);
    }
    return (eigen3v){{a.xx, a.yy, a.zz}, p, q, r};
}

#endif
