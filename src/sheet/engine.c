/* The sheet engine's life: creating, stepping, reporting limits. */
#include "base/clock.h"
#include "base/memory.h"
#include "base/threads.h"
#include "sheet/state.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>

#define SHEET_EFFECT_ADDRESS(name) &SHEET_EFFECT(name),
const effect *const sheet_effect_table[SHEET_EFFECTS] = {SHEET_EFFECT_LIST(SHEET_EFFECT_ADDRESS)};

/* ---- plans and constants ----------------------------------------------------------------------------------------- */

static void make_plans(sheet *s) {
    for (int m = 0; m < s->definition.material_count; m++) {
        s->plans[m] = (sheet_plan){.nu = 1.0 / 3, .grain_stiffness = 1, .grain_toughness = 1, .floor = 1};
        for (int e = 0; e < SHEET_EFFECTS; e++)
            if ((s->mask >> e & 1) && s->definition.materials[m].effects[e].on) sheet_effect_table[e]->sheet->declare(&s->definition.materials[m].effects[e], &s->plans[m]);
    }
}

static double least_limit(const sheet_body *b, const sheet_network *n) {
    double least = HUGE_VAL;
    for (int64_t k = n->start[b->first]; k < n->start[b->first + b->count]; k++)
        if (n->weight[k] > 0) least = fmin(least, n->limit[k]);
    return least;
}

static void make_constants(sheet *s, const sheet_network *n) {
    for (int k = 0; k < s->definition.body_count; k++) {
        const sheet_body *body = &s->definition.bodies[k];
        const sheet_material *material = &s->definition.materials[body->material];
        const sheet_plan *p = &s->plans[body->material];
        body_constants *b = &s->bodies[k];
        double surface = material->density * body->thickness;
        *b = (body_constants){.alpha = (real)p->alpha, .total = p->total, .toughness_softens = p->toughness_softens,
                              .stiffness_loss = (real)p->stiffness_loss, .toughness_loss = (real)p->toughness_loss,
                              .stretch_loss = (real)p->stretch_loss, .floor = (real)p->floor, .decay = (real)p->decay,
                              .damping = (real)p->damping, .bending = (real)(p->bending / surface), .contact_reach = p->contact_distance * body->spacing,
                              .contact_stiffness = p->contact_stiffness * p->E * body->thickness, .drag = (real)(p->drag / surface), .surface_density = surface,
                              .heat = surface * p->capacity,
                              .dilation_modulus = p->state ? p->E * body->thickness * (3 * p->nu - 1) / (2 * (1 - p->nu * p->nu)) : 0};
        for (int c = 0; c < 3; c++) b->wind[c] = (real)p->wind[c];
        bool softens = p->stiffness_loss != 0 || p->toughness_loss != 0 || p->stretch_loss != 0;
        b->flags = (p->fractures ? BOND_FRACTURES : 0u) | (p->state ? BOND_STATE : 0u) | (softens || p->alpha != 0 ? BOND_FEELS_THETA : 0u) |
                   (softens ? BOND_SOFTENS : 0u);
        if (p->fractures) b->least_limit = (real)least_limit(body, n);
        for (int e = 0; e < SHEET_EFFECTS; e++) {
            if (!material->effects[e].on || !(s->mask >> e & 1) || !sheet_effect_table[e]->sheet->bonds) continue;
            b->law_effect = e;
            double mass = surface * body->spacing * body->spacing; /* six neighbours at once: √(Σ K/2m) */
            if (k == 0) s->contact_bound = 0;
            s->contact_bound = fmax(s->contact_bound, sqrt(6 * b->contact_stiffness / (2 * mass)));
            if (sheet_effect_table[e]->sheet->constants) sheet_effect_table[e]->sheet->constants(p, &s->calibration[k], b->law);
        }
    }
}

/* Bonds from the definition: at the start, and again when a knob was turned. */
static status build(sheet *s, bool first, report *r) {
    sheet_network n;
    make_plans(s);
    status code = network_build(&s->definition, s->plans, &n, r);
    if (code != STATUS_OK) return code;
    code = network_calibrate(&s->definition, s->plans, &n, r);
    if (code == STATUS_OK) {
        memcpy(s->calibration, n.calibration, sizeof s->calibration);
        s->momentum_bound = n.momentum_bound;
        s->diffusion_bound = n.diffusion_bound;
        s->bending_bound = n.bending_bound;
        code = first ? sheet_layout(s, &n, r) : sheet_refill(s, &n, r);
        if (first && code == STATUS_OK && (s->mask >> SHEET_EFFECT_multirate & 1)) code = sheet_rates_create(s, r);
        if (code == STATUS_OK && s->rates) sheet_rates_load(s, &n);
        make_constants(s, &n);
    }
    network_free(&n);
    return code;
}

/* ---- stages that the engine runs itself -------------------------------------------------------------------------- */

static bool state_based(const sheet *s) {
    return s->dilation != NULL;
}

/* ϑ_i/w_i = (2/w_i²) Σ W A_j (η − α θ̄): what the state-based form adds (METHOD.md §6). */
static void dilate(const pack_work *w) {
    sheet *s = w->state;
    const sheet_pack *pack = &s->packs[w->pack];
    if (!(w->body->flags & BOND_STATE)) return;
    for (int part = 0; part < PACK_PARTS; part++) {
        int first = part * VEC_LANES;
        own_place own;
        vec r[4], sum = vec_all(0);
        own_place_load(s, w->pack, first, &own);
        for (int32_t k = 0; k < pack->slots; k++) {
            int64_t at = ((int64_t)pack->first_slot + k) * PACK + first;
            bond_vector(s, s->neighbour + at, &own, r);
            vec square = vec_fma(r[0], r[0], vec_fma(r[1], r[1], r[2] * r[2]));
            vec eta = vec_sqrt(vec_max(square, vec_all((real)1e-30))) * vec_load(s->inverse + at) - 1;
            vec theta = r[3] * (real)0.5, q = eta - w->body->alpha * theta;
            vec left = vec_sqrt(vec_max(1 - w->body->stiffness_loss * theta, vec_all(w->body->floor)));
            sum = vec_fma(vec_load(s->dilation + at) * left, q, sum);
        }
        vec_store(s->dilatation + (int64_t)w->pack * PACK + first, sum);
    }
}

static void pull(const pack_work *w) {
    sheet_effect_table[w->body->law_effect]->sheet->bonds(w);
}

/* ---- life -------------------------------------------------------------------------------------------------------- */

static void release_effects(sheet *s) {
    for (int e = 0; e < SHEET_EFFECTS; e++)
        if (sheet_effect_table[e]->sheet->release) sheet_effect_table[e]->sheet->release(s);
}

static void destroy(sheet *s) {
    if (!s) return;
    release_effects(s);
    sheet_rates_free(s);
    sheet_layout_free(s);
    memory_free(s, sizeof *s);
}

static void feed(sheet *s, const source_feed *feeds) {
    for (int k = 0; k < s->definition.source_count; k++) s->feeds[k] = feeds ? feeds[k] : (source_feed){.strength = 1};
}

static double fastest_now(const sheet *s) {
    double most = 0;
    for (int64_t pack = 0; pack < s->pack_count; pack++)
        for (int i = 0; i < PACK; i++) {
            double sum = 0;
            for (int c = 0; c < 3; c++) sum += (double)s->velocity[(pack * 3 + c) * PACK + i] * (double)s->velocity[(pack * 3 + c) * PACK + i];
            most = fmax(most, sum);
        }
    return sqrt(most);
}

static sheet *create(const sheet_definition *definition, report *r) {
    sheet *s = memory_allocate(sizeof *s);
    if (!s) {
        report_set(r, STATUS_SYSTEM, "out of memory for the sheet engine");
        return NULL;
    }
    s->definition = *definition;
    s->mask = definition->effect_mask;
    s->threads = definition->threads > 0 ? definition->threads : 1;
    s->count = definition->count;
    s->stiffening = 1;
    feed(s, definition->feeds);
    s->definition.feeds = NULL;
    if (build(s, true, r) != STATUS_OK) {
        destroy(s);
        return NULL;
    }
    /* What the caller lends only for loading. */
    s->definition.position = s->definition.velocity = s->definition.diffused = NULL;
    sheet_diffuse(s, 0); /* what is held from the start */
    s->speed = fastest_now(s);
    return s;
}

static const double way_a_step = 0.45; /* of a spacing; at half of one a step is refused */

static rigid_boundary *boundaries(sheet *s) {
    return s->definition.boundaries;
}

static double finest_spacing(const sheet *s) {
    double finest = HUGE_VAL;
    for (int b = 0; b < s->definition.body_count; b++) finest = fmin(finest, s->definition.bodies[b].spacing);
    return finest;
}

/* Bonds set the pace of what swings; a particle without any would still be flung past its neighbours. */
static void limits(const sheet *s, double *limit) {
    for (int e = 0; e < SHEET_EFFECTS; e++) limit[e] = HUGE_VAL;
    double momentum = s->rates ? sheet_rates_limit(s) : 1 / sqrt(s->momentum_bound * s->stiffening);
    if (s->speed > 0) momentum = fmin(momentum, way_a_step * finest_spacing(s) / s->speed);
    for (int e = 0; e < SHEET_EFFECTS; e++)
        if ((s->mask >> e & 1) && sheet_effect_table[e]->sheet->bonds) limit[e] = momentum;
    if (s->bending_bound > 0) limit[SHEET_EFFECT_bending] = 1 / s->bending_bound;
    if (s->contact_bound > 0) limit[SHEET_EFFECT_self_contact] = 1 / s->contact_bound;
    if (s->diffusion_bound > 0) limit[SHEET_EFFECT_diffusion] = 1 / s->diffusion_bound;
}

/* ---- stepping ---------------------------------------------------------------------------------------------------- */

static status blame(const sheet *s, int32_t at, double dt, sheet_fault *fault, report *r) {
    const real *node = s->node + (int64_t)at * NODE;
    double speed = 0;
    for (int c = 0; c < 3; c++) speed = fmax(speed, fabs((double)s->velocity[((int64_t)(at / PACK) * 3 + c) * PACK + at % PACK]));
    fault->particle = s->id[at];
    if (!isfinite((double)node[3])) {
        *fault = (sheet_fault){s->id[at], "diffused quantity", (double)node[3]};
        return report_set(r, STATUS_DIVERGED, "particle %lld of the sheet has a diffused quantity that is not finite (effect diffusion)", (long long)fault->particle);
    }
    fault->quantity = "speed";
    fault->value = speed;
    const char *law = sheet_effect_table[s->bodies[s->packs[at / PACK].body].law_effect]->name;
    return report_set(r, STATUS_DIVERGED, "particle %lld of the sheet runs away (effect %s): speed %.4g moves it over half a spacing in one step of %.4g",
                      (long long)fault->particle, law, speed, dt);
}

static void reset_results(sheet *s) {
    for (int32_t g = 0; g < s->group_count; g++) s->results[g] = (group_result){.stiffening = 1};
}

static status reduce_results(sheet *s, double dt, sheet_fault *fault, report *r) {
    real fastest = 0;
    s->stiffening = 1;
    for (int32_t g = 0; g < s->group_count; g++) {
        const group_result *result = &s->results[g];
        if (result->fastest > fastest) fastest = result->fastest;
        s->stiffening = fmax(s->stiffening, (double)result->stiffening);
        s->grip_work += result->grip_work;
        s->broken_since += result->broken;
        for (int c = 0; c < 3; c++) s->grip_impulse[c] += result->grip_impulse[c];
        if (result->fault) return blame(s, result->fault - 1, dt, fault, r);
    }
    s->speed = sqrt((double)fastest);
    return STATUS_OK;
}

/* Bonds and places, in as many parts as the fastest packs ask for. Boundaries move from part to part; who drives them moves them by the whole step. */
static void parts(sheet *s, double dt) {
    int count = s->rates ? 1 << s->rates->finest : 1;
    rigid_motion motions[SHEET_BOUNDARIES];
    for (int b = 0; b < s->definition.boundary_count; b++) motions[b] = s->definition.boundaries[b].motion;
    for (int part = 0; part < count; part++) {
        double t0 = clock_seconds();
        if (state_based(s)) sheet_for_due(s, dt, part, dilate);
        sheet_for_due(s, dt, part, pull);
        double t1 = clock_seconds();
        sheet_advance(s, dt, part);
        s->seconds[SHEET_PHASE_BONDS] += t1 - t0;
        s->seconds[SHEET_PHASE_ADVANCE] += clock_seconds() - t1;
        s->bond_updates += PACK * (s->rates ? s->rates->active_slots[part == 0 ? 0 : s->rates->finest - __builtin_ctz((unsigned)part)] : s->slot_count);
        for (int b = 0; b < s->definition.boundary_count && part + 1 < count; b++)
            if (motions[b].active) rigid_motion_advance(&s->definition.boundaries[b].motion, dt / count);
    }
    for (int b = 0; b < s->definition.boundary_count; b++) s->definition.boundaries[b].motion = motions[b];
}

static status step(sheet *s, double time, double dt, sheet_fault *fault, report *r) {
    double t0 = clock_seconds();
    sheet_take_hold(s);
    reset_results(s);
    if (s->rates) sheet_rates_choose(s, dt);
    for (int e = 0; e < SHEET_EFFECTS; e++)
        if ((s->mask >> e & 1) && sheet_effect_table[e]->sheet->before && sheet_effect_table[e]->sheet->before(s, (real)dt, r) != STATUS_OK)
            return r->code;
    double t1 = clock_seconds();
    s->seconds[SHEET_PHASE_CONTACT] += t1 - t0;
    parts(s, dt);
    double t3 = clock_seconds();
    for (int e = 0; e < SHEET_EFFECTS; e++)
        if ((s->mask >> e & 1) && sheet_effect_table[e]->sheet->after) sheet_effect_table[e]->sheet->after(s, time + dt, dt);
    s->seconds[SHEET_PHASE_DIFFUSION] += clock_seconds() - t3;
    return reduce_results(s, dt, fault, r);
}

static void surround(sheet *s, const double gravity[3], double cfl) {
    memcpy(s->definition.gravity, gravity, sizeof s->definition.gravity);
    s->definition.cfl = cfl;
}

static status refresh(sheet *s, report *r) {
    release_effects(s); /* lists that were made for other values */
    return build(s, false, r);
}

static int components(const sheet *s, const char *field) {
    return sheet_read(s, field, NULL);
}

static sheet_calibration calibration(const sheet *s, int body) {
    return s->calibration[body];
}

static double bytes_per_particle(const sheet *s) {
    double lanes = (double)s->pack_count * PACK, slots = (double)s->slot_count * PACK, size = sizeof(real);
    double particle = (NODE + 3 + 1) * size + sizeof *s->id + 1 + (s->diffused_next ? size : 0) + (s->dilatation ? size + 8 : 0);
    double bond = sizeof *s->neighbour + size * (2 + (s->limit != NULL) + (s->history != NULL) + (s->conduct != NULL) + 2 * (s->coupling != NULL));
    return (lanes * particle + slots * bond + (double)s->count * sizeof *s->place + sheet_rates_bytes(s)) / (double)s->count;
}

static void phases(const sheet *s, double seconds[SHEET_PHASES]) {
    memcpy(seconds, s->seconds, sizeof s->seconds);
}

/* The stages of a step in the order in which they are called. */
static int stage_names(uint32_t mask, char (*text)[48], int limit) {
    static const struct {
        const char *pass, *name;
        size_t offset;
    } places[] = {
        {NULL, "before", offsetof(sheet_stages, before)},
        {"bonds", "bonds", offsetof(sheet_stages, bonds)},
        {"advance", "velocity", offsetof(sheet_stages, velocity)},
        {"after", "after", offsetof(sheet_stages, after)},
    };
    int count = 0;
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        if (places[i].pass && count < limit) snprintf(text[count++], sizeof text[0], "%s", places[i].pass);
        for (int e = 0; e < SHEET_EFFECTS; e++) {
            void (*stage)(void);
            memcpy(&stage, (const char *)sheet_effect_table[e]->sheet + places[i].offset, sizeof stage);
            if ((mask >> e & 1) && stage && count < limit) snprintf(text[count++], sizeof text[0], "%s.%s", sheet_effect_table[e]->name, places[i].name);
        }
    }
    return count;
}

#define TEXT_(x) #x
#define TEXT(x) TEXT_(x)

const sheet_engine sheet_engine_table = {
    .simd = TEXT(SHEET_SIMD_NAME), .precision = SUNDER_PRECISION, .effects = sheet_effect_table, .effect_count = SHEET_EFFECTS,
    .create = create, .destroy = destroy, .boundaries = boundaries, .limits = limits, .step = step, .touch = &sheet_touch_table, .settle = sheet_diffuse,
    .measure = sheet_measure, .read = sheet_read, .components = components, .bonds = sheet_bonds, .calibration = calibration,
    .save = sheet_save, .restore = sheet_restore, .stages = stage_names, .feed = feed, .surround = surround, .refresh = refresh,
    .bytes_per_particle = bytes_per_particle, .rates = sheet_rates_report, .levels = sheet_rates_levels, .phases = phases,
};
