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

SIMD_INLINE mat3v mat3v_scale(vec s, mat3v m) {
    return (mat3v){s * m.xx, s * m.xy, s * m.xz, s * m.yx, s * m.yy, s * m.yz, s * m.zx, s * m.zy, s * m.zz};
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

SIMD_INLINE vec3v sym3v_times(sym3v s, vec3v n) {
    return (vec3v){vec_fma(s.xx, n.x, vec_fma(s.xy, n.y, s.xz * n.z)), vec_fma(s.xy, n.x, vec_fma(s.yy, n.y, s.yz * n.z)),
                   vec_fma(s.xz, n.x, vec_fma(s.yz, n.y, s.zz * n.z))};
}

/* Six components at `base` [TILE_PACKS][6][PACK] += a S. */
SIMD_INLINE void sym3v_add_to(real *base, int k, int part, vec a, sym3v S) {
    const vec value[6] = {S.xx, S.yy, S.zz, S.xy, S.yz, S.xz};
    for (int c = 0; c < 6; c++) {
        real *to = scratch_at(base, 6, k, c, part);
        vec_store(to, vec_fma(a, value[c], vec_load(to)));
    }
}

SIMD_INLINE sym3v sym3v_scratch(real *base, int k, int part) {
    return (sym3v){vec_load(scratch_at(base, 6, k, 0, part)), vec_load(scratch_at(base, 6, k, 1, part)), vec_load(scratch_at(base, 6, k, 2, part)),
                   vec_load(scratch_at(base, 6, k, 3, part)), vec_load(scratch_at(base, 6, k, 4, part)), vec_load(scratch_at(base, 6, k, 5, part))};
}

/* The largest eigenvalue of a positive semi-definite tensor, from above by at most 1.4 %: m + 2 p h, m the mean, 6 p² = |S − m I|², and
 * h = cos(acos(r)/3) with r = det(S − m I)/(2p³). h is concave: its tangents, at r = 1, 0, −0.6, −0.9 and −0.99, bound it from above. */
SIMD_INLINE vec sym3v_largest(sym3v s) {
    vec mean = (s.xx + s.yy + s.zz) * (real)(1.0 / 3);
    vec x = s.xx - mean, y = s.yy - mean, z = s.zz - mean;
    vec off = vec_fma(s.xy, s.xy, vec_fma(s.yz, s.yz, s.xz * s.xz));
    vec p = vec_sqrt(vec_fma(x, x, vec_fma(y, y, vec_fma(z, z, off + off))) * (real)(1.0 / 6));
    vec inverse = 1 / vec_max(p, mean * (real)1e-6 + (real)1e-30);
    x *= inverse, y *= inverse, z *= inverse;
    vec xy = s.xy * inverse, yz = s.yz * inverse, xz = s.xz * inverse;
    vec det = x * vec_fma(y, z, -(yz * yz)) - xy * vec_fma(xy, z, -(yz * xz)) + xz * vec_fma(xy, yz, -(y * xz));
    vec r = vec_min(vec_max((real)0.5 * det, vec_all(-1)), vec_all(1));
    vec h = vec_fma(vec_all((real)0.1111111), r, vec_all((real)0.8888891));
    h = vec_min(h, vec_fma(vec_all((real)0.1666667), r, vec_all((real)0.8660256)));
    h = vec_min(h, vec_fma(vec_all((real)0.2803679), r, vec_all((real)0.9079699)));
    h = vec_min(h, vec_fma(vec_all((real)0.5975272), r, vec_all((real)1.1618449)));
    h = vec_min(h, vec_fma(vec_all((real)1.9883659), r, vec_all((real)2.5087698)));
    return vec_fma(p + p, h, mean);
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

#if SUNDER_PRECISION == 32
#define EIGEN_TINY 1e-30
enum { EIGEN_NEWTON = 1 };
#else
#define EIGEN_TINY 1e-290
enum { EIGEN_NEWTON = 2 };
#endif

/* The largest root of β³ − 3β − 2r, r in [0, 1]: a cubic through the Chebyshev points, to 8e-5, and Newton's steps: 6e-9, 7e-16. */
SIMD_INLINE vec largest_root(vec r) {
    vec root = vec_fma(r, vec_all((real)0.01863937), vec_all((real)-0.08138239));
    root = vec_fma(vec_fma(root, r, vec_all((real)0.33066070)), r, vec_all((real)1.73213266));
    for (int i = 0; i < EIGEN_NEWTON; i++) {
        vec square = root * root;
        root = vec_fma(2 * root, square, 2 * r) / vec_fma(vec_all(3), square, vec_all(-3));
    }
    return root;
}

/* A right-handed orthonormal frame of a unit vector, without a branch (Duff et al. 2017). */
SIMD_INLINE void vec3v_frame(vec3v n, vec3v *u, vec3v *w) {
    vec sign = vec_select(n.z < 0, vec_all(-1), vec_all(1)), a = -1 / (sign + n.z), b = n.x * n.y * a, flat = sign * n.x;
    *u = (vec3v){vec_fma(flat * n.x, a, vec_all(1)), sign * b, -flat};
    *w = (vec3v){b, vec_fma(n.y * n.y, a, sign), -n.y};
}

/* The longest of the columns of the adjugate of a tensor of rank two: along the axis that it maps to zero. */
SIMD_INLINE vec3v sym3v_null_axis(sym3v m) {
    sym3v adjugate = {vec_fma(m.yy, m.zz, -(m.yz * m.yz)), vec_fma(m.xx, m.zz, -(m.xz * m.xz)), vec_fma(m.xx, m.yy, -(m.xy * m.xy)),
                      vec_fma(m.xz, m.yz, -(m.xy * m.zz)), vec_fma(m.xy, m.xz, -(m.yz * m.xx)), vec_fma(m.xy, m.yz, -(m.xz * m.yy))};
    vec3v n = {adjugate.xx, adjugate.xy, adjugate.xz}, second = {adjugate.xy, adjugate.yy, adjugate.yz},
          third = {adjugate.xz, adjugate.yz, adjugate.zz};
    vec_mask longer = adjugate.yy > adjugate.xx;
    n = vec3v_select(longer, second, n);
    n = vec3v_select(adjugate.zz > vec_max(adjugate.xx, adjugate.yy), third, n);
    return vec3v_scale(1 / vec_sqrt(vec3v_dot(n, n)), n);
}

/* Eigenvalues and orthonormal eigenvectors of a symmetric tensor by deflation (Eberly 2014): of B = ±(A − q I)/p, of which q I is A's
 * mean and p scales it so that β = 2 cos(acos(r)/3) is the largest eigenvalue, r = det B/2, the sign such that r ≥ 0. β then lies in [√3, 2] and
 * at least √3 from both others, so its vector is as good as A's own digits, and a plane rotation parts the other two. So repeated and nearly
 * repeated eigenvalues are exact, where closed forms for all three and non-symmetric solvers fail (FACTS.md §1). Nothing iterates: a third of the
 * operations of cyclic Jacobi, and a chain of ten divisions and roots instead of 48. */
typedef struct eigen_work {
    sym3v B;
    vec mean, scale;
    vec3v n, u, w;
    vec uu, ww, uw; /* B in the plane of u and w */
} eigen_work;

SIMD_INLINE void eigen_scale(sym3v a, eigen_work *e) {
    vec mean = (a.xx + a.yy + a.zz) * (real)(1.0 / 3.0);
    sym3v B = {a.xx - mean, a.yy - mean, a.zz - mean, a.xy, a.yz, a.xz};
    vec scale = vec_sqrt(sym3v_square_sum(B) * (real)(1.0 / 6.0)), inverse = 1 / vec_max(scale, vec_all((real)EIGEN_TINY));
    e->B = (sym3v){B.xx * inverse, B.yy * inverse, B.zz * inverse, B.xy * inverse, B.yz * inverse, B.xz * inverse};
    e->mean = mean, e->scale = scale;
}

SIMD_INLINE vec eigen_root(sym3v B) {
    vec minor_x = vec_fma(B.yy, B.zz, -(B.yz * B.yz)), minor_y = vec_fma(B.xz, B.yz, -(B.xy * B.zz)), minor_z = vec_fma(B.xy, B.yz, -(B.xz * B.yy));
    vec half = (real)0.5 * vec_fma(B.xx, minor_x, vec_fma(B.xy, minor_y, B.xz * minor_z));
    vec root = largest_root(vec_min(vec_abs(half), vec_all(1)));
    return vec_select(half < 0, -root, root);
}

SIMD_INLINE void eigen_axis(eigen_work *e) {
    sym3v B = e->B;
    vec alone = eigen_root(B);
    e->n = sym3v_null_axis((sym3v){B.xx - alone, B.yy - alone, B.zz - alone, B.xy, B.yz, B.xz});
}

SIMD_INLINE void eigen_plane(eigen_work *e) {
    vec3v_frame(e->n, &e->u, &e->w);
    vec3v Bu = sym3v_times(e->B, e->u), Bw = sym3v_times(e->B, e->w);
    e->uu = vec3v_dot(e->u, Bu), e->ww = vec3v_dot(e->w, Bw), e->uw = vec3v_dot(e->w, Bu);
}

/* t = tan of the smaller angle that makes uw zero, written without a division by it, so that a zero breaks nothing. */
SIMD_INLINE eigen3v eigen_turn(const eigen_work *e) {
    vec apart = e->ww - e->uu, twice = e->uw + e->uw;
    vec down = vec_fma(apart, apart, twice * twice);
    vec t = vec_select(apart < 0, -twice, twice) / vec_max(vec_abs(apart) + vec_sqrt(down), vec_all((real)EIGEN_TINY));
    vec c = 1 / vec_sqrt(vec_fma(t, t, vec_all(1))), s = t * c, shift = t * e->uw;
    vec3v u = e->u, w = e->w;
    return (eigen3v){
        {vec_fma(e->scale, -(e->uu + e->ww), e->mean), vec_fma(e->scale, e->uu - shift, e->mean), vec_fma(e->scale, e->ww + shift, e->mean)},
        e->n,
        {vec_fma(c, u.x, -(s * w.x)), vec_fma(c, u.y, -(s * w.y)), vec_fma(c, u.z, -(s * w.z))},
        {vec_fma(s, u.x, c * w.x), vec_fma(s, u.y, c * w.y), vec_fma(s, u.z, c * w.z)}};
}

/* How many vectors of tensors are best decomposed side by side. The chain of divisions and roots is longer than a processor sees ahead, so a second one, step by
 * step, takes place in its shadow. */
enum { EIGEN_TOGETHER = VEC_BYTES == 64 ? 1 : 2 };

SIMD_INLINE void sym3v_eigen_each(const sym3v *a, eigen3v *out, int count) {
    eigen_work e[EIGEN_TOGETHER];
    SIMD_UNROLL
    for (int i = 0; i < count; i++) eigen_scale(a[i], &e[i]);
    SIMD_UNROLL
    for (int i = 0; i < count; i++) eigen_axis(&e[i]);
    SIMD_UNROLL
    for (int i = 0; i < count; i++) eigen_plane(&e[i]);
    SIMD_UNROLL
    for (int i = 0; i < count; i++) out[i] = eigen_turn(&e[i]);
}

SIMD_INLINE eigen3v sym3v_eigen(sym3v a) {
    eigen3v e;
    sym3v_eigen_each(&a, &e, 1);
    return e;
}

#endif
