#include "store/series.h"

#include "base/json.h"
#include "base/memory.h"
#include "store/files.h"
#include "store/hdf.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LINE = 96 }; /* the longest line: two numbers and some words */

#define SERIES_NAME "frames.hdf.series"
#define ENTRY_FRONT "{\"name\": \""

/* What the series in the folder says of one frame. */
typedef struct known {
    int64_t number;
    const char *time; /* digits inside the old text */
    size_t length;
} known;

typedef struct series {
    char *old; /* the series that was there, or NULL */
    size_t old_size;
    known *known; /* [known_count], ascending */
    size_t known_count, known_capacity;
    char *text; /* the new one */
    size_t used, capacity;
} series;

static void series_free(series *s) {
    memory_free(s->old, s->old ? s->old_size + 1 : 0);
    memory_free(s->known, s->known_capacity * sizeof *s->known);
    memory_free(s->text, s->capacity);
}

static int by_number(const void *a, const void *b) {
    int64_t x = ((const known *)a)->number, y = ((const known *)b)->number;
    return (x > y) - (x < y);
}

/* Takes what it can from the old text. Only lines that look as append_line writes them are believed: anything else is
 * as good as absent, and the frame itself is asked. */
static status parse_old(series *s, report *r) {
    size_t lines = 0;
    for (const char *at = s->old; at && (at = strstr(at, ENTRY_FRONT)); at++) lines++;
    if (lines == 0) return STATUS_OK;
    s->known = memory_allocate_array(lines, sizeof *s->known);
    if (!s->known) return report_set(r, STATUS_SYSTEM, "out of memory for the times of %zu frames", lines);
    s->known_capacity = lines;
    for (const char *at = s->old; (at = strstr(at, ENTRY_FRONT));) {
        at += strlen(ENTRY_FRONT);
        char *end;
        int64_t number = strtoll(at, &end, 10);
        static const char middle[] = ".hdf\", \"time\": ";
        if (end - at < 6 || number < 0 || strncmp(end, middle, sizeof middle - 1) != 0) continue;
        const char *time = end + sizeof middle - 1;
        size_t length = strspn(time, "+-.0123456789e");
        if (length > 0 && length < JSON_NUMBER && time[length] == '}')
            s->known[s->known_count++] = (known){number, time, length};
    }
    qsort(s->known, s->known_count, sizeof *s->known, by_number);
    return STATUS_OK;
}

/* The time of a frame in text; false when the file cannot be opened, which keeps it out of the series. */
static bool ask_frame(const char *folder, int64_t number, char time[JSON_NUMBER]) {
    char path[FILE_PATH];
    report ignored;
    hid_t file;
    double value;
    if (path_format(path, &ignored, "%s/%06" PRId64 ".hdf", folder, number) || hdf_open(path, &file, &ignored))
        return false;
    bool good = hdf_read_number(file, path, "time", &value, &ignored) == STATUS_OK;
    H5Fclose(file);
    if (good) json_format_number(value, time);
    return good;
}

static void append_line(series *s, int64_t number, const char *time, bool first) {
    int written = snprintf(s->text + s->used, s->capacity - s->used,
                           "%s    " ENTRY_FRONT "%06" PRId64 ".hdf\", \"time\": %s}", first ? "" : ",\n", number, time);
    s->used += (size_t)written;
}

static status compose(series *s, const char *folder, const file_numbers *numbers, int64_t fresh, int64_t limit,
                      report *r) {
    static const char front[] = "{\n  \"file-series-version\": \"1.0\",\n  \"files\": [\n", back[] = "\n  ]\n}\n";
    s->capacity = sizeof front + sizeof back + numbers->count * LINE;
    s->text = memory_allocate(s->capacity);
    if (!s->text) return report_set(r, STATUS_SYSTEM, "out of memory for a series of %zu frames", numbers->count);
    memcpy(s->text, front, s->used = sizeof front - 1);
    bool first = true;
    for (size_t i = 0; i < numbers->count; i++) {
        known key = {.number = numbers->items[i]};
        if (limit >= 0 && key.number > limit) break;
        const known *old = s->known_count == 0 || key.number == fresh
                               ? NULL
                               : bsearch(&key, s->known, s->known_count, sizeof key, by_number);
        char time[JSON_NUMBER];
        if (old)
            snprintf(time, sizeof time, "%.*s", (int)old->length, old->time);
        else if (!ask_frame(folder, key.number, time))
            continue;
        append_line(s, key.number, time, first);
        first = false;
    }
    memcpy(s->text + s->used, back, sizeof back - 1);
    s->used += sizeof back - 1;
    return STATUS_OK;
}

status series_refresh(const char *folder, int64_t fresh, int64_t limit, report *r) {
    char path[FILE_PATH];
    series s = {0};
    file_numbers numbers = {0};
    status outcome = path_format(path, r, "%s/" SERIES_NAME, folder);
    if (!outcome) outcome = file_numbers_read(folder, "", ".hdf", &numbers, r);
    if (!outcome) outcome = file_read_whole(path, &s.old, &s.old_size, r);
    if (!outcome) outcome = parse_old(&s, r);
    if (!outcome) outcome = compose(&s, folder, &numbers, fresh, limit, r);
    if (!outcome) outcome = file_write_whole(path, s.text, s.used, r);
    file_numbers_free(&numbers);
    series_free(&s);
    return outcome;
}
