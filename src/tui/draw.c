#include "tui/draw.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <wchar.h>

/* The next code point of UTF-8 text, advancing *text; damaged bytes become '?'. */
static uint32_t next_point(const char **text) {
    const unsigned char *p = (const unsigned char *)*text;
    int more = p[0] < 0x80                   ? 0
               : p[0] >= 0xf0 && p[0] < 0xf8 ? 3
               : p[0] >= 0xe0 && p[0] < 0xf0 ? 2
               : p[0] >= 0xc2                ? 1
                                             : -1;
    if (more <= 0 || p[0] >= 0xf8) {
        *text += 1;
        return more == 0 ? p[0] : '?';
    }
    uint32_t point = p[0] & (0x3fu >> more);
    for (int i = 1; i <= more; i++) {
        if ((p[i] & 0xc0) != 0x80) {
            *text += i;
            return '?';
        }
        point = point << 6 | (p[i] & 0x3fu);
    }
    *text += more + 1;
    return point;
}

/* What our own Unicode looks like in ASCII. */
static uint32_t to_ascii(uint32_t point) {
    static const struct {
        uint32_t point;
        char ascii;
    } table[] = {{0x2500, '-'}, {0x2502, '|'}, {0xb7, '-'}, {0x2026, '~'}, {0x2013, '-'}, {0xd7, 'x'}, {0x2588, '#'},
               {0x25cf, 'o'},  {0x253c, '+'},  {0x25b8, '>'}, {0x254c, '.'},  {0x25b2, '^'},  {0x25c6, 'X'}, {0x2212, '-'}};
    if (point < 0x7f) return point;
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        if (table[i].point == point) return (uint32_t)(unsigned char)table[i].ascii;
    }
    return '?';
}

static uint32_t harmless(uint32_t point, bool ascii) {
    if (point < 0x20 || (point >= 0x7f && point < 0xa0)) return '?';
    return ascii ? to_ascii(point) : point;
}

static int columns_of(uint32_t point) {
    return point < 0x80 ? 1 : wcwidth((wchar_t)point);
}

int draw_width(const char *text) {
    int width = 0;
    while (*text) {
        int columns = columns_of(harmless(next_point(&text), false));
        if (columns > 0) width += columns;
    }
    return width;
}

tui_area draw_inset(tui_area area) {
    return (tui_area){area.y, area.x + 1, area.height, area.width - 1};
}

void draw_glyph(tui_area area, int row, int column, tui_ink ink, uint32_t glyph) {
    if (row < 0 || row >= area.height || column < 0 || column >= area.width) return;
    wchar_t text[2] = {(wchar_t)glyph, 0};
    cchar_t cell;
    if (setcchar(&cell, text, ink.attributes, 0, &ink.pair) == OK) mvadd_wch(area.y + row, area.x + column, &cell);
}

int draw_ink(const tui_theme *theme, tui_area area, int row, int column, tui_ink ink, const char *text) {
    while (*text) {
        uint32_t point = harmless(next_point(&text), theme->ascii);
        int columns = columns_of(point);
        if (columns <= 0) continue; /* combining marks and what the locale cannot place */
        if (column + columns > area.width) break;
        draw_glyph(area, row, column, ink, point);
        column += columns;
    }
    return column;
}

int draw_text(const tui_theme *theme, tui_area area, int row, int column, tui_style style, const char *text) {
    return draw_ink(theme, area, row, column, theme->styles[style], text);
}

int draw_format(const tui_theme *theme, tui_area area, int row, int column, tui_style style, const char *format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return draw_text(theme, area, row, column, style, text);
}

void draw_cut(const tui_theme *theme, tui_area area, int row, int column, tui_style style, const char *text) {
    bool fits = column + draw_width(text) <= area.width;
    tui_area rest = {area.y, area.x, area.height, area.width - !fits};
    int end = draw_text(theme, rest, row, column, style, text);
    if (!fits) draw_text(theme, area, row, end, style, "…");
}

void draw_right(const tui_theme *theme, tui_area area, int row, int column, tui_style style, const char *text) {
    int start = column - draw_width(text);
    draw_text(theme, area, row, start < 0 ? 0 : start, style, text);
}

void draw_blank(const tui_theme *theme, tui_area area, int row, tui_style style) {
    for (int i = 0; i < area.width; i++) draw_glyph(area, row, i, theme->styles[style], ' ');
}

void draw_heading(const tui_theme *theme, tui_area area, int row, const char *name, const char *note) {
    for (int i = 0; i < area.width; i++) draw_text(theme, area, row, i, STYLE_DIM, "─");
    draw_format(theme, area, row, 0, STYLE_HEAD, "%s ", name);
    if (!note) return;
    char text[64];
    snprintf(text, sizeof text, " %s", note);
    draw_right(theme, area, row, area.width, STYLE_DIM, text);
}

int draw_paragraph(const tui_theme *theme, tui_area area, int row, int rows, tui_style style, const char *text) {
    int used = 0;
    while (*text && used < rows) {
        int fits = 0, last_space = -1;
        for (int i = 0; text[i]; i++) {
            char part[256];
            if (text[i] == ' ') last_space = i;
            snprintf(part, sizeof part, "%.*s", i + 1, text);
            if (draw_width(part) > area.width) break;
            fits = i + 1;
        }
        if (fits == 0) break;
        int length = text[fits] && last_space > 0 ? last_space : fits;
        draw_format(theme, area, row + used, 0, style, "%.*s", length, text);
        text += length;
        while (*text == ' ') text++;
        used++;
    }
    return used;
}
