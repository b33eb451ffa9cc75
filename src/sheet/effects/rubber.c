/* Rubber: f = 2 c_n (s − 1/s³) + c* n (s^{n−1} − 1) (sheet paper eq. 19; the constant f(1) is subtracted, so that Ψ vanishes at rest, and
 * c_n = (c − c* n (n − 1))/8 makes c the modulus at rest: METHOD.md §6, 5). */
#include "base/simd_math.h"
#include "sheet/state.h"

enum { TWO_CN, CS_N, POWER_LESS };

static inline __attribute__((always_inline)) vec bond_law(const real *law, vec s, vec q, vec held, vec *stiffening) {
    (void)held;
    vec inverse = 1 / s, inverse2 = inverse * inverse;
    vec force = law[TWO_CN] * (s - inverse * inverse2), slope = law[TWO_CN] * (1 + 3 * inverse2 * inverse2);
    if (law[CS_N] != 0) {
        vec power = vec_exp(law[POWER_LESS] * vec_log(vec_max(s, vec_all((real)1e-6))));
        force += law[CS_N] * (power - 1);
        slope += law[CS_N] * law[POWER_LESS] * power * inverse;
    }
    /* Across the bond its stiffness is f/s, along it f′: the smaller of s = 0.2 and up bounds the time step. */
    vec counted = vec_select(s > (real)0.2, slope, vec_all(1));
    *stiffening = vec_max(counted, *stiffening);
    (void)q;
    return force;
}

#define LAW_HOLDS 0
#define LAW_STIFFENS 1
#define LAW_RUBBERY 1
#include "sheet/sweep.h"

#include "sheet/law_parameters.h"

enum { KEY_C_STAR = LAW_KEYS, KEY_N };

static void declare(const effect_values *own, sheet_plan *p) {
    p->law = LAW_RUBBER;
    law_declare(own, p);
    p->c_star = own->value[KEY_C_STAR][0];
    p->power = own->value[KEY_N][0];
}

static void constants(const sheet_plan *p, const sheet_calibration *c, real law[LAW_CONSTANTS]) {
    double cs = p->c_star / c->stiffness;
    law[TWO_CN] = (real)(2 * (1 - cs * p->power * (p->power - 1)) / 8);
    law[CS_N] = (real)(cs * p->power);
    law[POWER_LESS] = (real)(p->power - 1);
}

static double stored(const real law[LAW_CONSTANTS], const bond_state *b) {
    double s = b->s, power = (double)law[POWER_LESS] + 1, cs = (double)law[CS_N] / power;
    return 0.5 * (double)law[TWO_CN] * (s * s + 1 / (s * s) - 2) + cs * (pow(s, power) - 1 - power * (s - 1)) - b->swelling * (s - 1);
}

static const parameter parameters[] = {
    LAW_PARAMETERS,
    [KEY_C_STAR] = PARAMETER_PLAIN("c_star", "mass/(length^3 time^2)", "weakening term, at most 0, in units of the bond's stiffness c", -1e18, 0, 0),
    [KEY_N] = PARAMETER_PLAIN("n", "1", "power of the weakening term", 1.01, 12, 2),
};

static const effect_measure measures[] = {
    {"elastic", "mass length^2/time^2", "energy stored in bonds"},
};

static const sheet_stages stages = {.declare = declare, .constants = constants, .bonds = sweep, .stored = stored};

const effect SHEET_EFFECT(rubber) = {
    .name = "rubber", .engine = ENGINE_SHEET, .scope = SCOPE_MATERIAL, .doc = "rubbery micro-springs",
    .reference = "sheet paper section 4.1; METHOD.md section 6", .parameters = parameters,
    .parameter_count = sizeof parameters / sizeof *parameters, .measures = measures, .measure_count = 1,
    .provides = SHEET_ELASTICITY, .sheet = &stages,
};
