/* A branch's beginning: its parent's frames and checkpoints, by a second name. Files are never written in place, only replaced, so that
 * two folders may share them. */
#include "store/files.h"
#include "store/hdf.h"
#include "store/series.h"
#include "store/vtkhdf.h"

#include "base/memory.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <unistd.h>

static status copy_file(const char *from, const char *to, report *r) {
    char *text, temporary[FILE_PATH];
    size_t size;
    status s = file_read_whole(from, &text, &size, r);
    if (s || !text) return s; /* gone in the meantime: a thinned checkpoint */
    s = file_write_beside(to, text, size, temporary, r);
    if (!s) s = file_commit(temporary, to, r);
    memory_free(text, size + 1);
    return s;
}

static status adopt_file(const char *from, const char *to, report *r) {
    if (link(from, to) == 0 || errno == EEXIST || errno == ENOENT) return STATUS_OK;
    bool cannot = errno == EXDEV || errno == EPERM || errno == EMLINK || errno == ENOTSUP || errno == ENOSYS;
    return cannot ? copy_file(from, to, r) : file_fail(r, to, "link it to another run's file", errno);
}

/* The numbered files of one folder; the lowest first, so that what is there has no gap whenever this is stopped. */
static status adopt_numbered(const char *from, const char *to, const char *prefix, int64_t most, report *r) {
    file_numbers numbers;
    status s = file_numbers_read(from, prefix, ".hdf", &numbers, r);
    for (size_t i = 0; i < numbers.count && !s && numbers.items[i] <= most; i++) {
        char source[FILE_PATH], target[FILE_PATH];
        s = path_format(source, r, "%s/%s%06" PRId64 ".hdf", from, prefix, numbers.items[i]);
        if (!s) s = path_format(target, r, "%s/%s%06" PRId64 ".hdf", to, prefix, numbers.items[i]);
        if (!s) s = adopt_file(source, target, r);
    }
    file_numbers_free(&numbers);
    return s ? s : folder_sync(to, r);
}

/* Frames, or one set's views of them, and their series. */
static status adopt_frames(const char *from, const char *folder, const char *inner, int64_t frame, report *r) {
    char source[FILE_PATH], target[FILE_PATH];
    status s = path_format(source, r, "%s/frames%s", from, inner);
    if (!s) s = path_format(target, r, "%s/frames%s", folder, inner);
    if (!s && access(source, F_OK) != 0) return STATUS_OK;
    if (!s) s = folder_create(target, r);
    if (!s) s = adopt_numbered(source, target, "", frame, r);
    return s ? s : series_refresh(target, -1, -1, r);
}

status frame_adopt(const char *from, const char *folder, int64_t frame, report *r) {
    HDF_ALONE;
    status s = adopt_frames(from, folder, "", frame, r);
    for (int i = 0; i < VTKHDF_SETS && !s; i++) {
        char inner[64];
        snprintf(inner, sizeof inner, "/%s", vtkhdf_sets[i]);
        s = adopt_frames(from, folder, inner, frame, r);
    }
    /* Checkpoints last: one without its frames would be resumed from, and leave a gap behind it. */
    return s ? s : adopt_numbered(from, folder, "checkpoint-", frame, r);
}

bool frame_exists(const char *folder, int64_t frame) {
    char path[FILE_PATH];
    report ignored;
    return path_format(path, &ignored, "%s/frames/%06" PRId64 ".hdf", folder, frame) == STATUS_OK && access(path, F_OK) == 0;
}

bool checkpoint_exists(const char *folder, int64_t frame) {
    char path[FILE_PATH];
    report ignored;
    return path_format(path, &ignored, "%s/checkpoint-%06" PRId64 ".hdf", folder, frame) == STATUS_OK && access(path, F_OK) == 0;
}
