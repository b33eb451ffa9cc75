#include "store/frame_compare.h"

#include "base/memory.h"
#include "store/frames.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static bool same_shape(const record *a, const record *b) {
    return a && b && a->type == b->type && a->count == b->count && a->components == b->components;
}

static bool same_bytes(const record *a, const record *b) {
    return same_shape(a, b) && memcmp(a->data, b->data, (size_t)a->count * (size_t)a->components * record_type_size(a->type)) == 0;
}

static double largest_difference(const record *a, const record *b) {
    double most = 0;
    if (!same_shape(a, b)) return NAN;
    for (int64_t i = 0; i < a->count * a->components; i++) most = fmax(most, fabs(record_value(a, i) - record_value(b, i)));
    return most;
}

static void compare_lists(const record_list *a, const record_list *b, frame_difference *out) {
    for (int i = 0; i < a->count && out->same; i++) {
        const record *other = record_find(b, a->items[i].name);
        if (same_bytes(&a->items[i], other)) continue;
        *out = (frame_difference){.largest = largest_difference(&a->items[i], other)};
        snprintf(out->array, sizeof out->array, "%s", a->items[i].name);
    }
    for (int i = 0; i < b->count && out->same; i++) {
        if (record_find(a, b->items[i].name)) continue;
        *out = (frame_difference){.largest = NAN};
        snprintf(out->array, sizeof out->array, "%s", b->items[i].name);
    }
}

status frame_compare(const char *a, const char *b, int64_t frame, frame_difference *out, report *r) {
    record_list *lists = memory_allocate_array(2, sizeof *lists);
    double time[2];
    int64_t step[2];
    *out = (frame_difference){.same = true};
    if (!lists) return report_set(r, STATUS_SYSTEM, "out of memory for two frames");
    status s = frame_read(a, frame, &lists[0], &time[0], &step[0], r);
    if (!s) s = frame_read(b, frame, &lists[1], &time[1], &step[1], r);
    if (!s) compare_lists(&lists[0], &lists[1], out);
    record_clear(&lists[0]);
    record_clear(&lists[1]);
    memory_free(lists, 2 * sizeof *lists);
    return s;
}

status frame_first_difference(const char *a, const char *b, int64_t last, int64_t *frame, frame_difference *out, report *r) {
    int64_t *frames;
    int count;
    *frame = -1;
    *out = (frame_difference){.same = true};
    status s = frame_list(a, &frames, &count, r);
    for (int i = 0; i < count && !s && frames[i] <= last; i++) {
        if (!frame_exists(b, frames[i])) continue;
        s = frame_compare(a, b, frames[i], out, r);
        if (s || out->same) continue;
        *frame = frames[i];
        break;
    }
    memory_free(frames, (size_t)count * sizeof *frames);
    return s;
}
