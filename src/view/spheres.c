/* Drawing particles into a depth image. */
#include "view/canvas.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Large spheres are drawn in slices from front to back; between slices the farthest depth of each tile is taken down,
 * and a sphere behind all of its tiles is passed over. In a solid that is nine tenths of them. */
enum { TILE = 16, SLICES = 12 };

typedef struct tiles {
    int columns;
    float *farthest; /* [rows][columns] */
} tiles;

static void draw_pixel(view_canvas *canvas, const float at[3], float value) {
    if (!(at[0] >= 0 && at[0] < (float)canvas->width && at[1] >= 0 && at[1] < (float)canvas->height)) return;
    size_t i = (size_t)(int)at[1] * (size_t)canvas->width + (size_t)(int)at[0];
    if (!(at[2] < canvas->depth[i])) return;
    canvas->depth[i] = at[2];
    canvas->value[i] = value;
}

static bool hidden(const tiles *t, int x0, int x1, int y0, int y1, float nearest) {
    for (int y = y0 / TILE; y <= y1 / TILE; y++) {
        for (int x = x0 / TILE; x <= x1 / TILE; x++) {
            if (t->farthest[y * t->columns + x] > nearest) return false;
        }
    }
    return true;
}

/* `t` may be NULL: nothing is passed over then. */
static void draw_sphere(view_canvas *canvas, const tiles *t, const float at[3], float value, float radius) {
    float w = (float)canvas->width, h = (float)canvas->height;
    if (!(at[0] > -radius && at[0] < w + radius && at[1] > -radius && at[1] < h + radius)) return;
    int x0 = (int)fmaxf(at[0] - radius, 0), x1 = (int)fminf(at[0] + radius, w - 1);
    int y0 = (int)fmaxf(at[1] - radius, 0), y1 = (int)fminf(at[1] + radius, h - 1);
    float nearest = at[2] - radius;
    if (t && hidden(t, x0, x1, y0, y1, nearest)) return;
    for (int y = y0; y <= y1; y++) {
        float dy = (float)y + 0.5f - at[1], room = radius * radius - dy * dy;
        size_t row = (size_t)y * (size_t)canvas->width;
        for (int x = x0; x <= x1; x++) {
            float dx = (float)x + 0.5f - at[0], rise = room - dx * dx;
            if (rise < 0 || nearest >= canvas->depth[row + (size_t)x]) continue;
            float depth = at[2] - sqrtf(rise);
            if (!(depth < canvas->depth[row + (size_t)x])) continue;
            canvas->depth[row + (size_t)x] = depth;
            canvas->value[row + (size_t)x] = value;
        }
    }
}

static float farthest_in_tile(const view_canvas *canvas, int x0, int y0) {
    float farthest = -INFINITY;
    int x1 = x0 + TILE < canvas->width ? x0 + TILE : canvas->width;
    int y1 = y0 + TILE < canvas->height ? y0 + TILE : canvas->height;
    for (int y = y0; y < y1; y++) {
        for (int x = x0; x < x1; x++) {
            float depth = canvas->depth[(size_t)y * (size_t)canvas->width + (size_t)x];
            if (isinf(depth)) return INFINITY;
            if (depth > farthest) farthest = depth;
        }
    }
    return farthest;
}

static void update_tiles(const view_canvas *canvas, tiles *t) {
    for (int y = 0; y < canvas->height; y += TILE) {
        for (int x = 0; x < canvas->width; x += TILE)
            t->farthest[y / TILE * t->columns + x / TILE] = farthest_in_tile(canvas, x, y);
    }
}

/* Where a point lands; false when it is not finite or cut away. */
static bool place(const view_projection *projection, const float point[3], float at[3]) {
    if (view_is_cut(projection, point)) return false;
    view_project(projection, point, at);
    return isfinite(at[0] + at[1] + at[2]);
}

/* The depths between which the particles lie; false when there is none to draw. */
static bool depth_range(const view_projection *projection, const float *position, int64_t count, float *low,
                        float *high) {
    *low = INFINITY;
    *high = -INFINITY;
    for (int64_t i = 0; i < count; i++) {
        float at[3];
        if (!place(projection, position + 3 * i, at)) continue;
        *low = fminf(*low, at[2]);
        *high = fmaxf(*high, at[2]);
    }
    return *low <= *high;
}

static float value_at(const float *value, int64_t i) {
    return value ? fminf(fmaxf(value[i], 0), 1) : 0;
}

static void draw_slices(view_canvas *canvas, const view_projection *projection, const float *position,
                        const float *value, int64_t count, float radius) {
    float low, high;
    if (!depth_range(projection, position, count, &low, &high)) return;
    tiles t = {(canvas->width + TILE - 1) / TILE, canvas->spare};
    float per_slice = fmaxf(high - low, 1e-30f) / SLICES;
    for (int slice = 0; slice < SLICES; slice++) {
        update_tiles(canvas, &t);
        for (int64_t i = 0; i < count; i++) {
            float at[3];
            if (!place(projection, position + 3 * i, at)) continue;
            int mine = (int)((at[2] - low) / per_slice);
            if ((mine < SLICES ? mine : SLICES - 1) == slice) draw_sphere(canvas, &t, at, value_at(value, i), radius);
        }
    }
}

void view_canvas_draw(view_canvas *canvas, const view_projection *projection, const float *position, const float *value,
                      int64_t count, float radius) {
    if (canvas->width == 0 || canvas->height == 0) return;
    float pixels = fminf(radius * projection->scale, 0.25f * (float)(canvas->width + canvas->height));
    if (pixels > 4) {
        draw_slices(canvas, projection, position, value, count, pixels);
        return;
    }
    for (int64_t i = 0; i < count; i++) {
        float at[3];
        if (!place(projection, position + 3 * i, at)) continue;
        if (pixels > 0.75f) {
            draw_sphere(canvas, NULL, at, value_at(value, i), pixels);
        } else {
            draw_pixel(canvas, at, value_at(value, i));
        }
    }
}
