/* Surfaces of particles: closed, turned outwards, and as large as the body; charts: what is drawn is where the numbers are. */
#include "check.h"

#include "base/compare.h"
#include "base/memory.h"
#include "view/chart.h"
#include "view/surface.h"

static uint64_t edge_key(int32_t a, int32_t b) {
    return (uint64_t)(uint32_t)a << 32 | (uint32_t)b;
}

/* Every directed edge has as many partners the other way round: no hole, and neighbours agree which side is out. */
static bool is_closed(const view_surface *s) {
    size_t n = 3 * (size_t)s->triangle_count, found = 0;
    uint64_t *there = malloc(n * sizeof *there), *back = malloc(n * sizeof *back);
    for (size_t i = 0; i < n; i++) {
        int32_t a = s->triangle[i], b = s->triangle[i % 3 == 2 ? i - 2 : i + 1];
        there[i] = edge_key(a, b);
        back[i] = edge_key(b, a);
    }
    qsort(there, n, sizeof *there, compare_u64);
    qsort(back, n, sizeof *back, compare_u64);
    for (size_t i = 0; i < n; i++) found += there[i] == back[i];
    free(there);
    free(back);
    return n > 0 && found == n;
}

/* By the divergence theorem; positive when triangles face outwards. */
static double volume(const view_surface *s) {
    double sum = 0;
    for (int64_t t = 0; t < s->triangle_count; t++) {
        const float *a = s->vertex + 3 * s->triangle[3 * t], *b = s->vertex + 3 * s->triangle[3 * t + 1], *c = s->vertex + 3 * s->triangle[3 * t + 2];
        sum += (double)(a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6;
    }
    return sum;
}

/* A lattice of spacing h within a ball, or a cube, of radius 1. */
static int64_t fill(float *position, double h, bool ball) {
    int64_t n = 0;
    for (double x = -1 + h / 2; x < 1; x += h)
        for (double y = -1 + h / 2; y < 1; y += h)
            for (double z = -1 + h / 2; z < 1; z += h) {
                if (ball && x * x + y * y + z * z > 1) continue;
                position[3 * n] = (float)x, position[3 * n + 1] = (float)y, position[3 * n + 2] = (float)z;
                n++;
            }
    return n;
}

static double surface_volume(double h, bool ball, bool *closed) {
    float *position = malloc(3 * 100000 * sizeof *position);
    int64_t n = fill(position, h, ball);
    view_surface s = {0};
    view_surface_options o = {.spacing = (float)h};
    report r;
    CHECK(view_surface_make(position, NULL, n, &o, &s, &r) == STATUS_OK);
    double v = volume(&s);
    *closed = is_closed(&s);
    view_surface_free(&s);
    free(position);
    return v;
}

static void test_volumes(void) {
    bool closed;
    double ball = surface_volume(0.1, true, &closed);
    CHECK(closed);
    CHECK_NEAR(ball, 4.0 / 3 * M_PI, 0.04 * 4.0 / 3 * M_PI);
    double fine = surface_volume(0.05, true, &closed);
    CHECK(closed);
    CHECK_NEAR(fine, 4.0 / 3 * M_PI, 0.02 * 4.0 / 3 * M_PI);
    CHECK_NEAR(surface_volume(0.1, false, &closed), 8, 0.05 * 8);
    CHECK(closed);
}

/* The spacing is found from the particles, and the quantity comes along. */
static void test_values(void) {
    float *position = malloc(3 * 20000 * sizeof *position), *value = malloc(20000 * sizeof *value);
    int64_t n = fill(position, 0.2, true);
    for (int64_t i = 0; i < n; i++) value[i] = position[3 * i];
    view_surface s = {0}, same = {0};
    view_surface_options o = {0};
    report r;
    CHECK(view_surface_make(position, value, n, &o, &s, &r) == STATUS_OK && s.vertex_count > 100);
    for (int64_t i = 0; i < s.vertex_count; i++)
        if (fabsf(s.value[i] - s.vertex[3 * i]) > 0.25F) CHECK(false);
    CHECK_NEAR(volume(&s), 4.0 / 3 * M_PI, 0.1 * 4.0 / 3 * M_PI);
    view_surface_free(&s);
    position[3 * n] = NAN, position[3 * n + 1] = 0, position[3 * n + 2] = 0; /* a particle that is lost changes nothing */
    o.spacing = 0.2F;
    CHECK(view_surface_make(position, NULL, n, &o, &s, &r) == STATUS_OK && view_surface_make(position, NULL, n + 1, &o, &same, &r) == STATUS_OK);
    CHECK(s.triangle_count == same.triangle_count && memcmp(s.vertex, same.vertex, (size_t)s.vertex_count * 12) == 0);
    view_surface_free(&s);
    view_surface_free(&same);
    o.cell = 1e-9F;
    CHECK(view_surface_make(position, NULL, n, &o, &s, &r) == STATUS_INPUT);
    CHECK(view_surface_make(position, NULL, 0, &(view_surface_options){.spacing = 1}, &s, &r) == STATUS_INPUT);
    free(position);
    free(value);
}

/* Two tetrahedra that share a face: six faces are seen, and the volume is theirs. */
static void test_tetrahedra(void) {
    const float position[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
    const int32_t corner[] = {0, 1, 2, 3, 1, 4, 2, 3};
    view_surface s;
    report r;
    CHECK(view_surface_tetrahedra(position, NULL, 5, corner, 2, &s, &r) == STATUS_OK);
    CHECK(s.triangle_count == 6 && s.vertex_count == 5 && is_closed(&s));
    CHECK_NEAR(volume(&s), 1.0 / 6 + 1.0 / 3, 1e-6);
    view_surface_free(&s);
}

static void test_out_of_memory(void) {
    float *position = malloc(3 * 5000 * sizeof *position);
    int64_t n = fill(position, 0.3, true);
    view_surface_options o = {.spacing = 0.3F};
    size_t before = memory_live_bytes();
    int failed = 0;
    for (int64_t countdown = 1;; countdown++) {
        view_surface s = {0};
        report r;
        memory_fail_after(countdown, 1);
        status code = view_surface_make(position, NULL, n, &o, &s, &r);
        memory_fail_after(0, 0);
        view_surface_free(&s);
        CHECK(memory_live_bytes() == before);
        if (code == STATUS_OK) break;
        CHECK(code == STATUS_SYSTEM);
        failed++;
    }
    CHECK(failed > 5);
    free(position);
}

/* ---- charts ------------------------------------------------------------------------------------------------------ */

enum { WIDTH = 60, HEIGHT = 16, LEFT = 10 };

static view_chart_cell cells[WIDTH * HEIGHT];

static int count_cells(int series, int row_from, int row_to, int column_from, int column_to) {
    int count = 0;
    for (int row = row_from; row < row_to; row++)
        for (int column = column_from; column < column_to; column++) count += cells[row * WIDTH + column].series == series;
    return count;
}

static bool row_has(int row, const char *text) {
    char line[WIDTH + 1];
    for (int i = 0; i < WIDTH; i++) line[i] = (char)(cells[row * WIDTH + i].glyph < 0x80 ? cells[row * WIDTH + i].glyph : '.');
    line[WIDTH] = '\0';
    return strstr(line, text) != NULL;
}

static void test_chart(void) {
    const double x[] = {0, 1, 2, 3, 4}, up[] = {0, 25, 50, 75, 100}, gap[] = {100, NAN, NAN, NAN, 100};
    view_chart_series series[] = {{x, up, 5, false}, {x, gap, 5, false}};
    view_chart_options o = {.width = WIDTH, .height = HEIGHT, .x_label = "time"};
    view_chart(series, 1, &o, cells);
    CHECK(count_cells(0, 0, HEIGHT, 0, WIDTH) >= WIDTH - LEFT);                   /* a line from side to side */
    CHECK(count_cells(0, 0, 3, LEFT, LEFT + 10) == 0);                            /* it rises: not in the upper left */
    CHECK(count_cells(0, HEIGHT - 5, HEIGHT - 2, WIDTH - 10, WIDTH) == 0);
    CHECK(count_cells(0, 0, 2, WIDTH - 6, WIDTH) > 0 && count_cells(0, HEIGHT - 4, HEIGHT - 2, LEFT, LEFT + 6) > 0);
    CHECK(row_has(0, "100") && row_has(HEIGHT - 1, "time") && row_has(HEIGHT - 1, "0"));
    CHECK(count_cells(0, 0, HEIGHT, 0, LEFT) == 0); /* axes are left alone */
    view_chart(series, 2, &o, cells);
    CHECK(count_cells(1, 0, HEIGHT, 0, WIDTH) <= 3 && count_cells(1, 0, 2, 0, WIDTH) >= 1); /* two points and a letter, nothing between them */
    CHECK(view_chart_letter(0) == 'A' && row_has(0, "A") && row_has(1, "B")); /* the same newest point: one below the other */
}

static void test_chart_corners(void) {
    const double x[] = {1, 10, 100, 1000}, y[] = {1, 10, 100, 1000}, same[] = {5, 5, 5, 5}, none[] = {NAN, -1, 0, NAN};
    view_chart_options o = {.width = WIDTH, .height = HEIGHT, .log_x = true, .log_y = true, .ascii = true};
    view_chart_series line = {x, y, 4, false};
    view_chart(&line, 1, &o, cells);
    /* On logarithmic axes a power law is straight: the middle is crossed in the middle. */
    CHECK(count_cells(0, 5, 9, LEFT + 20, LEFT + 30) > 0 && count_cells(0, 0, 4, LEFT, LEFT + 20) == 0);
    for (int i = 0; i < WIDTH * HEIGHT; i++) CHECK(cells[i].glyph < 0x80);
    CHECK(row_has(0, "1000"));
    view_chart_series flat = {x, same, 4, true}, empty = {x, none, 4, false};
    o = (view_chart_options){.width = VIEW_CHART_LEAST_WIDTH, .height = VIEW_CHART_LEAST_HEIGHT};
    view_chart(&flat, 1, &o, cells);
    o.log_y = true;
    view_chart(&empty, 1, &o, cells);
    view_chart(NULL, 0, &o, cells);
    for (int i = 0; i < o.width * o.height; i++) CHECK(cells[i].series == -1);
}

int main(void) {
    RUN(test_volumes);
    RUN(test_values);
    RUN(test_tetrahedra);
    RUN(test_out_of_memory);
    RUN(test_chart);
    RUN(test_chart_corners);
    return check_finish();
}
