/* Where the values of knobs lie in a scene. Internal to this floor. */
#ifndef SUNDER_SIM_KNOB_PLACES_H
#define SUNDER_SIM_KNOB_PLACES_H

#include "sim/knobs.h"

typedef enum place_kind { PLACE_EFFECT, PLACE_DENSITY, PLACE_SCENE_KEY, PLACE_SOURCE, PLACE_DECLARED } place_kind;

typedef struct knob_place {
    place_kind kind;
    int material; /* −1: the scene's */
    int effect;   /* index in the catalogue; −1: none */
    int key;      /* index in the effect's parameters, in the keys of the scene, or in scene.parameters; of sources 2 × number, and 1 more for `on` */
} knob_place;

typedef struct knob_places {
    int count;
    knob_place items[KNOB_LIMIT];
} knob_places;

/* In the order of scene_knobs. */
void knob_places_list(const scene *s, knob_places *all);

/* The value of a place, three reals for vectors; and, of an effect's place, all values of the effect. */
double *knob_place_value(scene *s, knob_place p);
effect_values *knob_place_values(scene *s, knob_place p);

#endif
