/* The frame player: what it shows is what the frames hold, whatever has been shown before. */
#include "scratch.h"
#include "check.h"

#include "base/memory.h"
#include "session/player.h"

enum { PARTICLES = 40, FRAMES = 5 };

/* Frames of a body that is stretched by 1 + frame/10 along y, whose fibres lie along y. */
static void write_frames(const char *folder) {
    report r;
    if (run_folder_create(folder, false, &r)) abort();
    for (int64_t frame = 0; frame < FRAMES; frame++) {
        record_list list = {0};
        frame_header header = header_of(frame);
        float *fibre, *gradient = NULL;
        int32_t *body;
        fill_solid(&list, PARTICLES, frame);
        if (record_add(&list, "solid/fibre", RECORD_F32, PARTICLES, 3, "1", (void **)&fibre, &r) ||
            record_add(&list, "solid/body", RECORD_I32, PARTICLES, 1, "1", (void **)&body, &r))
            abort();
        gradient = record_find(&list, "solid/deformation_gradient")->data;
        for (int i = 0; i < PARTICLES; i++) {
            fibre[3 * i + 1] = i != 6; /* one has no fibre */
            body[i] = i % 3;
            for (int c = 0; c < 9; c++) gradient[9 * i + c] = c % 4 == 0 ? 1 : 0;
            gradient[9 * i + 4] = 1 + (float)frame / 10;
            if (i == 5) gradient[9 * i + 1] = 0.75F; /* sheared across the fibre: F_xy */
        }
        if (frame_write(folder, &header, &list, 1, &r)) abort();
        record_clear(&list);
    }
}

static void check_frame(frame_player *p, int64_t frame, const char *field) {
    frame_view view;
    report r;
    CHECK(frame_player_read(p, frame, field, &view, &r) == STATUS_OK);
    CHECK(view.frame == frame && view.step == 10 * frame && view.count == PARTICLES);
    CHECK_NEAR(view.time, (double)frame / 24, 1e-12);
    CHECK_NEAR(view.position[3 * 7 + 1], 14 + (double)frame, 1e-6);
    CHECK(view.body[8] == 2);
    if (!field) CHECK(view.value == NULL);
    else if (strcmp(field, "damage") == 0) {
        CHECK_NEAR(view.value[10], 0.25, 1e-7);
        CHECK(view.low == 0 && view.high == 1);
    } else if (strcmp(field, "speed") == 0) {
        CHECK_NEAR(view.value[3], sqrt(0.25 + 1 + 2.25), 1e-6);
        CHECK(view.low == view.high && view.high == view.value[0]);
    } else {
        CHECK_NEAR(view.value[3], 1 + (double)frame / 10, 1e-6);
        double s = 1 + (double)frame / 10, trace = 1 + 0.5625 + s * s;
        /* |F a₀| of the sheared one, and the larger root of λ⁴ − tr(FᵀF) λ² + det² = 0. */
        bool along = strcmp(field, "fibre_stretch") == 0;
        CHECK_NEAR(view.value[5], along ? hypot(0.75, s) : sqrt((trace + sqrt(trace * trace - 4 * s * s)) / 2), 1e-6);
        if (along) CHECK(view.value[6] == 1); /* as a live run shows it */
    }
}

static void test_shows_what_frames_hold(void) {
    frame_player *p;
    report r;
    write_frames(in_scratch("run"));
    CHECK(frame_player_open(in_scratch("run"), 0, &p, &r) == STATUS_OK);
    CHECK(frame_player_count(p) == FRAMES && frame_player_number(p, 4) == 4 && frame_player_number(p, 5) == -1);
    CHECK(strcmp(frame_player_default_field(p), "damage") == 0);
    static const char *const fields[] = {"damage", "speed", "stretch", "fibre_stretch", NULL};
    for (int64_t frame = 0; frame < FRAMES; frame++)
        for (int i = 0; i < 5; i++) check_frame(p, frame, fields[i]);
    check_frame(p, 0, "speed");
    frame_player_close(p);
}

/* A budget of two frames: all frames still come out right, and no more than that is held. */
static void test_cache_is_bounded(void) {
    frame_player *p;
    report r;
    size_t frame_bytes = PARTICLES * (4 * sizeof(float) + sizeof(int32_t)), before = memory_live_bytes();
    CHECK(frame_player_open(in_scratch("run"), 2 * frame_bytes, &p, &r) == STATUS_OK);
    size_t opened = memory_live_bytes();
    for (int round = 0; round < 3; round++)
        for (int64_t frame = 0; frame < FRAMES; frame++) {
            check_frame(p, frame, "damage");
            CHECK(memory_live_bytes() <= opened + 2 * frame_bytes);
        }
    CHECK(memory_live_bytes() > opened);
    frame_player_close(p);
    CHECK(memory_live_bytes() == before);
}

/* A solid and a sheet in one scene: all particles are shown, and a quantity of one of them leaves the other at its low end. */
static void test_both_engines(void) {
    frame_player *p;
    frame_view view;
    report r;
    record_list list = {0};
    frame_header header = header_of(0);
    int32_t *solid_body, *sheet_body;
    CHECK(run_folder_create(in_scratch("both"), false, &r) == STATUS_OK);
    fill_solid(&list, PARTICLES, 0);
    fill_sheet(&list, 7);
    if (record_add(&list, "solid/body", RECORD_I32, PARTICLES, 1, "1", (void **)&solid_body, &r) || record_add(&list, "sheet/body", RECORD_I32, 7, 1, "1", (void **)&sheet_body, &r)) abort();
    sheet_body[2] = 5;
    CHECK(frame_write(in_scratch("both"), &header, &list, 0, &r) == STATUS_OK);
    record_clear(&list);
    CHECK(frame_player_open(in_scratch("both"), 0, &p, &r) == STATUS_OK);
    CHECK(frame_player_read(p, 0, "diffused", &view, &r) == STATUS_OK && view.count == PARTICLES + 7);
    CHECK(view.position[3 * (PARTICLES + 2)] == 2 && view.position[3 * (PARTICLES + 2) + 1] == 100 && view.body[PARTICLES + 2] == 5);
    CHECK_NEAR(view.value[PARTICLES + 2], 1.0 / 3, 1e-7);
    CHECK_NEAR(view.low, 1.0 / 7, 1e-7);
    CHECK(view.high == 1 && view.value[3] == view.low);
    CHECK(frame_player_read(p, 0, "damage", &view, &r) == STATUS_OK && view.value[10] == 0.25F && view.value[PARTICLES + 2] == 0);
    frame_player_close(p);
}

static void test_wrong_input(void) {
    frame_player *p;
    frame_view view;
    report r;
    CHECK(frame_player_open(in_scratch("nowhere"), 0, &p, &r) == STATUS_INPUT && !p);
    CHECK(frame_player_open(in_scratch("run"), 0, &p, &r) == STATUS_OK);
    CHECK(frame_player_read(p, 1, "damge", &view, &r) == STATUS_INPUT && strcmp(r.nearest, "damage") == 0);
    CHECK(frame_player_read(p, 77, "damage", &view, &r) == STATUS_INPUT && strcmp(r.nearest, "4") == 0);
    CHECK(frame_player_index(p, 3) == 3 && frame_player_index(p, 99) == FRAMES - 1 && frame_player_index(p, -1) == 0);
    check_frame(p, 2, "stretch");
    frame_player_close(p);
}

/* Frames that appear later are found; one that was cut to pieces is an error, and the others go on. */
static void test_frames_come_and_break(void) {
    frame_player *p;
    frame_view view;
    report r;
    write_frames(in_scratch("growing"));
    CHECK(frame_truncate(in_scratch("growing"), 2, &r) == STATUS_OK);
    CHECK(frame_player_open(in_scratch("growing"), 0, &p, &r) == STATUS_OK);
    CHECK(frame_player_count(p) == 3);
    record_list list = {0};
    frame_header header = header_of(3);
    fill_solid(&list, PARTICLES, 3); /* without bodies */
    CHECK(frame_write(in_scratch("growing"), &header, &list, 0, &r) == STATUS_OK);
    record_clear(&list);
    CHECK(frame_player_refresh(p, &r) == STATUS_OK && frame_player_count(p) == 4);
    CHECK(frame_player_read(p, 3, "damage", &view, &r) == STATUS_SYSTEM && strstr(r.message, "solid/body"));
    write_text(in_scratch("growing/frames/000001.hdf"), "not HDF5", 8);
    CHECK(frame_player_read(p, 1, "damage", &view, &r) == STATUS_SYSTEM);
    check_frame(p, 2, "damage");
    frame_player_close(p);
}

int main(void) {
    scratch_make();
    RUN(test_shows_what_frames_hold);
    RUN(test_cache_is_bounded);
    RUN(test_both_engines);
    RUN(test_wrong_input);
    RUN(test_frames_come_and_break);
    return check_finish();
}
