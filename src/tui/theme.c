#include "tui/theme.h"

#include "base/memory.h"
#include "base/names.h"

#include <stdlib.h>
#include <string.h>

enum { SLOTS = 1 << 16, PAIRS_MOST = 32000 /* half full at most */ };

typedef struct theme_slot {
    int fore, back, pair; /* pair 0: free */
} theme_slot;

/* What a style is made of at each depth of colour; −1 is the ground's. */
typedef struct style_row {
    attr_t attributes;
    short fore256, back256;
    short fore8, back8;
    attr_t mono;
} style_row;

/* What is behind a theme's text, and what its text is without a colour of its own. */
typedef struct ground_row {
    short fore256, back256;
    short fore8, back8;
} ground_row;

static const ground_row dark_ground = {252, 234, 7, 0}, light_ground = {235, 231, 0, 7};

typedef struct theme_row {
    const char *name;
    view_palette palette;
    style_row styles[STYLE_COUNT];
} theme_row;

static const theme_row themes[TUI_THEMES] = {
    [TUI_DARK] = {"dark",
                  VIEW_EMBER,
                  {
                      [STYLE_TEXT] = {A_NORMAL, -1, -1, -1, -1, A_NORMAL},
                      [STYLE_DIM] = {A_NORMAL, 244, -1, -1, -1, A_NORMAL},
                      [STYLE_STRONG] = {A_NORMAL, 254, -1, -1, -1, A_BOLD},
                      [STYLE_HEAD] = {A_NORMAL, 110, -1, 6, -1, A_BOLD},
                      [STYLE_BAR] = {A_NORMAL, 247, 236, -1, -1, A_REVERSE},
                      [STYLE_BAR_STRONG] = {A_BOLD, 255, 236, -1, -1, A_REVERSE},
                      [STYLE_BAR_GOOD] = {A_BOLD, 114, 236, -1, -1, A_REVERSE},
                      [STYLE_BAR_WARN] = {A_BOLD, 221, 236, -1, -1, A_REVERSE},
                      [STYLE_BAR_BAD] = {A_BOLD, 210, 236, 1, -1, A_REVERSE},
                      [STYLE_GOOD] = {A_NORMAL, 114, -1, 2, -1, A_NORMAL},
                      [STYLE_WARN] = {A_NORMAL, 221, -1, 3, -1, A_BOLD},
                      [STYLE_BAD] = {A_BOLD, 210, -1, 1, -1, A_BOLD},
                      [STYLE_PLOT] = {A_NORMAL, 110, -1, 6, -1, A_NORMAL},
                  }},
    [TUI_LIGHT] = {"light",
                   VIEW_INK,
                   {
                       [STYLE_TEXT] = {A_NORMAL, -1, -1, -1, -1, A_NORMAL},
                       [STYLE_DIM] = {A_NORMAL, 242, -1, -1, -1, A_NORMAL},
                       [STYLE_STRONG] = {A_NORMAL, 234, -1, -1, -1, A_BOLD},
                       [STYLE_HEAD] = {A_NORMAL, 25, -1, 4, -1, A_BOLD},
                       [STYLE_BAR] = {A_NORMAL, 240, 254, -1, -1, A_REVERSE},
                       [STYLE_BAR_STRONG] = {A_BOLD, 233, 254, -1, -1, A_REVERSE},
                       [STYLE_BAR_GOOD] = {A_BOLD, 22, 254, -1, -1, A_REVERSE},
                       [STYLE_BAR_WARN] = {A_BOLD, 94, 254, -1, -1, A_REVERSE},
                       [STYLE_BAR_BAD] = {A_BOLD, 124, 254, 1, -1, A_REVERSE},
                       [STYLE_GOOD] = {A_NORMAL, 22, -1, 2, -1, A_NORMAL},
                       [STYLE_WARN] = {A_NORMAL, 94, -1, 5, -1, A_BOLD},
                       [STYLE_BAD] = {A_BOLD, 124, -1, 1, -1, A_BOLD},
                       [STYLE_PLOT] = {A_NORMAL, 25, -1, 4, -1, A_NORMAL},
                   }},
    [TUI_COLOUR_BLIND] = {"colour-blind",
                          VIEW_CIVIC,
                          {
                              [STYLE_TEXT] = {A_NORMAL, -1, -1, -1, -1, A_NORMAL},
                              [STYLE_DIM] = {A_NORMAL, 244, -1, -1, -1, A_NORMAL},
                              [STYLE_STRONG] = {A_BOLD, -1, -1, -1, -1, A_BOLD},
                              [STYLE_HEAD] = {A_NORMAL, 74, -1, 6, -1, A_BOLD},
                              [STYLE_BAR] = {A_NORMAL, 247, 236, -1, -1, A_REVERSE},
                              [STYLE_BAR_STRONG] = {A_BOLD, 255, 236, -1, -1, A_REVERSE},
                              [STYLE_BAR_GOOD] = {A_BOLD, 117, 236, -1, -1, A_REVERSE},
                              [STYLE_BAR_WARN] = {A_BOLD, 222, 236, -1, -1, A_REVERSE},
                              [STYLE_BAR_BAD] = {A_BOLD | A_UNDERLINE, 208, 236, 7, -1, A_REVERSE | A_UNDERLINE},
                              [STYLE_GOOD] = {A_NORMAL, 74, -1, 6, -1, A_NORMAL},
                              [STYLE_WARN] = {A_NORMAL, 222, -1, 3, -1, A_BOLD},
                              [STYLE_BAD] = {A_BOLD | A_UNDERLINE, 208, -1, 7, -1, A_BOLD | A_UNDERLINE},
                              [STYLE_PLOT] = {A_NORMAL, 74, -1, 6, -1, A_NORMAL},
                          }},
};

const char *theme_name(tui_theme_kind kind) {
    return themes[kind].name;
}

/* Starts curses' colours if any are wanted, and says how many of them to use. */
static int start_colours(int wanted) {
    const char *no_colour = getenv("NO_COLOR");
    if (wanted == TUI_AUTO && no_colour && no_colour[0]) wanted = 0;
    if (wanted == 0 || !has_colors() || start_color() == ERR) return 0;
    use_default_colors();
    int most = wanted == TUI_AUTO || wanted > COLORS ? COLORS : wanted;
    /* Where colours are given as red, green and blue there is no table of 256. */
    if (COLORS >= TUI_TRUE_COLOUR && most >= 256) return TUI_TRUE_COLOUR;
    return most >= 256 ? 256 : most >= 16 ? 16 : most >= 8 ? 8 : 0;
}

/* Terminals with a light background often say so: COLORFGBG is "foreground;background". */
static tui_theme_kind guess_kind(void) {
    const char *hint = getenv("COLORFGBG");
    const char *background = hint ? strrchr(hint, ';') : NULL;
    if (background && (strcmp(background, ";7") == 0 || strcmp(background, ";15") == 0)) return TUI_LIGHT;
    return TUI_DARK;
}

static theme_slot *find_slot(const tui_theme *theme, int fore, int back) {
    uint32_t hash = ((uint32_t)fore * 0x9e3779b1u) ^ ((uint32_t)back * 0x85ebca6bu);
    for (uint32_t i = (hash ^ hash >> 15) % SLOTS;; i = (i + 1) % SLOTS) {
        theme_slot *slot = &theme->slots[i];
        if (slot->pair == 0 || (slot->fore == fore && slot->back == back)) return slot;
    }
}

tui_ink theme_pair(tui_theme *theme, int foreground, int background) {
    if (foreground < 0) foreground = theme->ground_fore;
    if (background < 0) background = theme->ground_back;
    if (theme->colours == 0 || (foreground < 0 && background < 0)) return (tui_ink){A_NORMAL, 0};
    theme_slot *slot = find_slot(theme, foreground, background);
    if (slot->pair == 0) {
        /* Few terminals run out; those keep the foreground and give up the background. */
        if (theme->pair_count + 1 >= theme->pair_limit)
            return background != theme->ground_back ? theme_pair(theme, foreground, -1) : (tui_ink){A_NORMAL, 0};
        *slot = (theme_slot){foreground, background, ++theme->pair_count};
        init_extended_pair(slot->pair, foreground, background);
    }
    return (tui_ink){A_NORMAL, slot->pair};
}

/* Six bits a channel: pairs are not without end. The lowest eight numbers are the terminal's named colours, not shades of blue. */
static int direct_colour(view_rgb c) {
    int value = (c.r & 0xfc) << 16 | (c.g & 0xfc) << 8 | (c.b & 0xfc);
    return value < 8 ? 8 : value;
}

/* A colour of the 256 as red, green, blue. */
static view_rgb rgb_of_256(int index) {
    static const uint8_t levels[] = {0, 95, 135, 175, 215, 255};
    if (index < 16) {
        uint8_t high = index >= 8 ? 255 : 205;
        return (view_rgb){index & 1 ? high : 0, index & 2 ? high : 0, index & 4 ? high : 0};
    }
    if (index >= 232) {
        uint8_t grey = (uint8_t)(8 + 10 * (index - 232));
        return (view_rgb){grey, grey, grey};
    }
    index -= 16;
    return (view_rgb){levels[index / 36], levels[index / 6 % 6], levels[index % 6]};
}

int theme_colour(const tui_theme *theme, float value, float light) {
    switch (theme->colours) {
    case 0: return -1;
    case TUI_TRUE_COLOUR: return direct_colour(view_palette_rgb(theme->palette, value, light));
    case 256: return view_rgb_to_256(view_palette_rgb(theme->palette, value, light));
    default: return view_palette_ansi(theme->palette, value, theme->colours == 16);
    }
}

tui_ink theme_value(tui_theme *theme, float value) {
    if (theme->colours == 0) return (tui_ink){value >= 0.5f ? A_BOLD : A_NORMAL, 0};
    tui_ink ink = theme_pair(theme, theme_colour(theme, value, 1), -1);
    /* Plain blue on black is hardly seen; bold is the bright variant on most terminals of 8 colours. */
    if (theme->colours == 8 && theme->kind != TUI_LIGHT) ink.attributes |= A_BOLD;
    return ink;
}

static tui_ink style_ink(tui_theme *theme, const style_row *row) {
    if (theme->colours == 0) return (tui_ink){row->mono, 0};
    bool direct = theme->colours == TUI_TRUE_COLOUR, many = direct || theme->colours == 256;
    int fore = many ? row->fore256 : row->fore8, back = many ? row->back256 : row->back8;
    int own = theme->overrides[row - themes[theme->kind].styles] - 1;
    if (own >= 0 && (own < theme->colours || many)) fore = own;
    if (fore >= 0x1000000) {
        view_rgb rgb = {(uint8_t)(fore >> 16), (uint8_t)(fore >> 8), (uint8_t)fore};
        fore = direct ? direct_colour(rgb) : view_rgb_to_256(rgb);
    } else if (direct && fore >= 0) {
        fore = direct_colour(rgb_of_256(fore));
    }
    if (direct && back >= 0) back = direct_colour(rgb_of_256(back));
    tui_ink ink = theme_pair(theme, fore, back);
    ink.attributes = row->attributes;
    /* With few colours a bar is told apart by being reversed, and a value by being bold. */
    if (!many && row->back256 >= 0) ink.attributes |= A_REVERSE;
    if (!many && row == &themes[theme->kind].styles[STYLE_STRONG]) ink.attributes |= A_BOLD;
    return ink;
}

/* The terminal's own ground, unless the theme is made for the other one: dark letters are not read on black. */
static void paint_ground(tui_theme *theme) {
    bool many = theme->colours >= 256, own = theme->colours > 0 && (theme->kind == TUI_LIGHT) != (guess_kind() == TUI_LIGHT);
    const ground_row *g = theme->kind == TUI_LIGHT ? &light_ground : &dark_ground;
    int fore = many ? g->fore256 : g->fore8, back = many ? g->back256 : g->back8;
    bool direct = theme->colours == TUI_TRUE_COLOUR;
    theme->ground_fore = !own ? -1 : direct ? direct_colour(rgb_of_256(fore)) : fore;
    theme->ground_back = !own ? -1 : direct ? direct_colour(rgb_of_256(back)) : back;
    tui_ink ink = theme_pair(theme, -1, -1);
    cchar_t blank;
    setcchar(&blank, L" ", ink.attributes, 0, &ink.pair);
    bkgrndset(&blank);
}

void theme_choose(tui_theme *theme, tui_theme_kind kind) {
    if (kind == TUI_THEME_AUTO) kind = guess_kind();
    theme->kind = kind;
    theme->palette = themes[kind].palette;
    theme->pair_count = 0;
    memset(theme->slots, 0, SLOTS * sizeof *theme->slots);
    paint_ground(theme);
    for (int i = 0; i < STYLE_COUNT; i++) theme->styles[i] = style_ink(theme, &themes[kind].styles[i]);
}

bool theme_override(tui_theme *theme, const char *style, int colour, const char **nearest) {
    static const char *const names[STYLE_COUNT] = {"text",     "dim",     "strong", "head", "bar", "bar-strong", "bar-good",
                                                   "bar-warn", "bar-bad", "good",   "warn", "bad", "plot"};
    for (int i = 0; i < STYLE_COUNT; i++) {
        if (strcmp(names[i], style) != 0) continue;
        theme->overrides[i] = colour + 1;
        theme_choose(theme, theme->kind);
        return true;
    }
    *nearest = name_nearest(style, names, STYLE_COUNT);
    return false;
}

status theme_open(tui_theme *theme, tui_theme_kind kind, int wanted, bool ascii, report *r) {
    theme->slots = memory_allocate_array(SLOTS, sizeof *theme->slots);
    if (!theme->slots) return report_set(r, STATUS_SYSTEM, "out of memory for the screen's colours");
    theme->ascii = ascii;
    theme->colours = start_colours(wanted);
    if (theme->colours > 0) theme->pair_limit = COLOR_PAIRS > PAIRS_MOST ? PAIRS_MOST : COLOR_PAIRS;
    theme_choose(theme, kind);
    return STATUS_OK;
}

void theme_close(tui_theme *theme) {
    memory_free(theme->slots, SLOTS * sizeof *theme->slots);
    theme->slots = NULL;
}
