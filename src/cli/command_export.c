/* sunder export: a run for other programs: its measures as a table, its particles as files that they read. */
#include "base/json.h"
#include "base/memory.h"
#include "base/names.h"
#include "cli/runs.h"
#include "store/export.h"
#include "store/frames.h"

#include <getopt.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct export_command {
    const char *run, *database, *format, *out, *part; /* part: solid or sheet, of a scene with both */
    long frame; /* −1: the last */
    bool all, json;
    char id[LEDGER_ID], folder[1024];
    int64_t *frames; /* [frame_count] of the run */
    int frame_count;
} export_command;

enum { OPTION_FORMAT = 256, OPTION_FRAME, OPTION_ALL, OPTION_OUT, OPTION_DB, OPTION_JSON, OPTION_PART };

static const struct option long_options[] = {
    {"format", required_argument, NULL, OPTION_FORMAT}, {"frame", required_argument, NULL, OPTION_FRAME}, {"all", no_argument, NULL, OPTION_ALL},
    {"out", required_argument, NULL, OPTION_OUT},       {"db", required_argument, NULL, OPTION_DB},       {"json", no_argument, NULL, OPTION_JSON},
    {"part", required_argument, NULL, OPTION_PART},     {NULL, 0, NULL, 0}};

static int parse(export_command *c, int count, char **arguments) {
    int option, code = 0;
    while (code == 0 && (option = getopt_long(count, arguments, "", long_options, NULL)) != -1) {
        switch (option) {
        case OPTION_FORMAT: c->format = optarg; break;
        case OPTION_FRAME: code = cli_number("export", "--frame", optarg, 0, 1000000000, &c->frame); break;
        case OPTION_ALL: c->all = true; break;
        case OPTION_OUT: c->out = optarg; break;
        case OPTION_DB: c->database = optarg; break;
        case OPTION_JSON: c->json = true; break;
        case OPTION_PART: c->part = optarg; break;
        default: return cli_usage("export", "wrong option");
        }
    }
    if (code) return code;
    if (optind != count - 1) return cli_usage("export", "expected one run (an id, its beginning or end, or last)");
    if (!c->format) return cli_usage("export", "expected --format");
    c->run = arguments[optind];
    return 0;
}

/* ---- the run's numbers ------------------------------------------------------------------------------------------- */

static status take_csv_row(void *context, const ledger_cell *cells, int count, report *r) {
    FILE *out = context;
    (void)r;
    for (int i = 0; i < count; i++) {
        char digits[JSON_NUMBER] = "";
        if (isfinite(cells[i].number)) json_format_number(cells[i].number, digits); /* all of them: SQLite's text has fifteen */
        fprintf(out, "%s%s", i ? "," : "", digits);
    }
    fputc('\n', out);
    return STATUS_OK;
}

typedef struct csv_columns {
    FILE *sql, *out;
} csv_columns;

/* One column for each measure of the run: max(…) FILTER turns rows into columns. */
static status take_csv_column(void *context, const ledger_cell *cells, int count, report *r) {
    csv_columns *c = context;
    (void)count;
    if (strspn(cells[0].text, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.") != strlen(cells[0].text))
        return report_set(r, STATUS_SYSTEM, "a measure with an odd name: %s", cells[0].text);
    fprintf(c->out, ",%s", cells[0].text);
    fprintf(c->sql, ", max(value) FILTER (WHERE name = '%s')", cells[0].text);
    return STATUS_OK;
}

/* A row a frame: frame, time, steps, wall time, measures. */
static status write_csv(ledger *l, const export_command *c, FILE *out, report *r) {
    char argument[LEDGER_ID + 4], *sql = NULL;
    const char *const arguments[] = {argument};
    size_t size;
    snprintf(argument, sizeof argument, "id=%s", c->id);
    csv_columns columns = {.sql = open_memstream(&sql, &size), .out = out};
    if (!columns.sql) return report_set(r, STATUS_SYSTEM, "out of memory for a table");
    fputs("frame,time,steps,wall_s", out);
    fputs("SELECT f.frame, f.time, f.steps, f.wall_seconds", columns.sql);
    status code = ledger_each_row(l, "SELECT DISTINCT name FROM measures_view WHERE id = :id ORDER BY name", arguments, 1, take_csv_column, &columns, r);
    fputs(" FROM frames AS f JOIN runs USING (run) LEFT JOIN measures_view AS m ON m.run = f.run AND m.frame = f.frame "
          "WHERE runs.id = :id GROUP BY f.frame ORDER BY f.frame", columns.sql);
    fputc('\n', out);
    bool whole = fclose(columns.sql) == 0;
    if (code == STATUS_OK && !whole) code = report_set(r, STATUS_SYSTEM, "out of memory for a table");
    if (code == STATUS_OK) code = ledger_each_row(l, sql, arguments, 1, take_csv_row, out, r);
    free(sql);
    return code;
}

/* The run's numbers to --out, whole or not at all, or to standard output. */
static status export_numbers(ledger *l, const export_command *c, report *r) {
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (!out) return report_set(r, STATUS_SYSTEM, "out of memory for a table");
    bool csv = strcmp(c->format, "csv") == 0;
    status code = csv ? write_csv(l, c, out, r) : ledger_print_show(l, out, true, c->id, r);
    bool whole = fclose(out) == 0;
    if (code == STATUS_OK && !whole) code = report_set(r, STATUS_SYSTEM, "out of memory for a table");
    if (code == STATUS_OK && c->out) code = file_write_atomic(c->out, text, size, r);
    else if (code == STATUS_OK && fwrite(text, 1, size, stdout) != size) code = report_set(r, STATUS_SYSTEM, "cannot write the output");
    free(text);
    return code;
}

/* ---- particles --------------------------------------------------------------------------------------------------- */

/* Forgets the arrays of the other engine. */
static status keep_part(record_list *records, const char *part, report *r) {
    size_t front = strlen(part);
    int kept = 0;
    record *rest = records->items;
    for (int i = 0; i < records->count; i++) {
        record item = rest[i];
        if (strncmp(item.name, part, front) == 0 && item.name[front] == '/') rest[kept++] = item;
        else memory_free(item.data, (size_t)item.count * (size_t)item.components * record_type_size(item.type));
    }
    records->count = kept;
    return kept > 0 ? STATUS_OK : report_input(r, NULL, 0, "--part", "solid or sheet, whichever the run has", part, NULL);
}

static status write_points(const export_command *c, int64_t frame, const char *path, double *time, report *r) {
    record_list records = {0};
    int64_t step;
    status code = frame_read(c->folder, frame, &records, time, &step, r);
    if (code == STATUS_OK && c->part) code = keep_part(&records, c->part, r);
    export_points points = {.records = &records, .set = export_set(&records), .frame = frame, .time = *time};
    if (code == STATUS_OK && !points.set) code = report_set(r, STATUS_SYSTEM, "frame %" PRId64 " has no particles", frame);
    if (code == STATUS_OK) code = export_points_write(path, &points, r);
    record_clear(&records);
    if (code == STATUS_OK && !c->json) fprintf(stderr, "%s\n", path);
    return code;
}

/* The name of a file without its folder. */
static const char *file_name(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

/* A sequence: NAME.ply becomes NAME.000000.ply …; of .vtp also NAME.pvd, which lists them with their times. */
static status write_sequence(const export_command *c, const char *out, report *r) {
    size_t n = (size_t)c->frame_count;
    char(*paths)[1024] = memory_allocate_array(n, sizeof *paths);
    const char **names = memory_allocate_array(n, sizeof *names);
    double *times = memory_allocate_array(n, sizeof *times);
    status code = paths && names && times ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for %zu names", n);
    for (int i = 0; i < c->frame_count && code == STATUS_OK; i++) {
        code = export_sequence_path(out, c->frames[i], paths[i], r);
        if (code == STATUS_OK) code = write_points(c, c->frames[i], paths[i], &times[i], r);
        if (code == STATUS_OK) names[i] = file_name(paths[i]);
    }
    if (code == STATUS_OK && strcmp(c->format, "vtp") == 0) {
        char list[1024];
        snprintf(list, sizeof list, "%.*s.pvd", (int)strlen(out) - 4, out);
        code = export_pvd_write(list, names, times, c->frame_count, r);
        if (code == STATUS_OK && !c->json) fprintf(stderr, "%s\n", list);
    }
    memory_free(paths, n * sizeof *paths);
    memory_free(names, n * sizeof *names);
    memory_free(times, n * sizeof *times);
    return code;
}

static status read_frame(void *context, int index, record_list *records, int64_t *frame, report *r) {
    const export_command *c = context;
    double time;
    int64_t step;
    *frame = c->frames[index];
    status code = frame_read(c->folder, *frame, records, &time, &step, r);
    return code == STATUS_OK && c->part ? keep_part(records, c->part, r) : code;
}

static status take_rate(void *context, const ledger_cell *cells, int count, report *r) {
    (void)count, (void)r;
    if (cells[0].number > 0) *(double *)context = cells[0].number;
    return STATUS_OK;
}

/* Frames a second, from the last frame's time. */
static status frame_rate(ledger *l, const export_command *c, double *rate, report *r) {
    char argument[LEDGER_ID + 4];
    const char *const arguments[] = {argument};
    snprintf(argument, sizeof argument, "id=%s", c->id);
    *rate = 24;
    return ledger_each_row(l, "SELECT f.frame / f.time FROM frames AS f JOIN runs USING (run) WHERE runs.id = :id AND f.time > 0 ORDER BY f.frame DESC LIMIT 1",
                           arguments, 1, take_rate, rate, r);
}

static status export_frames(ledger *l, export_command *c, report *r) {
    char name[128], path[1024];
    double time = 0, rate;
    snprintf(name, sizeof name, "%s.%s", c->id, c->format);
    const char *out = c->out ? c->out : name;
    status code = frame_list(c->folder, &c->frames, &c->frame_count, r);
    if (code == STATUS_OK && c->frame_count == 0) code = report_input(r, c->folder, 0, c->id, "a run with frames", "none", NULL);
    if (code != STATUS_OK) return code;
    if (strcmp(c->format, "usda") == 0) {
        code = frame_rate(l, c, &rate, r);
        if (code == STATUS_OK) code = export_usda_write(out, c->frame_count, rate, read_frame, c, r);
        if (code == STATUS_OK && !c->json) fprintf(stderr, "%s\n", out);
        return code;
    }
    int64_t frame = c->frame < 0 ? c->frames[c->frame_count - 1] : c->frame;
    if (c->all) return write_sequence(c, out, r);
    if (c->out) snprintf(path, sizeof path, "%s", c->out);
    else code = export_sequence_path(out, frame, path, r);
    return code == STATUS_OK ? write_points(c, frame, path, &time, r) : code;
}

/* ---- the command ------------------------------------------------------------------------------------------------- */

static status check_format(const export_command *c, report *r) {
    static const char *const formats[] = {"csv", "json", "ply", "obj", "vtp", "usda"};
    enum { FORMATS = sizeof formats / sizeof *formats };
    bool known = false;
    for (int i = 0; i < FORMATS; i++) known |= strcmp(c->format, formats[i]) == 0;
    if (!known) return report_input(r, NULL, 0, "--format", "csv, json, ply, obj, vtp or usda", c->format, name_nearest(c->format, formats, FORMATS));
    const char *dot = c->out ? strrchr(c->out, '.') : NULL;
    if (c->out && (!dot || strcmp(dot + 1, c->format) != 0) && strcmp(c->format, "json") != 0) {
        char expected[64];
        snprintf(expected, sizeof expected, "a name that ends in .%s", c->format);
        return report_input(r, NULL, 0, "--out", expected, c->out, NULL);
    }
    return STATUS_OK;
}

static status print_json(const export_command *c, report *r) {
    json_writer w;
    json_begin(&w, 0);
    json_object(&w);
    json_member_string(&w, "run_id", c->id);
    json_member_string(&w, "format", c->format);
    json_member_string(&w, "out", c->out);
    json_member_integer(&w, "frames", c->all || strcmp(c->format, "usda") == 0 ? c->frame_count : 1);
    json_object_end(&w);
    return cli_print_json(&w, r);
}

int command_export(int count, char **arguments) {
    static export_command c = {.frame = -1};
    char path[1024];
    report r;
    ledger *l = NULL;
    int result = parse(&c, count, arguments);
    if (result) return result;
    status code = check_format(&c, &r);
    if (code == STATUS_OK) code = ledger_open_past(c.database, path, sizeof path, &l, &r);
    if (code == STATUS_OK) code = runs_find(l, c.run, c.id, c.folder, &r);
    /* A table of measures, unless particles are meant by naming frames. */
    bool numbers = strcmp(c.format, "json") == 0 || (strcmp(c.format, "csv") == 0 && c.frame < 0 && !c.all);
    if (code == STATUS_OK) code = numbers ? export_numbers(l, &c, &r) : export_frames(l, &c, &r);
    if (code == STATUS_OK && c.json && (!numbers || c.out)) code = print_json(&c, &r);
    memory_free(c.frames, (size_t)c.frame_count * sizeof *c.frames);
    if (l) ledger_close(l);
    return code == STATUS_OK ? 0 : cli_fail(&r);
}
