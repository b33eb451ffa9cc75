/* sunder without a command: the workbench; sunder --replay FILE: a command log done again, with or without a terminal. */
#include "cli/cli.h"

#include "session/session.h"
#include "tui/tui.h"

#include <getopt.h>
#include <unistd.h>

static const char usage[] = "[--db FILE] [--out DIR] [--replay FILE]";

static const struct option long_options[] = {{"replay", required_argument, NULL, 'r'},
                                             {"db", required_argument, NULL, 'd'},
                                             {"out", required_argument, NULL, 'o'},
                                             {NULL, 0, NULL, 0}};

static int wrong(const char *what) {
    fprintf(stderr, "sunder: %s\nusage: sunder %s\n", what, usage);
    return 2;
}

/* How runs have ended was seen on the screen: the workbench itself has done well when it could be opened. A replay's outcome is its run's. */
static int finish(session *run, bool replayed, status outcome, const report *r) {
    bool told = replayed || !run;
    if (outcome != STATUS_OK && told) (void)cli_fail(r);
    if (run) {
        cli_print_end(run, stdout);
        session_destroy(run);
    }
    return told ? status_exit_code(outcome) : 0;
}

int command_workbench(int count, char **arguments) {
    tui_options look = tui_options_default();
    int option;
    while ((option = getopt_long(count, arguments, "", long_options, NULL)) != -1) {
        if (option == 'r') look.replay = optarg;
        else if (option == 'd') look.database = optarg;
        else if (option == 'o') look.output = optarg;
        else return wrong("that option is of no use without a command; sunder help lists the commands");
    }
    if (optind < count) return wrong("options come before a command's name only when there is none");
    if (look.output && !look.replay) return wrong("--out DIR is for --replay FILE");
    const char *why;
    if (!tui_possible(&why)) {
        if (!look.replay) {
            int code = command_help(0, NULL);
            if (isatty(STDOUT_FILENO)) fprintf(stderr, "sunder: the workbench is off: %s\n", why);
            return code;
        }
        look.headless = true;
    }
    session *run = NULL;
    report r;
    status outcome = tui_workbench(&run, &look, &r);
    return finish(run, look.replay != NULL, outcome, &r);
}
