/* Scene → plan → stepping. */
#include "base/memory.h"
#include "base/threads.h"
#include "sim/contact.h"
#include "sim/crack.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Materials twice: as they are, and again for the particles that a grip protects from damage. */
static void define_materials(simulation *s, solid_definition *d) {
    const scene *from_scene = s->scene;
    d->material_count = 2 * from_scene->material_count;
    for (int m = 0; m < d->material_count; m++) {
        const scene_material *from = &from_scene->materials[m % from_scene->material_count];
        d->materials[m] = (solid_material){.density = from->density, .effects = from->effects, .protects = m >= from_scene->material_count};
        for (int e = 0; e < s->engine->effect_count; e++)
            if (from->effects[e].on) d->effect_mask |= 1u << e;
    }
    for (int e = 0; e < s->engine->effect_count; e++)
        if (from_scene->effects[e].on && s->engine->effects[e]->scope == SCOPE_SCENE) d->effect_mask |= 1u << e;
}

static void define(simulation *s, int threads, solid_definition *d) {
    const scene *from_scene = s->scene;
    *d = (solid_definition){.threads = threads, .dx = s->particles.dx, .transfer = from_scene->transfer,
                            .transfer_ratio = from_scene->transfer_ratio, .kernel = from_scene->kernel, .laplacian = from_scene->laplacian,
                            .count = s->particles.count, .position = s->particles.position, .velocity = s->particles.velocity,
                            .volume = s->particles.volume, .fibre1 = s->particles.fibre1, .fibre2 = s->particles.fibre2,
                            .damage = s->particles.damage, .material = s->particles.material, .element_count = s->particles.element_count,
                            .corner = s->particles.corner, .start = s->particles.start};
    for (int g = 0; g < s->particles.given_count; g++)
        d->given[d->given_count++] = (solid_given){s->particles.given_field[g], s->particles.given[g]};
    d->source_count = s->particles.source_count;
    memcpy(d->sources, s->particles.sources, sizeof d->sources);
    int gravity = effect_index("gravity"), damping = effect_index("mass_damping");
    if (from_scene->effects[gravity].on) memcpy(d->gravity, from_scene->effects[gravity].value[0], sizeof d->gravity);
    if (from_scene->effects[damping].on) d->damping = from_scene->effects[damping].value[0][0];
    define_materials(s, d);
    d->boundary_count = engine_define_boundaries(s->scene, d->boundaries);
}

static double smallest_limit(const simulation *s, double limits[EFFECT_LIMIT], int *which) {
    double least = HUGE_VAL;
    engine_limits(s, limits);
    *which = -1;
    for (int e = 0; e < s->plan.effect_count; e++)
        if (limits[e] < least) least = limits[e], *which = e;
    return least;
}

static void add_plan_field(simulation *s, const char *name, const char *from) {
    simulation_plan *p = &s->plan;
    int components = simulation_read(s, name, NULL);
    bool known = components == 0 || p->field_count == sizeof p->fields / sizeof *p->fields;
    for (int k = 0; k < p->field_count; k++) known |= strcmp(p->fields[k].name, name) == 0;
    if (known) return;
    plan_field *f = &p->fields[p->field_count++];
    snprintf(f->name, sizeof f->name, "%s", name);
    snprintf(f->effect, sizeof f->effect, "%s", from);
    f->bytes = components * p->precision / 8;
}

/* `mask` by index in the catalogue. */
static void make_plan(simulation *s, uint32_t mask, int threads) {
    simulation_plan *p = &s->plan;
    const scene *from = s->scene;
    p->mask = mask;
    p->particles = s->count;
    p->tetrahedra = s->particles.element_count;
    p->threads = threads;
    p->sheet_particles = engine_count(s, ENGINE_SHEET);
    p->spacing = s->solid ? s->particles.spacing : s->sheet_points.spacing;
    p->dx = s->solid ? s->particles.dx : s->sheet_points.spacing;
    p->precision = s->engine->precision;
    p->simd = s->engine->simd;
    static const char *const of_solids[] = {"position", "velocity", "affine_velocity", "deformation_gradient", "volume", "density_scale"};
    static const char *const of_sheets[] = {"position", "velocity", "area"};
    for (size_t i = 0; s->solid && i < sizeof of_solids / sizeof *of_solids; i++) add_plan_field(s, of_solids[i], "transfer");
    for (size_t i = 0; s->sheet && i < sizeof of_sheets / sizeof *of_sheets; i++) add_plan_field(s, of_sheets[i], "particles");
    for (int e = 0; e < p->effect_count; e++)
        for (int i = 0; (p->mask >> e & 1) && i < p->effects[e]->field_count; i++) add_plan_field(s, p->effects[e]->fields[i].key, p->effects[e]->name);
    p->bytes_per_particle = engine_bytes(s);
    int which;
    double least = smallest_limit(s, p->limits, &which), wanted = from->dt > 0 ? from->dt : least;
    p->dt = s->frame_time / ceil(s->frame_time / wanted - 1e-9);
}

/* Bodies of both kinds, sheets numbered after solids. */
static status join_bodies(simulation *s, report *r) {
    int64_t solids = s->particles.count;
    s->bodies = memory_allocate((size_t)s->count);
    if (!s->bodies) return report_set(r, STATUS_SYSTEM, "out of memory for the bodies of %lld particles", (long long)s->count);
    memcpy(s->bodies, s->particles.body, (size_t)solids);
    for (int64_t i = 0; i < s->sheet_points.count; i++) s->bodies[solids + i] = (uint8_t)(s->sheet_points.sheet[i] + s->scene->body_count);
    return STATUS_OK;
}

static status create_solid(simulation *s, int threads, report *r) {
    solid_definition *d = memory_allocate(sizeof *d);
    status code = d ? bodies_sample(s->scene, &s->particles, r) : report_set(r, STATUS_SYSTEM, "out of memory for the plan");
    source_feed feeds[SOLID_SOURCES];
    if (code == STATUS_OK) {
        define(s, threads, d);
        (void)engine_feeds(s->scene, ENGINE_SOLID, feeds);
        d->feeds = feeds;
        s->solid = s->engine->create(d, r);
        code = s->solid ? STATUS_OK : r->code;
    }
    if (code == STATUS_OK) s->plan.mask |= d->effect_mask;
    memory_free(d, sizeof *d);
    return code;
}

static status create_sheet(simulation *s, int threads, report *r) {
    status code = sheets_sample(s->scene, &s->sheet_points, r);
    if (code == STATUS_OK) code = engine_create_sheet(s, threads, r);
    if (code != STATUS_OK) return code;
    for (int e = 0; e < sheet_effects_first(); e++)
        if (s->scene->effects[e].on && s->plan.effects[e]->scope == SCOPE_SCENE) s->plan.mask |= 1u << e;
    return STATUS_OK;
}

/* Tried with a ball on a film: of 1.1 dx it is carried, of 1.7 dx it goes through. */
static void warn_of_gaps(simulation *s) {
    for (int k = 0; k < s->sheet_points.body_count; k++) {
        double spacing = s->sheet_points.bodies[k].spacing, dx = s->particles.dx;
        if (spacing > 1.25 * dx)
            snprintf(s->warning, sizeof s->warning, "sheet '%s' has particles %.3g apart, and solids a dx of %.3g: above 1.25 dx they may pass between them",
                     s->scene->sheets[k].name, spacing, dx);
    }
}

static status create_engines(simulation *s, int threads, report *r) {
    status code = s->plan.solid ? create_solid(s, threads, r) : STATUS_OK;
    if (code == STATUS_OK && s->plan.sheet) code = create_sheet(s, threads, r);
    s->count = s->particles.count + s->sheet_points.count;
    if (code == STATUS_OK && s->solid && s->sheet) code = join_bodies(s, r);
    if (code != STATUS_OK) return code;
    if (s->solid && s->sheet && s->scene->effects[effect_index("contact")].on && !(s->contact = contact_create(s, threads)))
        return report_set(r, STATUS_SYSTEM, "out of memory for the contact of sheets and solids");
    if (s->contact) warn_of_gaps(s);
    make_plan(s, s->plan.mask, threads);
    if (s->solid) bodies_free_loading(&s->particles);
    return STATUS_OK;
}

/* Whether all of it is where it may be; asked between frames. */
static status check_domain(const simulation *s, report *r) {
    const double *low = s->scene->domain_minimum, *high = s->scene->domain_maximum;
    bool bounded = false;
    for (int c = 0; c < 3; c++) bounded = bounded || isfinite(low[c]) || isfinite(high[c]);
    if (!bounded) return STATUS_OK;
    size_t bytes = (size_t)s->count * 3 * sizeof(double);
    double *x = memory_allocate(bytes);
    if (!x) return report_set(r, STATUS_SYSTEM, "out of memory for the places of %lld particles", (long long)s->count);
    simulation_read(s, "position", x);
    int64_t out = 0;
    while (out < 3 * s->count && x[out] >= low[out % 3] && x[out] <= high[out % 3]) out++;
    status code = STATUS_OK;
    if (out < 3 * s->count)
        code = report_set(r, s->frame > 0 ? STATUS_DIVERGED : STATUS_INPUT, "frame %lld, t = %.6g: particle %lld is outside of the domain: %c = %.6g, from %.6g to %.6g",
                          (long long)s->frame, s->time, (long long)(out / 3), (char)('x' + out % 3), x[out], low[out % 3], high[out % 3]);
    memory_free(x, bytes);
    return code;
}

status simulation_create(const scene *definition, const simulation_options *options, simulation **out, report *r) {
    *out = NULL;
    const solid_engine *engine = (scene_is_tetrahedra(definition) ? solid_tetra_find : solid_engine_find)(options->precision, options->simd);
    if (!engine)
        return report_input(r, NULL, 0, "simd", "an instruction set of this processor: auto, plain, avx2 or avx512", options->simd, NULL);
    simulation *s = memory_allocate(sizeof *s);
    if (!s) return report_set(r, STATUS_SYSTEM, "out of memory for the simulation");
    s->start = definition;
    s->scene = scene_copy(definition);
    if (!s->scene) {
        memory_free(s, sizeof *s);
        return report_set(r, STATUS_SYSTEM, "out of memory for the simulation");
    }
    s->engine = engine;
    s->sheets = sheet_engine_find(options->precision, engine->simd);
    s->frame_time = 1 / definition->fps;
    s->dt_min = HUGE_VAL;
    s->plan.effects = effect_catalogue(&s->plan.effect_count);
    s->plan.solid = definition->body_count > 0;
    s->plan.sheet = definition->sheet_count > 0;
    int threads = options->threads > 0 ? options->threads : processor_count();
    status code = create_engines(s, threads, r);
    if (code == STATUS_OK) code = check_domain(s, r);
    if (code != STATUS_OK) {
        simulation_destroy(s);
        return code;
    }
    *out = s;
    return STATUS_OK;
}

void simulation_destroy(simulation *s) {
    if (!s) return;
    if (s->solid) s->engine->destroy(s->solid);
    if (s->sheet) s->sheets->destroy(s->sheet);
    contact_destroy(s->contact);
    memory_free(s->bodies, (size_t)s->count);
    sheets_free(&s->sheet_points);
    bodies_free(&s->particles);
    scene_copy_free(s->scene);
    memory_free(s, sizeof *s);
}

const simulation_plan *simulation_get_plan(const simulation *s) {
    return &s->plan;
}

int simulation_stages(const simulation_plan *plan, char (*text)[48], int limit) {
    char own[32][48];
    int count = plan->solid ? (plan->tetrahedra ? solid_tetra_find : solid_engine_find)(plan->precision, plan->simd)->stages(plan->mask, text, limit) : 0;
    if (!plan->sheet) return count;
    int stages = sheet_engine_find(plan->precision, plan->simd)->stages(plan->mask >> sheet_effects_first(), own, 32);
    for (int i = 0; i < stages && count < limit; i++) {
        memcpy(text[count++], own[i], sizeof own[i]);
        /* The scene's own effects, which both engines share, act where particles advance. */
        for (int e = 0; e < sheet_effects_first() && strcmp(own[i], "advance") == 0; e++)
            if ((plan->mask >> e & 1) && count < limit) snprintf(text[count++], sizeof text[0], "%s.advance", plan->effects[e]->name);
    }
    return count;
}

/* ---- stepping ---------------------------------------------------------------------------------------------------- */

/* What grips and colliders share, from the scene. */
typedef struct boundary_source {
    const scene_function *velocity, *spin;
    double start, stop;
} boundary_source;

static boundary_source source_of(const scene *s, int i) {
    if (i < s->grip_count) {
        const scene_grip *g = &s->grips[i];
        return (boundary_source){&g->velocity, &g->spin, g->start, g->stop};
    }
    const scene_collider *c = &s->colliders[i - s->grip_count];
    return (boundary_source){&c->velocity, &c->spin, c->start, c->stop};
}

/* Velocities in the middle of the step: positions of the boundaries are then second order in Δt. */
static status drive_boundaries(simulation *s, double dt, report *r) {
    rigid_boundary *boundaries = engine_boundaries(s);
    double middle = s->time + 0.5 * dt;
    for (int i = 0; i < s->scene->grip_count + s->scene->collider_count; i++) {
        boundary_source from = source_of(s->scene, i);
        rigid_motion *m = &boundaries[i].motion;
        m->active = s->time >= from.start && s->time < from.stop;
        status code = STATUS_OK;
        if (from.velocity->outputs) code = scene_function_evaluate(from.velocity, &middle, 1, m->velocity, r);
        if (code == STATUS_OK && from.spin->outputs) code = scene_function_evaluate(from.spin, &middle, 1, m->spin, r);
        if (code != STATUS_OK) return code;
    }
    return STATUS_OK;
}

/* How fast grips and colliders go at a time, spin left out: it is a speed only with a distance. */
static status boundary_speed(const simulation *s, double time, double *most, report *r) {
    for (int i = 0; i < s->scene->grip_count + s->scene->collider_count; i++) {
        boundary_source from = source_of(s->scene, i);
        double v[6] = {0};
        if (from.velocity->outputs == 0 || time < from.start || time >= from.stop) continue;
        status code = scene_function_evaluate(from.velocity, &time, 1, v, r);
        if (code != STATUS_OK) return code;
        *most = fmax(*most, sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
    }
    return STATUS_OK;
}

static void advance_boundaries(simulation *s, double dt) {
    rigid_boundary *boundaries = engine_boundaries(s);
    for (int i = 0; i < s->scene->grip_count + s->scene->collider_count; i++)
        if (boundaries[i].motion.active) rigid_motion_advance(&boundaries[i].motion, dt);
}

static status one_step(simulation *s, double dt, report *r) {
    status code = drive_boundaries(s, dt, r);
    if (code != STATUS_OK) return code;
    code = engine_step(s, dt, r);
    if (code == STATUS_DIVERGED) {
        char text[sizeof r->message];
        snprintf(text, sizeof text, "step %lld, t = %.6g, frame %lld: %.400s", (long long)s->steps + 1, s->time, (long long)s->frame + 1,
                 r->message);
        return report_set(r, STATUS_DIVERGED, "%s", text);
    }
    if (code != STATUS_OK) return code;
    advance_boundaries(s, dt);
    s->steps++;
    s->time += dt;
    s->dt_min = fmin(s->dt_min, dt);
    s->dt_max = fmax(s->dt_max, dt);
    return STATUS_OK;
}

static const double steady_cfl = 0.8; /* pic, rpic and flip: measured on a ringing block, scenes/stress/cfl.lua */

/* Says once what a user would want to know of the time step. */
static void warn_of_limits(simulation *s, double dt, const double limits[EFFECT_LIMIT], int which, double least) {
    const char *name = which >= 0 ? s->plan.effects[which]->name : "";
    if (s->scene->dt > 0 && dt > least * (1 + 1e-9) && !s->warned_fixed) {
        s->warned_fixed = true;
        snprintf(s->warning, sizeof s->warning, "dt %.4g exceeds the limit %.4g of the effect '%s' at t = %.4g", dt, least, name, s->time);
    }
    if (s->solid && s->scene->dt == 0 && !s->plan.tetrahedra && s->scene->transfer != TRANSFER_APIC && s->scene->cfl > steady_cfl && !s->warned_cfl) {
        s->warned_cfl = true;
        snprintf(s->warning, sizeof s->warning, "cfl %.3g is too long for this transfer, which carries no whole affine velocity: above %.2g noise may grow", s->scene->cfl, steady_cfl);
    }
    int momentum = effect_index("elastic"), damage = effect_index("damage");
    if (s->solid && !s->warned_damage && limits[damage] < 0.05 * limits[momentum]) {
        s->warned_damage = true;
        snprintf(s->warning, sizeof s->warning,
                 "explicit damage limits the step to %.3g, %.0f times under the momentum's %.3g: a larger eta, or damage in its implicit form, is faster",
                 limits[damage], limits[momentum] / limits[damage], limits[momentum]);
    }
}

/* The next step's length: what is left of the frame divided by the least whole number of steps within the limit. The number
 * is kept while it holds, so that steps within a frame are equal unless the state asks for shorter ones. */
static status choose_step(simulation *s, double left, int64_t *steps_left, double *dt, report *r) {
    double limits[EFFECT_LIMIT];
    int which;
    double least = smallest_limit(s, limits, &which), driven = 0;
    /* At both ends of the step that would be: a motion may begin within it. */
    status code = boundary_speed(s, s->time, &driven, r);
    if (code == STATUS_OK) code = boundary_speed(s, s->time + fmin(least, left), &driven, r);
    if (code != STATUS_OK) return code;
    int boundary = effect_index("boundary");
    limits[boundary] = engine_boundary_limit(s, driven);
    if (limits[boundary] < least) least = limits[boundary], which = boundary;
    if (s->scene->dt > 0) {
        if (*steps_left == 0) *steps_left = (int64_t)ceil(left / s->scene->dt - 1e-9);
        *dt = left / (double)*steps_left;
        warn_of_limits(s, *dt, limits, which, least);
        return STATUS_OK;
    }
    double needed = ceil(left / least - 1e-9);
    if (!(needed <= SCENE_FRAME_STEPS)) {
        const char *name = which >= 0 ? s->plan.effects[which]->name : "?";
        bool damage = strcmp(name, "damage") == 0;
        return report_set(r, STATUS_DIVERGED, "step %lld, t = %.6g: the effect '%s' limits the time step to %.3g, %.3g steps for the rest of the frame%s",
                          (long long)s->steps + 1, s->time, name, least, needed,
                          damage ? "; damage in its implicit form (form = \"implicit\") has no such limit" : "");
    }
    if (needed < 1) needed = 1;
    if (*steps_left == 0 || (double)*steps_left < needed) *steps_left = (int64_t)needed;
    *dt = left / (double)*steps_left;
    warn_of_limits(s, *dt, limits, which, least);
    return STATUS_OK;
}

status simulation_step(simulation *s, double dt, report *r) {
    int64_t steps_left = 0;
    status code = dt > 0 ? STATUS_OK : choose_step(s, s->frame_time, &steps_left, &dt, r);
    return code == STATUS_OK ? one_step(s, dt, r) : code;
}

status simulation_advance(simulation *s, const atomic_int *abandon, report *r) {
    status code = engine_begin_frame(s, r);
    if (code != STATUS_OK) return code;
    double end = (double)(s->frame + 1) * s->frame_time, dt;
    int64_t steps_left = 0;
    do {
        if (abandon && atomic_load(abandon)) return report_set(r, STATUS_INTERRUPTED, "left at step %lld", (long long)s->steps);
        code = choose_step(s, end - s->time, &steps_left, &dt, r);
        if (code == STATUS_OK) code = one_step(s, dt, r);
        if (code != STATUS_OK) return code;
    } while (--steps_left > 0);
    s->frame++;
    s->time = end; /* frames sit at exact multiples, not at sums of steps */
    code = engine_end_frame(s, r);
    return code == STATUS_OK ? check_domain(s, r) : code;
}

int64_t simulation_frame(const simulation *s) {
    return s->frame;
}

double simulation_time(const simulation *s) {
    return s->time;
}

int64_t simulation_steps(const simulation *s) {
    return s->steps;
}

const char *simulation_take_warning(simulation *s) {
    static _Thread_local char taken[sizeof s->warning];
    memcpy(taken, s->warning, sizeof taken);
    s->warning[0] = '\0';
    return taken;
}

const uint8_t *simulation_bodies(const simulation *s) {
    return s->bodies ? s->bodies : s->sheet ? s->sheet_points.sheet : s->particles.body;
}

const solid_engine *simulation_engine(const simulation *s, solid **state) {
    *state = s->solid;
    return s->engine;
}

const sheet_engine *simulation_sheet_engine(const simulation *s, sheet **state) {
    *state = s->sheet;
    return s->sheet ? s->sheets : NULL;
}

/* ---- measures ---------------------------------------------------------------------------------------------------- */

static status measure_crack(simulation *s, simulation_measures *m, report *r) {
    if (!s->solid || m->solid.damage_max <= 0.5) return STATUS_OK;
    size_t bytes = (size_t)s->particles.count * sizeof(double);
    double *damage = memory_allocate(bytes);
    if (!damage) return report_set(r, STATUS_SYSTEM, "out of memory for the crack measure");
    status code = STATUS_OK;
    if (s->engine->read(s->solid, "damage", damage))
        code = crack_normal(s->particles.position, damage, s->particles.damage, s->particles.count, 1.3 * s->plan.dx, m->crack_normal, &m->has_crack, r);
    memory_free(damage, bytes);
    return code;
}

status simulation_measure(simulation *s, simulation_measures *m, report *r) {
    *m = (simulation_measures){.dt_min = s->steps ? s->dt_min : 0, .dt_max = s->dt_max, .time = s->time, .frame = s->frame, .steps = s->steps};
    status code = engine_measure(s, m, r);
    if (code != STATUS_OK) return code;
    double stored = m->solid.kinetic + m->solid.elastic + m->solid.fibre + m->solid.gravitational;
    if (!s->has_initial_energy) {
        s->has_initial_energy = true;
        s->initial_energy = stored;
    }
    m->dissipated = s->initial_energy + m->solid.grip_work - stored;
    return measure_crack(s, m, r);
}
