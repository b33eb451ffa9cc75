/* What the laws' tables share: moduli, weights, calibration, Poisson's ratio. */
#ifndef SUNDER_SHEET_LAW_PARAMETERS_H
#define SUNDER_SHEET_LAW_PARAMETERS_H

#include "sheet/plan.h"

#include <math.h>

static const char *const law_weights[] = {"isotropic", "paper", "constant", NULL};
static const char *const law_calibrations[] = {"lattice", "paper", NULL};
static const char *const law_poissons[] = {"state", "bond", NULL};

#define LAW_PARAMETERS                                                                                                  \
    [LAW_KEY_E] = {.key = "E", .unit = "mass/(length time^2)", .doc = "Young's modulus", .minimum = 1e-12, .maximum = 1e18, \
                   .fallback = {1e4}, .live = true, .logarithmic = true, .required = true},                             \
    [LAW_KEY_WEIGHT] = {.key = "weight", .unit = "1", .kind = PARAMETER_CHOICE, .maximum = 2, .choices = law_weights,   \
                        .doc = "bonds by length: isotropic on the lattice; paper: 1 - r/R; constant: 1",                \
                        .why_not = "bonds are made with it"},                                                           \
    [LAW_KEY_CALIBRATION] = {.key = "calibration", .unit = "1", .kind = PARAMETER_CHOICE, .maximum = 1, .choices = law_calibrations, \
                             .doc = "lattice: E is the sheet's modulus; paper: the paper's own constants",              \
                             .why_not = "bonds are made with it"},                                                      \
    [LAW_KEY_NU] = {.key = "nu", .unit = "1", .doc = "Poisson's ratio in the plane", .minimum = -0.5, .maximum = 0.9,   \
                    .fallback = {1.0 / 3}, .live = true},                                                               \
    [LAW_KEY_POISSON] = {.key = "poisson", .unit = "1", .kind = PARAMETER_CHOICE, .maximum = 1, .choices = law_poissons, \
                         .doc = "state: nu holds; bond: the ratio of bonds alone, 1/3, whatever nu says",               \
                         .why_not = "bonds are made with it"}

static inline void law_declare(const effect_values *own, sheet_plan *p) {
    p->E = own->value[LAW_KEY_E][0];
    p->weight = (sheet_weight)own->value[LAW_KEY_WEIGHT][0];
    p->paper = own->value[LAW_KEY_CALIBRATION][0] != 0;
    p->nu = own->value[LAW_KEY_NU][0];
    bool free_ratio = fabs(p->nu - 1.0 / 3) > 1e-9 && own->value[LAW_KEY_POISSON][0] == 0;
    p->state = free_ratio && !p->paper && p->law != LAW_RUBBER;
}

#endif
