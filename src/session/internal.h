/* What the files of this floor share. */
#ifndef SUNDER_SESSION_INTERNAL_H
#define SUNDER_SESSION_INTERNAL_H

#include "base/json.h"
#include "session/session.h"
#include "sim/simulation.h"
#include "store/frames.h"
#include "store/ledger.h"

#include <pthread.h>
#include <stdatomic.h>

enum { SESSION_PATH = 1024, SESSION_SETTINGS = 64 };

#define TURNS_RECORD "session/turns" /* in checkpoints: the turns that have acted, as in turns.json */

/* How a run was asked for, kept in its folder so that it can be resumed and reproduced with the same bits. */
typedef struct run_request {
    char scene[256], recipe[128], simd[16]; /* scene: path as given, or within the run's folder */
    int precision;
    int64_t frames; /* −1: the scene's */
    int setting_count;
    char setting_text[SESSION_SETTINGS][256];
    script_setting settings[SESSION_SETTINGS]; /* into setting_text */
} run_request;

/* Turns of knobs. `asked` and the lists are under the lock; the simulation's own values are touched by its thread alone. */
typedef struct session_knobs_state {
    pthread_mutex_t lock;
    int64_t passed;   /* the last frame whose turns have been taken: what is asked for now acts at the one after */
    int64_t promised; /* the frame at which the turn asked for last acts */
    scene *asked;     /* values with everything that was asked for */
    knob_turn *turns; /* [count] by frame: the first `acted` have acted, the others were known beforehand */
    int count, acted, capacity;
    knob_turn *queue; /* [queued] asked for by hand, for the next boundary */
    int queued, queue_capacity;
    atomic_int version; /* grows when a value of `asked` changes */
} session_knobs_state;

/* What a screen shows of a frame, taken from the simulation and not yet shown. */
typedef struct session_picture {
    double *position, *scalar; /* [particles][3], [particles]; owned */
    int64_t particles;
    int colour; /* what `scalar` is, by index */
    session_state state;
    int64_t frame, step;
    double time, dt_min, dt_max, seconds_per_frame, step_wall;
    int turns;
    session_sample sample;
    int stage_count;
    session_stage stages[SESSION_STAGES];
} session_picture;

/* A frame on its way out: copies of everything, so that the simulation can go on. */
enum { FILING_FRAME = 1, FILING_LOG = 2, FILING_CHECKPOINT = 4, FILING_PICTURE = 8 };
typedef struct filing_work {
    int parts; /* of the above: what is to be done */
    frame_header header;
    record_list frame, checkpoint;
    simulation_measures measures;
    double seconds; /* of the frame's steps */
    session_picture picture;
} filing_work;

typedef struct filing {
    pthread_t thread;
    bool threaded;
    pthread_mutex_t lock; /* guards what follows; `work` is the thread's own while busy */
    pthread_cond_t changed;
    bool busy, ending;
    status outcome; /* the first failure */
    report report;
    filing_work work;
} filing;

struct session {
    session_options options;
    run_request request;
    script *script;
    scene *scene;
    simulation *simulation;
    ledger *ledger;
    char id[LEDGER_ID], folder[SESSION_PATH], database[SESSION_PATH], hash[32];
    int64_t target; /* last frame */

    pthread_t thread;
    bool threaded;
    atomic_int stop, abandon, paused, steps_asked, ended;
    pthread_mutex_t lock; /* guards shown and warning */
    pthread_mutex_t ledger_lock; /* of every call while both threads run */
    filing filing;
    int64_t checkpointed, checkpointed_steps; /* the last frame whose checkpoint was handed over, −1: none; steps made by then */
    session_snapshot shown;
    session_knobs_state knobs;
    atomic_llong pause_at; /* −1: none */
    /* A branch: frames up to past_until are its parent's; from past_from on they are computed again without a word. −1: none. */
    char parent[LEDGER_ID], parent_folder[SESSION_PATH];
    int64_t past_from, past_until;
    bool ring_told;
    int scalar_count, colour_wanted, colour_shown; /* indices; the wanted one under the lock */
    simulation_scalar scalars[SESSION_COLOURS];

    simulation_measures measures;
    session_sample sample;
    session_unfinished unfinished;
    double wall_start, wall, step_wall, last_frame_wall;
    int64_t steps_before; /* steps before this session: a resumed run counts only its own for speed */
    bool first_crack_told;
    char warning[512];
    status outcome;
    report report;
    json_writer summary;
};

/* Its folder is written no more. */
void session_release_folder(const session *s);

/* folder.c */
status request_from_options(run_request *q, const session_options *options, report *r);
/* Sets what a request has; the strings stay the request's. */
void request_to_options(const run_request *q, session_options *out);
status request_write(const session *s, report *r);
status request_read(run_request *q, const char *folder, report *r);
status sources_write(const session *s, report *r);
/* The whole list into turns.json and the ledger; a ledger that fails is only warned of. */
status turns_write(session *s, report *r);

/* publish.c */
void publish_start(session *s);
void publish_state(session *s, session_state state);
/* Copies what the screen needs of the frame that has been reached; then, on the thread that files it, shows it. Shape: session_picture. Errors: memory.
 * picture_free on every way out. */
status picture_take(session *s, session_picture *p, report *r);
status picture_show(session *s, const session_picture *p, report *r);
void picture_free(session_picture *p);

/* filing.c: starts the thread; waits until it has nothing to do, and says what has failed so far; the same, then gives it work, whose memory it
 * takes over in any case; ends it when it is done. */
status filing_start(session *s, report *r);
status filing_wait(session *s, report *r);
status filing_hand_over(session *s, filing_work *w, report *r);
void filing_clear(filing_work *w);
void filing_end(session *s);

/* colours.c: what pictures can be coloured by; the field wanted; its values; and their way into the snapshot, whose lock the caller holds */
void colour_begin(session *s);
int colour_wanted(session *s);
status colour_read(session *s, int which, double *out, report *r);
void colour_fill(session *s, int which, const double *values);
/* Gives the snapshot the colours that are wanted, without a new frame. */
status colour_renew(session *s, report *r);

/* summary.c */
status summary_write(session *s, report *r);

/* turns.c: those of the options, checked one after the other on the scene as it is. */
status turns_begin(session *s, report *r);
/* Of a run that goes on from a checkpoint: the turns in `folder` up to frame `through`, then those of the options, none before frame `first`. What
 * acted before the checkpoint's frame acts on the simulation, whose state is still to be restored. */
status turns_resume(session *s, const char *folder, int64_t through, int64_t first, int64_t checkpoint, const record_list *saved, report *r);
/* The turns that have acted, as a record of a checkpoint. */
status turns_save(const session *s, record_list *list, report *r);
/* Before the session's thread starts: at which frame a turn by hand may act. */
void turns_start(session *s);
/* Lets everything act that is due between this frame and the next. */
status turns_act(session *s, report *r);
void turns_free(session *s);

/* loop.c */
void *session_loop(void *argument);
/* Warns on the screen and in the ledger. */
void session_warn(session *s, int64_t frame, const char *text);
/* An event for the screen and the ledger. */
void session_tell(session *s, int64_t frame, const char *kind, const char *text);
/* A ledger that fails must not cost the run its frames: the user is warned and the run goes on. */
void session_tolerate(session *s, status code, const report *r);

#endif
