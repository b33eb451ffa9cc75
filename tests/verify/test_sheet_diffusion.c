/* Diffusion along bonds: closed forms, conservation, cracks that let nothing through (METHOD.md §6, 8 and "Checks"). */
#include "check.h"
#include "verify/sheet_patch.h"

static const double PI = 3.14159265358979323846;

enum { AROUND = 16 };

/* A tube whose bonds have exactly the lengths of the square lattice: a strip without sides. Rows −1 … n+1 along x; those at x ≤ 0 are held
 * at 1, those at x ≥ 1 at 0. */
static double slab_error(int n) {
    double dx = 1.0 / n, radius = 0.5 * dx / sin(PI / AROUND), until = 0.1, worst = 0;
    patch *p = patch_create(SHEET_SQUARE, dx, 1.5, 1);
    for (int i = -1; i <= n + 1; i++)
        for (int a = 0; a < AROUND; a++)
            patch_add(p, i * dx, radius * cos(2 * PI * a / AROUND), radius * sin(2 * PI * a / AROUND), dx * dx);
    patch_set(p, "linear", "E", 1e-9); /* the mechanics stand still */
    patch_set(p, "diffusion", "k", 1);
    static int32_t warm[4 * AROUND], cold[4 * AROUND];
    static double ones[4 * AROUND], noughts[4 * AROUND];
    for (int k = 0; k < 2 * AROUND; k++) {
        warm[k] = k, cold[k] = (int32_t)p->d.count - 1 - k, ones[k] = 1;
        p->diffused[k] = 1;
    }
    p->d.sources[0] = (sheet_source){.count = 2 * AROUND, .particle = warm, .value = ones, .fixed = true, .stop = HUGE_VAL};
    p->d.sources[1] = (sheet_source){.count = 2 * AROUND, .particle = cold, .value = noughts, .fixed = true, .stop = HUGE_VAL};
    p->d.source_count = 2;
    CHECK(patch_start(p, 64, "auto", 2));
    int64_t steps = (int64_t)ceil(until / (0.3 * patch_limit(p)));
    CHECK(patch_steps(p, steps, until / (double)steps) == STATUS_OK);
    p->engine->settle(p->state, until);
    double *theta = malloc((size_t)p->d.count * sizeof *theta);
    p->engine->read(p->state, "diffused", theta);
    for (int i = 0; i <= n; i++) {
        double x = i * dx, expected = 1 - x;
        for (int k = 1; k < 60; k++) expected -= 2 * sin(k * PI * x) * exp(-k * k * PI * PI * until) / (k * PI);
        for (int a = 0; a < AROUND; a++) worst = fmax(worst, fabs(theta[(i + 1) * AROUND + a] - expected));
    }
    free(theta);
    patch_free(p);
    return worst;
}

static void a_slab_follows_its_fourier_series(void) {
    static const double given[] = {3.0e-4, 7.6e-5, 1.9e-5};
    double error[3];
    for (int k = 0; k < 3; k++) {
        char text[96];
        error[k] = slab_error(20 << k);
        snprintf(text, sizeof text, "slab between 1 and 0, t = 0.1, N = %d: largest error", 20 << k);
        CHECK_ROW("METHOD 6", text, 0, error[k], 1.25 * given[k]);
    }
    CHECK_ROW("METHOD 6", "the same: order from N = 20 to 40", 2, log2(error[0] / error[1]), 0.1);
    CHECK_ROW("METHOD 6", "the same: order from N = 40 to 80", 2, log2(error[1] / error[2]), 0.1);
}

/* A random sheet cut in two: one half hot. */
static void a_crack_lets_nothing_through(void) {
    patch *p = patch_create(SHEET_SQUARE, 0.1, 3.015, 0.5);
    patch_fill(p, 21, 17);
    patch_set(p, "linear", "E", 1e-9);
    patch_set(p, "diffusion", "k", 0.3);
    p->d.notches[0] = (sheet_notch){.body = -1, .from = {1.05, -1, 0}, .to = {1.05, 3, 0}, .normal = {0, 0, 1}};
    p->d.notch_count = 1;
    for (int64_t i = 0; i < p->d.count; i++) p->diffused[i] = p->rest[i][0] < 1.05 ? 1 + 0.5 * patch_random((uint64_t)i) : 0;
    CHECK(patch_start(p, 64, "auto", 1));
    double before = patch_measure(p).diffused_total;
    CHECK(patch_steps(p, 200, 0.5 * patch_limit(p)) == STATUS_OK);
    p->engine->settle(p->state, p->time);
    static double theta[PATCH_LIMIT];
    p->engine->read(p->state, "diffused", theta);
    double passed = 0, least = HUGE_VAL, most = -HUGE_VAL;
    for (int64_t i = 0; i < p->d.count; i++) {
        if (p->rest[i][0] > 1.05) passed += fabs(theta[i]);
        else least = fmin(least, theta[i]), most = fmax(most, theta[i]);
    }
    CHECK_ROW("METHOD 6", "two halves of a cut sheet: what has passed", 0, passed, 0);
    CHECK(most - least < 0.5); /* and the hot half has evened out */
    double after = patch_measure(p).diffused_total;
    CHECK_ROW("METHOD 6", "the same: relative change of the sum of rho C A theta", 0, after / before - 1, 1e-13);
    patch_free(p);
}

/* A rate that is on for part of the time adds rate × time whatever the steps; decay takes its share. */
static void sources_and_decay_add_up(void) {
    static int32_t one[1] = {40};
    static double rate[1] = {5};
    patch *p = patch_create(SHEET_HEXAGONAL, 0.1, 1.5, 0.5);
    patch_fill(p, 9, 9);
    patch_set(p, "linear", "E", 1e-9);
    patch_set(p, "diffusion", "k", 0.01);
    p->d.sources[0] = (sheet_source){.count = 1, .particle = one, .value = rate, .start = 0.0101, .stop = 0.0473};
    p->d.source_count = 1;
    CHECK(patch_start(p, 64, "auto", 1));
    CHECK(patch_steps(p, 77, 0.001) == STATUS_OK);
    p->engine->settle(p->state, p->time);
    double expected = 0.5 * p->area[40] * 5 * (0.0473 - 0.0101);
    CHECK_ROW("METHOD 6", "a source on for a while: sum of rho C A h theta", expected, patch_measure(p).diffused_total, 1e-14);
    patch_free(p);
    p = patch_create(SHEET_SQUARE, 0.1, 1.5, 0.5);
    patch_fill(p, 9, 9);
    patch_set(p, "linear", "E", 1e-9);
    patch_set(p, "diffusion", "k", 0.01);
    patch_set(p, "diffusion", "decay", 3);
    patch_set(p, "diffusion", "initial", 2);
    p->d.diffused = NULL;
    CHECK(patch_start(p, 64, "auto", 1));
    CHECK(patch_steps(p, 500, 0.001) == STATUS_OK);
    p->engine->settle(p->state, p->time);
    CHECK_ROW("METHOD 6", "decay at rate 3 for 0.5: largest theta", 2 * exp(-1.5), patch_measure(p).diffused_max, 1e-12);
    patch_free(p);
}

int main(void) {
    RUN(a_slab_follows_its_fourier_series);
    RUN(a_crack_lets_nothing_through);
    RUN(sources_and_decay_add_up);
    return check_finish();
}
