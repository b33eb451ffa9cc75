/* The Runs screen's state, and what its files share: the ledger as a table, runs beside each other, their curves, their frames. */
#ifndef SUNDER_TUI_RUNS_H
#define SUNDER_TUI_RUNS_H

#include "store/run_curves.h"
#include "store/run_table.h"
#include "tui/app.h"
#include "tui/frame_reader.h"
#include "tui/particle_view.h"
#include "view/chart.h"

enum { RUNS_MARKS = 12, RUNS_COLUMNS = 24, RUNS_NAME = 64, RUNS_LINES = 512, RUNS_CELL = 48 };

typedef enum runs_page {
    RUNS_TABLE,
    RUNS_DETAIL, /* all of one run, or what differs between the marked ones */
    RUNS_PLOT,
    RUNS_PLAYER,
} runs_page;

/* A line of RUNS_DETAIL: a name and a value for each run. */
typedef struct runs_line {
    char name[RUNS_NAME], cells[RUNS_MARKS][RUNS_CELL];
    bool heading, differs;
} runs_line;

typedef struct runs_state {
    runs_page page;
    ledger *l;
    run_table *table;
    char trouble[256]; /* why there is no table */
    double next_look;  /* s of clock_seconds: when the ledger is asked whether it has changed */

    int *rows, row_count, row_capacity; /* rows of the table that are shown, in order */
    int cursor, top, column;            /* cursor: index in rows; column: under the column cursor */
    int page_rows;                      /* rows in view when drawn last */
    char filter[ACTION_ARGUMENT], sort[RUNS_NAME];
    bool descending;
    int column_count;
    char columns[RUNS_COLUMNS][RUNS_NAME];

    int mark_count;
    char marks[RUNS_MARKS][LEDGER_ID];

    /* What the pages other than the table show: the marked runs, or the one under the cursor. */
    int shown_count;
    char shown[RUNS_MARKS][LEDGER_ID];
    runs_line *lines; /* [RUNS_LINES] */
    int line_count, line_top;

    char measure[RUNS_NAME], against[RUNS_NAME]; /* against: "" for time */
    bool log_plot;
    run_curve curves[RUNS_MARKS];
    int curve_count;

    frame_reader *reader; /* NULL before frames are looked at for the first time */
    char frames_of[READER_PATH]; /* the folder whose frames are shown; "" none */
    int64_t frame;               /* the one that was asked for */
    char field[READER_NAME];     /* the quantity that was; "" the run's usual one */
    particle_view view;
    bool playing;
    double next_frame; /* s of clock_seconds, while playing */

    char again_of[LEDGER_ID], again_folder[1024]; /* the run that app->run reproduces, "" none; its folder */
} runs_state;

runs_state *runs_state_of(tui_app *app);

/* The run that an argument names (id, its beginning or end), or the one under the cursor when it is empty. */
status runs_named(tui_app *app, runs_state *s, const char *argument, char id[LEDGER_ID], char folder[1024], report *r);
bool runs_is_marked(const runs_state *s, const char *id);
/* Fills `shown` with the marked runs, or with the one under the cursor when fewer than `least` are marked. */
status runs_choose_shown(runs_state *s, int least, report *r);

/* Reads the ledger again when it has changed (`force`: in any case), keeping cursor and marks. */
void runs_reload(tui_app *app, runs_state *s, bool force);

/* runs_draw.c, runs_detail.c, runs_plot.c, runs_player.c */
void runs_draw(tui_app *app, void *state, tui_area area);
void runs_draw_detail(tui_app *app, runs_state *s, tui_area area);
void runs_draw_plot(tui_app *app, runs_state *s, tui_area area);
status runs_read_curves(runs_state *s, report *r);
void runs_draw_player(tui_app *app, runs_state *s, tui_area area);
/* Asks for the frame of a number (the last one at or before it), or for the one so many further on; it is shown when it has been read. */
status runs_show_frame(tui_app *app, runs_state *s, int64_t frame, report *r);
status runs_show_further(tui_app *app, runs_state *s, int by, report *r);
void runs_tick_player(tui_app *app, runs_state *s, double now);
/* When the reproduction has ended: whether its bits are the same. */
void runs_tick_reproduction(tui_app *app, runs_state *s);

#define RUNS_HANDLER(name) status name(tui_app *app, const char *argument, report *r);
#define RUNS_COMPLETION(name) bool name(tui_app *app, const char *text, int index, char out[ACTION_ARGUMENT]);
/* runs_screen.c: the table */
RUNS_HANDLER(runs_up)
RUNS_HANDLER(runs_down)
RUNS_HANDLER(runs_page_up)
RUNS_HANDLER(runs_page_down)
RUNS_HANDLER(runs_home)
RUNS_HANDLER(runs_end)
RUNS_HANDLER(runs_left)
RUNS_HANDLER(runs_choose)
RUNS_HANDLER(runs_right)
RUNS_HANDLER(runs_filter)
RUNS_HANDLER(runs_show_all)
RUNS_HANDLER(runs_sort)
RUNS_HANDLER(runs_columns)
RUNS_HANDLER(runs_drop_column)
RUNS_HANDLER(runs_mark)
RUNS_HANDLER(runs_unmark)
RUNS_HANDLER(runs_back)
RUNS_COMPLETION(runs_complete_column)
RUNS_COMPLETION(runs_complete_run)
/* runs_detail.c, runs_plot.c, runs_player.c */
RUNS_HANDLER(runs_diff)
RUNS_HANDLER(runs_detail)
RUNS_HANDLER(runs_plot)
RUNS_HANDLER(runs_next_measure)
RUNS_HANDLER(runs_against)
RUNS_HANDLER(runs_logarithmic)
RUNS_COMPLETION(runs_complete_measure)
RUNS_COMPLETION(runs_complete_parameter)
RUNS_HANDLER(runs_open)
RUNS_HANDLER(runs_frame)
RUNS_HANDLER(runs_colour)
RUNS_HANDLER(runs_beside)
RUNS_HANDLER(runs_turn_left)
RUNS_HANDLER(runs_turn_right)
RUNS_HANDLER(runs_tilt_up)
RUNS_HANDLER(runs_tilt_down)
RUNS_HANDLER(runs_zoom_in)
RUNS_HANDLER(runs_zoom_out)
RUNS_HANDLER(runs_reset)
/* runs_change.c */
RUNS_HANDLER(runs_tag)
RUNS_HANDLER(runs_note)
RUNS_HANDLER(runs_delete)
RUNS_HANDLER(runs_delete_now)
RUNS_HANDLER(runs_reproduce)
#undef RUNS_HANDLER
#undef RUNS_COMPLETION

#endif
