/* sunder bench sheet: bonds a second and core, at 8 and 28 neighbours. */
#include "cli/bench_against.h"
#include "cli/cli.h"

#include "base/json.h"
#include "base/machine.h"
#include "sim/bench_sheet.h"

#include <string.h>

enum { ROWS = 64 };

typedef struct sheet_row {
    sheet_bench_options options;
    sheet_bench_result result;
} sheet_row;

static double bond_rate(const sheet_row *row) {
    return (double)row->result.bonds * (double)row->result.steps / row->result.seconds;
}

static double ns_per_particle(const sheet_row *row, double seconds) {
    return 1e9 * seconds / ((double)row->result.particles * (double)row->result.steps);
}

static void print_row(const sheet_row *row, FILE *out) {
    const sheet_bench_options *o = &row->options;
    fprintf(out, "%-8s %3d f%d %2d thr %8lld particles  %8.1f M bonds/s  %8.1f a thread  %7.1f ns/particle ", o->tearing ? "tearing" : "linear",
            o->neighbours, o->precision, o->threads, (long long)row->result.particles, 1e-6 * bond_rate(row), 1e-6 * bond_rate(row) / o->threads,
            ns_per_particle(row, row->result.seconds));
    for (int p = 0; p < SHEET_PHASES; p++) fprintf(out, " %s %.1f", sheet_bench_phase_names[p], ns_per_particle(row, row->result.phases[p]));
    fputc('\n', out);
    fflush(out);
}

static void json_row(json_writer *w, const sheet_row *row) {
    const sheet_bench_options *o = &row->options;
    const sheet_bench_result *m = &row->result;
    json_object(w);
    json_member_string(w, "case", o->tearing ? "tearing" : "linear");
    json_member_string(w, "engine", "sheet");
    json_member_string(w, "precision", o->precision == 32 ? "f32" : "f64");
    json_member_string(w, "simd", m->simd);
    json_member_string(w, "kernel", NULL);
    json_member_string(w, "laplacian", NULL);
    json_member_integer(w, "threads", o->threads);
    json_member_integer(w, "particles", m->particles);
    json_member_integer(w, "neighbours", o->neighbours);
    json_member_integer(w, "bonds", m->bonds);
    json_member_integer(w, "steps", m->steps);
    json_member_number(w, "particle_steps_per_s", (double)m->particles * (double)m->steps / m->seconds);
    json_member_number(w, "bond_steps_per_s", bond_rate(row));
    json_member_number(w, "bond_steps_per_s_per_thread", bond_rate(row) / o->threads);
    json_member_number(w, "ns_per_particle", ns_per_particle(row, m->seconds));
    json_member_number(w, "bytes_per_particle", m->bytes_per_particle);
    json_member_object(w, "phases");
    for (int p = 0; p < SHEET_PHASES; p++) json_member_number(w, sheet_bench_phase_names[p], ns_per_particle(row, m->phases[p]));
    json_object_end(w);
    json_object_end(w);
}

static status json_machine(json_writer *w, report *r) {
    machine m;
    const char *simd;
    double triad = 0;
    machine_describe(&m);
    status code = machine_triad(1, &triad, r);
    if (code != STATUS_OK) return code;
    json_member_object(w, "machine");
    json_member_string(w, "processor", m.processor);
    json_member_integer(w, "processors", m.processors);
    json_member_number(w, "triad_gb_s", triad);
    json_member_number(w, "fma_gflop_s", machine_fma(32, &simd));
    json_member_string(w, "simd", simd);
    json_object_end(w);
    return STATUS_OK;
}

/* LAMMPS on the sheet of a size and number of neighbours. */
typedef struct against_row {
    int neighbours;
    against_result result;
} against_row;

static double against_rate(const against_result *m) {
    return (double)m->bonds * (double)m->steps / m->seconds;
}

/* Beside it, our fastest row of the same sheet on one thread with bonds alone. */
static void print_against(const against_row *row, const sheet_row *rows, int count, FILE *out) {
    const against_result *m = &row->result;
    fprintf(out, "lammps   %3d f64  1 thr %8lld particles  %8.1f M bonds/s  peri/pmb, %s", row->neighbours, (long long)m->particles, 1e-6 * against_rate(m), m->version);
    for (int i = 0; i < count; i++) {
        const sheet_bench_options *o = &rows[i].options;
        if (o->tearing || o->threads != 1 || o->neighbours != row->neighbours || rows[i].result.particles != m->particles) continue;
        fprintf(out, "; f%d is %.1f times as fast", o->precision, bond_rate(&rows[i]) / against_rate(m));
    }
    fputc('\n', out);
    fflush(out);
}

static void json_against(json_writer *w, const against_row *row) {
    const against_result *m = &row->result;
    json_object(w);
    json_member_string(w, "program", m->version);
    json_member_string(w, "case", "peri/pmb");
    json_member_string(w, "precision", "f64");
    json_member_integer(w, "threads", 1);
    json_member_integer(w, "particles", m->particles);
    json_member_integer(w, "neighbours", row->neighbours);
    json_member_integer(w, "bonds", m->bonds);
    json_member_integer(w, "steps", m->steps);
    json_member_number(w, "bond_steps_per_s", against_rate(m));
    json_object_end(w);
}

static int print_json(const sheet_row *rows, int count, const against_row *others, int other_count) {
    json_writer w;
    report r;
    json_begin(&w, 2);
    json_object(&w);
    json_member_string(&w, "version", SUNDER_VERSION);
    status code = json_machine(&w, &r);
    json_member_array(&w, "rows");
    for (int i = 0; i < count; i++) json_row(&w, &rows[i]);
    json_array_end(&w);
    json_member_array(&w, "against");
    for (int i = 0; i < other_count; i++) json_against(&w, &others[i]);
    json_array_end(&w);
    json_object_end(&w);
    if (code == STATUS_OK) code = cli_print_json(&w, &r);
    else json_free(&w);
    return code == STATUS_OK ? 0 : cli_fail(&r);
}

int command_bench_sheet(const sheet_bench_matrix *q) {
    static sheet_row rows[ROWS];
    static against_row others[ROWS];
    report r;
    int count = 0, other_count = 0;
    if (q->lammps && lammps_find(&r) != STATUS_OK) return cli_fail(&r);
    for (int size = 0; size < q->size_count; size++)
        for (int neighbours = 8; neighbours <= 28; neighbours += 20)
            for (int tearing = 0; tearing < 2; tearing++)
                for (int p = 0; p < q->precision_count; p++)
                    for (int t = 0; t < q->thread_count && count < ROWS; t++) {
                        sheet_row *row = &rows[count];
                        row->options = (sheet_bench_options){.tearing = tearing != 0, .neighbours = neighbours, .precision = q->precisions[p],
                                                             .threads = q->threads[t], .particles = q->sizes[size], .simd = "auto",
                                                             .seconds = q->seconds, .repeat = q->repeat};
                        if (bench_sheet(&row->options, &row->result, &r) != STATUS_OK) return cli_fail(&r);
                        print_row(row, q->json ? stderr : stdout);
                        count++;
                    }
    for (int size = 0; size < q->size_count && q->lammps; size++)
        for (int neighbours = 8; neighbours <= 28; neighbours += 20) {
            against_row *other = &others[other_count++];
            other->neighbours = neighbours;
            if (lammps_sheet(q->sizes[size], neighbours, q->seconds, &other->result, &r) != STATUS_OK) return cli_fail(&r);
            print_against(other, rows, count, q->json ? stderr : stdout);
        }
    return q->json ? print_json(rows, count, others, other_count) : 0;
}
