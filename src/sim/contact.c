/* Contact of sheets and solids, by impulses at sheet particles (METHOD.md, end of §6: one scene holding both in contact).
 *
 * Around a sheet particle at x the solid particles within H are seen through W = c (1 − r²/H²)³: the share of the place that is full, ρ = Σ V W, is ½ at a
 * flat surface; −∇ρ points out of it, and (ρ − ½)/|∇ρ| is how deep x lies. The solid's velocity there and its answer to an impulse −J,
 *     u = Σ w_q (v_q + C_q (x − x_q)),   w_q = m_q W_q/Σ m W;   v_q −= w_q J/m_q,   C_q −= w_q J (x − x_q)ᵀ/(m_q D),
 * are adjoint in the metric of the kinetic energy ½ m (|v|² + D |C|²), D the transfer's. So momentum and angular momentum, of which m D ε:C is the
 * affine part, are kept to round-off; and an impulse that stops what approaches, within Coulomb's cone, takes energy away. Each sheet particle
 * sees what those before it did: no energy comes from many that share a piece of solid. Groups of them that share none go side by side, so the same
 * bits come at any number of threads.
 *
 * Outside, the approach may be as fast as closes the gap in this step, so nothing comes to lie deep; what lies within is let out slowly. Being impulses, not
 * springs, they have no stiffness, and need no step shorter than those of what they join. */
#include "sim/contact.h"

#include "base/memory.h"
#include "base/threads.h"
#include "sim/contact_near.h"

#include <math.h>
#include <string.h>

static const double REACH = 1.25;      /* H over the grid's spacing */
static const double RECOVERY = 0.01;   /* of the depth, in a step */
static const double ESCAPE = 0.025;    /* of the speed of the solid's waves: the most that recovery may be */
static const double LEAST_SLOPE = 0.1; /* of |∇ρ| H: deeper inside there is no telling where out is */

/* A worker's hands: the solid particles around a group, and of those the ones around one sheet particle. */
typedef struct contact_hands {
    int32_t capacity, around, count;
    int32_t *which;    // [capacity], indices of the near solids, of those around
    double *place;     // [3][capacity], theirs
    double *left;      // [capacity], 1 − r²/H² of those from one particle
    int32_t *near;     // [capacity], of those around one particle, again by index of the near solids
    double *weight;    // [capacity], m W, then w
} contact_hands;

struct sheet_contact {
    contact_near near;
    double inertia;                // D
    int64_t solids, sheets;
    double *volume, *mass;         // [solids], by id
    double *sheet_mass;            // [sheets], by id
    double (*change)[SHEET_PACK][3]; // [packs], of sheets' velocities
    int threads;
    contact_hands *hands;          // [threads]
};

/* What one sheet particle sees of the solid. */
typedef struct touch {
    double full, slope[3]; /* ρ, ∇ρ */
    double velocity[3];    /* u */
    double mobility;       /* by how much it gives way to an impulse */
} touch;

/* ---- memory ------------------------------------------------------------------------------------------------------ */

static void free_hands(contact_hands *h) {
    size_t capacity = (size_t)h->capacity;
    memory_free(h->which, capacity * sizeof *h->which);
    memory_free(h->place, 3 * capacity * sizeof *h->place);
    memory_free(h->left, capacity * sizeof *h->left);
    memory_free(h->near, capacity * sizeof *h->near);
    memory_free(h->weight, capacity * sizeof *h->weight);
    *h = (contact_hands){0};
}

/* What is in them is lost. */
static bool reserve_hands(contact_hands *h, int32_t need) {
    if (need <= h->capacity) return true;
    free_hands(h);
    h->capacity = need + need / 2 + 64;
    h->which = memory_allocate_array((size_t)h->capacity, sizeof *h->which);
    h->place = memory_allocate_array((size_t)h->capacity, 3 * sizeof *h->place);
    h->left = memory_allocate_array((size_t)h->capacity, sizeof *h->left);
    h->near = memory_allocate_array((size_t)h->capacity, sizeof *h->near);
    h->weight = memory_allocate_array((size_t)h->capacity, sizeof *h->weight);
    if (h->which && h->place && h->left && h->near && h->weight) return true;
    free_hands(h);
    return false;
}

void contact_destroy(sheet_contact *c) {
    if (!c) return;
    for (int t = 0; c->hands && t < c->threads; t++) free_hands(&c->hands[t]);
    memory_free(c->hands, (size_t)c->threads * sizeof *c->hands);
    memory_free(c->volume, (size_t)c->solids * sizeof *c->volume);
    memory_free(c->mass, (size_t)c->solids * sizeof *c->mass);
    memory_free(c->sheet_mass, (size_t)c->sheets * sizeof *c->sheet_mass);
    memory_free(c->change, (size_t)c->near.pack_count * sizeof *c->change);
    contact_near_free(&c->near);
    memory_free(c, sizeof *c);
}

static void find_masses(const simulation *s, sheet_contact *c) {
    const scene *from = s->scene;
    s->engine->read(s->solid, "volume", c->volume);
    if (!s->engine->read(s->solid, "density_scale", c->mass))
        for (int64_t i = 0; i < c->solids; i++) c->mass[i] = 1;
    for (int64_t i = 0; i < c->solids; i++) c->mass[i] *= c->volume[i] * from->materials[from->bodies[s->particles.body[i]].material].density;
    for (int64_t i = 0; i < c->sheets; i++) {
        const scene_sheet *b = &from->sheets[s->sheet_points.sheet[i]];
        c->sheet_mass[i] = s->sheet_points.area[i] * b->thickness * from->materials[b->material].density;
    }
}

sheet_contact *contact_create(const simulation *s, int threads) {
    sheet_contact *c = memory_allocate(sizeof *c);
    if (!c) return NULL;
    c->solids = s->particles.count, c->sheets = s->sheet_points.count, c->threads = threads > 0 ? threads : 1;
    c->inertia = s->particles.dx * s->particles.dx / (s->scene->kernel == KERNEL_QUADRATIC ? 4 : 3);
    bool fits = contact_near_create(&c->near, s, REACH * s->particles.dx, c->threads);
    c->volume = memory_allocate_array((size_t)c->solids, sizeof *c->volume);
    c->mass = memory_allocate_array((size_t)c->solids, sizeof *c->mass);
    c->sheet_mass = memory_allocate_array((size_t)c->sheets, sizeof *c->sheet_mass);
    c->change = memory_allocate_array((size_t)c->near.pack_count, sizeof *c->change);
    c->hands = memory_allocate_array((size_t)c->threads, sizeof *c->hands);
    if (!fits || !c->volume || !c->mass || !c->sheet_mass || !c->change || !c->hands) {
        contact_destroy(c);
        return NULL;
    }
    find_masses(s, c);
    return c;
}

/* ---- who is near ------------------------------------------------------------------------------------------------- */

static void take_surroundings(const sheet_contact *c, const contact_group *g, contact_hands *h) {
    const contact_near *n = &c->near;
    h->around = 0;
    for (int32_t k = 0; k < g->near_count; k++)
        for (int32_t q = n->cells[g->near[k]].first; q >= 0; q = n->solid_next[q]) {
            const double *x = n->solid_place[q];
            if (x[0] < g->low[0] || x[1] < g->low[1] || x[2] < g->low[2] || x[0] > g->high[0] || x[1] > g->high[1] || x[2] > g->high[2]) continue;
            for (int axis = 0; axis < 3; axis++) h->place[axis * h->capacity + h->around] = x[axis];
            h->which[h->around++] = q;
        }
}

/* What is left of the reach's square, a few at a time: a loop that a compiler turns into vectors. */
static void measure_distances(const double x[3], double inverse, int32_t count, const double *restrict px, const double *restrict py, const double *restrict pz,
                              double *restrict left) {
    enum { TOGETHER = 8 };
    int32_t i = 0;
    for (; i + TOGETHER <= count; i += TOGETHER)
        for (int k = 0; k < TOGETHER; k++) {
            double a = x[0] - px[i + k], b = x[1] - py[i + k], c = x[2] - pz[i + k];
            left[i + k] = 1 - (a * a + b * b + c * c) * inverse;
        }
    for (; i < count; i++) {
        double a = x[0] - px[i], b = x[1] - py[i], c = x[2] - pz[i];
        left[i] = 1 - (a * a + b * b + c * c) * inverse;
    }
}

/* Leaves m W in the hands, and ρ and ∇ρ in t. */
static void take_neighbours(const sheet_contact *c, const double x[3], contact_hands *h, touch *t) {
    static const double PI = 3.14159265358979323846;
    double H2 = c->near.reach * c->near.reach, unit = 315 / (64 * PI * H2 * c->near.reach);
    const double *place[3] = {h->place, h->place + h->capacity, h->place + 2 * (size_t)h->capacity};
    measure_distances(x, 1 / H2, h->around, place[0], place[1], place[2], h->left);
    *t = (touch){0};
    h->count = 0;
    for (int32_t i = 0; i < h->around; i++) {
        double left = h->left[i];
        if (left <= 0) continue;
        int32_t id = c->near.solid_id[h->which[i]];
        double W = unit * left * left * left, steep = -6 * unit * left * left / H2 * c->volume[id];
        t->full += c->volume[id] * W;
        for (int k = 0; k < 3; k++) t->slope[k] += steep * (x[k] - place[k][i]);
        h->near[h->count] = h->which[i];
        h->weight[h->count++] = c->mass[id] * W;
    }
}

/* ---- impulses ---------------------------------------------------------------------------------------------------- */

/* The solid's velocity at x, as it is by now, and its mobility; the weights become w. */
static void see_solid(const sheet_contact *c, const double x[3], contact_hands *h, touch *t) {
    double sum = 0;
    for (int32_t i = 0; i < h->count; i++) sum += h->weight[i];
    for (int32_t i = 0; i < h->count; i++) {
        int32_t q = h->near[i];
        double w = h->weight[i] /= sum, r[3], square = 0;
        const double *v = c->near.solid_motion[q], *C = v + 3;
        for (int k = 0; k < 3; k++) r[k] = x[k] - c->near.solid_place[q][k], square += r[k] * r[k];
        for (int k = 0; k < 3; k++) t->velocity[k] += w * (v[k] + C[3 * k] * r[0] + C[3 * k + 1] * r[1] + C[3 * k + 2] * r[2]);
        t->mobility += w * w * (1 + square / c->inertia) / c->mass[c->near.solid_id[q]];
    }
}

/* J on the sheet particle, −J on the solid around it. One that a grip holds does not move, but keeps the impulse until the grip takes it. */
static void exchange(sheet_contact *c, int32_t p, const contact_hands *h, const double J[3]) {
    contact_near *n = &c->near;
    double inverse = 1 / c->sheet_mass[n->sheet_id[p]];
    for (int k = 0; k < 3; k++) {
        if (!n->sheet_held[p]) n->sheet_velocity[p][k] += J[k] * inverse;
        c->change[p / SHEET_PACK][p % SHEET_PACK][k] += J[k] * inverse;
    }
    for (int32_t i = 0; i < h->count; i++) {
        int32_t q = h->near[i];
        double share = h->weight[i] / c->mass[n->solid_id[q]], *motion = n->solid_motion[q];
        n->solid_moved[q] = 1;
        for (int k = 0; k < 3; k++) {
            double step = -share * J[k];
            motion[k] += step;
            for (int l = 0; l < 3; l++) motion[3 + 3 * k + l] += step * (n->sheet_place[p][l] - n->solid_place[q][l]) / c->inertia;
        }
    }
}

/* How a step acts. */
typedef struct contact_step {
    sheet_contact *contact;
    simulation *state;
    const int32_t *groups; /* of one colour */
    double friction, dt;
    double escape; /* the largest speed of what lies within on its way out */
} contact_step;

static void stop_particle(const contact_step *step, int32_t p, contact_hands *h) {
    sheet_contact *c = step->contact;
    const double *x = c->near.sheet_place[p], *v = c->near.sheet_velocity[p];
    touch t;
    take_neighbours(c, x, h, &t);
    double slope = sqrt(t.slope[0] * t.slope[0] + t.slope[1] * t.slope[1] + t.slope[2] * t.slope[2]), n[3], J[3];
    if (!(slope * c->near.reach > LEAST_SLOPE)) return;
    double depth = (t.full - 0.5) / slope, least = depth > 0 ? fmin(RECOVERY * depth / step->dt, step->escape) : depth / step->dt;
    see_solid(c, x, h, &t);
    double mobility = t.mobility + (c->near.sheet_held[p] ? 0 : 1 / c->sheet_mass[c->near.sheet_id[p]]), along = 0, across = 0;
    for (int k = 0; k < 3; k++) n[k] = -t.slope[k] / slope, along += (v[k] - t.velocity[k]) * n[k];
    if (along >= least) return;
    double push = (least - along) / mobility;
    for (int k = 0; k < 3; k++) {
        double slip = v[k] - t.velocity[k] - along * n[k];
        J[k] = slip;
        across += slip * slip;
    }
    across = sqrt(across);
    double hold = across > 0 ? fmin(1 / mobility, step->friction * push / across) : 0;
    for (int k = 0; k < 3; k++) J[k] = push * n[k] - hold * J[k];
    exchange(c, p, h, J);
}

/* ---- the step ---------------------------------------------------------------------------------------------------- */

/* However short the steps of a stiff sheet, what it is in is not torn apart by its way out. */
static double escape_speed(const simulation *s) {
    double limit[EFFECT_LIMIT];
    s->engine->limits(s->solid, limit);
    return ESCAPE * s->particles.dx / limit[effect_index("elastic")];
}

static void settle_group(void *context, int64_t i, int worker) {
    const contact_step *step = context;
    sheet_contact *c = step->contact;
    const contact_group *g = &c->near.groups[step->groups[i]];
    contact_hands *h = &c->hands[worker];
    take_surroundings(c, g, h);
    for (int32_t p = g->first; p >= 0 && h->around > 0; p = c->near.sheet_next[p]) stop_particle(step, p, h);
}

static void move_block(void *context, int64_t i, int worker) {
    (void)worker;
    const contact_step *step = context;
    const contact_near *n = &step->contact->near;
    for (int32_t q = n->block_start[i]; q < n->block_start[i + 1]; q++)
        if (n->solid_moved[q]) step->state->engine->touch->move(step->state->solid, n->solid_at[q], n->solid_motion[q]);
}

static void push_pack(void *context, int64_t i, int worker) {
    (void)worker;
    const contact_step *step = context;
    int32_t pack = step->contact->near.near_packs[i];
    step->state->sheets->touch->push(step->state->sheet, pack, step->contact->change[pack]);
}

status contact_apply(simulation *s, double dt, report *r) {
    sheet_contact *c = s->contact;
    contact_step step = {.contact = c, .state = s, .friction = s->scene->effects[effect_index("contact")].value[0][0], .dt = dt, .escape = escape_speed(s)};
    status code = contact_near_find(&c->near, s, r);
    if (code != STATUS_OK || c->near.group_count == 0) return code;
    for (int t = 0; t < c->threads; t++)
        if (!reserve_hands(&c->hands[t], c->near.most)) return report_set(r, STATUS_SYSTEM, "out of memory for contact");
    for (int32_t k = 0; k < c->near.near_pack_count; k++) memset(c->change[c->near.near_packs[k]], 0, sizeof *c->change);
    for (int colour = 0; colour < CONTACT_COLOURS; colour++) {
        step.groups = c->near.order + c->near.colour_start[colour];
        parallel_for(c->threads, c->near.colour_start[colour + 1] - c->near.colour_start[colour], 1, settle_group, &step);
    }
    parallel_for(c->threads, c->near.block_count, 1, move_block, &step);
    parallel_for(c->threads, c->near.near_pack_count, 8, push_pack, &step);
    return STATUS_OK;
}
