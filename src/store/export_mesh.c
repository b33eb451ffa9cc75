/* Triangle meshes as PLY, OBJ and STL. */
#include "store/export_internal.h"

#include <inttypes.h>
#include <math.h>

static void write_ply(FILE *out, const void *mesh) {
    const export_mesh *m = mesh;
    fprintf(out, "ply\nformat binary_little_endian 1.0\ncomment sunder\nelement vertex %" PRId64 "\nproperty float x\nproperty float y\nproperty float z\n", m->vertex_count);
    if (m->value) fprintf(out, "property float %s\n", m->value_name);
    fprintf(out, "element face %" PRId64 "\nproperty list uchar int vertex_indices\nend_header\n", m->triangle_count);
    for (int64_t i = 0; i < m->vertex_count; i++) {
        for (int c = 0; c < 3; c++) export_put_f32(out, (double)m->vertex[3 * i + c]);
        if (m->value) export_put_f32(out, (double)m->value[i]);
    }
    for (int64_t i = 0; i < m->triangle_count; i++) {
        fputc(3, out);
        for (int c = 0; c < 3; c++) export_put_i32(out, m->triangle[3 * i + c]);
    }
}

static void write_obj(FILE *out, const void *mesh) {
    const export_mesh *m = mesh;
    fprintf(out, "# sunder: %" PRId64 " vertices, %" PRId64 " triangles\n", m->vertex_count, m->triangle_count);
    for (int64_t i = 0; i < m->vertex_count; i++) {
        const float *x = m->vertex + 3 * i;
        fprintf(out, "v %.9g %.9g %.9g\n", (double)x[0], (double)x[1], (double)x[2]);
    }
    for (int64_t i = 0; i < m->triangle_count; i++) {
        const int32_t *t = m->triangle + 3 * i;
        fprintf(out, "f %d %d %d\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
}

static void write_facet(FILE *out, const export_mesh *m, const int32_t t[3]) {
    const float *a = m->vertex + 3 * t[0], *b = m->vertex + 3 * t[1], *c = m->vertex + 3 * t[2];
    double u[3], v[3];
    for (int k = 0; k < 3; k++) u[k] = (double)(b[k] - a[k]), v[k] = (double)(c[k] - a[k]);
    double n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; k++) export_put_f32(out, length > 0 ? n[k] / length : 0);
    for (int corner = 0; corner < 3; corner++)
        for (int k = 0; k < 3; k++) export_put_f32(out, (double)m->vertex[3 * t[corner] + k]);
    fputc(0, out);
    fputc(0, out);
}

static void write_stl(FILE *out, const void *mesh) {
    const export_mesh *m = mesh;
    char header[80] = "sunder surface";
    fwrite(header, 1, sizeof header, out);
    export_put_i32(out, m->triangle_count);
    for (int64_t i = 0; i < m->triangle_count; i++) write_facet(out, m, m->triangle + 3 * i);
}

static const export_format formats[] = {{".ply", write_ply}, {".obj", write_obj}, {".stl", write_stl}};

status export_mesh_write(const char *path, const export_mesh *mesh, report *r) {
    return export_write(path, formats, sizeof formats / sizeof *formats, ".ply, .obj or .stl", mesh, r);
}
