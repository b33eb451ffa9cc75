/* frames.hdf.series: ParaView's list of a run's frames with their times. Internal to this floor. */
#ifndef SUNDER_STORE_SERIES_H
#define SUNDER_STORE_SERIES_H

#include "base/status.h"

#include <stdint.h>

/* Rewrites FOLDER/frames.hdf.series so that it names exactly the frames that are in the folder and can be opened. Times
 * are taken from the series that is there; frames it does not know, and `fresh` (−1: none), are asked themselves. Names
 * above `limit` are left out (−1: no limit). Syncs the folder. */
status series_refresh(const char *folder, int64_t fresh, int64_t limit, report *r);

#endif
