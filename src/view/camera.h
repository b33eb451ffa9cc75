/* An orthographic camera in orbit around what is shown.
 *
 * World y is up. At yaw 0 and pitch 0 the camera looks along −z: x points right. Pixels count from the upper left
 * corner, x to the right and y downwards; depth grows away from the camera and is in pixels, so that slopes are slopes
 * on the screen. */
#ifndef SUNDER_VIEW_CAMERA_H
#define SUNDER_VIEW_CAMERA_H

typedef struct view_camera {
    float yaw;       /* rad; positive turns the camera to the right of the scene */
    float pitch;     /* rad, within ±π/2; positive looks from above */
    float zoom;      /* 1: the box fits, whatever the yaw */
    float centre[3]; /* length; what the camera looks at */
    float half[3];   /* length; half the sides of the box that fits at zoom 1 */
} view_camera;

/* A camera ready to project: unit axes and a scale. */
typedef struct view_projection {
    float right[3], up[3], back[3]; /* orthonormal; back points to the camera */
    float centre[3];
    float scale;              /* pixels per length */
    float middle_x, middle_y; /* pixels; where `centre` lands */
} view_projection;

/* Three-quarter view from above, zoom 1, a unit cube. */
view_camera view_camera_default(void);

/* Centres on a box and makes it the one that fits. A box without extent is widened so that the scale stays finite. */
void view_camera_fit(view_camera *camera, const float minimum[3], const float maximum[3]);

/* Turns by the given angles; pitch stops at the poles, yaw wraps. */
void view_camera_orbit(view_camera *camera, float yaw, float pitch);

/* Multiplies the zoom, within 0.1 and 100. */
void view_camera_zoom(view_camera *camera, float factor);

/* The projection onto width × height square pixels. */
view_projection view_camera_projection(const view_camera *camera, float width, float height);

/* One point: out = {x, y, depth} in pixels. */
static inline void view_project(const view_projection *p, const float point[3], float out[3]) {
    float x = point[0] - p->centre[0], y = point[1] - p->centre[1], z = point[2] - p->centre[2];
    out[0] = p->middle_x + p->scale * (p->right[0] * x + p->right[1] * y + p->right[2] * z);
    out[1] = p->middle_y - p->scale * (p->up[0] * x + p->up[1] * y + p->up[2] * z);
    out[2] = -p->scale * (p->back[0] * x + p->back[1] * y + p->back[2] * z);
}

#endif
