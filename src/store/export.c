#include "store/export_internal.h"

#include "base/names.h"
#include "store/files.h"

#include <assert.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

status export_begin(export_file *f, const char *path, report *r) {
    *f = (export_file){.path = path};
    f->out = open_memstream(&f->text, &f->size);
    return f->out ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for %.400s", path);
}

status export_end(export_file *f, status outcome, report *r) {
    bool whole = fclose(f->out) == 0;
    if (outcome == STATUS_OK && !whole) outcome = report_set(r, STATUS_SYSTEM, "out of memory for %.400s", f->path);
    if (outcome == STATUS_OK) outcome = file_write_whole(f->path, f->text, f->size, r);
    free(f->text);
    return outcome;
}

/* Suffix of a path, "" for none. */
static const char *suffix_of(const char *path) {
    const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
    return dot ? dot : "";
}

status export_write(const char *path, const export_format *formats, int count, const char *expected, const void *thing, report *r) {
    enum { MOST = 8 };
    const char *names[MOST], *suffix = suffix_of(path);
    assert(count <= MOST);
    for (int i = 0; i < count; i++) {
        names[i] = formats[i].suffix;
        if (strcmp(suffix, formats[i].suffix) != 0) continue;
        export_file f;
        status code = export_begin(&f, path, r);
        if (code != STATUS_OK) return code;
        formats[i].write(f.out, thing);
        return export_end(&f, STATUS_OK, r);
    }
    return report_input(r, path, 0, "suffix", expected, *suffix ? suffix : "none", name_nearest(suffix, names, count));
}

const record *export_positions(const record_list *records, const char *set) {
    char name[RECORD_NAME];
    snprintf(name, sizeof name, "%s/position", set);
    const record *item = record_find(records, name);
    return item && item->components == 3 ? item : NULL;
}

const char *export_set(const record_list *records) {
    return export_positions(records, "solid") ? "solid" : export_positions(records, "sheet") ? "sheet" : NULL;
}

const char *export_short_name(const record *item) {
    const char *slash = strchr(item->name, '/');
    return slash ? slash + 1 : item->name;
}

const record *export_field(const record_list *records, const char *set, int index) {
    const record *position = export_positions(records, set);
    size_t front = strlen(set);
    for (int i = 0; i < records->count; i++) {
        const record *item = &records->items[i];
        const char *name = export_short_name(item);
        if (strncmp(item->name, set, front) != 0 || item->name[front] != '/' || item->count != position->count) continue;
        if (strcmp(name, "position") == 0 || strcmp(name, "tetrahedra") == 0 || strncmp(name, "bond", 4) == 0) continue;
        if (index-- == 0) return item;
    }
    return NULL;
}

status export_sequence_path(const char *out, int64_t frame, char path[1024], report *r) {
    const char *suffix = suffix_of(out);
    int front = (int)(strlen(out) - strlen(suffix));
    if (snprintf(path, 1024, "%.*s.%06" PRId64 "%s", front, out, frame, suffix) < 1024) return STATUS_OK;
    return report_input(r, out, 0, "--out", "a shorter path", "one that does not fit", NULL);
}

static void put_u32(FILE *out, uint32_t bits) {
    for (int i = 0; i < 4; i++, bits >>= 8) fputc((int)(bits & 0xff), out);
}

void export_put_f32(FILE *out, double value) {
    float narrow = (float)value;
    uint32_t bits;
    memcpy(&bits, &narrow, sizeof bits);
    put_u32(out, bits);
}

void export_put_i32(FILE *out, int64_t value) {
    put_u32(out, (uint32_t)value);
}
