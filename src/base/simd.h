/* Vectors: the one header that knows instruction sets.
 *
 * A kernel source is compiled once for each precision (SUNDER_PRECISION 32 or 64) and instruction set (SUNDER_SIMD 0 plain,
 * 1 AVX2 + FMA, 2 AVX-512). `vec` holds VEC_LANES reals; arithmetic operators work lane by lane. Plain is portable C (16-byte
 * vectors of the compiler's) and is the twin that the tests compare the others with. Fused multiply-add happens only
 * where vec_fma says so: the same bits on every run of one instruction set. */
#ifndef SUNDER_BASE_SIMD_H
#define SUNDER_BASE_SIMD_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#if SUNDER_PRECISION == 32
typedef float real;
typedef int32_t real_bits;
#elif SUNDER_PRECISION == 64
typedef double real;
typedef int64_t real_bits;
#else
#error "SUNDER_PRECISION must be 32 or 64"
#endif

#if SUNDER_SIMD > 0
#include <immintrin.h>
#endif

#if SUNDER_SIMD == 2
#define VEC_BYTES 64
#elif SUNDER_SIMD == 1
#define VEC_BYTES 32
#else
#define VEC_BYTES 16
#endif

enum { VEC_LANES = VEC_BYTES / (int)sizeof(real), VEC_REGISTERS = VEC_BYTES == 64 ? 32 : 16 };

typedef real vec __attribute__((vector_size(VEC_BYTES)));
typedef real_bits vec_mask __attribute__((vector_size(VEC_BYTES))); /* all ones where true */

#ifdef SUNDER_SANITIZED
#define SIMD_INLINE static inline /* thousands of copies of a sanitizer's checks take minutes a file to compile */
#else
#define SIMD_INLINE static inline __attribute__((always_inline))
#endif

/* Before a short loop of constant length whose arrays are to become registers; compilers leave some of these loops as they are. */
#ifdef __clang__
#define SIMD_UNROLL _Pragma("unroll")
#else
#define SIMD_UNROLL _Pragma("GCC unroll 16")
#endif

SIMD_INLINE vec vec_load(const real *from) {
    vec v;
    memcpy(&v, from, sizeof v);
    return v;
}

SIMD_INLINE void vec_store(real *to, vec v) {
    memcpy(to, &v, sizeof v);
}

SIMD_INLINE vec vec_all(real x) {
    return x - (vec){0};
}

/* a·b + c; fused on AVX2 and AVX-512, two roundings in plain. */
SIMD_INLINE vec vec_fma(vec a, vec b, vec c) {
#if SUNDER_SIMD == 2 && SUNDER_PRECISION == 32
    return _mm512_fmadd_ps(a, b, c);
#elif SUNDER_SIMD == 2
    return _mm512_fmadd_pd(a, b, c);
#elif SUNDER_SIMD == 1 && SUNDER_PRECISION == 32
    return _mm256_fmadd_ps(a, b, c);
#elif SUNDER_SIMD == 1
    return _mm256_fmadd_pd(a, b, c);
#else
    return a * b + c;
#endif
}

SIMD_INLINE vec vec_sqrt(vec a) {
#if SUNDER_SIMD == 2 && SUNDER_PRECISION == 32
    return _mm512_sqrt_ps(a);
#elif SUNDER_SIMD == 2
    return _mm512_sqrt_pd(a);
#elif SUNDER_SIMD == 1 && SUNDER_PRECISION == 32
    return _mm256_sqrt_ps(a);
#elif SUNDER_SIMD == 1
    return _mm256_sqrt_pd(a);
#else
    for (int i = 0; i < VEC_LANES; i++) a[i] = sizeof(real) == 4 ? (real)sqrtf((float)a[i]) : (real)sqrt((double)a[i]);
    return a;
#endif
}

/* where(mask) ? a : b */
SIMD_INLINE vec vec_select(vec_mask mask, vec a, vec b) {
#if SUNDER_SIMD == 1 && SUNDER_PRECISION == 32
    return _mm256_blendv_ps(b, a, (vec)mask);
#elif SUNDER_SIMD == 1
    return _mm256_blendv_pd(b, a, (vec)mask);
#else
    return (vec)(((vec_mask)a & mask) | ((vec_mask)b & ~mask));
#endif
}

/* a > b ? a : b, as the instruction has it. Of a NaN and a number the result is b: callers put the number that must survive second. */
SIMD_INLINE vec vec_max(vec a, vec b) {
#if SUNDER_SIMD == 1 && SUNDER_PRECISION == 32
    return _mm256_max_ps(a, b);
#elif SUNDER_SIMD == 1
    return _mm256_max_pd(a, b);
#else
    return vec_select(a > b, a, b);
#endif
}

SIMD_INLINE vec vec_min(vec a, vec b) {
#if SUNDER_SIMD == 1 && SUNDER_PRECISION == 32
    return _mm256_min_ps(a, b);
#elif SUNDER_SIMD == 1
    return _mm256_min_pd(a, b);
#else
    return vec_select(a < b, a, b);
#endif
}

SIMD_INLINE vec vec_abs(vec a) {
    const vec_mask sign = (vec_mask)vec_all(-(real)0);
    return (vec)((vec_mask)a & ~sign);
}

SIMD_INLINE int vec_any(vec_mask mask) {
#if SUNDER_SIMD == 2 && SUNDER_PRECISION == 32
    return _mm512_movepi32_mask((__m512i)mask) != 0;
#elif SUNDER_SIMD == 2
    return _mm512_movepi64_mask((__m512i)mask) != 0;
#elif SUNDER_SIMD == 1
    return _mm256_movemask_epi8((__m256i)mask) != 0;
#else
    real_bits any = 0;
    for (int i = 0; i < VEC_LANES; i++) any |= mask[i];
    return any != 0;
#endif
}

/* A bit for each lane that is true. */
SIMD_INLINE unsigned vec_bits(vec_mask mask) {
#if SUNDER_SIMD == 2 && SUNDER_PRECISION == 32
    return (unsigned)_mm512_movepi32_mask((__m512i)mask);
#elif SUNDER_SIMD == 2
    return (unsigned)_mm512_movepi64_mask((__m512i)mask);
#elif SUNDER_SIMD == 1 && SUNDER_PRECISION == 32
    return (unsigned)_mm256_movemask_ps((__m256)mask);
#elif SUNDER_SIMD == 1
    return (unsigned)_mm256_movemask_pd((__m256d)mask);
#else
    unsigned bits = 0;
    for (int i = 0; i < VEC_LANES; i++) bits |= (unsigned)(mask[i] != 0) << i;
    return bits;
#endif
}

/* The largest lane; NaN lanes do not win. */
SIMD_INLINE real vec_largest(vec a) {
    real largest = a[0];
    for (int i = 1; i < VEC_LANES; i++) largest = a[i] > largest ? a[i] : largest;
    return largest;
}

/* Rounds towards −∞; lanes must fit a 32-bit integer. */
SIMD_INLINE vec vec_floor(vec a) {
#if SUNDER_SIMD == 2 && SUNDER_PRECISION == 32
    return _mm512_floor_ps(a);
#elif SUNDER_SIMD == 2
    return _mm512_floor_pd(a);
#elif SUNDER_SIMD == 1 && SUNDER_PRECISION == 32
    return _mm256_floor_ps(a);
#elif SUNDER_SIMD == 1
    return _mm256_floor_pd(a);
#else
    for (int i = 0; i < VEC_LANES; i++) {
        real whole = (real)(int32_t)a[i];
        a[i] = whole > a[i] ? whole - 1 : whole;
    }
    return a;
#endif
}

/* One stage of the transposition: rows i and i + half exchange their off-diagonal blocks. */
#define TRANSPOSE_STAGE(half, first_lanes, second_lanes)                                                               \
    for (int i = 0; i < VEC_LANES; i++) {                                                                              \
        if (i & (half)) continue;                                                                                      \
        vec a = rows[i], b = rows[i + (half)];                                                                         \
        rows[i] = __builtin_shufflevector(a, b, first_lanes);                                                          \
        rows[i + (half)] = __builtin_shufflevector(a, b, second_lanes);                                                \
    }
#define LANES(...) __VA_ARGS__

/* Transposes VEC_LANES vectors: lane j of row i becomes lane i of row j. */
SIMD_INLINE void vec_transpose(vec rows[VEC_LANES]) {
#if SUNDER_SIMD == 1 && SUNDER_PRECISION == 32
    /* By interleaving, for which there is one instruction each; TRANSPOSE_STAGE(1) would take two. */
    vec pairs[8], fours[8];
    for (int i = 0; i < 8; i += 2) pairs[i] = _mm256_unpacklo_ps(rows[i], rows[i + 1]), pairs[i + 1] = _mm256_unpackhi_ps(rows[i], rows[i + 1]);
    for (int i = 0; i < 8; i += 4)
        for (int j = 0; j < 2; j++) {
            fours[i + 2 * j] = _mm256_shuffle_ps(pairs[i + j], pairs[i + j + 2], 0x44);
            fours[i + 2 * j + 1] = _mm256_shuffle_ps(pairs[i + j], pairs[i + j + 2], 0xee);
        }
    for (int i = 0; i < 4; i++) {
        rows[i] = _mm256_permute2f128_ps(fours[i], fours[i + 4], 0x20);
        rows[i + 4] = _mm256_permute2f128_ps(fours[i], fours[i + 4], 0x31);
    }
#elif VEC_BYTES == 64 && SUNDER_PRECISION == 32
    TRANSPOSE_STAGE(1, LANES(0, 16, 2, 18, 4, 20, 6, 22, 8, 24, 10, 26, 12, 28, 14, 30), LANES(1, 17, 3, 19, 5, 21, 7, 23, 9, 25, 11, 27, 13, 29, 15, 31))
    TRANSPOSE_STAGE(2, LANES(0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29), LANES(2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31))
    TRANSPOSE_STAGE(4, LANES(0, 1, 2, 3, 16, 17, 18, 19, 8, 9, 10, 11, 24, 25, 26, 27), LANES(4, 5, 6, 7, 20, 21, 22, 23, 12, 13, 14, 15, 28, 29, 30, 31))
    TRANSPOSE_STAGE(8, LANES(0, 1, 2, 3, 4, 5, 6, 7, 16, 17, 18, 19, 20, 21, 22, 23), LANES(8, 9, 10, 11, 12, 13, 14, 15, 24, 25, 26, 27, 28, 29, 30, 31))
#elif VEC_BYTES == 64
    TRANSPOSE_STAGE(1, LANES(0, 8, 2, 10, 4, 12, 6, 14), LANES(1, 9, 3, 11, 5, 13, 7, 15))
    TRANSPOSE_STAGE(2, LANES(0, 1, 8, 9, 4, 5, 12, 13), LANES(2, 3, 10, 11, 6, 7, 14, 15))
    TRANSPOSE_STAGE(4, LANES(0, 1, 2, 3, 8, 9, 10, 11), LANES(4, 5, 6, 7, 12, 13, 14, 15))
#elif VEC_BYTES == 32 || SUNDER_PRECISION == 32
    TRANSPOSE_STAGE(1, LANES(0, 4, 2, 6), LANES(1, 5, 3, 7))
    TRANSPOSE_STAGE(2, LANES(0, 1, 4, 5), LANES(2, 3, 6, 7))
#else
    TRANSPOSE_STAGE(1, LANES(0, 2), LANES(1, 3))
#endif
}

/* Four reals, whatever the width of vec. */
typedef real vec4 __attribute__((vector_size(4 * sizeof(real))));

/* Through pointers: wider vectors than the instruction set has are no values to return. */
SIMD_INLINE void vec4_load(vec4 *to, const real *from) {
#if SUNDER_SIMD > 0 && SUNDER_PRECISION == 32
    *to = _mm_loadu_ps(from);
#elif SUNDER_SIMD > 0
    *to = _mm256_loadu_pd(from); /* as a copy, where `to` is in memory, it would be two halves: whoever reads both waits */
#else
    memcpy(to, from, sizeof *to);
#endif
}

SIMD_INLINE void vec4_store(real *to, const vec4 *from) {
    memcpy(to, from, sizeof *from);
}

/* sum += scale · a, fused where vec_fma is. */
SIMD_INLINE void vec4_add_scaled(vec4 *sum, const vec4 *a, real scale) {
#if SUNDER_SIMD > 0 && SUNDER_PRECISION == 32
    *sum = _mm_fmadd_ps(*a, _mm_set1_ps(scale), *sum);
#elif SUNDER_SIMD > 0
    *sum = _mm256_fmadd_pd(*a, _mm256_set1_pd(scale), *sum);
#else
    *sum += *a * scale;
#endif
}

/* Part of a row of four pairs: as many of its eight reals as one register holds. */
enum { PAIRS = 8, PAIRS_LANES = VEC_LANES < PAIRS ? VEC_LANES : PAIRS };
typedef real vec_pairs __attribute__((vector_size(PAIRS_LANES * sizeof(real))));

SIMD_INLINE vec_pairs pairs_load(const real *from) {
    vec_pairs v;
    memcpy(&v, from, sizeof v);
    return v;
}

SIMD_INLINE void pairs_store(real *to, vec_pairs v) {
    memcpy(to, &v, sizeof v);
}

/* ababab… of a pair. */
SIMD_INLINE vec_pairs pairs_repeat(const real *pair) {
#if SUNDER_SIMD > 0 && SUNDER_PRECISION == 32
    return _mm256_castpd_ps(_mm256_broadcast_sd((const double *)(const void *)pair));
#elif SUNDER_SIMD == 2
    return _mm512_broadcast_f64x2(_mm_loadu_pd(pair));
#elif SUNDER_SIMD == 1
    return _mm256_broadcast_pd((const __m128d *)(const void *)pair);
#else
    vec_pairs v;
    for (int i = 0; i < PAIRS_LANES; i++) v[i] = pair[i % 2];
    return v;
#endif
}

/* aabbccdd, or as much of it as fits. */
SIMD_INLINE vec_pairs pairs_double(const real *from) {
#if SUNDER_SIMD == 1 && SUNDER_PRECISION == 64
    return _mm256_permute4x64_pd(_mm256_castpd128_pd256(_mm_loadu_pd(from)), 0x50);
#elif SUNDER_SIMD > 0
    vec4 v;
    vec4_load(&v, from);
    return __builtin_shufflevector(v, v, 0, 0, 1, 1, 2, 2, 3, 3);
#else
    vec_pairs v;
    for (int i = 0; i < PAIRS_LANES; i++) v[i] = from[i / 2];
    return v;
#endif
}

/* sum + scale · a, fused where vec_fma is. */
SIMD_INLINE vec_pairs pairs_add_scaled(vec_pairs sum, vec_pairs a, real scale) {
#if SUNDER_SIMD > 0 && SUNDER_PRECISION == 32
    return _mm256_fmadd_ps(a, _mm256_set1_ps(scale), sum);
#elif SUNDER_SIMD == 2
    return _mm512_fmadd_pd(a, _mm512_set1_pd(scale), sum);
#elif SUNDER_SIMD == 1
    return _mm256_fmadd_pd(a, _mm256_set1_pd(scale), sum);
#else
    return sum + a * scale;
#endif
}

/* The sum (0 + 2) + (1 + 3) of the lanes. */
SIMD_INLINE real vec4_sum(const vec4 *a) {
    vec4 half = *a + __builtin_shufflevector(*a, *a, 2, 3, 0, 1);
    return half[0] + half[1];
}

/* out = the sums (0 + 2) + (1 + 3) of the lanes of four. */
SIMD_INLINE void vec4_sums(const vec4 *a, const vec4 *b, const vec4 *c, const vec4 *d, vec4 *out) {
    vec4 ab = __builtin_shufflevector(*a, *b, 0, 4, 1, 5) + __builtin_shufflevector(*a, *b, 2, 6, 3, 7);
    vec4 cd = __builtin_shufflevector(*c, *d, 0, 4, 1, 5) + __builtin_shufflevector(*c, *d, 2, 6, 3, 7);
    *out = __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

/* ---- rows: four nodes of four reals, for the transfers ----------------------------------------------------------- */

enum {
    ROW = 16,
    ROW_PARTS = ROW / VEC_LANES,
    /* The nine rows around a particle, and what is added to them, stay in registers. */
    ROWS_FIT_REGISTERS = 9 * ROW_PARTS < VEC_REGISTERS,
};

/* Whether a part of a row holds one of its first nodes. */
SIMD_INLINE int row_needs(int part, int nodes) {
    return part * VEC_LANES < 4 * nodes;
}

typedef struct node_row {
    vec part[ROW_PARTS];
} node_row;

SIMD_INLINE node_row row_load(const real *from) {
    node_row r;
    for (int i = 0; i < ROW_PARTS; i++) r.part[i] = vec_load(from + i * VEC_LANES);
    return r;
}

SIMD_INLINE void row_store(real *to, node_row r) {
    for (int i = 0; i < ROW_PARTS; i++) vec_store(to + i * VEC_LANES, r.part[i]);
}

SIMD_INLINE node_row row_fma(node_row a, node_row b, node_row c) {
    for (int i = 0; i < ROW_PARTS; i++) c.part[i] = vec_fma(a.part[i], b.part[i], c.part[i]);
    return c;
}

SIMD_INLINE node_row row_multiply(node_row a, node_row b) {
    for (int i = 0; i < ROW_PARTS; i++) a.part[i] = a.part[i] * b.part[i];
    return a;
}

SIMD_INLINE node_row row_scale_add(node_row a, real s, node_row c) {
    vec scale = vec_all(s);
    for (int i = 0; i < ROW_PARTS; i++) c.part[i] = vec_fma(a.part[i], scale, c.part[i]);
    return c;
}

SIMD_INLINE node_row row_scale(node_row a, real s) {
    vec scale = vec_all(s);
    for (int i = 0; i < ROW_PARTS; i++) a.part[i] = a.part[i] * scale;
    return a;
}

/* to += s · a in memory, of the first `nodes` of its nodes at least. */
SIMD_INLINE void row_add_scaled_to(real *to, node_row a, real s, int nodes) {
    vec scale = vec_all(s);
    for (int i = 0; i < ROW_PARTS && i * VEC_LANES < 4 * nodes; i++) vec_store(to + i * VEC_LANES, vec_fma(a.part[i], scale, vec_load(to + i * VEC_LANES)));
}

SIMD_INLINE node_row row_add(node_row a, node_row b) {
    for (int i = 0; i < ROW_PARTS; i++) a.part[i] = a.part[i] + b.part[i];
    return a;
}

/* abcd abcd abcd abcd */
SIMD_INLINE node_row row_repeat(const real *four) {
    node_row r;
#if SUNDER_SIMD == 2 && SUNDER_PRECISION == 32
    r.part[0] = _mm512_broadcast_f32x4(_mm_loadu_ps(four));
#elif SUNDER_SIMD == 2
    r.part[0] = r.part[1] = _mm512_broadcast_f64x4(_mm256_loadu_pd(four));
#elif SUNDER_SIMD == 1 && SUNDER_PRECISION == 32
    r.part[0] = r.part[1] = _mm256_broadcast_ps((const __m128 *)(const void *)four);
#elif SUNDER_SIMD == 1
    r.part[0] = r.part[1] = r.part[2] = r.part[3] = _mm256_loadu_pd(four);
#else
    for (int i = 0; i < ROW_PARTS; i++) r.part[i] = vec_load(four + i * VEC_LANES % 4);
#endif
    return r;
}

/* aaaa bbbb cccc dddd */
SIMD_INLINE node_row row_spread(const real *four) {
    node_row r;
#if SUNDER_SIMD == 2 && SUNDER_PRECISION == 32
    const __m512i index = _mm512_set_epi32(3, 3, 3, 3, 2, 2, 2, 2, 1, 1, 1, 1, 0, 0, 0, 0);
    r.part[0] = _mm512_permutexvar_ps(index, _mm512_castps128_ps512(_mm_loadu_ps(four)));
#elif SUNDER_SIMD == 2
    r.part[0] = _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_set1_pd(four[0])), _mm256_set1_pd(four[1]), 1);
    r.part[1] = _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_set1_pd(four[2])), _mm256_set1_pd(four[3]), 1);
#elif SUNDER_SIMD == 1 && SUNDER_PRECISION == 32
    r.part[0] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_set1_ps(four[0])), _mm_set1_ps(four[1]), 1);
    r.part[1] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_set1_ps(four[2])), _mm_set1_ps(four[3]), 1);
#elif SUNDER_SIMD == 1
    for (int i = 0; i < 4; i++) r.part[i] = _mm256_set1_pd(four[i]);
#else
    for (int i = 0; i < ROW_PARTS; i++) r.part[i] = vec_all(four[i * VEC_LANES / 4]);
#endif
    return r;
}

/* Adds the four groups of four of each of four rows: sixteen sums. */
SIMD_INLINE void row_fold(const node_row rows[4], real *sums) {
#if SUNDER_SIMD == 2 && SUNDER_PRECISION == 32
#define FOLD(a, b) _mm512_add_ps(_mm512_shuffle_f32x4(a, b, 0x88), _mm512_shuffle_f32x4(a, b, 0xdd))
    __m512 first = FOLD(rows[0].part[0], rows[1].part[0]), second = FOLD(rows[2].part[0], rows[3].part[0]);
    _mm512_storeu_ps(sums, FOLD(first, second));
#undef FOLD
#elif SUNDER_SIMD == 2
    for (int i = 0; i < 4; i++) {
        __m512d low = rows[i].part[0], high = rows[i].part[1];
        __m256d sum01 = _mm256_add_pd(_mm512_castpd512_pd256(low), _mm512_extractf64x4_pd(low, 1));
        __m256d sum23 = _mm256_add_pd(_mm512_castpd512_pd256(high), _mm512_extractf64x4_pd(high, 1));
        _mm256_storeu_pd(sums + 4 * i, _mm256_add_pd(sum01, sum23));
    }
#elif SUNDER_SIMD == 1 && SUNDER_PRECISION == 32
    for (int i = 0; i < 4; i += 2) {
        __m256 a = _mm256_add_ps(rows[i].part[0], rows[i].part[1]), b = _mm256_add_ps(rows[i + 1].part[0], rows[i + 1].part[1]);
        _mm256_storeu_ps(sums + 4 * i, _mm256_add_ps(_mm256_insertf128_ps(a, _mm256_castps256_ps128(b), 1), _mm256_permute2f128_ps(a, b, 0x31)));
    }
#elif SUNDER_SIMD == 1
    for (int i = 0; i < 4; i++) {
        const vec *part = rows[i].part;
        _mm256_storeu_pd(sums + 4 * i, _mm256_add_pd(_mm256_add_pd(part[0], part[1]), _mm256_add_pd(part[2], part[3])));
    }
#else
    for (int i = 0; i < 4; i++) {
        real all[ROW];
        row_store(all, rows[i]);
        for (int c = 0; c < 4; c++) sums[4 * i + c] = (all[c] + all[4 + c]) + (all[8 + c] + all[12 + c]);
    }
#endif
}

/* ---- gathers ----------------------------------------------------------------------------------------------------- */

/* base[index[i] · stride] of each lane. */
SIMD_INLINE vec vec_gather(const real *base, const int32_t *index, int stride) {
    real lanes[VEC_LANES];
    for (int i = 0; i < VEC_LANES; i++) lanes[i] = base[(int64_t)index[i] * stride];
    return vec_load(lanes);
}

/* ---- quads: four reals of each lane -------------------------------------------------------------------------------
 *
 * In four vectors, as loads of 16 or 32 bytes bring them: lane after lane, in an order that these functions alone know. What is done to two quads element by
 * element needs no turning first. quad_turn makes four vectors of them, one for each component; a load a lane and the turn cost less than four gathers. */

/* From base + index[i] · stride. */
SIMD_INLINE void quad_gather(const real *base, const int32_t *index, int stride, vec quad[4]) {
#define QUAD_LANE(i) (base + (int64_t)index[i] * stride)
#if SUNDER_SIMD == 2 && SUNDER_PRECISION == 32
    for (int k = 0; k < 4; k++) { /* lanes k, k + 4, k + 8, k + 12 */
        __m512 r = _mm512_castps128_ps512(_mm_loadu_ps(QUAD_LANE(k)));
        r = _mm512_insertf32x4(r, _mm_loadu_ps(QUAD_LANE(k + 4)), 1);
        r = _mm512_insertf32x4(r, _mm_loadu_ps(QUAD_LANE(k + 8)), 2);
        quad[k] = _mm512_insertf32x4(r, _mm_loadu_ps(QUAD_LANE(k + 12)), 3);
    }
#elif SUNDER_SIMD == 2
    for (int k = 0; k < 4; k++) { /* lanes 0, 2; 1, 3; 4, 6; 5, 7 */
        int lane = 4 * (k / 2) + k % 2;
        quad[k] = _mm512_insertf64x4(_mm512_castpd256_pd512(_mm256_loadu_pd(QUAD_LANE(lane))), _mm256_loadu_pd(QUAD_LANE(lane + 2)), 1);
    }
#elif SUNDER_SIMD == 1 && SUNDER_PRECISION == 32
    for (int k = 0; k < 4; k++) /* lanes k, k + 4 */
        quad[k] = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(QUAD_LANE(k))), _mm_loadu_ps(QUAD_LANE(k + 4)), 1);
#else
    for (int k = 0; k < 4; k++) quad[k] = vec_load(QUAD_LANE(k % VEC_LANES) + k / VEC_LANES * VEC_LANES);
#endif
#undef QUAD_LANE
}

/* From base + i · stride. */
SIMD_INLINE void quad_load(const real *base, int stride, vec quad[4]) {
    static const int32_t lanes[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    quad_gather(base, lanes, stride, quad);
}

SIMD_INLINE void quad_store(real *base, int stride, const vec quad[4]) {
    for (int k = 0; k < 4; k++) {
#if SUNDER_SIMD == 2 || (SUNDER_SIMD == 1 && SUNDER_PRECISION == 32)
        for (int part = 0; part < VEC_LANES / 4; part++) {
            int lane = SUNDER_PRECISION == 64 ? 4 * (k / 2) + k % 2 + 2 * part : 4 * part + k;
            memcpy(base + (int64_t)lane * stride, (const real *)&quad[k] + 4 * part, 4 * sizeof(real));
        }
#else
        vec_store(base + (int64_t)(k % VEC_LANES) * stride + k / VEC_LANES * VEC_LANES, quad[k]);
#endif
    }
}

/* out[c] holds component c of each lane. */
SIMD_INLINE void quad_turn(const vec quad[4], vec out[4]) {
#if SUNDER_SIMD > 0 && SUNDER_PRECISION == 32
#if SUNDER_SIMD == 2
#define QUAD_OP(name) _mm512_##name
#else
#define QUAD_OP(name) _mm256_##name
#endif
    vec low01 = QUAD_OP(unpacklo_ps)(quad[0], quad[1]), low23 = QUAD_OP(unpacklo_ps)(quad[2], quad[3]);
    vec high01 = QUAD_OP(unpackhi_ps)(quad[0], quad[1]), high23 = QUAD_OP(unpackhi_ps)(quad[2], quad[3]);
    out[0] = QUAD_OP(shuffle_ps)(low01, low23, 0x44);
    out[1] = QUAD_OP(shuffle_ps)(low01, low23, 0xee);
    out[2] = QUAD_OP(shuffle_ps)(high01, high23, 0x44);
    out[3] = QUAD_OP(shuffle_ps)(high01, high23, 0xee);
#undef QUAD_OP
#elif SUNDER_SIMD == 2
    vec even01 = _mm512_unpacklo_pd(quad[0], quad[1]), even23 = _mm512_unpacklo_pd(quad[2], quad[3]);
    vec odd01 = _mm512_unpackhi_pd(quad[0], quad[1]), odd23 = _mm512_unpackhi_pd(quad[2], quad[3]);
    out[0] = _mm512_shuffle_f64x2(even01, even23, 0x88);
    out[1] = _mm512_shuffle_f64x2(odd01, odd23, 0x88);
    out[2] = _mm512_shuffle_f64x2(even01, even23, 0xdd);
    out[3] = _mm512_shuffle_f64x2(odd01, odd23, 0xdd);
#elif SUNDER_SIMD == 1 || SUNDER_PRECISION == 32
    for (int c = 0; c < 4; c++) out[c] = quad[c];
    vec_transpose(out);
#else
    for (int c = 0; c < 4; c += 2) {
        out[c] = __builtin_shufflevector(quad[c], quad[c + 1], 0, 2);
        out[c + 1] = __builtin_shufflevector(quad[c], quad[c + 1], 1, 3);
    }
#endif
}

/* The way back: in[c] holds component c. */
SIMD_INLINE void quad_turn_back(const vec in[4], vec quad[4]) {
#if SUNDER_SIMD == 2 && SUNDER_PRECISION == 64
    vec even01 = __builtin_shufflevector(in[0], in[2], 0, 1, 8, 9, 2, 3, 10, 11), even23 = __builtin_shufflevector(in[0], in[2], 4, 5, 12, 13, 6, 7, 14, 15);
    vec odd01 = __builtin_shufflevector(in[1], in[3], 0, 1, 8, 9, 2, 3, 10, 11), odd23 = __builtin_shufflevector(in[1], in[3], 4, 5, 12, 13, 6, 7, 14, 15);
    quad[0] = _mm512_unpacklo_pd(even01, odd01);
    quad[1] = _mm512_unpackhi_pd(even01, odd01);
    quad[2] = _mm512_unpacklo_pd(even23, odd23);
    quad[3] = _mm512_unpackhi_pd(even23, odd23);
#else
    quad_turn(in, quad); /* its own inverse */
#endif
}

/* Four reals from base + index[i] · stride of each lane: out[c] holds component c. */
SIMD_INLINE void vec_gather4(const real *base, const int32_t *index, int stride, vec out[4]) {
    vec quad[4];
    quad_gather(base, index, stride, quad);
    quad_turn(quad, out);
}

#endif
