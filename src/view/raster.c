#include "view/raster.h"

#include <math.h>
#include <string.h>

static const struct {
    const char *name;
    int x, y;
} modes[VIEW_MODES] = {
    [VIEW_BRAILLE] = {"braille", 2, 4},
    [VIEW_HALF] = {"blocks", 1, 2},
    [VIEW_ASCII] = {"ascii", 2, 4}, /* a finer canvas than it shows: coverage chooses among the characters */
};

const char *view_mode_name(view_mode mode) {
    return modes[mode].name;
}

int view_mode_pixels_x(view_mode mode) {
    return modes[mode].x;
}

int view_mode_pixels_y(view_mode mode) {
    return modes[mode].y;
}

/* Whether a pixel is inked: dense parts fully, thin parts by an ordered 4 × 4 threshold that stays put on the screen.
 */
static bool inked(const view_canvas *canvas, view_ink ink, int x, int y) {
    static const float threshold[4][4] = {
        {0.5f, 8.5f, 2.5f, 10.5f}, {12.5f, 4.5f, 14.5f, 6.5f}, {3.5f, 11.5f, 1.5f, 9.5f}, {15.5f, 7.5f, 13.5f, 5.5f}};
    size_t i = (size_t)y * (size_t)canvas->width + (size_t)x;
    if (isinf(canvas->depth[i])) return false;
    if (ink == VIEW_INK_SOLID) return true;
    float density = ink == VIEW_INK_LIGHT ? 0.2f + 0.9f * canvas->shade[i] : 0.3f + 0.8f * canvas->value[i];
    return density * 16 > threshold[y & 3][x & 3];
}

/* A rectangle of pixels in one: the nearest one's value, the mean light, the number covered and inked. */
typedef struct summary {
    float value, shade;
    int covered, bits; /* bits: inked pixels in reading order */
} summary;

static summary summarise(const view_canvas *canvas, view_ink ink, int x0, int y0, int nx, int ny) {
    summary s = {.value = -1};
    float nearest = INFINITY;
    for (int y = 0; y < ny; y++) {
        for (int x = 0; x < nx; x++) {
            size_t i = (size_t)(y0 + y) * (size_t)canvas->width + (size_t)(x0 + x);
            if (isinf(canvas->depth[i])) continue;
            s.covered++;
            s.shade += canvas->shade[i];
            if (inked(canvas, ink, x0 + x, y0 + y)) s.bits |= 1 << (y * nx + x);
            if (canvas->depth[i] < nearest) {
                nearest = canvas->depth[i];
                s.value = canvas->value[i];
            }
        }
    }
    if (s.covered) s.shade /= (float)s.covered;
    return s;
}

static view_cell braille_cell(const view_canvas *canvas, view_ink ink, int column, int row) {
    /* Unicode numbers the dots of U+2800 by column: 1 2 3 7 on the left, 4 5 6 8 on the right. */
    static const uint8_t dot[8] = {0x01, 0x08, 0x02, 0x10, 0x04, 0x20, 0x40, 0x80};
    summary s = summarise(canvas, ink, 2 * column, 4 * row, 2, 4);
    uint32_t pattern = 0;
    for (int k = 0; k < 8; k++) {
        if (s.bits & (1 << k)) pattern |= dot[k];
    }
    return (view_cell){pattern ? 0x2800 + pattern : ' ', {s.value, s.value}, {s.shade, s.shade}};
}

static view_cell half_cell(const view_canvas *canvas, view_ink ink, int column, int row) {
    summary upper = summarise(canvas, ink, column, 2 * row, 1, 1);
    summary lower = summarise(canvas, ink, column, 2 * row + 1, 1, 1);
    static const uint32_t glyphs[4] = {' ', 0x2580, 0x2584, 0x2588}; /* none, upper, lower, both */
    view_cell cell = {glyphs[upper.bits | lower.bits << 1], {upper.value, lower.value}, {upper.shade, lower.shade}};
    /* With both halves of one colour each, the upper is the glyph and the lower its background. */
    if (ink == VIEW_INK_SOLID && cell.glyph == 0x2588) cell.glyph = 0x2580;
    return cell;
}

static view_cell ascii_cell(const view_canvas *canvas, view_ink ink, int column, int row) {
    static const char ramp[] = ".:-=+*#%@";
    summary s = summarise(canvas, VIEW_INK_SOLID, 2 * column, 4 * row, 2, 4);
    view_cell cell = {' ', {s.value, s.value}, {s.shade, s.shade}};
    if (!s.covered) return cell;
    float dense = ink == VIEW_INK_VALUE ? s.value : s.shade * (float)s.covered / 8;
    int step = (int)(dense * (float)(sizeof ramp - 1));
    int last = (int)sizeof ramp - 2;
    cell.glyph = (uint32_t)(unsigned char)ramp[step < 0 ? 0 : step > last ? last : step];
    return cell;
}

void view_raster(const view_canvas *canvas, view_mode mode, view_ink ink, view_cell *cells) {
    int width = canvas->width / modes[mode].x, height = canvas->height / modes[mode].y;
    for (int row = 0; row < height; row++) {
        for (int column = 0; column < width; column++) {
            view_cell *cell = &cells[(size_t)row * (size_t)width + (size_t)column];
            switch (mode) {
            case VIEW_BRAILLE: *cell = braille_cell(canvas, ink, column, row); break;
            case VIEW_HALF: *cell = half_cell(canvas, ink, column, row); break;
            default: *cell = ascii_cell(canvas, ink, column, row); break;
            }
        }
    }
}
