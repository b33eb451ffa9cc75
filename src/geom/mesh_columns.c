/* Inside or outside, by signed crossings of a line from the point upwards.
 *
 * Across the lines, corners and points are rounded to whole numbers of 2^-29 of the mesh's size. Which side of an edge a
 * point lies on is then exact, and ties are settled as if all points were moved by the same vanishing amount: a line
 * never slips between two triangles, and never meets both where they share an edge. */
#include "geom/mesh_tree.h"

#include "geom/box.h"
#include "geom/vector.h"

#include <assert.h>
#include <string.h>

/* Differences of two such numbers have 30 bits, their products' differences 61. */
static const double WHOLE = 0x1p29;

enum { LISTED_PER_TRIANGLE = 16, COLUMN_LIMIT = 4096 };

/* ---- building ---------------------------------------------------------------------------------------------------- */

static void set_frame(const mesh *m, mesh_columns *c) {
    box3 box = box_empty();
    for (int64_t v = 0; v < m->vertex_count; v++) box_add(&box, m->vertex + 3 * v);
    int shortest = box_narrowest(&box);
    double extent = 0.0;
    for (int i = 0; i < 3; i++) {
        c->axis[i] = (shortest + 1 + i) % 3;
        c->low[i] = box.low[c->axis[i]], c->high[i] = box.high[c->axis[i]];
        extent = fmax(extent, c->high[i] - c->low[i]);
    }
    c->scale = WHOLE / extent;
}

static int32_t to_whole(const mesh_columns *c, int side, double x) {
    return (int32_t)floor((x - c->low[side]) * c->scale + 0.5);
}

static int32_t column_at(const mesh_columns *c, int side, int32_t whole) {
    int32_t column = (int32_t)(whole * c->wide[side]);
    return column < c->count[side] ? column : c->count[side] - 1;
}

/* Columns for about two triangles each, as square as the mesh allows. */
static void choose_columns(mesh_columns *c, double wanted) {
    double width = c->high[0] - c->low[0], height = c->high[1] - c->low[1], edge = sqrt(width * height / wanted);
    double sides[2] = {width, height};
    for (int i = 0; i < 2; i++) {
        double count = edge > 0.0 ? ceil(sides[i] / edge) : 1.0;
        c->count[i] = (int32_t)fmin(fmax(count, 1.0), COLUMN_LIMIT);
        double whole = fmax(sides[i] * c->scale, 1.0);
        c->wide[i] = c->count[i] / whole;
    }
}

typedef struct column_range {
    int32_t low[2], high[2];
} column_range;

static column_range range_of(const mesh_columns *c, const column_triangle *t) {
    column_range range;
    for (int i = 0; i < 2; i++) {
        const int32_t *p = i ? t->v : t->u;
        int32_t low = p[0] < p[1] ? p[0] : p[1], high = p[0] > p[1] ? p[0] : p[1];
        range.low[i] = column_at(c, i, low < p[2] ? low : p[2]);
        range.high[i] = column_at(c, i, high > p[2] ? high : p[2]);
    }
    return range;
}

static int64_t listed(const mesh_columns *c, int64_t triangles) {
    int64_t total = 0;
    for (int64_t t = 0; t < triangles; t++) {
        column_range range = range_of(c, &c->triangle[t]);
        total += (int64_t)(range.high[0] - range.low[0] + 1) * (range.high[1] - range.low[1] + 1);
    }
    return total;
}

/* Fewer columns until the lists are of a reasonable length: long thin triangles lie in many. */
static int64_t fit_columns(mesh_columns *c, int64_t triangles) {
    double wanted = (double)triangles;
    int64_t total;
    do {
        choose_columns(c, wanted);
        total = listed(c, triangles);
        wanted /= 2;
    } while (total > LISTED_PER_TRIANGLE * triangles && c->count[0] * c->count[1] > 1);
    return total;
}

/* Lists the triangles by column: counted into first[column + 1], summed, then filled in order. */
static void fill_lists(mesh_columns *c, int64_t triangles, int32_t *next) {
    int64_t columns = (int64_t)c->count[0] * c->count[1];
    for (int pass = 0; pass < 2; pass++) {
        for (int64_t t = 0; t < triangles; t++) {
            column_range range = range_of(c, &c->triangle[t]);
            for (int32_t i = range.low[0]; i <= range.high[0]; i++)
                for (int32_t k = range.low[1]; k <= range.high[1]; k++) {
                    int64_t column = (int64_t)i * c->count[1] + k;
                    if (pass == 0) c->first[column + 1]++;
                    else c->item[next[column]++] = (int32_t)t;
                }
        }
        if (pass == 1) break;
        for (int64_t i = 0; i < columns; i++) c->first[i + 1] += c->first[i];
        memcpy(next, c->first, (size_t)columns * sizeof *next);
    }
}

static void set_triangles(const mesh *m, mesh_columns *c) {
    for (int64_t t = 0; t < m->triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            const double *x = m->vertex + 3 * (int64_t)m->triangle[3 * t + k];
            c->triangle[t].u[k] = to_whole(c, 0, x[c->axis[0]]);
            c->triangle[t].v[k] = to_whole(c, 1, x[c->axis[1]]);
            c->triangle[t].w[k] = x[c->axis[2]];
        }
}

bool mesh_columns_create(arena *a, const mesh *m, mesh_columns *out) {
    *out = (mesh_columns){0};
    set_frame(m, out);
    out->triangle = arena_allocate(a, (size_t)m->triangle_count * sizeof *out->triangle);
    if (!out->triangle) return false;
    set_triangles(m, out);
    int64_t total = fit_columns(out, m->triangle_count), columns = (int64_t)out->count[0] * out->count[1];
    assert(total <= INT32_MAX); /* mesh.c limits the number of triangles */
    out->first = arena_allocate(a, ((size_t)columns + 1) * sizeof *out->first);
    out->item = arena_allocate(a, (size_t)total * sizeof *out->item);
    int32_t *next = memory_allocate((size_t)columns * sizeof *next);
    bool fine = out->first && out->item && next;
    if (fine) fill_lists(out, m->triangle_count, next);
    memory_free(next, (size_t)columns * sizeof *next);
    return fine;
}

/* ---- asking ------------------------------------------------------------------------------------------------------ */

/* Twice the area of (a, b, point): positive where the point lies left of the way from a to b. */
static int64_t left_of(const column_triangle *t, int a, int b, int32_t u, int32_t v) {
    int64_t du = (int64_t)t->u[b] - t->u[a], dv = (int64_t)t->v[b] - t->v[a];
    return du * (v - (int64_t)t->v[a]) - dv * (u - (int64_t)t->u[a]);
}

/* Its sign when the point is moved by (ε, ε²). Zero only when a and b coincide; never the same for all sides of a
 * triangle without area. */
static int side_of(const column_triangle *t, int a, int b, int64_t area) {
    if (area != 0) return area > 0 ? 1 : -1;
    if (t->v[a] != t->v[b]) return t->v[b] < t->v[a] ? 1 : -1;
    return (t->u[b] > t->u[a]) - (t->u[b] < t->u[a]);
}

/* +1 or −1 when the line upwards from (u, v, w) passes through the triangle, 0 when not. */
static int crossing(const column_triangle *t, int32_t u, int32_t v, double w) {
    int64_t area[3];
    int side = 0;
    for (int k = 0; k < 3; k++) {
        int a = k, b = (k + 1) % 3;
        area[k] = left_of(t, a, b, u, v);
        int sign = side_of(t, a, b, area[k]);
        if (sign == 0 || sign == -side) return 0;
        side = sign;
    }
    double total = (double)(area[0] + area[1] + area[2]);
    double height = ((double)area[1] * t->w[0] + (double)area[2] * t->w[1] + (double)area[0] * t->w[2]) / total;
    return height > w ? side : 0;
}

bool mesh_columns_inside(const mesh_columns *c, const double x[3]) {
    double place[3];
    for (int i = 0; i < 3; i++) {
        place[i] = x[c->axis[i]];
        if (!(place[i] >= c->low[i] && place[i] <= c->high[i])) return false;
    }
    int32_t u = to_whole(c, 0, place[0]), v = to_whole(c, 1, place[1]);
    int64_t column = (int64_t)column_at(c, 0, u) * c->count[1] + column_at(c, 1, v);
    int winding = 0;
    for (int32_t i = c->first[column]; i < c->first[column + 1]; i++)
        winding += crossing(&c->triangle[c->item[i]], u, v, place[2]);
    return winding != 0;
}
