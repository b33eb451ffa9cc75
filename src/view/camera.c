#include "view/camera.h"

#include <math.h>

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
    /* The widest that the box gets while it turns about y, so that a turn does not change the scale. */
    float across = hypotf(camera->half[0], camera->half[2]);
    float upright = fabsf(cp) * camera->half[1] + fabsf(sp) * across;
    float fit = fminf(p.middle_x / fmaxf(across, 1e-30f), p.middle_y / fmaxf(upright, 1e-30f));
    p.scale = margin * fit * camera->zoom;
    return p;
}
