/* The corotated model in a whole scene.
 *
 * A material has one elastic model: none and both are input errors that name the choice; what needs elasticity takes either. A bar
 * of E = 100, ν = 0.3 stretched slowly by 0.4 % stores the same energy in both models (both are Hooke's law there) to 2 %, in f32
 * and f64, and takes the same work from its grips. */
#include "check.h"
#include "verify/solid_scene.h"

#include "base/memory.h"
#include "solid/effects/list.h"

static scene *bar_scene(bool elastic, bool corotated) {
    scene *s = test_scene(test_bar, 100, 0.3, 1);
    s->materials[0].effects[EFFECT_elastic].on = elastic;
    if (!corotated) return s;
    test_set(s, "corotated", "E", 100);
    test_set(s, "corotated", "nu", 0.3);
    return s;
}

static void a_material_has_one_elastic_model(void) {
    report r;
    scene *both = bar_scene(true, true), *none = bar_scene(false, false), *one = bar_scene(false, true);
    CHECK(scene_validate(both, &r) == STATUS_INPUT);
    CHECK(strstr(r.expected, "one of 'elastic' and 'corotated'") && strstr(r.found, "both") && strcmp(r.key, "corotated") == 0);
    CHECK(scene_validate(none, &r) == STATUS_INPUT);
    CHECK(strstr(r.expected, "elastic = { … } or corotated = { … }"));
    test_set(none, "damage", "break_stretch", 0.2);
    CHECK(scene_validate(none, &r) == STATUS_INPUT);
    CHECK(strcmp(r.key, "damage") == 0 && strstr(r.expected, "elastic = { … } or corotated = { … }"));
    CHECK(scene_validate(one, &r) == STATUS_OK);
    test_set(one, "damage", "break_stretch", 0.2);
    test_set(one, "plastic", "yield_stress", 1);
    CHECK(scene_validate(one, &r) == STATUS_OK);
    test_set(one, "corotated", "nu", 0.5);
    CHECK(scene_validate(one, &r) == STATUS_INPUT && strcmp(r.key, "corotated.nu") == 0);
    scene_destroy(both);
    scene_destroy(none);
    scene_destroy(one);
}

static solid_measures stretch_slowly(bool corotated, int precision) {
    scene *s = bar_scene(!corotated, corotated);
    s->particles = 2000;
    s->transfer = TRANSFER_RPIC;
    test_pull(s, 1.75, 2e-3);
    simulation *sim = test_simulation(s, precision, "auto", 2);
    report r;
    simulation_measures m;
    while (simulation_time(sim) < 4) CHECK(simulation_step(sim, 0, &r) == STATUS_OK);
    simulation_measure(sim, &m, &r);
    simulation_destroy(sim);
    scene_destroy(s);
    printf("  %s f%d: stored %.4e, work %.4e\n", corotated ? "corotated" : "elastic  ", precision, m.solid.elastic, m.solid.grip_work);
    return m.solid;
}

static void small_stretch_is_the_same(void) {
    solid_measures elastic = stretch_slowly(false, 64);
    for (int precision = 32; precision <= 64; precision += 32) {
        solid_measures m = stretch_slowly(true, precision);
        CHECK_NEAR(m.elastic / elastic.elastic, 1, 0.02);
        CHECK_NEAR(m.grip_work / elastic.grip_work, 1, 0.02);
    }
}

int main(void) {
    RUN(a_material_has_one_elastic_model);
    RUN(small_stretch_is_the_same);
    return check_finish();
}
