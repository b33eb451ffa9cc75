/* sunder: finds the command and calls it. */
#include "cli/cli.h"

#include "base/json.h"
#include "base/names.h"

#include <errno.h>
#include <locale.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static const command commands[] = {
    {"run", "run SCENE [--set KEY=VALUE]… [--recipe NAME] | run --resume RUN | run --branch RUN@FRAME   [--turn FRAME:PATH=VALUE]… [--frames N]\n"
            "         [--threads N] [--precision f32|f64] [--simd NAME] [--out DIR] [--db FILE] [--checkpoint-every N] [--keep N|SIZE|all]\n"
            "         [--tui [--paused]] [--json] [--quiet]",
     "simulate a scene: frames, ledger row, live screen with --tui (--paused: not yet begun)", command_run},
    {"check", "check SCENE [--set KEY=VALUE]… [--recipe NAME] [--json]", "validate a scene without running it", command_check},
    {"explain", "explain SCENE [--set KEY=VALUE]… [--json]", "show the plan: effects, fields, bytes, step limits, cost", command_explain},
    {"sweep", "sweep SCRIPT.lua [-j N] [--list] [--set KEY=VALUE]… [--frames N] [--threads N] [--db FILE] [--json] [--quiet] [--lines]",
     "run a scene over lists of values; what is done already is left out", command_sweep},
    {"stress", "stress [CASE]… [--effect NAME]… [--quick | --full] [--precision f32|f64|both] [--simd NAME] [--threads N] [-j N] [--time-limit S]\n"
               "                [--db FILE] [--json] [--quiet] [--verbose]   stress --list | --last  [--json]   stress --measures",
     "make the hard cases (scenes/stress) and hold each against what it must come to; --list: what they cover", command_stress},
    {"accuracy", "accuracy SCENE [--axis NAME]… [--levels N] [--measure NAME]… [--frames N] [--budget SECONDS] [--set KEY=VALUE]… [--recipe NAME] [--list]\n"
                 "         [-j N] [--threads N] [--precision f32|f64] [--simd NAME] [--out DIR] [--csv FILE] [--db FILE] [--json] [--quiet]",
     "what accuracy costs in time: the scene coarser and finer along each axis, errors, orders, the frontier; what is done already is left out", command_accuracy},
    {"runs", "runs list [--where CONDITION] [--limit N] | show RUN | diff RUN RUN | best [MEASURE] [--most] [--scene TEXT] | query [NAME [KEY=VALUE]…]\n"
             "         runs sql QUERY [KEY=VALUE]… | plot RUN… | tag RUN [TAG]… [--remove] | note RUN TEXT | rm RUN… [--yes] [--keep-files]\n"
             "         runs reproduce RUN [--out DIR] [--threads N]      all with [--db FILE] [--json]",
     "ask the ledger about past runs, write remarks, take runs away, run one again and compare bits", command_runs},
    {"plot", "plot RUN… [--where CONDITION] [--measure NAME]… [--against PARAMETER] [--log] [--log-x] [--out FILE.png|.svg|.pdf|.gp] [--text]\n"
             "         [--width N] [--height N] [--db FILE] [--json]",
     "draw measures over time or against a parameter, in the terminal or (--out) by gnuplot", command_plot},
    {"export", "export RUN --format csv|json|ply|obj|vtp|usda [--frame N | --all] [--part solid|sheet] [--out FILE] [--db FILE] [--json]",
     "a run for other programs: measures (csv, json), particles (ply, obj, vtp, csv with --frame), a sequence (--all, usda)", command_export},
    {"mesh", "mesh RUN [--frame N | --all] [--out FILE.ply|.obj|.stl] [--field NAME] [--intact] [--cell L] [--spacing L] [--db FILE] [--json]",
     "the body's surface as a triangle mesh; --intact opens cracks", command_mesh},
    {"render", "render RUN [--frame N] [--out FILE.png] [--colour FIELD] [--width N] [--height N] [--yaw D] [--pitch D] [--zoom PERCENT] [--db FILE]", "draw a frame", command_render},
    {"doctor", "doctor [--json]", "say what this machine and this build can do", command_doctor},
    {"bench", "bench step|sheet [--json] [--csv FILE] [--full] [--case NAME]… [--particles N] [--threads N] [--precision f32|f64] [--seconds S] [--repeat N]\n"
              "         sheet also: [--against lammps]\n"
              "         bench table1 [--paper solid|sheet|both] [--row NAME]… [--frames N] [--warm N] [--paper-dt] [--scale F] [--time-limit S] [--threads N]\n"
              "                      [--precision f32|f64] [--scenes DIR] [--json]\n"
              "         bench constraint [--scene lance|hanging_torus] [--particles N] [--frames N] [--warm N] [--threads N] [--scenes DIR] [--json]\n"
              "         bench constitutive [--count N] [--json]",
     "measure how fast steps are, beside what the machine could do; table1: seconds a frame, beside the papers'; constraint: inextensible fibres' solvers;\n"
     "      constitutive: one stress, beside the paper's form and fixed-corotated", command_bench},
    {"help", "help [COMMAND | effects | actions [--json]]", "list the commands, or say more of one; all effects with their parameters; all that the workbench can do", command_help},
};

const command *command_table(int *count) {
    *count = (int)(sizeof commands / sizeof *commands);
    return commands;
}

static const command *find_command(const char *name) {
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
        if (strcmp(commands[i].name, name) == 0) return &commands[i];
    return NULL;
}

int cli_fail(const report *r) {
    char text[1600];
    report_format(r, text, sizeof text);
    fprintf(stderr, "sunder: %s\n", text);
    return status_exit_code(r->code);
}

status cli_print_json(json_writer *w, report *r) {
    status code = json_finish(w, r);
    if (code == STATUS_OK) puts(w->text);
    json_free(w);
    return code;
}

int cli_fail_script(const script_reports *reports) {
    for (int i = 0; i < reports->count; i++) (void)cli_fail(&reports->items[i]);
    return reports->count > 0 ? status_exit_code(reports->items[0].code) : 1;
}

int cli_usage(const char *name, const char *format, ...) {
    const command *c = find_command(name);
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "sunder %s: ", name);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fprintf(stderr, "\nusage: sunder %s\n", c ? c->usage : name);
    return 2;
}

int cli_add_setting(cli_scene_options *o, const char *name, const char *text) {
    if (o->setting_count == CLI_SETTINGS) return cli_usage(name, "--set: at most %d times", CLI_SETTINGS);
    const char *equals = strchr(text, '=');
    if (!equals || equals == text) return cli_usage(name, "--set %s: expected KEY=VALUE", text);
    if (strlen(text) >= sizeof o->text[0]) return cli_usage(name, "--set: expected fewer than %zu characters", sizeof o->text[0]);
    char *copy = o->text[o->setting_count];
    strcpy(copy, text);
    copy[equals - text] = '\0';
    o->settings[o->setting_count++] = (script_setting){copy, copy + (equals - text) + 1};
    return 0;
}

int cli_number(const char *name, const char *option, const char *text, long low, long high, long *value) {
    char *end;
    errno = 0;
    *value = strtol(text, &end, 10);
    if (end != text && *end == '\0' && errno == 0 && *value >= low && *value <= high) return 0;
    return cli_usage(name, "%s %s: expected a whole number from %ld to %ld", option, text, low, high);
}

static int unknown_command(const char *name) {
    const char *names[sizeof commands / sizeof *commands];
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) names[i] = commands[i].name;
    const char *nearest = name_nearest(name, names, (int)(sizeof names / sizeof *names));
    report r;
    report_input(&r, NULL, 0, name, "a command (sunder help lists them)", "none of that name", nearest);
    return cli_fail(&r);
}

int cli_help_of(const char *name) {
    const command *c = find_command(name);
    if (!c) return unknown_command(name);
    printf("usage: sunder %s\n\n%s\n", c->usage, c->help);
    return 0;
}

/* `sunder COMMAND … --help`, or -h where it is the first word. */
static bool asks_for_help(int count, char **arguments) {
    if (count > 0 && strcmp(arguments[0], "-h") == 0) return true;
    for (int i = 0; i < count && strcmp(arguments[i], "--") != 0; i++)
        if (strcmp(arguments[i], "--help") == 0) return true;
    return false;
}

static int run_command(int count, char **arguments) {
    if (count < 2) return command_workbench(count, arguments);
    const char *name = arguments[1];
    if (strcmp(name, "--help") == 0 || strcmp(name, "-h") == 0) return command_help(0, NULL);
    if (strcmp(name, "--version") == 0) return puts("sunder " SUNDER_VERSION) < 0;
    if (strncmp(name, "--", 2) == 0) return command_workbench(count, arguments);
    const command *c = find_command(name);
    if (!c) return unknown_command(name);
    return asks_for_help(count - 2, arguments + 2) ? cli_help_of(name) : c->handler(count - 1, arguments + 1);
}

int main(int count, char **arguments) {
    setlocale(LC_ALL, "");
    setlocale(LC_NUMERIC, "C"); /* numbers in files and JSON have a point, wherever we are */
    int code = run_command(count, arguments);
    if ((fflush(stdout) == 0 && !ferror(stdout)) || code != 0) return code;
    fprintf(stderr, "sunder: cannot write the output: %s\n", strerror(errno));
    return 1;
}
