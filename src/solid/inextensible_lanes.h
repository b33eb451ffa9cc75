/* What the passes over inextensible fibres and the making of their matrix share. */
#ifndef SUNDER_SOLID_INEXTENSIBLE_LANES_H
#define SUNDER_SOLID_INEXTENSIBLE_LANES_H

#include "solid/inextensible.h"
#include "solid/kernels.h"

#define LENGTH_TINY ((real)1e-12)
#define LEAST_J ((real)1e-3)

/* A part of a pack: fibre direction, volume, kernel, and the place between cell centres. */
typedef struct fibre_lanes {
    vec3v a;
    vec stretch, volume;
    kernel_place at;
    vec cell; /* window index of the lowest cell around */
    vec upper[3]; /* weight of the upper cell along each axis */
} fibre_lanes;

SIMD_INLINE fibre_lanes lanes_load(const solid *s, kernel_kind kernel, int32_t pack, int part) {
    fibre_lanes l;
    mat3v F = mat3v_load(&s->fields[FIELD_DEFORMATION], pack, part);
    vec3v a = mat3v_times(F, vec3v_load(&s->fields[s->fibre_field], pack, part));
    l.stretch = vec_sqrt(vec3v_dot(a, a));
    vec inverse = 1 / vec_max(l.stretch, vec_all(LENGTH_TINY));
    l.a = (vec3v){a.x * inverse, a.y * inverse, a.z * inverse};
    l.volume = vec_load(field_at(&s->fields[FIELD_VOLUME], pack, 0, part)) * vec_max(mat3v_determinant(F), vec_all(LEAST_J));
    vec3v x = vec3v_load(&s->fields[FIELD_POSITION], pack, part);
    l.at = kernel_locate(kernel, x);
    vec3v low = {vec_floor(x.x - (real)0.5), vec_floor(x.y - (real)0.5), vec_floor(x.z - (real)0.5)};
    l.cell = window_index(low);
    l.upper[0] = x.x - (real)0.5 - low.x, l.upper[1] = x.y - (real)0.5 - low.y, l.upper[2] = x.z - (real)0.5 - low.z;
    return l;
}

/* Γ of the eight cells around one lane: cell (i, j, k) at window index cell + i STRIDE_X + j STRIDE_Y + k. */
SIMD_INLINE void cell_weights(const fibre_lanes *l, int lane, real weight[8]) {
    real x = l->upper[0][lane], y = l->upper[1][lane], z = l->upper[2][lane];
    real flat[4] = {(1 - x) * (1 - y), (1 - x) * y, x * (1 - y), x * y};
    for (int i = 0; i < 4; i++) weight[2 * i] = flat[i] * (1 - z), weight[2 * i + 1] = flat[i] * z;
}

static const int cell_step[8] = {0, 1, STRIDE_Y, STRIDE_Y + 1, STRIDE_X, STRIDE_X + 1, STRIDE_X + STRIDE_Y, STRIDE_X + STRIDE_Y + 1};

SIMD_INLINE bool tile_is_inextensible(const solid *s, const solid_tile *tile) {
    return s->constraint.material[tile->material];
}

/* Loops over the parts of a block's inextensible tiles: the body sees t (tile), k, pack, part, first (the part's first record). */
#define FOR_EACH_PART(s, b, ...)                                                                                       \
    for (int32_t t_ = (b)->first_tile; t_ < (b)->first_tile + (b)->tile_count; t_++) {                                 \
        const solid_tile *t = &(s)->tiles[t_];                                                                         \
        if (!tile_is_inextensible(s, t)) continue;                                                                     \
        for (int k = 0; k < t->pack_count; k++)                                                                        \
            for (int part = 0; part < PACK_PARTS; part++) {                                                            \
                int32_t pack = t->first_pack + k;                                                                      \
                int first = k * PACK + part * VEC_LANES;                                                               \
                __VA_ARGS__                                                                                            \
            }                                                                                                          \
    }

#define LANES_OF(t, first) ((t)->count - (first) < VEC_LANES ? (t)->count - (first) : VEC_LANES)

/* What a hold leaves of a vector at its node. */
static inline void hold_project(const node_hold *h, double v[3]) {
    if (h->kind == HOLD_FREE || h->kind == HOLD_CANDIDATE) return;
    if (h->kind == HOLD_FIXED || h->kind == HOLD_STUCK) {
        v[0] = v[1] = v[2] = 0;
        return;
    }
    double normal = 0;
    for (int c = 0; c < 3; c++) normal += (double)h->normal[c] * v[c];
    for (int c = 0; c < 3; c++) v[c] -= normal * (double)h->normal[c];
}

#endif
