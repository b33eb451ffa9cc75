/* The state as records, bit for bit. Order, bonds and calibration follow from the definition, so only what changes is kept. */
#include "sheet/state.h"

static const record_type real_type = SUNDER_PRECISION == 32 ? RECORD_F32 : RECORD_F64;

enum { SCALARS = 6 };

typedef struct saved_array {
    const char *name;
    void *data;
    record_type type;
    int64_t count;
    int components;
} saved_array;

enum { SAVED = 14 };

static int list_saved(const sheet *s, saved_array rows[SAVED]) {
    int64_t lanes = (int64_t)s->pack_count * PACK;
    pack_rates *t = s->rates;
    const saved_array all[SAVED] = {
        {"sheet/node", s->node, real_type, lanes, NODE},
        {"sheet/velocity", s->velocity, real_type, s->pack_count, 3 * PACK},
        {"sheet/holder", s->holder, RECORD_U8, lanes, 1},
        {"sheet/stiffness", s->stiffness, real_type, s->slot_count, PACK},
        {"sheet/history", s->history, real_type, s->slot_count, PACK},
        {"sheet/conduct", s->conduct, real_type, s->slot_count, PACK},
        {"sheet/dilation", s->dilation, real_type, s->slot_count, PACK},
        {"sheet/laplace", s->laplace, real_type, s->slot_count, PACK},
        {"sheet/rates/step", t ? &t->step : NULL, RECORD_I32, 1, 1},
        {"sheet/rates/asked", t ? t->asked : NULL, RECORD_U8, s->pack_count, 1},
        {"sheet/rates/cracked", t ? t->cracked : NULL, RECORD_I32, s->pack_count, 1},
        {"sheet/rates/coldest", t ? t->coldest : NULL, real_type, s->pack_count, 1},
        {"sheet/rates/hottest", t ? t->hottest : NULL, real_type, s->pack_count, 1},
        {"sheet/rates/stiffening", t ? t->stiffening : NULL, real_type, s->pack_count, 1},
    };
    int count = 0;
    for (int i = 0; i < SAVED; i++)
        if (all[i].data) rows[count++] = all[i];
    return count;
}

static size_t bytes_of(const saved_array *a) {
    return (size_t)a->count * (size_t)a->components * record_type_size(a->type);
}

status sheet_save(const sheet *s, record_list *list, report *r) {
    saved_array rows[SAVED];
    int count = list_saved(s, rows);
    void *data;
    double *scalars = NULL;
    uint8_t *active = NULL;
    double *speed = NULL;
    status code = record_add(list, "sheet/speed", RECORD_F64, 1, 1, NULL, (void **)&speed, r);
    if (code == STATUS_OK) code = record_add(list, "sheet/scalars", RECORD_F64, SCALARS, 1, NULL, (void **)&scalars, r);
    if (code == STATUS_OK) code = record_add(list, "sheet/active", RECORD_U8, SHEET_BOUNDARIES, 1, NULL, (void **)&active, r);
    if (code != STATUS_OK) return code;
    *speed = s->speed;
    memcpy(scalars, (double[]){s->grip_work, s->grip_impulse[0], s->grip_impulse[1], s->grip_impulse[2], s->diffused_until, s->stiffening},
           SCALARS * sizeof *scalars);
    for (int b = 0; b < SHEET_BOUNDARIES; b++) active[b] = s->was_active[b];
    for (int i = 0; i < count && code == STATUS_OK; i++) {
        code = record_add(list, rows[i].name, rows[i].type, rows[i].count, rows[i].components, NULL, &data, r);
        if (code == STATUS_OK) memcpy(data, rows[i].data, bytes_of(&rows[i]));
    }
    return code;
}

status sheet_restore(sheet *s, const record_list *list, report *r) {
    saved_array rows[SAVED];
    int count = list_saved(s, rows);
    double *scalars;
    uint8_t *active;
    void *data;
    double *speed;
    status code = record_require(list, "sheet/speed", RECORD_F64, 1, 1, (void **)&speed, r);
    if (code == STATUS_OK) code = record_require(list, "sheet/scalars", RECORD_F64, SCALARS, 1, (void **)&scalars, r);
    if (code == STATUS_OK) code = record_require(list, "sheet/active", RECORD_U8, SHEET_BOUNDARIES, 1, (void **)&active, r);
    for (int i = 0; i < count && code == STATUS_OK; i++) {
        code = record_require(list, rows[i].name, rows[i].type, rows[i].count, rows[i].components, &data, r);
        if (code == STATUS_OK) memcpy(rows[i].data, data, bytes_of(&rows[i]));
    }
    if (code != STATUS_OK) return code;
    s->grip_work = scalars[0];
    memcpy(s->grip_impulse, scalars + 1, sizeof s->grip_impulse);
    s->diffused_until = scalars[4];
    s->stiffening = scalars[5];
    s->speed = *speed;
    s->broken_since = 1; /* contacts are listed anew */
    for (int b = 0; b < SHEET_BOUNDARIES; b++) s->was_active[b] = active[b];
    return STATUS_OK;
}
