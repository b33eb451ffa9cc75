/* Diffusion along bonds: ρ C θ̇_i = κ Σ_j γ*_ij (θ_j − θ_i)/|r⁰|² W_ij A_j, with κ = 4 k/Σ_j W A_j, and sources beside it (sheet paper eq. 25,
 * whose S is printed inside the sum; METHOD.md §6, 8). Its step limit is far above the mechanical one, so it runs every n-th step. */
#include "base/simd_math.h"
#include "base/threads.h"
#include "sheet/state.h"

enum { KEY_K, KEY_C, KEY_DECAY, KEY_INITIAL };

static const double SHARE_OF_LIMIT = 0.5;

static void declare(const effect_values *own, sheet_plan *p) {
    p->diffuses = true;
    p->conductivity = own->value[KEY_K][0];
    p->capacity = own->value[KEY_C][0];
    p->decay = own->value[KEY_DECAY][0];
    p->initial = own->value[KEY_INITIAL][0];
}

static void spread(const pack_work *w) {
    sheet *s = w->state;
    const sheet_pack *pack = &s->packs[w->pack];
    real keep = w->body->decay > 0 ? (real)exp(-(double)w->body->decay * (double)w->dt) : 1;
    for (int part = 0; part < PACK_PARTS; part++) {
        int first = part * VEC_LANES;
        int32_t self[VEC_LANES];
        for (int i = 0; i < VEC_LANES; i++) self[i] = w->pack * PACK + first + i;
        vec own = vec_gather(s->node + 3, self, NODE), sum = vec_all(0);
        for (int32_t k = 0; k < pack->slots; k++) {
            int64_t at = ((int64_t)pack->first_slot + k) * PACK + first;
            sum = vec_fma(vec_load(s->conduct + at), vec_gather(s->node + 3, s->neighbour + at, NODE) - own, sum);
        }
        vec_store(s->diffused_next + (int64_t)w->pack * PACK + first, vec_fma(sum, vec_all(w->dt), own) * keep);
    }
}

static void commit(const pack_work *w) {
    const real *next = w->state->diffused_next + (int64_t)w->pack * PACK;
    for (int lane = 0; lane < PACK; lane++) node_at(w->state, w->pack, lane)[3] = next[lane];
}

/* What sources give between two times: rates for the part of the time that they are on, held values where they are on at its end. */
static void apply_sources(sheet *s, double from, double to) {
    for (int k = 0; k < s->definition.source_count; k++) {
        const sheet_source *source = &s->definition.sources[k];
        double on = fmin(to, source->stop) - fmax(from, source->start), strength = s->feeds[k].strength;
        if (s->feeds[k].off) continue;
        if (source->fixed ? !(to >= source->start && to < source->stop) : !(on > 0)) continue;
        for (int64_t i = 0; i < source->count; i++) {
            real *theta = s->node + (int64_t)s->place[source->particle[i]] * NODE + 3;
            *theta = source->fixed ? (real)(strength * source->value[i]) : *theta + (real)(on * (strength * source->value[i]));
        }
    }
}

void sheet_diffuse(sheet *s, double time) {
    double interval = time - s->diffused_until;
    if (!s->conduct || !(interval >= 0)) return;
    if (interval > 0) {
        sheet_for_packs(s, (real)interval, spread);
        sheet_for_packs(s, (real)interval, commit);
    }
    apply_sources(s, s->diffused_until, time);
    if (s->rates) sheet_rates_feel(s);
    s->diffused_until = time;
}

/* As late as the limit allows: before the next step would exceed its share. */
static void after(sheet *s, double time, double dt) {
    if ((time + dt - s->diffused_until) * s->diffusion_bound > SHARE_OF_LIMIT) sheet_diffuse(s, time);
}

static const parameter parameters[] = {
    [KEY_K] = {.key = "k", .unit = "mass length/time^3", .doc = "conductivity: flux for a gradient of 1, in the units of rho C", .minimum = 0, .maximum = 1e18,
               .fallback = {0.01}, .live = true, .logarithmic = true, .required = true},
    [KEY_C] = {.key = "C", .unit = "1", .doc = "capacity of a mass", .minimum = 1e-12, .maximum = 1e18, .fallback = {1}, .live = true,
               .logarithmic = true},
    [KEY_DECAY] = PARAMETER_PLAIN("decay", "1/time", "rate at which the quantity is lost everywhere", 0, 1e9, 0),
    [KEY_INITIAL] = {.key = "initial", .unit = "1", .doc = "its value everywhere at the start", .minimum = -1e12, .maximum = 1e12,
                     .why_not = "the start is over"},
};

static const effect_field fields[] = {
    {"diffused", 1, "1", true, "the quantity that diffuses: temperature, moisture, acid"},
};

static const effect_measure measures[] = {
    {"diffused_total", "mass", "sum of rho C h A theta"},
};

static const sheet_stages stages = {.declare = declare, .after = after};

const effect SHEET_EFFECT(diffusion) = {
    .name = "diffusion", .engine = ENGINE_SHEET, .scope = SCOPE_MATERIAL, .doc = "a quantity spreads along bonds",
    .reference = "sheet paper section 4.3; METHOD.md section 6", .parameters = parameters, .parameter_count = 4, .fields = fields,
    .field_count = 1, .measures = measures, .measure_count = 1, .needs = SHEET_ELASTICITY, .sheet = &stages,
};
