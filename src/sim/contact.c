/* Contact of sheets and solids, by impulses at sheet particles (METHOD.md, end of §6: one scene holding both in contact).
 *
 * Around a sheet particle at x the solid particles within H are seen through W = c (1 − r²/H²)³: the share of the place that is full, ρ = Σ V W, is ½ at a
 * flat surface; −∇ρ points out of it, and (ρ − ½)/|∇ρ| is how deep x lies. The solid's velocity there and its answer to an impulse −J,
 *     u = Σ w_q (v_q + C_q (x − x_q)),   w_q = m_q W_q/Σ m W;   v_q −= w_q J/m_q,   C_q −= w_q J (x − x_q)ᵀ/(m_q D),
 * are adjoint in the metric of the kinetic energy ½ m (|v|² + D |C|²), D the transfer's. So momentum and angular momentum, of which m D ε:C is the
 * affine part, are kept to round-off; and an impulse that stops what approaches, within Coulomb's cone, takes energy away. Sheet particles
 * are gone through once, in order, each seeing what those before it did: the same bits at any number of threads, and no energy from many that
 * share a piece of solid.
 *
 * Outside, the approach may be as fast as closes the gap in this step, so nothing comes to lie deep; what lies within is let out slowly. */
#include "sim/contact.h"

#include "base/memory.h"
#include "base/random.h"

#include <math.h>
#include <string.h>

enum { NEIGHBOURS_MOST = 512 };

static const double REACH = 1.25;      /* H over the grid's spacing */
static const double RECOVERY = 0.01;   /* of the depth, in a step */
static const double LEAST_SLOPE = 0.1; /* of |∇ρ| H: deeper inside there is no telling where out is */

struct sheet_contact {
    int64_t solids, sheets, cells; /* cells: of the table, a power of two */
    double reach, inertia;         /* H; D */
    double *place, *velocity, *affine, *volume, *mass; // of solids: [solids][3], [3], [9], [1], [1]
    double *change;                                    // [solids][12]: of velocity and affine velocity
    double *sheet_place, *sheet_velocity, *sheet_change, *sheet_mass, *held; // [sheets][3], [3], [3], [1], [1]: 1 where a grip has it
    int32_t *head, *next;                              // [cells], [solids]; −1: none
};

/* One sheet particle and the solid around it. */
typedef struct touch {
    int count;
    int32_t near[NEIGHBOURS_MOST];
    double weight[NEIGHBOURS_MOST]; /* m W, then w */
    double full, slope[3];          /* ρ, ∇ρ */
} touch;

/* ---- memory ------------------------------------------------------------------------------------------------------ */

/* Every array: where its address is kept, and its bytes. */
typedef struct contact_array {
    void *address;
    size_t bytes;
} contact_array;

enum { ARRAYS = 13 };

static void list_arrays(sheet_contact *c, contact_array list[ARRAYS]) {
    size_t solids = (size_t)c->solids * sizeof(double), sheets = (size_t)c->sheets * sizeof(double);
    const contact_array all[ARRAYS] = {{&c->place, 3 * solids}, {&c->velocity, 3 * solids}, {&c->affine, 9 * solids}, {&c->volume, solids},
                                       {&c->mass, solids}, {&c->change, 12 * solids}, {&c->sheet_place, 3 * sheets}, {&c->sheet_velocity, 3 * sheets},
                                       {&c->sheet_change, 3 * sheets}, {&c->sheet_mass, sheets}, {&c->held, sheets}, {&c->head, (size_t)c->cells * sizeof *c->head},
                                       {&c->next, (size_t)c->solids * sizeof *c->next}};
    memcpy(list, all, sizeof all);
}

void contact_destroy(sheet_contact *c) {
    contact_array list[ARRAYS];
    if (!c) return;
    list_arrays(c, list);
    for (int i = 0; i < ARRAYS; i++) {
        void *data;
        memcpy(&data, list[i].address, sizeof data);
        memory_free(data, data ? list[i].bytes : 0);
    }
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

sheet_contact *contact_create(const simulation *s) {
    sheet_contact *c = memory_allocate(sizeof *c);
    contact_array list[ARRAYS];
    if (!c) return NULL;
    *c = (sheet_contact){.solids = s->particles.count, .sheets = s->sheet_points.count, .cells = 1024, .reach = REACH * s->particles.dx};
    while (c->cells < c->solids) c->cells *= 2;
    c->inertia = s->particles.dx * s->particles.dx / (s->scene->kernel == KERNEL_QUADRATIC ? 4 : 3);
    list_arrays(c, list);
    for (int i = 0; i < ARRAYS; i++) {
        void *data = memory_allocate(list[i].bytes);
        memcpy(list[i].address, &data, sizeof data);
        if (data) continue;
        contact_destroy(c);
        return NULL;
    }
    find_masses(s, c);
    return c;
}

/* ---- who is near ------------------------------------------------------------------------------------------------- */

static void cell_of(const sheet_contact *c, const double *x, int64_t cell[3]) {
    for (int k = 0; k < 3; k++) cell[k] = (int64_t)floor(x[k] / c->reach);
}

static int64_t slot_of(const sheet_contact *c, const int64_t cell[3]) {
    return (int64_t)(random_mix((uint64_t)cell[0] ^ random_mix((uint64_t)cell[1] ^ random_mix((uint64_t)cell[2]))) & (uint64_t)(c->cells - 1));
}

/* The box that sheets fill, and H around it. */
static void sheet_box(const sheet_contact *c, double low[3], double high[3]) {
    for (int k = 0; k < 3; k++) low[k] = HUGE_VAL, high[k] = -HUGE_VAL;
    for (int64_t i = 0; i < 3 * c->sheets; i++) {
        low[i % 3] = fmin(low[i % 3], c->sheet_place[i] - c->reach);
        high[i % 3] = fmax(high[i % 3], c->sheet_place[i] + c->reach);
    }
}

static bool within(const double *x, const double low[3], const double high[3]) {
    return x[0] > low[0] && x[1] > low[1] && x[2] > low[2] && x[0] < high[0] && x[1] < high[1] && x[2] < high[2];
}

/* Solid particles in the sheets' box, by cell, each cell's ascending; whether there are any. */
static bool fill_cells(sheet_contact *c) {
    double low[3], high[3];
    bool any = false;
    sheet_box(c, low, high);
    memset(c->head, 0xff, (size_t)c->cells * sizeof *c->head);
    for (int64_t q = c->solids - 1; q >= 0; q--) {
        int64_t cell[3];
        if (!within(c->place + 3 * q, low, high)) continue;
        cell_of(c, c->place + 3 * q, cell);
        int64_t slot = slot_of(c, cell);
        c->next[q] = c->head[slot];
        c->head[slot] = (int32_t)q;
        any = true;
    }
    return any;
}

/* Adds what a solid particle is to a place at the distance r from it. */
static void add_neighbour(const sheet_contact *c, int32_t q, const double r[3], touch *t) {
    static const double PI = 3.14159265358979323846;
    double H = c->reach, left = 1 - (r[0] * r[0] + r[1] * r[1] + r[2] * r[2]) / (H * H), unit = 315 / (64 * PI * H * H * H);
    if (left <= 0 || t->count == NEIGHBOURS_MOST) return;
    double W = unit * left * left * left, steep = -6 * unit * left * left / (H * H) * c->volume[q];
    t->full += c->volume[q] * W;
    for (int k = 0; k < 3; k++) t->slope[k] += steep * r[k];
    t->near[t->count] = q;
    t->weight[t->count++] = c->mass[q] * W;
}

static void find_neighbours(const sheet_contact *c, const double *x, touch *t) {
    int64_t middle[3], cell[3], own[3];
    t->count = 0;
    t->full = t->slope[0] = t->slope[1] = t->slope[2] = 0;
    cell_of(c, x, middle);
    for (int n = 0; n < 27; n++) {
        cell[0] = middle[0] + n / 9 - 1, cell[1] = middle[1] + n / 3 % 3 - 1, cell[2] = middle[2] + n % 3 - 1;
        for (int32_t q = c->head[slot_of(c, cell)]; q >= 0; q = c->next[q]) {
            const double *y = c->place + 3 * q, r[3] = {x[0] - y[0], x[1] - y[1], x[2] - y[2]};
            cell_of(c, y, own);
            if (memcmp(own, cell, sizeof own) == 0) add_neighbour(c, q, r, t);
        }
    }
}

/* ---- impulses ---------------------------------------------------------------------------------------------------- */

/* The solid's velocity at x, as it is by now; how much of an impulse there it gives way by; `weight` becomes w. */
static double solid_velocity(const sheet_contact *c, const double *x, touch *t, double u[3]) {
    double sum = 0, mobility = 0;
    for (int i = 0; i < t->count; i++) sum += t->weight[i];
    u[0] = u[1] = u[2] = 0;
    for (int i = 0; i < t->count; i++) {
        int32_t q = t->near[i];
        double w = t->weight[i] /= sum, r[3], square = 0;
        const double *v = c->velocity + 3 * q, *C = c->affine + 9 * q;
        for (int k = 0; k < 3; k++) r[k] = x[k] - c->place[3 * q + k], square += r[k] * r[k];
        for (int k = 0; k < 3; k++) u[k] += w * (v[k] + C[3 * k] * r[0] + C[3 * k + 1] * r[1] + C[3 * k + 2] * r[2]);
        mobility += w * w * (1 + square / c->inertia) / c->mass[q];
    }
    return mobility;
}

/* J on the sheet particle, −J on the solid around it. One that a grip holds does not move, but keeps the impulse until the grip takes it. */
static void exchange(sheet_contact *c, int64_t p, const touch *t, const double J[3]) {
    for (int k = 0; k < 3; k++) {
        c->sheet_velocity[3 * p + k] += (1 - c->held[p]) * J[k] / c->sheet_mass[p];
        c->sheet_change[3 * p + k] += J[k] / c->sheet_mass[p];
    }
    for (int i = 0; i < t->count; i++) {
        int32_t q = t->near[i];
        double share = t->weight[i] / c->mass[q];
        for (int k = 0; k < 3; k++) {
            double step = -share * J[k];
            c->velocity[3 * q + k] += step;
            c->change[12 * q + k] += step;
            for (int l = 0; l < 3; l++) {
                double lean = step * (c->sheet_place[3 * p + l] - c->place[3 * q + l]) / c->inertia;
                c->affine[9 * q + 3 * k + l] += lean;
                c->change[12 * q + 3 + 3 * k + l] += lean;
            }
        }
    }
}

static void stop_particle(sheet_contact *c, int64_t p, double friction, double dt, touch *t) {
    const double *x = c->sheet_place + 3 * p, *v = c->sheet_velocity + 3 * p;
    find_neighbours(c, x, t);
    double slope = sqrt(t->slope[0] * t->slope[0] + t->slope[1] * t->slope[1] + t->slope[2] * t->slope[2]), n[3], u[3], J[3];
    if (!(slope * c->reach > LEAST_SLOPE)) return;
    double depth = (t->full - 0.5) / slope, least = depth > 0 ? RECOVERY * fmin(depth, c->reach) / dt : depth / dt;
    double mobility = solid_velocity(c, x, t, u) + (1 - c->held[p]) / c->sheet_mass[p], along = 0, across = 0;
    for (int k = 0; k < 3; k++) n[k] = -t->slope[k] / slope, along += (v[k] - u[k]) * n[k];
    if (along >= least) return;
    double push = (least - along) / mobility;
    for (int k = 0; k < 3; k++) {
        double slip = v[k] - u[k] - along * n[k];
        J[k] = slip;
        across += slip * slip;
    }
    across = sqrt(across);
    double hold = across > 0 ? fmin(1 / mobility, friction * push / across) : 0;
    for (int k = 0; k < 3; k++) J[k] = push * n[k] - hold * J[k];
    exchange(c, p, t, J);
}

void contact_apply(simulation *s, double dt) {
    sheet_contact *c = s->contact;
    touch t;
    s->engine->read(s->solid, "position", c->place);
    s->sheets->read(s->sheet, "position", c->sheet_place);
    if (!fill_cells(c)) return;
    s->engine->read(s->solid, "velocity", c->velocity);
    s->engine->read(s->solid, "affine_velocity", c->affine);
    s->sheets->read(s->sheet, "velocity", c->sheet_velocity);
    s->sheets->read(s->sheet, "held", c->held);
    memset(c->change, 0, 12 * (size_t)c->solids * sizeof *c->change);
    memset(c->sheet_change, 0, 3 * (size_t)c->sheets * sizeof *c->sheet_change);
    double friction = s->scene->effects[effect_index("contact")].value[0][0];
    for (int64_t p = 0; p < c->sheets; p++) stop_particle(c, p, friction, dt, &t);
    s->engine->push(s->solid, c->change);
    s->sheets->push(s->sheet, c->sheet_change);
}
