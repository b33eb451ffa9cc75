/* The list of knobs, made from the effects' tables, and their values as text. */
#include "sim/knobs.h"

#include "base/memory.h"
#include "base/names.h"
#include "sim/knob_places.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- where knobs are --------------------------------------------------------------------------------------------- */

/* Keys of the scene that each step reads anew. */
static const parameter scene_keys[] = {
    {.key = "cfl", .unit = "1", .doc = "fraction of the step limit that is used", .minimum = 1e-3, .maximum = 1, .fallback = {0.5}, .live = true},
    {.key = "dt", .unit = "time", .doc = "time step; 0: as long as the limits allow", .maximum = 1e9, .live = true, .logarithmic = true},
};
enum { SCENE_KEYS = sizeof scene_keys / sizeof *scene_keys };

static const parameter source_keys[] = {
    {.key = "strength", .unit = "1", .doc = "what the source gives, or holds, is multiplied by this", .minimum = -1e12, .maximum = 1e12, .fallback = {1}, .live = true},
    {.key = "on", .unit = "1", .doc = "whether the source does anything", .kind = PARAMETER_BOOLEAN, .maximum = 1, .fallback = {1}, .live = true},
};

static const parameter density_key = {.key = "density", .unit = "mass/length^3", .doc = "at rest", .maximum = HUGE_VAL, .logarithmic = true,
                                      .why_not = "particles got their masses from it"};

static void add_place(knob_places *all, knob_place p) {
    if (all->count < KNOB_LIMIT) all->items[all->count++] = p;
}

static void add_effects(const scene *s, int material, knob_places *all) {
    int count;
    const effect *const *effects = effect_catalogue(&count);
    const effect_values *values = material < 0 ? s->effects : s->materials[material].effects;
    for (int e = 0; e < count; e++) {
        if ((effects[e]->scope == SCOPE_SCENE) != (material < 0) || !values[e].on) continue;
        for (int k = 0; k < effects[e]->parameter_count; k++) add_place(all, (knob_place){PLACE_EFFECT, material, e, k});
    }
}

static scene_source *source_at(const scene *s, int number) {
    return (scene_source *)(uintptr_t)scene_source_at(s, number);
}

static void add_sources(const scene *s, knob_places *all) {
    for (int number = 0; scene_source_at(s, number); number++) {
        add_place(all, (knob_place){PLACE_SOURCE, -1, -1, 2 * number});
        add_place(all, (knob_place){PLACE_SOURCE, -1, -1, 2 * number + 1});
    }
}

static bool is_declared(const scene_parameter *p) {
    if (p->is_text || strchr(p->name, '.')) return false;
    for (int k = 0; k < SCENE_KEYS; k++)
        if (strcmp(p->name, scene_keys[k].key) == 0) return false;
    return true;
}

void knob_places_list(const scene *s, knob_places *all) {
    all->count = 0;
    for (int m = 0; m < s->material_count; m++) {
        add_place(all, (knob_place){PLACE_DENSITY, m, -1, 0});
        add_effects(s, m, all);
    }
    add_effects(s, -1, all);
    for (int k = 0; k < SCENE_KEYS; k++) add_place(all, (knob_place){PLACE_SCENE_KEY, -1, -1, k});
    add_sources(s, all);
    for (int i = 0; i < s->parameter_count; i++)
        if (is_declared(&s->parameters[i])) add_place(all, (knob_place){PLACE_DECLARED, -1, -1, i});
}

/* The table's row; NULL for what a script declared. */
static const parameter *table_of(knob_place p) {
    int count;
    switch (p.kind) {
    case PLACE_EFFECT: return &effect_catalogue(&count)[p.effect]->parameters[p.key];
    case PLACE_DENSITY: return &density_key;
    case PLACE_SCENE_KEY: return &scene_keys[p.key];
    case PLACE_SOURCE: return &source_keys[p.key % 2];
    case PLACE_DECLARED: break;
    }
    return NULL;
}

effect_values *knob_place_values(scene *s, knob_place p) {
    return p.material < 0 ? &s->effects[p.effect] : &s->materials[p.material].effects[p.effect];
}

double *knob_place_value(scene *s, knob_place p) {
    switch (p.kind) {
    case PLACE_EFFECT: return knob_place_values(s, p)->value[p.key];
    case PLACE_DENSITY: return &s->materials[p.material].density;
    case PLACE_SCENE_KEY: return p.key == 0 ? &s->cfl : &s->dt;
    case PLACE_SOURCE: return p.key % 2 ? &source_at(s, p.key / 2)->on : &source_at(s, p.key / 2)->strength;
    case PLACE_DECLARED: break;
    }
    return &s->parameters[p.key].number;
}

/* ---- describing -------------------------------------------------------------------------------------------------- */

static void describe_table(const parameter *p, knob *k) {
    snprintf(k->key, sizeof k->key, "%s", p->key);
    snprintf(k->unit, sizeof k->unit, "%s", p->unit);
    snprintf(k->doc, sizeof k->doc, "%s", p->doc);
    k->kind = p->kind;
    k->components = p->kind == PARAMETER_VECTOR ? 3 : 1;
    k->minimum = p->minimum;
    k->maximum = p->maximum;
    memcpy(k->fallback, p->fallback, sizeof k->fallback);
    k->live = p->live;
    k->logarithmic = p->logarithmic;
    k->short_form = p->short_form != NULL;
    k->choices = p->choices;
    if (!p->live) snprintf(k->why_not, sizeof k->why_not, "%s: restart", p->why_not ? p->why_not : "the scene is made with it");
}

static void describe_declared(const scene_parameter *p, knob *k) {
    memcpy(k->unit, p->unit, sizeof p->unit);
    memcpy(k->doc, p->doc, sizeof p->doc);
    snprintf(k->key, sizeof k->key, "%.63s", p->name);
    k->minimum = -HUGE_VAL;
    k->maximum = HUGE_VAL;
    k->fallback[0] = p->number;
    snprintf(k->why_not, sizeof k->why_not, "the script makes the scene with it: restart");
}

static void describe_path(const scene *s, knob_place p, knob *k) {
    int count;
    const effect *e = p.effect >= 0 ? effect_catalogue(&count)[p.effect] : NULL;
    if (p.material >= 0) memcpy(k->owner, s->materials[p.material].name, sizeof k->owner);
    if (e) snprintf(k->effect, sizeof k->effect, "%s", e->name);
    if (p.kind == PLACE_SOURCE) snprintf(k->path, sizeof k->path, "sources.%d.%.31s", p.key / 2 + 1, k->key);
    else if (*k->owner && e) snprintf(k->path, sizeof k->path, "%.63s.%.30s.%.31s", k->owner, e->name, k->key);
    else if (*k->owner || e) snprintf(k->path, sizeof k->path, "%.63s.%.31s", e ? e->name : k->owner, k->key);
    else snprintf(k->path, sizeof k->path, "%.63s", k->key);
}

static bool varies(const scene_material *m, knob_place p) {
    for (int v = 0; v < m->variation_count; v++)
        if (m->variations[v].effect == p.effect && (p.effect < 0 || m->variations[v].key == p.key)) return true;
    return false;
}

static void describe(const scene *start, const scene *now, knob_place p, knob *k) {
    const parameter *row = table_of(p);
    *k = (knob){.material = p.material, .components = 1, .twin = -1};
    if (row) describe_table(row, k);
    else describe_declared(&now->parameters[p.key], k);
    describe_path(now, p, k);
    size_t bytes = (size_t)k->components * sizeof(double);
    memcpy(k->start, knob_place_value((scene *)(uintptr_t)start, p), bytes);
    memcpy(k->value, knob_place_value((scene *)(uintptr_t)now, p), bytes);
    if (p.material >= 0) k->varies = varies(&now->materials[p.material], p);
    if (row && row->twin) k->derived = !knob_place_values((scene *)(uintptr_t)now, p)->given[p.key];
}

/* The place that says the same thing as place i. */
static int find_twin(const knob_places *all, int i) {
    knob_place p = all->items[i];
    const parameter *row = table_of(p);
    if (p.kind != PLACE_EFFECT || !row->twin) return -1;
    for (int j = 0; j < all->count; j++) {
        knob_place q = all->items[j];
        if (q.kind == PLACE_EFFECT && q.material == p.material && q.effect == p.effect && strcmp(table_of(q)->key, row->twin) == 0) return j;
    }
    return -1;
}

int scene_knobs(const scene *start, const scene *now, knob *out, int limit) {
    knob_places all;
    knob_places_list(now, &all);
    for (int i = 0; i < all.count && i < limit; i++) {
        describe(start, now, all.items[i], &out[i]);
        out[i].twin = find_twin(&all, i);
    }
    return all.count;
}

/* ---- finding ----------------------------------------------------------------------------------------------------- */

/* The forms that --set knows: key, effect.key, material.key, material.effect.key; of short forms the effect alone too. */
static bool answers(const knob *k, const char *word) {
    char name[2 * KNOB_PATH];
    if (strcmp(word, k->path) == 0 || strcmp(word, k->key) == 0) return true;
    snprintf(name, sizeof name, "%s.%s", k->effect, k->key);
    if (*k->effect && strcmp(word, name) == 0) return true;
    snprintf(name, sizeof name, "%s.%s", k->owner, k->key);
    if (*k->owner && strcmp(word, name) == 0) return true;
    if (!k->short_form) return false;
    snprintf(name, sizeof name, "%s%s%s", k->owner, *k->owner ? "." : "", k->effect);
    return strcmp(word, k->effect) == 0 || strcmp(word, name) == 0;
}

static int not_found(const knob *list, int count, const char *word, report *r) {
    const char **names = memory_allocate_array((size_t)count + 1, 2 * sizeof *names);
    int named = 0;
    for (int i = 0; names && i < count; i++) {
        names[named++] = list[i].path;
        if (!strchr(word, '.')) names[named++] = list[i].key;
    }
    const char *nearest = names ? name_nearest(word, names, named) : NULL;
    report_input(r, NULL, 0, word, "a knob of this scene", "a name that does not exist", nearest);
    memory_free(names, ((size_t)count + 1) * 2 * sizeof *names);
    return -1;
}

int knob_find(const knob *list, int count, const char *word, report *r) {
    int found = -1;
    for (int i = 0; i < count; i++)
        if (strcmp(list[i].path, word) == 0) return i;
    char expected[256] = "one of ";
    size_t used = strlen(expected);
    for (int i = 0; i < count; i++) {
        if (!answers(&list[i], word)) continue;
        if (used < sizeof expected) used += (size_t)snprintf(expected + used, sizeof expected - used, "%s%s", found == -1 ? "" : ", ", list[i].path);
        found = found == -1 ? i : -2;
    }
    if (found == -2) report_input(r, NULL, 0, word, expected, "a name that several knobs have", NULL);
    if (found == -1) return not_found(list, count, word, r);
    return found < 0 ? -1 : found;
}

/* ---- values as text ---------------------------------------------------------------------------------------------- */

/* The text up to `end`, read as a number and no further. */
static bool read_number(const char *text, double *value, const char **end) {
    char *stop;
    *value = strtod(text, &stop);
    *end = stop + strspn(stop, " ");
    return stop != text && isfinite(*value);
}

static bool read_vector(const char *text, double value[3]) {
    const char *at = text + strspn(text, " {"), *end;
    for (int c = 0; c < 3; c++) {
        if (!read_number(at, &value[c], &end) || (c < 2 && *end != ',')) return false;
        at = end + 1;
    }
    end += strspn(end, " }");
    return *end == '\0';
}

static status parse_choice(const knob *k, const char *text, double *value, report *r) {
    int count = 0;
    char expected[256] = "one of ";
    size_t used = strlen(expected);
    for (; k->choices[count]; count++) {
        if (strcmp(text, k->choices[count]) == 0) {
            *value = count;
            return STATUS_OK;
        }
        if (used < sizeof expected) used += (size_t)snprintf(expected + used, sizeof expected - used, "%s%s", count ? ", " : "", k->choices[count]);
    }
    const char *end;
    if (read_number(text, value, &end) && *end == '\0') return STATUS_OK; /* its range is checked after */
    return report_input(r, NULL, 0, k->path, expected, text, name_nearest(text, k->choices, count));
}

static status parse_kind(const knob *k, const char *text, double value[3], report *r) {
    const char *end;
    if (k->kind == PARAMETER_CHOICE) return parse_choice(k, text, value, r);
    if (k->kind == PARAMETER_VECTOR)
        return read_vector(text, value) ? STATUS_OK : report_input(r, NULL, 0, k->path, "three numbers: x,y,z", text, NULL);
    if (k->kind == PARAMETER_BOOLEAN && (strcmp(text, "true") == 0 || strcmp(text, "false") == 0)) {
        *value = strcmp(text, "true") == 0;
        return STATUS_OK;
    }
    if (read_number(text, value, &end) && *end == '\0') return STATUS_OK;
    return report_input(r, NULL, 0, k->path, k->kind == PARAMETER_BOOLEAN ? "true or false" : "a number", *text ? text : "nothing", NULL);
}

status knob_check(const knob *k, const double value[3], report *r) {
    char expected[128], found[64];
    for (int c = 0; c < k->components; c++) {
        bool whole = k->kind == PARAMETER_REAL || k->kind == PARAMETER_VECTOR || floor(value[c]) == value[c];
        if (isfinite(value[c]) && value[c] >= k->minimum && value[c] <= k->maximum && whole) continue;
        snprintf(expected, sizeof expected, "%s from %g to %g", whole ? "a value" : "a whole number", k->minimum, k->maximum);
        snprintf(found, sizeof found, "%.6g", value[c]);
        return report_input(r, NULL, 0, k->path, expected, found, NULL);
    }
    return STATUS_OK;
}

status knob_parse(const knob *k, const char *text, double value[3], report *r) {
    double read[3] = {0};
    status code = parse_kind(k, text, read, r);
    if (code == STATUS_OK) code = knob_check(k, read, r);
    if (code == STATUS_OK) memcpy(value, read, 3 * sizeof *value);
    return code;
}

/* The shortest text that reads back as the same number. */
static int print_number(double x, char text[40]) {
    for (int digits = 15; digits < 17; digits++) {
        snprintf(text, 40, "%.*g", digits, x);
        if (strtod(text, NULL) == x) return (int)strlen(text);
    }
    return snprintf(text, 40, "%.17g", x);
}

void knob_print(const knob *k, const double value[3], char *text) {
    char numbers[3][40];
    for (int c = 0; c < 3; c++) print_number(value[c], numbers[c]);
    if (k->kind == PARAMETER_VECTOR) snprintf(text, KNOB_TEXT, "%s,%s,%s", numbers[0], numbers[1], numbers[2]);
    else if (k->kind == PARAMETER_BOOLEAN) snprintf(text, KNOB_TEXT, "%s", value[0] != 0 ? "true" : "false");
    else if (k->kind == PARAMETER_CHOICE) snprintf(text, KNOB_TEXT, "%s", k->choices[(int)value[0]]);
    else snprintf(text, KNOB_TEXT, "%s", numbers[0]);
}
