#include "store/vtkhdf.h"

#include "base/memory.h"
#include "store/hdf.h"

#include <stdio.h>
#include <string.h>

enum { VTK_VERTEX = 1 };

const char *const vtkhdf_sets[VTKHDF_SETS] = {"solid", "sheet"};

const record *vtkhdf_points(const record_list *records, const char *set) {
    char name[RECORD_NAME];
    snprintf(name, sizeof name, "%s/position", set);
    const record *points = record_find(records, name);
    return points && points->components == 3 ? points : NULL;
}

/* VTK compares Type with a fixed-length ASCII string and reads Version as two integers. */
static status write_kind(hid_t group, const char *path, report *r) {
    static const char kind[] = "UnstructuredGrid";
    const int64_t version[2] = {1, 0};
    hsize_t two = 2;
    hid_t type = H5Tcopy(H5T_C_S1), scalar = H5Screate(H5S_SCALAR), pair = H5Screate_simple(1, &two, NULL);
    H5Tset_size(type, sizeof kind - 1);
    H5Tset_strpad(type, H5T_STR_NULLPAD);
    hid_t name = H5Acreate2(group, "Type", type, scalar, H5P_DEFAULT, H5P_DEFAULT);
    hid_t number = H5Acreate2(group, "Version", H5T_STD_I64LE, pair, H5P_DEFAULT, H5P_DEFAULT);
    bool good =
        name >= 0 && number >= 0 && H5Awrite(name, type, kind) >= 0 && H5Awrite(number, H5T_NATIVE_INT64, version) >= 0;
    status s = good ? STATUS_OK : hdf_fail(r, path, "write the VTKHDF attributes");
    H5Aclose(number);
    H5Aclose(name);
    H5Sclose(pair);
    H5Sclose(scalar);
    H5Tclose(type);
    return s;
}

/* One vertex cell per point: cell i is point i, so connectivity is the first `count` of the offsets 0 … count. */
static status write_cells(hid_t file, const char *path, int64_t count, int deflate, report *r) {
    size_t cells = (size_t)count;
    int64_t *offsets = memory_allocate_array(cells + 1, sizeof *offsets);
    uint8_t *types = memory_allocate(cells);
    status s = offsets && types
                   ? STATUS_OK
                   : report_set(r, STATUS_SYSTEM, "%s: out of memory for the VTK view of %zu points", path, cells);
    if (!s) {
        for (size_t i = 0; i <= cells; i++) offsets[i] = (int64_t)i;
        memset(types, VTK_VERTEX, cells);
        const hdf_array arrays[] = {
            {"VTKHDF/NumberOfPoints", RECORD_I64, 1, 1, &count, NULL},
            {"VTKHDF/NumberOfCells", RECORD_I64, 1, 1, &count, NULL},
            {"VTKHDF/NumberOfConnectivityIds", RECORD_I64, 1, 1, &count, NULL},
            {"VTKHDF/Connectivity", RECORD_I64, count, 1, offsets, NULL},
            {"VTKHDF/Offsets", RECORD_I64, count + 1, 1, offsets, NULL},
            {"VTKHDF/Types", RECORD_U8, count, 1, types, NULL},
        };
        for (size_t i = 0; i < sizeof arrays / sizeof arrays[0] && !s; i++)
            s = hdf_write_array(file, path, &arrays[i], deflate, r);
    }
    memory_free(offsets, (cells + 1) * sizeof *offsets);
    memory_free(types, cells);
    return s;
}

static status link_to(hid_t group, const char *path, const char *name, const char *array, const char *source,
                      report *r) {
    char target[RECORD_NAME + 1];
    snprintf(target, sizeof target, "/%s", array);
    herr_t made = source ? H5Lcreate_external(source, target, group, name, H5P_DEFAULT, H5P_DEFAULT)
                         : H5Lcreate_soft(target, group, name, H5P_DEFAULT, H5P_DEFAULT);
    return made < 0 ? hdf_fail(r, path, "link an array into the VTK view") : STATUS_OK;
}

/* Every array of the set with a row per point, but the points themselves; "a/b" becomes "a_b", since a link is one
 * name. */
static status link_fields(hid_t group, const char *path, const record_list *records, const char *set,
                          const char *source, report *r) {
    const record *points = vtkhdf_points(records, set);
    size_t front = strlen(set) + 1;
    status s = STATUS_OK;
    for (int i = 0; i < records->count && !s; i++) {
        const record *item = &records->items[i];
        if (item == points || item->count != points->count) continue;
        if (strncmp(item->name, points->name, front) != 0) continue;
        if (strncmp(item->name + front, "bond", 4) == 0) continue; /* a row a bond: as many as points by chance */
        char name[RECORD_NAME];
        snprintf(name, sizeof name, "%s", item->name + front);
        for (char *slash = name; (slash = strchr(slash, '/'));) *slash = '_';
        s = link_to(group, path, name, item->name, source, r);
    }
    return s;
}

status vtkhdf_write(hid_t file, const char *path, const record_list *records, const char *set, const char *source,
                    int deflate, report *r) {
    const record *points = vtkhdf_points(records, set);
    hid_t view = hdf_create_group(file, "VTKHDF"), fields = view < 0 ? -1 : hdf_create_group(view, "PointData");
    status s = fields < 0 ? hdf_fail(r, path, "begin the VTK view") : write_kind(view, path, r);
    if (!s) s = write_cells(file, path, points->count, deflate, r);
    if (!s) s = link_to(view, path, "Points", points->name, source, r);
    if (!s) s = link_fields(fields, path, records, set, source, r);
    H5Gclose(fields);
    H5Gclose(view);
    return s;
}
