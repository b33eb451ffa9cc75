/* sunder plot: measures of runs over time, or against a parameter; in the terminal, or as a figure by gnuplot. */
#include "base/json.h"
#include "base/memory.h"
#include "cli/chart_print.h"
#include "cli/gnuplot.h"
#include "cli/runs.h"
#include "store/ledger_names.h"
#include "store/run_curves.h"
#include "view/chart.h"

#include <getopt.h>
#include <langinfo.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

enum { PLOT_RUNS = 512, PLOT_MEASURES = 8, PLOT_CURVES = 512, PLOT_NAME = 200 };

typedef struct plot_command {
    const char *database, *where, *against, *out;
    const char *measures[PLOT_MEASURES];
    int measure_count;
    bool json, text, log_x, log_y;
    long width, height;
    int run_count, curve_count;
    char parameter[LEDGER_NAME]; /* --against's, whole */
    char runs[PLOT_RUNS][LEDGER_ID];
    run_curve curves[PLOT_CURVES];
    char names[PLOT_CURVES][PLOT_NAME];
} plot_command;

enum { OPTION_DB = 256, OPTION_WHERE, OPTION_MEASURE, OPTION_AGAINST, OPTION_OUT, OPTION_TEXT, OPTION_JSON, OPTION_LOG, OPTION_LOG_X, OPTION_WIDTH, OPTION_HEIGHT };

static const struct option long_options[] = {
    {"db", required_argument, NULL, OPTION_DB},           {"where", required_argument, NULL, OPTION_WHERE}, {"measure", required_argument, NULL, OPTION_MEASURE},
    {"against", required_argument, NULL, OPTION_AGAINST}, {"out", required_argument, NULL, OPTION_OUT},     {"text", no_argument, NULL, OPTION_TEXT},
    {"json", no_argument, NULL, OPTION_JSON},             {"log", no_argument, NULL, OPTION_LOG},           {"log-x", no_argument, NULL, OPTION_LOG_X},
    {"width", required_argument, NULL, OPTION_WIDTH},     {"height", required_argument, NULL, OPTION_HEIGHT}, {NULL, 0, NULL, 0}};

static int parse(plot_command *c, int count, char **arguments) {
    int option, code = 0;
    while (code == 0 && (option = getopt_long(count, arguments, "", long_options, NULL)) != -1) {
        switch (option) {
        case OPTION_DB: c->database = optarg; break;
        case OPTION_WHERE: c->where = optarg; break;
        case OPTION_MEASURE:
            if (c->measure_count == PLOT_MEASURES) return cli_usage("plot", "--measure: at most %d", PLOT_MEASURES);
            c->measures[c->measure_count++] = optarg;
            break;
        case OPTION_AGAINST: c->against = optarg; break;
        case OPTION_OUT: c->out = optarg; break;
        case OPTION_TEXT: c->text = true; break;
        case OPTION_JSON: c->json = true; break;
        case OPTION_LOG: c->log_y = true; break;
        case OPTION_LOG_X: c->log_x = true; break;
        case OPTION_WIDTH: code = cli_number("plot", "--width", optarg, VIEW_CHART_LEAST_WIDTH, 8192, &c->width); break;
        case OPTION_HEIGHT: code = cli_number("plot", "--height", optarg, VIEW_CHART_LEAST_HEIGHT, 8192, &c->height); break;
        default: return cli_usage("plot", "wrong option");
        }
    }
    if (code) return code;
    if (optind == count && !c->where) return cli_usage("plot", "expected runs (ids, their beginnings or ends, or last), or --where CONDITION");
    if (c->measure_count == 0) c->measures[c->measure_count++] = "broken_fraction";
    return 0;
}

/* ---- what is drawn ----------------------------------------------------------------------------------------------- */

static status take_run(void *context, const ledger_cell *cells, int count, report *r) {
    plot_command *c = context;
    (void)count;
    if (c->run_count == PLOT_RUNS) return report_input(r, NULL, 0, "plot", "at most 512 runs", "more", NULL);
    snprintf(c->runs[c->run_count++], LEDGER_ID, "%s", cells[0].text);
    return STATUS_OK;
}

static status find_runs(plot_command *c, ledger *l, int count, char **names, report *r) {
    status code = STATUS_OK;
    if (c->where) {
        size_t size = strlen(c->where) + 96;
        char *sql = memory_allocate(size);
        if (!sql) return report_set(r, STATUS_SYSTEM, "out of memory for a condition");
        snprintf(sql, size, "SELECT id FROM runs_view WHERE (\n%s\n) ORDER BY run", c->where);
        code = ledger_each_row(l, sql, NULL, 0, take_run, c, r);
        memory_free(sql, size);
    }
    for (int i = 0; i < count && code == STATUS_OK; i++) {
        if (c->run_count == PLOT_RUNS) return report_input(r, NULL, 0, "plot", "at most 512 runs", "more", NULL);
        code = runs_find(l, names[i], c->runs[c->run_count], NULL, r);
        if (code == STATUS_OK) c->run_count++;
    }
    if (code == STATUS_OK && c->run_count == 0) code = report_input(r, NULL, 0, "--where", "a condition that some run fits", c->where, NULL);
    return code;
}

static status add_curve(plot_command *c, const char *name, run_curve **out, report *r) {
    if (c->curve_count == PLOT_CURVES) return report_input(r, NULL, 0, "plot", "at most 512 curves", "more", NULL);
    snprintf(c->names[c->curve_count], PLOT_NAME, "%s", name);
    *out = &c->curves[c->curve_count++];
    return STATUS_OK;
}

static status read_curves(plot_command *c, ledger *l, report *r) {
    status code = STATUS_OK;
    for (int m = 0; m < c->measure_count && code == STATUS_OK; m++) {
        run_curve *curve = NULL;
        if (c->against) code = add_curve(c, c->measures[m], &curve, r);
        for (int i = 0; i < c->run_count && code == STATUS_OK; i++) {
            char name[PLOT_NAME];
            snprintf(name, sizeof name, c->measure_count > 1 ? "%s %s" : "%s", c->runs[i], c->measures[m]);
            if (c->against) code = run_curve_point(l, c->runs[i], c->against, c->measures[m], curve, r);
            else if ((code = add_curve(c, name, &curve, r)) == STATUS_OK) code = run_curve_read(l, c->runs[i], c->measures[m], curve, r);
        }
        if (c->against && curve) run_curve_sort(curve);
    }
    return code;
}

static status collect(plot_command *c, int count, char **names, report *r) {
    char path[1024];
    ledger *l;
    status code = ledger_open_past(c->database, path, sizeof path, &l, r);
    if (code == STATUS_OK) code = find_runs(c, l, count, names, r);
    for (int m = 0; m < c->measure_count && code == STATUS_OK; m++) code = ledger_check_measure(l, c->measures[m], r);
    if (code == STATUS_OK && c->against) {
        code = ledger_find_parameter(l, c->against, c->parameter, r);
        c->against = c->parameter;
    }
    if (code == STATUS_OK) code = read_curves(c, l, r);
    if (l) ledger_close(l);
    return code;
}

/* ---- as text ----------------------------------------------------------------------------------------------------- */

static void choose_size(const plot_command *c, view_chart_options *o) {
    struct winsize size;
    bool known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    o->width = c->width ? (int)c->width : known ? size.ws_col - 1 : 79;
    o->height = c->height ? (int)c->height : known && size.ws_row > 12 ? size.ws_row * 2 / 3 : 20;
    if (o->width < VIEW_CHART_LEAST_WIDTH) o->width = VIEW_CHART_LEAST_WIDTH;
    if (o->height < VIEW_CHART_LEAST_HEIGHT) o->height = VIEW_CHART_LEAST_HEIGHT;
}

static status print_chart(const plot_command *c, report *r) {
    view_chart_options o = {.ascii = strcmp(nl_langinfo(CODESET), "UTF-8") != 0, .log_x = c->log_x, .log_y = c->log_y, .x_label = c->against ? c->against : "time"};
    choose_size(c, &o);
    size_t n = (size_t)o.width * (size_t)o.height;
    view_chart_cell *cells = memory_allocate_array(n, sizeof *cells);
    view_chart_series *series = memory_allocate_array((size_t)c->curve_count, sizeof *series);
    bool good = cells && series, colour = isatty(STDOUT_FILENO) && !getenv("NO_COLOR");
    for (int i = 0; i < c->curve_count && good; i++) series[i] = (view_chart_series){c->curves[i].x, c->curves[i].y, c->curves[i].count, c->against != NULL};
    if (good) {
        if (c->measure_count == 1) printf("%s\n", c->measures[0]);
        view_chart(series, c->curve_count, &o, cells);
        chart_print(&o, cells, colour);
        for (int i = 0; i < c->curve_count && c->curve_count > 1; i++) {
            if (colour) printf("\033[%dm", chart_colour(i));
            printf("%c  %s%s%s\n", view_chart_letter(i), c->names[i], c->curves[i].count ? "" : "  (nothing)", colour ? "\033[0m" : "");
        }
    }
    memory_free(cells, n * sizeof *cells);
    memory_free(series, (size_t)c->curve_count * sizeof *series);
    return good ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for a plot");
}

/* ---- as JSON, as a figure ---------------------------------------------------------------------------------------- */

static status print_json(const plot_command *c, report *r) {
    json_writer w;
    json_begin(&w, 0);
    json_object(&w);
    json_member_string(&w, "x", c->against ? c->against : "time");
    json_member_string(&w, "out", c->out);
    json_member_array(&w, "curves");
    for (int i = 0; i < c->curve_count; i++) {
        json_object(&w);
        if (!c->against) json_member_string(&w, "run_id", c->runs[i % c->run_count]);
        json_member_string(&w, "measure", c->measures[c->against ? i : i / c->run_count]);
        for (int axis = 0; axis < 2; axis++) {
            json_member_array(&w, axis ? "y" : "x");
            for (int k = 0; k < c->curves[i].count; k++) json_number(&w, axis ? c->curves[i].y[k] : c->curves[i].x[k]);
            json_array_end(&w);
        }
        json_object_end(&w);
    }
    json_array_end(&w);
    json_object_end(&w);
    return cli_print_json(&w, r);
}

static status write_figure(const plot_command *c, report *r) {
    static const char *names[PLOT_CURVES];
    static const double *x[PLOT_CURVES], *y[PLOT_CURVES];
    static int sizes[PLOT_CURVES];
    for (int i = 0; i < c->curve_count; i++) names[i] = c->names[i], x[i] = c->curves[i].x, y[i] = c->curves[i].y, sizes[i] = c->curves[i].count;
    gnuplot_figure f = {.x_label = c->against ? c->against : "time", .y_label = c->measure_count == 1 ? c->measures[0] : "", .log_x = c->log_x, .log_y = c->log_y,
                        .points = c->against != NULL, .width = c->width ? (int)c->width : 1000, .height = c->height ? (int)c->height : 600,
                        .count = c->curve_count, .names = names, .x = x, .y = y, .sizes = sizes};
    return gnuplot_write(c->out, &f, r);
}

int command_plot(int count, char **arguments) {
    static plot_command c;
    report r, figure;
    int result = parse(&c, count, arguments);
    if (result) return result;
    status code = collect(&c, count - optind, arguments + optind, &r);
    status drawn = code == STATUS_OK && c.out ? write_figure(&c, &figure) : STATUS_OK;
    if (code == STATUS_OK && c.json) code = print_json(&c, &r);
    /* A figure that cannot be had is drawn here instead; the exit code says that its file is missing. */
    else if (code == STATUS_OK && (!c.out || c.text || drawn == STATUS_SYSTEM)) code = print_chart(&c, &r);
    for (int i = 0; i < c.curve_count; i++) run_curve_free(&c.curves[i]);
    if (code != STATUS_OK) return cli_fail(&r);
    return drawn == STATUS_OK ? 0 : cli_fail(&figure);
}
