/* Swelling: the diffused quantity lengthens bonds by α θ̄ (METHOD.md §6, 4). The work is in the loop over bonds (sweep.h). */
#include "sheet/state.h"

static void declare(const effect_values *own, sheet_plan *p) {
    p->alpha = own->value[0][0];
}

static const parameter parameters[] = {
    {.key = "alpha", .unit = "1", .doc = "stretch of a free sheet for a diffused quantity of 1", .minimum = -100, .maximum = 100, .live = true,
     .required = true, .short_form = "swelling = 0.3"},
};

static const sheet_stages stages = {.declare = declare};

const effect SHEET_EFFECT(swelling) = {
    .name = "swelling", .engine = ENGINE_SHEET, .scope = SCOPE_MATERIAL, .doc = "the diffused quantity lengthens bonds",
    .reference = "sheet paper section 4.1; METHOD.md section 6", .parameters = parameters, .parameter_count = 1, .needs = "diffusion",
    .sheet = &stages,
};
