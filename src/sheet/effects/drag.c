/* Drag: the air around a sheet pulls its particles towards the wind's velocity, by a force per area proportional to the difference. */
#include "sheet/state.h"

enum { KEY_COEFFICIENT, KEY_WIND };

static void declare(const effect_values *own, sheet_plan *p) {
    p->drag = own->value[KEY_COEFFICIENT][0];
    for (int c = 0; c < 3; c++) p->wind[c] = own->value[KEY_WIND][c];
}

/* Exact over a step for a constant wind: no step limit. */
static void velocity(const pack_work *w) {
    const body_constants *b = w->body;
    if (!(b->drag > 0)) return;
    real keep = (real)exp(-(double)b->drag * (double)w->dt);
    for (int c = 0; c < 3; c++) {
        real *v = w->state->velocity + ((int64_t)w->pack * 3 + c) * PACK;
        for (int i = 0; i < PACK; i++) v[i] = b->wind[c] + keep * (v[i] - b->wind[c]);
    }
}

static const parameter parameters[] = {
    [KEY_COEFFICIENT] = {.key = "coefficient", .unit = "mass/(length^2 time)", .doc = "force per area and speed", .minimum = 0, .maximum = 1e12,
                         .live = true, .logarithmic = true, .required = true, .short_form = "drag = 0.1"},
    [KEY_WIND] = {.key = "wind", .unit = "length/time", .doc = "velocity of the air", .kind = PARAMETER_VECTOR, .minimum = -1e9,
                  .maximum = 1e9, .live = true},
};

static const sheet_stages stages = {.declare = declare, .velocity = velocity};

const effect SHEET_EFFECT(drag) = {
    .name = "drag", .engine = ENGINE_SHEET, .scope = SCOPE_MATERIAL, .doc = "resistance of the air", .reference = "METHOD.md section 6",
    .parameters = parameters, .parameter_count = 2, .needs = SHEET_ELASTICITY, .sheet = &stages,
};
