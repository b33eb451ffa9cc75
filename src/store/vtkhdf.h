/* The VTKHDF 1.0 view: what lets ParaView open a frame without knowing sunder. Internal to this floor. */
#ifndef SUNDER_STORE_VTKHDF_H
#define SUNDER_STORE_VTKHDF_H

#include "base/record.h"

#include <hdf5.h>

/* The point sets that a frame may hold; the first one present is viewed in the frame itself. */
enum { VTKHDF_SETS = 2 };
extern const char *const vtkhdf_sets[VTKHDF_SETS];

/* The positions of a point set, or NULL when the records hold none. */
const record *vtkhdf_points(const record_list *records, const char *set);

/* Adds the group /VTKHDF: an UnstructuredGrid with a vertex cell per point of `set`, whose Points and PointData are
 * links to the arrays, in the same file (`source` NULL: soft links) or in another (external links, relative to this
 * one). */
status vtkhdf_write(hid_t file, const char *path, const record_list *records, const char *set, const char *source,
                    int deflate, report *r);

#endif
