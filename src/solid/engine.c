/* The solid engine's life: creating, stepping, reporting limits. */
#include "base/clock.h"
#include "base/memory.h"
#include "base/threads.h"
#include "solid/inextensible.h"
#include "solid/order.h"

#include <assert.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>

enum { PHASE_SORT, PHASE_P2G, PHASE_GRID, PHASE_G2P };

static int add_field(solid *s, const char *name, int components) {
    for (int i = 0; i < s->field_count; i++)
        if (strcmp(s->fields[i].name, name) == 0) return i;
    s->fields[s->field_count] = (solid_field){.name = name, .components = components};
    return s->field_count++;
}

static int find_index(const solid *s, const char *name) {
    for (int i = 0; i < s->field_count; i++)
        if (strcmp(s->fields[i].name, name) == 0) return i;
    return -1;
}

static bool is_given(const solid *s, const char *field) {
    for (int i = 0; i < s->definition.given_count; i++)
        if (strcmp(s->definition.given[i].field, field) == 0) return true;
    return false;
}

static bool scales_parameter(const char *field) {
    for (int e = 0; e < SOLID_EFFECTS; e++)
        for (int k = 0; k < solid_effects[e]->parameter_count; k++)
            if (solid_effects[e]->parameters[k].scale && strcmp(solid_effects[e]->parameters[k].scale, field) == 0) return true;
    return false;
}

/* Only the fields of effects that are on; a second fibre family only where there is one, and what scales parameters only where the
 * definition brings it. */
static void plan_fields(solid *s) {
    add_field(s, "position", 3);
    add_field(s, "velocity", 3);
    add_field(s, "affine_velocity", 9);
    add_field(s, "deformation_gradient", 9);
    add_field(s, "volume", 1);
    for (int e = 0; e < s->effect_count; e++)
        for (int i = 0; (s->mask >> e & 1) && i < solid_effects[e]->field_count; i++) {
            const effect_field *f = &solid_effects[e]->fields[i];
            if (strcmp(f->key, "fibre") == 0 && !s->definition.fibre1) continue;
            if (strcmp(f->key, "fibre2") == 0 && !s->definition.fibre2) continue;
            if (scales_parameter(f->key) && !is_given(s, f->key)) continue;
            add_field(s, f->key, f->components);
        }
    if (is_given(s, "density_scale")) add_field(s, "density_scale", 1);
    s->density_scale = find_index(s, "density_scale");
    s->given_stiffness = s->stiffness_scale = find_index(s, "stiffness_scale");
    s->given_toughness = s->toughness_scale = find_index(s, "toughness_scale");
    if (find_index(s, "softened_stiffness") >= 0) s->stiffness_scale = find_index(s, "softened_stiffness");
    if (find_index(s, "softened_strength") >= 0) s->toughness_scale = find_index(s, "softened_strength");
    s->viscosity_scale = find_index(s, "viscosity_scale");
    s->gamma_scale = find_index(s, "gamma_scale");
    s->damage_field = find_index(s, "damage");
    s->history_field = find_index(s, "damage_history");
    s->fibre_field = find_index(s, "fibre");
    s->fibre2_field = find_index(s, "fibre2");
    s->tension_field = find_index(s, "fibre_tension");
    s->fibre_wave_field = find_index(s, "fibre_wave");
    s->snapped_field = find_index(s, "fibre_damage");
    s->diffusion.field = find_index(s, "diffused");
    s->transfers_damage = s->damage_field >= 0;
    for (int e = 0; e < SOLID_EFFECTS; e++) {
        assert(solid_effects[e]->field_count <= OWN_FIELDS);
        for (int i = 0; i < OWN_FIELDS; i++) s->own_field[e][i] = i < solid_effects[e]->field_count ? find_index(s, solid_effects[e]->fields[i].key) : -1;
    }
}

static size_t share_bytes(const solid *s) {
    return (size_t)(1 + PARALLEL_STAGES) * (size_t)(s->threads + 1) * sizeof *s->block_shares;
}

static void destroy(solid *s) {
    if (!s) return;
    particles_free(s);
    grid_free(s);
    constraint_forget(s);
    memory_free(s->workers, (size_t)s->threads * sizeof *s->workers);
    memory_free(s->block_shares, share_bytes(s));
    memory_free(s, sizeof *s);
}

static status prepare(solid *s, report *r) {
    status code = particles_load(s, r);
    if (code == STATUS_OK) code = grid_build(s, r);
    if (code != STATUS_OK) return code;
    s->sorted = true;
    return STATUS_OK;
}

static void collect_limits(solid *s) {
    memset(s->limits, 0, sizeof s->limits);
    for (int32_t t = 0; t < s->tile_count; t++)
        for (int e = 0; e < s->effect_count; e++)
            s->limits[e] = fmax(s->limits[e], (double)s->tile_results[t].limit[e]);
    s->limits[EFFECT_diffusion] = s->diffusion.rate;
}

static solid *create(const solid_definition *definition, report *r) {
    solid *s = memory_allocate(sizeof *s);
    if (!s) {
        report_set(r, STATUS_SYSTEM, "out of memory for the solid engine");
        return NULL;
    }
    solid_define(s, definition);
    plan_fields(s);
    solid_constants_refresh(s);
    s->workers = memory_allocate_array((size_t)s->threads, sizeof *s->workers);
    s->block_shares = memory_allocate(share_bytes(s));
    if (s->block_shares) s->colour_shares = s->block_shares + s->threads + 1;
    status code = STATUS_OK;
    if (!s->workers || !s->block_shares) code = report_set(r, STATUS_SYSTEM, "out of memory for %d threads", s->threads);
    if (code == STATUS_OK) code = prepare(s, r);
    if (code != STATUS_OK) {
        destroy(s);
        return NULL;
    }
    diffusion_start(s);
    diffusion_refresh(s);
    transfer_limits(s);
    collect_limits(s);
    return s;
}

/* Which quantity of a bad particle is to blame, for the message. */
static status blame(const solid *s, const solid_tile *tile, int lane, double dt, solid_fault *fault, report *r) {
    int32_t pack = tile->first_pack + lane / PACK;
    double speed = 0, J_parts = 0;
    for (int c = 0; c < 3; c++) speed = fmax(speed, fabs((double)field_at(&s->fields[FIELD_VELOCITY], pack, c, 0)[lane % PACK]));
    for (int c = 0; c < 9; c++) J_parts += (double)field_at(&s->fields[FIELD_DEFORMATION], pack, c, 0)[lane % PACK];
    fault->particle = s->id[pack * PACK + lane % PACK];
    fault->effect = "elastic";
    bool runaway = isfinite(speed) && isfinite(J_parts);
    fault->quantity = runaway ? "speed" : isfinite(speed) ? "deformation gradient" : "velocity";
    fault->value = runaway ? speed : NAN;
    if (s->damage_field >= 0 && !isfinite((double)field_at(&s->fields[s->damage_field], pack, 0, 0)[lane % PACK]))
        fault->effect = "damage", fault->quantity = "damage";
    if (runaway)
        return report_set(r, STATUS_DIVERGED, "particle %lld runs away (effect %s): speed %.4g moves it over a cell (%.4g) in one step of %.4g",
                          (long long)fault->particle, fault->effect, speed, s->definition.dx, dt);
    return report_set(r, STATUS_DIVERGED, "particle %lld has a %s that is not finite (effect %s)", (long long)fault->particle,
                      fault->quantity, fault->effect);
}

static status examine(solid *s, double dt, solid_fault *fault, report *r) {
    for (int32_t t = 0; t < s->tile_count; t++) {
        if (s->tile_results[t].fault) return blame(s, &s->tiles[t], s->tile_results[t].fault - 1, dt, fault, r);
        if (s->tile_results[t].unsorted) s->sorted = false;
    }
    collect_limits(s);
    return STATUS_OK;
}

static status sort(solid *s, report *r) {
    double start = clock_seconds();
    status code = particles_sort(s, r);
    s->seconds[PHASE_SORT] += clock_seconds() - start;
    return code;
}

/* What a frame starts with must not depend on the steps before it, or a resumed run would differ. */
static status begin_frame(solid *s, report *r) {
    constraint_begin_frame(s);
    return sort(s, r);
}

static status solve_effects(solid *s, real dt, report *r) {
    for (int e = 0; e < s->effect_count; e++) {
        if (!(s->mask >> e & 1) || !solid_effects[e]->stages->solve) continue;
        bool done = false; /* one solve serves all damage models */
        for (int before = 0; before < e; before++) done |= (s->mask >> before & 1) && solid_effects[before]->stages->solve == solid_effects[e]->stages->solve;
        if (done) continue;
        double start = clock_seconds();
        status code = solid_effects[e]->stages->solve(s, dt, r);
        s->solving[e] += clock_seconds() - start;
        if (code != STATUS_OK) return code;
    }
    return STATUS_OK;
}

/* A stage that runs once a step, by its place in solid_stages. */
static status run_stage(solid *s, size_t offset, real dt, report *r) {
    for (int e = 0; e < s->effect_count; e++) {
        status (*stage)(solid *, real, report *);
        memcpy(&stage, (const char *)solid_effects[e]->stages + offset, sizeof stage);
        if (!(s->mask >> e & 1) || !stage) continue;
        double start = clock_seconds();
        status code = stage(s, dt, r);
        s->solving[e] += clock_seconds() - start;
        if (code != STATUS_OK) return code;
    }
    return STATUS_OK;
}

static status step(solid *s, double dt, solid_fault *fault, report *r) {
    if (!s->sorted) {
        status code = sort(s, r);
        if (code != STATUS_OK) return code;
    }
    double start = clock_seconds();
    status code = run_stage(s, offsetof(solid_stages, before), (real)dt, r);
    if (code != STATUS_OK) return code;
    double t0 = clock_seconds();
    transfer_to_grid(s, (real)dt);
    double t1 = clock_seconds();
    if ((code = solve_effects(s, (real)dt, r)) != STATUS_OK) return code;
    grid_update(s, (real)dt);
    if ((code = run_stage(s, offsetof(solid_stages, constrain), (real)dt, r)) != STATUS_OK) return code;
    double t2 = clock_seconds();
    transfer_to_particles(s, (real)dt);
    double t3 = clock_seconds();
    s->seconds[PHASE_P2G] += t1 - t0;
    s->seconds[PHASE_GRID] += (t0 - start) + (t2 - t1);
    s->seconds[PHASE_G2P] += t3 - t2;
    return examine(s, dt, fault, r);
}

/* An effect's own limit follows from what its last step saw; it is brought up to date by the most that any material's constants ask for. */
static void hasten_limits(solid *s, real before[SOLID_MATERIALS][EFFECT_LIMIT][CONSTANTS]) {
    for (int e = 0; e < s->effect_count; e++) {
        double most = 0;
        for (int m = 0; solid_effects[e]->stages->hasten && m < s->definition.material_count; m++)
            if (s->material_mask[m] >> e & 1) most = fmax(most, solid_effects[e]->stages->hasten(before[m][e], s->constants[m][e]));
        if (most > 0) s->limits[e] *= most;
    }
}

/* What it leaves depends on the state and the new values alone, as a resumed run finds them, not on how the state was reached. */
static void refresh(solid *s) {
    real before[SOLID_MATERIALS][EFFECT_LIMIT][CONSTANTS];
    memcpy(before, s->constants, sizeof before);
    solid_constants_refresh(s);
    hasten_limits(s, before);
    diffusion_refresh(s);
    transfer_limits(s);
    s->limits[EFFECT_elastic] = 0;
    for (int32_t t = 0; t < s->tile_count; t++)
        s->limits[EFFECT_elastic] = fmax(s->limits[EFFECT_elastic], (double)s->tile_results[t].limit[EFFECT_elastic]);
}

static int components(const solid *s, const char *field) {
    return solid_read(s, field, NULL);
}

static double bytes_per_particle(const solid *s) {
    double bytes = (double)particles_bytes(s);
    double node_reals = NODE + (s->damage_grid ? DAMAGE_NODE : 0) + (s->old_grid ? NODE : 0) + (s->implicit_grid ? IMPLICIT_PLANES : 0) + (s->diffusion.grid ? NODE : 0);
    double grid_bytes = (double)s->slot_capacity * BLOCK_NODES * node_reals * sizeof(real);
    grid_bytes += constraint_bytes(s);
    double tables = (double)s->tile_capacity * (sizeof *s->tiles + sizeof *s->tile_results) +
                    (double)s->block_capacity * sizeof *s->blocks + (double)s->hash_capacity * 12 +
                    (double)s->sort_move_capacity * sizeof *s->sort_moves + (double)s->wait_capacity * sizeof *s->waits;
    return (bytes + grid_bytes + tables) / (double)s->count;
}

/* Of the passes the blocks that looked at the clock tell the shares. */
static void effort(const solid *s, double seconds[SOLID_PHASES][EFFECT_LIMIT]) {
    static const int phase_of[PASSES] = {[PASS_P2G] = PHASE_P2G, [PASS_G2P] = PHASE_G2P};
    memset(seconds, 0, SOLID_PHASES * sizeof *seconds);
    for (int pass = 0; pass < PASSES; pass++) {
        double all = 0;
        for (int w = 0; w < s->threads; w++) all += s->workers[w].clocks[pass].all;
        for (int w = 0; w < s->threads && all > 0; w++)
            for (int e = 0; e < s->effect_count; e++)
                seconds[phase_of[pass]][e] += s->workers[w].clocks[pass].effect[e] / all * s->seconds[phase_of[pass]];
    }
    memcpy(seconds[PHASE_GRID], s->solving, sizeof s->solving);
}

/* The stages of a step in the order in which transfer.c and grid.c call them. */
static int stage_names(uint32_t mask, char (*text)[48], int limit) {
    static const stage_place places[] = {
        {NULL, "before", offsetof(solid_stages, before)},
        {"p2g", "degrade", offsetof(solid_stages, degrade)}, {NULL, "stress", offsetof(solid_stages, stress)},
        {"solve", "solve", offsetof(solid_stages, solve)},
        {"grid", "grid", offsetof(solid_stages, grid)},      {NULL, "constrain", offsetof(solid_stages, constrain)},
        {"g2p", "update", offsetof(solid_stages, update)},
        {NULL, "degrade", offsetof(solid_stages, degrade)},  {NULL, "wave", offsetof(solid_stages, wave)},
    };
    return solid_stage_names(places, sizeof places / sizeof *places, mask, text, limit);
}

static bool knows(const effect *e) {
    (void)e;
    return true;
}

#define TEXT_(x) #x
#define TEXT(x) TEXT_(x)

const solid_engine solid_engine_table = {
    .simd = TEXT(SOLID_SIMD_NAME), .precision = SUNDER_PRECISION, .effects = solid_effects, .effect_count = SOLID_EFFECTS,
    .create = create, .destroy = destroy, .boundaries = solid_boundaries, .limits = solid_limits, .sort = begin_frame, .step = step, .touch = &solid_touch_table, .settle = diffusion_settle, .feed = diffusion_feed,
    .measure = solid_measure, .read = solid_read, .components = components, .save = solid_save, .restore = solid_restore,
    .stages = stage_names, .knows = knows, .surround = solid_surround, .refresh = refresh, .bytes_per_particle = bytes_per_particle, .phases = solid_phases,
    .phase_names = {"sort", "p2g", "grid", "g2p"}, .effort = effort,
};
