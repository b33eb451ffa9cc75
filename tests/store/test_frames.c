/* Frames: what is written comes back, in the layout that docs/file-format.md promises, and the series names what is
 * there. */
#include "base/memory.h"
#include "base/random.h"
#include "check.h"
#include "scratch.h"
#include "store/frames.h"

#include <fcntl.h>
#include <hdf5.h>
#include <math.h>
#include <sys/file.h>

/* ---- contents ---------------------------------------------------------------------------------------------------- */

static void add(record_list *list, const char *name, record_type type, int64_t count, int components,
                const void *values) {
    void *data;
    report r;
    if (record_add(list, name, type, count, components, "unit", &data, &r)) abort();
    if (count > 0) memcpy(data, values, (size_t)count * (size_t)components * record_type_size(type));
}

static void every_type_comes_back_to_the_bit(void) {
    const uint32_t odd32[6] = {0x7fc12345u, 0x80000000u, 0x7f800000u,
                               1u,          0xff7fffffu, 0x3f800000u}; /* NaN payload, −0, ∞ … */
    const uint64_t odd64[3] = {0x7ff8dead00000001u, 0x8000000000000000u, 1u};
    const int32_t i32[2] = {INT32_MIN, INT32_MAX};
    const int64_t i64[2] = {INT64_MIN, INT64_MAX};
    const uint64_t u64[2] = {0, UINT64_MAX};
    const uint8_t u8[5] = {0, 1, 127, 128, 255};
    record_list list = {0}, back;
    report r;
    double time = 0;
    int64_t step = 0;
    add(&list, "solid/position", RECORD_F32, 2, 3, odd32);
    add(&list, "solid/odd", RECORD_F64, 3, 1, odd64);
    add(&list, "solid/inner/state", RECORD_I32, 2, 1, i32);
    add(&list, "other/i64", RECORD_I64, 1, 2, i64);
    add(&list, "u64", RECORD_U64, 2, 1, u64);
    add(&list, "solid/u8", RECORD_U8, 5, 1, u8);
    add(&list, "solid/none", RECORD_F32, 0, 3, NULL);
    const char *run = make_run("types");
    frame_header header = header_of(3);
    header.time = 0.1;
    CHECK(frame_write(run, &header, &list, 1, &r) == STATUS_OK);
    CHECK(frame_read(run, 3, &back, &time, &step, &r) == STATUS_OK);
    CHECK(time == 0.1 && step == 30);
    CHECK(same_records(&list, &back));
    record_clear(&back);
    record_clear(&list);
}

/* Large enough for several chunks, with a last one that is not full; noise, that no filter makes smaller, included. */
static void chunks_come_back(void) {
    enum { N = 70001 };
    record_list list = {0}, back;
    report r;
    double time;
    int64_t step;
    fill_solid(&list, N, 5);
    fill_sheet(&list, N / 2);
    uint8_t *noise;
    uint64_t *words;
    if (record_add(&list, "solid/noise", RECORD_U8, 3 * N, 1, "", (void **)&noise, &r) ||
        record_add(&list, "solid/words", RECORD_U64, N, 1, "", (void **)&words, &r))
        abort();
    for (int i = 0; i < 3 * N; i++) noise[i] = (uint8_t)random_bits(1, 1, (uint64_t)i);
    for (int i = 0; i < N; i++) words[i] = random_bits(1, 2, (uint64_t)i);
    const char *run = make_run("chunks");
    for (int deflate = 0; deflate <= 9; deflate += 3) {
        frame_header header = header_of(deflate);
        CHECK(frame_write(run, &header, &list, deflate, &r) == STATUS_OK);
        CHECK(frame_read(run, deflate, &back, &time, &step, &r) == STATUS_OK);
        CHECK(same_records(&list, &back));
        record_clear(&back);
    }
    CHECK(size_of(in_scratch("chunks/frames/000003.hdf")) < size_of(in_scratch("chunks/frames/000000.hdf")) / 2);
    record_clear(&list);
}

/* Planes of noise among others, in every order: what is stored as it is and what is packed must come back as one array, and noise takes its own room
 * and no more. */
static void noise_among_planes_comes_back(void) {
    enum { N = 70001, MASKS = 16 };
    static const uint64_t wide[4] = {0x01, 0x80, 0x3f, 0xa5}; /* of eight planes */
    record_list list = {0}, back;
    report r;
    double time;
    int64_t step, raw[MASKS + 4], noisy[MASKS + 4];
    char name[32];
    for (int m = 0; m < MASKS + 4; m++) {
        int planes = m < MASKS ? 4 : 8;
        uint64_t mask = m < MASKS ? (uint64_t)m : wide[m - MASKS];
        unsigned char *bytes;
        snprintf(name, sizeof name, "solid/mask_%d", m);
        if (record_add(&list, name, m < MASKS ? RECORD_I32 : RECORD_U64, N, 1, "", (void **)&bytes, &r)) abort();
        for (int64_t i = 0; i < (int64_t)planes * N; i++)
            bytes[i] = (uint8_t)(mask >> i % planes & 1 ? random_bits(2, (uint64_t)m, (uint64_t)i) : (uint64_t)(i / 4096));
        raw[m] = (int64_t)planes * N;
        noisy[m] = (int64_t)__builtin_popcountll(mask) * N;
    }
    const char *run = make_run("planes");
    const frame_header header = header_of(0);
    CHECK(frame_write(run, &header, &list, 1, &r) == STATUS_OK);
    CHECK(frame_read(run, 0, &back, &time, &step, &r) == STATUS_OK);
    CHECK(same_records(&list, &back));
    hid_t file = H5Fopen(in_scratch("planes/frames/000000.hdf"), H5F_ACC_RDONLY, H5P_DEFAULT);
    for (int m = 0; m < MASKS + 4; m++) {
        snprintf(name, sizeof name, "solid/mask_%d", m);
        hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
        int64_t stored = (int64_t)H5Dget_storage_size(set);
        CHECK(stored >= noisy[m] && stored <= noisy[m] + raw[m] / 32); /* the last chunk is stored whole */
        H5Dclose(set);
    }
    H5Fclose(file);
    record_clear(&back);
    record_clear(&list);
}

/* ---- layout, read with HDF5 itself ------------------------------------------------------------------------------- */

static bool text_attribute_is(hid_t object, const char *name, const char *expected) {
    char text[128] = "";
    hid_t attribute = H5Aopen(object, name, H5P_DEFAULT), type = H5Tcopy(H5T_C_S1);
    if (attribute < 0) return false;
    hid_t stored = H5Aget_type(attribute);
    H5Tset_size(type, sizeof text);
    H5Tset_cset(type, H5Tget_cset(stored));
    bool same = H5Aread(attribute, type, text) >= 0 && strcmp(text, expected) == 0;
    H5Tclose(stored);
    H5Tclose(type);
    H5Aclose(attribute);
    return same;
}

static int64_t integer_attribute(hid_t object, const char *name) {
    int64_t value = -1;
    hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    if (attribute >= 0) H5Aread(attribute, H5T_NATIVE_INT64, &value);
    H5Aclose(attribute);
    return value;
}

/* "[50, 3] f32" and the like; "none" when there is no such dataset. */
static const char *shape_of(hid_t file, const char *name) {
    static char text[96];
    hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
    if (set < 0) return "none";
    hid_t space = H5Dget_space(set), type = H5Dget_type(set);
    hsize_t dims[4];
    int rank = H5Sget_simple_extent_dims(space, dims, NULL), used = 0;
    for (int i = 0; i < rank; i++)
        used += snprintf(text + used, sizeof text - (size_t)used, "%s%d", i ? "," : "", (int)dims[i]);
    snprintf(text + used, sizeof text - (size_t)used, " %c%d", H5Tget_class(type) == H5T_FLOAT ? 'f' : 'i',
             8 * (int)H5Tget_size(type));
    H5Tclose(type);
    H5Sclose(space);
    H5Dclose(set);
    return text;
}

static int64_t first_integer(hid_t file, const char *name) {
    int64_t values[256] = {-1};
    hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
    if (set >= 0) H5Dread(set, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    H5Dclose(set);
    return values[0];
}

static bool link_is(hid_t file, const char *name, H5L_type_t kind, const char *target) {
    H5L_info_t info;
    char value[256] = "";
    const char *path = value, *other;
    if (H5Lget_info(file, name, &info, H5P_DEFAULT) < 0 || info.type != kind) return false;
    if (H5Lget_val(file, name, value, sizeof value, H5P_DEFAULT) < 0) return false;
    if (kind == H5L_TYPE_EXTERNAL && H5Lunpack_elink_val(value, info.u.val_size, NULL, &other, &path) < 0) return false;
    return strcmp(path, target) == 0;
}

static void layout_is_as_documented(void) {
    const char *run = make_run("layout");
    write_solid_frame(run, 50, 7);
    hid_t file = H5Fopen(in_scratch("layout/frames/000007.hdf"), H5F_ACC_RDONLY, H5P_DEFAULT);
    CHECK(file >= 0);
    CHECK(text_attribute_is(file, "format", "sunder frame 1") && text_attribute_is(file, "units", "cgs"));
    CHECK(text_attribute_is(file, "run_id", "20261122-061502-3f9a") &&
          text_attribute_is(file, "scene_title", "Tube pull"));
    CHECK(text_attribute_is(file, "scene_hash", "0123456789abcdef") && text_attribute_is(file, "version", "0.1.0"));
    CHECK(text_attribute_is(file, "precision", "f32") && text_attribute_is(file, "simd", "avx2"));
    CHECK(integer_attribute(file, "frame") == 7 && integer_attribute(file, "step") == 70);
    CHECK(strcmp(shape_of(file, "/solid/position"), "50,3 f32") == 0);
    CHECK(strcmp(shape_of(file, "/solid/damage"), "50 f32") == 0);
    CHECK(strcmp(shape_of(file, "/solid/deformation_gradient"), "50,9 f32") == 0);
    CHECK(strcmp(shape_of(file, "/solid/id"), "50 i32") == 0);
    hid_t set = H5Dopen2(file, "/solid/velocity", H5P_DEFAULT);
    CHECK(text_attribute_is(set, "unit", "length/time"));
    H5Dclose(set);
    H5Fclose(file);
}

static void the_vtk_view_is_version_1(void) {
    const char *run = make_run("vtk");
    write_solid_frame(run, 50, 0);
    hid_t file = H5Fopen(in_scratch("vtk/frames/000000.hdf"), H5F_ACC_RDONLY, H5P_DEFAULT),
          view = H5Gopen2(file, "/VTKHDF", H5P_DEFAULT);
    CHECK(text_attribute_is(view, "Type", "UnstructuredGrid"));
    int64_t version[2] = {-1, -1};
    hid_t attribute = H5Aopen(view, "Version", H5P_DEFAULT);
    CHECK(H5Aread(attribute, H5T_NATIVE_INT64, version) >= 0 && version[0] == 1 && version[1] == 0);
    H5Aclose(attribute);
    CHECK(first_integer(file, "/VTKHDF/NumberOfPoints") == 50 && first_integer(file, "/VTKHDF/NumberOfCells") == 50);
    CHECK(first_integer(file, "/VTKHDF/NumberOfConnectivityIds") == 50);
    CHECK(strcmp(shape_of(file, "/VTKHDF/Offsets"), "51 i64") == 0 &&
          strcmp(shape_of(file, "/VTKHDF/Connectivity"), "50 i64") == 0);
    CHECK(strcmp(shape_of(file, "/VTKHDF/Types"), "50 i8") == 0 && first_integer(file, "/VTKHDF/Types") == 1);
    CHECK(link_is(file, "/VTKHDF/Points", H5L_TYPE_SOFT, "/solid/position"));
    CHECK(link_is(file, "/VTKHDF/PointData/damage", H5L_TYPE_SOFT, "/solid/damage"));
    CHECK(strcmp(shape_of(file, "/VTKHDF/PointData/velocity"), "50,3 f32") == 0);
    CHECK(H5Lexists(file, "/VTKHDF/PointData/position", H5P_DEFAULT) == 0);
    H5Gclose(view);
    H5Fclose(file);
}

static void a_sheet_beside_a_solid_has_its_own_view(void) {
    const char *run = make_run("both");
    record_list list;
    report r;
    frame_header header = header_of(2);
    fill_solid(&list, 40, 2);
    fill_sheet(&list, 30);
    CHECK(frame_write(run, &header, &list, 1, &r) == STATUS_OK);
    record_clear(&list);
    hid_t file = H5Fopen(in_scratch("both/frames/sheet/000002.hdf"), H5F_ACC_RDONLY, H5P_DEFAULT);
    CHECK(link_is(file, "/VTKHDF/Points", H5L_TYPE_EXTERNAL, "/sheet/position"));
    CHECK(strcmp(shape_of(file, "/VTKHDF/Points"), "30,3 f32") == 0);
    CHECK(strcmp(shape_of(file, "/VTKHDF/PointData/diffused"), "30 f32") == 0);
    CHECK(H5Lexists(file, "/VTKHDF/PointData/bonds", H5P_DEFAULT) == 0); /* not one row a point */
    H5Fclose(file);
    CHECK(exists(in_scratch("both/frames/sheet/frames.hdf.series")));

    run = make_run("sheet_only");
    list.count = 0;
    fill_sheet(&list, 30);
    header = header_of(0);
    CHECK(frame_write(run, &header, &list, 1, &r) == STATUS_OK);
    record_clear(&list);
    file = H5Fopen(in_scratch("sheet_only/frames/000000.hdf"), H5F_ACC_RDONLY, H5P_DEFAULT);
    CHECK(link_is(file, "/VTKHDF/Points", H5L_TYPE_SOFT, "/sheet/position"));
    H5Fclose(file);
    CHECK(!exists(in_scratch("sheet_only/frames/sheet")));
}

/* ---- the series -------------------------------------------------------------------------------------------------- */

static bool series_is(const char *path, const char *expected) {
    size_t size;
    char *text = read_text(path, &size);
    bool same = text && strcmp(text, expected) == 0;
    if (!same) printf("  %s\n", text ? text : "(no series)");
    free(text);
    return same;
}

#define SERIES(lines) "{\n  \"file-series-version\": \"1.0\",\n  \"files\": [\n" lines "\n  ]\n}\n"
#define LINE0 "    {\"name\": \"000000.hdf\", \"time\": 0}"
#define LINE3 "    {\"name\": \"000003.hdf\", \"time\": 0.125}"
#define LINE6 "    {\"name\": \"000006.hdf\", \"time\": 0.25}"

static void the_series_follows_the_files(void) {
    const char *run = make_run("series");
    char path[SCRATCH_PATH];
    snprintf(path, sizeof path, "%s/frames/frames.hdf.series", run);
    write_solid_frame(run, 3, 0);
    CHECK(series_is(path, SERIES(LINE0)));
    write_solid_frame(run, 3, 6);
    write_solid_frame(run, 3, 3); /* a gap, filled out of order */
    CHECK(series_is(path, SERIES(LINE0 ",\n" LINE3 ",\n" LINE6)));
    record_list list;
    report r;
    frame_header header = header_of(3);
    header.time = 0.5;
    fill_solid(&list, 3, 3);
    CHECK(frame_write(run, &header, &list, 1, &r) == STATUS_OK); /* the same frame, at another time */
    record_clear(&list);
    CHECK(series_is(path, SERIES(LINE0 ",\n    {\"name\": \"000003.hdf\", \"time\": 0.5},\n" LINE6)));
    remove(in_scratch("series/frames/000003.hdf")); /* a frame that someone took away */
    write_solid_frame(run, 3, 6);
    CHECK(series_is(path, SERIES(LINE0 ",\n" LINE6)));
}

static void a_lost_or_spoilt_series_is_made_anew(void) {
    static const char *const spoilt[] = {"",
                                         "{",
                                         "\0\0\0\0",
                                         "{\"name\": \"000000.hdf\", \"time\": nonsense}",
                                         "{\"name\": \"999999.hdf\", \"time\": 4}",
                                         "{\"name\": \"000000.hdf\", \"time\": 0"};
    const char *run = make_run("spoilt");
    char path[SCRATCH_PATH];
    snprintf(path, sizeof path, "%s/frames/frames.hdf.series", run);
    write_solid_frame(run, 3, 0);
    write_solid_frame(run, 3, 3);
    for (size_t i = 0; i < sizeof spoilt / sizeof spoilt[0]; i++) {
        write_text(path, spoilt[i], strlen(spoilt[i]));
        write_solid_frame(run, 3, 6);
        CHECK(series_is(path, SERIES(LINE0 ",\n" LINE3 ",\n" LINE6)));
        remove(in_scratch("spoilt/frames/000006.hdf"));
    }
    remove(path);
    write_solid_frame(run, 3, 6);
    CHECK(series_is(path, SERIES(LINE0 ",\n" LINE3 ",\n" LINE6)));
    write_text(in_scratch("spoilt/frames/000004.hdf"), "no HDF5", 7); /* would stop ParaView */
    write_solid_frame(run, 3, 6);
    CHECK(series_is(path, SERIES(LINE0 ",\n" LINE3 ",\n" LINE6)));
}

/* ---- numbers, absent frames, folders ----------------------------------------------------------------------------- */

static void the_last_frame_is_found(void) {
    const char *run = make_run("last");
    CHECK(frame_last(in_scratch("nowhere")) == -1);
    CHECK(frame_last(run) == -1);
    write_solid_frame(run, 3, 0);
    write_solid_frame(run, 3, 12);
    CHECK(frame_last(run) == 12);
    write_text(in_scratch("last/frames/000099.hdf"), "cut", 3); /* not a whole frame */
    write_text(in_scratch("last/frames/12.hdf"), "x", 1);
    CHECK(frame_last(run) == 12);
    write_solid_frame(run, 3, 1234567);
    CHECK(frame_last(run) == 1234567);
}

static void absent_frames_are_told(void) {
    const char *run = make_run("absent");
    record_list list;
    report r;
    double time;
    int64_t step;
    CHECK(frame_read(run, 5, &list, &time, &step, &r) == STATUS_INPUT);
    CHECK(strstr(r.expected, "holds frames") && list.count == 0);
    write_solid_frame(run, 3, 2);
    write_solid_frame(run, 3, 4);
    CHECK(frame_read(run, 5, &list, &time, &step, &r) == STATUS_INPUT);
    CHECK(strcmp(r.expected, "one of the 2 frames from 2 to 4") == 0 && strcmp(r.nearest, "4") == 0);
    CHECK(strstr(r.file, "000005.hdf") != NULL);
    CHECK(frame_read(run, 0, &list, &time, &step, &r) == STATUS_INPUT && strcmp(r.nearest, "2") == 0);
}

static void folders_are_made_and_guarded(void) {
    report r;
    CHECK(run_folder_create(in_scratch("a/b/c"), false, &r) == STATUS_OK);
    CHECK(exists(in_scratch("a/b/c/frames")) && exists(in_scratch("a/b/c/scene")));
    CHECK(run_folder_create(in_scratch("a/b/c/"), false, &r) == STATUS_OK); /* empty: may be used */
    write_solid_frame(in_scratch("a/b/c"), 3, 0);
    CHECK(run_folder_create(in_scratch("a/b/c"), false, &r) == STATUS_INPUT);
    CHECK(strstr(r.found, "1 frames") && strstr(r.file, "a/b/c"));
    write_text(in_scratch("a/b/c/frames/.000001.hdf.999999999.tmp"), "x", 1); /* left by a killed writer */
    write_text(in_scratch("a/b/c/frames/.mine.tmp"), "x", 1);
    CHECK(run_folder_create(in_scratch("a/b/c"), true, &r) == STATUS_OK);
    CHECK(!exists(in_scratch("a/b/c/frames/.000001.hdf.999999999.tmp")) &&
          exists(in_scratch("a/b/c/frames/.mine.tmp")));
    CHECK(exists(in_scratch("a/b/c/frames/000000.hdf")));
    write_text(in_scratch("file"), "x", 1);
    CHECK(run_folder_create(in_scratch("file"), false, &r) == STATUS_INPUT && strstr(r.expected, "folder"));
    CHECK(run_folder_create(in_scratch("file/below"), false, &r) != STATUS_OK);
    char path[5000];
    memset(path, 'a', sizeof path);
    path[0] = '/', path[sizeof path - 1] = '\0';
    CHECK(run_folder_create(path, false, &r) == STATUS_INPUT && strstr(r.expected, "shorter"));
}

static void another_runs_frame_is_not_overwritten(void) {
    const char *run = make_run("owner");
    record_list list;
    report r;
    write_solid_frame(run, 3, 1);
    fill_solid(&list, 4, 1);
    frame_header header = header_of(1);
    header.run_id = "20261122-061502-ffff";
    CHECK(frame_write(run, &header, &list, 1, &r) == STATUS_INPUT);
    CHECK(strcmp(r.found, "20261122-061502-3f9a") == 0 && strstr(r.file, "000001.hdf"));
    header.run_id = "20261122-061502-3f9a";
    CHECK(frame_write(run, &header, &list, 1, &r) == STATUS_OK); /* its own it may */
    write_text(in_scratch("owner/frames/000001.hdf"), "spoilt", 6);
    CHECK(frame_write(run, &header, &list, 1, &r) == STATUS_OK); /* and what nobody can read */
    record_clear(&list);
}

static void a_run_is_cut_back(void) {
    const char *run = make_run("cut");
    report r;
    record_list list;
    fill_solid(&list, 3, 0);
    fill_sheet(&list, 3);
    for (int frame = 0; frame <= 6; frame++) {
        frame_header header = header_of(frame);
        CHECK(frame_write(run, &header, &list, 1, &r) == STATUS_OK);
        CHECK(checkpoint_write(run, &header, &list, &r) == STATUS_OK);
    }
    record_clear(&list);
    CHECK(frame_truncate(run, 3, &r) == STATUS_OK);
    CHECK(frame_last(run) == 3);
    CHECK(count_files(in_scratch("cut/frames"), ".hdf") == 4 &&
          count_files(in_scratch("cut/frames/sheet"), ".hdf") == 4);
    CHECK(count_files(in_scratch("cut"), ".hdf") == 4);
    size_t size;
    char *series = read_text(in_scratch("cut/frames/frames.hdf.series"), &size);
    CHECK(strstr(series, "000003.hdf") && !strstr(series, "000004.hdf"));
    free(series);
    CHECK(frame_truncate(run, 100, &r) == STATUS_OK && frame_last(run) == 3);
    CHECK(frame_truncate(in_scratch("nowhere"), 0, &r) == STATUS_OK);
}

/* A program that holds HDF5's lock on a frame (a viewer that writes, a network file system that cannot lock) does not
 * stop us. */
static void locks_do_not_matter(void) {
    const char *run = make_run("locks");
    record_list list;
    report r;
    double time;
    int64_t step;
    write_solid_frame(run, 3, 0);
    int fd = open(in_scratch("locks/frames/000000.hdf"), O_RDWR);
    CHECK(flock(fd, LOCK_EX) == 0);
    CHECK(frame_read(run, 0, &list, &time, &step, &r) == STATUS_OK);
    record_clear(&list);
    write_solid_frame(run, 3, 0);
    close(fd);
}

static void texts_are_written_whole(void) {
    report r;
    CHECK(file_write_atomic(in_scratch("result.json"), "{}", 2, &r) == STATUS_OK &&
          size_of(in_scratch("result.json")) == 2);
    CHECK(file_write_atomic(in_scratch("result.json"), "", 0, &r) == STATUS_OK &&
          size_of(in_scratch("result.json")) == 0);
    CHECK(file_write_atomic(in_scratch("missing/result.json"), "{}", 2, &r) == STATUS_SYSTEM);
    CHECK(strstr(r.file, "missing/result.json") && strstr(r.message, "No such file"));
    CHECK(count_files(scratch, ".tmp") == 0);
}

/* The sum of all of it: whatever allocation fails, it is said, nothing leaks, and the folder holds whole frames only.
 */
static void memory_may_run_out(void) {
    const char *run = make_run("memory");
    record_list list, back;
    report r;
    double time;
    int64_t step;
    fill_solid(&list, 3000, 1);
    fill_sheet(&list, 2000);
    size_t before = memory_live_bytes();
    int failures = 0;
    for (int nth = 1;; nth++) {
        frame_header header = header_of(1);
        memory_fail_after(nth, 1);
        status s = frame_write(run, &header, &list, 1, &r);
        if (!s) s = frame_read(run, 1, &back, &time, &step, &r);
        memory_fail_after(0, 0);
        if (!s) record_clear(&back);
        CHECK(memory_live_bytes() == before);
        if (!s) break;
        CHECK(s == STATUS_SYSTEM && r.message[0]);
        failures++;
    }
    CHECK(failures > 20);
    CHECK(frame_last(run) == 1 && count_files(in_scratch("memory/frames"), ".tmp") == 0);
    record_clear(&list);
}

int main(void) {
    scratch_make();
    RUN(every_type_comes_back_to_the_bit);
    RUN(chunks_come_back);
    RUN(noise_among_planes_comes_back);
    RUN(layout_is_as_documented);
    RUN(the_vtk_view_is_version_1);
    RUN(a_sheet_beside_a_solid_has_its_own_view);
    RUN(the_series_follows_the_files);
    RUN(a_lost_or_spoilt_series_is_made_anew);
    RUN(the_last_frame_is_found);
    RUN(absent_frames_are_told);
    RUN(folders_are_made_and_guarded);
    RUN(another_runs_frame_is_not_overwritten);
    RUN(a_run_is_cut_back);
    RUN(locks_do_not_matter);
    RUN(texts_are_written_whole);
    RUN(memory_may_run_out);
    CHECK(memory_live_bytes() == 0);
    return check_finish();
}
