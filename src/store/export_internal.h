/* What the writers share: text that grows in memory and becomes a file, and values of records. */
#ifndef SUNDER_STORE_EXPORT_INTERNAL_H
#define SUNDER_STORE_EXPORT_INTERNAL_H

#include "store/export.h"

typedef struct export_file {
    const char *path;
    FILE *out;
    char *text;
    size_t size;
} export_file;

/* Begins a file in memory; export_end writes it whole under its path (with `outcome` STATUS_OK) and frees it. */
status export_begin(export_file *f, const char *path, report *r);
status export_end(export_file *f, status outcome, report *r);

/* The index-th record of the set that has a row a particle, positions and ids left out: NULL after the last. */
const record *export_field(const record_list *records, const char *set, int index);
const record *export_positions(const record_list *records, const char *set);

/* A record's name without its set. */
const char *export_short_name(const record *item);

/* A format of files by its suffix: how a thing (points, a mesh) is written in it. */
typedef struct export_format {
    const char *suffix;
    void (*write)(FILE *out, const void *thing);
} export_format;

/* Writes the file whole in the format of its path's suffix. Errors: another suffix (`expected` names those there are); the disk's, memory. */
status export_write(const char *path, const export_format *formats, int count, const char *expected, const void *thing, report *r);

/* Little-endian whatever the machine. */
void export_put_f32(FILE *out, double value);
void export_put_i32(FILE *out, int64_t value);

#endif
