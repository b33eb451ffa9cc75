/* src/view: camera, depth image, terminal raster, colour maps, plots, pictures. */
#include "check.h"

#include "base/memory.h"
#include "base/random.h"
#include "view/picture.h"
#include "view/plot.h"
#include "view/raster.h"

#include <png.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

/* ---- camera ------------------------------------------------------------------------------------------------------ */

static float dot(const float a[3], const float b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void test_camera_is_orthonormal(void) {
    view_camera camera = view_camera_default();
    for (int i = 0; i < 50; i++) {
        view_camera_orbit(&camera, 0.7f, i % 2 ? 0.9f : -0.4f);
        view_projection p = view_camera_projection(&camera, 80, 60);
        CHECK_NEAR(dot(p.right, p.right), 1, 1e-6);
        CHECK_NEAR(dot(p.up, p.up), 1, 1e-6);
        CHECK_NEAR(dot(p.back, p.back), 1, 1e-6);
        CHECK_NEAR(dot(p.right, p.up), 0, 1e-6);
        CHECK_NEAR(dot(p.right, p.back), 0, 1e-6);
        CHECK_NEAR(dot(p.up, p.back), 0, 1e-6);
        /* Right-handed: right × up = back. */
        CHECK_NEAR(p.right[1] * p.up[2] - p.right[2] * p.up[1], p.back[0], 1e-6);
        CHECK_NEAR(p.right[2] * p.up[0] - p.right[0] * p.up[2], p.back[1], 1e-6);
    }
}

static void test_camera_directions(void) {
    view_camera camera = view_camera_default();
    camera.yaw = camera.pitch = 0;
    view_projection p = view_camera_projection(&camera, 100, 100);
    float at[3], right[3] = {0.1f, 0, 0}, up[3] = {0, 0.1f, 0}, near[3] = {0, 0, 0.1f};
    view_project(&p, right, at);
    CHECK(at[0] > 50 && fabsf(at[1] - 50) < 1e-4f && fabsf(at[2]) < 1e-4f);
    view_project(&p, up, at);
    CHECK(at[1] < 50 && fabsf(at[0] - 50) < 1e-4f);
    view_project(&p, near, at);
    CHECK(at[2] < 0);
}

/* Whatever the yaw, all corners of the box that was fitted are inside, and the scale does not change. */
static void test_camera_fits_a_box(void) {
    const float low[3] = {-3, 1, 10}, high[3] = {5, 2, 14};
    view_camera camera = view_camera_default();
    view_camera_fit(&camera, low, high);
    float scale = view_camera_projection(&camera, 90, 80).scale;
    for (int turn = 0; turn < 36; turn++) {
        view_camera_orbit(&camera, 0.1745f, 0);
        view_projection p = view_camera_projection(&camera, 90, 80);
        CHECK_NEAR(p.scale, scale, 1e-4);
        for (int corner = 0; corner < 8; corner++) {
            float at[3], x[3];
            for (int k = 0; k < 3; k++) x[k] = corner >> k & 1 ? high[k] : low[k];
            view_project(&p, x, at);
            CHECK(at[0] >= 0 && at[0] <= 90 && at[1] >= 0 && at[1] <= 80);
        }
    }
    const float point[3] = {2, 2, 2};
    view_camera_fit(&camera, point, point);
    CHECK(isfinite(view_camera_projection(&camera, 90, 80).scale));
}

/* ---- raster ------------------------------------------------------------------------------------------------------ */

/* A projection that takes (x, y) for pixels as they are, and −z for depth. */
static view_projection flat(void) {
    return (view_projection){.right = {1, 0, 0}, .up = {0, -1, 0}, .back = {0, 0, 1}, .scale = 1};
}

enum { CELLS_X = 4, CELLS_Y = 3 };

static view_canvas canvas_for(view_mode mode, const float *points, const float *values, int64_t count) {
    view_canvas canvas = {0};
    report r;
    CHECK(view_canvas_resize(&canvas, CELLS_X * view_mode_pixels_x(mode), CELLS_Y * view_mode_pixels_y(mode), &r) ==
          STATUS_OK);
    view_projection p = flat();
    view_canvas_draw(&canvas, &p, points, values, count, 0);
    view_canvas_light(&canvas, 0);
    return canvas;
}

static void test_point_lands_in_its_braille_dot(void) {
    /* The eight dots of U+2800 in reading order, as the Unicode standard numbers them. */
    static const uint32_t dot_of[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};
    for (int y = 0; y < 4 * CELLS_Y; y++) {
        for (int x = 0; x < 2 * CELLS_X; x++) {
            float point[3] = {(float)x + 0.5f, (float)y + 0.5f, 0}, value = 0.75f;
            view_canvas canvas = canvas_for(VIEW_BRAILLE, point, &value, 1);
            view_cell cells[CELLS_X * CELLS_Y];
            view_raster(&canvas, VIEW_BRAILLE, VIEW_INK_SOLID, cells);
            int drawn = 0;
            for (int i = 0; i < CELLS_X * CELLS_Y; i++) drawn += cells[i].glyph != ' ';
            const view_cell *cell = &cells[y / 4 * CELLS_X + x / 2];
            CHECK(drawn == 1);
            CHECK(cell->glyph == 0x2800 + dot_of[y % 4][x % 2]);
            CHECK_NEAR(cell->value[0], 0.75, 1e-6);
            view_canvas_free(&canvas);
        }
    }
}

static void test_nearest_particle_gives_the_value(void) {
    const float points[12] = {2.5f, 1.5f, -5, 2.5f, 1.5f, 3, 2.5f, 1.5f, 1, 3.5f, 2.5f, 2};
    const float values[4] = {0.1f, 0.9f, 0.4f, 0.6f};
    view_canvas canvas = canvas_for(VIEW_BRAILLE, points, values, 4);
    CHECK_NEAR(canvas.value[1 * canvas.width + 2], 0.9, 1e-6);
    view_cell cells[CELLS_X * CELLS_Y];
    view_raster(&canvas, VIEW_BRAILLE, VIEW_INK_SOLID, cells);
    CHECK_NEAR(cells[1].value[0], 0.9, 1e-6); /* of two dots in the cell the nearer one */
    CHECK(cells[0].value[0] < 0 && cells[0].glyph == ' ');
    view_canvas_free(&canvas);
}

static void test_half_blocks(void) {
    const float points[12] = {0.5f, 0.5f, 0, 1.5f, 1.5f, 0, 2.5f, 0.5f, 0, 2.5f, 1.5f, 0};
    const float values[4] = {0.2f, 0.4f, 0.6f, 0.8f};
    view_canvas canvas = canvas_for(VIEW_HALF, points, values, 4);
    view_cell cells[CELLS_X * CELLS_Y];
    view_raster(&canvas, VIEW_HALF, VIEW_INK_SOLID, cells);
    CHECK(cells[0].glyph == 0x2580 && cells[0].value[0] > 0.19f && cells[0].value[1] < 0);
    CHECK(cells[1].glyph == 0x2584 && cells[1].value[0] < 0 && cells[1].value[1] > 0.39f);
    CHECK(cells[2].glyph == 0x2580);
    CHECK_NEAR(cells[2].value[0], 0.6, 1e-6);
    CHECK_NEAR(cells[2].value[1], 0.8, 1e-6);
    CHECK(cells[3].glyph == ' ');
    view_canvas_free(&canvas);
}

static void test_odd_positions_are_left_out(void) {
    const float points[15] = {NAN, 1, 0, 1, INFINITY, 0, -3, 1, 0, 1e30f, 1e30f, 1e30f, 1.5f, 1.5f, 0};
    const float values[5] = {1, 1, 1, 1, NAN};
    view_canvas canvas = canvas_for(VIEW_ASCII, points, values, 5);
    view_cell cells[CELLS_X * CELLS_Y];
    view_raster(&canvas, VIEW_ASCII, VIEW_INK_SOLID, cells);
    int drawn = 0;
    for (int i = 0; i < CELLS_X * CELLS_Y; i++) drawn += cells[i].glyph != ' ';
    CHECK(drawn == 1 && cells[0].glyph > ' ' && cells[0].glyph < 0x7f);
    CHECK(cells[0].value[0] >= 0 && cells[0].value[0] <= 1);
    /* The same with spheres, which reach over the edges. */
    view_projection p = flat();
    view_canvas_clear(&canvas);
    view_canvas_draw(&canvas, &p, points, values, 5, 3);
    CHECK(isfinite(canvas.depth[0]) && isinf(canvas.depth[canvas.width * canvas.height - 1]));
    view_canvas_free(&canvas);
}

/* A lit sphere: the upper left is brighter than the lower right, and a sphere's front is nearer than its rim. */
static void test_sphere_has_relief(void) {
    view_canvas canvas = {0};
    report r;
    CHECK(view_canvas_resize(&canvas, 60, 60, &r) == STATUS_OK);
    const float centre[3] = {30, 30, 0};
    view_projection p = flat();
    view_canvas_draw(&canvas, &p, centre, NULL, 1, 14);
    view_canvas_light(&canvas, 1);
    CHECK_NEAR(canvas.depth[30 * 60 + 30], -14, 0.1);
    CHECK(canvas.depth[30 * 60 + 42] > canvas.depth[30 * 60 + 30]);
    CHECK(isinf(canvas.depth[5 * 60 + 5]));
    CHECK(canvas.shade[24 * 60 + 24] > canvas.shade[37 * 60 + 37] + 0.2f);
    view_canvas_free(&canvas);
}

/* Spheres hidden behind others are passed over: the picture must be the one that all of them make. */
static void test_hidden_spheres_change_nothing(void) {
    enum { COUNT = 4000, W = 150, H = 110 };
    static float position[COUNT][3], value[COUNT];
    for (uint64_t i = 0; i < COUNT; i++) {
        for (uint64_t k = 0; k < 3; k++) position[i][k] = 170 * (float)random_unit(11, k, i) - 10;
        value[i] = (float)i / COUNT;
    }
    view_canvas canvas = {0};
    report r;
    CHECK(view_canvas_resize(&canvas, W, H, &r) == STATUS_OK);
    view_projection p = flat();
    const float radius = 12;
    view_canvas_draw(&canvas, &p, &position[0][0], value, COUNT, radius);
    int wrong = 0, covered = 0;
    for (int i = 0; i < W * H; i++) {
        float nearest = INFINITY, x = (float)(i % W) + 0.5f, y = (float)(i / W) + 0.5f;
        for (int k = 0; k < COUNT; k++) {
            float dx = x - position[k][0], dy = y - position[k][1], rise = radius * radius - dx * dx - dy * dy;
            if (rise >= 0) nearest = fminf(nearest, -position[k][2] - sqrtf(rise));
        }
        covered += isfinite(nearest);
        wrong += isfinite(nearest) ? !(fabsf(canvas.depth[i] - nearest) < 1e-3f) : isfinite(canvas.depth[i]);
    }
    CHECK(covered > W * H / 2);
    CHECK(wrong == 0);
    view_canvas_free(&canvas);
}

static void test_light_thins_ink(void) {
    view_canvas canvas = {0};
    report r;
    CHECK(view_canvas_resize(&canvas, 2, 4, &r) == STATUS_OK);
    int dots[2];
    for (int bright = 0; bright < 2; bright++) {
        for (int i = 0; i < 8; i++) {
            canvas.depth[i] = 0;
            canvas.shade[i] = bright ? 1.0f : 0.2f;
        }
        view_cell cell;
        view_raster(&canvas, VIEW_BRAILLE, VIEW_INK_LIGHT, &cell);
        dots[bright] = __builtin_popcount(cell.glyph & 0xff);
    }
    CHECK(dots[1] == 8);
    CHECK(dots[0] > 0 && dots[0] < 5);
    view_canvas_free(&canvas);
}

static void test_particle_radius(void) {
    enum { SIDE = 12 };
    static float lattice[SIDE * SIDE * SIDE][3];
    for (int i = 0; i < SIDE * SIDE * SIDE; i++) {
        lattice[i][0] = 0.25f * (float)(i % SIDE);
        lattice[i][1] = 0.25f * (float)(i / SIDE % SIDE);
        lattice[i][2] = 0.25f * (float)(i / SIDE / SIDE);
    }
    float radius = view_particle_radius(&lattice[0][0], SIDE * SIDE * SIDE);
    CHECK(radius > 0.25f * 0.707f && radius < 0.25f * 1.2f); /* half a face's diagonal closes a lattice plane */
    CHECK_NEAR(view_particle_radius(&lattice[0][0], 1), 0, 0);
    CHECK_NEAR(view_particle_radius(&lattice[0][0], 2), 0.25 * 0.75, 1e-6);
}

/* ---- palette ----------------------------------------------------------------------------------------------------- */

static void test_palettes_are_monotone(void) {
    for (int palette = 0; palette < VIEW_PALETTES; palette++) {
        double sign = palette == VIEW_INK ? -1 : 1, previous = sign > 0 ? -1 : -2;
        for (int i = 0; i <= 200; i++) {
            double l = sign * view_luminance(view_palette_rgb((view_palette)palette, (float)i / 200, 1));
            CHECK(l >= previous - 2e-3);
            previous = l;
        }
        double first = view_luminance(view_palette_rgb((view_palette)palette, 0, 1));
        double last = view_luminance(view_palette_rgb((view_palette)palette, 1, 1));
        CHECK(sign * (last - first) > 0.35);
        CHECK(view_palette_find(view_palette_name((view_palette)palette)) == palette);
    }
    CHECK(view_palette_find("no such map") == -1);
}

static void test_ansi_ramps_are_monotone(void) {
    /* xterm's standard colours. */
    static const view_rgb ansi[16] = {{0, 0, 0},       {205, 0, 0},   {0, 205, 0},   {205, 205, 0},
                                      {0, 0, 238},     {205, 0, 205}, {0, 205, 205}, {229, 229, 229},
                                      {127, 127, 127}, {255, 0, 0},   {0, 255, 0},   {255, 255, 0},
                                      {92, 92, 255},   {255, 0, 255}, {0, 255, 255}, {255, 255, 255}};
    for (int palette = 0; palette < VIEW_PALETTES; palette++) {
        for (int bright = 0; bright < 2; bright++) {
            double sign = palette == VIEW_INK ? -1 : 1, previous = -2;
            for (int i = 0; i <= 20; i++) {
                int colour = view_palette_ansi((view_palette)palette, (float)i / 20, bright);
                CHECK(colour >= 0 && colour < (bright ? 16 : 8));
                double l = sign * view_luminance(ansi[colour]);
                CHECK(l >= previous - 1e-9);
                previous = l;
            }
        }
    }
}

static void test_xterm_colours(void) {
    CHECK(view_rgb_to_256((view_rgb){0, 0, 0}) == 16);
    CHECK(view_rgb_to_256((view_rgb){255, 255, 255}) == 231);
    CHECK(view_rgb_to_256((view_rgb){255, 0, 0}) == 196);
    CHECK(view_rgb_to_256((view_rgb){95, 135, 175}) == 67);
    CHECK(view_rgb_to_256((view_rgb){128, 128, 128}) == 244);
    view_rgb dark = view_palette_rgb(VIEW_EMBER, 0.5f, 0), lit = view_palette_rgb(VIEW_EMBER, 0.5f, 1);
    CHECK(view_luminance(dark) < 0.3 * view_luminance(lit));
    view_rgb odd = view_palette_rgb(VIEW_EMBER, NAN, 1), one = view_palette_rgb(VIEW_EMBER, 1, 1);
    CHECK(memcmp(&odd, &one, sizeof odd) == 0);
}

/* ---- plots ------------------------------------------------------------------------------------------------------- */

static void test_sparkline(void) {
    char text[VIEW_PLOT_BYTES(16)];
    const double steps[8] = {0, 1, 2, 3, 4, 5, 6, 7};
    view_sparkline(steps, 8, 0, 8, 8, false, text);
    CHECK(strcmp(text, "▁▂▃▄▅▆▇█") == 0);
    view_sparkline(steps, 8, 0, 8, 10, false, text);
    CHECK(strcmp(text, "  ▁▂▃▄▅▆▇█") == 0);
    view_sparkline(steps, 8, 0, 8, 4, false, text); /* means 0.5, 2.5, 4.5, 6.5 */
    CHECK(strcmp(text, "▁▃▅▇") == 0);
    const double odd[4] = {NAN, -5, 100, INFINITY};
    view_sparkline(odd, 4, 0, 1, 4, false, text);
    CHECK(strcmp(text, " ▁█ ") == 0);
    view_sparkline(odd + 1, 2, 0, 0, 2, false, text); /* no range: the lowest */
    CHECK(strcmp(text, "▁▁") == 0);
    view_sparkline(steps, 8, 0, 7, 8, true, text);
    CHECK(strcmp(text, "_.-=+*##") == 0);
}

static void test_bar(void) {
    char text[VIEW_PLOT_BYTES(16)];
    view_bar(0.5, 4, false, text);
    CHECK(strcmp(text, "██  ") == 0);
    view_bar(1, 3, false, text);
    CHECK(strcmp(text, "███") == 0);
    view_bar(11.0 / 16, 2, false, text);
    CHECK(strcmp(text, "█▍") == 0);
    view_bar(1e-9, 3, false, text);
    CHECK(strcmp(text, "▏  ") == 0);
    view_bar(0, 3, false, text);
    CHECK(strcmp(text, "   ") == 0);
    view_bar(NAN, 2, false, text);
    CHECK(strcmp(text, "  ") == 0);
    view_bar(7, 2, true, text);
    CHECK(strcmp(text, "##") == 0);
    view_bar(0.5, 4, true, text);
    CHECK(strcmp(text, "##  ") == 0);
}

static void test_scales(void) {
    CHECK_NEAR(view_log_fraction(1, 1e-4, 1), 1, 0);
    CHECK_NEAR(view_log_fraction(1e-2, 1e-4, 1), 0.5, 1e-12);
    CHECK_NEAR(view_log_fraction(1e-5, 1e-4, 1), 0, 0);
    CHECK_NEAR(view_log_fraction(0, 1e-4, 1), 0, 0);
    CHECK_NEAR(view_log_fraction(NAN, 1e-4, 1), 0, 0);
    const double bins[6] = {1, 2, 3, 4, 5, 6};
    double groups[3];
    view_rebin(bins, 6, groups, 3);
    CHECK_NEAR(groups[0], 3, 0);
    CHECK_NEAR(groups[2], 11, 0);
}

/* ---- pictures ---------------------------------------------------------------------------------------------------- */

static void test_png_round_trip(void) {
    enum { W = 37, H = 21 };
    uint8_t pixels[H][W][3], back[H][W][3];
    for (int i = 0; i < W * H * 3; i++) (&pixels[0][0][0])[i] = (uint8_t)random_bits(3, 0, (uint64_t)i);
    char path[] = "/tmp/sunder-view-XXXXXX";
    int descriptor = mkstemp(path);
    CHECK(descriptor >= 0);
    close(descriptor);
    report r;
    CHECK(view_write_png(path, &pixels[0][0][0], W, H, &r) == STATUS_OK);
    png_image image = {.version = PNG_IMAGE_VERSION};
    CHECK(png_image_begin_read_from_file(&image, path) != 0);
    image.format = PNG_FORMAT_RGB;
    CHECK(image.width == W && image.height == H);
    CHECK(png_image_finish_read(&image, NULL, back, 0, NULL) != 0);
    CHECK(memcmp(pixels, back, sizeof pixels) == 0);
    unlink(path);
    CHECK(view_write_png("/nonexistent-folder/x.png", &pixels[0][0][0], W, H, &r) == STATUS_SYSTEM);
    CHECK(strstr(r.message, "/nonexistent-folder/x.png") != NULL);
}

/* 50 000 particles of a block, one half damaged: left and right of the picture differ in colour, the corners stay
 * background. */
static void test_render(void) {
    enum { COUNT = 50000 };
    float *position = memory_allocate_array(3 * COUNT, sizeof(float));
    float *value = memory_allocate_array(COUNT, sizeof(float));
    view_render_options o = view_render_options_default();
    size_t bytes = 3 * (size_t)o.width * (size_t)o.height;
    uint8_t *rgb = memory_allocate(bytes);
    CHECK(position && value && rgb);
    for (uint64_t i = 0; i < COUNT; i++) {
        for (uint64_t k = 0; k < 3; k++) position[3 * i + k] = (float)random_unit(7, k, i) * (k == 0 ? 2.0f : 1.0f);
        value[i] = position[3 * i] > 1 ? 1 : 0;
    }
    position[0] = NAN;
    float low[3], high[3];
    CHECK(view_bounds(position, COUNT, low, high) == COUNT - 1);
    view_camera_fit(&o.camera, low, high);
    o.camera.yaw = o.camera.pitch = 0;
    size_t before = memory_live_bytes();
    report r;
    clock_t start = clock();
    CHECK(view_render_points(position, value, COUNT, &o, rgb, &r) == STATUS_OK);
    double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
    printf("  50 000 particles at %d × %d: %.3f s\n", o.width, o.height, seconds);
    CHECK(memory_live_bytes() == before);
    const uint8_t *corner = rgb, *left = rgb + 3 * (360 * 1280 + 500), *right = rgb + 3 * (360 * 1280 + 780);
    CHECK(memcmp(corner, &o.background, 3) == 0);
    view_rgb l = {left[0], left[1], left[2]}, g = {right[0], right[1], right[2]};
    CHECK(l.b > l.r);      /* intact: slate */
    CHECK(g.r > g.b + 20); /* broken: flame */
    CHECK(view_luminance(g) > view_luminance(l) + 0.1);
    /* Memory that runs out is reported and leaves nothing behind. */
    for (int n = 1; n <= 5; n++) {
        memory_fail_after(n, 0);
        CHECK(view_render_points(position, value, COUNT, &o, rgb, &r) == STATUS_SYSTEM);
        CHECK(memory_live_bytes() == before);
    }
    memory_fail_after(0, 0);
    memory_free(position, 3 * COUNT * sizeof(float));
    memory_free(value, COUNT * sizeof(float));
    memory_free(rgb, bytes);
}

int main(void) {
    RUN(test_camera_is_orthonormal);
    RUN(test_camera_directions);
    RUN(test_camera_fits_a_box);
    RUN(test_point_lands_in_its_braille_dot);
    RUN(test_nearest_particle_gives_the_value);
    RUN(test_half_blocks);
    RUN(test_odd_positions_are_left_out);
    RUN(test_sphere_has_relief);
    RUN(test_hidden_spheres_change_nothing);
    RUN(test_light_thins_ink);
    RUN(test_particle_radius);
    RUN(test_palettes_are_monotone);
    RUN(test_ansi_ramps_are_monotone);
    RUN(test_xterm_colours);
    RUN(test_sparkline);
    RUN(test_bar);
    RUN(test_scales);
    RUN(test_png_round_trip);
    RUN(test_render);
    return check_finish();
}
