/* sunder bench: how fast steps are on this machine, beside what the machine could do. */
#include "cli/cli.h"

#include "base/clock.h"
#include "base/json.h"
#include "base/machine.h"
#include "base/names.h"
#include "sim/bench.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CHOICES = 8, ROWS = 256 };
static const double BUDGET = 500; /* seconds of the default matrix: the contract's ten minutes, less the rows' set-up and the copies */

typedef struct bench_request {
    bench_options options; /* what all rows share */
    bool json, full, sheet, lammps;
    const char *csv;
    int case_count, size_count, thread_count, precision_count;
    const bench_case *cases[CHOICES];
    long sizes[CHOICES];
    int threads[CHOICES], precisions[CHOICES];
} bench_request;

typedef struct bench_row {
    bench_options options;
    bench_result result;
} bench_row;

typedef struct bench_report {
    machine machine;
    const char *simd;
    double fma[2];          /* GFLOP/s a core: f32, f64 */
    double triad[CHOICES];  /* GB/s at request.threads[] */
    int row_count, scaling_count;
    bench_row rows[ROWS];
    bench_scaling scaling[CHOICES]; /* elastic f32, by size, of the most threads asked for */
} bench_report;

/* ---- the request ------------------------------------------------------------------------------------------------- */

static const struct option long_options[] = {
    {"json", no_argument, NULL, 'j'},         {"csv", required_argument, NULL, 'v'},       {"full", no_argument, NULL, 'f'},
    {"case", required_argument, NULL, 'c'},   {"particles", required_argument, NULL, 'n'}, {"threads", required_argument, NULL, 't'},
    {"precision", required_argument, NULL, 'p'}, {"seconds", required_argument, NULL, 's'}, {"repeat", required_argument, NULL, 'r'},
    {"against", required_argument, NULL, 'a'},
    {NULL, 0, NULL, 0},
};

static int add_case(bench_request *q, const char *name) {
    const bench_case *all;
    const char *names[CHOICES];
    int count = bench_cases(&all);
    if (q->case_count == CHOICES) return cli_usage("bench", "--case: at most %d times", CHOICES);
    for (int i = 0; i < count; i++) {
        names[i] = all[i].name;
        if (strcmp(name, all[i].name) != 0) continue;
        q->cases[q->case_count++] = &all[i];
        return 0;
    }
    char expected[256] = "one of";
    for (int i = 0; i < count; i++)
        snprintf(expected + strlen(expected), sizeof expected - strlen(expected), "%s %s", i ? "," : "", names[i]);
    report r;
    report_input(&r, NULL, 0, "--case", expected, name, name_nearest(name, names, count));
    return cli_fail(&r);
}

static int parse_seconds(bench_request *q, const char *text) {
    char *end;
    errno = 0;
    q->options.seconds = strtod(text, &end);
    if (end != text && *end == '\0' && errno == 0 && q->options.seconds >= 0 && q->options.seconds <= 3600) return 0;
    return cli_usage("bench", "--seconds %s: expected a number from 0 to 3600", text);
}

static int parse_option(bench_request *q, int option) {
    long value = 0;
    int code = 0;
    switch (option) {
    case 'j': q->json = true; break;
    case 'v': q->csv = optarg; break;
    case 'f': q->full = true; break;
    case 'c': return add_case(q, optarg);
    case 'n':
        code = cli_number("bench", "--particles", optarg, 1000, 100000000, &value);
        q->sizes[0] = value, q->size_count = 1;
        break;
    case 't':
        code = cli_number("bench", "--threads", optarg, 1, 256, &value);
        q->threads[0] = (int)value, q->thread_count = 1;
        break;
    case 'p':
        if (strcmp(optarg, "f32") != 0 && strcmp(optarg, "f64") != 0)
            return cli_usage("bench", "--precision %s: expected f32 or f64", optarg);
        q->precisions[0] = optarg[1] == '3' ? 32 : 64, q->precision_count = 1;
        break;
    case 'a':
        q->lammps = strcmp(optarg, "lammps") == 0;
        return q->lammps ? 0 : cli_usage("bench", "--against %s: expected lammps", optarg);
    case 's': return parse_seconds(q, optarg);
    case 'r':
        code = cli_number("bench", "--repeat", optarg, 1, BENCH_REPEATS, &value);
        q->options.repeat = (int)value;
        break;
    default: return cli_usage("bench", "wrong option");
    }
    return code;
}

/* What was not asked for by name is everything; 4 M particles only with --full, because of the ten minutes. */
static void complete(bench_request *q) {
    static const long of_solids[] = {50000, 500000, 4000000}, of_sheets[] = {10000, 1000000, 4000000};
    const long *sizes = q->sheet ? of_sheets : of_solids;
    const bench_case *all;
    int count = bench_cases(&all);
    if (q->case_count == 0)
        for (int i = 0; i < count; i++) q->cases[q->case_count++] = &all[i];
    if (q->size_count == 0)
        for (int i = 0; i < (q->full ? 3 : 2); i++) q->sizes[q->size_count++] = sizes[i];
    if (q->thread_count == 0)
        for (int t = 1; t <= 2; t++) q->threads[q->thread_count++] = t;
    if (q->precision_count == 0)
        for (int p = 32; p <= 64; p += 32) q->precisions[q->precision_count++] = p;
    if (q->full) q->options.limit = 60;
}

static int parse(bench_request *q, int count, char **arguments) {
    int option;
    while ((option = getopt_long(count, arguments, "", long_options, NULL)) != -1) {
        int code = parse_option(q, option);
        if (code) return code;
    }
    if (optind != count - 1) return cli_usage("bench", "expected what to measure: step, sheet, table1, constraint, or constitutive as its first argument");
    q->sheet = strcmp(arguments[optind], "sheet") == 0;
    if (!q->sheet && strcmp(arguments[optind], "step") != 0) return cli_usage("bench", "%s: expected step, sheet, table1, constraint, or constitutive as its first argument", arguments[optind]);
    if (q->sheet && (q->case_count || q->csv)) return cli_usage("bench", "sheet: --case and --csv belong to step");
    if (!q->sheet && q->lammps) return cli_usage("bench", "step: --against belongs to sheet");
    complete(q);
    return 0;
}

/* Quadratic kernels for all cases, a cubic Laplacian for explicit damage while it cracks; with --full all kernels. */
static bool wants(const bench_request *q, const bench_case *c, kernel_kind kernel, kernel_kind laplacian) {
    if (!c->damage && laplacian == KERNEL_CUBIC) return false;
    if (kernel == KERNEL_QUADRATIC && laplacian == KERNEL_QUADRATIC) return true;
    return q->full || (kernel == KERNEL_QUADRATIC && c->cracking && !c->implicit);
}

/* ---- people's table ---------------------------------------------------------------------------------------------- */

static const char *kernel_name(kernel_kind k) {
    return k == KERNEL_QUADRATIC ? "quadratic" : "cubic";
}

static const char *laplacian_name(const bench_row *row) {
    return row->options.which->damage ? kernel_name(row->options.laplacian) : NULL;
}

static double ns_per_particle(const bench_row *row) {
    return 1e9 * row->result.seconds / ((double)row->result.particles * (double)row->result.steps);
}

static double phase_ns(const bench_row *row, int phase) {
    return 1e9 * row->result.phases[phase] / ((double)row->result.particles * (double)row->result.steps);
}

/* The least time that memory allows over the time taken; the triad is that of as many threads. */
static double roofline_fraction(const bench_request *q, const bench_report *b, const bench_row *row) {
    for (int t = 0; t < q->thread_count; t++)
        if (q->threads[t] == row->options.threads) return row->result.bytes_moved / b->triad[t] / ns_per_particle(row);
    return NAN;
}

static void print_heading(const bench_request *q, const bench_report *b, FILE *out) {
    fprintf(out, "%s, %d processors\n", b->machine.processor, b->machine.processors);
    for (int t = 0; t < q->thread_count; t++)
        fprintf(out, "triad %.1f GB/s on %d thread%s\n", b->triad[t], q->threads[t], q->threads[t] == 1 ? "" : "s");
    fprintf(out, "multiply-add (%s) %.0f GFLOP/s f32, %.0f f64, one core\n\n", b->simd, b->fma[0], b->fma[1]);
    fprintf(out, "%-12s %-9s %-9s %4s %3s %9s %8s %8s %7s ", "case", "kernel", "laplacian", "", "thr", "particles", "M p-st/s", "a thread",
            "ns/part");
    for (int p = 0; p < BENCH_PHASES; p++) fprintf(out, " %7s", bench_phase_names[p]);
    fprintf(out, "  %6s %5s  %s\n", "bytes", "roof", "above / evaluated, or yielded");
    fflush(out);
}

static void print_row(const bench_request *q, const bench_report *b, const bench_row *row, FILE *out) {
    const bench_options *o = &row->options;
    const bench_result *m = &row->result;
    double rate = 1e3 / ns_per_particle(row);
    const char *laplacian = laplacian_name(row);
    fprintf(out, "%-12s %-9s %-9s f%-3d %3d %9lld %8.2f %8.2f %7.1f ", o->which->name, kernel_name(o->kernel), laplacian ? laplacian : "-",
            o->precision, o->threads, (long long)m->particles, rate, rate / o->threads, ns_per_particle(row));
    for (int p = 0; p < BENCH_PHASES; p++) fprintf(out, " %7.1f", phase_ns(row, p));
    fprintf(out, "  %6.0f %5.2f", m->bytes_per_particle, roofline_fraction(q, b, row));
    if (!isnan(m->above_critical)) fprintf(out, "  %.2f / %.2f", m->above_critical, m->evaluated);
    if (!isnan(m->yielded)) fprintf(out, "  %.2f", m->yielded);
    fputc('\n', out);
    fflush(out);
}

/* ---- JSON and CSV ------------------------------------------------------------------------------------------------ */

static void json_machine(json_writer *w, const bench_request *q, const bench_report *b) {
    json_member_object(w, "machine");
    json_member_string(w, "processor", b->machine.processor);
    json_member_integer(w, "processors", b->machine.processors);
    json_key(w, "cache_bytes"); /* from the first level */
    json_array(w);
    for (int level = 0; level < MACHINE_CACHE_LEVELS; level++) json_integer(w, b->machine.cache_bytes[level]);
    json_array_end(w);
    json_member_string(w, "simd", b->simd);
    double best = 0;
    for (int t = 0; t < q->thread_count; t++) best = fmax(best, b->triad[t]);
    json_member_number(w, "triad_gb_s", best);
    json_member_object(w, "triad_gb_s_by_threads");
    for (int t = 0; t < q->thread_count; t++) {
        char name[16];
        snprintf(name, sizeof name, "%d", q->threads[t]);
        json_member_number(w, name, b->triad[t]);
    }
    json_object_end(w);
    json_member_number(w, "fma_gflop_s", b->fma[0]);
    json_member_number(w, "fma_gflop_s_f64", b->fma[1]);
    json_object_end(w);
}

static void json_row(json_writer *w, const bench_request *q, const bench_report *b, const bench_row *row) {
    const bench_options *o = &row->options;
    const bench_result *m = &row->result;
    double rate = 1e9 / ns_per_particle(row);
    json_object(w);
    json_member_string(w, "case", o->which->name);
    json_member_string(w, "engine", "solid");
    json_member_string(w, "precision", o->precision == 32 ? "f32" : "f64");
    json_member_string(w, "simd", m->simd);
    json_member_string(w, "kernel", kernel_name(o->kernel));
    json_member_string(w, "laplacian", laplacian_name(row));
    json_member_integer(w, "threads", o->threads);
    json_member_integer(w, "particles", m->particles);
    json_member_integer(w, "bonds", 0);
    json_member_integer(w, "steps", m->steps);
    json_member_integer(w, "repetitions", m->repetitions);
    json_member_number(w, "particle_steps_per_s", rate);
    json_member_number(w, "particle_steps_per_s_per_thread", rate / o->threads);
    json_member_number(w, "bond_steps_per_s", 0);
    json_member_number(w, "ns_per_particle", ns_per_particle(row));
    json_member_number(w, "bytes_per_particle", m->bytes_per_particle);
    json_member_number(w, "bytes_moved_per_particle", m->bytes_moved);
    json_member_number(w, "roofline_fraction", roofline_fraction(q, b, row));
    json_member_number(w, "above_critical", m->above_critical);
    json_member_number(w, "evaluated", m->evaluated);
    json_member_number(w, "yielded", m->yielded);
    json_member_object(w, "phases");
    for (int p = 0; p < BENCH_PHASES; p++) json_member_number(w, bench_phase_names[p], phase_ns(row, p));
    json_object_end(w);
    json_object_end(w);
}

static void json_scaling(json_writer *w, const bench_request *q, const bench_scaling *m) {
    json_object(w);
    json_member_string(w, "case", "elastic");
    json_member_string(w, "precision", "f32");
    json_member_integer(w, "threads", q->threads[q->thread_count - 1]);
    json_member_integer(w, "particles", m->particles);
    json_member_integer(w, "rounds", m->rounds);
    json_member_number(w, "ratio", m->ratio);
    json_member_number(w, "independent_copies_ratio", m->copies_ratio);
    json_object_end(w);
}

static int print_json(const bench_request *q, const bench_report *b) {
    json_writer w;
    report r;
    json_begin(&w, 2);
    json_object(&w);
    json_member_string(&w, "version", SUNDER_VERSION);
    json_machine(&w, q, b);
    json_member_array(&w, "rows");
    for (int i = 0; i < b->row_count; i++) json_row(&w, q, b, &b->rows[i]);
    json_array_end(&w);
    json_member_array(&w, "scaling");
    for (int i = 0; i < b->scaling_count; i++) json_scaling(&w, q, &b->scaling[i]);
    json_array_end(&w);
    json_object_end(&w);
    return cli_print_json(&w, &r) == STATUS_OK ? 0 : cli_fail(&r);
}

/* One line a row, for docs/bench/plot.gp. */
static int write_csv(const bench_request *q, const bench_report *b) {
    FILE *f = fopen(q->csv, "w");
    report r;
    (void)report_set(&r, STATUS_SYSTEM, "%s: %s", q->csv, strerror(errno));
    if (!f) return cli_fail(&r);
    fprintf(f, "label,case,kernel,laplacian,precision,threads,particles,particle_steps_per_s_per_thread,ns_per_particle,roofline_fraction");
    for (int p = 0; p < BENCH_PHASES; p++) fprintf(f, ",%s", bench_phase_names[p]);
    fputc('\n', f);
    for (int i = 0; i < b->row_count; i++) {
        const bench_row *row = &b->rows[i];
        const bench_options *o = &row->options;
        const char *laplacian = laplacian_name(row);
        fprintf(f, "%s %c%s,%s,%s,%s,f%d,%d,%ld,%.6g,%.6g,%.6g", o->which->name, kernel_name(o->kernel)[0],
                laplacian ? *laplacian == 'q' ? "q" : "c" : "", o->which->name, kernel_name(o->kernel), laplacian ? laplacian : "", o->precision,
                o->threads, (long)o->particles, 1e9 / ns_per_particle(row) / o->threads, ns_per_particle(row), roofline_fraction(q, b, row));
        for (int p = 0; p < BENCH_PHASES; p++) fprintf(f, ",%.6g", phase_ns(row, p));
        fputc('\n', f);
    }
    bool written = !ferror(f);
    if (fclose(f) == 0 && written) return 0;
    (void)report_set(&r, STATUS_SYSTEM, "%s: could not be written", q->csv);
    return cli_fail(&r);
}

/* ---- running ----------------------------------------------------------------------------------------------------- */

static status measure_machine(const bench_request *q, bench_report *b, report *r) {
    machine_describe(&b->machine);
    b->fma[0] = machine_fma(32, &b->simd);
    b->fma[1] = machine_fma(64, &b->simd);
    status code = STATUS_OK;
    for (int t = 0; t < q->thread_count && code == STATUS_OK; t++) code = machine_triad(q->threads[t], &b->triad[t], r);
    return code;
}

/* Lists the matrix: small bodies first, so that most is known early. */
static status list_rows(const bench_request *q, bench_report *b, report *r) {
    int combinations = q->size_count * q->case_count * 4 * q->precision_count * q->thread_count;
    for (int i = 0; i < combinations; i++) {
        int rest = i;
        bench_options o = q->options;
        o.threads = q->threads[rest % q->thread_count], rest /= q->thread_count;
        o.precision = q->precisions[rest % q->precision_count], rest /= q->precision_count;
        o.laplacian = rest % 2 ? KERNEL_CUBIC : KERNEL_QUADRATIC, rest /= 2;
        o.kernel = rest % 2 ? KERNEL_CUBIC : KERNEL_QUADRATIC, rest /= 2;
        o.which = q->cases[rest % q->case_count];
        o.particles = q->sizes[rest / q->case_count];
        if (!wants(q, o.which, o.kernel, o.laplacian)) continue;
        if (b->row_count == ROWS) return report_set(r, STATUS_SYSTEM, "more than %d rows", ROWS);
        b->rows[b->row_count++].options = o;
    }
    return STATUS_OK;
}

static status measure_rows(const bench_request *q, bench_report *b, FILE *out, report *r) {
    double deadline = clock_seconds() + BUDGET;
    status code = list_rows(q, b, r);
    for (int i = 0; i < b->row_count && code == STATUS_OK; i++) {
        bench_row *row = &b->rows[i];
        double share = (deadline - clock_seconds()) / (b->row_count - i);
        if (!q->full) row->options.limit = fmin(row->options.limit, share);
        code = bench_step(&row->options, &row->result, r);
        if (code == STATUS_OK) print_row(q, b, row, out);
    }
    return code;
}

/* Whether several threads are held against one at a size: not where a simulation for each copy would take gigabytes. */
static bool scales(const bench_request *q, long particles) {
    bool elastic = false, single = false;
    for (int i = 0; i < q->case_count; i++) elastic |= strcmp(q->cases[i]->name, "elastic") == 0;
    for (int i = 0; i < q->precision_count; i++) single |= q->precisions[i] == 32;
    return q->thread_count > 1 && elastic && single && particles <= 500000;
}

static status measure_scaling(const bench_request *q, bench_report *b, FILE *out, report *r) {
    const bench_case *all;
    bench_options o = q->options;
    (void)bench_cases(&all);
    o.which = &all[0];
    o.precision = 32;
    o.threads = q->threads[q->thread_count - 1];
    for (int i = 0; i < q->size_count; i++) {
        bench_scaling *m = &b->scaling[b->scaling_count];
        if (!scales(q, q->sizes[i])) continue;
        o.particles = q->sizes[i];
        status code = bench_scale(&o, m, r);
        if (code != STATUS_OK) return code;
        b->scaling_count++;
        fprintf(out, "%s f32, %lld particles: %d threads are %.2f times as fast as one, as many independent copies %.2f times\n", o.which->name,
                (long long)m->particles, o.threads, m->ratio, m->copies_ratio);
        fflush(out);
    }
    return STATUS_OK;
}

int command_bench(int count, char **arguments) {
    static bench_request q;
    static bench_report b;
    q.options = bench_options_default();
    if (count > 1 && strcmp(arguments[1], "table1") == 0) return command_bench_table1(count - 1, arguments + 1);
    if (count > 1 && strcmp(arguments[1], "constraint") == 0) return command_bench_constraint(count - 1, arguments + 1);
    if (count > 1 && strcmp(arguments[1], "constitutive") == 0) return command_bench_constitutive(count - 1, arguments + 1);
    int code = parse(&q, count, arguments);
    if (code) return code;
    if (q.sheet)
        return command_bench_sheet(&(sheet_bench_matrix){.json = q.json, .lammps = q.lammps, .sizes = q.sizes, .threads = q.threads, .precisions = q.precisions,
                                                         .size_count = q.size_count, .thread_count = q.thread_count,
                                                         .precision_count = q.precision_count, .repeat = q.options.repeat, .seconds = q.options.seconds});
    FILE *out = q.json ? stderr : stdout;
    report r;
    if (measure_machine(&q, &b, &r) != STATUS_OK) return cli_fail(&r);
    print_heading(&q, &b, out);
    if (measure_rows(&q, &b, out, &r) != STATUS_OK || measure_scaling(&q, &b, out, &r) != STATUS_OK) return cli_fail(&r);
    if (q.csv && (code = write_csv(&q, &b)) != 0) return code;
    return q.json ? print_json(&q, &b) : 0;
}
