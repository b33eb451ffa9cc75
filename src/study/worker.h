/* This program as child processes that make runs: its words, and what it said, kept in files until it has ended. */
#ifndef SUNDER_STUDY_WORKER_H
#define SUNDER_STUDY_WORKER_H

#include "base/status.h"

#include <stdbool.h>
#include <stdio.h>
#include <sys/types.h>

enum { WORKER_WORDS = 256, WORKER_TEXTS = 112, WORKER_TEXT = 384 };

/* What follows the program's name; what does not fit is an error of the program. */
typedef struct worker_words {
    char *argv[WORKER_WORDS + 1];
    char text[WORKER_TEXTS][WORKER_TEXT];
    int count, texts;
} worker_words;

/* Begins with "sunder". Words are borrowed; a formatted one is kept. */
void worker_words_begin(worker_words *w);
void worker_word(worker_words *w, const char *word);
void worker_option(worker_words *w, const char *option, const char *format, ...) __attribute__((format(printf, 3, 4)));

typedef struct worker {
    int run; /* whose it is, −1: free */
    pid_t pid;
    FILE *out, *error;
} worker;

/* Starts it without standard input, in this process's group. Errors: the system's; then it is free. */
status worker_start(worker *w, int run, const worker_words *words, report *r);

/* Its exit code from what waitpid says, 128 and the number for a signal. */
int worker_exit_code(int outcome);

/* A text member of the summary that it printed (`run --json`, a member a line); false when there is none. */
bool worker_member(worker *w, const char *name, char *out, size_t size);

/* The last line of its complaints without "sunder: "; "" when there is none. */
void worker_complaint(worker *w, char *out, size_t size);

/* Forgets what it said: it is free. */
void worker_close(worker *w);

#endif
