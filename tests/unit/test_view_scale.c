/* src/view: what colours stand for, small maps, and what a cut and a pan do to a picture. */
#include "check.h"

#include "view/canvas.h"
#include "view/heat.h"
#include "view/scale.h"

static void test_scale_holds_nearly_all(void) {
    float values[1000];
    for (int i = 0; i < 1000; i++) values[i] = (float)i;
    values[17] = 1e9f; /* one that flies off */
    values[18] = NAN;
    view_scale scale = view_scale_fit(values, 1000);
    CHECK(scale.low >= 0 && scale.low < 20);
    CHECK(scale.high > 980 && scale.high < 1000);
    CHECK_NEAR((double)view_scale_place(scale, scale.low), 0, 0);
    CHECK_NEAR((double)view_scale_place(scale, scale.high), 1, 0);
    CHECK_NEAR((double)view_scale_place(scale, 0.5 * (scale.low + scale.high)), 0.5, 1e-6);
    CHECK_NEAR((double)view_scale_place(scale, 1e30), 1, 0);
    CHECK_NEAR((double)view_scale_place(scale, -1e30), 0, 0);
    CHECK(isnan(view_scale_place(scale, NAN)));
    CHECK_NEAR(view_scale_value(scale, (double)view_scale_place(scale, 500)), 500, 1e-3);
}

static void test_scale_of_what_hardly_varies(void) {
    float values[1000] = {0};
    view_scale scale = view_scale_fit(values, 1000);
    CHECK(scale.low == 0 && scale.high > 0);
    values[3] = 0.25f; /* the one particle that differs is what one looks for */
    scale = view_scale_fit(values, 1000);
    CHECK(scale.low == 0 && scale.high == 0.25);
    for (int i = 0; i < 1000; i++) values[i] = -4;
    scale = view_scale_fit(values, 1000);
    CHECK(scale.low < -4 && scale.high > -4);
    CHECK_NEAR((double)view_scale_place(scale, -4), 0.5, 1e-6);
    const float nothing[2] = {NAN, INFINITY};
    scale = view_scale_fit(nothing, 2);
    CHECK(scale.low == 0 && scale.high == 0);
}

static void test_scales_join(void) {
    view_scale a = {1, 3}, b = {-2, 2}, none = {0, 0}, both = view_scale_join(a, b);
    CHECK(both.low == -2 && both.high == 3);
    CHECK(view_scale_join(none, a).low == 1 && view_scale_join(a, none).high == 3);
}

/* A coarser map keeps the sum of what is shared out evenly; a finer one repeats. */
static void test_heat_resample(void) {
    const double from[2][4] = {{1, 3, 5, 7}, {2, 4, 6, NAN}};
    double two[2], wide[2][8], tall[4][4];
    view_heat_resample(&from[0][0], 2, 4, two, 1, 2);
    CHECK_NEAR(two[0], 2.5, 1e-12);
    CHECK_NEAR(two[1], 6, 1e-12); /* of the three finite ones */
    view_heat_resample(&from[0][0], 2, 4, &wide[0][0], 2, 8);
    for (int x = 0; x < 8; x++) CHECK(wide[0][x] == from[0][x / 2]);
    CHECK(isnan(wide[1][6]) && isnan(wide[1][7]));
    view_heat_resample(&from[0][0], 2, 4, &tall[0][0], 4, 4);
    CHECK(tall[1][2] == 5 && tall[2][2] == 6);
}

static void test_heat_scale(void) {
    double values[5] = {0, 1e-4, 1e-2, 1, NAN};
    view_heat_scale(values, 5, true, 1e-4);
    CHECK(values[0] == -1 && values[4] == -1);
    CHECK_NEAR(values[1], 0, 1e-12);
    CHECK_NEAR(values[2], 0.5, 1e-12);
    CHECK_NEAR(values[3], 1, 1e-12);
    double linear[3] = {0.5, 2, -1};
    view_heat_scale(linear, 3, false, 0);
    CHECK(linear[0] == 0.25 && linear[1] == 1 && linear[2] == -1);
    CHECK(view_heat_ascii(-1) == ' ' && view_heat_ascii(0) == '.' && view_heat_ascii(1) == '@' && view_heat_ascii(NAN) == ' ');
}

/* ---- cut and pan ------------------------------------------------------------------------------------------------- */

static int64_t drawn(const view_camera *camera, const float *position, int64_t count) {
    view_canvas canvas = {0};
    report r;
    int64_t pixels = 0;
    CHECK(view_canvas_resize(&canvas, 200, 100, &r) == STATUS_OK);
    view_projection p = view_camera_projection(camera, 200, 100);
    view_canvas_draw(&canvas, &p, position, NULL, count, 0);
    for (int i = 0; i < 200 * 100; i++) pixels += isfinite(canvas.depth[i]);
    view_canvas_free(&canvas);
    return pixels;
}

static void test_cut_leaves_out_one_side(void) {
    enum { POINTS = 40 };
    float position[POINTS][3];
    for (int i = 0; i < POINTS; i++) {
        position[i][0] = -1 + 2 * (float)i / (POINTS - 1);
        position[i][1] = position[i][2] = 0;
    }
    const float low[3] = {-1, -0.5f, -0.5f}, high[3] = {1, 0.5f, 0.5f};
    view_camera camera = view_camera_default();
    camera.yaw = camera.pitch = 0;
    view_camera_fit(&camera, low, high);
    CHECK(drawn(&camera, &position[0][0], POINTS) == POINTS);
    view_camera_cut(&camera, VIEW_CUT_X);
    CHECK(drawn(&camera, &position[0][0], POINTS) == POINTS / 2);
    view_camera_move_cut(&camera, 0.25f);
    CHECK(drawn(&camera, &position[0][0], POINTS) == 3 * POINTS / 4);
    camera.cut.flipped = true;
    CHECK(drawn(&camera, &position[0][0], POINTS) == POINTS / 4);
    view_camera_cut(&camera, VIEW_CUT_NONE);
    CHECK(drawn(&camera, &position[0][0], POINTS) == POINTS);
    CHECK(view_cut_find("z") == VIEW_CUT_Z && view_cut_find("w") == -1);
}

static void test_pan_moves_the_picture(void) {
    view_camera camera = view_camera_default();
    float at[3], moved[3];
    view_projection p = view_camera_projection(&camera, 300, 100);
    view_project(&p, camera.centre, at);
    view_camera_pan(&camera, 0.5f, 0.2f);
    p = view_camera_projection(&camera, 300, 100);
    view_project(&p, camera.centre, moved);
    CHECK_NEAR((double)(moved[0] - at[0]), 25, 1e-3);
    CHECK_NEAR((double)(moved[1] - at[1]), -10, 1e-3);
}

int main(void) {
    RUN(test_scale_holds_nearly_all);
    RUN(test_scale_of_what_hardly_varies);
    RUN(test_scales_join);
    RUN(test_heat_resample);
    RUN(test_heat_scale);
    RUN(test_cut_leaves_out_one_side);
    RUN(test_pan_moves_the_picture);
    return check_finish();
}
