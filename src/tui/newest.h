/* A thread of its own for what takes longer than a key may wait: it answers the newest question. One that comes while another is being answered
 * takes the place of the one that waits. */
#ifndef SUNDER_TUI_NEWEST_H
#define SUNDER_TUI_NEWEST_H

#include "base/status.h"

#include <pthread.h>
#include <stdbool.h>

typedef struct newest {
    pthread_t thread;
    pthread_mutex_t lock;        /* guards what follows, and the owner's question and answer */
    pthread_cond_t asked;
    bool closing, waiting, busy; /* waiting: the question has not been begun; busy: it has not been answered */
    void (*take)(void *owner);   /* called by the thread under the lock: the question becomes the thread's own */
    void (*answer)(void *owner); /* called by the thread without it */
    void *owner;
} newest;

/* Errors: no thread; `what` says for what. Pair with newest_close. */
status newest_open(newest *n, void (*take)(void *owner), void (*answer)(void *owner), void *owner, const char *what, report *r);

/* Waits for what is being answered. */
void newest_close(newest *n);

/* The owner writes its question between the two. */
void newest_begin(newest *n);
void newest_ask(newest *n);

#endif
