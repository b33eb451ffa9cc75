/* The solid engine's state, laid out for the loops that read it.
 *
 * Particles lie in packs of PACK. A field with c components is an array [packs][c][PACK]: one pack's values of a component
 * fill a cache line in f32. A *tile* is a run of packs of one grid block and one material, at most TILE_PACKS long, that stages work on
 * while it is in cache; the last pack of a tile is padded with particles of no volume (id −1), so that no loop has a
 * remainder. Positions are kept in units of dx from their block's first node, so precision does not depend on where a
 * body is. Blocks are 4×4×4 nodes; a block owns the particles whose kernel starts at one of its nodes.
 *
 * Lazy order: a particle may drift one cell out of its block before the next sort. Its kernel then reaches the block's *window*, which every pass
 * reads or fills densely and exchanges with the grid once a block. */
#ifndef SUNDER_SOLID_STATE_H
#define SUNDER_SOLID_STATE_H

#include "solid/effects/list.h"
#include "solid/solid.h"
#include "solid/variant.h"

#include <stdatomic.h>

enum {
    PACK = 16,
    PACK_PARTS = PACK / VEC_LANES,
    TILE_PACKS = 8,
    TILE_PARTICLES = TILE_PACKS * PACK,
    BLOCK = 4,
    BLOCK_NODES = BLOCK * BLOCK * BLOCK,
    NODE = 4,            /* reals a node: momentum (velocity after the grid update) and mass */
    DAMAGE_NODE = 2,     /* reals a node: Σ w d, Σ w; after the grid update a slot begins with their ratios */
    WINDOW_LOW = -2,     /* a window's first node, from the block's first node */
    WINDOW = 10,         /* nodes a side: reaches −2 … 7, enough for a cubic kernel centred by the quadratic's cells */
    WINDOW_NODES = WINDOW * WINDOW * WINDOW,
    NEIGHBOURS = 27,
    OWN_FIELDS = 8,      /* that an effect's table may name */
    CONSTANTS = 16,      /* reals an effect may derive from a material's values */
    EFFECT_FIELDS = 20,
    IMPLICIT_WINDOWS = 4, /* reals a node that a solve on the grid scatters together */
    IMPLICIT_PLANES = 8,  /* reals a node that the implicit solve keeps */
};

/* The particle fields that the engine itself keeps; effects' fields follow. */
enum { FIELD_POSITION, FIELD_VELOCITY, FIELD_AFFINE, FIELD_DEFORMATION, FIELD_VOLUME, FIELD_BUILT_IN };
enum { FIELD_LIMIT = FIELD_BUILT_IN + EFFECT_FIELDS };

typedef struct solid_field {
    const char *name;
    int components;
    real *data; // [pack_capacity][components][PACK]
} solid_field;

typedef struct solid_tile {
    int32_t block, material;
    int32_t first_pack, pack_count, count; /* count: real particles; the rest of the last pack is padding */
} solid_tile;

/* A block that owns particles. */
typedef struct solid_block {
    int32_t coordinate[3]; /* in blocks */
    int32_t first_tile, tile_count;
    int32_t base_low[3], base_high[3]; /* first kernel nodes that a particle may have before the next sort */
    int32_t neighbour[NEIGHBOURS]; /* grid slots of the blocks around (x slowest); −1 where no kernel can reach */
    int32_t waits;                 /* how many blocks it waits for in a pass by colours */
    bool damaged;                  /* some particle of it was at the start of the step */
} solid_block;

/* What a tile's stages leave for the pass that follows them: all [TILE_PACKS][…][PACK]. */
typedef struct tile_scratch {
    real kirchhoff[TILE_PACKS * 6 * PACK];    // xx yy zz xy yz xz of τ = P Fᵀ
    real degradation[TILE_PACKS * PACK];      // g(d); 1 where nothing degrades
    real laplacian[TILE_PACKS * PACK];        // Δd, per length²
    real wave_tensor[TILE_PACKS * 6 * PACK];  // xx yy zz xy yz xz of T: a wave along n has ρ0 c² ≤ n·T n + wave_modulus; summed over effects
    real wave_modulus[TILE_PACKS * PACK];     // what it has along any n
    real old_velocity[TILE_PACKS * 3 * PACK]; // FLIP: the grid's velocity before forces, at the particles
    real records[TILE_PARTICLES * 32];        // per particle, for scatter and gather
    double *lap;                              // [EFFECT_LIMIT], seconds of each effect's stages; NULL: nobody looks at the clock
} tile_scratch;

/* A few blocks of each pass look at the clock, which ones changes from step to step: they tell what share of a pass is whose. */
enum { PASS_P2G, PASS_G2P, PASSES, BLOCKS_A_LOOK = 16 };
typedef struct pass_clock {
    double all, effect[EFFECT_LIMIT];
} pass_clock;

typedef struct solid_worker {
    tile_scratch tile;
    _Alignas(64) real window[WINDOW_NODES * NODE];
    real old_window[WINDOW_NODES * NODE]; // FLIP only
    real damage_window[WINDOW_NODES * DAMAGE_NODE];
    pass_clock clocks[PASSES];
    real implicit_window[WINDOW_NODES * IMPLICIT_WINDOWS]; // of what is solved for on the grid
    char apart[4096]; // prefetchers of two processors that meet in a page slow both down
} solid_worker;

/* What the implicit solve needs of a material. */
typedef struct implicit_material {
    real eta, length2;
} implicit_material;

/* How a boundary holds a node: what the inextensible solve may not undo. */
typedef enum hold_kind {
    HOLD_FREE,
    HOLD_FIXED,     /* its velocity is prescribed */
    HOLD_PLANE,     /* it moves within a tangent plane */
    HOLD_TOUCHING,  /* the same while it is pressed against a boundary that it may leave */
    HOLD_STUCK,     /* so pressed, and held by friction */
    HOLD_CANDIDATE, /* within such a boundary, but leaving it */
} hold_kind;

typedef struct node_hold {
    real normal[3], before[3]; /* the boundary's normal; the node's velocity before contact */
    real wall;                 /* the boundary's speed along the normal */
    int32_t kind;
} node_hold;

typedef struct constraint_sums {
    double first, second, largest;
} constraint_sums;

/* The inextensible solve (inextensible.c). */
typedef struct fibre_constraint {
    bool on, material[SOLID_MATERIALS];
    real relaxation[SOLID_MATERIALS];
    real recovery[SOLID_MATERIALS]; /* rate at which stretch is taken back, 1/time */
    double tolerance;
    int solver; /* constraint_solver: what the last of the materials asks for */
    bool warm;  /* solves start from the particles' tensions */
    int64_t solves, iterations, factorisations;
    struct sparse_solver *preconditioner; /* NULL: Jacobi's */
    bool refused;  /* no library is worth its work for now */
    int eager;     /* solves to come that make a preconditioner at once */
    int fresh, stale, price, uses; /* of a library's: iterations of its first solve, those beyond them since, its cost in iterations, solves since its first */
    bool mapped;   /* `number` belongs to the slots as they are */
    double *vector;        // [2][vector_size], what the preconditioner reads and writes
    int32_t (*unknown)[3]; // [vector_size], cells in grid coordinates
    int32_t vector_size, unknowns;
    int32_t capacity, slot_count;
    int32_t *slots;    // [capacity], those that fibres reach
    uint8_t *reached;  // [capacity]
    int32_t *number;   // [capacity][BLOCK_NODES], unknowns of the preconditioner, −1: none
    real *cells;           // [capacity] planes of cells
    real *nodes;           // [capacity][BLOCK_NODES][NODE]
    node_hold *holds;      // [capacity][BLOCK_NODES]
    constraint_sums *sums; // [capacity]
} fibre_constraint;

/* What diffuses (effects/diffusion.c). */
typedef struct solid_diffusion {
    int field;            /* θ's index; −1: nothing diffuses */
    double clock, until;  /* the time, and the time that θ has been brought to */
    double rate;          /* of the fastest exchange, 1/time */
    real unit;            /* what makes weights of the order of 1 */
    int32_t capacity;
    real *grid;           // [capacity][BLOCK_NODES][NODE]
    source_feed feeds[SOLID_SOURCES];
} solid_diffusion;

/* Per-block results of a pass, reduced in block order so that bits do not depend on threads. */
typedef struct block_result {
    double grip_work, grip_impulse[3];
} block_result;

typedef struct tile_result {
    real limit[EFFECT_LIMIT]; /* 1/Δt allowed, largest over the tile, by effect */
    int32_t fault;            /* lane index of the first bad particle + 1, 0: none */
    int32_t unsorted;         /* a particle has left the margin */
} tile_result;

struct solid {
    solid_definition definition;
    const effect *const *effects;
    int effect_count, threads;
    uint32_t mask; /* effects on, by index */
    real constants[SOLID_MATERIALS][EFFECT_LIMIT][CONSTANTS];
    uint32_t material_mask[SOLID_MATERIALS];
    bool transfers_damage; /* some material has the damage effect */
    bool implicit_on;      /* some material's damage is implicit */
    bool explicit_on;      /* some material's is not: the grid carries the damage channel */
    bool material_damaged[SOLID_MATERIALS], material_implicit[SOLID_MATERIALS]; /* by whichever damage model */
    implicit_material implicit_materials[SOLID_MATERIALS];
    double implicit_tolerance;
    int implicit_known; /* of how many steps before, two at most, the slots hold the solution */
    int32_t implicit_capacity;
    real *implicit_grid;   // [implicit_capacity][IMPLICIT_PLANES][BLOCK_NODES], implicit.c
    double *implicit_sums; // [implicit_capacity][2]
    fibre_constraint constraint;
    solid_diffusion diffusion;

    int64_t count;
    int32_t pack_count, pack_capacity;
    int32_t *id; // [pack_capacity][PACK], −1 for padding
    int field_count;
    solid_field fields[FIELD_LIMIT];
    int density_scale, stiffness_scale, toughness_scale, viscosity_scale, gamma_scale; /* the same: parameters that vary in place */
    int given_stiffness, given_toughness; /* of those the ones that the definition brings, where softening has its own */
    int damage_field, history_field, fibre_field, fibre2_field, tension_field, fibre_wave_field, snapped_field; /* indices, −1 when absent */
    int own_field[SOLID_EFFECTS][OWN_FIELDS]; /* the fields that each effect's table names, in its order; −1 when absent: for the effect's own stages */

    int32_t tile_count, tile_capacity, result_capacity, block_count, block_capacity, colour_capacity;
    solid_tile *tiles;
    solid_block *blocks;
    int32_t colour_start[28]; /* blocks of colour c are colour_blocks[colour_start[c] … colour_start[c+1]) */
    int colour_count;
    int32_t *colour_blocks; // [colour_capacity]
    int32_t *block_shares;  // [threads + 1], each worker's own blocks
    int32_t *colour_shares; // [colour][threads + 1], the same of each colour's stretch of colour_blocks
    int32_t wait_limit, wait_capacity, done_capacity;
    int32_t *waits;                // [block_count][wait_limit], whom each block waits for; of more than one thread
    _Atomic uint32_t *block_done;  // [done_capacity], the last pass by colours that did it
    uint32_t pass;

    int32_t slot_count, slot_capacity;
    int32_t (*slot_coordinate)[3]; // [slot_capacity], in blocks, sorted
    real *grid;                    // [slot_capacity][BLOCK_NODES][NODE]
    real *old_grid;                // the same before forces, NULL unless the transfer is FLIP
    int32_t *slot_block;           // [slot_capacity], the block that lies there, −1: none
    bool *slot_damaged;            // [slot_capacity], where damaged particles reach: the damage channel works there alone
    real *damage_grid;             // [slot_capacity][BLOCK_NODES][DAMAGE_NODE], NULL unless some damage is explicit

    /* sorting: kept between sorts, grown when needed */
    uint16_t *sort_codes;             // [pack_capacity][PACK], neighbour, material and cell that a particle goes to
    int32_t *sort_order;              // [pack_capacity][PACK], where from
    int32_t (*sort_moves)[NEIGHBOURS]; // [sort_move_capacity], of old blocks: how many go to each neighbour, then where to
    int32_t *sort_starts;             // [sort_start_capacity], of new blocks: their first particle
    int32_t *sort_materials;          // [sort_material_capacity], of new blocks: the end of each material's particles
    int32_t sort_move_capacity, sort_start_capacity, sort_material_capacity;
    uint64_t *block_keys;             // [hash capacity]
    int32_t *block_ranks;             // [hash capacity]
    int64_t hash_capacity, hash_used;
    uint64_t *block_list; // [block_list_capacity], sorted keys of the blocks in use
    int32_t block_list_capacity;
    real *permute;                    // [pack_capacity][PACK], one component on its way

    solid_worker *workers; // [threads]
    tile_result *tile_results;   // [result_capacity]
    block_result *slot_results;  // [slot_capacity]
    double limits[EFFECT_LIMIT]; /* 1/Δt, from the current state */
    bool sorted;
    double grip_work, grip_impulse[3];
    double seconds[SOLID_PHASES], solving[EFFECT_LIMIT]; /* by phase; of the grid's, by the effect that solves there */
    int64_t looks; /* passes so far: which blocks look at the clock */
};

/* One tile in the hands of a stage. */
typedef struct tile_work {
    const solid *state;
    const solid_tile *tile;
    tile_scratch *scratch;
    const real *constants; // [CONSTANTS], the calling effect's, of this tile's material
    tile_result *result;
    int effect;            /* the calling effect's index */
    real dt;
    real *piola;           // [TILE_PACKS][9][PACK], the first Piola-Kirchhoff stress; only elements of a mesh ask for it
    double energy[2];      /* energy stages add here: matrix or own, fibre */
} tile_work;

/* One grid block in the hands of a stage. */
typedef struct grid_work {
    const solid *state;
    int32_t slot;
    real *nodes; // [BLOCK_NODES][NODE], velocity and mass
    const double *places; // [BLOCK_NODES][3] in the world: of a mesh's vertices; NULL: the slot's block says where
    real dt;
    block_result *result;
} grid_work;

typedef struct solid_stages {
    /* Derives what the kernels need from the values of a material, once and when a knob is turned. */
    void (*constants)(const effect_values *all, const solid_definition *d, bool protects, real constants[CONSTANTS]);
    void (*degrade)(tile_work *w);    /* before forces: fills scratch->degradation */
    void (*stress)(tile_work *w);     /* forces: adds to scratch->kirchhoff */
    void (*update)(tile_work *w);     /* after F: histories; sees scratch->laplacian */
    void (*wave)(tile_work *w);       /* after update: adds to scratch->wave_tensor and wave_modulus */
    void (*grid)(const grid_work *w); /* on velocities */
    void (*energy)(tile_work *w);     /* measures */
    /* For elements of a mesh, whose F comes from their corners and may be singular: P itself, added to `piola` (τ F⁻ᵀ is lost there); and a
     * bound of the largest eigenvalue of ∂²Ψ/∂F², added to scratch->wave_modulus. */
    void (*piola)(tile_work *w);
    void (*stiffness)(tile_work *w);
    /* Before the way to the grid, once a step of `dt`. */
    status (*before)(solid *s, real dt, report *r);
    void (*feel)(tile_work *w); /* after what diffuses has changed */
    /* Between the way to the grid and the grid's update, once a step: for what must be solved for. */
    status (*solve)(solid *s, real dt, report *r);
    /* After the grid's update, once a step: what must hold for its velocities. */
    status (*constrain)(solid *s, real dt, report *r);
    /* By how much constants that have changed bring the effect's own step limit down, 1/Δt over what it was; NULL: it has none of its own. */
    double (*hasten)(const real before[CONSTANTS], const real after[CONSTANTS]);
    /* Tells the engine what a material needs of it beyond constants; called after `constants`. */
    void (*declare)(solid *s, int material, const effect_values *all);
} solid_stages;

/* Where stages load and store: component c of sub-vector `part` of the tile's pack k. */
SIMD_INLINE real *field_at(const solid_field *f, int32_t pack, int component, int part) {
    return f->data + ((int64_t)pack * f->components + component) * PACK + part * VEC_LANES;
}

SIMD_INLINE real *scratch_at(real *base, int components, int k, int component, int part) {
    return base + (k * components + component) * PACK + part * VEC_LANES;
}

/* A quantity times the scale of a parameter that varies in place; as it is where none does (−1; or 0, which is the position's). */
SIMD_INLINE vec scaled(const solid *s, int field, int32_t pack, int part, vec value) {
    return field <= 0 ? value : value * vec_load(field_at(&s->fields[field], pack, 0, part));
}

SIMD_INLINE vec scaled_down(const solid *s, int field, int32_t pack, int part, vec value) {
    return field <= 0 ? value : value / vec_load(field_at(&s->fields[field], pack, 0, part));
}

SIMD_INLINE double scale_of(const solid *s, int field, int32_t pack, int lane) {
    return field <= 0 ? 1 : (double)field_at(&s->fields[field], pack, 0, 0)[lane];
}

/* Whether some kernel of this state is four nodes wide. */
static inline bool kernels_have_cubic(const solid *s) {
    return s->definition.kernel == KERNEL_CUBIC || ((s->transfers_damage || s->diffusion.field >= 0) && s->definition.laplacian == KERNEL_CUBIC);
}

/* particles.c */
status particles_reserve(solid *s, int32_t packs, report *r);
status particles_load(solid *s, report *r);
size_t particles_bytes(const solid *s); /* of all arrays of packs, sorting's included */
void particles_free(solid *s);
int particles_read(const solid *s, const char *field, double *out);
/* touch.c */
extern const solid_touch solid_touch_table;
/* sort.c */
status particles_sort(solid *s, report *r);
/* grid.c */
status grid_build(solid *s, report *r);
void grid_free(solid *s);
void grid_update(solid *s, real dt);
void grid_collect_results(solid *s); /* adds what the slots' boundaries did to the totals */
/* colours.c: calls pass(context, block, next, worker) once for each block, `next` being the block that the same worker probably takes then
 * (−1: none). Blocks that share nodes go in the order of their colours, so sums into nodes have one order; others do not wait. */
typedef void coloured_pass(void *context, int32_t block, int32_t next, int worker);
status colours_assign(solid *s, report *r);
void colours_pass(solid *s, coloured_pass *pass, void *context);
/* transfer.c */
void transfer_to_grid(solid *s, real dt);
void transfer_to_particles(solid *s, real dt);
void transfer_limits(solid *s); /* the momentum limit of a state that no step has reached: at the start, after a knob */
/* implicit.c: memory for a number of slots; the solve; then a block's diffusion l0² Δd and its value at a tile's particles, left
 * in scratch->laplacian */
status implicit_reserve(solid *s, int32_t slots, report *r);
void implicit_free(solid *s);
status implicit_solve(solid *s, real dt, report *r);
void implicit_load_window(const solid *s, const solid_block *b, real *window);
void implicit_gather(const tile_work *w, bool weighed, const real *window); /* weighed: records hold this kernel's weights already */
/* A particle's own step from dⁿ: driven by H, with the diffusion of the nodes' solution and rate = η/Δt. */
SIMD_INLINE vec implicit_damage(vec d, vec H, vec spread, vec rate) {
    vec solved = vec_fma(rate, d, H + spread) / (H + (rate + 1));
    return vec_min(vec_max(solved, d), vec_all(1));
}
/* effects/diffusion.c: memory for a number of slots; what a state starts with; what constants have changed; effects of θ as it is; θ brought to
 * a time; ρ-less capacity of a tile's material */
status diffusion_reserve(solid *s, int32_t slots, report *r);
void diffusion_free(solid *s);
void diffusion_start(solid *s);
void diffusion_refresh(solid *s);
void diffusion_feed(solid *s, const source_feed *feeds);
status diffusion_settle(solid *s, double time, report *r);
double diffusion_capacity(const solid *s, const solid_tile *tile);
/* measure.c; reading: particles_read, and what stages compute */
status solid_measure(const solid *s, solid_measures *m, report *r);
int solid_read(const solid *s, const char *field, double *out);
/* snapshot.c */
status solid_save(const solid *s, record_list *list, report *r);
status solid_restore(solid *s, const record_list *list, report *r);
/* both_engines.c: what they do alike, as struct solid_engine documents it */
void solid_define(solid *s, const solid_definition *definition); /* what an engine is made from, before anything is reserved */
void solid_constants_refresh(solid *s);
solid_boundary *solid_boundaries(solid *s);
void solid_limits(const solid *s, double *limit);
void solid_surround(solid *s, const double gravity[3], double damping);
void solid_phases(const solid *s, double seconds[SOLID_PHASES]);
/* Names the stages that `places` lists, pass by pass, of the effects in `mask`; returns how many. */
typedef struct stage_place {
    const char *pass, *name;
    size_t offset; /* in solid_stages */
} stage_place;
int solid_stage_names(const stage_place *places, int place_count, uint32_t mask, char (*text)[48], int limit);

/* An effect's table in this variant: each effect file defines one. */
#define SOLID_EFFECT(name) SOLID_VARIANT(effect_##name)
#define SOLID_EFFECT_EXTERN(name) extern const effect SOLID_EFFECT(name);
SOLID_EFFECT_LIST(SOLID_EFFECT_EXTERN)
/* All of them, in the order of effects/list.h. */
extern const effect *const solid_effects[SOLID_EFFECTS];

#endif
