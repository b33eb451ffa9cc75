/* Colours and attributes: from what a text means to what this terminal can show. */
#ifndef SUNDER_TUI_THEME_H
#define SUNDER_TUI_THEME_H

#include "tui/tui.h"

#define NCURSES_WIDECHAR 1
#include <curses.h>

typedef enum tui_style {
    STYLE_TEXT,
    STYLE_DIM,    /* labels, rules, units */
    STYLE_STRONG, /* values */
    STYLE_HEAD,   /* section headings */
    STYLE_BAR,    /* title and key line */
    STYLE_BAR_STRONG,
    STYLE_BAR_GOOD,
    STYLE_BAR_WARN,
    STYLE_BAR_BAD,
    STYLE_GOOD,
    STYLE_WARN,
    STYLE_BAD,
    STYLE_PLOT, /* sparklines and the progress bar */
    STYLE_COUNT
} tui_style;

typedef struct tui_ink {
    attr_t attributes;
    int pair;
} tui_ink;

typedef struct tui_theme {
    tui_theme_kind kind;
    int colours; /* TUI_TRUE_COLOUR, 256, 16, 8 or 0 */
    bool ascii;
    view_palette palette;
    int pair_count; /* handed out so far; pair 0 is the terminal's own */
    int pair_limit;
    struct theme_slot *slots; /* a table of pairs by their colours */
    int ground_fore, ground_back; /* what −1 stands for in a pair: −1 where the terminal's own colours do */
    int overrides[STYLE_COUNT]; /* the user's own colours + 1: 0–255, or 0x1000000 + rgb; 0: the theme's */
    tui_ink styles[STYLE_COUNT];
} tui_theme;

/* Sets the theme up for the curses screen now open. `wanted` colours: see tui_options.colours. Errors: STATUS_SYSTEM
 * (memory). */
status theme_open(tui_theme *theme, tui_theme_kind kind, int wanted, bool ascii, report *r);
void theme_close(tui_theme *theme);

/* Changes the kind; colour pairs are handed out anew and the palette becomes the kind's own. */
void theme_choose(tui_theme *theme, tui_theme_kind kind);

const char *theme_name(tui_theme_kind kind);

/* Gives a style ("dim", "bar-good") a colour of the user's own: 0–255, or 0x1000000 + rgb. False, with the nearest name (or NULL): no such style. */
bool theme_override(tui_theme *theme, const char *style, int colour, const char **nearest);

/* The ink for a colour pair in terminal colours (with true colour: 0xrrggbb); −1 is the ground's: the terminal's default, or the
 * theme's own where the terminal is dark and the theme light, or the other way round. */
tui_ink theme_pair(tui_theme *theme, int foreground, int background);

/* The terminal colour of `value` in the palette under `light`, both in [0,1]; −1 without colours. */
int theme_colour(const tui_theme *theme, float value, float light);

/* The ink of a value on the ground. Without colours, upper halves are bold. */
tui_ink theme_value(tui_theme *theme, float value);

#endif
