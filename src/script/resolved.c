/* The list of every resolved parameter, and the Lua text that pins them. */
#include "script/internal.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Room for one more; NULL when the list is full. */
static scene_parameter *add_parameter(script *s) {
    scene *sc = s->scene;
    if (sc->parameter_count < SCENE_PARAMETERS) return &sc->parameters[sc->parameter_count++];
    return NULL;
}

/* The shortest text that reads back as the same number. */
static void print_number(double x, char text[40]) {
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, 40, "%.*g", digits, x);
        if (strtod(text, NULL) == x) return;
    }
}

static void show_vector(const double value[3], char *text, size_t size) {
    char numbers[3][40];
    for (int c = 0; c < 3; c++) print_number(value[c], numbers[c]);
    snprintf(text, size, "%s,%s,%s", numbers[0], numbers[1], numbers[2]);
}

static void show_value(const parameter *p, const double value[3], scene_parameter *out) {
    snprintf(out->unit, sizeof out->unit, "%s", p->unit);
    snprintf(out->doc, sizeof out->doc, "%s", p->doc);
    out->is_text = p->kind != PARAMETER_REAL;
    out->number = value[0];
    if (p->kind == PARAMETER_BOOLEAN) snprintf(out->text, sizeof out->text, "%s", value[0] != 0 ? "true" : "false");
    if (p->kind == PARAMETER_CHOICE) snprintf(out->text, sizeof out->text, "%s", p->choices[(int)value[0]]);
    if (p->kind == PARAMETER_VECTOR) show_vector(value, out->text, sizeof out->text);
}

/* ---- the text ---------------------------------------------------------------------------------------------------- */

typedef struct text_out {
    char *text;
    size_t used, size; /* size 0: only counting */
} text_out;

static void put(text_out *out, const char *text, size_t length) {
    if (out->used + length < out->size) memcpy(out->text + out->used, text, length);
    out->used += length;
}

static void put_text(text_out *out, const char *text) {
    put(out, text, strlen(text));
}

static void put_quoted(text_out *out, const char *text) {
    put_text(out, "\"");
    for (const char *p = text; *p; p++) {
        char escaped[8];
        bool plain = !iscntrl((unsigned char)*p) && *p != '"' && *p != '\\';
        snprintf(escaped, sizeof escaped, "\\%03d", (unsigned char)*p);
        if (plain)
            put(out, p, 1);
        else
            put_text(out, escaped);
    }
    put_text(out, "\"");
}

static void put_parameter(text_out *out, const scene_parameter *p) {
    char number[40];
    print_number(p->number, number);
    put_text(out, "  [");
    put_quoted(out, p->name);
    put_text(out, "] = ");
    if (p->is_text)
        put_quoted(out, p->text);
    else
        put_text(out, number);
    put_text(out, ",\n");
}

/* Derived halves of twins are left out: the given half pins both. So is what a function of place gives: the function says it again. */
static void put_all(const script *s, const bool *derived, text_out *out) {
    put_text(out, "-- Every parameter of this run.\nreturn {\n");
    for (int i = 0; i < s->scene->parameter_count; i++)
        if (!derived[i]) put_parameter(out, &s->scene->parameters[i]);
    put_text(out, "}\n");
}

static void write_text(script *s, const bool *derived) {
    text_out out = {0};
    put_all(s, derived, &out);
    out = (text_out){.text = arena_allocate(s->memory, out.used + 1), .size = out.used + 1};
    if (!out.text) return;
    put_all(s, derived, &out);
    s->resolved = out.text;
}

/* ---- the list ---------------------------------------------------------------------------------------------------- */

static bool varies(const script *s, int row, int index, int key) {
    const scene_material *m = &s->scene->materials[row];
    for (int v = 0; row < SCENE_SITE && v < m->variation_count; v++)
        if (m->variations[v].effect == index && m->variations[v].key == key) return true;
    return false;
}

/* The parameters of one effect; the name is prefix.effect.key. */
static bool list_effect(script *s, int row, int index, bool *derived) {
    int count;
    const effect *e = effect_catalogue(&count)[index];
    const effect_values *values =
        row == SCENE_SITE ? &s->scene->effects[index] : &s->scene->materials[row].effects[index];
    if (!values->on) return true;
    for (int k = 0; k < e->parameter_count; k++) {
        scene_parameter *p = add_parameter(s);
        if (!p) return false;
        show_value(&e->parameters[k], values->value[k], p);
        snprintf(p->name, sizeof p->name, "%s%s%s.%s", row == SCENE_SITE ? "" : s->scene->materials[row].name,
                 row == SCENE_SITE ? "" : ".", e->name, e->parameters[k].key);
        p->from_set = s->knob_set[row][index][k];
        derived[p - s->scene->parameters] = (e->parameters[k].twin && !values->given[k]) || varies(s, row, index, k);
    }
    return true;
}

static bool list_material(script *s, int row, bool *derived) {
    int count;
    effect_catalogue(&count);
    scene_parameter *p = add_parameter(s);
    if (!p) return false;
    const scene_material *m = &s->scene->materials[row];
    *p = (scene_parameter){.unit = "mass/length^3", .doc = "at rest", .number = m->density};
    char name[sizeof m->name];
    memcpy(name, m->name, sizeof name);
    snprintf(p->name, sizeof p->name, "%.63s.density", name);
    p->from_set = s->density_set[row];
    derived[p - s->scene->parameters] = varies(s, row, -1, 0);
    for (int e = 0; e < count; e++)
        if (!list_effect(s, row, e, derived)) return false;
    return true;
}

static bool list_sources(script *s) {
    const scene_source *from;
    for (int number = 0; (from = scene_source_at(s->scene, number)); number++) {
        scene_parameter *strength = add_parameter(s), *on = add_parameter(s);
        if (!strength || !on) return false;
        *strength = (scene_parameter){.unit = "1", .doc = "what the source gives, or holds, is multiplied by this", .number = from->strength};
        *on = (scene_parameter){.unit = "1", .doc = "whether the source does anything", .is_text = true, .number = from->on};
        snprintf(strength->name, sizeof strength->name, "sources.%d.strength", number + 1);
        snprintf(on->name, sizeof on->name, "sources.%d.on", number + 1);
        snprintf(on->text, sizeof on->text, "%s", from->on != 0 ? "true" : "false");
    }
    return true;
}

static bool list_all(script *s, bool *derived) {
    int count;
    effect_catalogue(&count);
    for (int i = 0; i < s->declared_count; i++) {
        scene_parameter *p = add_parameter(s);
        if (!p) return false;
        *p = s->declared[i].shown;
    }
    for (int key = 0; key < scene_key_count(); key++) {
        if (s->scene_keys_declared >> key & 1) continue;
        scene_parameter *p = add_parameter(s);
        if (!p) return false;
        scene_key_show(s->scene, key, p);
        p->from_set = s->scene_keys_set >> key & 1;
    }
    for (int e = 0; e < count; e++)
        if (!list_effect(s, SCENE_SITE, e, derived)) return false;
    if (!list_sources(s)) return false;
    for (int row = 0; row < s->scene->material_count; row++)
        if (!list_material(s, row, derived)) return false;
    return true;
}

status resolve_parameters(script *s, report *r) {
    bool derived[SCENE_PARAMETERS] = {false};
    if (!list_all(s, derived)) {
        char expected[96];
        snprintf(expected, sizeof expected, "at most %d parameters: of the scene, and of its materials' effects",
                 SCENE_PARAMETERS);
        return report_input(r, s->sources[0].display, s->scene_line, "scene", expected, "more", NULL);
    }
    write_text(s, derived);
    return s->resolved ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory while a scene was resolved");
}
