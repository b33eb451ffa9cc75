#include "sim/variations.h"

#include "base/memory.h"

#include <stdio.h>
#include <string.h>

static const char density_field[] = "density_scale";

/* The row of a field among those given, made (all 1) when there is none yet; −1 without memory. */
static int row_of(body_particles *p, const char *field) {
    for (int g = 0; g < p->given_count; g++)
        if (strcmp(p->given_field[g], field) == 0) return g;
    double *values = memory_allocate_array((size_t)p->count, sizeof *values);
    if (!values) return -1;
    for (int64_t i = 0; i < p->count; i++) values[i] = 1;
    p->given_field[p->given_count] = field;
    p->given[p->given_count] = values;
    return p->given_count++;
}

static status set_share(body_particles *p, const char *field, int64_t i, double value, double of, report *r) {
    if (value == of) return STATUS_OK;
    int row = row_of(p, field);
    if (row < 0) return report_set(r, STATUS_SYSTEM, "out of memory for the field '%s'", field);
    p->given[row][i] = value / of;
    return STATUS_OK;
}

static status refuse(const scene_material *m, const char *key, const char *expected, double value, const double *x, report *r) {
    char found[128];
    snprintf(found, sizeof found, "%.6g at (%.4g, %.4g, %.4g)", value, x[0], x[1], x[2]);
    return report_input(r, m->file, m->line, key, expected, found, NULL);
}

/* Puts the varying values of one place into `here` and resolves what follows from them. */
static status resolve_at(const scene_material *m, const double *x, effect_values here[EFFECT_LIMIT], double *density, report *r) {
    int count;
    const effect *const *effects = effect_catalogue(&count);
    *density = m->density;
    for (int v = 0; v < m->variation_count; v++) {
        const scene_variation *from = &m->variations[v];
        double value;
        status code = scene_function_evaluate(&from->function, x, 3, &value, r);
        if (code != STATUS_OK) return code;
        if (from->effect < 0) {
            *density = value;
            if (!(value > 0)) return refuse(m, "density", "a positive number everywhere", value, x, r);
            continue;
        }
        const effect *e = effects[from->effect];
        const parameter *q = &e->parameters[from->key];
        char key[96], expected[96];
        snprintf(key, sizeof key, "%s.%s", e->name, q->key);
        snprintf(expected, sizeof expected, "a value above 0 and from %g to %g everywhere", q->minimum, q->maximum);
        if (!(value > 0) || !(value >= q->minimum) || !(value <= q->maximum)) return refuse(m, key, expected, value, x, r);
        here[from->effect].value[from->key][0] = value;
    }
    for (int e = 0; e < count; e++) {
        if (!here[e].on || effects[e]->scope != SCOPE_MATERIAL) continue;
        status code = effect_values_check(effects[e], &here[e], here, m->file, m->line, r);
        if (code != STATUS_OK) return code;
    }
    return STATUS_OK;
}

static status share_all(const scene_material *m, const effect_values here[EFFECT_LIMIT], double density, body_particles *p, int64_t i, report *r) {
    int count;
    const effect *const *effects = effect_catalogue(&count);
    status code = set_share(p, density_field, i, density, m->density, r);
    for (int e = 0; e < count; e++)
        for (int k = 0; here[e].on && k < effects[e]->parameter_count && code == STATUS_OK; k++) {
            const parameter *q = &effects[e]->parameters[k];
            /* Of twins the first stands for both: the engine reads that one. */
            int twin = q->twin ? effect_parameter(effects[e], q->twin) : -1;
            if (q->scale && (twin < 0 || k < twin)) code = set_share(p, q->scale, i, here[e].value[k][0], m->effects[e].value[k][0], r);
        }
    return code;
}

status variations_evaluate(const scene *s, body_particles *p, report *r) {
    effect_values *here = memory_allocate_array(EFFECT_LIMIT, sizeof *here);
    status code = here ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for parameters that vary");
    int last = -1;
    for (int64_t i = 0; i < p->count && code == STATUS_OK; i++) {
        int body = p->body[i];
        const scene_material *m = &s->materials[s->bodies[body].material];
        if (m->variation_count == 0) continue;
        if (body != last) memcpy(here, m->effects, sizeof m->effects);
        last = body;
        double density;
        code = resolve_at(m, p->position + 3 * i, here, &density, r);
        if (code == STATUS_OK) code = share_all(m, here, density, p, i, r);
    }
    memory_free(here, here ? EFFECT_LIMIT * sizeof *here : 0);
    return code;
}
