/* An orthographic camera in orbit around what is shown.
 *
 * World y is up. At yaw 0 and pitch 0 the camera looks along −z: x points right. Pixels count from the upper left
 * corner, x to the right and y downwards; depth grows away from the camera and is in pixels, so that slopes are slopes
 * on the screen. */
#ifndef SUNDER_VIEW_CAMERA_H
#define SUNDER_VIEW_CAMERA_H

#include <stdbool.h>

/* A plane that cuts what is shown: what lies beyond it is left out, so that the inside can be seen. */
typedef enum view_cut_axis { VIEW_CUT_NONE, VIEW_CUT_X, VIEW_CUT_Y, VIEW_CUT_Z, VIEW_CUT_AXES } view_cut_axis;

typedef struct view_cut {
    view_cut_axis axis; /* the plane's normal */
    float place;        /* in [0,1] of the box that fits, along the axis */
    bool flipped;       /* what lies before the plane is left out instead */
} view_cut;

typedef struct view_camera {
    float yaw;       /* rad; positive turns the camera to the right of the scene */
    float pitch;     /* rad, within ±π/2; positive looks from above */
    float zoom;      /* 1: the box fits, whatever the yaw */
    float centre[3]; /* length; what the camera looks at */
    float half[3];   /* length; half the sides of the box that fits at zoom 1 */
    float shift[2];  /* of the picture's half-height: how far the centre is moved to the right and up */
    view_cut cut;
} view_camera;

/* A camera ready to project: unit axes and a scale. */
typedef struct view_projection {
    float right[3], up[3], back[3]; /* orthonormal; back points to the camera */
    float centre[3];
    float scale;              /* pixels per length */
    float middle_x, middle_y; /* pixels; where `centre` lands */
    float cut[4];             /* points with cut[0] x + cut[1] y + cut[2] z > cut[3] are left out; all 0: none are */
} view_projection;

/* Three-quarter view from above, zoom 1, a unit cube. */
view_camera view_camera_default(void);

/* Centres on a box and makes it the one that fits. A box without extent is widened so that the scale stays finite. */
void view_camera_fit(view_camera *camera, const float minimum[3], const float maximum[3]);

/* Turns by the given angles; pitch stops at the poles, yaw wraps. */
void view_camera_orbit(view_camera *camera, float yaw, float pitch);

/* Multiplies the zoom, within 0.1 and 100. */
void view_camera_zoom(view_camera *camera, float factor);

/* Moves the picture by shares of its half-height, at most four either way. */
void view_camera_pan(view_camera *camera, float right, float up);

/* Cuts across an axis in the middle, or not at all. */
void view_camera_cut(view_camera *camera, view_cut_axis axis);

/* Moves the plane by a share of the box, within it. */
void view_camera_move_cut(view_camera *camera, float share);

/* The name of an axis, "off", "x", "y", "z"; and the axis of that name, or −1. */
const char *view_cut_name(view_cut_axis axis);
int view_cut_find(const char *name);

/* The projection onto width × height square pixels. */
view_projection view_camera_projection(const view_camera *camera, float width, float height);

/* Whether the plane leaves a point out. */
static inline bool view_is_cut(const view_projection *p, const float point[3]) {
    return p->cut[0] * point[0] + p->cut[1] * point[1] + p->cut[2] * point[2] > p->cut[3];
}

/* One point: out = {x, y, depth} in pixels. */
static inline void view_project(const view_projection *p, const float point[3], float out[3]) {
    float x = point[0] - p->centre[0], y = point[1] - p->centre[1], z = point[2] - p->centre[2];
    out[0] = p->middle_x + p->scale * (p->right[0] * x + p->right[1] * y + p->right[2] * z);
    out[1] = p->middle_y - p->scale * (p->up[0] * x + p->up[1] * y + p->up[2] * z);
    out[2] = -p->scale * (p->back[0] * x + p->back[1] * y + p->back[2] * z);
}

#endif
