/* The ground floor: memory, reports, names, records, random numbers, loops on threads. */
#include "base/memory.h"
#include "base/names.h"
#include "base/random.h"
#include "base/record.h"
#include "base/status.h"
#include "base/threads.h"
#include "check.h"

#include <stdatomic.h>

/* ---- memory -------------------------------------------------------------------------------------------------------
 */

static bool all_bytes_are(const void *block, size_t bytes, unsigned char value) {
    for (size_t i = 0; i < bytes; i++)
        if (((const unsigned char *)block)[i] != value) return false;
    return true;
}

static void blocks_are_zeroed_and_aligned(void) {
    for (size_t bytes = 0; bytes < 300; bytes += 7) {
        unsigned char *block = memory_allocate(bytes);
        CHECK(block && (uintptr_t)block % MEMORY_ALIGNMENT == 0);
        CHECK(all_bytes_are(block, bytes, 0));
        /* Dirty what goes back, so that the next block is zero only if someone clears it. */
        memset(block, 0xa5, bytes);
        memory_free(block, bytes);
    }
}

static void live_and_peak_bytes(void) {
    size_t before = memory_live_bytes();
    uint64_t count = memory_allocation_count();
    void *a = memory_allocate(1000), *b = memory_allocate_array(30, 8);
    CHECK(memory_live_bytes() == before + 1240);
    CHECK(memory_peak_bytes() >= before + 1240);
    memory_free(b, 240);
    memory_free(NULL, 12345);
    CHECK(memory_live_bytes() == before + 1000);
    size_t peak = memory_peak_bytes();
    void *large = memory_allocate(peak);
    CHECK(memory_peak_bytes() == before + 1000 + peak);
    memory_free(large, peak);
    memory_free(a, 1000);
    CHECK(memory_live_bytes() == before);
    CHECK(memory_peak_bytes() == before + 1000 + peak);
    CHECK(memory_allocation_count() == count + 3);
}

static void resizing_keeps_and_zeroes(void) {
    size_t before = memory_live_bytes();
    unsigned char *block = memory_resize(NULL, 0, 10);
    memset(block, 7, 10);
    block = memory_resize(block, 10, 1000);
    CHECK(all_bytes_are(block, 10, 7));
    CHECK(all_bytes_are(block + 10, 990, 0));
    CHECK(memory_live_bytes() == before + 1000);
    memory_fail_after(1, 0);
    CHECK(!memory_resize(block, 1000, 2000));
    CHECK(all_bytes_are(block, 10, 7));
    CHECK(memory_live_bytes() == before + 1000);
    block = memory_resize(block, 1000, 5);
    CHECK(all_bytes_are(block, 5, 7));
    memory_free(block, 5);
    CHECK(memory_live_bytes() == before);
}

/* Numbers of the allocations, of six, that fail. */
static unsigned failing_allocations(int64_t countdown, int sticky) {
    unsigned failed = 0;
    memory_fail_after(countdown, sticky);
    for (unsigned n = 1; n <= 6; n++) {
        void *block = memory_allocate(8);
        if (!block) failed |= 1u << n;
        memory_free(block, 8);
    }
    memory_fail_after(0, 0);
    return failed;
}

static void chosen_allocations_fail(void) {
    size_t before = memory_live_bytes();
    uint64_t count = memory_allocation_count();
    CHECK(failing_allocations(0, 0) == 0);
    CHECK(failing_allocations(1, 0) == 1u << 1);
    CHECK(failing_allocations(3, 0) == 1u << 3);
    CHECK(failing_allocations(4, 1) == (1u << 4 | 1u << 5 | 1u << 6));
    CHECK(failing_allocations(0, 1) == 0);
    CHECK(memory_allocation_count() == count + 30);
    CHECK(memory_live_bytes() == before);
}

static void impossible_sizes_fail(void) {
    size_t before = memory_live_bytes();
    CHECK(!memory_allocate(SIZE_MAX));
    CHECK(!memory_allocate_array(SIZE_MAX / 2, 3));
    /* 2^33 × 2^33 wraps around to 4 bytes. */
    CHECK(!memory_allocate_array((size_t)1 << 33, (size_t)1 << 33));
    CHECK(memory_live_bytes() == before);
    void *none = memory_allocate_array(0, 8);
    CHECK(none);
    memory_free(none, 0);
}

/* ---- arenas -------------------------------------------------------------------------------------------------------
 */

static void arenas_align_and_grow(void) {
    enum { BLOCKS = 500 };
    size_t before = memory_live_bytes(), sizes[BLOCKS];
    unsigned char *blocks[BLOCKS];
    arena *a = arena_create("test");
    for (int n = 0; n < BLOCKS; n++) {
        sizes[n] = n % 50 == 49 ? 100000 : (size_t)(n * 37 % 1500);
        blocks[n] = arena_allocate(a, sizes[n]);
        CHECK(blocks[n] && (uintptr_t)blocks[n] % MEMORY_ALIGNMENT == 0);
        CHECK(all_bytes_are(blocks[n], sizes[n], 0));
        memset(blocks[n], n & 0xff, sizes[n]);
    }
    for (int n = 0; n < BLOCKS; n++) CHECK(all_bytes_are(blocks[n], sizes[n], (unsigned char)(n & 0xff)));
    CHECK(memory_live_bytes() > before + 1000000);
    arena_destroy(a);
    arena_destroy(NULL);
    CHECK(memory_live_bytes() == before);
}

/* Blocks that fill chunks to the brim still lie in memory that was asked for, beside the first chunk's own header. */
static void arenas_stay_within_their_chunks(void) {
    size_t before = memory_live_bytes();
    arena *a = arena_create("test");
    for (size_t handed = 64; handed <= 64 * 5000; handed += 64) {
        CHECK(arena_allocate(a, 64));
        CHECK(memory_live_bytes() - before >= handed + MEMORY_ALIGNMENT);
    }
    arena_destroy(a);
}

static void arenas_copy_strings_and_fail(void) {
    size_t before = memory_live_bytes();
    char text[] = "tube pull";
    memory_fail_after(1, 0);
    CHECK(!arena_create("test"));
    arena *a = arena_create("test");
    memory_fail_after(1, 0);
    CHECK(!arena_copy_string(a, text));
    const char *copy = arena_copy_string(a, text), *empty = arena_copy_string(a, "");
    text[0] = 'c';
    CHECK(copy && strcmp(copy, "tube pull") == 0);
    CHECK(empty && empty[0] == '\0' && empty != copy);
    char line[MEMORY_ALIGNMENT + 1] = {0};
    memset(line, '-', sizeof line - 1);
    const char *long_copy = arena_copy_string(a, line);
    void *next = arena_allocate(a, 64);
    memset(next, 'x', 64);
    CHECK(long_copy && strcmp(long_copy, line) == 0);
    CHECK(!arena_allocate(a, SIZE_MAX));
    CHECK(!arena_allocate(a, SIZE_MAX - 100));
    arena_destroy(a);
    CHECK(memory_live_bytes() == before);
}

/* ---- reports ------------------------------------------------------------------------------------------------------
 */

static void check_sentence(const report *r, const char *expected) {
    char text[400];
    report_format(r, text, sizeof text);
    CHECK(strcmp(text, expected) == 0);
    if (strcmp(text, expected) != 0) printf("  got: %s\n", text);
}

static void reports_become_sentences(void) {
    report r;
    CHECK(report_set(&r, STATUS_SYSTEM, "cannot write '%s': %d", "x.hdf", 28) == STATUS_SYSTEM);
    CHECK(r.code == STATUS_SYSTEM && r.line == 0);
    check_sentence(&r, "cannot write 'x.hdf': 28");
    CHECK(report_input(&r, "a.lua", 7, "gama", "a known key", "gama", "gamma") == STATUS_INPUT);
    CHECK(r.code == STATUS_INPUT && r.message[0] == '\0');
    check_sentence(&r, "a.lua:7: gama: expected a known key, found gama (did you mean 'gamma'?)");
    report_input(&r, "a.lua", 0, NULL, NULL, "nothing", NULL);
    check_sentence(&r, "a.lua: found nothing");
    report_input(&r, NULL, 3, "dt", "a number > 0", NULL, NULL);
    check_sentence(&r, "dt: expected a number > 0");
    snprintf(r.message, sizeof r.message, "too slow");
    check_sentence(&r, "dt: too slow; expected a number > 0");
    report_clear(&r);
    CHECK(r.code == STATUS_OK);
    check_sentence(&r, "");
}

static void long_texts_are_cut(void) {
    char wide[1000], text[40];
    memset(wide, 'w', sizeof wide - 1);
    wide[sizeof wide - 1] = '\0';
    report r;
    report_input(&r, wide, 1, wide, wide, wide, wide);
    CHECK(strlen(r.file) == sizeof r.file - 1 && strlen(r.key) == sizeof r.key - 1);
    CHECK(strlen(r.expected) == sizeof r.expected - 1 && strlen(r.nearest) == sizeof r.nearest - 1);
    report_set(&r, STATUS_INPUT, "%s", wide);
    CHECK(strlen(r.message) == sizeof r.message - 1);
    report_input(&r, "file.lua", 12, "key", "something", "something else", "nearest");
    for (size_t size = 1; size < sizeof text; size++) {
        memset(text, '#', sizeof text);
        report_format(&r, text, size);
        CHECK(strlen(text) == size - 1);
        CHECK(all_bytes_are(text + size, sizeof text - size, '#'));
    }
    text[0] = '#';
    report_format(&r, text, 0);
    CHECK(text[0] == '#');
}

static void exit_codes(void) {
    CHECK(status_exit_code(STATUS_OK) == 0);
    CHECK(status_exit_code(STATUS_DIVERGED) == 1);
    CHECK(status_exit_code(STATUS_SYSTEM) == 1);
    CHECK(status_exit_code(STATUS_INPUT) == 2);
    CHECK(status_exit_code(STATUS_INTERRUPTED) == 130);
}

/* ---- names --------------------------------------------------------------------------------------------------------
 */

static void distances_between_names(void) {
    CHECK_NEAR(name_distance("gamma", "gamma"), 0.0, 0.0);
    CHECK_NEAR(name_distance("gama", "gamma"), 1.0, 0.0);
    CHECK_NEAR(name_distance("gammma", "gamma"), 1.0, 0.0);
    CHECK_NEAR(name_distance("gemma", "gamma"), 1.0, 0.0);
    CHECK_NEAR(name_distance("agmma", "gamma"), 1.0, 0.0);
    CHECK_NEAR(name_distance("Gamma", "gamma"), 0.5, 0.0);
    CHECK_NEAR(name_distance("", "gamma"), 5.0, 0.0);
    CHECK_NEAR(name_distance("gamma", ""), 5.0, 0.0);
    CHECK_NEAR(name_distance("kitten", "sitting"), 3.0, 0.0);
    CHECK_NEAR(name_distance("ab", "ba"), 1.0, 0.0);
    CHECK_NEAR(name_distance("ab", "bc"), 2.0, 0.0);
    char longer[200];
    memset(longer, 'n', sizeof longer - 1);
    longer[sizeof longer - 1] = '\0';
    CHECK_NEAR(name_distance(longer, longer + 50), 0.0, 0.0);
    CHECK_NEAR(name_distance(longer, "n"), 62.0, 0.0);
}

static void nearest_names(void) {
    static const char *const keys[] = {"gamma",         "sigma_c",  NULL, "eta", "alpha",
                                       "break_stretch", "residual", "E",  "nu",  "gamut"};
    enum { KEYS = sizeof keys / sizeof *keys };
    static const struct {
        const char *wrong, *right;
    } cases[] = {{"gama", "gamma"},
                 {"sigmac", "sigma_c"},
                 {"zzzz", NULL},
                 {"Eta", "eta"},
                 {"aplha", "alpha"},
                 {"e", "E"},
                 {"brekstrech", "break_stretch"},
                 {"residaul", "residual"},
                 {"viscosity", NULL},
                 {"break_stretch_x", "break_stretch"}};
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        const char *found = name_nearest(cases[n].wrong, keys, KEYS);
        CHECK(found == cases[n].right || (found && cases[n].right && strcmp(found, cases[n].right) == 0));
    }
    CHECK(!name_nearest("gamma", NULL, 0));
}

/* ---- records ------------------------------------------------------------------------------------------------------
 */

static void record_types(void) {
    CHECK(record_type_size(RECORD_F32) == 4 && record_type_size(RECORD_F64) == 8);
    CHECK(record_type_size(RECORD_I32) == 4 && record_type_size(RECORD_I64) == 8);
    CHECK(record_type_size(RECORD_U8) == 1 && record_type_size(RECORD_U64) == 8);
}

static void records_are_added_and_found(void) {
    static record_list list;
    size_t before = memory_live_bytes();
    report r;
    void *position = NULL, *flags = NULL, *empty = NULL, *data = NULL;
    CHECK(record_add(&list, "solid/position", RECORD_F64, 10, 3, "length", &position, &r) == STATUS_OK);
    CHECK(record_add(&list, "solid/flags", RECORD_U8, 10, 1, NULL, &flags, &r) == STATUS_OK);
    CHECK(record_add(&list, "solid/empty", RECORD_I32, 0, 1, "", &empty, &r) == STATUS_OK);
    CHECK(list.count == 3 && memory_live_bytes() == before + 250);
    CHECK(all_bytes_are(position, 240, 0) && empty);
    record *found = record_find(&list, "solid/position");
    CHECK(found && found->data == position && found->components == 3 && found->count == 10);
    CHECK(found && strcmp(found->unit, "length") == 0);
    found = record_find(&list, "solid/flags");
    CHECK(found && found->unit[0] == '\0');
    CHECK(!record_find(&list, "solid/pos"));
    CHECK(record_require(&list, "solid/flags", RECORD_U8, 10, 1, &data, &r) == STATUS_OK && data == flags);
    CHECK(record_require(&list, "solid/mass", RECORD_U8, 10, 1, &data, &r) == STATUS_SYSTEM);
    CHECK(strstr(r.message, "solid/mass") && strstr(r.message, "missing"));
    CHECK(record_require(&list, "solid/flags", RECORD_F32, 10, 1, &data, &r) == STATUS_SYSTEM);
    CHECK(record_require(&list, "solid/flags", RECORD_U8, 11, 1, &data, &r) == STATUS_SYSTEM);
    CHECK(strstr(r.message, "[10,1]") && strstr(r.message, "[11,1]"));
    CHECK(record_require(&list, "solid/flags", RECORD_U8, 10, 2, &data, &r) == STATUS_SYSTEM);
    record_clear(&list);
    CHECK(list.count == 0 && memory_live_bytes() == before);
    CHECK(!record_find(&list, "solid/position"));
}

static void record_lists_run_out(void) {
    static record_list list;
    size_t before = memory_live_bytes();
    report r;
    void *data;
    memory_fail_after(1, 0);
    CHECK(record_add(&list, "first", RECORD_F32, 4, 1, "", &data, &r) == STATUS_SYSTEM);
    CHECK(list.count == 0 && strstr(r.message, "first"));
    for (int n = 0; n < RECORD_LIMIT; n++)
        CHECK(record_add(&list, "more", RECORD_F32, 4, 1, "", &data, &r) == STATUS_OK);
    CHECK(record_add(&list, "last", RECORD_F32, 4, 1, "", &data, &r) == STATUS_SYSTEM);
    CHECK(strstr(r.message, "last"));
    record_clear(&list);
    CHECK(memory_live_bytes() == before);
}

/* ---- random numbers -----------------------------------------------------------------------------------------------
 */

/* Mean and variance of n numbers uniform in [0, 1): 1/2 ± 1/√(12 n) and 1/12 ± 1/√(180 n); five of these are allowed.
 */
static void check_uniform(uint64_t seed, uint64_t stream, uint64_t stride) {
    enum { N = 200000 };
    double sum = 0.0, squares = 0.0, product = 0.0, last = 0.5, least = 1.0, most = 0.0;
    for (uint64_t n = 0; n < N; n++) {
        double u = random_unit(seed, stream, n * stride), d = u - 0.5;
        sum += d, squares += d * d, product += d * (last - 0.5);
        least = fmin(least, u), most = fmax(most, u), last = u;
    }
    CHECK_NEAR(sum / N, 0.0, 5.0 / sqrt(12.0 * N));
    CHECK_NEAR(squares / N, 1.0 / 12.0, 5.0 / sqrt(180.0 * N));
    CHECK_NEAR(product / N, 0.0, 5.0 / 12.0 / sqrt((double)N));
    CHECK(least >= 0.0 && least < 1e-3 && most < 1.0 && most > 0.999);
}

static void random_numbers_are_uniform(void) {
    check_uniform(0, 0, 1);
    check_uniform(1, 7, 1);
    check_uniform(1, 7, 1u << 20);
    check_uniform(UINT64_MAX, 1, UINT64_C(1) << 40);
}

/* Neighbouring seeds, streams and counters give unrelated bits: each of the 64 flips half the time. */
static void random_numbers_are_unrelated(void) {
    enum { N = 4000 };
    int flips[3][64] = {0};
    for (uint64_t n = 0; n < N; n++) {
        uint64_t bits = random_bits(5, 3, n);
        uint64_t changed[3] = {bits ^ random_bits(6, 3, n), bits ^ random_bits(5, 4, n),
                               bits ^ random_bits(5, 3, n + 1)};
        for (int way = 0; way < 3; way++)
            for (int bit = 0; bit < 64; bit++) flips[way][bit] += (int)(changed[way] >> bit & 1);
    }
    for (int way = 0; way < 3; way++)
        for (int bit = 0; bit < 64; bit++) CHECK_NEAR((double)flips[way][bit] / N, 0.5, 5.0 * 0.5 / sqrt((double)N));
    CHECK(random_bits(1, 2, 3) != random_bits(2, 1, 3) && random_bits(1, 2, 3) != random_bits(1, 3, 2));
}

/* The same numbers whatever the order they are asked for, and in every release: recorded runs depend on them. */
static void random_numbers_are_fixed(void) {
    uint64_t forward[100];
    for (uint64_t n = 0; n < 100; n++) forward[n] = random_bits(42, 1, n);
    for (uint64_t n = 100; n-- > 0;) CHECK(random_bits(42, 1, n) == forward[n]);
    /* SplitMix64 started at 0, its first output (Steele, Lea, Flood 2014; Vigna's reference program prints the same).
     */
    CHECK(random_mix(0) == UINT64_C(0xe220a8397b1dcdaf));
}

enum { ITEMS = 1000, ITEM_STAGES = 5, MOST_THREADS = 5 };
typedef struct visits {
    atomic_int times[ITEMS], done[ITEM_STAGES], at_work[MOST_THREADS], shared;
    int stage_of[ITEMS], sizes[ITEM_STAGES];
} visits;

/* Waits for all items of the stage below: that they have been taken by others must be enough. */
static void visit(void *context, int64_t i, int worker) {
    visits *v = context;
    int stage = v->stage_of[i];
    if (atomic_fetch_add(&v->at_work[worker], 1) != 0) atomic_fetch_add(&v->shared, 1);
    for (int spins = 0; stage > 0 && atomic_load(&v->done[stage - 1]) < v->sizes[stage - 1]; spins++) thread_relax(spins);
    atomic_fetch_add(&v->times[i], 1);
    atomic_fetch_sub(&v->at_work[worker], 1);
    atomic_fetch_add(&v->done[stage], 1);
}

static bool each_once(const visits *v, int count) {
    bool once = atomic_load(&v->shared) == 0;
    for (int i = 0; i < ITEMS; i++) once &= atomic_load(&v->times[i]) == (i < count);
    return once;
}

/* Uneven on purpose: some workers have nothing of some stages, so that others' stretches are helped with. */
static void set_stages(visits *v, int threads, int32_t *bounds) {
    int32_t at = 0;
    for (int stage = 0; stage < ITEM_STAGES; stage++)
        for (int w = 0; w <= threads; w++) {
            bounds[stage * (threads + 1) + w] = at;
            int size = w == threads ? 0 : (stage + w) % 3 * 13;
            for (int i = 0; i < size; i++) v->stage_of[at++] = stage;
            v->sizes[stage] += size;
        }
}

static void loops_visit_each_item_once(void) {
    for (int guests = 0; guests < 2; guests++) {
        if (guests) parallel_make_room();
        for (int threads = 1; threads <= MOST_THREADS; threads++)
            for (int grain = 1; grain <= 64; grain *= 8) {
                visits v = {.sizes = {0}};
                parallel_for(threads, ITEMS - grain, grain, visit, &v);
                CHECK(each_once(&v, ITEMS - grain));
                visits staged = {.sizes = {0}};
                int32_t bounds[ITEM_STAGES * (MOST_THREADS + 1)];
                set_stages(&staged, threads, bounds);
                parallel_stages(threads, ITEM_STAGES, bounds, visit, &staged);
                CHECK(each_once(&staged, bounds[ITEM_STAGES * (threads + 1) - 1]));
            }
        if (guests) parallel_take_room();
    }
}

int main(void) {
    RUN(blocks_are_zeroed_and_aligned);
    RUN(live_and_peak_bytes);
    RUN(resizing_keeps_and_zeroes);
    RUN(chosen_allocations_fail);
    RUN(impossible_sizes_fail);
    RUN(arenas_align_and_grow);
    RUN(arenas_stay_within_their_chunks);
    RUN(arenas_copy_strings_and_fail);
    RUN(reports_become_sentences);
    RUN(long_texts_are_cut);
    RUN(exit_codes);
    RUN(distances_between_names);
    RUN(nearest_names);
    RUN(record_types);
    RUN(records_are_added_and_found);
    RUN(record_lists_run_out);
    RUN(random_numbers_are_uniform);
    RUN(random_numbers_are_unrelated);
    RUN(random_numbers_are_fixed);
    RUN(loops_visit_each_item_once);
    CHECK(memory_live_bytes() == 0);
    return check_finish();
}
