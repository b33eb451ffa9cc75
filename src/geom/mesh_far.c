#include "geom/mesh_far.h"

#include "geom/vector.h"

#include <stdint.h>

enum { STRIDE = 8 }; /* cells of the coarsest lattice, a power of two */

/* Cells between the surface and a point that the samples may answer for. */
static const double CLEAR = 2.0;

/* A cell is no larger than √3/2 of its side around its corners. */
static const double CORNER_REACH = 0.8661;

/* Further along samples lose less than this share to single precision. */
static const double ROUNDING = 1e-6;

static int64_t node_at(const mesh_far *f, const int at[3]) {
    return ((int64_t)at[0] * f->nodes[1] + at[1]) * f->nodes[2] + at[2];
}

/* What eight corners say about a place in their cell, as fractions of its side; false when they are too near the
 * surface, or on both sides of it. */
static bool interpolate(const float corner[8], double side, const double fraction[3], double *distance) {
    double least = HUGE_VAL, sum = 0.0;
    int inside = 0;
    for (int k = 0; k < 8; k++) {
        double weight = (k & 4 ? fraction[0] : 1.0 - fraction[0]) * (k & 2 ? fraction[1] : 1.0 - fraction[1]) *
                        (k & 1 ? fraction[2] : 1.0 - fraction[2]);
        double size = fabs((double)corner[k]);
        inside += corner[k] < 0.0f;
        least = size < least ? size : least;
        sum += weight * size;
    }
    if (!(least >= CLEAR * side) || (inside != 0 && inside != 8)) return false;
    double found = sum - side * side / (4.0 * (least - CORNER_REACH * side));
    *distance = inside ? -found : found;
    return true;
}

static void corners_of(const mesh_far *f, const int at[3], int stride, float corner[8]) {
    for (int k = 0; k < 8; k++) {
        int node[3] = {at[0] + (k & 4 ? stride : 0), at[1] + (k & 2 ? stride : 0), at[2] + (k & 1 ? stride : 0)};
        corner[k] = f->value[node_at(f, node)];
    }
}

/* ---- sampling ---------------------------------------------------------------------------------------------------- */

typedef struct far_builder {
    mesh_far *far;
    double (*exact)(const void *context, const double x[3]);
    const void *context;
} far_builder;

static void sample_corners(const far_builder *b, const int at[3], int stride) {
    const mesh_far *f = b->far;
    for (int k = 0; k < 8; k++) {
        int node[3] = {at[0] + (k & 4 ? stride : 0), at[1] + (k & 2 ? stride : 0), at[2] + (k & 1 ? stride : 0)};
        float *value = &f->value[node_at(f, node)];
        if (!isnan(*value)) continue;
        double x[3];
        for (int c = 0; c < 3; c++) x[c] = f->origin[c] + f->spacing * node[c];
        *value = (float)(b->exact(b->context, x) * (1.0 - ROUNDING));
    }
}

/* Gives the nodes of a cell far from the surface what its corners say; those that have a value keep it. */
static void fill_cell(const far_builder *b, const int at[3], int stride, const float corner[8]) {
    const mesh_far *f = b->far;
    for (int i = 0; i <= stride; i++)
        for (int j = 0; j <= stride; j++)
            for (int k = 0; k <= stride; k++) {
                int node[3] = {at[0] + i, at[1] + j, at[2] + k};
                float *value = &f->value[node_at(f, node)];
                double fraction[3] = {(double)i / stride, (double)j / stride, (double)k / stride}, distance = 0.0;
                if (!isnan(*value)) continue;
                interpolate(corner, stride * f->spacing, fraction, &distance);
                *value = (float)(distance * (1.0 - ROUNDING));
            }
}

/* Samples a cell's corners, and its inside as finely as its distance from the surface asks for. */
static void sample_cell(const far_builder *b, const int at[3], int stride) {
    static const double middle[3] = {0.5, 0.5, 0.5};
    float corner[8];
    double distance;
    sample_corners(b, at, stride);
    if (stride == 1) return;
    corners_of(b->far, at, stride, corner);
    if (interpolate(corner, stride * b->far->spacing, middle, &distance)) {
        fill_cell(b, at, stride, corner);
        return;
    }
    int half = stride / 2;
    for (int k = 0; k < 8; k++) {
        int child[3] = {at[0] + (k & 4 ? half : 0), at[1] + (k & 2 ? half : 0), at[2] + (k & 1 ? half : 0)};
        sample_cell(b, child, half);
    }
}

bool mesh_far_create(arena *a, const double low[3], const double high[3], int cells,
                     double (*exact)(const void *context, const double x[3]), const void *context, mesh_far *out) {
    double longest = 0.0;
    for (int c = 0; c < 3; c++) longest = fmax(longest, high[c] - low[c]);
    *out = (mesh_far){.spacing = longest / cells};
    int64_t total = 1;
    for (int c = 0; c < 3; c++) {
        /* Room on both sides, so that whatever lies outside the lattice is far. */
        int wanted = (int)ceil((high[c] - low[c]) / out->spacing + 2.0 * (CLEAR + 2.0));
        int rounded = (wanted + STRIDE - 1) / STRIDE * STRIDE;
        out->nodes[c] = rounded + 1;
        out->origin[c] = 0.5 * (low[c] + high[c]) - 0.5 * rounded * out->spacing;
        total *= out->nodes[c];
    }
    out->value = arena_allocate(a, (size_t)total * sizeof *out->value);
    if (!out->value) return false;
    for (int64_t i = 0; i < total; i++) out->value[i] = NAN;
    far_builder b = {out, exact, context};
    for (int i = 0; i + 1 < out->nodes[0]; i += STRIDE)
        for (int j = 0; j + 1 < out->nodes[1]; j += STRIDE)
            for (int k = 0; k + 1 < out->nodes[2]; k += STRIDE) sample_cell(&b, (int[3]){i, j, k}, STRIDE);
    return true;
}

/* ---- asking ------------------------------------------------------------------------------------------------------ */

/* Outside the lattice the way to the mesh leads through the nearest point of the lattice's box, y, and turns there by a
 * right angle at most: |x − p|² ≥ |x − y|² + |y − p|². */
bool mesh_far_distance(const mesh_far *f, const double x[3], double *distance) {
    double fraction[3], outside = 0.0;
    int at[3];
    for (int c = 0; c < 3; c++) {
        double place = (x[c] - f->origin[c]) / f->spacing, end = f->nodes[c] - 1, held = place >= end ? end : place > 0.0 ? place : 0.0;
        outside += (place - held) * (place - held);
        at[c] = held < end ? (int)held : f->nodes[c] - 2;
        fraction[c] = held - at[c];
    }
    float corner[8];
    corners_of(f, at, 1, corner);
    if (!interpolate(corner, f->spacing, fraction, distance)) return false;
    if (outside > 0.0) *distance = hypot(*distance, f->spacing * sqrt(outside));
    return true;
}
