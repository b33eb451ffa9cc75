/* A depth image: for each square pixel what is nearest, its value, and how much light it gets.
 *
 * Terminal rasters and pictures are both made from one: particles are drawn as small spheres, then the relief is lit.
 */
#ifndef SUNDER_VIEW_CANVAS_H
#define SUNDER_VIEW_CANVAS_H

#include "base/status.h"
#include "view/camera.h"

#include <stddef.h>
#include <stdint.h>

typedef struct view_canvas {
    int width, height; /* pixels */
    size_t capacity;   /* pixels that fit into the arrays */
    float *depth;      /* [height][width] pixels, grows away from the camera; INFINITY where nothing is */
    float *value;      /* [height][width] value of the nearest particle, in [0,1] */
    float *shade;      /* [height][width] light, in [0,1]; set by view_canvas_light */
    float *smooth;     /* [height][width] relief without the particles' bumps; work space */
    float *spare;      /* [height][width] work space */
} view_canvas;

/* Makes the canvas width × height and empty; start from a zeroed one. Errors: STATUS_SYSTEM (the canvas is then 0 × 0).
 */
status view_canvas_resize(view_canvas *canvas, int width, int height, report *r);
void view_canvas_free(view_canvas *canvas);

/* Empties every pixel. */
void view_canvas_clear(view_canvas *canvas);

/* Draws `count` spheres of `radius` (length; under a pixel they become one pixel). position has shape [count][3]; value
 * has shape [count] and is clamped to [0,1], NULL means 0 everywhere. Positions that are not finite are left out, as
 * are those that lie outside the picture. */
void view_canvas_draw(view_canvas *canvas, const view_projection *projection, const float *position, const float *value,
                      int64_t count, float radius);

/* Lights the relief: direction, and darkening in hollows and behind edges. `grain` is the particles' radius in pixels:
 * bumps of that size are smoothed away, so that the body's form is seen and not its grain. */
void view_canvas_light(view_canvas *canvas, float grain);

/* A radius (length) for which neighbouring particles' spheres just close the surface: from the distances between
 * neighbours of a sample. 0 when there are fewer than two particles. */
float view_particle_radius(const float *position, int64_t count);

#endif
