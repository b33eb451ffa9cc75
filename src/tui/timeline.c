#include "tui/timeline.h"

#include <inttypes.h>
#include <stdio.h>

/* What stands before the line, in a width that does not change while the run goes on. */
static void label(const timeline *line, tui_area area, char *text, size_t size) {
    char last[32];
    int digits = snprintf(last, sizeof last, "%" PRId64, line->last);
    snprintf(text, size, "%s%*" PRId64 "/%s", area.width >= 60 ? "frame " : "", digits, line->now, last);
}

/* The columns of the line itself, within the row. */
static void extent(const timeline *line, tui_area area, int *from, int *width) {
    char text[64];
    label(line, area, text, sizeof text);
    *from = draw_width(text) + 2;
    *width = area.width - *from - 1;
}

static int column_of(const timeline *line, int width, int64_t frame) {
    if (line->last <= line->first || frame < line->first || frame > line->last) return frame == line->first ? 0 : -1;
    return (int)((frame - line->first) * (width - 1) / (line->last - line->first));
}

static void mark(const timeline *line, tui_theme *theme, tui_area area, int row, tui_style style, const char *glyph,
                 const int64_t *frames, int count) {
    int from, width;
    extent(line, area, &from, &width);
    for (int i = 0; i < count; i++) {
        int column = column_of(line, width, frames[i]);
        if (column >= 0) draw_text(theme, area, row, from + column, style, glyph);
    }
}

void timeline_draw(const timeline *line, tui_theme *theme, tui_area area, int row) {
    int from, width;
    extent(line, area, &from, &width);
    if (width < 8 || row >= area.height) return;
    char text[64];
    label(line, area, text, sizeof text);
    draw_text(theme, area, row, 1, STYLE_TEXT, text);
    int now = column_of(line, width, line->now);
    for (int i = 0; i < width; i++) {
        if (i <= now) draw_text(theme, area, row, from + i, STYLE_PLOT, "─");
        else draw_text(theme, area, row, from + i, STYLE_DIM, "╌");
    }
    /* What matters most is drawn last: over what shares its column. */
    mark(line, theme, area, row, STYLE_STRONG, theme->ascii ? "o" : "·", line->checkpoints, line->checkpoint_count);
    mark(line, theme, area, row, STYLE_BAD, "!", line->events, line->event_count);
    mark(line, theme, area, row, STYLE_WARN, "▲", line->turns, line->turn_count);
    mark(line, theme, area, row, STYLE_STRONG, "█", &line->now, 1);
    if (line->chosen >= 0) mark(line, theme, area, row, STYLE_HEAD, "◆", &line->chosen, 1);
}

int64_t timeline_next(const int64_t *checkpoints, int count, int64_t from, int direction) {
    if (count == 0) return -1;
    if (direction < 0) {
        for (int i = count; i > 0; i--) {
            if (from < 0 || checkpoints[i - 1] < from) return checkpoints[i - 1];
        }
        return checkpoints[0];
    }
    for (int i = 0; i < count; i++) {
        if (from >= 0 && checkpoints[i] > from) return checkpoints[i];
    }
    return -1;
}

int64_t timeline_frame_at(const timeline *line, tui_area area, int column) {
    int from, width;
    extent(line, area, &from, &width);
    if (column < from || column >= from + width || width < 2) return -1;
    return line->first + (column - from) * (line->last - line->first) / (width - 1);
}
