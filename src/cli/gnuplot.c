#include "cli/gnuplot.h"

#include "base/json.h"
#include "base/names.h"
#include "store/frames.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* ---- the script -------------------------------------------------------------------------------------------------- */

/* A text in double quotes, as gnuplot reads it (without its markup: enhanced mode is off). */
static void put_quoted(FILE *out, const char *text) {
    fputc('"', out);
    for (; *text; text++) {
        if (*text == '"' || *text == '\\') fputc('\\', out);
        fputc((unsigned char)*text < 0x20 ? ' ' : *text, out);
    }
    fputc('"', out);
}

static void put_setting(FILE *out, const char *key, const char *text) {
    if (!text || !text[0]) return;
    fprintf(out, "set %s ", key);
    put_quoted(out, text);
    fputc('\n', out);
}

static void put_data(FILE *out, const gnuplot_figure *f, int which) {
    fprintf(out, "$run%d << EOD\n", which);
    for (int i = 0; i < f->sizes[which]; i++) {
        char x[JSON_NUMBER], y[JSON_NUMBER];
        if (!isfinite(f->x[which][i]) || !isfinite(f->y[which][i])) {
            fputc('\n', out); /* a gap */
            continue;
        }
        json_format_number(f->x[which][i], x);
        json_format_number(f->y[which][i], y);
        fprintf(out, "%s %s\n", x, y);
    }
    fputs("EOD\n", out);
}

static void put_script(FILE *out, const gnuplot_figure *f, const char *terminal, const char *path) {
    if (terminal) {
        fprintf(out, "set terminal %s\n", terminal);
        put_setting(out, "output", path);
    }
    fputs("set termoption noenhanced\nset encoding utf8\nset grid lc rgb \"#c8c8c8\"\nset key outside top center horizontal\n", out);
    put_setting(out, "title", f->title);
    put_setting(out, "xlabel", f->x_label);
    put_setting(out, "ylabel", f->y_label);
    if (f->log_x) fputs("set logscale x\n", out);
    if (f->log_y) fputs("set logscale y\n", out);
    for (int i = 0; i < f->count; i++) put_data(out, f, i);
    fputs("plot ", out);
    for (int i = 0; i < f->count; i++) {
        fprintf(out, "%s$run%d with %s title ", i ? ", " : "", i, f->points ? "linespoints" : "lines lw 2");
        put_quoted(out, f->names[i]);
    }
    fputc('\n', out);
}

static status make_script(const gnuplot_figure *f, const char *terminal, const char *path, char **text, size_t *size, report *r) {
    FILE *out = open_memstream(text, size);
    if (!out) return report_set(r, STATUS_SYSTEM, "out of memory for a figure");
    put_script(out, f, terminal, path);
    return fclose(out) == 0 ? STATUS_OK : report_set(r, STATUS_SYSTEM, "out of memory for a figure");
}

/* ---- the program ------------------------------------------------------------------------------------------------- */

/* Whether the program is on the path. */
static bool is_there(void) {
    const char *path = getenv("PATH");
    for (const char *at = path ? path : ""; *at;) {
        char name[1024];
        size_t length = strcspn(at, ":");
        snprintf(name, sizeof name, "%.*s/gnuplot", (int)length, at);
        if (length > 0 && access(name, X_OK) == 0) return true;
        at += length + (at[length] == ':');
    }
    return false;
}

/* gnuplot's first complaint, without its empty lines. */
static void first_words(FILE *file, char text[256]) {
    char line[256];
    text[0] = '\0';
    rewind(file);
    while (!text[0] && fgets(line, sizeof line, file)) {
        line[strcspn(line, "\n")] = '\0';
        const char *at = line + strspn(line, " \t^");
        if (*at) snprintf(text, 256, "%s", at);
    }
}

static status start(const char *script, FILE *input, FILE *errors, pid_t *pid, report *r) {
    char *const argv[] = {"gnuplot", "-", NULL};
    posix_spawn_file_actions_t actions;
    fputs(script, input);
    if (fflush(input) != 0) return report_set(r, STATUS_SYSTEM, "a temporary file for gnuplot: %s", strerror(errno));
    rewind(input);
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, fileno(input), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, fileno(errors), STDERR_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    int trouble = posix_spawnp(pid, "gnuplot", &actions, NULL, argv, environ);
    posix_spawn_file_actions_destroy(&actions);
    return trouble ? report_set(r, STATUS_SYSTEM, "starting gnuplot: %s", strerror(trouble)) : STATUS_OK;
}

static status run_gnuplot(const char *script, report *r) {
    FILE *input = tmpfile(), *errors = tmpfile();
    pid_t pid = 0;
    int outcome = 0;
    status code = input && errors ? start(script, input, errors, &pid, r) : report_set(r, STATUS_SYSTEM, "a temporary file for gnuplot: %s", strerror(errno));
    while (code == STATUS_OK && waitpid(pid, &outcome, 0) < 0 && errno == EINTR) continue;
    if (code == STATUS_OK && outcome != 0) {
        char words[256];
        first_words(errors, words);
        code = report_set(r, STATUS_SYSTEM, "gnuplot: %s", words[0] ? words : "it failed without a word");
    }
    if (input) fclose(input);
    if (errors) fclose(errors);
    return code;
}

status gnuplot_write(const char *path, const gnuplot_figure *f, report *r) {
    static const char *const suffixes[] = {".png", ".svg", ".pdf", ".gp"};
    enum { PNG, SVG, PDF, SCRIPT, KINDS };
    const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
    int kind = -1;
    for (int i = 0; i < KINDS; i++)
        if (dot && strcmp(dot, suffixes[i]) == 0) kind = i;
    if (kind < 0) return report_input(r, path, 0, "--out", "a name that ends in .png, .svg, .pdf or .gp (gnuplot's script)", dot ? dot : "none", dot ? name_nearest(dot, suffixes, KINDS) : NULL);
    if (kind != SCRIPT && !is_there())
        return report_set(r, STATUS_SYSTEM, "%.300s: gnuplot is not here to draw it (package gnuplot-nox); a name that ends in .gp keeps its script", path);
    char terminal[96] = "", *text = NULL;
    size_t size = 0;
    if (kind == PDF) snprintf(terminal, sizeof terminal, "pdfcairo size %d.%02d,%d.%02d", f->width / 100, f->width % 100, f->height / 100, f->height % 100);
    else if (kind == SVG) snprintf(terminal, sizeof terminal, "svg size %d,%d", f->width, f->height);
    else if (kind == PNG) snprintf(terminal, sizeof terminal, "pngcairo size %d,%d", f->width, f->height);
    status code = make_script(f, terminal[0] ? terminal : NULL, path, &text, &size, r);
    if (code == STATUS_OK) code = terminal[0] ? run_gnuplot(text, r) : file_write_atomic(path, text, size, r);
    free(text);
    return code;
}
