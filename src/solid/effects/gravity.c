/* Gravity: a constant acceleration on every grid node. */
#include "solid/state.h"

static void add_gravity(const grid_work *w) {
    const double *g = w->state->definition.gravity;
    real step[3] = {(real)g[0] * w->dt, (real)g[1] * w->dt, (real)g[2] * w->dt};
    for (int node = 0; node < BLOCK_NODES; node++) {
        real *n = w->nodes + node * NODE;
        for (int c = 0; c < 3; c++) n[c] += n[3] > 0 ? step[c] : 0;
    }
}

static const parameter parameters[] = {
    {.key = "acceleration", .unit = "length/time^2", .doc = "acceleration of everything", .kind = PARAMETER_VECTOR,
     .minimum = -1e9, .maximum = 1e9, .live = true, .short_form = "gravity = {0, -9.8, 0}"},
};

static const solid_stages stages = {.grid = add_gravity};

const effect SOLID_EFFECT(gravity) = {
    .name = "gravity", .engine = ENGINE_SOLID, .scope = SCOPE_SCENE, .doc = "constant acceleration",
    .reference = "METHOD.md section 3", .parameters = parameters, .parameter_count = 1, .stages = &stages,
};
