/* An order for the unknowns of a regular grid in which a factorisation fills in little: nested dissection by their places (George 1973). */
#ifndef SUNDER_BASE_DISSECTION_H
#define SUNDER_BASE_DISSECTION_H

#include <stdbool.h>
#include <stdint.h>

/* order ← the indices of `count` cells, those that are to be eliminated first first. Cells are coupled when they differ by no more than `reach` along
 * every axis. Halves of the longest extent come first, each in the same manner, then the cells between them, `reach` thick. The order depends on the cells
 * and their sequence alone. order [count] is the caller's. False when memory is out. */
bool dissection_order(const int32_t (*cells)[3], int32_t count, int reach, int32_t *order);

#endif
