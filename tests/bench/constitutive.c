/* How long a stress takes: our closed form, the paper's QR form, fixed-corotated with a decomposition (METHOD.md §1).
 *
 *     bench_constitutive [COUNT]     COUNT random F, 10⁷ unless said
 *
 * The paper reports its QR form 3.4 times as fast as fixed-corotated, both scalar. */
#include "bench/constitutive.h"

#include <stdio.h>
#include <stdlib.h>

static void print_table(const bench_result *single, const bench_result *wide) {
    static const char *const names[BENCH_ROWS] = {
        [BEST_CLOSED] = "closed form",   [BEST_COROTATED] = "fixed-corotated",   [PLAIN_CLOSED] = "closed form",        [PLAIN_COROTATED] = "fixed-corotated",
        [SCALAR_CLOSED] = "closed form", [SCALAR_QR] = "QR form",                [SCALAR_COROTATED] = "fixed-corotated",
    };
    printf("%-10s %-18s %12s %12s   %s\n", "build", "model", "f32 ns/F", "f64 ns/F", "difference from scalar, f32 f64");
    for (int row = 0; row < BENCH_ROWS; row++) {
        const char *build = row < PLAIN_CLOSED ? wide->simd : row < SCALAR_CLOSED ? "plain" : "scalar";
        printf("%-10s %-18s %12.2f %12.2f", build, names[row], single->nanoseconds[row], wide->nanoseconds[row]);
        if (row == SCALAR_CLOSED || row == SCALAR_COROTATED) puts("");
        else printf("   %.1e %.1e\n", single->difference[row], wide->difference[row]);
    }
}

static void print_ratio(const char *text, const bench_result *single, const bench_result *wide, int slow, int fast) {
    printf("%-58s %8.1f %8.1f\n", text, single->nanoseconds[slow] / single->nanoseconds[fast], wide->nanoseconds[slow] / wide->nanoseconds[fast]);
}

int main(int argc, char **argv) {
    int64_t count = argc > 1 ? strtoll(argv[1], NULL, 10) : 10000000;
    if (count < 1) return fputs("usage: bench_constitutive [COUNT]\n", stderr), 2;
    bench_result single = bench_constitutive_f32(count), wide = bench_constitutive_f64(count);
    print_table(&single, &wide);
    printf("\n%-58s %8s %8s\n", "ratio", "f32", "f64");
    print_ratio("fixed-corotated over closed form, best build", &single, &wide, BEST_COROTATED, BEST_CLOSED);
    print_ratio("fixed-corotated over closed form, plain build", &single, &wide, PLAIN_COROTATED, PLAIN_CLOSED);
    print_ratio("fixed-corotated over closed form, scalar", &single, &wide, SCALAR_COROTATED, SCALAR_CLOSED);
    print_ratio("fixed-corotated over QR form, scalar (the paper: 3.4)", &single, &wide, SCALAR_COROTATED, SCALAR_QR);
    print_ratio("scalar fixed-corotated over closed form in the best build", &single, &wide, SCALAR_COROTATED, BEST_CLOSED);
    return 0;
}
