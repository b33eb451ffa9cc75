#include "tui/capture.h"

#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum { STREAMS = 2, CAPTURE_LARGEST = 16 * 1024 * 1024 };

/* A file in memory and not a pipe: writers never wait for the screen, and what an assertion said before it killed the
 * process can still be told. */
static struct {
    atomic_int file;              /* atomic: a fatal signal may strike in any thread */
    atomic_int original[STREAMS]; /* duplicates of descriptors 1 and 2, −1 when left alone */
} state = {-1, {-1, -1}};

status capture_begin(report *r) {
    fflush(stdout);
    fflush(stderr);
    int made = memfd_create("sunder-output", MFD_CLOEXEC);
    if (made < 0) return report_set(r, STATUS_SYSTEM, "no memory file for printed text: %s", strerror(errno));
    fcntl(made, F_SETFL, O_APPEND);
    state.file = made;
    for (int i = 0; i < STREAMS; i++) {
        if (!isatty(i + 1)) continue;
        state.original[i] = fcntl(i + 1, F_DUPFD_CLOEXEC, 3);
        if (state.original[i] < 0 || dup2(made, i + 1) < 0) {
            int cause = errno;
            capture_end();
            capture_forget();
            return report_set(r, STATUS_SYSTEM, "cannot redirect descriptor %d: %s", i + 1, strerror(cause));
        }
    }
    return STATUS_OK;
}

void capture_end(void) {
    for (int i = 0; i < STREAMS; i++) {
        if (state.original[i] >= 0) dup2(state.original[i], i + 1);
    }
}

void capture_forget(void) {
    for (int i = 0; i < STREAMS; i++) {
        int original = atomic_exchange(&state.original[i], -1);
        if (original >= 0) close(original);
    }
    int file = atomic_exchange(&state.file, -1);
    if (file >= 0) close(file);
}

int64_t capture_size(void) {
    struct stat info;
    if (state.file < 0 || fstat(state.file, &info) != 0) return 0;
    /* Something that prints without end must not fill the memory: what is old goes. */
    if (info.st_size > CAPTURE_LARGEST && ftruncate(state.file, 0) == 0) return 0;
    return info.st_size;
}

int capture_tail(char text[CAPTURE_KEPT + 1]) {
    struct stat info;
    text[0] = '\0';
    if (state.file < 0 || fstat(state.file, &info) != 0) return 0;
    off_t start = info.st_size > CAPTURE_KEPT ? info.st_size - CAPTURE_KEPT : 0;
    ssize_t count = pread(state.file, text, CAPTURE_KEPT, start);
    if (count <= 0) return 0;
    text[count] = '\0';
    if (start == 0) return (int)count;
    ssize_t first = 0;
    while (first < count && text[first] != '\n') first++;
    if (first == count) return (int)count; /* one endless line: shown as it is */
    memmove(text, text + first + 1, (size_t)(count - first));
    return (int)(count - first - 1);
}

void capture_replay(void) {
    char text[CAPTURE_KEPT + 1];
    int length = capture_tail(text);
    for (int done = 0; done < length;) {
        ssize_t written = write(STDERR_FILENO, text + done, (size_t)(length - done));
        if (written <= 0) break;
        done += (int)written;
    }
}
