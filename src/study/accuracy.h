/* What accuracy costs in time: a scene run along its axes of accuracy (study/axes.h), everything else equal, and what came of it.
 *
 * A run's error is its distance from the finest run of its axis, in measures over time: from the ledger's curves and from frames. Distances are L2
 * over frames, relative to the reference's own size. The order that an axis shows follows from its three finest levels; it also says what
 * the finest still lacks. The estimate of a run is what its own axis leaves and what all the others leave at the scene's own values: it makes runs of
 * different axes comparable, and the frontier is drawn by it. */
#ifndef SUNDER_STUDY_ACCURACY_H
#define SUNDER_STUDY_ACCURACY_H

#include "study/axes.h"
#include "study/run.h"

enum { ACCURACY_RUNS = 96, ACCURACY_MEASURES = 24, ACCURACY_CURVES = 6, ACCURACY_NAME = 48, ACCURACY_PATH = 1024, ACCURACY_NOTES = 16, ACCURACY_TEXT = 320 };

typedef struct accuracy_options {
    const char *scene, *recipe;
    const script_setting *settings; /* [setting_count] */
    int setting_count;
    const char *const *axes;        /* [axis_count] words, "all" among them; none: those that are taken unasked */
    const char *const *measures;    /* [measure_count] names; none: the usual ones */
    int axis_count, measure_count;
    int levels;                     /* of an axis, 2 to AXIS_LEVELS */
    int64_t frames;                 /* −1: the scene's */
    double budget;                  /* seconds that all runs may take as predicted; 0: no limit */
    int precision, threads, jobs;
    const char *simd, *database, *output, *command; /* output: folder for the runs' folders, NULL: the ledger's own */
} accuracy_options;

typedef enum accuracy_state { ACCURACY_WAITING, ACCURACY_GOING, ACCURACY_BEFORE, ACCURACY_DONE, ACCURACY_FAILED, ACCURACY_LEFT_OUT } accuracy_state;

/* A measure in which runs are compared. */
typedef enum accuracy_measure_kind {
    MEASURE_CURVES,   /* the ledger's, together */
    MEASURE_MOMENTS,  /* centre and extents from frames, over the body's size */
    MEASURE_FIELD,    /* a field's mean and root mean square from frames */
    MEASURE_TIME,     /* when damage first exceeds 0.9 */
    MEASURE_NORMAL,   /* angle between cracks, over a right angle */
    MEASURE_PARTICLES /* particle by particle at the end; only where particles are the same */
} accuracy_measure_kind;

typedef struct accuracy_measure {
    char name[ACCURACY_NAME];
    char doc[96];
    accuracy_measure_kind kind;
    int curves;
    char curve[ACCURACY_CURVES][ACCURACY_NAME]; /* names in the ledger, or of the field */
    bool judged; /* the error of a run is the largest of these */
    bool occurs; /* some run has it */
} accuracy_measure;

typedef struct accuracy_run {
    int axis, level; /* axis −1: the scene as it is */
    accuracy_state state;
    study_result result;
    char folder[ACCURACY_PATH], hash[32];
    int setting_count;
    script_setting *settings;
    double predicted;     /* seconds, of a run that is still to be made */
    int timed;            /* how often its steps were timed; result.step_seconds is the least */
    int frames;           /* of its curves */
    double *curve[ACCURACY_MEASURES][ACCURACY_CURVES]; /* [frames] */
    double end, crack_time; /* of its last frame; NAN: none */
} accuracy_run;

/* One level of an axis, judged. */
typedef struct accuracy_point {
    int run; /* −1: not made */
    double h;
    double error[ACCURACY_MEASURES], early[ACCURACY_MEASURES]; /* against the reference, over its size in all frames: in all frames, in those before the axis' first crack; NAN: none */
    double worst, worst_early; /* the largest of the judged */
    int worst_measure;
    double estimate;           /* as above; NAN: unknown */
    bool frontier;
    int dominated_by;          /* run that is faster and better, −1: none */
} accuracy_point;

typedef struct accuracy_result {
    int reference;                   /* its finest level that was made; −1: fewer than two were */
    double order[ACCURACY_MEASURES]; /* observed; NAN: none */
    double left[ACCURACY_MEASURES];  /* what the reference still lacks, by that order; NAN: unknown */
    double worst_order, worst_left;  /* of the measure that is the worst one of the scene's own level */
    double crack;                    /* the first crack of its runs, NAN: none */
    accuracy_point point[AXIS_LEVELS];
} accuracy_result;

typedef struct accuracy_study {
    accuracy_options options;
    char title[128], tag[STUDY_TAG], simd[16], hash[32];
    int threads;
    int64_t frames, particles;
    int axis_count, run_count, measure_count, note_count;
    accuracy_axis axes[AXES];
    int run_of[AXES][AXIS_LEVELS]; /* −1: not planned */
    accuracy_run runs[ACCURACY_RUNS]; /* the first is the scene as it is */
    accuracy_measure measures[ACCURACY_MEASURES];
    accuracy_result results[AXES];
    double extent;                 /* diagonal of the bodies at the start */
    int dimensions;                /* of solids 3, of sheets 2: particles go with h to this power */
    char notes[ACCURACY_NOTES][ACCURACY_TEXT]; /* why an axis was left out, what a budget took away, advice */
    int advice;                    /* notes from here on are advice */
} accuracy_study;

/* Loads the scene, finds axes and levels, looks up what the ledger has of them, predicts what the others cost, and takes finer levels away until the
 * budget holds. Nothing is run but a few steps of each plan. Errors: those of the scene; an axis or a measure that it does not have, with the
 * nearest; a budget that is too small. Free with accuracy_free, after errors too. */
status accuracy_plan(const accuracy_options *options, accuracy_study **out, script_reports *reports);

/* Seconds that the runs which are still to be made take as predicted, and how many they are. */
double accuracy_predicted(const accuracy_study *s, int *runs);

/* Makes the runs that are missing; `tell` as study_runs_make, with the run's number in study.runs. Short ones are timed again. STATUS_INTERRUPTED keeps
 * what is done. */
status accuracy_make(accuracy_study *s, study_teller tell, void *context, report *r);

/* Compares and judges what has been done. Errors: the ledger, frames that cannot be read, memory. */
status accuracy_judge(accuracy_study *s, report *r);

/* What a level is called: "particles 25000", "the scene's own". */
void accuracy_run_name(const accuracy_study *s, int run, char text[96]);

void accuracy_free(accuracy_study *s);

/* ---- shared by the files of this study --------------------------------------------------------------------------- */

/* accuracy_past.c: a run of an earlier study that is the same and was timed as this one is. */
status accuracy_find_past(accuracy_study *s, accuracy_run *run, report *r);
/* A short run's steps once more, until a second is full; remembered in the ledger. */
status accuracy_time_again(accuracy_study *s, accuracy_run *run, report *r);
/* Runs made at a time have times that cannot be compared: the ledger says so. */
status accuracy_mark_together(accuracy_study *s, const accuracy_run *run, report *r);

/* accuracy_compare.c: reads a run's curves; distance of two runs in a measure over frames [0, last], and its scale by the reference. NAN where a run lacks it. */
status accuracy_read(accuracy_study *s, accuracy_run *run, report *r);
status accuracy_distance(const accuracy_study *s, const accuracy_run *a, const accuracy_run *b, int measure, int last, double *out, report *r);
double accuracy_scale(const accuracy_study *s, const accuracy_run *reference, int measure, int last);

void accuracy_note(accuracy_study *s, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
