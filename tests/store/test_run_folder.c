/* Taking a run's folder away: all of a run's files, and nothing else, ever. */
#include "scratch.h"
#include "check.h"

#include "store/run_folder.h"

#define ID "20261122-061502-3f9a" /* as header_of has it */

static void write_folder(const char *name) {
    report r;
    char folder[SCRATCH_PATH];
    snprintf(folder, sizeof folder, "%s", in_scratch("%s", name));
    if (run_folder_create(folder, false, &r)) abort();
    for (int64_t frame = 0; frame < 3; frame++) {
        record_list list = {0};
        frame_header header = header_of(frame);
        fill_solid(&list, 10, frame);
        fill_sheet(&list, 10);
        if (frame_write(folder, &header, &list, 0, &r) || checkpoint_write(folder, &header, &list, &r)) abort();
        record_clear(&list);
    }
    mkdir(in_scratch("%s/scene/recipes", name), 0777);
    static const char *const files[] = {"scene/request", "scene/tube_pull.lua", "scene/recipes/tube.lua", "result.json", "turns.json", "commands.log"};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) write_text(in_scratch("%s/%s", name, files[i]), "x", 1);
}

static void test_all_of_it_goes(void) {
    run_folder_removal out;
    report r;
    write_folder("whole");
    CHECK(run_folder_remove(in_scratch("whole"), ID, NULL, true, &out, &r) == STATUS_OK);
    CHECK(out.files == 6 + 3 + 3 + 1 + 3 + 1 && out.kept == 0 && out.bytes > 0 && !out.absent); /* others, frames, views, their lists, checkpoints */
    CHECK(exists(in_scratch("whole/frames/000002.hdf"))); /* it only looked */
    CHECK(run_folder_remove(in_scratch("whole"), ID, NULL, false, &out, &r) == STATUS_OK);
    CHECK(!exists(in_scratch("whole")));
    CHECK(run_folder_remove(in_scratch("whole"), ID, NULL, false, &out, &r) == STATUS_OK && out.absent);
}

static void test_others_files_stay(void) {
    run_folder_removal out;
    report r;
    write_folder("shared");
    write_text(in_scratch("outside"), "precious", 8);
    mkdir(in_scratch("shared/renders"), 0777);
    write_text(in_scratch("shared/renders/a.png"), "x", 1);
    write_text(in_scratch("shared/notes.txt"), "x", 1);
    write_text(in_scratch("shared/frames/my.hdf"), "x", 1);
    write_text(in_scratch("shared/scene/mesh.obj"), "x", 1);
    if (symlink("../outside", in_scratch("shared/result.json.link")) || symlink("/", in_scratch("shared/scene/root"))) abort();
    CHECK(run_folder_remove(in_scratch("shared"), ID, NULL, false, &out, &r) == STATUS_OK);
    CHECK(out.kept == 6); /* the user's folder counts once */
    CHECK(exists(in_scratch("shared/renders/a.png")) && exists(in_scratch("shared/notes.txt")) && exists(in_scratch("shared/frames/my.hdf")));
    CHECK(exists(in_scratch("shared/scene/mesh.obj")) && exists(in_scratch("outside")));
    CHECK(!exists(in_scratch("shared/frames/000000.hdf")) && !exists(in_scratch("shared/result.json")) && !exists(in_scratch("shared/scene/request")));
}

static void test_only_the_runs_own(void) {
    run_folder_removal out;
    report r;
    write_folder("own");
    CHECK(run_folder_remove(in_scratch("own"), "20250101-000000-0000", NULL, false, &out, &r) == STATUS_INPUT && strcmp(r.found, ID) == 0);
    CHECK(exists(in_scratch("own/frames/000000.hdf")) && exists(in_scratch("own/result.json")));
    /* Of a branch, whose frames are its parent's. */
    CHECK(run_folder_remove(in_scratch("own"), "20250101-000000-0000", ID, true, &out, &r) == STATUS_OK);
    mkdir(in_scratch("home"), 0777);
    write_text(in_scratch("home/result.json"), "x", 1);
    CHECK(run_folder_remove(in_scratch("home"), ID, NULL, false, &out, &r) == STATUS_INPUT && exists(in_scratch("home/result.json")));
    if (symlink(in_scratch("own"), in_scratch("link"))) abort();
    CHECK(run_folder_remove(in_scratch("link"), ID, NULL, false, &out, &r) == STATUS_INPUT && exists(in_scratch("own/frames/000000.hdf")));
    CHECK(run_folder_remove("", ID, NULL, false, &out, &r) == STATUS_OK && out.absent);
}

int main(void) {
    scratch_make();
    RUN(test_all_of_it_goes);
    RUN(test_others_files_stay);
    RUN(test_only_the_runs_own);
    return check_finish();
}
