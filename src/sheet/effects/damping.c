/* Damping: velocities decay at a rate, so that a sheet comes to rest. */
#include "sheet/state.h"

static void declare(const effect_values *own, sheet_plan *p) {
    p->damping = own->value[0][0];
}

static void velocity(const pack_work *w) {
    if (!(w->body->damping > 0)) return;
    real keep = (real)exp(-(double)w->body->damping * (double)w->dt), *v = w->state->velocity + (int64_t)w->pack * 3 * PACK;
    for (int i = 0; i < 3 * PACK; i++) v[i] *= keep;
}

static const parameter parameters[] = {
    {.key = "rate", .unit = "1/time", .doc = "velocities fall by e in 1/rate", .minimum = 0, .maximum = 1e9, .live = true, .required = true,
     .short_form = "damping = 0.5"},
};

static const sheet_stages stages = {.declare = declare, .velocity = velocity};

const effect SHEET_EFFECT(damping) = {
    .name = "damping", .engine = ENGINE_SHEET, .scope = SCOPE_MATERIAL, .doc = "velocities decay", .reference = "METHOD.md section 6",
    .parameters = parameters, .parameter_count = 1, .needs = SHEET_ELASTICITY, .sheet = &stages,
};
