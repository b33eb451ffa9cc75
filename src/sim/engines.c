/* One face for both engines: a simulation has one, or the other, or both side by side. They share the step, gravity, grips and colliders; solids and
 * sheets pass through one another unless the scene says `contact`. */
#include "base/clock.h"
#include "base/memory.h"
#include "sim/contact.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

rigid_boundary *engine_boundaries(const simulation *s) {
    return s->solid ? s->engine->boundaries(s->solid) : s->sheets->boundaries(s->sheet);
}

/* Where a scene has both, the second engine's boundaries move as those do. */
static void share_boundaries(const simulation *s) {
    if (!s->solid || !s->sheet) return;
    const rigid_boundary *from = s->engine->boundaries(s->solid);
    rigid_boundary *to = s->sheets->boundaries(s->sheet);
    for (int i = 0; i < s->scene->grip_count + s->scene->collider_count; i++) to[i].motion = from[i].motion;
}

/* What a particle may go in a step: less than a cell, or half a sheet's spacing. */
static double finest_way(const simulation *s) {
    double way = s->solid ? s->plan.dx : HUGE_VAL;
    if (s->solid && s->plan.tetrahedra) way = s->particles.spacing;
    return s->sheet ? fmin(way, 0.45 * s->sheet_points.spacing) : way;
}

/* Waves and speeds say nothing of what gravity is about to set in motion: from rest the way is |g| Δt², here a quarter of what is allowed. */
static void limit_gravity(const simulation *s, double limit[EFFECT_LIMIT]) {
    int gravity = effect_index("gravity");
    const double *g = s->scene->effects[gravity].value[0];
    double pull = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]), way = s->scene->cfl * finest_way(s);
    if (s->scene->effects[gravity].on && pull > 0) limit[gravity] = 0.5 * sqrt(way / pull);
}

double engine_boundary_limit(const simulation *s, double speed) {
    return speed > 0 ? s->scene->cfl * finest_way(s) / speed : HUGE_VAL;
}

/* What stands in a wind is blown along before its own speed says so. */
static void limit_wind(const simulation *s, double limit[EFFECT_LIMIT]) {
    int drag = effect_index("drag"), key = effect_parameter(s->plan.effects[drag], "wind");
    for (int b = 0; b < s->scene->sheet_count; b++) {
        const effect_values *values = &s->scene->materials[s->scene->sheets[b].material].effects[drag];
        const double *wind = values->value[key];
        double speed = sqrt(wind[0] * wind[0] + wind[1] * wind[1] + wind[2] * wind[2]);
        if (values->on) limit[drag] = fmin(limit[drag], engine_boundary_limit(s, speed));
    }
}

void engine_limits(const simulation *s, double limit[EFFECT_LIMIT]) {
    for (int e = 0; e < EFFECT_LIMIT; e++) limit[e] = HUGE_VAL;
    if (s->solid) s->engine->limits(s->solid, limit);
    if (s->sheet) s->sheets->limits(s->sheet, limit + sheet_effects_first());
    /* The momentum limit shrinks by the scene's cfl; others are limits as they stand. */
    for (int e = 0; e < s->plan.effect_count; e++) {
        const effect *table = s->plan.effects[e];
        if (strcmp(table->name, "elastic") == 0 || effect_supplies(table, SHEET_ELASTICITY)) limit[e] *= s->scene->cfl;
    }
    limit_gravity(s, limit);
    limit_wind(s, limit);
}

status engine_step(simulation *s, double dt, report *r) {
    solid_fault fault;
    sheet_fault sheet_trouble;
    share_boundaries(s);
    status code = s->solid ? s->engine->step(s->solid, dt, &fault, r) : STATUS_OK;
    if (code == STATUS_OK && s->sheet) code = s->sheets->step(s->sheet, s->time, dt, &sheet_trouble, r);
    if (code != STATUS_OK || !s->contact) return code;
    double start = clock_seconds();
    code = contact_apply(s, dt, r);
    s->contact_seconds += clock_seconds() - start;
    return code;
}

status engine_begin_frame(simulation *s, report *r) {
    return s->solid ? s->engine->sort(s->solid, r) : STATUS_OK;
}

status engine_end_frame(simulation *s, report *r) {
    status code = s->solid && s->engine->settle ? s->engine->settle(s->solid, s->time, r) : STATUS_OK;
    if (code == STATUS_OK && s->sheet) s->sheets->settle(s->sheet, s->time);
    return code;
}

double engine_bytes(const simulation *s) {
    double bytes = s->solid ? s->engine->bytes_per_particle(s->solid) * (double)s->particles.count : 0;
    if (s->sheet) bytes += s->sheets->bytes_per_particle(s->sheet) * (double)s->sheet_points.count;
    return bytes / (double)s->count;
}

status engine_save(const simulation *s, record_list *list, report *r) {
    status code = s->solid ? s->engine->save(s->solid, list, r) : STATUS_OK;
    return code == STATUS_OK && s->sheet ? s->sheets->save(s->sheet, list, r) : code;
}

status engine_restore(simulation *s, const record_list *list, report *r) {
    status code = s->solid ? s->engine->restore(s->solid, list, r) : STATUS_OK;
    return code == STATUS_OK && s->sheet ? s->sheets->restore(s->sheet, list, r) : code;
}

int64_t engine_count(const simulation *s, engine_kind kind) {
    return kind == ENGINE_SHEET ? (s->sheet ? s->sheet_points.count : 0) : s->solid ? s->particles.count : 0;
}

int engine_read(const simulation *s, engine_kind kind, const char *field, double *out) {
    if (engine_count(s, kind) == 0) return 0;
    if (kind == ENGINE_SHEET) return out ? s->sheets->read(s->sheet, field, out) : s->sheets->components(s->sheet, field);
    return out ? s->engine->read(s->solid, field, out) : s->engine->components(s->solid, field);
}

/* Where both are, a field that one has not is 0 there; broken bonds stand for damage, as they do in the measures. */
static const char *counterpart(const char *field) {
    return strcmp(field, "damage") == 0 ? "broken" : field;
}

int simulation_read(const simulation *s, const char *field, double *out) {
    if (!s->solid || !s->sheet) return engine_read(s, s->sheet ? ENGINE_SHEET : ENGINE_SOLID, field, out);
    int own = engine_read(s, ENGINE_SOLID, field, NULL), components = own ? own : engine_read(s, ENGINE_SHEET, field, NULL);
    if (!out || components == 0) return components;
    size_t solids = (size_t)(s->particles.count * components), sheets = (size_t)(s->sheet_points.count * components);
    memset(out, 0, (solids + sheets) * sizeof *out);
    if (own) engine_read(s, ENGINE_SOLID, field, out);
    const char *name = engine_read(s, ENGINE_SHEET, field, NULL) ? field : counterpart(field);
    if (engine_read(s, ENGINE_SHEET, name, NULL) == components) engine_read(s, ENGINE_SHEET, name, out + solids);
    return components;
}

const char *simulation_picture_field(const simulation *s) {
    if (engine_read(s, ENGINE_SOLID, "damage", NULL) || !s->sheet) return "damage";
    return simulation_read(s, "diffused", NULL) ? "diffused" : "broken";
}

/* What a sheet has in common with a solid, so that ledgers and screens need not tell them apart. */
static void share_measures(const sheet_measures *from, solid_measures *to) {
    *to = (solid_measures){.mass = from->mass, .kinetic = from->kinetic, .elastic = from->elastic, .gravitational = from->gravitational,
                           .grip_work = from->grip_work, .damage_mean = from->broken_mean, .damage_max = from->broken_max,
                           .determinant_min = 1, .determinant_max = 1, .speed_max = from->speed_max};
    memcpy(to->momentum, from->momentum, sizeof to->momentum);
    memcpy(to->angular_momentum, from->angular_momentum, sizeof to->angular_momentum);
    memcpy(to->grip_impulse, from->grip_impulse, sizeof to->grip_impulse);
    if (from->bonds_total > 0) to->broken_fraction = (double)from->bonds_broken / (double)from->bonds_total;
    _Static_assert(sizeof to->histogram == sizeof from->histogram, "one number of bins");
    memcpy(to->histogram, from->histogram, sizeof to->histogram);
}

/* Sums, and the extremes of both; shares weigh by particles. What only solids have stays theirs. */
static void add_measures(const solid_measures *from, double weight, solid_measures *to) {
    to->mass += from->mass;
    to->kinetic += from->kinetic;
    to->elastic += from->elastic;
    to->gravitational += from->gravitational;
    to->grip_work += from->grip_work;
    for (int c = 0; c < 3; c++) {
        to->momentum[c] += from->momentum[c];
        to->angular_momentum[c] += from->angular_momentum[c];
        to->grip_impulse[c] += from->grip_impulse[c];
    }
    to->damage_mean += weight * (from->damage_mean - to->damage_mean);
    to->broken_fraction += weight * (from->broken_fraction - to->broken_fraction);
    to->damage_max = fmax(to->damage_max, from->damage_max);
    to->speed_max = fmax(to->speed_max, from->speed_max);
}

status engine_measure(const simulation *s, simulation_measures *m, report *r) {
    status code = s->solid ? s->engine->measure(s->solid, &m->solid, r) : STATUS_OK;
    if (code != STATUS_OK || !s->sheet) return code;
    solid_measures common;
    m->has_sheet = true;
    code = s->sheets->measure(s->sheet, &m->sheet, r);
    if (code != STATUS_OK) return code;
    share_measures(&m->sheet, &common);
    if (s->solid) add_measures(&common, (double)s->sheet_points.count / (double)s->count, &m->solid);
    else m->solid = common;
    return STATUS_OK;
}

_Static_assert((int)SOLID_SOURCES == (int)SHEET_SOURCES, "one array of feeds serves both");

/* ---- making ------------------------------------------------------------------------------------------------------ */

static void motion_default(rigid_motion *m, const double pivot[3]) {
    *m = (rigid_motion){.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    memcpy(m->pivot, pivot, sizeof m->pivot);
}

int engine_define_boundaries(const scene *s, rigid_boundary *out) {
    int count = 0;
    for (int g = 0; g < s->grip_count; g++, count++) {
        out[count] = (rigid_boundary){.shape = s->grips[g].shape, .grip = true};
        motion_default(&out[count].motion, s->grips[g].pivot);
    }
    for (int c = 0; c < s->collider_count; c++, count++) {
        out[count] = (rigid_boundary){.shape = s->colliders[c].shape, .contact = s->colliders[c].contact, .friction = s->colliders[c].friction};
        motion_default(&out[count].motion, s->colliders[c].pivot);
    }
    return count;
}

/* Effects that any sheet's material names, by index in the sheet engine's list. */
static uint32_t sheet_mask(const scene *s) {
    uint32_t mask = 0;
    int first = sheet_effects_first(), count;
    (void)effect_catalogue(&count);
    for (int k = 0; k < s->sheet_count; k++)
        for (int e = first; e < count; e++)
            if (s->materials[s->sheets[k].material].effects[e].on) mask |= 1u << (e - first);
    return mask;
}

static source_feed feed_of(const scene_source *from) {
    return (source_feed){from->strength, from->on == 0};
}

int engine_feeds(const scene *s, engine_kind kind, source_feed out[SOLID_SOURCES]) {
    int count = 0, bodies = kind == ENGINE_SHEET ? s->sheet_count : s->body_count;
    for (int b = 0; b < bodies; b++) {
        int sources = kind == ENGINE_SHEET ? s->sheets[b].source_count : s->bodies[b].source_count;
        for (int k = 0; k < sources && count < SOLID_SOURCES; k++)
            out[count++] = feed_of(kind == ENGINE_SHEET ? &s->sheets[b].sources[k] : &s->bodies[b].sources[k]);
    }
    return count;
}

status engine_refresh(simulation *s, report *r) {
    static const double still[3] = {0};
    const effect_values *gravity = &s->scene->effects[effect_index("gravity")], *damping = &s->scene->effects[effect_index("mass_damping")];
    const double *g = gravity->on ? gravity->value[0] : still;
    source_feed feeds[SOLID_SOURCES];
    if (s->solid) {
        s->engine->surround(s->solid, g, damping->on ? damping->value[0][0] : 0);
        (void)engine_feeds(s->scene, ENGINE_SOLID, feeds);
        if (s->engine->feed) s->engine->feed(s->solid, feeds);
        s->engine->refresh(s->solid);
    }
    if (!s->sheet) return STATUS_OK;
    (void)engine_feeds(s->scene, ENGINE_SHEET, feeds);
    s->sheets->feed(s->sheet, feeds);
    s->sheets->surround(s->sheet, g, s->scene->cfl);
    return s->sheets->refresh(s->sheet, r);
}

status engine_create_sheet(simulation *s, int threads, report *r) {
    const scene *from = s->scene;
    const sheet_particles *p = &s->sheet_points;
    sheet_definition *d = memory_allocate(sizeof *d);
    source_feed feeds[SOLID_SOURCES];
    if (!d) return report_set(r, STATUS_SYSTEM, "out of memory for the plan");
    (void)engine_feeds(from, ENGINE_SHEET, feeds);
    *d = (sheet_definition){.threads = threads, .effect_mask = sheet_mask(from), .material_count = from->material_count, .body_count = p->body_count,
                            .notch_count = p->notch_count, .source_count = p->source_count, .count = p->count, .rest = p->rest,
                            .position = p->position, .velocity = p->velocity, .area = p->area, .grain = p->grain, .protected = p->protected, .feeds = feeds, .cfl = from->cfl};
    for (int m = 0; m < from->material_count; m++)
        d->materials[m] = (sheet_material){.density = from->materials[m].density, .effects = from->materials[m].effects + sheet_effects_first()};
    memcpy(d->bodies, p->bodies, sizeof p->bodies);
    memcpy(d->notches, p->notches, sizeof p->notches);
    memcpy(d->sources, p->sources, sizeof p->sources);
    const effect_values *gravity = &from->effects[effect_index("gravity")];
    if (gravity->on) memcpy(d->gravity, gravity->value[0], sizeof d->gravity);
    d->boundary_count = engine_define_boundaries(from, d->boundaries);
    report_clear(r);
    s->sheet = s->sheets->create(d, r);
    status code = s->sheet ? STATUS_OK : r->code;
    if (code == STATUS_INPUT && !r->file[0]) snprintf(r->file, sizeof r->file, "%s", from->file);
    if (code == STATUS_OK) s->plan.mask |= d->effect_mask << sheet_effects_first();
    memory_free(d, sizeof *d);
    return code;
}
