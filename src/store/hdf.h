/* HDF5 behind a few calls: files are built in memory and written by files.h, so that a full disk never meets HDF5's own
 * (unforgiving) way of closing a file; reading opens, copies and closes. Internal to this floor. */
#ifndef SUNDER_STORE_HDF_H
#define SUNDER_STORE_HDF_H

#include "base/record.h"
#include "base/status.h"
#include "store/frames.h"

#include <hdf5.h>

/* HDF5 knows no threads: the function in which this stands is alone with it until it returns, and HDF5 prints nothing. Every public call of
 * frames.h begins with it; not to be nested. */
#define HDF_ALONE int hdf_alone __attribute__((cleanup(hdf_leave), unused)) = hdf_enter()
int hdf_enter(void);
void hdf_leave(const int *entered);

/* Fills `r` with STATUS_SYSTEM: "PATH: cannot DOING: the innermost message of HDF5's error stack". */
status hdf_fail(report *r, const char *path, const char *doing);

/* A file being built in memory. `path` is what it will be called; it serves messages only. */
typedef struct hdf_image {
    const char *path;
    hid_t file;
    char *block; /* [size] once closed: the file's bytes */
    size_t capacity, size;
} hdf_image;

/* Starts an image with room for `reserve` bytes (it grows past it) and `user_block` bytes (0, or 512·2^k) before HDF5's
 * own. */
status hdf_image_create(hdf_image *image, const char *path, size_t reserve, size_t user_block, report *r);

/* Completes block and size. Pair hdf_image_create with hdf_image_free on every way out; it closes what is open. */
status hdf_image_close(hdf_image *image, report *r);
void hdf_image_free(hdf_image *image);

/* Opens an existing file for reading, without HDF5's file locks: our files never change once they have their name. */
status hdf_open(const char *path, hid_t *file, report *r);

/* Attributes of a file, group or dataset. */
status hdf_write_text(hid_t object, const char *path, const char *name, const char *value, report *r);
status hdf_read_text(hid_t object, const char *path, const char *name, char *value, size_t size, report *r);
status hdf_read_integer(hid_t object, const char *path, const char *name, int64_t *value, report *r);
status hdf_read_number(hid_t object, const char *path, const char *name, double *value, report *r);

/* The attributes that frames, views and checkpoints share. */
status hdf_write_header(hid_t file, const char *path, const char *format, const frame_header *header, report *r);

/* Creates a group whose links and attributes stay in its header (small files, checksummed). */
hid_t hdf_create_group(hid_t parent, const char *name);

typedef struct hdf_array {
    const char *name; /* path in the file; groups on the way are made */
    record_type type;
    int64_t count;
    int components;
    const void *data; /* [count][components] */
    const char *unit; /* attribute; NULL: none */
} hdf_array;

/* Writes one dataset: [count] when components is 1, else [count, components]. `deflate` 1–9 compresses what is large
 * enough to be worth it; 0 writes it as it is. */
status hdf_write_array(hid_t file, const char *path, const hdf_array *array, int deflate, report *r);

/* Reads every dataset outside the group `skip` (may be NULL) into records called by their path. */
status hdf_read_records(hid_t file, const char *path, const char *skip, record_list *records, report *r);

/* The same without the values: each record's data is NULL. Nothing is to be freed. */
status hdf_read_shapes(hid_t file, const char *path, const char *skip, record_list *records, report *r);

/* Reads the datasets of these names [count]; those that are not there are left out. */
status hdf_read_named(hid_t file, const char *path, const char *const *names, int count, record_list *records, report *r);

#endif
