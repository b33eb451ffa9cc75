/* The tests' own vocabulary: named test functions, checks that count, a closing line. */
#ifndef SUNDER_TESTS_CHECK_H
#define SUNDER_TESTS_CHECK_H

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
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
