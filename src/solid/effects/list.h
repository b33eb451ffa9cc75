/* The one list that adding an effect touches. Its order is the order of stages within a step. */
#ifndef SUNDER_SOLID_EFFECTS_LIST_H
#define SUNDER_SOLID_EFFECTS_LIST_H

#define SOLID_EFFECT_LIST(X)                                                                                           \
    X(plastic) /* moves F first, so that damage sees what is left */                                                   \
    X(damage)  /* degrades before forces, which see g(d) */                                                            \
    X(pff)     /* or this: a material has one damage model */                                                          \
    X(elastic)                                                                                                         \
    X(corotated) /* or this: a material has one elastic model */                                                       \
    X(fibres)                                                                                                          \
    X(snapping) /* of fibres */                                                                                        \
    X(diffusion) /* of moisture or heat */                                                                             \
    X(swelling)  /* by it */                                                                                           \
    X(softening)                                                                                                       \
    X(gravity)                                                                                                         \
    X(mass_damping)                                                                                                    \
    X(boundary) /* grips and colliders on the grid's velocities */                                                     \
    X(inextensible) /* the last word on them */                                                                        \
    X(contact) /* no stage: the simulation does it */

#define SOLID_EFFECT_INDEX(name) EFFECT_##name,
enum { SOLID_EFFECT_LIST(SOLID_EFFECT_INDEX) SOLID_EFFECTS };
#undef SOLID_EFFECT_INDEX

#endif
