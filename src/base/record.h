/* Named arrays: how state travels between floors that do not know each other.
 *
 * The simulation describes a frame or a checkpoint as a list of records; the store writes any list it is given. */
#ifndef SUNDER_BASE_RECORD_H
#define SUNDER_BASE_RECORD_H

#include "base/status.h"

#include <stdint.h>

typedef enum record_type { RECORD_F32, RECORD_F64, RECORD_I32, RECORD_I64, RECORD_U8, RECORD_U64 } record_type;

enum { RECORD_NAME = 64, RECORD_LIMIT = 96 };

typedef struct record {
    char name[RECORD_NAME]; /* a path such as "solid/position" */
    record_type type;
    int components;         /* 1 for scalars: the array has shape [count][components], row-major */
    int64_t count;
    void *data;             /* owned by the record list */
    char unit[32];
} record;

typedef struct record_list {
    int count;
    record items[RECORD_LIMIT];
} record_list;

/* Bytes of one element of `type`. */
size_t record_type_size(record_type type);

/* Adds a zeroed array to the list and returns its data through *data.
 * Errors: STATUS_SYSTEM when memory or room in the list is out. */
status record_add(record_list *list, const char *name, record_type type, int64_t count, int components,
                  const char *unit, void **data, report *r);

/* The record called `name`, or NULL. */
record *record_find(const record_list *list, const char *name);

/* Element i of a record, whatever its type. */
double record_value(const record *item, int64_t i);

/* As record_find, but requires type, count and components to match; names what is wrong otherwise. */
status record_require(const record_list *list, const char *name, record_type type, int64_t count, int components,
                      void **data, report *r);

/* Frees all data and empties the list. */
void record_clear(record_list *list);

#endif
