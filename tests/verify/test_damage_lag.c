/* What the single pass of the damage update costs (METHOD.md §2), f64.
 *
 * In one pass damage rides to the grid with the momentum, at the positions of xⁿ, and its Laplacian comes back with the same weights, after the
 * particles have moved: only the Laplacian's places lag, by O(Δt). The two-pass version here takes dⁿ to the grid again, at xⁿ⁺¹, and updates d
 * from that. A cube that is torn while it flies: the difference in d falls at first order in Δt, and at the automatic step's
 * length (40 steps) is below 2e-3. In both, no particle's d falls or leaves [0, 1] at any step. */
#include "check.h"
#define SUNDER_PRECISION 64
#define SUNDER_SIMD 0
#include "../src/solid/transfer.c"
#include "verify/solid_particles.h"

static const double DX = 0.1, END = 0.2;

static status torn_in_flight(void *context, const double *x, int inputs, double *v, int outputs, report *r) {
    (void)context, (void)inputs, (void)outputs, (void)r;
    v[0] = 1 + 2 * sin(M_PI * x[0]), v[1] = 0.5 + 0.3 * x[2], v[2] = -0.7;
    return STATUS_OK;
}

/* Forgets what the step did to d and H, takes d to the grid from where the particles are now, and updates once more. */
static void update_again(solid *s, const real *d, const real *H, double dt) {
    size_t bytes = (size_t)s->pack_count * PACK * sizeof(real);
    memcpy(s->fields[s->damage_field].data, d, bytes);
    memcpy(s->fields[s->history_field].data, H, bytes);
    report r;
    if (!s->sorted) CHECK(particles_sort(s, &r) == STATUS_OK); /* a kernel may be about to leave its block's window */
    transfer_to_grid(s, 0);
    for (int64_t slot = 0; slot < s->slot_count; slot++) damage_from_sums(s->damage_grid + slot * BLOCK_NODES * DAMAGE_NODE);
    solid_worker *own = &s->workers[0];
    for (int32_t b = 0; b < s->block_count; b++) {
        exchange_window(&s->blocks[b], own->damage_window, s->damage_grid, 1, BLOCK_NODES * DAMAGE_NODE, true, false);
        for (int32_t t = s->blocks[b].first_tile; t < s->blocks[b].first_tile + s->blocks[b].tile_count; t++) {
            tile_work w = {.state = s, .tile = &s->tiles[t], .scratch = &own->tile, .result = &s->tile_results[t], .dt = dt};
            gather_laplacian(&w, KERNEL_CUBIC, own->damage_window);
            CALL_STAGE(&w, update);
        }
    }
}

/* d has not fallen, nor left [0, 1], since `last` [count], which becomes what it is now. */
static void check_growth(simulation *sim, double *last) {
    double *now = particles_get(sim, "damage");
    for (int64_t i = 0; i < simulation_get_plan(sim)->particles; i++) {
        CHECK(now[i] >= last[i] && now[i] <= 1);
        last[i] = now[i];
    }
    particles_drop(sim, now);
}

/* d of all particles at the end; free with memory_free. */
static double *tear(bool two_passes, int steps, int64_t *count) {
    scene *s = test_scene(test_cube, 10, 0.3, 1);
    s->dx = DX;
    s->kernel = s->laplacian = KERNEL_CUBIC;
    s->bodies[0].velocity = (scene_function){.outputs = 3, .call = torn_in_flight};
    test_set(s, "damage", "sigma_c", 2);
    test_set(s, "damage", "eta", 0.5);
    test_set(s, "damage", "length_scale", 2 * DX);
    simulation *sim = test_simulation(s, 64, "plain", 1);
    solid *state;
    const solid_engine *engine = simulation_engine(sim, &state);
    size_t bytes = (size_t)state->pack_capacity * PACK * sizeof(real);
    real *d = memory_allocate(2 * bytes), *H = memory_allocate(2 * bytes);
    double *last = particles_get(sim, "damage");
    report r;
    for (int step = 0; step < steps; step++) {
        if (!state->sorted) CHECK(engine->sort(state, &r) == STATUS_OK);
        size_t used = (size_t)state->pack_count * PACK * sizeof(real);
        CHECK(used <= 2 * bytes);
        memcpy(d, state->fields[state->damage_field].data, used);
        memcpy(H, state->fields[state->history_field].data, used);
        CHECK(simulation_step(sim, END / steps, &r) == STATUS_OK);
        if (two_passes) update_again(state, d, H, END / steps);
        check_growth(sim, last);
    }
    *count = simulation_get_plan(sim)->particles;
    double *out = memory_allocate((size_t)*count * sizeof *out);
    engine->read(state, "damage", out);
    particles_drop(sim, last);
    memory_free(d, 2 * bytes), memory_free(H, 2 * bytes);
    simulation_destroy(sim);
    scene_destroy(s);
    return out;
}

static void the_lag_is_of_first_order(void) {
    double worst[3], largest = 0, mean = 0;
    for (int i = 0; i < 3; i++) {
        int64_t n;
        double *one = tear(false, 40 << i, &n), *two = tear(true, 40 << i, &n);
        worst[i] = 0, mean = 0;
        for (int64_t p = 0; p < n; p++) {
            worst[i] = fmax(worst[i], fabs(one[p] - two[p]));
            largest = fmax(largest, two[p]), mean += two[p] / (double)n;
        }
        printf("  %d steps: largest difference %.2e (d up to %.3f, mean %.3f)\n", 40 << i, worst[i], largest, mean);
        memory_free(one, (size_t)n * sizeof *one), memory_free(two, (size_t)n * sizeof *two);
    }
    CHECK(largest > 0.3 && largest < 1);
    CHECK_ROW("METHOD 2", "one pass against two, a cube torn in flight: largest difference of d, 40 steps", 0, worst[0], 2e-3);
    CHECK_ROW("METHOD 2", "the same: order in the time step", 1, log2(worst[1] / worst[2]), 0.3);
}

int main(void) {
    RUN(the_lag_is_of_first_order);
    return check_finish();
}
