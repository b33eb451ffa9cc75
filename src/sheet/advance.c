/* What happens to particles once their bonds have pulled: gravity, drag, grips, colliders, and the way to new places. */
#include "base/threads.h"
#include "sheet/state.h"

#include <math.h>

typedef struct pack_context {
    sheet *state;
    double dt;
    int first_level; /* levels that are due: this and above; −1: all packs take one step */
    int32_t count;
    void (*stage)(const pack_work *w);
} pack_context;

static void visit_pack(const pack_context *c, int32_t p, group_result *result) {
    sheet *s = c->state;
    pack_work w = {.state = s, .pack = p, .body = &s->bodies[s->packs[p].body], .dt = (real)c->dt, .way = (real)c->dt, .due = true,
                   .stiffening = &result->stiffening, .result = result};
    c->stage(&w);
}

/* Steps of a pack's level and of its reach; within the level's, only its bonds to faster packs are due. */
static void visit_due_pack(const pack_context *c, int32_t p, group_result *result) {
    sheet *s = c->state;
    pack_rates *t = s->rates;
    int level = t->level[p];
    bool due = level >= c->first_level;
    pack_work w = {.state = s, .pack = p, .body = &s->bodies[s->packs[p].body], .dt = (real)ldexp(c->dt, -level), .way = (real)ldexp(c->dt, -t->reach[p]),
                   .due = due, .sifted = t->reach[p] > level, .share = {due ? 1 : 0, (real)0.5}, .stiffening = &t->stiffening[p], .result = result};
    c->stage(&w);
}

static void visit_group(void *context, int64_t group, int worker) {
    (void)worker;
    const pack_context *c = context;
    sheet *s = c->state;
    int32_t last = (int32_t)(group + 1) * GROUP_PACKS;
    for (int32_t k = (int32_t)group * GROUP_PACKS; k < last && k < c->count; k++) {
        if (c->first_level < 0) visit_pack(c, k, &s->results[group]);
        else visit_due_pack(c, s->rates->order[k], &s->results[group]);
    }
}

void sheet_for_packs(sheet *s, real dt, void (*stage)(const pack_work *w)) {
    pack_context c = {.state = s, .dt = (double)dt, .first_level = -1, .count = s->pack_count, .stage = stage};
    parallel_for(s->threads, s->group_count, 4, visit_group, &c);
}

void sheet_for_due(sheet *s, double dt, int part, void (*stage)(const pack_work *w)) {
    const pack_rates *t = s->rates;
    if (!t) {
        sheet_for_packs(s, (real)dt, stage);
        return;
    }
    int level = part == 0 ? 0 : t->finest - __builtin_ctz((unsigned)part);
    pack_context c = {.state = s, .dt = dt, .first_level = level, .count = t->active[level], .stage = stage};
    parallel_for(s->threads, (c.count + GROUP_PACKS - 1) / GROUP_PACKS, 4, visit_group, &c);
}

void sheet_break_bonds(const pack_work *w, int64_t first, unsigned lanes) {
    sheet *s = w->state;
    if (s->rates) s->rates->cracked[w->pack] = s->rates->step;
    for (int i = 0; i < VEC_LANES; i++) {
        if (!(lanes >> i & 1)) continue;
        s->stiffness[first + i] = 0;
        s->history[first + i] = BROKEN;
        if (s->conduct) s->conduct[first + i] = 0;
        if (s->dilation) s->dilation[first + i] = 0;
        if (s->laplace) s->laplace[first + i] = 0;
        w->result->broken++;
    }
}

/* ---- boundaries -------------------------------------------------------------------------------------------------- */

/* A grip takes the particles that are inside when it starts and keeps them until it stops; they move with it, wherever it goes. */
void sheet_take_hold(sheet *s) {
    for (int g = 0; g < s->definition.boundary_count; g++) {
        const rigid_boundary *b = &s->definition.boundaries[g];
        if (!b->grip || b->motion.active == s->was_active[g]) continue;
        s->was_active[g] = b->motion.active;
        for (int64_t i = 0; i < s->count; i++) {
            int64_t at = s->place[i];
            const real *node = s->node + at * NODE;
            double x[3] = {coordinate_of(node, 0), coordinate_of(node, 1), coordinate_of(node, 2)}, rest[3];
            if (!b->motion.active) {
                if (s->holder[at] == g + 1) s->holder[at] = 0;
                continue;
            }
            rigid_motion_to_rest(&b->motion, x, rest);
            if (shape_distance(b->shape, rest) < 0) s->holder[at] = (uint8_t)(g + 1);
        }
    }
}

static void set_velocity(const pack_work *w, int lane, const double u[3], const double v[3]) {
    sheet *s = w->state;
    double mass = (double)s->area[(int64_t)w->pack * PACK + lane] * w->body->surface_density;
    for (int c = 0; c < 3; c++) {
        real *own = s->velocity + ((int64_t)w->pack * 3 + c) * PACK + lane;
        double impulse = mass * (v[c] - (double)*own);
        w->result->grip_impulse[c] += impulse;
        w->result->grip_work += impulse * u[c];
        *own = (real)v[c];
    }
}

static void place_of(const pack_work *w, int lane, double x[3]) {
    const real *node = node_at(w->state, w->pack, lane);
    for (int c = 0; c < 3; c++) x[c] = coordinate_of(node, c);
}

static void move_held(const pack_work *w) {
    const sheet *s = w->state;
    for (int lane = 0; lane < s->packs[w->pack].count; lane++) {
        int holder = s->holder[(int64_t)w->pack * PACK + lane];
        if (!holder) continue;
        double x[3], u[3];
        place_of(w, lane, x);
        rigid_motion_velocity(&s->definition.boundaries[holder - 1].motion, x, u);
        set_velocity(w, lane, u, u);
    }
}

/* A sphere around a pack: colliders further off than its radius touch none of it. */
static double pack_reach(const pack_work *w, double center[3]) {
    int count = w->state->packs[w->pack].count;
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, x[3], square = 0;
    for (int lane = 0; lane < count; lane++) {
        place_of(w, lane, x);
        for (int c = 0; c < 3; c++) low[c] = fmin(low[c], x[c]), high[c] = fmax(high[c], x[c]);
    }
    for (int c = 0; c < 3; c++) {
        center[c] = 0.5 * (low[c] + high[c]);
        square += 0.25 * (high[c] - low[c]) * (high[c] - low[c]);
    }
    return sqrt(square);
}

static void collide(const pack_work *w) {
    const sheet *s = w->state;
    double center[3], rest[3], x[3], u[3], v[3], normal[3], reach = -1;
    double h = 1e-3 * s->definition.bodies[s->packs[w->pack].body].spacing;
    for (int k = 0; k < s->definition.boundary_count; k++) {
        const rigid_boundary *b = &s->definition.boundaries[k];
        if (b->grip || !b->motion.active) continue;
        if (reach < 0) reach = pack_reach(w, center);
        rigid_motion_to_rest(&b->motion, center, rest);
        if (shape_distance(b->shape, rest) > reach) continue;
        for (int lane = 0; lane < s->packs[w->pack].count; lane++) {
            place_of(w, lane, x);
            rigid_motion_to_rest(&b->motion, x, rest);
            if (s->holder[(int64_t)w->pack * PACK + lane] || shape_distance(b->shape, rest) >= 0) continue;
            for (int c = 0; c < 3; c++) v[c] = (double)s->velocity[((int64_t)w->pack * 3 + c) * PACK + lane];
            rigid_motion_velocity(&b->motion, x, u);
            (void)rigid_boundary_velocity(b, rest, h, u, v, normal);
            set_velocity(w, lane, u, v);
        }
    }
}

/* ---- positions --------------------------------------------------------------------------------------------------- */

/* The first of these lanes that has run away, or whose θ is not finite. */
__attribute__((cold)) static void find_fault(const pack_work *w, int first, unsigned near) {
    if (w->result->fault) return;
    for (int i = 0; i < VEC_LANES; i++) {
        if ((near >> i & 1) && isfinite((double)node_at(w->state, w->pack, first + i)[3])) continue;
        w->result->fault = w->pack * PACK + first + i + 1;
        return;
    }
}

/* high + low + step, with high the rounded sum: the error of the addition is kept (Knuth's two-sum). θ and the 0 beside the low parts take a step of 0.
 * Returns 0 where all is finite, else NaN. */
SIMD_INLINE vec move_quads(real *node, const vec step[4]) {
    vec high[4], low[4], finite = vec_all(0);
    quad_load(node, NODE, high);
    quad_load(node + NODE_LOW, NODE, low);
    for (int k = 0; k < 4; k++) {
        vec moved = low[k] + step[k], sum = high[k] + moved, back = sum - high[k];
        low[k] = (high[k] - (sum - back)) + (moved - back);
        high[k] = sum;
        finite = finite + (sum - sum);
    }
    quad_store(node, NODE, high);
    quad_store(node + NODE_LOW, NODE, low);
    return finite;
}

/* Padding, which has no area, stays. */
static void move(const pack_work *w) {
    sheet *s = w->state;
    real farthest = (real)(0.5 * s->definition.bodies[s->packs[w->pack].body].spacing);
    vec fastest = vec_all(0);
    for (int part = 0; part < PACK_PARTS; part++) {
        int first = part * VEC_LANES;
        vec step[4], quad[4], way = vec_all(0), speed = vec_all(0);
        vec_mask alive = vec_load(s->area + (int64_t)w->pack * PACK + first) > 0;
        for (int c = 0; c < 3; c++) {
            vec v = vec_load(s->velocity + ((int64_t)w->pack * 3 + c) * PACK + first);
            step[c] = vec_select(alive, v * vec_all(w->way), vec_all(0));
            way = way + step[c] * step[c];
            speed = speed + v * v;
        }
        step[3] = vec_all(0);
        fastest = vec_max(fastest, vec_select(alive, speed, vec_all(0)));
        quad_turn_back(step, quad);
        vec finite = move_quads(node_at(s, w->pack, first), quad);
        vec_mask near = way < farthest * farthest;
        if (vec_any(~near | (finite != 0))) find_fault(w, first, vec_bits(near));
    }
    if (vec_any(fastest > w->result->fastest)) w->result->fastest = vec_largest(fastest);
}

static void change_velocities(const pack_work *w) {
    sheet *s = w->state;
    for (int c = 0; c < 3; c++) {
        real *v = s->velocity + ((int64_t)w->pack * 3 + c) * PACK, step = (real)s->definition.gravity[c] * w->dt;
        if (step == 0) continue;
        for (int i = 0; i < PACK; i++) v[i] += step;
    }
    for (uint32_t left = s->mask; left; left &= left - 1) {
        const sheet_stages *stages = sheet_effect_table[__builtin_ctz(left)]->sheet;
        if (stages->velocity) stages->velocity(w);
    }
}

static void advance_pack(const pack_work *w) {
    if (w->due) change_velocities(w);
    if (w->state->definition.boundary_count) {
        move_held(w);
        collide(w);
    }
    move(w);
}

void sheet_advance(sheet *s, double dt, int part) {
    sheet_for_due(s, dt, part, advance_pack);
}
