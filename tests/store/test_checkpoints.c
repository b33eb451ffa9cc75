/* Checkpoints: bit for bit, or an error that says what is wrong; never something else. */
#include "base/memory.h"
#include "base/random.h"
#include "check.h"
#include "scratch.h"
#include "store/frames.h"

#include <hdf5.h>

/* Records of every type with arbitrary bits; `seed` makes them differ. */
static void fill_state(record_list *list, int n, uint64_t seed) {
    static const record_type types[] = {RECORD_F32, RECORD_F64, RECORD_I32, RECORD_I64, RECORD_U8, RECORD_U64};
    report r;
    list->count = 0;
    for (int t = 0; t < 6; t++) {
        for (int components = 1; components <= 9; components += 4) {
            char name[RECORD_NAME];
            uint8_t *data;
            snprintf(name, sizeof name, "%s/array_%d_%d", t % 2 ? "solid" : "grid/inner", t, components);
            if (record_add(list, name, types[t], n, components, t ? "" : "length", (void **)&data, &r)) abort();
            size_t bytes = (size_t)n * (size_t)components * record_type_size(types[t]);
            for (size_t i = 0; i < bytes; i++) data[i] = (uint8_t)random_bits(seed, (uint64_t)(10 * t + components), i);
        }
    }
}

static void write_state(const char *run, int n, int64_t frame) {
    record_list list;
    report r;
    frame_header header = header_of(frame);
    fill_state(&list, n, (uint64_t)frame);
    CHECK(checkpoint_write(run, &header, &list, &r) == STATUS_OK);
    record_clear(&list);
}

static bool state_is(const record_list *list, int n, int64_t frame) {
    record_list expected;
    fill_state(&expected, n, (uint64_t)frame);
    bool same = same_records(&expected, list);
    record_clear(&expected);
    return same;
}

static void every_bit_comes_back(void) {
    static const int sizes[] = {0, 1, 7, 5000};
    const char *run = make_run("bits");
    record_list back;
    report r;
    for (int i = 0; i < 4; i++) {
        write_state(run, sizes[i], i);
        CHECK(checkpoint_read(run, i, &back, &r) == STATUS_OK);
        CHECK(state_is(&back, sizes[i], i));
        record_clear(&back);
    }
    write_state(run, 9, 3); /* a frame that is computed again */
    CHECK(checkpoint_read(run, 3, &back, &r) == STATUS_OK && state_is(&back, 9, 3));
    record_clear(&back);
    CHECK(count_files(run, ".tmp") == 0);
}

static void hdf5_tools_can_read_it(void) {
    const char *run = make_run("tools");
    write_state(run, 5, 0);
    hid_t file = H5Fopen(in_scratch("tools/checkpoint-000000.hdf"), H5F_ACC_RDONLY, H5P_DEFAULT);
    CHECK(file >= 0);
    CHECK(H5Aexists(file, "content_xxh3") > 0 && H5Aexists(file, "run_id") > 0);
    CHECK(H5Lexists(file, "/solid", H5P_DEFAULT) > 0);
    H5Fclose(file);
}

/* No byte of the file may change unnoticed, and none may take the program down. */
static void any_flipped_byte_is_noticed(void) {
    const char *run = make_run("flip");
    char path[SCRATCH_PATH];
    record_list back;
    report r;
    size_t size;
    write_state(run, 2, 0);
    snprintf(path, sizeof path, "%s/checkpoint-000000.hdf", run);
    char *good = read_text(path, &size);
    int unnoticed = 0, unnamed = 0;
    for (size_t i = 0; i < size; i += i < 1024 ? 1 : 13) {
        good[i] ^= (char)(1 << i % 8);
        write_text(path, good, size);
        good[i] ^= (char)(1 << i % 8);
        unnoticed += checkpoint_read(run, 0, &back, &r) != STATUS_SYSTEM;
        unnamed += strstr(r.message, "damaged") == NULL || strstr(r.file, "checkpoint-000000.hdf") == NULL;
    }
    CHECK(unnoticed == 0);
    CHECK(unnamed == 0);
    write_text(path, good, size);
    CHECK(checkpoint_read(run, 0, &back, &r) == STATUS_OK && state_is(&back, 2, 0));
    record_clear(&back);
    free(good);
}

static void any_cut_or_grown_file_is_noticed(void) {
    const char *run = make_run("cut");
    char path[SCRATCH_PATH];
    record_list back;
    report r;
    size_t size;
    write_state(run, 2, 0);
    snprintf(path, sizeof path, "%s/checkpoint-000000.hdf", run);
    char *good = read_text(path, &size);
    int unnoticed = 0;
    for (size_t length = 0; length < size; length += length < 600 ? 1 : 97) {
        write_text(path, good, length);
        unnoticed += checkpoint_read(run, 0, &back, &r) != STATUS_SYSTEM;
    }
    CHECK(unnoticed == 0);
    CHECK(strstr(r.expected, "bytes after the seal") && r.found[0]);
    write_text(path, good, size + 1); /* the NUL that read_text put behind it */
    CHECK(checkpoint_read(run, 0, &back, &r) == STATUS_SYSTEM);
    free(good);
}

static void the_last_good_one_is_used(void) {
    const char *run = make_run("fallback");
    record_list back;
    report warning, r;
    int64_t frame = -1;
    CHECK(checkpoint_read_last(run, &back, &frame, &warning, &r) == STATUS_INPUT);
    CHECK(strstr(r.expected, "holds checkpoints"));
    for (int i = 2; i <= 8; i += 2) write_state(run, 3, i);
    CHECK(checkpoint_read_last(run, &back, &frame, &warning, &r) == STATUS_OK);
    CHECK(frame == 8 && warning.code == STATUS_OK && state_is(&back, 3, 8));
    record_clear(&back);
    write_text(in_scratch("fallback/checkpoint-000008.hdf"), "", 0);
    CHECK(checkpoint_read_last(run, &back, &frame, &warning, &r) == STATUS_OK);
    CHECK(frame == 6 && state_is(&back, 3, 6));
    CHECK(warning.code == STATUS_SYSTEM && strstr(warning.file, "000008") && strstr(warning.message, "frame 6"));
    record_clear(&back);
    for (int i = 2; i <= 8; i += 2) write_text(in_scratch("fallback/checkpoint-%06d.hdf", i), "rubbish", 7);
    CHECK(checkpoint_read_last(run, &back, &frame, &warning, &r) == STATUS_SYSTEM);
    CHECK(strstr(r.message, "damaged") && warning.code == STATUS_OK && back.count == 0);
}

static void absent_ones_are_told(void) {
    const char *run = make_run("absent");
    record_list back;
    report r;
    write_state(run, 1, 4);
    write_state(run, 1, 8);
    CHECK(checkpoint_read(run, 7, &back, &r) == STATUS_INPUT);
    CHECK(strcmp(r.expected, "one of the 2 checkpoints of frames 4 to 8") == 0 && strcmp(r.nearest, "4") == 0);
    CHECK(strcmp(r.found, "none of frame 7") == 0);
}

static void old_ones_are_removed(void) {
    const char *run = make_run("thin");
    report r;
    for (int i = 0; i < 6; i++) write_state(run, 1, i);
    CHECK(checkpoint_thin(run, 0, &r) == STATUS_OK && count_files(run, ".hdf") == 6); /* 0 keeps all */
    CHECK(checkpoint_thin(run, 2, &r) == STATUS_OK && count_files(run, ".hdf") == 2);
    CHECK(exists(in_scratch("thin/checkpoint-000005.hdf")) && exists(in_scratch("thin/checkpoint-000004.hdf")));
    CHECK(checkpoint_thin(run, 5, &r) == STATUS_OK && count_files(run, ".hdf") == 2);
    CHECK(checkpoint_thin(in_scratch("nowhere"), 2, &r) == STATUS_OK);
}

static void memory_may_run_out(void) {
    const char *run = make_run("memory");
    record_list list, back;
    report warning, r;
    int64_t frame;
    fill_state(&list, 100, 1);
    size_t before = memory_live_bytes();
    int failures = 0;
    for (int nth = 1;; nth++) {
        frame_header header = header_of(1);
        memory_fail_after(nth, 1);
        status s = checkpoint_write(run, &header, &list, &r);
        if (!s) s = checkpoint_read_last(run, &back, &frame, &warning, &r);
        memory_fail_after(0, 0);
        if (!s) CHECK(same_records(&list, &back));
        if (!s) record_clear(&back);
        CHECK(memory_live_bytes() == before);
        if (!s) break;
        CHECK(s == STATUS_SYSTEM && r.message[0]);
        failures++;
    }
    CHECK(failures > 18);
    record_clear(&list);
}

/* A lack of memory is no damage: an older checkpoint must not quietly take the place of the newest. */
static void want_of_memory_is_not_damage(void) {
    const char *run = make_run("not_damage");
    record_list back;
    report warning, r;
    int64_t frame = -1;
    write_state(run, 3, 1);
    write_state(run, 3, 2);
    memory_fail_after(3, 0); /* once: an older one would be read without trouble */
    status s = checkpoint_read_last(run, &back, &frame, &warning, &r);
    memory_fail_after(0, 0);
    CHECK(s == STATUS_SYSTEM && frame == 2);
    if (!s) record_clear(&back);
}

int main(void) {
    scratch_make();
    RUN(every_bit_comes_back);
    RUN(hdf5_tools_can_read_it);
    RUN(any_flipped_byte_is_noticed);
    RUN(any_cut_or_grown_file_is_noticed);
    RUN(the_last_good_one_is_used);
    RUN(absent_ones_are_told);
    RUN(old_ones_are_removed);
    RUN(memory_may_run_out);
    RUN(want_of_memory_is_not_damage);
    CHECK(memory_live_bytes() == 0);
    return check_finish();
}
