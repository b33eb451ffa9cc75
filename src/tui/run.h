/* The Run screen's own state, and what its files share. */
#ifndef SUNDER_TUI_RUN_H
#define SUNDER_TUI_RUN_H

#include "tui/app.h"
#include "tui/knob_panel.h"
#include "tui/particle_view.h"
#include "tui/timeline.h"

enum { RUN_CHECKPOINTS = 512, RUN_PENDING = 32, RUN_TURNS = 256 };

/* What the panel shows where there is no room for all of it. */
typedef enum run_panel { RUN_NUMBERS, RUN_DAMAGE, RUN_KNOBS, RUN_TIME, RUN_EVENTS, RUN_PANELS } run_panel;

/* A value for a knob that is not live: it waits for a restart. */
typedef struct run_pending {
    char path[KNOB_PATH], value[KNOB_TEXT];
} run_pending;

typedef struct run_state {
    particle_view view;
    bool spinning;    /* the camera turns by itself */
    double last_turn; /* of the spinning camera, s of clock_seconds */
    bool log_histogram;
    char colour[32]; /* asked for last; "" the run's own choice */
    run_panel panel;
    bool whole; /* the panel takes the picture's place as well */

    knob_panel knobs;
    int knob_version; /* of the snapshot that the list is from; −1: none yet */
    bool knobs_in_view; /* when the screen was drawn last */
    run_pending pending[RUN_PENDING];
    int pending_count;

    int64_t checkpoints[RUN_CHECKPOINTS];
    int checkpoint_count;
    knob_turn turns[RUN_TURNS];
    int turn_count;
    int64_t chosen; /* frame under the timeline's cursor, −1: none */
} run_state;

/* The state, made when there is none yet. */
run_state *run_state_of(tui_app *app);

/* Whether there is a run that still goes on; else says what to do. */
status run_needed(const tui_app *app, report *r);

/* What is drawn of the snapshot. */
particle_points run_points(const tui_app *app);

/* run_draw.c: where things are within the screen's area; a height or width of 0: not shown. */
typedef struct run_layout {
    tui_area picture, panel, second, third, timeline;
} run_layout;

run_layout run_lay_out(const run_state *state, tui_area body);
void run_draw(tui_app *app, void *state, tui_area body);
timeline run_timeline(const tui_app *app, const run_state *state);
const char *run_panel_name(run_panel panel);

/* Handlers, by file. */
#define RUN_HANDLER(name) status name(tui_app *app, const char *argument, report *r);
#define RUN_COMPLETION(name) bool name(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]);

/* run_control.c: going on, going back, going elsewhere. */
RUN_HANDLER(run_pause)
RUN_HANDLER(run_step)
RUN_HANDLER(run_go_to)
RUN_HANDLER(run_stop)
RUN_HANDLER(run_choose_earlier)
RUN_HANDLER(run_choose_later)
RUN_HANDLER(run_choose)
RUN_HANDLER(run_branch)
RUN_HANDLER(run_restart)
RUN_HANDLER(run_save_recipe)
RUN_COMPLETION(run_complete_checkpoint)
RUN_COMPLETION(run_complete_material)

/* run_knobs.c */
RUN_HANDLER(run_knob_up)
RUN_HANDLER(run_knob_down)
RUN_HANDLER(run_knob_page_up)
RUN_HANDLER(run_knob_page_down)
RUN_HANDLER(run_knob_other)
RUN_HANDLER(run_knob_more)
RUN_HANDLER(run_knob_less)
RUN_HANDLER(run_knob_more_fine)
RUN_HANDLER(run_knob_less_fine)
RUN_HANDLER(run_knob_type)
RUN_HANDLER(run_knob_find)
RUN_HANDLER(run_turn)
RUN_HANDLER(run_undo)
RUN_HANDLER(run_redo)
RUN_HANDLER(run_reset_knob)
RUN_HANDLER(run_reset_knobs)
RUN_COMPLETION(run_complete_knob)
void run_knobs_follow(tui_app *app, run_state *state);

/* run_view.c: what is seen. */
RUN_HANDLER(run_turn_left)
RUN_HANDLER(run_turn_right)
RUN_HANDLER(run_tilt_up)
RUN_HANDLER(run_tilt_down)
RUN_HANDLER(run_zoom_in)
RUN_HANDLER(run_zoom_out)
RUN_HANDLER(run_pan_left)
RUN_HANDLER(run_pan_right)
RUN_HANDLER(run_pan_up)
RUN_HANDLER(run_pan_down)
RUN_HANDLER(run_reset_camera)
RUN_HANDLER(run_look)
RUN_HANDLER(run_cut)
RUN_HANDLER(run_cut_in)
RUN_HANDLER(run_cut_out)
RUN_HANDLER(run_cut_flip)
RUN_HANDLER(run_scale)
RUN_HANDLER(run_spin)
RUN_HANDLER(run_mode)
RUN_HANDLER(run_palette)
RUN_HANDLER(run_colour)
RUN_HANDLER(run_histogram)
RUN_HANDLER(run_next_panel)
RUN_HANDLER(run_whole)
RUN_COMPLETION(run_complete_colour)
RUN_COMPLETION(run_complete_panel)

#undef RUN_HANDLER
#undef RUN_COMPLETION

#endif
