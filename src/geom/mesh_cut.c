/* Cutting triangles whose sides are too long: a side is cut or not by its own length alone, so neighbours agree. */
#include "geom/mesh_build.h"

#include "base/compare.h"

#include <stdlib.h>
#include <string.h>

enum { PASSES = 40 };

/* A triangle's worth of memory, times this, is enough. */
static const int64_t TRIANGLE_LIMIT = 1 << 27;

static double side_square(const mesh *m, int32_t a, int32_t b) {
    double sum = 0;
    for (int c = 0; c < 3; c++) {
        double d = m->vertex[3 * (int64_t)a + c] - m->vertex[3 * (int64_t)b + c];
        sum += d * d;
    }
    return sum;
}

static uint64_t side_key(int32_t a, int32_t b) {
    return a < b ? (uint64_t)a << 32 | (uint32_t)b : (uint64_t)b << 32 | (uint32_t)a;
}

/* The sides to be cut, sorted, each once; how many. */
static int64_t collect(const mesh *m, double square, uint64_t *keys) {
    int64_t found = 0, kept = 0;
    for (int64_t t = 0; t < m->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            int32_t a = m->triangle[3 * t + k], b = m->triangle[3 * t + (k + 1) % 3];
            if (side_square(m, a, b) > square) keys[found++] = side_key(a, b);
        }
    qsort(keys, (size_t)found, sizeof *keys, compare_u64);
    for (int64_t i = 0; i < found; i++)
        if (i == 0 || keys[i] != keys[i - 1]) keys[kept++] = keys[i];
    return kept;
}

/* The new vertex in the middle of a side, −1 where it is not cut. */
static int64_t middle_of(const uint64_t *keys, int64_t count, int64_t first, int32_t a, int32_t b) {
    uint64_t key = side_key(a, b);
    const uint64_t *found = bsearch(&key, keys, (size_t)count, sizeof *keys, compare_u64);
    return found ? first + (found - keys) : -1;
}

/* Two, three or four triangles for one: the first in its place, the others at the end. */
static status cut_triangle(mesh *m, int64_t t, const int64_t middle[3], report *r) {
    int cuts = (middle[0] >= 0) + (middle[1] >= 0) + (middle[2] >= 0), turn = 0;
    if (cuts == 0) return STATUS_OK;
    /* Turn it so that with one cut it is side 0, with two sides 0 and 1. */
    while (cuts < 3 && !(middle[turn] >= 0 && (cuts == 1 || middle[(turn + 1) % 3] >= 0))) turn++;
    int64_t c[3], h[3];
    for (int k = 0; k < 3; k++) c[k] = m->triangle[3 * t + (k + turn) % 3], h[k] = middle[(k + turn) % 3];
    int64_t parts[4][3] = {{c[0], h[0], c[2]}, {h[0], c[1], c[2]}}; /* one cut */
    if (cuts == 2) memcpy(parts, (int64_t[4][3]){{c[0], h[0], c[2]}, {h[0], c[1], h[1]}, {h[0], h[1], c[2]}}, sizeof parts);
    if (cuts == 3) memcpy(parts, (int64_t[4][3]){{c[0], h[0], h[2]}, {h[0], c[1], h[1]}, {h[2], h[1], c[2]}, {h[0], h[1], h[2]}}, sizeof parts);
    for (int k = 0; k < 3; k++) m->triangle[3 * t + k] = (int32_t)parts[0][k];
    status code = STATUS_OK;
    for (int p = 1; p <= cuts && code == STATUS_OK; p++) code = mesh_add_triangle(m, parts[p][0], parts[p][1], parts[p][2], r);
    return code;
}

static status cut_once(mesh *m, const uint64_t *keys, int64_t count, report *r) {
    int64_t first = m->vertex_count, triangles = m->triangle_count;
    status code = STATUS_OK;
    for (int64_t i = 0; i < count && code == STATUS_OK; i++) {
        const double *a = m->vertex + 3 * (int64_t)(keys[i] >> 32), *b = m->vertex + 3 * (int64_t)(keys[i] & 0xffffffff);
        const double x[3] = {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])};
        code = mesh_add_vertex(m, x, r);
    }
    for (int64_t t = 0; t < triangles && code == STATUS_OK; t++) {
        int64_t middle[3];
        for (int k = 0; k < 3; k++) middle[k] = middle_of(keys, count, first, m->triangle[3 * t + k], m->triangle[3 * t + (k + 1) % 3]);
        code = cut_triangle(m, t, middle, r);
    }
    return code;
}

status mesh_cut_long_sides(mesh *m, double longest, report *r) {
    for (int pass = 0; pass < PASSES; pass++) {
        size_t bytes = (size_t)m->triangle_count * 3 * sizeof(uint64_t);
        uint64_t *keys = memory_allocate(bytes);
        if (!keys) return report_set(r, STATUS_SYSTEM, "out of memory for the sides of %lld triangles", (long long)m->triangle_count);
        int64_t count = collect(m, longest * longest, keys);
        status code = count ? cut_once(m, keys, count, r) : STATUS_OK;
        memory_free(keys, bytes);
        if (code != STATUS_OK || count == 0) return code;
        if (m->triangle_count > TRIANGLE_LIMIT) break;
    }
    return report_input(r, NULL, 0, "dx", "a spacing that cuts the mesh's surface into under 1.3e8 triangles", "a smaller one", NULL);
}
