/* Meshes: every format against the same shape, what is wrong with a file or a surface, and distances against closed
 * forms and brute force. */
#include "base/random.h"
#include "check.h"
#include "geom/mesh.h"
#include "geom/shape.h"
#include "unit/mesh_files.h"

#define PI 3.14159265358979323846

static const double LOW[3] = {-1, -0.5, 0}, HIGH[3] = {1, 0.75, 2}, ORIGIN[3] = {0, 0, 0}, Z_AXIS[3] = {0, 0, 1};

static made_mesh made; /* large: not on the stack */
static arena *shapes;
static report trouble;

static mesh read_file(const char *name, made_file f) {
    mesh m;
    status code = mesh_read(name, f.data, f.size, &m, &trouble);
    char text[900];
    report_format(&trouble, text, sizeof text);
    CHECK(code == STATUS_OK);
    if (code != STATUS_OK) printf("  %s: %s\n", name, text);
    free(f.data);
    return m;
}

static mesh read_made(const made_mesh *from) {
    return read_file("made.obj", made_obj(from));
}

/* Reads text; expects wrong input and these words. */
static void refused(const char *name, const char *text, size_t size, const char *words) {
    mesh m;
    char said[900];
    status code = mesh_read(name, text, size, &m, &trouble);
    CHECK(code == STATUS_INPUT);
    report_format(&trouble, said, sizeof said);
    CHECK(strstr(said, words) != NULL && strstr(said, name) == said);
    if (!strstr(said, words)) printf("  said: %s\n  not:  %s\n", said, words);
    CHECK(m.vertex == NULL && m.triangle == NULL);
    mesh_free(&m);
}

static void refused_text(const char *name, const char *text, const char *words) {
    refused(name, text, strlen(text), words);
}

static mesh_report facts_of(const mesh *m) {
    mesh_report facts = {0};
    CHECK(mesh_inspect(m, &facts, &trouble) == STATUS_OK);
    return facts;
}

/* The mesh as a shape; the mesh is freed. */
static const shape *solid_of(mesh *m) {
    mesh_report facts;
    status code = mesh_make_solid("made.obj", m, &facts, &trouble);
    CHECK(code == STATUS_OK);
    if (code != STATUS_OK) printf("  %s %s\n", trouble.expected, trouble.found);
    const shape *s = code == STATUS_OK ? shape_mesh(shapes, m, "made.obj") : NULL;
    mesh_free(m);
    return s;
}

static const shape *solid_of_made(void) {
    mesh m = read_made(&made);
    return solid_of(&m);
}

static void cloud_point(uint64_t n, double reach, double x[3]) {
    for (uint64_t i = 0; i < 3; i++) x[i] = reach * (2.0 * random_unit(12, 1, 3 * n + i) - 1.0);
}

/* ---- formats ----------------------------------------------------------------------------------------------------- */

static void check_same(mesh m, double tolerance) {
    CHECK(m.vertex_count == 162 && m.triangle_count == 320);
    mesh_report facts = facts_of(&m);
    CHECK(facts.boundary_edges == 0 && facts.nonmanifold_edges == 0 && facts.components == 1 && facts.holes == 0);
    CHECK(facts.orientation == MESH_OUTWARD);
    CHECK_NEAR(facts.volume, 4.0470, 2e-4);
    double worst = 0;
    for (int64_t t = 0; t < m.triangle_count; t++)
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 3; i++) {
                double x = m.vertex[3 * m.triangle[3 * t + k] + i];
                worst = fmax(worst, fabs(x - made.vertex[made.triangle[t][k]][i]));
            }
    CHECK_NEAR(worst, 0.0, tolerance);
    mesh_free(&m);
}

static void every_format_holds_the_same(void) {
    made_sphere(&made, 2);
    check_same(read_file("a.obj", made_obj(&made)), 1e-12);
    check_same(read_file("folder.x/a.PLY", made_ply(&made, "ascii")), 1e-12);
    check_same(read_file("a.ply", made_ply(&made, "binary_little_endian")), 1e-12);
    check_same(read_file("a.ply", made_ply(&made, "binary_big_endian")), 1e-12);
    check_same(read_file("a.stl", made_stl(&made, true)), 1e-8);
    check_same(read_file("a.Stl", made_stl(&made, false)), 1e-7);
}

static const char *const CUBE_VERTICES = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1 # c\n";

static void obj_forms(void) {
    static const char *const faces[] = {
        "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n",
        "f 4/1 3/1 2/1 1/1\r\nf 5//9 6//9 7//9 8//9\r\nf 1/2/3 2/2/3 6/2/3 5/2/3\r\nf 2 3 7 6\r\nf 3 4 8 7\r\nf 4 1 5 8",
        "\tf -5 -6 -7 -8 # down\nf -4 -3 -2 -1\ng side\nf 1 2 \\\n 6 5\nf 2 3 7 6\nusemtl none\nf 3 4 8 7\nf 4 1 5 8\n",
    };
    for (int k = 0; k < 3; k++) {
        char text[1000];
        snprintf(text, sizeof text, "%s%s", CUBE_VERTICES, faces[k]);
        mesh m;
        CHECK(mesh_read("cube.obj", text, strlen(text), &m, &trouble) == STATUS_OK);
        mesh_report facts = facts_of(&m);
        CHECK(facts.vertices == 8 && facts.triangles == 12 && facts.boundary_edges == 0 && facts.orientation == MESH_OUTWARD);
        CHECK_NEAR(facts.volume, 1.0, 1e-15);
        for (int i = 0; i < 3; i++) CHECK(facts.minimum[i] == 0.0 && facts.maximum[i] == 1.0);
        mesh_free(&m);
    }
}

static void numbers(void) {
    static const struct {
        const char *text;
        double value;
    } rows[] = {{"0.1", 0.1}, {"-12.5e-3", -0.0125}, {"+.5", 0.5}, {"5.", 5}, {"1E2", 100}, {"0", 0}, {"1e-400", 0},
                {"3.14159265358979312", 3.14159265358979312}, {"123456789012345678901234567890e-29", 1.23456789012345678901},
                {"0.00000000000000000000000000001e29", 1}};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        char text[300];
        snprintf(text, sizeof text, "v %s 7 8\nv 20 0 0\nv 0 20 0\nf 1 2 3\n", rows[k].text);
        mesh m;
        CHECK(mesh_read("n.obj", text, strlen(text), &m, &trouble) == STATUS_OK);
        CHECK_NEAR(m.vertex[0], rows[k].value, 1e-15 * fabs(rows[k].value));
        mesh_free(&m);
    }
    static const char *const wrong[] = {"nan", "inf", "1e400", "1.2.3", "0x10", "--1", "1e", "e5", ".", "1,5", "1e31"};
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        char text[100], words[100];
        snprintf(text, sizeof text, "v 0 0 0\nv 1 %s 0\n", wrong[k]);
        snprintf(words, sizeof words, "n.obj:2: v: expected three finite coordinates, found '%s'", wrong[k]);
        refused_text("n.obj", text, words);
    }
}

static void welding(void) {
    /* Two triangles that share an edge, written with corners of their own a rounding apart; a sliver; a lone vertex. */
    mesh m;
    const char *text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 1e-8\nv 1e-8 1 0\nv 1 1 0\nv 9 9 9\nv 0 1e-8 0\n"
                       "f 1 2 3\nf 4 6 5\nf 1 8 3\n";
    CHECK(mesh_read("w.obj", text, strlen(text), &m, &trouble) == STATUS_OK);
    mesh_report facts = facts_of(&m);
    CHECK(facts.vertices == 4 && facts.triangles == 2 && facts.boundary_edges == 4 && facts.holes == 1);
    CHECK(facts.maximum[0] == 1.0); /* the lone vertex does not count */
    mesh_free(&m);
}

/* ---- what is wrong with a file ----------------------------------------------------------------------------------- */

static void wrong_obj(void) {
    refused_text("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n# c\nf 1 2 4\n", "x.obj:5: f: expected vertices by number, 1 to 3 (or -1 to -3), found '4'");
    refused_text("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", "found '0'");
    refused_text("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n", "found '-4'");
    refused_text("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 1.5\n", "found '1.5'");
    refused_text("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n", "x.obj:4: f: expected");
    refused_text("x.obj", "f 1 2 3\n", "x.obj:1: f: expected v lines before the first f line");
    refused_text("x.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", "x.obj:4: f: expected at least three corners, found the end of the line");
    refused_text("x.obj", "v 0 0\n", "x.obj:1: v: expected three finite coordinates, found the end of the line");
    refused_text("x.obj", "v 0 \x01\xff 1\n", "found '?"); /* what is no text is not shown */
    refused_text("x.obj", "# nothing\n", "expected a mesh with triangles, found none");
    refused_text("x.obj", "", "expected a mesh, found an empty file");
    refused_text("x.obj", "v 1 1 1\nf 1 1 1\n", "expected a mesh of some size");
    refused_text("x.obj", "v 1 1 1\nv 2 2 2\nf 1 2 1\n", "expected triangles of some size");
    refused_text("x.fbx", "whatever", "expected a mesh: a file that ends in .obj, .ply or .stl");
}

#define PLY_HEAD "ply\nformat ascii 1.0\n"
#define PLY_XYZ "property float x\nproperty float y\nproperty float z\n"
#define PLY_FACES(n) "element face " n "\nproperty list uchar int vertex_index\nend_header\n"

static void wrong_ply(void) {
    const char *points = "0 0 0\n1 0 0\n0 1 0\n";
    char text[500];
    refused_text("x.ply", "plyx\n", "x.ply:1: expected \"ply\", found 'plyx'");
    refused_text("x.ply", "ply\nformat ascii 1.0\nelement vertex 3\n" PLY_XYZ, "expected end_header, found the end of the file");
    refused_text("x.ply", "ply\nformat latin 1.0\n", "x.ply:2: format: expected ascii, binary_little_endian or binary_big_endian, found 'latin'");
    refused_text("x.ply", PLY_HEAD "element vertex -3\n", "x.ply:3: element: expected a count");
    refused_text("x.ply", PLY_HEAD "element vertex 3\nproperty quad x\n", "x.ply:4: property: expected a type, such as float or uchar, found 'quad'");
    refused_text("x.ply", PLY_HEAD "element vertex 3\nproperty list float int x\n", "expected a whole type");
    refused_text("x.ply", PLY_HEAD "property float x\n", "expected an element before its properties");
    refused_text("x.ply", PLY_HEAD "element vertex 3\nproperty float x\nproperty float y\n" PLY_FACES("1"), "expected an element \"vertex\" with x, y and z");
    refused_text("x.ply", PLY_HEAD "element vertex 3\n" PLY_XYZ "end_header\n", "expected an element \"face\"");
    refused_text("x.ply", PLY_HEAD "element thing 2000000000\nelement vertex 3\n" PLY_XYZ PLY_FACES("1"), "expected properties of every element");
    refused_text("x.ply", PLY_HEAD "element vertex 2000000000\n" PLY_XYZ PLY_FACES("1") "0 0 0\n1 0", "x.ply:11: expected a finite coordinate, found the end of the file");
    snprintf(text, sizeof text, PLY_HEAD "element vertex 3\n" PLY_XYZ PLY_FACES("1") "%s3 0 1 3\n", points);
    refused_text("x.ply", text, "x.ply:13: expected a vertex by number, 0 to 2, found '3'");
    snprintf(text, sizeof text, PLY_HEAD "element vertex 3\n" PLY_XYZ PLY_FACES("1") "%s2 0 1\n", points);
    refused_text("x.ply", text, "x.ply:13: expected three corners or more, found '2'");
    snprintf(text, sizeof text, PLY_HEAD "element vertex 3\n" PLY_XYZ PLY_FACES("1") "0 0 0\n1 nan 0\n");
    refused_text("x.ply", text, "x.ply:11: expected a finite coordinate, found 'nan'");
}

static void wrong_binary(void) {
    made = (made_mesh){0};
    made_box(&made, LOW, HIGH);
    made_file f = made_ply(&made, "binary_big_endian");
    size_t body = (size_t)(strstr(f.data, "end_header\n") - f.data) + strlen("end_header\n");
    refused("x.ply", f.data, body + 30, "x.ply: byte 323: expected a finite coordinate, found the end of the file");
    CHECK(body == 298);
    memset(f.data + body, 0x7f, 8); /* x of the first vertex: not a number */
    f.data[body] = 0x7f, f.data[body + 1] = (char)0xff;
    refused("x.ply", f.data, f.size, "x.ply: byte 298: expected a finite coordinate, found nan");
    free(f.data);
    f = made_ply(&made, "binary_little_endian");
    f.data[f.size - 2] = 1; /* the last corner */
    refused("x.ply", f.data, f.size, "expected a vertex by number, 0 to 7, found 65541");
    free(f.data);
    f = made_stl(&made, false);
    refused("x.stl", f.data, f.size - 1, "x.stl: byte 80: expected 684 bytes for 12 triangles, found 683 bytes");
    refused("x.stl", f.data, 50, "expected an STL file");
    memset(f.data + 80, 0xff, 4);
    refused("x.stl", f.data, f.size, "for 4294967295 triangles");
    f.data[80] = 12, f.data[81] = f.data[82] = f.data[83] = 0;
    memset(f.data + 84 + 50 + 12, 0xff, 4);
    refused("x.stl", f.data, f.size, "x.stl: byte 146: expected a finite coordinate, found");
    free(f.data);
}

static void wrong_stl(void) {
    refused_text("x.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n", "x.stl:6: loop: expected three vertices before endloop");
    refused_text("x.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nvertex 1 0 0\n", "x.stl:5: vertex: expected three finite coordinates, found 'vertex'");
    refused_text("x.stl", "solid a\nfacet normal 0 0 1\nouter circle\n", "x.stl:3: expected facet, outer loop, vertex, endloop, endfacet or endsolid, found 'circle'");
    refused_text("x.stl", "solid a\nfacet normal 0 0 1\n", "expected endsolid, found the end of the file");
}

/* Every prefix of every format, and many files with bytes changed: a status, never a crash (the sanitizers' build tells
 * more), and nothing kept. What is accepted goes through everything behind the reader too. */
static void try_garbage(const char *name, const char *data, size_t size) {
    mesh m;
    mesh_report facts;
    /* A block of just this size, so that a sanitizer sees a byte read behind it. */
    char *copy = malloc(size ? size : 1);
    memcpy(copy, data, size);
    status code = mesh_read(name, copy, size, &m, &trouble);
    free(copy);
    if (code == STATUS_OK) code = mesh_make_solid(name, &m, &facts, &trouble);
    if (code == STATUS_OK) {
        arena *a = arena_create("garbage");
        const shape *s = shape_mesh(a, &m, name);
        CHECK(s && !isnan(shape_distance(s, m.vertex)));
        arena_destroy(a);
    } else {
        CHECK(code == STATUS_INPUT && trouble.file[0]);
    }
    mesh_free(&m);
}

static void garbage_is_survived(void) {
    made = (made_mesh){0};
    made_box(&made, LOW, HIGH);
    size_t before = memory_live_bytes();
    made_file files[6] = {made_obj(&made), made_ply(&made, "ascii"), made_ply(&made, "binary_little_endian"),
                          made_ply(&made, "binary_big_endian"), made_stl(&made, true), made_stl(&made, false)};
    static const char *const names[6] = {"g.obj", "g.ply", "g.ply", "g.ply", "g.stl", "g.stl"};
    static const char spice[] = "0123456789-+.e \n/\\nan\xff\x7f\x80";
    for (int k = 0; k < 6; k++) {
        for (size_t size = 0; size < files[k].size; size++) try_garbage(names[k], files[k].data, size);
        for (uint64_t n = 0; n < 3000; n++) {
            char *copy = malloc(files[k].size);
            memcpy(copy, files[k].data, files[k].size);
            int changes = 1 + (int)(random_bits(3, (uint64_t)k, n) % 6);
            for (int c = 0; c < changes; c++) {
                uint64_t bits = random_bits(4 + (uint64_t)c, (uint64_t)k, n);
                char byte = bits & 1 ? spice[(bits >> 8) % (sizeof spice - 1)] : (char)(bits >> 16);
                copy[(bits >> 32) % files[k].size] = byte;
            }
            try_garbage(names[k], copy, files[k].size);
            free(copy);
        }
        free(files[k].data);
    }
    CHECK(memory_live_bytes() == before);
}

/* ---- what is wrong with a surface -------------------------------------------------------------------------------- */

static void holes(void) {
    made_sphere(&made, 2);
    made.triangles--; /* the last, and one far from it */
    memcpy(made.triangle[0], made.triangle[--made.triangles], sizeof made.triangle[0]);
    made.triangle[0][1] = made.triangle[0][0];
    const double *x = made.vertex[made.triangle[319][0]];
    mesh m = read_made(&made);
    mesh_report facts = facts_of(&m);
    CHECK(facts.triangles == 317 && facts.components == 1 && facts.orientation == MESH_OUTWARD);
    CHECK(facts.boundary_edges >= 8 && facts.holes == 2);
    double to_any = HUGE_VAL;
    for (int k = 0; k < 3; k++) to_any = fmin(to_any, fabs(facts.hole_at[k] - x[k]));
    CHECK(mesh_make_solid("made.obj", &m, &facts, &trouble) == STATUS_INPUT);
    CHECK(strcmp(trouble.expected, "a closed surface") == 0 && strncmp(trouble.found, "2 holes (", 9) == 0);
    CHECK(strcmp(trouble.file, "made.obj") == 0 && strstr(trouble.found, "one at ("));
    mesh_free(&m);
    made = (made_mesh){0};
    made_box(&made, LOW, HIGH);
    made.triangles -= 2; /* the face x = 1 */
    m = read_made(&made);
    CHECK(mesh_make_solid("made.obj", &m, &facts, &trouble) == STATUS_INPUT);
    CHECK(strncmp(trouble.found, "1 hole (4 open edges), one at (1, ", 34) == 0);
    CHECK(facts.holes == 1 && facts.boundary_edges == 4 && facts.hole_at[0] == 1.0);
    mesh_free(&m);
}

static void orientation(void) {
    for (int kind = 0; kind < 3; kind++) {
        made_sphere(&made, 2);
        int wrong = 0;
        for (int t = 0; t < made.triangles; t++) {
            bool turn = kind == 0 || (kind == 1 && random_unit(5, 5, (uint64_t)t) < 0.3);
            if (turn) made_turn(&made, t), wrong++;
        }
        mesh m = read_made(&made);
        CHECK(facts_of(&m).orientation == (kind == 0 ? MESH_INWARD : kind == 1 ? MESH_MIXED : MESH_OUTWARD));
        int64_t turned;
        CHECK(mesh_orient("made.obj", &m, &turned, &trouble) == STATUS_OK && turned == wrong);
        CHECK(facts_of(&m).orientation == MESH_OUTWARD);
        CHECK_NEAR(facts_of(&m).volume, 4.0470, 2e-4);
        const shape *s = solid_of(&m);
        CHECK(shape_distance(s, ORIGIN) < -0.9);
    }
}

static void one_sided(void) {
    enum { LONG = 24 };
    made = (made_mesh){0};
    for (int i = 0; i < LONG; i++) {
        double u = 2 * PI * i / LONG, half = 0.5 * u;
        for (int side = -1; side <= 1; side += 2) {
            double radius = 1 + 0.3 * side * cos(half);
            made_vertex(&made, radius * cos(u), radius * sin(u), 0.3 * side * sin(half));
        }
    }
    for (int i = 0; i < LONG; i++) {
        int a = 2 * i, b = 2 * i + 1, c = i + 1 < LONG ? a + 2 : 1, d = i + 1 < LONG ? b + 2 : 0;
        made_triangle(&made, a, b, d);
        made_triangle(&made, a, d, c);
    }
    mesh m = read_made(&made);
    int64_t turned;
    CHECK(mesh_orient("moebius.obj", &m, &turned, &trouble) == STATUS_INPUT);
    CHECK(strstr(trouble.found, "a one-sided surface, near (") && strcmp(trouble.file, "moebius.obj") == 0);
    mesh_free(&m);
}

static void edges_of_many(void) {
    /* Two boxes that share an edge are a solid; a box with a wall across is not. */
    made = (made_mesh){0};
    made_box(&made, ORIGIN, (double[]){1, 1, 1});
    made_box(&made, (double[]){1, 1, 0}, (double[]){2, 2, 1});
    mesh m = read_made(&made);
    mesh_report facts = facts_of(&m);
    CHECK(facts.vertices == 14 && facts.nonmanifold_edges == 1 && facts.unpaired_edges == 0 && facts.components == 1);
    const shape *s = solid_of(&m);
    CHECK_NEAR(shape_distance(s, (double[]){0.5, 0.5, 0.5}), -0.5, 1e-15);
    CHECK_NEAR(shape_distance(s, (double[]){1.5, 1.5, 0.5}), -0.5, 1e-15);
    CHECK_NEAR(shape_distance(s, (double[]){1.25, 0.75, 0.5}), 0.25, 1e-15);
    made = (made_mesh){0};
    made_box(&made, ORIGIN, (double[]){1, 1, 1});
    made_triangle(&made, 0, 1, 7); /* the diagonal plane through two opposite edges */
    made_triangle(&made, 0, 7, 6);
    m = read_made(&made);
    CHECK(mesh_make_solid("made.obj", &m, &facts, &trouble) == STATUS_INPUT);
    CHECK(facts.unpaired_edges == 4 && strncmp(trouble.found, "4 edges where three or more triangles meet", 42) == 0);
    mesh_free(&m);
    made = (made_mesh){0};
    for (int k = 0; k < 4; k++) made_vertex(&made, k & 1, k & 2, 0);
    for (int side = 0; side < 2; side++) { /* a square and its back */
        made_triangle(&made, 0, 1, 3), made_triangle(&made, 0, 3, 2);
        if (side) made_turn(&made, 2), made_turn(&made, 3);
    }
    m = read_made(&made);
    CHECK(mesh_make_solid("made.obj", &m, &facts, &trouble) == STATUS_INPUT && strcmp(trouble.found, "a flat one") == 0);
    mesh_free(&m);
}

/* ---- distances --------------------------------------------------------------------------------------------------- */

/* Compares with a shape whose distance is exact, on points around `center`: equal near the surface, no further from zero
 * anywhere, and not much nearer. Both within `tolerance`. */
static void compare(const shape *m, const shape *exact, double reach, double near, double tolerance) {
    double worst = 0, beyond = 0, share = 1;
    int wrong_side = 0, close = 0;
    for (uint64_t n = 0; n < 20000; n++) {
        double x[3];
        cloud_point(n, n % 2 ? reach : 0.4 * reach, x);
        double d = shape_distance(m, x), e = shape_distance(exact, x);
        if (fabs(e) > tolerance) wrong_side += (d < 0) != (e < 0);
        beyond = fmax(beyond, fabs(d) - fabs(e));
        if (fabs(e) < near) worst = fmax(worst, fabs(d - e)), close++;
        else share = fmin(share, d / e);
    }
    CHECK(close > 300);
    CHECK(wrong_side == 0);
    CHECK_NEAR(worst, 0.0, tolerance);
    CHECK(beyond <= tolerance);
    CHECK(share > 0.6);
}

static void against_box(void) {
    made = (made_mesh){0};
    made_box(&made, LOW, HIGH);
    const shape *m = solid_of_made(), *box = shape_box(shapes, LOW, HIGH);
    compare(m, box, 2.5, 0.3, 1e-14);
    double low[3], high[3];
    shape_bounds(m, low, high);
    for (int i = 0; i < 3; i++) CHECK(low[i] == LOW[i] && high[i] == HIGH[i]);
    CHECK_NEAR(shape_volume(m, 0), 5.0, 5e-3);
    char text[100];
    shape_describe(m, text, sizeof text);
    CHECK(strcmp(text, "mesh 'made.obj' of 12 triangles") == 0);
    const double far[3] = {3e9, 4e9, 0};
    CHECK_NEAR(shape_distance(m, far), 5e9, 5e9 * 1e-6);
    CHECK_NEAR(shape_distance(m, (double[]){1e30, 0, 0}), 1e30, 1e24);
}

/* Corners, edges and faces of the mesh lie on the lattice of these points: crossings meet them exactly. */
static void on_the_lattice(void) {
    made_sphere(&made, 0);
    for (int v = 0; v < made.vertices; v++)
        for (int i = 0; i < 3; i++) made.vertex[v][i] = round(8 * made.vertex[v][i]);
    const shape *m = solid_of_made();
    int wrong = 0;
    for (int x = -9; x <= 9; x++)
        for (int y = -9; y <= 9; y++)
            for (int z = -9; z <= 9; z++) {
                /* By parity of the distance's sign along a small shift away from ties. */
                double at[3] = {x, y, z}, beside[3] = {x + 1e-5, y + 3e-5, z + 2e-5};
                double here = shape_distance(m, at), there = shape_distance(m, beside);
                if (fabs(here) > 1e-3 && (here < 0) != (there < 0)) wrong++;
            }
    CHECK(wrong == 0);
}

static void against_sphere_and_torus(void) {
    made_sphere(&made, 5); /* edges of 0.04: 2e-4 between chord and arc */
    const shape *m = solid_of_made(), *sphere = shape_sphere(shapes, ORIGIN, 1.0);
    compare(m, sphere, 1.5, 0.05, 4e-4);
    CHECK_NEAR(shape_volume(m, 0), 4.0 / 3.0 * PI, 0.01);
    made_torus(&made, 1.0, 0.3, 160, 50);
    m = solid_of_made();
    const shape *torus = shape_torus(shapes, ORIGIN, Z_AXIS, 1.0, 0.3);
    compare(m, torus, 1.5, 0.05, 1.3 * (1 - cos(PI / 160)) + 0.3 * (1 - cos(PI / 50)));
}

/* The solid angle of a triangle (Van Oosterom and Strackee). */
static double solid_angle(const double x[3], const double *const corner[3]) {
    double p[3][3], length[3];
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 3; i++) p[k][i] = corner[k][i] - x[i];
        length[k] = sqrt(p[k][0] * p[k][0] + p[k][1] * p[k][1] + p[k][2] * p[k][2]);
    }
    double det = p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) + p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
                 p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0]);
    double dots[3];
    for (int k = 0; k < 3; k++) {
        const double *a = p[(k + 1) % 3], *b = p[(k + 2) % 3];
        dots[k] = (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) * length[k];
    }
    return 2 * atan2(det, length[0] * length[1] * length[2] + dots[0] + dots[1] + dots[2]);
}

/* By sampling each triangle's plane and sides: slow, and written differently. */
static double brute_triangle(const double x[3], const double *const corner[3]) {
    double best = HUGE_VAL, low[2] = {0, 0}, center[2] = {0, 0}, size = 1;
    for (int round = 0; round < 60; round++) { /* a shrinking grid over (s, t) */
        for (int i = 0; i <= 8; i++)
            for (int k = 0; k <= 8; k++) {
                double s = fmin(fmax(low[0] + size * i / 8, 0), 1), t = fmin(fmax(low[1] + size * k / 8, 0), 1 - s), squared = 0;
                for (int c = 0; c < 3; c++) {
                    double d = corner[0][c] + s * (corner[1][c] - corner[0][c]) + t * (corner[2][c] - corner[0][c]) - x[c];
                    squared += d * d;
                }
                if (squared < best) best = squared, center[0] = s, center[1] = t;
            }
        size *= 0.8;
        low[0] = center[0] - 0.5 * size, low[1] = center[1] - 0.5 * size;
    }
    return sqrt(best);
}

/* Two spheres that overlap, a third with a cavity, a fourth turned inside out on its own. */
static void make_odd_mesh(void) {
    static made_mesh ball;
    made_sphere(&made, 1);
    made_sphere(&ball, 1);
    static const struct {
        double scale, x, y, z;
        bool turn;
    } more[] = {{0.8, 1.1, 0.3, 0.1, false}, {0.9, -0.4, 3, 0.2, false}, {0.4, -0.3, 3.1, 0.1, true}, {0.3, 2.5, 2.5, 0, true}};
    for (int k = 0; k < 4; k++) {
        int first = made.vertices, from = made.triangles;
        made_add(&made, &ball);
        made_move(&made, first, more[k].scale, more[k].x, more[k].y, more[k].z);
        for (int t = from; t < made.triangles && more[k].turn; t++) made_turn(&made, t);
    }
}

static void against_brute_force(void) {
    make_odd_mesh();
    mesh m = read_made(&made);
    double *vertex = malloc((size_t)m.vertex_count * 3 * sizeof *vertex);
    int32_t *triangle = malloc((size_t)m.triangle_count * 3 * sizeof *triangle);
    memcpy(vertex, m.vertex, (size_t)m.vertex_count * 3 * sizeof *vertex);
    memcpy(triangle, m.triangle, (size_t)m.triangle_count * 3 * sizeof *triangle);
    int64_t triangles = m.triangle_count;
    const shape *s = solid_of(&m);
    double worst = 0;
    int inside = 0, wrong = 0;
    for (uint64_t n = 0; n < 1200; n++) {
        double x[3], nearest = HUGE_VAL, angle = 0;
        cloud_point(n, n < 60 ? 1.2 : 2.0, x);
        x[0] += 0.8, x[1] += 1.5;
        for (int64_t t = 0; t < triangles; t++) {
            const double *corner[3];
            for (int k = 0; k < 3; k++) corner[k] = vertex + 3 * triangle[3 * t + k];
            angle += solid_angle(x, corner);
            if (n < 60) nearest = fmin(nearest, brute_triangle(x, corner));
        }
        double distance = shape_distance(s, x);
        bool within = fabs(angle / (4 * PI)) > 0.5;
        inside += within;
        wrong += within != (distance < 0);
        if (n >= 60) continue;
        CHECK(fabs(distance) < nearest + 1e-4);
        if (nearest < 0.1) worst = fmax(worst, nearest - fabs(distance));
    }
    CHECK(wrong == 0 && inside > 100);
    CHECK_NEAR(worst, 0.0, 1e-4);
    free(vertex);
    free(triangle);
}

/* A closed surface of needles and of triangles without area must not spoil distances. */
static void needles(void) {
    made = (made_mesh){0};
    made_box(&made, ORIGIN, (double[]){1, 1, 1});
    /* The edge from corner 0 to corner 4 gets a point in its middle and one just beside, used by one side only. */
    int middle = made_vertex(&made, 0, 0, 0.5);
    for (int t = 0; t < 12; t++) {
        int *c = made.triangle[t];
        for (int k = 0; k < 3; k++)
            if (c[k] == 0 && c[(k + 1) % 3] == 4) { /* this side only: a triangle without area closes the rest */
                int other = c[(k + 2) % 3];
                c[(k + 1) % 3] = middle;
                made_triangle(&made, middle, 4, other);
                made_triangle(&made, 0, 4, middle);
                k = 3, t = 12;
            }
    }
    mesh m = read_made(&made);
    mesh_report facts = facts_of(&m);
    CHECK(facts.triangles == 14 && facts.boundary_edges == 0);
    /* Turned away from the axes, the triangle's area is round-off. */
    const double a = 2.0 / 3, b = 1.0 / 3, turn[9] = {a, -b, a, a, a, -b, -b, a, a}, scale = 1.0 / 3;
    mesh_transform(&m, turn, scale, ORIGIN);
    const shape *s = solid_of(&m), *box = shape_box(shapes, ORIGIN, (double[]){1, 1, 1});
    const shape *turned = shape_transform(shapes, box, turn, scale, ORIGIN);
    compare(s, turned, 0.8, 0.05, 1e-9);
}

/* ---- memory ------------------------------------------------------------------------------------------------------ */

static bool build_all(const made_file *f) {
    mesh m;
    mesh_report facts;
    status code = mesh_read("m.ply", f->data, f->size, &m, &trouble);
    if (code == STATUS_OK) code = mesh_make_solid("m.ply", &m, &facts, &trouble);
    CHECK(code == STATUS_OK || code == STATUS_SYSTEM);
    arena *a = code == STATUS_OK ? arena_create("mesh") : NULL;
    bool built = a && shape_mesh(a, &m, "m.ply");
    arena_destroy(a);
    mesh_free(&m);
    return built;
}

static void every_allocation_may_fail(void) {
    made_torus(&made, 1, 0.4, 40, 30);
    made_file f = made_ply(&made, "binary_little_endian");
    size_t before = memory_live_bytes();
    int failed = 0;
    bool built = false;
    for (int n = 1; n < 200 && !built; n++) {
        memory_fail_after(n, 0);
        built = build_all(&f);
        memory_fail_after(0, 0);
        CHECK(memory_live_bytes() == before);
        failed += !built;
    }
    CHECK(built && failed >= 15);
    free(f.data);
}

int main(void) {
    shapes = arena_create("test shapes");
    if (!shapes) return 1;
    RUN(every_format_holds_the_same);
    RUN(obj_forms);
    RUN(numbers);
    RUN(welding);
    RUN(wrong_obj);
    RUN(wrong_ply);
    RUN(wrong_binary);
    RUN(wrong_stl);
    RUN(garbage_is_survived);
    RUN(holes);
    RUN(orientation);
    RUN(one_sided);
    RUN(edges_of_many);
    RUN(against_box);
    RUN(on_the_lattice);
    RUN(against_sphere_and_torus);
    RUN(against_brute_force);
    RUN(needles);
    RUN(every_allocation_may_fail);
    arena_destroy(shapes);
    CHECK(memory_live_bytes() == 0);
    return check_finish();
}
