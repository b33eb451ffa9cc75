/* The Stress screen's state, and what its files share. */
#ifndef SUNDER_TUI_STRESSES_H
#define SUNDER_TUI_STRESSES_H

#include "store/ledger.h"
#include "tui/app.h"
#include "tui/child.h"

enum { STRESSES = 1024, STRESSES_NAME = 192, STRESSES_EFFECTS = 192, STRESSES_REMARK = 192, STRESSES_MARKS = 60 };

typedef enum stress_state { STATE_NOT_RUN, STATE_GOING, STATE_HOLDS, STATE_STOPS, STATE_KNOWN, STATE_FAILS, STATES } stress_state;

/* A hard case, and what has become of its newest run. */
typedef struct stress_row {
    char name[STRESSES_NAME], effects[STRESSES_EFFECTS], remark[STRESSES_REMARK], precision[24];
    stress_state state;
    char id[LEDGER_ID]; /* "": there is no run to look at */
    char text[1024];    /* its figures with their bounds, "; " between them */
    bool marked;
} stress_row;

typedef struct stresses {
    stress_row *rows; // [count] of STRESSES
    int count;
    int *shown;       // [shown_count] of STRESSES: rows that fit the filter
    int shown_count, cursor, page_rows;
    char effect[64];  /* only cases that have it on; "": all */
    bool trouble;     /* only those that fail or are known limits */
    char precision[8]; /* "f32", "f64", "both" */
    child child;
    bool going, listing; /* a child makes runs; or tells what was found before */
    char said[CHILD_LINE];
} stresses;

/* The word of a state as `sunder stress` says it. */
const char *stress_state_word(stress_state state);

int stresses_count(const stresses *s, stress_state state);

void stresses_draw(tui_app *app, void *state, tui_area area);

#endif
