/* What a mesh is like: edges, holes, pieces, volume; and turning its triangles the same way round. */
#include "geom/mesh.h"

#include "geom/disjoint.h"
#include "geom/vector.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* Of the cube of the mesh's largest extent: a closed mesh of less volume is flat. */
static const double VOLUME_FLOOR = 1e-12;

/* ---- edges ------------------------------------------------------------------------------------------------------- */

/* Corner c of a mesh is where its triangle c / 3 begins its side c % 3, to the next corner of that triangle. */
typedef struct edge_list {
    const mesh *m;
    int64_t corners;
    int32_t *order; // [corners] sorted by the lower vertex of the side, then by the higher
} edge_list;

static int32_t side_start(const mesh *m, int64_t corner) {
    return m->triangle[corner];
}

static int32_t side_end(const mesh *m, int64_t corner) {
    return m->triangle[corner % 3 == 2 ? corner - 2 : corner + 1];
}

static int32_t side_vertex(const mesh *m, int64_t corner, bool higher) {
    int32_t a = side_start(m, corner), b = side_end(m, corner);
    return (a > b) == higher ? a : b;
}

/* One pass of a counting sort by a vertex of the sides: stable, so that two passes sort by both. first has shape
 * [vertices + 1]; from NULL stands for the corners in their own order. */
static void sort_by_vertex(const edge_list *e, bool higher, const int32_t *from, int32_t *to, int32_t *first) {
    const mesh *m = e->m;
    memset(first, 0, ((size_t)m->vertex_count + 1) * sizeof *first);
    for (int64_t c = 0; c < e->corners; c++) first[side_vertex(m, c, higher) + 1]++;
    for (int64_t v = 0; v < m->vertex_count; v++) first[v + 1] += first[v];
    for (int64_t i = 0; i < e->corners; i++) {
        int32_t c = from ? from[i] : (int32_t)i;
        to[first[side_vertex(m, c, higher)]++] = c;
    }
}

static void edges_free(edge_list *e) {
    memory_free(e->order, (size_t)e->corners * sizeof *e->order);
}

static status out_of_memory(report *r) {
    return report_set(r, STATUS_SYSTEM, "out of memory for the edges of a mesh");
}

static status edges_create(const mesh *m, edge_list *e, report *r) {
    *e = (edge_list){.m = m, .corners = 3 * m->triangle_count};
    size_t bytes = (size_t)e->corners * sizeof *e->order, first_bytes = ((size_t)m->vertex_count + 1) * sizeof(int32_t);
    e->order = memory_allocate(bytes);
    int32_t *half = memory_allocate(bytes), *first = memory_allocate(first_bytes);
    bool fine = e->order && half && first;
    if (fine) {
        sort_by_vertex(e, true, NULL, half, first);
        sort_by_vertex(e, false, half, e->order, first);
    } else {
        edges_free(e);
    }
    memory_free(half, bytes);
    memory_free(first, first_bytes);
    return fine ? STATUS_OK : out_of_memory(r);
}

/* An edge: the sides order[begin] … order[end − 1], of which `up` run from the lower vertex to the higher. */
typedef struct edge {
    int64_t begin, end, up;
} edge;

/* The next edge; false when there is none. Begin with a zeroed one. */
static bool next_edge(const edge_list *e, edge *out) {
    const mesh *m = e->m;
    if (out->end == e->corners) return false;
    *out = (edge){.begin = out->end, .end = out->end};
    int32_t low = side_vertex(m, e->order[out->begin], false), high = side_vertex(m, e->order[out->begin], true);
    for (; out->end < e->corners; out->end++) {
        int32_t c = e->order[out->end];
        if (side_vertex(m, c, false) != low || side_vertex(m, c, true) != high) break;
        out->up += side_start(m, c) == low;
    }
    return true;
}

static void edge_middle(const edge_list *e, const edge *which, double middle[3]) {
    int32_t c = e->order[which->begin];
    const double *a = e->m->vertex + 3 * (int64_t)side_start(e->m, c), *b = e->m->vertex + 3 * (int64_t)side_end(e->m, c);
    for (int i = 0; i < 3; i++) middle[i] = 0.5 * (a[i] + b[i]);
}

/* ---- counting ---------------------------------------------------------------------------------------------------- */

/* Whether two sets have become one. */
static bool join(int32_t *parent, int32_t a, int32_t b) {
    a = disjoint_root(parent, a), b = disjoint_root(parent, b);
    parent[a > b ? a : b] = a > b ? b : a;
    return a != b;
}

/* Adds a boundary edge to the holes: each vertex that is new to them begins one, an edge between two joins them. Parents
 * are −1 for vertices that are on no boundary. */
static void add_to_holes(int32_t *parent, const int32_t ends[2], mesh_report *out) {
    for (int i = 0; i < 2; i++) {
        if (parent[ends[i]] >= 0) continue;
        parent[ends[i]] = ends[i];
        out->holes++;
    }
    if (join(parent, ends[0], ends[1])) out->holes--;
}

static void count_edges(const edge_list *e, int32_t *hole, int32_t *piece, mesh_report *out) {
    const mesh *m = e->m;
    for (edge it = {0}; next_edge(e, &it);) {
        int64_t sides = it.end - it.begin;
        for (int64_t i = it.begin + 1; i < it.end; i++)
            if (join(piece, e->order[it.begin] / 3, e->order[i] / 3)) out->components--;
        if (sides > 2) out->nonmanifold_edges++;
        if (sides > 2 && 2 * it.up != sides && out->unpaired_edges++ == 0) edge_middle(e, &it, out->unpaired_at);
        if (sides == 2 && it.up != 1) out->opposed_edges++;
        if (sides != 1) continue;
        if (out->boundary_edges++ == 0) edge_middle(e, &it, out->hole_at);
        int32_t corner = e->order[it.begin], ends[2] = {side_start(m, corner), side_end(m, corner)};
        add_to_holes(hole, ends, out);
    }
}

/* The volume between the triangles and the middle of the box: far from it, terms would cancel. */
static void measure(const mesh *m, mesh_report *out) {
    double middle[3];
    for (int i = 0; i < 3; i++) out->minimum[i] = HUGE_VAL, out->maximum[i] = -HUGE_VAL;
    for (int64_t v = 0; v < 3 * m->vertex_count; v++) {
        out->minimum[v % 3] = fmin(out->minimum[v % 3], m->vertex[v]);
        out->maximum[v % 3] = fmax(out->maximum[v % 3], m->vertex[v]);
    }
    for (int i = 0; i < 3; i++) middle[i] = 0.5 * (out->minimum[i] + out->maximum[i]);
    for (int64_t t = 0; t < m->triangle_count; t++) {
        double corner[3][3], normal[3];
        for (int k = 0; k < 3; k++) vector_subtract(m->vertex + 3 * (int64_t)m->triangle[3 * t + k], middle, corner[k]);
        vector_cross(corner[1], corner[2], normal);
        out->volume += vector_dot(corner[0], normal) / 6.0;
    }
}

status mesh_inspect(const mesh *m, mesh_report *out, report *r) {
    *out = (mesh_report){.vertices = m->vertex_count, .triangles = m->triangle_count, .components = m->triangle_count};
    edge_list edges;
    status code = edges_create(m, &edges, r);
    if (code != STATUS_OK) return code;
    size_t hole_bytes = (size_t)m->vertex_count * sizeof(int32_t), piece_bytes = (size_t)m->triangle_count * sizeof(int32_t);
    int32_t *hole = memory_allocate(hole_bytes), *piece = memory_allocate(piece_bytes);
    if (hole && piece) {
        memset(hole, -1, hole_bytes);
        for (int32_t t = 0; t < (int32_t)m->triangle_count; t++) piece[t] = t;
        count_edges(&edges, hole, piece, out);
        measure(m, out);
        out->orientation = out->opposed_edges > 0 ? MESH_MIXED : out->volume > 0 ? MESH_OUTWARD : MESH_INWARD;
    } else {
        code = out_of_memory(r);
    }
    memory_free(hole, hole_bytes);
    memory_free(piece, piece_bytes);
    edges_free(&edges);
    return code;
}

/* ---- orientation ------------------------------------------------------------------------------------------------- */

enum { SEEN = 1, TURNED = 2 };

/* A walk over the triangles from neighbour to neighbour. */
typedef struct turning {
    mesh *m;
    int32_t *mate;  // [3 triangles] the corner of the neighbour's side, or −1 where there is not exactly one
    int32_t *reached; // [triangles] in the order of the walk
    uint8_t *state;   // [triangles] SEEN, TURNED
} turning;

static void find_mates(const edge_list *e, int32_t *mate) {
    memset(mate, -1, (size_t)e->corners * sizeof *mate);
    for (edge it = {0}; next_edge(e, &it);) {
        if (it.end - it.begin != 2) continue;
        int32_t a = e->order[it.begin], b = e->order[it.begin + 1];
        mate[a] = b, mate[b] = a;
    }
}

/* Walks over the piece of triangle `start`, which lies at reached[first], and returns the end of the piece in `reached`;
 * −1 − corner where it comes back to a triangle from its other side. */
static int64_t walk_piece(turning *w, int64_t first, int32_t start) {
    int64_t end = first;
    w->reached[end++] = start;
    w->state[start] = SEEN;
    for (int64_t i = first; i < end; i++) {
        int32_t t = w->reached[i];
        for (int32_t c = 3 * t; c < 3 * t + 3; c++) {
            int32_t mate = w->mate[c];
            if (mate < 0) continue;
            bool opposed = side_start(w->m, c) == side_start(w->m, mate);
            uint8_t wanted = (uint8_t)(SEEN | ((w->state[t] ^ (opposed ? TURNED : 0)) & TURNED));
            uint8_t *state = &w->state[mate / 3];
            if (*state && *state != wanted) return -1 - (int64_t)c;
            if (!*state) w->reached[end++] = mate / 3;
            *state = wanted;
        }
    }
    return end;
}

/* What fewer triangles of the piece reached[first … end) want becomes turned. */
static void settle_piece(turning *w, int64_t first, int64_t end) {
    int64_t marked = 0;
    for (int64_t i = first; i < end; i++) marked += (w->state[w->reached[i]] & TURNED) != 0;
    for (int64_t i = first; i < end && 2 * marked > end - first; i++) w->state[w->reached[i]] ^= TURNED;
}

static status one_sided(const char *file, const mesh *m, int64_t corner, report *r) {
    const double *x = m->vertex + 3 * (int64_t)m->triangle[corner];
    char found[100];
    snprintf(found, sizeof found, "a one-sided surface, near (%.4g, %.4g, %.4g)", x[0], x[1], x[2]);
    return report_input(r, file, 0, NULL, "a surface with an inside and an outside", found, NULL);
}

static void turn(mesh *m, int64_t triangle) {
    int32_t *corner = m->triangle + 3 * triangle, second = corner[1];
    corner[1] = corner[2], corner[2] = second;
}

/* Turns what is marked, then everything when the volume comes out negative. */
static int64_t apply_turns(turning *w) {
    mesh *m = w->m;
    int64_t turned = 0;
    mesh_report facts = {0};
    for (int64_t t = 0; t < m->triangle_count; t++) {
        if (!(w->state[t] & TURNED)) continue;
        turn(m, t);
        turned++;
    }
    measure(m, &facts);
    if (!(facts.volume < 0)) return turned;
    for (int64_t t = 0; t < m->triangle_count; t++) turn(m, t);
    return m->triangle_count - turned;
}

static status walk_all(const char *file, turning *w, report *r) {
    for (int64_t t = 0, first = 0; t < w->m->triangle_count; t++) {
        if (w->state[t]) continue;
        int64_t end = walk_piece(w, first, (int32_t)t);
        if (end < 0) return one_sided(file, w->m, -1 - end, r);
        settle_piece(w, first, end);
        first = end;
    }
    return STATUS_OK;
}

status mesh_orient(const char *file, mesh *m, int64_t *turned, report *r) {
    edge_list edges;
    *turned = 0;
    status code = edges_create(m, &edges, r);
    if (code != STATUS_OK) return code;
    size_t count = (size_t)m->triangle_count, bytes = count * sizeof(int32_t);
    turning w = {.m = m, .mate = memory_allocate(3 * bytes), .reached = memory_allocate(bytes), .state = memory_allocate(count)};
    if (w.mate && w.reached && w.state) {
        find_mates(&edges, w.mate);
        code = walk_all(file, &w, r);
        if (code == STATUS_OK) *turned = apply_turns(&w);
    } else {
        code = out_of_memory(r);
    }
    memory_free(w.mate, 3 * bytes);
    memory_free(w.reached, bytes);
    memory_free(w.state, count);
    edges_free(&edges);
    return code;
}

status mesh_make_solid(const char *file, mesh *m, mesh_report *facts, report *r) {
    int64_t turned;
    char found[160];
    status code = mesh_orient(file, m, &turned, r);
    if (code == STATUS_OK) code = mesh_inspect(m, facts, r);
    if (code != STATUS_OK) return code;
    if (facts->boundary_edges > 0) {
        const double *x = facts->hole_at;
        snprintf(found, sizeof found, "%lld hole%s (%lld open edges), one at (%.4g, %.4g, %.4g)", (long long)facts->holes,
                 facts->holes == 1 ? "" : "s", (long long)facts->boundary_edges, x[0], x[1], x[2]);
        return report_input(r, file, 0, NULL, "a closed surface", found, NULL);
    }
    if (facts->unpaired_edges > 0) {
        const double *x = facts->unpaired_at;
        snprintf(found, sizeof found, "%lld edge%s where three or more triangles meet with no inside, one at (%.4g, %.4g, %.4g)",
                 (long long)facts->unpaired_edges, facts->unpaired_edges == 1 ? "" : "s", x[0], x[1], x[2]);
        return report_input(r, file, 0, NULL, "a surface that encloses a solid", found, NULL);
    }
    double extent = 0;
    for (int i = 0; i < 3; i++) extent = fmax(extent, facts->maximum[i] - facts->minimum[i]);
    if (facts->volume > VOLUME_FLOOR * extent * extent * extent) return STATUS_OK;
    return report_input(r, file, 0, NULL, "a surface that encloses a solid", "a flat one", NULL);
}
