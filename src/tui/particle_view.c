#include "tui/particle_view.h"

#include "base/compare.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SPREAD_SAMPLE = 1024, LEGEND_WIDEST = 40 };

void particle_view_open(particle_view *view, view_mode mode) {
    *view = (particle_view){.camera = view_camera_default(), .mode = mode, .old = true};
}

void particle_view_close(particle_view *view) {
    memory_free(view->cells, view->cell_capacity * sizeof *view->cells);
    memory_free(view->value, view->value_capacity * sizeof *view->value);
    view_canvas_free(&view->canvas);
    memset(view, 0, sizeof *view);
}

void particle_view_forget(particle_view *view) {
    view->fitted = view->scale_is_set = false;
    view->scale = (view_scale){0, 0};
    view->scaled[0] = '\0';
    view->old = true;
}

void particle_view_match(particle_view *view, const particle_view *with) {
    view->camera = with->camera;
    memcpy(view->fit_minimum, with->fit_minimum, sizeof view->fit_minimum);
    memcpy(view->fit_maximum, with->fit_maximum, sizeof view->fit_maximum);
    view->fitted = with->fitted;
    view->mode = with->mode;
    view->scale = with->scale;
    view->radius = with->radius;
    view->old = true;
}

/* ---- the camera follows ------------------------------------------------------------------------------------------ */

/* Where nearly all of the material is along an axis: a few particles that fly off must not shrink everything else. */
static bool spread(const particle_points *points, int axis, float *low, float *high) {
    float sample[SPREAD_SAMPLE];
    int count = 0;
    int64_t stride = points->count / SPREAD_SAMPLE + 1;
    for (int64_t i = 0; i < points->count && count < SPREAD_SAMPLE; i += stride) {
        float x = points->position[3 * i + axis];
        if (isfinite(x)) sample[count++] = x;
    }
    if (count == 0) return false;
    qsort(sample, (size_t)count, sizeof(float), compare_f32);
    *low = sample[count / 50];
    *high = sample[count - 1 - count / 50];
    return true;
}

/* The first frame's box is the base. It grows in jumps of a tenth, so that the scale rests between them, and to four
 * times its size at most. */
static void follow_box(particle_view *view, const particle_points *points) {
    float longest = 0;
    for (int i = 0; i < 3; i++) longest = fmaxf(longest, view->first_maximum[i] - view->first_minimum[i]);
    for (int i = 0; i < 3; i++) {
        float low, high, step = 0.1f * longest;
        if (!spread(points, i, &low, &high)) return;
        float lowest = view->first_minimum[i] - 1.5f * longest, highest = view->first_maximum[i] + 1.5f * longest;
        if (low < view->fit_minimum[i]) view->fit_minimum[i] = fmaxf(low - step, lowest);
        if (high > view->fit_maximum[i]) view->fit_maximum[i] = fminf(high + step, highest);
    }
    view_camera_fit(&view->camera, view->fit_minimum, view->fit_maximum);
}

/* The scale grows with the values and never shrinks, so that a colour keeps its meaning while one looks. */
static void follow_scale(particle_view *view, const particle_points *points) {
    const char *name = points->name ? points->name : "";
    if (strcmp(view->scaled, name) != 0) {
        snprintf(view->scaled, sizeof view->scaled, "%s", name);
        view->scale = (view_scale){0, 0};
        view->scale_is_set = false;
    }
    if (view->scale_is_set || !points->scalar) return;
    bool has_natural = points->natural.high > points->natural.low;
    view->scale = has_natural ? points->natural : view_scale_join(view->scale, view_scale_fit(points->scalar, points->count));
}

/* A sheet is looked at nearly from the front (or from above, when it lies), where a body is looked at from a corner; a camera that was
 * turned already stays as it is. */
static void face(view_camera *camera, const float minimum[3], const float maximum[3]) {
    view_camera usual = view_camera_default();
    float longest = 0;
    for (int i = 0; i < 3; i++) longest = fmaxf(longest, maximum[i] - minimum[i]);
    if (camera->yaw != usual.yaw || camera->pitch != usual.pitch || !(longest > 0)) return;
    if (maximum[2] - minimum[2] < 0.02f * longest) camera->yaw = camera->pitch = 0.15f;
    else if (maximum[1] - minimum[1] < 0.02f * longest) camera->pitch = 0.9f;
}

void particle_view_face(particle_view *view) {
    face(&view->camera, view->first_minimum, view->first_maximum);
    view_camera_fit(&view->camera, view->fit_minimum, view->fit_maximum);
}

void particle_view_follow(particle_view *view, const particle_points *points, const float minimum[3], const float maximum[3]) {
    if (points->count == 0) return;
    if (!view->fitted) {
        memcpy(view->fit_minimum, minimum, sizeof view->fit_minimum);
        memcpy(view->fit_maximum, maximum, sizeof view->fit_maximum);
        memcpy(view->first_minimum, minimum, sizeof view->first_minimum);
        memcpy(view->first_maximum, maximum, sizeof view->first_maximum);
        view->radius = view_particle_radius(points->position, points->count);
        view->fitted = true;
        face(&view->camera, minimum, maximum);
    }
    follow_box(view, points);
    follow_scale(view, points);
    view->old = true;
}

/* ---- the picture ------------------------------------------------------------------------------------------------- */

static status ensure_cells(particle_view *view, int width, int height, report *r) {
    size_t wanted = (size_t)width * (size_t)height;
    view->cells_width = width;
    view->cells_height = height;
    if (wanted <= view->cell_capacity) return STATUS_OK;
    memory_free(view->cells, view->cell_capacity * sizeof *view->cells);
    view->cells = memory_allocate_array(wanted, sizeof *view->cells);
    view->cell_capacity = view->cells ? wanted : 0;
    if (view->cells) return STATUS_OK;
    view->cells_width = view->cells_height = 0;
    return report_set(r, STATUS_SYSTEM, "out of memory for the picture");
}

/* The scalars on their scale, or NULL where there are none. */
static status ensure_values(particle_view *view, const particle_points *points, report *r) {
    size_t wanted = (size_t)points->count;
    if (!points->scalar) return STATUS_OK;
    if (wanted > view->value_capacity) {
        memory_free(view->value, view->value_capacity * sizeof *view->value);
        view->value = memory_allocate_array(wanted, sizeof *view->value);
        view->value_capacity = view->value ? wanted : 0;
        if (!view->value) return report_set(r, STATUS_SYSTEM, "out of memory for the picture");
    }
    view_scale_apply(view->scale, points->scalar, view->value, points->count);
    return STATUS_OK;
}

/* Braille dots have one colour a cell, so that light has to show in their density; blocks carry it in their colour. */
static view_ink choose_ink(const particle_view *view, const tui_theme *theme) {
    if (theme->colours == 0) return VIEW_INK_VALUE;
    return view->mode == VIEW_HALF && theme->colours >= 256 ? VIEW_INK_SOLID : VIEW_INK_LIGHT;
}

static status prepare(particle_view *view, const tui_theme *theme, tui_area area, const particle_points *points, report *r) {
    if (!view->old && view->cells_width == area.width && view->cells_height == area.height) return STATUS_OK;
    if (strcmp(view->scaled, points->name ? points->name : "") != 0) follow_scale(view, points); /* another quantity, or the scale was let go */
    status failed = ensure_cells(view, area.width, area.height, r);
    if (failed == STATUS_OK) failed = ensure_values(view, points, r);
    if (failed == STATUS_OK)
        failed = view_canvas_resize(&view->canvas, area.width * view_mode_pixels_x(view->mode),
                                    area.height * view_mode_pixels_y(view->mode), r);
    if (failed) {
        view->cells_width = view->cells_height = 0;
        return failed;
    }
    view_projection p = view_camera_projection(&view->camera, (float)view->canvas.width, (float)view->canvas.height);
    view_canvas_draw(&view->canvas, &p, points->position, points->scalar ? view->value : NULL, points->count, view->radius);
    view_canvas_light(&view->canvas, view->radius * p.scale);
    view_raster(&view->canvas, view->mode, choose_ink(view, theme), view->cells);
    view->old = false;
    return STATUS_OK;
}

/* Blocks have a colour for each half where there are enough of them, darkened by the light; all else has its value's
 * ink. */
static tui_ink cell_ink(const particle_view *view, tui_theme *theme, const view_cell *cell) {
    if (choose_ink(view, theme) != VIEW_INK_SOLID) return theme_value(theme, fmaxf(cell->value[0], cell->value[1]));
    int colour[2];
    for (int i = 0; i < 2; i++)
        colour[i] = cell->value[i] < 0 ? -1 : theme_colour(theme, cell->value[i], 0.35f + 0.65f * cell->shade[i]);
    if (cell->glyph == 0x2580) return theme_pair(theme, colour[0], colour[1]);
    return theme_pair(theme, colour[1], -1);
}

/* ---- below the picture ------------------------------------------------------------------------------------------- */

/* "damage 0 ▐████▌ 1": the colours of the picture with the numbers at their ends. */
static void draw_legend(const particle_view *view, tui_theme *theme, tui_area area, int row, const particle_points *points) {
    if (!points->scalar) {
        draw_text(theme, area, row, 1, STYLE_DIM, "one colour");
        return;
    }
    char low[32], high[32], name[64];
    bool has_unit = points->unit && points->unit[0] && strcmp(points->unit, "1") != 0;
    snprintf(name, sizeof name, "%s%s%s", points->name ? points->name : "", has_unit ? " " : "", has_unit ? points->unit : "");
    snprintf(low, sizeof low, "%.3g", view->scale.low);
    snprintf(high, sizeof high, "%.3g", view->scale.high);
    int used = 1 + draw_width(low) + 2 + draw_width(high) + 1 + (view->scale_is_set ? 4 : 0);
    if (used + draw_width(name) + 10 > area.width) snprintf(name, sizeof name, "%s", points->name ? points->name : "");
    int width = area.width - used - draw_width(name) - 2;
    width = width > LEGEND_WIDEST ? LEGEND_WIDEST : width;
    int column = draw_text(theme, area, row, 1, STYLE_TEXT, name);
    column = draw_text(theme, area, row, column + 1, STYLE_DIM, low) + 1;
    for (int i = 0; i < width; i++) {
        float value = ((float)i + 0.5f) / (float)width;
        uint32_t glyph = theme->colours == 0 ? (uint32_t)".:-=+*#%@"[(int)(value * 9)] : theme->ascii ? '#' : 0x2588;
        draw_glyph(area, row, column + i, theme_value(theme, value), glyph);
    }
    column = draw_text(theme, area, row, column + (width > 0 ? width : 0) + 1, STYLE_DIM, high);
    if (view->scale_is_set) draw_text(theme, area, row, column + 1, STYLE_DIM, "set");
}

/* Camera, cut, mode and colours: as many of them as fit, none cut in half. */
static void draw_caption(const particle_view *view, const tui_theme *theme, tui_area area, int row) {
    static const float degrees = 57.29578f;
    const view_cut *cut = &view->camera.cut;
    char parts[6][32] = {""};
    if (cut->axis != VIEW_CUT_NONE)
        snprintf(parts[0], sizeof parts[0], "cut %s%s %.0f%%", cut->flipped ? "-" : "", view_cut_name(cut->axis), 100 * (double)cut->place);
    snprintf(parts[1], sizeof parts[1], "yaw %+4.0f", (double)(view->camera.yaw * degrees));
    snprintf(parts[2], sizeof parts[2], "pitch %+3.0f", (double)(view->camera.pitch * degrees));
    snprintf(parts[3], sizeof parts[3], "zoom %5.2f", (double)view->camera.zoom);
    snprintf(parts[4], sizeof parts[4], "%s", view_mode_name(view->mode));
    snprintf(parts[5], sizeof parts[5], "%s", theme->colours ? view_palette_name(theme->palette) : "");
    int column = 1;
    for (int i = 0; i < 6; i++) {
        if (!parts[i][0]) continue;
        if (column + draw_width(parts[i]) > area.width) break;
        column = draw_text(theme, area, row, column, STYLE_DIM, parts[i]) + (area.width < 60 ? 1 : 2);
    }
}

void particle_view_draw(particle_view *view, tui_theme *theme, tui_area area, const particle_points *points) {
    bool roomy = area.height > 6;
    tui_area picture = {area.y, area.x, area.height - (roomy ? 2 : 0), area.width};
    report r;
    if (picture.height < 1 || picture.width < 1) return;
    if (prepare(view, theme, picture, points, &r) != STATUS_OK) {
        draw_text(theme, picture, 0, 0, STYLE_BAD, r.message);
        return;
    }
    for (int row = 0; row < picture.height; row++) {
        for (int column = 0; column < picture.width; column++) {
            const view_cell *cell = &view->cells[(size_t)row * (size_t)picture.width + (size_t)column];
            if (cell->glyph != ' ') draw_glyph(picture, row, column, cell_ink(view, theme, cell), cell->glyph);
        }
    }
    if (!roomy) return;
    draw_legend(view, theme, area, area.height - 2, points);
    draw_caption(view, theme, area, area.height - 1);
}
