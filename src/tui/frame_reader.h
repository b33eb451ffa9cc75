/* Frames of runs, read on a thread of their own: a frame of many particles takes longer than a key may wait. The newest question is the one that
 * is answered. All functions are the screen's thread's. */
#ifndef SUNDER_TUI_FRAME_READER_H
#define SUNDER_TUI_FRAME_READER_H

#include "session/player.h"

enum { READER_FIELDS = 48, READER_NAME = 32, READER_PATH = 1024 };

typedef struct frame_reader frame_reader;

/* What has been read last: of which folder, its frames, and one of them. All of it holds until a frame_reader_poll says true. */
typedef struct frame_page {
    char folder[READER_PATH]; /* "": nothing was read yet */
    int64_t asked;            /* the number of the frame that was asked for */
    int64_t *frames;          /* [frame_count], ascending */
    int frame_count, frame_capacity;
    int field_count;
    char fields[READER_FIELDS][READER_NAME]; /* quantities to colour by */
    char field[READER_NAME];                 /* the one that `view` has; "" none */
    bool has_frame;
    frame_view view; /* without bodies */
    float low[3], high[3]; /* the box around the first frame */
    char problem[512];     /* why there is no frame; "" when there is */

    float *position, *value; /* [capacity][3] and [capacity]: what `view` points to */
    int64_t capacity;
} frame_page;

/* cache_bytes as frame_player_open's. `wake` is called, from the reader's thread, when a page is ready. Free with frame_reader_close, which waits for
 * a frame that is being read. Errors: memory, threads. */
status frame_reader_open(size_t cache_bytes, void (*wake)(void *context), void *context, frame_reader **out, report *r);
void frame_reader_close(frame_reader *p);

/* Asks for the last frame at or before number `frame` of a run's folder, with a quantity ("": the run's usual one; one that it does not have: none).
 * `refresh`: the run may have more frames than when it was looked at last (a number beyond the last one known implies it). */
void frame_reader_ask(frame_reader *p, const char *folder, int64_t frame, const char *field, bool refresh);

/* True when there is a new page, which frame_reader_page is then. */
bool frame_reader_poll(frame_reader *p);
const frame_page *frame_reader_page(const frame_reader *p);

/* Something has been asked for whose page has not been polled. */
bool frame_reader_busy(frame_reader *p);

/* In a page's frames: the place of the last one at or before a number; 0 when there is none. */
int frame_page_index(const frame_page *page, int64_t frame);
/* Whether a run's particles have a quantity. */
bool frame_page_has(const frame_page *page, const char *field);

#endif
