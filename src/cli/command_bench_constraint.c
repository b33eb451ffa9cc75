/* sunder bench constraint: what a solve of inextensible fibres takes, by preconditioner, with and without the last step's tension. */
#include "cli/cli.h"

#include "base/clock.h"
#include "base/json.h"
#include "base/sparse.h"
#include "sim/simulation.h"

#include <getopt.h>
#include <stdlib.h>
#include <string.h>

enum { SETTINGS = 4 };

typedef struct constraint_request {
    bool json;
    int frames, warm, threads;
    long particles; /* 0: the scene's own */
    const char *scenes, *only; /* only: one scene by name, or NULL */
} constraint_request;

typedef struct constraint_scene {
    const char *name, *variant;
} constraint_scene;

typedef struct constraint_row {
    const constraint_scene *scene;
    const char *solver;
    bool warm_start;
    int64_t particles, steps, solves, iterations, factorisations;
    double seconds, solving; /* of the frames timed, and of the solves in them */
} constraint_row;

static const constraint_scene scenes[] = {{"lance", "inextensible"}, {"hanging_torus", "inextensible"}};
static const char *const solvers[] = {"auto", "jacobi", "direct", "amg"};
enum { SCENES = sizeof scenes / sizeof scenes[0], SOLVERS = sizeof solvers / sizeof solvers[0], ROWS = SCENES * SOLVERS * 2 };

static const struct option long_options[] = {
    {"json", no_argument, NULL, 'j'},          {"frames", required_argument, NULL, 'n'}, {"warm", required_argument, NULL, 'w'},
    {"threads", required_argument, NULL, 't'}, {"scenes", required_argument, NULL, 'c'}, {"particles", required_argument, NULL, 'p'},
    {"scene", required_argument, NULL, 's'},   {NULL, 0, NULL, 0},
};

static int choose_scene(constraint_request *q) {
    q->only = optarg;
    for (int i = 0; i < SCENES; i++)
        if (strcmp(optarg, scenes[i].name) == 0) return 0;
    return cli_usage("bench", "constraint: --scene %s: expected lance or hanging_torus", optarg);
}

static int whole(const char *option, long low, long high, int *value) {
    long number = 0;
    int code = cli_number("bench", option, optarg, low, high, &number);
    *value = (int)number;
    return code;
}

static int parse(constraint_request *q, int count, char **arguments) {
    int option, code = 0;
    while (code == 0 && (option = getopt_long(count, arguments, "", long_options, NULL)) != -1) switch (option) {
        case 'j': q->json = true; break;
        case 'c': q->scenes = optarg; break;
        case 's': code = choose_scene(q); break;
        case 'n': code = whole("--frames", 1, 1000, &q->frames); break;
        case 'w': code = whole("--warm", 0, 1000, &q->warm); break;
        case 't': code = whole("--threads", 1, 256, &q->threads); break;
        case 'p': code = cli_number("bench", "--particles", optarg, 100, 100000000, &q->particles); break;
        default: code = cli_usage("bench", "wrong option");
        }
    if (code == 0 && optind < count) code = cli_usage("bench", "constraint: %s: expected options only", arguments[optind]);
    return code;
}

/* Frames passed over, then frames timed. */
static status advance(simulation *s, const constraint_request *q, constraint_row *row, report *r) {
    simulation_measures before, after;
    status code = STATUS_OK;
    for (int i = 0; i < q->warm && code == STATUS_OK; i++) code = simulation_advance(s, NULL, r);
    if (code == STATUS_OK) code = simulation_measure(s, &before, r);
    double start = clock_seconds();
    for (int i = 0; i < q->frames && code == STATUS_OK; i++) code = simulation_advance(s, NULL, r);
    row->seconds = clock_seconds() - start;
    if (code == STATUS_OK) code = simulation_measure(s, &after, r);
    if (code != STATUS_OK) return code;
    row->particles = simulation_get_plan(s)->particles;
    row->steps = after.steps - before.steps;
    row->solves = after.solid.constraint_solves - before.solid.constraint_solves;
    row->iterations = after.solid.constraint_iterations - before.solid.constraint_iterations;
    row->factorisations = after.solid.constraint_factorisations - before.solid.constraint_factorisations;
    row->solving = after.solid.constraint_seconds - before.solid.constraint_seconds;
    return STATUS_OK;
}

static status measure(const constraint_request *q, constraint_row *row, script_reports *reports) {
    char path[512], count[24];
    snprintf(path, sizeof path, "%s/solid/%s.lua", q->scenes, row->scene->name);
    snprintf(count, sizeof count, "%ld", q->particles);
    const script_setting settings[SETTINGS] = {
        {"variant", row->scene->variant}, {"solver", row->solver}, {"warm_start", row->warm_start ? "true" : "false"}, {"particles", count}};
    script_options options = script_options_default();
    options.settings = settings;
    options.setting_count = q->particles > 0 ? SETTINGS : SETTINGS - 1;
    script *text = NULL;
    status code = script_load(path, &options, &text, reports);
    if (code != STATUS_OK) return code;
    simulation *s = NULL;
    simulation_options engine = {.threads = q->threads, .precision = 32, .simd = "auto"};
    code = simulation_create(script_scene(text), &engine, &s, &reports->items[0]);
    if (code == STATUS_OK) code = advance(s, q, row, &reports->items[0]);
    reports->count = code != STATUS_OK;
    simulation_destroy(s);
    script_close(text);
    return code;
}

static double a_solve(const constraint_row *row, double value) {
    return row->solves ? value / (double)row->solves : 0;
}

static void print_row(const constraint_row *row, FILE *out) {
    fprintf(out, "%-14s %-7s %-4s %9lld %6lld %12.1f %9.2f %9.3f %8lld\n", row->scene->name, row->solver, row->warm_start ? "yes" : "no",
            (long long)row->particles, (long long)row->steps, a_solve(row, (double)row->iterations), 1e3 * a_solve(row, row->solving), row->seconds,
            (long long)row->factorisations);
    fflush(out);
}

static void write_row(json_writer *w, const constraint_row *row) {
    json_object(w);
    json_member_string(w, "scene", row->scene->name);
    json_member_string(w, "solver", row->solver);
    json_member_boolean(w, "warm_start", row->warm_start);
    json_member_integer(w, "particles", row->particles);
    json_member_integer(w, "steps", row->steps);
    json_member_integer(w, "solves", row->solves);
    json_member_integer(w, "factorisations", row->factorisations);
    json_member_number(w, "iterations_per_solve", a_solve(row, (double)row->iterations));
    json_member_number(w, "seconds_per_solve", a_solve(row, row->solving));
    json_member_number(w, "seconds", row->seconds);
    json_object_end(w);
}

static int print_json(const constraint_row *rows, int count) {
    json_writer w;
    report r;
    json_begin(&w, 2);
    json_object(&w);
    json_member_string(&w, "version", SUNDER_VERSION);
    json_member_array(&w, "rows");
    for (int i = 0; i < count; i++) write_row(&w, &rows[i]);
    json_array_end(&w);
    json_object_end(&w);
    return cli_print_json(&w, &r) == STATUS_OK ? 0 : cli_fail(&r);
}

static bool can(const char *solver) {
    if (strcmp(solver, "direct") == 0) return sparse_available(SPARSE_DIRECT);
    if (strcmp(solver, "amg") == 0) return sparse_available(SPARSE_AMG);
    return true;
}

int command_bench_constraint(int count, char **arguments) {
    constraint_request q = {.frames = 1, .warm = 1, .threads = 1, .scenes = "scenes"};
    int code = parse(&q, count, arguments), measured = 0;
    if (code) return code;
    static script_reports reports;
    static constraint_row rows[ROWS];
    FILE *out = q.json ? stderr : stdout;
    fprintf(out, "%-14s %-7s %-4s %9s %6s %12s %9s %9s %8s\n", "scene", "solver", "warm", "particles", "steps", "iterations", "ms", "seconds", "made");
    for (int i = 0; i < ROWS; i++) {
        constraint_row row = {.scene = &scenes[i / (2 * SOLVERS)], .solver = solvers[i / 2 % SOLVERS], .warm_start = i % 2 == 0};
        if (!can(row.solver) || (q.only && strcmp(q.only, row.scene->name) != 0)) continue;
        if (measure(&q, &row, &reports) != STATUS_OK) return cli_fail_script(&reports);
        print_row(&row, out);
        rows[measured++] = row;
    }
    return q.json ? print_json(rows, measured) : 0;
}
