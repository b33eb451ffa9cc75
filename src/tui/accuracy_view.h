/* The Accuracy screen's state, and what its files share. The study is made by `sunder accuracy` in a process of its own, which says what becomes of each
 * run line by line, and all levels with their figures at its end, as rows of a table. */
#ifndef SUNDER_TUI_ACCURACY_VIEW_H
#define SUNDER_TUI_ACCURACY_VIEW_H

#include "store/ledger.h"
#include "tui/app.h"
#include "tui/child.h"
#include "tui/start_words.h"

enum { VIEW_ROWS = 224, VIEW_MEASURES = 24, VIEW_NOTES = 16, VIEW_AXES = 24, VIEW_WORD = 64, VIEW_NOTE = 320, VIEW_SETTINGS = 512, VIEW_COLUMNS = 21 };

/* Columns of the table that `sunder accuracy --csv` writes, in its order; measures come after them. */
typedef enum view_column {
    COLUMN_AXIS, COLUMN_KEY, COLUMN_VALUE, COLUMN_ROLE, COLUMN_STATUS, COLUMN_RUN, COLUMN_PARTICLES, COLUMN_STEPS, COLUMN_H, COLUMN_STEP_SECONDS,
    COLUMN_SECONDS, COLUMN_PREDICTED, COLUMN_ERROR, COLUMN_EARLY, COLUMN_ORDER, COLUMN_LEFT, COLUMN_ESTIMATE, COLUMN_FRONTIER, COLUMN_DOMINATED, COLUMN_USUAL,
    COLUMN_SETTINGS
} view_column;

/* One level of an axis. Numbers are NAN where there are none. */
typedef struct view_level {
    int axis;
    char value[VIEW_WORD], key[VIEW_WORD], state[16], run[LEDGER_ID], dominated[96], settings[VIEW_SETTINGS], message[160];
    bool own, reference, frontier;
    double number[VIEW_COLUMNS]; /* by view_column */
    double measure[VIEW_MEASURES];
} view_level;

typedef struct view_axis {
    char name[VIEW_WORD];
    bool on;
} view_axis;

typedef struct accuracy_view {
    char words[START_TEXT]; /* the scene, as `start` takes it; "" for none */
    int levels;
    long frames, budget;    /* 0: the scene's; none */
    int axis_count, level_count, measure_count, note_count;
    view_axis axes[VIEW_AXES];
    view_level *level;      /* [VIEW_ROWS] */
    char measures[VIEW_MEASURES][VIEW_WORD];
    char notes[VIEW_NOTES][VIEW_NOTE], title[160], tag[160]; /* of the study, as it said */
    int cursor, top;        /* of levels */
    int shown;              /* measure in the column of errors; −1: the largest of all, −2: up to the first crack */
    bool plot;              /* where table and curves have no room beside each other: the curves */
    bool going, looking;    /* a child makes the study; or looks what it would be */
    bool table;             /* its table has begun */
    child child;
    char said[CHILD_LINE];  /* its last line that is none of these */
} accuracy_view;

/* accuracy_lines.c: takes in a line of what the child says. */
void accuracy_view_take(accuracy_view *s, const char *line);

/* Puts levels in the order of their axes: a study's table has those of the marked ones alone, and the others stay. */
void accuracy_view_order(accuracy_view *s);

/* The error that is shown of a level: NAN where there is none; `about` when it is what the order leaves. */
double accuracy_view_error(const accuracy_view *s, const view_level *l, bool *about);

/* accuracy_draw.c */
void accuracy_view_draw(tui_app *app, void *state, tui_area area);

#endif
