/* Regions that take smaller steps: what they keep, how exact they are, what they save (METHOD.md §6, "Spatial multi-rate").
 *
 * The sheet is soft where it is wet, and a patch of it is dry: sixteen times stiffer, so that its limit is a quarter of the rest's. */
#include "check.h"
#include "verify/sheet_patch.h"

enum { ACROSS = 48, ROWS = 32 };

static const double DX = 1.0 / 32, H = 0.02;

static bool is_dry(const double x[3]) {
    return hypot(x[0] - 0.5, x[1] - 0.45) < 0.22;
}

/* Free, moving smoothly in the plane and out of it, turning. */
static patch *wet_sheet(bool multirate, int across, int rows) {
    patch *p = patch_create(SHEET_SQUARE, DX, 1.5, H);
    patch_fill(p, across, rows);
    patch_set(p, "linear", "E", 800);
    patch_set(p, "diffusion", "k", 0);
    patch_set(p, "softening", "stiffness", 1.0 - 1.0 / 16);
    if (multirate) patch_set(p, "multirate", "levels", 4), patch_set(p, "multirate", "heated", 0);
    for (int64_t i = 0; i < p->d.count; i++) {
        const double *x = p->rest[i];
        p->diffused[i] = is_dry(x) ? 0 : 1;
        p->velocity[i][0] = 0.3 * sin(3 * x[0] + 2 * x[1]) - 0.4 * (x[1] - 0.5);
        p->velocity[i][1] = 0.2 * cos(2 * x[0] - 3 * x[1]) + 0.4 * (x[0] - 0.7);
        p->velocity[i][2] = 0.2 * sin(4 * x[0] + x[1]);
    }
    return p;
}

static sheet_rates rates_of(const patch *p) {
    sheet_rates rates;
    p->engine->rates(p->state, &rates);
    return rates;
}

static void what_a_sheet_of_several_steps_keeps(void) {
    patch *p = wet_sheet(true, ACROSS, ROWS);
    p->d.cfl = 0.3; /* what symplectic Euler keeps differs from the energy by the square of the step: by more where waves have become short */
    CHECK(patch_start(p, 64, "auto", 1));
    double dt = 0.3 * patch_limit(p), mean[2] = {0}, scale = 0;
    sheet_measures start = patch_measure(p);
    for (int64_t i = 0; i < p->d.count; i++) scale += start.mass / (double)p->d.count * fabs(p->velocity[i][0]);
    int64_t steps = 20000;
    for (int end = 0; end < 2; end++) {
        if (end) CHECK(patch_steps(p, steps, dt) == STATUS_OK);
        for (int k = 0; k < 1000; k++) {
            CHECK(patch_steps(p, 1, dt) == STATUS_OK);
            sheet_measures m = patch_measure(p);
            mean[end] += (m.kinetic + m.elastic) / 1000;
        }
    }
    sheet_measures last = patch_measure(p);
    sheet_rates rates = rates_of(p);
    CHECK(rates.levels == 3 && rates.particles[2] > 100 && rates.particles[1] > 100 && rates.particles[0] > 500);
    double change = 0;
    for (int c = 0; c < 3; c++) change = fmax(change, fabs(last.momentum[c] - start.momentum[c]));
    CHECK_ROW("METHOD 6", "steps of 1, 1/2 and 1/4, 22 000 undamped: change of the momentum over the sum of its parts", 0, change / scale, 1e-11);
    CHECK_ROW("METHOD 6", "the same: relative change of the angular momentum", 0, last.angular_momentum[2] / start.angular_momentum[2] - 1, 1e-10);
    CHECK_ROW("METHOD 6", "the same: drift of the mean energy", 0, mean[1] / mean[0] - 1, 1e-3);
    patch_free(p);
}

/* Positions after a while, with `halvings` of the step and of every part of it. */
static void run(bool multirate, int halvings, double (*x)[3]) {
    patch *p = wet_sheet(multirate, ACROSS, ROWS);
    p->d.cfl = ldexp(0.5, -halvings);
    CHECK(patch_start(p, 64, "auto", 1));
    double end = 0.06, whole = multirate ? 0.5 * patch_limit(p) : 0.125 * patch_limit(p);
    int64_t steps = (int64_t)ceil(end / whole) << halvings;
    CHECK(patch_steps(p, steps, end / (double)steps) == STATUS_OK);
    CHECK(multirate == (rates_of(p).levels == 3));
    p->engine->read(p->state, "position", x[0]);
    patch_free(p);
}

static double distance(const double (*a)[3], const double (*b)[3]) {
    double most = 0;
    for (int i = 0; i < ACROSS * ROWS; i++)
        for (int c = 0; c < 3; c++) most = fmax(most, fabs(a[i][c] - b[i][c]));
    return most;
}

/* From rest the places of a symplectic Euler step are those of a leapfrog, of second order; so are those of this scheme. */
static void several_steps_are_of_second_order(void) {
    static double exact[ACROSS * ROWS][3], x[ACROSS * ROWS][3];
    double error[3];
    run(false, 4, exact);
    for (int k = 0; k < 3; k++) {
        run(true, k, x);
        error[k] = distance((const double(*)[3])x, (const double(*)[3])exact);
    }
    CHECK_ROW("METHOD 6", "steps of 1, 1/2 and 1/4 against short ones: observed order of places", 2, log2(error[1] / error[2]), 0.25);
    CHECK_ROW("METHOD 6", "the same: largest difference of places at half the limit, in spacings", 0, error[0] / DX, 0.02);
}

static void bonds_are_updated_less_often(void) {
    int64_t updates[2];
    double end = 0.1;
    for (int multirate = 0; multirate < 2; multirate++) {
        patch *p = wet_sheet(multirate, 2 * ACROSS, 2 * ROWS);
        p->d.cfl = 0.5;
        CHECK(patch_start(p, 64, "auto", 1));
        double dt = 0.5 * patch_limit(p);
        CHECK(patch_steps(p, (int64_t)ceil(end / dt), dt) == STATUS_OK);
        updates[multirate] = rates_of(p).bond_updates;
        patch_free(p);
    }
    double ratio = (double)updates[1] / (double)updates[0];
    CHECK_ROW("METHOD 6", "stiff patch over a fortieth of the sheet: bond updates of several steps over those of one", 0.5, ratio, 0.12);
}

/* A sheet all alike takes one step, and its bits are those of the engine without levels. */
static void a_sheet_all_alike_takes_one_step(void) {
    static double x[2][ACROSS * ROWS][3];
    for (int multirate = 0; multirate < 2; multirate++) {
        patch *p = patch_create(SHEET_HEXAGONAL, DX, 1.5, H);
        patch_fill(p, ACROSS, ROWS);
        patch_set(p, "linear", "E", 50);
        if (multirate) patch_set(p, "multirate", "levels", 4);
        for (int64_t i = 0; i < p->d.count; i++) p->velocity[i][0] = 0.3 * p->rest[i][1], p->velocity[i][1] = 0.1 * sin(9 * p->rest[i][0]);
        CHECK(patch_start(p, 64, "auto", 1));
        CHECK(patch_steps(p, 200, 0.5 * patch_limit(p)) == STATUS_OK);
        CHECK(rates_of(p).levels == 1);
        p->engine->read(p->state, "position", x[multirate][0]);
        patch_free(p);
    }
    CHECK(distance((const double(*)[3])x[0], (const double(*)[3])x[1]) == 0);
}

/* A notched sheet, drawn apart, hot on its right: levels follow the crack and the heat. */
static patch *cracking_sheet(arena *memory) {
    patch *p = patch_create(SHEET_SQUARE, DX, 1.5, H);
    patch_fill(p, 2 * ACROSS, 2 * ROWS);
    patch_set(p, "linear", "E", 100);
    patch_set(p, "fracture", "stretch", 0.02);
    patch_set(p, "diffusion", "k", 1e-4);
    patch_set(p, "swelling", "alpha", 0.01);
    patch_set(p, "self_contact", "stiffness", 0.5);
    patch_set(p, "multirate", "levels", 3);
    double middle = DX * (ROWS - 0.5);
    p->d.notches[0] = (sheet_notch){.body = -1, .from = {-1, middle, 0}, .to = {0.6, middle, 0}, .normal = {0, 0, 1}};
    p->d.notch_count = 1;
    for (int side = 0; side < 2; side++) {
        double near = side ? DX * (2 * ROWS - 2.5) : DX * 1.5, far = side ? 100 : -100;
        p->d.boundaries[side] = (rigid_boundary){.shape = shape_box(memory, (const double[]){-100, fmin(near, far), -100}, (const double[]){100, fmax(near, far), 100}),
                                                 .grip = true, .motion = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .velocity = {0, side ? 0.03 : -0.03, 0}, .active = true}};
    }
    p->d.boundary_count = 2;
    for (int64_t i = 0; i < p->d.count; i++) {
        const double *x = p->rest[i];
        p->diffused[i] = hypot(x[0] - 2.6, x[1] - 0.3) < 0.15 ? 1 : 0;
        p->velocity[i][1] = 0.06 * (x[1] - middle) / (2 * middle);
        p->protected[i] = x[1] < 3 * DX || x[1] > 2 * middle - 3 * DX;
    }
    return p;
}

static void cracks_and_heat_ask_for_smaller_steps(void) {
    static uint8_t levels[4 * ACROSS * ROWS];
    static double broken[2][4 * ACROSS * ROWS];
    arena *memory = arena_create("crack");
    patch *p = cracking_sheet(memory);
    p->d.cfl = 0.5;
    CHECK(patch_start(p, 64, "auto", 2));
    double dt = 0.5 * patch_limit(p);
    CHECK(patch_steps(p, 1, dt) == STATUS_OK);
    p->engine->levels(p->state, levels);
    int64_t hot = 0, cold = 0, torn = 0, still = 0;
    for (int64_t i = 0; i < p->d.count; i++) {
        bool is_hot = fabs(hypot(p->rest[i][0] - 2.6, p->rest[i][1] - 0.3) - 0.15) < DX, is_cold = p->rest[i][0] < 2;
        CHECK(!is_hot || levels[i] == 1);
        CHECK(!is_cold || levels[i] == 0);
        hot += is_hot, cold += is_cold;
    }
    CHECK(hot > 40 && cold > 3000);
    int64_t before = patch_measure(p).bonds_broken;
    for (int k = 0; k < 4000 && patch_measure(p).bonds_broken < before + 40; k++) CHECK(patch_steps(p, 4, dt) == STATUS_OK);
    CHECK(patch_measure(p).bonds_broken >= before + 40);
    p->engine->read(p->state, "broken", broken[0]);
    CHECK(patch_steps(p, 4, dt) == STATUS_OK);
    p->engine->read(p->state, "broken", broken[1]);
    CHECK(patch_steps(p, 1, dt) == STATUS_OK);
    p->engine->levels(p->state, levels);
    for (int64_t i = 0; i < p->d.count; i++) {
        bool tears = broken[1][i] > broken[0][i], is_still = fabs(p->rest[i][1] - DX * ROWS) > 0.7 && hypot(p->rest[i][0] - 2.6, p->rest[i][1] - 0.3) > 0.5;
        CHECK(!tears || levels[i] >= 1);
        CHECK(!is_still || levels[i] == 0);
        torn += tears, still += is_still;
    }
    CHECK(torn > 0 && still > 200);
    patch_free(p);
    arena_destroy(memory);
}

typedef struct picture {
    double position[4 * ACROSS * ROWS][3];
    sheet_measures m;
} picture;

static void look(patch *p, picture *out) {
    memset(out, 0, sizeof *out);
    p->engine->settle(p->state, p->time);
    p->engine->read(p->state, "position", out->position[0]);
    out->m = patch_measure(p);
}

static bool same(const picture *a, const picture *b) {
    return memcmp(a->position, b->position, sizeof a->position) == 0 && a->m.bonds_broken == b->m.bonds_broken && a->m.elastic == b->m.elastic &&
           a->m.grip_work == b->m.grip_work;
}

static void threads_and_restarts_do_not_change_bits(void) {
    static picture first, other;
    static record_list records;
    arena *memory = arena_create("bits");
    report r;
    for (int precision = 32; precision <= 64; precision += 32) {
        patch *p = cracking_sheet(memory);
        p->d.cfl = 0.5;
        CHECK(patch_start(p, precision, "auto", 1));
        double dt = 0.5 * patch_limit(p), time;
        int64_t half = 0;
        for (; half < 8000 && patch_measure(p).bonds_broken < 100; half += 7) CHECK(patch_steps(p, 7, dt) == STATUS_OK);
        CHECK(rates_of(p).levels > 1);
        CHECK(p->engine->save(p->state, &records, &r) == STATUS_OK);
        time = p->time;
        CHECK(patch_steps(p, 100, dt) == STATUS_OK);
        look(p, &first);
        patch_stop(p);
        CHECK(patch_start(p, precision, "auto", 3));
        CHECK(p->engine->restore(p->state, &records, &r) == STATUS_OK);
        p->time = time;
        CHECK(patch_steps(p, 100, dt) == STATUS_OK);
        look(p, &other);
        CHECK(same(&first, &other));
        patch_stop(p);
        CHECK(patch_start(p, precision, "auto", 2));
        CHECK(patch_steps(p, half, dt) == STATUS_OK);
        CHECK(patch_steps(p, 100, dt) == STATUS_OK);
        look(p, &other);
        CHECK(same(&first, &other));
        record_clear(&records);
        patch_free(p);
    }
    arena_destroy(memory);
}

int main(void) {
    RUN(what_a_sheet_of_several_steps_keeps);
    RUN(several_steps_are_of_second_order);
    RUN(bonds_are_updated_less_often);
    RUN(a_sheet_all_alike_takes_one_step);
    RUN(cracks_and_heat_ask_for_smaller_steps);
    RUN(threads_and_restarts_do_not_change_bits);
    return check_finish();
}
