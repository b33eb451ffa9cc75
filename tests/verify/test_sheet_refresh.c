/* Knobs: a sheet whose value is turned goes on as one that was made with it (sheet.h, `refresh`).
 *
 * The sheet is drawn, heated by sources, cracks and touches itself. For each live value: turned at once, its bits are those of a sheet made with the new
 * one; turned later, those of such a sheet that is given the state of the moment. */
#include "check.h"
#include "verify/sheet_patch.h"

enum { SIDE = 24, COUNT = SIDE * SIDE };

static const double DX = 0.05;

typedef struct turn {
    const char *law, *effect, *key;
    double from, to;
    bool grows; /* the engine needs arrays that it did not need: no state of before fits one made with them */
} turn;

static const turn turns[] = {
    {"linear", "linear", "E", 100, 140, false},
    {"linear", "linear", "nu", 1.0 / 3, 0.1, true},
    {"linear", "linear", "nu", 0.1, 1.0 / 3, true},
    {"linear", "linear", "nu", 0.1, 0.25, false},
    {"rubber", "rubber", "c_star", 0, -1, false},
    {"rubber", "rubber", "n", 2, 3, false},
    {"elastoplastic", "elastoplastic", "eta0", 0.01, 0.02, false},
    {"elastoplastic", "elastoplastic", "beta", 0.1, 0.3, false},
    {"linear", "fracture", "stretch", 0.05, 0.03, false},
    {"linear", "diffusion", "k", 0.05, 0.1, false},
    {"linear", "diffusion", "C", 1, 2, false},
    {"linear", "diffusion", "decay", 0, 3, false},
    {"linear", "swelling", "alpha", 0.03, 0.06, false},
    {"linear", "softening", "stiffness", 0.5, 0.9, false},
    {"linear", "softening", "stretch", 0, 0.5, false},
    {"linear", "softening", "floor", 0.01, 0.99, false},
    {"linear", "grain", "stiffness", 1, 2, false},
    {"linear", "grain", "toughness", 1, 2, false},
    {"linear", "bending", "stiffness", 1e-4, 3e-4, false},
    {"linear", "bending", "stiffness", 0, 3e-4, true},
    {"linear", "bending", "stiffness", 3e-4, 0, true},
    {"linear", "self_contact", "distance", 0.6, 0.95, false},
    {"linear", "self_contact", "stiffness", 0.5, 1, false},
    {"linear", "drag", "coefficient", 0.1, 0.5, false},
    {"linear", "damping", "rate", 0.1, 2, false},
    {"linear", "multirate", "levels", 0, 4, false},
};

static patch *busy_sheet(arena *memory, const turn *t, double value) {
    static int32_t hot[SIDE];
    static double rate[SIDE];
    patch *p = patch_create(SHEET_SQUARE, DX, 1.5, 0.02);
    patch_fill(p, SIDE, SIDE);
    patch_set(p, t->law, "E", 100);
    if (strcmp(t->law, "elastoplastic") == 0) patch_set(p, t->law, "eta0", 0.01), patch_set(p, t->law, "beta", 0.1), patch_set(p, t->law, "poisson", 1);
    if (strcmp(t->law, "rubber") == 0) patch_set(p, t->law, "c_star", -0.5);
    patch_set(p, "fracture", "stretch", 0.05);
    patch_set(p, "diffusion", "k", 0.05);
    patch_set(p, "swelling", "alpha", 0.03);
    patch_set(p, "softening", "stiffness", 0.5);
    patch_set(p, "self_contact", "stiffness", 0.5);
    patch_set(p, t->effect, t->key, value);
    p->d.notches[0] = (sheet_notch){.body = -1, .from = {-1, 0.58, 0}, .to = {0.4, 0.58, 0}, .normal = {0, 0, 1}};
    p->d.notch_count = 1;
    for (int k = 0; k < SIDE; k++) hot[k] = (37 * k * k) % COUNT, rate[k] = 20;
    p->d.sources[0] = (sheet_source){.count = SIDE, .particle = hot, .value = rate, .stop = HUGE_VAL};
    p->d.source_count = 1;
    for (int side = 0; side < 2; side++) {
        double edge = side ? 1e3 : -1e3, near = side ? 1.05 : 0.1;
        p->d.boundaries[side] = (rigid_boundary){.shape = shape_box(memory, (const double[]){-1e3, fmin(near, edge), -1e3}, (const double[]){1e3, fmax(near, edge), 1e3}),
                                                 .grip = true, .motion = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .velocity = {0.1, side ? 0.5 : -0.5, 0.1}, .active = true}};
    }
    p->d.boundary_count = 2;
    for (int64_t i = 0; i < p->d.count; i++) p->grain[i][0] = 0.8, p->grain[i][1] = 0.6, p->position[i][2] = 0.01 * patch_random((uint64_t)i);
    return p;
}

typedef struct picture {
    double position[COUNT][3], diffused[COUNT], limit;
    int64_t broken;
} picture;

static const double STEP = 5e-4; /* far below every limit here */
static const int64_t STEPS = 120;

static void go(patch *p, picture *out) {
    memset(out, 0, sizeof *out);
    CHECK(patch_steps(p, STEPS, STEP) == STATUS_OK);
    p->engine->settle(p->state, p->time);
    p->engine->read(p->state, "position", out->position[0]);
    p->engine->read(p->state, "diffused", out->diffused);
    out->limit = patch_limit(p);
    out->broken = patch_measure(p).bonds_broken;
}

static bool refresh(patch *p, const turn *t) {
    report r;
    patch_set(p, t->effect, t->key, t->to);
    bool good = p->engine->refresh(p->state, &r) == STATUS_OK;
    if (!good) printf("  %s\n", r.message);
    return good;
}

static bool same(const picture *a, const picture *b, const turn *t, const char *when) {
    bool equal = memcmp(a, b, sizeof *a) == 0;
    if (!equal) printf("  %s.%s of %s, %g to %g, turned %s: other bits\n", t->effect, t->key, t->law, t->from, t->to, when);
    return equal;
}

static void a_turned_sheet_is_one_made_so(void) {
    static picture turned, made, untouched;
    for (size_t k = 0; k < sizeof turns / sizeof *turns; k++) {
        const turn *t = &turns[k];
        arena *memory = arena_create("knobs");
        patch *a = busy_sheet(memory, t, t->from), *b = busy_sheet(memory, t, t->to), *c = busy_sheet(memory, t, t->from);
        CHECK(patch_start(a, 64, "auto", 1) && patch_start(b, 64, "auto", 1) && patch_start(c, 64, "auto", 1));
        CHECK(refresh(a, t));
        go(a, &turned);
        go(b, &made);
        go(c, &untouched);
        CHECK(same(&turned, &made, t, "at once"));
        bool acts = memcmp(&turned, &untouched, sizeof turned) != 0;
        if (!acts) printf("  %s.%s does nothing here\n", t->effect, t->key);
        CHECK(acts || strcmp(t->effect, "multirate") == 0 || strcmp(t->effect, "self_contact") == 0); /* those act later than this run */
        patch_free(a), patch_free(b), patch_free(c);
        arena_destroy(memory);
    }
}

static void a_sheet_turned_later_is_one_given_its_state(void) {
    static picture turned, made;
    static record_list records;
    report r;
    for (size_t k = 0; k < sizeof turns / sizeof *turns; k++) {
        const turn *t = &turns[k];
        if (t->grows) continue;
        arena *memory = arena_create("knobs");
        patch *a = busy_sheet(memory, t, t->from), *b = busy_sheet(memory, t, t->to);
        CHECK(patch_start(a, 64, "auto", 1) && patch_start(b, 64, "auto", 1));
        CHECK(patch_steps(a, 150, STEP) == STATUS_OK);
        a->engine->settle(a->state, a->time);
        CHECK(patch_measure(a).bonds_broken > SIDE);
        CHECK(a->engine->save(a->state, &records, &r) == STATUS_OK);
        CHECK(b->engine->restore(b->state, &records, &r) == STATUS_OK);
        b->time = a->time;
        CHECK(b->engine->refresh(b->state, &r) == STATUS_OK);
        CHECK(refresh(a, t));
        go(a, &turned);
        go(b, &made);
        CHECK(same(&turned, &made, t, "later"));
        record_clear(&records);
        patch_free(a), patch_free(b);
        arena_destroy(memory);
    }
}

/* What surrounds a sheet and what feeds it, between steps. */
static void gravity_and_sources_are_turned(void) {
    static const turn none = {"linear", "linear", "E", 100, 100, false};
    static picture turned, made;
    arena *memory = arena_create("knobs");
    patch *a = busy_sheet(memory, &none, 100), *b = busy_sheet(memory, &none, 100);
    b->d.gravity[2] = -3;
    b->d.feeds = &(source_feed){.strength = 0.25};
    CHECK(patch_start(a, 64, "auto", 1) && patch_start(b, 64, "auto", 1));
    a->engine->surround(a->state, (const double[]){0, 0, -3}, a->d.cfl);
    a->engine->feed(a->state, &(source_feed){.strength = 0.25});
    CHECK(refresh(a, &none));
    go(a, &turned);
    go(b, &made);
    CHECK(same(&turned, &made, &none, "with gravity and a source"));
    patch_free(a), patch_free(b);
    arena_destroy(memory);
}

/* Bending acts where all bonds are left: a particle whose bonds a notch cuts has none, at the start and after a turn. */
static void a_cut_sheet_does_not_resist_bending_at_its_cut(void) {
    static double force[2][COUNT][3];
    for (int turned = 0; turned < 2; turned++) {
        patch *p = patch_create(SHEET_SQUARE, DX, 1.5, 0.02);
        patch_fill(p, SIDE, SIDE);
        patch_set(p, "linear", "E", 1e-9);
        patch_set(p, "bending", "stiffness", 1);
        p->d.notches[0] = (sheet_notch){.body = -1, .from = {-1, 0.575, 0}, .to = {9, 0.575, 0}, .normal = {0, 0, 1}};
        p->d.notch_count = 1;
        for (int64_t i = 0; i < p->d.count; i++) p->position[i][2] = 0.2 * p->rest[i][1]; /* each half is flat: affine motions take no force */
        report r;
        CHECK(patch_start(p, 64, "auto", 1));
        if (turned) CHECK(p->engine->refresh(p->state, &r) == STATUS_OK);
        CHECK(patch_steps(p, 1, 1e-6) == STATUS_OK);
        p->engine->read(p->state, "velocity", force[turned][0]);
        double most = 0;
        for (int64_t i = 0; i < p->d.count; i++) most = fmax(most, fabs(force[turned][i][2]));
        CHECK_ROW("METHOD 6", turned ? "the same after a knob was turned" : "tilted sheet, cut through: acceleration by bending at the cut", 0, most / 1e-6, 1e-6);
        patch_free(p);
    }
}

int main(void) {
    RUN(a_turned_sheet_is_one_made_so);
    RUN(a_sheet_turned_later_is_one_given_its_state);
    RUN(gravity_and_sources_are_turned);
    RUN(a_cut_sheet_does_not_resist_bending_at_its_cut);
    return check_finish();
}
