/* A run's frames as one line: where it is, which checkpoints it can go back to, when knobs were turned and what happened. */
#ifndef SUNDER_TUI_TIMELINE_H
#define SUNDER_TUI_TIMELINE_H

#include "tui/draw.h"
#include "tui/theme.h"

typedef struct timeline {
    int64_t first, last, now;       /* frames; the line reaches from first to last */
    int64_t chosen;                 /* a frame under the cursor, −1: none */
    const int64_t *checkpoints;     /* [checkpoint_count] */
    int checkpoint_count;
    const int64_t *turns, *events;  /* [turn_count], [event_count]: frames */
    int turn_count, event_count;
} timeline;

/* Draws it into a row of the area: "frame 12/240 ─·──▲──!──█╌╌╌╌". */
void timeline_draw(const timeline *line, tui_theme *theme, tui_area area, int row);

/* The checkpoint next to `from` in a direction, or −1; from −1 counts as beyond the last. */
int64_t timeline_next(const int64_t *checkpoints, int count, int64_t from, int direction);

/* The frame that a column of the row that timeline_draw filled stands for, −1 when it is none. */
int64_t timeline_frame_at(const timeline *line, tui_area area, int column);

#endif
