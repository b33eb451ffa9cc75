/* Fracture: a bond stretched beyond η_c is broken for ever: it carries no force and nothing diffuses through it (sheet paper §5; METHOD.md
 * §6, 6 and 7). The test itself is in the loop over bonds (sweep.h). */
#include "sheet/state.h"

enum { KEY_G, KEY_STRETCH, KEY_CRITERION, KEY_TRAPPING };

static void declare(const effect_values *own, sheet_plan *p) {
    p->fractures = true;
    p->toughness = own->value[KEY_G][0];
    p->stretch = own->value[KEY_STRETCH][0];
    p->total = own->value[KEY_CRITERION][0] != 0;
    p->untrapped = own->value[KEY_TRAPPING][0] == 0;
}

/* One of the two holds, but where bonds are plastic: those have both. */
static void turned(effect_values *own, const effect_values *all, int key) {
    if (all[SHEET_EFFECT_elastoplastic].on || (key != KEY_G && key != KEY_STRETCH) || !(own->value[key][0] > 0)) return;
    int other = key == KEY_G ? KEY_STRETCH : KEY_G;
    own->value[other][0] = 0;
    own->given[other] = false;
}

static const char *const criteria[] = {"mechanical", "total", NULL};

static const parameter parameters[] = {
    [KEY_G] = {.key = "G", .unit = "mass/time^2", .doc = "fracture energy: work per area of crack", .minimum = 0, .maximum = 1e18, .live = true,
               .logarithmic = true, .short_form = "fracture = 1.2"},
    [KEY_STRETCH] = {.key = "stretch", .unit = "1", .doc = "critical stretch of a bond", .minimum = 0, .maximum = 100, .live = true,
                     .logarithmic = true},
    [KEY_CRITERION] = {.key = "criterion", .unit = "1", .doc = "mechanical: stretch less swelling; total: the paper's", .kind = PARAMETER_CHOICE,
                       .maximum = 1, .choices = criteria, .why_not = "bonds remember the stretch that it measures"},
    [KEY_TRAPPING] = {.key = "trapping", .unit = "1", .doc = "correct G for how the lattice holds cracks back", .kind = PARAMETER_BOOLEAN,
                      .maximum = 1, .fallback = {1}, .live = true},
};

static const effect_field fields[] = {
    {"broken", 1, "1", true, "fraction of a particle's bonds that are broken"},
};

static const effect_measure measures[] = {
    {"bonds_total", "1", "bonds"},
    {"bonds_broken", "1", "bonds that are broken"},
};

static const sheet_stages stages = {.declare = declare};

const effect SHEET_EFFECT(fracture) = {
    .name = "fracture", .engine = ENGINE_SHEET, .scope = SCOPE_MATERIAL, .doc = "bonds break beyond a critical stretch",
    .reference = "sheet paper section 5; METHOD.md section 6", .parameters = parameters, .parameter_count = 4, .fields = fields,
    .field_count = 1, .measures = measures, .measure_count = 2, .turned = turned, .needs = SHEET_ELASTICITY, .sheet = &stages,
};
