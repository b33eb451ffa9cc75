/* The solid engine, AnisoMPM, as the floors above see it: one table of functions a precision and instruction set.
 *
 * The engine knows particles, a sparse block grid, materials and rigid boundaries. It knows no Lua, no file, no terminal and no
 * database. All quantities are in scene units; arrays handed in and out are f64 and in order of particle id. */
#ifndef SUNDER_SOLID_SOLID_H
#define SUNDER_SOLID_SOLID_H

#include "base/record.h"
#include "effect/effect.h"
#include "effect/kinds.h"
#include "geom/rigid.h"

#include <stdatomic.h>
#include <stdint.h>

enum { SOLID_MATERIALS = 32, SOLID_BOUNDARIES = 64, SOLID_BINS = 50, SOLID_PHASES = 4, SOLID_GIVEN = 8, SOLID_SOURCES = 64 };

typedef struct solid_material {
    double density;
    const effect_values *effects; /* by index in the engine's effect list; borrowed for the engine's life */
    bool protects;                /* particles of this material are never damaged (they were gripped at the start) */
} solid_material;

typedef rigid_boundary solid_boundary;

/* Values of an optional field, at the start and for good. */
typedef struct solid_given {
    const char *field;
    const double *value; /* [count] */
} solid_given;

/* Feeds what diffuses: adds `value` a unit of time, or holds it at `value`, while start ≤ t < stop. */
typedef struct solid_source {
    int64_t first, count; /* ids that it may reach */
    const double *value;  // [count], quantity/time (a rate of θ itself) or quantity; NaN: nothing
    bool fixed;
    double start, stop;
} solid_source;

typedef struct solid_definition {
    int threads;
    double dx;
    transfer_kind transfer;
    double transfer_ratio;
    kernel_kind kernel, laplacian;
    double gravity[3];
    double damping; /* 1/time */
    uint32_t effect_mask; /* effects that any body uses, by index in the effect list */
    int material_count, boundary_count;
    solid_material materials[SOLID_MATERIALS];
    solid_boundary boundaries[SOLID_BOUNDARIES];
    int64_t count;
    const double *position, *velocity; /* [count][3] */
    const double *volume;              /* [count], rest volume */
    const double *fibre1, *fibre2;     /* [count][3], unit and orthogonal; NULL when no effect needs them */
    const double *damage;              /* [count], at the start, 0 to 1; NULL: whole */
    int given_count;
    solid_given given[SOLID_GIVEN];    /* fields by which a material's parameters are scaled; "density_scale" its density */
    const uint8_t *material;           /* [count] */
    int source_count;
    solid_source sources[SOLID_SOURCES]; /* arrays are borrowed for the engine's life */
    const source_feed *feeds;          /* [source_count]; NULL: all as they are */
    /* A body of tetrahedra: particles are its vertices, `position` their places at rest. Fibres and
     * `material` are the elements'; `volume` is not read. */
    int64_t element_count;         /* 0: material points */
    const int32_t *corner;         /* [element_count][4], right-handed: (x1 − x0) × (x2 − x0) · (x3 − x0) > 0 */
    const double *start;           /* [count][3], places at time 0 */
} solid_definition;

typedef struct solid_measures {
    double mass, momentum[3], angular_momentum[3]; /* angular momentum with the particles' affine part */
    double kinetic, elastic, fibre, gravitational;
    double grip_work, grip_impulse[3]; /* put in by boundaries since the start */
    double damage_mean, damage_max, broken_fraction; /* broken: d > 0.9, of all particles */
    double histogram[SOLID_BINS];                    /* fraction of particles by damage */
    double diffused_total;                           /* Σ ρ C V θ */
    double determinant_min, determinant_max, speed_max;
    double stretch_min, stretch_max; /* |F a1| of the first fibre family; 1 where there is none */
    int64_t constraint_solves, constraint_iterations, constraint_factorisations; /* of inextensible fibres, since the start */
    double constraint_seconds; /* in them, since the start; not part of the state */
} solid_measures;

typedef struct solid solid;

/* What stopped a step: filled by `check`. */
typedef struct solid_fault {
    int64_t particle;
    const char *effect, *quantity;
    double value;
} solid_fault;

/* How contact reaches the particles that touch something: by block, which is by place. All are called between a step and the next, and those that take
 * a const state by several threads at once. `at` is where a particle lies until then. */
typedef struct solid_touch {
    /* How many blocks there are, and a box that holds all particles. */
    int32_t (*blocks)(const solid *s, double low[3], double high[3]);
    /* Sets marks[block] of those with particles in a box, and perhaps of some that come near it; whether there are any. */
    bool (*mark)(const solid *s, const double low[3], const double high[3], _Atomic uint8_t *marks);
    int32_t (*population)(const solid *s, int32_t block);
    /* A block's particles, in order of storage: place[population][3], at[population], id[population]. */
    void (*places)(const solid *s, int32_t block, double *place, int32_t *at, int32_t *id);
    /* Velocity and affine velocity of one particle, 3 + 9; `move` sets them, and of different particles may be called at once. */
    void (*motion)(const solid *s, int32_t at, double motion[12]);
    void (*move)(solid *s, int32_t at, const double motion[12]);
} solid_touch;

typedef struct solid_engine {
    const char *simd;
    int precision;
    const effect *const *effects;
    int effect_count;
    /* Creates the engine's state; NULL with a report when memory is out or an effect rejects its values. */
    solid *(*create)(const solid_definition *definition, report *r);
    void (*destroy)(solid *s);
    /* The boundaries' motions may be written between steps. */
    solid_boundary *(*boundaries)(solid *s);
    /* Largest Δt of each effect from the current state into limit[effect_count] (HUGE_VAL: none); momentum's, without the cfl
     * factor, is that of effect "elastic". */
    void (*limits)(const solid *s, double *limit);
    /* Puts particles in canonical order and drops what was kept from step to step only to save work. Called by the simulation at the start of every
     * frame (so a resumed run finds the same); `step` sorts by itself when a particle leaves its block's margin. Errors: out of memory. */
    status (*sort)(solid *s, report *r);
    /* One step of symplectic Euler. STATUS_DIVERGED when the new state is not finite or runs away; `fault` says where. */
    status (*step)(solid *s, double dt, solid_fault *fault, report *r);
    const solid_touch *touch; /* NULL: it has no particles with affine velocities */
    /* Diffusion runs every n-th step: this brings it to `time`, as a frame must have it. NULL where nothing diffuses ever. Errors: out of memory. */
    status (*settle)(solid *s, double time, report *r);
    void (*feed)(solid *s, const source_feed *feeds); /* [source_count], between steps; NULL likewise */
    status (*measure)(const solid *s, solid_measures *m, report *r); /* errors: out of memory */
    /* Copies a field in order of id into out[count][components]: "position", "velocity", "deformation_gradient", "affine_velocity", "volume", "kirchhoff_stress"
     * (of the effects' stress stages: xx yy zz xy yz xz; particles only), or a field of an effect that is on. Returns components, 0 when there is no such field. */
    int (*read)(const solid *s, const char *field, double *out);
    /* Components of such a field, 0 when there is none. */
    int (*components)(const solid *s, const char *field);
    /* The whole state, bit for bit. `restore` needs a solid created from the same definition. */
    status (*save)(const solid *s, record_list *list, report *r);
    status (*restore)(solid *s, const record_list *list, report *r);
    /* Lists what runs within a step for effects in `mask`, in order: "p2g", "damage.degrade", … Returns how many; text has room for
     * `limit` names. */
    int (*stages)(uint32_t mask, char (*text)[48], int limit);
    /* Whether this engine can run an effect of its list. */
    bool (*knows)(const effect *e);
    /* What acts on everything: gravity, and the share of speed lost in a unit of time. Between steps. */
    void (*surround)(solid *s, const double gravity[3], double damping);
    /* A knob was turned: values in the definition's materials changed. Between frames. */
    void (*refresh)(solid *s);
    /* Bytes a particle; seconds of steps since the start, by phase; and how much of each phase is which effect's (NULL: not known). */
    double (*bytes_per_particle)(const solid *s);
    const char *phase_names[SOLID_PHASES]; /* NULL: no such phase */
    void (*phases)(const solid *s, double seconds[SOLID_PHASES]);
    void (*effort)(const solid *s, double seconds[SOLID_PHASES][EFFECT_LIMIT]);
} solid_engine;

/* The engine for a precision (32, 64) and instruction set ("auto": the best that this processor has; "plain", "avx2",
 * "avx512"). NULL when this processor or build lacks it. */
const solid_engine *solid_engine_find(int precision, const char *simd);

/* The engine of bodies of tetrahedra, in which F comes from the mesh (solid paper, Fig. 19), behind the same table: particles are the mesh's
 * vertices. "deformation_gradient" is the mean over a vertex' elements, determinants are the elements' own. There is no sorting. */
const solid_engine *solid_tetra_find(int precision, const char *simd);

#endif
