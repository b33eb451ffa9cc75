/* What the hard cases cover, made from the effects' tables. */
#ifndef SUNDER_CLI_STRESS_LIST_H
#define SUNDER_CLI_STRESS_LIST_H

#include "study/stress.h"

/* Each effect with the cases that have it on, then each case. Exit code: 1 when an effect has no case. */
int stress_print_list(const stress_suite *s, bool json, bool markdown);

/* What `expect` can bound. Returns 0. */
int stress_print_measures(bool markdown);

#endif
