/* Diffusion of moisture or heat through solids (METHOD.md, end of §6): ρ C θ̇ = ∇·(k ∇θ) + sources.
 *
 * A particle exchanges θ with the nodes' means, as often as a walk with the kernel's own variance D has to:
 *     θ̇_p = (g k/ρ C D) Σ_i w_ip φ_i (θ_i − θ_p),   θ_i = Σ_p a_p w_ip θ_p / Σ_p a_p w_ip,   a_p = V_p g k,   g = (1 − d)².
 * The way to the nodes and back has the variance 2 D an axis, half of which times the rate is the diffusivity k/ρ C; the error is of second order in
 * dx. What a node takes it gives: φ (Σ_p a w θ_i − Σ_p a w θ_p) = 0, so Σ ρ C V θ is kept to round-off whatever k, d and the places are. Means
 * lie between what they are of: no new extremes while Δt g k/ρ C D ≤ 1, and differences within a cell, which gradients on the grid would not
 * see, die first of all. φ = (Σ V m w / Σ V w)⁴, m = 1 − d⁸, shuts the nodes of a crack, which particles of both its sides reach: it insulates
 * where it is narrower than they are. Bodies that come as near as kernels reach conduct into one another.
 *
 * The walk's limit is far above momentum's for most materials, so it runs every n-th step, and at the end of a frame.
 *
 * A particle that a source holds would be felt 0.4 dx too late: a walk steps over the face. It counts for HELD, and is felt 0.1 dx too late. */
#include "base/memory.h"
#include "base/threads.h"
#include "solid/moduli.h"
#include "solid/records.h"

#include <math.h>

enum { RATE, CONDUCTIVITY, DECAY, HEAT, INITIAL };
enum { KEY_K, KEY_C, KEY_DECAY, KEY_INITIAL, KEY_COUNT };
enum { LEVEL, OPEN }; /* planes of nodes, made of the four sums */

static const double SHARE_OF_LIMIT = 0.5;
static const real HELD = 3;

static void constants(const effect_values *all, const solid_definition *d, bool protects, real out[CONSTANTS]) {
    (void)protects;
    const effect_values *own = &all[EFFECT_diffusion];
    double variance = d->dx * d->dx / (d->laplacian == KERNEL_QUADRATIC ? 4 : 3);
    out[RATE] = (real)(own->value[KEY_K][0] / (own->value[KEY_C][0] * variance)); /* over ρ */
    out[CONDUCTIVITY] = (real)own->value[KEY_K][0];
    out[DECAY] = (real)own->value[KEY_DECAY][0];
    out[HEAT] = (real)own->value[KEY_C][0];
    out[INITIAL] = (real)own->value[KEY_INITIAL][0];
}

static bool takes_part(const solid *s, const solid_tile *tile) {
    return s->material_mask[tile->material] >> EFFECT_diffusion & 1;
}

static const real *constants_of(const solid *s, const solid_tile *tile) {
    return s->constants[tile->material][EFFECT_diffusion];
}

/* How fast particles of the material's own density exchange. */
static double rate_of(const solid *s, const solid_tile *tile) {
    return (double)constants_of(s, tile)[RATE] / s->definition.materials[tile->material].density;
}

/* ---- memory ------------------------------------------------------------------------------------------------------ */

void diffusion_free(solid *s) {
    solid_diffusion *d = &s->diffusion;
    memory_free(d->grid, d->grid ? (size_t)d->capacity * NODE * BLOCK_NODES * sizeof(real) : 0);
    d->grid = NULL;
    d->capacity = 0;
}

status diffusion_reserve(solid *s, int32_t slots, report *r) {
    if (s->diffusion.field < 0 || slots <= s->diffusion.capacity) return STATUS_OK;
    diffusion_free(s);
    s->diffusion.grid = memory_allocate_array((size_t)slots, NODE * BLOCK_NODES * sizeof(real));
    if (!s->diffusion.grid) return report_set(r, STATUS_SYSTEM, "out of memory for diffusion on %d grid blocks", slots);
    s->diffusion.capacity = slots;
    return STATUS_OK;
}

/* ---- sources ----------------------------------------------------------------------------------------------------- */

static bool is_held(const solid *s, int k, double time) {
    const solid_source *source = &s->definition.sources[k];
    return source->fixed && !s->diffusion.feeds[k].off && time >= source->start && time < source->stop;
}

/* What a source has for a particle; NaN: nothing. */
static double fed(const solid_source *source, int32_t id) {
    int64_t at = id - source->first;
    return id >= 0 && at >= 0 && at < source->count ? source->value[at] : NAN;
}

/* What sources give a tile between two times: rates for the part of the time that they are on, held values where they are on at its end. */
static void feed_tile(const solid *s, const solid_tile *tile, double from, double to) {
    const solid_field *theta = &s->fields[s->diffusion.field];
    for (int k = 0; k < s->definition.source_count; k++) {
        const solid_source *source = &s->definition.sources[k];
        double on = fmin(to, source->stop) - fmax(from, source->start), strength = s->diffusion.feeds[k].strength;
        if (s->diffusion.feeds[k].off || (source->fixed ? !is_held(s, k, to) : !(on > 0))) continue;
        for (int32_t p = 0; p < tile->count; p++) {
            int32_t pack = tile->first_pack + p / PACK;
            double value = strength * fed(source, s->id[pack * PACK + p % PACK]);
            real *own = field_at(theta, pack, 0, 0) + p % PACK;
            if (!isnan(value)) *own = source->fixed ? (real)value : *own + (real)(on * value);
        }
    }
}

/* How much each of a tile's particles counts for. */
static void weigh_tile(const solid *s, const solid_tile *tile, double from, double to, real *weight) {
    for (int32_t p = 0; p < tile->pack_count * PACK; p++) weight[p] = 1;
    for (int k = 0; k < s->definition.source_count; k++) {
        if (!is_held(s, k, from) || !is_held(s, k, to)) continue;
        for (int32_t p = 0; p < tile->count; p++)
            if (!isnan(fed(&s->definition.sources[k], s->id[(tile->first_pack + p / PACK) * PACK + p % PACK]))) weight[p] = HELD;
    }
}

/* ---- the walk ---------------------------------------------------------------------------------------------------- */

typedef struct walk_context {
    solid *state;
    double from, to;
} walk_context;

static bool is_wide(const solid *s) {
    return kernels_are_wide(s->definition.kernel, s->definition.laplacian, true);
}

SIMD_INLINE vec damage_of(const solid *s, const solid_tile *tile, int32_t pack, int part) {
    return s->material_damaged[tile->material] ? vec_load(field_at(&s->fields[s->damage_field], pack, 0, part)) : vec_all(0);
}

/* What a particle gives its nodes: w (a θ, a, V m, V), m = 1 − d⁸ what of it is whole. */
SIMD_INLINE void walk_records(const solid *s, const solid_tile *tile, const real *weights, real *records, kernel_kind kind) {
    real k = s->diffusion.unit * constants_of(s, tile)[CONDUCTIVITY];
    for (int i = 0; i < tile->pack_count; i++)
        for (int part = 0; part < PACK_PARTS; part++) {
            int32_t pack = tile->first_pack + i;
            vec volume = vec_load(field_at(&s->fields[FIELD_VOLUME], pack, 0, part)), d = damage_of(s, tile, pack, part);
            vec weight = vec_load(weights + i * PACK + part * VEC_LANES) * volume * k * ((1 - d) * (1 - d)), d4 = d * d * (d * d);
            vec values[NODE] = {weight * vec_load(field_at(&s->fields[s->diffusion.field], pack, 0, part)), weight, volume * (1 - d4 * d4), volume};
            plain_records(records, i * PACK + part * VEC_LANES, kind, vec3v_load(&s->fields[FIELD_POSITION], pack, part), values);
        }
}

SIMD_INLINE void walk_block(const walk_context *c, int32_t index, int worker, kernel_kind kind) {
    solid *s = c->state;
    const solid_block *b = &s->blocks[index];
    solid_worker *own = &s->workers[worker];
    real *window = own->implicit_window, *records = own->tile.records;
    memset(window, 0, NODE * WINDOW_NODES * sizeof *window);
    for (int32_t t = b->first_tile; t < b->first_tile + b->tile_count; t++) {
        const solid_tile *tile = &s->tiles[t];
        if (!takes_part(s, tile)) continue;
        weigh_tile(s, tile, c->from, c->to, own->tile.laplacian);
        walk_records(s, tile, own->tile.laplacian, records, kind);
        scatter_plain(records, tile->count, kind, window);
    }
    exchange_window(b, window, s->diffusion.grid, NODE, NODE * BLOCK_NODES, is_wide(s), true);
}

static void walk_quadratic(void *context, int32_t block, int32_t next, int worker) {
    (void)next;
    walk_block(context, block, worker, KERNEL_QUADRATIC);
}

static void walk_cubic(void *context, int32_t block, int32_t next, int worker) {
    (void)next;
    walk_block(context, block, worker, KERNEL_CUBIC);
}

static void clear_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    const solid *s = context;
    memset(s->diffusion.grid + slot * NODE * BLOCK_NODES, 0, NODE * BLOCK_NODES * sizeof(real));
}

/* The sums become planes of φ θ and φ. */
static void average_slot(void *context, int64_t slot, int worker) {
    (void)worker;
    const solid *s = context;
    real sums[BLOCK_NODES * NODE], *grid = s->diffusion.grid + slot * NODE * BLOCK_NODES;
    memcpy(sums, grid, sizeof sums);
    for (int n = 0; n < BLOCK_NODES; n++) {
        const real *sum = sums + NODE * n;
        real whole = sum[3] > 0 ? sum[2] / sum[3] : 0, open = whole * whole * (whole * whole);
        grid[OPEN * BLOCK_NODES + n] = open;
        grid[LEVEL * BLOCK_NODES + n] = sum[1] > 0 ? open * (sum[0] / sum[1]) : 0;
    }
}

/* θ of a tile's particles towards the means of their nodes; levels[TILE_PARTICLES] Σ w φ θ_i, and Σ w φ in scratch->laplacian. */
static void exchange_tile(const tile_work *w, const real *levels, double interval) {
    const solid *s = w->state;
    const real *c = constants_of(s, w->tile);
    const solid_field *theta = &s->fields[s->diffusion.field];
    real share = (real)(interval * rate_of(s, w->tile)), keep = c[DECAY] > 0 ? (real)exp(-(double)c[DECAY] * interval) : 1;
    for (int k = 0; k < w->tile->pack_count; k++)
        for (int part = 0; part < PACK_PARTS; part++) {
            int32_t pack = w->tile->first_pack + k;
            vec own = vec_load(field_at(theta, pack, 0, part)), left = 1 - damage_of(s, w->tile, pack, part);
            vec level = vec_load(levels + k * PACK + part * VEC_LANES), open = vec_load(scratch_at(w->scratch->laplacian, 1, k, 0, part));
            vec pace = scaled_down(s, s->density_scale, pack, part, share * left * left);
            vec_store(field_at(theta, pack, 0, part), vec_fma(pace, vec_fma(-open, own, level), own) * keep);
        }
}

/* Σ w of a plane of the block's nodes at the tile's particles, whose records hold their weights: out[TILE_PARTICLES]. */
static void gather_plane(const tile_work *w, const solid_block *b, real *window, int plane, real *out) {
    const solid *s = w->state;
    int nodes = s->definition.laplacian == KERNEL_QUADRATIC ? 3 : 4;
    exchange_window(b, window, s->diffusion.grid + plane * BLOCK_NODES, 1, NODE * BLOCK_NODES, is_wide(s), false);
    for (int p = 0; p < w->tile->pack_count * PACK; p++) {
        const real *r = w->scratch->records + p * RECORD;
        out[p] = p < w->tile->count ? mean_at(r, nodes, window + (int)r[G2P_NODE]) : 0;
    }
}

static void return_block(void *context, int64_t index, int worker) {
    const walk_context *c = context;
    solid *s = c->state;
    const solid_block *b = &s->blocks[index];
    solid_worker *own = &s->workers[worker];
    real *window = own->implicit_window, levels[TILE_PARTICLES];
    memset(window, 0, WINDOW_NODES * sizeof *window);
    for (int32_t t = b->first_tile; t < b->first_tile + b->tile_count; t++) {
        tile_work w = {.state = s, .tile = &s->tiles[t], .scratch = &own->tile};
        if (!takes_part(s, w.tile)) continue;
        if (c->to > c->from) {
            kernel_records(s, w.tile, 0, w.tile->pack_count, own->tile.records, s->definition.laplacian);
            gather_plane(&w, b, window, LEVEL, levels);
            gather_plane(&w, b, window, OPEN, own->tile.laplacian);
            exchange_tile(&w, levels, c->to - c->from);
        }
        feed_tile(s, w.tile, c->from, c->to);
    }
}

/* What θ acts on is brought up to date. */
static void feel_tile(void *context, int64_t t, int worker) {
    solid *s = context;
    tile_work w = {.state = s, .tile = &s->tiles[t], .scratch = &s->workers[worker].tile};
    for (int e = 0; e < s->effect_count; e++) {
        if (!(s->material_mask[w.tile->material] >> e & 1) || !s->effects[e]->stages->feel) continue;
        w.constants = s->constants[w.tile->material][e];
        s->effects[e]->stages->feel(&w);
    }
}

static void feel_all(solid *s) {
    parallel_for(s->threads, s->tile_count, 8, feel_tile, s);
}

static void bring_to(solid *s, double time) {
    solid_diffusion *d = &s->diffusion;
    walk_context c = {s, d->until, time};
    if (time > d->until) {
        parallel_for(s->threads, s->slot_count, 64, clear_slot, s);
        colours_pass(s, s->definition.laplacian == KERNEL_CUBIC ? walk_cubic : walk_quadratic, &c);
        parallel_for(s->threads, s->slot_count, 64, average_slot, s);
    }
    parallel_for(s->threads, s->block_count, 4, return_block, &c);
    d->until = time;
    feel_all(s);
}

/* As late as the limit allows: before the step would exceed its share. */
static status before(solid *s, real dt, report *r) {
    (void)r;
    solid_diffusion *d = &s->diffusion;
    if (d->clock > d->until && (d->clock + (double)dt - d->until) * d->rate > SHARE_OF_LIMIT) bring_to(s, d->clock);
    d->clock += (double)dt;
    return STATUS_OK;
}

status diffusion_settle(solid *s, double time, report *r) {
    solid_diffusion *d = &s->diffusion;
    if (d->field < 0) return STATUS_OK;
    status code = s->sorted ? STATUS_OK : particles_sort(s, r);
    if (code == STATUS_OK) bring_to(s, time);
    d->clock = time;
    return code;
}

void diffusion_feed(solid *s, const source_feed *feeds) {
    for (int k = 0; k < s->definition.source_count; k++) s->diffusion.feeds[k] = feeds ? feeds[k] : (source_feed){.strength = 1};
}

/* The fastest exchange, and the unit of weights: only their ratios matter. */
void diffusion_refresh(solid *s) {
    double fastest = 0, most = 0, cell = s->definition.dx * s->definition.dx * s->definition.dx;
    for (int32_t t = 0; s->diffusion.field >= 0 && t < s->tile_count; t++) {
        const solid_tile *tile = &s->tiles[t];
        if (!takes_part(s, tile)) continue;
        const real *c = constants_of(s, tile);
        for (int32_t p = 0; p < (s->density_scale > 0 ? tile->count : 1); p++)
            fastest = fmax(fastest, rate_of(s, tile) / scale_of(s, s->density_scale, tile->first_pack + p / PACK, p % PACK));
        most = fmax(most, (double)c[CONDUCTIVITY]);
    }
    s->diffusion.rate = fastest;
    s->diffusion.unit = (real)(most > 0 ? 1 / (most * cell) : 0);
    s->limits[EFFECT_diffusion] = fastest;
    if (s->diffusion.field >= 0) feel_all(s);
}

/* What softening is to work on, everywhere; θ; what is held from the start. */
void diffusion_start(solid *s) {
    if (s->diffusion.field < 0) return;
    for (int32_t t = 0; t < s->tile_count; t++) {
        const solid_tile *tile = &s->tiles[t];
        for (int32_t p = 0; p < tile->pack_count * PACK; p++) {
            int32_t pack = tile->first_pack + p / PACK;
            if (takes_part(s, tile)) field_at(&s->fields[s->diffusion.field], pack, 0, 0)[p % PACK] = constants_of(s, tile)[INITIAL];
            if (s->stiffness_scale != s->given_stiffness)
                field_at(&s->fields[s->stiffness_scale], pack, 0, 0)[p % PACK] = (real)scale_of(s, s->given_stiffness, pack, p % PACK);
            if (s->toughness_scale != s->given_toughness)
                field_at(&s->fields[s->toughness_scale], pack, 0, 0)[p % PACK] = (real)scale_of(s, s->given_toughness, pack, p % PACK);
        }
    }
    diffusion_feed(s, s->definition.feeds);
    bring_to(s, 0);
}

double diffusion_capacity(const solid *s, const solid_tile *tile) {
    return takes_part(s, tile) ? (double)constants_of(s, tile)[HEAT] : 0;
}

/* ---- the table --------------------------------------------------------------------------------------------------- */

static const parameter parameters[KEY_COUNT] = {
    [KEY_K] = {.key = "k", .unit = "mass length/time^3", .doc = "conductivity: flux for a gradient of 1, in the units of rho C", .minimum = 0, .maximum = 1e18,
               .fallback = {0.01}, .live = true, .logarithmic = true, .required = true},
    [KEY_C] = {.key = "C", .unit = "1", .doc = "capacity of a mass", .minimum = 1e-12, .maximum = 1e18, .fallback = {1}, .live = true,
               .logarithmic = true},
    [KEY_DECAY] = {.key = "decay", .unit = "1/time", .doc = "rate at which the quantity is lost everywhere", .maximum = 1e9, .live = true},
    [KEY_INITIAL] = {.key = "initial", .unit = "1", .doc = "its value everywhere at the start", .minimum = -1e12, .maximum = 1e12,
                     .why_not = "the start is over"},
};

static const effect_field fields[] = {
    {.key = "diffused", .components = 1, .unit = "1", .written = true, .doc = "the quantity that diffuses: temperature, moisture, acid"},
};

static const effect_measure measures[] = {
    {"diffused_total", "mass", "sum of rho C V theta"},
};

static const solid_stages stages = {.constants = constants, .before = before};

const effect SOLID_EFFECT(diffusion) = {
    .name = "diffusion", .engine = ENGINE_SOLID, .scope = SCOPE_MATERIAL, .doc = "a quantity spreads through the body",
    .reference = "METHOD.md section 6 (beyond the papers)", .parameters = parameters, .parameter_count = KEY_COUNT, .fields = fields,
    .field_count = 1, .measures = measures, .measure_count = 1, .needs = ELASTICITY, .stages = &stages,
};
