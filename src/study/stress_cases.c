/* Finding the hard cases. */
#include "study/stress.h"

#include "base/memory.h"
#include "base/names.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SCENES = 512, CASES = 512, VARIANTS = 64, NAME_LIMIT = 56 /* "stress:NAME/VARIANT" is a tag */ };

static uint32_t effects_on(const scene *s) {
    int count;
    const effect *const *all = effect_catalogue(&count);
    uint32_t mask = 0;
    for (int e = 0; e < count; e++) {
        if (all[e]->scope == SCOPE_SCENE && s->effects[e].on) mask |= 1u << e;
        for (int b = 0; b < s->body_count; b++)
            if (s->materials[s->bodies[b].material].effects[e].on && all[e]->engine == ENGINE_SOLID) mask |= 1u << e;
        for (int b = 0; b < s->sheet_count; b++)
            if (s->materials[s->sheets[b].material].effects[e].on && all[e]->engine == ENGINE_SHEET) mask |= 1u << e;
    }
    return mask;
}

static void take_gravity(const scene *s, double out[3]) {
    int count, e = effect_index("gravity"), key = e < 0 ? -1 : effect_parameter(effect_catalogue(&count)[e], "acceleration");
    memset(out, 0, 3 * sizeof *out);
    if (key >= 0 && s->effects[e].on) memcpy(out, s->effects[e].value[key], 3 * sizeof *out);
}

static status fail(script_reports *reports, const char *file, const char *key, const char *expected, const char *found, const char *nearest) {
    reports->count = 1;
    return report_input(&reports->items[0], file, 0, key, expected, found, nearest);
}

/* The variants that the file declares; none is one without a name. */
static int list_variants(const script *from, char (*out)[HARD_TEXT]) {
    for (int i = 0; i < script_declaration_count(from); i++) {
        script_declaration d = script_declaration_at(from, i);
        if (strcmp(d.name, "variant") != 0 || d.choice_count == 0) continue;
        int count = d.choice_count < VARIANTS ? d.choice_count : VARIANTS;
        for (int k = 0; k < count; k++) snprintf(out[k], HARD_TEXT, "%s", d.choices[k]);
        return count;
    }
    out[0][0] = '\0';
    return 1;
}

static int64_t declared_particles(const script *from) {
    for (int i = 0; i < script_declaration_count(from); i++)
        if (strcmp(script_declaration_at(from, i).name, "particles") == 0) return (int64_t)script_declaration_at(from, i).shown->number;
    return 0;
}

static status load(const char *path, const char *variant, script **out, script_reports *reports) {
    script_setting setting = {"variant", variant};
    script_options o = script_options_default();
    o.settings = &setting;
    o.setting_count = variant[0] != '\0';
    return script_load(path, &o, out, reports);
}

static status take_case(const library_scene *file, const char *variant, script *from, stress_case *c, script_reports *reports) {
    scene *s = script_scene(from);
    if (strlen(file->name) + strlen(variant) > NAME_LIMIT) return fail(reports, file->path, "variant", "a file's name and a variant of 56 bytes together", "more", NULL);
    if (!s->hard.given) return fail(reports, file->path, "expect", "what its run must come to: expect = { energy_gain = 0.05, … } (docs/stress.md)", "nothing", NULL);
    *c = (stress_case){.like = -1, .hard = s->hard, .effects = effects_on(s), .particles = declared_particles(from)};
    snprintf(c->name, sizeof c->name, "%s%s%.*s", file->name, variant[0] ? "/" : "", HARD_TEXT - 1, variant);
    snprintf(c->scene, sizeof c->scene, "%s", file->path);
    snprintf(c->variant, sizeof c->variant, "%.*s", HARD_TEXT - 1, variant);
    snprintf(c->title, sizeof c->title, "%s", s->title);
    snprintf(c->remark, sizeof c->remark, "%s", file->remark);
    take_gravity(s, c->gravity);
    return STATUS_OK;
}

static status add_file(stress_suite *suite, const library_scene *file, script_reports *reports) {
    static char variants[VARIANTS][HARD_TEXT];
    script *from = NULL;
    status code = load(file->path, "", &from, reports);
    if (code != STATUS_OK) return code;
    int count = list_variants(from, variants);
    for (int i = 0; i < count && code == STATUS_OK; i++) {
        script_close(from), from = NULL;
        code = load(file->path, variants[i], &from, reports);
        if (code == STATUS_OK && suite->count == suite->capacity) code = fail(reports, file->path, NULL, "at most 512 hard cases", "more", NULL);
        if (code == STATUS_OK) code = take_case(file, variants[i], from, &suite->cases[suite->count], reports);
        suite->count += code == STATUS_OK;
    }
    if (from) script_close(from);
    return code;
}

static int compare_cases(const void *a, const void *b) {
    const stress_case *x = a, *y = b;
    return strcmp(x->name, y->name);
}

static status find_likes(stress_suite *suite, script_reports *reports) {
    for (int i = 0; i < suite->count; i++) {
        stress_case *c = &suite->cases[i];
        const char *names[CASES];
        if (!c->hard.same_as.variant[0]) continue;
        for (int k = 0; k < suite->count; k++) {
            const stress_case *other = &suite->cases[k];
            bool mate = k != i && strcmp(other->scene, c->scene) == 0;
            names[k] = mate ? other->variant : NULL;
            if (mate && strcmp(other->variant, c->hard.same_as.variant) == 0) c->like = k;
        }
        if (c->like < 0)
            return fail(reports, c->scene, "expect.same_as.variant", "another variant of the scene", c->hard.same_as.variant,
                        name_nearest(c->hard.same_as.variant, names, suite->count));
    }
    return STATUS_OK;
}

status stress_find(stress_suite *out, script_reports *reports) {
    library_scene *scenes = memory_allocate_array(SCENES, sizeof *scenes);
    *out = (stress_suite){.capacity = CASES, .cases = memory_allocate_array(CASES, sizeof(stress_case))};
    reports->count = 1;
    status code = scenes && out->cases ? STATUS_OK : report_set(&reports->items[0], STATUS_SYSTEM, "out of memory for the hard cases");
    int count = scenes ? library_scenes(scenes, SCENES) : 0;
    for (int i = 0; i < count && code == STATUS_OK; i++)
        if (strcmp(scenes[i].group, "stress") == 0) code = add_file(out, &scenes[i], reports);
    if (out->cases) qsort(out->cases, (size_t)out->count, sizeof *out->cases, compare_cases);
    if (code == STATUS_OK) code = find_likes(out, reports);
    if (code == STATUS_OK) reports->count = 0;
    memory_free(scenes, SCENES * sizeof *scenes);
    return code;
}

void stress_free(stress_suite *s) {
    memory_free(s->cases, (size_t)s->capacity * sizeof *s->cases);
    *s = (stress_suite){0};
}

int stress_match(const stress_suite *s, const char *word, bool *chosen) {
    size_t length = strlen(word);
    int found = 0;
    for (int i = 0; i < s->count; i++) {
        const char *name = s->cases[i].name;
        if (strncmp(name, word, length) != 0 || (name[length] != '\0' && name[length] != '/')) continue;
        chosen[i] = true;
        found++;
    }
    return found;
}

const char *stress_nearest(const stress_suite *s, const char *word) {
    static char files[CASES][STRESS_NAME];
    const char *names[2 * CASES];
    int count = 0;
    for (int i = 0; i < s->count; i++) {
        snprintf(files[i], sizeof files[i], "%.*s", (int)strcspn(s->cases[i].name, "/"), s->cases[i].name);
        names[count++] = files[i];
        names[count++] = s->cases[i].name;
    }
    return name_nearest(word, names, count);
}

int stress_coverage(const stress_suite *s, int which) {
    int count = 0;
    for (int i = 0; i < s->count; i++) count += (s->cases[i].effects >> which & 1) != 0;
    return count;
}
