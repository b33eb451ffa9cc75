/* sunder doctor: what this machine and this build can do, and which package brings what is missing. */
#include "cli/cli.h"

#include "base/sparse.h"
#include "base/json.h"
#include "base/threads.h"
#include "geom/tetrahedra.h"
#include "solid/solid.h"
#include "store/ledger.h"
#include "tui/tui.h"

#include <curses.h>
#include <getopt.h>
#include <hdf5.h>
#include <langinfo.h>
#include <lua.h>
#include <sqlite3.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { ROWS = 24 };

typedef struct doctor_row {
    const char *name;
    char value[512];
    bool good; /* a row that is not good says what to do */
} doctor_row;

typedef struct doctor_report {
    int count;
    doctor_row rows[ROWS];
} doctor_report;

static void add(doctor_report *d, bool good, const char *name, const char *format, ...) __attribute__((format(printf, 4, 5)));

static void add(doctor_report *d, bool good, const char *name, const char *format, ...) {
    doctor_row *row = &d->rows[d->count++];
    row->name = name;
    row->good = good;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(row->value, sizeof row->value, format, arguments);
    va_end(arguments);
}

static void add_libraries(doctor_report *d) {
    unsigned major, minor, release;
    H5get_libversion(&major, &minor, &release);
    add(d, true, "lua", LUA_VERSION_MAJOR "." LUA_VERSION_MINOR "." LUA_VERSION_RELEASE);
    add(d, true, "sqlite", "%s", sqlite3_libversion());
    add(d, true, "hdf5", "%u.%u.%u", major, minor, release);
    add(d, true, "ncurses", "%s", curses_version());
    report r;
    const char *gmsh = tetrahedra_gmsh_version(&r);
    if (gmsh) add(d, true, "gmsh", "%s", gmsh);
    else add(d, true, "gmsh", "not found (package libgmsh-dev: tetrahedra within triangle meshes)");
}

/* Programs that commands may call, with the Debian package of each. */
static void add_solvers(doctor_report *d) {
    static const char *const names[SPARSE_KINDS] = {"cholmod", "hypre"}, *const uses[SPARSE_KINDS] = {"solver direct", "solver amg"};
    for (int kind = 0; kind < SPARSE_KINDS; kind++) {
        if (sparse_available((sparse_kind)kind)) add(d, true, names[kind], "found");
        else add(d, true, names[kind], "not found (package %s: %s of inextensible fibres)", sparse_package((sparse_kind)kind), uses[kind]);
    }
}

static void add_tools(doctor_report *d) {
    static const struct {
        const char *program, *package, *what;
    } tools[] = {{"gnuplot", "gnuplot-nox", "figures of sunder plot --out"}, {"sqlite3", "sqlite3", "queries of the ledger by hand"}, {"pvpython", "paraview", "opening frames in ParaView"}};
    for (size_t i = 0; i < sizeof tools / sizeof *tools; i++) {
        char path[64];
        snprintf(path, sizeof path, "/usr/bin/%s", tools[i].program);
        bool found = access(path, X_OK) == 0;
        if (found) add(d, true, tools[i].program, "found");
        else add(d, true, tools[i].program, "not found (package %s: %s)", tools[i].package, tools[i].what);
    }
}

static void add_ledger(doctor_report *d) {
    char path[1024];
    report r;
    ledger *l = NULL;
    status code = ledger_default_path(path, sizeof path, &r);
    if (code == STATUS_OK) code = ledger_open(path, &l, &r);
    if (code == STATUS_OK) add(d, true, "ledger", "%.500s", path);
    else {
        char text[480];
        report_format(&r, text, sizeof text);
        add(d, false, "ledger", "%s", text);
    }
    if (l) ledger_close(l);
}

static void examine(doctor_report *d) {
    static const char *const simds[] = {"plain", "avx2", "avx512"};
    char has[64] = "";
    for (size_t i = 0; i < 3; i++)
        if (solid_engine_find(32, simds[i])) snprintf(has + strlen(has), sizeof has - strlen(has), "%s%s", has[0] ? ", " : "", simds[i]);
    const char *why = "yes";
    bool screen = tui_possible(&why);
    add(d, true, "version", "%s", SUNDER_VERSION);
    add(d, true, "processors", "%d", processor_count());
    add(d, true, "instruction sets", "%s (auto: %s)", has, solid_engine_find(32, "auto")->simd);
    add(d, true, "live view", "%s", screen ? "possible here" : why);
    add(d, true, "character set", "%s", nl_langinfo(CODESET));
    add_libraries(d);
    add_solvers(d);
    add_tools(d);
    add_ledger(d);
}

static void print_json(const doctor_report *d, bool good) {
    json_writer w;
    report r;
    json_begin(&w, 2);
    json_object(&w);
    json_member_boolean(&w, "ok", good);
    for (int i = 0; i < d->count; i++) json_member_string(&w, d->rows[i].name, d->rows[i].value);
    json_object_end(&w);
    if (cli_print_json(&w, &r) != STATUS_OK) (void)cli_fail(&r);
}

int command_doctor(int count, char **arguments) {
    static const struct option long_options[] = {{"json", no_argument, NULL, 'j'}, {NULL, 0, NULL, 0}};
    static doctor_report d;
    bool json = false, good = true;
    int option;
    while ((option = getopt_long(count, arguments, "", long_options, NULL)) != -1) {
        if (option != 'j') return cli_usage("doctor", "wrong option");
        json = true;
    }
    examine(&d);
    for (int i = 0; i < d.count; i++) good &= d.rows[i].good;
    if (json) print_json(&d, good);
    for (int i = 0; i < d.count && !json; i++) printf("%s %-17s %s\n", d.rows[i].good ? "  " : "! ", d.rows[i].name, d.rows[i].value);
    return good ? 0 : 1;
}
