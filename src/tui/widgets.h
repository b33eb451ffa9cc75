/* The parts of the screen, one file each. Each draws into the area that it is given; those in the panel return how many
 * rows they took. */
#ifndef SUNDER_TUI_WIDGETS_H
#define SUNDER_TUI_WIDGETS_H

#include "tui/run.h"

/* title.c: program, screens, scene, variant, run id, state. */
void widget_title(const tui_app *app, tui_area area);

/* panel.c: the statistics, stacked for a tall area or in few lines for a flat one. */
void widget_panel(tui_app *app, const run_state *view, tui_area area);
void widget_strip(tui_app *app, const run_state *view, tui_area area);

/* numbers.c: progress and the run's figures. */
int widget_progress(const tui_app *app, tui_area area, int row);
int widget_numbers(const tui_app *app, tui_area area, int row);
int widget_effects(const tui_app *app, tui_area area, int row, int rows);

/* series.c: figures with their history as sparklines. */
int widget_energy(const tui_app *app, tui_area area, int row, bool with_work);
int widget_damage(const tui_app *app, tui_area area, int row);
int widget_pace(const tui_app *app, tui_area area, int row);
void widget_broken_line(const tui_app *app, tui_area area, int row);
bool app_has_damage(const tui_app *app);

/* histogram.c: the share of particles by damage, in `bins` bars (a divisor of SESSION_BINS), with a heading. */
int widget_histogram(tui_app *app, const run_state *view, tui_area area, int row, int bins);

/* run_widgets.c: where the time of steps goes, what has happened, how the histogram came about (`rows` at most, 0 when there is
 * no room), the histogram with it, and what waits for a restart (over the area's last row). */
int widget_stages(tui_app *app, tui_area area, int row, int rows);
int widget_events(tui_app *app, tui_area area, int row, int rows);
int widget_history(tui_app *app, const run_state *state, tui_area area, int row, int rows);
void widget_damage_panel(tui_app *app, const run_state *state, tui_area area);
void widget_pending(tui_app *app, const run_state *state, tui_area area);

/* message.c: a question, a passing notice, a failure, a warning, or how it ended. */
int message_rows(tui_app *app, int width); /* how many rows it asks for: 1 to 3 */
void widget_message(tui_app *app, tui_area area);

/* keys.c: the key line. */
void widget_keys(tui_app *app, tui_area area);

/* pages.c: help, printed text, the command log. They clamp app->scroll. */
void widget_page(tui_app *app, tui_area area);

/* layout.c: the whole screen. */
void workbench_draw(tui_app *app);

enum { SCREEN_MINIMUM_WIDTH = 40, SCREEN_MINIMUM_HEIGHT = 10 };

#endif
