/* The Compare screen's own state: two runs at the same frame, from the frames on disk (those of the live run as well). */
#ifndef SUNDER_TUI_COMPARE_H
#define SUNDER_TUI_COMPARE_H

#include "store/ledger.h"
#include "tui/app.h"
#include "tui/frame_reader.h"
#include "tui/particle_view.h"

enum { COMPARE_SIDES = 2, COMPARE_RUNS = 100, COMPARE_BINS = 50, COMPARE_TEXT = 512 };

typedef struct compare_side {
    char id[LEDGER_ID], folder[TUI_PATH], title[192];
    frame_reader *reader;
    bool grown;       /* the run may have more frames than its reader has seen */
    frame_view shown; /* the reader's, valid while has_frame */
    bool has_frame;
    char problem[256];               /* why there is nothing to see; "" when there is */
    double histogram[COMPARE_BINS];  /* shares of particles over the colour scale */
    particle_view view;
} compare_side;

typedef struct compare_state {
    compare_side sides[COMPARE_SIDES];
    int64_t frame;
    bool follows;  /* the newest frame that both have */
    bool plays;    /* frames go on by themselves */
    double next;   /* s of clock_seconds: of the next one */
    bool log_histogram;
    char colour[32];  /* the quantity; "" the first run's own */
    view_scale scale; /* of both, over all frames seen */
    bool stale;       /* other frames are to be asked for */
    char runs[COMPARE_RUNS][LEDGER_ID]; /* that can be completed to, the newest first */
    int run_count;
    char differs[COMPARE_TEXT]; /* parameters and turns that are not the same */
} compare_state;

/* Puts a run on a side: an id, its beginning or end, or last. */
status compare_choose(tui_app *app, compare_state *state, int side, const char *run, report *r);

/* The frames that both have: first and last; false when there is none. */
bool compare_range(const compare_state *state, int64_t *first, int64_t *last);

/* What has been read of a side's run; NULL while there is nothing. */
const frame_page *compare_page(const compare_side *side);

/* Asks for what is to be shown, if that has changed. */
void compare_ask(compare_state *state);

/* Takes over what has been read since; true when there was something. */
bool compare_take(compare_state *state);

void compare_draw(tui_app *app, void *state, tui_area area);

#endif
