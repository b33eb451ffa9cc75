/* sunder runs reproduce: a past run once more, from what its folder and its row keep, and whether the bits are the same. */
#include "cli/runs.h"

#include "base/json.h"
#include "session/recall.h"
#include "store/frame_compare.h"
#include "store/frames.h"

#include <math.h>
#include <signal.h>
#include <string.h>

static session *going;
static volatile sig_atomic_t interruptions;

/* Both requests store to an atomic: safe in a handler. */
static void on_interrupt(int number) {
    (void)number;
    if (interruptions++ == 0) session_stop(going);
    else session_abandon(going);
}

typedef struct reproduction {
    char id[LEDGER_ID], folder[1024]; /* of the past run */
    char again[64], again_folder[1024];
    int64_t frames, first; /* first: frame that differs, −1: none */
    frame_difference difference;
} reproduction;

/* Runs it; STATUS_OK when it came to its end. */
static status run_again(ledger *l, const runs_options *o, reproduction *p, script_reports *reports) {
    report *r = &reports->items[0];
    session_recall *recall;
    session_options options;
    session_snapshot shot = {0};
    char line[128];
    reports->count = 1;
    status code = session_recall_run(l, p->id, p->folder, &recall, r);
    if (code != STATUS_OK) return code;
    session_recall_options(recall, &options);
    snprintf(line, sizeof line, "sunder runs reproduce %s", p->id);
    options.command = line;
    options.database = o->path;
    options.output = o->out;
    options.threads = (int)o->threads;
    options.frames = p->frames;
    options.checkpoint_every = 0;
    code = session_start(&options, &going, reports);
    if (code != STATUS_OK) {
        session_recall_free(recall);
        return code;
    }
    reports->count = 1;
    struct sigaction action = {.sa_handler = on_interrupt};
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    session_wait(going, -1);
    code = session_outcome(going, r);
    session_poll(going, &shot);
    snprintf(p->again, sizeof p->again, "%.63s", shot.run_id);
    snprintf(p->again_folder, sizeof p->again_folder, "%.1023s", shot.output);
    session_snapshot_free(&shot);
    session_destroy(going);
    session_recall_free(recall);
    return code;
}

/* The last frame tells: a state that is the same to the bit got there the same way. Where it differs, the first one is looked for. */
static status compare(reproduction *p, report *r) {
    p->first = -1;
    status code = frame_compare(p->folder, p->again_folder, p->frames, &p->difference, r);
    if (code != STATUS_OK || p->difference.same) return code;
    return frame_first_difference(p->folder, p->again_folder, p->frames, &p->first, &p->difference, r);
}

static status print_json(const reproduction *p, report *r) {
    json_writer w;
    json_begin(&w, 0);
    json_object(&w);
    json_member_string(&w, "run_id", p->id);
    json_member_string(&w, "again", p->again);
    json_member_string(&w, "out", p->again_folder);
    json_member_integer(&w, "frames", p->frames);
    json_member_boolean(&w, "same", p->first < 0);
    json_key(&w, "first_difference");
    if (p->first < 0) json_null(&w);
    else {
        json_object(&w);
        json_member_integer(&w, "frame", p->first);
        json_member_string(&w, "array", p->difference.array);
        json_member_number(&w, "largest", p->difference.largest);
        json_object_end(&w);
    }
    json_object_end(&w);
    return cli_print_json(&w, r);
}

static void print_text(const reproduction *p) {
    printf("%s again as %s, %lld frames: ", p->id, p->again, (long long)p->frames);
    if (p->first < 0) printf("the same bits\n");
    else if (isnan(p->difference.largest)) printf("frame %lld differs: %s is not in both, or of another shape\n", (long long)p->first, p->difference.array);
    else printf("frame %lld is the first that differs: %s by up to %.3g\n", (long long)p->first, p->difference.array, p->difference.largest);
}

/* runs reproduce RUN [--out DIR] [--threads N]: exit code 0 for the same bits, 1 for others. */
status verb_reproduce(ledger *l, const runs_options *o, int count, char **names, int *exit, report *r) {
    static script_reports reports;
    static reproduction p;
    if (count != 1) return report_input(r, NULL, 0, "runs reproduce", "one run (an id, its beginning or end, or last)", count ? "more" : "none", NULL);
    status code = runs_find(l, names[0], p.id, p.folder, r);
    if (code != STATUS_OK) return code;
    p.frames = frame_last(p.folder);
    if (p.frames < 0) return report_input(r, p.folder, 0, p.id, "a run with frames to compare with", "none", NULL);
    code = run_again(l, o, &p, &reports);
    if (code != STATUS_OK) {
        *r = reports.items[0];
        return code;
    }
    code = compare(&p, r);
    if (code == STATUS_OK && o->json) code = print_json(&p, r);
    if (code == STATUS_OK && !o->json) print_text(&p);
    *exit = p.first < 0 ? 0 : 1;
    return code;
}
