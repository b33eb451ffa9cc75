/* Wrong scenes: tests/cases/wrong/NN_name.lua must not load, tests/cases/wrong_running/NN_name.lua must load and fail
 * later.
 *
 * A case says in its first line (the binary one in its second) what its report must contain:
 *     -- expect: FILE:LINE key=KEY nearest=NAME found=WORDS says WORDS
 * FILE is the file's last name; key and found may be a part; '_' in `found` stands for a blank; several lines each want
 * a report. */
#include "base/memory.h"
#include "check.h"
#include "script/script.h"

#include <dirent.h>
#include <stdlib.h>
#include <time.h>

#define WRONG SUNDER_SOURCE "/tests/cases/wrong"
#define WRONG_RUNNING SUNDER_SOURCE "/tests/cases/wrong_running"

enum { LEAST_CASES = 36, FILE_SIZE = 4096 };

static script_reports reports;

typedef struct expectation {
    char file[128], key[128], nearest[64], found[128], says[256];
    int line;
} expectation;

/* The next "-- expect:" line from *at on; false when there are no more. */
static bool next_expectation(const char **at, expectation *e) {
    const char *start = strstr(*at, "-- expect: ");
    if (!start) return false;
    *e = (expectation){.line = 0};
    char line[512];
    snprintf(line, sizeof line, "%.*s", (int)strcspn(start, "\n"), start);
    *at = start + strlen(line);
    char *says = strstr(line, " says ");
    if (says) {
        snprintf(e->says, sizeof e->says, "%s", says + 6);
        *says = '\0';
    }
    sscanf(line, "-- expect: %127[^:]:%d", e->file, &e->line);
    const char *key = strstr(line, " key="), *nearest = strstr(line, " nearest="), *found = strstr(line, " found=");
    if (key) sscanf(key, " key=%127s", e->key);
    if (nearest) sscanf(nearest, " nearest=%63s", e->nearest);
    if (found) sscanf(found, " found=%127s", e->found);
    for (char *c = e->found; *c; c++)
        if (*c == '_') *c = ' ';
    return true;
}

static bool fits(const report *r, const expectation *e) {
    char text[1500];
    report_format(r, text, sizeof text);
    const char *slash = strrchr(r->file, '/');
    return r->code == STATUS_INPUT && strcmp(slash ? slash + 1 : r->file, e->file) == 0 && r->line == e->line &&
           strstr(r->key, e->key) && strstr(r->found, e->found) && strstr(text, e->says) &&
           (!*e->nearest || strcmp(r->nearest, e->nearest) == 0);
}

static char *read_case(const char *path) {
    static char text[FILE_SIZE];
    FILE *f = fopen(path, "rb");
    size_t size = f ? fread(text, 1, sizeof text - 1, f) : 0;
    text[size] = '\0';
    if (f) fclose(f);
    return text;
}

/* Whether every expectation of the file is met by some report. */
static void check_reports(const char *name, const char *path) {
    const char *at = read_case(path);
    expectation e;
    if (!*at) { /* the empty file cannot say what it wants */
        CHECK(reports.count > 0 && reports.items[0].line > 0 && strstr(reports.items[0].file, name));
        return;
    }
    CHECK(strstr(at, "-- expect: ") != NULL);
    while (next_expectation(&at, &e)) {
        bool met = false;
        for (int i = 0; i < reports.count; i++) met = met || fits(&reports.items[i], &e);
        CHECK(met);
        if (met) continue;
        printf("  %s wants %s:%d key=%s nearest=%s found=%s says %s\n", name, e.file, e.line, e.key, e.nearest, e.found,
               e.says);
        for (int i = 0; i < reports.count; i++) {
            char text[1500];
            report_format(&reports.items[i], text, sizeof text);
            printf("    reported %s\n", text);
        }
    }
}

static script_options limits(const char *path) {
    script_options o = script_options_default();
    /* Bombs that only the clock stops get little of it; the others must not meet it even under a sanitizer. */
    o.time_limit = strstr(read_case(path), "processor time") ? 0.15 : 20;
    o.memory_limit = (size_t)64 << 20;
    return o;
}

static int compare_names(const void *a, const void *b) {
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Calls `run` for each case of a folder in order of name; returns how many. */
static int for_each_case(const char *folder, void (*run)(const char *name, const char *path)) {
    char *names[256];
    int count = 0;
    DIR *stream = opendir(folder);
    CHECK(stream != NULL);
    if (!stream) return 0;
    for (struct dirent *entry; (entry = readdir(stream)) && count < 256;)
        if (strstr(entry->d_name, ".lua")) names[count++] = strdup(entry->d_name);
    closedir(stream);
    qsort(names, (size_t)count, sizeof *names, compare_names);
    for (int i = 0; i < count; i++) {
        char path[1024];
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        run(names[i], path);
        free(names[i]);
    }
    return count;
}

static void run_wrong(const char *name, const char *path) {
    script_options o = limits(path);
    script *s;
    size_t before = memory_live_bytes();
    struct timespec start, end;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &start);
    CHECK(script_load(path, &o, &s, &reports) == STATUS_INPUT);
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &end);
    double seconds = (double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec);
    CHECK(s == NULL && seconds < 2 * o.time_limit + 1);
    check_reports(name, path);
    CHECK(memory_live_bytes() == before);
}

static void test_wrong(void) {
    CHECK(for_each_case(WRONG, run_wrong) >= LEAST_CASES);
}

/* What a simulation would do: the grip's velocity at every step. */
static void run_wrong_later(const char *name, const char *path) {
    script_options o = limits(path);
    script *s;
    size_t before = memory_live_bytes();
    CHECK(script_load(path, &o, &s, &reports) == STATUS_OK && s);
    if (!s) return;
    const scene *sc = script_scene(s);
    status code = STATUS_OK;
    double v[3], t = 0;
    for (; code == STATUS_OK && t < sc->duration; t += 1e-3)
        code = scene_function_evaluate(&sc->grips[0].velocity, &t, 1, v, &reports.items[0]);
    CHECK(code == STATUS_INPUT && t > 0.4 && t < 0.41);
    reports.count = 1;
    check_reports(name, path);
    /* A script that was stopped stays stopped; one that failed once may be asked again. */
    double early = 0.1;
    code = scene_function_evaluate(&sc->grips[0].velocity, &early, 1, v, &reports.items[0]);
    CHECK((code == STATUS_OK) == !strstr(name, "loops"));
    script_close(s);
    CHECK(memory_live_bytes() == before);
}

static void test_wrong_running(void) {
    CHECK(for_each_case(WRONG_RUNNING, run_wrong_later) >= 5);
}

static void test_missing_file(void) {
    script_options o = script_options_default();
    script *s;
    CHECK(script_load(WRONG "/01_mispelt_scene_key.lua", &o, &s, &reports) == STATUS_INPUT);
    CHECK(strstr(reports.items[0].nearest, "/01_misspelt_scene_key.lua") != NULL);
    CHECK(script_load(WRONG, &o, &s, &reports) == STATUS_INPUT);
    CHECK(strcmp(reports.items[0].found, "a folder") == 0);
    CHECK(script_load("/dev/zero", &o, &s, &reports) == STATUS_INPUT);
}

int main(void) {
    RUN(test_wrong);
    RUN(test_wrong_running);
    RUN(test_missing_file);
    return check_finish();
}
