/* Damping: everything loses speed at one rate, rigid motion too. v̇ = … − rate v, exact over a step: v ← v e^(−rate Δt). */
#include "solid/state.h"

#include <math.h>

static void slow_down(const grid_work *w) {
    real keep = (real)exp(-(double)w->dt * w->state->definition.damping);
    for (int node = 0; node < BLOCK_NODES; node++)
        for (int c = 0; c < 3; c++) w->nodes[node * NODE + c] *= keep;
}

static const parameter parameters[] = {
    {.key = "rate", .unit = "1/time", .doc = "share of its speed that everything loses in a unit of time, while that is small", .maximum = 1e9,
     .live = true, .short_form = "mass_damping = 0.5", .required = true},
};

static const solid_stages stages = {.grid = slow_down};

const effect SOLID_EFFECT(mass_damping) = {
    .name = "mass_damping", .engine = ENGINE_SOLID, .scope = SCOPE_SCENE, .doc = "drag on all motion, for scenes that are to come to rest",
    .reference = "METHOD.md section 3", .parameters = parameters, .parameter_count = 1, .stages = &stages,
};
