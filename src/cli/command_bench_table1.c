/* sunder bench table1: the scenes of the papers' first tables at their particle counts, our seconds beside theirs. */
#include "cli/cli.h"

#include "base/json.h"
#include "base/machine.h"
#include "base/names.h"
#include "cli/table1.h"
#include "cli/time_scene.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { ROWS = 32, SETTINGS = TABLE1_SETTINGS + 3, TEXT = 320 };

typedef struct table1_request {
    bool json, paper_dt, solid, sheet;
    int frames, warm; /* −1: the row's own */
    int threads, precision;
    double scale, limit;
    const char *scenes;
    int row_count;
    const table1_row *rows[ROWS];
} table1_request;

typedef enum row_outcome { TIMED, NO_SCENE, FAILED } row_outcome;

typedef struct measured_row {
    const table1_row *row;
    row_outcome outcome;
    int exit_code; /* of a failure */
    char scene[512], setting_text[SETTINGS][64], note[TEXT + 512];
    int setting_count;
    bool paper_dt; /* it ran at the paper's step */
    scene_timing timing;
} measured_row;

/* ---- the request ------------------------------------------------------------------------------------------------- */

static const struct option long_options[] = {
    {"json", no_argument, NULL, 'j'},         {"paper", required_argument, NULL, 'b'},      {"row", required_argument, NULL, 'r'},
    {"frames", required_argument, NULL, 'n'}, {"warm", required_argument, NULL, 'w'},       {"paper-dt", no_argument, NULL, 'd'},
    {"scale", required_argument, NULL, 's'},  {"time-limit", required_argument, NULL, 'l'}, {"threads", required_argument, NULL, 't'},
    {"precision", required_argument, NULL, 'p'}, {"scenes", required_argument, NULL, 'c'},  {NULL, 0, NULL, 0},
};

static int add_row(table1_request *q, const char *name) {
    const table1_row *all, *row = table1_find(name);
    const char *names[ROWS];
    int count = table1_rows(&all);
    if (q->row_count == ROWS) return cli_usage("bench", "--row: at most %d times", ROWS);
    if (row) {
        q->rows[q->row_count++] = row;
        return 0;
    }
    char expected[256] = "one of";
    for (int i = 0; i < count; i++) {
        names[i] = all[i].name;
        snprintf(expected + strlen(expected), sizeof expected - strlen(expected), "%s %s", i ? "," : "", names[i]);
    }
    report r;
    report_input(&r, NULL, 0, "--row", expected, name, name_nearest(name, names, count));
    return cli_fail(&r);
}

static int parse_real(const char *option, double low, double high, double *value) {
    char *end;
    errno = 0;
    *value = strtod(optarg, &end);
    if (end != optarg && *end == '\0' && errno == 0 && *value >= low && *value <= high) return 0;
    return cli_usage("bench", "%s %s: expected a number from %g to %g", option, optarg, low, high);
}

static int parse_whole(const char *option, long low, long high, int *value) {
    long number = 0;
    int code = cli_number("bench", option, optarg, low, high, &number);
    *value = (int)number;
    return code;
}

static int parse_paper(table1_request *q) {
    q->solid = strcmp(optarg, "sheet") != 0;
    q->sheet = strcmp(optarg, "solid") != 0;
    if (!q->solid || !q->sheet || strcmp(optarg, "both") == 0) return 0;
    return cli_usage("bench", "--paper %s: expected solid, sheet or both", optarg);
}

static int parse_option(table1_request *q, int option) {
    switch (option) {
    case 'j': q->json = true; break;
    case 'd': q->paper_dt = true; break;
    case 'c': q->scenes = optarg; break;
    case 'b': return parse_paper(q);
    case 'r': return add_row(q, optarg);
    case 'n': return parse_whole("--frames", 1, SCENE_TIMING_FRAMES, &q->frames);
    case 'w': return parse_whole("--warm", 0, SCENE_TIMING_FRAMES, &q->warm);
    case 't': return parse_whole("--threads", 1, 256, &q->threads);
    case 's': return parse_real("--scale", 1e-4, 1000, &q->scale);
    case 'l': return parse_real("--time-limit", 1e-3, 1e6, &q->limit);
    case 'p':
        if (strcmp(optarg, "f32") != 0 && strcmp(optarg, "f64") != 0)
            return cli_usage("bench", "--precision %s: expected f32 or f64", optarg);
        q->precision = optarg[1] == '3' ? 32 : 64;
        break;
    default: return cli_usage("bench", "wrong option");
    }
    return 0;
}

static int warm_of(const table1_request *q, const table1_row *row) {
    return q->warm < 0 ? row->warm : q->warm;
}

static int frames_of(const table1_request *q, const table1_row *row) {
    return q->frames < 0 ? row->frames : q->frames;
}

static int parse(table1_request *q, int count, char **arguments) {
    int option, code;
    while ((option = getopt_long(count, arguments, "", long_options, NULL)) != -1)
        if ((code = parse_option(q, option)) != 0) return code;
    if (optind < count) return cli_usage("bench", "table1: %s: rows are named by --row", arguments[optind]);
    const table1_row *all;
    int rows = table1_rows(&all);
    if (q->row_count == 0)
        for (int i = 0; i < rows; i++)
            if (all[i].sheet ? q->sheet : q->solid) q->rows[q->row_count++] = &all[i];
    for (int i = 0; i < q->row_count; i++)
        if (warm_of(q, q->rows[i]) + frames_of(q, q->rows[i]) > SCENE_TIMING_FRAMES)
            return cli_usage("bench", "table1: --frames and --warm: at most %d together", SCENE_TIMING_FRAMES);
    if (access(q->scenes, R_OK | X_OK) == 0) return 0;
    report r;
    report_input(&r, NULL, 0, "--scenes", "the folder of scenes, with solid/ and sheet/ in it", q->scenes, NULL);
    return cli_fail(&r);
}

/* ---- one row ----------------------------------------------------------------------------------------------------- */

static void add_setting(measured_row *m, const char *key, double value) {
    snprintf(m->setting_text[m->setting_count++], sizeof m->setting_text[0], "%s=%.10g", key, value);
}

/* Sheets have no frame in their table, and a number of particles by their spacing. */
static void choose_settings(const table1_request *q, measured_row *m) {
    const table1_row *row = m->row;
    snprintf(m->scene, sizeof m->scene, "%s/%s", q->scenes, row->scene);
    m->setting_count = 0;
    if (row->sheet) add_setting(m, "dx", row->dx / sqrt(q->scale));
    else add_setting(m, "particles", round((double)row->particles * q->scale));
    if (row->fps > 0) add_setting(m, "fps", row->fps);
    for (int i = 0; i < TABLE1_SETTINGS && row->settings[i]; i++)
        snprintf(m->setting_text[m->setting_count++], sizeof m->setting_text[0], "%s", row->settings[i]);
}

static scene_timing_request timing_request(const table1_request *q, const measured_row *m, script_setting settings[SETTINGS],
                                           char text[SETTINGS][64]) {
    for (int i = 0; i < m->setting_count; i++) {
        memcpy(text[i], m->setting_text[i], sizeof text[i]);
        char *equals = strchr(text[i], '=');
        *equals = '\0';
        settings[i] = (script_setting){text[i], equals + 1};
    }
    return (scene_timing_request){.scene = m->scene, .settings = settings, .setting_count = m->setting_count, .threads = q->threads,
                                  .precision = q->precision, .warm = warm_of(q, m->row), .frames = frames_of(q, m->row), .limit = q->limit};
}

static void add_note(measured_row *m, const char *text) {
    size_t used = strlen(m->note);
    if (text[0]) snprintf(m->note + used, sizeof m->note - used, "%s%s", used ? "; " : "", text);
}

static status fail_row(measured_row *m, status code, const script_reports *reports) {
    char text[TEXT * 2] = "";
    if (reports->count > 0) report_format(&reports->items[0], text, sizeof text);
    m->outcome = FAILED;
    m->exit_code = status_exit_code(code);
    add_note(m, text);
    return code;
}

/* Adds the paper's step where our limits allow it at the start, and says why not where they do not. */
static status choose_step(const table1_request *q, measured_row *m) {
    static script_reports reports;
    script_setting settings[SETTINGS];
    char text[SETTINGS][64], why[TEXT];
    const char *limiting;
    double limit;
    scene_timing_request timing = timing_request(q, m, settings, text);
    status code = scene_step_limit(&timing, &limit, &limiting, &reports);
    if (code != STATUS_OK) return fail_row(m, code, &reports);
    m->paper_dt = m->row->dt <= limit;
    if (m->paper_dt) {
        add_setting(m, "dt", m->row->dt);
        return STATUS_OK;
    }
    snprintf(why, sizeof why, "at our own step: the paper's %.3g is over the limit %.3g of '%s'", m->row->dt, limit, limiting);
    add_note(m, why);
    return STATUS_OK;
}

static void add_limit_note(const table1_request *q, measured_row *m) {
    const scene_timing *t = &m->timing;
    char text[TEXT];
    if (t->extrapolated) snprintf(text, sizeof text, "extrapolated: no whole frame within %g s", q->limit);
    else snprintf(text, sizeof text, "stopped at %g s, after %d frame%s", q->limit, t->warm + t->frames, t->warm + t->frames == 1 ? "" : "s");
    if (t->limited) add_note(m, text);
    add_note(m, t->warning);
}

static status measure_row(const table1_request *q, measured_row *m) {
    static script_reports reports;
    script_setting settings[SETTINGS];
    char text[SETTINGS][64];
    scene_timing_request timing = timing_request(q, m, settings, text);
    status code = scene_time(&timing, &m->timing, &reports);
    if (code != STATUS_OK) return fail_row(m, code, &reports);
    add_limit_note(q, m);
    return STATUS_OK;
}

/* ---- what is said of a row --------------------------------------------------------------------------------------- */

/* Ours, in the paper's unit. */
static double our_seconds(const measured_row *m) {
    return m->row->sheet ? TABLE1_SHEET_STEPS * m->timing.seconds_a_step : m->timing.seconds;
}

/* How many times faster; NAN with other particle counts than the paper's. */
static double ratio_of(const table1_request *q, const measured_row *m) {
    return q->scale == 1 ? m->row->seconds / our_seconds(m) : NAN;
}

static double paper_steps(const table1_row *row) {
    return row->sheet ? TABLE1_SHEET_STEPS : round(1 / (row->fps * row->dt));
}

static double paper_rate(const table1_row *row) {
    return (double)row->particles * paper_steps(row) / row->seconds;
}

static double our_rate(const measured_row *m) {
    return (double)m->timing.particles / m->timing.seconds_a_step;
}

static const char *outcome_name(const measured_row *m) {
    if (m->outcome == NO_SCENE) return "no scene yet";
    if (m->outcome == FAILED) return "failed";
    return m->timing.extrapolated ? "extrapolated" : "timed";
}

/* ---- people's table ---------------------------------------------------------------------------------------------- */

static void print_heading(const table1_request *q, const machine *here, FILE *out) {
    fprintf(out, "Ours: %s, %d processors, f%d. Paper: %s (solids), %s (sheets).\n", here->processor, here->processors, q->precision,
            table1_machine(false), table1_machine(true));
    fprintf(out, "Our scenes stand in for the papers' (their meshes are not published), each run by the settings shown, at %s.\n",
            q->paper_dt ? "the paper's step where our limits allow it" : "our own step, the largest that our limits allow");
    fprintf(out, "Seconds are a frame's, of steps alone, the median of the frames timed; of sheets those of %d steps.\n", TABLE1_SHEET_STEPS);
    if (q->scale != 1) fprintf(out, "Particle counts are %g times the paper's: seconds cannot be compared.\n", q->scale);
    fprintf(out, "\n%-18s %9s %9s %9s %9s %7s %3s %7s %7s %9s %9s %6s %7s %8s %7s %7s\n", "row", "particles", "paper s", "ours s", "whole s",
            "faster", "thr", "steps", "paper's", "dt", "paper's", "M/s", "paper's", "frames", "damage", "broken");
    fflush(out);
}

static void print_start(const measured_row *m, FILE *out) {
    fprintf(out, "%s: %s", m->row->example, m->scene);
    for (int i = 0; i < m->setting_count; i++) fprintf(out, " --set %s", m->setting_text[i]);
    fputc('\n', out);
    fflush(out);
}

static void print_row(const table1_request *q, const measured_row *m, FILE *out) {
    const table1_row *row = m->row;
    const scene_timing *t = &m->timing;
    fprintf(out, "%-18s ", row->name);
    if (m->outcome != TIMED) {
        fprintf(out, "%9ld %9.4g  %s\n", row->particles, row->seconds, outcome_name(m));
    } else {
        char frames[32], faster[16] = "-", whole[16] = "-", steps[16] = "-";
        snprintf(frames, sizeof frames, "%d+%d", t->warm, t->frames);
        if (q->scale == 1) snprintf(faster, sizeof faster, "%s%.1f", t->extrapolated ? "~" : "", ratio_of(q, m));
        if (!row->sheet) snprintf(steps, sizeof steps, "%.0f", paper_steps(row));
        if (!row->sheet && !t->extrapolated) snprintf(whole, sizeof whole, "%.4g", t->run_seconds);
        fprintf(out, "%9lld %9.4g %s%8.4g %9s %7s %3d %7.1f %7s %9.3g %9.3g %6.4g %7.3g %8s %7.3g %7.3g\n", (long long)t->particles, row->seconds,
                t->extrapolated ? "~" : " ", our_seconds(m), whole, faster, t->threads, t->steps, steps, t->dt, row->dt,
                1e-6 * our_rate(m), 1e-6 * paper_rate(row), t->extrapolated ? "part" : frames, t->damage_max, t->broken_fraction);
    }
    if (m->note[0]) fprintf(out, "                   %s\n", m->note);
    fflush(out);
}

/* ---- JSON -------------------------------------------------------------------------------------------------------- */

static void json_paper(json_writer *w, const table1_row *row) {
    json_member_string(w, "name", row->name);
    json_member_string(w, "example", row->example);
    json_member_string(w, "paper", row->sheet ? "sheet" : "solid");
    json_member_integer(w, "paper_particles", row->particles);
    json_member_number(w, "paper_s_per_frame", row->sheet ? NAN : row->seconds);
    json_member_number(w, "paper_s_per_20_steps", row->sheet ? row->seconds : NAN);
    json_member_number(w, "paper_steps_per_frame", row->sheet ? NAN : paper_steps(row));
    json_member_number(w, "paper_dt", row->dt);
    json_member_number(w, "paper_dx", row->dx);
    json_member_number(w, "paper_particle_steps_per_s", paper_rate(row));
}

static void json_timing(json_writer *w, const table1_request *q, const measured_row *m) {
    const scene_timing *t = &m->timing;
    json_member_integer(w, "particles", t->particles);
    json_member_number(w, "s_per_frame", t->seconds);
    json_member_number(w, "s_per_frame_mean", t->seconds_mean);
    json_member_number(w, "run_s_per_frame", t->run_seconds);
    json_member_number(w, "setup_s", t->setup_seconds);
    json_member_number(w, "s_per_20_steps", m->row->sheet ? our_seconds(m) : NAN);
    json_member_number(w, "ratio", ratio_of(q, m));
    json_member_integer(w, "threads", t->threads);
    json_member_string(w, "simd", t->simd);
    json_member_number(w, "steps_per_frame", t->steps);
    json_member_number(w, "dt", t->dt);
    json_member_string(w, "dt_from", m->paper_dt ? "paper" : "auto");
    json_member_number(w, "particle_steps_per_s", our_rate(m));
    json_member_integer(w, "warm", t->warm);
    json_member_integer(w, "frames", t->frames);
    json_member_boolean(w, "extrapolated", t->extrapolated);
    json_member_boolean(w, "time_limit_reached", t->limited);
    json_member_number(w, "damage_max", t->damage_max);
    json_member_number(w, "broken_fraction", t->broken_fraction);
}

static void json_row(json_writer *w, const table1_request *q, const measured_row *m) {
    json_object(w);
    json_paper(w, m->row);
    json_member_string(w, "status", outcome_name(m));
    json_member_string(w, "scene", m->scene);
    json_member_array(w, "settings");
    for (int i = 0; i < m->setting_count; i++) json_string(w, m->setting_text[i]);
    json_array_end(w);
    json_member_number(w, "scale", q->scale);
    json_member_string(w, "note", m->note[0] ? m->note : NULL);
    if (m->outcome == TIMED) json_timing(w, q, m);
    json_object_end(w);
}

static int print_json(const table1_request *q, const machine *here, const measured_row *rows, int count) {
    json_writer w;
    report r;
    json_begin(&w, 2);
    json_object(&w);
    json_member_string(&w, "version", SUNDER_VERSION);
    json_member_string(&w, "processor", here->processor);
    json_member_integer(&w, "processors", here->processors);
    json_member_string(&w, "precision", q->precision == 32 ? "f32" : "f64");
    json_member_object(&w, "paper_machines");
    json_member_string(&w, "solid", table1_machine(false));
    json_member_string(&w, "sheet", table1_machine(true));
    json_object_end(&w);
    json_member_array(&w, "rows");
    for (int i = 0; i < count; i++) json_row(&w, q, &rows[i]);
    json_array_end(&w);
    json_object_end(&w);
    return cli_print_json(&w, &r) == STATUS_OK ? 0 : cli_fail(&r);
}

static status do_row(const table1_request *q, measured_row *m, FILE *out) {
    choose_settings(q, m);
    add_note(m, m->row->remark);
    m->outcome = access(m->scene, R_OK) == 0 ? TIMED : NO_SCENE;
    status code = m->outcome == TIMED && q->paper_dt ? choose_step(q, m) : STATUS_OK;
    print_start(m, out);
    if (m->outcome == TIMED) code = measure_row(q, m);
    print_row(q, m, out);
    return code;
}

/* A row that fails does not keep the others from being timed; it decides the exit code. */
int command_bench_table1(int count, char **arguments) {
    static table1_request q;
    static measured_row rows[ROWS];
    q = (table1_request){.solid = true, .frames = -1, .warm = -1, .precision = 32, .scale = 1, .limit = 60, .scenes = "scenes"};
    int worst = 0, measured = 0, code = parse(&q, count, arguments);
    if (code) return code;
    FILE *out = q.json ? stderr : stdout;
    machine here;
    machine_describe(&here);
    print_heading(&q, &here, out);
    for (status state = STATUS_OK; measured < q.row_count && state != STATUS_INTERRUPTED; measured++) {
        rows[measured].row = q.rows[measured];
        state = do_row(&q, &rows[measured], out);
        if (rows[measured].exit_code) worst = rows[measured].exit_code;
    }
    if (q.json && (code = print_json(&q, &here, rows, measured)) != 0) return code;
    return worst;
}
