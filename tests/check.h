/* The tests' own vocabulary: named test functions, checks that count, a closing line. */
#ifndef SUNDER_TESTS_CHECK_H
#define SUNDER_TESTS_CHECK_H

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int check_failures;
static int check_count;

#define CHECK(condition)                                                                                               \
    do {                                                                                                               \
        check_count++;                                                                                                 \
        if (!(condition)) {                                                                                            \
            check_failures++;                                                                                          \
            printf("  %s:%d: failed: %s\n", __FILE__, __LINE__, #condition);                                          \
        }                                                                                                              \
    } while (0)

/* |actual − expected| ≤ tolerance, with both figures printed when it is not so (NaN fails). */
#define CHECK_NEAR(actual, expected, tolerance)                                                                        \
    do {                                                                                                               \
        check_count++;                                                                                                 \
        double check_a = (actual), check_e = (expected), check_t = (tolerance);                                        \
        if (!(fabs(check_a - check_e) <= check_t)) {                                                                   \
            check_failures++;                                                                                          \
            printf("  %s:%d: failed: %s = %.17g, expected %.17g within %g\n", __FILE__, __LINE__, #actual, check_a,      \
                   check_e, check_t);                                                                                  \
        }                                                                                                              \
    } while (0)

/* A row of docs/verification.md: what was set up, what theory says, what came out. `measured` must lie within `tolerance` of
 * `expected`; for errors and drifts expected is 0. With SUNDER_VERIFICATION set the row is appended to that file. */
#define CHECK_ROW(source, set_up, expected, measured, tolerance)                                                       \
    check_row(__FILE__, __LINE__, source, set_up, expected, measured, tolerance)

static inline void check_row(const char *file, int line, const char *source, const char *set_up, double expected,
                             double measured, double tolerance) {
    bool good = fabs(measured - expected) <= tolerance;
    check_count++;
    if (!good) {
        check_failures++;
        printf("  %s:%d: failed: %s: %.6g, expected %.6g within %.3g\n", file, line, set_up, measured, expected, tolerance);
    }
    const char *path = getenv("SUNDER_VERIFICATION");
    FILE *out = path ? fopen(path, "a") : NULL;
    if (!out) return;
    fprintf(out, "| %s | %s | %.6g | %.6g | %.3g | %s |\n", source, set_up, expected, measured, tolerance, good ? "holds" : "FAILS");
    fclose(out);
}

#define RUN(test)                                                                                                      \
    do {                                                                                                               \
        int check_before = check_failures;                                                                             \
        test();                                                                                                        \
        printf("%s %s\n", check_failures == check_before ? "ok  " : "FAIL", #test);                                    \
        fflush(stdout);                                                                                                \
    } while (0)

/* Ends main: prints the tally, returns the exit code. A run without a single check fails. */
static inline int check_finish(void) {
    printf("%d checks, %d failed\n", check_count, check_failures);
    return check_failures || !check_count ? 1 : 0;
}

#endif
