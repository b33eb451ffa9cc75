/* A material's elastic model and its moduli, whichever effect it is chosen by: what damage, fibres and plasticity read. No
 * reals here: compiled once. */
#ifndef SUNDER_SOLID_MODULI_H
#define SUNDER_SOLID_MODULI_H

#include "effect/effect.h"

/* The `provides` of the effects that are elastic models, and the `needs` of those that build on one. */
#define ELASTICITY "elasticity"

typedef enum elastic_model {
    ELASTIC_NONE,
    ELASTIC_CLOSED_FORM, /* effect `elastic`:   τ = μ b + (λ (J − 1) − μ) J I */
    ELASTIC_COROTATED,   /* effect `corotated`: τ = 2μ (b − √b) + λ (J − 1) J I */
} elastic_model;

/* Parameters that the models share come first in each. */
enum { ELASTIC_KEY_E, ELASTIC_KEY_NU, ELASTIC_KEY_LAME };

/* `all` has shape [effect count]. mu and lambda are the coefficients of the model's own energy; lame_lambda is Eν/((1+ν)(1−2ν)) whatever
 * the model. Nothing is written when the material has no elasticity. */
elastic_model solid_elastic_moduli(const effect_values *all, double *mu, double *lambda, double *lame_lambda);

#endif
