#include "view/canvas.h"

#include "base/compare.h"
#include "base/memory.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

enum { CANVAS_ARRAYS = 5, SMOOTHING_PASSES = 5, OCCLUSION_DIRECTIONS = 8 };

static float **canvas_array(view_canvas *canvas, int index) {
    float **arrays[CANVAS_ARRAYS] = {&canvas->depth, &canvas->value, &canvas->shade, &canvas->smooth, &canvas->spare};
    return arrays[index];
}

void view_canvas_free(view_canvas *canvas) {
    for (int i = 0; i < CANVAS_ARRAYS; i++) memory_free(*canvas_array(canvas, i), canvas->capacity * sizeof(float));
    memset(canvas, 0, sizeof *canvas);
}

status view_canvas_resize(view_canvas *canvas, int width, int height, report *r) {
    assert(width >= 0 && height >= 0);
    size_t pixels = (size_t)width * (size_t)height;
    if (pixels > canvas->capacity) {
        view_canvas_free(canvas);
        canvas->capacity = pixels;
        for (int i = 0; i < CANVAS_ARRAYS; i++) {
            float *array = memory_allocate_array(pixels, sizeof(float));
            if (!array) {
                for (int k = 0; k < i; k++) memory_free(*canvas_array(canvas, k), pixels * sizeof(float));
                memset(canvas, 0, sizeof *canvas);
                return report_set(r, STATUS_SYSTEM, "out of memory for a picture of %d × %d pixels", width, height);
            }
            *canvas_array(canvas, i) = array;
        }
    }
    canvas->width = width;
    canvas->height = height;
    view_canvas_clear(canvas);
    return STATUS_OK;
}

void view_canvas_clear(view_canvas *canvas) {
    size_t pixels = (size_t)canvas->width * (size_t)canvas->height;
    for (size_t i = 0; i < pixels; i++) canvas->depth[i] = INFINITY;
    if (pixels == 0) return;
    memset(canvas->value, 0, pixels * sizeof(float));
    memset(canvas->shade, 0, pixels * sizeof(float));
}

/* ---- light ------------------------------------------------------------------------------------------------------- */

/* One pass of smoothing along x (step 1) or y (step width): the mean of the neighbours at ±distance that belong to the
 * same surface, that is, do not jump in depth by more than `edge`. */
static void smooth_pass(const view_canvas *canvas, const float *from, float *to, int distance, bool along_x,
                        float edge) {
    int w = canvas->width, h = canvas->height;
    for (int y = 0; y < h; y++) {
        for (int x = 0; x < w; x++) {
            size_t i = (size_t)y * (size_t)w + (size_t)x;
            float centre = from[i], sum = 2 * centre, weight = 2;
            to[i] = centre;
            if (isinf(centre)) continue;
            int along = along_x ? x : y, length = along_x ? w : h;
            size_t stride = (size_t)distance * (along_x ? 1 : (size_t)w);
            float before = along >= distance ? from[i - stride] : INFINITY;
            float after = along + distance < length ? from[i + stride] : INFINITY;
            /* Both or neither: a one-sided mean would bend the relief at every rim. */
            if (fabsf(before - centre) < edge && fabsf(after - centre) < edge) {
                sum += before + after;
                weight += 2;
            }
            to[i] = sum / weight;
        }
    }
}

/* The slope between neighbours: central where both sides belong to the surface, one-sided at rims. A lone pixel leans
 * by the step down to its neighbours, cut at `edge`: it looks steep, which it is. */
static float slope(float before, float centre, float after, float edge) {
    bool has_before = fabsf(centre - before) < edge, has_after = fabsf(after - centre) < edge;
    if (has_before && has_after) return 0.5f * (after - before);
    if (has_before) return centre - before;
    if (has_after) return after - centre;
    return 0.5f * (fminf(fmaxf(after - centre, -edge), edge) - fminf(fmaxf(before - centre, -edge), edge));
}

/* How much of the sky is hidden: in eight directions, whether the relief rises towards the camera there. In [0,1]. */
static float occlusion(const view_canvas *canvas, int x, int y, float reach) {
    static const float directions[OCCLUSION_DIRECTIONS][2] = {{1, 0},  {0.7f, 0.7f},   {0, 1},  {-0.7f, 0.7f},
                                                              {-1, 0}, {-0.7f, -0.7f}, {0, -1}, {0.7f, -0.7f}};
    int w = canvas->width, h = canvas->height;
    float centre = canvas->smooth[(size_t)y * (size_t)w + (size_t)x], hidden = 0;
    for (int k = 0; k < OCCLUSION_DIRECTIONS; k++) {
        for (int ring = 1; ring <= 2; ring++) {
            float distance = reach * (float)(ring * ring);
            int u = x + (int)lrintf(directions[k][0] * distance), v = y + (int)lrintf(directions[k][1] * distance);
            if (u < 0 || v < 0 || u >= w || v >= h) continue;
            float rise = (centre - canvas->smooth[(size_t)v * (size_t)w + (size_t)u]) / distance - 0.35f;
            hidden += fminf(fmaxf(rise, 0), 1);
        }
    }
    return hidden / (2 * OCCLUSION_DIRECTIONS);
}

static float light_at(const view_canvas *canvas, int x, int y, float reach, float edge) {
    static const float sun[3] = {-0.42f, 0.60f, 0.68f}; /* unit length: from the upper left, before the scene */
    int w = canvas->width, h = canvas->height;
    const float *z = canvas->smooth;
    size_t i = (size_t)y * (size_t)w + (size_t)x;
    float dx = slope(x > 0 ? z[i - 1] : INFINITY, z[i], x + 1 < w ? z[i + 1] : INFINITY, edge);
    float dy = slope(y > 0 ? z[i - (size_t)w] : INFINITY, z[i], y + 1 < h ? z[i + (size_t)w] : INFINITY, edge);
    /* Depth grows away from the camera and y downwards: the normal towards the camera is (dz/dx, −dz/dy, 1) with y up.
     */
    float length = sqrtf(dx * dx + dy * dy + 1);
    float direct = fmaxf((sun[0] * dx - sun[1] * dy + sun[2]) / length, 0), facing = 1 / length;
    float open = 1 - 0.9f * occlusion(canvas, x, y, reach);
    return fminf((0.30f + 0.55f * direct + 0.26f * facing) * open * open, 1);
}

void view_canvas_light(view_canvas *canvas, float grain) {
    size_t pixels = (size_t)canvas->width * (size_t)canvas->height;
    if (pixels == 0) return;
    float size = fmaxf(grain, 0.5f), edge = 4 * size + 2;
    memcpy(canvas->smooth, canvas->depth, pixels * sizeof(float));
    int distance = 1;
    for (int pass = 0; pass < SMOOTHING_PASSES && distance <= (int)ceilf(2 * size); pass++, distance *= 2) {
        smooth_pass(canvas, canvas->smooth, canvas->spare, distance, true, edge);
        smooth_pass(canvas, canvas->spare, canvas->smooth, distance, false, edge);
    }
    for (int y = 0; y < canvas->height; y++) {
        for (int x = 0; x < canvas->width; x++) {
            size_t i = (size_t)y * (size_t)canvas->width + (size_t)x;
            if (!isinf(canvas->depth[i])) canvas->shade[i] = light_at(canvas, x, y, 1.5f * size + 1, edge);
        }
    }
}

/* ---- particle size ----------------------------------------------------------------------------------------------- */

/* The distance to the sixth-nearest neighbour: in a cubic lattice, its spacing. The nearest alone would say nothing
 * about a cloud that is dense in one direction only. */
static float sixth_neighbour(const float *position, int64_t count, int64_t index) {
    enum { NEIGHBOURS = 6 };
    const float *p = position + 3 * index;
    float best[NEIGHBOURS];
    for (int i = 0; i < NEIGHBOURS; i++) best[i] = INFINITY;
    for (int64_t k = 0; k < count; k++) {
        float x = position[3 * k] - p[0], y = position[3 * k + 1] - p[1], z = position[3 * k + 2] - p[2];
        float squared = x * x + y * y + z * z;
        if (k == index || !(squared < best[NEIGHBOURS - 1])) continue;
        int place = NEIGHBOURS - 1;
        for (; place > 0 && best[place - 1] > squared; place--) best[place] = best[place - 1];
        best[place] = squared;
    }
    return sqrtf(best[count > NEIGHBOURS ? NEIGHBOURS - 1 : (int)count - 2]);
}

float view_particle_radius(const float *position, int64_t count) {
    enum { SAMPLE = 33 };
    float distance[SAMPLE];
    int found = 0;
    if (count < 2) return 0;
    for (int k = 0; k < SAMPLE; k++) {
        float d = sixth_neighbour(position, count, (int64_t)k * (count - 1) / (SAMPLE - 1));
        if (isfinite(d) && d > 0) distance[found++] = d;
    }
    if (found == 0) return 0;
    qsort(distance, (size_t)found, sizeof(float), compare_f32);
    return 0.75f * distance[found / 2];
}
