/* Replays: the lines of a command log done again, each when the run has come to its frame. The replay itself lets the run
 * go on and pauses it, so that what was done by hand at a frame is done there, however fast frames are now. */
#include "tui/actions.h"
#include "tui/shell.h"

#include "base/memory.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { REPLAY_LARGEST = 64 << 20 /* bytes of a log */ };

static status refuse(const tui_replay *p, const char *expected, const char *found, report *r) {
    return report_input(r, p->path, p->line, NULL, expected, found, NULL);
}

status replay_open(tui_app *app, const char *path, report *r) {
    tui_replay *p = &app->shell->replay;
    snprintf(p->path, sizeof p->path, "%s", path);
    FILE *file = fopen(path, "re");
    if (!file) return report_input(r, path, 0, NULL, "a command log", strerror(errno), NULL);
    p->capacity = 64 * 1024;
    p->text = memory_allocate(p->capacity);
    size_t used = 0, got = 0;
    while (p->text && (got = fread(p->text + used, 1, p->capacity - 1 - used, file)) > 0) {
        used += got;
        if (used + 1 < p->capacity) continue;
        if (p->capacity >= REPLAY_LARGEST) break;
        char *larger = memory_resize(p->text, p->capacity, 2 * p->capacity);
        if (!larger) break;
        p->text = larger;
        p->capacity *= 2;
    }
    bool whole = p->text && feof(file) && !ferror(file);
    fclose(file);
    if (!whole) return report_set(r, STATUS_SYSTEM, "cannot read all of %s", path);
    p->text[used] = '\0';
    p->next = p->text;
    p->active = true;
    return STATUS_OK;
}

void replay_close(tui_app *app) {
    tui_replay *p = &app->shell->replay;
    memory_free(p->text, p->capacity);
    p->text = p->next = NULL;
    p->active = false;
}

/* ---- lines ------------------------------------------------------------------------------------------------------- */

/* Reads the next line that is one into frame, name, argument; false at the end. */
static bool next_line(tui_replay *p, report *r) {
    report_clear(r);
    while (*p->next) {
        char *text = p->next, *end = text + strcspn(text, "\n"), *after;
        p->next = *end ? end + 1 : end;
        p->line++;
        size_t size = (size_t)(end - text);
        if (size == 0 || text[0] == '#') continue;
        *end = '\0';
        p->frame = -1;
        if (text[0] == '-') after = text + 1;
        else p->frame = strtoll(text, &after, 10);
        if (after == text || *after != ' ') {
            (void)refuse(p, "\"FRAME ACTION ARGUMENT\"", text, r);
            return false;
        }
        after++;
        size_t name = strcspn(after, " ");
        if (name == 0 || name >= sizeof p->name || strlen(after) >= sizeof p->argument) {
            (void)refuse(p, "an action", after, r);
            return false;
        }
        snprintf(p->name, sizeof p->name, "%.*s", (int)name, after);
        snprintf(p->argument, sizeof p->argument, "%s", after + name + (after[name] == ' '));
        return true;
    }
    return false;
}

/* Whether the run is where the line is to be done; lets it go on when it is not. */
static bool arrived(tui_app *app, tui_replay *p) {
    const session_snapshot *s = app->shot;
    if (app_starting(app)) return false;
    if (p->frame < 0 || !app->run || app->ended || app->stopping) return !app->stopping || app->ended;
    if (s->state == SESSION_PAUSED && s->frame >= p->frame) return true;
    if (p->sent_to != p->frame || p->sent_run != app->run) {
        session_run_to(app->run, p->frame);
        p->sent_to = p->frame;
        p->sent_run = app->run;
    }
    return false;
}

static void end(tui_app *app, tui_replay *p, const report *r) {
    p->active = false;
    if (r->code != STATUS_OK) {
        p->outcome = *r;
        app_fail(app, r);
        if (!app->headless) return;
        app_end_run(app);
    } else if (app->run && !app->ended && !app->stopping) {
        session_pause(app->run, false);
    }
    if (app->headless) app->leave_at_end = true;
}

static status do_line(tui_app *app, tui_replay *p, report *r) {
    action_place place;
    char trouble[600];
    if (actions_find(app, p->name, &place) && place.action->paces) return STATUS_OK;
    if (app_do(app, p->name, p->argument, r) == STATUS_OK) return STATUS_OK;
    report_format(r, trouble, sizeof trouble);
    return refuse(p, "an action that can be done here", trouble, r);
}

void replay_fail(tui_app *app, const report *r) {
    tui_replay *p = &app->shell->replay;
    if (!app->options.replay || p->outcome.code != STATUS_OK) return;
    end(app, p, r);
    p->outcome = *r;
}

void replay_tick(tui_app *app) {
    tui_replay *p = &app->shell->replay;
    report r;
    while (p->active && !app->leaving) {
        if (!p->read) {
            p->read = next_line(p, &r);
            if (!p->read && app_starting(app) && r.code == STATUS_OK) return;
            if (!p->read) {
                end(app, p, &r);
                return;
            }
        }
        if (!arrived(app, p)) return;
        p->read = false;
        if (do_line(app, p, &r) != STATUS_OK) end(app, p, &r);
    }
}
