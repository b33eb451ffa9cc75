/* Files of the store: written beside, synced, renamed, and found again. Internal to this floor. */
#ifndef SUNDER_STORE_FILES_H
#define SUNDER_STORE_FILES_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { FILE_PATH = 4096 };

/* printf into a path of FILE_PATH bytes. STATUS_INPUT when it does not fit: a cut path would name another file. */
status path_format(char path[FILE_PATH], report *r, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Sets the report's file; of a path that is too long, its end stays. */
void report_file(report *r, const char *path);

/* Fills `r` with STATUS_SYSTEM: "PATH: cannot DOING: strerror(error)". */
status file_fail(report *r, const char *path, const char *doing, int error);

/* Creates the folder and its missing parents; one that exists already is fine. */
status folder_create(const char *path, report *r);

/* Syncs a folder, so that the names in it outlive a power cut. */
status folder_sync(const char *path, report *r);

/* Writes a temporary file beside `path` and syncs it. `temporary` is its name, for file_commit or unlink. On an error
 * nothing is left behind. */
status file_write_beside(const char *path, const void *data, size_t size, char temporary[FILE_PATH], report *r);

/* Renames the temporary file to `path` (removing it when that fails). The folder is not synced. */
status file_commit(const char *temporary, const char *path, report *r);

/* Tells the system that a synced file will hardly be read soon, so that its memory serves the next one: memory that has not been used before is slow
 * to come by under a hypervisor. */
void file_forget(const char *path);

/* Writes `path` whole or not at all, and syncs its folder. */
status file_write_whole(const char *path, const void *data, size_t size, report *r);

/* Removes temporary files in `folder` whose writer is no longer alive. */
void folder_sweep(const char *folder);

/* Numbers of the files PREFIX%06dSUFFIX in `folder`, ascending; a missing folder holds none. Free with
 * file_numbers_free. */
typedef struct file_numbers {
    int64_t *items; /* [count] */
    size_t count, capacity;
} file_numbers;

status file_numbers_read(const char *folder, const char *prefix, const char *suffix, file_numbers *numbers, report *r);
void file_numbers_free(file_numbers *numbers);

/* Reads a whole file into memory: *text has *size bytes and a NUL after them; free *size + 1 bytes. A missing file is
 * STATUS_OK with *text NULL. */
status file_read_whole(const char *path, char **text, size_t *size, report *r);

#endif
