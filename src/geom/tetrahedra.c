#include "geom/tetrahedra.h"

#include "base/memory.h"

#include <math.h>
#include <string.h>

enum { CORNERS = 8, PARTS = 5, RETREATS = 3 };

/* More cubes than this in a shape's box is a slip in the spacing. */
static const double CUBE_LIMIT = 0x1p28;

/* Least volume that a tetrahedron at the surface keeps of the lattice's. */
static const double LEAST_PART = 0.3;

/* A cube's corner c lies at (c & 1, c >> 1 & 1, c >> 2). The middle one of five has the corners with an even number of ones, or the odd ones;
 * a neighbour has the other kind, so the diagonals of a common face are one. */
static const int parts[2][PARTS][4] = {
    {{1, 2, 4, 7}, {0, 1, 2, 4}, {3, 2, 1, 7}, {5, 1, 4, 7}, {6, 4, 2, 7}},
    {{0, 5, 3, 6}, {1, 3, 0, 5}, {2, 0, 3, 6}, {4, 5, 0, 6}, {7, 3, 5, 6}},
};

typedef struct lattice {
    const shape *body;
    double low[3], edge[3];
    int64_t cubes[3], nodes[3]; /* along each axis */
    uint8_t *inside;            // [cubes]
    int32_t *vertex;            // [nodes], −1: no cube has it
} lattice;

static int64_t total(const int64_t n[3]) {
    return n[0] * n[1] * n[2];
}

static status choose(lattice *l, double edge, report *r) {
    double high[3], cubes = 1;
    shape_bounds(l->body, l->low, high);
    for (int c = 0; c < 3; c++) {
        double size = high[c] - l->low[c], count = fmax(1, round(size / edge));
        if (!(size > 0) || !isfinite(size) || !(edge > 0))
            return report_input(r, NULL, 0, "shape", "a bounded body of some size, and a spacing above 0", "none to fill with tetrahedra", NULL);
        cubes *= count;
        if (!(cubes <= CUBE_LIMIT)) return report_input(r, NULL, 0, "dx", "a spacing that gives under 2.7e8 cubes", "a smaller one", NULL);
        l->cubes[c] = (int64_t)count;
        l->nodes[c] = l->cubes[c] + 1;
        l->edge[c] = size / count;
    }
    l->inside = memory_allocate_array((size_t)total(l->cubes), 1);
    l->vertex = memory_allocate_array((size_t)total(l->nodes), sizeof *l->vertex);
    if (l->inside && l->vertex) return STATUS_OK;
    return report_set(r, STATUS_SYSTEM, "out of memory for a lattice of %.3g cubes", cubes);
}

static void release(lattice *l) {
    memory_free(l->inside, l->inside ? (size_t)total(l->cubes) : 0);
    memory_free(l->vertex, l->vertex ? (size_t)total(l->nodes) * sizeof *l->vertex : 0);
}

static int64_t node_index(const lattice *l, const int64_t cube[3], int corner) {
    return ((cube[0] + (corner & 1)) * l->nodes[1] + cube[1] + (corner >> 1 & 1)) * l->nodes[2] + cube[2] + (corner >> 2);
}

/* Marks cubes and numbers vertices; how many of each there are. */
static void mark(lattice *l, tetrahedra *out) {
    int64_t cube[3], i = 0;
    for (int64_t n = 0; n < total(l->nodes); n++) l->vertex[n] = -1;
    for (cube[0] = 0; cube[0] < l->cubes[0]; cube[0]++)
        for (cube[1] = 0; cube[1] < l->cubes[1]; cube[1]++)
            for (cube[2] = 0; cube[2] < l->cubes[2]; cube[2]++, i++) {
                double middle[3];
                for (int c = 0; c < 3; c++) middle[c] = l->low[c] + ((double)cube[c] + 0.5) * l->edge[c];
                l->inside[i] = shape_distance(l->body, middle) < 0;
                if (!l->inside[i]) continue;
                out->count += PARTS;
                for (int corner = 0; corner < CORNERS; corner++) {
                    int32_t *vertex = &l->vertex[node_index(l, cube, corner)];
                    if (*vertex < 0) *vertex = (int32_t)out->vertex_count++;
                }
            }
}

static void fill(const lattice *l, tetrahedra *out) {
    int64_t cube[3], i = 0, next = 0;
    for (cube[0] = 0; cube[0] < l->cubes[0]; cube[0]++)
        for (cube[1] = 0; cube[1] < l->cubes[1]; cube[1]++)
            for (cube[2] = 0; cube[2] < l->cubes[2]; cube[2]++, i++) {
                if (!l->inside[i]) continue;
                for (int part = 0; part < PARTS; part++, next++)
                    for (int k = 0; k < 4; k++)
                        out->corner[4 * next + k] = l->vertex[node_index(l, cube, parts[(cube[0] + cube[1] + cube[2]) % 2][part][k])];
                for (int corner = 0; corner < CORNERS; corner++) {
                    double *x = out->vertex + 3 * (int64_t)l->vertex[node_index(l, cube, corner)];
                    for (int c = 0; c < 3; c++) x[c] = l->low[c] + (double)(cube[c] + (corner >> c & 1)) * l->edge[c];
                }
            }
}

double tetrahedra_determinant(const tetrahedra *t, int64_t i) {
    double e[3][3];
    const int32_t *corner = t->corner + 4 * i;
    for (int k = 0; k < 3; k++)
        for (int c = 0; c < 3; c++) e[k][c] = t->vertex[3 * (int64_t)corner[k + 1] + c] - t->vertex[3 * (int64_t)corner[0] + c];
    return e[2][0] * (e[0][1] * e[1][2] - e[0][2] * e[1][1]) + e[2][1] * (e[0][2] * e[1][0] - e[0][0] * e[1][2]) +
           e[2][2] * (e[0][0] * e[1][1] - e[0][1] * e[1][0]);
}

/* Which vertices lie on the stair-stepped surface: those of fewer than eight cubes. */
static void mark_surface(const lattice *l, uint8_t *cubes_at) {
    int64_t cube[3], i = 0;
    for (cube[0] = 0; cube[0] < l->cubes[0]; cube[0]++)
        for (cube[1] = 0; cube[1] < l->cubes[1]; cube[1]++)
            for (cube[2] = 0; cube[2] < l->cubes[2]; cube[2]++, i++)
                for (int corner = 0; corner < CORNERS && l->inside[i]; corner++) cubes_at[l->vertex[node_index(l, cube, corner)]]++;
}

/* Moves the surface's vertices onto the shape's surface, and those of tetrahedra that this spoils half way back, twice, then home, until none is. */
static void fit(const lattice *l, tetrahedra *t, double *home, uint8_t *moved) {
    double h = fmin(l->edge[0], fmin(l->edge[1], l->edge[2])), whole = l->edge[0] * l->edge[1] * l->edge[2];
    mark_surface(l, moved);
    memcpy(home, t->vertex, (size_t)t->vertex_count * 3 * sizeof *home);
    for (int64_t v = 0; v < t->vertex_count; v++) {
        double *x = t->vertex + 3 * v, normal[3], distance = shape_distance(l->body, x);
        moved[v] = moved[v] < CORNERS && fabs(distance) > 1e-9 * h && fabs(distance) < h ? RETREATS : 0;
        if (!moved[v]) continue;
        shape_normal(l->body, x, 1e-4 * h, normal);
        for (int c = 0; c < 3; c++) x[c] -= distance * normal[c];
    }
    for (bool spoilt = true; spoilt;) {
        spoilt = false;
        for (int64_t i = 0; i < t->count; i++) {
            double least = LEAST_PART * whole * (i % PARTS == 0 ? 2 : 1); /* the middle one is twice as large */
            if (tetrahedra_determinant(t, i) >= least) continue;
            for (int k = 0; k < 4; k++) {
                int64_t v = t->corner[4 * i + k];
                if (!moved[v]) continue;
                double keep = --moved[v] ? 0.5 : 0;
                for (int c = 0; c < 3; c++) t->vertex[3 * v + c] = home[3 * v + c] + keep * (t->vertex[3 * v + c] - home[3 * v + c]);
                spoilt = true;
            }
        }
    }
}

static status make(lattice *l, tetrahedra *out, report *r) {
    mark(l, out);
    if (out->count == 0)
        return report_input(r, NULL, 0, "dx", "a spacing that lets a cube's middle lie inside the shape", "a coarser one", NULL);
    out->vertex = memory_allocate_array((size_t)out->vertex_count, 3 * sizeof *out->vertex);
    out->corner = memory_allocate_array((size_t)out->count, 4 * sizeof *out->corner);
    if (out->vertex) out->vertex_capacity = out->vertex_count;
    if (out->corner) out->capacity = out->count;
    double *home = memory_allocate_array((size_t)out->vertex_count, 3 * sizeof *home);
    uint8_t *moved = memory_allocate_array((size_t)out->vertex_count, 1);
    bool whole = out->vertex && out->corner && home && moved;
    if (whole) {
        fill(l, out);
        fit(l, out, home, moved);
    }
    memory_free(home, home ? (size_t)out->vertex_count * 3 * sizeof *home : 0);
    memory_free(moved, moved ? (size_t)out->vertex_count : 0);
    return whole ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for %lld tetrahedra", (long long)out->count);
}

status tetrahedra_fill(const shape *s, double edge, tetrahedra *out, report *r) {
    lattice l = {.body = s};
    *out = (tetrahedra){0};
    status code = choose(&l, edge, r);
    if (code == STATUS_OK) code = make(&l, out, r);
    release(&l);
    if (code != STATUS_OK) tetrahedra_free(out);
    return code;
}

void tetrahedra_free(tetrahedra *t) {
    memory_free(t->vertex, (size_t)t->vertex_capacity * 3 * sizeof *t->vertex);
    memory_free(t->corner, (size_t)t->capacity * 4 * sizeof *t->corner);
    *t = (tetrahedra){0};
}
