/* Multi-rate: regions that are stiffer take smaller steps, 2^−l of the step; and, for their accuracy, regions where bonds break or where
 * what diffuses acts on some more than on others. A material without it takes one step throughout. The work is in rates.c. */
#include "sheet/state.h"

enum { KEY_LEVELS, KEY_CRACKING, KEY_HEATED };

static void declare(const effect_values *own, sheet_plan *p) {
    p->multirate = true;
    p->levels = (int)lround(own->value[KEY_LEVELS][0]);
    p->cracking = (int)lround(own->value[KEY_CRACKING][0]);
    p->heated = (int)lround(own->value[KEY_HEATED][0]);
}

static const parameter parameters[] = {
    [KEY_LEVELS] = {.key = "levels", .unit = "1", .doc = "how often a step may be halved where bonds are stiffer", .minimum = 0, .maximum = 5,
                    .fallback = {4}, .live = true, .short_form = "multirate = 4", .accuracy = {.kind = ACCURACY_DIFFERENCE, .finer = -2}},
    [KEY_CRACKING] = {.key = "cracking", .unit = "1", .doc = "how often it is halved again where bonds break", .maximum = 2, .fallback = {1}, .live = true,
                      .accuracy = {.kind = ACCURACY_DIFFERENCE, .finer = 1}},
    [KEY_HEATED] = {.key = "heated", .unit = "1", .doc = "how often it is halved again where the diffused quantity swells or softens some bonds more than others",
                    .maximum = 2, .fallback = {1}, .live = true, .accuracy = {.kind = ACCURACY_DIFFERENCE, .finer = 1}},
};

static const sheet_stages stages = {.declare = declare};

const effect SHEET_EFFECT(multirate) = {
    .name = "multirate", .engine = ENGINE_SHEET, .scope = SCOPE_MATERIAL, .doc = "regions that are stiffer, hotter or cracking take smaller steps",
    .reference = "METHOD.md section 6; Lew, Marsden, Ortiz and West 2003", .parameters = parameters, .parameter_count = 3,
    .needs = SHEET_ELASTICITY, .sheet = &stages,
};
