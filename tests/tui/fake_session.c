#include "tui/fake_session.h"

#include "base/clock.h"
#include "session/recall.h"

#include "base/memory.h"
#include "base/random.h"

#include <errno.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { STEPS_A_FRAME = 40 };

struct session {
    fake_options options;
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    session_snapshot state; /* published; under `lock` */
    float *rest;            /* [particles][3] before anything moved */
    bool paused;            /* under `lock` */
    int steps;              /* frames asked for while paused; under `lock` */
    atomic_bool stop, abandon;
    double started;
};

static void sleep_for(double seconds) {
    struct timespec span = {(time_t)seconds, (long)(1e9 * (seconds - floor(seconds)))};
    while (nanosleep(&span, &span) != 0 && errno == EINTR) {
    }
}

/* ---- the tube ---------------------------------------------------------------------------------------------------- */

static void fill_rest(session *s) {
    double spacing = cbrt(0.475 / (double)s->options.particles);
    int64_t placed = 0, nx = (int64_t)(2 / spacing), ny = (int64_t)(0.6 / spacing) + 1;
    for (uint64_t cell = 0; placed < s->options.particles; cell++) {
        int64_t i = (int64_t)cell % nx, j = (int64_t)cell / nx % ny, k = (int64_t)cell / nx / ny % ny;
        double x = -1 + spacing * ((double)i + random_unit(1, 0, cell));
        double y = -0.3 + spacing * ((double)j + random_unit(1, 1, cell));
        double z = -0.3 + spacing * ((double)k + random_unit(1, 2, cell)), radius = hypot(y, z);
        if (radius < 0.12 || radius > 0.3) continue;
        float *to = s->rest + 3 * placed++;
        to[0] = (float)x;
        to[1] = (float)y;
        to[2] = (float)z;
    }
}

/* Positions and damage at progress t in [0,1]: it stretches and necks, damage grows along a slanted line, and it parts.
 */
static void deform(session *s, double t) {
    session_snapshot *out = &s->state;
    float p = (float)t, gap = p > 0.5f ? (p - 0.5f) * 1.1f : 0;
    for (int64_t i = 0; i < out->point_count; i++) {
        const float *x = s->rest + 3 * i;
        float tear = x[0] - 0.6f * x[1] + 0.05f * sinf(9 * x[1] + 7 * x[2]);
        float neck = 1 - 0.35f * p * expf(-x[0] * x[0] / 0.08f);
        out->position[3 * i] = x[0] * (1 + 0.2f * p) + (tear > 0 ? 0.5f : -0.5f) * gap;
        out->position[3 * i + 1] = x[1] * neck;
        out->position[3 * i + 2] = x[2] * neck;
        out->scalar[i] = s->options.undamaged ? 0 : fminf(expf(-tear * tear / 0.02f) * 1.5f * p, 1);
    }
}

static void measure(session *s, double t) {
    session_snapshot *out = &s->state;
    session_sample *now = &out->now;
    memset(now, 0, sizeof *now);
    now->frame = out->frame;
    now->time = out->time;
    now->seconds = s->options.frame_seconds;
    now->dt = out->dt;
    now->kinetic = 3e-3 + (t > 0.5 ? 0.4 * exp(-20 * (t - 0.5)) : 0);
    now->elastic = 12.5 * (t < 0.5 ? t * t : 0.25 * exp(-12 * (t - 0.5)));
    now->fibre = 0.3 * now->elastic * (1 + 0.1 * sin(30 * t));
    now->work = 3.1 * fmin(t, 0.55);
    for (int64_t i = 0; i < out->point_count; i++) {
        double d = (double)out->scalar[i];
        int bin = (int)(d * SESSION_BINS);
        now->histogram[bin < SESSION_BINS ? bin : SESSION_BINS - 1] += 1 / (double)out->point_count;
        now->damage_mean += d / (double)out->point_count;
        now->damage_max = fmax(now->damage_max, d);
        if (d >= 0.99) now->broken_fraction += 1 / (double)out->point_count;
    }
    if (out->history_count == SESSION_HISTORY) {
        memmove(out->history, out->history + 1, (SESSION_HISTORY - 1) * sizeof *out->history);
        out->history_count--;
    }
    out->history[out->history_count++] = *now;
}

static void publish_frame(session *s, int64_t frame) {
    session_snapshot *out = &s->state;
    double t = (double)frame / (double)s->options.frames;
    double torn = s->options.torn ? 0.7 + 0.3 * t : t;
    out->frame = frame;
    out->step = frame * STEPS_A_FRAME;
    out->time = out->duration * t;
    out->seconds_per_frame = s->options.frame_seconds;
    out->seconds_left = s->options.frame_seconds * (double)(s->options.frames - frame);
    out->wall = clock_seconds() - s->started;
    out->step_wall = 0.9 * out->wall;
    deform(s, torn);
    measure(s, torn);
    if (s->options.warns && frame >= 5) snprintf(out->message, sizeof out->message, "the time step fell to a tenth");
    out->version++;
}

/* ---- the thread -------------------------------------------------------------------------------------------------- */

static void set_state(session *s, session_state state) {
    if (s->state.state == state) return;
    s->state.state = state;
    s->state.version++;
}

/* Waits while paused; false when the run must end. */
static bool may_go_on(session *s) {
    while (s->paused && s->steps == 0 && !atomic_load(&s->stop)) {
        set_state(s, SESSION_PAUSED);
        /* A stop can come from a signal handler, which cannot wake a condition. */
        struct timespec until;
        clock_gettime(CLOCK_REALTIME, &until);
        until.tv_nsec += 5000000;
        if (until.tv_nsec >= 1000000000) {
            until.tv_nsec -= 1000000000;
            until.tv_sec++;
        }
        pthread_cond_timedwait(&s->changed, &s->lock, &until);
    }
    if (atomic_load(&s->stop)) return false;
    if (s->paused) {
        s->steps--;
    } else {
        set_state(s, SESSION_RUNNING);
    }
    return true;
}

static void simulate_frame(session *s, int64_t frame) {
    if (s->options.prints) {
        fprintf(stderr, "library: a complaint about frame %lld\n", (long long)frame);
        printf("library: standard output, frame %lld\n", (long long)frame);
        fflush(stdout);
    }
    if (frame == s->options.crash_at) raise(s->options.crash_signal);
    for (int i = 0; i < STEPS_A_FRAME && !atomic_load(&s->abandon); i++)
        sleep_for(s->options.frame_seconds / STEPS_A_FRAME);
    while (s->options.hold && access(s->options.hold, F_OK) == 0 && !atomic_load(&s->abandon)) sleep_for(0.005);
}

static void *run(void *argument) {
    session *s = argument;
    status outcome = STATUS_OK;
    sleep_for(0.05);
    pthread_mutex_lock(&s->lock);
    publish_frame(s, 0);
    for (int64_t frame = 1; frame <= s->options.frames; frame++) {
        if (!may_go_on(s)) {
            outcome = STATUS_INTERRUPTED;
            break;
        }
        pthread_mutex_unlock(&s->lock);
        simulate_frame(s, frame);
        pthread_mutex_lock(&s->lock);
        if (atomic_load(&s->abandon)) {
            outcome = STATUS_INTERRUPTED;
            break;
        }
        if (frame == s->options.fail_at) {
            outcome = STATUS_DIVERGED;
            snprintf(s->state.message, sizeof s->state.message,
                     "diverged at step %lld: particle 1234 has a velocity that is not finite (elasticity)",
                     (long long)(frame * STEPS_A_FRAME - 7));
            break;
        }
        publish_frame(s, frame);
    }
    s->state.outcome = outcome;
    s->state.seconds_left = 0;
    set_state(s, SESSION_ENDED);
    pthread_cond_broadcast(&s->changed);
    pthread_mutex_unlock(&s->lock);
    return NULL;
}

static void describe(session *s) {
    session_snapshot *out = &s->state;
    snprintf(out->run_id, sizeof out->run_id, "20260714-093012-k7f3");
    snprintf(out->title, sizeof out->title, "Tube pull");
    snprintf(out->variant, sizeof out->variant, "full");
    snprintf(out->output, sizeof out->output, "runs/20260714-093012-k7f3");
    snprintf(out->precision, sizeof out->precision, "f32");
    snprintf(out->simd, sizeof out->simd, "avx2");
    static const char *const effects[] = {"elastic", "fibres", "damage", "gravity", "grips"};
    for (int i = 0; i < 5; i++) {
        if (s->options.undamaged && i == 2) continue;
        snprintf(out->effects[out->effect_count++], sizeof out->effects[0], "%s", effects[i]);
    }
    out->threads = 2;
    out->frames = s->options.frames;
    out->particles = out->point_count = out->point_capacity = s->options.particles;
    out->duration = 7;
    out->dt = out->dt_min = 1.042e-3;
    out->dt_max = 2.1e-3;
    const float low[3] = {-1, -0.3f, -0.3f}, high[3] = {1, 0.3f, 0.3f};
    memcpy(out->bounds_minimum, low, sizeof low);
    memcpy(out->bounds_maximum, high, sizeof high);
}

session *fake_session_start(const fake_options *options) {
    session *s = memory_allocate(sizeof *s);
    if (!s) return NULL;
    s->options = *options;
    s->paused = options->start_paused;
    s->started = clock_seconds();
    size_t count = (size_t)options->particles;
    s->rest = memory_allocate_array(3 * count, sizeof(float));
    s->state.position = memory_allocate_array(3 * count, sizeof(float));
    s->state.scalar = memory_allocate_array(count, sizeof(float));
    s->state.body = memory_allocate_array(count, sizeof(int32_t));
    if (!s->rest || !s->state.position || !s->state.scalar || !s->state.body) exit(1);
    fill_rest(s);
    describe(s);
    pthread_mutex_init(&s->lock, NULL);
    pthread_cond_init(&s->changed, NULL);
    if (pthread_create(&s->thread, NULL, run, s) != 0) exit(1);
    return s;
}

/* ---- session.h --------------------------------------------------------------------------------------------------- */

static void free_points(session_snapshot *snapshot) {
    size_t count = (size_t)snapshot->point_capacity;
    memory_free(snapshot->position, 3 * count * sizeof(float));
    memory_free(snapshot->scalar, count * sizeof(float));
    memory_free(snapshot->body, count * sizeof(int32_t));
}

bool session_poll(session *s, session_snapshot *snapshot) {
    pthread_mutex_lock(&s->lock);
    bool fresh = s->state.version != snapshot->version;
    if (fresh) {
        session_snapshot kept = *snapshot;
        size_t count = (size_t)s->state.point_count;
        if (kept.point_capacity < s->state.point_count) {
            free_points(&kept);
            kept.position = memory_allocate_array(3 * count, sizeof(float));
            kept.scalar = memory_allocate_array(count, sizeof(float));
            kept.body = memory_allocate_array(count, sizeof(int32_t));
            kept.point_capacity = s->state.point_count;
        }
        *snapshot = s->state;
        snapshot->position = memcpy(kept.position, s->state.position, 3 * count * sizeof(float));
        snapshot->scalar = memcpy(kept.scalar, s->state.scalar, count * sizeof(float));
        snapshot->body = memcpy(kept.body, s->state.body, count * sizeof(int32_t));
        snapshot->point_capacity = kept.point_capacity;
    }
    pthread_mutex_unlock(&s->lock);
    return fresh;
}

void session_snapshot_free(session_snapshot *snapshot) {
    free_points(snapshot);
    memset(snapshot, 0, sizeof *snapshot);
}

void session_pause(session *s, bool paused) {
    pthread_mutex_lock(&s->lock);
    s->paused = paused;
    s->steps = 0;
    pthread_cond_broadcast(&s->changed);
    pthread_mutex_unlock(&s->lock);
}

void session_step_once(session *s) {
    pthread_mutex_lock(&s->lock);
    s->steps++;
    pthread_cond_broadcast(&s->changed);
    pthread_mutex_unlock(&s->lock);
}

void session_run_to(session *s, int64_t frame) {
    (void)frame;
    session_pause(s, false);
}

int session_knobs(session *s, knob *out, int limit) {
    (void)s, (void)out, (void)limit;
    return 0;
}

status session_turn(session *s, const char *path, const double value[3], report *r) {
    (void)s, (void)value;
    return report_input(r, NULL, 0, path, "a knob", "a session that has none", NULL);
}

status session_turn_text(session *s, const char *path, const char *value, report *r) {
    (void)s, (void)value;
    return report_input(r, NULL, 0, path, "a knob", "a session that has none", NULL);
}

int session_turns(session *s, knob_turn *out, int limit) {
    (void)s, (void)out, (void)limit;
    return 0;
}

int session_checkpoints(session *s, int64_t *frames, int limit) {
    (void)s, (void)frames, (void)limit;
    return 0;
}

status session_save_recipe(session *s, int material, const char *path, char file[SESSION_RECIPE], report *r) {
    (void)s, (void)material, (void)file;
    return report_input(r, path, 0, NULL, "a material", "a session that has none", NULL);
}

int session_colours(session *s, char (*names)[32], int limit) {
    (void)s;
    if (limit > 0) snprintf(names[0], sizeof names[0], "damage");
    return 1;
}

status session_colour(session *s, const char *name, report *r) {
    (void)s;
    return strcmp(name, "damage") == 0 ? STATUS_OK : report_input(r, NULL, 0, "colour", "a field of this run", name, "damage");
}

void session_stop(session *s) {
    atomic_store(&s->stop, true);
}

void session_abandon(session *s) {
    atomic_store(&s->abandon, true);
    atomic_store(&s->stop, true);
}

bool session_wait(session *s, double seconds) {
    double until = clock_seconds() + seconds;
    for (;;) {
        pthread_mutex_lock(&s->lock);
        bool ended = s->state.state == SESSION_ENDED;
        pthread_mutex_unlock(&s->lock);
        if (ended || (seconds >= 0 && clock_seconds() >= until)) return ended;
        sleep_for(0.005);
    }
}

status session_outcome(session *s, report *r) {
    if (s->state.outcome == STATUS_OK) {
        report_clear(r);
        return STATUS_OK;
    }
    return report_set(r, s->state.outcome, "%s", s->state.message[0] ? s->state.message : "stopped");
}

void session_destroy(session *s) {
    session_abandon(s);
    pthread_join(s->thread, NULL);
    free_points(&s->state);
    memory_free(s->rest, 3 * (size_t)s->options.particles * sizeof(float));
    memory_free(s, sizeof *s);
}

/* The program's runs cannot be started here. */
status session_start(const session_options *options, session **out, script_reports *reports) {
    *out = NULL;
    reports->count = 1;
    return report_input(&reports->items[0], options->scene_path, 0, NULL, "a scene file", "a synthetic session only", NULL);
}

int64_t session_turn_frame(session *s) {
    return s->state.frame;
}

void session_request(const session *s, session_options *out) {
    (void)s;
    *out = (session_options){.scene_path = "tube_pull.lua", .simd = "auto", .precision = 32, .frames = -1, .checkpoint_every = 1, .keep = 2};
}

session_options session_options_default(void) {
    return (session_options){.simd = "auto", .precision = 32, .frames = -1, .checkpoint_every = 1, .keep = 2};
}

/* ---- recall.h: a synthetic run leaves no folder to be run again from -------------------------------------------- */

status session_recall_run(ledger *l, const char *id, const char *folder, session_recall **out, report *r) {
    (void)l, (void)id;
    *out = NULL;
    return report_input(r, folder, 0, "resume", "the folder of a run of sunder", "a synthetic one", NULL);
}

void session_recall_options(const session_recall *recall, session_options *out) {
    (void)recall;
    *out = session_options_default();
}

void session_recall_free(session_recall *recall) {
    (void)recall;
}
