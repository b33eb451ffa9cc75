/* sunder help: the commands; sunder help effects: the reference of all effects, made from their tables. */
#include "cli/cli.h"

#include "base/json.h"
#include "sim/scene.h"
#include "tui/actions.h"

#include <math.h>
#include <string.h>

static void print_value(const parameter *p, double value) {
    if (p->kind == PARAMETER_CHOICE) printf("%s", p->choices[(int)value]);
    else if (p->kind == PARAMETER_BOOLEAN) printf("%s", value != 0 ? "true" : "false");
    else printf("%g", value);
}

static void print_default(const parameter *p) {
    if (p->required && !p->twin) {
        printf("required");
    } else if (p->required || p->twin) {
        printf("this or `%s`", p->twin);
    } else if (p->kind == PARAMETER_VECTOR) {
        printf("{%g, %g, %g}", p->fallback[0], p->fallback[1], p->fallback[2]);
    } else {
        print_value(p, p->fallback[0]);
    }
}

static void print_range(const parameter *p) {
    if (p->kind == PARAMETER_CHOICE) {
        for (int i = 0; p->choices[i]; i++) printf("%s%s", i ? ", " : "", p->choices[i]);
    } else if (p->kind == PARAMETER_BOOLEAN) {
        printf("true, false");
    } else {
        printf("%g … %g", p->minimum, p->maximum);
    }
}

static void print_parameters(const effect *e) {
    puts("| key | unit | default | range | live | |\n|---|---|---|---|---|---|");
    for (int i = 0; i < e->parameter_count; i++) {
        const parameter *p = &e->parameters[i];
        printf("| `%s` | %s | ", p->key, p->unit);
        print_default(p);
        printf(" | ");
        print_range(p);
        printf(" | %s%s | %s |\n", p->live ? "yes" : "no: ", p->live ? "" : p->why_not, p->doc);
    }
    putchar('\n');
}

/* What `sunder accuracy` makes axes of. */
static void print_axes(const effect *e) {
    bool any = false;
    for (int i = 0; i < e->parameter_count; i++) {
        const parameter *p = &e->parameters[i];
        const accuracy_rule *a = &p->accuracy;
        if (a->kind == ACCURACY_NONE) continue;
        printf("%s`%s` (", any ? ", " : "Trades accuracy for time: ", p->key);
        if (a->kind == ACCURACY_FACTOR) printf("finer: times %g", a->finer);
        else if (a->kind == ACCURACY_DIFFERENCE) printf("finer: %+g", a->finer);
        else printf("finest: %s", p->choices[a->finer > 0 ? (int)p->maximum : 0]);
        putchar(')');
        any = true;
    }
    if (any) puts(".\n");
}

static void print_effect(const effect *e) {
    bool shared = effect_index_of(ENGINE_SOLID, e->name) >= 0 && effect_index_of(ENGINE_SHEET, e->name) >= 0;
    printf("## %s%s\n\n%s. %s; %s.\n\n", e->name, !shared ? "" : e->engine == ENGINE_SHEET ? " (sheets)" : " (solids)", e->doc,
           e->scope == SCOPE_MATERIAL ? "Of a material" : "Of the scene", e->reference);
    if (e->needs) printf("Needs: %s.\n\n", e->needs);
    if (e->provides) printf("Provides: %s; a material has at most one effect that does.\n\n", e->provides);
    if (e->parameter_count > 0) print_parameters(e);
    print_axes(e);
    if (e->field_count > 0) puts("| field | components | unit | in frames | |\n|---|---|---|---|---|");
    for (int i = 0; i < e->field_count; i++) {
        const effect_field *f = &e->fields[i];
        printf("| `%s` | %d | %s | %s | %s |\n", f->key, f->components, f->unit, f->written ? "yes" : "no", f->doc);
    }
    if (e->field_count > 0) putchar('\n');
}

static int print_effects(void) {
    int count;
    const effect *const *effects = effect_catalogue(&count);
    puts("# Effects\n\nMade by `sunder help effects` from the effects' own tables. Naming an effect in a material or a scene turns it on;\n"
         "one that nobody names takes no memory and no time.\n");
    for (int i = 0; i < count; i++) print_effect(effects[i]);
    return 0;
}

/* ---- the workbench's actions -------------------------------------------------------------------------------------- */

static void print_action(const char *name, const tui_action *a) {
    printf("| `%s`%s%s | %s | %s |\n", name, a->asks ? " " : "", a->asks ? a->asks : "", a->keys_shown ? a->keys_shown : "", a->help);
}

static void json_action(json_writer *w, const char *name, const action_place *place) {
    const tui_action *a = place->action;
    json_object(w);
    json_member_string(w, "name", name);
    json_member_string(w, "screen", place->screen ? place->screen->name : NULL);
    json_member_string(w, "keys", a->keys_shown);
    json_member_string(w, "argument", a->asks);
    json_member_boolean(w, "needs_argument", a->argument >= ARGUMENT_TEXT);
    json_member_boolean(w, "logged", !a->unlogged);
    json_member_string(w, "help", a->help);
    json_object_end(w);
}

static int print_actions(bool json) {
    json_writer w;
    report r;
    action_place place;
    json_begin(&w, 2);
    json_array(&w);
    if (!json) puts("# What the workbench can do\n\nMade by `sunder help actions`. Type `:` and a name, or press the key; `config.lua` binds others.\n\n| action | keys | |\n|---|---|---|");
    for (int i = 0; actions_at(i, &place); i++) {
        char name[128];
        action_name(&place, name, sizeof name);
        if (json) json_action(&w, name, &place);
        else print_action(name, place.action);
    }
    json_array_end(&w);
    status code = json_finish(&w, &r);
    if (json && code == STATUS_OK) puts(w.text);
    json_free(&w);
    return code == STATUS_OK ? 0 : cli_fail(&r);
}

int command_help(int count, char **arguments) {
    if (count == 2 && strcmp(arguments[1], "effects") == 0) return print_effects();
    if (count >= 2 && strcmp(arguments[1], "actions") == 0 && (count == 2 || (count == 3 && strcmp(arguments[2], "--json") == 0)))
        return print_actions(count == 3);
    if (count == 2) return cli_help_of(arguments[1]);
    if (count > 2) return cli_usage("help", "expected nothing, a command, 'effects', or 'actions' and perhaps --json");
    int commands;
    const command *table = command_table(&commands);
    puts("sunder: a terminal workbench for tearing things\n\n  sunder [--db FILE]\n      open the workbench\n"
         "  sunder --replay FILE [--db FILE] [--out DIR]\n      do a workbench's command log again, to the same bits; no terminal needed");
    for (int i = 0; i < commands; i++) printf("  sunder %s\n      %s\n", table[i].usage, table[i].help);
    puts("\nExit codes: 0 done; 1 the simulation failed; 2 the input is wrong; 130 interrupted.");
    return 0;
}
