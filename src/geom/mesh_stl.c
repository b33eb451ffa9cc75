/* STL: three corners a triangle, as text or as 50 bytes each. Which of the two is told by the size: files of both kinds
 * begin with "solid". */
#include "geom/mesh_build.h"
#include "geom/text.h"

#include <stdio.h>
#include <string.h>

enum { HEADER = 80, COUNT_END = 84, RECORD = 50, CORNERS_AT = 12 };

/* ---- binary ------------------------------------------------------------------------------------------------------ */

static uint32_t little_u32(const uint8_t *bytes) {
    return (uint32_t)bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static double little_f32(const uint8_t *bytes) {
    uint32_t bits = little_u32(bytes);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

static status add_three(mesh *m, report *r) {
    return mesh_add_triangle(m, m->vertex_count - 3, m->vertex_count - 2, m->vertex_count - 1, r);
}

static status read_record(const char *file, const uint8_t *data, size_t at, mesh *m, report *r) {
    for (int corner = 0; corner < 3; corner++) {
        double x[3];
        for (int i = 0; i < 3; i++) {
            size_t place = at + CORNERS_AT + 12 * (size_t)corner + 4 * (size_t)i;
            x[i] = little_f32(data + place);
            if (mesh_coordinate_ok(x[i])) continue;
            char found[40];
            snprintf(found, sizeof found, "%g", x[i]);
            return mesh_wrong_byte(file, place, "a finite coordinate", found, r);
        }
        status code = mesh_add_vertex(m, x, r);
        if (code != STATUS_OK) return code;
    }
    return add_three(m, r);
}

static status read_binary(const char *file, const uint8_t *data, size_t size, mesh *m, report *r) {
    char expected[120], found[60];
    snprintf(found, sizeof found, "%zu bytes", size);
    if (size < COUNT_END)
        return mesh_wrong_byte(file, size, "an STL file: \"solid\", or 80 bytes and a number of triangles", found, r);
    uint64_t count = little_u32(data + HEADER);
    if (count > (size - COUNT_END) / RECORD) {
        unsigned long long wanted = COUNT_END + RECORD * (unsigned long long)count;
        snprintf(expected, sizeof expected, "%llu bytes for %llu triangles", wanted, (unsigned long long)count);
        return mesh_wrong_byte(file, HEADER, expected, found, r);
    }
    status code = STATUS_OK;
    for (uint64_t i = 0; i < count && code == STATUS_OK; i++)
        code = read_record(file, data, COUNT_END + RECORD * (size_t)i, m, r);
    return code;
}

/* ---- text -------------------------------------------------------------------------------------------------------- */

/* The normal's three words are skipped unread: the order of the corners says the same, and many writers put NaN. */
static void skip_normal(text_reader *t) {
    text_word word;
    for (int i = 0; i < 3; i++) text_next_word(t, &word);
}

static status read_text(const char *file, const void *data, size_t size, mesh *m, report *r) {
    text_reader t = text_open(file, data, size);
    text_word word;
    int corners = 0; /* since "loop" */
    bool ended = false;
    while (text_next_word(&t, &word)) {
        status code = STATUS_OK;
        ended = text_is(&word, "endsolid");
        if (text_is(&word, "solid") || ended) {
            while (text_word_on_line(&t, &word)) {}
        } else if (text_is(&word, "vertex")) {
            corners++;
            code = mesh_read_vertex(&t, text_next_word, "vertex", m, r);
        } else if (text_is(&word, "endloop")) {
            code = corners == 3 ? add_three(m, r) : text_wrong(&t, "loop", "three vertices before endloop", &word, r);
            corners = 0;
        } else if (text_is(&word, "normal")) {
            skip_normal(&t);
        } else if (!text_is(&word, "facet") && !text_is(&word, "outer") && !text_is(&word, "loop") &&
                   !text_is(&word, "endfacet")) {
            code = text_wrong(&t, NULL, "facet, outer loop, vertex, endloop, endfacet or endsolid", &word, r);
        }
        if (code != STATUS_OK) return code;
    }
    return ended ? STATUS_OK : text_wrong(&t, NULL, "endsolid", NULL, r);
}

status mesh_read_stl(const char *file, const void *data, size_t size, mesh *m, report *r) {
    bool sized = size >= COUNT_END && size == COUNT_END + RECORD * (uint64_t)little_u32((const uint8_t *)data + HEADER);
    text_reader t = text_open(file, data, size);
    text_word word;
    bool text = !sized && text_next_word(&t, &word) && text_is(&word, "solid");
    return text ? read_text(file, data, size, m, r) : read_binary(file, data, size, m, r);
}
