/* Inextensible fibres: the first fibre family keeps its length, whatever the load (AnisoMPM §6; METHOD.md §4). The solve is the
 * engine's (inextensible.c); here is what a material says of it. */
#include "solid/inextensible.h"
#include "solid/moduli.h"
#include "solid/tensor.h"

#include <math.h>

/* How many times faster than a wave of the matrix crosses a cell a stretch is taken back: at 8 a rope under 1000 times Fig. 21's load gives by
 * more than 0.1 %. */
static const double HASTE = 20;

enum { KEY_RELAXATION, KEY_TOLERANCE, KEY_SOLVER, KEY_WARM_START, KEY_COUNT };

static void declare(solid *s, int material, const effect_values *all) {
    const effect_values *own = &all[EFFECT_inextensible];
    s->constraint.on = true;
    s->constraint.material[material] = true;
    s->constraint.relaxation[material] = (real)own->value[KEY_RELAXATION][0];
    double mu = 0, lambda = 0, lame_lambda;
    solid_elastic_moduli(all, &mu, &lambda, &lame_lambda);
    s->constraint.recovery[material] = (real)(HASTE * sqrt((lambda + 2 * mu) / s->definition.materials[material].density) / s->definition.dx);
    s->constraint.solver = (int)own->value[KEY_SOLVER][0];
    s->constraint.warm = own->value[KEY_WARM_START][0] != 0;
    if (own->value[KEY_TOLERANCE][0] < s->constraint.tolerance) s->constraint.tolerance = own->value[KEY_TOLERANCE][0];
}

/* At the limit of stability a rope under 1000 times Fig. 21's load gives by 0.2 %; at half that step by 0.07 %. On the square of the waves' speed. */
#define MARGIN ((real)4)

/* A fibre under tension λ carries transverse waves at √(λ/ρ): fibres' directions move explicitly, so these limit the step. */
static void wave(tile_work *w) {
    const solid_field *own = &w->state->fields[w->state->fibre_wave_field];
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            real *modulus = scratch_at(w->scratch->wave_modulus, 1, k, 0, part);
            vec_store(modulus, vec_load(modulus) + MARGIN * vec_load(field_at(own, w->tile->first_pack + k, 0, part)));
        }
}

static const char *const solver_choices[] = {"auto", "jacobi", "direct", "amg", NULL};

static const parameter parameters[] = {
    [KEY_RELAXATION] = {.key = "relaxation", .unit = "length time^2/mass",
                        .doc = "stretching a step per tension that is let through: 0 holds hard, larger is softer", .maximum = 1e6,
                        .live = true, .logarithmic = true, .accuracy = {.kind = ACCURACY_FACTOR, .finer = 0.1}},
    [KEY_TOLERANCE] = {.key = "tolerance", .unit = "1", .doc = "stretching left over, by what it was before the solve", .minimum = 1e-12,
                       .maximum = 0.5, .fallback = {1e-4}, .live = true, .logarithmic = true, .accuracy = {.kind = ACCURACY_FACTOR, .finer = 0.1}},
    [KEY_SOLVER] = {.key = "solver", .unit = "1", .doc = "preconditioner of the conjugate gradients; auto: jacobi, and a better one when that is slow",
                    .kind = PARAMETER_CHOICE, .maximum = 3, .choices = solver_choices, .live = true},
    [KEY_WARM_START] = {.key = "warm_start", .unit = "1", .doc = "whether a solve starts from the last step's tension, or from none",
                        .kind = PARAMETER_BOOLEAN, .maximum = 1, .fallback = {1}, .live = true},
};

static const effect_field fields[] = {
    {.key = "fibre", .components = 3, .unit = "1", .written = true, .doc = "first fibre direction at rest, unit"},
    {.key = "fibre_tension", .components = 1, .unit = "mass/(length time^2)", .written = true, .doc = "stress along an inextensible fibre"},
    {.key = "fibre_wave", .components = 1, .unit = "mass/(length time^2)", .written = false,
     .doc = "density times the square of the speed of transverse waves along an inextensible fibre"},
};

static const solid_stages stages = {.declare = declare, .wave = wave, .constrain = constraint_solve};

const effect SOLID_EFFECT(inextensible) = {
    .name = "inextensible", .engine = ENGINE_SOLID, .scope = SCOPE_MATERIAL, .doc = "fibres that keep their length, by a solve on the grid",
    .reference = "AnisoMPM section 6; METHOD.md section 4", .parameters = parameters, .parameter_count = KEY_COUNT,
    .fields = fields, .field_count = 3, .stages = &stages,
};
