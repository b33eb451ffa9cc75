#include "session/session.h"

#include "base/clock.h"
#include "base/memory.h"
#include "session/internal.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

session_options session_options_default(void) {
    return (session_options){.script = script_options_default(), .simd = "auto", .precision = 32, .frames = -1,
                             .checkpoint_every = CHECKPOINTS_AS_NEEDED, .keep = 2, .deflate = 1};
}

/* ---- folders that this process writes ---------------------------------------------------------------------------- */

enum { CLAIMS = 64 };
static pthread_mutex_t claims_lock = PTHREAD_MUTEX_INITIALIZER;
static session *claims[CLAIMS];

/* A run that another session of this process is still writing must not be resumed: its frames would be cut under its feet. (The ledger knows of
 * other processes.) */
static status claim_folder(session *s, report *r) {
    session **place = NULL;
    bool taken = false;
    pthread_mutex_lock(&claims_lock);
    for (int i = 0; i < CLAIMS; i++) {
        taken |= claims[i] && strcmp(claims[i]->folder, s->folder) == 0;
        if (!claims[i] && !place) place = &claims[i];
    }
    if (!taken && place) *place = s;
    pthread_mutex_unlock(&claims_lock);
    if (taken) return report_input(r, s->folder, 0, "resume", "a run that has ended", "one that this process is still writing", NULL);
    return place ? STATUS_OK : report_set(r, STATUS_SYSTEM, "more than %d sessions at a time", (int)CLAIMS);
}

void session_release_folder(const session *s) {
    pthread_mutex_lock(&claims_lock);
    for (int i = 0; i < CLAIMS; i++)
        if (claims[i] == s) claims[i] = NULL;
    pthread_mutex_unlock(&claims_lock);
}

/* ---- starting ---------------------------------------------------------------------------------------------------- */

static status open_ledger(session *s, report *r) {
    return ledger_open_given(s->options.database, s->database, sizeof s->database, &s->ledger, r);
}

static status find_resumed(session *s, report *r) {
    status code = ledger_resolve(s->ledger, s->options.resume, s->id, s->folder, sizeof s->folder, r);
    if (code == STATUS_OK) code = request_read(&s->request, s->folder, r);
    return code;
}

/* The run that a branch leaves; its folder says how it was asked for. */
static status find_parent(session *s, report *r) {
    status code = ledger_resolve(s->ledger, s->options.branch_of, s->parent, s->parent_folder, sizeof s->parent_folder, r);
    if (code == STATUS_OK) code = request_read(&s->request, s->parent_folder, r);
    if (code != STATUS_OK) return code;
    int64_t last = frame_last(s->parent_folder);
    s->past_until = s->options.branch_frame;
    if (s->past_until >= 0 && s->past_until <= last) return STATUS_OK;
    char expected[96], found[32], nearest[32];
    snprintf(expected, sizeof expected, "a frame that %.40s has, from 0 to %lld", s->parent, (long long)last);
    snprintf(found, sizeof found, "%lld", (long long)s->past_until);
    snprintf(nearest, sizeof nearest, "%lld", (long long)last);
    return report_input(r, NULL, 0, "branch", expected, found, last >= 0 ? nearest : NULL);
}

static status load_scene(session *s, script_reports *reports) {
    script_options options = s->options.script;
    options.recipe = s->request.recipe[0] ? s->request.recipe : NULL;
    options.settings = s->request.settings;
    options.setting_count = s->request.setting_count;
    status code = script_load(s->request.scene, &options, &s->script, reports);
    if (code != STATUS_OK) return code;
    s->scene = script_scene(s->script);
    sources_hash(s->script, s->hash);
    return STATUS_OK;
}

static status make_simulation(session *s, report *r) {
    simulation_options options = {.threads = s->options.threads, .precision = s->request.precision, .simd = s->request.simd};
    status code = simulation_create(s->scene, &options, &s->simulation, r);
    if (code != STATUS_OK) return code;
    s->target = s->request.frames >= 0 ? s->request.frames : scene_frames(s->scene);
    return STATUS_OK;
}

static void tell_of_damaged(session *s, const report *warning) {
    char text[512];
    if (warning->code == STATUS_OK) return;
    report_format(warning, text, sizeof text);
    session_warn(s, simulation_frame(s->simulation), text);
}

/* Back to the last checkpoint; frames after it are written again. Nothing in the folder is touched before all that could be refused has been. */
static status restore(session *s, report *r) {
    record_list records = {0};
    int64_t frame = 0;
    report warning, ignored;
    report_clear(&warning);
    status code = checkpoint_read_last(s->folder, &records, &frame, &warning, r);
    if (code == STATUS_OK && s->options.frames >= 0) s->target = frame + s->options.frames;
    if (code == STATUS_OK) code = turns_resume(s, s->folder, INT64_MAX, frame, frame, &records, r);
    if (code == STATUS_OK) code = simulation_restore(s->simulation, &records, r);
    record_clear(&records);
    if (code == STATUS_OK) code = ledger_reopen(s->ledger, s->id, r); /* refuses a run that still lives: its frames stay */
    if (code == STATUS_OK) code = frame_truncate(s->folder, frame, r);
    if (code == STATUS_OK && s->knobs.count > 0) code = turns_write(s, r);
    if (code != STATUS_OK) return code;
    session_tolerate(s, ledger_cut_events(s->ledger, s->id, frame, &ignored), &ignored);
    tell_of_damaged(s, &warning);
    s->steps_before = simulation_steps(s->simulation);
    return STATUS_OK;
}

/* To the parent's newest checkpoint up to the branch's frame, or to the scene's own start where there is none; the rest of the way is computed again. */
static status restore_parent(session *s, report *r) {
    record_list records = {0};
    int64_t frame = -1, start;
    report warning;
    status code = checkpoint_read_before(s->parent_folder, s->past_until, &records, &frame, &warning, r);
    start = s->past_from = frame < 0 ? 0 : frame;
    if (s->options.frames >= 0) s->target = s->past_until + s->options.frames;
    if (code == STATUS_OK) code = turns_resume(s, s->parent_folder, s->past_until, s->past_until, start, &records, r);
    if (code == STATUS_OK && frame >= 0) code = simulation_restore(s->simulation, &records, r);
    record_clear(&records);
    s->steps_before = simulation_steps(s->simulation);
    if (code == STATUS_OK) tell_of_damaged(s, &warning);
    return code;
}

static void effect_names(const simulation_plan *plan, char *text, size_t size) {
    size_t used = 0;
    text[0] = '\0';
    for (int e = 0; e < plan->effect_count; e++)
        if ((plan->mask >> e & 1) && used < size)
            used += (size_t)snprintf(text + used, size - used, "%s%s", used ? "," : "", plan->effects[e]->name);
}

static const char *variant_of(const scene *s) {
    for (int i = 0; i < s->parameter_count; i++)
        if (strcmp(s->parameters[i].name, "variant") == 0) return s->parameters[i].text;
    return NULL;
}

static status log_parameters(session *s, report *r) {
    for (int i = 0; i < s->scene->parameter_count; i++) {
        const scene_parameter *p = &s->scene->parameters[i];
        status code = ledger_parameter(s->ledger, s->id, p->name, p->unit, p->number, p->is_text ? p->text : NULL, p->from_set, r);
        if (code != STATUS_OK) return code;
    }
    return STATUS_OK;
}

/* The run's folder as an absolute path: --out, or a folder named by the id. */
static status choose_folder(session *s, report *r) {
    char base[SESSION_PATH];
    const char *given = s->options.output;
    status code = STATUS_OK;
    if (!given) code = ledger_runs_folder(base, sizeof base, r);
    else if (!*given) code = report_input(r, NULL, 0, "--out", "the folder of a run", "an empty name", NULL);
    else if (*given != '/' && !getcwd(base, sizeof base)) code = report_set(r, STATUS_SYSTEM, "current folder: %s", strerror(errno));
    if (code != STATUS_OK) return code;
    bool absolute = given && *given == '/';
    int length = snprintf(s->folder, sizeof s->folder, "%s%s%s", absolute ? "" : base, absolute ? "" : "/", given ? given : s->id);
    if (length < (int)sizeof s->folder) return STATUS_OK;
    char expected[64], found[64];
    snprintf(expected, sizeof expected, "the path of a folder under %d bytes", SESSION_PATH);
    snprintf(found, sizeof found, "one of %d", length);
    return report_input(r, NULL, 0, "--out", expected, found, NULL);
}

static status begin_row(session *s, report *r) {
    const simulation_plan *plan = simulation_get_plan(s->simulation);
    char effects[256];
    effect_names(plan, effects, sizeof effects);
    ledger_run run = {.scene_path = s->options.scene_path, .scene_title = s->scene->title, .scene_hash = s->hash,
                      .variant = variant_of(s->scene), .command = s->options.command, .output = s->folder,
                      .precision = plan->precision == 32 ? "f32" : "f64", .simd = plan->simd, .version = SUNDER_VERSION,
                      .effects = effects, .threads = plan->threads, .particles = plan->particles, .frames_wanted = s->target,
                      .seed = (int64_t)s->scene->seed, .parent = s->parent[0] ? s->parent : NULL, .parent_frame = s->past_until};
    return ledger_begin(s->ledger, &run, s->id, r);
}

/* The row, its folder's name and its parameters are one transaction: a row without them is never seen. */
static status begin_rows(session *s, report *r) {
    status code = ledger_batch_begin(s->ledger, r);
    if (code != STATUS_OK) return code;
    code = begin_row(s, r);
    if (code == STATUS_OK && !s->options.output) {
        code = choose_folder(s, r);
        if (code == STATUS_OK) code = ledger_set_output(s->ledger, s->id, s->folder, r);
    }
    if (code == STATUS_OK) code = log_parameters(s, r);
    if (code == STATUS_OK && s->parent[0]) code = ledger_copy_past(s->ledger, s->parent, s->id, s->past_until, r);
    return ledger_batch_end(s->ledger, code, r);
}

/* A new run: its folder, its row, its scripts. A folder that was asked for is made before the row, so that a wrong name leaves none;
 * after that, a row whose run cannot start ends as failed. */
static status begin(session *s, report *r) {
    status code = STATUS_OK;
    if (s->options.output) {
        code = choose_folder(s, r);
        if (code == STATUS_OK) code = run_folder_create(s->folder, false, r);
    }
    if (code == STATUS_OK) code = begin_rows(s, r);
    if (code != STATUS_OK) return code;
    if (!s->options.output) code = run_folder_create(s->folder, false, r);
    if (code == STATUS_OK) code = sources_write(s, r);
    if (code == STATUS_OK) code = request_write(s, r);
    if (code == STATUS_OK && s->knobs.count > 0) code = turns_write(s, r);
    if (code == STATUS_OK && s->parent[0]) code = frame_adopt(s->parent_folder, s->folder, s->past_until, r);
    if (code == STATUS_OK) return code;
    char text[768];
    report ignored;
    report_format(r, text, sizeof text);
    (void)ledger_finish(s->ledger, s->id, "failed", 0, 0, 0, text, NULL, &ignored);
    return code;
}

static status prepare(session *s, script_reports *reports) {
    report *r = &reports->items[0];
    reports->count = 0;
    status code = STATUS_OK;
    bool goes_on = s->options.resume || s->options.branch_of;
    if (goes_on) code = open_ledger(s, r);
    else code = request_from_options(&s->request, &s->options, r);
    if (code == STATUS_OK && s->options.resume) code = find_resumed(s, r);
    if (code == STATUS_OK && s->options.branch_of) code = find_parent(s, r);
    if (code == STATUS_OK && s->options.resume) code = claim_folder(s, r);
    if (code == STATUS_OK) {
        code = load_scene(s, reports);
        if (code != STATUS_OK) return code; /* the script has filled in its reports */
        code = make_simulation(s, r);
    }
    if (code == STATUS_OK && !goes_on) code = turns_begin(s, r);
    if (code == STATUS_OK && s->options.branch_of) code = restore_parent(s, r);
    if (code == STATUS_OK && !s->ledger) code = open_ledger(s, r);
    if (code == STATUS_OK) code = s->options.resume ? restore(s, r) : begin(s, r);
    if (code == STATUS_OK && !s->options.resume) code = claim_folder(s, r);
    reports->count = code != STATUS_OK;
    return code;
}

status session_start(const session_options *options, session **out, script_reports *reports) {
    *out = NULL;
    session *s = memory_allocate(sizeof *s);
    if (!s) {
        reports->count = 1;
        return report_set(&reports->items[0], STATUS_SYSTEM, "out of memory for the session");
    }
    s->options = *options;
    s->wall_start = clock_seconds();
    pthread_mutex_init(&s->lock, NULL);
    pthread_mutex_init(&s->knobs.lock, NULL);
    pthread_mutex_init(&s->ledger_lock, NULL);
    pthread_mutex_init(&s->filing.lock, NULL);
    pthread_cond_init(&s->filing.changed, NULL);
    s->checkpointed = -1;
    atomic_store(&s->pause_at, -1);
    s->past_until = -1;
    atomic_store(&s->paused, options->start_paused);
    status code = prepare(s, reports);
    if (code == STATUS_OK) {
        publish_start(s);
        turns_start(s);
        if (pthread_create(&s->thread, NULL, session_loop, s) != 0) {
            reports->count = 1;
            code = report_set(&reports->items[0], STATUS_SYSTEM, "no thread for the simulation");
        } else {
            s->threaded = true;
        }
    }
    if (code != STATUS_OK) {
        session_destroy(s);
        return code;
    }
    *out = s;
    return STATUS_OK;
}

void session_pause(session *s, bool paused) {
    atomic_store(&s->paused, paused);
}

void session_step_once(session *s) {
    atomic_fetch_add(&s->steps_asked, 1);
}

int session_checkpoints(session *s, int64_t *frames, int limit) {
    return checkpoint_frames(s->folder, frames, limit);
}

void session_run_to(session *s, int64_t frame) {
    atomic_store(&s->pause_at, frame);
    atomic_store(&s->paused, 0);
}

void session_stop(session *s) {
    atomic_store(&s->stop, 1);
}

void session_abandon(session *s) {
    atomic_store(&s->abandon, 1);
}

bool session_wait(session *s, double seconds) {
    double end = clock_seconds() + seconds;
    while (!atomic_load(&s->ended) && (seconds < 0 || clock_seconds() < end))
        nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
    return atomic_load(&s->ended);
}

status session_outcome(session *s, report *r) {
    *r = s->report;
    return s->outcome;
}

const char *session_summary(session *s) {
    return s->summary.text;
}

void session_request(const session *s, session_options *out) {
    *out = s->options;
    request_to_options(&s->request, out);
    out->output = out->resume = out->branch_of = NULL;
    out->branch_frame = 0;
    out->turns = NULL;
    out->turn_count = 0;
    out->database = s->database[0] ? s->database : NULL;
    out->start_paused = false;
}

void session_destroy(session *s) {
    if (!s) return;
    if (s->threaded) {
        if (!atomic_load(&s->ended)) session_stop(s);
        pthread_join(s->thread, NULL);
    }
    session_release_folder(s);
    simulation_destroy(s->simulation);
    if (s->script) script_close(s->script);
    if (s->ledger) ledger_close(s->ledger);
    session_snapshot_free(&s->shown);
    json_free(&s->summary);
    turns_free(s);
    pthread_cond_destroy(&s->filing.changed);
    pthread_mutex_destroy(&s->filing.lock);
    pthread_mutex_destroy(&s->ledger_lock);
    pthread_mutex_destroy(&s->knobs.lock);
    pthread_mutex_destroy(&s->lock);
    memory_free(s, sizeof *s);
}
