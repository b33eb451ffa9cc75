#include "view/palette.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum { PALETTE_STOPS = 6, RAMP_LENGTH = 5 };

typedef struct palette_row {
    const char *name;
    view_rgb stops[PALETTE_STOPS]; /* evenly spaced over [0,1] */
    float darkest;                 /* what is left of a colour in full shadow: much on paper, little on black */
    int ansi8[RAMP_LENGTH], ansi16[RAMP_LENGTH];
} palette_row;

static const palette_row palettes[VIEW_PALETTES] = {
    [VIEW_EMBER] = {"ember",
                    {{96, 112, 170}, {146, 108, 182}, {200, 98, 160}, {240, 110, 96}, {252, 168, 72}, {255, 240, 170}},
                    0.2f,
                    {4, 4, 5, 3, 7},
                    {4, 5, 13, 11, 15}},
    [VIEW_LAGOON] = {"lagoon",
                     {{96, 98, 184}, {66, 122, 176}, {44, 146, 144}, {82, 180, 112}, {164, 208, 78}, {252, 234, 92}},
                     0.2f,
                     {4, 4, 6, 3, 7},
                     {4, 2, 6, 11, 15}},
    [VIEW_CIVIC] = {"civic",
                    {{64, 108, 190}, {94, 126, 174}, {124, 138, 152}, {168, 160, 130}, {214, 188, 96}, {255, 226, 72}},
                    0.2f,
                    {4, 4, 6, 3, 3},
                    {4, 12, 6, 7, 11}},
    [VIEW_INK] = {"ink",
                  {{150, 178, 200}, {124, 146, 190}, {132, 104, 168}, {156, 58, 118}, {138, 18, 58}, {74, 0, 22}},
                  0.5f,
                  {6, 5, 1, 1, 0},
                  {14, 6, 5, 1, 0}},
};

const char *view_palette_name(view_palette palette) {
    return palettes[palette].name;
}

int view_palette_find(const char *name) {
    for (int i = 0; i < VIEW_PALETTES; i++) {
        if (strcmp(palettes[i].name, name) == 0) return i;
    }
    return -1;
}

static float clamp_value(float value) {
    return isnan(value) ? 1 : fminf(fmaxf(value, 0), 1);
}

static uint8_t blend(uint8_t a, uint8_t b, float t, float light) {
    return (uint8_t)lrintf(((float)a + ((float)b - (float)a) * t) * light);
}

view_rgb view_palette_rgb(view_palette palette, float value, float light) {
    float place = clamp_value(value) * (PALETTE_STOPS - 1);
    int below = (int)place;
    if (below > PALETTE_STOPS - 2) below = PALETTE_STOPS - 2;
    float t = place - (float)below, darkest = palettes[palette].darkest;
    float l = darkest + (1 - darkest) * fminf(fmaxf(light, 0), 1);
    view_rgb a = palettes[palette].stops[below], b = palettes[palette].stops[below + 1];
    return (view_rgb){blend(a.r, b.r, t, l), blend(a.g, b.g, t, l), blend(a.b, b.b, t, l)};
}

int view_palette_ansi(view_palette palette, float value, int bright) {
    int step = (int)(clamp_value(value) * RAMP_LENGTH);
    if (step > RAMP_LENGTH - 1) step = RAMP_LENGTH - 1;
    return bright ? palettes[palette].ansi16[step] : palettes[palette].ansi8[step];
}

static int squared_distance(view_rgb a, int r, int g, int b) {
    int dr = a.r - r, dg = a.g - g, db = a.b - b;
    return 3 * dr * dr + 6 * dg * dg + 2 * db * db; /* weights near the eye's */
}

int view_rgb_to_256(view_rgb colour) {
    static const int level[6] = {0, 95, 135, 175, 215, 255};
    const uint8_t part[3] = {colour.r, colour.g, colour.b};
    int cube[3];
    for (int i = 0; i < 3; i++) {
        cube[i] = 0;
        for (int k = 1; k < 6; k++) {
            if (abs(level[k] - part[i]) < abs(level[cube[i]] - part[i])) cube[i] = k;
        }
    }
    int grey = ((colour.r + colour.g + colour.b) / 3 - 3) / 10;
    grey = grey < 0 ? 0 : grey > 23 ? 23 : grey;
    int shade = 8 + 10 * grey;
    if (squared_distance(colour, shade, shade, shade) <
        squared_distance(colour, level[cube[0]], level[cube[1]], level[cube[2]]))
        return 232 + grey;
    return 16 + 36 * cube[0] + 6 * cube[1] + cube[2];
}

static double linear(uint8_t part) {
    double v = part / 255.0;
    return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
}

double view_luminance(view_rgb colour) {
    return 0.2126 * linear(colour.r) + 0.7152 * linear(colour.g) + 0.0722 * linear(colour.b);
}
