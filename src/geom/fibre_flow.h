/* Fibres along a flow: the directions of ∇φ where ∇²φ = 0 in a body, φ = 1 on its inflow, φ = 0 on its outflow and no
 * flux passes its other surface (solid paper §7).
 *
 * Trilinear finite elements on a lattice of cubes. A cube that the surface cuts counts with the part that is inside,
 * which makes the surface's own place, not a staircase of cubes, what the flow runs along. Inflow and outflow are parts of
 * the body; φ is held on the surfaces where they begin (by a penalty), and directions within them continue those
 * outside. */
#ifndef SUNDER_GEOM_FIBRE_FLOW_H
#define SUNDER_GEOM_FIBRE_FLOW_H

#include "base/status.h"
#include "geom/shape.h"

typedef struct flow_definition {
    const shape *body, *inflow, *outflow;
    int resolution; /* cubes along the longest side of the body's box, FLOW_COARSEST to FLOW_FINEST; 0: so that the body
                       takes about FLOW_CUBES */
} flow_definition;

enum { FLOW_COARSEST = 4, FLOW_FINEST = 256, FLOW_CUBES = 30000 };

typedef struct fibre_flow fibre_flow;

/* Solves; the field lives in the arena, and the shapes are not needed any more. Errors: STATUS_INPUT when the body is
 * unbounded or empty, when inflow or outflow miss it, meet each other within a cube, or are not joined by the body (key
 * and message say which); STATUS_SYSTEM when memory is out. */
status fibre_flow_solve(arena *a, const flow_definition *d, const fibre_flow **out, report *r);

/* The direction at x, of unit length: from inflow to outflow. Outside the body it continues what is inside. */
void fibre_flow_direction(const fibre_flow *f, const double x[3], double direction[3]);

#endif
