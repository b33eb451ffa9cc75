/* sunder check: validate a scene, say everything that is wrong. */
#include "cli/cli.h"

#include "base/json.h"

#include <getopt.h>

static const struct option long_options[] = {
    {"set", required_argument, NULL, 's'}, {"recipe", required_argument, NULL, 'r'}, {"json", no_argument, NULL, 'j'}, {NULL, 0, NULL, 0}};

/* What is no error, but may not be what was meant. */
static const char *find_note(script *s) {
    const scene *from = s ? script_scene(s) : NULL;
    bool apart = from && from->body_count > 0 && from->sheet_count > 0 && !from->effects[effect_index("contact")].on;
    return apart ? NOTE_NO_CONTACT : NULL;
}

static void print_json(const script_reports *reports, const char *note) {
    json_writer w;
    report r;
    json_begin(&w, 2);
    json_object(&w);
    json_member_boolean(&w, "ok", reports->count == 0);
    json_member_array(&w, "errors");
    for (int i = 0; i < reports->count; i++) {
        const report *e = &reports->items[i];
        char text[1600];
        report_format(e, text, sizeof text);
        json_object(&w);
        json_member_string(&w, "file", e->file[0] ? e->file : NULL);
        json_key(&w, "line");
        if (e->line > 0) json_integer(&w, e->line);
        else json_null(&w);
        json_member_string(&w, "key", e->key[0] ? e->key : NULL);
        json_member_string(&w, "expected", e->expected[0] ? e->expected : NULL);
        json_member_string(&w, "found", e->found[0] ? e->found : NULL);
        json_member_string(&w, "nearest", e->nearest[0] ? e->nearest : NULL);
        json_member_string(&w, "message", text);
        json_object_end(&w);
    }
    json_array_end(&w);
    json_member_array(&w, "notes");
    if (note) json_string(&w, note);
    json_array_end(&w);
    json_object_end(&w);
    if (cli_print_json(&w, &r) != STATUS_OK) (void)cli_fail(&r);
}

int command_check(int count, char **arguments) {
    static cli_scene_options o;
    static script_reports reports;
    bool json = false;
    int option, code = 0;
    while ((option = getopt_long(count, arguments, "", long_options, NULL)) != -1) {
        if (option == 's') code = cli_add_setting(&o, "check", optarg);
        else if (option == 'r') o.recipe = optarg;
        else if (option == 'j') json = true;
        else return cli_usage("check", "wrong option");
        if (code) return code;
    }
    if (optind != count - 1) return cli_usage("check", "expected one scene");
    script_options options = script_options_default();
    options.recipe = o.recipe;
    options.settings = o.settings;
    options.setting_count = o.setting_count;
    script *s = NULL;
    status result = script_load(arguments[optind], &options, &s, &reports);
    const char *note = result == STATUS_OK ? find_note(s) : NULL;
    if (json) print_json(&reports, note);
    else if (result == STATUS_OK) printf("%s: ok\n%s%s%s", arguments[optind], note ? "note: " : "", note ? note : "", note ? "\n" : "");
    else (void)cli_fail_script(&reports);
    if (s) script_close(s);
    return status_exit_code(result);
}
