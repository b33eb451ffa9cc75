/* Softening: the diffused quantity takes stiffness, toughness or critical stretch away: acid dissolves, water weakens paper, heat softens
 * foil. Each falls linearly with θ̄ down to a floor. The work is in the loop over bonds (sweep.h). */
#include "sheet/state.h"

enum { KEY_STIFFNESS, KEY_TOUGHNESS, KEY_STRETCH, KEY_FLOOR };

static void declare(const effect_values *own, sheet_plan *p) {
    p->stiffness_loss = own->value[KEY_STIFFNESS][0];
    p->toughness_loss = own->value[KEY_TOUGHNESS][0];
    p->stretch_loss = own->value[KEY_STRETCH][0];
    p->toughness_softens = own->given[KEY_TOUGHNESS];
    p->floor = own->value[KEY_FLOOR][0];
}

static const parameter parameters[] = {
    [KEY_STIFFNESS] = PARAMETER_PLAIN("stiffness", "1", "share of the stiffness lost at a diffused quantity of 1", 0, 1e6, 0),
    [KEY_TOUGHNESS] = {.key = "toughness", .unit = "1", .doc = "share of the fracture energy lost; the critical stretch follows", .minimum = 0,
                       .maximum = 1e6, .live = true, .twin = "stretch"},
    [KEY_STRETCH] = {.key = "stretch", .unit = "1", .doc = "share of the critical stretch lost", .minimum = 0, .maximum = 1e6, .live = true,
                     .twin = "toughness"},
    [KEY_FLOOR] = PARAMETER_PLAIN("floor", "1", "share that is always left", 1e-6, 1, 0.01),
};

static const sheet_stages stages = {.declare = declare};

const effect SHEET_EFFECT(softening) = {
    .name = "softening", .engine = ENGINE_SHEET, .scope = SCOPE_MATERIAL, .doc = "the diffused quantity weakens bonds",
    .reference = "METHOD.md section 6", .parameters = parameters, .parameter_count = 4, .needs = "diffusion", .sheet = &stages,
};
