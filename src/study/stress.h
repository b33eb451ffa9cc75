/* The hard cases: scenes that say what their run must come to, their runs as child processes, what was measured, and the verdict.
 *
 * A case is a file of scenes/stress (here, in $SUNDER_SCENES or with the program), or one variant of it; a user adds one by writing a
 * file with `expect`. A child of its own for each: one that crashes or never ends fails alone. */
#ifndef SUNDER_STUDY_STRESS_H
#define SUNDER_STUDY_STRESS_H

#include "script/library.h"
#include "script/script.h"
#include "sim/hard_case.h"
#include "store/ledger.h"

enum { STRESS_NAME = LIBRARY_NAME + HARD_TEXT + 1, STRESS_TEXT = 1024, STRESS_MESSAGE = 512 };

typedef struct stress_case {
    char name[STRESS_NAME];        /* "inversion/random": the file's name and its variant */
    char scene[LIBRARY_PATH], variant[HARD_TEXT], title[128], remark[LIBRARY_REMARK];
    uint32_t effects;              /* that are on, by index in effect_catalogue() */
    int64_t particles;             /* of a scene that declares `particles`, so that it can be made larger; else 0 */
    double gravity[3];
    int like;                      /* the case that same_as names; −1: none */
    hard_case hard;
} stress_case;

typedef struct stress_suite {
    int count, capacity;
    stress_case *cases; // [count], sorted by name
} stress_suite;

/* Loads every case. Errors: a scene of scenes/stress that is wrong, or that has no `expect`, or names a variant that is not there; memory. */
status stress_find(stress_suite *out, script_reports *reports);
void stress_free(stress_suite *s);

/* Cases that are meant by a word: one by its name, or all variants of a file. Marks them in chosen[count]; returns how many. */
int stress_match(const stress_suite *s, const char *word, bool *chosen);

/* The name nearest to a word that means none, or NULL. */
const char *stress_nearest(const stress_suite *s, const char *word);

/* How many cases have an effect on. */
int stress_coverage(const stress_suite *s, int which);

/* ---- one run of a case ------------------------------------------------------------------------------------------- */

typedef enum stress_verdict {
    STRESS_WAITING,
    STRESS_GOING,
    STRESS_HOLDS,   /* it ran to its end and all is within its bounds */
    STRESS_STOPS,   /* it ended with the message that it should end with */
    STRESS_KNOWN,   /* it does not hold, which is written down */
    STRESS_FAILS,
    STRESS_VERDICTS,
} stress_verdict;

/* "holds", "stops", "known limit", "FAILS" … */
const char *stress_verdict_word(stress_verdict v);
/* The verdict of a word, −1 when there is none. */
int stress_verdict_find(const char *word);

typedef struct stress_run {
    int which;                  /* the case, by index in the suite */
    int precision;              /* 32 or 64 */
    char simd[16];
    double scale;               /* of the scene's particles */
    int like;                   /* the run that this one is compared with, by index; −1: none */
    stress_verdict verdict;
    char id[LEDGER_ID], folder[1024];
    int exit_code;
    bool timed_out;
    char message[STRESS_MESSAGE]; /* what the run complained about last, "" */
    char text[STRESS_TEXT];     /* figures with their bounds, "; " between them; why it fails comes first */
    double seconds;
    double value[HARD_MEASURE_COUNT]; /* NaN: not measured */
    double difference;          /* from the run `like`; NaN */
} stress_run;

/* ---- stress_figures.c --------------------------------------------------------------------------------------------------- */

/* What no run may ever do: a state that is not finite, a damage outside of [0, 1] or that heals, particles that get lost. */
typedef struct stress_figures {
    double value[HARD_MEASURE_COUNT];
    char broken[256]; /* "": none of it */
} stress_figures;

/* Measures a run that has ended, from its rows in the ledger and its frames. Errors: of the ledger and of files. */
status stress_measure(ledger *l, const char *id, const char *folder, const double gravity[3], stress_figures *out, report *r);

/* Largest |x/length − shift/length − x'| over the last frames' particles of two runs. */
status stress_difference(const char *folder, const char *other, const hard_likeness *how, double *out, report *r);

/* ---- stress_verdict.c --------------------------------------------------------------------------------------------------- */

/* Judges a run that has ended: fills verdict, text, value, difference. `other` is the folder of the run `like`, or NULL. */
status stress_judge(ledger *l, const stress_case *c, stress_run *run, const char *other, report *r);

/* ---- stress_work.c ------------------------------------------------------------------------------------------------------ */

typedef struct stress_request {
    const stress_suite *suite;
    stress_run *runs; // [count]
    int count;
    int jobs, threads;
    double limit;         /* seconds that a run may take */
    const char *database; /* the ledger's path */
    /* Told when a run starts and when it has been judged. */
    void (*tell)(void *context, int run);
    void *context;
} stress_request;

/* Makes and judges all runs that are waiting, so many at a time; one that another is compared with goes first. Each is tagged
 * stress:CASE and its verdict noted as an event, or as a refusal where no run began. STATUS_INTERRUPTED after SIGINT or SIGTERM. */
status stress_work(stress_request *q, report *r);

/* Takes over the verdict that the ledger has of the newest run of each, or of its refusal. */
status stress_recall(ledger *l, const stress_suite *suite, stress_run *runs, int count, report *r);

#endif
