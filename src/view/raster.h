/* A terminal's cells made from a depth image; knows nothing of curses. */
#ifndef SUNDER_VIEW_RASTER_H
#define SUNDER_VIEW_RASTER_H

#include "view/canvas.h"

#include <stdbool.h>
#include <stdint.h>

typedef enum view_mode {
    VIEW_BRAILLE, /* 2 × 4 dots a cell */
    VIEW_HALF,    /* 1 × 2 blocks a cell, each with a colour of its own */
    VIEW_ASCII,   /* one of " .:-=+*#%@" */
    VIEW_MODES
} view_mode;

typedef struct view_cell {
    uint32_t glyph; /* Unicode code point; a space where nothing is */
    float value[2]; /* of the nearest particle: upper and lower half (the same twice unless VIEW_HALF); −1: empty */
    float shade[2]; /* mean light in [0,1] of what is drawn */
} view_cell;

/* What tells the parts of a body apart where there is no colour. */
typedef enum view_ink {
    VIEW_INK_SOLID, /* whatever is covered is drawn: colour carries value and light */
    VIEW_INK_LIGHT, /* lit parts are denser: colour carries the value only */
    VIEW_INK_VALUE, /* parts of higher value are denser: no colour at all */
} view_ink;

const char *view_mode_name(view_mode mode);

/* Pixels of the canvas that one cell takes. They are square when a cell is twice as high as wide. */
int view_mode_pixels_x(view_mode mode);
int view_mode_pixels_y(view_mode mode);

/* Fills cells[height][width] from a canvas of width·pixels_x × height·pixels_y, lit. */
void view_raster(const view_canvas *canvas, view_mode mode, view_ink ink, view_cell *cells);

#endif
