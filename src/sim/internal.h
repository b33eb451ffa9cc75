/* What the files of this floor share. */
#ifndef SUNDER_SIM_INTERNAL_H
#define SUNDER_SIM_INTERNAL_H

#include "sim/bodies.h"
#include "sim/simulation.h"

struct simulation {
    const scene *scene;
    const solid_engine *engine;
    solid *solid;
    body_particles particles; /* rest positions and bodies stay for measures; the rest is freed after loading */
    solid_material materials[SOLID_MATERIALS];
    simulation_plan plan;
    double frame_time, dt_min, dt_max;
    int64_t frame, steps, step_in_frame;
    double time;
    double initial_energy;
    bool has_initial_energy;
    bool warned_fixed, warned_damage;
    char warning[256];
};

#endif
