#include "solid/moduli.h"

#include "solid/effects/list.h"

elastic_model solid_elastic_moduli(const effect_values *all, double *mu, double *lambda, double *lame_lambda) {
    bool corotated = all[EFFECT_corotated].on;
    const effect_values *own = &all[corotated ? EFFECT_corotated : EFFECT_elastic];
    if (!own->on) return ELASTIC_NONE;
    double E = own->value[ELASTIC_KEY_E][0], nu = own->value[ELASTIC_KEY_NU][0];
    *mu = E / (2 * (1 + nu));
    *lame_lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
    *lambda = *lame_lambda;
    if (corotated) return ELASTIC_COROTATED;
    /* Linearised, the closed form's energy is μ ε:ε + (λ − μ)/2 (tr ε)²: the extra μ makes (E, ν) mean what they say. */
    bool consistent = own->value[ELASTIC_KEY_LAME][0] == 0;
    if (consistent) *lambda += *mu;
    return ELASTIC_CLOSED_FORM;
}
