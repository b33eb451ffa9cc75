/* What a source gives to the particles of its body or sheet. */
#ifndef SUNDER_SIM_SOURCES_H
#define SUNDER_SIM_SOURCES_H

#include "sim/scene.h"

/* value[count]: the rate or held value at each place [count][3] that the source reaches, NaN elsewhere. `stream` makes its random spots its own.
 * Errors: its function's own; a source that reaches no particle (naming `owner`). */
status source_evaluate(const scene *s, const scene_source *from, int stream, const char *owner, const double *place, int64_t count, double *value,
                       report *r);

#endif
