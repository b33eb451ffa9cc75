/* A session: one run of one scene, from its ledger row to its result, on a thread of its own.
 *
 * It owns the loop "simulate a frame, measure, write, log". Screens and progress lines read snapshots; they never wait for the
 * simulation nor it for them. */
#ifndef SUNDER_SESSION_SESSION_H
#define SUNDER_SESSION_SESSION_H

#include "base/status.h"
#include "script/script.h"
#include "sim/knobs.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct session session;

enum { SESSION_BINS = 50, SESSION_HISTORY = 512, SESSION_EFFECTS = 16, SESSION_EVENTS = 64, SESSION_STAGES = 32, SESSION_COLOURS = 24 };

typedef struct session_options {
    script_options script;
    const char *scene_path;
    const char *output;   /* --out or NULL */
    const char *database; /* --db or NULL */
    const char *resume;   /* --resume RUN or NULL */
    const char *simd;     /* "auto", "plain", "avx2", "avx512" */
    const char *command;  /* the command line, for the ledger */
    int threads;          /* 0: all cores */
    int precision;        /* 32 or 64 */
    int64_t frames;       /* −1: the scene's */
    int checkpoint_every; /* frames; 0: none; CHECKPOINTS_AS_NEEDED */
    int keep;             /* checkpoints kept; 0: all */
    int64_t keep_bytes;   /* above 0 instead: a ring of checkpoints within so many bytes, dense where it is new, sparse where it is old, frame 0 always */
    const char *branch_of; /* --branch: a run's id, its unique prefix or "last"; NULL for none */
    int64_t branch_frame;
    const knob_turn *turns; /* [turn_count], known beforehand: each acts at its frame. Words may be short as for --set; copied by session_start */
    int turn_count;
    int deflate;          /* 0–9 */
    bool start_paused;
} session_options;

/* Every frame where older checkpoints stay, to go back to (keep 0, keep_bytes). Where the newest stay alone, for who resumes: the first frame, the
 * last, and those that are SESSION_CHECKPOINT_STEPS steps or more past the last checkpoint, since frames of few steps are sooner made than secured. */
enum { CHECKPOINTS_AS_NEEDED = -1, SESSION_CHECKPOINT_STEPS = 100 };

session_options session_options_default(void);

typedef enum session_state { SESSION_STARTING, SESSION_RUNNING, SESSION_PAUSED, SESSION_ENDED } session_state;

/* Numbers of one frame: kept for sparklines and progress. */
typedef struct session_sample {
    int64_t frame, step;  /* step: how many there were up to here */
    double time, seconds; /* simulated time; wall time of this frame's steps */
    double wall;          /* since the session's start, when this frame had been measured and not yet been written */
    double kinetic, elastic, fibre, work;
    double damage_mean, damage_max, broken_fraction, dt;
    double histogram[SESSION_BINS]; /* fraction of particles by damage, 50 equal bins over [0,1] */
} session_sample;

/* Of a frame that was abandoned between its steps: how many were made, the simulated time they cover, and their wall time. */
typedef struct session_unfinished {
    int64_t steps;
    double time, seconds;
} session_unfinished;

/* Something worth telling: "first_crack", "warning", "knob", "branch" … */
typedef struct session_event {
    int64_t frame;
    char kind[16], text[512];
} session_event;

/* Where the time of steps goes: a phase of a step, or an effect's part in it. */
typedef struct session_stage {
    char name[48];  /* "sort", "p2g" …, then the names of effects */
    double seconds; /* since the session's start */
    double share;   /* of all phases */
    bool part;      /* an effect's part of the phase above it */
} session_stage;

/* What a screen shows. Arrays have shape [particles][…], rows by id, and belong to the snapshot. */
typedef struct session_snapshot {
    uint64_t version; /* grows with each publication */
    session_state state;
    status outcome;         /* valid when state is SESSION_ENDED */
    char message[768];      /* the failure, or the last warning */
    char run_id[40], title[128], output[1024], precision[8], simd[16], variant[64];
    char effects[SESSION_EFFECTS][32];
    int effect_count;
    int threads;
    int64_t frame, frames, step, particles;
    double time, duration, dt, dt_min, dt_max;
    double seconds_per_frame, seconds_left, wall, step_wall;
    session_unfinished unfinished; /* all 0 when the run ended with a whole frame */
    session_sample now;
    int history_count; /* samples of the last SESSION_HISTORY frames, oldest first */
    session_sample history[SESSION_HISTORY];
    int64_t point_count, point_capacity;
    float *position;     /* [point_count][3] */
    float *scalar;       /* [point_count], the field `colour`, as it is */
    int32_t *body;       /* [point_count] */
    float bounds_minimum[3], bounds_maximum[3]; /* of the first frame: a steady camera */
    char colour[32], colour_unit[48];           /* what `scalar` holds */
    float scalar_minimum, scalar_maximum;       /* of this frame */
    float colour_minimum, colour_maximum;       /* what colours should run over: 0 to 1 of damage, of others what was seen so far */
    int64_t pause_at;      /* frame that session_run_to asked for, −1: none */
    int turn_count;        /* turns that have acted */
    int knob_version;      /* grows whenever a knob's value changes: session_knobs is worth calling */
    char parent[40];       /* of a branch */
    int64_t parent_frame;
    int64_t event_total;   /* since the session's start */
    int event_count;       /* the last SESSION_EVENTS, oldest first */
    session_event events[SESSION_EVENTS];
    int stage_count;
    session_stage stages[SESSION_STAGES];
} session_snapshot;

/* Loads the scene, opens the ledger, plans, and starts the thread. Input errors are returned here, before any row or folder is made. */
status session_start(const session_options *options, session **out, script_reports *reports);

/* Copies the newest state if its version differs from snapshot->version; returns whether it did. Never blocks on the
 * simulation for longer than a copy. Start from a zeroed snapshot; free it with session_snapshot_free. */
bool session_poll(session *s, session_snapshot *snapshot);
void session_snapshot_free(session_snapshot *snapshot);

/* Requests, from any thread (session_stop also from a signal handler). */
void session_pause(session *s, bool paused);
void session_step_once(session *s); /* while paused: one frame */
void session_run_to(session *s, int64_t frame); /* go on, and pause when that frame is reached; one that is past pauses at once */
void session_stop(session *s);      /* finish the frame, write a checkpoint, end as interrupted */
void session_abandon(session *s);   /* leave at the next step: up to the last whole frame is kept */

/* The run's knobs, with turns counted in that have been asked for and act at the next frame. As scene_knobs; from any thread. */
int session_knobs(session *s, knob *out, int limit);

/* Asks for a turn, from any thread: checked at once (errors as scene_turn; STATUS_INPUT too when the run has ended), acts at the next boundary
 * between frames. It is kept with its frame in the run's folder (turns.json), in the ledger and in checkpoints, before any step sees it. */
status session_turn(session *s, const char *path, const double value[3], report *r);
status session_turn_text(session *s, const char *path, const char *value, report *r);

/* The frame at whose end the turn asked for last acts: what a log of turns notes. */
int64_t session_turn_frame(session *s);

/* The turns that have acted, and those known beforehand that will, by frame; from any thread. Returns how many there are. */
int session_turns(session *s, knob_turn *out, int limit);

/* Frames whose checkpoints are there, ascending; from any thread. Returns how many there are. */
int session_checkpoints(session *s, int64_t *frames, int limit);

/* Writes a material as it now is to a Lua file that loads as a recipe and resolves to the same values (by its name where recipes are looked for: in
 * recipes/ beside a scene or above it, or in $SUNDER_RECIPES). A path without an ending gets `.lua`; `file` (may be NULL) is told the file that was written.
 * A file that is there is replaced. Errors: no such material, another ending, a path that cannot be written. */
enum { SESSION_RECIPE = 1024 };
status session_save_recipe(session *s, int material, const char *path, char file[SESSION_RECIPE], report *r);

/* Fields that this run can be coloured by, and the choice; from any thread. An unknown name is an input error with the nearest. The next
 * snapshot has it, while the run is paused or ended too. */
int session_colours(session *s, char (*names)[32], int limit);
status session_colour(session *s, const char *name, report *r);

/* Waits for the end (at most `seconds`; negative: for ever). True when it has ended. */
bool session_wait(session *s, double seconds);

/* After the end: the outcome, its report and the summary as JSON (owned by the session). */
status session_outcome(session *s, report *r);
const char *session_summary(session *s);

/* How this run was asked for, as options for another one like it: scene, recipe, settings, precision, frames and how it is kept; a folder
 * of its own, from the beginning, without turns. Strings are the session's. */
void session_request(const session *s, session_options *out);

/* A run's identity, as the ledger has it in scene_hash: of every source and every resolved parameter; hexadecimal. */
void sources_hash(const script *from, char hash[32]);

/* Stops if needed, joins the thread, closes ledger and script. */
void session_destroy(session *s);

#endif
