/* Damage on the grid (METHOD.md §2), f64.
 *
 * - Beside a band held at d = 1 a bar relaxes to exp(−|x|/l0), x from the band's edge: decay length fitted over 1.5–4 l0 within 2 % at
 *   l0 = 8 dx, mean and largest error falling at first order in dx; explicit and implicit, quadratic and cubic. The profile has a kink at the
 *   band's edge, where d'' is −δ(x)/l0: at particles within a kernel's reach of it Δd is of size −1/(l0 dx) whatever the kernel. So the largest
 *   error is there, and comes to its order late: implicit from l0 = 8 to 16 dx (from 4 to 8 it is 0.6).
 * - The implicit operator is symmetric and positive definite.
 * - Explicit and implicit damage agree as Δt → 0, first-order slope: driven evenly, and each particle as it likes.
 * - A narrow band of driven particles breaks the same particles, explicitly and implicitly, in two steps or many.
 * - η = 0 works implicitly (the rate-independent limit): uniform D̃ gives d = D̃/(1 + D̃) in one step. */
#include "check.h"
#define SUNDER_PRECISION 64
#define SUNDER_SIMD 0
#include "../src/solid/implicit.c"
#include "verify/solid_scene.h"

static double length_of_bar, width_of_bar;

static const shape *bar(arena *a) {
    double w = 0.5 * width_of_bar;
    return shape_box(a, (const double[]){-0.5 * length_of_bar, -w, -w}, (const double[]){0.5 * length_of_bar, w, w});
}

/* Relaxes the band, as wide to each side as l0, and compares with the profile outside: fitted decay length over l0, and the mean
 * error. (A band narrower than a kernel is a peak on the nodes, concave around it, where d does not grow.) */
static void relax_band(double cells, bool implicit, kernel_kind laplacian, double *decay, double *error, double largest[2]) {
    double l0 = 1, dx = l0 / cells;
    length_of_bar = 16;
    width_of_bar = 2 * dx;
    scene *s = test_scene(bar, 1e-6, 0.3, 1);
    s->dx = dx;
    s->particles_per_cell = 8;
    s->laplacian = laplacian;
    test_set(s, "damage", "sigma_c", 1);
    test_set(s, "damage", "eta", 1);
    test_set(s, "damage", "length_scale", l0);
    test_set(s, "damage", "form", implicit ? 1 : 0);
    test_set(s, "damage", "tolerance", 1e-10);
    report r;
    s->bodies[0].notches = shape_box(s->memory, (const double[]){-1, -9, -9}, (const double[]){1, 9, 9});
    simulation *sim = test_simulation(s, 64, "plain", 2);
    double step = implicit ? 0.5 : 0.9 / (1 + 12 * cells * cells);
    for (double t = 0; t < 8; t += step) CHECK(simulation_step(sim, step, &r) == STATUS_OK);
    solid *state;
    const solid_engine *engine = simulation_engine(sim, &state);
    int64_t n = simulation_get_plan(sim)->particles;
    double *x = memory_allocate((size_t)n * 24), *d = memory_allocate((size_t)n * 8);
    engine->read(state, "position", x);
    engine->read(state, "damage", d);
    double sx = 0, sy = 0, sxx = 0, sxy = 0, count = 0;
    double total = 0, seen = 0;
    largest[0] = largest[1] = 0;
    for (int64_t i = 0; i < n; i++) {
        double away = fabs(x[3 * i]) - 1;
        if (away > 5 * l0 || away < 0) continue;
        total += fabs(d[i] - exp(-away / l0)), seen++;
        largest[0] = fmax(largest[0], fabs(d[i] - exp(-away / l0)));
        if (away > dx) largest[1] = fmax(largest[1], fabs(d[i] - exp(-away / l0)));
        if (away < 1.5 * l0 || away > 4 * l0) continue;
        sx += away, sy += log(d[i]), sxx += away * away, sxy += away * log(d[i]), count++;
    }
    *decay = -(count * sxx - sx * sx) / (count * sxy - sx * sy) / l0;
    *error = total / seen;
    memory_free(x, (size_t)n * 24), memory_free(d, (size_t)n * 8);
    simulation_destroy(sim);
    scene_destroy(s);
}

static void a_band_relaxes_to_its_exponential(void) {
    static const char *const names[2][2] = {{"explicit, quadratic", "explicit, cubic"}, {"implicit, quadratic", "implicit, cubic"}};
    for (int implicit = 0; implicit < 2; implicit++)
        for (int laplacian = 0; laplacian < 2; laplacian++) {
            double decay, error, fine_decay, coarse_decay, coarse_error, coarse_largest[2], largest[2];
            int cells = implicit ? 16 : 8;
            relax_band(cells / 2, implicit, (kernel_kind)laplacian, &coarse_decay, &coarse_error, coarse_largest);
            relax_band(cells, implicit, (kernel_kind)laplacian, &fine_decay, &error, largest);
            decay = implicit ? coarse_decay : fine_decay;
            printf("  %s: decay %.4f, %.4f l0; mean error %.4f, %.4f (order %.2f)\n", names[implicit][laplacian], coarse_decay, fine_decay,
                   coarse_error, error, log2(coarse_error / error));
            printf("    largest error %.4f, %.4f (order %.2f); further than a cell from the band %.4f, %.4f (order %.2f)\n", coarse_largest[0],
                   largest[0], log2(coarse_largest[0] / largest[0]), coarse_largest[1], largest[1], log2(coarse_largest[1] / largest[1]));
            char text[128];
            snprintf(text, sizeof text, "band held at d = 1: decay length over l0 at l0 = 8 dx, %s", names[implicit][laplacian]);
            CHECK_ROW("METHOD 2", text, 1, decay, 0.02);
            snprintf(text, sizeof text, "the same: order of the mean error in dx, %s", names[implicit][laplacian]);
            CHECK_ROW("METHOD 2", text, 1, log2(coarse_error / error), 0.35);
            snprintf(text, sizeof text, "the same: order of the largest error in dx, %s", names[implicit][laplacian]);
            CHECK_ROW("METHOD 2", text, 1, log2(coarse_largest[0] / largest[0]), 0.35);
        }
}

/* Notches break exactly what lies inside, and one that catches nothing is refused. */
static void notches_break_what_lies_inside(void) {
    length_of_bar = 4, width_of_bar = 1;
    scene *s = test_scene(bar, 1, 0.3, 1);
    s->particles = 3000;
    test_set(s, "damage", "sigma_c", 1);
    const shape *notch = s->bodies[0].notches = shape_sphere(s->memory, (const double[]){1, 0.5, 0}, 0.4);
    simulation *sim = test_simulation(s, 32, "plain", 1);
    solid *state;
    const solid_engine *engine = simulation_engine(sim, &state);
    int64_t n = simulation_get_plan(sim)->particles, inside = 0;
    double *x = memory_allocate((size_t)n * 24), *d = memory_allocate((size_t)n * 8);
    engine->read(state, "position", x);
    engine->read(state, "damage", d);
    for (int64_t i = 0; i < n; i++) {
        double distance = shape_distance(notch, x + 3 * i);
        if (fabs(distance) > 1e-5) CHECK(d[i] == (distance < 0)); /* positions are f32 */
        inside += distance < 0;
    }
    CHECK(inside > 50 && inside < n / 10);
    memory_free(x, (size_t)n * 24), memory_free(d, (size_t)n * 8);
    simulation_destroy(sim);
    s->bodies[0].notches = shape_sphere(s->memory, (const double[]){9, 9, 9}, 0.1);
    simulation_options o = {.threads = 1, .precision = 32, .simd = "plain"};
    report r;
    CHECK(simulation_create(s, &o, &sim, &r) == STATUS_INPUT && strcmp(r.key, "notches") == 0);
    scene_destroy(s);
}

static status swell(void *context, const double *x, int inputs, double *v, int outputs, report *r) {
    (void)context, (void)inputs, (void)outputs, (void)r;
    for (int c = 0; c < 3; c++) v[c] = 0.3 * x[c];
    return STATUS_OK;
}

/* A cube that swells: D̃ grows from the rim of nothing to something, everywhere alike up to the free faces. */
static scene *swelling_cube(bool implicit, double eta) {
    scene *s = test_scene(test_cube, 10, 0.3, 1);
    s->particles = 1000;
    s->bodies[0].velocity = (scene_function){.outputs = 3, .call = swell};
    test_set(s, "damage", "sigma_c", 0.5);
    test_set(s, "damage", "eta", eta);
    test_set(s, "damage", "form", implicit ? 1 : 0);
    test_set(s, "damage", "tolerance", 1e-12);
    return s;
}

static void the_operator_is_symmetric_positive_definite(void) {
    scene *s = swelling_cube(true, 0.1);
    simulation *sim = test_simulation(s, 64, "plain", 2);
    report r;
    for (int i = 0; i < 40; i++) CHECK(simulation_step(sim, 5e-3, &r) == STATUS_OK);
    solid *state;
    simulation_engine(sim, &state);
    size_t values = (size_t)state->slot_count * BLOCK_NODES;
    double *x[2], *Ax[2], worst = 0;
    int indefinite = 0;
    for (int i = 0; i < 2; i++) x[i] = memory_allocate(values * 8), Ax[i] = memory_allocate(values * 8);
    for (uint64_t trial = 0; trial < 20; trial++) {
        double products[2] = {0, 0}, own[2] = {0, 0}, alone[2] = {0, 0};
        for (int i = 0; i < 2; i++) {
            for (size_t n = 0; n < values; n++) {
                bool used = plane(state, (int64_t)n / BLOCK_NODES, DIAGONAL)[n % BLOCK_NODES] > 0;
                x[i][n] = used ? (double)((trial * 7919 + (uint64_t)i * 104729 + n * 2654435761u) % 1000003) / 500001.5 - 1 : 0;
                plane(state, (int64_t)n / BLOCK_NODES, SEARCH)[n % BLOCK_NODES] = x[i][n];
                plane(state, (int64_t)n / BLOCK_NODES, IMAGE)[n % BLOCK_NODES] = 0;
            }
            apply_diffusion(state);
            for (size_t n = 0; n < values; n++)
                Ax[i][n] = plane(state, (int64_t)n / BLOCK_NODES, IMAGE)[n % BLOCK_NODES] +
                           plane(state, (int64_t)n / BLOCK_NODES, DIAGONAL)[n % BLOCK_NODES] * x[i][n];
        }
        for (size_t n = 0; n < values; n++) {
            products[0] += x[0][n] * Ax[1][n], products[1] += x[1][n] * Ax[0][n];
            own[0] += x[0][n] * Ax[0][n], own[1] += x[1][n] * Ax[1][n];
            for (int i = 0; i < 2; i++)
                alone[i] += plane(state, (int64_t)n / BLOCK_NODES, DIAGONAL)[n % BLOCK_NODES] * x[i][n] * x[i][n];
        }
        worst = fmax(worst, fabs(products[0] - products[1]) / sqrt(own[0] * own[1]));
        for (int i = 0; i < 2; i++) {
            CHECK(alone[i] > 0);
            indefinite += !(own[i] > alone[i]);
        }
    }
    CHECK_ROW("METHOD 2", "implicit operator: worst relative asymmetry of 20 pairs of random vectors", 0, worst, 1e-12);
    CHECK_ROW("METHOD 2", "the same: vectors of 40 with x (A + B) x no more than x A x, which is more than 0", 0, indefinite, 0);
    for (int i = 0; i < 2; i++) memory_free(x[i], values * 8), memory_free(Ax[i], values * 8);
    simulation_destroy(sim);
    scene_destroy(s);
}

/* A cube at rest in which D̃ = 3 everywhere, damaged for a time in equal steps; returns the mean of d. */
static double driven_damage(bool implicit, double eta, double time, int steps) {
    scene *s = swelling_cube(implicit, eta);
    s->bodies[0].velocity.outputs = 0;
    simulation *sim = test_simulation(s, 64, "auto", 2);
    solid *state;
    const solid_engine *engine = simulation_engine(sim, &state);
    record_list saved = {0};
    report r;
    CHECK(engine->save(state, &saved, &r) == STATUS_OK);
    record *H = record_find(&saved, "solid/damage_history");
    for (int64_t n = 0; n < H->count * H->components; n++) ((double *)H->data)[n] = 3;
    CHECK(engine->restore(state, &saved, &r) == STATUS_OK);
    for (int i = 0; i < steps; i++) CHECK(simulation_step(sim, time / steps, &r) == STATUS_OK);
    simulation_measures m;
    simulation_measure(sim, &m, &r);
    record_clear(&saved);
    simulation_destroy(sim);
    scene_destroy(s);
    return m.solid.damage_mean;
}

static void explicit_and_implicit_agree(void) {
    double difference[3], exact = 0.75 * (1 - exp(-4 * 0.02 / 0.1));
    for (int i = 0; i < 3; i++) {
        double first = driven_damage(false, 0.1, 0.02, 20 << i), second = driven_damage(true, 0.1, 0.02, 20 << i);
        difference[i] = first - second;
        printf("  %d steps: explicit %.6f, implicit %.6f, exact %.6f\n", 20 << i, first, second, exact);
        CHECK(first > exact && second < exact);
    }
    CHECK_ROW("METHOD 2", "explicit less implicit damage as the step is halved: order", 1, log2(difference[1] / difference[2]), 0.05);
}

static double drive_of_band(const double *x) {
    return fabs(x[0]) < 0.1 ? 20 : 0;
}

static double drive_at_random(const double *x) {
    double noise = sin(1234.5 * x[0] + 987.6 * x[1] + 555.5 * x[2]) * 43758.5453;
    return 10 * (noise - floor(noise));
}

/* A bar at rest with a drive for each particle; fills d in order of id and returns how many particles there are. */
static int64_t driven_bar(bool implicit, double (*drive)(const double *), double length, double eta, double time, int steps, double **d) {
    double dx = 0.1;
    length_of_bar = 2, width_of_bar = 0.4;
    scene *s = test_scene(bar, 1e-6, 0.3, 1);
    s->dx = dx;
    s->particles_per_cell = 8;
    test_set(s, "damage", "sigma_c", 1);
    test_set(s, "damage", "eta", eta);
    test_set(s, "damage", "length_scale", length);
    test_set(s, "damage", "form", implicit ? 1 : 0);
    test_set(s, "damage", "tolerance", 1e-10);
    simulation *sim = test_simulation(s, 64, "plain", 2);
    solid *state;
    const solid_engine *engine = simulation_engine(sim, &state);
    record_list saved = {0};
    report r;
    CHECK(engine->save(state, &saved, &r) == STATUS_OK);
    const int32_t *tiles = record_find(&saved, "solid/tiles")->data, *blocks = record_find(&saved, "solid/blocks")->data;
    const double *x = record_find(&saved, "solid/position")->data;
    double *H = record_find(&saved, "solid/damage_history")->data;
    for (int64_t t = 0; t < record_find(&saved, "solid/tiles")->count; t++)
        for (int32_t p = 0; p < tiles[5 * t + 4]; p++) {
            int64_t pack = tiles[5 * t + 2] + p / PACK;
            double at[3];
            for (int c = 0; c < 3; c++) at[c] = dx * (x[(pack * 3 + c) * PACK + p % PACK] + BLOCK * blocks[5 * tiles[5 * t] + c]);
            H[pack * PACK + p % PACK] = drive(at);
        }
    CHECK(engine->restore(state, &saved, &r) == STATUS_OK);
    for (int i = 0; i < steps; i++) CHECK(simulation_step(sim, time / steps, &r) == STATUS_OK);
    int64_t n = simulation_get_plan(sim)->particles;
    *d = memory_allocate((size_t)n * 8);
    engine->read(state, "damage", *d);
    record_clear(&saved);
    simulation_destroy(sim);
    scene_destroy(s);
    return n;
}

/* Neighbours that are driven differently: what an average over nodes would even out. Diffusion is as good as off, for the two forms have
 * each their own Laplacian. */
static void unlike_neighbours_agree(void) {
    double difference[3];
    for (int i = 0; i < 3; i++) {
        double *first, *second;
        int64_t n = driven_bar(false, drive_at_random, 1e-6, 0.1, 0.02, 40 << i, &first);
        driven_bar(true, drive_at_random, 1e-6, 0.1, 0.02, 40 << i, &second);
        difference[i] = 0;
        for (int64_t k = 0; k < n; k++) difference[i] = fmax(difference[i], fabs(first[k] - second[k]));
        memory_free(first, (size_t)n * 8), memory_free(second, (size_t)n * 8);
        printf("  %d steps: largest difference %.6f\n", 40 << i, difference[i]);
    }
    CHECK_ROW("METHOD 2", "the same, each particle driven by its own 0 to 10, largest difference: order", 1, log2(difference[1] / difference[2]), 0.05);
}

/* 20/21 is broken and nothing else is: the band ends where its drive ends. l0 = dx/2. */
static void a_narrow_band_breaks_itself_alone(void) {
    static const struct {
        const char *text;
        double eta;
        int steps;
        bool implicit;
    } rows[] = {{"explicit", 0.1, 400, false}, {"implicit, 400 steps", 0.1, 400, true}, {"implicit, eta 1e-9, 2 steps", 1e-9, 2, true}};
    double sums[3];
    for (int i = 0; i < 3; i++) {
        double *d, broken = 0;
        int64_t n = driven_bar(rows[i].implicit, drive_of_band, 0.05, rows[i].eta, 1, rows[i].steps, &d);
        sums[i] = 0;
        for (int64_t k = 0; k < n; k++) sums[i] += d[k], broken += d[k] > 0.9;
        memory_free(d, (size_t)n * 8);
        char text[128];
        snprintf(text, sizeof text, "band of driving force 20, two cells of twenty, l0 = dx/2: broken fraction, %s", rows[i].text);
        CHECK_ROW("METHOD 2", text, 0.1, broken / (double)n, 1e-9);
    }
    CHECK_ROW("METHOD 2", "the same: sum of damage, implicit over explicit", 1, sums[1] / sums[0], 0.03);
    CHECK_ROW("METHOD 2", "the same: sum of damage, eta 1e-9 in 2 steps over explicit", 1, sums[2] / sums[0], 0.03);
}

static void no_viscosity_is_the_rate_independent_limit(void) {
    CHECK_ROW("METHOD 2", "implicit, uniform driving force 3, eta 1e-9: d after one step", 0.75, driven_damage(true, 1e-9, 1e-3, 1), 1e-6);
    CHECK_ROW("METHOD 2", "implicit, uniform driving force 3, eta 0: d after one step", 0.75, driven_damage(true, 0, 1e-3, 1), 1e-6);
}

/* A cube held at F = s I under the phase field: d = K/(1 + K), K = 4 l0 (1 − r) Ψ⁺/G, one solve after Ψ⁺ is known; with a mobility M, after
 * n steps of Δt, d = K/(1 + K) (1 − (1 + (1 + K) M Δt)⁻ⁿ) (backward Euler of ċ = −M × residual). */
static double phase_field_damage(double stretch, double mobility, int steps) {
    scene *s = test_scene(test_cube, 10, 0.3, 1e6); /* heavy: it does not move within the steps */
    s->particles = 1000;
    test_set(s, "pff", "toughness", 2);
    test_set(s, "pff", "length_scale", 0.05);
    test_set(s, "pff", "mobility", mobility);
    test_set(s, "pff", "residual", 0.02);
    test_set(s, "pff", "tolerance", 1e-12);
    simulation *sim = test_simulation(s, 64, "auto", 2);
    solid *state;
    const solid_engine *engine = simulation_engine(sim, &state);
    record_list saved = {0};
    report r;
    CHECK(engine->save(state, &saved, &r) == STATUS_OK);
    record *F = record_find(&saved, "solid/deformation_gradient");
    for (int64_t n = 0; n < F->count * F->components; n++) ((double *)F->data)[n] *= stretch;
    CHECK(engine->restore(state, &saved, &r) == STATUS_OK);
    for (int i = 0; i < steps + 1; i++) CHECK(simulation_step(sim, 1e-6, &r) == STATUS_OK);
    simulation_measures m;
    simulation_measure(sim, &m, &r);
    record_clear(&saved);
    simulation_destroy(sim);
    scene_destroy(s);
    return m.solid.damage_mean;
}

static double phase_field_driving(double stretch) {
    double mu = 10 / 2.6, lambda = 10 * 0.3 / (1.3 * 0.4) + mu, J = stretch * stretch * stretch;
    double energy = 1.5 * mu * (stretch * stretch - 1) - mu * (J - 1) + (J >= 1 ? 0.5 * lambda * (J - 1) * (J - 1) : 0);
    return 4 * 0.05 * 0.98 * fmax(energy, 0) / 2; /* Ψμ alone can fall below 0 in compression: no drive */
}

static void the_phase_field_is_its_closed_form(void) {
    static const double stretches[] = {1.1, 0.9};
    for (int i = 0; i < 2; i++) {
        double K = phase_field_driving(stretches[i]);
        CHECK_ROW("METHOD 2", i ? "phase field (PFF), uniform squeeze 0.9: d" : "phase field (PFF), uniform stretch 1.1: d", K / (1 + K),
                  phase_field_damage(stretches[i], 0, 1), 1e-6);
    }
    double K = phase_field_driving(1.1), expected = K / (1 + K) * (1 - pow(1 + (1 + K) * 2e5 * 1e-6, -5));
    CHECK_ROW("METHOD 2", "phase field (PFF), mobility 2e5, five steps: d", expected, phase_field_damage(1.1, 2e5, 5), 1e-6);
}

int main(void) {
    RUN(the_phase_field_is_its_closed_form);
    RUN(notches_break_what_lies_inside);
    RUN(a_band_relaxes_to_its_exponential);
    RUN(the_operator_is_symmetric_positive_definite);
    RUN(explicit_and_implicit_agree);
    RUN(unlike_neighbours_agree);
    RUN(a_narrow_band_breaks_itself_alone);
    RUN(no_viscosity_is_the_rate_independent_limit);
    return check_finish();
}
