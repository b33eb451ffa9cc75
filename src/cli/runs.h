/* The verbs of `sunder runs`, each in the file of its kind. */
#ifndef SUNDER_CLI_RUNS_H
#define SUNDER_CLI_RUNS_H

#include "cli/cli.h"
#include "store/ledger.h"

typedef struct runs_options {
    const char *database, *where, *scene, *out;
    bool json, most, yes, keep_files, remove;
    long limit; /* −1: each verb's own */
    long threads;
    char path[1024]; /* of the ledger */
} runs_options;

/* A verb: names [count] are its words. STATUS_OK, or a report; *exit is the exit code of a verb that went well. */
typedef status runs_verb(ledger *l, const runs_options *o, int count, char **names, int *exit, report *r);

/* runs_ask.c */
runs_verb verb_list, verb_show, verb_diff, verb_best, verb_query, verb_sql;
/* runs_change.c */
runs_verb verb_tag, verb_note, verb_rm;
/* runs_reproduce.c */
runs_verb verb_reproduce;

/* A run by its id, the beginning or end of it, or "last". output may be NULL, else [1024]. */
status runs_find(ledger *l, const char *name, char id[LEDGER_ID], char *output, report *r);

#endif
