/* Meshes made by the tests, and the files of every format that hold them. */
#ifndef SUNDER_TESTS_MESH_FILES_H
#define SUNDER_TESTS_MESH_FILES_H

#include "base/memory.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MADE_VERTICES = 84000, MADE_TRIANGLES = 84000 };

typedef struct made_mesh {
    int vertices, triangles;
    double vertex[MADE_VERTICES][3];
    int triangle[MADE_TRIANGLES][3];
} made_mesh;

typedef struct made_file {
    char *data;
    size_t size;
} made_file;

static inline int made_vertex(made_mesh *m, double x, double y, double z) {
    double *to = m->vertex[m->vertices];
    to[0] = x, to[1] = y, to[2] = z;
    return m->vertices++;
}

static inline void made_triangle(made_mesh *m, int a, int b, int c) {
    int *to = m->triangle[m->triangles++];
    to[0] = a, to[1] = b, to[2] = c;
}

/* A box from low to high: twelve triangles; added to what is there. */
static inline void made_box(made_mesh *m, const double low[3], const double high[3]) {
    static const int face[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    int first = m->vertices;
    for (int k = 0; k < 8; k++) made_vertex(m, k & 1 ? high[0] : low[0], k & 2 ? high[1] : low[1], k & 4 ? high[2] : low[2]);
    for (int f = 0; f < 6; f++) {
        made_triangle(m, first + face[f][0], first + face[f][1], first + face[f][2]);
        made_triangle(m, first + face[f][0], first + face[f][2], first + face[f][3]);
    }
}

/* The middle of an edge, on the unit sphere; made twice where two triangles ask: meshes are welded anyway. */
static inline int made_middle(made_mesh *m, int a, int b) {
    double x[3], length = 0;
    for (int i = 0; i < 3; i++) x[i] = m->vertex[a][i] + m->vertex[b][i], length += x[i] * x[i];
    length = sqrt(length);
    return made_vertex(m, x[0] / length, x[1] / length, x[2] / length);
}

/* An icosahedron on the unit sphere, its triangles cut in four `level` times: 20 × 4^level triangles. */
static inline void made_sphere(made_mesh *m, int level) {
    static const int face[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},   {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                                    {3, 8, 9},  {4, 9, 5},  {2, 4, 11},  {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    double golden = 0.5 * (1 + sqrt(5.0)), scale = 1 / sqrt(1 + golden * golden), a = scale, b = golden * scale;
    const double corner[12][3] = {{-a, b, 0}, {a, b, 0},  {-a, -b, 0}, {a, -b, 0}, {0, -a, b},  {0, a, b},
                                  {0, -a, -b}, {0, a, -b}, {b, 0, -a},  {b, 0, a},  {-b, 0, -a}, {-b, 0, a}};
    *m = (made_mesh){0};
    for (int v = 0; v < 12; v++) made_vertex(m, corner[v][0], corner[v][1], corner[v][2]);
    for (int f = 0; f < 20; f++) made_triangle(m, face[f][0], face[f][1], face[f][2]);
    for (int l = 0; l < level; l++)
        for (int t = 0, old = m->triangles; t < old; t++) {
            int p = m->triangle[t][0], q = m->triangle[t][1], r = m->triangle[t][2];
            int pq = made_middle(m, p, q), qr = made_middle(m, q, r), rp = made_middle(m, r, p);
            int *whole = m->triangle[t];
            whole[0] = pq, whole[1] = qr, whole[2] = rp;
            made_triangle(m, p, pq, rp);
            made_triangle(m, q, qr, pq);
            made_triangle(m, r, rp, qr);
        }
}

/* A ring around z of `around` × `across` quadrilaterals. */
static inline void made_torus(made_mesh *m, double major, double minor, int around, int across) {
    const double turn = 2 * acos(-1.0);
    *m = (made_mesh){0};
    for (int i = 0; i < around; i++)
        for (int k = 0; k < across; k++) {
            double u = turn * i / around, v = turn * k / across, radius = major + minor * cos(v);
            made_vertex(m, radius * cos(u), radius * sin(u), minor * sin(v));
        }
    for (int i = 0; i < around; i++)
        for (int k = 0; k < across; k++) {
            int next = (i + 1) % around, up = (k + 1) % across;
            int p = i * across + k, q = next * across + k, r = next * across + up, s = i * across + up;
            made_triangle(m, p, q, r);
            made_triangle(m, p, r, s);
        }
}

/* x ↦ scale x + shift for the vertices from `first` on. */
static inline void made_move(made_mesh *m, int first, double scale, double dx, double dy, double dz) {
    const double shift[3] = {dx, dy, dz};
    for (int v = first; v < m->vertices; v++)
        for (int i = 0; i < 3; i++) m->vertex[v][i] = scale * m->vertex[v][i] + shift[i];
}

/* Adds a copy of `other`. */
static inline void made_add(made_mesh *m, const made_mesh *other) {
    int first = m->vertices;
    for (int v = 0; v < other->vertices; v++) made_vertex(m, other->vertex[v][0], other->vertex[v][1], other->vertex[v][2]);
    for (int t = 0; t < other->triangles; t++)
        made_triangle(m, first + other->triangle[t][0], first + other->triangle[t][1], first + other->triangle[t][2]);
}

static inline void made_turn(made_mesh *m, int triangle) {
    int kept = m->triangle[triangle][1];
    m->triangle[triangle][1] = m->triangle[triangle][2], m->triangle[triangle][2] = kept;
}

/* ---- files ------------------------------------------------------------------------------------------------------- */

static inline FILE *made_open(made_file *f) {
    FILE *out = open_memstream(&f->data, &f->size);
    if (!out) exit(1);
    return out;
}

static inline void put_bytes(FILE *out, const void *value, size_t size, bool big) {
    const unsigned char *bytes = value; /* of a little-endian machine */
    for (size_t i = 0; i < size; i++) fputc(bytes[big ? size - 1 - i : i], out);
}

static inline made_file made_obj(const made_mesh *m) {
    made_file f;
    FILE *out = made_open(&f);
    fprintf(out, "# made by a test\no thing\n");
    for (int v = 0; v < m->vertices; v++) fprintf(out, "v %.17g %.17g %.17g\n", m->vertex[v][0], m->vertex[v][1], m->vertex[v][2]);
    for (int t = 0; t < m->triangles; t++)
        fprintf(out, "f %d %d %d\n", m->triangle[t][0] + 1, m->triangle[t][1] + 1, m->triangle[t][2] + 1);
    fclose(out);
    return f;
}

/* format: "ascii", "binary_little_endian" or "binary_big_endian". Has a colour and an element that readers must skip. */
static inline made_file made_ply(const made_mesh *m, const char *format) {
    made_file f;
    FILE *out = made_open(&f);
    bool text = format[0] == 'a', big = strstr(format, "big") != NULL;
    fprintf(out, "ply\nformat %s 1.0\ncomment made by a test\nelement vertex %d\n", format, m->vertices);
    fprintf(out, "property double x\nproperty uchar red\nproperty double y\nproperty float64 z\n");
    fprintf(out, "element strip 2\nproperty list uchar short item\nproperty int last\n");
    fprintf(out, "element face %d\nproperty uchar flag\nproperty list uint8 int vertex_indices\nend_header\n", m->triangles);
    for (int v = 0; v < m->vertices; v++) {
        const double *x = m->vertex[v];
        if (text) fprintf(out, "%.17g 7 %.17g %.17g\n", x[0], x[1], x[2]);
        if (text) continue;
        put_bytes(out, &x[0], 8, big), fputc(7, out), put_bytes(out, &x[1], 8, big), put_bytes(out, &x[2], 8, big);
    }
    for (int i = 0; i < 2; i++) {
        const short item[2] = {5, -6};
        const int last = -7;
        if (text) fprintf(out, "2 5 -6 -7\n");
        if (text) continue;
        fputc(2, out), put_bytes(out, &item[0], 2, big), put_bytes(out, &item[1], 2, big), put_bytes(out, &last, 4, big);
    }
    for (int t = 0; t < m->triangles; t++) {
        if (text) fprintf(out, "1 3 %d %d %d\n", m->triangle[t][0], m->triangle[t][1], m->triangle[t][2]);
        if (text) continue;
        fputc(1, out), fputc(3, out);
        for (int k = 0; k < 3; k++) put_bytes(out, &m->triangle[t][k], 4, big);
    }
    fclose(out);
    return f;
}

static inline made_file made_stl(const made_mesh *m, bool text) {
    made_file f;
    FILE *out = made_open(&f);
    const float normal[3] = {0, 0, NAN};
    if (text) fprintf(out, "solid made by a test\n");
    else fprintf(out, "%-80s", "solid, says the header of many a binary file");
    if (!text) put_bytes(out, &m->triangles, 4, false);
    for (int t = 0; t < m->triangles; t++) {
        if (text) fprintf(out, " facet normal 0 0 nan\n  outer loop\n");
        else put_bytes(out, normal, sizeof normal, false);
        for (int k = 0; k < 3; k++) {
            const double *x = m->vertex[m->triangle[t][k]];
            if (text) fprintf(out, "   vertex %.9g %.9g %.9g\n", x[0], x[1], x[2]);
            for (int i = 0; i < 3 && !text; i++) put_bytes(out, &(float){(float)x[i]}, 4, false);
        }
        if (text) fprintf(out, "  endloop\n endfacet\n");
        else fputc(0, out), fputc(0, out);
    }
    if (text) fprintf(out, "endsolid made by a test\n");
    fclose(out);
    return f;
}

#endif
