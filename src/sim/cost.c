/* What a run would cost. */
#include "sim/simulation.h"

#include <time.h>

bool simulation_concerns(const simulation_plan *plan, int e) {
    return plan->effects[e]->scope == SCOPE_SCENE || (plan->effects[e]->engine == ENGINE_SHEET ? plan->sheet : plan->solid);
}

status simulation_measure_cost(simulation *s, const scene *scene_data, double limit, simulation_cost *c, report *r) {
    enum { STEPS = 50 };
    const simulation_plan *plan = simulation_get_plan(s);
    struct timespec start, now;
    int steps = 0;
    clock_gettime(CLOCK_MONOTONIC, &start);
    double elapsed = 0;
    while (steps < STEPS && elapsed < limit) {
        status code = simulation_step(s, plan->dt, r);
        if (code != STATUS_OK) return code;
        steps++;
        clock_gettime(CLOCK_MONOTONIC, &now);
        elapsed = (double)(now.tv_sec - start.tv_sec) + 1e-9 * (double)(now.tv_nsec - start.tv_nsec);
    }
    c->seconds_per_step = elapsed / steps;
    c->steps = (double)scene_frames(scene_data) / scene_data->fps / plan->dt;
    c->seconds = c->steps * c->seconds_per_step;
    return STATUS_OK;
}
