/* What the store's tests share: a scratch folder, children, records. */
#ifndef SUNDER_TESTS_SCRATCH_H
#define SUNDER_TESTS_SCRATCH_H

#include "base/record.h"
#include "store/frames.h"

#include <dirent.h>
#include <fcntl.h>
#include <ftw.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { SCRATCH_PATH = 1024 };
static char scratch[256]; /* set by scratch_make; removed at exit */

static int scratch_remove_one(const char *path, const struct stat *info, int kind, struct FTW *place) {
    (void)info, (void)kind, (void)place;
    return remove(path);
}

static inline void scratch_remove(void) {
    nftw(scratch, scratch_remove_one, 16, FTW_DEPTH | FTW_PHYS);
}

/* Makes the folder; children that leave by _exit do not remove it. */
static inline void scratch_make(void) {
    const char *root = getenv("TMPDIR");
    snprintf(scratch, sizeof scratch, "%s/sunder-test-XXXXXX", root && root[0] ? root : "/tmp");
    if (!mkdtemp(scratch)) abort();
    chmod(scratch, 0777); /* some children give up their privileges */
    atexit(scratch_remove);
}

/* A path inside the scratch folder; good until the fourth call after it. */
static inline const char *in_scratch(const char *format, ...) __attribute__((format(printf, 1, 2)));
static inline const char *in_scratch(const char *format, ...) {
    static char paths[4][SCRATCH_PATH];
    static int next;
    char *path = paths[next = (next + 1) % 4];
    int front = snprintf(path, sizeof paths[0], "%s/", scratch);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(path + front, sizeof paths[0] - (size_t)front, format, arguments);
    va_end(arguments);
    return path;
}

static inline bool exists(const char *path) {
    return access(path, F_OK) == 0;
}

static inline long size_of(const char *path) {
    struct stat info;
    return stat(path, &info) == 0 ? (long)info.st_size : -1;
}

/* Replaces a file's bytes in place: emptying it first would make some file systems sync it. */
static inline void write_text(const char *path, const char *text, size_t size) {
    int fd = open(path, O_WRONLY | O_CREAT, 0666);
    if (fd < 0 || write(fd, text, size) != (ssize_t)size || ftruncate(fd, (off_t)size) != 0) abort();
    close(fd);
}

/* A whole file with a NUL behind it; free() it. */
static inline char *read_text(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    *size = 0;
    if (!file) return NULL;
    size_t bytes = (size_t)size_of(path);
    char *text = calloc(1, bytes + 1);
    if (!text || fread(text, 1, bytes, file) != bytes) abort();
    fclose(file);
    *size = bytes;
    return text;
}

/* Number of names in a folder that end in `suffix`, hidden ones too. */
static inline int count_files(const char *folder, const char *suffix) {
    DIR *directory = opendir(folder);
    int count = 0;
    if (!directory) return -1;
    for (struct dirent *entry; (entry = readdir(directory));) {
        size_t length = strlen(entry->d_name), back = strlen(suffix);
        count += length >= back && strcmp(entry->d_name + length - back, suffix) == 0;
    }
    closedir(directory);
    return count;
}

/* Runs `task` in a child; returns its exit code, or −signal. */
static inline int in_child(int (*task)(void *context), void *context) {
    fflush(stdout);
    pid_t pid = fork();
    if (pid < 0) abort();
    if (pid == 0) {
        int code = task(context);
        fflush(stdout);
        _exit(code);
    }
    int state;
    if (waitpid(pid, &state, 0) != pid) abort();
    return WIFEXITED(state) ? WEXITSTATUS(state) : -WTERMSIG(state);
}

static inline frame_header header_of(int64_t frame) {
    return (frame_header){.frame = frame,
                          .step = 10 * frame,
                          .time = (double)frame / 24.0,
                          .run_id = "20261122-061502-3f9a",
                          .units = "cgs",
                          .scene_title = "Tube pull",
                          .scene_hash = "0123456789abcdef",
                          .version = "0.1.0",
                          .precision = "f32",
                          .simd = "avx2"};
}

/* Fills `list` with the arrays of a solid of n particles, different for each frame. */
static inline void fill_solid(record_list *list, int n, int64_t frame) {
    report r;
    float *position, *velocity, *damage, *gradient;
    int32_t *id;
    list->count = 0;
    if (record_add(list, "solid/position", RECORD_F32, n, 3, "length", (void **)&position, &r) ||
        record_add(list, "solid/velocity", RECORD_F32, n, 3, "length/time", (void **)&velocity, &r) ||
        record_add(list, "solid/id", RECORD_I32, n, 1, "", (void **)&id, &r) ||
        record_add(list, "solid/damage", RECORD_F32, n, 1, "1", (void **)&damage, &r) ||
        record_add(list, "solid/deformation_gradient", RECORD_F32, n, 9, "1", (void **)&gradient, &r))
        abort();
    for (int i = 0; i < n; i++) {
        id[i] = i;
        damage[i] = (float)i / (float)n;
        for (int k = 0; k < 3; k++) position[3 * i + k] = (float)(i * (k + 1)) + (float)frame;
        for (int k = 0; k < 3; k++) velocity[3 * i + k] = (float)(k + 1) * 0.5f;
        for (int k = 0; k < 9; k++) gradient[9 * i + k] = k % 4 == 0 ? 1.0f + 1e-6f * (float)i : 0.0f;
    }
}

/* Adds a sheet of n particles with bonds. */
static inline void fill_sheet(record_list *list, int n) {
    report r;
    float *position, *diffused;
    int32_t *bonds;
    if (record_add(list, "sheet/position", RECORD_F32, n, 3, "length", (void **)&position, &r) ||
        record_add(list, "sheet/diffused", RECORD_F32, n, 1, "1", (void **)&diffused, &r) ||
        record_add(list, "sheet/bonds", RECORD_I32, 2 * n, 2, "", (void **)&bonds, &r))
        abort();
    for (int i = 0; i < n; i++)
        position[3 * i] = (float)i, position[3 * i + 1] = 100.0f, diffused[i] = 1.0f / (float)(i + 1);
}

static inline bool same_records(const record_list *a, const record_list *b) {
    if (a->count != b->count) return false;
    for (int i = 0; i < a->count; i++) {
        const record *x = &a->items[i], *y = record_find(b, x->name);
        if (!y || x->type != y->type || x->count != y->count || x->components != y->components ||
            strcmp(x->unit, y->unit) != 0)
            return false;
        size_t bytes = (size_t)x->count * (size_t)x->components * record_type_size(x->type);
        if (memcmp(x->data, y->data, bytes) != 0) return false;
    }
    return true;
}

/* Makes a run folder of this name and returns its path. */
static inline const char *make_run(const char *name) {
    static char path[512];
    report r;
    snprintf(path, sizeof path, "%s/%s", scratch, name);
    if (run_folder_create(path, false, &r)) {
        printf("  %s: %s\n", r.file, r.message);
        abort();
    }
    return path;
}

static inline void write_solid_frame(const char *folder, int n, int64_t frame) {
    record_list list;
    report r;
    frame_header header = header_of(frame);
    fill_solid(&list, n, frame);
    if (frame_write(folder, &header, &list, 1, &r)) {
        printf("  %s: %s\n", r.file, r.message);
        abort();
    }
    record_clear(&list);
}

#endif
