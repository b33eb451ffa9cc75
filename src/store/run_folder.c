#include "store/run_folder.h"

#include "store/files.h"
#include "store/frames.h"
#include "store/hdf.h"

#include "base/memory.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { DEPTH = 8 };

/* ---- whose folder it is ------------------------------------------------------------------------------------------ */

/* The run that the folder's newest readable frame names; "" when there is none. */
static status frame_owner(const char *folder, char owner[128], report *r) {
    int64_t *frames;
    int count;
    report ignored;
    owner[0] = '\0';
    status s = frame_list(folder, &frames, &count, r);
    if (s) return s;
    HDF_ALONE;
    for (int i = count; i > 0 && !owner[0]; i--) {
        char path[FILE_PATH];
        hid_t file;
        if (path_format(path, &ignored, "%s/frames/%06" PRId64 ".hdf", folder, frames[i - 1]) || hdf_open(path, &file, &ignored)) continue;
        if (hdf_read_text(file, path, "run_id", owner, 128, &ignored)) owner[0] = '\0';
        H5Fclose(file);
    }
    memory_free(frames, (size_t)count * sizeof *frames);
    return STATUS_OK;
}

static status check_owner(const char *folder, const char *id, const char *parent, report *r) {
    char owner[128], path[FILE_PATH];
    struct stat info;
    if (lstat(folder, &info) == 0 && !S_ISDIR(info.st_mode))
        return report_input(r, folder, 0, id, "the run's own folder", "a link or a file", NULL);
    status s = frame_owner(folder, owner, r);
    if (s) return s;
    if (owner[0])
        return strcmp(owner, id) == 0 || (parent && strcmp(owner, parent) == 0) ? STATUS_OK
                                                                                : report_input(r, folder, 0, id, "frames of this run", owner, NULL);
    /* A run that failed before its first frame left its request. */
    s = path_format(path, r, "%s/scene/request", folder);
    if (s || access(path, F_OK) == 0) return s;
    return report_input(r, folder, 0, id, "the folder of a run: frames, or scene/request", "neither", NULL);
}

/* ---- what is its ------------------------------------------------------------------------------------------------- */

static bool is_numbered(const char *name, const char *prefix) {
    size_t front = strlen(prefix);
    if (strncmp(name, prefix, front) != 0) return false;
    size_t digits = strspn(name + front, "0123456789");
    return digits >= 6 && strcmp(name + front + digits, ".hdf") == 0;
}

static bool ends_in(const char *name, const char *suffix) {
    size_t length = strlen(name), back = strlen(suffix);
    return length >= back && strcmp(name + length - back, suffix) == 0;
}

/* Whether a run writes a file of this name there: `inside` is "", "frames", "frames/sheet", "scene", "scene/recipes" … */
static bool is_ours(const char *inside, const char *name) {
    static const char *const words[] = {"result.json", "turns.json", "commands.log"};
    if (strncmp(inside, "frames", 6) == 0) return is_numbered(name, "") || strcmp(name, "frames.hdf.series") == 0;
    if (strncmp(inside, "scene", 5) == 0) return ends_in(name, ".lua") || strcmp(name, "request") == 0;
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (strcmp(name, words[i]) == 0) return true;
    return is_numbered(name, "checkpoint-");
}

/* Folders that a run makes; a user's own beside them is not entered. */
static bool is_our_folder(const char *inside, const char *name) {
    if (!inside[0]) return strcmp(name, "frames") == 0 || strcmp(name, "scene") == 0;
    return strncmp(inside, "scene", 5) == 0 || strcmp(name, "sheet") == 0 || strcmp(name, "solid") == 0;
}

static void keep(run_folder_removal *out, const char *inside, const char *name) {
    if (out->kept++ == 0) snprintf(out->first_kept, sizeof out->first_kept, "%.120s%s%.120s", inside, inside[0] ? "/" : "", name);
}

static status clear_folder(const char *folder, const char *inside, bool look, int depth, run_folder_removal *out, report *r);

static status clear_entry(const char *folder, const char *inside, const char *name, bool look, int depth, run_folder_removal *out, report *r) {
    char path[FILE_PATH], within[FILE_PATH];
    struct stat info;
    status s = path_format(path, r, "%s%s%s/%s", folder, inside[0] ? "/" : "", inside, name);
    if (!s) s = path_format(within, r, "%s%s%s", inside, inside[0] ? "/" : "", name);
    if (s) return s;
    if (lstat(path, &info) != 0) return errno == ENOENT ? STATUS_OK : file_fail(r, path, "ask for its kind", errno);
    if (S_ISDIR(info.st_mode) && depth < DEPTH && is_our_folder(inside, name)) {
        s = clear_folder(folder, within, look, depth + 1, out, r);
        /* Not empty: something of the user's is in it. */
        if (!s && !look && rmdir(path) != 0 && errno != ENOTEMPTY && errno != EEXIST && errno != ENOENT) s = file_fail(r, path, "remove it", errno);
        return s;
    }
    if (!S_ISREG(info.st_mode) || !is_ours(inside, name)) {
        keep(out, inside, name);
        return STATUS_OK;
    }
    out->files++;
    out->bytes += info.st_size;
    if (!look && unlink(path) != 0 && errno != ENOENT) s = file_fail(r, path, "remove it", errno);
    return s;
}

static status clear_folder(const char *folder, const char *inside, bool look, int depth, run_folder_removal *out, report *r) {
    char path[FILE_PATH];
    status s = path_format(path, r, "%s%s%s", folder, inside[0] ? "/" : "", inside);
    DIR *directory = s ? NULL : opendir(path);
    if (!s && !directory) return file_fail(r, path, "list the folder", errno);
    for (struct dirent *entry; !s && (entry = readdir(directory));)
        if (strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0) s = clear_entry(folder, inside, entry->d_name, look, depth, out, r);
    if (directory) closedir(directory);
    return s;
}

status run_folder_remove(const char *folder, const char *id, const char *parent, bool look, run_folder_removal *out, report *r) {
    struct stat info;
    *out = (run_folder_removal){0};
    out->absent = !folder[0] || (lstat(folder, &info) != 0 && errno == ENOENT);
    if (out->absent) return STATUS_OK;
    status s = check_owner(folder, id, parent, r);
    if (!s && !look) folder_sweep(folder);
    if (!s) s = clear_folder(folder, "", look, 0, out, r);
    if (!s && !look && rmdir(folder) != 0 && errno != ENOTEMPTY && errno != EEXIST) s = file_fail(r, folder, "remove it", errno);
    return s;
}
