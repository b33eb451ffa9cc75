/* The run ledger: one SQLite database that remembers every run, its parameters and its measures per frame.
 *
 * WAL journal, busy timeout, BEGIN IMMEDIATE, one connection per process writes. Schema and migrations are the .sql
 * files of db/schema, compiled into the program. Run ids are short, sortable and unique: "20261122-061502-3f9a". */
#ifndef SUNDER_STORE_LEDGER_H
#define SUNDER_STORE_LEDGER_H

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef struct ledger ledger;

enum { LEDGER_ID = 40 };

/* The ledger's path when --db is not given: $SUNDER_DB, else $XDG_DATA_HOME/sunder/ledger.db, else ~/.local/share/…;
 * the folder is created by ledger_open. */
status ledger_default_path(char *path, size_t size, report *r);

/* The folder under which runs without --out are kept: the ledger's default folder + "/runs". */
status ledger_runs_folder(char *path, size_t size, report *r);

/* Opens (creating and migrating as needed). A file that is no database, or a newer schema, is an error that says so. */
status ledger_open(const char *path, ledger **out, report *r);
/* Opens the ledger that was asked for (--db), or the default one where `given` is NULL; path[size] becomes its path. */
status ledger_open_given(const char *given, char *path, size_t size, ledger **out, report *r);
/* The same to ask about past runs: a ledger that was asked for and is not there is an input error, and is not made. */
status ledger_open_past(const char *given, char *path, size_t size, ledger **out, report *r);
void ledger_close(ledger *l);

typedef struct ledger_run {
    const char *scene_path, *scene_title, *scene_hash; /* hash: of all sources, hex */
    const char *variant;                               /* may be NULL */
    const char *command;                               /* the command line, for people */
    const char *output;                                /* the run's folder */
    const char *precision, *simd, *version;
    const char *effects; /* names joined by commas */
    int threads;
    int64_t particles, frames_wanted, seed;
    const char *parent; /* run id and frame that it was resumed or branched from, or NULL */
    int64_t parent_frame;
} ledger_run;

/* Writes the run as 'running', with this process's pid, host and start time (dead runs are recognised by them), and
 * gives its id. */
status ledger_begin(ledger *l, const ledger_run *run, char id[LEDGER_ID], report *r);

/* Calls between the two become one transaction (one sync of the disk instead of one each): `outcome` is STATUS_OK to
 * keep what was written, an error to drop it all. Batches nest. ledger_batch_end returns `outcome`, or the commit's own
 * trouble. */
status ledger_batch_begin(ledger *l, report *r);
status ledger_batch_end(ledger *l, status outcome, report *r);

/* Notes the folder of a run that was begun before its folder had a name. */
status ledger_set_output(ledger *l, const char *id, const char *output, report *r);

/* A resolved parameter of a run: text when `text` is not NULL, else a number. */
status ledger_parameter(ledger *l, const char *id, const char *name, const char *unit, double number, const char *text,
                        bool from_set, report *r);

typedef struct ledger_value {
    const char *name;
    double value; /* NaN is stored as NULL */
} ledger_value;

/* Measures of one frame, in one transaction. Rows of this frame and of later ones are replaced: a resumed run goes on
 * from here. */
status ledger_frame(ledger *l, const char *id, int64_t frame, double time, int64_t steps, double wall_seconds,
                    const ledger_value *values, int count, report *r);

/* An event ("first_crack", "warning", "knob", "checkpoint" …) with free text. */
status ledger_event(ledger *l, const char *id, int64_t frame, const char *kind, const char *text, report *r);

/* A turn of a knob: it acts between `frame` and the next. */
typedef struct ledger_turn {
    int64_t frame;
    const char *path, *value; /* "tube.damage.eta", "0.05" */
} ledger_turn;

/* A run's turns, in the order in which they act: turns [count] take the place of those that the ledger had. */
status ledger_turns(ledger *l, const char *id, const ledger_turn *turns, int count, report *r);

/* Called for each turn in order; anything but STATUS_OK stops and is returned. The texts live until it returns. */
typedef status (*ledger_turn_taker)(void *context, const ledger_turn *turn, report *r);
status ledger_each_turn(ledger *l, const char *id, ledger_turn_taker take, void *context, report *r);

/* Copies frames with their measures, and events, of a run up to `frame` to another run, which has none of them yet, and where its scene
 * was: a branch has its past in its own rows. */
status ledger_copy_past(ledger *l, const char *from, const char *id, int64_t frame, report *r);

/* Forgets what a resumed run will tell again: events of later frames, and the turns of this one. */
status ledger_cut_events(ledger *l, const char *id, int64_t frame, report *r);

/* Ends a run: status is "done", "failed", "interrupted" ("dead" is for runs that could not say so themselves);
 * summary_json is the `run --json` object. */
status ledger_finish(ledger *l, const char *id, const char *run_status, int64_t frames, int64_t steps,
                     double wall_seconds, const char *message, const char *summary_json, report *r);

/* Marks a run that is being resumed as 'running' again, under this process. A run that another live process of this
 * host is writing is an input error; of another host it cannot be known, and the caller is believed. */
status ledger_reopen(ledger *l, const char *id, report *r);

/* Expands a full id, a unique prefix, a unique suffix, or "last" into an id and its output folder. STATUS_INPUT with
 * the nearest id. */
status ledger_resolve(ledger *l, const char *name, char id[LEDGER_ID], char *output, size_t size, report *r);

/* Tags are short words without commas; `on` adds, else removes (a tag that is not there is an input error with the
 * nearest). */
status ledger_tag(ledger *l, const char *id, const char *tag, bool on, report *r);

/* Adds a remark in free text. */
status ledger_note(ledger *l, const char *id, const char *text, report *r);

/* The verdict of a hard case that was refused before a run of it began, in the place of the one before; NULL forgets it. */
status ledger_refusal(ledger *l, const char *name, const char *precision, const char *text, report *r);

/* Forgets a run and all its rows; its folder is the caller's business. A run that is still being written is an input
 * error. */
status ledger_remove(ledger *l, const char *id, report *r);

/* One value of a row that a query gave. */
typedef struct ledger_cell {
    const char *name; /* the column's */
    const char *text; /* NULL when the value is */
    double number;    /* NaN when it is not a number */
} ledger_cell;

/* Called for each row with cells [count]; anything but STATUS_OK stops the query and is returned. */
typedef status (*ledger_row)(void *context, const ledger_cell *cells, int count, report *r);

/* Runs one SQL query that only reads. arguments has shape [argument_count], each "NAME=VALUE" for the parameter :NAME
 * of the SQL. One that is not given is an input error, unless the comment that the SQL opens with says its default ("(default …)"): it is
 * NULL then; an unknown one is an input error with the nearest. */
status ledger_each_row(ledger *l, const char *sql, const char *const *arguments, int argument_count, ledger_row row,
                       void *context, report *r);

/* The same, printed: a table for people, or {"columns": […], "rows": [[…], …]}. */
status ledger_print_sql(ledger *l, FILE *out, bool json, const char *sql, const char *const *arguments,
                        int argument_count, report *r);

/* Ready-made queries (db/queries): the SQL by name (STATUS_INPUT with the nearest), and their names in order, NULL at
 * the end. Each SQL text opens with comments that say what it answers and what its parameters are. */
status ledger_query(const char *name, const char **sql, report *r);
const char *ledger_query_name(int index);

/* Runs whose process is gone are shown as "dead" (host and pid, with the process start time, tell). `json` prints one
 * object on `out`. Filters: `where` is NULL or an SQL condition over the runs view. */
status ledger_print_list(ledger *l, FILE *out, bool json, const char *where, int limit, report *r);
status ledger_print_show(ledger *l, FILE *out, bool json, const char *id, report *r);
/* Just what differs: columns of the run, parameters, final measures; nothing that is equal, and not times and ids. */
status ledger_print_diff(ledger *l, FILE *out, bool json, const char *a, const char *b, report *r);

#endif
