#include "view/camera.h"

#include <math.h>
#include <string.h>

static const float quarter_turn = 1.57079632679f, whole_turn = 6.28318530718f;
static const float margin = 0.94f; /* of the picture that a fitting box may take */

view_camera view_camera_default(void) {
    return (view_camera){.yaw = 0.52f, .pitch = 0.38f, .zoom = 1, .half = {0.5f, 0.5f, 0.5f}};
}

void view_camera_fit(view_camera *camera, const float minimum[3], const float maximum[3]) {
    float largest = 0;
    for (int i = 0; i < 3; i++) {
        camera->centre[i] = 0.5f * (minimum[i] + maximum[i]);
        camera->half[i] = fmaxf(0.5f * (maximum[i] - minimum[i]), 0);
        largest = fmaxf(largest, camera->half[i]);
    }
    if (!(largest > 0) || !isfinite(largest)) {
        for (int i = 0; i < 3; i++) camera->half[i] = 0.5f;
    }
    for (int i = 0; i < 3; i++) {
        if (!isfinite(camera->centre[i])) camera->centre[i] = 0;
    }
}

void view_camera_orbit(view_camera *camera, float yaw, float pitch) {
    camera->yaw = remainderf(camera->yaw + yaw, whole_turn);
    camera->pitch = fminf(fmaxf(camera->pitch + pitch, -quarter_turn), quarter_turn);
}

void view_camera_zoom(view_camera *camera, float factor) {
    camera->zoom = fminf(fmaxf(camera->zoom * factor, 0.1f), 100);
}

void view_camera_pan(view_camera *camera, float right, float up) {
    const float by[2] = {right, up};
    for (int i = 0; i < 2; i++) camera->shift[i] = fminf(fmaxf(camera->shift[i] + by[i], -4), 4);
}

void view_camera_cut(view_camera *camera, view_cut_axis axis) {
    camera->cut = (view_cut){.axis = axis, .place = 0.5f};
}

void view_camera_move_cut(view_camera *camera, float share) {
    camera->cut.place = fminf(fmaxf(camera->cut.place + share, 0), 1);
}

static const char *const cut_names[VIEW_CUT_AXES] = {"off", "x", "y", "z"};

const char *view_cut_name(view_cut_axis axis) {
    return cut_names[axis];
}

int view_cut_find(const char *name) {
    for (int i = 0; i < VIEW_CUT_AXES; i++) {
        if (strcmp(cut_names[i], name) == 0) return i;
    }
    return -1;
}

static void project_cut(const view_camera *camera, float cut[4]) {
    if (camera->cut.axis == VIEW_CUT_NONE) return;
    int k = (int)camera->cut.axis - 1;
    float sign = camera->cut.flipped ? -1 : 1;
    cut[k] = sign;
    cut[3] = sign * (camera->centre[k] + (2 * camera->cut.place - 1) * camera->half[k]);
}

view_projection view_camera_projection(const view_camera *camera, float width, float height) {
    float cy = cosf(camera->yaw), sy = sinf(camera->yaw), cp = cosf(camera->pitch), sp = sinf(camera->pitch);
    view_projection p = {
        .right = {cy, 0, -sy},
        .up = {-sp * sy, cp, -sp * cy},
        .back = {cp * sy, sp, cp * cy},
        .centre = {camera->centre[0], camera->centre[1], camera->centre[2]},
        .middle_x = 0.5f * width,
        .middle_y = 0.5f * height,
    };
    project_cut(camera, p.cut);
    /* The widest that the box gets while it turns about y, so that a turn does not change the scale. */
    float across = hypotf(camera->half[0], camera->half[2]);
    float upright = fabsf(cp) * camera->half[1] + fabsf(sp) * across;
    float fit = fminf(p.middle_x / fmaxf(across, 1e-30f), p.middle_y / fmaxf(upright, 1e-30f));
    p.scale = margin * fit * camera->zoom;
    p.middle_x += 0.5f * height * camera->shift[0];
    p.middle_y -= 0.5f * height * camera->shift[1];
    return p;
}
