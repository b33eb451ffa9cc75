/* The sheet engine as the floors above see it: one table of functions a precision and instruction set.
 *
 * A sheet is one layer of particles joined by micro-springs, with a quantity that diffuses through it (Han, Xue, Aanjaneya; METHOD.md
 * §6). The engine knows particles, bonds, materials, sources and rigid boundaries. It knows no Lua, no file, no terminal and no database.
 * All quantities are in scene units; arrays handed in and out are f64 and in order of particle id. */
#ifndef SUNDER_SHEET_SHEET_H
#define SUNDER_SHEET_SHEET_H

#include "base/record.h"
#include "effect/effect.h"
#include "effect/kinds.h"
#include "geom/rigid.h"

#include <stdint.h>

enum { SHEET_MATERIALS = 16, SHEET_BODIES = 32, SHEET_BOUNDARIES = 64, SHEET_SOURCES = 64, SHEET_NOTCHES = 64, SHEET_BINS = 50 };
/* A step is divided by 2^l, l < SHEET_LEVELS, where the effect multirate asks for it. */
enum { SHEET_LEVELS = 8 };
enum { SHEET_PACK = 16 }; /* neighbours that are stored together */
enum { SHEET_PHASE_BONDS, SHEET_PHASE_DIFFUSION, SHEET_PHASE_CONTACT, SHEET_PHASE_ADVANCE, SHEET_PHASES };

/* The `provides` of the effects that are laws of a bond, and the `needs` of those that build on one. */
#define SHEET_ELASTICITY "sheet elasticity"

/* How the particles of a body lie; it chooses bond weights and the correction for lattice trapping. */
typedef enum sheet_lattice { SHEET_SQUARE, SHEET_HEXAGONAL, SHEET_SCATTERED } sheet_lattice;

typedef struct sheet_material {
    double density;
    const effect_values *effects; /* by index in the engine's effect list; borrowed for the engine's life */
} sheet_material;

/* One sheet: a run of particles. Bonds join particles of one body only. */
typedef struct sheet_body {
    int64_t first, count;
    int material;
    sheet_lattice lattice;
    double thickness, spacing;
    double radius; /* bonds reach this many spacings */
} sheet_body;

/* A cut made before the start: bonds that it crosses are broken. Either a shape, or the straight line from … to, seen along `normal`. */
typedef struct sheet_notch {
    int body; /* −1: all */
    const shape *shape; /* or NULL */
    double from[3], to[3], normal[3];
} sheet_notch;

/* Feeds the diffused quantity: adds `value` a unit of time, or holds it at `value`, while start ≤ t < stop. */
typedef struct sheet_source {
    int64_t count;
    const int32_t *particle; // [count], ids
    const double *value;     // [count], quantity/time (a rate of θ itself) or quantity
    bool fixed;
    double start, stop;
} sheet_source;

typedef struct sheet_definition {
    int threads;
    double gravity[3];
    double cfl; /* share of its own limit that each pack of particles may step by, where steps are divided; 0: all of it */
    uint32_t effect_mask; /* effects that any body uses, by index in the effect list */
    int material_count, body_count, boundary_count, notch_count, source_count;
    sheet_material materials[SHEET_MATERIALS];
    sheet_body bodies[SHEET_BODIES];
    rigid_boundary boundaries[SHEET_BOUNDARIES];
    sheet_notch notches[SHEET_NOTCHES];
    sheet_source sources[SHEET_SOURCES]; /* arrays are borrowed for the engine's life */
    const source_feed *feeds;          /* [source_count]; NULL: all as they are */
    int64_t count;
    const double *rest;               /* [count][3] */
    const double *position;           /* [count][3] at the start; NULL: rest */
    const double *velocity;           /* [count][3]; NULL: at rest */
    const double *area;               /* [count], rest areas */
    const double *grain;              /* [count][3], unit; NULL when no effect needs them */
    const double *diffused;           /* [count] at the start; NULL: 0 */
    const uint8_t *protected;         /* [count], 1: bonds of this particle never break; NULL: none */
} sheet_definition;

typedef struct sheet_measures {
    double mass, momentum[3], angular_momentum[3];
    double kinetic, elastic, gravitational;
    double grip_work, grip_impulse[3]; /* put in by boundaries since the start */
    int64_t bonds_total, bonds_broken; /* each bond counted once */
    double broken_mean, broken_max;    /* of each particle's fraction of broken bonds */
    double histogram[SHEET_BINS];      /* fraction of particles by that, in equal bins over [0,1] */
    double diffused_total;             /* Σ ρ C A h θ */
    double diffused_min, diffused_max, stretch_max, speed_max;
} sheet_measures;

/* What the constants of a body came out as: for `explain`, tests and messages. */
typedef struct sheet_calibration {
    double weight_sum;       /* Σ W A inside */
    double stiffness;        /* c of an interior bond */
    double critical_stretch; /* η_c, trapping included; HUGE_VAL: does not break */
    double trapping;         /* what η_c was divided by */
    double toughness;        /* the G that it stands for */
    double beta;             /* decay of the elastoplastic law; 0 for others */
    int neighbours;          /* of an interior particle, with weight > 0 */
} sheet_calibration;

/* How the last step was divided, and what it has cost. */
typedef struct sheet_rates {
    int levels;                       /* 1: one step for all */
    int64_t particles[SHEET_LEVELS];  /* that take steps of 2^−l */
    int64_t bond_updates;             /* evaluations of a bond's force since the engine was made, bonds counted from both ends */
} sheet_rates;

typedef struct sheet sheet;

/* What stopped a step. */
typedef struct sheet_fault {
    int64_t particle;
    const char *quantity;
    double value;
} sheet_fault;

/* How contact reaches the particles that touch something: by pack of SHEET_PACK neighbours. All are called between a step and the next, of different packs
 * by several threads at once. */
typedef struct sheet_touch {
    int32_t (*packs)(const sheet *s);
    /* How many particles a pack has, where they are, and their ids. */
    int (*places)(const sheet *s, int32_t pack, double place[SHEET_PACK][3], int32_t id[SHEET_PACK]);
    void (*motion)(const sheet *s, int32_t pack, double velocity[SHEET_PACK][3], bool held[SHEET_PACK]); /* held: by a grip */
    void (*push)(sheet *s, int32_t pack, const double change[SHEET_PACK][3]); /* adds to velocities */
} sheet_touch;

typedef struct sheet_engine {
    const char *simd;
    int precision;
    const effect *const *effects;
    int effect_count;
    /* Builds bonds and calibrates. NULL with a report: memory, or values that do not go together. */
    sheet *(*create)(const sheet_definition *definition, report *r);
    void (*destroy)(sheet *s);
    /* The boundaries' motions may be written between steps. */
    rigid_boundary *(*boundaries)(sheet *s);
    /* Largest Δt of each effect from the current state into limit[effect_count] (HUGE_VAL: none), without any safety factor. */
    void (*limits)(const sheet *s, double *limit);
    /* One step of symplectic Euler from `time`. STATUS_DIVERGED when the new state is not finite or runs away; `fault` says where. */
    status (*step)(sheet *s, double time, double dt, sheet_fault *fault, report *r);
    const sheet_touch *touch;
    /* Diffusion runs every n-th step: this brings it to `time`, as a frame must have it. */
    void (*settle)(sheet *s, double time);
    status (*measure)(const sheet *s, sheet_measures *m, report *r); /* errors: out of memory */
    /* Copies a field in order of id into out[count][components]: "position", "velocity", "area", "broken" (fraction
     * of bonds), "diffused". Returns components, 0 when there is no such field. */
    int (*read)(const sheet *s, const char *field, double *out);
    int (*components)(const sheet *s, const char *field);
    /* Bonds, each once: pairs [n][2] of ids, smaller first, in ascending order, and whether each is broken. Either may be NULL. Returns n. */
    int64_t (*bonds)(const sheet *s, int32_t *pairs, uint8_t *broken);
    sheet_calibration (*calibration)(const sheet *s, int body);
    /* The whole state, bit for bit. `restore` needs a sheet created from the same definition. */
    status (*save)(const sheet *s, record_list *list, report *r);
    status (*restore)(sheet *s, const record_list *list, report *r);
    /* Lists what runs within a step for effects in `mask`, in order. Returns how many; text has room for `limit` names. */
    int (*stages)(uint32_t mask, char (*text)[48], int limit);
    void (*feed)(sheet *s, const source_feed *feeds);      /* [source_count], between steps */
    void (*surround)(sheet *s, const double gravity[3], double cfl); /* the definition's, anew; between steps */
    /* A knob was turned: values in the definition's materials changed. Between frames. Histories keep their values. */
    status (*refresh)(sheet *s, report *r);
    double (*bytes_per_particle)(const sheet *s);
    void (*rates)(const sheet *s, sheet_rates *out);
    /* The level of each particle in the last step, in order of id: out[count]. */
    void (*levels)(const sheet *s, uint8_t *out);
    void (*phases)(const sheet *s, double seconds[SHEET_PHASES]);
} sheet_engine;

/* The engine for a precision (32, 64) and instruction set ("auto": the best that this processor has; "plain", "avx2",
 * "avx512"). NULL when this processor or build lacks it. */
const sheet_engine *sheet_engine_find(int precision, const char *simd);

#endif
