/* Steps of each pack: levels, and the order in which packs are due (METHOD.md §6, "Spatial multi-rate").
 *
 * Each bond is an impulse at both its ends at once, at the pace of its faster end, with both ends where they are then: an asynchronous variational
 * integrator (Lew, Marsden, Ortiz, West 2003) whose paces are powers of two. So momentum and angular momentum are kept to round-off, and a
 * sheet whose levels do not change keeps its energy as one that takes single steps does. */
#include "base/memory.h"
#include "sheet/state.h"

#include <math.h>

/* A pack that has cracked, or that asked for less, is asked again after so many steps. */
enum { MEMORY = 16, BINS_AN_OCTAVE = 4, BINS = 512 };

/* A longer step is worth its levels if it saves this share of the bond updates. */
static const double WORTH = 0.02;

/* θ acts where over a pack it changes a stiffness or a limit by this share, or strains its bonds unequally by this. */
static const double ACTS = 0.05, SWELLS = 1e-3;

/* ---- memory ------------------------------------------------------------------------------------------------------ */

typedef struct rate_row {
    void **array;
    size_t count, size;
} rate_row;

enum { RATE_ROWS = 11 };

static void list_rows(pack_rates *t, rate_row rows[RATE_ROWS]) {
    size_t n = (size_t)t->pack_count, near = t->near_start ? (size_t)t->near_start[n] : 0;
    const rate_row all[RATE_ROWS] = {
        {(void **)&t->pace, n, sizeof *t->pace},       {(void **)&t->stiffening, n, sizeof(real)},
        {(void **)&t->coldest, n, sizeof(real)},       {(void **)&t->hottest, n, sizeof(real)},
        {(void **)&t->cracked, n, sizeof *t->cracked},
        {(void **)&t->asked, n, 1},                    {(void **)&t->level, n, 1},
        {(void **)&t->reach, n, 1},                    {(void **)&t->order, n, sizeof *t->order},
        {(void **)&t->near, near, sizeof *t->near},    {(void **)&t->near_start, n + 1, sizeof *t->near_start},
    };
    memcpy(rows, all, sizeof all);
}

void sheet_rates_free(sheet *s) {
    if (!s->rates) return;
    rate_row rows[RATE_ROWS];
    list_rows(s->rates, rows);
    for (int i = 0; i < RATE_ROWS; i++) memory_free(*rows[i].array, rows[i].count * rows[i].size);
    memory_free(s->rates, sizeof *s->rates);
    s->rates = NULL;
}

double sheet_rates_bytes(const sheet *s) {
    if (!s->rates) return 0;
    rate_row rows[RATE_ROWS];
    double bytes = sizeof *s->rates;
    list_rows(s->rates, rows);
    for (int i = 0; i < RATE_ROWS; i++) bytes += (double)(rows[i].count * rows[i].size);
    return bytes;
}

/* The packs that a pack's bonds reach, without itself, ascending. Returns how many; counts beyond `limit` too. */
enum { NEAR_LIMIT = 512 };

static int find_near(const sheet *s, int32_t p, int32_t near[NEAR_LIMIT]) {
    int count = 0;
    int64_t first = (int64_t)s->packs[p].first_slot * PACK, last = first + (int64_t)s->packs[p].slots * PACK;
    for (int64_t at = first; at < last; at++) {
        int32_t q = s->neighbour[at] / PACK;
        int place = count;
        while (place > 0 && near[place - 1] > q) place--;
        if (q == p || (place > 0 && near[place - 1] == q) || count == NEAR_LIMIT) continue;
        memmove(near + place + 1, near + place, (size_t)(count - place) * sizeof *near);
        near[place] = q;
        count++;
    }
    return count;
}

static status list_near(sheet *s, report *r) {
    pack_rates *t = s->rates;
    int32_t near[NEAR_LIMIT + 1];
    for (int32_t p = 0; p < t->pack_count; p++) t->near_start[p + 1] = t->near_start[p] + find_near(s, p, near);
    t->near = memory_allocate_array((size_t)t->near_start[t->pack_count], sizeof *t->near);
    if (!t->near && t->near_start[t->pack_count] > 0) return report_set(r, STATUS_SYSTEM, "out of memory for the steps of a sheet's regions");
    for (int32_t p = 0; p < t->pack_count; p++) {
        int count = find_near(s, p, near);
        memcpy(t->near + t->near_start[p], near, (size_t)count * sizeof *near);
    }
    return STATUS_OK;
}

status sheet_rates_create(sheet *s, report *r) {
    pack_rates *t = s->rates = memory_allocate(sizeof *t);
    if (!t) return report_set(r, STATUS_SYSTEM, "out of memory for the steps of a sheet's regions");
    t->pack_count = s->pack_count;
    rate_row rows[RATE_ROWS];
    list_rows(t, rows);
    for (int i = 0; i < RATE_ROWS; i++) {
        if (rows[i].array == (void **)&t->near) continue;
        *rows[i].array = memory_allocate_array(rows[i].count, rows[i].size);
        if (*rows[i].array) continue;
        return report_set(r, STATUS_SYSTEM, "out of memory for the steps of a sheet's regions");
    }
    for (int32_t p = 0; p < t->pack_count; p++) t->stiffening[p] = 1, t->order[p] = p;
    return list_near(s, r);
}

void sheet_rates_load(sheet *s, const sheet_network *n) {
    pack_rates *t = s->rates;
    for (int32_t p = 0; p < t->pack_count; p++) {
        t->pace[p] = 0;
        for (int lane = 0; lane < s->packs[p].count; lane++) t->pace[p] = fmax(t->pace[p], n->pace[s->id[(int64_t)p * PACK + lane]]);
    }
    /* The dilatation of a state-based form reaches over two bonds: its bodies take one step throughout. */
    for (int b = 0; b < s->definition.body_count; b++) {
        const sheet_plan *plan = &s->plans[s->definition.bodies[b].material];
        t->uniform[b] = !plan->multirate || plan->state;
    }
    sheet_rates_feel(s);
}

static void feel_pack(const pack_work *w) {
    sheet *s = w->state;
    const sheet_pack *pack = &s->packs[w->pack];
    real coldest = node_at(s, w->pack, 0)[3], hottest = coldest;
    for (int lane = 0; lane < pack->count; lane++) {
        real own = node_at(s, w->pack, lane)[3];
        for (int32_t k = 0; k < pack->slots; k++) {
            int32_t other = s->neighbour[((int64_t)pack->first_slot + k) * PACK + lane];
            real theta = (own + s->node[(int64_t)other * NODE + 3]) * (real)0.5;
            coldest = theta < coldest ? theta : coldest;
            hottest = theta > hottest ? theta : hottest;
        }
    }
    s->rates->coldest[w->pack] = coldest;
    s->rates->hottest[w->pack] = hottest;
}

void sheet_rates_feel(sheet *s) {
    sheet_for_packs(s, 0, feel_pack);
}

/* ---- what packs ask for ------------------------------------------------------------------------------------------ */

/* By the law's stiffness in the last step and what softening leaves at the θ of the moment. */
static double pace_now(const sheet *s, int32_t p) {
    const pack_rates *t = s->rates;
    const body_constants *b = &s->bodies[s->packs[p].body];
    double pace = t->pace[p] * (double)t->stiffening[p];
    if (b->stiffness_loss == 0) return pace;
    return pace * fmax(1 - (double)b->stiffness_loss * (double)t->coldest[p], (double)b->floor);
}

/* Of bodies that take one step throughout, the fastest pack's. */
static void uniform_paces(const sheet *s, double pace[SHEET_BODIES]) {
    const pack_rates *t = s->rates;
    for (int b = 0; b < SHEET_BODIES; b++) pace[b] = 0;
    for (int32_t p = 0; p < t->pack_count; p++) pace[s->packs[p].body] = fmax(pace[s->packs[p].body], pace_now(s, p));
}

static int most_levels(const sheet *s) {
    int most = 0;
    for (int b = 0; b < s->definition.body_count; b++) {
        const sheet_plan *plan = &s->plans[s->definition.bodies[b].material];
        if (plan->multirate && plan->levels > most) most = plan->levels;
    }
    return most;
}

/* Bins of ¼ octave of a limit below the longest, ½ octave of a pace; a pack counts with its bin's fastest. */
static int bin_of(double pace, double least) {
    int exponent;
    double mantissa = frexp(pace / least, &exponent);
    int bin = 2 * (exponent - 1) + (mantissa >= sqrt(0.5));
    return bin < BINS - 1 ? bin : BINS - 1;
}

double sheet_rates_limit(const sheet *s) {
    const pack_rates *t = s->rates;
    double uniform[SHEET_BODIES], slots[BINS] = {0}, most = 0, least = HUGE_VAL;
    uniform_paces(s, uniform);
    for (int b = 0; b < s->definition.body_count; b++) most = fmax(most, uniform[b]);
    for (int32_t p = 0; p < t->pack_count; p++) {
        int body = s->packs[p].body;
        double pace = t->uniform[body] ? uniform[body] : pace_now(s, p);
        if (pace > 0) least = fmin(least, pace);
    }
    if (!(most > 0)) return HUGE_VAL;
    for (int32_t p = 0; p < t->pack_count; p++) {
        int body = s->packs[p].body;
        double pace = t->uniform[body] ? uniform[body] : pace_now(s, p);
        slots[pace > 0 ? bin_of(pace, least) : 0] += s->packs[p].slots;
    }
    /* The step is 2^(j/4) of the shortest limit: what bonds cost a unit of time, for each j. */
    int best = 0;
    double best_cost = HUGE_VAL;
    for (int j = 0; j <= BINS_AN_OCTAVE * most_levels(s); j++) {
        double step = exp2((double)j / BINS_AN_OCTAVE) / sqrt(most), cost = 0;
        for (int bin = 0; bin < BINS; bin++) {
            if (slots[bin] == 0) continue;
            double pace = fmin(least * exp2(0.5 * (bin + 1)), most), halvings = ceil(0.5 * log2(step * step * pace) - 1e-6);
            cost += slots[bin] * exp2(fmax(0, halvings)) / step;
        }
        if (cost < (1 - WORTH) * best_cost) best = j, best_cost = cost;
    }
    return exp2((double)best / BINS_AN_OCTAVE) / sqrt(most);
}

static int halvings(double pace, double dt) {
    int level = 0;
    for (double square = dt * dt * pace; square > 1 + 1e-6 && level < SHEET_LEVELS - 1; square *= 0.25) level++;
    return level;
}

/* Whether θ swells or softens some bonds of a pack more than others: what is alike moves slowly. */
static bool is_heated(const body_constants *b, double difference) {
    double loss = fmax((double)b->stiffness_loss, fmax((double)b->toughness_loss, (double)b->stretch_loss));
    return loss * difference > ACTS || fabs((double)b->alpha) * difference > SWELLS;
}

static bool has_cracked(const pack_rates *t, int32_t p) {
    return t->cracked[p] > 0 && t->step - t->cracked[p] < MEMORY;
}

static int ask(const sheet *s, int32_t p, double dt, const double uniform[SHEET_BODIES]) {
    const pack_rates *t = s->rates;
    int body = s->packs[p].body;
    const sheet_plan *plan = &s->plans[s->definition.bodies[body].material];
    double cfl = s->definition.cfl > 0 ? s->definition.cfl : 1;
    if (t->uniform[body]) return halvings(uniform[body] / (cfl * cfl), dt);
    int level = halvings(pace_now(s, p) / (cfl * cfl), dt), more = 0;
    if (plan->cracking > 0) {
        bool cracks = has_cracked(t, p);
        for (int64_t k = t->near_start[p]; k < t->near_start[p + 1] && !cracks; k++) cracks = has_cracked(t, t->near[k]);
        more = cracks ? plan->cracking : 0;
    }
    if (plan->heated > more && is_heated(&s->bodies[body], (double)t->hottest[p] - (double)t->coldest[p])) more = plan->heated;
    return level + more < SHEET_LEVELS ? level + more : SHEET_LEVELS - 1;
}

/* ---- levels ------------------------------------------------------------------------------------------------------ */

/* Neighbours lie at most one level apart, so that a pack has bonds of two paces at most. */
static void smooth_levels(pack_rates *t) {
    for (int level = SHEET_LEVELS - 1; level > 1; level--)
        for (int32_t p = 0; p < t->pack_count; p++) {
            if (t->level[p] != level) continue;
            for (int64_t k = t->near_start[p]; k < t->near_start[p + 1]; k++)
                if (t->level[t->near[k]] < level - 1) t->level[t->near[k]] = (uint8_t)(level - 1);
        }
}

/* Packs by falling reach, and by place within each. */
static void order_packs(sheet *s) {
    pack_rates *t = s->rates;
    int32_t next[SHEET_LEVELS] = {0};
    for (int l = 0; l <= SHEET_LEVELS; l++) t->active[l] = 0, t->active_slots[l] = 0;
    for (int32_t p = 0; p < t->pack_count; p++) {
        uint8_t reach = t->level[p];
        for (int64_t k = t->near_start[p]; k < t->near_start[p + 1]; k++)
            if (t->level[t->near[k]] > reach) reach = t->level[t->near[k]];
        t->reach[p] = reach;
        t->active[reach]++;
        t->active_slots[reach] += s->packs[p].slots;
    }
    for (int l = SHEET_LEVELS - 1; l >= 0; l--) {
        next[l] = t->active[l + 1];
        t->active[l] += t->active[l + 1];
        t->active_slots[l] += t->active_slots[l + 1];
    }
    for (int32_t p = 0; p < t->pack_count; p++) t->order[next[t->reach[p]]++] = p;
}

void sheet_rates_choose(sheet *s, double dt) {
    pack_rates *t = s->rates;
    double uniform[SHEET_BODIES];
    uniform_paces(s, uniform);
    t->finest = 0;
    for (int32_t p = 0; p < t->pack_count; p++) {
        int level = ask(s, p, dt, uniform);
        /* Levels rise at once and fall at certain steps, so that they do not flicker. */
        if (level < t->asked[p] && t->step % MEMORY != 0) level = t->asked[p];
        t->asked[p] = t->level[p] = (uint8_t)level;
        t->stiffening[p] = 1;
        if (level > t->finest) t->finest = level;
    }
    smooth_levels(t);
    order_packs(s);
    t->step++;
}

/* ---- reports ----------------------------------------------------------------------------------------------------- */

void sheet_rates_report(const sheet *s, sheet_rates *out) {
    const pack_rates *t = s->rates;
    *out = (sheet_rates){.levels = t ? t->finest + 1 : 1, .bond_updates = s->bond_updates};
    for (int32_t p = 0; p < s->pack_count; p++) out->particles[t ? t->level[p] : 0] += s->packs[p].count;
}

void sheet_rates_levels(const sheet *s, uint8_t *out) {
    for (int64_t i = 0; i < s->count; i++) out[i] = s->rates ? s->rates->level[s->place[i] / PACK] : 0;
}
