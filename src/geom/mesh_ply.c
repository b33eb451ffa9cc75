/* PLY: a header that lists elements and their properties, then the values as text or in either byte order. Read are the
 * x, y, z of "vertex" and the list vertex_indices (or vertex_index) of "face"; the rest is skipped. */
#include "geom/mesh_build.h"
#include "geom/text.h"

#include <stdio.h>
#include <string.h>

enum { ELEMENTS = 16, PROPERTIES = 64, ROLE_NONE = -1, ROLE_CORNERS = 3 };

typedef enum ply_format { PLY_TEXT, PLY_LITTLE, PLY_BIG } ply_format;
typedef enum ply_type { PLY_I8, PLY_U8, PLY_I16, PLY_U16, PLY_I32, PLY_U32, PLY_F32, PLY_F64, PLY_TYPES } ply_type;

static const char *const type_names[PLY_TYPES][2] = {
    {"char", "int8"}, {"uchar", "uint8"}, {"short", "int16"},   {"ushort", "uint16"},
    {"int", "int32"}, {"uint", "uint32"}, {"float", "float32"}, {"double", "float64"},
};
static const size_t type_sizes[PLY_TYPES] = {1, 1, 2, 2, 4, 4, 4, 8};

typedef struct ply_property {
    ply_type type;
    bool list;
    ply_type count_type; /* of lists */
    int role;            /* 0, 1, 2: a coordinate; ROLE_CORNERS: a face's list */
} ply_property;

typedef struct ply_element {
    int64_t count;
    int property_count, roles; /* roles: bit by role */
    bool vertices, faces;
    ply_property property[PROPERTIES];
} ply_element;

typedef struct ply_reader {
    text_reader text; /* the header's, and the body's when that is text */
    const uint8_t *start;
    ply_format format;
    int element_count;
    ply_element element[ELEMENTS];
    int64_t vertices; /* announced */
    mesh *m;
    report *r;
} ply_reader;

/* ---- header ------------------------------------------------------------------------------------------------------ */

static status wrong(ply_reader *p, const char *key, const char *expected, const text_word *found) {
    return text_wrong(&p->text, key, expected, found->size ? found : NULL, p->r);
}

static status read_format(ply_reader *p) {
    static const char *const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    text_word word;
    text_word_on_line(&p->text, &word);
    for (int i = 0; i < 3; i++) {
        if (!text_is(&word, formats[i])) continue;
        p->format = (ply_format)i;
        return STATUS_OK;
    }
    return wrong(p, "format", "ascii, binary_little_endian or binary_big_endian", &word);
}

static status read_element(ply_reader *p) {
    text_word name, word;
    double count;
    if (!text_word_on_line(&p->text, &name)) return wrong(p, "element", "a name and a count", &name);
    if (!text_word_on_line(&p->text, &word) || !text_number(&word, &count) || !(count >= 0 && count <= INT32_MAX) ||
        count != (double)(int64_t)count)
        return wrong(p, "element", "a count of 0 to 2147483647", &word);
    if (p->element_count == ELEMENTS) return wrong(p, "element", "at most 16 elements", &name);
    ply_element *e = &p->element[p->element_count++];
    *e = (ply_element){.count = (int64_t)count, .vertices = text_is(&name, "vertex"), .faces = text_is(&name, "face")};
    if (e->vertices) p->vertices = e->count;
    return STATUS_OK;
}

static status read_type(ply_reader *p, const text_word *word, ply_type *type) {
    for (int i = 0; i < PLY_TYPES; i++) {
        if (!text_is(word, type_names[i][0]) && !text_is(word, type_names[i][1])) continue;
        *type = (ply_type)i;
        return STATUS_OK;
    }
    return wrong(p, "property", "a type, such as float or uchar", word);
}

static int role_of(const ply_element *e, const ply_property *property, const text_word *name) {
    static const char *const coordinates[] = {"x", "y", "z"};
    for (int i = 0; e->vertices && !property->list && i < 3; i++)
        if (text_is(name, coordinates[i])) return i;
    bool corners = text_is(name, "vertex_indices") || text_is(name, "vertex_index");
    return e->faces && property->list && corners ? ROLE_CORNERS : ROLE_NONE;
}

static status read_property(ply_reader *p) {
    text_word word;
    text_word_on_line(&p->text, &word);
    ply_element *e = p->element_count ? &p->element[p->element_count - 1] : NULL;
    if (!e) return wrong(p, "property", "an element before its properties", &word);
    if (e->property_count == PROPERTIES) return wrong(p, "property", "at most 64 properties of an element", &word);
    ply_property *property = &e->property[e->property_count++];
    *property = (ply_property){.list = text_is(&word, "list")};
    status code = STATUS_OK;
    if (property->list) {
        text_word_on_line(&p->text, &word);
        code = read_type(p, &word, &property->count_type);
        if (code == STATUS_OK && property->count_type >= PLY_F32)
            code = wrong(p, "property", "a whole type for a list's count", &word);
        if (code == STATUS_OK) text_word_on_line(&p->text, &word);
    }
    if (code == STATUS_OK) code = read_type(p, &word, &property->type);
    if (code != STATUS_OK) return code;
    text_word_on_line(&p->text, &word);
    property->role = role_of(e, property, &word);
    if (property->role != ROLE_NONE) e->roles |= 1 << property->role;
    return STATUS_OK;
}

/* Leaves the reader on the first byte of the body. */
static status read_header(ply_reader *p) {
    text_word word;
    bool begun = text_word_on_line(&p->text, &word) && text_is(&word, "ply"), formatted = false;
    if (!begun) return wrong(p, NULL, "\"ply\"", &word);
    while (text_next_line(&p->text)) {
        status code = STATUS_OK;
        if (!text_word_on_line(&p->text, &word)) continue;
        if (text_is(&word, "format")) {
            code = read_format(p);
            formatted = true;
        } else if (text_is(&word, "element")) code = read_element(p);
        else if (text_is(&word, "property")) code = read_property(p);
        else if (text_is(&word, "end_header")) {
            text_next_line(&p->text);
            return formatted ? STATUS_OK : wrong(p, "format", "a format line in the header", &word);
        } else if (!text_is(&word, "comment") && !text_is(&word, "obj_info"))
            code = wrong(p, NULL, "format, element, property, comment, obj_info or end_header", &word);
        if (code != STATUS_OK) return code;
    }
    return text_wrong(&p->text, NULL, "end_header", NULL, p->r);
}

/* What the header must announce. An element without properties would be a count that no byte of the file backs. */
static status check_header(ply_reader *p) {
    bool vertices = false, faces = false;
    for (int i = 0; i < p->element_count; i++) {
        const ply_element *e = &p->element[i];
        if (e->count > 0 && e->property_count == 0)
            return report_input(p->r, p->text.file, 0, "header", "properties of every element", "none", NULL);
        if (e->vertices) vertices = e->roles == 7;
        if (e->faces) faces = e->roles == 1 << ROLE_CORNERS;
    }
    if (vertices && faces) return STATUS_OK;
    const char *missing = vertices ? "an element \"face\" with a list vertex_indices"
                                   : "an element \"vertex\" with x, y and z";
    return report_input(p->r, p->text.file, 0, "header", missing, "none", NULL);
}

/* ---- values ------------------------------------------------------------------------------------------------------ */

static double decode(const uint8_t *bytes, ply_type type, bool big) {
    uint64_t bits = 0;
    size_t size = type_sizes[type];
    for (size_t i = 0; i < size; i++) bits = bits << 8 | bytes[big ? i : size - 1 - i];
    float single;
    double value;
    uint32_t half = (uint32_t)bits;
    switch (type) {
    case PLY_I8: return (double)(int8_t)bits;
    case PLY_I16: return (double)(int16_t)bits;
    case PLY_I32: return (double)(int32_t)bits;
    case PLY_F32: memcpy(&single, &half, sizeof single); return (double)single;
    case PLY_F64: memcpy(&value, &bits, sizeof value); return value;
    default: return (double)bits;
    }
}

/* Wrong at the value of `type` that was just read: its word, or its bytes. */
static status wrong_value(ply_reader *p, ply_type type, const char *expected, double found, const text_word *word) {
    if (p->format == PLY_TEXT) return text_wrong(&p->text, NULL, expected, word, p->r);
    char shown[40];
    snprintf(shown, sizeof shown, "%.9g", found);
    size_t at = (size_t)((const uint8_t *)p->text.at - p->start) - type_sizes[type];
    return mesh_wrong_byte(p->text.file, at, expected, shown, p->r);
}

static status read_value(ply_reader *p, ply_type type, const char *expected, double *value, text_word *word) {
    if (p->format == PLY_TEXT) {
        bool found = text_next_word(&p->text, word);
        return found && text_number(word, value) ? STATUS_OK
                                                 : text_wrong(&p->text, NULL, expected, found ? word : NULL, p->r);
    }
    size_t left = (size_t)(p->text.end - p->text.at), at = (size_t)((const uint8_t *)p->text.at - p->start);
    if (left < type_sizes[type]) return mesh_wrong_byte(p->text.file, at, expected, "the end of the file", p->r);
    *value = decode((const uint8_t *)p->text.at, type, p->format == PLY_BIG);
    p->text.at += type_sizes[type];
    return STATUS_OK;
}

/* A corner of a face: an index, and the triangle that it completes. */
static status take_corner(ply_reader *p, const ply_property *property, int64_t number, int64_t fan[2]) {
    char expected[60];
    double value;
    text_word word;
    snprintf(expected, sizeof expected, "a vertex by number, 0 to %lld", (long long)p->vertices - 1);
    status code = read_value(p, property->type, expected, &value, &word);
    if (code != STATUS_OK) return code;
    if (!(value >= 0 && value < (double)p->vertices) || value != (double)(int64_t)value)
        return wrong_value(p, property->type, expected, value, &word);
    int64_t corner = (int64_t)value;
    if (number >= 2) code = mesh_add_triangle(p->m, fan[0], fan[1], corner, p->r);
    fan[number == 0 ? 0 : 1] = corner;
    return code;
}

/* The items of a list cost a byte each at least: a count that the file cannot back ends at the file's end. */
static status read_list(ply_reader *p, const ply_property *property) {
    double count, value;
    text_word word;
    bool corners = property->role == ROLE_CORNERS;
    const char *expected = corners ? "three corners or more" : "a count of list items";
    status code = read_value(p, property->count_type, expected, &count, &word);
    if (code != STATUS_OK) return code;
    bool whole = count >= 0 && count <= UINT32_MAX && count == (double)(int64_t)count;
    if (!whole || (corners && count < 3)) return wrong_value(p, property->count_type, expected, count, &word);
    int64_t fan[2] = {0, 0};
    for (int64_t i = 0; i < (int64_t)count && code == STATUS_OK; i++) {
        if (corners) code = take_corner(p, property, i, fan);
        else code = read_value(p, property->type, "a list item", &value, &word);
    }
    return code;
}

static status read_record(ply_reader *p, const ply_element *e) {
    double x[3] = {0, 0, 0}, value;
    text_word word;
    for (int i = 0; i < e->property_count; i++) {
        const ply_property *property = &e->property[i];
        bool coordinate = property->role >= 0 && property->role < 3;
        const char *expected = coordinate ? "a finite coordinate" : "a value";
        status code = property->list ? read_list(p, property) : read_value(p, property->type, expected, &value, &word);
        if (code != STATUS_OK) return code;
        if (coordinate && !mesh_coordinate_ok(value)) return wrong_value(p, property->type, expected, value, &word);
        if (coordinate) x[property->role] = value;
    }
    return e->vertices ? mesh_add_vertex(p->m, x, p->r) : STATUS_OK;
}

status mesh_read_ply(const char *file, const void *data, size_t size, mesh *m, report *r) {
    ply_reader p = {.text = text_open(file, data, size), .start = data, .m = m, .r = r};
    status code = read_header(&p);
    if (code == STATUS_OK) code = check_header(&p);
    for (int i = 0; i < p.element_count && code == STATUS_OK; i++)
        for (int64_t k = 0; k < p.element[i].count && code == STATUS_OK; k++) code = read_record(&p, &p.element[i]);
    return code;
}
