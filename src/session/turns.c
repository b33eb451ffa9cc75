/* Turns of knobs in a run: asked for from any thread, acting between frames. */
#include "base/memory.h"
#include "session/internal.h"

#include <stdio.h>
#include <string.h>

/* ---- lists ------------------------------------------------------------------------------------------------------- */

/* Room for one more at `index`, what follows moved on; NULL when out of memory. */
static knob_turn *insert_turn(knob_turn **list, int *count, int *capacity, int index) {
    if (*count == *capacity) {
        int wanted = *capacity ? 2 * *capacity : 16;
        knob_turn *grown = memory_allocate_array((size_t)wanted, sizeof *grown);
        if (!grown) return NULL;
        if (*count) memcpy(grown, *list, (size_t)*count * sizeof *grown);
        memory_free(*list, (size_t)*capacity * sizeof **list);
        *list = grown;
        *capacity = wanted;
    }
    memmove(*list + index + 1, *list + index, (size_t)(*count - index) * sizeof **list);
    ++*count;
    return *list + index;
}

/* After those of its frame, before those of later ones. */
static status add_turn(session_knobs_state *k, const knob_turn *turn, report *r) {
    int at = k->count;
    while (at > k->acted && k->turns[at - 1].frame > turn->frame) at--;
    knob_turn *place = insert_turn(&k->turns, &k->count, &k->capacity, at);
    if (!place) return report_set(r, STATUS_SYSTEM, "out of memory for the turns of knobs");
    *place = *turn;
    return STATUS_OK;
}

void turns_free(session *s) {
    session_knobs_state *k = &s->knobs;
    scene_copy_free(k->asked);
    memory_free(k->turns, (size_t)k->capacity * sizeof *k->turns);
    memory_free(k->queue, (size_t)k->queue_capacity * sizeof *k->queue);
    *k = (session_knobs_state){.lock = k->lock};
}

/* ---- beforehand -------------------------------------------------------------------------------------------------- */

/* Names the turn in a report about it. */
static status blame(const knob_turn *turn, status code, report *r) {
    if (code != STATUS_INPUT) return code;
    char key[sizeof r->key];
    snprintf(key, sizeof key, "turn %lld:%.60s", (long long)turn->frame, r->key[0] ? r->key : turn->path);
    memcpy(r->key, key, sizeof key);
    return code;
}

static status check_turns(session_knobs_state *k, scene *values, report *r) {
    for (int i = 0; i < k->count; i++) {
        if (k->turns[i].frame < 0) {
            char found[32];
            snprintf(found, sizeof found, "%lld", (long long)k->turns[i].frame);
            return blame(&k->turns[i], report_input(r, NULL, 0, k->turns[i].path, "a frame from 0 on", found, NULL), r);
        }
        char path[KNOB_PATH];
        status code = scene_turn_text(values, k->turns[i].path, k->turns[i].value, path, r);
        if (code != STATUS_OK) return blame(&k->turns[i], code, r);
        memcpy(k->turns[i].path, path, sizeof path);
    }
    return STATUS_OK;
}

status turns_begin(session *s, const knob_turn *turns, int count, report *r) {
    session_knobs_state *k = &s->knobs;
    status code = STATUS_OK;
    for (int i = 0; i < count && code == STATUS_OK; i++) code = add_turn(k, &turns[i], r);
    scene *values = scene_copy(s->scene);
    k->asked = scene_copy(s->scene);
    if (code == STATUS_OK && (!values || !k->asked)) code = report_set(r, STATUS_SYSTEM, "out of memory for the knobs");
    if (code == STATUS_OK) code = check_turns(k, values, r);
    scene_copy_free(values);
    return code;
}

/* ---- between frames ---------------------------------------------------------------------------------------------- */

/* Those asked for by hand join the list at this frame. */
static status take_queue(session_knobs_state *k, int64_t frame, report *r) {
    status code = STATUS_OK;
    for (int i = 0; i < k->queued && code == STATUS_OK; i++) {
        k->queue[i].frame = frame;
        code = add_turn(k, &k->queue[i], r);
    }
    k->queued = 0;
    return code;
}

/* One that no longer fits (the sheet's engine may still refuse it) is dropped, and the user told: a run goes on without it. */
static void drop_turn(session *s, const report *r) {
    session_knobs_state *k = &s->knobs;
    char reason[400], text[512];
    report_format(r, reason, sizeof reason);
    snprintf(text, sizeof text, "a turn was refused: %s", reason);
    pthread_mutex_lock(&k->lock);
    memmove(k->turns + k->acted, k->turns + k->acted + 1, (size_t)(k->count - k->acted - 1) * sizeof *k->turns);
    k->count--;
    pthread_mutex_unlock(&k->lock);
    session_warn(s, text);
}

/* What was asked for while the others acted still counts for what is asked next. */
static void renew_asked(session *s) {
    session_knobs_state *k = &s->knobs;
    report ignored;
    pthread_mutex_lock(&k->lock);
    simulation_copy_values(s->simulation, k->asked);
    for (int i = 0; i < k->queued; i++) (void)scene_turn_text(k->asked, k->queue[i].path, k->queue[i].value, NULL, &ignored);
    k->version++;
    pthread_mutex_unlock(&k->lock);
}

static void tell_turn(session *s, const knob_turn *turn) {
    char text[KNOB_PATH + KNOB_TEXT + 8];
    report ignored;
    snprintf(text, sizeof text, "%s = %s", turn->path, turn->value);
    (void)ledger_event(s->ledger, s->id, turn->frame, "knob", text, &ignored);
}

void turns_start(session *s) {
    pthread_mutex_lock(&s->knobs.lock);
    s->knobs.passed = simulation_frame(s->simulation) - 1;
    pthread_mutex_unlock(&s->knobs.lock);
}

status turns_act(session *s, report *r) {
    session_knobs_state *k = &s->knobs;
    int64_t frame = simulation_frame(s->simulation);
    pthread_mutex_lock(&k->lock);
    k->passed = frame;
    status code = take_queue(k, frame, r);
    bool due = k->acted < k->count && k->turns[k->acted].frame <= frame;
    pthread_mutex_unlock(&k->lock);
    if (code != STATUS_OK || !due) return code;
    while (k->acted < k->count && k->turns[k->acted].frame <= frame) { /* only this thread changes the list's length */
        knob_turn turn = k->turns[k->acted];
        report refused;
        code = simulation_turn_text(s->simulation, turn.path, turn.value, &refused);
        if (code == STATUS_OK) {
            k->acted++;
            tell_turn(s, &turn);
        } else {
            drop_turn(s, &refused);
        }
    }
    renew_asked(s);
    return STATUS_OK;
}

/* ---- from any thread --------------------------------------------------------------------------------------------- */

int session_knobs(session *s, knob *out, int limit) {
    pthread_mutex_lock(&s->knobs.lock);
    int count = scene_knobs(s->scene, s->knobs.asked, out, limit);
    pthread_mutex_unlock(&s->knobs.lock);
    return count;
}

static status queue_turn(session_knobs_state *k, const char *path, const char *value, report *r) {
    knob_turn turn = {.frame = -1};
    status code = scene_turn_text(k->asked, path, value, turn.path, r);
    if (code != STATUS_OK) return code;
    snprintf(turn.value, sizeof turn.value, "%s", value);
    knob_turn *place = insert_turn(&k->queue, &k->queued, &k->queue_capacity, k->queued);
    if (!place) return report_set(r, STATUS_SYSTEM, "out of memory for the turns of knobs");
    *place = turn;
    k->promised = k->passed + 1;
    k->version++;
    return STATUS_OK;
}

status session_turn_text(session *s, const char *path, const char *value, report *r) {
    if (atomic_load(&s->ended))
        return report_input(r, NULL, 0, path, "a run that goes on (of one that has ended, a branch can be made)", "one that has ended", NULL);
    if (strlen(value) >= KNOB_TEXT) return report_input(r, NULL, 0, path, "a value of under 128 characters", "a longer one", NULL);
    pthread_mutex_lock(&s->knobs.lock);
    status code = queue_turn(&s->knobs, path, value, r);
    pthread_mutex_unlock(&s->knobs.lock);
    return code;
}

status session_turn(session *s, const char *path, const double value[3], report *r) {
    size_t bytes = KNOB_LIMIT * sizeof(knob);
    knob *list = memory_allocate(bytes);
    if (!list) return report_set(r, STATUS_SYSTEM, "out of memory for the knobs");
    char text[KNOB_TEXT];
    int count = session_knobs(s, list, KNOB_LIMIT), found = knob_find(list, count, path, r);
    status code = found < 0 ? STATUS_INPUT : knob_check(&list[found], value, r);
    if (code == STATUS_OK) {
        knob_print(&list[found], value, text);
        code = session_turn_text(s, path, text, r);
    }
    memory_free(list, bytes);
    return code;
}

int64_t session_turn_frame(session *s) {
    pthread_mutex_lock(&s->knobs.lock);
    int64_t frame = s->knobs.promised;
    pthread_mutex_unlock(&s->knobs.lock);
    return frame;
}

int session_turns(session *s, knob_turn *out, int limit) {
    pthread_mutex_lock(&s->knobs.lock);
    int count = s->knobs.count;
    for (int i = 0; i < count && i < limit; i++) out[i] = s->knobs.turns[i];
    pthread_mutex_unlock(&s->knobs.lock);
    return count;
}
