/* A frame's particles as PLY, OBJ, VTP and CSV, and a sequence of VTP as PVD. */
#include "store/export_internal.h"

#include "base/json.h"

#include <inttypes.h>

static bool is_whole(const record *item) {
    return item->type != RECORD_F32 && item->type != RECORD_F64;
}

/* A column's name: the field's, with x y z or numbers behind it when it has several components. */
static void column_name(const record *item, int component, char text[80]) {
    const char *name = export_short_name(item);
    if (item->components == 1) snprintf(text, 80, "%s", name);
    else if (item->components == 3) snprintf(text, 80, "%s_%c", name, "xyz"[component]);
    else snprintf(text, 80, "%s_%d", name, component);
}

/* ---- PLY --------------------------------------------------------------------------------------------------------- */

/* The names that readers look for: x y z, and for velocities what Houdini and Blender keep as they are. */
static void write_ply_header(FILE *out, const export_points *p, int64_t count) {
    fprintf(out, "ply\nformat binary_little_endian 1.0\ncomment sunder frame %" PRId64 " time %.9g\nelement vertex %" PRId64 "\n", p->frame, p->time, count);
    fputs("property float x\nproperty float y\nproperty float z\n", out);
    const record *item;
    for (int k = 0; (item = export_field(p->records, p->set, k)); k++)
        for (int c = 0; c < item->components; c++) {
            char name[80];
            column_name(item, c, name);
            fprintf(out, "property %s %s\n", is_whole(item) ? "int" : "float", name);
        }
    fputs("end_header\n", out);
}

static void write_ply(FILE *out, const void *points) {
    const export_points *p = points;
    const record *position = export_positions(p->records, p->set), *item;
    write_ply_header(out, p, position->count);
    for (int64_t i = 0; i < position->count; i++) {
        for (int c = 0; c < 3; c++) export_put_f32(out, record_value(position, 3 * i + c));
        for (int k = 0; (item = export_field(p->records, p->set, k)); k++)
            for (int c = 0; c < item->components; c++) {
                double value = record_value(item, item->components * i + c);
                if (is_whole(item)) export_put_i32(out, (int64_t)value);
                else export_put_f32(out, value);
            }
    }
}

/* ---- OBJ, CSV ---------------------------------------------------------------------------------------------------- */

static void write_obj(FILE *out, const void *points) {
    const export_points *p = points;
    const record *position = export_positions(p->records, p->set);
    fprintf(out, "# sunder frame %" PRId64 " time %.9g: %" PRId64 " points\n", p->frame, p->time, position->count);
    for (int64_t i = 0; i < position->count; i++)
        fprintf(out, "v %.9g %.9g %.9g\n", record_value(position, 3 * i), record_value(position, 3 * i + 1), record_value(position, 3 * i + 2));
    /* Points that no element names are dropped by some readers. */
    for (int64_t i = 0; i < position->count; i++) fprintf(out, "p %" PRId64 "\n", i + 1);
}

static void write_csv(FILE *out, const void *points) {
    const export_points *p = points;
    const record *position = export_positions(p->records, p->set), *item;
    fputs("x,y,z", out);
    for (int k = 0; (item = export_field(p->records, p->set, k)); k++)
        for (int c = 0; c < item->components; c++) {
            char name[80];
            column_name(item, c, name);
            fprintf(out, ",%s", name);
        }
    fputc('\n', out);
    for (int64_t i = 0; i < position->count; i++) {
        for (int c = 0; c < 3; c++) fprintf(out, "%s%.9g", c ? "," : "", record_value(position, 3 * i + c));
        for (int k = 0; (item = export_field(p->records, p->set, k)); k++)
            for (int c = 0; c < item->components; c++) fprintf(out, ",%.9g", record_value(item, item->components * i + c));
        fputc('\n', out);
    }
}

/* ---- VTP --------------------------------------------------------------------------------------------------------- */

/* An array of the appended block: 4 bytes of size, then the values. */
static void declare_array(FILE *out, const char *name, const char *type, int components, int64_t count, int64_t *offset) {
    fprintf(out, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"appended\" offset=\"%" PRId64 "\"/>\n", type, name, components, *offset);
    *offset += 4 + 4 * count * components;
}

static void append_array(FILE *out, const record *item) {
    int64_t values = item->count * item->components;
    export_put_i32(out, 4 * values);
    for (int64_t i = 0; i < values; i++) {
        if (is_whole(item)) export_put_i32(out, (int64_t)record_value(item, i));
        else export_put_f32(out, record_value(item, i));
    }
}

static void append_numbers(FILE *out, int64_t count, int64_t first) {
    export_put_i32(out, 4 * count);
    for (int64_t i = 0; i < count; i++) export_put_i32(out, first + i);
}

static void write_vtp(FILE *out, const void *points) {
    const export_points *p = points;
    const record *position = export_positions(p->records, p->set), *item;
    int64_t n = position->count, offset = 0;
    fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\" byte_order=\"LittleEndian\">\n<PolyData>\n", out);
    fprintf(out, "<Piece NumberOfPoints=\"%" PRId64 "\" NumberOfVerts=\"%" PRId64 "\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n<Points>\n", n, n);
    declare_array(out, "position", "Float32", 3, n, &offset);
    fputs("</Points>\n<Verts>\n", out);
    declare_array(out, "connectivity", "Int32", 1, n, &offset);
    declare_array(out, "offsets", "Int32", 1, n, &offset);
    fputs("</Verts>\n<PointData>\n", out);
    for (int k = 0; (item = export_field(p->records, p->set, k)); k++)
        declare_array(out, export_short_name(item), is_whole(item) ? "Int32" : "Float32", item->components, n, &offset);
    fputs("</PointData>\n</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_", out);
    append_array(out, position);
    append_numbers(out, n, 0);
    append_numbers(out, n, 1);
    for (int k = 0; (item = export_field(p->records, p->set, k)); k++) append_array(out, item);
    fputs("\n</AppendedData>\n</VTKFile>\n", out);
}

status export_pvd_write(const char *path, const char *const *names, const double *times, int count, report *r) {
    export_file f;
    status code = export_begin(&f, path, r);
    if (code != STATUS_OK) return code;
    fputs("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n<Collection>\n", f.out);
    for (int i = 0; i < count; i++) {
        char time[JSON_NUMBER];
        json_format_number(times[i], time);
        fprintf(f.out, "<DataSet timestep=\"%s\" part=\"0\" file=\"%s\"/>\n", time, names[i]);
    }
    fputs("</Collection>\n</VTKFile>\n", f.out);
    return export_end(&f, STATUS_OK, r);
}

/* ---- the choice -------------------------------------------------------------------------------------------------- */

static const export_format formats[] = {{".ply", write_ply}, {".obj", write_obj}, {".vtp", write_vtp}, {".csv", write_csv}};

status export_points_write(const char *path, const export_points *points, report *r) {
    return export_write(path, formats, sizeof formats / sizeof *formats, ".ply, .obj, .vtp or .csv", points, r);
}
