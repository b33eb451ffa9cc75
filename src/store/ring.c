/* Which checkpoints stay when there is room for some only. */
#include "base/memory.h"
#include "store/files.h"
#include "store/frames.h"

#include <errno.h>
#include <inttypes.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct ring {
    const char *folder;
    file_numbers frames;
    int64_t *bytes; /* [frames.count] */
    int64_t total;
} ring;

static status checkpoint_name(const ring *k, size_t i, char path[FILE_PATH], report *r) {
    return path_format(path, r, "%s/checkpoint-%06" PRId64 ".hdf", k->folder, k->frames.items[i]);
}

static status weigh(ring *k, report *r) {
    k->bytes = memory_allocate_array(k->frames.count + 1, sizeof *k->bytes);
    if (!k->bytes) return report_set(r, STATUS_SYSTEM, "out of memory for a list of %zu checkpoints", k->frames.count);
    for (size_t i = 0; i < k->frames.count; i++) {
        char path[FILE_PATH];
        struct stat info = {0}; /* one that has just gone weighs nothing */
        status s = checkpoint_name(k, i, path, r);
        if (s) return s;
        if (stat(path, &info) != 0 && errno != ENOENT) return file_fail(r, path, "ask for its size", errno);
        k->bytes[i] = (int64_t)info.st_size;
        k->total += k->bytes[i];
    }
    return STATUS_OK;
}

/* The gap that a checkpoint's loss would leave, by its age: the least is missed least. Of equals the older goes. 0: all must stay. */
static size_t least_missed(const ring *k) {
    size_t least = 0, newest = k->frames.count - 1;
    double smallest = 0;
    for (size_t i = 1; i + 2 < k->frames.count; i++) {
        const int64_t *frame = k->frames.items;
        double gap = (double)(frame[i + 1] - frame[i - 1]) / (double)(frame[newest] - frame[i]);
        if (least == 0 || gap < smallest) least = i, smallest = gap;
    }
    return least;
}

static status drop(ring *k, size_t i, report *r) {
    char path[FILE_PATH];
    status s = checkpoint_name(k, i, path, r);
    if (s) return s;
    if (unlink(path) != 0 && errno != ENOENT) return file_fail(r, path, "remove it", errno);
    k->total -= k->bytes[i];
    for (size_t j = i; j + 1 < k->frames.count; j++) k->frames.items[j] = k->frames.items[j + 1], k->bytes[j] = k->bytes[j + 1];
    k->frames.count--;
    return STATUS_OK;
}

status checkpoint_ring(const char *folder, int64_t bytes, int64_t *over, report *r) {
    ring k = {.folder = folder};
    status s = file_numbers_read(folder, "checkpoint-", ".hdf", &k.frames, r);
    size_t count = k.frames.count;
    if (!s) s = weigh(&k, r);
    while (!s && k.total > bytes) {
        size_t i = k.frames.count > 3 ? least_missed(&k) : 0;
        if (i == 0) break;
        s = drop(&k, i, r);
    }
    if (over) *over = k.total > bytes ? k.total - bytes : 0;
    memory_free(k.bytes, (count + 1) * sizeof *k.bytes);
    file_numbers_free(&k.frames);
    return s;
}
