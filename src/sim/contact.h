/* Contact of sheets and solids in one scene: the scene's effect `contact`. */
#ifndef SUNDER_SIM_CONTACT_H
#define SUNDER_SIM_CONTACT_H

#include "sim/internal.h"

typedef struct sheet_contact sheet_contact;

/* NULL without memory. The simulation has both engines, and its solids are particles. */
sheet_contact *contact_create(const simulation *s, int threads);
void contact_destroy(sheet_contact *c);

/* After both engines' step of dt: what presses is stopped, with friction. Errors: out of memory, where more is near than ever before. */
status contact_apply(simulation *s, double dt, report *r);

#endif
