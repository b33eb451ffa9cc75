/* The solid engine's particles in the hands of a test: f64 fields of a live simulation, by id. */
#ifndef SUNDER_TESTS_SOLID_PARTICLES_H
#define SUNDER_TESTS_SOLID_PARTICLES_H

#ifndef SUNDER_PRECISION
#define SUNDER_PRECISION 64
#define SUNDER_SIMD 0
#endif
#include "base/memory.h"
#include "solid/state.h"
#include "verify/solid_scene.h"

/* A field of all particles in order of id, [count][components]; free with particles_drop. */
static inline double *particles_get(simulation *sim, const char *field) {
    solid *state;
    const solid_engine *engine = simulation_engine(sim, &state);
    double *out = memory_allocate((size_t)simulation_get_plan(sim)->particles * 9 * sizeof *out);
    engine->read(state, field, out);
    return out;
}

static inline void particles_drop(simulation *sim, double *values) {
    memory_free(values, (size_t)simulation_get_plan(sim)->particles * 9 * sizeof *values);
}

/* v += scale × kick(id) for every particle of an f64 simulation, where it lies. The next step carries it to the grid as it would carry
 * Δt b: with an affine transfer a particle's own velocity is used for nothing else. */
static inline void particles_kick(simulation *sim, double scale, const double *kick) {
    solid *state;
    simulation_engine(sim, &state);
    const solid_field *v = &state->fields[FIELD_VELOCITY];
    for (int32_t pack = 0; pack < state->pack_count; pack++)
        for (int lane = 0; lane < PACK; lane++) {
            int64_t id = state->id[pack * PACK + lane];
            for (int c = 0; id >= 0 && c < 3; c++) *(field_at(v, pack, c, 0) + lane) += scale * kick[3 * id + c];
        }
}

/* Slip walls that contain the whole scene take the motion along `axis` from every node: what is left is motion in a plane, or along a line. */
static inline void forbid_motion(scene *s, int axis) {
    double place[3] = {0, 0, 0}, normal[3] = {0, 0, 0};
    place[axis] = 1e3, normal[axis] = 1;
    s->colliders[s->collider_count++] =
        (scene_collider){.shape = shape_half_space(s->memory, place, normal), .stop = HUGE_VAL, .contact = CONTACT_SLIP};
}

#endif
