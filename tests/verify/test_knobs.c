/* Knobs: the list, words and values; and that every parameter that says it is live acts when it is turned.
 *
 * Of each effect's live parameters one is turned in the middle of a small run, in f32 and f64. The run then differs from the one that was not turned; it
 * has the same bits at 1, 2 and 3 threads, when its state at the turn is restored into a fresh simulation and turned there, and when a later state is
 * restored into one that was given the turn beforehand: what a turn leaves in an engine must not depend on how its state was reached. */
#include "check.h"
#include "verify/solid_scene.h"

#include "base/memory.h"
#include "solid/moduli.h"

enum { BEFORE = 3, FRAMES = 5, LIST = KNOB_LIMIT };

/* ---- scenes ------------------------------------------------------------------------------------------------------ */

static const shape *bar(arena *a) {
    return shape_box(a, (const double[]){-0.6, -0.2, -0.2}, (const double[]){0.6, 0.2, 0.2});
}

static void pull_apart(scene *s, double speed) {
    for (int side = -1; side <= 1; side += 2) {
        double low[3] = {side < 0 ? -5 : 0.45, -5, -5}, high[3] = {side < 0 ? -0.45 : 5, 5, 5};
        s->grips[s->grip_count++] = (scene_grip){.shape = shape_box(s->memory, low, high), .stop = HUGE_VAL, .protects = true,
                                                 .velocity = {.outputs = 3, .constant = {side * speed, 0.2 * side * speed, 0}}};
    }
}

static scene *solid_scene(const char *elasticity, int families) {
    scene *s = test_scene(bar, 2e3, 0.3, 10);
    int count;
    const effect *const *effects = effect_catalogue(&count);
    s->particles = 400;
    s->fps = 60;
    s->seed = 5;
    s->bodies[0].sampling = SAMPLING_JITTERED;
    s->bodies[0].fibres = (scene_fibres){.families = families, .direction = {.outputs = 3 * families, .constant = {1, 1, 0, -1, 1, 0}}};
    effect_values *gravity = &s->effects[effect_index("gravity")], *damping = &s->effects[effect_index("mass_damping")];
    gravity->on = gravity->given[0] = damping->on = damping->given[0] = true;
    gravity->value[0][1] = -2;
    damping->value[0][0] = 0.3;
    for (int e = 0; e < count; e++)
        if (effect_supplies(effects[e], ELASTICITY)) s->materials[0].effects[e].on = strcmp(effects[e]->name, elasticity) == 0;
    test_set(s, elasticity, "E", 2e3);
    test_set(s, elasticity, "nu", 0.3);
    pull_apart(s, 2);
    return s;
}

/* Damage is under way when a knob is turned (its mean goes from 0.05 to 0.23); then the bar is let go, and what drives damage falls. */
static scene *explicit_damage(void) {
    scene *s = solid_scene("elastic", 2);
    test_set(s, "fibres", "gamma", 5);
    test_set(s, "fibres", "gamma2", 2);
    test_set(s, "damage", "break_stretch", 0.1);
    test_set(s, "damage", "alpha", -0.6);
    test_set(s, "damage", "alpha2", -0.3);
    test_set(s, "damage", "eta", 0.12);
    for (int g = 0; g < s->grip_count; g++) {
        s->grips[g].stop = (BEFORE + 1) / s->fps;
        s->grips[g].velocity.constant[0] *= 0.3;
    }
    return s;
}

/* Its damage, not its waves, limits the step: a limit that the last step left behind, and a turn changes. */
static scene *brittle_damage(void) {
    scene *s = explicit_damage();
    test_set(s, "damage", "eta", 0.004);
    return s;
}

static scene *implicit_damage(void) {
    scene *s = solid_scene("elastic", 1);
    test_set(s, "fibres", "gamma", 5);
    test_set(s, "damage", "sigma_c", 40);
    test_set(s, "damage", "form", 1);
    test_set(s, "damage", "eta", 0.005);
    return s;
}

static scene *snapping_fibres(void) {
    scene *s = solid_scene("elastic", 1);
    test_set(s, "fibres", "gamma", 5);
    test_set(s, "snapping", "snap_strain", 0.01);
    test_set(s, "snapping", "snap_time", 0.1);
    return s;
}

static scene *plastic_phase_field(void) {
    scene *s = solid_scene("corotated", 0);
    test_set(s, "plastic", "yield_stress", 30);
    test_set(s, "plastic", "hardening", 50);
    test_set(s, "pff", "toughness", 0.05);
    test_set(s, "pff", "mobility", 50);
    return s;
}

static scene *inextensible(void) {
    scene *s = solid_scene("elastic", 1);
    s->particles = 200;
    s->grip_count = 1;
    test_set(s, "inextensible", "relaxation", 1e-4);
    return s;
}

static scene *tetrahedra(void) {
    scene *s = solid_scene("elastic", 1);
    s->bodies[0].discretisation = DISCRETISATION_TETRAHEDRA;
    s->dx = 0.15;
    s->particles = 0;
    test_set(s, "fibres", "gamma", 5);
    return s;
}

static scene *sheet_scene(const char *law) {
    scene *s = scene_create();
    int count;
    const effect *const *effects = effect_catalogue(&count);
    snprintf(s->file, sizeof s->file, "test");
    s->fps = 60;
    s->material_count = 1;
    snprintf(s->materials[0].name, sizeof s->materials[0].name, "skin");
    s->materials[0].density = 100;
    for (int e = 0; e < count; e++) effect_values_default(effects[e], &s->materials[0].effects[e]);
    s->sheet_count = 1;
    s->sheets[0] = (scene_sheet){.name = "skin", .radius = 1.5, .thickness = 0.02, .spacing = 0.08, .ripple = 0.05,
                                 .region = {.shape = shape_box(s->memory, (const double[]){-0.6, -0.6, -1}, (const double[]){0.6, 0.6, 1}), .normal = {0, 0, 1}},
                                 .grain = {.families = 1, .direction = {.outputs = 3, .constant = {1, 0.5, 0}}}};
    scene_sheet *b = &s->sheets[0];
    b->sources[b->source_count++] = (scene_source){.value = {.outputs = 1, .constant = {4}}, .stop = HUGE_VAL, .strength = 1, .on = 1};
    b->sources[b->source_count++] = (scene_source){.shape = shape_sphere(s->memory, (const double[]){0, 0.3, 0}, 0.2), .fixed = true, .strength = 1, .on = 1,
                                                   .value = {.outputs = 1, .constant = {0.7}}, .stop = HUGE_VAL};
    b->notches[b->notch_count++] = (scene_notch){.from = {-0.7, 0.01, 0}, .to = {-0.2, 0.01, 0}};
    effect_values *gravity = &s->effects[effect_index("gravity")];
    gravity->on = gravity->given[0] = true;
    gravity->value[0][2] = -1;
    test_set(s, law, "E", 2e3);
    test_set(s, "diffusion", "k", 0.5);
    test_set(s, "swelling", "alpha", 0.05);
    test_set(s, "softening", "stiffness", 0.3);
    pull_apart(s, 2);
    return s;
}

static scene *linear_sheet(void) {
    scene *s = sheet_scene("linear");
    s->sheets[0].spacing = 0.05;
    test_set(s, "linear", "nu", 0.2);
    test_set(s, "fracture", "G", 0.02);
    test_set(s, "softening", "toughness", 0.4);
    test_set(s, "grain", "stiffness", 2);
    test_set(s, "grain", "toughness", 1.5);
    test_set(s, "bending", "stiffness", 1e-4);
    test_set(s, "self_contact", "distance", 0.9);
    test_set(s, "drag", "coefficient", 0.5);
    test_set(s, "damping", "rate", 0.5);
    return s;
}

static scene *rubber_sheet(void) {
    scene *s = sheet_scene("rubber");
    test_set(s, "rubber", "c_star", -0.02);
    test_set(s, "fracture", "stretch", 0.1);
    test_set(s, "softening", "stretch", 0.4);
    return s;
}

static scene *plastic_sheet(void) {
    scene *s = sheet_scene("elastoplastic");
    test_set(s, "elastoplastic", "eta0", 0.01);
    test_set(s, "elastoplastic", "beta", 0.5);
    test_set(s, "fracture", "stretch", 0.15);
    return s;
}

/* Beside a stiff sheet: regions that step at different rates. */
static scene *multirate_sheets(void) {
    scene *s = sheet_scene("linear");
    test_set(s, "fracture", "G", 0.02);
    test_set(s, "multirate", "levels", 3);
    s->materials[1] = s->materials[0];
    snprintf(s->materials[1].name, sizeof s->materials[1].name, "hide");
    s->material_count = 2;
    test_set_material(s, 1, "linear", "E", 1e5);
    test_set(s, "multirate", "levels", 1); /* the most that any material allows holds */
    s->sheets[1] = s->sheets[0];
    s->sheets[1].material = 1;
    s->sheets[1].source_count = 0;
    s->sheet_count = 2;
    return s;
}

/* A bar that is fed, swells along and across its fibres and softens while it tears. */
static scene *wet_bar(void) {
    scene *s = explicit_damage();
    scene_body *b = &s->bodies[0];
    b->sources[b->source_count++] = (scene_source){.value = {.outputs = 1, .constant = {4}}, .stop = HUGE_VAL, .strength = 1, .on = 1};
    b->sources[b->source_count++] = (scene_source){.shape = shape_sphere(s->memory, (const double[]){0, 0.1, 0}, 0.2), .fixed = true, .strength = 1, .on = 1,
                                                   .value = {.outputs = 1, .constant = {0.7}}, .stop = HUGE_VAL};
    test_set(s, "diffusion", "k", 3);
    test_set(s, "diffusion", "decay", 0.5);
    test_set(s, "swelling", "alpha", 0.05);
    test_set(s, "swelling", "along", -0.02);
    test_set(s, "softening", "stiffness", 0.3);
    test_set(s, "softening", "strength", 0.4);
    return s;
}

/* A bar and a sheet in one scene. */
static scene *both_kinds(void) {
    scene *s = sheet_scene("linear"), *from = explicit_damage();
    s->materials[1] = from->materials[0];
    s->material_count = 2;
    s->bodies[0] = from->bodies[0];
    s->bodies[0].shape = bar(s->memory);
    s->bodies[0].material = 1;
    s->body_count = 1;
    s->particles = 300;
    effect_values *contact = &s->effects[effect_index("contact")];
    contact->on = contact->given[0] = true;
    contact->value[0][0] = 0.2;
    scene_destroy(from);
    return s;
}

/* ---- runs -------------------------------------------------------------------------------------------------------- */

static bool advance(simulation *sim, int frames) {
    report r;
    for (int f = 0; f < frames; f++)
        if (simulation_advance(sim, NULL, &r) != STATUS_OK) {
            printf("  %s\n", r.message);
            return false;
        }
    return true;
}

/* Of everything that frames and ledgers hold. */
static uint64_t hash_of(simulation *sim) {
    report r;
    uint64_t hash = 0;
    simulation_measures m;
    if (simulation_hash(sim, &hash, &r) != STATUS_OK || simulation_measure(sim, &m, &r) != STATUS_OK) return 0;
    return hash ^ (uint64_t)simulation_steps(sim) << 40;
}

typedef struct rig {
    scene *(*make)(void);
    int precision;
    record_list at_turn; /* the state that all start from */
    uint64_t unturned;
} rig;

static simulation *start(scene *s, const rig *g, int threads) {
    return test_simulation(s, g->precision, "auto", threads);
}

static void prepare(rig *g) {
    scene *s = g->make();
    report r;
    simulation *sim = start(s, g, 1);
    g->unturned = 0;
    CHECK(sim != NULL);
    if (sim) {
        CHECK(advance(sim, BEFORE) && simulation_save(sim, &g->at_turn, &r) == STATUS_OK && advance(sim, FRAMES - BEFORE));
        g->unturned = hash_of(sim);
    }
    simulation_destroy(sim);
    scene_destroy(s);
}

static bool turn(simulation *sim, const char *path, const double value[3]) {
    report r;
    char text[512];
    if (simulation_turn(sim, path, value, &r) == STATUS_OK) return true;
    report_format(&r, text, sizeof text);
    printf("  %s\n", text);
    return false;
}

/* Never stopped; the state one frame after the turn on the way. */
static uint64_t run_straight(const rig *g, const char *path, const double value[3], record_list *after) {
    scene *s = g->make();
    report r;
    simulation *sim = start(s, g, 1);
    bool good = sim && advance(sim, BEFORE) && turn(sim, path, value) && advance(sim, 1) && simulation_save(sim, after, &r) == STATUS_OK &&
                advance(sim, FRAMES - BEFORE - 1);
    uint64_t hash = good ? hash_of(sim) : 0;
    simulation_destroy(sim);
    scene_destroy(s);
    return hash;
}

/* Restored where the turn is made. */
static uint64_t run_restored(const rig *g, const char *path, const double value[3]) {
    scene *s = g->make();
    report r;
    simulation *sim = start(s, g, 2);
    bool good = sim && simulation_restore(sim, &g->at_turn, &r) == STATUS_OK && turn(sim, path, value) && advance(sim, FRAMES - BEFORE);
    uint64_t hash = good ? hash_of(sim) : 0;
    simulation_destroy(sim);
    scene_destroy(s);
    return hash;
}

/* Restored after it was made, knowing it from a list. */
static uint64_t run_replayed(const rig *g, const knob *k, const double value[3], const record_list *after) {
    scene *s = g->make();
    report r;
    knob_turn listed = {.frame = BEFORE};
    simulation *sim = start(s, g, 3);
    memcpy(listed.path, k->path, sizeof listed.path);
    knob_print(k, value, listed.value);
    bool good = sim && simulation_replay_turns(sim, &listed, 1, &r) == STATUS_OK && simulation_restore(sim, after, &r) == STATUS_OK &&
                advance(sim, FRAMES - BEFORE - 1);
    uint64_t hash = good ? hash_of(sim) : 0;
    simulation_destroy(sim);
    scene_destroy(s);
    return hash;
}

/* ---- what each is turned to -------------------------------------------------------------------------------------- */

/* Where a third more is not what shows. */
static const struct {
    const char *key;
    double value;
} special[] = {{"tolerance", 1e-9}, {"solver", 1}, {"poisson", 1}, {"weight", 1}, {"as_shipped", 1}, {"lame", 1}, {"n", 3}, {"floor", 0.97}, {"trapping", 0},
               {"alpha", -0.9}, {"alpha2", -0.9}, {"distance", 0.98}, {"decay", 2}, {"nu", 0.25}, {"stretch", 0.05}, {"residual", 0.3}, {"cfl", 0.3}, {"levels", 1}, {"cracking", 2}, {"heated", 2}, {"dt", 2e-4}};

static void other_value(const knob *k, double value[3]) {
    for (int c = 0; c < 3; c++) value[c] = 1.3 * k->value[c] + (k->value[c] == 0 ? 0.2 : 0);
    for (size_t i = 0; i < sizeof special / sizeof *special; i++)
        if (strcmp(special[i].key, k->key) == 0) value[0] = special[i].value;
    if (k->kind == PARAMETER_BOOLEAN) value[0] = k->value[0] == 0;
    if (value[0] > k->maximum) value[0] = 0.5 * (k->minimum + k->maximum);
}

/* Parameters that some scene has shown to act, by effect and key; and those that cannot show it. */
static bool acted[EFFECT_LIMIT][PARAMETER_LIMIT];

/* What bonds cannot have is known to their engine alone: of G, stretch and beta two fix the third. */
static bool engine_refuses(const rig *g, const knob *k) {
    return g->make == plastic_sheet && strcmp(k->path, "skin.fracture.G") == 0;
}

/* A second family of fibres, where there is but one, is refused: another scene has two. */
static bool can_turn(const rig *g, const knob *k, const double value[3]) {
    scene *s = g->make();
    report r;
    bool can = scene_validate(s, &r) == STATUS_OK && scene_turn(s, k->path, value, NULL, &r) == STATUS_OK;
    if (!can) CHECK(strstr(r.expected, "fibre directions") != NULL);
    scene_destroy(s);
    return can;
}

/* A word that both engines have means that of the engine whose bodies have the material. */
static int effect_of(const rig *g, const knob *k) {
    scene *s = g->make();
    bool of_sheet = false;
    for (int b = 0; b < s->sheet_count; b++) of_sheet |= s->sheets[b].material == k->material;
    int e = effect_index_of(of_sheet ? ENGINE_SHEET : ENGINE_SOLID, k->effect);
    scene_destroy(s);
    return e;
}

static void turn_one(const rig *g, const knob *k) {
    double value[3];
    record_list after = {0};
    other_value(k, value);
    if (engine_refuses(g, k) || !can_turn(g, k, value)) return;
    uint64_t straight = run_straight(g, k->path, value, &after);
    bool same = straight && straight == run_restored(g, k->path, value) && straight == run_replayed(g, k, value, &after);
    if (!same) printf("  %s turned to %g (f%d)\n", k->path, value[0], g->precision);
    CHECK(same);
    record_clear(&after);
    if (straight == g->unturned) return;
    if (*k->effect) {
        /* Regions of many rates are made anew at every turn: what acts there alone has been forgotten where a turn changes only what it must. */
        if (g->make == multirate_sheets && strcmp(k->effect, "multirate") != 0) return;
        int count, e = effect_of(g, k);
        acted[e][effect_parameter(effect_catalogue(&count)[e], k->key)] = true;
    } else {
        CHECK(straight != g->unturned);
    }
}

static void turn_all(scene *(*make)(void)) {
    knob *list = memory_allocate_array(LIST, sizeof *list);
    scene *s = make();
    report r;
    CHECK(scene_validate(s, &r) == STATUS_OK);
    int count = scene_knobs(s, s, list, LIST);
    for (int precision = 32; precision <= 64; precision += 32) {
        rig g = {.make = make, .precision = precision};
        prepare(&g);
        for (int i = 0; i < count && g.unturned; i++)
            if (list[i].live) turn_one(&g, &list[i]);
        record_clear(&g.at_turn);
    }
    scene_destroy(s);
    memory_free(list, LIST * sizeof *list);
}

static void turns_act_in_solids_that_crack(void) {
    turn_all(explicit_damage);
}

static void turns_act_where_damage_limits_the_step(void) {
    turn_all(brittle_damage);
}

static void turns_act_in_implicit_damage(void) {
    turn_all(implicit_damage);
}

static void turns_act_on_fibres_that_snap(void) {
    turn_all(snapping_fibres);
}

static void turns_act_in_plastic_bodies_with_a_phase_field(void) {
    turn_all(plastic_phase_field);
}

static void turns_act_on_inextensible_fibres(void) {
    turn_all(inextensible);
}

static void turns_act_on_tetrahedra(void) {
    turn_all(tetrahedra);
}

static void turns_act_in_linear_sheets(void) {
    turn_all(linear_sheet);
}

static void turns_act_in_rubber_sheets(void) {
    turn_all(rubber_sheet);
}

static void turns_act_in_plastic_sheets(void) {
    turn_all(plastic_sheet);
}

static void a_turn_that_the_engine_refuses_leaves_no_trace(void) {
    rig g = {.make = plastic_sheet, .precision = 32};
    report r;
    prepare(&g);
    scene *s = g.make();
    simulation *sim = start(s, &g, 1);
    CHECK(sim && advance(sim, BEFORE) && simulation_turn_text(sim, "fracture.G", "0.2", &r) == STATUS_INPUT && strstr(r.expected, "two of"));
    CHECK(sim && advance(sim, FRAMES - BEFORE) && hash_of(sim) == g.unturned);
    simulation_destroy(sim);
    scene_destroy(s);
    record_clear(&g.at_turn);
}

static void turns_act_in_sheets_of_many_rates(void) {
    turn_all(multirate_sheets);
}

static void turns_act_in_wet_bodies(void) {
    turn_all(wet_bar);
}

static void turns_act_where_solids_and_sheets_are(void) {
    turn_all(both_kinds);
}

/* Parameters that may be turned and need not show it. */
static const struct {
    const char *effect, *key, *why;
} silent[] = {{"inextensible", "solver", "another way to the same solution: auto is jacobi's while that is quick"},
              {"rubber", "nu", "rubber's bonds have the ratio 1/3: it acts where calibration is the paper's"}};

static bool is_silent(const char *name, const char *key) {
    for (size_t i = 0; i < sizeof silent / sizeof *silent; i++)
        if (strcmp(silent[i].effect, name) == 0 && strcmp(silent[i].key, key) == 0) return true;
    return false;
}

/* After all scenes. */
static void every_live_parameter_of_every_effect_acts(void) {
    int count;
    const effect *const *effects = effect_catalogue(&count);
    for (int e = 0; e < count; e++)
        for (int k = 0; k < effects[e]->parameter_count; k++) {
            const parameter *p = &effects[e]->parameters[k];
            if (is_silent(effects[e]->name, p->key)) continue;
            if (p->live && !acted[e][k]) printf("  %s.%s is live and has changed no run\n", effects[e]->name, p->key);
            CHECK(!p->live || acted[e][k]);
            CHECK(p->live == !p->why_not); /* who is not says why */
        }
}

/* ---- the list, words and values ---------------------------------------------------------------------------------- */

typedef struct listed {
    scene *s;
    knob list[LIST];
    int count;
    report r;
} listed;

static listed *list_knobs(scene *(*make)(void)) {
    listed *l = memory_allocate(sizeof *l);
    l->s = make();
    CHECK(scene_validate(l->s, &l->r) == STATUS_OK);
    l->count = scene_knobs(l->s, l->s, l->list, LIST);
    return l;
}

static void free_listed(listed *l) {
    scene_destroy(l->s);
    memory_free(l, sizeof *l);
}

static const knob *named(listed *l, const char *word) {
    int found = knob_find(l->list, l->count, word, &l->r);
    return found < 0 ? NULL : &l->list[found];
}

static void knobs_are_found_by_the_words_of_set(void) {
    listed *l = list_knobs(explicit_damage);
    const knob *eta = named(l, "block.damage.eta");
    CHECK(eta && eta == named(l, "eta") && eta == named(l, "damage.eta") && eta == named(l, "block.eta"));
    CHECK(eta && eta->live && eta->logarithmic && eta->value[0] == 0.12 && eta->start[0] == 0.12 && eta->fallback[0] == 0.1 && eta->material == 0);
    CHECK(named(l, "gravity") && strcmp(named(l, "gravity")->path, "gravity.acceleration") == 0 && named(l, "gravity")->components == 3);
    CHECK(!named(l, "bock.damage.etta") && strcmp(l->r.nearest, "block.damage.eta") == 0);
    CHECK(!named(l, "damage.etta") && l->r.code == STATUS_INPUT);
    const knob *density = named(l, "density");
    CHECK(density && !density->live && strstr(density->why_not, "restart"));
    const knob *sigma = named(l, "sigma_c"), *stretch = named(l, "break_stretch");
    CHECK(sigma && stretch && &l->list[sigma->twin] == stretch && &l->list[stretch->twin] == sigma);
    CHECK(sigma && sigma->derived && stretch && !stretch->derived);
    CHECK(named(l, "cfl") && named(l, "cfl")->live);
    free_listed(l);
    l = list_knobs(linear_sheet);
    CHECK(!named(l, "stiffness") && strstr(l->r.expected, "skin.softening.stiffness") && strstr(l->r.expected, "skin.grain.stiffness"));
    CHECK(named(l, "sources.2.strength") && named(l, "sources.2.strength")->value[0] == 1 && !named(l, "sources.3.strength"));
    free_listed(l);
}

static void values_go_through_text_to_the_bit(void) {
    listed *l = list_knobs(explicit_damage);
    char text[KNOB_TEXT];
    double back[3];
    const knob *eta = named(l, "eta"), *gravity = named(l, "gravity"), *lame = named(l, "lame"), *shipped = named(l, "as_shipped");
    static const double values[][3] = {{0.1}, {1.0 / 3}, {1e-300}, {5e-324}, {123456.789012345678}, {0}};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        knob_print(eta, values[i], text);
        CHECK(knob_parse(eta, text, back, &l->r) == STATUS_OK && memcmp(back, values[i], sizeof **values) == 0);
    }
    double g[3] = {0.1, -9.81, 1.0 / 3};
    knob_print(gravity, g, text);
    CHECK(knob_parse(gravity, text, back, &l->r) == STATUS_OK && memcmp(back, g, sizeof g) == 0);
    CHECK(knob_parse(gravity, "{0, -1, 0}", back, &l->r) == STATUS_OK && back[1] == -1);
    CHECK(knob_parse(gravity, "0,-1", back, &l->r) == STATUS_INPUT && knob_parse(gravity, "0,-1,0,2", back, &l->r) == STATUS_INPUT);
    CHECK(knob_parse(lame, "paper", back, &l->r) == STATUS_OK && back[0] == 1 && (knob_print(lame, back, text), strcmp(text, "paper") == 0));
    CHECK(knob_parse(lame, "papr", back, &l->r) == STATUS_INPUT && strcmp(l->r.nearest, "paper") == 0);
    CHECK(knob_parse(lame, "2", back, &l->r) == STATUS_INPUT && knob_parse(lame, "0.5", back, &l->r) == STATUS_INPUT);
    CHECK(knob_parse(shipped, "true", back, &l->r) == STATUS_OK && back[0] == 1 && knob_parse(shipped, "maybe", back, &l->r) == STATUS_INPUT);
    CHECK(knob_parse(eta, "0.1x", back, &l->r) == STATUS_INPUT && knob_parse(eta, "", back, &l->r) == STATUS_INPUT && knob_parse(eta, "nan", back, &l->r) == STATUS_INPUT);
    CHECK(knob_parse(eta, "-1", back, &l->r) == STATUS_INPUT && strstr(l->r.expected, "from 0 to 1e+06"));
    free_listed(l);
}

static void turns_resolve_what_follows_from_them(void) {
    listed *l = list_knobs(explicit_damage);
    char path[KNOB_PATH];
    double sigma[3] = {named(l, "sigma_c")->value[0]}, doubled = 2 * sigma[0], E[3] = {4e3};
    /* sigma_c follows E while break_stretch was said last, and holds when it was turned itself. */
    CHECK(scene_turn(l->s, "elastic.E", E, path, &l->r) == STATUS_OK && strcmp(path, "block.elastic.E") == 0);
    l->count = scene_knobs(l->s, l->s, l->list, LIST);
    CHECK_NEAR(named(l, "sigma_c")->value[0], doubled, 1e-9 * doubled);
    CHECK(scene_turn(l->s, "sigma_c", sigma, NULL, &l->r) == STATUS_OK);
    CHECK(scene_turn_text(l->s, "E", "2e3", NULL, &l->r) == STATUS_OK);
    l->count = scene_knobs(l->s, l->s, l->list, LIST);
    CHECK(named(l, "sigma_c")->value[0] == sigma[0] && !named(l, "sigma_c")->derived && named(l, "break_stretch")->derived);
    CHECK_NEAR(named(l, "break_stretch")->value[0], 0.1, 1e-9);
    free_listed(l);
    l = list_knobs(rubber_sheet);
    double G[3] = {0.5};
    CHECK(scene_turn(l->s, "fracture.G", G, NULL, &l->r) == STATUS_OK);
    l->count = scene_knobs(l->s, l->s, l->list, LIST);
    CHECK(named(l, "fracture.G")->value[0] == 0.5 && named(l, "fracture.stretch")->value[0] == 0); /* one of the two holds */
    CHECK(scene_turn_text(l->s, "softening.toughness", "0.2", NULL, &l->r) == STATUS_OK);
    l->count = scene_knobs(l->s, l->s, l->list, LIST);
    CHECK(named(l, "softening.stretch")->value[0] == 0);
    free_listed(l);
}

static void wrong_turns_leave_everything_as_it_was(void) {
    listed *l = list_knobs(explicit_damage);
    simulation *sim = test_simulation(l->s, 32, "auto", 1);
    static const struct {
        const char *word, *value, *expected;
    } wrong[] = {{"damage.etta", "1", "a knob of this scene"}, {"eta", "-1", "from 0"}, {"eta", "0", "a positive viscosity"}, {"form", "implicit", "while a run goes on"},
                 {"length_scale", "1", "while a run goes on"}, {"density", "3", "while a run goes on"}, {"nu", "0.6", "from"}, {"eta", "soon", "a number"}};
    knob *now = memory_allocate_array(LIST, sizeof *now);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        CHECK(simulation_turn_text(sim, wrong[i].word, wrong[i].value, &l->r) == STATUS_INPUT && strstr(l->r.expected, wrong[i].expected));
        int count = simulation_knobs(sim, now, LIST);
        bool same = count == l->count;
        for (int k = 0; k < count; k++) same = same && memcmp(now[k].value, l->list[k].value, sizeof now[k].value) == 0 && now[k].derived == l->list[k].derived;
        CHECK(same);
    }
    /* A second family of fibres is not there. */
    scene *one = implicit_damage();
    CHECK(scene_validate(one, &l->r) == STATUS_OK);
    CHECK(scene_turn_text(one, "alpha2", "-1", NULL, &l->r) == STATUS_INPUT && strstr(l->r.expected, "fibre directions"));
    scene_destroy(one);
    memory_free(now, LIST * sizeof *now);
    simulation_destroy(sim);
    free_listed(l);
}

int main(void) {
    RUN(knobs_are_found_by_the_words_of_set);
    RUN(values_go_through_text_to_the_bit);
    RUN(turns_resolve_what_follows_from_them);
    RUN(wrong_turns_leave_everything_as_it_was);
    RUN(turns_act_in_solids_that_crack);
    RUN(turns_act_where_damage_limits_the_step);
    RUN(turns_act_in_implicit_damage);
    RUN(turns_act_on_fibres_that_snap);
    RUN(turns_act_in_plastic_bodies_with_a_phase_field);
    RUN(turns_act_on_inextensible_fibres);
    RUN(turns_act_on_tetrahedra);
    RUN(turns_act_in_linear_sheets);
    RUN(turns_act_in_rubber_sheets);
    RUN(turns_act_in_plastic_sheets);
    RUN(a_turn_that_the_engine_refuses_leaves_no_trace);
    RUN(turns_act_in_sheets_of_many_rates);
    RUN(turns_act_in_wet_bodies);
    RUN(turns_act_where_solids_and_sheets_are);
    RUN(every_live_parameter_of_every_effect_acts);
    return check_finish();
}
