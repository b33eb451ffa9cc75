/* A frame player: the frames of a run's folder, one at a time, as a viewer wants them.
 *
 * It reads what is asked for and keeps what it has read within a budget, the least recently shown going first, so that scrubbing
 * back and forth costs no disk. Frames are read by the caller's thread. A run that is still being written may be played. */
#ifndef SUNDER_SESSION_PLAYER_H
#define SUNDER_SESSION_PLAYER_H

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct frame_player frame_player;

/* A frame as a picture needs it. Arrays belong to the player and hold until its next call; rows are in the order of ids,
 * of a scene with both a solid and a sheet the solid's first. */
typedef struct frame_view {
    int64_t frame, step;
    double time;
    int64_t count;         /* particles (vertices, for tetrahedra) */
    const float *position; /* [count][3] length */
    const float *value;    /* [count] the quantity that was asked for; NULL: this run does not have it */
    const int32_t *body;   /* [count] the body's place in the scene */
    float low, high;       /* what `value` runs over in this frame; 0 and 1 for what is a fraction by nature */
} frame_view;

/* Opens a run's folder. A folder without frames is an input error. `cache_bytes` 0: 256 MiB. Free with frame_player_close. */
status frame_player_open(const char *folder, size_t cache_bytes, frame_player **out, report *r);
void frame_player_close(frame_player *p);

/* Numbers of the frames, ascending: [frame_player_count]. frame_player_refresh looks for new ones (a run that goes on). */
int frame_player_count(const frame_player *p);
int64_t frame_player_number(const frame_player *p, int index);
status frame_player_refresh(frame_player *p, report *r);

/* Place in that order of the last frame at or before `frame`; 0 when there is none. */
int frame_player_index(const frame_player *p, int64_t frame);

/* Names of the quantities that particles can be coloured by, in order; NULL at the end. Each array of one component under its own
 * name, and `speed`, `stretch` (largest principal stretch, of F) and `fibre_stretch` (|F a₀|) where their sources are. */
const char *frame_player_field(const frame_player *p, int index);

/* The quantity that pictures show unless told: damage, what diffuses, broken bonds, else speed. */
const char *frame_player_default_field(const frame_player *p);

/* Frame number `frame` with the quantity `field` (NULL: none). Errors: STATUS_INPUT for a frame that is not there and for an
 * unknown quantity (with the nearest), STATUS_SYSTEM for a file that cannot be read. */
status frame_player_read(frame_player *p, int64_t frame, const char *field, frame_view *out, report *r);

/* The box around the first frame's particles, for a camera that stays where it is. */
status frame_player_bounds(frame_player *p, float low[3], float high[3], report *r);

#endif
