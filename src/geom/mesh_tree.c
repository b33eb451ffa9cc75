/* The nearest triangle by a hierarchy of boxes, four to a branch. */
#include "geom/mesh_tree.h"

#include "geom/box.h"
#include "geom/vector.h"

#include <assert.h>
#include <string.h>

enum { STACK = 64 };

/* In units of the tree: what single precision may lose of a place in or near the mesh. */
static const float BOX_MARGIN = 1e-6f;

/* Relative: what it may lose of a distance. */
static const double DISTANCE_MARGIN = 1e-5;

/* Squared sine of the angle at a triangle's first corner: below it s and t (triangle_squared) are mostly round-off, and the
 * sides stand for the triangle. */
static const double NEEDLE = 1e-12;

/* ---- building ---------------------------------------------------------------------------------------------------- */

typedef struct tree_builder {
    const mesh *m;
    mesh_tree *tree;
    double (*middle)[3]; // [triangles] of each triangle's box
    int32_t *order;      // [triangles]
    int32_t branches;
} tree_builder;

/* Splits range [begin, end) into at most TREE_WIDTH parts by halving twice: bounds has shape [parts + 1]. */
static int part_count(int64_t count) {
    return count <= TREE_LEAF ? 1 : count <= 2 * TREE_LEAF ? 2 : TREE_WIDTH;
}

/* Branches of a tree over so many triangles: it depends on the number alone. */
static int64_t count_branches(int64_t count) {
    int parts = part_count(count);
    int64_t total = 1, left = count;
    for (int k = 0; k < parts; k++) {
        int64_t part = left / (parts - k);
        left -= part;
        if (part > TREE_LEAF) total += count_branches(part);
    }
    return total;
}

static int widest_axis(const tree_builder *b, int64_t begin, int64_t end) {
    box3 box = box_empty();
    for (int64_t i = begin; i < end; i++) box_add(&box, b->middle[b->order[i]]);
    return box_widest(&box);
}

/* Whether triangle p comes before q along an axis: ties by number, so that the order is one. */
static bool before(const tree_builder *b, int axis, int32_t p, int32_t q) {
    double x = b->middle[p][axis], y = b->middle[q][axis];
    return x < y || (x == y && p < q);
}

static void swap(int32_t *a, int32_t *b) {
    int32_t kept = *a;
    *a = *b, *b = kept;
}

/* Hoare's selection: afterwards order[begin … at) comes before order[at … end) along the range's widest side. The
 * median of three keeps sorted input from being the worst case. */
static void divide(tree_builder *b, int64_t begin, int64_t at, int64_t end) {
    int axis = widest_axis(b, begin, end);
    int32_t *order = b->order;
    for (int64_t low = begin, high = end - 1; low < high;) {
        int64_t middle = low + (high - low) / 2;
        if (before(b, axis, order[middle], order[low])) swap(&order[middle], &order[low]);
        if (before(b, axis, order[high], order[low])) swap(&order[high], &order[low]);
        if (before(b, axis, order[high], order[middle])) swap(&order[high], &order[middle]);
        int32_t pivot = order[middle];
        int64_t i = low, j = high;
        while (i <= j) {
            while (before(b, axis, order[i], pivot)) i++;
            while (before(b, axis, pivot, order[j])) j--;
            if (i <= j) swap(&order[i++], &order[j--]);
        }
        if (at <= j) high = j;
        else if (at >= i) low = i;
        else return;
    }
}

/* A box's sides in the tree's units, widened. */
static void set_box(tree_builder *b, tree_branch *branch, int k, int64_t begin, int64_t end) {
    const mesh_tree *t = b->tree;
    for (int c = 0; c < 3; c++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int64_t i = 3 * begin; i < 3 * end; i++) {
            double x = b->m->vertex[3 * (int64_t)b->m->triangle[3 * (int64_t)b->order[i / 3] + i % 3] + c];
            low = fmin(low, x), high = fmax(high, x);
        }
        branch->low[c][k] = (float)((low - t->center[c]) / t->unit) - BOX_MARGIN;
        branch->high[c][k] = (float)((high - t->center[c]) / t->unit) + BOX_MARGIN;
    }
}

static int32_t build(tree_builder *b, int64_t begin, int64_t end) {
    int parts = part_count(end - begin);
    int32_t number = b->branches++;
    int64_t bound[TREE_WIDTH + 1] = {begin};
    for (int k = 0; k < parts; k++) bound[k + 1] = bound[k] + (end - bound[k]) / (parts - k);
    int half = parts / 2;
    if (parts > 1) divide(b, begin, bound[half], end);
    if (parts == TREE_WIDTH) {
        divide(b, begin, bound[1], bound[half]);
        divide(b, bound[half], bound[half + 1], end);
    }
    tree_branch made = {0};
    for (int k = 0; k < TREE_WIDTH; k++) {
        if (k >= parts) {
            made.count[k] = -1;
            continue;
        }
        set_box(b, &made, k, bound[k], bound[k + 1]);
        bool leaf = bound[k + 1] - bound[k] <= TREE_LEAF;
        made.child[k] = leaf ? (int32_t)bound[k] : build(b, bound[k], bound[k + 1]);
        made.count[k] = leaf ? (int32_t)(bound[k + 1] - bound[k]) : 0;
    }
    b->tree->branch[number] = made;
    return number;
}

static void set_corners(const tree_builder *b) {
    for (int64_t i = 0; i < b->tree->triangles; i++) {
        const int32_t *index = b->m->triangle + 3 * (int64_t)b->order[i];
        double(*corner)[3] = b->tree->corner[i];
        const double *first = b->m->vertex + 3 * (int64_t)index[0];
        memcpy(corner[0], first, 3 * sizeof *first);
        for (int k = 1; k < 3; k++) vector_subtract(b->m->vertex + 3 * (int64_t)index[k], first, corner[k]);
    }
}

static void set_frame(const mesh *m, mesh_tree *t) {
    box3 box = box_empty();
    for (int64_t v = 0; v < m->vertex_count; v++) box_add(&box, m->vertex + 3 * v);
    for (int c = 0; c < 3; c++) {
        t->center[c] = 0.5 * (box.low[c] + box.high[c]);
        t->half[c] = 0.5 * (box.high[c] - box.low[c]);
    }
    t->unit = vector_length(t->half);
}

static void set_middles(const tree_builder *b) {
    for (int32_t t = 0; t < (int32_t)b->tree->triangles; t++) {
        const int32_t *index = b->m->triangle + 3 * (int64_t)t;
        b->order[t] = t;
        for (int c = 0; c < 3; c++) {
            double x = b->m->vertex[3 * (int64_t)index[0] + c], y = b->m->vertex[3 * (int64_t)index[1] + c],
                   z = b->m->vertex[3 * (int64_t)index[2] + c];
            b->middle[t][c] = 0.5 * (fmin(x, fmin(y, z)) + fmax(x, fmax(y, z)));
        }
    }
}

bool mesh_tree_create(arena *a, const mesh *m, mesh_tree *out) {
    size_t count = (size_t)m->triangle_count;
    *out = (mesh_tree){.triangles = m->triangle_count};
    set_frame(m, out);
    out->branch = arena_allocate(a, (size_t)count_branches(m->triangle_count) * sizeof *out->branch);
    out->corner = arena_allocate(a, count * sizeof *out->corner);
    tree_builder b = {.m = m, .tree = out};
    b.middle = memory_allocate(count * sizeof *b.middle);
    b.order = memory_allocate(count * sizeof *b.order);
    bool fine = out->branch && out->corner && b.middle && b.order;
    if (fine) {
        set_middles(&b);
        build(&b, 0, m->triangle_count);
        assert(b.branches == count_branches(m->triangle_count));
        set_corners(&b);
    }
    memory_free(b.middle, count * sizeof *b.middle);
    memory_free(b.order, count * sizeof *b.order);
    return fine;
}

/* ---- asking ------------------------------------------------------------------------------------------------------ */

/* Not fmin, which is a call: the numbers are never NaN. */
static inline double lesser(double a, double b) {
    return a < b ? a : b;
}

static double along_edge(const double offset[3], const double edge[3]) {
    double along = vector_dot(offset, edge), length_squared = vector_dot(edge, edge);
    double t = along <= 0.0 ? 0.0 : along >= length_squared ? 1.0 : along / length_squared;
    double d[3] = {offset[0] - t * edge[0], offset[1] - t * edge[1], offset[2] - t * edge[2]};
    return vector_dot(d, d);
}

/* Squared distance of a triangle, with corners 0, e, f, to a point at `d`. The foot of the perpendicular is s e + t f;
 * where it lies outside, the nearest point is on a side that it lies beyond. */
static double triangle_squared(const double d[3], const double e[3], const double f[3]) {
    double ee = vector_dot(e, e), ef = vector_dot(e, f), ff = vector_dot(f, f), de = vector_dot(d, e), df = vector_dot(d, f);
    double area = ee * ff - ef * ef, s = ff * de - ef * df, t = ee * df - ef * de;
    bool needle = area <= NEEDLE * ee * ff;
    if (!needle && s > 0.0 && t > 0.0 && s + t < area) {
        double normal[3];
        vector_cross(e, f, normal);
        double height = vector_dot(d, normal);
        return height * height / vector_dot(normal, normal);
    }
    double nearest = HUGE_VAL, opposite[3], from_e[3];
    if (needle || s <= 0.0) nearest = along_edge(d, f);
    if (needle || t <= 0.0) nearest = lesser(nearest, along_edge(d, e));
    if (!needle && s + t < area) return nearest;
    vector_subtract(f, e, opposite);
    vector_subtract(d, e, from_e);
    return lesser(nearest, along_edge(from_e, opposite));
}

typedef struct waiting {
    float distance; /* squared, in the tree's units */
    int32_t branch;
} waiting;

typedef int32_t four_flags __attribute__((vector_size(TREE_WIDTH * sizeof(int32_t))));

static tree_four greater(tree_four a, tree_four b) {
    four_flags first = a > b;
    return (tree_four)((first & (four_flags)a) | (~first & (four_flags)b));
}

/* Squared distances from a point to the four boxes of a branch. */
static tree_four box_distances(const tree_branch *b, const float x[3]) {
    tree_four squared = {0};
    for (int c = 0; c < 3; c++) {
        tree_four beyond = greater(greater(b->low[c] - x[c], x[c] - b->high[c]), (tree_four){0});
        squared += beyond * beyond;
    }
    return squared;
}

/* Where a squared length stands among squared lengths in single precision and the tree's units: never too low. */
static float limit_of(const mesh_tree *t, double squared) {
    return (float)(squared / (t->unit * t->unit) * (1.0 + DISTANCE_MARGIN));
}

static double leaf_squared(const mesh_tree *t, int32_t first, int32_t count, const double x[3], double nearest) {
    for (int32_t i = first; i < first + count; i++) {
        double d[3];
        vector_subtract(x, t->corner[i][0], d);
        nearest = lesser(nearest, triangle_squared(d, t->corner[i][1], t->corner[i][2]));
    }
    return nearest;
}

/* Looks into the nearer boxes first. A branch leaves at most three others waiting, and the tree is balanced: the stack
 * is deep enough for 4^20 triangles. */
static double nearest_squared(const mesh_tree *t, const double x[3]) {
    waiting stack[STACK];
    int depth = 0;
    float place[3], limit = HUGE_VALF;
    double nearest = HUGE_VAL;
    for (int c = 0; c < 3; c++) place[c] = (float)((x[c] - t->center[c]) / t->unit);
    stack[depth++] = (waiting){0.0f, 0};
    while (depth > 0) {
        waiting next = stack[--depth];
        if (next.distance > limit) continue;
        const tree_branch *b = &t->branch[next.branch];
        tree_four distance = box_distances(b, place);
        int base = depth;
        for (int k = 0; k < TREE_WIDTH; k++) {
            if (b->count[k] < 0 || distance[k] > limit) continue;
            if (b->count[k] > 0) {
                nearest = leaf_squared(t, b->child[k], b->count[k], x, nearest);
                limit = limit_of(t, nearest);
                continue;
            }
            int at = depth++;
            for (; at > base && stack[at - 1].distance < distance[k]; at--) stack[at] = stack[at - 1];
            stack[at] = (waiting){distance[k], b->child[k]};
        }
    }
    return nearest;
}

double mesh_tree_distance(const mesh_tree *t, const double x[3]) {
    return sqrt(nearest_squared(t, x));
}
