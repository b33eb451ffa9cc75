/* The live screen over a synthetic session, for test_tui.py and for looking at.
 * Options: --particles N --frames N --frame-ms MS --fail-at N --crash-at N SIGNAL --exit-after MS --print --paused
 * --warn
 * --torn --undamaged --leave --log --theme N --ascii */
#include "base/memory.h"
#include "tui/fake_session.h"
#include "tui/tui.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static double number(int argc, char **argv, int *i) {
    if (++*i >= argc) {
        fprintf(stderr, "demo_tui: a number is missing at the end\n");
        exit(2);
    }
    return atof(argv[*i]);
}

/* Leaves by exit() from another thread, as a library might. */
static void *exit_later(void *milliseconds) {
    usleep((useconds_t)(1000 * *(const double *)milliseconds));
    exit(7);
}

typedef struct demo_options {
    fake_options fake;
    tui_options tui;
    double exit_after; /* ms; 0: never */
} demo_options;

static demo_options parse(int argc, char **argv) {
    demo_options o = {.fake = {.particles = 20000, .frames = 200, .frame_seconds = 0.05, .fail_at = -1, .crash_at = -1},
                      .tui = tui_options_default()};
    for (int i = 1; i < argc; i++) {
        const char *name = argv[i];
        if (strcmp(name, "--particles") == 0)
            o.fake.particles = (int64_t)number(argc, argv, &i);
        else if (strcmp(name, "--frames") == 0)
            o.fake.frames = (int64_t)number(argc, argv, &i);
        else if (strcmp(name, "--frame-ms") == 0)
            o.fake.frame_seconds = number(argc, argv, &i) / 1000;
        else if (strcmp(name, "--hold") == 0)
            o.fake.hold = i + 1 < argc ? argv[++i] : NULL;
        else if (strcmp(name, "--fail-at") == 0)
            o.fake.fail_at = (int64_t)number(argc, argv, &i);
        else if (strcmp(name, "--exit-after") == 0)
            o.exit_after = number(argc, argv, &i);
        else if (strcmp(name, "--theme") == 0)
            o.tui.theme = (tui_theme_kind)number(argc, argv, &i);
        else if (strcmp(name, "--torn") == 0)
            o.fake.torn = true;
        else if (strcmp(name, "--print") == 0)
            o.fake.prints = true;
        else if (strcmp(name, "--paused") == 0)
            o.fake.start_paused = true;
        else if (strcmp(name, "--warn") == 0)
            o.fake.warns = true;
        else if (strcmp(name, "--undamaged") == 0)
            o.fake.undamaged = true;
        else if (strcmp(name, "--leave") == 0)
            o.tui.leave_at_end = true;
        else if (strcmp(name, "--ascii") == 0)
            o.tui.ascii = true;
        else if (strcmp(name, "--log") == 0)
            o.tui.log_histogram = true;
        else if (strcmp(name, "--crash-at") == 0) {
            o.fake.crash_at = (int64_t)number(argc, argv, &i);
            o.fake.crash_signal = (int)number(argc, argv, &i);
        } else {
            fprintf(stderr, "demo_tui: unknown option %s\n", name);
            exit(2);
        }
    }
    return o;
}

int main(int argc, char **argv) {
    static demo_options o;
    o = parse(argc, argv);
    const char *why;
    if (!tui_possible(&why)) {
        printf("impossible: %s\n", why);
        return 3;
    }
    session *s = fake_session_start(&o.fake);
    if (!s) return 1;
    pthread_t thread;
    if (o.exit_after > 0 && pthread_create(&thread, NULL, exit_later, &o.exit_after) != 0) return 1;
    report r;
    status outcome = tui_workbench(&s, &o.tui, &r);
    session_snapshot last = {0};
    session_poll(s, &last);
    const session_sample *now = &last.now;
    printf("last %.3e %.3e %.3e %.2f %.4f %.4f\n", now->kinetic, now->elastic, now->fibre, 100 * now->broken_fraction,
           now->damage_mean, now->damage_max);
    session_snapshot_free(&last);
    session_destroy(s);
    printf("outcome %d: %s\nleft %zu bytes\n", (int)outcome, r.message, memory_live_bytes());
    return status_exit_code(outcome);
}
