/* Rigid motions, and what a rigid shape does to the material that it touches: shared by both engines, in f64. */
#ifndef SUNDER_GEOM_RIGID_H
#define SUNDER_GEOM_RIGID_H

#include "geom/shape.h"

/* sticky: no relative motion; slip: no normal motion; separate: may leave, not enter. */
typedef enum contact_kind { CONTACT_STICKY, CONTACT_SLIP, CONTACT_SEPARATE } contact_kind;

/* A rigid shape at its place: maps between its rest frame (time 0) and the world. */
typedef struct rigid_motion {
    double translation[3];
    double rotation[9]; /* about `pivot` */
    double pivot[3];    /* at time 0 */
    double velocity[3], spin[3];
    bool active;
} rigid_motion;

/* A rigid shape that takes hold of material (a grip) or keeps it out (a collider). */
typedef struct rigid_boundary {
    const shape *shape; /* in its rest frame */
    bool grip;
    contact_kind contact;
    double friction;
    rigid_motion motion; /* updated by the caller before each step */
} rigid_boundary;

/* World position → the boundary's rest frame, and the velocity of the boundary's material at a world position. */
void rigid_motion_to_rest(const rigid_motion *m, const double x[3], double rest[3]);
void rigid_motion_velocity(const rigid_motion *m, const double x[3], double velocity[3]);
/* Moves it on by dt with its current velocity and spin. */
void rigid_motion_advance(rigid_motion *m, double dt);

/* What a boundary did: took its own velocity along; let go; stopped the normal motion; and all of it, by friction. */
typedef enum contact_outcome { OUTCOME_HELD, OUTCOME_LEFT, OUTCOME_SLID, OUTCOME_STUCK } contact_outcome;

/* The velocity that a boundary leaves material with at the place `rest` of its own frame: v becomes it; u is the boundary's there. Its normal,
 * from differences over `h`, goes into `normal`, which is untouched where the material is held. */
contact_outcome rigid_boundary_velocity(const rigid_boundary *b, const double rest[3], double h, const double u[3], double v[3], double normal[3]);

#endif
