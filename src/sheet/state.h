/* The sheet engine's state, laid out for the loop over bonds.
 *
 * Particles lie in packs of PACK, each of one body, the last of a body padded. A pack has as many *slots* as its particle with the most
 * bonds: slot k holds bond k of each of its particles, arrays [slot][PACK], so that a vector works on one bond of several particles. Each bond is
 * thus stored from both ends and each particle sums its own: no races, and the same bits at any number of threads. Both ends compute the same
 * stretch to the bit (differences of coordinates only change their sign, means are symmetric), so their histories stay equal.
 *
 * A neighbour's place and diffused quantity are one record of NODE reals. Coordinates are sums of two reals, high and low: a step that is
 * small beside a coordinate is not lost in f32, nor is a small stretch of a short bond far from the origin.
 *
 * A broken bond has stiffness and conductance 0, and the history BROKEN for ever. */
#ifndef SUNDER_SHEET_STATE_H
#define SUNDER_SHEET_STATE_H

#include "sheet/effects/list.h"
#include "sheet/network.h"
#include "sheet/sheet.h"
#include "sheet/variant.h"

enum {
    PACK = SHEET_PACK,
    PACK_PARTS = PACK / VEC_LANES,
    NODE = 8,        /* x y z θ, low parts of x y z, 0 */
    NODE_LOW = 4,
    GROUP_PACKS = 8, /* what a thread takes at a time, and what results are kept for */
    LAW_CONSTANTS = 4,
};

#define BROKEN ((real)1e30)

/* What the bonds of a body do beside their law: the loop over bonds is compiled for each combination. */
enum { BOND_FRACTURES = 1, BOND_STATE = 2, BOND_FEELS_THETA = 4, BOND_SOFTENS = 8 /* only with the one before */ };

typedef struct sheet_pack {
    int32_t body, count; /* real particles */
    int32_t first_slot, slots;
} sheet_pack;

/* A body's numbers, in the run's precision. */
typedef struct body_constants {
    unsigned flags;
    int law_effect;               /* index of the effect that is its law */
    real law[LAW_CONSTANTS];
    real alpha;
    bool total, toughness_softens;
    real stiffness_loss, toughness_loss, stretch_loss, floor;
    real least_limit; /* the smallest critical stretch of its bonds */
    real decay, damping, drag, wind[3]; /* drag: per mass */
    real bending;                       /* B/ρh */
    double contact_reach, contact_stiffness; /* distance, force per approach */
    double surface_density;       /* ρ h */
    double heat;                  /* ρ C h */
    double dilation_modulus;      /* Λ */
} body_constants;

/* How packs' steps are divided (rates.c; METHOD.md §6). A pack of level l takes steps of 2^−l of a step, a bond those of its faster end, and its
 * ends are then where they are at that time: a pack moves by steps of its `reach`, the highest level of the packs that its bonds reach. */
typedef struct pack_rates {
    int32_t pack_count;
    double *pace;        // [pack_count], largest of its particles at rest
    real *stiffening;    // [pack_count], in the last step
    real *coldest, *hottest; // [pack_count], smallest and largest θ̄ of its bonds
    int32_t *cracked;    // [pack_count], the step after which a bond last broke + 1; 0: none has
    uint8_t *asked;      // [pack_count], the level that a pack asks for itself
    uint8_t *level, *reach; // [pack_count]
    int32_t *order;      // [pack_count], by falling reach
    int32_t active[SHEET_LEVELS + 1];       /* packs of a reach of at least l */
    int64_t active_slots[SHEET_LEVELS + 1]; /* and their slots */
    int64_t *near_start; // [pack_count + 1]
    int32_t *near;       // packs that a pack's bonds reach, ascending
    int32_t step;
    int finest;          /* the highest level of the step at hand */
    bool uniform[SHEET_BODIES]; /* bodies that take one step throughout */
} pack_rates;

/* Results of a group of packs, reduced in order. */
typedef struct group_result {
    real stiffening; /* largest stiffness of a bond over c */
    int32_t fault;   /* index of the first bad particle + 1 */
    int32_t broken;  /* bonds that broke, counted from both ends */
    real fastest;    /* largest square of a speed */
    double grip_work, grip_impulse[3];
} group_result;

struct sheet {
    sheet_definition definition;
    sheet_plan plans[SHEET_MATERIALS];
    sheet_calibration calibration[SHEET_BODIES];
    body_constants bodies[SHEET_BODIES];
    uint32_t mask;
    int threads;
    double momentum_bound, diffusion_bound, bending_bound, contact_bound; /* of the state at rest */
    pack_rates *rates; /* NULL: one step for all */
    struct contact_list *contacts; /* effects/self_contact.c; NULL unless it is on */
    int64_t broken_since;  /* bonds broken since contacts were last listed */
    double stiffening;
    double speed; /* the largest of a particle in the last step */

    int64_t count;
    int32_t pack_count, group_count;
    sheet_pack *packs;    // [pack_count]
    int32_t *id;          // [pack_count][PACK], −1 for padding
    int32_t *place;       // [count], where each id lies
    real *node;           // [pack_count][PACK][NODE]
    real *velocity;       // [pack_count][3][PACK]
    real *area;           // [pack_count][PACK]
    uint8_t *holder;      // [pack_count][PACK], the grip that holds a particle + 1
    bool was_active[SHEET_BOUNDARIES];

    int32_t slot_count;
    int32_t *neighbour;   // [slot_count][PACK], places; a particle's own where it has no bond
    real *inverse;        // [slot_count][PACK], 1/|r⁰|
    real *stiffness;      // [slot_count][PACK]; 0: no bond, or broken
    real *limit;          // [slot_count][PACK], critical stretch; NULL unless bonds break
    real *history;        // [slot_count][PACK], largest stretch, or BROKEN; NULL unless kept
    real *conduct;        // [slot_count][PACK]; NULL unless something diffuses
    real *coupling, *dilation; // [slot_count][PACK]; NULL unless state-based
    real *dilatation;     // [pack_count][PACK], ϑ/w; NULL unless state-based
    real *diffused_next;  // [pack_count][PACK]; NULL unless something diffuses
    real *laplace;        // [slot_count][PACK], weights of the Laplacian; NULL unless something resists bending
    real *curvature;      // [pack_count][PACK][4], the Laplacian of the places
    real *whole;          // [pack_count][PACK], Σ laplace where curvature is known, −1 elsewhere
    double *weight_sum;   // [pack_count][PACK], w; NULL unless state-based

    source_feed feeds[SHEET_SOURCES];
    int64_t bond_updates;
    double diffused_until; /* the time that θ has been brought to */
    group_result *results; // [group_count]
    double grip_work, grip_impulse[3];
    double seconds[SHEET_PHASES];
};

/* One pack in the hands of a stage. */
typedef struct pack_work {
    sheet *state;
    int32_t pack;
    const body_constants *body;
    real dt;         /* the step of its level */
    real way;        /* and of its reach, by which it moves */
    bool due;        /* whether a step of its level begins; else only bonds to faster packs are evaluated */
    bool sifted;     /* whether some bonds reach faster packs */
    real share[2];   /* of dt that acts now on bonds of its own level, and on those to faster packs */
    real *stiffening;
    group_result *result;
} pack_work;

/* The stretch of one bond, for energies. */
typedef struct bond_state {
    double s, strain; /* |r|/|r⁰|; s − 1 − α θ̄ or, by the total criterion, s − 1 */
    double swelling;  /* α θ̄ */
    double left;      /* share of the stiffness that softening leaves */
    double history;
} bond_state;

typedef struct sheet_stages {
    /* Tells the plan of a material what the effect asks. */
    void (*declare)(const effect_values *own, sheet_plan *plan);
    /* Laws: derives constants from a plan and the c of its body; adds forces of a pack's bonds to its velocities; stored energy over c. */
    void (*constants)(const sheet_plan *plan, const sheet_calibration *c, real law[LAW_CONSTANTS]);
    void (*bonds)(const pack_work *w);
    double (*stored)(const real law[LAW_CONSTANTS], const bond_state *b);
    /* Before the bonds: what needs a sweep of its own. Errors: out of memory. */
    status (*before)(sheet *s, real dt, report *r);
    void (*release)(sheet *s); /* frees what `before` keeps */
    double (*energy)(const sheet *s, int32_t pack, int lane); /* of a particle, beside its bonds */
    /* On a pack's velocities, before boundaries. */
    void (*velocity)(const pack_work *w);
    /* After positions have moved to `time`; `dt` is the step that led there. */
    void (*after)(sheet *s, double time, double dt);
} sheet_stages;

/* Where particle `lane` of a pack lies. */
SIMD_INLINE real *node_at(const sheet *s, int32_t pack, int lane) {
    return s->node + ((int64_t)pack * PACK + lane) * NODE;
}

SIMD_INLINE double coordinate_of(const real *node, int c) {
    return (double)node[c] + (double)node[NODE_LOW + c];
}

/* The places of VEC_LANES particles that follow one another, for what leads from them to others: quads (simd.h), with −θ where θ lies. */
typedef struct own_place {
    vec high[4], low[4];
} own_place;

SIMD_INLINE void own_place_load(const sheet *s, int32_t pack, int first, own_place *own) {
    static const real signs[] = {1, 1, 1, -1};
    vec sign[4];
    quad_load(node_at(s, pack, first), NODE, own->high);
    quad_load(node_at(s, pack, first) + NODE_LOW, NODE, own->low);
    quad_load(signs, 0, sign);
    for (int k = 0; k < 4; k++) own->high[k] = own->high[k] * sign[k];
}

/* What leads to their neighbours: x y z, and the sum of both ends' θ. Turned when the differences are taken: a record's last real is 0. */
SIMD_INLINE void bond_vector(const sheet *s, const int32_t *neighbour, const own_place *own, vec r[4]) {
    vec high[4], low[4];
    quad_gather(s->node, neighbour, NODE, high);
    quad_gather(s->node + NODE_LOW, neighbour, NODE, low);
    for (int k = 0; k < 4; k++) high[k] = (high[k] - own->high[k]) + (low[k] - own->low[k]);
    quad_turn(high, r);
}

/* layout.c: orders particles, fills all arrays from a calibrated network; the bonds alone when a knob was turned. Errors: out of memory. */
status sheet_layout(sheet *s, const sheet_network *n, report *r);
status sheet_refill(sheet *s, const sheet_network *n, report *r);
void sheet_layout_free(sheet *s);
/* touch.c */
extern const sheet_touch sheet_touch_table;
/* advance.c */
void sheet_take_hold(sheet *s);
/* Moves the packs that are due at a part of a step. */
void sheet_advance(sheet *s, double dt, int part);
/* Breaks the bonds of `lanes` (a bit each) in a slot. */
void sheet_break_bonds(const pack_work *w, int64_t first, unsigned lanes);
/* Calls a stage for all packs. */
void sheet_for_packs(sheet *s, real dt, void (*stage)(const pack_work *w));
/* Calls a stage for the packs that are due at a part of a step: all in part 0, then those whose own or whose neighbours' smaller steps begin. */
void sheet_for_due(sheet *s, double dt, int part, void (*stage)(const pack_work *w));
/* rates.c. Errors: out of memory. */
status sheet_rates_create(sheet *s, report *r);
void sheet_rates_load(sheet *s, const sheet_network *n);
void sheet_rates_free(sheet *s);
double sheet_rates_bytes(const sheet *s);
/* The longest step at which no pack's part of it exceeds its own limit. */
double sheet_rates_limit(const sheet *s);
/* θ has changed. */
void sheet_rates_feel(sheet *s);
/* Gives packs their levels for a step of dt. */
void sheet_rates_choose(sheet *s, double dt);
void sheet_rates_report(const sheet *s, sheet_rates *out);
void sheet_rates_levels(const sheet *s, uint8_t *out);
/* effects/diffusion.c: brings θ to `time`. */
void sheet_diffuse(sheet *s, double time);
/* measure.c, snapshot.c */
status sheet_measure(const sheet *s, sheet_measures *m, report *r);
int sheet_read(const sheet *s, const char *field, double *out);
int64_t sheet_bonds(const sheet *s, int32_t *pairs, uint8_t *broken);
status sheet_save(const sheet *s, record_list *list, report *r);
status sheet_restore(sheet *s, const record_list *list, report *r);

/* An effect's table in this variant: each effect file defines one. */
#define SHEET_EFFECT(name) SHEET_VARIANT(sheet_effect_##name)
#define SHEET_EFFECT_EXTERN(name) extern const effect SHEET_EFFECT(name);
SHEET_EFFECT_LIST(SHEET_EFFECT_EXTERN)
extern const effect *const sheet_effect_table[SHEET_EFFECTS];

#endif
