#include "sim/scene.h"

#include "base/memory.h"
#include "sheet/sheet.h"
#include "solid/moduli.h"
#include "solid/solid.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

const effect *const *effect_catalogue(int *count) {
    static const effect *all[EFFECT_LIMIT];
    const solid_engine *solids = solid_engine_find(64, "plain");
    const sheet_engine *sheets = sheet_engine_find(64, "plain");
    *count = solids->effect_count + sheets->effect_count;
    assert(*count <= EFFECT_LIMIT);
    if (!all[0]) { /* the last written first: a reader on another thread sees a whole table */
        for (int e = sheets->effect_count - 1; e >= 0; e--) all[solids->effect_count + e] = sheets->effects[e];
        for (int e = solids->effect_count - 1; e >= 0; e--) all[e] = solids->effects[e];
    }
    return all;
}

int sheet_effects_first(void) {
    return solid_engine_find(64, "plain")->effect_count;
}

int effect_index(const char *name) {
    int count;
    const effect *const *effects = effect_catalogue(&count);
    for (int i = 0; i < count; i++)
        if (strcmp(effects[i]->name, name) == 0) return i;
    return -1;
}

int effect_index_of(engine_kind engine, const char *name) {
    int count;
    const effect *const *effects = effect_catalogue(&count);
    for (int i = 0; i < count; i++)
        if (effects[i]->engine == engine && strcmp(effects[i]->name, name) == 0) return i;
    return -1;
}

status scene_function_evaluate(const scene_function *f, const double *input, int inputs, double *output, report *r) {
    if (!f->call) {
        for (int i = 0; i < f->outputs; i++) output[i] = f->constant[i];
        return STATUS_OK;
    }
    status code = f->call(f->context, input, inputs, output, f->outputs, r);
    for (int i = 0; code == STATUS_OK && i < f->outputs; i++)
        if (!isfinite(output[i])) code = report_set(r, STATUS_INPUT, "a function of time or place gave %g", output[i]);
    return code;
}

scene *scene_create(void) {
    arena *memory = arena_create("scene");
    scene *s = memory ? arena_allocate(memory, sizeof *s) : NULL;
    if (!s) {
        arena_destroy(memory);
        return NULL;
    }
    *s = (scene){.memory = memory, .duration = 1, .fps = 24, .particles_per_cell = 8, .cfl = 0.5};
    for (int c = 0; c < 3; c++) s->domain_minimum[c] = -HUGE_VAL, s->domain_maximum[c] = HUGE_VAL;
    int count;
    const effect *const *effects = effect_catalogue(&count);
    for (int e = 0; e < count; e++) effect_values_default(effects[e], &s->effects[e]);
    return s;
}

void scene_destroy(scene *s) {
    if (s) arena_destroy(s->memory);
}

scene *scene_copy(const scene *s) {
    scene *copy = memory_allocate(sizeof *copy);
    if (copy) *copy = *s;
    return copy;
}

void scene_copy_free(scene *copy) {
    memory_free(copy, copy ? sizeof *copy : 0);
}

const scene_source *scene_source_at(const scene *s, int number) {
    for (int b = 0; b < s->body_count; number -= s->bodies[b++].source_count)
        if (number < s->bodies[b].source_count) return &s->bodies[b].sources[number];
    for (int b = 0; b < s->sheet_count; number -= s->sheets[b++].source_count)
        if (number < s->sheets[b].source_count) return &s->sheets[b].sources[number];
    return NULL;
}

int64_t scene_frames(const scene *s) {
    return (int64_t)llround(s->duration * s->fps);
}

bool scene_protects(const scene *s, const double x[3]) {
    for (int g = 0; g < s->grip_count; g++)
        if (s->grips[g].protects && shape_distance(s->grips[g].shape, x) < 0) return true;
    return false;
}

/* The first effect from index `from` on that a material names and that answers a need; -1. */
static int find_supplier(const scene_material *m, const char *need, int from) {
    int count;
    const effect *const *effects = effect_catalogue(&count);
    for (int e = from; e < count; e++)
        if (m->effects[e].on && effect_supplies(effects[e], need)) return e;
    return -1;
}

/* "elastic = { … } or corotated = { … }": what a scene may write to meet a need. */
static void describe_suppliers(const char *need, char *text, size_t size) {
    int count;
    const effect *const *effects = effect_catalogue(&count);
    size_t used = 0;
    text[0] = '\0';
    for (int e = 0; e < count && used < size; e++)
        if (effect_supplies(effects[e], need))
            used += (size_t)snprintf(text + used, size - used, "%s%s = { … }", used ? " or " : "", effects[e]->name);
}

/* Of effects that provide the same a material names one. */
static status check_alternatives(const scene_material *m, const effect *const *effects, int count, report *r) {
    for (int e = 0; e < count; e++) {
        if (!m->effects[e].on || !effects[e]->provides) continue;
        int other = find_supplier(m, effects[e]->provides, e + 1);
        if (other < 0) continue;
        char expected[128], found[128];
        snprintf(expected, sizeof expected, "one of '%s' and '%s' (each provides %s)", effects[e]->name, effects[other]->name, effects[e]->provides);
        snprintf(found, sizeof found, "both in the material '%.60s'", m->name);
        return report_input(r, m->file, m->line, effects[other]->name, expected, found, NULL);
    }
    return STATUS_OK;
}

/* The effects that a material names must find those they need. */
static status check_needs(const scene_material *m, const effect *const *effects, int count, report *r) {
    for (int e = 0; e < count; e++) {
        if (!m->effects[e].on || !effects[e]->needs || find_supplier(m, effects[e]->needs, 0) >= 0) continue;
        char suppliers[96], expected[192], found[128];
        describe_suppliers(effects[e]->needs, suppliers, sizeof suppliers);
        snprintf(expected, sizeof expected, "%s beside '%s': %s", effects[e]->needs, effects[e]->name, suppliers);
        snprintf(found, sizeof found, "a material '%.60s' without it", m->name);
        return report_input(r, m->file, m->line, effects[e]->name, expected, found, NULL);
    }
    return STATUS_OK;
}

/* A material serves the bodies that use it: it has their engine's elasticity, and no effect of the other engine. */
static status check_engine(const scene_material *m, engine_kind engine, const char *need, report *r) {
    int count;
    const effect *const *effects = effect_catalogue(&count);
    for (int e = 0; e < count; e++) {
        if (!m->effects[e].on || effects[e]->engine == engine) continue;
        char expected[128], found[128];
        snprintf(expected, sizeof expected, "an effect of %s", engine == ENGINE_SHEET ? "sheets" : "solids");
        snprintf(found, sizeof found, "'%s', which belongs to %s", effects[e]->name, engine == ENGINE_SHEET ? "solids" : "sheets");
        return report_input(r, m->file, m->line, effects[e]->name, expected, found, NULL);
    }
    int supplier = find_supplier(m, need, 0);
    if (supplier >= 0) return STATUS_OK;
    char suppliers[160], expected[224];
    describe_suppliers(need, suppliers, sizeof suppliers);
    snprintf(expected, sizeof expected, "a material with elasticity: %s", suppliers);
    return report_input(r, m->file, m->line, engine == ENGINE_SHEET ? "linear" : "elastic", expected, "none", NULL);
}

static status check_material(const scene *s, int index, scene_material *m, report *r) {
    int count;
    const effect *const *effects = effect_catalogue(&count);
    if (!(m->density > 0) || !isfinite(m->density)) {
        char found[48];
        snprintf(found, sizeof found, "%g", m->density);
        return report_input(r, m->file, m->line, "density", "a positive number", found, NULL);
    }
    status code = check_alternatives(m, effects, count, r);
    if (code == STATUS_OK) code = check_needs(m, effects, count, r);
    for (int e = 0; e < count && code == STATUS_OK; e++)
        if (m->effects[e].on && effects[e]->scope == SCOPE_MATERIAL)
            code = effect_values_check(effects[e], &m->effects[e], m->effects, m->file, m->line, r);
    for (int b = 0; b < s->body_count && code == STATUS_OK; b++)
        if (s->bodies[b].material == index) code = check_engine(m, ENGINE_SOLID, ELASTICITY, r);
    for (int b = 0; b < s->sheet_count && code == STATUS_OK; b++)
        if (s->sheets[b].material == index) code = check_engine(m, ENGINE_SHEET, SHEET_ELASTICITY, r);
    return code;
}

/* Damage that follows fibres, and fibres themselves, need directions. */
static status check_fibres(const scene *s, const scene_body *b, report *r) {
    const scene_material *m = &s->materials[b->material];
    const effect_values *damage = &m->effects[effect_index("damage")], *fibres = &m->effects[effect_index("fibres")];
    int count;
    const effect *const *effects = effect_catalogue(&count);
    const effect *damage_effect = effects[effect_index("damage")], *fibre_effect = effects[effect_index("fibres")];
    int wanted = 0;
    if (damage->on && damage->value[effect_parameter(damage_effect, "alpha")][0] != 0) wanted = 1;
    if (fibres->on || m->effects[effect_index("inextensible")].on) wanted = 1;
    const effect_values *swelling = &m->effects[effect_index_of(ENGINE_SOLID, "swelling")];
    if (swelling->on && swelling->given[effect_parameter(effects[effect_index_of(ENGINE_SOLID, "swelling")], "along")]) wanted = 1;
    if (damage->on && damage->value[effect_parameter(damage_effect, "alpha2")][0] != 0) wanted = 2;
    if (fibres->on && fibres->value[effect_parameter(fibre_effect, "gamma2")][0] != 0) wanted = 2;
    if (b->fibres.families >= wanted) return STATUS_OK;
    char found[160];
    snprintf(found, sizeof found, "%d in body '%.48s', whose material '%.48s' needs %d", b->fibres.families, b->name, m->name, wanted);
    return report_input(r, s->file, 0, "fibres", "fibre directions", found, NULL);
}

bool scene_is_tetrahedra(const scene *s) {
    return s->body_count > 0 && s->bodies[0].discretisation == DISCRETISATION_TETRAHEDRA;
}

/* Bodies of tetrahedra live without a grid: they meet no others, and have no effect that needs one. */
static status check_discretisation(const scene *s, const scene_body *b, report *r) {
    const scene_material *m = &s->materials[b->material];
    bool tetrahedra = b->discretisation == DISCRETISATION_TETRAHEDRA;
    int count;
    const effect *const *effects = effect_catalogue(&count);
    if (tetrahedra != scene_is_tetrahedra(s))
        return report_input(r, s->file, 0, "discretisation", "the same for all bodies of a scene (tetrahedra live without a grid)", "particles and tetrahedra", NULL);
    if (!tetrahedra && b->start.outputs)
        return report_input(r, s->file, 0, "start", "discretisation = \"tetrahedra\" beside it (particles start at rest)", "particles", NULL);
    if (tetrahedra && m->variation_count > 0)
        return report_input(r, m->file, m->line, "function", "constants (functions of place are for bodies of particles)", "a function of place beside discretisation = \"tetrahedra\"", NULL);
    for (int e = 0; e < count && tetrahedra; e++) {
        if (!m->effects[e].on || effects[e]->engine != ENGINE_SOLID || solid_tetra_find(64, "plain")->knows(effects[e])) continue;
        char found[128];
        snprintf(found, sizeof found, "'%s' in the body '%.60s'", effects[e]->name, b->name);
        return report_input(r, m->file, m->line, effects[e]->name, "an effect that tetrahedra know: elastic, corotated, fibres", found, NULL);
    }
    return STATUS_OK;
}

/* What starts broken must be able to break. */
static status check_notches(const scene *s, const scene_body *b, report *r) {
    const scene_material *m = &s->materials[b->material];
    if (!b->notches || find_supplier(m, "damage model", 0) >= 0) return STATUS_OK;
    char suppliers[96], expected[160], found[160];
    describe_suppliers("damage model", suppliers, sizeof suppliers);
    snprintf(expected, sizeof expected, "a material that can break: %s", suppliers);
    snprintf(found, sizeof found, "notches in body '%.48s', whose material '%.48s' cannot", b->name, m->name);
    return report_input(r, s->file, 0, "notches", expected, found, NULL);
}

/* What is fed must be able to spread. */
static status check_sources(const scene *s, engine_kind engine, int count, const char *name, const scene_material *m, report *r) {
    if (count == 0 || m->effects[effect_index_of(engine, "diffusion")].on) return STATUS_OK;
    char found[160];
    snprintf(found, sizeof found, "sources in %s '%.48s', whose material '%.48s' has none", engine == ENGINE_SHEET ? "sheet" : "body", name, m->name);
    return report_input(r, s->file, 0, "sources", "a material with diffusion = { … }", found, NULL);
}

static status check_body(const scene *s, const scene_body *b, report *r) {
    double low[3], high[3];
    if (!b->shape) return report_input(r, s->file, 0, "shape", "a shape", "nothing", NULL);
    shape_bounds(b->shape, low, high);
    for (int c = 0; c < 3; c++)
        if (!isfinite(low[c]) || !isfinite(high[c]))
            return report_input(r, s->file, 0, "shape", "a bounded shape for a body", "one without bounds", NULL);
    if (b->material < 0 || b->material >= s->material_count)
        return report_input(r, s->file, 0, "material", "a material", "nothing", NULL);
    status code = check_discretisation(s, b, r);
    if (code == STATUS_OK) code = check_fibres(s, b, r);
    if (code == STATUS_OK) code = check_notches(s, b, r);
    return code == STATUS_OK ? check_sources(s, ENGINE_SOLID, b->source_count, b->name, &s->materials[b->material], r) : code;
}

static status check_sheet(const scene *s, const scene_sheet *b, report *r) {
    if (!b->region.shape) return report_input(r, s->file, 0, "shape", "a shape", "nothing", NULL);
    if (b->material < 0 || b->material >= s->material_count) return report_input(r, s->file, 0, "material", "a material", "nothing", NULL);
    const scene_material *m = &s->materials[b->material];
    if (m->effects[effect_index("grain")].on && b->grain.families < 1) {
        char found[160];
        snprintf(found, sizeof found, "none in sheet '%.48s', whose material '%.48s' has a grain", b->name, m->name);
        return report_input(r, s->file, 0, "grain", "a direction", found, NULL);
    }
    return check_sources(s, ENGINE_SHEET, b->source_count, b->name, m, r);
}

static status check_numbers(const scene *s, report *r) {
    const struct {
        const char *key;
        double value, minimum, maximum;
    } rows[] = {
        {"duration", s->duration, 0, 1e9}, {"fps", s->fps, 1e-9, 1e9},
        {"particles_per_cell", s->particles_per_cell, 0.125, 1000}, {"cfl", s->cfl, 1e-3, 1},
        {"dx", s->dx, 0, 1e9}, {"dt", s->dt, 0, 1e9},
        {"particles", (double)s->particles, 0, 5e8}, {"transfer_ratio", s->transfer_ratio, 0, 1},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        if (rows[i].value >= rows[i].minimum && rows[i].value <= rows[i].maximum) continue;
        char expected[96], found[48];
        snprintf(expected, sizeof expected, "a value from %g to %g", rows[i].minimum, rows[i].maximum);
        snprintf(found, sizeof found, "%g", rows[i].value);
        return report_input(r, s->file, 0, rows[i].key, expected, found, NULL);
    }
    return STATUS_OK;
}

status scene_check_step(const scene *s, report *r) {
    double steps = 1 / s->fps / s->dt;
    if (s->dt == 0 || steps <= SCENE_FRAME_STEPS) return STATUS_OK;
    char expected[96], found[96];
    snprintf(expected, sizeof expected, "at least %.3g, which makes %d steps a frame", 1 / s->fps / SCENE_FRAME_STEPS, SCENE_FRAME_STEPS);
    snprintf(found, sizeof found, "%g, which makes %.3g", s->dt, steps);
    return report_input(r, s->file, 0, "dt", expected, found, NULL);
}

status scene_check_material(scene *s, int material, report *r) {
    status code = check_material(s, material, &s->materials[material], r);
    for (int i = 0; i < s->body_count && code == STATUS_OK; i++)
        if (s->bodies[i].material == material) code = check_fibres(s, &s->bodies[i], r);
    return code;
}

status scene_validate(scene *s, report *r) {
    if (s->body_count + s->sheet_count == 0) return report_input(r, s->file, 0, "solids", "at least one body", "none", NULL);
    status code = check_numbers(s, r);
    if (code == STATUS_OK) code = scene_check_step(s, r);
    for (int i = 0; i < s->material_count && code == STATUS_OK; i++) code = check_material(s, i, &s->materials[i], r);
    for (int i = 0; i < s->body_count && code == STATUS_OK; i++) code = check_body(s, &s->bodies[i], r);
    for (int i = 0; i < s->sheet_count && code == STATUS_OK; i++) code = check_sheet(s, &s->sheets[i], r);
    if (code == STATUS_OK && s->body_count == 0 && s->effects[effect_index("mass_damping")].on)
        code = report_input(r, s->file, 0, "mass_damping", "damping = … in the sheet's material", "mass_damping, which is for solids", NULL);
    if (code == STATUS_OK && s->effects[effect_index("contact")].on && (s->body_count == 0 || s->sheet_count == 0 || scene_is_tetrahedra(s)))
        code = report_input(r, s->file, 0, "contact", "sheets, and solids of particles: it is theirs with one another",
                            scene_is_tetrahedra(s) ? "solids of tetrahedra" : "one kind alone", NULL);
    if (code != STATUS_OK) return code;
    s->effects[effect_index("boundary")].on = s->grip_count + s->collider_count > 0;
    return STATUS_OK;
}
