/* What a run would cost. */
#include "sim/simulation.h"

#include "base/clock.h"

bool simulation_concerns(const simulation_plan *plan, int e) {
    return plan->effects[e]->scope == SCOPE_SCENE || (plan->effects[e]->engine == ENGINE_SHEET ? plan->sheet : plan->solid);
}

status simulation_measure_cost(simulation *s, const scene *scene_data, double limit, simulation_cost *c, report *r) {
    enum { STEPS = 50 };
    const simulation_plan *plan = simulation_get_plan(s);
    int steps = 0;
    double start = clock_seconds(), elapsed = 0;
    while (steps < STEPS && elapsed < limit) {
        status code = simulation_step(s, plan->dt, r);
        if (code != STATUS_OK) return code;
        steps++;
        elapsed = clock_seconds() - start;
    }
    c->seconds_per_step = elapsed / steps;
    c->steps = (double)scene_frames(scene_data) / scene_data->fps / plan->dt;
    c->seconds = c->steps * c->seconds_per_step;
    return STATUS_OK;
}
