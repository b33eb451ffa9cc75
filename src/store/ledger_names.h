/* What measures and parameters the ledger knows, and which of them a user means. */
#ifndef SUNDER_STORE_LEDGER_NAMES_H
#define SUNDER_STORE_LEDGER_NAMES_H

#include "store/ledger.h"

enum { LEDGER_NAME = 128 };

/* STATUS_OK when some run has a measure of this name, else STATUS_INPUT with the nearest. */
status ledger_check_measure(ledger *l, const char *name, report *r);

/* The parameter that is meant by its whole name, or by the end of a dotted one ("eta" for "tube.damage.eta") when only one ends so.
 * STATUS_INPUT with the nearest. */
status ledger_find_parameter(ledger *l, const char *word, char name[LEDGER_NAME], report *r);

/* Calls `take` with each name of a measure (or a parameter) that some run has, in order. */
status ledger_each_measure(ledger *l, void (*take)(void *context, const char *name), void *context, report *r);
status ledger_each_parameter(ledger *l, void (*take)(void *context, const char *name), void *context, report *r);

#endif
