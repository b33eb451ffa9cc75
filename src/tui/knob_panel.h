/* The knobs of a run as a list with a cursor: rows for every parameter of every effect, twins side by side on one row, and what can be
 * undone. Draws itself; turning is left to whoever asks it for the next value. */
#ifndef SUNDER_TUI_KNOB_PANEL_H
#define SUNDER_TUI_KNOB_PANEL_H

#include "sim/knobs.h"
#include "tui/draw.h"
#include "tui/theme.h"

enum { KNOB_UNDO = 256 };

/* One row of the list: a heading, a knob, or a knob and its twin. */
typedef struct knob_row {
    int knob; /* index in the list; that of a heading's first knob */
    int twin; /* −1: none */
    bool heading;
} knob_row;

/* What a turn changed: the side of a pair of twins that was said before, and the one that is said now. */
typedef struct knob_change {
    char from_path[KNOB_PATH], from[KNOB_TEXT], to_path[KNOB_PATH], to[KNOB_TEXT];
} knob_change;

typedef struct knob_panel {
    knob *list; /* [KNOB_LIMIT], memory of the panel */
    int count;
    knob_row *rows; /* [2 KNOB_LIMIT] */
    int row_count;
    int cursor;     /* row, never a heading unless there is nothing else */
    bool on_twin;   /* the cursor is on the row's second side */
    int component;  /* of a vector, that arrows turn */
    int top;        /* first row shown */
    knob_change undo[KNOB_UNDO]; /* [undo_count], oldest first; beyond undo_at: what can be done again */
    int undo_count, undo_at;
} knob_panel;

/* Errors: memory. */
status knob_panel_open(knob_panel *panel, report *r);
void knob_panel_close(knob_panel *panel);

/* The list has changed: rows are made anew, the cursor stays on its knob. `count` of panel->list are filled in. */
void knob_panel_arrange(knob_panel *panel, int count);

/* Another run's knobs come: nothing can be undone. */
void knob_panel_forget(knob_panel *panel);

/* The knob under the cursor, NULL when there is none. */
const knob *knob_panel_current(const knob_panel *panel);

/* Moves the cursor by rows, over headings; stops at the ends. */
void knob_panel_move(knob_panel *panel, int by);

/* To the knob with this index in the list. */
void knob_panel_go(knob_panel *panel, int index);

/* The twin of the current knob, or the next component of a vector. False when it has neither. */
bool knob_panel_other(knob_panel *panel);

/* The value one step up (direction 1) or down (−1): factors where the table says logarithmic (1.25, fine 1.02), shares of the range
 * where it has one (a fortieth, fine a four-hundredth), else of the value's own size; the next choice; on and off. Rounded to four digits,
 * within the range. False when it cannot go further. */
bool knob_step(const knob *k, int component, int direction, bool fine, double value[3]);

/* Where a value is on its slider, in [0,1]: over the range where it is finite, else around the value that the run began with. */
double knob_place(const knob *k, double value);

/* A value for people: four digits, "on", a choice's name, "(0, -9.8, 0)". text[KNOB_TEXT]. */
void knob_show(const knob *k, const double value[3], char *text);

/* Notes a turn that has been made; what could be done again is forgotten. `before` is the list as it was. */
void knob_panel_note(knob_panel *panel, const knob *before, int index, const char *to);

/* The turn that undoes the last one, or does it again; NULL when there is none. Call knob_panel_undone when it has been made. */
const knob_change *knob_panel_undo(const knob_panel *panel);
const knob_change *knob_panel_redo(const knob_panel *panel);
void knob_panel_undone(knob_panel *panel, int by);

/* Draws list and, below it, what is to be known of the current knob. */
void knob_panel_draw(knob_panel *panel, tui_theme *theme, tui_area area);

#endif
