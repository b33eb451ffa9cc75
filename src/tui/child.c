#include "tui/child.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

status child_start(child *c, char *const *arguments, report *r) {
    int ends[2];
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    *c = (child){.fd = -1};
    if (pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) return report_set(r, STATUS_SYSTEM, "a pipe: %s", strerror(errno));
    /* The writing end waits, as programs expect of their output. */
    fcntl(ends[1], F_SETFL, fcntl(ends[1], F_GETFL) & ~O_NONBLOCK);
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes, 0);
    int trouble = posix_spawn(&c->pid, "/proc/self/exe", &actions, &attributes, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    close(ends[1]);
    if (trouble == 0) {
        c->fd = ends[0];
        return STATUS_OK;
    }
    close(ends[0]);
    c->pid = 0;
    return report_set(r, STATUS_SYSTEM, "starting sunder: %s", strerror(trouble));
}

/* The end of its output: it has ended, or is about to. */
static void finish(child *c) {
    int outcome = 0;
    close(c->fd);
    c->fd = -1;
    while (waitpid(c->pid, &outcome, 0) < 0 && errno == EINTR) continue;
    c->exit_code = WIFEXITED(outcome) ? WEXITSTATUS(outcome) : 128 + WTERMSIG(outcome);
    c->ended = true;
    c->pid = 0;
}

static bool take_line(child *c, char line[CHILD_LINE], bool rest) {
    char *end = memchr(c->line, '\n', c->used);
    size_t length = end ? (size_t)(end - c->line) : c->used;
    if (!end && !(rest && c->used > 0)) return false;
    memcpy(line, c->line, length);
    line[length] = '\0';
    size_t gone = end ? length + 1 : length;
    memmove(c->line, c->line + gone, c->used - gone);
    c->used -= gone;
    return true;
}

bool child_line(child *c, char line[CHILD_LINE]) {
    while (!take_line(c, line, c->fd < 0 || c->used == CHILD_LINE - 1)) {
        if (c->fd < 0) return false;
        ssize_t got = read(c->fd, c->line + c->used, CHILD_LINE - 1 - c->used);
        if (got > 0) c->used += (size_t)got;
        else if (got == 0) finish(c);
        else if (errno != EINTR) return false;
    }
    return true;
}

void child_stop(const child *c) {
    if (c->pid > 0) kill(-c->pid, SIGINT);
}

void child_close(child *c) {
    child_stop(c);
    if (c->fd >= 0) close(c->fd);
    if (c->pid > 0) (void)waitpid(c->pid, NULL, WNOHANG);
    *c = (child){.fd = -1};
}
