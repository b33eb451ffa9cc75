/* Turns of knobs in a run: asked for from any thread, acting between frames. */
#include "base/memory.h"
#include "session/internal.h"
#include "session/turns_file.h"

#include <stdio.h>
#include <string.h>

/* ---- lists ------------------------------------------------------------------------------------------------------- */

/* Room for one more at `index`, what follows moved on; NULL when out of memory. */
static knob_turn *insert_turn(knob_turn **list, int *count, int *capacity, int index) {
    if (*count == *capacity) {
        int wanted = *capacity ? 2 * *capacity : 16;
        knob_turn *grown = memory_resize(*list, (size_t)*capacity * sizeof **list, (size_t)wanted * sizeof **list);
        if (!grown) return NULL;
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
    while (at > 0 && k->turns[at - 1].frame > turn->frame) at--;
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
    k->asked = NULL;
    k->turns = k->queue = NULL;
    k->count = k->acted = k->capacity = k->queued = k->queue_capacity = 0;
}

/* ---- beforehand -------------------------------------------------------------------------------------------------- */

/* Names the turn in a report about it. */
static status blame(const knob_turn *turn, status code, report *r) {
    if (code != STATUS_INPUT) return code;
    char key[sizeof r->key];
    snprintf(key, sizeof key, "turn %lld:%.100s", (long long)turn->frame, r->key[0] ? r->key : turn->path);
    memcpy(r->key, key, sizeof key);
    return code;
}

/* Each on what those before it left; words become whole paths. */
static status check_turns(session *s, report *r) {
    session_knobs_state *k = &s->knobs;
    scene *values = scene_copy(s->scene);
    status code = values ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for the knobs");
    for (int i = 0; i < k->count && code == STATUS_OK; i++) {
        char path[KNOB_PATH];
        code = scene_turn_text(values, k->turns[i].path, k->turns[i].value, path, r);
        if (code == STATUS_OK) memcpy(k->turns[i].path, path, sizeof path);
        else code = blame(&k->turns[i], code, r);
    }
    scene_copy_free(values);
    return code;
}

/* Those of the options, at frames that are still to come. */
static status add_options(session *s, int64_t first, report *r) {
    for (int i = 0; i < s->options.turn_count; i++) {
        const knob_turn *turn = &s->options.turns[i];
        if (turn->frame < first || turn->frame >= s->target) {
            char expected[96], found[32];
            snprintf(expected, sizeof expected, "a frame from %lld up to %lld, the last but one", (long long)first, (long long)s->target - 1);
            snprintf(found, sizeof found, "%lld", (long long)turn->frame);
            return blame(turn, report_input(r, NULL, 0, turn->path, expected, found, NULL), r);
        }
        status code = add_turn(&s->knobs, turn, r);
        if (code != STATUS_OK) return code;
    }
    return STATUS_OK;
}

status turns_begin(session *s, report *r) {
    session_knobs_state *k = &s->knobs;
    if (!k->asked) k->asked = scene_copy(s->scene);
    if (!k->asked) return report_set(r, STATUS_SYSTEM, "out of memory for the knobs");
    status code = add_options(s, simulation_frame(s->simulation), r);
    return code == STATUS_OK ? check_turns(s, r) : code;
}

/* ---- going on ---------------------------------------------------------------------------------------------------- */

status turns_save(const session *s, record_list *list, report *r) {
    const session_knobs_state *k = &s->knobs;
    char *text;
    size_t size;
    void *data;
    if (k->acted == 0) return STATUS_OK;
    status code = turns_format(k->turns, k->acted, &text, &size, r);
    if (code != STATUS_OK) return code;
    code = record_add(list, TURNS_RECORD, RECORD_U8, (int64_t)size, 1, NULL, &data, r);
    if (code == STATUS_OK) memcpy(data, text, size);
    memory_free(text, size + 1);
    return code;
}

typedef struct turn_list {
    knob_turn *items;
    int count;
} turn_list;

static void free_list(turn_list *list) {
    memory_free(list->items, (size_t)list->count * sizeof *list->items);
    *list = (turn_list){0};
}

static status read_file(const char *folder, turn_list *out, report *r) {
    char path[SESSION_PATH + 32], *text;
    size_t size;
    snprintf(path, sizeof path, "%s/turns.json", folder);
    status code = file_read_text(path, &text, &size, r);
    if (code != STATUS_OK || !text) return code;
    code = turns_parse(path, text, size, &out->items, &out->count, r);
    memory_free(text, size + 1);
    return code;
}

static status read_saved(const char *folder, const record_list *saved, turn_list *out, report *r) {
    const record *from = record_find(saved, TURNS_RECORD);
    if (!from) return STATUS_OK;
    size_t size = (size_t)from->count;
    char *text = memory_allocate(size + 1);
    if (!text) return report_set(r, STATUS_SYSTEM, "out of memory for the turns of knobs");
    memcpy(text, from->data, size);
    status code = turns_parse(folder, text, size, &out->items, &out->count, r);
    memory_free(text, size + 1);
    return code;
}

static bool same_turn(const knob_turn *a, const knob_turn *b) {
    return a->frame == b->frame && strcmp(a->path, b->path) == 0 && strcmp(a->value, b->value) == 0;
}

/* What made the checkpoint's state is beyond doubt; what comes after it is in the file. */
static status join_lists(session *s, const turn_list *file, const turn_list *saved, int64_t checkpoint, int64_t through, report *r) {
    status code = STATUS_OK;
    int before = 0;
    bool same = true;
    for (; before < file->count && file->items[before].frame < checkpoint; before++)
        same = same && before < saved->count && same_turn(&file->items[before], &saved->items[before]);
    if (!same || before != saved->count)
        session_warn(s, simulation_frame(s->simulation), "turns.json is not what the checkpoint was made with: the checkpoint's turns count");
    for (int i = 0; i < saved->count && code == STATUS_OK; i++) code = add_turn(&s->knobs, &saved->items[i], r);
    for (int i = 0; i < file->count && code == STATUS_OK; i++)
        if (file->items[i].frame >= checkpoint && file->items[i].frame <= through) code = add_turn(&s->knobs, &file->items[i], r);
    return code;
}

status turns_resume(session *s, const char *folder, int64_t through, int64_t first, int64_t checkpoint, const record_list *saved, report *r) {
    session_knobs_state *k = &s->knobs;
    turn_list in_file = {0}, in_checkpoint = {0};
    k->asked = scene_copy(s->scene);
    status code = k->asked ? read_file(folder, &in_file, r) : report_set(r, STATUS_SYSTEM, "out of memory for the knobs");
    if (code == STATUS_OK) code = read_saved(folder, saved, &in_checkpoint, r);
    if (code == STATUS_OK) code = join_lists(s, &in_file, &in_checkpoint, checkpoint, through, r);
    free_list(&in_file);
    free_list(&in_checkpoint);
    if (code == STATUS_OK) code = add_options(s, first, r);
    if (code == STATUS_OK) code = check_turns(s, r);
    if (code != STATUS_OK) return code;
    while (k->acted < k->count && k->turns[k->acted].frame < checkpoint) k->acted++;
    code = simulation_replay_turns(s->simulation, k->turns, k->acted, r);
    if (code == STATUS_OK) simulation_copy_values(s->simulation, k->asked);
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
    session_warn(s, simulation_frame(s->simulation), text);
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

static void tell_turn(session *s, const knob_turn *turn, const char *before) {
    char text[KNOB_PATH + 2 * KNOB_TEXT + 16];
    if (turn->frame < s->past_until) return; /* its parent's ledger has told it */
    snprintf(text, sizeof text, "%s: %s -> %s", turn->path, before, turn->value);
    session_tell(s, turn->frame, "knob", text);
}

void turns_start(session *s) {
    pthread_mutex_lock(&s->knobs.lock);
    int64_t first = simulation_frame(s->simulation);
    if (first < s->past_until) first = s->past_until; /* a branch's past is its parent's */
    s->knobs.passed = first - 1;
    pthread_mutex_unlock(&s->knobs.lock);
}

/* The value before a turn, for the event. text[KNOB_TEXT]. */
static void print_value(const session *s, const char *path, char *text) {
    size_t bytes = KNOB_LIMIT * sizeof(knob);
    knob *list = memory_allocate(bytes);
    report ignored;
    snprintf(text, KNOB_TEXT, "?");
    int found = list ? knob_find(list, simulation_knobs(s->simulation, list, KNOB_LIMIT), path, &ignored) : -1;
    if (found >= 0) knob_print(&list[found], list[found].value, text);
    memory_free(list, bytes);
}

static status act_one(session *s, report *r) {
    session_knobs_state *k = &s->knobs;
    knob_turn turn = k->turns[k->acted];
    char before[KNOB_TEXT];
    print_value(s, turn.path, before);
    status code = simulation_turn_text(s->simulation, turn.path, turn.value, r);
    if (code == STATUS_SYSTEM) return code;
    if (code == STATUS_OK) {
        k->acted++;
        tell_turn(s, &turn, before);
    } else {
        drop_turn(s, r);
    }
    return STATUS_OK;
}

/* The list is on the disk before any step sees what it says: whatever ends this process, a resumed run makes the same steps. */
status turns_act(session *s, report *r) {
    session_knobs_state *k = &s->knobs;
    int64_t frame = simulation_frame(s->simulation);
    pthread_mutex_lock(&k->lock);
    bool by_hand = k->queued > 0 && frame > k->passed;
    if (frame > k->passed) k->passed = frame;
    status code = by_hand ? take_queue(k, frame, r) : STATUS_OK;
    bool due = k->acted < k->count && k->turns[k->acted].frame <= frame;
    pthread_mutex_unlock(&k->lock);
    if (code != STATUS_OK || !due) return code;
    int count = k->count;
    while (code == STATUS_OK && k->acted < k->count && k->turns[k->acted].frame <= frame) /* only this thread changes the list's length */
        code = act_one(s, r);
    if (code == STATUS_OK && (by_hand || k->count != count)) code = turns_write(s, r);
    renew_asked(s);
    return code;
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
    int version = s->knobs.version;
    pthread_mutex_unlock(&s->knobs.lock);
    if (code != STATUS_OK) return code;
    pthread_mutex_lock(&s->lock);
    s->shown.knob_version = version;
    s->shown.version++;
    pthread_mutex_unlock(&s->lock);
    return STATUS_OK;
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
