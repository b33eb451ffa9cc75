/* A tuned material as a recipe: Lua that loads again and resolves to the same values. */
#include "base/json.h"
#include "base/memory.h"
#include "session/internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Lua reads C's decimal numbers, 17 digits at most bring back every bit. */
static void put_value(FILE *out, const parameter *p, const double value[3]) {
    char text[JSON_NUMBER];
    if (p->kind == PARAMETER_BOOLEAN) fprintf(out, "%s", value[0] != 0 ? "true" : "false");
    else if (p->kind == PARAMETER_CHOICE) fprintf(out, "\"%s\"", p->choices[(int)value[0]]);
    else
        for (int c = 0; c < (p->kind == PARAMETER_VECTOR ? 3 : 1); c++) {
            json_format_number(value[c], text);
            fprintf(out, "%s%s", c ? ", " : p->kind == PARAMETER_VECTOR ? "{ " : "", text);
        }
    if (p->kind == PARAMETER_VECTOR) fprintf(out, " }");
}

/* Said by the scene, or turned; what was not and is at its default stays unsaid, and so does what follows from its twin. */
static bool is_said(const parameter *p, const effect_values *values, int k) {
    if (values->given[k]) return true;
    return !p->twin && memcmp(values->value[k], p->fallback, sizeof p->fallback) != 0;
}

static void put_effect(FILE *out, const effect *e, const effect_values *values) {
    int said = 0;
    fprintf(out, "  %s = ", e->name);
    for (int k = 0; k < e->parameter_count; k++) {
        if (!is_said(&e->parameters[k], values, k)) continue;
        fprintf(out, "%s%s = ", said++ ? ", " : "{ ", e->parameters[k].key);
        put_value(out, &e->parameters[k], values->value[k]);
    }
    fprintf(out, "%s,\n", said ? " }" : "true");
}

/* Comments are one line each, whatever a title holds. */
static void put_comment(FILE *out, const char *text) {
    for (const char *c = text; *c; c++) fputc((unsigned char)*c < ' ' ? ' ' : *c, out);
}

static void put_origin(FILE *out, const session *s, const scene_material *m, int64_t frame) {
    fprintf(out, "-- Material '");
    put_comment(out, m->name);
    fprintf(out, "' of the scene '");
    put_comment(out, s->scene->title);
    fprintf(out, "' as it was tuned in run %s, after frame %lld.\n", s->id, (long long)frame);
    if (m->variation_count > 0) fprintf(out, "-- What the scene gives as a function of place stands here with its largest value.\n");
}

static void put_material(FILE *out, const scene_material *m) {
    int count;
    const effect *const *effects = effect_catalogue(&count);
    char density[JSON_NUMBER];
    json_format_number(m->density, density);
    fprintf(out, "return {\n  density = %s,\n", density);
    for (int e = 0; e < count; e++)
        if (m->effects[e].on && effects[e]->scope == SCOPE_MATERIAL) put_effect(out, effects[e], &m->effects[e]);
    fprintf(out, "}\n");
}

static status no_material(const session *s, int material, report *r) {
    char expected[64], found[24];
    snprintf(expected, sizeof expected, "a material's number, from 0 to %d", s->scene->material_count - 1);
    snprintf(found, sizeof found, "%d", material);
    return report_input(r, NULL, 0, "material", expected, found, NULL);
}

/* Recipes are found by their names without the `.lua` that their files end in. */
static status recipe_file(const char *path, char file[SESSION_RECIPE], report *r) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *ending = strrchr(name, '.');
    if (!*name || ending == name || (ending && strcmp(ending, ".lua") != 0))
        return report_input(r, NULL, 0, "recipe", "a file name that ends in .lua, or has no ending", path, NULL);
    if (snprintf(file, SESSION_RECIPE, "%s%s", path, ending ? "" : ".lua") >= SESSION_RECIPE)
        return report_input(r, NULL, 0, "recipe", "a shorter path", path, NULL);
    return STATUS_OK;
}

status session_save_recipe(session *s, int material, const char *path, char file[SESSION_RECIPE], report *r) {
    char own[SESSION_RECIPE];
    if (!file) file = own;
    if (material < 0 || material >= s->scene->material_count) return no_material(s, material, r);
    status code = recipe_file(path, file, r);
    if (code != STATUS_OK) return code;
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);
    if (!out) return report_set(r, STATUS_SYSTEM, "out of memory for a recipe");
    pthread_mutex_lock(&s->lock);
    int64_t frame = s->shown.frame;
    pthread_mutex_unlock(&s->lock);
    pthread_mutex_lock(&s->knobs.lock);
    put_origin(out, s, &s->knobs.asked->materials[material], frame);
    put_material(out, &s->knobs.asked->materials[material]);
    pthread_mutex_unlock(&s->knobs.lock);
    code = fclose(out) ? report_set(r, STATUS_SYSTEM, "out of memory for a recipe") : file_write_atomic(file, text, size, r);
    free(text);
    return code;
}
