/* Elastoplastic bonds: f = c q up to η0, then c η0 e^{−β(q − η0)/η0}; unloading with slope c from the largest stretch, so that a stretch
 * stays (sheet paper eq. 20, with its softening applied once; METHOD.md §6, 7). q is the mechanical stretch η − α θ̄. */
#include "base/simd_math.h"
#include "sheet/state.h"

enum { ETA0, DECAY }; /* DECAY: β/η0 */

static inline __attribute__((always_inline)) vec bond_law(const real *law, vec s, vec q, vec held, vec *stiffening) {
    (void)s, (void)stiffening;
    vec over = vec_max(held - law[ETA0], vec_all(0));
    vec envelope = vec_select(over > 0, law[ETA0] * vec_exp(-law[DECAY] * over), held);
    return envelope - (held - q);
}

#define LAW_HOLDS 1
#define LAW_STIFFENS 0
#define LAW_RUBBERY 0
#include "sheet/sweep.h"

#include "sheet/law_parameters.h"

enum { KEY_ETA0 = LAW_KEYS, KEY_BETA };

static void declare(const effect_values *own, sheet_plan *p) {
    p->law = LAW_ELASTOPLASTIC;
    law_declare(own, p);
    p->eta0 = own->value[KEY_ETA0][0];
    p->beta = own->value[KEY_BETA][0];
}

static void constants(const sheet_plan *p, const sheet_calibration *c, real law[LAW_CONSTANTS]) {
    law[ETA0] = (real)p->eta0;
    law[DECAY] = (real)(c->beta / p->eta0);
}

/* What unloading gives back. */
static double stored(const real law[LAW_CONSTANTS], const bond_state *b) {
    double eta0 = (double)law[ETA0], held = fmax(b->history, b->strain);
    double force = held > eta0 ? eta0 * exp(-(double)law[DECAY] * (held - eta0)) : held;
    force -= held - b->strain;
    return 0.5 * force * force;
}

static const parameter parameters[] = {
    LAW_PARAMETERS,
    [KEY_ETA0] = {.key = "eta0", .unit = "1", .doc = "stretch at which bonds yield", .minimum = 1e-9, .maximum = 10, .fallback = {1e-3},
                  .live = true, .logarithmic = true, .required = true},
    [KEY_BETA] = PARAMETER_PLAIN("beta", "1", "decay of the force beyond eta0; 0: from fracture.G and fracture.stretch", 0, 1e9, 0),
};

static const effect_field fields[] = {
    {"history", 1, "1", false, "the largest stretch that each bond has had"},
};

static const effect_measure measures[] = {
    {"elastic", "mass length^2/time^2", "energy stored in bonds"},
};

static const sheet_stages stages = {.declare = declare, .constants = constants, .bonds = sweep, .stored = stored};

const effect SHEET_EFFECT(elastoplastic) = {
    .name = "elastoplastic", .engine = ENGINE_SHEET, .scope = SCOPE_MATERIAL, .doc = "micro-springs that yield and soften",
    .reference = "sheet paper section 4.1; METHOD.md section 6", .parameters = parameters,
    .parameter_count = sizeof parameters / sizeof *parameters, .fields = fields, .field_count = 1, .measures = measures,
    .measure_count = 1, .provides = SHEET_ELASTICITY, .sheet = &stages,
};
