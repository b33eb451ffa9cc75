/* A line of text that is being typed: bytes of UTF-8 and a cursor between characters. */
#ifndef SUNDER_TUI_TYPING_H
#define SUNDER_TUI_TYPING_H

#include "tui/draw.h"
#include "tui/screen.h"

#include <stddef.h>

enum { TYPING_LONGEST = ACTION_ARGUMENT + 64 }; /* bytes of a line that is drawn, terminator included */

/* Moves the cursor, a place in bytes, one character back (step < 0) or on (step > 0), as far as there are any. */
void typing_step(const char *text, size_t *cursor, int step);

/* Takes away the character before the cursor. */
void typing_erase_before(char *text, size_t *cursor);

/* Puts text in at the cursor, which goes behind it; nothing happens when it does not fit into text[size]. */
void typing_insert(char *text, size_t size, size_t *cursor, const char *more);

/* Draws the line behind a sign such as ":", with the cursor reversed; what does not fit before the cursor goes off to the left. */
void typing_draw(const tui_theme *theme, tui_area area, int row, const char *sign, const char *text, size_t cursor);

#endif
