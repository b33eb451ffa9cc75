/* Turning knobs: of a scene's values, and of a simulation between two frames. */
#include "base/memory.h"
#include "sim/internal.h"
#include "sim/knob_places.h"

#include <stdio.h>
#include <string.h>

/* What is wrong is wrong with the turn, wherever the scene named the effect. */
static status blame_turn(const knob *k, status code, report *r) {
    if (code != STATUS_INPUT) return code;
    r->file[0] = '\0';
    r->line = 0;
    char *dot = strchr(r->key, '.');
    if (!dot && *k->effect) snprintf(r->key, sizeof r->key, "%s", k->path);
    return code;
}

static status resolve_scene(scene *now, int effect_at, report *r) {
    int count;
    const effect *e = effect_catalogue(&count)[effect_at];
    return effect_values_check(e, &now->effects[effect_at], now->effects, NULL, 0, r);
}

static status turn_effect(scene *now, const knob *k, knob_place p, const double value[3], report *r) {
    effect_values *values = knob_place_values(now, p);
    int count, twin = -1;
    const effect *e = effect_catalogue(&count)[p.effect];
    memcpy(values->value[p.key], value, (size_t)k->components * sizeof *value);
    values->given[p.key] = true;
    if (e->parameters[p.key].twin) twin = effect_parameter(e, e->parameters[p.key].twin);
    if (twin >= 0) {
        values->given[twin] = false;
        memcpy(values->value[twin], e->parameters[twin].fallback, sizeof values->value[twin]);
    }
    const effect_values *all = p.material < 0 ? now->effects : now->materials[p.material].effects;
    if (e->turned) e->turned(values, all + (e->engine == ENGINE_SHEET ? sheet_effects_first() : 0), p.key);
    return p.material < 0 ? resolve_scene(now, p.effect, r) : scene_check_material(now, p.material, r);
}

static status turn_place(scene *now, const knob *k, knob_place p, const double value[3], report *r) {
    if (p.kind != PLACE_EFFECT) {
        double *turned = knob_place_value(now, p), old = *turned;
        *turned = value[0];
        status stepped = scene_check_step(now, r);
        if (stepped != STATUS_OK) *turned = old;
        return blame_turn(k, stepped, r);
    }
    size_t bytes = p.material < 0 ? sizeof now->effects : sizeof now->materials[0].effects;
    effect_values *all = p.material < 0 ? now->effects : now->materials[p.material].effects, *before = memory_allocate(bytes);
    if (!before) return report_set(r, STATUS_SYSTEM, "out of memory for a turn");
    memcpy(before, all, bytes);
    status code = turn_effect(now, k, p, value, r);
    if (code != STATUS_OK) memcpy(all, before, bytes);
    memory_free(before, bytes);
    return blame_turn(k, code, r);
}

static status find_live(const scene *now, const char *word, knob *list, int *found, report *r) {
    int count = scene_knobs(now, now, list, KNOB_LIMIT);
    *found = knob_find(list, count, word, r);
    if (*found < 0) return STATUS_INPUT;
    const knob *k = &list[*found];
    return k->live ? STATUS_OK : report_input(r, NULL, 0, k->path, "a knob that may be turned while a run goes on", k->why_not, NULL);
}

status scene_turn(scene *now, const char *word, const double value[3], char *path, report *r) {
    size_t bytes = KNOB_LIMIT * sizeof(knob);
    knob *list = memory_allocate(bytes);
    if (!list) return report_set(r, STATUS_SYSTEM, "out of memory for the knobs");
    knob_places all;
    int found;
    report_clear(r);
    status code = find_live(now, word, list, &found, r);
    if (code == STATUS_OK) code = knob_check(&list[found], value, r);
    knob_places_list(now, &all);
    if (code == STATUS_OK) code = turn_place(now, &list[found], all.items[found], value, r);
    if (code == STATUS_OK && path) memcpy(path, list[found].path, sizeof list[found].path);
    memory_free(list, bytes);
    return code;
}

status scene_turn_text(scene *now, const char *word, const char *text, char *path, report *r) {
    size_t bytes = KNOB_LIMIT * sizeof(knob);
    knob *list = memory_allocate(bytes);
    if (!list) return report_set(r, STATUS_SYSTEM, "out of memory for the knobs");
    double value[3];
    int found;
    report_clear(r);
    status code = find_live(now, word, list, &found, r);
    if (code == STATUS_OK) code = knob_parse(&list[found], text, value, r);
    memory_free(list, bytes);
    return code == STATUS_OK ? scene_turn(now, word, value, path, r) : code;
}

/* ---- simulations ------------------------------------------------------------------------------------------------- */

int simulation_knobs(const simulation *s, knob *out, int limit) {
    return scene_knobs(s->start, s->scene, out, limit);
}

/* The engines see the scene's new values; one that refuses them gets the old ones back. */
static status refresh_or_undo(simulation *s, const scene *before, report *r) {
    status code = engine_refresh(s, r);
    if (code == STATUS_OK) return code;
    report ignored;
    *s->scene = *before;
    (void)engine_refresh(s, &ignored);
    return code;
}

status simulation_turn(simulation *s, const char *path, const double value[3], report *r) {
    scene *before = scene_copy(s->scene);
    if (!before) return report_set(r, STATUS_SYSTEM, "out of memory for a turn");
    status code = scene_turn(s->scene, path, value, NULL, r);
    if (code == STATUS_OK) code = refresh_or_undo(s, before, r);
    scene_copy_free(before);
    return code;
}

status simulation_turn_text(simulation *s, const char *path, const char *value, report *r) {
    scene *before = scene_copy(s->scene);
    if (!before) return report_set(r, STATUS_SYSTEM, "out of memory for a turn");
    status code = scene_turn_text(s->scene, path, value, NULL, r);
    if (code == STATUS_OK) code = refresh_or_undo(s, before, r);
    scene_copy_free(before);
    return code;
}

status simulation_replay_turns(simulation *s, const knob_turn *turns, int count, report *r) {
    scene *before = scene_copy(s->scene);
    if (!before) return report_set(r, STATUS_SYSTEM, "out of memory for a turn");
    status code = STATUS_OK;
    for (int i = 0; i < count && code == STATUS_OK; i++) code = scene_turn_text(s->scene, turns[i].path, turns[i].value, NULL, r);
    if (code != STATUS_OK) *s->scene = *before;
    else if (count > 0) code = refresh_or_undo(s, before, r);
    scene_copy_free(before);
    return code;
}

void simulation_copy_values(const simulation *s, scene *to) {
    *to = *s->scene;
}
