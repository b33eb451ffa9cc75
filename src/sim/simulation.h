/* A simulation: a scene's plan, its particles and engines, advanced frame by frame. It knows no script, file or screen. */
#ifndef SUNDER_SIM_SIMULATION_H
#define SUNDER_SIM_SIMULATION_H

#include "base/record.h"
#include "sim/knobs.h"
#include "sheet/sheet.h"
#include "solid/solid.h"

#include <stdatomic.h>

typedef struct simulation simulation;

typedef struct simulation_options {
    int threads;      /* 0: every processor */
    int precision;    /* 32 or 64 */
    const char *simd; /* "auto" or a name */
} simulation_options;

/* What the plan says of a scene, for `explain` and for the ledger. */
typedef struct plan_field {
    char name[48], effect[32];
    double bytes; /* a particle */
} plan_field;

typedef struct simulation_plan {
    int effect_count;
    const effect *const *effects; /* [effect_count], the catalogue */
    bool solid, sheet;            /* which kinds the scene has */
    uint32_t mask;                /* on */
    int field_count;
    plan_field fields[16];
    double bytes_per_particle; /* grid and sort buffers included */
    double limits[EFFECT_LIMIT]; /* Δt, HUGE_VAL: none; from the initial state, cfl included */
    double dt;                   /* the first step's */
    double dx, spacing;
    int64_t particles, sheet_particles; /* all, and those of sheets, which come last */
    int64_t tetrahedra; /* of which `particles` are the vertices; 0: material points */
    int threads, precision;
    const char *simd;
} simulation_plan;

typedef struct simulation_measures {
    solid_measures solid; /* of sheets: what they have in common with solids, bonds standing for damage */
    bool has_sheet;
    sheet_measures sheet;
    double dissipated;   /* energy that has left the balance since the start */
    bool has_crack;      /* some damage is above 0.5 */
    double crack_normal[3];
    double dt_min, dt_max, time;
    int64_t frame, steps;
} simulation_measures;

/* Samples the bodies, makes the plan and the engines. Errors: wrong input (found late), memory, a processor without `simd`. */
status simulation_create(const scene *s, const simulation_options *options, simulation **out, report *r);
void simulation_destroy(simulation *s);

const simulation_plan *simulation_get_plan(const simulation *s);

/* The knobs of the scene as they stand, as scene_knobs does. */
int simulation_knobs(const simulation *s, knob *out, int limit);

/* Turns a knob between two frames: it acts on the steps from here on. Errors as scene_turn, and memory; after an error all is as it was. */
status simulation_turn(simulation *s, const char *path, const double value[3], report *r);

status simulation_turn_text(simulation *s, const char *path, const char *value, report *r);

/* All of these, whatever their frames, and the engines see the outcome alone: for a state that is about to be restored. */
status simulation_replay_turns(simulation *s, const knob_turn *turns, int count, report *r);

/* The scene's values as they stand into a copy of it (scene_copy). */
void simulation_copy_values(const simulation *s, scene *to);

/* What runs within a step, in order; returns how many names were written. */
int simulation_stages(const simulation_plan *plan, char (*text)[48], int limit);

/* Whether an effect could be on in this scene: those of the other engine could not, but for the scene's own. */
bool simulation_concerns(const simulation_plan *plan, int e);

/* What a run would cost: measured on a few steps of this very plan (at most `limit` seconds of them), then scaled to the scene's frames at its first
 * step length. The simulation has moved on afterwards. */
typedef struct simulation_cost {
    double seconds_per_step, steps, seconds;
} simulation_cost;
status simulation_measure_cost(simulation *s, const scene *scene_data, double limit, simulation_cost *c, report *r);

/* Advances by one frame. `abandon` (may be NULL) is looked at between steps: STATUS_INTERRUPTED leaves a state between frames that must
 * not be written. STATUS_DIVERGED says effect, particle and step. */
status simulation_advance(simulation *s, const atomic_int *abandon, report *r);

/* One step of length dt, or of the automatic length when dt is 0; for tests and benchmarks. */
status simulation_step(simulation *s, double dt, report *r);

int64_t simulation_frame(const simulation *s);
double simulation_time(const simulation *s);
int64_t simulation_steps(const simulation *s);

/* Measures of the state at a frame's end. Errors: out of memory. */
status simulation_measure(simulation *s, simulation_measures *m, report *r);

/* A frame's arrays in order of id: "solid/position" …, "sheet/position" … in the run's precision; in frame 0 the sheet's bonds too. The caller
 * clears the list. */
status simulation_frame_records(const simulation *s, record_list *list, report *r);

/* Everything needed to go on with the same bits, and back. */
status simulation_save(const simulation *s, record_list *list, report *r);
status simulation_restore(simulation *s, const record_list *list, report *r);

/* A hash of (x, v, F, d) of all particles in order of id. Errors: out of memory. */
status simulation_hash(const simulation *s, uint64_t *hash, report *r);

/* The last warning about the time step, "" when there is none; cleared by the call. */
const char *simulation_take_warning(simulation *s);

/* Which body each particle belongs to, [particles] by id, sheets after solids; owned by the simulation. */
const uint8_t *simulation_bodies(const simulation *s);

/* Copies a field in order of id, as the engines' `read`, solids before sheets; where one kind has no such field it is 0 (but broken bonds stand for
 * damage). out NULL: components alone. 0 when there is no such field. */
int simulation_read(const simulation *s, const char *field, double *out);

/* One number a particle, for pictures: fields with one component, and what is derived from others (speed, displacement, body; of solids
 * stretch, determinant, stress, fibre_stretch). Lists those that this simulation has, the one that pictures show unasked first; returns how
 * many. */
typedef struct simulation_scalar {
    char name[32], unit[48], doc[96];
    bool share; /* from 0 to 1 by its nature */
} simulation_scalar;
int simulation_scalars(const simulation *s, simulation_scalar *out, int limit);

/* Fills out[particles] by id. Errors: no such scalar (with the nearest), memory. */
status simulation_read_scalar(const simulation *s, const char *name, double *out, report *r);

/* Seconds of steps since the start: the engine's phases in order, each followed by what effects have in it where that is known. Returns how many. */
typedef struct simulation_effort {
    char name[48];
    double seconds;
    bool part; /* an effect's part of the phase before it */
} simulation_effort;
int simulation_efforts(const simulation *s, simulation_effort *out, int limit);

/* The field that pictures colour by: damage, the diffused quantity, or broken bonds. */
const char *simulation_picture_field(const simulation *s);

/* The sheet engine and its state, or NULL where there are no sheets. */
const sheet_engine *simulation_sheet_engine(const simulation *s, sheet **state);

/* The solid engine and its state, for benchmarks and tests. */
const solid_engine *simulation_engine(const simulation *s, solid **state);

#endif
