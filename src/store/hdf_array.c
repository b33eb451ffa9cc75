/* Datasets: records out and in. */
#include "store/hdf.h"

#include "store/files.h"
#include "store/hdf_chunks.h"

#include <stdio.h>
#include <string.h>

/* The on-disk type, or the native one that it is read into. */
static hid_t type_of(record_type type, bool native) {
    switch (type) {
    case RECORD_F32: return native ? H5T_NATIVE_FLOAT : H5T_IEEE_F32LE;
    case RECORD_F64: return native ? H5T_NATIVE_DOUBLE : H5T_IEEE_F64LE;
    case RECORD_I32: return native ? H5T_NATIVE_INT32 : H5T_STD_I32LE;
    case RECORD_I64: return native ? H5T_NATIVE_INT64 : H5T_STD_I64LE;
    case RECORD_U8: return native ? H5T_NATIVE_UINT8 : H5T_STD_U8LE;
    case RECORD_U64: break;
    }
    return native ? H5T_NATIVE_UINT64 : H5T_STD_U64LE;
}

/* Finds the record type that holds values of a dataset's type exactly. */
static bool record_type_of(hid_t type, record_type *found) {
    H5T_class_t class = H5Tget_class(type);
    size_t size = H5Tget_size(type);
    bool is_signed = class == H5T_INTEGER && H5Tget_sign(type) == H5T_SGN_2;
    if (class == H5T_FLOAT && (size == 4 || size == 8))
        *found = size == 4 ? RECORD_F32 : RECORD_F64;
    else if (class == H5T_INTEGER && is_signed && (size == 4 || size == 8))
        *found = size == 4 ? RECORD_I32 : RECORD_I64;
    else if (class == H5T_INTEGER && !is_signed && (size == 1 || size == 8))
        *found = size == 1 ? RECORD_U8 : RECORD_U64;
    else
        return false;
    return true;
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

/* A creation list: chunked with shuffle and deflate (whose streams carry a checksum) when `rows` says so, else
 * contiguous. */
static hid_t creation_list(const hdf_array *array, int rank, int64_t rows, int deflate) {
    hid_t list = H5Pcreate(H5P_DATASET_CREATE);
    hsize_t chunk[2] = {(hsize_t)rows, (hsize_t)array->components};
    bool good = list >= 0 && H5Pset_fill_time(list, H5D_FILL_TIME_NEVER) >= 0;
    if (good && rows > 0) {
        good = H5Pset_chunk(list, rank, chunk) >= 0;
        if (record_type_size(array->type) > 1) good = good && H5Pset_shuffle(list) >= 0;
        good = good && H5Pset_deflate(list, (unsigned)deflate) >= 0;
    }
    if (good) return list;
    H5Pclose(list);
    return -1;
}

static hid_t create_dataset(hid_t file, const hdf_array *array, int64_t rows, int deflate) {
    hsize_t dims[2] = {(hsize_t)array->count, (hsize_t)array->components};
    int rank = array->components == 1 ? 1 : 2;
    hid_t space = H5Screate_simple(rank, dims, NULL), links = H5Pcreate(H5P_LINK_CREATE), set = -1;
    hid_t list = creation_list(array, rank, rows, deflate);
    if (space >= 0 && list >= 0 && links >= 0 && H5Pset_create_intermediate_group(links, 1) >= 0)
        set = H5Dcreate2(file, array->name, type_of(array->type, false), space, links, list, H5P_DEFAULT);
    H5Pclose(list);
    H5Pclose(links);
    H5Sclose(space);
    return set;
}

status hdf_write_array(hid_t file, const char *path, const hdf_array *array, int deflate, report *r) {
    int64_t rows = deflate > 0 ? hdf_chunk_rows(array) : 0;
    hid_t set = create_dataset(file, array, rows, deflate);
    status s = set < 0 ? hdf_fail(r, path, "create an array") : STATUS_OK;
    if (!s && rows > 0)
        s = hdf_write_chunks(set, path, array, deflate, r);
    else if (!s && array->count > 0 &&
             H5Dwrite(set, type_of(array->type, true), H5S_ALL, H5S_ALL, H5P_DEFAULT, array->data) < 0)
        s = hdf_fail(r, path, "write an array");
    if (!s && array->unit) s = hdf_write_text(set, path, "unit", array->unit, r);
    if (set >= 0 && H5Dclose(set) < 0 && !s) s = hdf_fail(r, path, "finish an array");
    if (s) snprintf(r->key, sizeof r->key, "%s", array->name);
    return s;
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

typedef struct reading {
    const char *path, *skip;
    record_list *records;
    report *report;
    status status;
    bool shapes; /* names, types and shapes only: data stays NULL */
} reading;

static status odd_array(reading *read, const char *name, const char *expected, const char *found) {
    report_set(read->report, STATUS_SYSTEM, "an array that sunder does not write");
    report_file(read->report, read->path);
    snprintf(read->report->key, sizeof read->report->key, "%s", name);
    snprintf(read->report->expected, sizeof read->report->expected, "%s", expected);
    snprintf(read->report->found, sizeof read->report->found, "%s", found);
    return STATUS_SYSTEM;
}

static status read_shape(reading *read, hid_t set, const char *name, int64_t *count, int *components) {
    hid_t space = H5Dget_space(set);
    hsize_t dims[2] = {0, 1};
    int rank = space < 0 ? -1 : H5Sget_simple_extent_ndims(space);
    if (rank == 1 || rank == 2) rank = H5Sget_simple_extent_dims(space, dims, NULL);
    H5Sclose(space);
    /* The product must fit memory's own arithmetic; whether there is that much is the allocator's to say. */
    if ((rank != 1 && rank != 2) || dims[0] > INT64_MAX / 64 || dims[1] > 4096 || dims[0] * dims[1] > INT64_MAX / 64)
        return odd_array(read, name, "shape [n] or [n, components]", "another");
    *count = (int64_t)dims[0];
    *components = (int)dims[1];
    return STATUS_OK;
}

static status read_unit(reading *read, hid_t set, char unit[32]) {
    unit[0] = '\0';
    if (H5Aexists(set, "unit") <= 0) return STATUS_OK;
    return hdf_read_text(set, read->path, "unit", unit, 32, read->report);
}

static status add_shape(reading *read, const char *name, record_type kind, int64_t count, int components, const char *unit) {
    record_list *list = read->records;
    if (list->count == RECORD_LIMIT) return report_set(read->report, STATUS_SYSTEM, "%s: over %d arrays", read->path, RECORD_LIMIT);
    record *item = &list->items[list->count++];
    *item = (record){.type = kind, .components = components, .count = count};
    snprintf(item->name, sizeof item->name, "%s", name);
    snprintf(item->unit, sizeof item->unit, "%.31s", unit);
    return STATUS_OK;
}

static status read_array(reading *read, hid_t set, const char *name) {
    hid_t type = H5Dget_type(set);
    record_type kind;
    bool known = type >= 0 && record_type_of(type, &kind);
    H5Tclose(type);
    if (!known) return odd_array(read, name, "f32, f64, i32, i64, u8 or u64", "another type");
    if (strlen(name) >= RECORD_NAME) return odd_array(read, name, "a name of at most 63 bytes", "a longer one");
    int64_t count;
    int components;
    char unit[32];
    void *data;
    status s = read_shape(read, set, name, &count, &components);
    if (!s) s = read_unit(read, set, unit);
    if (!s && read->shapes) return add_shape(read, name, kind, count, components, unit);
    if (!s) s = record_add(read->records, name, kind, count, components, unit, &data, read->report);
    if (s || count == 0) return s;
    if (H5Dread(set, type_of(kind, true), H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0) return STATUS_OK;
    hdf_fail(read->report, read->path, "read an array");
    snprintf(read->report->key, sizeof read->report->key, "%s", name);
    return STATUS_SYSTEM;
}

static herr_t visit(hid_t file, const char *name, const H5O_info_t *info, void *context) {
    reading *read = context;
    size_t skipped = read->skip ? strlen(read->skip) : 0;
    if (info->type != H5O_TYPE_DATASET) return 0;
    if (skipped && strncmp(name, read->skip, skipped) == 0 && name[skipped] == '/') return 0;
    hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
    read->status = set < 0 ? hdf_fail(read->report, read->path, "open an array") : read_array(read, set, name);
    H5Dclose(set);
    return read->status ? -1 : 0;
}

static status read_all(hid_t file, reading *read) {
    herr_t visited = H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, visit, read, H5O_INFO_BASIC);
    if (visited >= 0) return STATUS_OK;
    if (!read->status) read->status = hdf_fail(read->report, read->path, "list the arrays");
    H5Eclear2(H5E_DEFAULT);
    return read->status;
}

status hdf_read_records(hid_t file, const char *path, const char *skip, record_list *records, report *r) {
    reading read = {.path = path, .skip = skip, .records = records, .report = r};
    status s = read_all(file, &read);
    if (s) record_clear(records);
    return s;
}

status hdf_read_shapes(hid_t file, const char *path, const char *skip, record_list *records, report *r) {
    reading read = {.path = path, .skip = skip, .records = records, .report = r, .shapes = true};
    status s = read_all(file, &read);
    if (s) records->count = 0;
    return s;
}

status hdf_read_named(hid_t file, const char *path, const char *const *names, int count, record_list *records, report *r) {
    reading read = {.path = path, .records = records, .report = r};
    status s = STATUS_OK;
    for (int i = 0; i < count && !s; i++) {
        hid_t set = H5Dopen2(file, names[i], H5P_DEFAULT);
        if (set < 0) continue;
        s = read_array(&read, set, names[i]);
        H5Dclose(set);
    }
    H5Eclear2(H5E_DEFAULT);
    if (s) record_clear(records);
    return s;
}
