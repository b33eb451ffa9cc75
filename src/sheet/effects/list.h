/* The one list that adding an effect touches. Its order is the order of stages within a step. */
#ifndef SUNDER_SHEET_EFFECTS_LIST_H
#define SUNDER_SHEET_EFFECTS_LIST_H

#define SHEET_EFFECT_LIST(X)                                                                                           \
    X(linear)                                                                                                          \
    X(rubber)        /* or this: a material has one law */                                                             \
    X(elastoplastic) /* or this */                                                                                     \
    X(fracture)                                                                                                        \
    X(diffusion)                                                                                                       \
    X(swelling)                                                                                                        \
    X(softening)                                                                                                       \
    X(grain)                                                                                                           \
    X(bending)                                                                                                         \
    X(self_contact)                                                                                                    \
    X(drag)                                                                                                            \
    X(damping)                                                                                                         \
    X(multirate) /* no stage: it divides the step */

#define SHEET_EFFECT_INDEX(name) SHEET_EFFECT_##name,
enum { SHEET_EFFECT_LIST(SHEET_EFFECT_INDEX) SHEET_EFFECTS };
#undef SHEET_EFFECT_INDEX

#endif
