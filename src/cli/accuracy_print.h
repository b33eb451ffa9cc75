/* What `sunder accuracy` says of a study. */
#ifndef SUNDER_CLI_ACCURACY_PRINT_H
#define SUNDER_CLI_ACCURACY_PRINT_H

#include "study/accuracy.h"

#include <stdio.h>

/* Tables, plot, frontier and advice for people: 80 columns. */
status accuracy_print(const accuracy_study *s, report *r);

/* One JSON object on standard output. */
status accuracy_print_json(const accuracy_study *s, report *r);

/* A row a level, with names in the first; notes as lines that begin with '#'. */
void accuracy_print_rows(const accuracy_study *s, FILE *out);

const char *accuracy_state_name(accuracy_state state);

#endif
