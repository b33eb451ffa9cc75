#include "tui/newest.h"

static void *work(void *argument) {
    newest *n = argument;
    pthread_mutex_lock(&n->lock);
    while (!n->closing) {
        if (!n->waiting) {
            n->busy = false;
            pthread_cond_wait(&n->asked, &n->lock);
            continue;
        }
        n->waiting = false;
        n->take(n->owner);
        pthread_mutex_unlock(&n->lock);
        n->answer(n->owner);
        pthread_mutex_lock(&n->lock);
    }
    pthread_mutex_unlock(&n->lock);
    return NULL;
}

status newest_open(newest *n, void (*take)(void *owner), void (*answer)(void *owner), void *owner, const char *what, report *r) {
    *n = (newest){.take = take, .answer = answer, .owner = owner};
    pthread_mutex_init(&n->lock, NULL);
    pthread_cond_init(&n->asked, NULL);
    if (pthread_create(&n->thread, NULL, work, n) == 0) return STATUS_OK;
    pthread_cond_destroy(&n->asked);
    pthread_mutex_destroy(&n->lock);
    return report_set(r, STATUS_SYSTEM, "no thread %s", what);
}

void newest_close(newest *n) {
    pthread_mutex_lock(&n->lock);
    n->closing = true;
    pthread_cond_signal(&n->asked);
    pthread_mutex_unlock(&n->lock);
    pthread_join(n->thread, NULL);
    pthread_cond_destroy(&n->asked);
    pthread_mutex_destroy(&n->lock);
}

void newest_begin(newest *n) {
    pthread_mutex_lock(&n->lock);
}

void newest_ask(newest *n) {
    n->waiting = n->busy = true;
    pthread_cond_signal(&n->asked);
    pthread_mutex_unlock(&n->lock);
}
