/* The reader of frames: what it gives is what a player of the same folder gives, of the newest question, and stays whole until it is asked for more. */
#include "scratch.h"
#include "check.h"

#include "base/memory.h"
#include "tui/frame_reader.h"

#include <stdatomic.h>
#include <time.h>

enum { PARTICLES = 300, FRAMES = 12 };

static atomic_int woken;

static void wake(void *context) {
    (void)context;
    atomic_fetch_add(&woken, 1);
}

static void write_frame_number(const char *folder, int64_t frame) {
    report r;
    record_list list = {0};
    frame_header header = header_of(frame);
    int32_t *body;
    fill_solid(&list, PARTICLES, frame);
    if (record_add(&list, "solid/body", RECORD_I32, PARTICLES, 1, "1", (void **)&body, &r) || frame_write(folder, &header, &list, 1, &r)) abort();
    record_clear(&list);
}

/* The page that answers the question asked last. */
static const frame_page *settle(frame_reader *p) {
    while (frame_reader_busy(p))
        if (!frame_reader_poll(p)) nanosleep(&(struct timespec){.tv_nsec = 200000}, NULL);
    return frame_reader_page(p);
}

static void check_page(const frame_page *page, int64_t frame, const char *field) {
    frame_player *player;
    frame_view view;
    report r;
    float low[3], high[3];
    CHECK(frame_player_open(page->folder, 0, &player, &r) == STATUS_OK);
    CHECK(frame_player_read(player, frame, field, &view, &r) == STATUS_OK && frame_player_bounds(player, low, high, &r) == STATUS_OK);
    CHECK(frame_player_read(player, frame, field, &view, &r) == STATUS_OK);
    CHECK(page->has_frame && page->view.frame == frame && page->view.count == PARTICLES && page->view.step == view.step && page->view.time == view.time);
    CHECK(memcmp(page->view.position, view.position, PARTICLES * 3 * sizeof(float)) == 0 && memcmp(page->low, low, sizeof low) == 0);
    CHECK(field ? memcmp(page->view.value, view.value, PARTICLES * sizeof(float)) == 0 : page->view.value == NULL);
    CHECK(strcmp(page->field, field ? field : "") == 0);
    frame_player_close(player);
}

static void test_gives_what_a_player_gives(void) {
    frame_reader *p;
    report r;
    if (run_folder_create(in_scratch("run"), false, &r)) abort();
    for (int64_t frame = 0; frame < FRAMES; frame++) write_frame_number(in_scratch("run"), frame);
    size_t before = memory_live_bytes();
    CHECK(frame_reader_open(0, wake, NULL, &p, &r) == STATUS_OK && !frame_reader_busy(p) && frame_reader_page(p)->folder[0] == '\0');
    frame_reader_ask(p, in_scratch("run"), 3, "", false);
    check_page(settle(p), 3, "damage");
    CHECK(frame_reader_page(p)->frame_count == FRAMES && frame_page_index(frame_reader_page(p), 7) == 7 && atomic_load(&woken) == 1);
    frame_reader_ask(p, in_scratch("run"), 5, "speed", false);
    check_page(settle(p), 5, "speed");
    frame_reader_ask(p, in_scratch("run"), 4, "nothing of that name", false);
    check_page(settle(p), 4, NULL);
    frame_reader_ask(p, in_scratch("run"), INT64_MAX, "damage", false);
    check_page(settle(p), FRAMES - 1, "damage");
    frame_reader_close(p);
    CHECK(memory_live_bytes() == before);
}

/* However fast questions come, each page is of one frame, and the last is of the last question. */
static void test_the_newest_question_is_answered(void) {
    frame_reader *p;
    report r;
    CHECK(frame_reader_open(0, wake, NULL, &p, &r) == STATUS_OK);
    for (int i = 0; i < 400; i++) {
        frame_reader_ask(p, in_scratch("run"), i * 7 % FRAMES, i % 2 ? "damage" : "speed", false);
        if (frame_reader_poll(p)) {
            const frame_page *page = frame_reader_page(p);
            check_page(page, page->asked, page->field);
        }
    }
    const frame_page *page = settle(p);
    CHECK(page->asked == 399 * 7 % FRAMES && strcmp(page->field, "damage") == 0);
    check_page(page, page->asked, "damage");
    CHECK(!frame_reader_poll(p));
    frame_reader_close(p);
}

/* A run that goes on has more frames when one beyond the last is asked for, or when the reader is told; another folder is another run; what cannot
 * be read says why, and is tried again. */
static void test_folders_and_growth(void) {
    frame_reader *p;
    report r;
    CHECK(frame_reader_open(0, wake, NULL, &p, &r) == STATUS_OK);
    frame_reader_ask(p, in_scratch("later"), 0, "", false);
    CHECK(!settle(p)->has_frame && frame_reader_page(p)->problem[0] != '\0');
    if (run_folder_create(in_scratch("later"), false, &r)) abort();
    write_frame_number(in_scratch("later"), 0);
    frame_reader_ask(p, in_scratch("later"), 0, "", false);
    check_page(settle(p), 0, "damage");
    write_frame_number(in_scratch("later"), 1);
    frame_reader_ask(p, in_scratch("later"), 0, "", false);
    CHECK(settle(p)->frame_count == 1);
    frame_reader_ask(p, in_scratch("later"), 0, "", true);
    CHECK(settle(p)->frame_count == 2);
    write_frame_number(in_scratch("later"), 2);
    frame_reader_ask(p, in_scratch("later"), 2, "", false);
    check_page(settle(p), 2, "damage");
    frame_reader_ask(p, in_scratch("run"), 9, "", false);
    check_page(settle(p), 9, "damage");
    frame_reader_close(p);
}

int main(void) {
    scratch_make();
    RUN(test_gives_what_a_player_gives);
    RUN(test_the_newest_question_is_answered);
    RUN(test_folders_and_growth);
    return check_finish();
}
