#include "cli/accuracy_print.h"

#include "base/memory.h"
#include "cli/chart_print.h"

#include <langinfo.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

enum { SHOWN = 4, CHART_HEIGHT = 16 };

static void share(double value, bool about, char text[24]) {
    if (isnan(value)) snprintf(text, 24, "-");
    else if (value >= 0.0995) snprintf(text, 24, "%s%.0f%%", about ? "~" : "", 100 * value);
    else snprintf(text, 24, "%s%.2g%%", about ? "~" : "", 100 * value);
}

/* The measures that a table has room for: those that are judged, then others that occur. */
static int shown_measures(const accuracy_study *s, const accuracy_axis *a, int out[SHOWN]) {
    int count = 0;
    for (int pass = 0; pass < 2; pass++)
        for (int m = 0; m < s->measure_count && count < SHOWN; m++)
            if (s->measures[m].occurs && s->measures[m].judged == !pass && (a->same_particles || s->measures[m].kind != MEASURE_PARTICLES)) out[count++] = m;
    return count;
}

/* Text broken at spaces, 80 columns wide; what goes on is indented. */
static void print_wrapped(const char *text) {
    int column = 0;
    while (*text) {
        size_t bytes = strcspn(text, " ");
        if (text[bytes] == ' ' && text[bytes + 1] == '%') bytes += 2; /* a figure keeps its sign */
        int width = 0;
        for (size_t i = 0; i < bytes; i++) width += ((unsigned char)text[i] & 0xc0) != 0x80;
        if (column > 0 && column + 1 + width > 80) {
            printf("\n  ");
            column = 2;
        } else if (column > 0) {
            putchar(' ');
            column++;
        }
        printf("%.*s", (int)bytes, text);
        column += width;
        text += bytes + (text[bytes] == ' ');
    }
    putchar('\n');
}

/* ---- tables ------------------------------------------------------------------------------------------------------ */

static void print_point(const accuracy_study *s, int axis, int level, const int *measures, int count) {
    const accuracy_result *x = &s->results[axis];
    const accuracy_point *p = &x->point[level];
    const axis_level *l = &s->axes[axis].level[level];
    int number = s->run_of[axis][level];
    const accuracy_run *run = &s->runs[number];
    char worst[24], early[24], each[24];
    const char *mark = number == 0 ? "*" : " ";
    if (p->run < 0) {
        printf("%s %-9s %s%s%s\n", mark, l->value, accuracy_state_name(run->state), run->result.message[0] ? ": " : "", run->result.message);
        return;
    }
    bool reference = level == x->reference;
    share(reference ? x->worst_left : p->worst, reference, worst);
    share(reference || isnan(x->crack) ? NAN : p->worst_early, false, early);
    printf("%s %-9s %7.3g %5.3gx %8s %8s", mark, l->value, run->result.step_seconds, run->result.step_seconds / s->runs[0].result.step_seconds, worst, early);
    for (int i = 0; i < count; i++) {
        share(reference ? x->left[measures[i]] : p->error[measures[i]], reference, each);
        printf(" %8s", each);
    }
    putchar('\n');
}

static void print_axis(const accuracy_study *s, int axis) {
    const accuracy_axis *a = &s->axes[axis];
    const accuracy_result *x = &s->results[axis];
    int measures[SHOWN], count = shown_measures(s, a, measures), levels = 0;
    for (int l = 0; l < a->count; l++) levels += s->run_of[axis][l] >= 0;
    if (levels == 0) return;
    char head[ACCURACY_TEXT];
    snprintf(head, sizeof head, "%s: %s", a->name, a->doc);
    putchar('\n');
    print_wrapped(head);
    printf("  %-9.9s %7s %6s %8s %8s", a->key, "steps s", "time", "error", "to crack");
    for (int i = 0; i < count; i++) printf(" %8.8s", s->measures[measures[i]].name);
    putchar('\n');
    for (int l = 0; l < a->count; l++)
        if (s->run_of[axis][l] >= 0) print_point(s, axis, l, measures, count);
    if (!a->ordered || x->reference < 0) return;
    printf("  %-42s", "observed order");
    for (int i = 0; i < count; i++)
        if (isnan(x->order[measures[i]])) printf(" %8s", "-");
        else printf(" %8.2f", x->order[measures[i]]);
    putchar('\n');
}

/* ---- the plot ---------------------------------------------------------------------------------------------------- */

/* Error against seconds, a line an axis and points for what is worth its time; the finest level stands at what it still lacks, where that is known. */
typedef struct curves {
    double x[AXES][AXIS_LEVELS], y[AXES][AXIS_LEVELS], best_x[AXES * AXIS_LEVELS], best_y[AXES * AXIS_LEVELS];
    view_chart_series series[AXES + 1];
} curves;

static int fill_series(const accuracy_study *s, curves *c) {
    int count = 0, best = 0;
    for (int a = 0; a < s->axis_count; a++) {
        int n = 0;
        for (int l = 0; l < s->axes[a].count; l++) {
            const accuracy_point *p = &s->results[a].point[l];
            if (p->run < 0 || s->results[a].reference < 0) continue;
            c->x[a][n] = s->runs[p->run].result.step_seconds;
            c->y[a][n] = l == s->results[a].reference ? s->results[a].worst_left : p->worst;
            if (p->frontier && c->y[a][n] > 0) c->best_x[best] = c->x[a][n], c->best_y[best++] = c->y[a][n];
            n++;
        }
        c->series[count++] = (view_chart_series){c->x[a], c->y[a], n, false};
    }
    c->series[count++] = (view_chart_series){c->best_x, c->best_y, best, true};
    return count;
}

static status print_chart(const accuracy_study *s, report *r) {
    struct winsize size;
    bool known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0, colour = isatty(STDOUT_FILENO) && !getenv("NO_COLOR");
    view_chart_options o = {.width = known && size.ws_col < 100 ? size.ws_col - 1 : 79, .height = CHART_HEIGHT, .ascii = strcmp(nl_langinfo(CODESET), "UTF-8") != 0,
                            .log_x = true, .log_y = true, .x_label = "seconds of steps"};
    if (o.width < VIEW_CHART_LEAST_WIDTH) o.width = VIEW_CHART_LEAST_WIDTH;
    curves c;
    view_chart_cell *cells = memory_allocate_array((size_t)o.width * (size_t)o.height, sizeof *cells);
    if (!cells) return report_set(r, STATUS_SYSTEM, "out of memory for a plot");
    int count = fill_series(s, &c);
    printf("\nerror against seconds\n");
    view_chart(c.series, count, &o, cells);
    chart_print(&o, cells, colour);
    int at = 0;
    for (int i = 0; i < count; i++) {
        const char *name = i < s->axis_count ? s->axes[i].name : "worth its time";
        if (c.series[i].count == 0) continue;
        if (at + 4 + (int)strlen(name) > 80) at = 0, putchar('\n');
        at += 4 + (int)strlen(name);
        if (colour) printf("\033[%dm", chart_colour(i));
        printf("  %c %s%s", view_chart_letter(i), name, colour ? "\033[0m" : "");
    }
    putchar('\n');
    memory_free(cells, (size_t)o.width * (size_t)o.height * sizeof *cells);
    return STATUS_OK;
}

/* ---- the frontier ------------------------------------------------------------------------------------------------ */

static int list_points(const accuracy_study *s, const accuracy_point *out[ACCURACY_RUNS]) {
    int count = 0;
    for (int i = 0; i < s->axis_count * AXIS_LEVELS; i++) {
        const accuracy_point *p = &s->results[i / AXIS_LEVELS].point[i % AXIS_LEVELS];
        bool there = isnan(p->estimate);
        for (int k = 0; k < count; k++) there |= out[k]->run == p->run;
        if (!there && count < ACCURACY_RUNS) out[count++] = p;
    }
    for (int i = 1; i < count; i++)
        for (int k = i; k > 0 && s->runs[out[k]->run].result.step_seconds < s->runs[out[k - 1]->run].result.step_seconds; k--) {
            const accuracy_point *swap = out[k];
            out[k] = out[k - 1], out[k - 1] = swap;
        }
    return count;
}

static void print_frontier(const accuracy_study *s) {
    const accuracy_point *points[ACCURACY_RUNS];
    int count = list_points(s, points);
    if (count < 2) return;
    printf("\nworth their time (+), with the error that all axes together leave\n   %7s %7s %8s\n", "steps s", "time", "error");
    for (int i = 0; i < count; i++) {
        const accuracy_point *p = points[i];
        char text[24], name[96], other[96] = "";
        double seconds = s->runs[p->run].result.step_seconds;
        share(p->estimate, true, text);
        accuracy_run_name(s, p->run, name);
        if (p->dominated_by >= 0) accuracy_run_name(s, p->dominated_by, other);
        printf(" %c %7.3g %6.3gx %8s  %s%s%s%s\n", p->frontier ? '+' : ' ', seconds, seconds / s->runs[0].result.step_seconds, text, name, other[0] ? " (beaten by " : "", other,
               other[0] ? ")" : "");
    }
}

status accuracy_print(const accuracy_study *s, report *r) {
    bool any = false;
    for (int a = 0; a < s->axis_count; a++) print_axis(s, a), any |= s->results[a].reference >= 0;
    printf("\n* the scene's own; error: the largest of the measures, against the finest level;\n  ~ what is estimated to be left by the observed order\n");
    status code = any ? print_chart(s, r) : STATUS_OK;
    print_frontier(s);
    if (s->note_count > 0) putchar('\n');
    for (int i = 0; i < s->note_count; i++) print_wrapped(s->notes[i]);
    if (s->options.jobs > 1) printf("Runs were made %d at a time: their seconds cannot be compared.\n", s->options.jobs);
    return code;
}
