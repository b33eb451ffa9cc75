/* The Scenes screen's own state. */
#ifndef SUNDER_TUI_SCENES_H
#define SUNDER_TUI_SCENES_H

#include "script/library.h"
#include "tui/app.h"
#include "tui/scene_preview.h"

enum { SCENES_LIMIT = 256, SCENES_SETTINGS = 24, SCENES_SETTING = 192, SCENES_RECIPES = 96 };

typedef struct scenes_state {
    library_scene list[SCENES_LIMIT];
    int count;
    int shown[SCENES_LIMIT], shown_count; /* indices of those that the filter lets through */
    int cursor, top;                      /* of shown */
    char filter[64];
    bool typing;      /* the filter */
    bool on_settings; /* the cursor is on the settings, not on the list */
    int parameter;    /* 0: the recipe, then what the scene declares */

    char recipe[LIBRARY_NAME]; /* "" for the scene's own */
    char settings[SCENES_SETTINGS][SCENES_SETTING]; /* "KEY=VALUE" */
    int setting_count;
    int precision; /* 32 or 64 */

    char recipes[SCENES_RECIPES][LIBRARY_NAME]; /* that can be completed to */
    int recipe_count;

    scene_preview *preview; /* NULL without a terminal */
    preview_facts facts;
    double ask_at; /* when to look at what is chosen, s of clock_seconds; 0: it has been */
    char asked[START_TEXT]; /* what was looked at last */
    bool asked_plan, busy;
} scenes_state;

/* The scene under the cursor, NULL when none is shown. */
const library_scene *scenes_chosen(const scenes_state *s);

/* The scene under the cursor with its recipe, settings and precision, as `start` takes it. False: none is shown, or it does not fit. */
bool scenes_words(const scenes_state *s, char out[START_TEXT]);

/* Rows of settings: the recipe and the scene's parameters. */
int scenes_rows(const scenes_state *s);

/* scenes_draw.c */
void scenes_draw(tui_app *app, void *state, tui_area area);

#endif
