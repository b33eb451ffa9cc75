/* Who writes a run, and whether that process is still there. Internal to this floor. */
#ifndef SUNDER_STORE_PROCESS_H
#define SUNDER_STORE_PROCESS_H

#include <stdbool.h>
#include <stdint.h>

typedef struct process_identity {
    char host[256];
    char boot[64];  /* the kernel's boot id, "" when unknown */
    char space[64]; /* the pid namespace, "" when unknown */
    int64_t pid;
    int64_t started; /* clock ticks from boot to its start, 0 when unknown: a reused pid differs in it */
} process_identity;

/* This process. */
void process_self(process_identity *self);

/* True when the process is certainly gone. False for what cannot be known from here: another host, another container.
 */
bool process_is_gone(const process_identity *other);

#endif
