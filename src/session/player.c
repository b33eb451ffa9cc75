#include "session/player.h"

#include "base/memory.h"
#include "base/names.h"
#include "base/record.h"
#include "geom/vector.h"
#include "sim/derived.h"
#include "store/frames.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PLAYER_FIELDS = 48, PLAYER_NAME = 32, PLAYER_PATH = 1024, PLAYER_SLOTS = 256, PLAYER_SETS = 2, PLAYER_SOURCES = 4, DEFAULT_CACHE = 256 << 20 };

/* A frame that has been read. */
typedef struct slot {
    int64_t frame, step, count, counts[PLAYER_SETS]; /* counts: of each set */
    double time;
    float *position; /* [count][3] */
    float *value;    /* [count] of `field`; NULL when field is −1 */
    int32_t *body;   /* [count] */
    int field;       /* index into fields, −1: none */
    float low, high;
    uint64_t used;
} slot;

struct frame_player {
    char folder[PLAYER_PATH], sets[PLAYER_SETS][16]; /* sets: "solid", "sheet": whose particles are shown, one after the other */
    int set_count;
    int64_t *frames;                   /* [frame_count] */
    int frame_count, field_count, slot_count;
    char fields[PLAYER_FIELDS][PLAYER_NAME];
    slot slots[PLAYER_SLOTS];
    size_t limit;
    uint64_t clock;
};

/* ---- quantities -------------------------------------------------------------------------------------------------- */

static int find_field(const frame_player *p, const char *name) {
    for (int i = 0; i < p->field_count; i++)
        if (strcmp(p->fields[i], name) == 0) return i;
    return -1;
}

static const record *find_in(const record_list *records, const char *set, const char *field) {
    char name[RECORD_NAME];
    snprintf(name, sizeof name, "%s/%s", set, field);
    return record_find(records, name);
}

static bool has(const record_list *shapes, const char *set, const char *field, int components) {
    const record *item = find_in(shapes, set, field);
    return item && item->components == components;
}

static void add_field(frame_player *p, const char *name) {
    if (p->field_count == PLAYER_FIELDS || strlen(name) >= PLAYER_NAME || find_field(p, name) >= 0) return;
    snprintf(p->fields[p->field_count++], PLAYER_NAME, "%s", name);
}

/* Of one set: arrays with a row a particle and one component, and what follows from the vectors and tensors. */
static void find_fields(frame_player *p, const char *set, const record_list *shapes, int64_t count) {
    size_t front = strlen(set) + 1;
    for (int i = 0; i < shapes->count; i++) {
        const record *item = &shapes->items[i];
        bool ours = strncmp(item->name, set, front - 1) == 0 && item->name[front - 1] == '/';
        if (ours && item->components == 1 && item->count == count && strcmp(item->name + front, "id") != 0)
            add_field(p, item->name + front);
    }
    if (has(shapes, set, "velocity", 3)) add_field(p, "speed");
    if (has(shapes, set, "deformation_gradient", 9)) {
        add_field(p, "stretch");
        if (has(shapes, set, "fibre", 3)) add_field(p, "fibre_stretch");
    }
}

static status unknown_field(const frame_player *p, const char *name, report *r) {
    const char *names[PLAYER_FIELDS];
    for (int i = 0; i < p->field_count; i++) names[i] = p->fields[i];
    return report_input(r, p->folder, 0, "field", "a quantity of this run's particles", name, name_nearest(name, names, p->field_count));
}

/* A quantity of particle i from the arrays that it is made of. */
static double quantity(const char *field, const record *const sources[2], int64_t i) {
    double v[9], a[3];
    int components = sources[0]->components;
    for (int c = 0; c < components && c < 9; c++) v[c] = record_value(sources[0], components * i + c);
    if (strcmp(field, "speed") == 0) return vector_length(v);
    if (strcmp(field, "stretch") == 0) return derived_stretch(v);
    if (strcmp(field, "fibre_stretch") != 0) return v[0];
    for (int c = 0; c < 3; c++) a[c] = record_value(sources[1], 3 * i + c);
    return derived_fibre_stretch(v, a);
}

/* The arrays that a quantity is made of; how many. */
static int sources_of(const char *field, const char *names[2]) {
    names[0] = field;
    if (strcmp(field, "speed") == 0) names[0] = "velocity";
    if (strcmp(field, "stretch") == 0) names[0] = "deformation_gradient";
    if (strcmp(field, "fibre_stretch") != 0) return 1;
    names[0] = "deformation_gradient";
    names[1] = "fibre";
    return 2;
}

/* ---- the cache --------------------------------------------------------------------------------------------------- */

static void slot_clear(slot *s) {
    size_t n = (size_t)s->count;
    memory_free(s->position, n * 3 * sizeof *s->position);
    memory_free(s->value, n * sizeof *s->value);
    memory_free(s->body, n * sizeof *s->body);
    *s = (slot){.frame = -1, .field = -1};
}

static size_t slot_bytes(const slot *s) {
    return (size_t)s->count * (4 * sizeof *s->position + sizeof *s->body);
}

static slot *find_slot(frame_player *p, int64_t frame) {
    for (int i = 0; i < p->slot_count; i++)
        if (p->slots[i].frame == frame) return &p->slots[i];
    return NULL;
}

/* Drops the frames that were shown longest ago until one more of `bytes` has room, and gives the place for it. */
static slot *make_room(frame_player *p, size_t bytes) {
    for (;;) {
        size_t held = 0;
        slot *oldest = NULL, *empty = NULL;
        for (int i = 0; i < p->slot_count; i++) {
            slot *s = &p->slots[i];
            held += slot_bytes(s);
            if (s->frame < 0) empty = s;
            else if (!oldest || s->used < oldest->used) oldest = s;
        }
        if (!oldest || (held + bytes <= p->limit && (empty || p->slot_count < PLAYER_SLOTS)))
            return empty ? empty : &p->slots[p->slot_count++];
        slot_clear(oldest);
    }
}

/* ---- reading ----------------------------------------------------------------------------------------------------- */

static status read_records(const frame_player *p, int64_t frame, const char *const *fields, int count, record_list *records, slot *clock, report *r) {
    char paths[PLAYER_SETS * PLAYER_SOURCES][RECORD_NAME];
    const char *names[PLAYER_SETS * PLAYER_SOURCES] = {NULL};
    int wanted = 0;
    for (int set = 0; set < p->set_count; set++)
        for (int i = 0; i < count; i++, wanted++) {
            snprintf(paths[wanted], sizeof paths[0], "%s/%s", p->sets[set], fields[i]);
            names[wanted] = paths[wanted];
        }
    return frame_read_named(p->folder, frame, names, wanted, records, &clock->time, &clock->step, r);
}

static const record *required(const frame_player *p, const record_list *records, const char *set, const char *field, int64_t count, int components, report *r) {
    const record *item = find_in(records, set, field);
    if (item && (count < 0 || item->count == count) && (components == 0 || item->components == components)) return item;
    report_set(r, STATUS_SYSTEM, "%.400s: a frame without a whole array '%s/%s'", p->folder, set, field);
    return NULL;
}

static status fill_place(const frame_player *p, const record_list *records, slot *s, report *r) {
    const record *position[PLAYER_SETS], *body[PLAYER_SETS];
    for (int set = 0; set < p->set_count; set++) {
        position[set] = required(p, records, p->sets[set], "position", -1, 3, r);
        body[set] = position[set] ? required(p, records, p->sets[set], "body", position[set]->count, 1, r) : NULL;
        if (!body[set]) return r->code;
        s->counts[set] = position[set]->count;
        s->count += position[set]->count;
    }
    size_t n = (size_t)s->count;
    s->position = memory_allocate_array(n, 3 * sizeof *s->position);
    s->body = memory_allocate_array(n, sizeof *s->body);
    if (!s->position || !s->body) return report_set(r, STATUS_SYSTEM, "out of memory for a frame of %zu particles", n);
    for (int64_t set = 0, at = 0; set < p->set_count; at += position[set++]->count) {
        for (int64_t i = 0; i < 3 * position[set]->count; i++) s->position[3 * at + i] = (float)record_value(position[set], i);
        for (int64_t i = 0; i < position[set]->count; i++) s->body[at + i] = (int32_t)record_value(body[set], i);
    }
    return STATUS_OK;
}

/* The quantity of one set's particles; false when the set does not have it. */
static bool fill_set(const char *name, const record_list *records, const char *set, int64_t count, float *value) {
    const char *names[2];
    const record *sources[2] = {NULL, NULL};
    int needed = sources_of(name, names);
    for (int i = 0; i < needed; i++) {
        sources[i] = find_in(records, set, names[i]);
        if (!sources[i] || sources[i]->count != count) return false;
    }
    for (int64_t i = 0; i < count; i++) value[i] = (float)quantity(name, sources, i);
    return true;
}

static status fill_value(const frame_player *p, const record_list *records, slot *s, int field, report *r) {
    const char *name = p->fields[field];
    bool filled[PLAYER_SETS] = {false}, any = false, fraction = strcmp(name, "damage") == 0 || strcmp(name, "broken") == 0;
    float low = HUGE_VALF, high = -HUGE_VALF;
    if (!s->value) s->value = memory_allocate_array((size_t)s->count, sizeof *s->value);
    if (!s->value) return report_set(r, STATUS_SYSTEM, "out of memory for '%s'", name);
    for (int64_t set = 0, at = 0; set < p->set_count; at += s->counts[set++]) {
        any |= filled[set] = fill_set(name, records, p->sets[set], s->counts[set], s->value + at);
        for (int64_t i = 0; i < s->counts[set] && filled[set]; i++) {
            low = fminf(low, s->value[at + i]);
            high = fmaxf(high, s->value[at + i]);
        }
    }
    if (!any) return report_set(r, STATUS_SYSTEM, "%.400s: a frame without a whole array for '%s'", p->folder, name);
    s->low = fraction || !isfinite(low) ? 0 : low;
    s->high = fraction || !isfinite(high) ? 1 : high;
    /* What does not have the quantity stands at its low end. */
    for (int64_t set = 0, at = 0; set < p->set_count; at += s->counts[set++])
        for (int64_t i = 0; i < s->counts[set] && !filled[set]; i++) s->value[at + i] = s->low;
    s->field = field;
    return STATUS_OK;
}

/* Reads a frame into the cache, or a further quantity of one that is there. */
static status load(frame_player *p, int64_t frame, int field, slot **out, report *r) {
    slot fresh = {.frame = frame, .field = -1}, *s = find_slot(p, frame);
    record_list records = {0};
    const char *names[4] = {"position", "body"};
    int first = s ? 2 : 0, count = 2;
    if (field >= 0) count += sources_of(p->fields[field], names + 2);
    slot clock;
    status code = read_records(p, frame, names + first, count - first, &records, &clock, r);
    if (code == STATUS_OK && !s) {
        fresh.time = clock.time, fresh.step = clock.step;
        code = fill_place(p, &records, &fresh, r);
    }
    if (code == STATUS_OK && !s) {
        s = make_room(p, slot_bytes(&fresh));
        *s = fresh;
        fresh = (slot){0};
    }
    if (code == STATUS_OK && field >= 0) code = fill_value(p, &records, s, field, r);
    if (code != STATUS_OK) slot_clear(s ? s : &fresh);
    record_clear(&records);
    *out = s;
    return code;
}

status frame_player_read(frame_player *p, int64_t frame, const char *field, frame_view *out, report *r) {
    int wanted = field ? find_field(p, field) : -1;
    if (field && wanted < 0) return unknown_field(p, field, r);
    slot *s = find_slot(p, frame);
    status code = STATUS_OK;
    if (!s || (wanted >= 0 && s->field != wanted)) code = load(p, frame, wanted, &s, r);
    if (code != STATUS_OK) return code;
    s->used = ++p->clock;
    *out = (frame_view){.frame = frame, .step = s->step, .time = s->time, .count = s->count, .position = s->position,
                        .value = wanted >= 0 ? s->value : NULL, .body = s->body, .low = s->low, .high = s->high};
    return STATUS_OK;
}

/* ---- opening ----------------------------------------------------------------------------------------------------- */

status frame_player_refresh(frame_player *p, report *r) {
    int64_t *frames;
    int count;
    status code = frame_list(p->folder, &frames, &count, r);
    if (code != STATUS_OK) return code;
    memory_free(p->frames, (size_t)p->frame_count * sizeof *p->frames);
    p->frames = frames;
    p->frame_count = count;
    if (count > 0) return STATUS_OK;
    return report_input(r, p->folder, 0, NULL, "a run's folder with frames in it", "none", NULL);
}

static status look_inside(frame_player *p, report *r) {
    record_list *shapes = memory_allocate(sizeof *shapes);
    if (!shapes) return report_set(r, STATUS_SYSTEM, "out of memory for a frame's contents");
    status code = frame_shapes(p->folder, p->frames[0], shapes, r);
    static const char *const sets[PLAYER_SETS] = {"solid", "sheet"};
    for (int i = 0; i < PLAYER_SETS && code == STATUS_OK; i++) {
        const record *position = find_in(shapes, sets[i], "position");
        if (!position) continue;
        snprintf(p->sets[p->set_count++], sizeof p->sets[0], "%s", sets[i]);
        find_fields(p, sets[i], shapes, position->count);
    }
    if (code == STATUS_OK && p->set_count == 0) code = report_set(r, STATUS_SYSTEM, "%.400s: frames without particles", p->folder);
    memory_free(shapes, sizeof *shapes);
    return code;
}

status frame_player_open(const char *folder, size_t cache_bytes, frame_player **out, report *r) {
    *out = NULL;
    frame_player *p = memory_allocate(sizeof *p);
    if (!p) return report_set(r, STATUS_SYSTEM, "out of memory for a frame player");
    snprintf(p->folder, sizeof p->folder, "%s", folder);
    p->limit = cache_bytes ? cache_bytes : DEFAULT_CACHE;
    status code = frame_player_refresh(p, r);
    if (code == STATUS_OK) code = look_inside(p, r);
    if (code == STATUS_OK) *out = p;
    else frame_player_close(p);
    return code;
}

void frame_player_close(frame_player *p) {
    if (!p) return;
    for (int i = 0; i < p->slot_count; i++) slot_clear(&p->slots[i]);
    memory_free(p->frames, (size_t)p->frame_count * sizeof *p->frames);
    memory_free(p, sizeof *p);
}

int frame_player_count(const frame_player *p) {
    return p->frame_count;
}

int64_t frame_player_number(const frame_player *p, int index) {
    return index >= 0 && index < p->frame_count ? p->frames[index] : -1;
}

int frame_player_index(const frame_player *p, int64_t frame) {
    int index = 0;
    while (index + 1 < p->frame_count && p->frames[index + 1] <= frame) index++;
    return index;
}

const char *frame_player_field(const frame_player *p, int index) {
    return index >= 0 && index < p->field_count ? p->fields[index] : NULL;
}

const char *frame_player_default_field(const frame_player *p) {
    static const char *const names[] = {"damage", "diffused", "broken", "speed"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (find_field(p, names[i]) >= 0) return names[i];
    return frame_player_field(p, 0);
}

status frame_player_bounds(frame_player *p, float low[3], float high[3], report *r) {
    frame_view view;
    status code = frame_player_read(p, p->frames[0], NULL, &view, r);
    if (code != STATUS_OK) return code;
    for (int c = 0; c < 3; c++) low[c] = HUGE_VALF, high[c] = -HUGE_VALF;
    for (int64_t i = 0; i < 3 * view.count; i++) {
        low[i % 3] = fminf(low[i % 3], view.position[i]);
        high[i % 3] = fmaxf(high[i % 3], view.position[i]);
    }
    return STATUS_OK;
}
