/* sunder explain: the plan of a scene, before it costs anything. */
#include "cli/cli.h"

#include "base/json.h"
#include "sim/simulation.h"

#include <getopt.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

static const struct option long_options[] = {
    {"set", required_argument, NULL, 's'},     {"recipe", required_argument, NULL, 'r'}, {"json", no_argument, NULL, 'j'},
    {"precision", required_argument, NULL, 'p'}, {"threads", required_argument, NULL, 't'}, {NULL, 0, NULL, 0}};

/* How the steps just taken were divided, where the scene asks for that; false: it does not. */
static bool find_rates(const simulation *s, sheet_rates *out) {
    int count;
    sheet *state;
    const sheet_engine *engine = simulation_sheet_engine(s, &state);
    const effect *const *effects = effect_catalogue(&count);
    for (int e = 0; e < count && engine; e++)
        if (effects[e]->engine == ENGINE_SHEET && strcmp(effects[e]->name, "multirate") == 0 && (simulation_get_plan(s)->mask >> e & 1)) {
            engine->rates(state, out);
            return true;
        }
    return false;
}

/* Of the bond updates that one short step for all would take. */
static double rate_share(const sheet_rates *rates) {
    double parts = 0, particles = 0;
    for (int l = 0; l < rates->levels; l++) {
        particles += (double)rates->particles[l];
        parts += (double)rates->particles[l] * ldexp(1, l);
    }
    return parts / (particles * ldexp(1, rates->levels - 1));
}

static void print_rates(const simulation *s) {
    sheet_rates rates;
    if (!find_rates(s, &rates)) return;
    printf("    multirate      ");
    for (int l = 0; l < rates.levels; l++) printf("%s%lld particles by 1/%d", l ? ", " : "", (long long)rates.particles[l], 1 << l);
    printf(" of a step: %.0f %% of the updates of one short step\n", 100 * rate_share(&rates));
}

static void print_text(const simulation *state, const scene *s, const simulation_cost *c) {
    const simulation_plan *p = simulation_get_plan(state);
    printf("%s\n\n", s->title[0] ? s->title : s->file);
    printf("  particles  %lld  spacing %.4g  dx %.4g  f%d %s, %d threads\n", (long long)p->particles, p->spacing, p->dx, p->precision,
           p->simd, p->threads);
    if (p->tetrahedra) printf("  elements   %lld tetrahedra, of which the particles are the vertices; there is no grid\n", (long long)p->tetrahedra);
    printf("  bodies     ");
    for (int b = 0; b < s->body_count; b++) {
        char text[160];
        shape_describe(s->bodies[b].shape, text, sizeof text);
        printf("%s%s of %s\n", b ? "             " : "", text, s->materials[s->bodies[b].material].name);
    }
    for (int b = 0; b < s->sheet_count; b++) {
        char text[160];
        shape_describe(s->sheets[b].region.shape, text, sizeof text);
        printf("%ssheet of %s, %s, thickness %.4g\n", b + s->body_count ? "             " : "", text, s->materials[s->sheets[b].material].name, s->sheets[b].thickness);
    }
    if (p->solid && p->sheet && !s->effects[effect_index("contact")].on) printf("             %s\n", NOTE_NO_CONTACT);
    puts("\n  effects");
    for (int e = 0; e < p->effect_count; e++)
        if (simulation_concerns(p, e)) printf("    %-3s %-14s %s\n", p->mask >> e & 1 ? "on" : "off", p->effects[e]->name, p->effects[e]->doc);
    puts("\n  fields, bytes a particle");
    for (int i = 0; i < p->field_count; i++) printf("    %5.0f  %-22s %s\n", p->fields[i].bytes, p->fields[i].name, p->fields[i].effect);
    printf("    %5.0f  with grid, padding and sort buffers\n", p->bytes_per_particle);
    puts("\n  step limits");
    for (int e = 0; e < p->effect_count; e++)
        if (isfinite(p->limits[e])) printf("    %-14s %.4g\n", p->effects[e]->name, p->limits[e]);
    printf("    dt             %.4g%s\n", p->dt, s->dt > 0 ? " (fixed by the scene)" : "");
    print_rates(state);
    printf("\n  cost       %lld frames, about %.0f steps of %.2f ms: %.0f s\n", (long long)scene_frames(s), c->steps, 1e3 * c->seconds_per_step,
           c->seconds);
}

static void json_names(json_writer *w, const char *key, const simulation_plan *p, uint32_t mask) {
    json_member_array(w, key);
    for (int e = 0; e < p->effect_count; e++)
        if ((mask >> e & 1) && simulation_concerns(p, e)) json_string(w, p->effects[e]->name);
    json_array_end(w);
}

static void json_rates(json_writer *w, const simulation *s) {
    sheet_rates rates;
    json_key(w, "multirate");
    if (!find_rates(s, &rates)) {
        json_null(w);
        return;
    }
    json_object(w);
    json_member_array(w, "particles_by_level");
    for (int l = 0; l < rates.levels; l++) json_integer(w, rates.particles[l]);
    json_array_end(w);
    json_member_number(w, "share_of_updates", rate_share(&rates));
    json_object_end(w);
}

static void print_json(const simulation *state, const scene *s, const simulation_cost *c) {
    const simulation_plan *p = simulation_get_plan(state);
    json_writer w;
    report r;
    json_begin(&w, 2);
    json_object(&w);
    json_member_string(&w, "scene", s->file);
    json_member_string(&w, "title", s->title);
    json_names(&w, "effects_on", p, p->mask);
    json_names(&w, "effects_off", p, ~p->mask);
    json_member_array(&w, "fields");
    for (int i = 0; i < p->field_count; i++) {
        json_object(&w);
        json_member_string(&w, "name", p->fields[i].name);
        json_member_number(&w, "bytes", p->fields[i].bytes);
        json_member_string(&w, "effect", p->fields[i].effect);
        json_object_end(&w);
    }
    json_array_end(&w);
    json_member_number(&w, "bytes_per_particle", p->bytes_per_particle);
    json_member_array(&w, "stages");
    char stages[32][48];
    int count = simulation_stages(p, stages, 32);
    for (int i = 0; i < count; i++) json_string(&w, stages[i]);
    json_array_end(&w);
    json_member_object(&w, "step_limits");
    for (int e = 0; e < p->effect_count; e++)
        if (isfinite(p->limits[e])) json_member_number(&w, p->effects[e]->name, p->limits[e]);
    json_object_end(&w);
    json_member_number(&w, "dt", p->dt);
    json_rates(&w, state);
    json_member_number(&w, "dx", p->dx);
    json_member_integer(&w, "particles", p->particles);
    json_member_integer(&w, "tetrahedra", p->tetrahedra);
    json_member_number(&w, "predicted_steps", c->steps);
    json_member_number(&w, "predicted_seconds", c->seconds);
    json_object_end(&w);
    if (cli_print_json(&w, &r) != STATUS_OK) (void)cli_fail(&r);
}

static int explain(const char *path, const script_options *options, const simulation_options *engine, bool json) {
    static script_reports reports;
    script *s = NULL;
    if (script_load(path, options, &s, &reports) != STATUS_OK) return cli_fail_script(&reports);
    report r;
    simulation *simulation_state = NULL;
    simulation_cost c = {0};
    status code = simulation_create(script_scene(s), engine, &simulation_state, &r);
    if (code == STATUS_OK) code = simulation_measure_cost(simulation_state, script_scene(s), 0.5, &c, &r);
    if (code == STATUS_OK) (json ? print_json : print_text)(simulation_state, script_scene(s), &c);
    int exit_code = code == STATUS_OK ? 0 : cli_fail(&r);
    simulation_destroy(simulation_state);
    script_close(s);
    return exit_code;
}

int command_explain(int count, char **arguments) {
    static cli_scene_options o;
    simulation_options engine = {.precision = 32, .simd = "auto"};
    bool json = false;
    int option, code = 0;
    long value;
    while ((option = getopt_long(count, arguments, "", long_options, NULL)) != -1) {
        if (option == 's') code = cli_add_setting(&o, "explain", optarg);
        else if (option == 'r') o.recipe = optarg;
        else if (option == 'j') json = true;
        else if (option == 'p' && strcmp(optarg, "f64") == 0) engine.precision = 64;
        else if (option == 'p' && strcmp(optarg, "f32") == 0) engine.precision = 32;
        else if (option == 'p') return cli_usage("explain", "--precision %s: expected f32 or f64", optarg);
        else if (option == 't') {
            code = cli_number("explain", "--threads", optarg, 1, 256, &value);
            engine.threads = (int)value;
        } else return cli_usage("explain", "wrong option");
        if (code) return code;
    }
    if (optind != count - 1) return cli_usage("explain", "expected one scene");
    script_options options = script_options_default();
    options.recipe = o.recipe;
    options.settings = o.settings;
    options.setting_count = o.setting_count;
    return explain(arguments[optind], &options, &engine, json);
}
