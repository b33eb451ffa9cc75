#include "tui/signals.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const struct {
    int number;
    char event;
} soft[] = {
    {SIGINT, SIGNAL_INTERRUPT}, {SIGTERM, SIGNAL_TERMINATE}, {SIGHUP, SIGNAL_TERMINATE},
    {SIGTSTP, SIGNAL_SUSPEND},  {SIGCONT, SIGNAL_CONTINUE},  {SIGWINCH, SIGNAL_RESIZE},
};
static const int fatal[] = {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGQUIT, SIGTRAP, SIGSYS, SIGXCPU, SIGXFSZ};
enum { SOFT = sizeof soft / sizeof *soft, FATAL = sizeof fatal / sizeof *fatal, ALTERNATE_STACK = 64 * 1024 };

static struct {
    int read_end, write_end;
    struct sigaction old_soft[SOFT], old_fatal[FATAL];
    stack_t old_stack;
    void (*_Atomic emergency)(void); /* NULL when not installed, or once it has been called */
    bool exit_hooked;
} state = {.read_end = -1, .write_end = -1};

/* A stack overflow leaves no room for a handler: the thread of the screen brings a stack for it. */
static char alternate_stack[ALTERNATE_STACK];

static void on_soft(int number) {
    int kept = errno;
    for (int i = 0; i < SOFT; i++) {
        if (soft[i].number == number && write(state.write_end, &soft[i].event, 1) < 0) break; /* full: enough is told */
    }
    errno = kept;
}

static void call_emergency(void) {
    void (*emergency)(void) = atomic_exchange(&state.emergency, NULL);
    if (emergency) emergency();
}

static void on_fatal(int number) {
    call_emergency();
    for (int i = 0; i < FATAL; i++) {
        if (fatal[i] == number) sigaction(number, &state.old_fatal[i], NULL);
    }
    raise(number); /* is delivered when this handler returns, to whoever handled it before us */
}

static status make_pipe(report *r) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0)
        return report_set(r, STATUS_SYSTEM, "no pipe for signals: %s", strerror(errno));
    state.read_end = ends[0];
    state.write_end = ends[1];
    return STATUS_OK;
}

/* Installs a handler unless the signal was being ignored (nohup, a parent's choice): then it stays so. */
static void install(int number, const struct sigaction *action, struct sigaction *old) {
    sigaction(number, NULL, old);
    if (old->sa_handler != SIG_IGN) sigaction(number, action, NULL);
}

status signals_install(void (*emergency)(void), report *r) {
    status s = make_pipe(r);
    if (s != STATUS_OK) return s;
    if (!state.exit_hooked) state.exit_hooked = atexit(call_emergency) == 0;
    atomic_store(&state.emergency, emergency);
    stack_t stack = {.ss_sp = alternate_stack, .ss_size = sizeof alternate_stack};
    sigaltstack(&stack, &state.old_stack);
    for (int i = 0; i < SOFT; i++) {
        struct sigaction action = {.sa_handler = on_soft, .sa_flags = SA_RESTART};
        sigfillset(&action.sa_mask);
        install(soft[i].number, &action, &state.old_soft[i]);
    }
    for (int i = 0; i < FATAL; i++) {
        struct sigaction action = {.sa_handler = on_fatal, .sa_flags = SA_ONSTACK};
        sigemptyset(&action.sa_mask);
        install(fatal[i], &action, &state.old_fatal[i]);
    }
    return STATUS_OK;
}

void signals_remove(void) {
    for (int i = 0; i < SOFT; i++) sigaction(soft[i].number, &state.old_soft[i], NULL);
    for (int i = 0; i < FATAL; i++) sigaction(fatal[i], &state.old_fatal[i], NULL);
    sigaltstack(&state.old_stack, NULL);
    atomic_store(&state.emergency, NULL);
    close(state.read_end);
    close(state.write_end);
    state.read_end = state.write_end = -1;
}

int signals_descriptor(void) {
    return state.read_end;
}

void signals_stop_self(void) {
    struct sigaction standard = {.sa_handler = SIG_DFL}, ours;
    sigaction(SIGTSTP, &standard, &ours);
    raise(SIGTSTP);
    sigaction(SIGTSTP, &ours, NULL);
}
