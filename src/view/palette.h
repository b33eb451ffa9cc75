/* Colour maps from a value in [0,1] to what a picture or a terminal can show. In each of them lightness runs one way
 * from 0 to 1, so that it survives grey paper and colour-blind eyes. */
#ifndef SUNDER_VIEW_PALETTE_H
#define SUNDER_VIEW_PALETTE_H

#include <stdint.h>

typedef enum view_palette {
    VIEW_EMBER,  /* slate to flame, for dark backgrounds */
    VIEW_LAGOON, /* indigo, green, yellow, for dark backgrounds */
    VIEW_CIVIC,  /* blue to yellow: the same to people who do not tell red from green */
    VIEW_INK,    /* pale to dark red, for light backgrounds */
    VIEW_PALETTES
} view_palette;

typedef struct view_rgb {
    uint8_t r, g, b;
} view_rgb;

/* The map's name, "ember" …; never NULL. */
const char *view_palette_name(view_palette palette);

/* The map with this name, or −1. */
int view_palette_find(const char *name);

/* The colour of `value` (clamped to [0,1]; NaN counts as 1) under light in [0,1]: 1 is the map's own colour, 0 its
 * darkest shade. */
view_rgb view_palette_rgb(view_palette palette, float value, float light);

/* The nearest of xterm's colours 16–255 (a 6 × 6 × 6 cube and 24 greys, which do not follow the user's theme). */
int view_rgb_to_256(view_rgb colour);

/* A terminal colour 0–7, or 0–15 when `bright` ones exist: a ramp of its own for each map, not the nearest match, which
 * would not be monotone. */
int view_palette_ansi(view_palette palette, float value, int bright);

/* Relative luminance in [0,1], linear light (Rec. 709). */
double view_luminance(view_rgb colour);

#endif
