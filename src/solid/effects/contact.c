/* Contact of sheets with solids. The simulation does it, which knows both engines (src/sim/contact.c). */
#include "solid/state.h"

static const parameter parameters[] = {
    {.key = "friction", .unit = "1", .doc = "Coulomb's coefficient between sheets and solids", .maximum = 1e3, .live = true, .short_form = "contact = 0.3"},
};

static const solid_stages stages = {0};

const effect SOLID_EFFECT(contact) = {
    .name = "contact", .engine = ENGINE_SOLID, .scope = SCOPE_SCENE, .doc = "sheets and solids push one another",
    .reference = "METHOD.md section 6 (beyond the papers)", .parameters = parameters, .parameter_count = 1, .stages = &stages,
};
