/* How a run is asked for, as one text: the argument of the action "start", in the words of `sunder run`. */
#ifndef SUNDER_TUI_START_WORDS_H
#define SUNDER_TUI_START_WORDS_H

#include "session/session.h"

enum { START_WORDS = 160, START_TEXT = 1024, START_TURNS_SAID = 64 };

typedef struct start_words {
    char text[2 * START_TEXT];
    script_setting settings[START_WORDS / 2];
    knob_turn turns[START_TURNS_SAID];
    char scene[512];
    session_options options; /* points into this struct: not to be copied */
} start_words;

/* Reads "SCENE [--recipe NAME] [--set KEY=VALUE]… [--frames N] [--threads N] [--precision f32|f64] [--simd NAME]
 * [--turn FRAME:PATH=VALUE]… [--paused]"; 'quotes' keep
 * spaces. A scene that is not found as given is looked for by its name among those at hand. What is not said is as in a
 * workbench: checkpoints in a ring for rewinding. STATUS_INPUT: a word that is none of these. */
status start_parse(const char *text, start_words *out, report *r);

/* The text that start_parse reads back. False: it does not fit. */
bool start_print(const session_options *options, char out[START_TEXT]);

#endif
