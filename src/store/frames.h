/* A run's folder: frames and checkpoints, one HDF5 file each, written beside, synced and renamed.
 *
 * Any thread may call; HDF5 is called by one at a time. No file stays open between calls, HDF5's own
 * error printing is off and its error stack ends up in the report. */
#ifndef SUNDER_STORE_FRAMES_H
#define SUNDER_STORE_FRAMES_H

#include "base/record.h"
#include "base/status.h"

#include <stdbool.h>

/* What a frame says of itself besides its arrays. */
typedef struct frame_header {
    int64_t frame, step;
    double time;
    const char *run_id, *units, *scene_title, *scene_hash, *version, *precision, *simd;
} frame_header;

/* Creates the folder with frames/ and scene/, and removes what killed writers left half-written. A folder that already
 * holds a run's frames or checkpoints is an input error that says so, unless `resume`. */
status run_folder_create(const char *folder, bool resume, report *r);

/* Writes frames/%06d.hdf from records named "solid/position" [n,3] … "sheet/…", with attributes and a VTKHDF 1.0
 * UnstructuredGrid view by soft links (a vertex cell per particle), then refreshes frames/frames.hdf.series (a JSON
 * file: ParaView's file series with times), itself written beside and renamed. `deflate` 0–9 (with shuffle). When there
 * is a solid and a sheet, the sheet's view is frames/sheet/%06d.hdf, by external links. A frame of another run_id is
 * never overwritten: an input error. */
status frame_write(const char *folder, const frame_header *header, const record_list *records, int deflate, report *r);

/* Reads a frame's records back (names as written, without the VTK view), and its step and time. What was in
 * the list is overwritten, not freed; the caller clears it. A frame that is not there is an input error that names
 * those that are. */
status frame_read(const char *folder, int64_t frame, record_list *records, double *time, int64_t *step, report *r);

/* The same for chosen records only (names NULL: all; those that the frame does not have are left out): what a viewer reads again and again. */
status frame_read_named(const char *folder, int64_t frame, const char *const *names, int count, record_list *records,
                        double *time, int64_t *step, report *r);

/* What a frame holds: names, types, shapes and units; every record's data is NULL, and nothing is to be freed. */
status frame_shapes(const char *folder, int64_t frame, record_list *records, report *r);

/* Numbers of the frames in a run's folder, ascending; none when there is no such folder. Free with memory_free(*frames,
 * *count · 8). */
status frame_list(const char *folder, int64_t **frames, int *count, report *r);

/* Number of the last whole frame, or −1. */
int64_t frame_last(const char *folder);

/* checkpoint-%06d.hdf: any records; every byte comes back as it was. A content hash (xxHash) is stored and checked on
 * reading: a damaged file is an error, and checkpoint_read_last falls back to the one before it, saying so in *warning.
 */
status checkpoint_write(const char *folder, const frame_header *header, const record_list *records, report *r);
status checkpoint_read(const char *folder, int64_t frame, record_list *records, report *r);
status checkpoint_read_last(const char *folder, record_list *records, int64_t *frame, report *warning, report *r);

/* The newest whole checkpoint of a frame up to `most`. Where there is none, *frame is −1 and the status STATUS_OK. */
status checkpoint_read_before(const char *folder, int64_t most, record_list *records, int64_t *frame, report *warning, report *r);

/* Frames that have a checkpoint, ascending, at most `limit`; returns how many there are, 0 too where the folder cannot be read. */
int checkpoint_frames(const char *folder, int64_t *frames, int limit);

/* Removes all but the `keep` newest checkpoints; below 1 it keeps all. */
status checkpoint_thin(const char *folder, int keep, report *r);

/* Keeps checkpoints within `bytes` in all: the first always, and the two newest; of the others the ones go first that the rest make up for best, so that those
 * left are dense where they are new and sparse where they are old. *over (may be NULL) is how many bytes there are still too many. */
status checkpoint_ring(const char *folder, int64_t bytes, int64_t *over, report *r);

/* Gives the frames (with their views) and checkpoints of a run up to `frame` a second name in another run's folder, which then has them for itself
 * whatever happens to the first; where the file system cannot link, they are copied. Files that are there already stay. */
status frame_adopt(const char *from, const char *folder, int64_t frame, report *r);

/* Whether the folder holds this frame, and a checkpoint of it. */
bool frame_exists(const char *folder, int64_t frame);
bool checkpoint_exists(const char *folder, int64_t frame);

/* Removes frames (with their views) and checkpoints numbered above `frame`: a resumed run rewrites them. */
status frame_truncate(const char *folder, int64_t frame, report *r);

/* Reads a whole file: *text has *size bytes and a NUL after them; free *size + 1 bytes. A missing file is STATUS_OK with *text NULL. */
status file_read_text(const char *path, char **text, size_t *size, report *r);

/* Writes text beside, syncs, renames, syncs the directory. */
status file_write_atomic(const char *path, const char *text, size_t size, report *r);

#endif
