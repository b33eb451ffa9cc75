/* What the files of this floor share. */
#ifndef SUNDER_SIM_INTERNAL_H
#define SUNDER_SIM_INTERNAL_H

#include "sim/bodies.h"
#include "sim/sheets.h"
#include "sim/simulation.h"

/* A scene has solids, sheets, or both; particles of both are numbered solids first. */
struct simulation {
    const scene *start; /* as it was given */
    scene *scene;       /* a copy of it, in which knobs are turned; engines borrow its values */
    const solid_engine *engine;
    solid *solid; /* NULL in a scene of sheets alone */
    const sheet_engine *sheets;
    sheet *sheet; /* or NULL */
    sheet_particles sheet_points; /* stay: the engine borrows rest places and sources */
    struct sheet_contact *contact; /* NULL unless the scene has both kinds and says so */
    double contact_seconds;        /* since the start */
    int64_t count;
    uint8_t *bodies; // [count] where a scene has both, else NULL: those of the one kind
    body_particles particles; /* rest positions and bodies stay for measures; the rest is freed after loading */
    solid_material materials[SOLID_MATERIALS];
    simulation_plan plan;
    double frame_time, dt_min, dt_max;
    int64_t frame, steps;
    double time;
    double initial_energy;
    bool has_initial_energy;
    bool warned_fixed, warned_damage, warned_cfl;
    char warning[256];
};

/* engines.c: both engines behind one face */
rigid_boundary *engine_boundaries(const simulation *s);
/* By index in the catalogue, the scene's cfl included. */
void engine_limits(const simulation *s, double limit[EFFECT_LIMIT]);
/* The step in which a grip or collider of that speed moves material less than a cell. */
double engine_boundary_limit(const simulation *s, double speed);
status engine_step(simulation *s, double dt, report *r);
status engine_begin_frame(simulation *s, report *r);
status engine_end_frame(simulation *s, report *r);
double engine_bytes(const simulation *s);
/* Reads a field of one kind alone, as simulation_read. */
int engine_read(const simulation *s, engine_kind kind, const char *field, double *out);
status engine_save(const simulation *s, record_list *list, report *r);
status engine_restore(simulation *s, const record_list *list, report *r);
status engine_measure(const simulation *s, simulation_measures *m, report *r);
int64_t engine_count(const simulation *s, engine_kind kind);
/* Knobs were turned: the engines see the scene's values again. Between frames. Errors: memory; values that a sheet's bonds cannot have. */
status engine_refresh(simulation *s, report *r);
/* How sources of one kind are turned up or down, by the index of the engine's; returns how many. */
int engine_feeds(const scene *s, engine_kind kind, source_feed out[SOLID_SOURCES]);
int engine_define_boundaries(const scene *s, rigid_boundary *out);
/* From sampled sheets; sets the plan's mask. */
status engine_create_sheet(simulation *s, int threads, report *r);

#endif
