/* Studies by figures made up for them: errors, orders, the frontier and advice of accuracy; what is measured of a hard case's rows and frames, and
 * its verdict. Nothing is simulated. */
#include "check.h"
#include "store/ledger_scratch.h"
#include "study/accuracy.h"
#include "study/stress.h"

#include "base/memory.h"

enum { FRAMES = 10, POINTS = FRAMES + 1 };

static accuracy_study study;
static double curves[ACCURACY_RUNS][ACCURACY_MEASURES][ACCURACY_CURVES][POINTS];

/* ---- accuracy ---------------------------------------------------------------------------------------------------- */

static void measure_is(int m, const char *name, accuracy_measure_kind kind, int count, bool judged) {
    accuracy_measure *own = &study.measures[m];
    *own = (accuracy_measure){.kind = kind, .curves = count, .judged = judged};
    snprintf(own->name, sizeof own->name, "%s", name);
    study.measure_count = m + 1;
}

static accuracy_run *run_is(int run, int axis, int level, int64_t particles, double seconds) {
    accuracy_run *q = &study.runs[run];
    *q = (accuracy_run){.axis = axis, .level = level, .state = ACCURACY_DONE, .frames = POINTS, .end = 1, .crack_time = NAN};
    q->result.particles = particles;
    q->result.steps = 100 * (run + 1);
    q->result.step_seconds = seconds;
    for (int m = 0; m < ACCURACY_MEASURES; m++)
        for (int c = 0; c < ACCURACY_CURVES; c++) q->curve[m][c] = curves[run][m][c];
    if (axis >= 0) study.run_of[axis][level] = run;
    study.run_count = run + 1 > study.run_count ? run + 1 : study.run_count;
    return q;
}

static void axis_is(int a, const char *key, int count, int at, bool ordered, bool same) {
    accuracy_axis *x = &study.axes[a];
    *x = (accuracy_axis){.count = count, .wanted = count, .scene = at, .ordered = ordered, .same_particles = same};
    snprintf(x->name, sizeof x->name, "%s", key);
    snprintf(x->key, sizeof x->key, "%s", key);
    for (int l = 0; l < AXIS_LEVELS; l++) study.run_of[a][l] = -1, snprintf(x->level[l].value, sizeof x->level[l].value, "%d", l);
    study.run_of[a][at] = 0;
    study.axis_count = a + 1;
}

/* Levels of a resolution of 10³ to 80³ particles, the second the scene's own; an energy 1 + share · (1/10, 1/20 …)^power in all frames. */
static void four_levels(double power, double share) {
    memset(&study, 0, sizeof study);
    memset(curves, 0, sizeof curves);
    study.frames = FRAMES;
    study.dimensions = 3;
    study.extent = 2;
    measure_is(0, "energy", MEASURE_CURVES, 2, true);
    axis_is(0, "particles", 4, 1, true, false);
    for (int l = 0; l < 4; l++) {
        int run = l == 1 ? 0 : l == 0 ? 1 : l;
        double h = 0.1 / (1 << l);
        accuracy_run *q = run_is(run, l == 1 ? -1 : 0, l, (int64_t)llround(pow(h, -3)), pow(16, l - 1));
        for (int i = 0; i < POINTS; i++) q->curve[0][0][i] = 1 + share * pow(h, power), q->curve[0][1][i] = 2;
    }
}

static bool noted(const char *words) {
    for (int i = 0; i < study.note_count; i++)
        if (strstr(study.notes[i], words)) return true;
    return false;
}

static void errors_and_orders_are_those_of_the_figures(void) {
    report r;
    four_levels(2, 0.3);
    CHECK(accuracy_judge(&study, &r) == STATUS_OK);
    const accuracy_result *x = &study.results[0];
    double h[4] = {0.1, 0.05, 0.025, 0.0125}, size = sqrt(pow(1 + 0.3 * h[3] * h[3], 2) + 4);
    CHECK(x->reference == 3 && x->point[3].error[0] == 0);
    for (int l = 0; l < 3; l++) CHECK_NEAR(x->point[l].error[0], 0.3 * (h[l] * h[l] - h[3] * h[3]) / size, 1e-12);
    CHECK_NEAR(x->order[0], 2, 1e-6);
    CHECK_NEAR(x->left[0], 0.3 * h[3] * h[3] / size, 1e-9); /* what Richardson's extrapolation adds */
    CHECK_NEAR(x->worst_order, 2, 1e-6);
    CHECK_NEAR(x->point[1].estimate, x->point[1].worst + x->worst_left, 1e-12);
    for (int l = 0; l < 4; l++) CHECK(x->point[l].frontier && x->point[l].dominated_by == -1); /* each is better for more time */
    CHECK(noted("More time does most for particles 2:")); /* a quarter of the error for 16 times the time; then less and less */
    CHECK(!noted("Time is to be saved") && noted("from 1 to 2 takes 16 times as long"));
    study.dimensions = 2; /* the same particles of a sheet are less far apart: h goes with their root */
    CHECK(accuracy_judge(&study, &r) == STATUS_OK);
    CHECK_NEAR(x->order[0], 4.0 / 3, 1e-6);
}

static void errors_before_the_first_crack_are_told_apart(void) {
    report r;
    four_levels(2, 0);
    measure_is(1, "cracking", MEASURE_TIME, 1, true);
    measure_is(2, "work", MEASURE_CURVES, 1, false);
    for (int run = 0; run < 4; run++)
        for (int i = 0; i < POINTS; i++) {
            study.runs[run].curve[0][0][i] += i >= 5 ? run : 0; /* runs part where the first of them cracks */
            study.runs[run].curve[2][0][i] = 1000 * run;
        }
    study.runs[0].crack_time = 0.5, study.runs[2].crack_time = 0.9, study.runs[3].crack_time = 0.8;
    CHECK(accuracy_judge(&study, &r) == STATUS_OK);
    const accuracy_result *x = &study.results[0];
    CHECK(x->crack == 0.5);
    for (int l = 0; l < 4; l++) CHECK(x->point[l].early[0] == 0 && x->point[l].worst_early == 0);
    /* Six of eleven frames, by how far run numbers lie apart. */
    CHECK_NEAR(x->point[1].error[0], 3 * sqrt(6.0 / 11) / sqrt((5 + 6 * 16 + 11 * 4) / 11.0), 1e-12);
    CHECK_NEAR(x->point[1].error[1], 0.3 / 0.8, 1e-12);
    CHECK_NEAR(x->point[0].error[1], 0.2 / 0.8, 1e-12); /* one without a crack cracks at its end at the earliest */
    CHECK_NEAR(x->point[1].error[2], 1, 1e-12);
    CHECK(x->point[1].worst_measure == 0 && x->point[1].worst == x->point[1].error[0]); /* work is not judged */
    CHECK(noted("After the first crack"));
}

/* A second axis whose finer level takes twice as long and is off by a tenth; and a cheaper setting of the first that is as good. */
static void axes_are_weighed_against_each_other(void) {
    report r;
    four_levels(2, 0.3);
    axis_is(1, "precision", 2, 0, false, true);
    accuracy_run *fine = run_is(4, 1, 1, 8000, 2);
    for (int i = 0; i < POINTS; i++) fine->curve[0][0][i] = study.runs[0].curve[0][0][i] + 0.1, fine->curve[0][1][i] = 2;
    CHECK(accuracy_judge(&study, &r) == STATUS_OK);
    const accuracy_point *own = &study.results[0].point[1], *other = &study.results[1].point[0];
    double first = own->worst + study.results[0].worst_left, second = other->worst;
    CHECK(second > 0.04 && first < 0.01);
    CHECK_NEAR(own->estimate, first + second, 1e-12);
    CHECK_NEAR(other->estimate, first + second, 1e-12); /* the scene's own is one run, whatever axis it is seen along */
    CHECK_NEAR(study.results[1].point[1].estimate, first, 1e-12);
    CHECK_NEAR(study.results[0].point[3].estimate, study.results[0].worst_left + second, 1e-12);
    CHECK(study.results[0].point[2].dominated_by == 4 && !study.results[0].point[3].frontier); /* double precision is faster than both, and better */
    CHECK(study.results[1].point[1].frontier && noted("More time does most for precision 1:"));
    four_levels(2, 1e-9);
    study.runs[1].result.step_seconds = 0.25;
    for (int i = 0; i < POINTS; i++) study.runs[1].curve[0][0][i] = study.runs[0].curve[0][0][i] + 1e-15; /* half the particles, the same error */
    CHECK(accuracy_judge(&study, &r) == STATUS_OK && noted("Time is to be saved by particles 0: 0.25 of the time"));
    for (int i = 0; i < POINTS; i++) study.runs[1].curve[0][0][i] = study.runs[0].curve[0][0][i] + 1e-9; /* and a far larger one */
    study.note_count = 0;
    CHECK(accuracy_judge(&study, &r) == STATUS_OK && !noted("Time is to be saved"));
}

static void distances_of_every_kind(void) {
    report r;
    double d;
    four_levels(2, 0);
    measure_is(1, "crack_normal", MEASURE_NORMAL, 3, true);
    measure_is(2, "shape", MEASURE_MOMENTS, 6, true);
    accuracy_run *a = &study.runs[0], *b = &study.runs[1];
    a->curve[1][0][FRAMES] = 1, b->curve[1][0][FRAMES] = -1; /* one plane, its normal the other way */
    CHECK(accuracy_distance(&study, a, b, 1, FRAMES, &d, &r) == STATUS_OK && d == 0);
    b->curve[1][0][FRAMES] = b->curve[1][1][FRAMES] = sqrt(0.5);
    CHECK(accuracy_distance(&study, a, b, 1, FRAMES, &d, &r) == STATUS_OK);
    CHECK_NEAR(d, 0.5, 1e-7); /* half a right angle */
    b->curve[1][0][FRAMES] = NAN;
    CHECK(accuracy_distance(&study, a, b, 1, FRAMES, &d, &r) == STATUS_OK && isnan(d));
    CHECK(accuracy_scale(&study, a, 2, FRAMES) == 2);
}

/* ---- what is read of a run --------------------------------------------------------------------------------------- */

static char run_id[LEDGER_ID], run_folder[512];

typedef struct made_frame {
    double x, velocity, damage, diffused, stretch; /* of the first particle: place along x, … F = stretch I */
    int count;
} made_frame;

static void write_frame(const char *folder, int64_t frame, const made_frame *f) {
    record_list list = {0};
    report r;
    double *x, *v, *d, *theta, *F;
    frame_header header = header_of(frame);
    if (record_add(&list, "solid/position", RECORD_F64, f->count, 3, "", (void **)&x, &r) || record_add(&list, "solid/velocity", RECORD_F64, f->count, 3, "", (void **)&v, &r) ||
        record_add(&list, "solid/damage", RECORD_F64, f->count, 1, "", (void **)&d, &r) || record_add(&list, "solid/diffused", RECORD_F64, f->count, 1, "", (void **)&theta, &r) ||
        record_add(&list, "solid/deformation_gradient", RECORD_F64, f->count, 9, "", (void **)&F, &r))
        abort();
    for (int i = 0; i < f->count; i++) {
        for (int k = 0; k < 3; k++) x[3 * i + k] = k + 1, v[3 * i + k] = 0;
        for (int k = 0; k < 9; k++) F[9 * i + k] = k % 4 == 0 ? (i ? 1 : f->stretch) : 0;
        d[i] = i ? 0 : f->damage, theta[i] = i ? 0 : f->diffused;
    }
    x[0] = f->x, v[0] = f->velocity;
    if (frame_write(folder, &header, &list, 1, &r)) abort();
    record_clear(&list);
}

/* A run of frames 0, 1, …, two particles unless said otherwise, and its rows in the ledger. */
static void write_frames(const char *name, const made_frame *frames, int count) {
    snprintf(run_folder, sizeof run_folder, "%s", make_run(name));
    for (int i = 0; i < count; i++) write_frame(run_folder, i, &frames[i]);
}

static void write_rows(ledger *l, const ledger_value *rows, int values, int frames) {
    report r;
    ledger_run run = sample_run("full");
    if (ledger_begin(l, &run, run_id, &r)) abort();
    for (int i = 0; i < frames; i++)
        if (ledger_frame(l, run_id, i, 0.5 * i, 10 * i, 0, rows + i * values, (size_t)values, &r)) abort();
}

static void curves_are_read_from_ledger_and_frames(void) {
    static const made_frame frames[] = {{.x = 3, .damage = 0.2, .diffused = 2, .stretch = 1, .count = 2}, {.x = 5, .damage = 0.5, .diffused = 6, .stretch = 1, .count = 2}};
    static const ledger_value rows[] = {{"kinetic", 1}, {"gravitational", 7}, {"damage_max", 0.5}, {"kinetic", 4}, {"gravitational", 9}, {"damage_max", 1}};
    report r;
    memset(&study, 0, sizeof study);
    study.frames = 1;
    study.options.database = strdup(in_scratch("study.db"));
    measure_is(0, "energy", MEASURE_CURVES, 2, true);
    snprintf(study.measures[0].curve[0], ACCURACY_NAME, "kinetic");
    snprintf(study.measures[0].curve[1], ACCURACY_NAME, "gravitational");
    measure_is(1, "cracking", MEASURE_TIME, 1, true);
    snprintf(study.measures[1].curve[0], ACCURACY_NAME, "damage_max");
    measure_is(2, "shape", MEASURE_MOMENTS, 6, true);
    measure_is(3, "diffused", MEASURE_FIELD, 2, true);
    snprintf(study.measures[3].curve[0], ACCURACY_NAME, "diffused");
    measure_is(4, "position", MEASURE_PARTICLES, 0, true);
    snprintf(study.measures[4].curve[0], ACCURACY_NAME, "position");
    ledger *l = open_ledger("study.db");
    write_rows(l, rows, 3, 2);
    ledger_close(l);
    write_frames("curves", frames, 2);
    accuracy_run *q = &study.runs[0], *other = &study.runs[1];
    snprintf(q->result.id, sizeof q->result.id, "%s", run_id);
    snprintf(q->folder, sizeof q->folder, "%s", run_folder);
    CHECK(accuracy_read(&study, q, &r) == STATUS_OK);
    CHECK(q->curve[0][0][0] == 1 && q->curve[0][0][1] == 4);
    CHECK(q->curve[0][1][0] == 0 && q->curve[0][1][1] == 2); /* a potential is counted from its start */
    CHECK_NEAR(q->crack_time, 0.4, 1e-12);                   /* 0.9 lies four fifths of the way from 0.5 to 1 */
    CHECK(q->curve[2][0][1] == 3 && q->curve[2][3][1] == 4 && q->curve[2][4][1] == 0);
    CHECK(q->curve[3][0][1] == 3 && fabs(q->curve[3][1][1] - sqrt(18)) < 1e-12);
    CHECK_NEAR(study.extent, 2, 1e-12);
    static const made_frame apart[] = {{.x = 3, .stretch = 1, .count = 2}, {.x = 5.5, .stretch = 1, .count = 2}};
    double d;
    write_frames("apart", apart, 2);
    snprintf(other->folder, sizeof other->folder, "%s", run_folder);
    CHECK(accuracy_distance(&study, q, other, 4, 1, &d, &r) == STATUS_OK);
    CHECK_NEAR(d, 0.5 / sqrt(2), 1e-12);
    for (int m = 0; m < study.measure_count; m++)
        for (int c = 0; c < study.measures[m].curves; c++) memory_free(q->curve[m][c], 2 * sizeof(double));
    free((char *)study.options.database);
}

/* ---- hard cases -------------------------------------------------------------------------------------------------- */

enum { ROWS = 20 };

/* A mass of 2 that falls by gravity −10 along y for a second, in two frames of half a second each; grips put in work 3 and push by 4 at the end. */
static const ledger_value falling[][ROWS] = {
    {{"kinetic", 1}, {"elastic", 4}, {"fibre", 1}, {"gravitational", 0}, {"grip_work", 0}, {"mass", 2}, {"speed_max", 1}, {"determinant_min", 0.9}, {"dt_min", NAN},
     {"momentum_y", 2}, {"angular_momentum_z", 3}, {"diffused_total", 10}, {"determinant_max", 1.1},
     {"momentum_x", 0}, {"momentum_z", 0}, {"angular_momentum_x", 0}, {"angular_momentum_y", 0}, {"grip_impulse_x", 0}, {"grip_impulse_z", 0}, {"grip_impulse_y", 0}},
    {{"kinetic", 2}, {"elastic", 2}, {"fibre", 0}, {"gravitational", 0}, {"grip_work", 0}, {"mass", 2}, {"speed_max", 8}, {"determinant_min", 0.4}, {"dt_min", 0.08},
     {"momentum_y", -8}, {"angular_momentum_z", 3}, {"diffused_total", 9}, {"determinant_max", 1.5},
     {"momentum_x", 0}, {"momentum_z", 0}, {"angular_momentum_x", 0}, {"angular_momentum_y", 0}, {"grip_impulse_x", 0}, {"grip_impulse_z", 0}, {"grip_impulse_y", 0}},
    {{"kinetic", 4}, {"elastic", 1}, {"fibre", 1}, {"gravitational", 1}, {"grip_work", 3}, {"mass", 2}, {"speed_max", 5}, {"determinant_min", 0.7}, {"dt_min", 0.02},
     {"momentum_y", -14}, {"angular_momentum_z", 4.5}, {"diffused_total", 10}, {"determinant_max", 1.2},
     {"momentum_x", 0}, {"momentum_z", 0}, {"angular_momentum_x", 0}, {"angular_momentum_y", 0}, {"grip_impulse_x", 0}, {"grip_impulse_z", 0}, {"grip_impulse_y", 4}},
};
static const made_frame whole[] = {{.x = 3, .damage = 0.2, .diffused = 0.5, .stretch = 1, .count = 2}, {.x = 9, .damage = 0.4, .diffused = 0.9, .stretch = 3, .count = 2},
                                   {.x = 7, .damage = 0.4, .diffused = -0.1, .stretch = 2, .count = 2}};

static void figures_are_those_of_rows_and_frames(void) {
    static const double gravity[3] = {0, -10, 0};
    report r;
    stress_figures f;
    ledger *l = open_ledger("stress.db");
    write_rows(l, falling[0], ROWS, 3);
    write_frames("whole", whole, 3);
    CHECK(stress_measure(l, run_id, run_folder, gravity, &f, &r) == STATUS_OK && f.broken[0] == '\0');
    const double *v = f.value;
    /* The balance is 6, 4, 4 (6 + 1 − 3): it loses 2 of 6 and gains nothing. */
    CHECK_NEAR(v[HARD_energy_drift], 2.0 / 6, 1e-12);
    CHECK_NEAR(v[HARD_energy_gain], 0, 1e-12);
    CHECK_NEAR(v[HARD_energy_left], 1, 1e-12);
    CHECK_NEAR(v[HARD_stored_left], 2.0 / 5, 1e-12);
    CHECK_NEAR(v[HARD_momentum_drift], 0, 1e-12); /* gravity and grips gave all of it */
    CHECK_NEAR(v[HARD_angular_drift], 0.5, 1e-12);
    CHECK(v[HARD_speed_max] == 8 && v[HARD_speed_end] == 5);
    CHECK(v[HARD_determinant_min] == 0.4 && v[HARD_determinant_end] == 0.7 && v[HARD_determinant_max] == 1.5);
    CHECK_NEAR(v[HARD_diffused_drift], 0.1, 1e-12);
    CHECK_NEAR(v[HARD_step_shrink], 4, 1e-12);
    CHECK(v[HARD_steps] == 20 && isnan(v[HARD_bond_stretch_max]));
    CHECK_NEAR(v[HARD_deformation_max], 3, 1e-12);
    CHECK_NEAR(v[HARD_deformation_end], 2, 1e-12);
    CHECK(v[HARD_damage_max] == 0.4 && v[HARD_diffused_min] == -0.1 && v[HARD_diffused_max] == 0.9);
    CHECK(v[HARD_low_x] == 1 && v[HARD_high_x] == 9 && v[HARD_centre_x] == 4 && v[HARD_centre_y] == 2);
    CHECK_NEAR(v[HARD_spread], 3, 1e-12); /* from 1 … 3 to 1 … 7 */
    ledger_close(l);
}

static void what_no_run_may_do_is_told(void) {
    static const struct {
        made_frame last;
        const char *words;
    } cases[] = {{{.x = 1, .damage = 0.1, .stretch = 1, .count = 2}, "healed"}, {{.x = 1, .damage = 1.5, .stretch = 1, .count = 2}, "out of [0, 1]"},
                 {{.x = 1, .damage = 0.3, .stretch = 1, .count = 1}, "lost"}, {{.x = 1, .damage = 0.3, .velocity = INFINITY, .stretch = 1, .count = 2}, "velocity: inf"},
                 {{.x = NAN, .damage = 0.3, .stretch = 1, .count = 2}, "position: "}, {{.x = 1, .damage = 0.3, .diffused = NAN, .stretch = 1, .count = 2}, "diffused quantity"}};
    static const double gravity[3] = {0, -10, 0};
    report r;
    stress_figures f;
    ledger *l = open_ledger("broken.db");
    write_rows(l, falling[0], ROWS, 3);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        made_frame frames[] = {whole[0], cases[i].last};
        char name[16];
        snprintf(name, sizeof name, "broken%zu", i);
        write_frames(name, frames, 2);
        CHECK(stress_measure(l, run_id, run_folder, gravity, &f, &r) == STATUS_OK);
        if (!strstr(f.broken, cases[i].words)) printf("  %s: '%s'\n", cases[i].words, f.broken);
        CHECK(strstr(f.broken, cases[i].words));
    }
    ledger_close(l);
}

static void likeness_is_up_to_shift_and_length(void) {
    static const made_frame small[] = {{.x = 0.5, .stretch = 1, .count = 1}}, large[] = {{.x = 2.5, .stretch = 1, .count = 1}}, two[] = {{.x = 2.5, .stretch = 1, .count = 2}};
    char first[512];
    double d;
    report r;
    write_frames("small", small, 1);
    snprintf(first, sizeof first, "%s", run_folder);
    write_frames("large", large, 1);
    /* 2.5, 2, 3 less the shift 1.5, −2, −3, over 2, is 0.5, 2, 3. */
    CHECK(stress_difference(run_folder, first, &(hard_likeness){.length = 2, .shift = {1.5, -2, -3}}, &d, &r) == STATUS_OK && d == 0);
    CHECK(stress_difference(run_folder, first, &(hard_likeness){.length = 2, .shift = {1, -2, -3}}, &d, &r) == STATUS_OK && d == 0.25);
    write_frames("two", two, 1);
    CHECK(stress_difference(run_folder, first, &(hard_likeness){.length = 1}, &d, &r) == STATUS_OK && d == HUGE_VAL);
}

/* A state that no run may be in is no known limit, and no bound that holds makes up for it. */
static void a_broken_state_fails(void) {
    static stress_case c;
    static stress_run run;
    report r;
    made_frame frames[] = {whole[0], whole[1]};
    frames[1].damage = 0;
    ledger *l = open_ledger("healed.db");
    write_rows(l, falling[0], ROWS, 2);
    write_frames("healed", frames, 2);
    for (int known = 0; known < 2; known++) {
        c = (stress_case){.like = -1, .hard = {.given = true, .count = 1, .items = {{HARD_speed_max, -HUGE_VAL, known ? 1 : 100}}}};
        run = (stress_run){.which = 0};
        snprintf(c.hard.known_limit, sizeof c.hard.known_limit, "%s", known ? "it is so" : "");
        snprintf(run.id, sizeof run.id, "%s", run_id);
        snprintf(run.folder, sizeof run.folder, "%s", run_folder);
        CHECK(stress_judge(l, &c, &run, NULL, &r) == STATUS_OK && run.verdict == STRESS_FAILS && strstr(run.text, "healed"));
    }
    ledger_close(l);
}

/* The verdict of a run that was measured before, or that left nothing to be measured. */
static stress_verdict verdict(const hard_case *h, const char *message, int code, bool late, double speed) {
    static stress_case c;
    static stress_run run;
    report r;
    c = (stress_case){.like = -1, .hard = *h};
    run = (stress_run){.exit_code = code, .timed_out = late, .seconds = 60};
    snprintf(run.message, sizeof run.message, "%s", message);
    run.value[HARD_speed_max] = speed;
    CHECK(stress_judge(NULL, &c, &run, NULL, &r) == STATUS_OK);
    return run.verdict;
}

static void verdicts(void) {
    hard_case bound = {.given = true, .count = 1, .items = {{HARD_speed_max, -HUGE_VAL, 2}}}, stop = {.given = true, .stop = "diverged"}, known = bound;
    snprintf(known.known_limit, sizeof known.known_limit, "it is so");
    CHECK(verdict(&bound, "", 0, false, 2) == STRESS_HOLDS && verdict(&bound, "", 0, false, 2.0001) == STRESS_FAILS && verdict(&bound, "", 0, false, NAN) == STRESS_FAILS);
    CHECK(verdict(&bound, "diverged", 1, false, 1) == STRESS_FAILS && verdict(&bound, "", 139, false, 1) == STRESS_FAILS && verdict(&bound, "", 0, true, 1) == STRESS_FAILS);
    CHECK(verdict(&stop, "it diverged", 1, false, 1) == STRESS_STOPS && verdict(&stop, "no memory", 1, false, 1) == STRESS_FAILS);
    CHECK(verdict(&stop, "", 0, false, 1) == STRESS_FAILS && verdict(&stop, "it diverged", 139, false, 1) == STRESS_FAILS);
    CHECK(verdict(&known, "", 0, false, 3) == STRESS_KNOWN && verdict(&known, "", 0, false, 1) == STRESS_FAILS);
    CHECK(verdict(&known, "", 139, false, 3) == STRESS_FAILS && verdict(&known, "", 0, true, 3) == STRESS_FAILS); /* a crash is no limit */
}

int main(void) {
    scratch_make();
    RUN(errors_and_orders_are_those_of_the_figures);
    RUN(errors_before_the_first_crack_are_told_apart);
    RUN(axes_are_weighed_against_each_other);
    RUN(distances_of_every_kind);
    RUN(curves_are_read_from_ledger_and_frames);
    RUN(figures_are_those_of_rows_and_frames);
    RUN(what_no_run_may_do_is_told);
    RUN(a_broken_state_fails);
    RUN(likeness_is_up_to_shift_and_length);
    RUN(verdicts);
    return check_finish();
}
