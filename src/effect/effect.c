#include "effect/effect.h"

#include <stdio.h>
#include <string.h>

int effect_parameter(const effect *e, const char *key) {
    for (int i = 0; i < e->parameter_count; i++)
        if (strcmp(e->parameters[i].key, key) == 0) return i;
    return -1;
}

bool effect_supplies(const effect *e, const char *need) {
    return strcmp(e->name, need) == 0 || (e->provides && strcmp(e->provides, need) == 0);
}

void effect_values_default(const effect *e, effect_values *values) {
    memset(values, 0, sizeof *values);
    for (int i = 0; i < e->parameter_count; i++)
        memcpy(values->value[i], e->parameters[i].fallback, sizeof values->value[i]);
}

static status check_range(const effect *e, const parameter *p, const double value[3], const char *file, int line,
                          report *r) {
    int components = p->kind == PARAMETER_VECTOR ? 3 : 1;
    for (int c = 0; c < components; c++) {
        if (value[c] >= p->minimum && value[c] <= p->maximum) continue;
        char key[128], expected[128], found[64];
        snprintf(key, sizeof key, "%s.%s", e->name, p->key);
        snprintf(expected, sizeof expected, "a value from %g to %g", p->minimum, p->maximum);
        snprintf(found, sizeof found, "%g", value[c]);
        return report_input(r, file, line, key, expected, found, NULL);
    }
    return STATUS_OK;
}

static bool twin_given(const effect *e, const parameter *p, const effect_values *values) {
    int twin = p->twin ? effect_parameter(e, p->twin) : -1;
    return twin >= 0 && values->given[twin];
}

status effect_values_check(const effect *e, effect_values *values, const effect_values *all, const char *file, int line,
                           report *r) {
    for (int i = 0; i < e->parameter_count; i++) {
        const parameter *p = &e->parameters[i];
        char key[128], expected[256];
        snprintf(key, sizeof key, "%s.%s", e->name, p->key);
        if (values->given[i]) {
            if (twin_given(e, p, values)) {
                snprintf(expected, sizeof expected, "one of '%s' and '%s' (they say the same thing)", p->key, p->twin);
                return report_input(r, file, line, key, expected, "both", NULL);
            }
            status s = check_range(e, p, values->value[i], file, line, r);
            if (s != STATUS_OK) return s;
        } else if (p->required && !twin_given(e, p, values)) {
            snprintf(expected, sizeof expected, "a value%s%s (%s)", p->twin ? ", or its twin " : "",
                     p->twin ? p->twin : "", p->doc);
            return report_input(r, file, line, key, expected, "nothing", NULL);
        }
    }
    if (!e->resolve) return STATUS_OK;
    status s = e->resolve(values, all, r);
    if (s == STATUS_INPUT && !r->file[0]) {
        snprintf(r->file, sizeof r->file, "%s", file ? file : "");
        r->line = line;
    }
    return s;
}
