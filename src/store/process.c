#include "store/process.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum { STARTED_FIELD = 22 }; /* of /proc/PID/stat, counted from 1 */

/* Reads the start of a small file as one line; "" when it cannot be read. */
static void read_line(const char *path, char *text, size_t size) {
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    ssize_t got = fd < 0 ? 0 : read(fd, text, size - 1);
    if (fd >= 0) close(fd);
    text[got > 0 ? got : 0] = '\0';
    text[strcspn(text, "\n")] = '\0';
}

/* State and start of a process; false when /proc does not say. */
static bool read_stat(int64_t pid, char *state, int64_t *started) {
    char path[64], text[1024];
    snprintf(path, sizeof path, "/proc/%" PRId64 "/stat", pid);
    read_line(path, text, sizeof text);
    const char *at = strrchr(text, ')'); /* the name before it may hold spaces and brackets */
    if (!at || at[1] != ' ') return false;
    *state = at[2];
    for (int field = 2; at && field < STARTED_FIELD; field++) at = strchr(at + 1, ' ');
    return at && sscanf(at, "%" SCNd64, started) == 1;
}

void process_self(process_identity *self) {
    memset(self, 0, sizeof *self);
    if (gethostname(self->host, sizeof self->host - 1) != 0) snprintf(self->host, sizeof self->host, "unknown");
    read_line("/proc/sys/kernel/random/boot_id", self->boot, sizeof self->boot);
    ssize_t length = readlink("/proc/self/ns/pid", self->space, sizeof self->space - 1);
    self->space[length > 0 ? length : 0] = '\0';
    self->pid = getpid();
    char state;
    if (!read_stat(self->pid, &state, &self->started)) self->started = 0;
}

static bool known_and_different(const char *a, const char *b) {
    return a[0] && b[0] && strcmp(a, b) != 0;
}

bool process_is_gone(const process_identity *other) {
    process_identity self;
    process_self(&self);
    if (strcmp(self.host, other->host) != 0) return false;
    if (known_and_different(self.boot, other->boot)) return true;
    if (known_and_different(self.space, other->space)) return false;
    char state;
    int64_t started;
    if (!read_stat(other->pid, &state, &started)) return kill((pid_t)other->pid, 0) != 0 && errno == ESRCH;
    if (state == 'Z' || state == 'X') return true; /* it has ended; its parent has yet to ask */
    return other->started > 0 && started > 0 && started != other->started;
}
