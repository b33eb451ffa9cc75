#include "view/picture.h"

#include "base/memory.h"
#include "view/canvas.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <png.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

view_render_options view_render_options_default(void) {
    return (view_render_options){
        .width = 1280,
        .height = 720,
        .samples = 2,
        .palette = VIEW_EMBER,
        .background = {18, 20, 24},
        .camera = view_camera_default(),
    };
}

int64_t view_bounds(const float *position, int64_t count, float minimum[3], float maximum[3]) {
    int64_t finite = 0;
    for (int64_t i = 0; i < count; i++) {
        const float *p = position + 3 * i;
        if (!isfinite(p[0] + p[1] + p[2])) continue;
        for (int k = 0; k < 3; k++) {
            minimum[k] = finite ? fminf(minimum[k], p[k]) : p[k];
            maximum[k] = finite ? fmaxf(maximum[k], p[k]) : p[k];
        }
        finite++;
    }
    for (int k = 0; k < 3 && finite == 0; k++) {
        minimum[k] = -0.5f;
        maximum[k] = 0.5f;
    }
    return finite;
}

/* The mean of a samples × samples square of canvas pixels, empty ones counting as background. */
static void resolve_pixel(const view_canvas *canvas, const view_render_options *o, int x, int y, uint8_t *out) {
    int sum[3] = {0, 0, 0}, n = o->samples;
    for (int k = 0; k < n * n; k++) {
        size_t i = (size_t)(y * n + k / n) * (size_t)canvas->width + (size_t)(x * n + k % n);
        view_rgb c = o->background;
        if (!isinf(canvas->depth[i])) c = view_palette_rgb(o->palette, canvas->value[i], canvas->shade[i]);
        sum[0] += c.r;
        sum[1] += c.g;
        sum[2] += c.b;
    }
    for (int k = 0; k < 3; k++) out[k] = (uint8_t)((sum[k] + n * n / 2) / (n * n));
}

status view_render_points(const float *position, const float *value, int64_t count, const view_render_options *options,
                          uint8_t *rgb, report *r) {
    assert(options->width > 0 && options->height > 0 && options->samples > 0);
    view_canvas canvas = {0};
    int width = options->width * options->samples, height = options->height * options->samples;
    status s = view_canvas_resize(&canvas, width, height, r);
    if (s != STATUS_OK) return s;
    view_projection projection = view_camera_projection(&options->camera, (float)width, (float)height);
    float radius = options->radius > 0 ? options->radius : view_particle_radius(position, count);
    view_canvas_draw(&canvas, &projection, position, value, count, radius);
    view_canvas_light(&canvas, radius * projection.scale);
    for (int y = 0; y < options->height; y++) {
        for (int x = 0; x < options->width; x++) {
            resolve_pixel(&canvas, options, x, y, rgb + 3 * ((size_t)y * (size_t)options->width + (size_t)x));
        }
    }
    view_canvas_free(&canvas);
    return STATUS_OK;
}

/* ---- PNG --------------------------------------------------------------------------------------------------------- */

/* Encodes into an open file and closes it; *why is set on failure. */
static bool encode(FILE *file, const uint8_t *rgb, int width, int height, char why[128]) {
    png_image image = {.version = PNG_IMAGE_VERSION,
                       .width = (png_uint_32)width,
                       .height = (png_uint_32)height,
                       .format = PNG_FORMAT_RGB};
    bool good = png_image_write_to_stdio(&image, file, 0, rgb, 0, NULL) != 0;
    if (!good) snprintf(why, 128, "%.64s", image.message);
    if (good && (fflush(file) != 0 || fsync(fileno(file)) != 0)) {
        snprintf(why, 128, "%s", strerror(errno));
        good = false;
    }
    if (fclose(file) != 0 && good) {
        snprintf(why, 128, "%s", strerror(errno));
        good = false;
    }
    return good;
}

status view_write_png(const char *path, const uint8_t *rgb, int width, int height, report *r) {
    assert(width > 0 && height > 0);
    char beside[4096], why[128] = "";
    if (snprintf(beside, sizeof beside, "%s.part", path) >= (int)sizeof beside)
        return report_set(r, STATUS_SYSTEM, "%.200s…: the path is too long", path);
    FILE *file = fopen(beside, "wb");
    if (!file) return report_set(r, STATUS_SYSTEM, "%s: %s", path, strerror(errno));
    if (!encode(file, rgb, width, height, why)) {
        unlink(beside);
        return report_set(r, STATUS_SYSTEM, "%s: %s", path, why);
    }
    if (rename(beside, path) != 0) {
        int cause = errno;
        unlink(beside);
        return report_set(r, STATUS_SYSTEM, "%s: %s", path, strerror(cause));
    }
    return STATUS_OK;
}
