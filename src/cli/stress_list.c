#include "cli/stress_list.h"

#include "base/json.h"
#include "cli/cli.h"

#include <stdio.h>
#include <string.h>

static const char *engine_word(const effect *e) {
    return e->scope == SCOPE_SCENE ? "scene" : e->engine == ENGINE_SOLID ? "solid" : "sheet";
}

static void print_effect(const stress_suite *s, const effect *e, int index, bool markdown) {
    int found = stress_coverage(s, index), shown = 0;
    enum { SHOWN = 6 };
    printf(markdown ? "| `%s` | %s | %d | " : "  %-14s %-6s %4d  ", e->name, engine_word(e), found);
    for (int i = 0; i < s->count && shown < SHOWN; i++)
        if (s->cases[i].effects >> index & 1) printf("%s%s", shown++ ? ", " : "", s->cases[i].name);
    if (found > SHOWN) printf(", ...");
    if (found == 0) printf("NO CASE");
    puts(markdown ? " |" : "");
}

/* What a file is about stands once, beside its first case. */
static void print_case(const stress_case *c, const stress_case *before, bool markdown) {
    int count;
    const effect *const *all = effect_catalogue(&count);
    bool first = !before || strcmp(before->scene, c->scene) != 0;
    const char *about = !first ? "" : c->remark[0] ? c->remark : c->title;
    printf(markdown ? "| `%s` | %s | " : "  %-28s %s\n%32s", c->name, about, "");
    for (int e = 0, shown = 0; e < count; e++)
        if (c->effects >> e & 1) printf("%s%s", shown++ ? ", " : "", all[e]->name);
    if (c->hard.stop[0]) printf(markdown ? " | stops: \"%s\"" : "; stops: \"%s\"", c->hard.stop);
    else if (c->hard.known_limit[0]) printf(markdown ? " | known limit: %s" : "; known limit: %s", c->hard.known_limit);
    else if (markdown) {
        printf(" | ");
        for (int i = 0; i < c->hard.count; i++) printf("%s%s", i ? ", " : "", hard_measure_at(c->hard.items[i].measure)->key);
        if (c->like >= 0) printf("%ssame as %s", c->hard.count ? ", " : "", c->hard.same_as.variant);
    }
    puts(markdown ? " |" : "");
}

static int print_json(const stress_suite *s) {
    int count, missing = 0;
    const effect *const *all = effect_catalogue(&count);
    json_writer w;
    report r;
    json_begin(&w, 2);
    json_object(&w);
    json_member_array(&w, "coverage");
    for (int e = 0; e < count; e++) {
        missing += stress_coverage(s, e) == 0;
        json_object(&w);
        json_member_string(&w, "effect", all[e]->name);
        json_member_string(&w, "engine", engine_word(all[e]));
        json_member_array(&w, "cases");
        for (int i = 0; i < s->count; i++)
            if (s->cases[i].effects >> e & 1) json_string(&w, s->cases[i].name);
        json_array_end(&w);
        json_object_end(&w);
    }
    json_array_end(&w);
    json_member_array(&w, "cases");
    for (int i = 0; i < s->count; i++) {
        json_object(&w);
        json_member_string(&w, "case", s->cases[i].name);
        json_member_string(&w, "title", s->cases[i].title);
        json_member_string(&w, "scene", s->cases[i].scene);
        json_object_end(&w);
    }
    json_array_end(&w);
    json_object_end(&w);
    return cli_print_json(&w, &r) != STATUS_OK ? cli_fail(&r) : missing > 0;
}

int stress_print_list(const stress_suite *s, bool json, bool markdown) {
    int count, missing = 0;
    const effect *const *all = effect_catalogue(&count);
    if (json) return print_json(s);
    puts(markdown ? "# The hard cases\n\nMade by `sunder stress --list --markdown`; what it is for is in [stress.md](stress.md).\n\n## Effects and the cases that have them on\n\n"
                    "| effect | of | cases | |\n|---|---|---|---|"
                  : "Effects and the cases that have them on");
    for (int e = 0; e < count; e++) {
        print_effect(s, all[e], e, markdown);
        missing += stress_coverage(s, e) == 0;
    }
    puts(markdown ? "\n## Cases\n\n| case | | effects | held against |\n|---|---|---|---|" : "\nCases");
    for (int i = 0; i < s->count; i++) print_case(&s->cases[i], i > 0 ? &s->cases[i - 1] : NULL, markdown);
    if (missing > 0) fprintf(stderr, "sunder: %d effects have no hard case: write scenes/stress/NAME.lua\n", missing);
    return missing > 0;
}

int stress_print_measures(bool markdown) {
    if (markdown) puts("| measure | unit | a bare number is | |\n|---|---|---|---|");
    for (int i = 0; i < HARD_MEASURE_COUNT; i++) {
        const hard_measure_row *m = hard_measure_at(i);
        printf(markdown ? "| `%s` | %s | %s | %s |\n" : "%-18s %-12s %-9s %s\n", m->key, m->unit, m->sense == HARD_AT_MOST ? "at most" : "at least", m->doc);
    }
    return 0;
}
