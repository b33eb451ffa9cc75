/* Meshes of tetrahedra: right-handed, face to face, closed, as large as the shape. */
#include "check.h"

#include "base/memory.h"
#include "geom/tetrahedra.h"
#include "unit/mesh_files.h"

static arena *memory;

static double volume_of(const tetrahedra *t) {
    double sum = 0;
    for (int64_t i = 0; i < t->count; i++) {
        CHECK(tetrahedra_determinant(t, i) > 0);
        sum += tetrahedra_determinant(t, i) / 6;
    }
    return sum;
}

static int compare_faces(const void *a, const void *b) {
    return memcmp(a, b, 4 * sizeof(int32_t));
}

/* Faces as three sorted corners and the side that they are seen from: an inner face occurs twice, once from each side, an outer one once. */
static int64_t outer_faces(const tetrahedra *t) {
    static const int faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    int64_t n = 4 * t->count, outer = 0;
    int32_t(*list)[4] = memory_allocate_array((size_t)n, sizeof *list);
    for (int64_t i = 0; i < n; i++) {
        int32_t f[3], side = 1;
        for (int k = 0; k < 3; k++) f[k] = t->corner[4 * (i / 4) + faces[i % 4][k]];
        for (int pass = 0; pass < 2; pass++)
            for (int k = 0; k < 2; k++)
                if (f[k] > f[k + 1]) {
                    int32_t swap = f[k];
                    f[k] = f[k + 1], f[k + 1] = swap, side = -side;
                }
        memcpy(list[i], (int32_t[]){f[0], f[1], f[2], side}, sizeof *list);
    }
    qsort(list, (size_t)n, sizeof *list, compare_faces);
    for (int64_t i = 0; i < n;) {
        int64_t end = i + 1;
        while (end < n && memcmp(list[i], list[end], 3 * sizeof(int32_t)) == 0) end++;
        CHECK(end - i <= 2);
        if (end - i == 2) CHECK(list[i][3] == -list[i + 1][3]);
        else outer++;
        i = end;
    }
    memory_free(list, (size_t)n * sizeof *list);
    return outer;
}

static void a_box_is_filled_exactly(void) {
    tetrahedra t;
    report r;
    const shape *box = shape_box(memory, (const double[]){-1, 0, 2}, (const double[]){1, 1.5, 3.1});
    CHECK(tetrahedra_fill(box, 0.3, &t, &r) == STATUS_OK);
    CHECK(t.count == 5 * 7 * 5 * 4 && t.vertex_count == 8 * 6 * 5);
    CHECK_NEAR(volume_of(&t), 2 * 1.5 * 1.1, 1e-12);
    CHECK(outer_faces(&t) == 2 * 2 * (7 * 5 + 5 * 4 + 7 * 4));
    tetrahedra_free(&t);
    /* coarser than the box: one cube */
    CHECK(tetrahedra_fill(box, 10, &t, &r) == STATUS_OK && t.count == 5 && t.vertex_count == 8);
    CHECK_NEAR(volume_of(&t), 2 * 1.5 * 1.1, 1e-12);
    tetrahedra_free(&t);
}

static void round_shapes_are_near(void) {
    const double origin[3] = {0.1, 0.2, -0.3}, axis[3] = {0, 0, 1};
    const struct {
        const shape *shape;
        double volume;
    } rows[] = {{shape_sphere(memory, origin, 1), 4 * M_PI / 3}, {shape_torus(memory, origin, axis, 1, 0.4), 2 * M_PI * M_PI * 0.16}};
    for (int i = 0; i < 2; i++) {
        double error[2];
        for (int fine = 0; fine < 2; fine++) {
            tetrahedra t;
            report r;
            CHECK(tetrahedra_fill(rows[i].shape, fine ? 0.06 : 0.12, &t, &r) == STATUS_OK);
            error[fine] = fabs(volume_of(&t) / rows[i].volume - 1);
            int64_t outer = outer_faces(&t), on = 0;
            for (int64_t v = 0; v < t.vertex_count; v++) on += fabs(shape_distance(rows[i].shape, t.vertex + 3 * v)) < 0.012;
            printf("  %lld tetrahedra, %lld faces outside, %lld vertices near the surface: volume off by %.2f %%\n", (long long)t.count,
                   (long long)outer, (long long)on, 100 * error[fine]);
            CHECK(outer > 100 && on > outer / 6); /* a third of the vertices: a closed surface has half as many as triangles */
            tetrahedra_free(&t);
        }
        CHECK(error[0] < 0.04 && error[1] < 0.02);
    }
}

static void wrong_input_is_named(void) {
    tetrahedra t;
    report r;
    const shape *half = shape_half_space(memory, (const double[]){0, 0, 0}, (const double[]){0, 1, 1});
    const shape *ball = shape_sphere(memory, (const double[]){0, 0, 0}, 1);
    CHECK(tetrahedra_fill(half, 0.1, &t, &r) == STATUS_INPUT && strcmp(r.key, "shape") == 0 && t.count == 0);
    CHECK(tetrahedra_fill(ball, 1e-5, &t, &r) == STATUS_INPUT && strcmp(r.key, "dx") == 0);
    CHECK(tetrahedra_fill(ball, 0, &t, &r) == STATUS_INPUT);
    CHECK(tetrahedra_fill(ball, NAN, &t, &r) == STATUS_INPUT);
    const shape *thin = shape_tube(memory, (const double[]){0, 0, 0}, (const double[]){0, 0, 1}, 1, 0.99, 1, 1);
    CHECK(tetrahedra_fill(thin, 1, &t, &r) == STATUS_INPUT && strcmp(r.key, "dx") == 0 && !t.vertex);
}

static void memory_may_be_out(void) {
    report r;
    const shape *ball = shape_sphere(memory, (const double[]){0, 0, 0}, 1);
    size_t before = memory_live_bytes();
    int failures = 0;
    for (int64_t n = 1; n < 100; n++) {
        tetrahedra t;
        memory_fail_after(n, 0);
        status code = tetrahedra_fill(ball, 0.3, &t, &r);
        memory_fail_after(0, 0);
        tetrahedra_free(&t);
        CHECK(memory_live_bytes() == before);
        if (code == STATUS_OK) break;
        CHECK(code == STATUS_SYSTEM);
        failures++;
    }
    CHECK(failures >= 6);
}

static const shape *shape_of(const made_mesh *made) {
    made_file f = made_obj(made);
    mesh m;
    mesh_report facts;
    report r;
    CHECK(mesh_read("made.obj", f.data, f.size, &m, &r) == STATUS_OK && mesh_make_solid("made.obj", &m, &facts, &r) == STATUS_OK);
    const shape *s = shape_mesh(memory, &m, "made.obj");
    mesh_free(&m);
    free(f.data);
    return s;
}

/* Triangles cut to length: the surface is what it was, closed, and no side is too long. */
static void long_sides_are_cut(void) {
    static made_mesh made;
    made_box(&made, (const double[]){0, 0, 0}, (const double[]){3, 0.5, 1});
    mesh m;
    mesh_report facts;
    report r;
    CHECK(shape_triangles(shape_of(&made), &m, &r) == STATUS_OK && m.triangle_count == 12);
    CHECK(mesh_cut_long_sides(&m, 0.2, &r) == STATUS_OK);
    CHECK(mesh_inspect(&m, &facts, &r) == STATUS_OK);
    CHECK(facts.boundary_edges == 0 && facts.nonmanifold_edges == 0 && facts.opposed_edges == 0 && facts.orientation == MESH_OUTWARD);
    CHECK_NEAR(facts.volume, 1.5, 1e-12);
    double longest = 0;
    for (int64_t i = 0; i < 3 * m.triangle_count; i++) {
        const double *a = m.vertex + 3 * (int64_t)m.triangle[i], *b = m.vertex + 3 * (int64_t)m.triangle[i - i % 3 + (i + 1) % 3];
        longest = fmax(longest, hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]));
    }
    CHECK(longest <= 0.2 && m.triangle_count < 4000);
    mesh_free(&m);
}

/* A box and a torus, moved: as large as they are, face to face, the surface's corners kept. */
static void gmsh_fills_meshes(void) {
    static made_mesh box, ring;
    tetrahedra t;
    report r;
    made_box(&box, (const double[]){0, 0, 0}, (const double[]){1, 2, 1});
    made_torus(&ring, 1, 0.4, 60, 30);
    if (!tetrahedra_gmsh_version(&r)) {
        printf("  Gmsh is not there: %s\n", r.expected);
        CHECK(tetrahedra_fill_gmsh(shape_of(&box), 0.25, &t, &r) == STATUS_INPUT && strcmp(r.key, "mesher") == 0 && strstr(r.expected, "libgmsh"));
        return;
    }
    CHECK(tetrahedra_fill_gmsh(shape_of(&box), 0.25, &t, &r) == STATUS_OK);
    printf("  box: %lld tetrahedra of %lld vertices\n", (long long)t.count, (long long)t.vertex_count);
    CHECK_NEAR(volume_of(&t), 2, 1e-9);
    CHECK(t.count > 300 && t.count < 10000 && outer_faces(&t) >= 12 * 16);
    tetrahedra_free(&t);
    const double turn[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1}, aside[3] = {5, 0, 0};
    const shape *moved = shape_transform(memory, shape_of(&ring), turn, 2, aside);
    CHECK(shape_is_mesh(moved) && tetrahedra_fill_gmsh(moved, 0.3, &t, &r) == STATUS_OK);
    printf("  torus: %lld tetrahedra of %lld vertices\n", (long long)t.count, (long long)t.vertex_count);
    CHECK_NEAR(volume_of(&t) / (8 * 2 * M_PI * M_PI * 0.16), 1, 0.01);
    CHECK(outer_faces(&t) == 2 * 60 * 30); /* no side is over 1.5 × 0.3 */
    for (int64_t v = 0; v < t.vertex_count; v++) CHECK(fabs(t.vertex[3 * v] - 5) < 2.81);
    tetrahedra_free(&t);
    /* again, with the library already there, gives the same */
    tetrahedra again;
    CHECK(tetrahedra_fill_gmsh(moved, 0.3, &t, &r) == STATUS_OK && tetrahedra_fill_gmsh(moved, 0.3, &again, &r) == STATUS_OK);
    CHECK(t.count == again.count && t.vertex_count == again.vertex_count);
    CHECK(memcmp(t.corner, again.corner, (size_t)t.count * 16) == 0 && memcmp(t.vertex, again.vertex, (size_t)t.vertex_count * 24) == 0);
    tetrahedra_free(&t), tetrahedra_free(&again);
    CHECK(tetrahedra_fill_gmsh(shape_sphere(memory, (const double[]){0, 0, 0}, 1), 0.3, &t, &r) == STATUS_INPUT && strcmp(r.key, "mesher") == 0);
}

int main(void) {
    memory = arena_create("test");
    RUN(a_box_is_filled_exactly);
    RUN(round_shapes_are_near);
    RUN(wrong_input_is_named);
    RUN(memory_may_be_out);
    RUN(long_sides_are_cut);
    RUN(gmsh_fills_meshes);
    arena_destroy(memory);
    return check_finish();
}
