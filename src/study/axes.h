/* Axes of accuracy: what of a scene may be made finer for more time, everything else equal. They are made from the rules in the effects'
 * tables (effect/effect.h) and from those of the scene's own keys: an effect that is off has no axis. */
#ifndef SUNDER_STUDY_AXES_H
#define SUNDER_STUDY_AXES_H

#include "script/script.h"
#include "sim/simulation.h"

enum { AXES = 24, AXIS_LEVELS = 9, AXIS_SETTINGS = 16, AXIS_NAME = 64, AXIS_KEY = 160, AXIS_VALUE = 40 };

typedef struct axis_level {
    int settings;                        /* beyond the scene's own: --set KEY=VALUE */
    char key[AXIS_SETTINGS][AXIS_KEY], text[AXIS_SETTINGS][AXIS_VALUE];
    char value[AXIS_VALUE];              /* for people: "25000", "f64", "cubic" */
    double number;                       /* NAN of a choice */
    int precision;                       /* 32, 64 */
} axis_level;

typedef struct accuracy_axis {
    char name[AXIS_NAME];  /* what --axis takes: "resolution", "step", "damage.tolerance" */
    char key[AXIS_NAME];   /* what its values are of: "particles", "cfl" */
    char doc[192];
    bool same_particles;   /* particles can be compared one by one */
    bool ordered;          /* its levels have a size h, and an order can be observed */
    bool unasked;          /* taken when no axis is named */
    int first, scene;      /* of the levels: the coarsest that is wanted, and the scene's own */
    int wanted, count;     /* how many are wanted from `first` on; how many there could be */
    axis_level level[AXIS_LEVELS]; /* coarsest first; beyond those wanted there may be coarser ones for a budget */
} accuracy_axis;

/* The axes of a scene whose plan is known, each with about `levels` levels about the scene's own (2 to AXIS_LEVELS); `precision` is what runs are made in.
 * Returns how many. */
int accuracy_axes(const scene *s, const simulation_plan *plan, int precision, int levels, accuracy_axis axes[AXES]);

/* Which axis a word means: its name, its key, or the end of a dotted name that only one has. −1 with the nearest (STATUS_INPUT). */
int accuracy_axis_find(const accuracy_axis *axes, int count, const char *word, report *r);

#endif
