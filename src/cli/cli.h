/* The commands: parse, call, print. Each is one file and one row of the table in main.c. */
#ifndef SUNDER_CLI_CLI_H
#define SUNDER_CLI_CLI_H

#include "base/status.h"
#include "script/script.h"

#include <stdbool.h>
#include <stdio.h>

enum { CLI_SETTINGS = 64 };

/* Options that several commands share. */
typedef struct cli_scene_options {
    const char *scene, *recipe;
    int setting_count;
    script_setting settings[CLI_SETTINGS];
    char text[CLI_SETTINGS][256]; /* where the settings' strings live */
} cli_scene_options;

typedef int command_handler(int count, char **arguments);

command_handler command_run, command_check, command_explain, command_runs, command_render, command_plot, command_export, command_mesh, command_doctor, command_bench, command_sweep, command_stress, command_accuracy, command_help, command_workbench;

typedef struct command {
    const char *name, *usage, *help;
    command_handler *handler;
} command;

/* The table of commands and its length. */
const command *command_table(int *count);

/* Says in two lines what a run that has ended has done. */
struct session;
void cli_print_end(struct session *s, FILE *out);

/* What `bench sheet` was asked for. */
typedef struct sheet_bench_matrix {
    bool json, lammps; /* lammps: beside it */
    const long *sizes;
    const int *threads, *precisions;
    int size_count, thread_count, precision_count, repeat;
    double seconds;
} sheet_bench_matrix;

/* command_bench_sheet.c: times it and prints; the exit code. */
int command_bench_sheet(const sheet_bench_matrix *q);

/* command_bench_table1.c: `bench table1`, with its own options; arguments[0] is "table1". The exit code. */
int command_bench_table1(int count, char **arguments);

/* command_bench_constraint.c: `bench constraint`, likewise. */
int command_bench_constraint(int count, char **arguments);

/* command_bench_constitutive.c: `bench constitutive`, likewise. */
int command_bench_constitutive(int count, char **arguments);

/* Prints a report as one line on standard error, after "sunder: ", and returns its exit code. */
int cli_fail(const report *r);

/* The same for wrong arguments: what is wrong with `option`, and how the command is used. Returns 2. */
int cli_usage(const char *name, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Prints how a command is used; the exit code: 2 when there is none of that name. */
int cli_help_of(const char *name);

/* Prints all of a script's reports; returns the exit code of the first. */
int cli_fail_script(const script_reports *reports);

/* Ends a JSON text, prints it on standard output and frees it. */
struct json_writer;
status cli_print_json(struct json_writer *w, report *r);

/* Adds a --set KEY=VALUE. Returns 0, or 2 with a message. */
int cli_add_setting(cli_scene_options *o, const char *name, const char *text);

/* Reads a whole number within [low, high]. Returns 0, or 2 with a message. */
int cli_number(const char *name, const char *option, const char *text, long low, long high, long *value);

/* What `check` and `explain` say of a scene with both kinds. */
#define NOTE_NO_CONTACT "sheets and solids share time, gravity, grips and colliders, but pass through one another: contact = { … } makes them touch"

#endif
