/* Same input, same bits: over threads, and over a stop and a restart (DESIGN.md, "Same bits").
 *
 * A sheet that is drawn, heated at places, swells, softens and cracks from a notch, in each law, lattice and precision. */
#include "check.h"
#include "verify/sheet_patch.h"

enum { SIDE = 40 };

static patch *cracking_sheet(arena *memory, const char *law, sheet_lattice lattice) {
    static int32_t hot[SIDE];
    static double rate[SIDE];
    patch *p = patch_create(lattice, 0.05, lattice == SHEET_SCATTERED ? 2.2 : 1.5, 0.02);
    patch_fill(p, SIDE, SIDE);
    if (lattice == SHEET_SCATTERED)
        for (int i = 0; i < SIDE * SIDE; i++)
            for (int c = 0; c < 2; c++) p->rest[i][c] += 0.01 * patch_random((uint64_t)(2 * i + c)), p->position[i][c] = p->rest[i][c];
    patch_set(p, law, "E", 100);
    if (strcmp(law, "elastoplastic") == 0) patch_set(p, law, "eta0", 0.01), patch_set(p, law, "beta", 0.1), patch_set(p, law, "nu", 0.2);
    patch_set(p, "fracture", "stretch", 0.04);
    patch_set(p, "diffusion", "k", 0.05);
    patch_set(p, "swelling", "alpha", 0.03);
    patch_set(p, "softening", "stiffness", 0.5);
    patch_set(p, "self_contact", "stiffness", 0.5);
    if (lattice == SHEET_HEXAGONAL) patch_set(p, "bending", "stiffness", 1e-4);
    p->d.notches[0] = (sheet_notch){.body = -1, .from = {-1, 0.98, 0}, .to = {0.5, 0.98, 0}, .normal = {0, 0, 1}};
    p->d.notch_count = 1;
    for (int k = 0; k < SIDE; k++) hot[k] = (37 * k * k) % (SIDE * SIDE), rate[k] = 20;
    p->d.sources[0] = (sheet_source){.count = SIDE, .particle = hot, .value = rate, .stop = HUGE_VAL};
    p->d.source_count = 1;
    for (int side = 0; side < 2; side++) {
        double edge = side ? 1e3 : -1e3, near = side ? 1.85 : 0.1;
        p->d.boundaries[side] = (rigid_boundary){.shape = shape_box(memory, (const double[]){-1e3, fmin(near, edge), -1e3}, (const double[]){1e3, fmax(near, edge), 1e3}),
                                                 .grip = true, .motion = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .velocity = {0.1, side ? 0.5 : -0.5, 0.1}, .active = true}};
    }
    p->d.boundary_count = 2;
    return p;
}

typedef struct picture {
    double position[SIDE * SIDE][3], diffused[SIDE * SIDE];
    sheet_measures m;
} picture;

static void look(patch *p, picture *out) {
    p->engine->settle(p->state, p->time);
    p->engine->read(p->state, "position", out->position[0]);
    p->engine->read(p->state, "diffused", out->diffused);
    out->m = patch_measure(p);
}

static const char *const laws[] = {"linear", "rubber", "elastoplastic"};
static const sheet_lattice lattices[] = {SHEET_SQUARE, SHEET_HEXAGONAL, SHEET_SCATTERED};
static const int64_t STEPS = 300;

static void threads_do_not_change_bits(void) {
    static const int threads[] = {1, 2, 3, 7};
    static picture first, other;
    arena *memory = arena_create("threads");
    for (int k = 0; k < 3; k++)
        for (int precision = 32; precision <= 64; precision += 32)
            for (int t = 0; t < 4; t++) {
                patch *p = cracking_sheet(memory, laws[k], lattices[k]);
                CHECK(patch_start(p, precision, "auto", threads[t]));
                CHECK(patch_steps(p, STEPS, 0.5 * patch_limit(p)) == STATUS_OK);
                memset(&other, 0, sizeof other);
                look(p, t == 0 ? &first : &other);
                if (t == 0) CHECK(first.m.bonds_broken > SIDE && first.m.diffused_max > 0.01);
                else CHECK(memcmp(&first.position, &other.position, sizeof first.position) == 0 && memcmp(&first.diffused, &other.diffused, sizeof first.diffused) == 0 &&
                           first.m.bonds_broken == other.m.bonds_broken && first.m.elastic == other.m.elastic && first.m.grip_work == other.m.grip_work);
                patch_free(p);
            }
    arena_destroy(memory);
}

static void a_restored_sheet_goes_on_with_the_same_bits(void) {
    static picture first, other;
    static record_list records;
    arena *memory = arena_create("restart");
    report r;
    for (int k = 0; k < 3; k++)
        for (int precision = 32; precision <= 64; precision += 32) {
            patch *p = cracking_sheet(memory, laws[k], lattices[k]);
            CHECK(patch_start(p, precision, "auto", 2));
            double dt = 0.5 * patch_limit(p);
            CHECK(patch_steps(p, STEPS / 2 + 7, dt) == STATUS_OK);
            CHECK(p->engine->save(p->state, &records, &r) == STATUS_OK);
            double time = p->time;
            CHECK(patch_steps(p, STEPS / 2, dt) == STATUS_OK);
            look(p, &first);
            patch_stop(p);
            CHECK(patch_start(p, precision, "auto", 1));
            CHECK(p->engine->restore(p->state, &records, &r) == STATUS_OK);
            p->time = time;
            CHECK(patch_steps(p, STEPS / 2, dt) == STATUS_OK);
            look(p, &other);
            CHECK(memcmp(&first.position, &other.position, sizeof first.position) == 0 && memcmp(&first.diffused, &other.diffused, sizeof first.diffused) == 0);
            CHECK(first.m.bonds_broken == other.m.bonds_broken && first.m.grip_work == other.m.grip_work);
            record_clear(&records);
            patch_free(p);
        }
    arena_destroy(memory);
}

/* Both copies of a bond have the same history: pairs as the engine lists them are whole, and half of the directed ones. */
static void both_ends_agree(void) {
    arena *memory = arena_create("ends");
    patch *p = cracking_sheet(memory, "linear", SHEET_SQUARE);
    CHECK(patch_start(p, 32, "auto", 2));
    CHECK(patch_steps(p, STEPS, 0.5 * patch_limit(p)) == STATUS_OK);
    int64_t count = p->engine->bonds(p->state, NULL, NULL), broken = 0;
    int32_t *pairs = malloc((size_t)count * 2 * sizeof *pairs);
    uint8_t *flags = malloc((size_t)count);
    CHECK(p->engine->bonds(p->state, pairs, flags) == count);
    for (int64_t k = 0; k < count; k++) {
        broken += flags[k];
        CHECK(pairs[2 * k] < pairs[2 * k + 1]);
        if (k) CHECK(pairs[2 * k - 2] < pairs[2 * k] || (pairs[2 * k - 2] == pairs[2 * k] && pairs[2 * k - 1] < pairs[2 * k + 1]));
    }
    sheet_measures m = patch_measure(p);
    CHECK(count == 4 * SIDE * SIDE - 6 * SIDE + 2); /* 8-neighbour bonds of a square */
    double shares[SIDE * SIDE], histogram[SHEET_BINS] = {0};
    CHECK(p->engine->read(p->state, "broken", shares) == 1);
    for (int i = 0; i < SIDE * SIDE; i++) histogram[shares[i] < 1 ? (int)(shares[i] * SHEET_BINS) : SHEET_BINS - 1] += 1;
    CHECK(histogram[0] < SIDE * SIDE);
    for (int i = 0; i < SHEET_BINS; i++) CHECK_NEAR(m.histogram[i], histogram[i] / (SIDE * SIDE), 1e-15);
    CHECK(m.bonds_total == count && m.bonds_broken == broken); /* measures halve the directed count: lost to rounding if ends disagreed */
    free(pairs);
    free(flags);
    patch_free(p);
    arena_destroy(memory);
}

int main(void) {
    RUN(threads_do_not_change_bits);
    RUN(a_restored_sheet_goes_on_with_the_same_bits);
    RUN(both_ends_agree);
    return check_finish();
}
