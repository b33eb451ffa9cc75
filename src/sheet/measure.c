/* What a frame reports: sums in f64, group by group, added in order; and fields in order of id. */
#include "base/memory.h"
#include "base/threads.h"
#include "sheet/state.h"

#include <math.h>

/* ---- bonds ------------------------------------------------------------------------------------------------------- */

static bool is_bond(const sheet *s, int32_t pack, int lane, int64_t at) {
    return s->neighbour[at] != pack * PACK + lane;
}

static bool is_broken(const sheet *s, int64_t at) {
    return s->history && s->history[at] == BROKEN;
}

static double theta_of(const sheet *s, int64_t place) {
    return (double)s->node[place * NODE + 3];
}

static bond_state examine_bond(const sheet *s, const body_constants *b, int64_t place, int64_t at) {
    const real *own = s->node + place * NODE, *far = s->node + (int64_t)s->neighbour[at] * NODE;
    double square = 0;
    for (int c = 0; c < 3; c++) {
        double r = ((double)far[c] - (double)own[c]) + ((double)far[NODE_LOW + c] - (double)own[NODE_LOW + c]);
        square += r * r;
    }
    bond_state bond = {.s = sqrt(square) * (double)s->inverse[at], .history = s->history ? (double)s->history[at] : 0};
    double theta = 0.5 * (theta_of(s, place) + theta_of(s, s->neighbour[at]));
    bond.swelling = (double)b->alpha * theta;
    bond.left = fmax(1 - (double)b->stiffness_loss * theta, (double)b->floor);
    bond.strain = bond.s - 1 - (b->total ? 0 : bond.swelling);
    return bond;
}

/* Half the energy of a bond, which both its ends count: A_i (c W A_j) ψ/2, with c W A_j from the stiffness. */
static double bond_energy(const sheet *s, const body_constants *b, int64_t place, int64_t at, const bond_state *bond) {
    double modulus = (double)s->stiffness[at] * bond->left * b->surface_density / (double)s->inverse[at];
    return 0.5 * (double)s->area[place] * modulus * sheet_effect_table[b->law_effect]->sheet->stored(b->law, bond);
}

static void measure_bonds(const sheet *s, int32_t p, int lane, sheet_measures *m) {
    const sheet_pack *pack = &s->packs[p];
    const body_constants *b = &s->bodies[pack->body];
    int64_t place = (int64_t)p * PACK + lane;
    int total = 0, broken = 0;
    double dilatation = 0;
    for (int32_t k = 0; k < pack->slots; k++) {
        int64_t at = ((int64_t)pack->first_slot + k) * PACK + lane;
        if (!is_bond(s, p, lane, at)) continue;
        total++;
        if (is_broken(s, at)) {
            broken++;
            continue;
        }
        bond_state bond = examine_bond(s, b, place, at);
        m->stretch_max = fmax(m->stretch_max, bond.s - 1);
        m->elastic += bond_energy(s, b, place, at, &bond);
        if (s->dilation) dilatation += (double)s->dilation[at] * sqrt(bond.left) * (bond.s - 1 - bond.swelling) * s->weight_sum[place];
    }
    for (int e = 0; e < SHEET_EFFECTS; e++)
        if ((s->mask >> e & 1) && sheet_effect_table[e]->sheet->energy) m->elastic += sheet_effect_table[e]->sheet->energy(s, p, lane);
    m->elastic += 0.5 * b->dilation_modulus * dilatation * dilatation * (double)s->area[place];
    double share = total ? (double)broken / total : 0;
    m->bonds_total += total;
    m->bonds_broken += broken;
    m->broken_mean += share;
    m->broken_max = fmax(m->broken_max, share);
    int bin = (int)(share * SHEET_BINS);
    m->histogram[bin < SHEET_BINS ? bin : SHEET_BINS - 1] += 1;
}

/* ---- particles --------------------------------------------------------------------------------------------------- */

static void measure_particle(const sheet *s, int32_t p, int lane, sheet_measures *m) {
    const body_constants *b = &s->bodies[s->packs[p].body];
    int64_t place = (int64_t)p * PACK + lane;
    double area = (double)s->area[place], mass = area * b->surface_density, x[3], v[3], square = 0, theta = theta_of(s, place);
    for (int c = 0; c < 3; c++) {
        x[c] = coordinate_of(node_at(s, p, lane), c);
        v[c] = (double)s->velocity[((int64_t)p * 3 + c) * PACK + lane];
        square += v[c] * v[c];
        m->momentum[c] += mass * v[c];
        m->gravitational -= mass * s->definition.gravity[c] * x[c];
    }
    m->mass += mass;
    m->kinetic += 0.5 * mass * square;
    m->angular_momentum[0] += mass * (x[1] * v[2] - x[2] * v[1]);
    m->angular_momentum[1] += mass * (x[2] * v[0] - x[0] * v[2]);
    m->angular_momentum[2] += mass * (x[0] * v[1] - x[1] * v[0]);
    m->speed_max = fmax(m->speed_max, sqrt(square));
    m->diffused_total += area * b->heat * theta;
    m->diffused_min = fmin(m->diffused_min, theta);
    m->diffused_max = fmax(m->diffused_max, theta);
}

static const sheet_measures nothing = {.diffused_min = HUGE_VAL, .diffused_max = -HUGE_VAL, .stretch_max = -HUGE_VAL};

typedef struct measure_context {
    const sheet *state;
    sheet_measures *parts; // [group_count]
} measure_context;

static void measure_group(void *context, int64_t group, int worker) {
    (void)worker;
    const measure_context *c = context;
    const sheet *s = c->state;
    sheet_measures m = nothing;
    int32_t last = (int32_t)(group + 1) * GROUP_PACKS;
    for (int32_t p = (int32_t)group * GROUP_PACKS; p < last && p < s->pack_count; p++)
        for (int lane = 0; lane < s->packs[p].count; lane++) {
            measure_particle(s, p, lane, &m);
            measure_bonds(s, p, lane, &m);
        }
    c->parts[group] = m;
}

static void add_part(sheet_measures *m, const sheet_measures *part) {
    m->mass += part->mass;
    for (int c = 0; c < 3; c++) {
        m->momentum[c] += part->momentum[c];
        m->angular_momentum[c] += part->angular_momentum[c];
    }
    m->kinetic += part->kinetic;
    m->elastic += part->elastic;
    m->gravitational += part->gravitational;
    m->bonds_total += part->bonds_total;
    m->bonds_broken += part->bonds_broken;
    m->broken_mean += part->broken_mean;
    m->broken_max = fmax(m->broken_max, part->broken_max);
    for (int i = 0; i < SHEET_BINS; i++) m->histogram[i] += part->histogram[i];
    m->diffused_total += part->diffused_total;
    m->diffused_min = fmin(m->diffused_min, part->diffused_min);
    m->diffused_max = fmax(m->diffused_max, part->diffused_max);
    m->stretch_max = fmax(m->stretch_max, part->stretch_max);
    m->speed_max = fmax(m->speed_max, part->speed_max);
}

status sheet_measure(const sheet *s, sheet_measures *m, report *r) {
    size_t bytes = (size_t)s->group_count * sizeof *m;
    measure_context c = {s, memory_allocate(bytes)};
    if (!c.parts) return report_set(r, STATUS_SYSTEM, "out of memory for the measures of a sheet");
    parallel_for(s->threads, s->group_count, 4, measure_group, &c);
    *m = nothing;
    for (int32_t g = 0; g < s->group_count; g++) add_part(m, &c.parts[g]);
    memory_free(c.parts, bytes);
    m->bonds_total /= 2; /* both ends have counted it */
    m->bonds_broken /= 2;
    m->broken_mean /= (double)s->count;
    for (int i = 0; i < SHEET_BINS; i++) m->histogram[i] /= (double)s->count;
    if (m->stretch_max == -HUGE_VAL) m->stretch_max = 0;
    m->grip_work = s->grip_work;
    memcpy(m->grip_impulse, s->grip_impulse, sizeof m->grip_impulse);
    return STATUS_OK;
}

/* ---- fields ------------------------------------------------------------------------------------------------------ */

static double broken_share(const sheet *s, int64_t place) {
    int32_t p = (int32_t)(place / PACK);
    int lane = (int)(place % PACK), total = 0, broken = 0;
    for (int32_t k = 0; k < s->packs[p].slots; k++) {
        int64_t at = ((int64_t)s->packs[p].first_slot + k) * PACK + lane;
        if (!is_bond(s, p, lane, at)) continue;
        total++;
        broken += is_broken(s, at);
    }
    return total ? (double)broken / total : 0;
}

enum { READ_POSITION, READ_VELOCITY, READ_AREA, READ_BROKEN, READ_DIFFUSED };

static int find_field(const sheet *s, const char *name) {
    static const char *const names[] = {"position", "velocity", "area", "broken", "diffused"};
    for (int i = 0; i < 5; i++)
        if (strcmp(names[i], name) == 0) return (i == READ_BROKEN && !s->history) || (i == READ_DIFFUSED && !s->conduct) ? -1 : i;
    return -1;
}

int sheet_read(const sheet *s, const char *name, double *out) {
    int field = find_field(s, name), count = field == READ_POSITION || field == READ_VELOCITY ? 3 : 1;
    if (field < 0) return 0;
    for (int64_t i = 0; out && i < s->count; i++) {
        int64_t place = s->place[i], pack = place / PACK, lane = place % PACK;
        for (int c = 0; c < count; c++) {
            double *to = out + i * count + c;
            if (field == READ_POSITION) *to = coordinate_of(s->node + place * NODE, c);
            else if (field == READ_VELOCITY) *to = (double)s->velocity[(pack * 3 + c) * PACK + lane];
            else if (field == READ_AREA) *to = (double)s->area[place];
            else *to = field == READ_BROKEN ? broken_share(s, place) : theta_of(s, place);
        }
    }
    return count;
}

int64_t sheet_bonds(const sheet *s, int32_t *pairs, uint8_t *broken) {
    int64_t count = 0;
    for (int64_t i = 0; i < s->count; i++) {
        int32_t place = s->place[i], p = place / PACK;
        for (int32_t k = 0; k < s->packs[p].slots; k++) {
            int64_t at = ((int64_t)s->packs[p].first_slot + k) * PACK + place % PACK;
            int32_t other = s->id[s->neighbour[at]];
            if (!is_bond(s, p, place % PACK, at) || other < i) continue;
            if (pairs) pairs[2 * count] = (int32_t)i, pairs[2 * count + 1] = other;
            if (broken) broken[count] = is_broken(s, at);
            count++;
        }
    }
    return count;
}
