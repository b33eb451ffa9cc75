/* A scene as plain data: what the script floor produces and the simulation consumes.
 *
 * Everything lives in the scene's arena. Functions of time or place arrive as callbacks: the simulation does not know
 * that Lua stands behind them. They are called from the simulation's thread only. */
#ifndef SUNDER_SIM_SCENE_H
#define SUNDER_SIM_SCENE_H

#include "effect/effect.h"
#include "effect/kinds.h"
#include "geom/rigid.h"
#include "geom/sampling.h"
#include "geom/sampling_sheet.h"
#include "geom/shape.h"
#include "sim/hard_case.h"

#include <stdint.h>

enum { SCENE_MATERIALS = 16, SCENE_BODIES = 32, SCENE_GRIPS = 32, SCENE_COLLIDERS = 32, SCENE_NOTCHES = 64, SCENE_VARIATIONS = 8, SCENE_PARAMETERS = 512 };
enum { SCENE_FRAME_STEPS = 5000000 }; /* a frame that needs more steps will never end */
enum { SCENE_SHEETS = 16, SHEET_CUTS = 16, BODY_SOURCES = 16 }; /* sheets; notches of each; sources of each and of each solid */

/* A constant, or a function of `inputs` reals (time, or x y z) giving `outputs` reals. */
typedef struct scene_function {
    int outputs;         /* 1 to 6; 0: absent */
    double constant[6];  /* used when call is NULL */
    status (*call)(void *context, const double *input, int inputs, double *output, int outputs, report *r);
    void *context;
} scene_function;

/* Evaluates a function; a result that is not finite is an input error. */
status scene_function_evaluate(const scene_function *f, const double *input, int inputs, double *output, report *r);

/* A parameter of a material that varies in place: asked once for each particle, at the start. The material's own value is then the
 * largest that the function was seen to give inside a body, and every particle has its share of it. */
typedef struct scene_variation {
    int effect; /* index in effect_catalogue(); −1: the density */
    int key;    /* index of the effect's parameter */
    scene_function function; /* of place: 1 output */
} scene_variation;

typedef struct scene_material {
    char name[64];
    double density;             /* mass/length^3, > 0 */
    effect_values effects[EFFECT_LIMIT]; /* by index in effect_catalogue() */
    int variation_count;
    scene_variation variations[SCENE_VARIATIONS];
    char file[256];             /* where it was defined, for messages */
    int line;
} scene_material;

/* Per-particle fibre directions in the reference configuration. */
typedef struct scene_fibres {
    int families;           /* 0, 1 or 2 */
    scene_function direction; /* of place: 3 outputs (one family) or 6 (two); need not be unit or orthogonal */
} scene_fibres;

/* Feeds what diffuses in a body or a sheet. */
typedef struct scene_source {
    const shape *shape;   /* where; NULL: everywhere, or at the spots */
    int spots;            /* how many round spots at random places, 0: none */
    double radius;        /* of a spot */
    scene_function value; /* of place, 1 output: a rate, or the value that is held */
    bool fixed;           /* hold the value instead of adding it */
    double start, stop;   /* on while start ≤ t < stop; stop may be HUGE_VAL */
    double strength;      /* what it gives, or holds, is multiplied by this; 1 */
    double on;            /* 1, or 0: it does nothing at all */
} scene_source;

typedef struct scene_body {
    char name[64];
    const shape *shape;
    int material; /* index into scene.materials */
    sampling_kind sampling;
    scene_fibres fibres;
    scene_function velocity; /* of place: initial velocity, 3 outputs; absent means at rest */
    const shape *notches;    /* particles inside start broken; NULL: none */
    discretisation_kind discretisation;
    mesher_kind mesher;
    scene_function start;    /* of place at rest: where a vertex is at time 0, 3 outputs; tetrahedra only; absent means there */
    int source_count;
    scene_source sources[BODY_SOURCES];
} scene_body;

/* A cut that a sheet has from the start: a thin shape, or the straight line from … to. */
typedef struct scene_notch {
    const shape *shape; /* or NULL */
    double from[3], to[3];
} scene_notch;

typedef struct scene_sheet {
    char name[64];
    sheet_region region;
    int material;
    double thickness;
    double spacing;       /* of particles, 0: from the scene's dx or particles */
    double radius;        /* bonds reach this many spacings */
    double ripple;        /* random places out of the plane at the start, up to this many spacings */
    sheet_sampling lattice;
    scene_fibres grain;
    scene_function velocity;
    int notch_count, source_count;
    scene_notch notches[SHEET_CUTS];
    scene_source sources[BODY_SOURCES];
} scene_sheet;

/* Grips take hold of grid nodes inside a moving region, or of a sheet's particles that are inside when they start, and prescribe their velocity. */
typedef struct scene_grip {
    char name[64];
    const shape *shape;        /* at time 0 */
    scene_function velocity;   /* of time: 3 outputs */
    scene_function spin;       /* of time: angular velocity about `pivot`, 3 outputs; absent means none */
    double pivot[3];           /* moves along with the grip */
    double start, stop;        /* holds only while start ≤ t < stop; stop may be HUGE_VAL */
    bool protects;             /* particles that start inside are never damaged (default true) */
} scene_grip;

/* Rigid shapes that material cannot enter: walls are half-spaces at rest. */
typedef struct scene_collider {
    char name[64];
    const shape *shape;
    scene_function velocity, spin;
    double pivot[3];
    double start, stop;
    contact_kind contact;
    double friction;      /* Coulomb coefficient, for slip and separate */
} scene_collider;

/* One resolved scene parameter, for the ledger and for `--set`. */
typedef struct scene_parameter {
    char name[128];  /* "pull", or dotted: "tube.damage.eta" */
    char unit[48];
    char doc[192];
    bool is_text;
    double number;
    char text[128];
    bool from_set;   /* overridden by --set */
} scene_parameter;

typedef struct scene {
    arena *memory;
    char title[128], file[256];
    char units[64];      /* a name for the unit system, free text ("cgs", "SI"); may be empty */
    double duration, fps;
    int64_t particles;   /* wanted, over all bodies */
    double dx;           /* grid spacing, 0: from `particles` and particles_per_cell */
    double particles_per_cell; /* default 8 */
    double dt;           /* 0: automatic */
    double cfl;          /* fraction of the step limit, default 0.5 */
    uint64_t seed;
    double domain_minimum[3], domain_maximum[3]; /* particles that leave are a divergence; default ±HUGE_VAL */
    transfer_kind transfer;
    double transfer_ratio; /* FLIP fraction; RPIC: share of the symmetric part of C that is kept; default 0 */
    kernel_kind kernel, laplacian;

    effect_values effects[EFFECT_LIMIT]; /* SCOPE_SCENE effects, by index in effect_catalogue() */
    int material_count, body_count, sheet_count, grip_count, collider_count, parameter_count;
    scene_material materials[SCENE_MATERIALS];
    scene_body bodies[SCENE_BODIES];
    scene_sheet sheets[SCENE_SHEETS];
    scene_grip grips[SCENE_GRIPS];
    scene_collider colliders[SCENE_COLLIDERS];
    scene_parameter parameters[SCENE_PARAMETERS];
    hard_case hard; /* what `sunder stress` expects of it */
} scene;

/* A scene with every default in place, in an arena of its own. NULL when out of memory. */
scene *scene_create(void);
void scene_destroy(scene *s);

/* Checks what tables cannot: bodies present, materials used, numbers finite, needed effects on, twins resolved. Fills the derived
 * halves of twins in every material. */
status scene_validate(scene *s, report *r);

/* Whether a frame of the scene's own `dt` is at most SCENE_FRAME_STEPS steps; STATUS_INPUT otherwise. */
status scene_check_step(const scene *s, report *r);

/* The same for one material whose values have changed: its effects, and the fibres of the bodies that it is for. */
status scene_check_material(scene *s, int material, report *r);

/* A copy whose values may be changed without the scene's; names, shapes and functions stay the scene's, which must outlive it. NULL when out
 * of memory. */
scene *scene_copy(const scene *s);
void scene_copy_free(scene *copy);

/* Whether the scene's bodies are tetrahedra: all are, or none (scene_validate). */
bool scene_is_tetrahedra(const scene *s);

/* Source number `number` of all solids and then of all sheets, in their order; NULL when there are fewer. */
const scene_source *scene_source_at(const scene *s, int number);

/* The number of frames after the initial one: duration × fps, rounded. */
int64_t scene_frames(const scene *s);

/* Whether a grip that protects holds the place x at the start. */
bool scene_protects(const scene *s, const double x[3]);

/* All effects of both engines, the solid engine's first, metadata only (the tables' stages are those of the plain f64 build).
 * Effects of the scene itself, gravity and boundaries, stand once, among the solid engine's, and hold for both. */
const effect *const *effect_catalogue(int *count);

/* Where the sheet engine's effects begin in the catalogue. */
int sheet_effects_first(void);

/* The index of an effect by name in the catalogue, or -1; where both engines have one of that name, the solid engine's. */
int effect_index(const char *name);

/* The same of one engine alone. */
int effect_index_of(engine_kind engine, const char *name);

#endif
