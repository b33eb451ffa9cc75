/* Pictures of particles as RGB pixels, and PNG files of them. */
#ifndef SUNDER_VIEW_PICTURE_H
#define SUNDER_VIEW_PICTURE_H

#include "base/status.h"
#include "view/camera.h"
#include "view/palette.h"

#include <stdint.h>

typedef struct view_render_options {
    int width, height; /* pixels */
    int samples;       /* pixels drawn for each one kept, along each side: 2 smooths edges, 1 is four times as fast */
    view_palette palette;
    view_rgb background;
    view_camera camera; /* fit it to the first frame's bounds and keep it for a steady film */
    float radius;       /* length; drawn size of a particle; 0: from the particles' spacing */
} view_render_options;

/* 1280 × 720, 2 samples, ember on near-black, the default camera (to be fitted), radius from the particles. */
view_render_options view_render_options_default(void);

/* Draws particles, coloured by value and lit by their relief, into rgb[height][width][3]. position has shape
 * [count][3], value [count] in [0,1] or NULL. Particles that are not finite are left out. Errors: STATUS_SYSTEM
 * (memory). */
status view_render_points(const float *position, const float *value, int64_t count, const view_render_options *options,
                          uint8_t *rgb, report *r);

/* Writes rgb[height][width][3] as a PNG: beside, then renamed over `path`. Errors: STATUS_SYSTEM with the cause. */
status view_write_png(const char *path, const uint8_t *rgb, int width, int height, report *r);

/* The box around the finite ones of position[count][3]. Returns their number; the box is the unit cube when that is 0.
 */
int64_t view_bounds(const float *position, int64_t count, float minimum[3], float maximum[3]);

#endif
