#include "base/record.h"

#include "base/memory.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

size_t record_type_size(record_type type) {
    switch (type) {
    case RECORD_F32:
    case RECORD_I32: return 4;
    case RECORD_F64:
    case RECORD_I64:
    case RECORD_U64: return 8;
    case RECORD_U8: break;
    }
    return 1;
}

static size_t record_bytes(const record *item) {
    return (size_t)item->count * (size_t)item->components * record_type_size(item->type);
}

status record_add(record_list *list, const char *name, record_type type, int64_t count, int components,
                  const char *unit, void **data, report *r) {
    if (list->count == RECORD_LIMIT) return report_set(r, STATUS_SYSTEM, "no room for the array '%s'", name);
    record *item = &list->items[list->count];
    memset(item, 0, sizeof *item);
    snprintf(item->name, sizeof item->name, "%s", name);
    snprintf(item->unit, sizeof item->unit, "%s", unit ? unit : "");
    item->type = type;
    item->count = count;
    item->components = components;
    item->data = memory_allocate(record_bytes(item));
    if (!item->data) return report_set(r, STATUS_SYSTEM, "out of memory for the array '%s'", name);
    list->count++;
    *data = item->data;
    return STATUS_OK;
}

record *record_find(const record_list *list, const char *name) {
    for (int i = 0; i < list->count; i++)
        if (strcmp(list->items[i].name, name) == 0) return (record *)&list->items[i];
    return NULL;
}

double record_value(const record *item, int64_t i) {
    switch (item->type) {
    case RECORD_F32: return ((const float *)item->data)[i];
    case RECORD_F64: return ((const double *)item->data)[i];
    case RECORD_I32: return ((const int32_t *)item->data)[i];
    case RECORD_I64: return (double)((const int64_t *)item->data)[i];
    case RECORD_U8: return ((const uint8_t *)item->data)[i];
    case RECORD_U64: return (double)((const uint64_t *)item->data)[i];
    }
    return NAN;
}

status record_require(const record_list *list, const char *name, record_type type, int64_t count, int components,
                      void **data, report *r) {
    record *item = record_find(list, name);
    if (!item) return report_set(r, STATUS_SYSTEM, "the array '%s' is missing", name);
    if (item->type != type || item->count != count || item->components != components)
        return report_set(r, STATUS_SYSTEM,
                          "the array '%s' has shape [%" PRId64 ",%d] of type %d; expected [%" PRId64 ",%d] of type %d", name,
                          item->count, item->components, (int)item->type, count, components, (int)type);
    *data = item->data;
    return STATUS_OK;
}

void record_clear(record_list *list) {
    for (int i = 0; i < list->count; i++) memory_free(list->items[i].data, record_bytes(&list->items[i]));
    list->count = 0;
}
