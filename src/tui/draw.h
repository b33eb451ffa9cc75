/* Text into rectangles of the screen: clipped, control characters made harmless, Unicode made ASCII where the terminal
 * needs that. */
#ifndef SUNDER_TUI_DRAW_H
#define SUNDER_TUI_DRAW_H

#include "tui/theme.h"

#include <stdint.h>

/* A rectangle of cells on the screen. */
typedef struct tui_area {
    int y, x, height, width;
} tui_area;

/* What is left of an area without its first column, which screens leave free. */
tui_area draw_inset(tui_area area);

/* Writes UTF-8 text at (row, column) of the area with a style; returns the column after it. What does not fit is cut.
 */
int draw_text(const tui_theme *theme, tui_area area, int row, int column, tui_style style, const char *text);
int draw_format(const tui_theme *theme, tui_area area, int row, int column, tui_style style, const char *format, ...)
    __attribute__((format(printf, 6, 7)));

/* As draw_text, but what does not fit ends in "…". */
void draw_cut(const tui_theme *theme, tui_area area, int row, int column, tui_style style, const char *text);

/* As draw_text, but ending before `column`. */
void draw_right(const tui_theme *theme, tui_area area, int row, int column, tui_style style, const char *text);

/* As draw_text with any ink. */
int draw_ink(const tui_theme *theme, tui_area area, int row, int column, tui_ink ink, const char *text);

/* One cell of any code point. */
void draw_glyph(tui_area area, int row, int column, tui_ink ink, uint32_t glyph);

/* Fills a row of the area with spaces in a style. */
void draw_blank(const tui_theme *theme, tui_area area, int row, tui_style style);

/* A section heading: "── name ─────── note ──" over the row. note may be NULL. */
void draw_heading(const tui_theme *theme, tui_area area, int row, const char *name, const char *note);

/* Text over at most `rows` rows, broken at spaces; what is beyond the last is cut. Returns the rows used. */
int draw_paragraph(const tui_theme *theme, tui_area area, int row, int rows, tui_style style, const char *text);

/* The columns that text takes. */
int draw_width(const char *text);

#endif
