#include "study/axes.h"

#include "base/json.h"
#include "base/names.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct maker {
    const scene *scene;
    const simulation_plan *plan;
    int precision, levels, count;
    accuracy_axis *axes;
} maker;

static void add_setting(axis_level *l, const char *key, const char *text) {
    if (l->settings == AXIS_SETTINGS) return;
    snprintf(l->key[l->settings], AXIS_KEY, "%s", key);
    snprintf(l->text[l->settings++], AXIS_VALUE, "%s", text);
}

static void add_number(axis_level *l, const char *key, double value) {
    char text[JSON_NUMBER];
    json_format_number(value, text);
    add_setting(l, key, text);
}

static accuracy_axis *add_axis(maker *m, const char *name, const char *key, const char *doc) {
    if (m->count == AXES) return NULL;
    accuracy_axis *a = &m->axes[m->count++];
    *a = (accuracy_axis){.same_particles = true, .unasked = true};
    snprintf(a->name, sizeof a->name, "%s", name);
    snprintf(a->key, sizeof a->key, "%s", key);
    snprintf(a->doc, sizeof a->doc, "%s", doc);
    return a;
}

static axis_level *add_level(const maker *m, accuracy_axis *a, double number) {
    axis_level *l = &a->level[a->count++];
    *l = (axis_level){.number = number, .precision = m->precision};
    if (isfinite(number)) snprintf(l->value, sizeof l->value, "%.6g", number);
    return l;
}

/* A round number of particles reads better, and is as good. */
static double round_count(double value) {
    double unit = pow(10, floor(log10(value)) - 2);
    return value < 100 ? ceil(value) : unit * floor(value / unit + 0.5);
}

/* Which of the steps k = 0 (the scene's own), ±1 (the next finer, coarser) … are levels: as many finer ones as half of those wanted, coarser ones
 * for the rest and for a budget, or finer ones where coarser ones are out of range. */
typedef bool (*step_allowed)(const void *rule, int step);

static int choose_steps(const maker *m, step_allowed allowed, const void *rule, int steps[AXIS_LEVELS], int *first, int *own, int *wanted) {
    int finer = 0, coarser = 0, least = m->levels / 2;
    while (coarser < AXIS_LEVELS / 2 && allowed(rule, -coarser - 1)) coarser++;
    int least_coarser = m->levels - 1 - least;
    if (coarser < least_coarser) least = m->levels - 1 - coarser;
    while (finer < least && allowed(rule, finer + 1)) finer++;
    *wanted = m->levels < coarser + finer + 1 ? m->levels : coarser + finer + 1;
    while (coarser + finer + 1 > AXIS_LEVELS) coarser--;
    for (int k = -coarser; k <= finer; k++) steps[k + coarser] = k;
    *own = coarser;
    *first = coarser + finer + 1 - *wanted;
    return coarser + finer + 1;
}

/* ---- the scene's own axes ---------------------------------------------------------------------------------------- */

static bool always(const void *rule, int step) {
    (void)rule, (void)step;
    return true;
}

static bool enough_particles(const void *rule, int step) {
    return *(const double *)rule * pow(2, step) >= 64;
}

/* Twice the particles a level. What the scene says of its spacing is what is changed: particles, dx, or both. */
static void add_resolution(maker *m) {
    const scene *s = m->scene;
    double count = (double)m->plan->particles, dimensions = m->plan->solid ? 3 : 2;
    bool by_dx = s->dx > 0 && (s->particles == 0 || m->plan->solid), by_count = s->particles > 0 || s->dx <= 0;
    double base = s->particles > 0 ? (double)s->particles : count;
    int steps[AXIS_LEVELS], first, own, wanted;
    accuracy_axis *a = add_axis(m, "resolution", by_count ? "particles" : "dx", "more particles, a finer grid; the step follows where it is automatic");
    if (!a) return;
    int n = choose_steps(m, enough_particles, &count, steps, &first, &own, &wanted);
    a->same_particles = false;
    a->ordered = true;
    a->first = first, a->scene = own, a->wanted = wanted;
    for (int i = 0; i < n; i++) {
        double particles = round_count(base * pow(2, steps[i])), dx = s->dx * pow(2, -steps[i] / dimensions);
        axis_level *l = add_level(m, a, by_count ? (steps[i] ? particles : base) : dx);
        if (steps[i] == 0) continue;
        if (by_count) add_number(l, "particles", particles);
        if (by_dx) add_number(l, "dx", dx);
    }
}

static bool share_allowed(const void *rule, int step) {
    double value = *(const double *)rule * pow(0.5, step);
    return value <= 1 && value >= 1e-3;
}

static void add_step(maker *m) {
    const scene *s = m->scene;
    bool fixed = s->dt > 0;
    double own_value = fixed ? s->dt : s->cfl;
    int steps[AXIS_LEVELS], first, own, wanted;
    accuracy_axis *a = add_axis(m, "step", fixed ? "dt" : "cfl", "a shorter time step");
    if (!a) return;
    int n = choose_steps(m, fixed ? always : share_allowed, &own_value, steps, &first, &own, &wanted);
    a->ordered = true;
    a->first = first, a->scene = own, a->wanted = wanted;
    for (int i = 0; i < n; i++) {
        axis_level *l = add_level(m, a, own_value * pow(0.5, steps[i]));
        if (steps[i]) add_number(l, a->key, l->number);
    }
}

static void add_precision(maker *m) {
    accuracy_axis *a = add_axis(m, "precision", "precision", "the reals that a run is made in");
    if (!a) return;
    a->wanted = 2;
    a->scene = m->precision == 64;
    for (int i = 0; i < 2; i++) {
        axis_level *l = add_level(m, a, NAN);
        l->precision = i ? 64 : 32;
        snprintf(l->value, sizeof l->value, "f%d", l->precision);
    }
}

/* As many more particles in cells of the same size: what sums over particles cost in place of integrals. */
static void add_quadrature(maker *m) {
    const scene *s = m->scene;
    double count = (double)m->plan->particles, own_value = s->dx > 0 && s->particles > 0 ? count : s->particles_per_cell;
    int steps[AXIS_LEVELS], first, own, wanted;
    accuracy_axis *a = add_axis(m, "quadrature", "particles_per_cell", "more particles in cells of the same size");
    if (!a) return;
    int n = choose_steps(m, enough_particles, &count, steps, &first, &own, &wanted);
    a->same_particles = a->unasked = false;
    a->first = first, a->scene = own, a->wanted = wanted;
    for (int i = 0; i < n; i++) {
        axis_level *l = add_level(m, a, own_value * pow(2, steps[i]));
        if (steps[i] == 0) continue;
        add_number(l, "dx", m->plan->dx);
        add_number(l, "particles", round_count(count * pow(2, steps[i])));
    }
}

/* Choices among the scene's own keys, coarsest first. */
typedef struct key_choice {
    const char *key, *doc, *needs; /* needs: what an effect of the scene must provide, or NULL */
    bool unasked;
    size_t offset;
    int count;
    const char *value[4]; /* by the number that the scene keeps */
    int order[4];         /* from coarse to fine */
} key_choice;

static const key_choice key_choices[] = {
    {"kernel", "B-spline of the momentum", NULL, true, offsetof(scene, kernel), 2, {"quadratic", "cubic"}, {KERNEL_QUADRATIC, KERNEL_CUBIC}},
    {"laplacian", "B-spline of the damage", "damage model", true, offsetof(scene, laplacian), 2, {"quadratic", "cubic"}, {KERNEL_QUADRATIC, KERNEL_CUBIC}},
    {"transfer", "what a particle's velocity carries: how much the grid damps", NULL, false, offsetof(scene, transfer), 3, {"apic", "rpic", "pic"},
     {TRANSFER_PIC, TRANSFER_RPIC, TRANSFER_APIC}},
};

static bool provided(const maker *m, const char *need) {
    for (int e = 0; need && e < m->plan->effect_count; e++)
        if ((m->plan->mask >> e & 1) && effect_supplies(m->plan->effects[e], need)) return true;
    return need == NULL;
}

static void add_key_choice(maker *m, const key_choice *c) {
    int own = *(const int *)((const char *)m->scene + c->offset), place = -1;
    for (int i = 0; i < c->count; i++)
        if (c->order[i] == own) place = i;
    if (place < 0 || !provided(m, c->needs)) return;
    accuracy_axis *a = add_axis(m, c->key, c->key, c->doc);
    if (!a) return;
    a->unasked = c->unasked;
    a->scene = place;
    a->wanted = c->count;
    for (int i = 0; i < c->count; i++) {
        axis_level *l = add_level(m, a, NAN);
        snprintf(l->value, sizeof l->value, "%s", c->value[c->order[i]]);
        if (i != place) add_setting(l, c->key, c->value[c->order[i]]);
    }
}

/* ---- the effects' axes ------------------------------------------------------------------------------------------- */

typedef struct value_rule {
    const parameter *p;
    double own;
} value_rule;

static double stepped(const parameter *p, double own, int step) {
    return p->accuracy.kind == ACCURACY_FACTOR ? own * pow(p->accuracy.finer, step) : own + step * p->accuracy.finer;
}

static bool in_range(const void *context, int step) {
    const value_rule *rule = context;
    double value = stepped(rule->p, rule->own, step);
    return value >= rule->p->minimum * (1 - 1e-12) && value <= rule->p->maximum * (1 + 1e-12);
}

/* The values that an effect has in the scene: the scene's, or each material's in turn. */
static const effect_values *values_at(const scene *s, const effect *e, int index, int owner, const char **name) {
    if (e->scope == SCOPE_SCENE) {
        *name = "";
        return owner == 0 ? &s->effects[index] : NULL;
    }
    *name = owner < s->material_count ? s->materials[owner].name : "";
    return owner < s->material_count ? &s->materials[owner].effects[index] : NULL;
}

static bool applies(const effect *e, const effect_values *v, const parameter *p) {
    if (!v->on) return false;
    const char *when = p->accuracy.when;
    return !when || v->value[effect_parameter(e, when)][0] == p->accuracy.is;
}

/* Every material that the parameter is of, each by its own value. */
static void set_everywhere(const maker *m, int index, int key, int step, axis_level *l) {
    const effect *e = m->plan->effects[index];
    const parameter *p = &e->parameters[key];
    const char *owner;
    const effect_values *v;
    for (int o = 0; (v = values_at(m->scene, e, index, o, &owner)) != NULL; o++) {
        char path[AXIS_KEY];
        if (!applies(e, v, p)) continue;
        snprintf(path, sizeof path, "%s%s%s.%s", owner, owner[0] ? "." : "", e->name, p->key);
        double to = p->accuracy.kind == ACCURACY_CHOICE ? l->number : stepped(p, v->value[key][0], step);
        if (p->accuracy.kind == ACCURACY_CHOICE) add_setting(l, path, p->choices[(int)l->number]);
        else add_number(l, path, fmin(fmax(to, p->minimum), p->maximum));
    }
}

static void add_effect_choice(maker *m, int index, int key, double own, accuracy_axis *a) {
    const parameter *p = &m->plan->effects[index]->parameters[key];
    int choices = 0;
    while (p->choices[choices] && choices < AXIS_LEVELS) choices++;
    a->wanted = choices;
    for (int i = 0; i < choices; i++) {
        int which = p->accuracy.finer > 0 ? i : choices - 1 - i;
        axis_level *l = add_level(m, a, which);
        snprintf(l->value, sizeof l->value, "%s", p->choices[which]);
        if (which == (int)own) a->scene = i;
        else set_everywhere(m, index, key, 0, l);
        l->number = NAN;
    }
}

static void add_effect_axis(maker *m, int index, int key) {
    const effect *e = m->plan->effects[index];
    const parameter *p = &e->parameters[key];
    const char *owner;
    const effect_values *v;
    int steps[AXIS_LEVELS], first, own, wanted, o = 0;
    char name[AXIS_NAME];
    while ((v = values_at(m->scene, e, index, o, &owner)) != NULL && !applies(e, v, p)) o++;
    if (!v || (p->accuracy.kind == ACCURACY_FACTOR && v->value[key][0] == 0)) return;
    snprintf(name, sizeof name, "%s.%s", e->name, p->key);
    accuracy_axis *a = add_axis(m, name, p->key, p->doc);
    if (!a) return;
    if (p->accuracy.kind == ACCURACY_CHOICE) {
        add_effect_choice(m, index, key, v->value[key][0], a);
        return;
    }
    value_rule rule = {p, v->value[key][0]};
    int n = choose_steps(m, in_range, &rule, steps, &first, &own, &wanted);
    a->ordered = p->accuracy.kind == ACCURACY_FACTOR;
    a->first = first, a->scene = own, a->wanted = wanted;
    for (int i = 0; i < n; i++) {
        axis_level *l = add_level(m, a, stepped(p, rule.own, steps[i]));
        if (steps[i]) set_everywhere(m, index, key, steps[i], l);
    }
}

int accuracy_axes(const scene *s, const simulation_plan *plan, int precision, int levels, accuracy_axis axes[AXES]) {
    maker m = {.scene = s, .plan = plan, .precision = precision, .levels = levels, .axes = axes};
    bool grid = plan->solid && plan->tetrahedra == 0;
    add_resolution(&m);
    add_step(&m);
    add_precision(&m);
    if (grid && !plan->sheet) add_quadrature(&m);
    for (size_t i = 0; grid && i < sizeof key_choices / sizeof *key_choices; i++) add_key_choice(&m, &key_choices[i]);
    for (int e = 0; e < plan->effect_count; e++)
        for (int k = 0; (plan->mask >> e & 1) && k < plan->effects[e]->parameter_count; k++)
            if (plan->effects[e]->parameters[k].accuracy.kind != ACCURACY_NONE) add_effect_axis(&m, e, k);
    return m.count;
}

int accuracy_axis_find(const accuracy_axis *axes, int count, const char *word, report *r) {
    const char *names[2 * AXES];
    int found = -1, ends = 0;
    for (int i = 0; i < count; i++) {
        const char *dot = strrchr(axes[i].name, '.');
        names[2 * i] = axes[i].name;
        names[2 * i + 1] = axes[i].key;
        if (strcmp(axes[i].name, word) == 0) return i;
        if (strcmp(axes[i].key, word) != 0 && !(dot && strcmp(dot + 1, word) == 0)) continue;
        found = i;
        ends++;
    }
    if (ends == 1) return found;
    char expected[256];
    size_t used = (size_t)snprintf(expected, sizeof expected, "an axis of this scene:");
    for (int i = 0; i < count && used < sizeof expected; i++) used += (size_t)snprintf(expected + used, sizeof expected - used, " %s", axes[i].name);
    report_input(r, NULL, 0, "--axis", expected, word, name_nearest(word, names, 2 * count));
    return -1;
}
