/* Checkpoints: any records, sealed. The first 512 bytes (HDF5's user block) carry the size and hash of all that
 * follows, so that a damaged file is known before HDF5 parses it; an attribute carries the hash of the arrays
 * themselves. */
#include "store/frames.h"

#include "base/compare.h"
#include "base/threads.h"
#include "store/files.h"
#include "store/hdf.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

enum { SEAL = 512, HASH_TEXT = 17, FILE_OVERHEAD = 1 << 16, ARRAY_OVERHEAD = 1 << 13, READ_STEP = 1 << 16 };

static status checkpoint_path(char path[FILE_PATH], const char *folder, int64_t frame, report *r) {
    return path_format(path, r, "%s/checkpoint-%06" PRId64 ".hdf", folder, frame);
}

/* ---- hashes ------------------------------------------------------------------------------------------------------ */

static uint64_t record_hash(const record *item) {
    struct {
        uint64_t name, unit, data;
        int64_t count, components, type;
    } parts = {
        .name = XXH3_64bits(item->name, strlen(item->name)),
        .unit = XXH3_64bits(item->unit, strlen(item->unit)),
        .data = XXH3_64bits(item->data, (size_t)item->count * (size_t)item->components * record_type_size(item->type)),
        .count = item->count,
        .components = item->components,
        .type = (int64_t)item->type,
    };
    return XXH3_64bits(&parts, sizeof parts);
}

/* The hash of all records, whatever their order (HDF5 gives them back by name). */
static void content_hash(const record_list *records, char text[HASH_TEXT]) {
    uint64_t hashes[RECORD_LIMIT];
    for (int i = 0; i < records->count; i++) hashes[i] = record_hash(&records->items[i]);
    qsort(hashes, (size_t)records->count, sizeof hashes[0], compare_u64);
    snprintf(text, HASH_TEXT, "%016" PRIx64, (uint64_t)XXH3_64bits(hashes, (size_t)records->count * sizeof hashes[0]));
}

static void make_seal(char seal[SEAL], uint64_t bytes, uint64_t hash) {
    memset(seal, 0, SEAL);
    snprintf(seal, SEAL, "sunder checkpoint 1\nbytes %" PRIu64 "\nxxh3 %016" PRIx64 "\n", bytes, hash);
}

static status damaged(report *r, const char *path, const char *expected, const char *found) {
    report_set(r, STATUS_SYSTEM, "the checkpoint is damaged");
    report_file(r, path);
    snprintf(r->expected, sizeof r->expected, "%s", expected);
    snprintf(r->found, sizeof r->found, "%s", found);
    return STATUS_SYSTEM;
}

/* Reads an open file to its end: the seal, and the hash and size of what follows. */
static status hash_file(int fd, const char *path, char seal[SEAL], uint64_t *hash, uint64_t *bytes, bool *whole,
                        report *r) {
    XXH3_state_t *state = XXH3_createState();
    if (!state) return report_set(r, STATUS_SYSTEM, "%s: out of memory for its hash", path);
    XXH3_64bits_reset(state);
    char buffer[READ_STEP];
    uint64_t done = 0;
    ssize_t got;
    while ((got = read(fd, buffer, done < SEAL ? SEAL - (size_t)done : sizeof buffer)) != 0) {
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) break;
        if (done < SEAL)
            memcpy(seal + done, buffer, (size_t)got);
        else
            XXH3_64bits_update(state, buffer, (size_t)got);
        done += (uint64_t)got;
    }
    int error = got < 0 ? errno : 0;
    *hash = XXH3_64bits_digest(state);
    *bytes = done < SEAL ? 0 : done - SEAL;
    XXH3_freeState(state);
    *whole = error == 0;
    return error ? file_fail(r, path, "read it", error) : STATUS_OK;
}

/* The seal must be, to the byte, the one that this size and hash would get. */
static status check_seal(const char *path, bool *whole, report *r) {
    *whole = true;
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0) return file_fail(r, path, "open it", errno);
    char seal[SEAL] = {0}, right[SEAL];
    uint64_t hash, bytes, told;
    status s = hash_file(fd, path, seal, &hash, &bytes, whole, r);
    close(fd);
    if (s) return s;
    make_seal(right, bytes, hash);
    if (memcmp(seal, right, SEAL) == 0) return STATUS_OK;
    *whole = false;
    char expected[64], found[64];
    seal[SEAL - 1] = '\0';
    if (sscanf(seal, "sunder checkpoint 1\nbytes %" SCNu64, &told) != 1)
        return damaged(r, path, "the seal of a sunder checkpoint", "none");
    if (told != bytes) {
        snprintf(expected, sizeof expected, "%" PRIu64 " bytes after the seal", told);
        snprintf(found, sizeof found, "%" PRIu64, bytes);
        return damaged(r, path, expected, found);
    }
    snprintf(found, sizeof found, "%016" PRIx64, hash);
    return damaged(r, path, "contents whose hash is that of the seal", found);
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

static size_t image_bytes(const record_list *records) {
    size_t bytes = FILE_OVERHEAD;
    for (int i = 0; i < records->count; i++) {
        const record *item = &records->items[i];
        bytes += (size_t)item->count * (size_t)item->components * record_type_size(item->type) + ARRAY_OVERHEAD;
    }
    return bytes;
}

static status write_contents(hid_t file, const char *path, const frame_header *header, const record_list *records,
                             report *r) {
    char hash[HASH_TEXT];
    content_hash(records, hash);
    status s = hdf_write_header(file, path, "sunder checkpoint 1", header, r);
    if (!s) s = hdf_write_text(file, path, "content_xxh3", hash, r);
    for (int i = 0; i < records->count && !s; i++) {
        const record *item = &records->items[i];
        const hdf_array array = {item->name, item->type, item->count, item->components, item->data, item->unit};
        s = hdf_write_array(file, path, &array, 0, r);
    }
    return s;
}

status checkpoint_write(const char *folder, const frame_header *header, const record_list *records, report *r) {
    assert(header->frame >= 0);
    HDF_ALONE;
    char path[FILE_PATH];
    hdf_image image;
    status s = checkpoint_path(path, folder, header->frame, r);
    if (!s) s = hdf_image_create(&image, path, image_bytes(records), SEAL, r);
    if (s) return s;
    parallel_make_room(); /* what follows in memory takes as long as some steps */
    s = write_contents(image.file, path, header, records, r);
    if (!s) s = hdf_image_close(&image, r);
    if (!s) make_seal(image.block, image.size - SEAL, XXH3_64bits(image.block + SEAL, image.size - SEAL));
    parallel_take_room();
    if (!s) {
        s = file_write_whole(path, image.block, image.size, r);
        if (!s) file_forget(path);
    }
    hdf_image_free(&image);
    return s;
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

static status read_contents(hid_t file, const char *path, record_list *records, bool *whole, report *r) {
    char told[HASH_TEXT], hash[HASH_TEXT];
    status s = hdf_read_text(file, path, "content_xxh3", told, sizeof told, r);
    if (!s) s = hdf_read_records(file, path, NULL, records, r);
    if (s) return s;
    content_hash(records, hash);
    if (strcmp(told, hash) == 0) return STATUS_OK;
    record_clear(records);
    *whole = false;
    return damaged(r, path, told, hash);
}

/* *whole tells a damaged file, which an older one may stand in for, from trouble (memory, permissions) that it would
 * share. */
static status read_path(const char *path, record_list *records, bool *whole, report *r) {
    hid_t file;
    status s = check_seal(path, whole, r);
    if (!s) s = hdf_open(path, &file, r);
    if (s) return s;
    s = read_contents(file, path, records, whole, r);
    H5Fclose(file);
    return s;
}

/* The report for a checkpoint that is not there: which ones are. */
static status missing(const char *path, const char *folder, int64_t frame, report *r) {
    file_numbers numbers;
    status s = file_numbers_read(folder, "checkpoint-", ".hdf", &numbers, r);
    if (s) return s;
    char expected[96] = "a folder that holds checkpoints", found[64] = "none", nearest[32] = "";
    if (frame >= 0) snprintf(found, sizeof found, "none of frame %" PRId64, frame);
    for (size_t i = 0; i < numbers.count; i++)
        if (i == 0 || numbers.items[i] <= frame) snprintf(nearest, sizeof nearest, "%" PRId64, numbers.items[i]);
    if (numbers.count > 0)
        snprintf(expected, sizeof expected, "one of the %zu checkpoints of frames %" PRId64 " to %" PRId64,
                 numbers.count, numbers.items[0], numbers.items[numbers.count - 1]);
    file_numbers_free(&numbers);
    return report_input(r, path, 0, NULL, expected, found, nearest[0] ? nearest : NULL);
}

status checkpoint_read(const char *folder, int64_t frame, record_list *records, report *r) {
    HDF_ALONE;
    records->count = 0;
    char path[FILE_PATH];
    bool whole;
    status s = checkpoint_path(path, folder, frame, r);
    if (s) return s;
    return access(path, F_OK) == 0 ? read_path(path, records, &whole, r) : missing(path, folder, frame, r);
}

/* The newest whole one up to `most` of those listed. */
static status read_newest(const char *folder, const file_numbers *numbers, int64_t most, record_list *records, int64_t *frame, report *warning,
                          report *r) {
    bool whole = false;
    status s = STATUS_OK;
    *frame = -1;
    for (size_t i = numbers->count; i > 0 && !whole; i--) {
        char path[FILE_PATH];
        if (numbers->items[i - 1] > most) continue;
        *frame = numbers->items[i - 1];
        s = checkpoint_path(path, folder, *frame, r);
        if (!s) s = read_path(path, records, &whole, r);
        if (!whole && !warning->code) *warning = *r; /* the newest's trouble is the one worth telling */
    }
    if (!s && warning->code) {
        size_t used = strlen(warning->message);
        snprintf(warning->message + used, sizeof warning->message - used,
                 "; the one of frame %" PRId64 " is used instead", *frame);
    }
    if (s) report_clear(warning);
    return s;
}

status checkpoint_read_last(const char *folder, record_list *records, int64_t *frame, report *warning, report *r) {
    HDF_ALONE;
    report_clear(warning);
    records->count = 0;
    file_numbers numbers;
    status s = file_numbers_read(folder, "checkpoint-", ".hdf", &numbers, r);
    if (s) return s;
    if (numbers.count == 0) return missing(folder, folder, -1, r);
    s = read_newest(folder, &numbers, INT64_MAX, records, frame, warning, r);
    file_numbers_free(&numbers);
    return s;
}

status checkpoint_read_before(const char *folder, int64_t most, record_list *records, int64_t *frame, report *warning, report *r) {
    HDF_ALONE;
    report_clear(warning);
    records->count = 0;
    file_numbers numbers;
    status s = file_numbers_read(folder, "checkpoint-", ".hdf", &numbers, r);
    if (!s) s = read_newest(folder, &numbers, most, records, frame, warning, r);
    file_numbers_free(&numbers);
    return s;
}

int checkpoint_frames(const char *folder, int64_t *frames, int limit) {
    file_numbers numbers;
    report ignored;
    if (file_numbers_read(folder, "checkpoint-", ".hdf", &numbers, &ignored) != STATUS_OK) return 0;
    int count = (int)numbers.count;
    for (int i = 0; i < count && i < limit; i++) frames[i] = numbers.items[i];
    file_numbers_free(&numbers);
    return count;
}

status checkpoint_thin(const char *folder, int keep, report *r) {
    if (keep < 1) return STATUS_OK;
    file_numbers numbers;
    status s = file_numbers_read(folder, "checkpoint-", ".hdf", &numbers, r);
    for (size_t i = 0; !s && i + (size_t)keep < numbers.count; i++) {
        char path[FILE_PATH];
        s = checkpoint_path(path, folder, numbers.items[i], r);
        if (!s && unlink(path) != 0 && errno != ENOENT) s = file_fail(r, path, "remove it", errno);
    }
    file_numbers_free(&numbers);
    return s;
}
