/* What a material asks of the engine: effects fill it from their values, in f64, compiled once. Calibration turns it into numbers of
 * each bond. */
#ifndef SUNDER_SHEET_PLAN_H
#define SUNDER_SHEET_PLAN_H

#include "effect/effect.h"

typedef enum sheet_law { LAW_LINEAR, LAW_RUBBER, LAW_ELASTOPLASTIC } sheet_law;

/* Weights of bonds by length (METHOD.md §6, 3). isotropic: 1 at eight neighbours, else the smallest change of 1 − r/R that makes the
 * lattice isotropic; paper: 1 − r/R; constant: 1. */
typedef enum sheet_weight { WEIGHT_ISOTROPIC, WEIGHT_PAPER, WEIGHT_CONSTANT } sheet_weight;

/* Parameters that the laws share come first in each. */
enum { LAW_KEY_E, LAW_KEY_WEIGHT, LAW_KEY_CALIBRATION, LAW_KEY_NU, LAW_KEY_POISSON, LAW_KEYS };

typedef struct sheet_plan {
    sheet_law law;
    sheet_weight weight;
    bool paper;     /* the paper's own constants */
    double E, nu;   /* nu as the scene says it */
    bool state;     /* the state-based form: a Poisson ratio other than 1/3 */
    double c_star, power;   /* rubber */
    double eta0, beta;      /* elastoplastic; beta 0: from toughness and critical stretch */
    bool fractures, total, untrapped;
    double toughness, stretch; /* 0: not given */
    bool diffuses;
    double conductivity, capacity, decay, initial;
    double alpha;
    double stiffness_loss, toughness_loss, stretch_loss, floor;
    bool toughness_softens;
    double grain_stiffness, grain_toughness; /* 1: none */
    double bending, damping, drag, wind[3];
    double contact_distance, contact_stiffness; /* in spacings, in units of E h; 0: none */
    bool multirate;
    int levels, cracking, heated; /* how often a step is halved at most; and once more where bonds break, where θ acts */
} sheet_plan;

#define PARAMETER_PLAIN(key_, unit_, doc_, least, most, value)                                                         \
    {.key = key_, .unit = unit_, .doc = doc_, .minimum = least, .maximum = most, .fallback = {value}, .live = true}

#endif
