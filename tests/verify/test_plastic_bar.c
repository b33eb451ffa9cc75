/* What plastic flow makes of a body (METHOD.md §3).
 *
 * A bar of 4 × 1 × 1, E = 100, ν = 0.3, τy = 1 hardening by 10 (so that it stretches evenly), is pulled by its ends to a stretch over 1.1
 * and let go. F is what the flow leaves, the elastic part; the shape is in the positions:
 *     elastic stretch 1 + √1.5 (τy + 10 p)/E (2e-3),   whole stretch that times exp(√⅔ p) (3e-3).
 * After the release the elastic part is gone, length and volume stay, and nothing flows any more. In f32 it is the same bar to 2e-3.
 * Damage with σc = 6 beside it never sees a stress that the flow has relaxed; without flow the bar breaks. */
#include "check.h"
#include "verify/solid_scene.h"

#include "base/memory.h"
#include "solid/effects/list.h"

typedef struct bar_state {
    double stretch, volume, elastic, strain; /* of the middle: by positions; F's own stretch; mean plastic strain */
    double strain_most, damage_most;         /* anywhere */
} bar_state;

/* Slopes of current over rest position along each axis, by least squares, of the particles in the middle (the bar sits evenly about
 * the origin), and what F and the fields say. */
static bar_state look(simulation *sim, const double *rest, bool plastic) {
    solid *state;
    const solid_engine *engine = simulation_engine(sim, &state);
    int64_t n = simulation_get_plan(sim)->particles, used = 0;
    size_t row = (size_t)n * sizeof(double);
    double *F = memory_allocate(9 * row), *p = memory_allocate(row), *d = memory_allocate(row), *x = memory_allocate(3 * row);
    double both[3] = {0}, square[3] = {0};
    bar_state out = {0};
    engine->read(state, "deformation_gradient", F);
    engine->read(state, "position", x);
    engine->read(state, "damage", d);
    CHECK((engine->read(state, "plastic_strain", p) == 1) == plastic);
    for (int64_t i = 0; i < n; i++) {
        out.strain_most = fmax(out.strain_most, p[i]);
        out.damage_most = fmax(out.damage_most, d[i]);
        if (fabs(rest[3 * i]) > 0.7) continue;
        for (int c = 0; c < 3; c++) both[c] += x[3 * i + c] * rest[3 * i + c], square[c] += rest[3 * i + c] * rest[3 * i + c];
        out.elastic += F[9 * i];
        out.strain += p[i];
        used++;
    }
    out.elastic /= (double)used, out.strain /= (double)used;
    out.stretch = both[0] / square[0];
    out.volume = out.stretch * both[1] / square[1] * both[2] / square[2];
    memory_free(F, 9 * row);
    memory_free(p, row);
    memory_free(d, row);
    memory_free(x, 3 * row);
    return out;
}

/* States at the end of the pull, soon after, and later. */
static void pull_and_release(int precision, bool plastic, bar_state out[3]) {
    static const double at[3] = {1.5, 6, 8};
    scene *s = test_scene(test_bar, 100, 0.3, 1);
    s->particles = 2000;
    s->transfer = TRANSFER_RPIC; /* damps what the release sets going */
    for (int side = -1; side <= 1; side += 2) {
        double low[3] = {side < 0 ? -4 : 1.75, -2, -2}, high[3] = {side < 0 ? -1.75 : 4, 2, 2};
        s->grips[s->grip_count++] = (scene_grip){.shape = shape_box(s->memory, low, high), .stop = at[0], .protects = true,
                                                 .velocity = {.outputs = 3, .constant = {0.2 * side, 0, 0}}};
    }
    if (plastic) test_set(s, "plastic", "yield_stress", 1), test_set(s, "plastic", "hardening", 10);
    test_set(s, "damage", "sigma_c", 6);
    test_set(s, "damage", "eta", 0.05);
    simulation *sim = test_simulation(s, precision, "auto", 2);
    report r;
    int64_t n = simulation_get_plan(sim)->particles;
    double *rest = memory_allocate((size_t)n * 24);
    solid *state;
    simulation_engine(sim, &state)->read(state, "position", rest);
    for (int k = 0; k < 3; k++) {
        while (simulation_time(sim) < at[k]) CHECK(simulation_step(sim, 0, &r) == STATUS_OK);
        out[k] = look(sim, rest, plastic);
        printf("  f%d %s t = %g: stretch %.4f (elastic %.4f), volume %.4f, plastic strain %.4f, damage %.3f\n", precision,
               plastic ? "plastic" : "elastic", at[k], out[k].stretch, out[k].elastic, out[k].volume, out[k].strain, out[k].damage_most);
    }
    memory_free(rest, (size_t)n * 24);
    simulation_destroy(sim);
    scene_destroy(s);
}

static void a_bar_keeps_its_new_shape(void) {
    bar_state single[3], wide[3], elastic[3];
    pull_and_release(32, true, single);
    pull_and_release(64, true, wide);
    pull_and_release(64, false, elastic);
    CHECK_NEAR(wide[0].elastic - 1, sqrt(1.5) * (1 + 10 * wide[0].strain) / 100, 2e-3);
    CHECK_NEAR(wide[0].stretch, wide[0].elastic * exp(sqrt(2.0 / 3) * wide[0].strain), 3e-3);
    CHECK(wide[1].stretch > 1.1 && fabs(wide[1].elastic - 1) < 5e-3);
    CHECK_NEAR(wide[2].stretch / wide[1].stretch, 1, 1e-3);
    CHECK(wide[2].strain_most - wide[1].strain_most < 1e-4);
    CHECK_NEAR(wide[2].volume, 1, 2e-3);
    CHECK(wide[2].damage_most == 0 && elastic[0].damage_most > 0.5);
    CHECK_NEAR(single[2].stretch, wide[2].stretch, 2e-3);
    CHECK_NEAR(single[2].volume, wide[2].volume, 2e-3);
}

static void plastic_runs_before_damage(void) {
    char names[64][48];
    const solid_engine *engine = solid_engine_find(64, "plain");
    int count = engine->stages(1u << EFFECT_plastic | 1u << EFFECT_damage | 1u << EFFECT_elastic, names, 64), plastic = -1, damage = -1;
    for (int i = 0; i < count; i++) {
        if (strcmp(names[i], "plastic.update") == 0) plastic = i;
        if (strcmp(names[i], "damage.update") == 0) damage = i;
    }
    CHECK(plastic >= 0 && damage > plastic);
}

static void wrong_materials_are_named(void) {
    report r;
    scene *s = test_scene(test_bar, 100, 0.3, 1);
    test_set(s, "plastic", NULL, 0);
    CHECK(scene_validate(s, &r) == STATUS_INPUT && strstr(r.key, "plastic.yield_stress"));
    test_set(s, "plastic", "yield_stress", 1);
    CHECK(scene_validate(s, &r) == STATUS_OK);
    s->materials[0].effects[EFFECT_elastic].on = false;
    CHECK(scene_validate(s, &r) == STATUS_INPUT && strstr(r.expected, "elasticity"));
    scene_destroy(s);
}

int main(void) {
    RUN(plastic_runs_before_damage);
    RUN(wrong_materials_are_named);
    RUN(a_bar_keeps_its_new_shape);
    return check_finish();
}
