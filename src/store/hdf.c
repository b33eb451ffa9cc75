#include "store/hdf.h"

#include "base/memory.h"
#include "store/files.h"

#include <pthread.h>
#include <stdio.h>
#include <string.h>

enum {
    IMAGE_STEP = 1 << 18, /* bytes by which HDF5 asks for more room */
    COMPACT_LINKS = 256,  /* more than RECORD_LIMIT: links stay in the group's header, without heap and B-tree */
    COMPACT_ATTRIBUTES = 64,
};

/* A name that no file can have: the core driver first tries to open what it is about to create. */
#define NO_FILE "/dev/null/sunder-image"

static pthread_mutex_t one_thread = PTHREAD_MUTEX_INITIALIZER;

/* HDF5's own printing, off for this thread. */
static void hdf_quiet(void) {
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
}

int hdf_enter(void) {
    pthread_mutex_lock(&one_thread);
    hdf_quiet();
    return 0;
}

void hdf_leave(const int *entered) {
    (void)entered;
    pthread_mutex_unlock(&one_thread);
}

static herr_t keep_innermost(unsigned n, const H5E_error2_t *error, void *context) {
    (void)n;
    *(H5E_error2_t *)context = *error;
    return 1; /* an upward walk starts at the innermost: stop here */
}

status hdf_fail(report *r, const char *path, const char *doing) {
    H5E_error2_t error = {0};
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &error);
    report_set(r, STATUS_SYSTEM, "cannot %s: %s (HDF5, %s)", doing,
               error.desc && error.desc[0] ? error.desc : "no reason given",
               error.func_name ? error.func_name : "unknown");
    report_file(r, path);
    H5Eclear2(H5E_DEFAULT);
    return STATUS_SYSTEM;
}

/* ---- images ------------------------------------------------------------------------------------------------------ */

/* The core driver's memory is ours: reserved in one piece before HDF5 starts, so that memory runs out (if it must)
 * before there is anything to lose, and kept when HDF5 gives it back, so that the finished file needs no copy. */
static void *image_resize(void *block, size_t size, H5FD_file_image_op_t operation, void *context) {
    (void)block, (void)operation;
    hdf_image *image = context;
    if (size <= image->capacity) return image->block;
    size_t capacity = image->capacity * 2 > size ? image->capacity * 2 : size;
    char *larger = memory_resize(image->block, image->capacity, capacity);
    if (!larger) return NULL;
    image->block = larger;
    image->capacity = capacity;
    return larger;
}

static void *image_allocate(size_t size, H5FD_file_image_op_t operation, void *context) {
    return image_resize(NULL, size, operation, context);
}

static herr_t image_keep(void *block, H5FD_file_image_op_t operation, void *context) {
    (void)block, (void)operation, (void)context;
    return 0;
}

static void *image_copy(void *to, const void *from, size_t size, H5FD_file_image_op_t operation, void *context) {
    (void)operation, (void)context;
    return memcpy(to, from, size);
}

static void *context_copy(void *context) {
    return context;
}

static herr_t context_free(void *context) {
    (void)context;
    return 0;
}

static hid_t image_access(hdf_image *image) {
    H5FD_file_image_callbacks_t callbacks = {image_allocate, image_copy,   image_resize, image_keep,
                                             context_copy,   context_free, image};
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    if (access < 0) return access;
    /* Version 1.8's format: every header checksummed, and readable by all that is in use. */
    if (H5Pset_fapl_core(access, IMAGE_STEP, false) < 0 || H5Pset_file_image_callbacks(access, &callbacks) < 0 ||
        H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18) < 0) {
        H5Pclose(access);
        return -1;
    }
    return access;
}

status hdf_image_create(hdf_image *image, const char *path, size_t reserve, size_t user_block, report *r) {
    *image = (hdf_image){.path = path, .file = -1};
    image->block = memory_allocate(reserve);
    if (!image->block) {
        report_set(r, STATUS_SYSTEM, "out of memory for the %zu bytes of a file", reserve);
        report_file(r, path);
        return STATUS_SYSTEM;
    }
    image->capacity = reserve;
    hid_t creation = H5Pcreate(H5P_FILE_CREATE), access = image_access(image);
    if (creation >= 0 && access >= 0 && H5Pset_userblock(creation, user_block) >= 0 &&
        H5Pset_attr_phase_change(creation, COMPACT_ATTRIBUTES, COMPACT_ATTRIBUTES / 2) >= 0)
        image->file = H5Fcreate(NO_FILE, H5F_ACC_TRUNC, creation, access);
    status s = image->file < 0 ? hdf_fail(r, path, "begin an HDF5 file") : STATUS_OK;
    H5Pclose(creation);
    H5Pclose(access);
    if (s) hdf_image_free(image);
    return s;
}

status hdf_image_close(hdf_image *image, report *r) {
    ssize_t size = H5Fflush(image->file, H5F_SCOPE_GLOBAL) < 0 ? -1 : H5Fget_file_image(image->file, NULL, 0);
    hid_t creation = size < 0 ? -1 : H5Fget_create_plist(image->file);
    hsize_t user_block = 0;
    if (creation < 0 || H5Pget_userblock(creation, &user_block) < 0) size = -1;
    H5Pclose(creation);
    if (size < 0) return hdf_fail(r, image->path, "complete the HDF5 file");
    herr_t closed = H5Fclose(image->file);
    image->file = -1;
    if (closed < 0) return hdf_fail(r, image->path, "close the HDF5 file");
    image->size = (size_t)size + (size_t)user_block;
    return STATUS_OK;
}

void hdf_image_free(hdf_image *image) {
    if (image->file >= 0) H5Fclose(image->file);
    memory_free(image->block, image->capacity);
    *image = (hdf_image){.file = -1};
}

/* ---- opening ----------------------------------------------------------------------------------------------------- */

status hdf_open(const char *path, hid_t *file, report *r) {
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    /* Locks fail on some network file systems, and we never write to a file that has its name. */
    *file = access < 0 || H5Pset_file_locking(access, false, true) < 0 ? -1 : H5Fopen(path, H5F_ACC_RDONLY, access);
    status s = *file < 0 ? hdf_fail(r, path, "read it as HDF5") : STATUS_OK;
    H5Pclose(access);
    return s;
}

hid_t hdf_create_group(hid_t parent, const char *name) {
    hid_t creation = H5Pcreate(H5P_GROUP_CREATE), links = H5Pcreate(H5P_LINK_CREATE), group = -1;
    if (creation >= 0 && links >= 0 && H5Pset_link_phase_change(creation, COMPACT_LINKS, COMPACT_LINKS / 2) >= 0 &&
        H5Pset_create_intermediate_group(links, 1) >= 0)
        group = H5Gcreate2(parent, name, links, creation, H5P_DEFAULT);
    H5Pclose(creation);
    H5Pclose(links);
    return group;
}

/* ---- attributes -------------------------------------------------------------------------------------------------- */

static status write_attribute(hid_t object, const char *path, const char *name, hid_t file_type, hid_t memory_type,
                              const void *value, report *r) {
    hid_t space = H5Screate(H5S_SCALAR);
    hid_t attribute = space < 0 ? -1 : H5Acreate2(object, name, file_type, space, H5P_DEFAULT, H5P_DEFAULT);
    bool good = attribute >= 0 && H5Awrite(attribute, memory_type, value) >= 0;
    status s = good ? STATUS_OK : hdf_fail(r, path, "write an attribute");
    if (s) snprintf(r->key, sizeof r->key, "%s", name);
    H5Aclose(attribute);
    H5Sclose(space);
    return s;
}

status hdf_write_text(hid_t object, const char *path, const char *name, const char *value, report *r) {
    const char *text = value ? value : "";
    size_t size = strlen(text);
    hid_t type = H5Tcopy(H5T_C_S1);
    if (type < 0 || H5Tset_size(type, size ? size : 1) < 0 || H5Tset_strpad(type, H5T_STR_NULLPAD) < 0 ||
        H5Tset_cset(type, H5T_CSET_UTF8) < 0) {
        H5Tclose(type);
        return hdf_fail(r, path, "make a text type");
    }
    status s = write_attribute(object, path, name, type, type, text, r);
    H5Tclose(type);
    return s;
}

static status write_integer(hid_t object, const char *path, const char *name, int64_t value, report *r) {
    return write_attribute(object, path, name, H5T_STD_I64LE, H5T_NATIVE_INT64, &value, r);
}

static status write_number(hid_t object, const char *path, const char *name, double value, report *r) {
    return write_attribute(object, path, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value, r);
}

static status read_attribute(hid_t object, const char *path, const char *name, hid_t type, void *value, report *r) {
    hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    bool good = attribute >= 0 && H5Aread(attribute, type, value) >= 0;
    status s = good ? STATUS_OK : hdf_fail(r, path, "read an attribute");
    if (s) snprintf(r->key, sizeof r->key, "%s", name);
    H5Aclose(attribute);
    return s;
}

status hdf_read_text(hid_t object, const char *path, const char *name, char *value, size_t size, report *r) {
    hid_t type = H5Tcopy(H5T_C_S1);
    status s = type < 0 || H5Tset_size(type, size) < 0 || H5Tset_cset(type, H5T_CSET_UTF8) < 0
                   ? hdf_fail(r, path, "make a text type")
                   : read_attribute(object, path, name, type, value, r);
    H5Tclose(type);
    return s;
}

status hdf_read_integer(hid_t object, const char *path, const char *name, int64_t *value, report *r) {
    return read_attribute(object, path, name, H5T_NATIVE_INT64, value, r);
}

status hdf_read_number(hid_t object, const char *path, const char *name, double *value, report *r) {
    return read_attribute(object, path, name, H5T_NATIVE_DOUBLE, value, r);
}

status hdf_write_header(hid_t file, const char *path, const char *format, const frame_header *header, report *r) {
    const struct {
        const char *name, *value;
    } texts[] = {
        {"format", format},
        {"units", header->units},
        {"run_id", header->run_id},
        {"scene_title", header->scene_title},
        {"scene_hash", header->scene_hash},
        {"version", header->version},
        {"precision", header->precision},
        {"simd", header->simd},
    };
    status s = STATUS_OK;
    for (size_t i = 0; i < sizeof texts / sizeof texts[0] && !s; i++)
        s = hdf_write_text(file, path, texts[i].name, texts[i].value, r);
    if (!s) s = write_integer(file, path, "frame", header->frame, r);
    if (!s) s = write_integer(file, path, "step", header->step, r);
    if (!s) s = write_number(file, path, "time", header->time, r);
    return s;
}
