/* --set and pinned values that no declared parameter took: keys of the scene, and knobs of effects by name or dotted
 * path. */
#include "script/internal.h"

#include "base/names.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MATCHES = 64, NAMES = 1024, PATH_SIZE = 192, SOURCE = -2 };

/* A value that --set can reach beside the scene's plain keys. */
typedef struct knob {
    int row;    /* material, or SCENE_SITE */
    int effect; /* −1: the density; SOURCE: one of the bodies' and sheets' sources */
    int key;    /* of a source 2 × its number among all, and 1 more for `on` */
} knob;

static scene_source *source_at(scene *s, int number) {
    return (scene_source *)(uintptr_t)scene_source_at(s, number);
}

static void source_name(int key, char *text) {
    snprintf(text, PATH_SIZE, "sources.%d.%s", key / 2 + 1, key % 2 ? "on" : "strength");
}

static const effect *effect_at(int index) {
    int count;
    return effect_catalogue(&count)[index];
}

/* "tube.damage.eta", "tube.density", "gravity.acceleration", "sources.1.strength" */
static void knob_path(const script *s, knob k, char *text) {
    const char *material = k.row == SCENE_SITE ? "" : s->scene->materials[k.row].name;
    if (k.effect == SOURCE)
        source_name(k.key, text);
    else if (k.effect < 0)
        snprintf(text, PATH_SIZE, "%s.density", material);
    else
        snprintf(text, PATH_SIZE, "%s%s%s.%s", material, *material ? "." : "", effect_at(k.effect)->name,
                 effect_at(k.effect)->parameters[k.key].key);
}

/* The names that a knob answers to; at most 6 of PATH_SIZE bytes. */
static int knob_names(const script *s, knob k, char names[6][PATH_SIZE]) {
    bool of_scene = k.row == SCENE_SITE;
    const char *material = of_scene ? "" : s->scene->materials[k.row].name;
    int count = 0;
    if (k.effect == SOURCE) {
        source_name(k.key, names[count++]);
        return count;
    }
    if (k.effect < 0) {
        snprintf(names[count++], PATH_SIZE, "density");
        snprintf(names[count++], PATH_SIZE, "%s.density", material);
        return count;
    }
    const effect *e = effect_at(k.effect);
    const parameter *p = &e->parameters[k.key];
    snprintf(names[count++], PATH_SIZE, "%s", p->key);
    snprintf(names[count++], PATH_SIZE, "%s.%s", e->name, p->key);
    if (p->short_form) snprintf(names[count++], PATH_SIZE, "%s", e->name);
    if (of_scene) return count;
    snprintf(names[count++], PATH_SIZE, "%s.%s", material, p->key);
    snprintf(names[count++], PATH_SIZE, "%s.%s.%s", material, e->name, p->key);
    if (p->short_form) snprintf(names[count++], PATH_SIZE, "%s.%s", material, e->name);
    return count;
}

typedef bool (*knob_visitor)(const script *s, knob k, bool on, void *context);

/* Visits every knob of the scene, of effects that are off too; ends when the visitor says false. */
static void visit_knobs(const script *s, knob_visitor visit, void *context) {
    int count;
    const effect *const *all = effect_catalogue(&count);
    for (int row = 0; row <= SCENE_SITE; row++) {
        bool of_scene = row == SCENE_SITE;
        if (!of_scene && row >= s->scene->material_count) continue;
        const effect_values *values = of_scene ? s->scene->effects : s->scene->materials[row].effects;
        if (!of_scene && !visit(s, (knob){row, -1, 0}, true, context)) return;
        for (int e = 0; e < count; e++) {
            if ((all[e]->scope == SCOPE_SCENE) != of_scene) continue;
            for (int k = 0; k < all[e]->parameter_count; k++)
                if (!visit(s, (knob){row, e, k}, values[e].on, context)) return;
        }
    }
    for (int key = 0; source_at(s->scene, key / 2); key++)
        if (!visit(s, (knob){SCENE_SITE, SOURCE, key}, true, context)) return;
}

/* ---- finding ----------------------------------------------------------------------------------------------------- */

typedef struct knob_search {
    const char *name;
    int on_count, off_count;
    knob on[MATCHES];
    knob off; /* the first that matches but is not on */
} knob_search;

static bool match_knob(const script *s, knob k, bool on, void *context) {
    knob_search *q = context;
    char names[6][PATH_SIZE];
    int count = knob_names(s, k, names);
    bool same = false;
    for (int i = 0; i < count; i++) same = same || strcmp(names[i], q->name) == 0;
    if (same && on && q->on_count < MATCHES) q->on[q->on_count++] = k;
    if (same && !on && q->off_count++ == 0) q->off = k;
    return true;
}

typedef struct name_pool {
    bool dotted;
    int count;
    char text[NAMES][PATH_SIZE];
    const char *names[NAMES];
} name_pool;

static void add_name(name_pool *pool, const char *name) {
    if (pool->count == NAMES) return;
    snprintf(pool->text[pool->count], PATH_SIZE, "%.*s", PATH_SIZE - 1, name);
    pool->names[pool->count] = pool->text[pool->count];
    pool->count++;
}

static bool pool_knob(const script *s, knob k, bool on, void *context) {
    name_pool *pool = context;
    char names[6][PATH_SIZE];
    int count = on ? knob_names(s, k, names) : 0;
    for (int i = 0; i < count; i++)
        if ((strchr(names[i], '.') != NULL) == pool->dotted) add_name(pool, names[i]);
    return pool->count < NAMES;
}

/* The nearest name that --set would take, copied into out[PATH_SIZE]; NULL when none is near. */
static const char *nearest_setting(script *s, const char *name, char *out) {
    name_pool *pool = memory_allocate(sizeof *pool);
    if (!pool) return NULL;
    pool->dotted = strchr(name, '.') != NULL;
    if (!pool->dotted) {
        for (int i = 0; i < s->declared_count; i++) add_name(pool, s->declared[i].name);
        for (int i = 0; i < scene_key_count(); i++) add_name(pool, scene_key_name(i));
    }
    visit_knobs(s, pool_knob, pool);
    const char *nearest = name_nearest(name, pool->names, pool->count);
    if (nearest) snprintf(out, PATH_SIZE, "%s", nearest);
    memory_free(pool, sizeof *pool);
    return nearest ? out : NULL;
}

/* ---- applying ---------------------------------------------------------------------------------------------------- */

static void report_setting(script *s, const script_override *o, const char *expected, const char *found,
                           const char *nearest) {
    char key[160];
    snprintf(key, sizeof key, "%s %s", o->pinned ? "resolved" : "--set", o->key);
    report r;
    report_input(&r, s->sources[0].display, s->scene_line, key, expected, found, nearest);
    problem_report(s, &r);
}

static void report_ambiguous(script *s, const script_override *o, const knob_search *q) {
    char expected[256] = "one of ";
    size_t used = strlen(expected);
    for (int i = 0; i < q->on_count && used < sizeof expected; i++) {
        char path[PATH_SIZE];
        knob_path(s, q->on[i], path);
        used += (size_t)snprintf(expected + used, sizeof expected - used, "%s%s", i ? ", " : "", path);
    }
    report_setting(s, o, expected, "a name that several materials or effects have", NULL);
}

/* A value that is set takes the place of a function, its own or its twin's. */
static void drop_variation(scene_material *m, int effect_index_, int key, int twin) {
    int kept = 0;
    for (int v = 0; v < m->variation_count; v++) {
        const scene_variation *old = &m->variations[v];
        if (old->effect != effect_index_ || (old->key != key && old->key != twin)) m->variations[kept++] = *old;
    }
    m->variation_count = kept;
}

static void set_density(script *s, const script_override *o, knob k) {
    plain_value v = plain_from_text(o->value);
    plain_rule rule = {.kind = PLAIN_NUMBER, .minimum = 0, .maximum = HUGE_VAL, .above = true};
    char expected[256];
    const char *nearest;
    if (!plain_fit(&v, &rule, expected, sizeof expected, &nearest)) {
        report_setting(s, o, expected, v.found, nearest);
        return;
    }
    s->scene->materials[k.row].density = v.number[0];
    drop_variation(&s->scene->materials[k.row], -1, 0, -1);
    s->density_set[k.row] = s->density_set[k.row] || !o->pinned;
}

static void set_source(script *s, const script_override *o, knob k) {
    plain_value v = plain_from_text(o->value);
    plain_rule rule = {.kind = k.key % 2 ? PLAIN_BOOLEAN : PLAIN_NUMBER, .minimum = -1e12, .maximum = 1e12};
    char expected[256];
    const char *nearest;
    scene_source *to = source_at(s->scene, k.key / 2);
    if (!plain_fit(&v, &rule, expected, sizeof expected, &nearest)) report_setting(s, o, expected, v.found, nearest);
    else if (k.key % 2) to->on = v.number[0];
    else to->strength = v.number[0];
}

static void set_knob(script *s, const script_override *o, knob k) {
    if (k.effect == SOURCE) {
        set_source(s, o, k);
        return;
    }
    if (k.effect < 0) {
        set_density(s, o, k);
        return;
    }
    const effect *e = effect_at(k.effect);
    effect_values *values =
        k.row == SCENE_SITE ? &s->scene->effects[k.effect] : &s->scene->materials[k.row].effects[k.effect];
    plain_value v = plain_from_text(o->value);
    char expected[256];
    const char *nearest;
    if (!set_effect_parameter(e, k.key, &v, values, expected, sizeof expected, &nearest)) {
        report_setting(s, o, expected, v.found, nearest);
        return;
    }
    bool *set = s->knob_set[k.row][k.effect];
    set[k.key] = set[k.key] || !o->pinned;
    /* Of two keys that say the same thing the one set last holds. */
    const char *twin_name = e->parameters[k.key].twin;
    int twin = twin_name ? effect_parameter(e, twin_name) : -1;
    if (twin >= 0) {
        values->given[twin] = set[twin] = false;
        memcpy(values->value[twin], e->parameters[twin].fallback, sizeof values->value[twin]);
    }
    if (k.row < SCENE_SITE) drop_variation(&s->scene->materials[k.row], k.effect, k.key, twin);
}

static void apply_knob(script *s, const script_override *o) {
    knob_search q = {.name = o->key};
    visit_knobs(s, match_knob, &q);
    if (q.on_count == 1) {
        set_knob(s, o, q.on[0]);
    } else if (q.on_count > 1) {
        report_ambiguous(s, o, &q);
    } else if (q.off_count > 0) {
        char expected[128];
        snprintf(expected, sizeof expected, "a key of an effect that is on ('%s' is off here)",
                 effect_at(q.off.effect)->name);
        report_setting(s, o, expected, "a key of one that is not", NULL);
    } else {
        char nearest[PATH_SIZE];
        report_setting(s, o, "a parameter of this scene, a key of the scene, or material.effect.key",
                       "a name that does not exist", nearest_setting(s, o->key, nearest));
    }
}

void settings_apply(script *s) {
    for (int i = 0; i < s->override_count; i++) {
        script_override *o = &s->overrides[i];
        if (o->used) continue;
        int key = scene_key_find(o->key);
        if (key < 0) {
            apply_knob(s, o);
            continue;
        }
        plain_value v = plain_from_text(o->value);
        char expected[256];
        const char *nearest;
        if (!scene_key_set(s->scene, key, &v, expected, sizeof expected, &nearest))
            report_setting(s, o, expected, v.found, nearest);
        if (!o->pinned) s->scene_keys_set |= (uint64_t)1 << key;
    }
}
