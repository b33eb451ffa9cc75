/* From figures to a verdict. */
#include "study/stress.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const char *const words[STRESS_VERDICTS] = {"not run", "started", "holds", "stops", "known limit", "FAILS"};

const char *stress_verdict_word(stress_verdict v) {
    return words[v];
}

int stress_verdict_find(const char *word) {
    for (int i = 0; i < STRESS_VERDICTS; i++)
        if (strcmp(words[i], word) == 0) return i;
    return -1;
}

static void say(stress_run *run, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void say(stress_run *run, const char *format, ...) {
    size_t used = strlen(run->text);
    va_list arguments;
    if (used > 0) used += (size_t)snprintf(run->text + used, sizeof run->text - used, "; ");
    if (used >= sizeof run->text) return;
    va_start(arguments, format);
    vsnprintf(run->text + used, sizeof run->text - used, format, arguments);
    va_end(arguments);
}

static bool within(const hard_expectation *e, double value) {
    return value >= e->low && value <= e->high; /* NaN is within nothing */
}

static void say_bound(stress_run *run, const hard_expectation *e, double value) {
    const char *key = hard_measure_at(e->measure)->key, *mark = within(e, value) ? "" : "! ";
    if (isnan(value)) say(run, "%s%s was not measured", mark, key);
    else if (isinf(e->low)) say(run, "%s%s %.4g (at most %.4g)", mark, key, value, e->high);
    else if (isinf(e->high)) say(run, "%s%s %.4g (at least %.4g)", mark, key, value, e->low);
    else say(run, "%s%s %.4g (%.4g to %.4g)", mark, key, value, e->low, e->high);
}

/* Those that do not hold come first. */
static int compare(const hard_case *h, stress_run *run) {
    int failed = 0;
    bool like = h->same_as.variant[0] != '\0', alike = !like || run->difference <= h->same_as.tolerance;
    for (int good = 0; good < 2; good++) {
        if (like && alike == good) say(run, "%sdifference %.4g from %s (at most %.4g)", alike ? "" : "! ", run->difference, h->same_as.variant, h->same_as.tolerance);
        for (int i = 0; i < h->count; i++) {
            double value = run->value[h->items[i].measure];
            if (within(&h->items[i], value) != good) continue;
            say_bound(run, &h->items[i], value);
            failed += !good;
        }
    }
    return failed + !alike;
}

static bool ended_as_it_should(const hard_case *h, stress_run *run) {
    if (run->timed_out) say(run, "! did not end in %.0f s", run->seconds);
    else if (run->exit_code > 2 && run->exit_code != 130) say(run, "! crashed: signal %d", run->exit_code - 128);
    else if (h->stop[0] && run->exit_code == 0) say(run, "! ran to its end instead of stopping with \"%s\"", h->stop);
    else if (h->stop[0] && !strstr(run->message, h->stop)) say(run, "! stopped with another message than \"%s\": %s", h->stop, run->message);
    else if (!h->stop[0] && run->exit_code != 0) say(run, "! %s", run->message[0] ? run->message : "ended without a message");
    else return true;
    return false;
}

static status measure(ledger *l, const stress_case *c, stress_run *run, const char *other, stress_figures *f, report *r) {
    status code = stress_measure(l, run->id, run->folder, c->gravity, f, r);
    memcpy(run->value, f->value, sizeof run->value);
    run->difference = NAN;
    if (code == STATUS_OK && c->like >= 0 && other && run->exit_code == 0) code = stress_difference(run->folder, other, &c->hard.same_as, &run->difference, r);
    return code;
}

/* A known limit is one of bounds: a crash, a state that is not finite or a case that never ends is none. One that holds after all is told. */
status stress_judge(ledger *l, const stress_case *c, stress_run *run, const char *other, report *r) {
    stress_figures f = {.broken = ""};
    run->text[0] = '\0';
    run->verdict = STRESS_FAILS;
    if (run->id[0]) {
        status code = measure(l, c, run, other, &f, r);
        if (code != STATUS_OK) return code;
    }
    bool ended = ended_as_it_should(&c->hard, run), known = c->hard.known_limit[0] != '\0', crashed = run->timed_out || run->exit_code > 2;
    if (f.broken[0]) say(run, "! %s", f.broken);
    int failed = ended && run->exit_code == 0 ? compare(&c->hard, run) : 0;
    bool held = ended && failed == 0 && !f.broken[0];
    if (held && known) say(run, "! holds, though it is listed as a known limit: take known_limit out");
    else if (held) run->verdict = c->hard.stop[0] ? STRESS_STOPS : STRESS_HOLDS;
    else if (known && !crashed && !f.broken[0]) run->verdict = STRESS_KNOWN;
    if (held && c->hard.stop[0]) say(run, "%s", run->message);
    if (run->verdict == STRESS_KNOWN) say(run, "%s", c->hard.known_limit);
    return STATUS_OK;
}
