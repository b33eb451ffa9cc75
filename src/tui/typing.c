#include "tui/typing.h"

#include <curses.h>
#include <stdio.h>
#include <string.h>

/* A continuation byte of UTF-8. */
static bool inner_byte(char c) {
    return ((unsigned char)c & 0xc0) == 0x80;
}

void typing_step(const char *text, size_t *cursor, int step) {
    size_t at = *cursor;
    if (step < 0 && at > 0) {
        do at--;
        while (at > 0 && inner_byte(text[at]));
    } else if (step > 0 && text[at]) {
        do at++;
        while (inner_byte(text[at]));
    }
    *cursor = at;
}

void typing_erase_before(char *text, size_t *cursor) {
    size_t end = *cursor;
    typing_step(text, cursor, -1);
    memmove(text + *cursor, text + end, strlen(text + end) + 1);
}

void typing_insert(char *text, size_t size, size_t *cursor, const char *more) {
    size_t length = strlen(text), added = strlen(more);
    if (length + added + 1 > size) return;
    memmove(text + *cursor + added, text + *cursor, length - *cursor + 1);
    memcpy(text + *cursor, more, added);
    *cursor += added;
}

void typing_draw(const tui_theme *theme, tui_area area, int row, const char *sign, const char *text, size_t cursor) {
    char before[TYPING_LONGEST], at[8] = " ";
    snprintf(before, sizeof before, "%.*s", (int)cursor, text);
    const char *shown = before, *rest = text + cursor;
    int column = draw_text(theme, area, row, 0, STYLE_HEAD, sign);
    while (draw_width(shown) > area.width - column - 2 && *shown)
        do shown++;
        while (inner_byte(*shown));
    column = draw_text(theme, area, row, column, STYLE_STRONG, shown);
    size_t under = 0;
    typing_step(rest, &under, 1);
    if (under) snprintf(at, sizeof at, "%.*s", (int)under, rest);
    tui_ink ink = theme->styles[STYLE_STRONG];
    ink.attributes |= A_REVERSE;
    column = draw_ink(theme, area, row, column, ink, at);
    draw_text(theme, area, row, column, STYLE_STRONG, rest + under);
}
