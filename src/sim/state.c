/* A simulation's state as records: frames in order of id, checkpoints bit for bit, and hashes. */
#include "base/memory.h"
#include "sim/internal.h"

#include <stdio.h>
#include <string.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

static const char *set_of(engine_kind kind) {
    return kind == ENGINE_SHEET ? "sheet" : "solid";
}

/* Reads a field into a record of the run's precision. */
static status add_field(const simulation *s, engine_kind kind, const char *field, const char *unit, record_list *list, report *r) {
    int components = engine_read(s, kind, field, NULL);
    char name[RECORD_NAME];
    snprintf(name, sizeof name, "%s/%s", set_of(kind), field);
    if (components == 0 || record_find(list, name)) return STATUS_OK;
    int64_t count = engine_count(s, kind), values = count * components;
    bool narrow = s->engine->precision == 32;
    void *data;
    status code = record_add(list, name, narrow ? RECORD_F32 : RECORD_F64, count, components, unit, &data, r);
    if (code != STATUS_OK || !narrow) {
        if (code == STATUS_OK) engine_read(s, kind, field, data);
        return code;
    }
    double *wide = memory_allocate_array((size_t)values, sizeof *wide);
    if (!wide) return report_set(r, STATUS_SYSTEM, "out of memory for the field '%s'", field);
    engine_read(s, kind, field, wide);
    for (int64_t i = 0; i < values; i++) ((float *)data)[i] = (float)wide[i];
    memory_free(wide, (size_t)values * sizeof *wide);
    return STATUS_OK;
}

static status add_ids(const simulation *s, engine_kind kind, record_list *list, report *r) {
    void *data;
    char name[RECORD_NAME];
    int64_t count = engine_count(s, kind);
    const uint8_t *body = kind == ENGINE_SHEET ? s->sheet_points.sheet : s->particles.body;
    snprintf(name, sizeof name, "%s/id", set_of(kind));
    status code = record_add(list, name, RECORD_I32, count, 1, "1", &data, r);
    for (int64_t i = 0; code == STATUS_OK && i < count; i++) ((int32_t *)data)[i] = (int32_t)i;
    snprintf(name, sizeof name, "%s/body", set_of(kind));
    if (code == STATUS_OK) code = record_add(list, name, RECORD_I32, count, 1, "1", &data, r);
    for (int64_t i = 0; code == STATUS_OK && i < count; i++) ((int32_t *)data)[i] = body[i];
    return code;
}

/* Bonds stay who they are: pairs stand in frame 0 alone. */
static status add_bonds(const simulation *s, record_list *list, report *r) {
    int64_t count = s->sheets->bonds(s->sheet, NULL, NULL);
    void *pairs = NULL, *broken = NULL;
    status code = STATUS_OK;
    if (s->frame == 0) code = record_add(list, "sheet/bonds", RECORD_I32, count, 2, "1", &pairs, r);
    if (code == STATUS_OK) code = record_add(list, "sheet/bond_broken", RECORD_U8, count, 1, "1", &broken, r);
    if (code == STATUS_OK) s->sheets->bonds(s->sheet, pairs, broken);
    return code;
}

/* What the vertices are corners of, in the first frame only: it does not change. */
static status add_tetrahedra(const simulation *s, record_list *list, report *r) {
    void *data;
    if (s->particles.element_count == 0 || s->frame > 0) return STATUS_OK;
    status code = record_add(list, "solid/tetrahedra", RECORD_I32, s->particles.element_count, 4, "1", &data, r);
    if (code == STATUS_OK) memcpy(data, s->particles.corner, (size_t)s->particles.element_count * 4 * sizeof *s->particles.corner);
    return code;
}

static status add_set(const simulation *s, engine_kind kind, record_list *list, report *r) {
    if (engine_count(s, kind) == 0) return STATUS_OK;
    status code = add_field(s, kind, "position", "length", list, r);
    if (code == STATUS_OK) code = add_field(s, kind, "velocity", "length/time", list, r);
    if (code == STATUS_OK) code = add_ids(s, kind, list, r);
    if (code == STATUS_OK) code = add_field(s, kind, "deformation_gradient", "1", list, r);
    for (int e = 0; e < s->plan.effect_count && code == STATUS_OK; e++)
        for (int i = 0; i < s->plan.effects[e]->field_count && code == STATUS_OK; i++) {
            const effect_field *f = &s->plan.effects[e]->fields[i];
            if (f->written && (s->plan.mask >> e & 1)) code = add_field(s, kind, f->key, f->unit, list, r);
        }
    return code;
}

status simulation_frame_records(const simulation *s, record_list *list, report *r) {
    status code = add_set(s, ENGINE_SOLID, list, r);
    if (code == STATUS_OK) code = add_tetrahedra(s, list, r);
    if (code == STATUS_OK) code = add_set(s, ENGINE_SHEET, list, r);
    return code == STATUS_OK && s->sheet ? add_bonds(s, list, r) : code;
}

/* ---- checkpoints ------------------------------------------------------------------------------------------------- */

enum { CLOCK_INTEGERS = 4, CLOCK_REALS = 4, MOTION_REALS = 12 };

status simulation_save(const simulation *s, record_list *list, report *r) {
    int64_t *integers = NULL;
    double *reals = NULL, *motions = NULL;
    int boundaries = s->scene->grip_count + s->scene->collider_count;
    status code = record_add(list, "sim/integers", RECORD_I64, CLOCK_INTEGERS, 1, NULL, (void **)&integers, r);
    if (code == STATUS_OK) code = record_add(list, "sim/reals", RECORD_F64, CLOCK_REALS, 1, NULL, (void **)&reals, r);
    if (code == STATUS_OK) code = record_add(list, "sim/motions", RECORD_F64, boundaries, MOTION_REALS, NULL, (void **)&motions, r);
    if (code != STATUS_OK) return code;
    memcpy(integers, (int64_t[]){s->frame, s->steps, s->has_initial_energy, s->warned_fixed + 2 * s->warned_damage + 4 * s->warned_cfl}, CLOCK_INTEGERS * sizeof *integers);
    memcpy(reals, (double[]){s->time, s->dt_min, s->dt_max, s->initial_energy}, CLOCK_REALS * sizeof *reals);
    const rigid_boundary *b = engine_boundaries(s);
    for (int i = 0; i < boundaries; i++) {
        memcpy(motions + i * MOTION_REALS, b[i].motion.translation, 3 * sizeof *motions);
        memcpy(motions + i * MOTION_REALS + 3, b[i].motion.rotation, 9 * sizeof *motions);
    }
    return engine_save(s, list, r);
}

status simulation_restore(simulation *s, const record_list *list, report *r) {
    int64_t *integers;
    double *reals, *motions;
    int boundaries = s->scene->grip_count + s->scene->collider_count;
    status code = record_require(list, "sim/integers", RECORD_I64, CLOCK_INTEGERS, 1, (void **)&integers, r);
    if (code == STATUS_OK) code = record_require(list, "sim/reals", RECORD_F64, CLOCK_REALS, 1, (void **)&reals, r);
    if (code == STATUS_OK) code = record_require(list, "sim/motions", RECORD_F64, boundaries, MOTION_REALS, (void **)&motions, r);
    if (code == STATUS_OK) code = engine_restore(s, list, r);
    if (code != STATUS_OK) return code;
    s->frame = integers[0];
    s->steps = integers[1];
    s->has_initial_energy = integers[2] != 0;
    s->warned_fixed = integers[3] & 1;
    s->warned_damage = integers[3] >> 1 & 1;
    s->warned_cfl = integers[3] >> 2 & 1;
    s->time = reals[0];
    s->dt_min = reals[1];
    s->dt_max = reals[2];
    s->initial_energy = reals[3];
    rigid_boundary *b = engine_boundaries(s);
    for (int i = 0; i < boundaries; i++) {
        memcpy(b[i].motion.translation, motions + i * MOTION_REALS, 3 * sizeof *motions);
        memcpy(b[i].motion.rotation, motions + i * MOTION_REALS + 3, 9 * sizeof *motions);
    }
    return STATUS_OK;
}

status simulation_hash(const simulation *s, uint64_t *hash, report *r) {
    static const char *const fields[] = {"position", "velocity", "deformation_gradient", "damage", "diffused", "broken"};
    size_t bytes = (size_t)s->count * 9 * sizeof(double);
    double *values = memory_allocate(bytes);
    if (!values) return report_set(r, STATUS_SYSTEM, "out of memory for the state's hash");
    *hash = 0;
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        int components = simulation_read(s, fields[i], values);
        *hash = XXH3_64bits_withSeed(values, (size_t)s->count * (size_t)components * sizeof *values, *hash);
    }
    memory_free(values, bytes);
    return STATUS_OK;
}
