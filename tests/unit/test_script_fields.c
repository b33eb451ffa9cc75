/* What scenes read from files (meshes, tables of fibres) and fibres that are solved for: placing, sources, messages. */
#include "base/memory.h"
#include "check.h"
#include "unit/mesh_files.h"
#include "unit/script_files.h"

#define HEAD "local s = require 'sunder'\n"
#define MATTER "material = { density = 1, elastic = { E = 1 } }"
#define SCENE(solids) HEAD "return s.scene { particles = 1000, duration = 1, solids = { " solids " } }"

static made_mesh made;

static void write_made(const char *name, made_file f) {
    char path[200];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *out = fopen(path, "wb");
    if (!out || fwrite(f.data, 1, f.size, out) != f.size || fclose(out) != 0) exit(1);
    free(f.data);
}

static script *loaded(const char *text) {
    script *s = load(text);
    CHECK(s != NULL);
    if (!s) printf("  %s\n", complaint());
    return s;
}

static void refused(const char *text, const char *words) {
    script *s = load(text);
    CHECK(s == NULL);
    CHECK(reports.count > 0 && reports.items[0].code == STATUS_INPUT);
    CHECK(complains(words));
    script_close(s);
}

static void write_meshes(void) {
    made_sphere(&made, 2);
    files_write("meshes/keep", "");
    write_made("meshes/ball.stl", made_stl(&made, false));
    made = (made_mesh){0};
    made_box(&made, (double[]){10, 0, 0}, (double[]){12, 4, 6});
    write_made("meshes/brick.ply", made_ply(&made, "binary_big_endian"));
    made.triangles--;
    write_made("open.obj", made_obj(&made));
    files_write("broken.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n");
}

/* ---- meshes ------------------------------------------------------------------------------------------------------ */

static void check_bounds(const char *words, const double low[3], const double high[3]) {
    char text[600];
    snprintf(text, sizeof text, SCENE("{ shape = s.mesh { file = 'meshes/brick.ply'%s }, " MATTER " }"), words);
    script *s = loaded(text);
    if (!s) return;
    double minimum[3], maximum[3];
    shape_bounds(script_scene(s)->bodies[0].shape, minimum, maximum);
    for (int c = 0; c < 3; c++) {
        CHECK_NEAR(minimum[c], low[c], 1e-12);
        CHECK_NEAR(maximum[c], high[c], 1e-12);
    }
    script_close(s);
}

static void meshes_are_placed(void) {
    check_bounds("", (double[]){10, 0, 0}, (double[]){12, 4, 6});
    check_bounds(", center = { 1, 1, 1 }", (double[]){0, -1, -2}, (double[]){2, 3, 4});
    check_bounds(", scale = 0.5", (double[]){5, 0, 0}, (double[]){6, 2, 3});
    check_bounds(", scale = 0.5, center = { 0, 0, 0 }", (double[]){-0.5, -1, -1.5}, (double[]){0.5, 1, 1.5});
    check_bounds(", rotate = { axis = 'z', angle = 90 }", (double[]){-4, 10, 0}, (double[]){0, 12, 6});
    check_bounds(", rotate = { axis = 'z', angle = 90 }, center = { 1, 1, 1 }", (double[]){-1, 0, -2}, (double[]){3, 2, 4});
}

/* The run's folder gets the very bytes, under the same name, once: a copy of that folder loads. */
static void meshes_are_sources(void) {
    script *s = loaded(SCENE("{ shape = s.mesh { file = 'meshes/ball.stl' } - s.mesh { file = 'meshes/ball.stl', scale = 0.5 }, " MATTER " }"));
    if (!s) return;
    CHECK(script_source_count(s) == 2);
    script_source source = script_source_at(s, 1);
    made_sphere(&made, 2);
    made_file f = made_stl(&made, false);
    CHECK(strcmp(source.name, "meshes/ball.stl") == 0);
    CHECK(source.size == f.size && memcmp(source.text, f.data, f.size) == 0);
    CHECK(shape_distance(script_scene(s)->bodies[0].shape, (double[]){0.7, 0, 0}) < 0);
    CHECK(shape_distance(script_scene(s)->bodies[0].shape, (double[]){0.3, 0, 0}) > 0);
    char text[200];
    shape_describe(script_scene(s)->bodies[0].shape, text, sizeof text);
    CHECK(strncmp(text, "difference(mesh 'meshes/ball.stl' of 320 triangles", 50) == 0);
    free(f.data);
    script_close(s);
}

static void wrong_meshes(void) {
#define MESH(words) SCENE("\n{ shape = s.mesh {\n" words " }, " MATTER " }")
    refused(MESH("file = 'meshes/boll.stl'"), "scene.lua:4: file: expected a file that can be read, by its path from the scene's folder, found "
            "'meshes/boll.stl': No such file or directory (did you mean 'meshes/ball.stl'?)");
    refused(MESH("file = 'meshes/ball.txt'"), "scene.lua:4: file: expected a file that ends in .obj or .ply or .stl, found 'meshes/ball.txt'");
    refused(MESH("file = '../ball.stl'"), "scene.lua:4: file: expected a path below the scene's folder");
    refused(MESH("file = '/etc/ball.stl'"), "expected a path below the scene's folder");
    refused(MESH("file = 'meshes'"), "expected a file that ends in");
    refused(MESH("scale = 2"), "file: expected");
    refused(MESH("file = 'meshes/ball.stl',\nscale = 0"), "scene.lua:5: scale");
    refused(MESH("file = 'meshes/ball.stl', rotate = { angle = 3 }"), "rotate.axis");
    refused(MESH("file = 'meshes/ball.stl', rotated = 3"), "did you mean 'rotate'?");
    refused(MESH("file = 'meshes/ball.stl', center = { 1e12, 0, 0 }"), "expected a place within a billion of the mesh's sizes");
    refused(MESH("file = 'open.obj'"), "open.obj: expected a closed surface, found 1 hole (3 open edges), one at (1");
    refused(MESH("file = 'broken.obj'"), "broken.obj:4: f: expected vertices by number, 1 to 3 (or -1 to -3), found '4'");
}

/* ---- fibres ------------------------------------------------------------------------------------------------------ */

static void fibres_at(script *s, int body, double x, double y, double z, double a[6]) {
    report r;
    const scene_body *b = &script_scene(s)->bodies[body];
    memset(a, 0, 6 * sizeof *a);
    CHECK(b->fibres.families >= 1 && b->fibres.direction.outputs == 3 * b->fibres.families);
    CHECK(scene_function_evaluate(&b->fibres.direction, (double[]){x, y, z}, 3, a, &r) == STATUS_OK);
}

#define BAR "shape = s.box { min = { 0, 0, 0 }, max = { 4, 1, 1 } }, " MATTER
#define FIBRES(words) SCENE("{ " BAR ",\nfibres = " words " }")

static void curves(void) {
    double a[6];
    script *s = loaded(FIBRES("s.fibres.curve { points = { { 0, 0, 0 }, { 2, 0, 0 }, { 2, 9, 0 } }, second = 'z' }"));
    if (!s) return;
    fibres_at(s, 0, 0.1, 0.2, 0.3, a);
    CHECK(a[0] > 0.9 && script_scene(s)->bodies[0].fibres.families == 2 && a[5] == 1);
    fibres_at(s, 0, 2.1, 8, 0.3, a);
    CHECK(a[1] > 0.99);
    script_close(s);
    refused(FIBRES("s.fibres.curve { points = { { 0, 0, 0 } } }"), "scene.lua:3: points: expected at least two points, found one");
    refused(FIBRES("s.fibres.curve { points = {\n{ 0, 0, 0 },\n{ 0, 0, 0 } } }"), "scene.lua:5: points[2]: expected a point apart from the one before");
    refused(FIBRES("s.fibres.curve { points = { { 0, 0, 0 }, { 0, 0 } } }"), "points[2]: expected");
    refused(FIBRES("s.fibres.curve { second = 'x' }"), "points: expected");
}

static void random_fibres(void) {
    double a[6], b[6];
    script *s = loaded(FIBRES("s.fibres.random { direction = 'x', spread = 10 }"));
    if (!s) return;
    fibres_at(s, 0, 0.1, 0.2, 0.3, a);
    fibres_at(s, 0, 0.1, 0.2, 0.4, b);
    CHECK(a[0] > cos(10.01 * acos(-1.0) / 180) && a[0] < 1 && a[1] != b[1]);
    script_scene(s)->seed = 99; /* what the scene's seed says counts, whenever it is said */
    fibres_at(s, 0, 0.1, 0.2, 0.3, b);
    CHECK(a[1] != b[1]);
    script_close(s);
    s = loaded(FIBRES("s.fibres.random { direction = 'x', spread = 10, seed = 3 }"));
    if (!s) return;
    fibres_at(s, 0, 0.1, 0.2, 0.3, a);
    script_scene(s)->seed = 99;
    fibres_at(s, 0, 0.1, 0.2, 0.3, b);
    CHECK(a[1] == b[1]);
    script_close(s);
    refused(FIBRES("s.fibres.random { direction = 'x', spread = 200 }"), "spread");
    refused(FIBRES("s.fibres.random { direction = 'x' }"), "spread: expected");
}

static void tables(void) {
    double a[6];
    files_write("lay.csv", "x,y,z,dx,dy,dz\n0,0,0,1,0,0\n4,0,0,0,1,0\n");
    script *s = loaded(FIBRES("s.fibres.file { path = 'lay.csv' }"));
    if (!s) return;
    fibres_at(s, 0, 3, 0, 0, a);
    CHECK(a[0] == 0 && a[1] == 1 && script_source_count(s) == 2 && strcmp(script_source_at(s, 1).name, "lay.csv") == 0);
    script_close(s);
    s = loaded(FIBRES("s.fibres.file { path = 'lay.csv', method = 'inverse_distance' }"));
    if (!s) return;
    fibres_at(s, 0, 2, 0, 0, a);
    CHECK_NEAR(a[0], a[1], 1e-12);
    script_close(s);
    files_write("lay.csv", "0,0,0,1,0,0\n4,0,0,0,1\n");
    refused(FIBRES("s.fibres.file { path = 'lay.csv' }"), "lay.csv:2: expected 6 numbers, as in the rows before, found 5 numbers");
    refused(FIBRES("s.fibres.file { path = 'lie.csv' }"), "scene.lua:3: path: expected a file that can be read");
    refused(FIBRES("s.fibres.file { path = 'lay.csv', method = 'nearby' }"), "method");
}

#define ENDS "inflow = s.box { min = { -1, -1, -1 }, max = { 0.5, 2, 9 } }, outflow = s.box { min = { 3.5, -1, -1 }, max = { 5, 2, 9 } }"

static void flows(void) {
    double a[6];
    script *s = loaded(FIBRES("s.fibres.flow { " ENDS ", second = 'y', resolution = 16 }"));
    if (!s) return;
    fibres_at(s, 0, 2, 0.3, 0.7, a);
    CHECK_NEAR(a[0], 1, 1e-4);
    CHECK(a[4] == 1);
    script_close(s);
    /* The same fibres in two bodies run in each of them: the second is a bar along z with its ends on the sides. */
    s = loaded(HEAD "local lay = s.fibres.flow { resolution = 16,\n"
               "inflow = s.box { min = { -1, -1, -1 }, max = { 0.5, 2, 0.5 } }, outflow = s.box { min = { 3.5, -1, -1 }, max = { 5, 2, 9 } }\n"
               "+ s.box { min = { -1, -1, 5.5 }, max = { 3, 2, 9 } } }\n"
               "return s.scene { particles = 1000, duration = 1, solids = { { " BAR ", fibres = lay },\n"
               "{ shape = s.box { min = { 0, 0, 0 }, max = { 0.4, 1, 6 } }, " MATTER ", fibres = lay } } }");
    if (!s) return;
    fibres_at(s, 0, 2, 0.3, 0.7, a);
    CHECK_NEAR(a[0], 1, 0.05);
    fibres_at(s, 1, 0.2, 0.5, 3, a);
    CHECK_NEAR(a[2], 1, 1e-3);
    fibres_at(s, 0, 2, 0.3, 0.7, a);
    CHECK_NEAR(a[0], 1, 0.05);
    script_close(s);
    refused(FIBRES("s.fibres.flow { resolution = 16, inflow = s.sphere { radius = 1 },\n outflow = s.sphere { center = { 9, 9, 9 }, radius = 1 } }"),
            "scene.lua:4: outflow: expected a shape that holds a part of the body, and not all of it, found none of it, or all");
    refused(FIBRES("s.fibres.flow { inflow = s.sphere { radius = 1 } }"), "outflow: expected");
    refused(FIBRES("s.fibres.flow { " ENDS ",\nresolution = 999 }"), "scene.lua:4: resolution");
    refused(FIBRES("s.fibres.flow { inflow = 3, outflow = s.sphere { radius = 1 } }"), "inflow: expected a shape");
}

/* Reading and solving in C is not the script's time: what is allowed here would not do for it. */
static void time_in_c_is_not_the_scripts(void) {
    script_options o = script_options_default();
    o.time_limit = 0.02;
    made_torus(&made, 1, 0.3, 120, 60);
    write_made("meshes/ring.stl", made_stl(&made, false));
    char text[2000];
    snprintf(text, sizeof text, "%s", HEAD "local ring = s.mesh { file = 'meshes/ring.stl' }\nlocal sum = 0\nfor i = 1, 20000 do sum = sum + i end\n"
             "return s.scene { particles = 1000, duration = 1, solids = { { " BAR ",\nfibres = s.fibres.flow { " ENDS ", resolution = 60 } } },\n"
             "colliders = { { shape = ring } } }");
    script *s = load_with(text, &o, NULL);
    CHECK(s != NULL);
    if (!s) printf("  %s\n", complaint());
    script_close(s);
}

/* Bodies of tetrahedra: the words for them, and what is wrong with each. */
static void tetrahedra(void) {
    script *s = loaded(SCENE("{ shape = s.mesh { file = 'meshes/ball.stl' }, discretisation = 'tetrahedra', mesher = 'gmsh',"
                             " start = function(x, y, z) return 2 * x, y + 1, -z end, " MATTER " }, "
                             "{ shape = s.sphere { radius = 1 }, discretisation = 'tetrahedra', start = { 1, 2, 3 }, " MATTER " }"));
    if (s) {
        const scene *sc = script_scene(s);
        CHECK(sc->bodies[0].discretisation == DISCRETISATION_TETRAHEDRA && sc->bodies[0].mesher == MESHER_GMSH && scene_is_tetrahedra(sc));
        CHECK(sc->bodies[1].mesher == MESHER_LATTICE);
        double place[3];
        report r;
        CHECK(scene_function_evaluate(&sc->bodies[0].start, (double[]){1, 2, 3}, 3, place, &r) == STATUS_OK);
        CHECK(place[0] == 2 && place[1] == 3 && place[2] == -3);
        CHECK(scene_function_evaluate(&sc->bodies[1].start, (double[]){1, 2, 3}, 3, place, &r) == STATUS_OK && place[2] == 3);
        script_close(s);
    }
    s = loaded(SCENE("{ shape = s.sphere { radius = 1 }, " MATTER " }"));
    if (s) CHECK(script_scene(s)->bodies[0].discretisation == DISCRETISATION_PARTICLES && script_scene(s)->bodies[0].start.outputs == 0);
    script_close(s);
#define BALL(words) SCENE("{ shape = s.sphere { radius = 1 }, " words ", " MATTER " }")
    refused(BALL("discretisation = 'tetrahedrons'"), "tetrahedra");
    refused(BALL("discretisation = 'tetrahedra', mesher = 'gmesh'"), "gmsh");
    refused(BALL("discretisation = 'tetrahedra', start = function(x, y, z) return x end"), "solids[1].start");
    refused(BALL("start = { 0, 0, 0 }"), "discretisation");
#undef BALL
}

int main(void) {
    files_open();
    write_meshes();
    RUN(meshes_are_placed);
    RUN(meshes_are_sources);
    RUN(wrong_meshes);
    RUN(curves);
    RUN(random_fibres);
    RUN(tables);
    RUN(flows);
    RUN(tetrahedra);
    RUN(time_in_c_is_not_the_scripts);
    files_close();
    CHECK(memory_live_bytes() == 0);
    return check_finish();
}
