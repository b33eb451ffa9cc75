#include "study/worker.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <spawn.h>
#include <stdarg.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

void worker_words_begin(worker_words *w) {
    w->count = w->texts = 0;
    worker_word(w, "sunder");
}

void worker_word(worker_words *w, const char *word) {
    assert(w->count < WORKER_WORDS);
    w->argv[w->count++] = (char *)word;
    w->argv[w->count] = NULL;
}

void worker_option(worker_words *w, const char *option, const char *format, ...) {
    va_list arguments;
    assert(w->texts < WORKER_TEXTS);
    va_start(arguments, format);
    vsnprintf(w->text[w->texts], WORKER_TEXT, format, arguments);
    va_end(arguments);
    worker_word(w, option);
    worker_word(w, w->text[w->texts++]);
}

static status spawn(worker *w, const worker_words *words, report *r) {
    posix_spawn_file_actions_t actions;
    if (!w->out || !w->error) return report_set(r, STATUS_SYSTEM, "a temporary file for a run's output: %s", strerror(errno));
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, fileno(w->out), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, fileno(w->error), STDERR_FILENO);
    int trouble = posix_spawn(&w->pid, "/proc/self/exe", &actions, NULL, words->argv, environ);
    posix_spawn_file_actions_destroy(&actions);
    return trouble ? report_set(r, STATUS_SYSTEM, "starting a run: %s", strerror(trouble)) : STATUS_OK;
}

status worker_start(worker *w, int run, const worker_words *words, report *r) {
    *w = (worker){.run = run, .out = tmpfile(), .error = tmpfile()};
    status code = spawn(w, words, r);
    if (code != STATUS_OK) worker_close(w);
    return code;
}

int worker_exit_code(int outcome) {
    return WIFEXITED(outcome) ? WEXITSTATUS(outcome) : 128 + WTERMSIG(outcome);
}

/* The text behind `start` in a line, up to its closing quote. */
static bool take_text(const char *line, const char *start, char *out, size_t size) {
    const char *at = strstr(line, start);
    if (!at) return false;
    size_t used = 0;
    for (at += strlen(start); *at && *at != '"' && used + 1 < size; at++) {
        if (*at == '\\' && at[1]) at++;
        out[used++] = *at;
    }
    out[used] = '\0';
    return true;
}

bool worker_member(worker *w, const char *name, char *out, size_t size) {
    char line[4096], start[64];
    snprintf(start, sizeof start, "\"%s\": \"", name);
    rewind(w->out);
    while (fgets(line, sizeof line, w->out))
        if (take_text(line, start, out, size)) return true;
    return false;
}

void worker_complaint(worker *w, char *out, size_t size) {
    char line[4096];
    out[0] = '\0';
    rewind(w->error);
    while (fgets(line, sizeof line, w->error)) {
        line[strcspn(line, "\n")] = '\0';
        const char *text = strncmp(line, "sunder: ", 8) == 0 ? line + 8 : line;
        if (*text) snprintf(out, size, "%s", text);
    }
}

void worker_close(worker *w) {
    if (w->out) fclose(w->out);
    if (w->error) fclose(w->error);
    *w = (worker){.run = -1};
}
