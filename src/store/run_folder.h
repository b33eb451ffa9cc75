/* Taking a run's folder away, and nothing but it. */
#ifndef SUNDER_STORE_RUN_FOLDER_H
#define SUNDER_STORE_RUN_FOLDER_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct run_folder_removal {
    bool absent;         /* there was no such folder */
    int64_t files, bytes; /* removed, or that would be */
    int kept;            /* files that no run of sunder writes: they stay, and their folders */
    char first_kept[256]; /* one of them, within the folder */
} run_folder_removal;

/* Removes the folder of run `id`: its frames, checkpoints, scripts and results, by their names; any other file stays, links are not
 * followed. `parent` (may be NULL) is the run whose frames a branch shares. STATUS_INPUT, and nothing is touched, when the folder
 * is not this run's: a link, or without what a run leaves, or with frames of another. `look` only counts. A folder that is not
 * there is fine. */
status run_folder_remove(const char *folder, const char *id, const char *parent, bool look, run_folder_removal *out, report *r);

#endif
