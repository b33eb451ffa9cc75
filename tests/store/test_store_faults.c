/* What happens to a run's folder when the disk is full, the folder cannot be written, the process is killed or a file
 * is damaged: whole frames stay whole, and the caller is told. */
#include "base/memory.h"
#include "base/random.h"
#include "check.h"
#include "scratch.h"
#include "store/frames.h"

#include <errno.h>
#include <grp.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>

/* Every frame in the folder opens and holds what write_solid_frame wrote; returns how many, or −1. */
static int whole_frames(const char *run, int n, int last) {
    int found = 0;
    for (int frame = 0; frame <= last; frame++) {
        char path[SCRATCH_PATH];
        snprintf(path, sizeof path, "%s/frames/%06d.hdf", run, frame);
        if (!exists(path)) continue;
        record_list expected, back;
        report r;
        double time;
        int64_t step;
        if (frame_read(run, frame, &back, &time, &step, &r)) return -1;
        fill_solid(&expected, n, frame);
        bool same = same_records(&expected, &back) && step == 10 * frame;
        record_clear(&expected);
        record_clear(&back);
        if (!same) return -1;
        found++;
    }
    return found;
}

/* Every file that the series names is there. */
static bool series_is_sound(const char *run) {
    char path[SCRATCH_PATH];
    snprintf(path, sizeof path, "%s/frames/frames.hdf.series", run);
    size_t size;
    char *text = read_text(path, &size);
    if (!text) return count_files(run, "frames") == 1; /* killed before the first was written */
    bool sound = strstr(text, "]\n}\n") != NULL;
    for (const char *at = text; (at = strstr(at, "\"name\": \"")); at++) {
        snprintf(path, sizeof path, "%s/frames/%.10s", run, at + 9);
        sound = sound && exists(path);
    }
    free(text);
    return sound;
}

/* ---- a full disk ------------------------------------------------------------------------------------------------- */

enum { FULL_N = 4000 };

/* Writes frames until one fails, then checks what is left. Exit code 0: all as it should be. */
static int write_until_full(void *context) {
    const char *run = context;
    record_list list;
    report r;
    status s = STATUS_OK;
    int frame = 0;
    for (; !s && frame < 1000; frame++) {
        frame_header header = header_of(frame);
        fill_solid(&list, FULL_N, frame);
        s = frame_write(run, &header, &list, 0, &r);
        record_clear(&list);
    }
    int last = frame - 1; /* the one that failed; only its series may have been what did not fit */
    if (s != STATUS_SYSTEM || !strstr(r.file, "frames/")) return 2;
    if (!strstr(r.message, strerror(ENOSPC)) && !strstr(r.message, strerror(EFBIG))) return 3;
    int whole = whole_frames(run, FULL_N, 1000);
    if (whole != last && whole != last + 1) return 4;
    if (whole < 1 && size_of(in_scratch("limit")) < 0) return 5;
    char frames[SCRATCH_PATH];
    snprintf(frames, sizeof frames, "%s/frames", run);
    if (count_files(frames, ".tmp") != 0) return 6;
    if (!series_is_sound(run)) return 7;
    frame_header header = header_of(1);
    fill_solid(&list, FULL_N, 1);
    s = checkpoint_write(run, &header, &list, &r); /* the disk is still full */
    record_clear(&list);
    return s == STATUS_SYSTEM && count_files(run, ".hdf") == 0 && count_files(run, ".tmp") == 0 ? 0 : 8;
}

static int write_on_small_disk(void *context) {
    char *disk = context;
    report r;
    if (mount("tmpfs", disk, "tmpfs", 0, "size=1500k") != 0) return 77;
    int code =
        run_folder_create(in_scratch("disk/run"), false, &r) ? 1 : write_until_full((char *)in_scratch("disk/run"));
    umount(disk);
    return code;
}

static void a_full_disk_keeps_whole_frames(void) {
    char disk[SCRATCH_PATH];
    snprintf(disk, sizeof disk, "%s/disk", scratch);
    CHECK(mkdir(disk, 0777) == 0);
    int code = in_child(write_on_small_disk, disk);
    if (code == 77)
        printf("  (may not mount a small disk here)\n");
    else
        CHECK(code == 0);
    if (code != 0) printf("  code %d\n", code);
}

static int write_past_limit(void *context) {
    const struct rlimit limit = {100 * 1024, 100 * 1024};
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &limit);
    return write_until_full(context);
}

/* The same without a right to mount: no file may grow past 100 KiB, and a frame is larger. */
static void a_file_size_limit_is_told(void) {
    write_text(in_scratch("limit"), "", 0); /* says that not even one frame fits */
    int code = in_child(write_past_limit, (char *)make_run("limited"));
    CHECK(code == 0);
    if (code != 0) printf("  code %d\n", code);
    remove(in_scratch("limit"));
}

/* ---- no right to write ------------------------------------------------------------------------------------------- */

static int write_without_right(void *context) {
    const char *run = context;
    record_list list;
    report r;
    if (getuid() == 0 && (setgroups(0, NULL) != 0 || setgid(65534) != 0 || setuid(65534) != 0)) return 77;
    fill_solid(&list, 10, 1);
    frame_header header = header_of(1);
    if (frame_write(run, &header, &list, 1, &r) != STATUS_SYSTEM || !strstr(r.message, strerror(EACCES))) return 1;
    if (!strstr(r.file, "000001.hdf")) return 2;
    if (checkpoint_write(run, &header, &list, &r) != STATUS_SYSTEM || !strstr(r.message, strerror(EACCES))) return 3;
    if (run_folder_create(in_scratch("locked/new"), false, &r) != STATUS_SYSTEM || !strstr(r.file, "locked/new"))
        return 4;
    if (frame_truncate(run, -1, &r) != STATUS_SYSTEM) return 5;
    return whole_frames(run, 10, 10) == 1 ? 0 : 6;
}

static void a_folder_without_write_permission_is_told(void) {
    char run[SCRATCH_PATH];
    snprintf(run, sizeof run, "%s", make_run("locked"));
    write_solid_frame(run, 10, 0);
    chmod(in_scratch("locked/frames"), 0555);
    chmod(run, 0555);
    int code = in_child(write_without_right, run);
    chmod(run, 0755);
    chmod(in_scratch("locked/frames"), 0755);
    CHECK(code == 0 || code == 77);
    if (code != 0) printf("  code %d\n", code);
}

/* ---- kill −9 ----------------------------------------------------------------------------------------------------- */

enum { KILL_N = 3000, KILL_ROUNDS = 24 };

static void write_for_ever(const char *run) {
    for (int frame = 0;; frame++) {
        record_list list;
        report r;
        frame_header header = header_of(frame);
        fill_solid(&list, KILL_N, frame);
        if (frame_write(run, &header, &list, frame % 2, &r) || checkpoint_write(run, &header, &list, &r) ||
            checkpoint_thin(run, 2, &r))
            _exit(1);
        record_clear(&list);
    }
}

static void kill_a_writer(int round) {
    char name[32];
    snprintf(name, sizeof name, "killed%d", round);
    const char *run = make_run(name);
    fflush(stdout);
    pid_t pid = fork();
    if (pid == 0) write_for_ever(run);
    usleep(3000u + 4700u * (unsigned)round);
    kill(pid, SIGKILL);
    int state;
    waitpid(pid, &state, 0);
    CHECK(WIFSIGNALED(state));
    int last = (int)frame_last(run);
    CHECK(whole_frames(run, KILL_N, last + 2) == last + 1); /* no gap, nothing beyond the last, all whole */
    CHECK(series_is_sound(run));
    record_list back;
    report warning, r;
    int64_t frame = -1;
    status s = checkpoint_read_last(run, &back, &frame, &warning, &r);
    CHECK(last < 1 ||
          (s == STATUS_OK && warning.code == STATUS_OK && frame >= last - 1)); /* whole, and not left behind */
    if (!s) record_clear(&back);
    CHECK(run_folder_create(run, true, &r) == STATUS_OK); /* and resuming tidies up */
    CHECK(count_files(run, ".tmp") == 0 && count_files(in_scratch("%s/frames", name), ".tmp") == 0);
    write_solid_frame(run, KILL_N, last + 1);
    CHECK(frame_last(run) == last + 1 && series_is_sound(run));
}

static void kill_leaves_whole_frames(void) {
    for (int round = 0; round < KILL_ROUNDS; round++) kill_a_writer(round);
}

/* ---- damage ------------------------------------------------------------------------------------------------------ */

enum { DAMAGE_TRIES = 400 };

/* Reads frames with a few random bytes changed: an error or some values, but the program goes on. */
static int read_damaged(void *context) {
    const char *run = context;
    char path[SCRATCH_PATH];
    size_t size;
    int refused = 0;
    snprintf(path, sizeof path, "%s/frames/000000.hdf", run);
    char *good = read_text(path, &size);
    for (uint64_t i = 0; i < DAMAGE_TRIES; i++) {
        record_list back;
        report r;
        double time;
        int64_t step;
        size_t at = random_bits(1, 1, i) % size;
        char kept = good[at];
        good[at] ^= (char)(1 + random_bits(1, 2, i) % 255);
        write_text(path, good, size);
        good[at] = kept;
        if (frame_read(run, 0, &back, &time, &step, &r))
            refused++;
        else
            record_clear(&back);
    }
    free(good);
    return memory_live_bytes() == 0 && refused > DAMAGE_TRIES / 4 ? 0 : 1;
}

static void damaged_frames_do_no_harm(void) {
    const char *run = make_run("damaged");
    write_solid_frame(run, 3000, 0); /* large enough for compressed chunks */
    CHECK(in_child(read_damaged, (char *)run) == 0);
}

static void cut_frames_are_told(void) {
    const char *run = make_run("truncated");
    char path[SCRATCH_PATH];
    size_t size;
    write_solid_frame(run, 100, 0);
    snprintf(path, sizeof path, "%s/frames/000000.hdf", run);
    char *good = read_text(path, &size);
    for (size_t length = 0; length < size; length += 501) {
        record_list back;
        report r;
        double time;
        int64_t step;
        write_text(path, good, length);
        CHECK(frame_read(run, 0, &back, &time, &step, &r) == STATUS_SYSTEM);
        CHECK(strstr(r.file, "000000.hdf") && r.message[0]);
    }
    free(good);
}

int main(void) {
    scratch_make();
    RUN(a_full_disk_keeps_whole_frames);
    RUN(a_file_size_limit_is_told);
    RUN(a_folder_without_write_permission_is_told);
    RUN(kill_leaves_whole_frames);
    RUN(damaged_frames_do_no_harm);
    RUN(cut_frames_are_told);
    CHECK(memory_live_bytes() == 0);
    return check_finish();
}
