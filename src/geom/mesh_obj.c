/* Wavefront OBJ: v and f lines; everything else is skipped. */
#include "geom/mesh_build.h"
#include "geom/text.h"

#include <stdio.h>
#include <string.h>

/* A corner is "7", "7/1", "7//3" or "7/1/3"; −1 is the last vertex so far. */
static status read_corner(const text_reader *t, const mesh *m, const text_word *word, int64_t *corner, report *r) {
    const char *slash = memchr(word->text, '/', word->size);
    text_word index = {word->text, slash ? (size_t)(slash - word->text) : word->size};
    double value;
    bool number = text_number(&index, &value);
    double last = (double)m->vertex_count;
    if (number && value < 0) value += last + 1;
    if (number && value >= 1 && value <= last && value == (double)(int64_t)value) {
        *corner = (int64_t)value - 1;
        return STATUS_OK;
    }
    char expected[80];
    long long count = (long long)m->vertex_count;
    snprintf(expected, sizeof expected, "vertices by number, 1 to %lld (or -1 to -%lld)", count, count);
    return text_wrong(t, "f", count ? expected : "v lines before the first f line", word, r);
}

/* A polygon as a fan around its first corner. */
static status read_face(text_reader *t, mesh *m, report *r) {
    int64_t first = 0, last = 0, corner = 0;
    text_word word;
    int64_t count = 0;
    for (; text_word_on_line(t, &word) && word.text[0] != '#'; count++) {
        status code = read_corner(t, m, &word, &corner, r);
        if (code == STATUS_OK && count >= 2) code = mesh_add_triangle(m, first, last, corner, r);
        if (code != STATUS_OK) return code;
        if (count == 0) first = corner;
        last = corner;
    }
    return count >= 3 ? STATUS_OK : text_wrong(t, "f", "at least three corners", NULL, r);
}

status mesh_read_obj(const char *file, const void *data, size_t size, mesh *m, report *r) {
    text_reader t = text_open(file, data, size);
    do {
        text_word word;
        status code = STATUS_OK;
        if (!text_word_on_line(&t, &word)) continue;
        if (text_is(&word, "v")) code = mesh_read_vertex(&t, text_word_on_line, "v", m, r);
        else if (text_is(&word, "f")) code = read_face(&t, m, r);
        if (code != STATUS_OK) return code;
    } while (text_next_line(&t));
    return STATUS_OK;
}
