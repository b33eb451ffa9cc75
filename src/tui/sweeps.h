/* The Sweep screen's state, and what its files share. */
#ifndef SUNDER_TUI_SWEEPS_H
#define SUNDER_TUI_SWEEPS_H

#include "script/sweep.h"
#include "store/ledger.h"
#include "tui/app.h"
#include "tui/child.h"

enum { SWEEPS_SCRIPTS = 64, SWEEPS_NAME = 64 };

typedef struct sweep_cell_result {
    bool known; /* the child has said what has become of it */
    sweep_line last;
    double value; /* of the measure; NaN: none */
} sweep_cell_result;

typedef struct sweep_state {
    char scripts[SWEEPS_SCRIPTS][SWEEP_PATH];
    int script_count, script;
    bool loaded;
    sweep plan;
    int count;
    sweep_cell_result *cells; /* [count] */
    int axis[2];              /* down and across; −1: none */
    int held[SWEEP_AXES];     /* where the axes that are not shown stand */
    int at[2];                /* the cell under the cursor */
    char measure[SWEEPS_NAME], title[SWEEP_TEXT];
    child child;
    bool going, listing;      /* a child runs the sweep; or looks what is done */
    char said[CHILD_LINE];    /* its last line that is none of a run */
    ledger *l;
} sweep_state;

/* The run of the shown axes' values; −1 when there is none. */
int sweep_run_at(const sweep_state *s, int down, int across);
/* How many values an axis of the two has: 1 for none. */
int sweep_extent(const sweep_state *s, int which);

void sweep_draw(tui_app *app, void *state, tui_area area);

#endif
