/* What a scene that is a hard case expects of its run (`expect` in the scene's table): bounds on what is measured of it, or the
 * message with which it must stop. Plain data: `sunder stress` makes the run and compares (src/study). */
#ifndef SUNDER_SIM_HARD_CASE_H
#define SUNDER_SIM_HARD_CASE_H

#include <stdbool.h>
#include <stdint.h>

enum { HARD_EXPECTATIONS = 16, HARD_TURNS = 16, HARD_TEXT = 128, HARD_LIMIT_TEXT = 256 };

/* What a bare number in `expect` bounds. */
typedef enum hard_sense { HARD_AT_MOST, HARD_AT_LEAST } hard_sense;

/* key, unit, sense, how it is made. Energies of a balance count what grips put in; `largest` is over all frames. */
#define HARD_MEASURES(X)                                                                                                       \
    X(energy_gain, "1", HARD_AT_MOST, "energy from nowhere: largest growth of the balance, of the largest kinetic and stored energy") \
    X(energy_drift, "1", HARD_AT_MOST, "largest change of the balance, of the largest kinetic and stored energy")             \
    X(energy_left, "1", HARD_AT_MOST, "kinetic and stored energy at the end, of the largest")                                 \
    X(stored_left, "1", HARD_AT_MOST, "stored energy at the end, of the largest")                                             \
    X(momentum_drift, "1", HARD_AT_MOST, "largest change of momentum that neither gravity nor grips gave, of mass times largest speed") \
    X(angular_drift, "1", HARD_AT_MOST, "largest change of angular momentum, of its size at the start")                       \
    X(speed_max, "length/time", HARD_AT_MOST, "largest speed of a particle")                                                  \
    X(speed_end, "length/time", HARD_AT_MOST, "largest speed of a particle at the end")                                       \
    X(deformation_max, "1", HARD_AT_MOST, "largest |F|/sqrt 3 of a particle; 1 at rest")                                      \
    X(deformation_end, "1", HARD_AT_MOST, "the same at the end")                                                              \
    X(determinant_min, "1", HARD_AT_LEAST, "smallest det F")                                                                  \
    X(determinant_max, "1", HARD_AT_MOST, "largest det F")                                                                    \
    X(determinant_end, "1", HARD_AT_LEAST, "smallest det F at the end")                                                       \
    X(fibre_stretch_min, "1", HARD_AT_LEAST, "smallest stretch along the first fibres")                                       \
    X(fibre_stretch_max, "1", HARD_AT_MOST, "largest stretch along the first fibres")                                         \
    X(bond_stretch_max, "1", HARD_AT_MOST, "largest strain of a sheet's whole bonds: length over that at rest, less 1")                                        \
    X(damage_mean, "1", HARD_AT_MOST, "mean damage, or share of broken bonds, at the end")                                    \
    X(damage_max, "1", HARD_AT_MOST, "largest damage, or share of a particle's bonds that are broken")                        \
    X(broken_fraction, "1", HARD_AT_MOST, "share of broken particles at the end")                                             \
    X(diffused_min, "1", HARD_AT_LEAST, "smallest diffused quantity")                                                         \
    X(diffused_max, "1", HARD_AT_MOST, "largest diffused quantity")                                                           \
    X(diffused_drift, "1", HARD_AT_MOST, "largest change of the diffused quantity's sum, of its size at the start")           \
    X(step_shrink, "1", HARD_AT_MOST, "the first frame's smallest step, of the smallest of all")                              \
    X(steps, "1", HARD_AT_MOST, "steps in all")                                                                               \
    X(spread, "1", HARD_AT_MOST, "diagonal of the box around all particles at the end, of that at the start")                 \
    X(low_x, "length", HARD_AT_LEAST, "smallest x of a particle")                                                             \
    X(low_y, "length", HARD_AT_LEAST, "smallest y of a particle")                                                             \
    X(low_z, "length", HARD_AT_LEAST, "smallest z of a particle")                                                             \
    X(high_x, "length", HARD_AT_MOST, "largest x of a particle")                                                              \
    X(high_y, "length", HARD_AT_MOST, "largest y of a particle")                                                              \
    X(high_z, "length", HARD_AT_MOST, "largest z of a particle")                                                              \
    X(centre_x, "length", HARD_AT_MOST, "mean x of the particles at the end")                                                 \
    X(centre_y, "length", HARD_AT_MOST, "mean y of the particles at the end")                                                 \
    X(centre_z, "length", HARD_AT_MOST, "mean z of the particles at the end")

#define HARD_MEASURE_NAME(key, unit, sense, doc) HARD_##key,
typedef enum hard_measure { HARD_MEASURES(HARD_MEASURE_NAME) HARD_MEASURE_COUNT } hard_measure;
#undef HARD_MEASURE_NAME

typedef struct hard_measure_row {
    const char *key, *unit, *doc;
    hard_sense sense;
} hard_measure_row;

/* The row of a measure, and the measure of a key or −1. */
const hard_measure_row *hard_measure_at(int measure);
int hard_measure_find(const char *key);

/* low ≤ the measure ≤ high; ±HUGE_VAL: no bound. */
typedef struct hard_expectation {
    int measure;
    double low, high;
} hard_expectation;

/* A knob that is turned while the case runs. */
typedef struct hard_turn {
    int64_t frame;
    char path[HARD_TEXT], value[HARD_TEXT];
} hard_turn;

/* The last frame's places are those of another variant of the same file, once both are brought to one measure:
 * |x/length − shift/length − x'| ≤ tolerance, particle by particle. */
typedef struct hard_likeness {
    char variant[HARD_TEXT]; /* "": none */
    double length, shift[3], tolerance;
} hard_likeness;

typedef struct hard_case {
    bool given;                        /* the scene has `expect` */
    char stop[HARD_TEXT];              /* "": it must run to its end; else words of the message that it must end with */
    char known_limit[HARD_LIMIT_TEXT]; /* "": none; else why it does not hold, and where that is written */
    int count, turn_count;
    hard_expectation items[HARD_EXPECTATIONS];
    hard_turn turns[HARD_TURNS];
    hard_likeness same_as;
} hard_case;

#endif
