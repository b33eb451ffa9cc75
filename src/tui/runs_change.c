/* What is written about runs, taking them away, and running them again. */
#include "tui/runs.h"

#include "session/recall.h"
#include "store/frame_compare.h"
#include "store/frames.h"
#include "store/run_folder.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- tags and notes ---------------------------------------------------------------------------------------------- */

status runs_tag(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    bool on = argument[0] != '-';
    /* Of a page that shows runs, those. */
    status code = s->page == RUNS_TABLE || s->shown_count == 0 ? runs_choose_shown(s, 1, r) : STATUS_OK;
    if (code == STATUS_OK) code = ledger_batch_begin(s->l, r);
    if (code != STATUS_OK) return code;
    for (int i = 0; i < s->shown_count && code == STATUS_OK; i++) {
        code = ledger_tag(s->l, s->shown[i], argument + !on, on, r);
        if (code == STATUS_INPUT && !on && s->shown_count > 1) code = STATUS_OK; /* not all of them have it */
    }
    code = ledger_batch_end(s->l, code, r);
    runs_reload(app, s, true);
    if (code == STATUS_OK) app_notice(app, "%s %s %d run%s", argument + !on, on ? "on" : "off", s->shown_count, s->shown_count == 1 ? "" : "s");
    return code;
}

status runs_note(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    char id[LEDGER_ID], folder[1024];
    status code = runs_named(app, s, "", id, folder, r);
    if (code == STATUS_OK) code = ledger_note(s->l, id, argument, r);
    if (code != STATUS_OK) return code;
    runs_reload(app, s, true);
    app_notice(app, "noted about %s", id);
    return STATUS_OK;
}

/* ---- taking away ------------------------------------------------------------------------------------------------- */

static const char *parent_of(const runs_state *s, const char *id) {
    const run_column *c;
    report unused;
    int row = s->table ? run_table_find(s->table, id) : -1;
    return row >= 0 && run_table_column(s->table, "parent", &c, &unused) == STATUS_OK ? c->text[row] : NULL;
}

status runs_delete(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    char id[LEDGER_ID], folder[1024];
    run_folder_removal files;
    (void)argument;
    status code = runs_named(app, s, "", id, folder, r);
    if (code == STATUS_OK) code = run_folder_remove(folder, id, parent_of(s, id), true, &files, r);
    if (code != STATUS_OK) return code;
    app_ask(app, "runs.delete-now", id, 0, "Take %s away for good, with %" PRId64 " files (%.1f MB)? y/n", id, files.files, 1e-6 * (double)files.bytes);
    return STATUS_OK;
}

status runs_delete_now(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    char id[LEDGER_ID], folder[1024];
    run_folder_removal files;
    status code = runs_named(app, s, argument, id, folder, r);
    if (code == STATUS_OK && app->run && !app->ended && strcmp(app->shot->run_id, id) == 0)
        return report_set(r, STATUS_INPUT, "%s is the run that goes on: stop it first.", id); /* the ledger believes this process */
    if (code == STATUS_OK) code = run_folder_remove(folder, id, parent_of(s, id), true, &files, r);
    if (code == STATUS_OK) code = ledger_remove(s->l, id, r);
    if (code != STATUS_OK) return code;
    if (s->page != RUNS_TABLE) (void)runs_back(app, "", r);
    code = run_folder_remove(folder, id, parent_of(s, id), false, &files, r); /* the table is still the one from before */
    runs_reload(app, s, true);
    if (code == STATUS_OK && files.kept) app_notice(app, "%s is gone; %d files that are no run's stay in %s", id, files.kept, folder);
    else if (code == STATUS_OK) app_notice(app, "%s is gone", id);
    return code;
}

/* ---- once more --------------------------------------------------------------------------------------------------- */

status runs_reproduce(tui_app *app, const char *argument, report *r) {
    runs_state *s = runs_state_of(app);
    char id[LEDGER_ID], folder[1024], line[128];
    session_recall *recall;
    session_options options;
    status code = runs_named(app, s, argument, id, folder, r);
    if (code != STATUS_OK) return code;
    app_log_argument(app, "%s", id);
    if (app->run && !app->ended && !argument[0]) {
        app_ask(app, "runs.reproduce", id, 0, "Stop the run that goes on, and run %s again? y/n", id);
        return STATUS_OK;
    }
    int64_t last = frame_last(folder);
    if (last < 0) return report_input(r, folder, 0, id, "a run with frames to compare with", "none", NULL);
    code = session_recall_run(s->l, id, folder, &recall, r);
    if (code != STATUS_OK) return code;
    session_recall_options(recall, &options);
    snprintf(line, sizeof line, "sunder runs reproduce %s", id);
    options.command = line;
    options.frames = last;
    code = app_start_run(app, &options, r);
    session_recall_free(recall);
    if (code != STATUS_OK) return code;
    snprintf(s->again_of, sizeof s->again_of, "%s", id);
    snprintf(s->again_folder, sizeof s->again_folder, "%s", folder);
    return STATUS_OK;
}

void runs_tick_reproduction(tui_app *app, runs_state *s) {
    frame_difference difference;
    int64_t frame;
    report r;
    if (!s->again_of[0] || app_starting(app) || !app->run || !app->ended) return;
    const session_snapshot *shot = app->shot;
    if (shot->state != SESSION_ENDED) return;
    int64_t last = frame_last(s->again_folder);
    if (shot->outcome == STATUS_OK && shot->frame == last) {
        status code = frame_compare(s->again_folder, shot->output, last, &difference, &r);
        if (code == STATUS_OK && difference.same) app_notice(app, "%s again: the same bits at frame %" PRId64, s->again_of, last);
        else if (code == STATUS_OK && frame_first_difference(s->again_folder, shot->output, last, &frame, &difference, &r) == STATUS_OK)
            app_notice(app, "%s again: frame %" PRId64 " is the first that differs (%s by up to %.3g)", s->again_of, frame, difference.array, difference.largest);
        else app_fail(app, &r);
    }
    s->again_of[0] = '\0';
}
