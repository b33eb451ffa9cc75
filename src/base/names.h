/* "Did you mean …": the valid name nearest to a misspelt one. */
#ifndef SUNDER_BASE_NAMES_H
#define SUNDER_BASE_NAMES_H

/* Edits (insert, delete, replace, swap neighbours; case counts half) between two names. Names over 63 bytes are cut. */
double name_distance(const char *a, const char *b);

/* The candidate nearest to `name`, or NULL when none is within about a third of its length.
 * candidates has shape [count]; NULL entries are skipped. */
const char *name_nearest(const char *name, const char *const *candidates, int count);

#endif
