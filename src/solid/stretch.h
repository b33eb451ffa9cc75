/* Principal stretches on vectors of particles: the singular values of F and their axes, from the symmetric eigen-solver. */
#ifndef SUNDER_SOLID_STRETCH_H
#define SUNDER_SOLID_STRETCH_H

#include "solid/tensor.h"

/* Mᵀ v */
SIMD_INLINE vec3v mat3v_transpose_times(mat3v m, vec3v v) {
    return (vec3v){vec_fma(m.xx, v.x, vec_fma(m.yx, v.y, m.zx * v.z)), vec_fma(m.xy, v.x, vec_fma(m.yy, v.y, m.zy * v.z)),
                   vec_fma(m.xz, v.x, vec_fma(m.yz, v.y, m.zz * v.z))};
}

/* F = Σ n_i (Fᵀ n_i)ᵀ = Σ s_i n_i m_iᵀ */
typedef struct stretch3v {
    vec3v first, second, third;                      /* n_i, orthonormal */
    vec3v pulled_first, pulled_second, pulled_third; /* Fᵀ n_i = s_i m_i */
    vec3v square;                                    /* s_i², not ordered */
} stretch3v;

/* b = F Fᵀ gives the axes. Its eigenvalues would lose stretches below √ε of the largest one; |Fᵀ n|² keeps them to ε. */
SIMD_INLINE void mat3v_stretch_each(const mat3v *F, const sym3v *b, stretch3v *out, int count) {
    eigen3v axes[EIGEN_TOGETHER];
    sym3v_eigen_each(b, axes, count);
    SIMD_UNROLL
    for (int i = 0; i < count; i++) {
        const eigen3v *e = &axes[i];
        stretch3v s = {.first = e->first, .second = e->second, .third = e->third};
        s.pulled_first = mat3v_transpose_times(F[i], e->first);
        s.pulled_second = mat3v_transpose_times(F[i], e->second);
        s.pulled_third = mat3v_transpose_times(F[i], e->third);
        s.square = (vec3v){vec3v_dot(s.pulled_first, s.pulled_first), vec3v_dot(s.pulled_second, s.pulled_second),
                           vec3v_dot(s.pulled_third, s.pulled_third)};
        out[i] = s;
    }
}

SIMD_INLINE stretch3v mat3v_stretch(mat3v F, sym3v b) {
    stretch3v s;
    mat3v_stretch_each(&F, &b, &s, 1);
    return s;
}

#endif
