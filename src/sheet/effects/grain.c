/* Grain: bonds along a sheet's fibre direction are stiffer and tougher than those across, as cos² of the angle. E and G hold across the
 * grain. The work is in the calibration of bonds. */
#include "sheet/state.h"

enum { KEY_STIFFNESS, KEY_TOUGHNESS };

static void declare(const effect_values *own, sheet_plan *p) {
    p->grain_stiffness = own->value[KEY_STIFFNESS][0];
    p->grain_toughness = own->value[KEY_TOUGHNESS][0];
}

static const parameter parameters[] = {
    [KEY_STIFFNESS] = {.key = "stiffness", .unit = "1", .doc = "stiffness of bonds along the grain over those across", .minimum = 1e-3,
                       .maximum = 1e3, .fallback = {1}, .live = true, .logarithmic = true},
    [KEY_TOUGHNESS] = {.key = "toughness", .unit = "1", .doc = "energy that breaks bonds along the grain over those across", .minimum = 1e-3,
                       .maximum = 1e3, .fallback = {1}, .live = true, .logarithmic = true},
};

static const sheet_stages stages = {.declare = declare};

const effect SHEET_EFFECT(grain) = {
    .name = "grain", .engine = ENGINE_SHEET, .scope = SCOPE_MATERIAL, .doc = "bonds differ along and across a direction, as in paper",
    .reference = "METHOD.md section 6, beyond the paper", .parameters = parameters, .parameter_count = 2, .needs = SHEET_ELASTICITY,
    .sheet = &stages,
};
