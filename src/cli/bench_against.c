#include "cli/bench_against.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <math.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

static const char *const names[] = {"lmp", "lmp_serial", "lmp_mpi"};
enum { NAMES = sizeof names / sizeof *names };

/* What LAMMPS did on this kind of machine: it sets how many steps take the time that is asked for. */
static const double BONDS_A_SECOND = 6e7;
enum { WARM_UP_STEPS = 10, LEAST_STEPS = 5 };

static const char *find_program(void) {
    const char *path = getenv("PATH");
    for (int i = 0; i < NAMES; i++)
        for (const char *at = path; at && *at;) {
            char file[1024];
            int length = (int)strcspn(at, ":");
            snprintf(file, sizeof file, "%.*s/%s", length, at, names[i]);
            if (length > 0 && access(file, X_OK) == 0) return names[i];
            at += length + (at[length] == ':');
        }
    return NULL;
}

status lammps_find(report *r) {
    if (find_program()) return STATUS_OK;
    return report_input(r, NULL, 0, "--against", "LAMMPS as lmp, lmp_serial or lmp_mpi in PATH (Debian: the package lammps)", "none of them", NULL);
}

/* The sheet breathes a little; no bond breaks; neighbours are listed once. */
static void write_input(FILE *out, int64_t particles, int neighbours, int64_t steps) {
    long long side = llround(sqrt((double)particles));
    double dx = 1.0 / (double)side, horizon = (neighbours == 8 ? 1.51 : 3.015) * dx;
    fprintf(out, "units si\natom_style peri\natom_modify map array\nboundary f f f\nlattice sc %.17g\n", dx);
    fprintf(out, "region space block -10 %lld -10 %lld -10 10\nregion sheet block 0 %lld.5 0 %lld.5 0 0.5\n", side + 10, side + 10, side - 1, side - 1);
    fprintf(out, "create_box 1 space\ncreate_atoms 1 region sheet\npair_style peri/pmb\npair_coeff * * 1 %.17g 0.5 0.25\n", horizon);
    fprintf(out, "set group all density 1\nset group all volume %.17g\nvelocity all ramp vx -0.005 0.005 x 0 1 units box\n", 0.01 * dx * dx);
    fprintf(out, "fix 1 all nve\ntimestep %.17g\nneighbor %.17g bin\nneigh_modify delay 1000000 every 1000000 check no\nthermo 1000000\n", 1e-3 * dx, 0.4 * dx);
    fprintf(out, "run %d\nrun %lld\n", WARM_UP_STEPS, (long long)steps);
}

/* Of its output: the version, the bonds, the last loop's time; the first error into `trouble`. */
static void read_output(FILE *from, against_result *out, char *trouble, size_t size) {
    char line[1024];
    rewind(from);
    while (fgets(line, sizeof line, from)) {
        const char *at = strstr(line, "total # of bonds = ");
        double seconds;
        long long steps, atoms;
        line[strcspn(line, "\n")] = '\0';
        if (strncmp(line, "LAMMPS (", 8) == 0) snprintf(out->version, sizeof out->version, "%.95s", line);
        if (at) out->bonds = strtoll(at + 19, NULL, 10);
        if (sscanf(line, "Loop time of %lf on %*d procs for %lld steps with %lld", &seconds, &steps, &atoms) == 3)
            out->seconds = seconds, out->steps = steps, out->particles = atoms;
        if (strncmp(line, "ERROR", 5) == 0 && !trouble[0]) snprintf(trouble, size, "%.200s", line);
    }
}

static status run_program(const char *program, const char *input, FILE *output, report *r) {
    char one[] = "OMP_NUM_THREADS=1";
    char *const arguments[] = {(char *)(uintptr_t)program, "-in", (char *)(uintptr_t)input, "-log", "none", NULL};
    posix_spawn_file_actions_t actions;
    pid_t pid = 0;
    int state = 0;
    putenv(one);
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, fileno(output), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, fileno(output), STDERR_FILENO);
    int trouble = posix_spawnp(&pid, program, &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    unsetenv("OMP_NUM_THREADS");
    if (trouble) return report_set(r, STATUS_SYSTEM, "starting %s: %s", program, strerror(trouble));
    while (waitpid(pid, &state, 0) < 0 && errno == EINTR) {}
    return STATUS_OK;
}

status lammps_sheet(int64_t particles, int neighbours, double seconds, against_result *out, report *r) {
    char input[] = "/tmp/sunder-lammps-XXXXXX", trouble[256] = "";
    *out = (against_result){0};
    status code = lammps_find(r);
    if (code != STATUS_OK) return code;
    int64_t steps = (int64_t)fmax(LEAST_STEPS, ceil(seconds * BONDS_A_SECOND / ((double)particles * neighbours)));
    int file = mkstemp(input);
    FILE *script = file >= 0 ? fdopen(file, "w") : NULL, *output = tmpfile();
    if (script) write_input(script, particles, neighbours, steps);
    if (!script || fclose(script) != 0 || !output) code = report_set(r, STATUS_SYSTEM, "a temporary file for LAMMPS: %s", strerror(errno));
    if (code == STATUS_OK) code = run_program(find_program(), input, output, r);
    if (code == STATUS_OK) read_output(output, out, trouble, sizeof trouble);
    if (output) fclose(output);
    if (file >= 0) unlink(input);
    if (code != STATUS_OK || (out->steps == steps && out->seconds > 0 && out->bonds > 0)) return code;
    return report_set(r, STATUS_SYSTEM, "LAMMPS did not run the sheet: %s", trouble[0] ? trouble : "it says nothing that is known here");
}
