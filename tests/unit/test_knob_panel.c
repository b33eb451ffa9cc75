/* src/tui: the list of knobs with its cursor, steps and undo; the line of frames. Nothing here needs a terminal. */
#include "check.h"

#include "base/memory.h"
#include "tui/knob_panel.h"
#include "tui/timeline.h"

static const char *const forms[] = {"explicit", "implicit", NULL};

/* Two materials' worth of what effects have: logarithmic twins, a bounded real, a vector, a choice, a switch. */
static int make_knobs(knob *k) {
    k[0] = (knob){.path = "tube.damage.sigma_c", .owner = "tube", .effect = "damage", .key = "sigma_c", .components = 1, .maximum = HUGE_VAL,
                  .start = {100}, .value = {100}, .live = true, .logarithmic = true, .derived = true, .twin = 1};
    k[1] = (knob){.path = "tube.damage.break_stretch", .owner = "tube", .effect = "damage", .key = "break_stretch", .components = 1,
                  .maximum = 100, .start = {0.2}, .value = {0.2}, .live = true, .logarithmic = true, .twin = 0};
    k[2] = (knob){.path = "tube.damage.alpha", .owner = "tube", .effect = "damage", .key = "alpha", .components = 1, .minimum = -1, .maximum = 0,
                  .start = {-0.99}, .value = {-0.99}, .live = true, .twin = -1};
    k[3] = (knob){.path = "tube.damage.form", .owner = "tube", .effect = "damage", .key = "form", .kind = PARAMETER_CHOICE, .components = 1,
                  .choices = forms, .maximum = 1, .twin = -1};
    k[4] = (knob){.path = "gravity.acceleration", .effect = "gravity", .key = "acceleration", .kind = PARAMETER_VECTOR, .components = 3,
                  .minimum = -HUGE_VAL, .maximum = HUGE_VAL, .start = {0, -9.8, 0}, .value = {0, -9.8, 0}, .live = true, .twin = -1};
    k[5] = (knob){.path = "gravity.on", .effect = "gravity", .key = "on", .kind = PARAMETER_BOOLEAN, .components = 1, .maximum = 1, .twin = -1};
    return 6;
}

static void test_cursor(void) {
    knob_panel panel;
    report r;
    CHECK(knob_panel_open(&panel, &r) == STATUS_OK);
    CHECK(knob_panel_current(&panel) == NULL);
    knob_panel_arrange(&panel, make_knobs(panel.list));
    CHECK(panel.row_count == 2 + 5); /* two headings; the twins share a row */
    CHECK(strcmp(knob_panel_current(&panel)->key, "sigma_c") == 0);
    CHECK(knob_panel_other(&panel) && strcmp(knob_panel_current(&panel)->key, "break_stretch") == 0);
    knob_panel_move(&panel, 1);
    CHECK(strcmp(knob_panel_current(&panel)->key, "alpha") == 0);
    CHECK(!knob_panel_other(&panel));
    knob_panel_move(&panel, 2); /* over a heading */
    CHECK(strcmp(knob_panel_current(&panel)->key, "acceleration") == 0);
    CHECK(knob_panel_other(&panel) && panel.component == 1);
    /* New values leave the cursor where it is. */
    knob_panel_arrange(&panel, make_knobs(panel.list));
    CHECK(strcmp(knob_panel_current(&panel)->key, "acceleration") == 0 && panel.component == 1);
    knob_panel_move(&panel, 100);
    CHECK(strcmp(knob_panel_current(&panel)->key, "on") == 0);
    knob_panel_move(&panel, -100);
    CHECK(strcmp(knob_panel_current(&panel)->key, "sigma_c") == 0);
    knob_panel_go(&panel, 1);
    CHECK(strcmp(knob_panel_current(&panel)->key, "break_stretch") == 0);
    knob_panel_close(&panel);
    CHECK(memory_live_bytes() == 0);
}

static void test_steps(void) {
    knob k[8];
    double value[3];
    make_knobs(k);
    CHECK(knob_step(&k[0], 0, 1, false, value));
    CHECK_NEAR(value[0], 125, 1e-12);
    CHECK(knob_step(&k[0], 0, -1, true, value));
    CHECK_NEAR(value[0], 98.04, 1e-12); /* 100/1.02 to four digits */
    CHECK(knob_step(&k[2], 0, 1, false, value));
    CHECK_NEAR(value[0], -0.965, 1e-12); /* a fortieth of [−1, 0] */
    CHECK(knob_step(&k[2], 0, -1, false, value));
    CHECK_NEAR(value[0], -1, 0); /* not beyond the range */
    k[2].value[0] = -1;
    CHECK(!knob_step(&k[2], 0, -1, false, value));
    CHECK(knob_step(&k[3], 0, 1, false, value) && value[0] == 1);
    CHECK(knob_step(&k[3], 0, -1, false, value) && value[0] == 1);
    CHECK(knob_step(&k[5], 0, 1, false, value) && value[0] == 1);
    CHECK(knob_step(&k[4], 1, 1, false, value));
    CHECK_NEAR(value[1], -8.82, 1e-12);
    CHECK(value[0] == 0 && value[2] == 0);
    /* A step from nothing has a size, and one back reaches nothing again. */
    CHECK(knob_step(&k[4], 0, 1, false, value) && value[0] > 0);
    k[4].value[0] = value[0];
    CHECK(knob_step(&k[4], 0, -1, false, value) && value[0] == 0);
}

static void test_slider(void) {
    knob k[8];
    make_knobs(k);
    CHECK_NEAR(knob_place(&k[0], 100), 0.5, 1e-9); /* where it began is in the middle of four decades */
    CHECK_NEAR(knob_place(&k[0], 1000), 0.75, 1e-9);
    CHECK_NEAR(knob_place(&k[0], 0), 0, 0);
    CHECK_NEAR(knob_place(&k[0], 1e9), 1, 0);
    CHECK_NEAR(knob_place(&k[2], -0.25), 0.75, 1e-9);
    char text[KNOB_TEXT];
    knob_show(&k[3], k[3].value, text);
    CHECK(strcmp(text, "explicit") == 0);
    knob_show(&k[4], k[4].value, text);
    CHECK(strcmp(text, "(0, -9.8, 0)") == 0);
}

/* Undoing a turn of a twin that followed gives back the twin that was said, not a number computed from it. */
static void test_undo(void) {
    knob_panel panel;
    report r;
    CHECK(knob_panel_open(&panel, &r) == STATUS_OK);
    knob_panel_arrange(&panel, make_knobs(panel.list));
    CHECK(!knob_panel_undo(&panel) && !knob_panel_redo(&panel));
    knob_panel_note(&panel, panel.list, 0, "125");
    const knob_change *change = knob_panel_undo(&panel);
    CHECK(change && strcmp(change->from_path, "tube.damage.break_stretch") == 0 && atof(change->from) == 0.2);
    CHECK(change && strcmp(change->to_path, "tube.damage.sigma_c") == 0 && atof(change->to) == 125);
    knob_panel_undone(&panel, -1);
    CHECK(!knob_panel_undo(&panel) && knob_panel_redo(&panel) == change);
    knob_panel_undone(&panel, 1);
    knob_panel_note(&panel, panel.list, 2, "-0.5");
    knob_panel_undone(&panel, -1);
    knob_panel_note(&panel, panel.list, 2, "-0.4"); /* a new turn: what was undone is gone */
    CHECK(!knob_panel_redo(&panel) && panel.undo_count == 2);
    for (int i = 0; i < KNOB_UNDO + 10; i++) knob_panel_note(&panel, panel.list, 2, "-0.3");
    CHECK(panel.undo_count == KNOB_UNDO);
    knob_panel_close(&panel);
}

static void test_timeline(void) {
    const int64_t checkpoints[] = {0, 8, 12, 14};
    CHECK(timeline_next(checkpoints, 4, -1, -1) == 14);
    CHECK(timeline_next(checkpoints, 4, 14, -1) == 12);
    CHECK(timeline_next(checkpoints, 4, 0, -1) == 0);
    CHECK(timeline_next(checkpoints, 4, 12, 1) == 14);
    CHECK(timeline_next(checkpoints, 4, 14, 1) == -1);
    CHECK(timeline_next(checkpoints, 0, 3, -1) == -1);
    timeline line = {.first = 0, .last = 100, .now = 50};
    tui_area area = {0, 0, 1, 113}; /* " frame  50/100 ", 98 columns of line less one, and one at the end */
    CHECK(timeline_frame_at(&line, area, 1) == -1);
    CHECK(timeline_frame_at(&line, area, 15) == 0);
    CHECK(timeline_frame_at(&line, area, 15 + 48) == 50);
    CHECK(timeline_frame_at(&line, area, 15 + 96) == 100);
    CHECK(timeline_frame_at(&line, area, 15 + 97) == -1);
}

int main(void) {
    RUN(test_cursor);
    RUN(test_steps);
    RUN(test_slider);
    RUN(test_undo);
    RUN(test_timeline);
    return check_finish();
}
