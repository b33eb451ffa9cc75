/* Linear micro-springs: f = c (η − α θ̄) (sheet paper eq. 18; METHOD.md §6). */
#include "sheet/state.h"

static inline __attribute__((always_inline)) vec bond_law(const real *law, vec s, vec q, vec held, vec *stiffening) {
    (void)law, (void)s, (void)held, (void)stiffening;
    return q;
}

#define LAW_HOLDS 0
#define LAW_STIFFENS 0
#define LAW_RUBBERY 0
#include "sheet/sweep.h"

#include "sheet/law_parameters.h"

static void declare(const effect_values *own, sheet_plan *p) {
    p->law = LAW_LINEAR;
    law_declare(own, p);
}

static double stored(const real law[LAW_CONSTANTS], const bond_state *b) {
    (void)law;
    return 0.5 * b->strain * b->strain;
}

static const parameter parameters[] = {LAW_PARAMETERS};

static const effect_measure measures[] = {
    {"elastic", "mass length^2/time^2", "energy stored in bonds"},
};

static const sheet_stages stages = {.declare = declare, .bonds = sweep, .stored = stored};

const effect SHEET_EFFECT(linear) = {
    .name = "linear", .engine = ENGINE_SHEET, .scope = SCOPE_MATERIAL, .doc = "linear micro-springs",
    .reference = "sheet paper section 4.1; METHOD.md section 6", .parameters = parameters,
    .parameter_count = sizeof parameters / sizeof *parameters, .measures = measures, .measure_count = 1,
    .provides = SHEET_ELASTICITY, .sheet = &stages,
};
