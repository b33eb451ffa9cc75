/* Storage, reading and welding of meshes. */
#include "geom/mesh.h"

#include "base/random.h"
#include "geom/mesh_build.h"
#include "geom/text.h"
#include "geom/vector.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

enum { FIRST_CAPACITY = 256, NAME_SHOWN = 80 };

/* More vertices or triangles would not leave room for three corners a triangle in 32 bits. */
static const int64_t COUNT_LIMIT = 1 << 26;

/* Of the mesh's largest extent: coarser than the rounding of single-precision files, finer than any detail they hold. */
static const double WELD_TOLERANCE = 1e-6;

/* Below it products of lengths would vanish. */
static const double EXTENT_FLOOR = 1e-30;

/* ---- storage ----------------------------------------------------------------------------------------------------- */

static status out_of_memory(report *r) {
    return report_set(r, STATUS_SYSTEM, "out of memory for a mesh");
}

/* Room for one more row of `size` bytes in an array. */
static status grow(void **rows, int64_t count, int64_t *capacity, size_t size, report *r) {
    if (count < *capacity) return STATUS_OK;
    if (count >= COUNT_LIMIT) return report_set(r, STATUS_INPUT, "a mesh may have at most 67108864 vertices or triangles");
    int64_t wanted = *capacity ? 2 * *capacity : FIRST_CAPACITY;
    void *grown = memory_resize(*rows, (size_t)*capacity * size, (size_t)wanted * size);
    if (!grown) return out_of_memory(r);
    *rows = grown, *capacity = wanted;
    return STATUS_OK;
}

bool mesh_coordinate_ok(double x) {
    return fabs(x) <= MESH_COORDINATE_LIMIT;
}

status mesh_add_vertex(mesh *m, const double x[3], report *r) {
    void *rows = m->vertex;
    status code = grow(&rows, m->vertex_count, &m->vertex_capacity, 3 * sizeof(double), r);
    m->vertex = rows;
    if (code == STATUS_OK) memcpy(m->vertex + 3 * m->vertex_count++, x, 3 * sizeof *x);
    return code;
}

status mesh_read_vertex(text_reader *t, bool (*next)(text_reader *, text_word *), const char *key, mesh *m, report *r) {
    double x[3];
    for (int i = 0; i < 3; i++) {
        text_word word;
        bool found = next(t, &word);
        if (!found || !text_number(&word, &x[i]) || !mesh_coordinate_ok(x[i]))
            return text_wrong(t, key, "three finite coordinates", found ? &word : NULL, r);
    }
    return mesh_add_vertex(m, x, r);
}

status mesh_add_triangle(mesh *m, int64_t a, int64_t b, int64_t c, report *r) {
    void *rows = m->triangle;
    status code = grow(&rows, m->triangle_count, &m->triangle_capacity, 3 * sizeof(int32_t), r);
    m->triangle = rows;
    if (code != STATUS_OK) return code;
    int32_t *corner = m->triangle + 3 * m->triangle_count++;
    corner[0] = (int32_t)a, corner[1] = (int32_t)b, corner[2] = (int32_t)c;
    return STATUS_OK;
}

void mesh_free(mesh *m) {
    memory_free(m->vertex, (size_t)m->vertex_capacity * 3 * sizeof(double));
    memory_free(m->triangle, (size_t)m->triangle_capacity * 3 * sizeof(int32_t));
    *m = (mesh){0};
}

void mesh_transform(mesh *m, const double rotation[9], double scale, const double translation[3]) {
    for (int64_t v = 0; v < m->vertex_count; v++) {
        double *x = m->vertex + 3 * v, old[3] = {x[0], x[1], x[2]};
        for (int i = 0; i < 3; i++) x[i] = scale * vector_dot(rotation + 3 * i, old) + translation[i];
    }
}

/* ---- welding ----------------------------------------------------------------------------------------------------- */

/* Vertices by the cell of a lattice that they lie in. Cells are four tolerances wide, so that the vertices near one lie
 * in one cell mostly, and in eight at most. */
typedef struct weld_table {
    const mesh *m;
    double origin[3], cell, tolerance;
    uint64_t mask;
    int32_t *slot; /* [mask + 1]: a kept vertex + 1, or 0 */
} weld_table;

static void cell_of(const weld_table *t, const double x[3], double offset, int64_t cell[3]) {
    for (int i = 0; i < 3; i++) cell[i] = (int64_t)floor((x[i] - t->origin[i] + offset) / t->cell);
}

static uint64_t slot_of(const weld_table *t, const int64_t cell[3]) {
    return random_mix((uint64_t)cell[0] ^ random_mix((uint64_t)cell[1] ^ random_mix((uint64_t)cell[2]))) & t->mask;
}

static bool is_near(const weld_table *t, const double x[3], int32_t vertex) {
    double d[3];
    vector_subtract(x, t->m->vertex + 3 * (int64_t)vertex, d);
    return vector_length(d) <= t->tolerance;
}

/* A kept vertex of the cell near x, or −1. */
static int32_t find_in_cell(const weld_table *t, const int64_t cell[3], const double x[3]) {
    for (uint64_t at = slot_of(t, cell); t->slot[at]; at = (at + 1) & t->mask)
        if (is_near(t, x, t->slot[at] - 1)) return t->slot[at] - 1;
    return -1;
}

static int32_t find_near(const weld_table *t, const double x[3]) {
    int64_t low[3], high[3], cell[3];
    cell_of(t, x, -t->tolerance, low);
    cell_of(t, x, t->tolerance, high);
    for (cell[0] = low[0]; cell[0] <= high[0]; cell[0]++)
        for (cell[1] = low[1]; cell[1] <= high[1]; cell[1]++)
            for (cell[2] = low[2]; cell[2] <= high[2]; cell[2]++) {
                int32_t found = find_in_cell(t, cell, x);
                if (found >= 0) return found;
            }
    return -1;
}

static void keep_vertex(weld_table *t, int32_t vertex) {
    int64_t cell[3];
    cell_of(t, t->m->vertex + 3 * (int64_t)vertex, 0.0, cell);
    uint64_t at = slot_of(t, cell);
    while (t->slot[at]) at = (at + 1) & t->mask;
    t->slot[at] = vertex + 1;
}

/* Replaces corners by what their vertices became, and drops triangles that lost one. */
static void rename_corners(mesh *m, const int32_t *name) {
    int64_t kept = 0;
    for (int64_t k = 0; k < m->triangle_count; k++) {
        const int32_t *old = m->triangle + 3 * k;
        int32_t a = name[old[0]], b = name[old[1]], c = name[old[2]];
        if (a == b || b == c || c == a) continue;
        int32_t *corner = m->triangle + 3 * kept++;
        corner[0] = a, corner[1] = b, corner[2] = c;
    }
    m->triangle_count = kept;
}

/* Leaves out vertices without triangles; `name` is scratch for one number a vertex. */
static void drop_unused(mesh *m, int32_t *name) {
    memset(name, 0, (size_t)m->vertex_count * sizeof *name);
    for (int64_t c = 0; c < 3 * m->triangle_count; c++) name[m->triangle[c]] = 1;
    int64_t kept = 0;
    for (int64_t v = 0; v < m->vertex_count; v++) {
        if (!name[v]) continue;
        memmove(m->vertex + 3 * kept, m->vertex + 3 * v, 3 * sizeof *m->vertex);
        name[v] = (int32_t)kept++;
    }
    m->vertex_count = kept;
    for (int64_t c = 0; c < 3 * m->triangle_count; c++) m->triangle[c] = name[m->triangle[c]];
}

/* Makes vertices nearer than `tolerance` one, and leaves out what that makes useless. */
static status weld(mesh *m, double tolerance, report *r) {
    size_t count = (size_t)m->vertex_count, slots = 2;
    while (slots < 2 * count) slots *= 2;
    weld_table t = {.m = m, .cell = 4 * tolerance, .tolerance = tolerance, .mask = slots - 1};
    int32_t *name = memory_allocate_array(count, sizeof *name);
    t.slot = memory_allocate_array(slots, sizeof *t.slot);
    status code = name && t.slot ? STATUS_OK : out_of_memory(r);
    if (code == STATUS_OK) {
        for (int i = 0; i < 3; i++) t.origin[i] = HUGE_VAL;
        for (size_t v = 0; v < 3 * count; v++) t.origin[v % 3] = fmin(t.origin[v % 3], m->vertex[v]);
        for (int32_t v = 0; v < (int32_t)count; v++) {
            int32_t near = find_near(&t, m->vertex + 3 * (int64_t)v);
            name[v] = near >= 0 ? near : v;
            if (near < 0) keep_vertex(&t, v);
        }
        rename_corners(m, name);
        drop_unused(m, name);
    }
    memory_free(t.slot, slots * sizeof *t.slot);
    memory_free(name, count * sizeof *name);
    return code;
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

status mesh_wrong_byte(const char *file, size_t byte, const char *expected, const char *found, report *r) {
    char key[40];
    snprintf(key, sizeof key, "byte %zu", byte);
    return report_input(r, file, 0, key, expected, found, NULL);
}

typedef status (*mesh_reader)(const char *file, const void *data, size_t size, mesh *m, report *r);

/* The reader that a file's ending asks for, or NULL. */
static mesh_reader reader_for(const char *file) {
    static const struct {
        const char *ending;
        mesh_reader read;
    } readers[] = {{".obj", mesh_read_obj}, {".ply", mesh_read_ply}, {".stl", mesh_read_stl}};
    size_t length = strlen(file);
    for (size_t i = 0; length >= 4 && i < sizeof readers / sizeof *readers; i++) {
        int same = 0;
        for (size_t k = 0; k < 4; k++) same += tolower((unsigned char)file[length - 4 + k]) == readers[i].ending[k];
        if (same == 4) return readers[i].read;
    }
    return NULL;
}

static double largest_extent(const mesh *m) {
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, extent = 0.0;
    for (int64_t i = 0; i < 3 * m->vertex_count; i++) {
        low[i % 3] = fmin(low[i % 3], m->vertex[i]);
        high[i % 3] = fmax(high[i % 3], m->vertex[i]);
    }
    for (int i = 0; i < 3; i++) extent = fmax(extent, high[i] - low[i]);
    return extent;
}

status mesh_read(const char *file, const void *data, size_t size, mesh *out, report *r) {
    *out = (mesh){0};
    mesh_reader read = reader_for(file);
    if (!read) return report_input(r, file, 0, NULL, "a mesh: a file that ends in .obj, .ply or .stl", "another ending", NULL);
    if (size == 0) return report_input(r, file, 0, NULL, "a mesh", "an empty file", NULL);
    status code = read(file, data, size, out, r);
    if (code == STATUS_INPUT && !r->file[0]) snprintf(r->file, sizeof r->file, "%.*s", NAME_SHOWN, file);
    if (code == STATUS_OK && out->triangle_count == 0)
        code = report_input(r, file, 0, NULL, "a mesh with triangles", "none", NULL);
    double extent = largest_extent(out);
    if (code == STATUS_OK && !(extent >= EXTENT_FLOOR))
        code = report_input(r, file, 0, NULL, "a mesh of some size", "all vertices in one place", NULL);
    if (code == STATUS_OK) code = weld(out, WELD_TOLERANCE * extent, r);
    if (code == STATUS_OK && out->triangle_count == 0)
        code = report_input(r, file, 0, NULL, "triangles of some size", "none that welding left", NULL);
    if (code != STATUS_OK) mesh_free(out);
    return code;
}
