#include "sim/bench.h"

#include "base/clock.h"
#include "base/eigen.h"
#include "base/memory.h"
#include "solid/moduli.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const char *const bench_phase_names[BENCH_PHASES] = {"sort", "p2g", "grid", "g2p", "measure", "other"};
_Static_assert(SOLID_PHASES == 4, "a phase of the engine needs its name here");

enum { FRAME_STEPS = 25, WARM_UP_FRAMES = 2, CELL_PARTICLES = 8 };

/* The tube's material (scenes/solid/tube_pull.lua) but for ν. */
static const double YOUNG = 4e4, POISSON = 0.3, DENSITY = 500, FIBRE_STIFFNESS = 10, CFL = 0.5;
static const double FIBRE[3] = {0.70710678118654752, 0.70710678118654752, 0};
static const double STRAIN_PER_FRAME = 0.005; /* 2e-4 a step: far below the speed of sound at any size */
static const double DRIFT_PER_STEP = 0.02;    /* cells a step that the bar moves sideways, so that particles change cells */
static const double CRACKING_FRACTION = 0.02;

static const bench_case all_cases[] = {
    {.name = "elastic", .doc = "elasticity alone"},
    {.name = "fibres", .doc = "and fibres", .fibres = true},
    {.name = "damage_early", .doc = "and anisotropic damage, whole: all early outs are taken", .fibres = true, .damage = true},
    {.name = "damage", .doc = "and anisotropic damage, cracking: no early out is taken", .fibres = true, .damage = true, .cracking = true},
    {.name = "implicit", .doc = "the same, damage solved on the grid", .fibres = true, .damage = true, .cracking = true, .implicit = true},
    {.name = "plastic", .doc = "elasticity and plasticity, flowing", .plastic = true},
};

int bench_cases(const bench_case **cases) {
    int count = (int)(sizeof all_cases / sizeof *all_cases);
    *cases = all_cases;
    return effect_index("plastic") >= 0 ? count : count - 1; /* the last */
}

bench_options bench_options_default(void) {
    return (bench_options){.which = &all_cases[0], .precision = 32, .threads = 1, .particles = 50000, .simd = "auto",
                           .seconds = 0.3, .limit = 8, .repeat = 5};
}

/* ---- the scene --------------------------------------------------------------------------------------------------- */

static status bar_velocity(void *context, const double *x, int inputs, double *v, int outputs, report *r) {
    (void)inputs, (void)outputs, (void)r;
    const bench_bar *m = context;
    v[0] = m->rate * x[0];
    v[1] = m->drift - POISSON * m->rate * x[1];
    v[2] = -POISSON * m->rate * x[2];
    return STATUS_OK;
}

static void set(scene *s, const char *effect_name, const char *key, double value) {
    int count, e = effect_index(effect_name);
    const effect *table = effect_catalogue(&count)[e];
    effect_values *v = &s->materials[0].effects[e];
    int p = effect_parameter(table, key);
    v->on = true;
    v->value[p][0] = value;
    v->given[p] = true;
}

static void define_damage(scene *s, const bench_case *c, double strain) {
    double stress = YOUNG * strain, frame_time = 1 / s->fps;
    set(s, "damage", "alpha", -1);
    set(s, "damage", "sigma_c", !c->cracking ? 1e3 * YOUNG : c->implicit ? 0.5 * stress : 0.2 * stress);
    /* Slow enough that no particle breaks: a broken one is no longer evaluated. */
    set(s, "damage", "eta", c->implicit ? 0.1 : 1e4 * frame_time);
    if (!c->implicit) return;
    set(s, "damage", "form", 1);
    set(s, "damage", "tolerance", 1e-4);
}

/* One step's length at rest. */
static double step_length(const scene_material *m, bool fibres, double dx) {
    double mu = 0, lambda = 0, lame_lambda;
    solid_elastic_moduli(m->effects, &mu, &lambda, &lame_lambda);
    return CFL * dx / sqrt((mu + lambda + (fibres ? mu * FIBRE_STIFFNESS : 0)) / m->density);
}

/* The material, and the length of a frame that follows from it: as many steps at every size. */
static void define_material(scene *s, const bench_case *c) {
    int count;
    const effect *const *effects = effect_catalogue(&count);
    scene_material *m = &s->materials[s->material_count++];
    snprintf(m->name, sizeof m->name, "bar");
    m->density = DENSITY;
    for (int e = 0; e < count; e++) effect_values_default(effects[e], &m->effects[e]);
    set(s, "elastic", "E", YOUNG);
    set(s, "elastic", "nu", POISSON);
    s->fps = 1 / (FRAME_STEPS * step_length(m, c->fibres, s->dx));
    double strain = STRAIN_PER_FRAME * WARM_UP_FRAMES; /* where the timing begins */
    if (c->fibres) set(s, "fibres", "gamma", FIBRE_STIFFNESS);
    if (c->damage) define_damage(s, c, strain);
    if (c->plastic) set(s, "plastic", "yield_stress", 0.25 * YOUNG * strain);
}

/* Thin, one layer of nodes: what is held does not stretch, and early outs would take it. */
static void add_grip(scene *s, double side, const bench_bar *m) {
    double inner = 1 - 0.5 * s->dx, low[3] = {side < 0 ? -2 : inner, -2, -2}, high[3] = {side < 0 ? -inner : 2, 2, 2};
    s->grips[s->grip_count++] = (scene_grip){.shape = shape_box(s->memory, low, high), .stop = HUGE_VAL,
                                             .velocity = {.outputs = 3, .constant = {side * m->rate, m->drift, 0}}};
}

static scene *make_scene(const bench_options *o, bench_bar *m) {
    scene *s = scene_create();
    if (!s) return NULL;
    const bench_case *c = o->which;
    const double low[3] = {-1, -0.5, -0.5}, high[3] = {1, 0.5, 0.5}, volume = 2;
    snprintf(s->file, sizeof s->file, "bench");
    s->particles = o->particles;
    s->particles_per_cell = CELL_PARTICLES;
    s->dx = cbrt(CELL_PARTICLES * volume / (double)o->particles);
    s->cfl = CFL;
    s->kernel = o->kernel;
    s->laplacian = o->laplacian;
    define_material(s, c);
    m->rate = STRAIN_PER_FRAME * s->fps;
    m->drift = DRIFT_PER_STEP * FRAME_STEPS * s->dx * s->fps;
    s->bodies[s->body_count++] = (scene_body){
        .name = "bar", .shape = shape_box(s->memory, low, high), .sampling = SAMPLING_JITTERED,
        .velocity = {.outputs = 3, .call = bar_velocity, .context = m}};
    if (c->fibres) {
        s->bodies[0].fibres = (scene_fibres){.families = 1, .direction = {.outputs = 3}};
        memcpy(s->bodies[0].fibres.direction.constant, FIBRE, sizeof FIBRE);
    }
    add_grip(s, -1, m);
    add_grip(s, 1, m);
    return s;
}

/* ---- what is moved ----------------------------------------------------------------------------------------------- */

/* Bytes that a step must move between memory and processor for one particle, however clever it is about caches within a pass:
 * each pass over the particles reads each field that it needs once and writes each that it changes once.
 *   to the grid   reads position, velocity, affine velocity, deformation, volume; fibres; damage
 *   to particles  reads position, deformation, volume; damage, its history and fibres; writes all but volume and fibres
 *   grid          a node's four reals: cleared, added to (read and written), updated (read and written), gathered; the damage's two likewise,
 *                 shared by the particles of a cell
 * Not counted: ids, tiles and tables, the halo of nodes around the body, lines that a store loads first, sorting, measures, and the implicit
 * solve's passes. So it is a lower bound, and the time that it takes at the triad's speed is one too. */
static double bytes_moved(const simulation_plan *p) {
    static const struct {
        const char *field;
        int moves;
    } table[] = {{"position", 3}, {"velocity", 2}, {"affine_velocity", 2}, {"deformation_gradient", 3}, {"volume", 2},
                 {"fibre", 1}, {"fibre2", 1}, {"damage", 3}, {"damage_history", 2}, {"plastic_strain", 2}};
    double bytes = 0, real_bytes = p->precision / 8.0;
    bool damage = p->mask >> effect_index("damage") & 1, fibres = p->mask >> effect_index("fibres") & 1;
    for (int i = 0; i < p->field_count; i++)
        for (size_t k = 0; k < sizeof table / sizeof *table; k++) {
            if (strcmp(p->fields[i].name, table[k].field) != 0) continue;
            bool both = damage && fibres && strncmp(table[k].field, "fibre", 5) == 0; /* each pass reads them */
            bytes += p->fields[i].bytes * (table[k].moves + both);
        }
    double node_reals = (damage ? 4 + 2 : 4) * 6; /* clear, add ×2, update ×2, gather */
    return bytes + node_reals * real_bytes / CELL_PARTICLES;
}

/* ---- whether it cracks ------------------------------------------------------------------------------------------- */

/* The damage effect's criterion at one particle, from its definition and apart from the kernel (METHOD.md §2). */
typedef struct criterion {
    double mu, lambda, sigma_c, alpha, zeta;
} criterion;

static double damage_value(const scene *s, const char *key) {
    int count, e = effect_index("damage");
    return s->materials[0].effects[e].value[effect_parameter(effect_catalogue(&count)[e], key)][0];
}

static criterion criterion_of(const scene *s) {
    double lame_lambda;
    criterion c = {.sigma_c = damage_value(s, "sigma_c"), .alpha = damage_value(s, "alpha"), .zeta = damage_value(s, "zeta")};
    (void)solid_elastic_moduli(s->materials[0].effects, &c.mu, &c.lambda, &lame_lambda);
    return c;
}

/* Φ = tr(A σ⁺ A σ⁺)/σc² with A = I + α (R a)(R a)ᵀ, in the stress' own axes; *bound is |σ|²/σc² ≥ Φ, which early outs look at. */
static double driving_force(const criterion *c, const double F[9], double *bound) {
    double b[9], square[3], axis[3][3], Fa[3], sigma[3], along[3], phi = 0;
    double J = matrix_determinant(F);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) b[3 * i + j] = F[3 * i] * F[3 * j] + F[3 * i + 1] * F[3 * j + 1] + F[3 * i + 2] * F[3 * j + 2];
        Fa[i] = F[3 * i] * FIBRE[0] + F[3 * i + 1] * FIBRE[1] + F[3 * i + 2] * FIBRE[2];
    }
    eigen_symmetric(b, square, axis);
    *bound = 0;
    for (int i = 0; i < 3; i++) {
        double stress = c->mu * square[i] / J + c->lambda * (J - 1) - c->mu;
        *bound += stress * stress / (c->sigma_c * c->sigma_c);
        sigma[i] = fmax(stress, 0);
        along[i] = (axis[i][0] * Fa[0] + axis[i][1] * Fa[1] + axis[i][2] * Fa[2]) / sqrt(square[i]);
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double a = (i == j) + c->alpha * along[i] * along[j];
            phi += sigma[i] * sigma[j] * a * a;
        }
    return phi / (c->sigma_c * c->sigma_c);
}

typedef struct activity {
    double above_critical, evaluated, yielded;
} activity;

static activity count_cracking(const scene *s, int64_t n, const double *F, const double *damage, const double *history) {
    criterion c = criterion_of(s);
    int64_t above = 0, evaluated = 0;
    for (int64_t i = 0; i < n; i++) {
        double bound;
        above += driving_force(&c, F + 9 * i, &bound) > 1;
        evaluated += bound > 1 + history[i] / c.zeta && damage[i] < 1;
    }
    return (activity){(double)above / (double)n, (double)evaluated / (double)n, NAN};
}

static activity count_yielded(int64_t n, const double *strain) {
    int64_t yielded = 0;
    for (int64_t i = 0; i < n; i++) yielded += strain[i] > 0;
    return (activity){NAN, NAN, (double)yielded / (double)n};
}

/* How many particles do what the case is about, in the state as it is. */
static status look(const simulation *sim, const scene *s, const bench_case *c, activity *out, report *r) {
    *out = (activity){NAN, NAN, NAN};
    if (!c->damage && !c->plastic) return STATUS_OK;
    solid *state;
    const solid_engine *engine = simulation_engine(sim, &state);
    int64_t n = simulation_get_plan(sim)->particles;
    size_t bytes = (size_t)n * 11 * sizeof(double);
    double *values = memory_allocate(bytes);
    if (!values) return report_set(r, STATUS_SYSTEM, "out of memory for a look at %lld particles", (long long)n);
    if (c->plastic) {
        engine->read(state, "plastic_strain", values);
        *out = count_yielded(n, values);
    } else {
        double *damage = values + 9 * n, *history = values + 10 * n;
        engine->read(state, "deformation_gradient", values);
        engine->read(state, "damage", damage);
        engine->read(state, "damage_history", history);
        *out = count_cracking(s, n, values, damage, history);
    }
    memory_free(values, bytes);
    return STATUS_OK;
}

/* ---- timing ------------------------------------------------------------------------------------------------------ */

typedef struct repetition {
    double seconds, phases[BENCH_PHASES];
    int64_t steps;
} repetition;

static status run_frames(simulation *sim, int frames, repetition *out, report *r) {
    solid *state;
    const solid_engine *engine = simulation_engine(sim, &state);
    double before[SOLID_PHASES], after[SOLID_PHASES], measuring = 0, inside = 0;
    int64_t first = simulation_steps(sim);
    engine->phases(state, before);
    double start = clock_seconds();
    for (int f = 0; f < frames; f++) {
        simulation_measures m;
        status code = simulation_advance(sim, NULL, r);
        double at = clock_seconds();
        if (code == STATUS_OK) code = simulation_measure(sim, &m, r);
        if (code != STATUS_OK) return code;
        measuring += clock_seconds() - at;
    }
    out->seconds = clock_seconds() - start;
    engine->phases(state, after);
    for (int p = 0; p < SOLID_PHASES; p++) {
        out->phases[p] = after[p] - before[p];
        inside += out->phases[p];
    }
    out->phases[BENCH_MEASURE] = measuring;
    out->phases[BENCH_OTHER] = out->seconds - inside - measuring;
    out->steps = simulation_steps(sim) - first;
    return STATUS_OK;
}

/* The repetition in the middle, by time: its phases are then one run's, and sum to its time. */
static repetition middle(repetition *all, int count) {
    for (int i = 1; i < count; i++)
        for (int k = i; k > 0 && all[k].seconds < all[k - 1].seconds; k--) {
            repetition other = all[k];
            all[k] = all[k - 1];
            all[k - 1] = other;
        }
    return all[(count - 1) / 2];
}

/* Repetitions of `frames` frames, each from the state in `start`. */
static status repeat(simulation *sim, const record_list *start, const bench_options *o, int frames, bench_result *out, report *r) {
    repetition all[BENCH_REPEATS];
    int count = 0;
    double begun = clock_seconds();
    while (count == 0 || (count < o->repeat && count < BENCH_REPEATS && clock_seconds() - begun < o->limit)) {
        status code = simulation_restore(sim, start, r);
        if (code == STATUS_OK) code = run_frames(sim, frames, &all[count], r);
        if (code != STATUS_OK) return code;
        count++;
    }
    repetition typical = middle(all, count);
    out->repetitions = count;
    out->seconds = typical.seconds;
    out->steps = typical.steps;
    memcpy(out->phases, typical.phases, sizeof out->phases);
    return STATUS_OK;
}

static status measure_case(simulation *sim, const scene *s, const bench_options *o, bench_result *out, report *r) {
    repetition last = {0};
    activity before, after;
    record_list start = {0};
    status code = run_frames(sim, WARM_UP_FRAMES - 1, &last, r);
    if (code == STATUS_OK) code = run_frames(sim, 1, &last, r);
    if (code == STATUS_OK) code = look(sim, s, o->which, &before, r);
    if (code == STATUS_OK) code = simulation_save(sim, &start, r);
    double frames = code == STATUS_OK ? ceil(o->seconds / last.seconds) : 1;
    if (code == STATUS_OK) code = repeat(sim, &start, o, (int)fmin(fmax(frames, 1), BENCH_FRAMES), out, r);
    record_clear(&start);
    if (code == STATUS_OK) code = look(sim, s, o->which, &after, r);
    if (code != STATUS_OK) return code;
    const simulation_plan *plan = simulation_get_plan(sim);
    out->particles = plan->particles;
    out->simd = plan->simd;
    out->bytes_per_particle = plan->bytes_per_particle;
    out->bytes_moved = bytes_moved(plan);
    /* Not fmin, which would drop a NAN. */
    out->above_critical = before.above_critical < after.above_critical ? before.above_critical : after.above_critical;
    out->evaluated = before.evaluated < after.evaluated ? before.evaluated : after.evaluated;
    out->yielded = before.yielded < after.yielded ? before.yielded : after.yielded;
    if (o->which->cracking && out->above_critical < CRACKING_FRACTION)
        return report_set(r, STATUS_DIVERGED, "the benchmark '%s' does not crack: only %.2g of its particles are above the critical stress",
                          o->which->name, out->above_critical);
    return STATUS_OK;
}

status bench_bar_create(const bench_options *o, bench_bar *bar, report *r) {
    *bar = (bench_bar){0};
    bar->scene = make_scene(o, bar);
    if (!bar->scene) return report_set(r, STATUS_SYSTEM, "out of memory for the benchmark's scene");
    simulation_options options = {.threads = o->threads, .precision = o->precision, .simd = o->simd};
    status code = scene_validate(bar->scene, r);
    return code == STATUS_OK ? simulation_create(bar->scene, &options, &bar->simulation, r) : code;
}

void bench_bar_destroy(bench_bar *bar) {
    simulation_destroy(bar->simulation);
    if (bar->scene) scene_destroy(bar->scene);
    *bar = (bench_bar){0};
}

status bench_step(const bench_options *o, bench_result *out, report *r) {
    bench_bar bar;
    memset(out, 0, sizeof *out);
    status code = bench_bar_create(o, &bar, r);
    if (code == STATUS_OK) code = measure_case(bar.simulation, bar.scene, o, out, r);
    bench_bar_destroy(&bar);
    return code;
}
