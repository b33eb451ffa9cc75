#include "store/files.h"

#include "base/compare.h"
#include "base/memory.h"
#include "store/frames.h"

#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define TEMPORARY_SUFFIX ".tmp"

status path_format(char path[FILE_PATH], report *r, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(path, FILE_PATH, format, arguments);
    va_end(arguments);
    if (length >= 0 && length < FILE_PATH) return STATUS_OK;
    char expected[64], found[64];
    snprintf(expected, sizeof expected, "a path shorter than %d bytes", FILE_PATH);
    snprintf(found, sizeof found, "one of %d", length);
    return report_input(r, path, 0, NULL, expected, found, NULL);
}

void report_file(report *r, const char *path) {
    size_t length = strlen(path), room = sizeof r->file - 1;
    memcpy(r->file, length > room ? path + length - room : path, (length > room ? room : length) + 1);
}

status file_fail(report *r, const char *path, const char *doing, int error) {
    report_set(r, STATUS_SYSTEM, "cannot %s: %s", doing, strerror(error));
    report_file(r, path);
    return STATUS_SYSTEM;
}

/* ---- folders ----------------------------------------------------------------------------------------------------- */

static status folder_create_one(const char *path, report *r) {
    if (mkdir(path, 0777) == 0) return STATUS_OK;
    int error = errno;
    struct stat info;
    if (error == EEXIST && stat(path, &info) == 0) {
        if (S_ISDIR(info.st_mode)) return STATUS_OK;
        return report_input(r, path, 0, NULL, "a folder", "a file of that name", NULL);
    }
    return file_fail(r, path, "create the folder", error);
}

status folder_create(const char *path, report *r) {
    char part[FILE_PATH];
    status s = path_format(part, r, "%s", path);
    if (s) return s;
    for (char *slash = strchr(part + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        struct stat info;
        if (stat(part, &info) != 0 && (s = folder_create_one(part, r))) return s;
        *slash = '/';
    }
    return folder_create_one(part, r);
}

status folder_sync(const char *path, report *r) {
    int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0) return file_fail(r, path, "open the folder to sync it", errno);
    int failed = fsync(fd), error = errno;
    close(fd);
    /* Some file systems cannot sync a folder and say so; there is nothing better to be done on them. */
    if (failed && error != EINVAL && error != ENOTSUP) return file_fail(r, path, "sync the folder", error);
    return STATUS_OK;
}

/* The folder part of a path, without its last slash; "." when there is none. */
static void folder_of(const char *path, char folder[FILE_PATH]) {
    const char *slash = strrchr(path, '/');
    if (!slash)
        snprintf(folder, FILE_PATH, ".");
    else
        snprintf(folder, FILE_PATH, "%.*s", slash == path ? 1 : (int)(slash - path), path);
}

/* ---- writing beside ---------------------------------------------------------------------------------------------- */

static int write_all(int fd, const char *data, size_t size) {
    while (size > 0) {
        ssize_t written = write(fd, data, size);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return errno;
        if (written == 0) return ENOSPC;
        data += written;
        size -= (size_t)written;
    }
    return 0;
}

/* The temporary's name: hidden, in the same folder, with the writer's pid so that folder_sweep can tell the dead ones.
 */
static status temporary_name(const char *path, char temporary[FILE_PATH], report *r) {
    const char *slash = strrchr(path, '/');
    const char *name = slash ? slash + 1 : path;
    return path_format(temporary, r, "%.*s.%s.%ld" TEMPORARY_SUFFIX, (int)(name - path), path, name, (long)getpid());
}

status file_write_beside(const char *path, const void *data, size_t size, char temporary[FILE_PATH], report *r) {
    status s = temporary_name(path, temporary, r);
    if (s) return s;
    int fd = open(temporary, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (fd < 0) return file_fail(r, path, "write a file beside it", errno);
    const char *doing = "write it";
    int error = write_all(fd, data, size);
    if (!error && fsync(fd) != 0) error = errno, doing = "sync it";
    if (close(fd) != 0 && !error) error = errno, doing = "close it";
    if (!error) return STATUS_OK;
    unlink(temporary);
    return file_fail(r, path, doing, error);
}

status file_commit(const char *temporary, const char *path, report *r) {
    if (rename(temporary, path) == 0) return STATUS_OK;
    int error = errno;
    unlink(temporary);
    return file_fail(r, path, "rename the new file to it", error);
}

void file_forget(const char *path) {
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0) return;
    (void)posix_fadvise(fd, 0, 0, POSIX_FADV_DONTNEED);
    close(fd);
}

status file_write_whole(const char *path, const void *data, size_t size, report *r) {
    char temporary[FILE_PATH], folder[FILE_PATH];
    status s = file_write_beside(path, data, size, temporary, r);
    if (!s) s = file_commit(temporary, path, r);
    if (s) return s;
    folder_of(path, folder);
    return folder_sync(folder, r);
}

status file_write_atomic(const char *path, const char *text, size_t size, report *r) {
    return file_write_whole(path, text, size, r);
}

status file_read_text(const char *path, char **text, size_t *size, report *r) {
    return file_read_whole(path, text, size, r);
}

/* The pid in ".NAME.PID.tmp", or 0 when the name is not one of our temporaries. */
static long temporary_pid(const char *name) {
    size_t length = strlen(name), suffix = strlen(TEMPORARY_SUFFIX);
    if (name[0] != '.' || length <= suffix || strcmp(name + length - suffix, TEMPORARY_SUFFIX) != 0) return 0;
    size_t digits = length - suffix;
    while (digits > 0 && isdigit((unsigned char)name[digits - 1])) digits--;
    if (digits < 2 || name[digits - 1] != '.') return 0;
    return strtol(name + digits, NULL, 10);
}

void folder_sweep(const char *folder) {
    DIR *directory = opendir(folder);
    if (!directory) return;
    for (struct dirent *entry; (entry = readdir(directory));) {
        long pid = temporary_pid(entry->d_name);
        if (pid <= 0 || pid > INT_MAX) continue;
        bool gone = pid == (long)getpid() || (kill((pid_t)pid, 0) != 0 && errno == ESRCH);
        if (gone) unlinkat(dirfd(directory), entry->d_name, 0);
    }
    closedir(directory);
}

/* ---- finding and reading ----------------------------------------------------------------------------------------- */

/* The number in PREFIX%06dSUFFIX, or −1. Seven digits and more follow frame 999999. */
static int64_t number_in(const char *name, const char *prefix, const char *suffix) {
    size_t front = strlen(prefix), back = strlen(suffix), length = strlen(name);
    if (length < front + 6 + back || length > front + 12 + back) return -1;
    if (strncmp(name, prefix, front) != 0 || strcmp(name + length - back, suffix) != 0) return -1;
    int64_t number = 0;
    for (size_t i = front; i < length - back; i++) {
        if (!isdigit((unsigned char)name[i])) return -1;
        number = number * 10 + (name[i] - '0');
    }
    return length - front - back > 6 && name[front] == '0' ? -1 : number;
}

static status append_number(file_numbers *numbers, int64_t number, report *r) {
    if (numbers->count == numbers->capacity) {
        size_t capacity = numbers->capacity ? 2 * numbers->capacity : 256, item = sizeof numbers->items[0];
        int64_t *items = memory_resize(numbers->items, numbers->capacity * item, capacity * item);
        if (!items) return report_set(r, STATUS_SYSTEM, "out of memory for a list of %zu files", capacity);
        numbers->items = items;
        numbers->capacity = capacity;
    }
    numbers->items[numbers->count++] = number;
    return STATUS_OK;
}

status file_numbers_read(const char *folder, const char *prefix, const char *suffix, file_numbers *numbers, report *r) {
    *numbers = (file_numbers){0};
    DIR *directory = opendir(folder);
    if (!directory && (errno == ENOENT || errno == ENOTDIR))
        return STATUS_OK; /* who writes there will say what is wrong */
    if (!directory) return file_fail(r, folder, "list the folder", errno);
    status s = STATUS_OK;
    errno = 0; /* the only way to tell readdir's errors from its end */
    for (struct dirent *entry; !s && (entry = readdir(directory)); errno = 0) {
        int64_t number = number_in(entry->d_name, prefix, suffix);
        if (number >= 0) s = append_number(numbers, number, r);
    }
    if (!s && errno) s = file_fail(r, folder, "list the folder", errno);
    closedir(directory);
    if (s) file_numbers_free(numbers);
    if (numbers->count > 1) qsort(numbers->items, numbers->count, sizeof numbers->items[0], compare_i64);
    return s;
}

void file_numbers_free(file_numbers *numbers) {
    memory_free(numbers->items, numbers->capacity * sizeof numbers->items[0]);
    *numbers = (file_numbers){0};
}

static status read_all(int fd, const char *path, char *text, size_t size, report *r) {
    for (size_t done = 0; done < size;) {
        ssize_t got = read(fd, text + done, size - done);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return file_fail(r, path, "read it", errno);
        if (got == 0) return report_set(r, STATUS_SYSTEM, "%s: it shrank while it was read", path);
        done += (size_t)got;
    }
    return STATUS_OK;
}

status file_read_whole(const char *path, char **text, size_t *size, report *r) {
    *text = NULL;
    *size = 0;
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    if (fd < 0 && errno == ENOENT) return STATUS_OK;
    if (fd < 0) return file_fail(r, path, "open it", errno);
    struct stat info;
    status s = STATUS_OK;
    if (fstat(fd, &info) != 0) s = file_fail(r, path, "ask for its size", errno);
    char *block = s ? NULL : memory_allocate((size_t)info.st_size + 1);
    if (!s && !block)
        s = report_set(r, STATUS_SYSTEM, "%s: out of memory for its %lld bytes", path, (long long)info.st_size);
    if (!s) s = read_all(fd, path, block, (size_t)info.st_size, r);
    close(fd);
    if (s) {
        memory_free(block, block ? (size_t)info.st_size + 1 : 0);
        return s;
    }
    *text = block;
    *size = (size_t)info.st_size;
    return STATUS_OK;
}
