/* The Compare screen's own state: two runs at the same frame, from the frames on disk (those of the live run as well). */
#ifndef SUNDER_TUI_COMPARE_H
#define SUNDER_TUI_COMPARE_H

#include "session/player.h"
#include "store/ledger.h"
#include "tui/app.h"
#include "tui/particle_view.h"

enum { COMPARE_SIDES = 2, COMPARE_BINS = 50, COMPARE_TEXT = 512 };

typedef struct compare_side {
    char id[LEDGER_ID], folder[TUI_PATH], title[192];
    frame_player *player; /* NULL: no run is chosen, or it has no frames */
    frame_view shown;     /* of the player, valid while has_frame */
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
    double next;   /* s of app_clock: of the next one */
    bool log_histogram;
    char colour[32];  /* the quantity; "" the first run's own */
    view_scale scale; /* of both, over all frames seen */
    bool stale;       /* other frames are to be read */
    char differs[COMPARE_TEXT]; /* parameters and turns that are not the same */
} compare_state;

compare_state *compare_state_of(tui_app *app);

/* Puts a run on a side: an id, its beginning or end, or last. */
status compare_choose(tui_app *app, compare_state *state, int side, const char *run, report *r);

/* The frames that both have: first and last; false when there is none. */
bool compare_range(const compare_state *state, int64_t *first, int64_t *last);

/* Reads what is to be shown, if that has changed. */
void compare_read(compare_state *state);

void compare_draw(tui_app *app, void *state, tui_area area);

#endif
