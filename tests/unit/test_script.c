/* The scene language: what scenes, recipes, parameters and settings come to. What is wrong: test_script_wrong.c. */
#include "base/memory.h"
#include "check.h"
#include "unit/script_files.h"

#define HEAD "local s = require 'sunder'\n"
#define MATTER "{ density = 1, elastic = { E = 1 } }"
#define BALL "{ shape = s.sphere { radius = 1 }, material = " MATTER " }"
#define SET(...) ((const char *const[]){__VA_ARGS__, NULL})

/* Loads and expects success: a failure says why and fails the test. */
static script *loaded(const char *text, const char *const *pairs) {
    script *s = load_set(text, pairs);
    CHECK(s != NULL);
    if (!s) printf("  %s\n", complaint());
    return s;
}

/* Loads, expects failure and these words in the first report. */
static void refused(const char *text, const char *const *pairs, const char *words) {
    script *s = load_set(text, pairs);
    CHECK(s == NULL);
    CHECK(reports.count > 0 && reports.items[0].code == STATUS_INPUT);
    CHECK(complains(words));
    script_close(s);
}

/* ---- the shipped scenes ------------------------------------------------------------------------------------------ */

static script *load_shipped(const char *name, const char *variant) {
    char path[512];
    snprintf(path, sizeof path, SUNDER_SOURCE "/scenes/solid/%s", name);
    script_setting one = {"variant", variant};
    script_options o = script_options_default();
    o.settings = &one, o.setting_count = 1;
    script *s;
    script_load(path, &o, &s, &reports);
    CHECK(s != NULL);
    if (!s) printf("  %s\n", complaint());
    return s;
}

static void test_tube_pull(void) {
    script *s = load_shipped("tube_pull.lua", "full");
    if (!s) return;
    const scene *sc = script_scene(s);
    CHECK(strcmp(sc->title, "Tube pull") == 0);
    CHECK(sc->particles == 50000 && scene_frames(sc) == 168 && sc->fps == 24);
    CHECK(sc->transfer == TRANSFER_RPIC && sc->transfer_ratio == 0.01);
    CHECK(sc->body_count == 1 && sc->grip_count == 2 && sc->material_count == 1 && sc->collider_count == 0);
    CHECK(sc->materials[0].density == 500 && strcmp(sc->materials[0].name, "tube") == 0);
    CHECK(knob_value(s, 0, "elastic", "E") == 4e4 && knob_value(s, 0, "fibres", "gamma") == 10);
    CHECK(knob_value(s, 0, "elastic", "lame") == 1);                 /* paper */
    CHECK_NEAR(knob_value(s, 0, "damage", "sigma_c"), 31957.6, 0.1); /* FACTS.md: break_stretch .20 */
    CHECK(sc->effects[effect_index("gravity")].on && sc->effects[effect_index("gravity")].value[0][1] == -1);
    CHECK(sc->grips[0].velocity.constant[0] == -0.1 && sc->grips[1].velocity.constant[0] == 0.1);
    CHECK(sc->grips[0].pivot[0] == -0.6 && sc->grips[0].protects && sc->grips[0].stop == HUGE_VAL);
    CHECK(sc->bodies[0].fibres.families == 1);
    CHECK_NEAR(sc->bodies[0].fibres.direction.constant[1], sqrt(0.5), 1e-15);
    const scene_parameter *variant = parameter_named(s, "variant"), *pull = parameter_named(s, "pull");
    CHECK(variant && variant->is_text && strcmp(variant->text, "full") == 0 && variant->from_set);
    CHECK(pull && pull->number == 0.1 && strcmp(pull->unit, "length/time") == 0 && !pull->from_set);
    CHECK(script_source_count(s) == 2);
    CHECK(strcmp(script_source_at(s, 0).name, "tube_pull.lua") == 0);
    CHECK(strcmp(script_source_at(s, 1).name, "recipes/tube.lua") == 0);
    CHECK(strstr(script_source_at(s, 1).text, "density = 500") != NULL);
    script_close(s);
}

static void test_variants(void) {
    const struct {
        const char *scene, *variant;
        bool damage, fibres;
        double alpha;
    } rows[] = {
        {"tube_pull.lua", "full", true, true, -1},
        {"tube_pull.lua", "isotropic", true, false, 0},
        {"tube_pull.lua", "damage_only", true, false, -1},
        {"tube_pull.lua", "elastic_only", false, true, 0},
        {"tube_compress.lua", "full", true, true, -1},
        {"tube_compress.lua", "isotropic", true, false, 0},
        {"tube_compress.lua", "elastic_only", false, true, 0},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        script *s = load_shipped(rows[i].scene, rows[i].variant);
        if (!s) continue;
        CHECK(effect_is_on(s, 0, "damage") == rows[i].damage);
        CHECK(effect_is_on(s, 0, "fibres") == rows[i].fibres);
        if (rows[i].damage) CHECK(knob_value(s, 0, "damage", "alpha") == rows[i].alpha);
        script_close(s);
    }
}

static void test_tube_compress(void) {
    script *s = load_shipped("tube_compress.lua", "full");
    if (!s) return;
    const scene *sc = script_scene(s);
    CHECK(scene_frames(sc) == 140 && sc->collider_count == 2);
    CHECK_NEAR(knob_value(s, 0, "damage", "sigma_c"), 610.17, 0.01);
    double t = 1, v[3];
    report r;
    CHECK(scene_function_evaluate(&sc->colliders[0].velocity, &t, 1, v, &r) == STATUS_OK && v[1] == -0.5);
    t = 1.3;
    CHECK(scene_function_evaluate(&sc->colliders[0].velocity, &t, 1, v, &r) == STATUS_OK && v[1] == 0);
    CHECK(sc->colliders[0].contact == CONTACT_SEPARATE && sc->colliders[0].friction == 0.4);
    const double above[3] = {0, 0.1, 0}, below[3] = {0, -0.1, 0};
    CHECK(sc->colliders[1].contact == CONTACT_STICKY);
    CHECK(shape_distance(sc->colliders[1].shape, above) > 0 && shape_distance(sc->colliders[1].shape, below) < 0);
    script_close(s);
}

/* ---- parameters and settings ------------------------------------------------------------------------------------- */

static const char params_scene[] =
    HEAD "local p = s.params { duration = 2, pull = { 0.1, unit = 'length/time', doc = 'speed', min = 0, max = 1 },\n"
         "  hard = true, label = 'plain', way = s.choice { 'left', 'right' }, count = 3 }\n"
         "return s.scene { particles = 1000, title = p.label .. tostring(p.hard) .. p.way .. p.count,\n"
         "  solids = { " BALL " }, grips = { { shape = s.sphere { radius = 0.2 }, velocity = { p.pull, 0, 0 } } } }\n";

static void test_parameter_defaults(void) {
    script *s = loaded(params_scene, NULL);
    if (!s) return;
    CHECK(strcmp(script_scene(s)->title, "plaintrueleft3") == 0);
    CHECK(script_scene(s)->duration == 2); /* a standard name acts on the scene by itself */
    CHECK(script_scene(s)->grips[0].velocity.constant[0] == 0.1);
    script_close(s);
}

static void test_parameters_set(void) {
    script *s = loaded(params_scene, SET("pull=0.5", "hard=false", "label=x y", "way=right", "count=4", "duration=3"));
    if (!s) return;
    CHECK(strcmp(script_scene(s)->title, "x yfalseright4") == 0);
    CHECK(script_scene(s)->duration == 3 && script_scene(s)->grips[0].velocity.constant[0] == 0.5);
    CHECK(parameter_named(s, "pull")->from_set && parameter_named(s, "duration")->from_set);
    CHECK(strcmp(parameter_named(s, "hard")->text, "false") == 0);
    CHECK(!parameter_named(s, "cfl")->from_set);
    script_close(s);
}

static void test_parameters_refused(void) {
    refused(params_scene, SET("pull=fast"), "--set pull");
    refused(params_scene, SET("pull=2"), "from 0 to 1");
    refused(params_scene, SET("pull=nan"), "found 'nan'");
    refused(params_scene, SET("hard=1"), "true or false");
    refused(params_scene, SET("way=rihgt"), "did you mean 'right'");
    refused(params_scene, SET("pul=1"), "did you mean 'pull'");
    refused(params_scene, SET("particels=1"), "did you mean 'particles'");
    refused(params_scene, SET("particles=1.5"), "whole number");
    refused(HEAD "local p = s.params { a = { 5, max = 2 } } return s.scene { particles = 1, solids = { " BALL " } }",
            NULL, "of at most 2");
    refused(HEAD "local p = s.params { a = { 5, unti = 'm' } } return s.scene { particles = 1, solids = { " BALL " } }",
            NULL, "did you mean 'unit'");
    refused(HEAD "local p = s.params { a = {} } return s.scene { particles = 1, solids = { " BALL " } }", NULL,
            "s.choice");
    refused(HEAD "local p = s.params { a = 1 } p.a = 2 return s.scene { particles = 1, solids = { " BALL " } }", NULL,
            "read-only");
}

static void test_standard_names(void) {
    const char *text = HEAD "return s.scene { particles = 1000, duration = 2, dx = 0.1, solids = { " BALL " } }";
    script *s = loaded(text, SET("particles=2e3", "duration=5", "dx=auto", "dt=0.25", "seed=7", "cfl=0.3", "fps=10",
                                 "kernel=cubic", "transfer=flip"));
    if (!s) return;
    const scene *sc = script_scene(s);
    CHECK(sc->particles == 2000 && sc->duration == 5 && sc->dx == 0 && sc->dt == 0.25 && sc->seed == 7 &&
          sc->fps == 10);
    CHECK(sc->kernel == KERNEL_CUBIC && sc->transfer == TRANSFER_FLIP && sc->cfl == 0.3);
    CHECK(parameter_named(s, "particles")->from_set && strcmp(parameter_named(s, "dx")->text, "auto") == 0);
    script_close(s);
    /* Declared and used in an expression: the scene's own word stands. */
    s = loaded(HEAD "local p = s.params { particles = 10 }\n"
                    "return s.scene { particles = p.particles * 2, solids = { " BALL " } }",
               SET("particles=50"));
    if (s) CHECK(script_scene(s)->particles == 100);
    script_close(s);
}

static const char two_materials[] =
    HEAD "return s.scene { particles = 1000, gravity = { 0, -9.8, 0 }, solids = {\n"
         "  { shape = s.sphere { radius = 1 }, material = { name = 'peel', density = 1, elastic = { E = 1 },\n"
         "      damage = { break_stretch = 0.2 } } },\n"
         "  { shape = s.sphere { radius = 1, center = { 3, 0, 0 } }, material = { name = 'pulp', density = 2,\n"
         "      elastic = { E = 2 } } } } }";

static void test_knobs(void) {
    script *s =
        loaded(two_materials, SET("eta=0.7", "peel.elastic.E=5", "pulp.nu=0.1", "gravity=0,0,-3", "peel.density=4"));
    if (!s) return;
    CHECK(knob_value(s, 0, "damage", "eta") == 0.7 && knob_value(s, 0, "elastic", "E") == 5);
    CHECK(knob_value(s, 1, "elastic", "E") == 2 && knob_value(s, 1, "elastic", "nu") == 0.1);
    CHECK(knob_value(s, 0, "elastic", "nu") == 0.3 && script_scene(s)->materials[0].density == 4);
    const double *g = script_scene(s)->effects[effect_index("gravity")].value[0];
    CHECK(g[0] == 0 && g[1] == 0 && g[2] == -3);
    CHECK(parameter_named(s, "peel.damage.eta")->from_set && !parameter_named(s, "pulp.elastic.E")->from_set);
    CHECK(strcmp(parameter_named(s, "gravity.acceleration")->text, "0,0,-3") == 0);
    CHECK(strcmp(parameter_named(s, "peel.damage.eta")->unit, "time") == 0);
    script_close(s);
    refused(two_materials, SET("nu=0.2"), "peel.elastic.nu, pulp.elastic.nu");
    refused(two_materials, SET("elastic.E=0.2"), "peel.elastic.E, pulp.elastic.E");
    refused(two_materials, SET("peel.damage.etta=1"), "did you mean 'peel.damage.eta'");
    refused(two_materials, SET("etta=1"), "did you mean 'eta'");
    refused(two_materials, SET("gamma=1"), "'fibres' is off here");
    refused(two_materials, SET("eta=-1"), "found '-1'");
    refused(two_materials, SET("gravity=1,2"), "three finite numbers");
    refused(two_materials, SET("peel.density=0"), "above 0");
}

static void test_twins(void) {
    script *s = loaded(two_materials, SET("sigma_c=3"));
    if (!s) return;
    CHECK(knob_value(s, 0, "damage", "sigma_c") == 3);
    CHECK(!parameter_named(s, "peel.damage.break_stretch")->from_set &&
          parameter_named(s, "peel.damage.sigma_c")->from_set);
    script_close(s);
    s = loaded(two_materials, SET("sigma_c=3", "break_stretch=0.5"));
    if (!s) return;
    CHECK(knob_value(s, 0, "damage", "break_stretch") == 0.5 && knob_value(s, 0, "damage", "sigma_c") != 3);
    script_close(s);
}

/* ---- recipes ----------------------------------------------------------------------------------------------------- */

static void test_recipes(void) {
    files_write("recipes/rope.lua",
                "return { density = 3, elastic = { E = 7, nu = 0.2 }, damage = { break_stretch = 0.1 },\n"
                "  fibres = { gamma = 2 } }");
    files_write("stuff/gum.lua",
                "local s = require 'sunder'\n"
                "return s.recipe('rope', { elastic = { E = 1 }, damage = { sigma_c = 4 }, fibres = false })");
    script *s = loaded(
        HEAD "local along = s.fibres.direction { 1, 0, 0 }\n"
             "local function ball(x, m) return { shape = s.sphere { radius = 1, center = { x, 0, 0 } }, fibres = "
             "along, material = m } end\n"
             "return s.scene { particles = 1, solids = { ball(0, 'rope'), ball(3, 'rope'), ball(6, s.recipe 'rope'),\n"
             "  ball(9, s.recipe('rope', { elastic = { nu = 0.4 }, damage = { sigma_c = 2 } })), ball(12, s.recipe "
             "'stuff/gum.lua') } }",
        NULL);
    if (!s) return;
    const scene *sc = script_scene(s);
    CHECK(sc->material_count == 4); /* the same name twice is one material */
    CHECK(sc->bodies[0].material == sc->bodies[1].material && sc->bodies[2].material == 1);
    CHECK(strcmp(sc->materials[0].name, "rope") == 0 && strcmp(sc->materials[1].name, "rope_2") == 0);
    CHECK(strcmp(sc->materials[3].name, "gum") == 0);
    CHECK(knob_value(s, 1, "elastic", "E") == 7 && knob_value(s, 2, "elastic", "nu") == 0.4);
    CHECK(knob_value(s, 2, "elastic", "E") == 7 && knob_value(s, 2, "damage", "sigma_c") == 2); /* the twin gave way */
    CHECK(knob_value(s, 3, "elastic", "E") == 1 && knob_value(s, 3, "damage", "sigma_c") == 4);
    CHECK(!effect_is_on(s, 3, "fibres") && effect_is_on(s, 0, "fibres"));
    CHECK(script_source_count(s) == 3 && strcmp(script_source_at(s, 2).name, "stuff/gum.lua") == 0);
    script_close(s);
    refused(HEAD
            "return s.scene { particles = 1, solids = { { shape = s.sphere { radius = 1 }, material = 'ropee' } } }",
            NULL, "did you mean 'rope'");
}

static void test_recipe_folder(void) {
    char text[256];
    files_write("elsewhere/felt.lua", "return { density = 11, elastic = { E = 1 } }");
    snprintf(text, sizeof text, "%s/elsewhere", folder);
    setenv("SUNDER_RECIPES", text, 1);
    script *s = loaded(HEAD "return s.scene { particles = 1, solids = { { shape = s.sphere { radius = 1 },\n"
                            "  material = 'felt' } } }",
                       NULL);
    CHECK(s && script_scene(s)->materials[0].density == 11);
    CHECK(s && strcmp(script_source_at(s, 1).name, "recipes/felt.lua") == 0);
    script_close(s);
    unsetenv("SUNDER_RECIPES");
}

static void test_recipe_option(void) {
    script_options o = script_options_default();
    o.recipe = "tube"; /* found in the source tree */
    script *s = load_with(HEAD "return s.scene { particles = 1, solids = { { shape = s.sphere { radius = 1 },\n"
                               "  fibres = s.fibres.direction { 1, 0, 0 }, material = { nonsense = 1 } } } }",
                          &o, SET("eta=0.9"));
    CHECK(s && script_scene(s)->materials[0].density == 500 && knob_value(s, 0, "damage", "eta") == 0.9);
    script_close(s);
    o.recipe = "tubbe";
    s = load_with(HEAD "return s.scene { particles = 1, solids = { " BALL " } }", &o, NULL);
    CHECK(!s && complains("did you mean 'tube'") && complains("--recipe"));
}

/* ---- shapes ------------------------------------------------------------------------------------------------------ */

static void check_distance(const char *expression, double x, double y, double z, double expected) {
    char text[1024];
    snprintf(text, sizeof text,
             HEAD "return s.scene { particles = 1, solids = { { shape = %s, material = " MATTER " } } }", expression);
    script *s = loaded(text, NULL);
    if (!s) return;
    const double point[3] = {x, y, z};
    CHECK_NEAR(shape_distance(script_scene(s)->bodies[0].shape, point), expected, 1e-9);
    script_close(s);
}

static void test_shapes(void) {
    check_distance("s.sphere { radius = 2, center = { 1, 0, 0 } }", 4, 0, 0, 1);
    check_distance("s.box { min = { 0, 0, 0 }, max = { 1, 2, 3 } }", 0.5, 3, 1, 1);
    check_distance("s.box { center = { 1, 1, 1 }, size = { 2, 2, 2 } }", 1, 1, 4, 2);
    check_distance("s.cylinder { axis = 'y', radius = 1, length = 4 }", 3, 1, 0, 2);
    check_distance("s.cylinder { axis = { 0, 0, 5 }, radius = 1, length = 4, center = { 0, 0, 2 } }", 0, 0, 5, 1);
    check_distance("s.tube { axis = 'x', outer = 2, inner = 1, length = 9 }", 0, 0, 0.5, 0.5);
    check_distance("s.capsule { from = { 0, 0, 0 }, to = { 4, 0, 0 }, radius = 1 }", 2, 3, 0, 2);
    check_distance("s.torus { axis = 'z', major = 3, minor = 1 }", 5, 0, 0, 1);
    check_distance("s.sphere { radius = 1 } + s.sphere { radius = 1, center = { 5, 0, 0 } }", 7, 0, 0, 1);
    check_distance("s.union { s.sphere { radius = 1 }, s.sphere { radius = 2 } }", 3, 0, 0, 1);
    check_distance("s.sphere { radius = 2 } * s.half_space { normal = 'x' }", 1, 0, 0, 1);
    check_distance("s.sphere { radius = 2 } - s.sphere { radius = 1 }", 0, 0.25, 0, 0.75);
    check_distance("s.difference(s.sphere { radius = 3 }, s.sphere { radius = 1 }, s.half_space { normal = 'y' })", 0,
                   -1, 0, 1);
    check_distance("s.sphere { radius = 1 }:translate { 0, 5, 0 }", 0, 7, 0, 1);
    check_distance("s.translate(s.sphere { radius = 1 }, { 0, 5, 0 }):scale(2)", 0, 13, 0, 1);
    /* A quarter turn about z takes +x to +y. */
    check_distance("s.box { min = { 0, -1, -1 }, max = { 4, 1, 1 } }:rotate { axis = 'z', angle = 90 }", 0, 6, 0, 2);
    check_distance("s.rotate(s.sphere { radius = 1 }, { axis = 'z', angle = 90, center = { 2, 0, 0 } })", 2, -4, 0, 1);
    refused(HEAD "return s.scene { solids = { { shape = s.sphere { radius = 1 } + 3 } } }", NULL, "expected a shape");
    refused(HEAD "return s.scene { solids = { { shape = s.sphere { radius = 1 }:turn(3) } } }", NULL,
            "exists in shapes");
    refused(HEAD "return s.scene { solids = { { shape = s.box { min = { 0, 0, 0 } } } } }", NULL, "either min and max");
    refused(HEAD "return s.scene { solids = { { shape = s.cylinder { axis = 'w', radius = 1, length = 1 } } } }", NULL,
            "an axis");
    refused(HEAD "local a = s.sphere { radius = 1 } for i = 1, 20 do a = a + a end\n"
                 "return s.scene { particles = 1, solids = { { shape = a, material = " MATTER " } } }",
            NULL, "4096");
}

/* ---- functions and fibres ---------------------------------------------------------------------------------------- */

static void check_field(const char *fibres, double x, double y, double z, int families, const double *expected) {
    char text[1024];
    snprintf(text, sizeof text,
             HEAD
             "return s.scene { particles = 1, solids = { { shape = s.sphere { radius = 9 }, fibres = s.fibres.%s,\n"
             "  material = " MATTER " } } }",
             fibres);
    script *s = loaded(text, NULL);
    if (!s) return;
    const scene_fibres *f = &script_scene(s)->bodies[0].fibres;
    const double point[3] = {x, y, z};
    double out[6];
    report r;
    CHECK(f->families == families && f->direction.outputs == 3 * families);
    CHECK(scene_function_evaluate(&f->direction, point, 3, out, &r) == STATUS_OK);
    for (int i = 0; i < 3 * families; i++) CHECK_NEAR(out[i], expected[i], 1e-12);
    script_close(s);
}

static void test_fibres(void) {
    double h = sqrt(0.5);
    check_field("direction { 0, 0, -4 }", 1, 1, 1, 1, (double[]){0, 0, -1});
    check_field("direction({ 1, 0, 0 }, { 0, 2, 0 })", 1, 1, 1, 2, (double[]){1, 0, 0, 0, 1, 0});
    check_field("direction { { 1, 0, 0 }, { 0, 0, 1 } }", 1, 1, 1, 2, (double[]){1, 0, 0, 0, 0, 1});
    check_field("radial { axis = 'y' }", 3, 7, 0, 1, (double[]){1, 0, 0});
    check_field("radial { axis = 'y', center = { 1, 0, 0 } }", 1, 7, 2, 1, (double[]){0, 0, 1});
    check_field("circumferential { axis = 'z' }", 2, 0, 5, 1, (double[]){0, 1, 0});
    check_field("helical { axis = 'z', angle = 45 }", 2, 0, 5, 1, (double[]){0, h, h});
    check_field("helical { axis = 'z', angle = 90 }", 2, 0, 5, 1, (double[]){0, 0, 1});
    check_field("radial { axis = 'y' }", 0, 7, 0, 1, (double[]){1, 0, 0}); /* on the axis: a fixed perpendicular */
    check_field("field(function(x, y, z) return y, -x, 0 end)", 2, 3, 0, 1, (double[]){3, -2, 0});
    check_field("field(function(x, y, z) return 1, 0, 0, 0, x, 0 end)", 2, 3, 0, 2, (double[]){1, 0, 0, 0, 2, 0});
}

static void test_functions(void) {
    script *s = loaded(
        HEAD
        "local wave = { amplitude = 2 }\n"
        "setmetatable(wave, { __call = function(self, t) return self.amplitude * t end })\n"
        "local list, scale = { 10, 20, 30 }, 1\n"
        "local function helper(t) local total = 0 for i, v in ipairs(list) do total = total + v * #list end\n"
        "  for k, v in pairs(wave) do total = total + v end return total + scale * t end\n"
        "return s.scene { particles = 1, duration = 4, solids = { { shape = s.sphere { radius = 1 }, material = " MATTER
        ",\n"
        "    velocity = function(x, y, z) return -y, x, 0 end } },\n"
        "  grips = { { shape = s.sphere { radius = 0.5, center = { 1, 2, 3 } }, start = 1, stop = 3, protects = "
        "false,\n"
        "    velocity = function(t) local own = {} own.x = wave(t) return own.x, helper(t), math.floor(2.5) end,\n"
        "    spin = function(t) return { 0, 0, t } end } } }",
        NULL);
    if (!s) return;
    const scene_grip *g = &script_scene(s)->grips[0];
    double t = 1.5, v[3];
    const double x[3] = {0.25, 0.5, 0};
    report r;
    for (int again = 0; again < 3; again++) {
        CHECK(scene_function_evaluate(&g->velocity, &t, 1, v, &r) == STATUS_OK);
        CHECK(v[0] == 3 && v[1] == 180 + 2 + 1.5 && v[2] == 2);
    }
    CHECK(scene_function_evaluate(&g->spin, &t, 1, v, &r) == STATUS_OK && v[2] == 1.5);
    CHECK(scene_function_evaluate(&script_scene(s)->bodies[0].velocity, x, 3, v, &r) == STATUS_OK && v[0] == -0.5);
    CHECK(g->start == 1 && g->stop == 3 && !g->protects && g->pivot[2] == 3);
    script_close(s);
}

/* ---- the sandbox, where it lets through ----------------------------------------------------------------------------
 */

/* Loads a scene whose title is the value of an expression, after some statements. */
static void check_title(const char *statements, const char *expression, const char *expected) {
    char text[2048];
    snprintf(text, sizeof text,
             HEAD "%s\nreturn s.scene { particles = 1, title = tostring(%s), solids = { " BALL " } }", statements,
             expression);
    script *s = loaded(text, NULL);
    if (!s) return;
    CHECK(strcmp(script_scene(s)->title, expected) == 0);
    if (strcmp(script_scene(s)->title, expected) != 0) printf("  title: %s\n", script_scene(s)->title);
    script_close(s);
}

static void test_sandbox(void) {
    files_write("helper.lua", "local m = {} function m.twice(x) return 2 * x end return m");
    files_write("lib/deep.lua", "return 'deep ' .. ...");
    check_title("local h = require 'helper'", "h.twice(21)", "42");
    check_title("", "require 'lib/deep'", "deep lib/deep");
    check_title("a = 5 local f = load 'return a + 1'", "f()", "6");
    check_title("local ok, e = pcall(error, 'no')", "tostring(ok) .. e", "falseno");
    check_title("local ok, e = xpcall(function() error('x', 0) end, function(m) return m .. '!' end)", "e", "x!");
    check_title("local t = { b = 2, a = 1, [2] = 'y', [1] = 'x', c = 3 } local o = '' for k, v in pairs(t) do o = o .. "
                "k .. v end",
                "o", "1x2ya1b2c3");
    check_title(
        "local t, o, k = { z = 1, y = 2, [-1] = 3 }, '' repeat k = next(t, k) o = o .. tostring(k) until k == nil", "o",
        "-1yznil");
    check_title("local t = {} for i = 1, 300 do t[i] = { key = i % 3, at = i } end\n"
                "table.sort(t, function(a, b) return a.key < b.key end) local stable = true\n"
                "for i = 2, 300 do if t[i].key == t[i - 1].key and t[i].at < t[i - 1].at then stable = false end end",
                "tostring(stable) .. t[1].at .. ' ' .. t[300].at", "true3 299");
    check_title("local t = { 5, 2, 9, 1 } table.sort(t) table.insert(t, 1, 0) table.insert(t, 7) table.remove(t, 2)",
                "table.concat(t, ',')", "0,2,5,9,7");
    check_title("local t = table.move({ 1, 2, 3 }, 1, 3, 2)", "table.concat(t, ',')", "1,1,2,3");
    check_title("", "select('#', table.unpack({ 1, 2, 3 }, 2))", "2");
    check_title("", "('%d-%s'):format(3, ('ab'):upper())", "3-AB");
    check_title("", "math.type(math.random(3)) .. tostring(math.random() < 1)", "integertrue");
}

static void test_log(void) {
    script *s = loaded(HEAD "print('hello', 3, true) return s.scene { particles = 1, solids = { " BALL " } }", NULL);
    if (!s) return;
    CHECK(strcmp(script_log(s), "hello\t3\ttrue\n") == 0);
    script_close(s);
}

static void test_random(void) {
    const char *text =
        HEAD "return s.scene { particles = 1, title = ('%.17g %d'):format(math.random(), math.random(1000)),\n"
             "  solids = { " BALL " } }";
    char first[128];
    script *s = loaded(text, NULL);
    if (!s) return;
    snprintf(first, sizeof first, "%s", script_scene(s)->title);
    script_close(s);
    s = loaded(text, NULL);
    if (s) CHECK(strcmp(first, script_scene(s)->title) == 0);
    script_close(s);
    s = loaded(text, SET("seed=1"));
    if (s) CHECK(strcmp(first, script_scene(s)->title) != 0);
    script_close(s);
}

/* ---- resolved parameters ----------------------------------------------------------------------------------------- */

static void check_round_trip(const char *text, const char *const *pairs) {
    script *s = loaded(text, pairs);
    if (!s) return;
    script_options o = script_options_default();
    char *resolved = strdup(script_resolved(s));
    o.resolved = resolved;
    script *again = load_with(text, &o, NULL);
    CHECK(again != NULL);
    if (!again) printf("  %s\n", complaint());
    if (again) {
        const scene *a = script_scene(s), *b = script_scene(again);
        CHECK(strcmp(resolved, script_resolved(again)) == 0);
        CHECK(a->parameter_count == b->parameter_count && a->particles == b->particles && a->dt == b->dt);
        for (int m = 0; m < a->material_count; m++)
            for (int e = 0; e < EFFECT_LIMIT; e++) {
                CHECK(a->materials[m].effects[e].on == b->materials[m].effects[e].on);
                CHECK(memcmp(a->materials[m].effects[e].value, b->materials[m].effects[e].value,
                             sizeof a->materials[m].effects[e].value) == 0);
            }
        for (int i = 0; i < b->parameter_count; i++) CHECK(!b->parameters[i].from_set);
        script_close(again);
    }
    free(resolved);
    script_close(s);
}

static void test_resolved(void) {
    check_round_trip(params_scene, SET("pull=0.123456789012345678", "label=a \"quoted\" \\ word", "way=right"));
    check_round_trip(two_materials, SET("sigma_c=0.3333333333333333", "gravity=0.1,0.2,0.3", "dt=0.001"));
    check_round_trip(two_materials, NULL);
    script_options o = script_options_default();
    o.resolved = "return { [\"peel.damage.eta\"] = 0.25, duration = 9 }";
    script *s = load_with(two_materials, &o, SET("duration=3"));
    CHECK(s && knob_value(s, 0, "damage", "eta") == 0.25 && script_scene(s)->duration == 3); /* --set is the stronger */
    script_close(s);
    o.resolved = "return { [\"peel.damage.etta\"] = 0.25 }";
    s = load_with(two_materials, &o, NULL);
    CHECK(!s && complains("did you mean 'peel.damage.eta'"));
    o.resolved = "while true do end";
    o.time_limit = 0.05;
    s = load_with(two_materials, &o, NULL);
    CHECK(!s && complains("processor time"));
}

/* Parameters that are functions of place: the material has their largest, what pins a run leaves them to the scene, and --set
 * takes their place. */
static void test_variations(void) {
    static const char text[] = HEAD
        "return s.scene { particles = 1, duration = 4, solids = { { shape = s.box { size = { 2, 2, 2 } },\n"
        "  material = { name = 'wood', density = function(x, y, z) return 2 + 0 * x end,\n"
        "    elastic = { E = function(x, y, z) return 10 + x end },\n"
        "    damage = { break_stretch = 0.1, eta = function(x, y, z) return 0.5 end } } } } }";
    script *s = loaded(text, NULL);
    if (!s) return;
    const scene_material *m = &script_scene(s)->materials[0];
    CHECK(m->variation_count == 3 && m->density == 2 && knob_value(s, 0, "damage", "eta") == 0.5);
    CHECK(knob_value(s, 0, "elastic", "E") > 10 && knob_value(s, 0, "elastic", "E") < 11);
    CHECK(strstr(script_resolved(s), "break_stretch") && !strstr(script_resolved(s), "elastic.E") && !strstr(script_resolved(s), "density") &&
          !strstr(script_resolved(s), "damage.eta"));
    script_close(s);
    s = loaded(text, SET("E=7", "density=3"));
    if (!s) return;
    CHECK(script_scene(s)->materials[0].variation_count == 1 && script_scene(s)->materials[0].density == 3);
    CHECK(knob_value(s, 0, "elastic", "E") == 7 && strstr(script_resolved(s), "elastic.E"));
    script_close(s);
}

/* A list of notches is their union. */
static void test_notches(void) {
    script *s = loaded(HEAD
        "return s.scene { particles = 1, duration = 4, solids = { { shape = s.box { size = { 2, 2, 2 } },\n"
        "  material = { density = 1, elastic = { E = 1 }, damage = { sigma_c = 1 } },\n"
        "  notches = { s.sphere { radius = 0.25, center = { 1, 0, 0 } }, s.sphere { radius = 0.25, center = { -1, 0, 0 } } } } } }", NULL);
    if (!s) return;
    const shape *notches = script_scene(s)->bodies[0].notches;
    const double right[3] = {1, 0, 0}, left[3] = {-1, 0, 0}, middle[3] = {0, 0, 0};
    CHECK(notches && shape_distance(notches, right) < 0 && shape_distance(notches, left) < 0 && shape_distance(notches, middle) > 0);
    script_close(s);
}

/* ---- memory ------------------------------------------------------------------------------------------------------ */

/* Every allocation fails once, from the first on, until a load gets through; nothing leaks, nothing crashes, and each
 * failure is reported as the system's. */
static void test_allocation_failures(void) {
    static const char text[] = HEAD
        "local p = s.params { pull = 1 }\n"
        "return s.scene { particles = 1, solids = { { shape = s.sphere { radius = 1 } - s.sphere { radius = 0.5 },\n"
        "  material = s.recipe('tube', { damage = { eta = 1 } }), fibres = s.fibres.direction { 1, 0, 0 } } },\n"
        "  grips = { { shape = s.sphere { radius = 0.2 }, velocity = function(t) return p.pull, t, 0 end } } }\n";
    size_t before = memory_live_bytes();
    int failures = 0;
    /* Every allocation near the start, then a sample: Lua makes thousands of the same kind. */
    for (int64_t n = 1;; n += n < 400 ? 1 : 17) {
        memory_fail_after(n, 1);
        script *s = load(text);
        memory_fail_after(0, 0);
        bool through = s != NULL;
        if (!through) {
            failures++;
            if (reports.count < 1 || reports.items[0].code != STATUS_SYSTEM)
                printf("  n = %d: %s\n", (int)n, complaint());
            CHECK(reports.count >= 1 && reports.items[0].code == STATUS_SYSTEM);
        }
        script_close(s);
        if (memory_live_bytes() != before) {
            CHECK(memory_live_bytes() == before);
            return;
        }
        if (through) break;
    }
    CHECK(failures > 400);
}

int main(void) {
    files_open();
    size_t before = memory_live_bytes();
    RUN(test_tube_pull);
    RUN(test_variants);
    RUN(test_tube_compress);
    RUN(test_parameter_defaults);
    RUN(test_parameters_set);
    RUN(test_parameters_refused);
    RUN(test_standard_names);
    RUN(test_knobs);
    RUN(test_twins);
    RUN(test_recipes);
    RUN(test_recipe_folder);
    RUN(test_recipe_option);
    RUN(test_shapes);
    RUN(test_fibres);
    RUN(test_functions);
    RUN(test_sandbox);
    RUN(test_log);
    RUN(test_random);
    RUN(test_resolved);
    RUN(test_variations);
    RUN(test_notches);
    CHECK(memory_live_bytes() == before);
    RUN(test_allocation_failures);
    files_close();
    return check_finish();
}
