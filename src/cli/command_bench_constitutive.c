/* sunder bench constitutive: how long a stress takes, in our closed form, in the paper's QR form, and fixed-corotated with a decomposition. */
#include "cli/cli.h"

#include "base/json.h"
#include "base/machine.h"
#include "sim/bench_constitutive.h"

#include <getopt.h>
#include <math.h>

static const double PAPER_RATIO = 3.4; /* AnisoMPM §8: its QR form against fixed-corotated, 10⁸ F, one at a time */

static const char *const models[CONTESTANTS] = {
    [BEST_CLOSED] = "closed form",   [BEST_COROTATED] = "fixed-corotated",   [PLAIN_CLOSED] = "closed form",        [PLAIN_COROTATED] = "fixed-corotated",
    [SCALAR_CLOSED] = "closed form", [SCALAR_QR] = "QR form",                [SCALAR_COROTATED] = "fixed-corotated",
};

typedef struct constitutive_ratio {
    const char *key, *text;
    constitutive_contestant slow, fast;
} constitutive_ratio;

static const constitutive_ratio ratios[] = {
    {"corotated_over_closed", "fixed-corotated over closed form, best build", BEST_COROTATED, BEST_CLOSED},
    {"corotated_over_closed_plain", "fixed-corotated over closed form, plain build", PLAIN_COROTATED, PLAIN_CLOSED},
    {"corotated_over_closed_scalar", "fixed-corotated over closed form, scalar", SCALAR_COROTATED, SCALAR_CLOSED},
    {"corotated_over_qr_scalar", "fixed-corotated over QR form, scalar (the paper: 3.4)", SCALAR_COROTATED, SCALAR_QR},
    {"scalar_corotated_over_best_closed", "scalar fixed-corotated over closed form in the best build", SCALAR_COROTATED, BEST_CLOSED},
};
enum { RATIOS = sizeof ratios / sizeof ratios[0] };

static const struct option long_options[] = {{"json", no_argument, NULL, 'j'}, {"count", required_argument, NULL, 'n'}, {NULL, 0, NULL, 0}};

static const char *build_name(const constitutive_result *result, int contestant) {
    return contestant < PLAIN_CLOSED ? result->simd : contestant < SCALAR_CLOSED ? "plain" : "scalar";
}

/* The scalar code of a model is what its other builds are compared with. */
static bool is_compared(int contestant) {
    return contestant != SCALAR_CLOSED && contestant != SCALAR_COROTATED;
}

static double ratio_of(const constitutive_result *result, const constitutive_ratio *ratio) {
    return result->nanoseconds[ratio->slow] / result->nanoseconds[ratio->fast];
}

static void print_table(const constitutive_result *f32, const constitutive_result *f64, FILE *out) {
    fprintf(out, "%lld random F for each, in each precision\n\n%-10s %-18s %12s %12s   %s\n", (long long)f32->count, "build", "model", "f32 ns/F", "f64 ns/F",
            "difference from scalar, f32 f64");
    for (int i = 0; i < CONTESTANTS; i++) {
        fprintf(out, "%-10s %-18s %12.2f %12.2f", build_name(f64, i), models[i], f32->nanoseconds[i], f64->nanoseconds[i]);
        if (is_compared(i)) fprintf(out, "   %.1e %.1e", f32->difference[i], f64->difference[i]);
        fputc('\n', out);
    }
    fprintf(out, "\n%-58s %8s %8s\n", "ratio", "f32", "f64");
    for (int i = 0; i < RATIOS; i++) fprintf(out, "%-58s %8.1f %8.1f\n", ratios[i].text, ratio_of(f32, &ratios[i]), ratio_of(f64, &ratios[i]));
}

static void json_precision(json_writer *w, const char *precision, const constitutive_result *result) {
    for (int i = 0; i < CONTESTANTS; i++) {
        json_object(w);
        json_member_string(w, "precision", precision);
        json_member_string(w, "build", build_name(result, i));
        json_member_string(w, "model", models[i]);
        json_member_integer(w, "count", result->count);
        json_member_number(w, "ns", result->nanoseconds[i]);
        json_member_number(w, "difference", is_compared(i) ? result->difference[i] : NAN);
        json_object_end(w);
    }
}

static void json_ratios(json_writer *w, const char *precision, const constitutive_result *result) {
    json_member_object(w, precision);
    for (int i = 0; i < RATIOS; i++) json_member_number(w, ratios[i].key, ratio_of(result, &ratios[i]));
    json_object_end(w);
}

static int print_json(const constitutive_result *f32, const constitutive_result *f64) {
    json_writer w;
    report r;
    machine here;
    machine_describe(&here);
    json_begin(&w, 2);
    json_object(&w);
    json_member_string(&w, "version", SUNDER_VERSION);
    json_member_string(&w, "processor", here.processor);
    json_member_array(&w, "rows");
    json_precision(&w, "f32", f32);
    json_precision(&w, "f64", f64);
    json_array_end(&w);
    json_member_object(&w, "ratios");
    json_ratios(&w, "f32", f32);
    json_ratios(&w, "f64", f64);
    json_object_end(&w);
    json_member_number(&w, "paper_ratio", PAPER_RATIO);
    json_object_end(&w);
    return cli_print_json(&w, &r) == STATUS_OK ? 0 : cli_fail(&r);
}

int command_bench_constitutive(int count, char **arguments) {
    bool json = false;
    long deformations = 10000000;
    int option, code = 0;
    while (code == 0 && (option = getopt_long(count, arguments, "", long_options, NULL)) != -1) switch (option) {
        case 'j': json = true; break;
        case 'n': code = cli_number("bench", "--count", optarg, 1, 10000000000, &deformations); break;
        default: code = cli_usage("bench", "wrong option");
        }
    if (code == 0 && optind < count) code = cli_usage("bench", "constitutive: %s: expected options only", arguments[optind]);
    if (code) return code;
    constitutive_result f32, f64;
    report r;
    if (bench_constitutive_f32(deformations, &f32, &r) != STATUS_OK || bench_constitutive_f64(deformations, &f64, &r) != STATUS_OK) return cli_fail(&r);
    print_table(&f32, &f64, json ? stderr : stdout);
    return json ? print_json(&f32, &f64) : 0;
}
