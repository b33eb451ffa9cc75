/* Knobs: every parameter of a scene by the word that --set knows it by, with what its table says of it, and turning them while a
 * simulation goes on.
 *
 * A turn acts at the boundary between two frames: the state of frame k is what it was, the steps after it see the new value. So a run is
 * given by its scene and its list of turns, each with the frame at whose end it acts: the same list gives the same bits, whether turns were
 * made by hand while the run went on or were known beforehand. */
#ifndef SUNDER_SIM_KNOBS_H
#define SUNDER_SIM_KNOBS_H

#include "sim/scene.h"

enum { KNOB_PATH = 128, KNOB_TEXT = 128, KNOB_LIMIT = SCENE_PARAMETERS };

typedef struct knob {
    char path[KNOB_PATH];  /* "tube.damage.eta", "gravity.acceleration": the word of --set and of the resolved parameters */
    char owner[64];        /* the material's name; "" for what belongs to the scene */
    int material;          /* index in scene.materials; −1: of the scene */
    char effect[32];       /* "" for what no effect has: a density, a key of the scene or of its script */
    char key[64], unit[48], doc[192];
    parameter_kind kind;
    int components;        /* 3 for vectors, else 1 */
    double minimum, maximum, fallback[3]; /* maximum may be HUGE_VAL, minimum −HUGE_VAL */
    double start[3];       /* as the scene, its recipe and --set gave it */
    double value[3];       /* now */
    bool live;             /* may be turned: it acts from the next frame on */
    bool logarithmic;      /* a slider should step it by factors */
    bool derived;          /* it follows from its twin, which the scene said or which was turned last */
    bool short_form;       /* its effect may be written as a bare value that means it */
    bool varies;           /* a function of place: the value is the largest, and turning it scales all */
    int twin;              /* index of the knob that says the same thing in the same list, −1: none */
    char why_not[96];      /* what a knob that is not live needs, "" for those that are */
    const char *const *choices; /* NULL-terminated, of PARAMETER_CHOICE; static */
} knob;

/* One turn of a knob, as text: the value in --set's words ("0.05", "true", "implicit", "0,-9.8,0"), numbers with all their digits. */
typedef struct knob_turn {
    int64_t frame; /* acts between this frame and the next */
    char path[KNOB_PATH], value[KNOB_TEXT];
} knob_turn;

/* The knobs of `now`, with `start` telling what each was to begin with (the same scene is allowed), in a fixed order: materials, the scene's
 * effects, keys of the scene, parameters that its script declared. Fills at most `limit`; returns how many there are. */
int scene_knobs(const scene *start, const scene *now, knob *out, int limit);

/* Which of the list is meant by a word: its path, or any shorter form that --set knows and that is unique. −1 with the nearest
 * path (STATUS_INPUT) when there is none or more than one. */
int knob_find(const knob *list, int count, const char *word, report *r);

/* Range, and whole numbers where there are only those. */
status knob_check(const knob *k, const double value[3], report *r);

/* A value from text, checked for its kind, range and choices, and back; text that knob_print wrote gives the same bits again. Numbers may be
 * given for choices (the index) and booleans (0, 1). text[KNOB_TEXT]. */
status knob_parse(const knob *k, const char *text, double value[3], report *r);
void knob_print(const knob *k, const double value[3], char *text);

/* Turns a knob of a scene's values: checks kind, range and that it is live, lets its twin go, and resolves what follows from it in its material
 * (sigma_c and break_stretch, sigma_c after E). STATUS_INPUT leaves everything as it was: an unknown path (with the nearest), a knob that is
 * not live (with what it needs), a value out of its range, values that no longer go together. path[KNOB_PATH] receives the whole path
 * and may be NULL. */
status scene_turn(scene *now, const char *word, const double value[3], char *path, report *r);

/* The same with a value in --set's words. */
status scene_turn_text(scene *now, const char *word, const char *text, char *path, report *r);

#endif
