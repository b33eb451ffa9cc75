/* Frames: frames/%06d.hdf, the views beside them, and the run's folder. */
#include "store/frames.h"

#include "base/memory.h"
#include "base/threads.h"
#include "store/files.h"
#include "store/hdf.h"
#include "store/series.h"
#include "store/vtkhdf.h"

#include <assert.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum {
    FILE_OVERHEAD = 1 << 16,  /* superblock, root, attributes */
    ARRAY_OVERHEAD = 1 << 14, /* header and chunk index of a dataset */
    CELL_BYTES = 17,          /* connectivity, offset, type */
};

static status frame_path(char path[FILE_PATH], const char *folder, const char *inner, int64_t frame, report *r) {
    return path_format(path, r, "%s/frames/%s%06" PRId64 ".hdf", folder, inner, frame);
}

/* ---- the folder -------------------------------------------------------------------------------------------------- */

/* How many frames and checkpoints the folder holds. */
static status count_contents(const char *folder, size_t *frames, size_t *checkpoints, report *r) {
    char path[FILE_PATH];
    file_numbers numbers;
    status s = path_format(path, r, "%s/frames", folder);
    if (!s) s = file_numbers_read(path, "", ".hdf", &numbers, r);
    if (s) return s;
    *frames = numbers.count;
    file_numbers_free(&numbers);
    s = file_numbers_read(folder, "checkpoint-", ".hdf", &numbers, r);
    if (s) return s;
    *checkpoints = numbers.count;
    file_numbers_free(&numbers);
    return STATUS_OK;
}

static status refuse_contents(const char *folder, report *r) {
    size_t frames, checkpoints;
    status s = count_contents(folder, &frames, &checkpoints, r);
    if (s || frames + checkpoints == 0) return s;
    char found[128];
    snprintf(found, sizeof found, "a run's %zu frames and %zu checkpoints", frames, checkpoints);
    report_input(r, folder, 0, NULL, "a folder without a run in it", found, NULL);
    snprintf(r->message, sizeof r->message,
             "frames are never overwritten by another run: resume that run or choose another folder");
    return STATUS_INPUT;
}

status run_folder_create(const char *folder, bool resume, report *r) {
    static const char *const inside[] = {"frames", "scene"};
    status s = resume ? STATUS_OK : refuse_contents(folder, r);
    if (!s) s = folder_create(folder, r);
    folder_sweep(folder);
    for (size_t i = 0; i < sizeof inside / sizeof inside[0] && !s; i++) {
        char path[FILE_PATH];
        s = path_format(path, r, "%s/%s", folder, inside[i]);
        if (!s) s = folder_create(path, r);
        if (!s) folder_sweep(path);
    }
    if (!s) s = folder_sync(folder, r);
    return s;
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

static size_t image_bytes(const record_list *records) {
    size_t bytes = FILE_OVERHEAD;
    for (int i = 0; i < records->count; i++) {
        const record *item = &records->items[i];
        size_t row = (size_t)item->components * record_type_size(item->type);
        if (strstr(item->name, "/position")) row += CELL_BYTES;
        bytes += (size_t)item->count * row + ARRAY_OVERHEAD;
    }
    return bytes;
}

/* A run must not write over another run's frame, whatever led it there. A frame that cannot be read may be replaced. */
static status check_owner(const char *path, const frame_header *header, report *r) {
    char owner[128];
    hid_t file;
    if (!header->run_id || access(path, F_OK) != 0) return STATUS_OK;
    if (hdf_open(path, &file, r)) return STATUS_OK;
    bool named = hdf_read_text(file, path, "run_id", owner, sizeof owner, r) == STATUS_OK;
    H5Fclose(file);
    if (!named || strcmp(owner, header->run_id) == 0) return STATUS_OK;
    return report_input(r, path, 0, "run_id", header->run_id, owner, NULL);
}

static const char *first_set(const record_list *records) {
    for (int i = 0; i < VTKHDF_SETS; i++)
        if (vtkhdf_points(records, vtkhdf_sets[i])) return vtkhdf_sets[i];
    return NULL;
}

static status write_contents(hid_t file, const char *path, const frame_header *header, const record_list *records,
                             int deflate, report *r) {
    status s = hdf_write_header(file, path, "sunder frame 1", header, r);
    for (int i = 0; i < records->count && !s; i++) {
        const record *item = &records->items[i];
        const hdf_array array = {item->name, item->type, item->count, item->components, item->data, item->unit};
        s = hdf_write_array(file, path, &array, deflate, r);
    }
    const char *set = first_set(records);
    if (!s && set) s = vtkhdf_write(file, path, records, set, NULL, deflate, r);
    return s;
}

/* Builds the frame (`set` NULL) or a view of one of its sets (links into the frame), and puts it in its place. */
static status write_file(const char *path, const frame_header *header, const record_list *records, const char *set,
                         int deflate, report *r) {
    hdf_image image;
    status s = hdf_image_create(&image, path, image_bytes(records), 0, r);
    if (s) return s;
    parallel_make_room(); /* what follows in memory takes as long as some steps */
    if (set) {
        char source[64];
        snprintf(source, sizeof source, "../%06" PRId64 ".hdf", header->frame);
        s = hdf_write_header(image.file, path, "sunder view 1", header, r);
        if (!s) s = vtkhdf_write(image.file, path, records, set, source, deflate, r);
    } else {
        s = write_contents(image.file, path, header, records, deflate, r);
    }
    if (!s) s = hdf_image_close(&image, r);
    parallel_take_room();
    char temporary[FILE_PATH];
    if (!s) s = file_write_beside(path, image.block, image.size, temporary, r);
    if (!s) s = file_commit(temporary, path, r);
    hdf_image_free(&image);
    return s;
}

/* The folder of a set's view: "frames/sheet". */
static status view_folder(char path[FILE_PATH], const char *folder, const char *set, report *r) {
    return path_format(path, r, "%s/frames/%s", folder, set);
}

/* Sets after the first get a view in a folder of their own: one root holds one point set. */
static status write_views(const char *folder, const frame_header *header, const record_list *records, int deflate,
                          report *r) {
    const char *first = first_set(records);
    status s = STATUS_OK;
    for (int i = 0; i < VTKHDF_SETS && !s; i++) {
        const char *set = vtkhdf_sets[i];
        if (set == first || !vtkhdf_points(records, set)) continue;
        char path[FILE_PATH], views[FILE_PATH];
        s = view_folder(views, folder, set, r);
        if (!s) s = folder_create(views, r);
        if (!s) s = path_format(path, r, "%s/%06" PRId64 ".hdf", views, header->frame);
        if (!s) s = write_file(path, header, records, set, deflate, r);
        if (!s) s = series_refresh(views, header->frame, -1, r);
    }
    return s;
}

status frame_write(const char *folder, const frame_header *header, const record_list *records, int deflate, report *r) {
    assert(header->frame >= 0 && deflate >= 0 && deflate <= 9);
    HDF_ALONE;
    char path[FILE_PATH], frames[FILE_PATH];
    status s = frame_path(path, folder, "", header->frame, r);
    if (!s) s = path_format(frames, r, "%s/frames", folder);
    if (!s) s = check_owner(path, header, r);
    if (!s) s = write_file(path, header, records, NULL, deflate, r);
    if (!s) s = series_refresh(frames, header->frame, -1, r); /* syncs the folder, and so the frame's name */
    if (!s) s = write_views(folder, header, records, deflate, r);
    return s;
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

/* The report for a frame that is not there: which ones are. */
static status missing_frame(const char *path, const char *frames, int64_t frame, report *r) {
    file_numbers numbers;
    status s = file_numbers_read(frames, "", ".hdf", &numbers, r);
    if (s) return s;
    char expected[128] = "a folder that holds frames", found[64], nearest[32] = "";
    snprintf(found, sizeof found, "no frame %" PRId64, frame);
    for (size_t i = 0; i < numbers.count; i++)
        if (i == 0 || numbers.items[i] <= frame) snprintf(nearest, sizeof nearest, "%" PRId64, numbers.items[i]);
    if (numbers.count > 0)
        snprintf(expected, sizeof expected, "one of the %zu frames from %" PRId64 " to %" PRId64, numbers.count,
                 numbers.items[0], numbers.items[numbers.count - 1]);
    file_numbers_free(&numbers);
    return report_input(r, path, 0, NULL, expected, found, nearest[0] ? nearest : NULL);
}

/* Opens a frame, or says which frames there are. */
static status open_frame(const char *folder, int64_t frame, char path[FILE_PATH], hid_t *file, report *r) {
    char frames[FILE_PATH];
    status s = frame_path(path, folder, "", frame, r);
    if (!s) s = path_format(frames, r, "%s/frames", folder);
    if (!s && access(path, F_OK) != 0) return missing_frame(path, frames, frame, r);
    return s ? s : hdf_open(path, file, r);
}

static status read_clock(hid_t file, const char *path, double *time, int64_t *step, report *r) {
    status s = hdf_read_number(file, path, "time", time, r);
    return s ? s : hdf_read_integer(file, path, "step", step, r);
}

status frame_read_named(const char *folder, int64_t frame, const char *const *names, int count, record_list *records,
                        double *time, int64_t *step, report *r) {
    char path[FILE_PATH];
    hid_t file;
    HDF_ALONE;
    records->count = 0;
    status s = open_frame(folder, frame, path, &file, r);
    if (s) return s;
    s = read_clock(file, path, time, step, r);
    if (!s) s = names ? hdf_read_named(file, path, names, count, records, r) : hdf_read_records(file, path, "VTKHDF", records, r);
    H5Fclose(file);
    return s;
}

status frame_read(const char *folder, int64_t frame, record_list *records, double *time, int64_t *step, report *r) {
    return frame_read_named(folder, frame, NULL, 0, records, time, step, r);
}

status frame_shapes(const char *folder, int64_t frame, record_list *records, report *r) {
    char path[FILE_PATH];
    hid_t file;
    HDF_ALONE;
    records->count = 0;
    status s = open_frame(folder, frame, path, &file, r);
    if (s) return s;
    s = hdf_read_shapes(file, path, "VTKHDF", records, r);
    H5Fclose(file);
    return s;
}

status frame_list(const char *folder, int64_t **frames, int *count, report *r) {
    char path[FILE_PATH];
    file_numbers numbers;
    *frames = NULL;
    *count = 0;
    status s = path_format(path, r, "%s/frames", folder);
    if (!s) s = file_numbers_read(path, "", ".hdf", &numbers, r);
    if (s) return s;
    *frames = memory_allocate_array(numbers.count, sizeof **frames);
    if (!*frames) s = report_set(r, STATUS_SYSTEM, "out of memory for the numbers of %zu frames", numbers.count);
    else if (numbers.count > 0) memcpy(*frames, numbers.items, numbers.count * sizeof **frames);
    if (!s) *count = (int)numbers.count;
    file_numbers_free(&numbers);
    return s;
}

int64_t frame_last(const char *folder) {
    HDF_ALONE;
    char frames[FILE_PATH], path[FILE_PATH];
    report ignored;
    file_numbers numbers;
    if (path_format(frames, &ignored, "%s/frames", folder)) return -1;
    if (file_numbers_read(frames, "", ".hdf", &numbers, &ignored)) return -1;
    int64_t last = -1;
    for (size_t i = numbers.count; i > 0 && last < 0; i--) {
        hid_t file;
        if (frame_path(path, folder, "", numbers.items[i - 1], &ignored) || hdf_open(path, &file, &ignored)) continue;
        H5Fclose(file);
        last = numbers.items[i - 1];
    }
    file_numbers_free(&numbers);
    return last;
}

/* ---- cutting back ------------------------------------------------------------------------------------------------ */

/* Removes the numbered files above `limit`, the highest first: whenever it is stopped, what is left is without a gap.
 */
static status remove_above(const char *folder, const char *prefix, int64_t limit, report *r) {
    file_numbers numbers;
    status s = file_numbers_read(folder, prefix, ".hdf", &numbers, r);
    for (size_t i = numbers.count; i > 0 && !s && numbers.items[i - 1] > limit; i--) {
        char path[FILE_PATH];
        s = path_format(path, r, "%s/%s%06" PRId64 ".hdf", folder, prefix, numbers.items[i - 1]);
        if (!s && unlink(path) != 0 && errno != ENOENT) s = file_fail(r, path, "remove it", errno);
    }
    bool touched = numbers.count > 0;
    file_numbers_free(&numbers);
    return s || !touched ? s : folder_sync(folder, r);
}

/* The series goes first, so that it never names a frame that is gone. */
static status cut_frames(const char *frames, int64_t frame, report *r) {
    if (access(frames, F_OK) != 0) return STATUS_OK;
    status s = series_refresh(frames, -1, frame, r);
    return s ? s : remove_above(frames, "", frame, r);
}

status frame_truncate(const char *folder, int64_t frame, report *r) {
    HDF_ALONE;
    char path[FILE_PATH];
    /* Checkpoints first: one that outlives its frames would be resumed from, and leave a gap behind it. */
    status s = remove_above(folder, "checkpoint-", frame, r);
    for (int i = 0; i < VTKHDF_SETS && !s; i++) {
        s = view_folder(path, folder, vtkhdf_sets[i], r);
        if (!s) s = cut_frames(path, frame, r);
    }
    if (!s) s = path_format(path, r, "%s/frames", folder);
    return s ? s : cut_frames(path, frame, r);
}
