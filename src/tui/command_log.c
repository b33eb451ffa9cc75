/* The command log: every action by name and argument with the frame at which it was done, in memory and in the folder
 * of each run of the session. One line each: "FRAME NAME ARGUMENT"; FRAME is "-" without a run; '#' opens a remark. */
#include "tui/shell.h"

#include "base/memory.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

static const char header[] = "# sunder commands 1: FRAME ACTION ARGUMENT; sunder --replay FILE does them again\n";

static void append(command_log *log, const char *text, size_t size) {
    if (log->used + size + 1 > log->capacity) {
        size_t wanted = 2 * (log->used + size + 1) + 4096;
        char *larger = memory_allocate(wanted);
        if (!larger) return;
        if (log->used) memcpy(larger, log->text, log->used);
        memory_free(log->text, log->capacity);
        log->text = larger;
        log->capacity = wanted;
    }
    memcpy(log->text + log->used, text, size);
    log->used += size;
    log->text[log->used] = '\0';
}

void log_open(tui_app *app) {
    append(&app->shell->log, header, sizeof header - 1);
}

void log_close(tui_app *app) {
    command_log *log = &app->shell->log;
    log_settle(app);
    if (log->file) fclose(log->file);
    memory_free(log->text, log->capacity);
    *log = (command_log){0};
}

int64_t log_frame_now(const tui_app *app) {
    return app->run ? app->shot->frame : -1;
}

void log_line(tui_app *app, int64_t frame, const char *name, const char *argument) {
    command_log *log = &app->shell->log;
    char line[ACTION_ARGUMENT + SHELL_NAME + 32];
    int size = frame < 0 ? snprintf(line, sizeof line, "- %s%s%s\n", name, argument[0] ? " " : "", argument)
                         : snprintf(line, sizeof line, "%lld %s%s%s\n", (long long)frame, name, argument[0] ? " " : "", argument);
    if (size >= (int)sizeof line) return;
    append(log, line, (size_t)size);
    if (log->file) {
        fwrite(line, 1, (size_t)size, log->file);
        fflush(log->file);
    }
    if (app->page == PAGE_COMMANDS) app->dirty = true;
}

void log_defer(tui_app *app) {
    app->shell->log_deferred = !app->ended;
}

void log_pend(tui_app *app, const char *name, const char *argument) {
    char *pending = app->shell->log.pending;
    size_t used = strlen(pending), room = sizeof app->shell->log.pending - used;
    if (snprintf(pending + used, room, "%s%s%s\n", name, argument[0] ? " " : "", argument) >= (int)room) pending[used] = '\0';
}

void log_settle(tui_app *app) {
    char *next, *line = app->shell->log.pending;
    for (; *line; line = next) {
        next = line + strcspn(line, "\n");
        if (*next) *next++ = '\0';
        log_line(app, log_frame_now(app), line, "");
    }
    app->shell->log.pending[0] = '\0';
}

static FILE *write_all(const command_log *log, const char *path, report *r) {
    FILE *file = fopen(path, "we");
    if (file && fwrite(log->text, 1, log->used, file) == log->used && fflush(file) == 0) return file;
    (void)report_set(r, STATUS_SYSTEM, "cannot write %s: %s", path, strerror(errno));
    if (file) fclose(file);
    return NULL;
}

void log_detach(tui_app *app) {
    command_log *log = &app->shell->log;
    if (log->file) fclose(log->file);
    log->file = NULL;
    log->attached = false;
}

void log_attach(tui_app *app) {
    command_log *log = &app->shell->log;
    if (log->attached || !app->shot->output[0]) return;
    log->attached = true;
    tui_shell *shell = app->shell;
    if (shell->run_count < SHELL_RUNS) snprintf(shell->runs[shell->run_count++], sizeof shell->runs[0], "%s", app->shot->run_id);
    if (access(app->shot->output, F_OK) != 0) return; /* nothing is kept of this run */
    char path[TUI_PATH];
    report r;
    if (snprintf(path, sizeof path, "%s/commands.log", app->shot->output) >= (int)sizeof path) return;
    log->file = write_all(log, path, &r);
    if (!log->file) app_fail(app, &r);
}

status log_save(tui_app *app, const char *path, report *r) {
    report_clear(r);
    FILE *file = write_all(&app->shell->log, path, r);
    if (!file) return r->code;
    if (fclose(file) != 0) return report_set(r, STATUS_SYSTEM, "cannot write %s: %s", path, strerror(errno));
    return STATUS_OK;
}
