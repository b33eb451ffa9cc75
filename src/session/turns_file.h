/* turns.json: a run's turns, one a line, as people and programs read them. Internal to this floor. */
#ifndef SUNDER_SESSION_TURNS_FILE_H
#define SUNDER_SESSION_TURNS_FILE_H

#include "sim/knobs.h"

#include <stddef.h>

/* The text of turns [count]: free *size + 1 bytes. */
status turns_format(const knob_turn *turns, int count, char **text, size_t *size, report *r);

/* Back from text [size]: free count × sizeof **turns bytes. `path` names the file in messages. STATUS_INPUT names the line of what is no turn. */
status turns_parse(const char *path, const char *text, size_t size, knob_turn **turns, int *count, report *r);

#endif
