#include "tui/widgets.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SPREAD_SAMPLE = 1024 };

/* ---- the camera follows ------------------------------------------------------------------------------------------ */

static int compare_floats(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Where nearly all of the material is along an axis: a few particles that fly off must not shrink everything else. */
static bool spread(const session_snapshot *s, int axis, float *low, float *high) {
    float sample[SPREAD_SAMPLE];
    int count = 0;
    int64_t stride = s->point_count / SPREAD_SAMPLE + 1;
    for (int64_t i = 0; i < s->point_count && count < SPREAD_SAMPLE; i += stride) {
        float x = s->position[3 * i + axis];
        if (isfinite(x)) sample[count++] = x;
    }
    if (count == 0) return false;
    qsort(sample, (size_t)count, sizeof(float), compare_floats);
    *low = sample[count / 50];
    *high = sample[count - 1 - count / 50];
    return true;
}

/* The first frame's box is the base. It grows in jumps of a tenth, so that the scale rests between them, and to four
 * times its size at most. */
void particles_follow(const tui_app *app, run_state *view) {
    const session_snapshot *s = app->shot;
    if (s->point_count == 0) return;
    if (!view->fitted) {
        memcpy(view->fit_minimum, s->bounds_minimum, sizeof view->fit_minimum);
        memcpy(view->fit_maximum, s->bounds_maximum, sizeof view->fit_maximum);
        view->radius = view_particle_radius(s->position, s->point_count);
        view->fitted = true;
    }
    float longest = 0;
    for (int i = 0; i < 3; i++) longest = fmaxf(longest, s->bounds_maximum[i] - s->bounds_minimum[i]);
    for (int i = 0; i < 3; i++) {
        float low, high, step = 0.1f * longest;
        if (!spread(s, i, &low, &high)) return;
        float lowest = s->bounds_minimum[i] - 1.5f * longest, highest = s->bounds_maximum[i] + 1.5f * longest;
        if (low < view->fit_minimum[i]) view->fit_minimum[i] = fmaxf(low - step, lowest);
        if (high > view->fit_maximum[i]) view->fit_maximum[i] = fminf(high + step, highest);
    }
    view_camera_fit(&view->camera, view->fit_minimum, view->fit_maximum);
}

/* ---- the picture ------------------------------------------------------------------------------------------------- */

static status ensure_cells(run_state *view, int width, int height, report *r) {
    size_t wanted = (size_t)width * (size_t)height;
    view->cells_width = width;
    view->cells_height = height;
    if (wanted <= view->cell_capacity) return STATUS_OK;
    memory_free(view->cells, view->cell_capacity * sizeof(view_cell));
    view->cells = memory_allocate_array(wanted, sizeof(view_cell));
    view->cell_capacity = view->cells ? wanted : 0;
    if (view->cells) return STATUS_OK;
    view->cells_width = view->cells_height = 0;
    return report_set(r, STATUS_SYSTEM, "out of memory for the picture");
}

/* Braille dots have one colour a cell, so that light has to show in their density; blocks carry it in their colour. */
static view_ink choose_ink(const tui_app *app, const run_state *view) {
    if (app->theme.colours == 0) return VIEW_INK_VALUE;
    return view->mode == VIEW_HALF && app->theme.colours == 256 ? VIEW_INK_SOLID : VIEW_INK_LIGHT;
}

status particles_prepare(const tui_app *app, run_state *view, tui_area area, report *r) {
    if (area.width < 1 || area.height < 1) return STATUS_OK;
    if (!view->picture_old && view->cells_width == area.width && view->cells_height == area.height) return STATUS_OK;
    const session_snapshot *s = app->shot;
    status failed = ensure_cells(view, area.width, area.height, r);
    if (failed) return failed;
    failed = view_canvas_resize(&view->canvas, area.width * view_mode_pixels_x(view->mode),
                                area.height * view_mode_pixels_y(view->mode), r);
    if (failed) {
        view->cells_width = view->cells_height = 0;
        return failed;
    }
    view_projection p = view_camera_projection(&view->camera, (float)view->canvas.width, (float)view->canvas.height);
    view_canvas_draw(&view->canvas, &p, s->position, s->scalar, s->point_count, view->radius);
    view_canvas_light(&view->canvas, view->radius * p.scale);
    view_raster(&view->canvas, view->mode, choose_ink(app, view), view->cells);
    view->picture_old = false;
    return STATUS_OK;
}

/* Blocks have a colour for each half where there are enough of them, darkened by the light; all else has its value's
 * ink. */
static tui_ink cell_ink(tui_app *app, const run_state *view, const view_cell *cell) {
    tui_theme *t = &app->theme;
    if (choose_ink(app, view) != VIEW_INK_SOLID) return theme_value(t, fmaxf(cell->value[0], cell->value[1]));
    int colour[2];
    for (int i = 0; i < 2; i++)
        colour[i] = cell->value[i] < 0 ? -1 : theme_colour(t, cell->value[i], 0.35f + 0.65f * cell->shade[i]);
    if (cell->glyph == 0x2580) return theme_pair(t, colour[0], colour[1]);
    return theme_pair(t, colour[1], -1);
}

/* Camera, mode and colours under the picture: as many of them as fit, none cut in half. */
static void draw_caption(const tui_app *app, const run_state *view, tui_area area) {
    static const float degrees = 57.29578f;
    char parts[5][32];
    snprintf(parts[0], sizeof parts[0], "yaw %+4.0f", (double)(view->camera.yaw * degrees));
    snprintf(parts[1], sizeof parts[1], "pitch %+3.0f", (double)(view->camera.pitch * degrees));
    snprintf(parts[2], sizeof parts[2], "zoom %5.2f", (double)view->camera.zoom);
    snprintf(parts[3], sizeof parts[3], "%s", view_mode_name(view->mode));
    snprintf(parts[4], sizeof parts[4], "%s", app->theme.colours ? view_palette_name(app->theme.palette) : "");
    int column = 1;
    for (int i = 0; i < 5; i++) {
        if (column + draw_width(parts[i]) > area.width) break;
        column = draw_text(&app->theme, area, area.height - 1, column, STYLE_DIM, parts[i]) + 2;
    }
}

void widget_particles(tui_app *app, run_state *view, tui_area area) {
    tui_area picture = {area.y, area.x, area.height - (area.height > 6), area.width};
    if (picture.height < 1 || picture.width < 1) return;
    report r;
    if (app->shot->point_count == 0) {
        const char *text = !app->run ? "no run; F2 lists scenes to start" : app->ended ? "no particles" : "the scene is being set up …";
        draw_text(&app->theme, picture, picture.height / 2, (picture.width - draw_width(text)) / 2, STYLE_DIM, text);
        return;
    }
    if (particles_prepare(app, view, picture, &r) != STATUS_OK) {
        draw_text(&app->theme, picture, 0, 0, STYLE_BAD, r.message);
        return;
    }
    for (int row = 0; row < picture.height; row++) {
        for (int column = 0; column < picture.width; column++) {
            const view_cell *cell = &view->cells[(size_t)row * (size_t)picture.width + (size_t)column];
            if (cell->glyph != ' ') draw_glyph(picture, row, column, cell_ink(app, view, cell), cell->glyph);
        }
    }
    if (area.height > picture.height) draw_caption(app, view, area);
}
