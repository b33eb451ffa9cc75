/* sunder mesh: the surface of a run's body as a triangle mesh, a frame or all of them. */
#include "base/json.h"
#include "base/memory.h"
#include "cli/runs.h"
#include "session/player.h"
#include "store/export.h"
#include "store/frames.h"
#include "view/surface.h"

#include <getopt.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

typedef struct mesh_command {
    const char *run, *database, *out, *field;
    long frame; /* −1: the last */
    bool all, json, intact;
    double cell, spacing;
    int64_t written, vertices, triangles;
    record_list first; /* of tetrahedra: frame 0's */
} mesh_command;

enum { OPTION_FRAME = 256, OPTION_ALL, OPTION_OUT, OPTION_CELL, OPTION_SPACING, OPTION_FIELD, OPTION_INTACT, OPTION_DB, OPTION_JSON };

static const struct option long_options[] = {
    {"frame", required_argument, NULL, OPTION_FRAME}, {"all", no_argument, NULL, OPTION_ALL},                 {"out", required_argument, NULL, OPTION_OUT},
    {"cell", required_argument, NULL, OPTION_CELL},   {"spacing", required_argument, NULL, OPTION_SPACING},   {"field", required_argument, NULL, OPTION_FIELD},
    {"intact", no_argument, NULL, OPTION_INTACT},     {"db", required_argument, NULL, OPTION_DB},             {"json", no_argument, NULL, OPTION_JSON},
    {NULL, 0, NULL, 0}};

static int parse_length(const char *option, double *value) {
    char *end;
    *value = strtod(optarg, &end);
    return end != optarg && !*end && *value > 0 && *value < 1e30 ? 0 : cli_usage("mesh", "%s %s: expected a length above 0", option, optarg);
}

static int parse(mesh_command *c, int count, char **arguments) {
    int option, code = 0;
    while (code == 0 && (option = getopt_long(count, arguments, "", long_options, NULL)) != -1) {
        switch (option) {
        case OPTION_FRAME: code = cli_number("mesh", "--frame", optarg, 0, 1000000000, &c->frame); break;
        case OPTION_ALL: c->all = true; break;
        case OPTION_OUT: c->out = optarg; break;
        case OPTION_CELL: code = parse_length("--cell", &c->cell); break;
        case OPTION_SPACING: code = parse_length("--spacing", &c->spacing); break;
        case OPTION_FIELD: c->field = optarg; break;
        case OPTION_INTACT: c->intact = true; break;
        case OPTION_DB: c->database = optarg; break;
        case OPTION_JSON: c->json = true; break;
        default: return cli_usage("mesh", "wrong option");
        }
    }
    if (code) return code;
    if (optind != count - 1) return cli_usage("mesh", "expected one run (an id, its beginning or end, or last)");
    c->run = arguments[optind];
    size_t length = strlen(c->out);
    if (c->field && (length < 4 || strcmp(c->out + length - 4, ".ply") != 0))
        return cli_usage("mesh", "--field %s: expected a .ply for --out, which can hold a quantity, found '%s'", c->field, c->out);
    return 0;
}

/* ---- one frame --------------------------------------------------------------------------------------------------- */

/* Particles that are broken for good are left out, so that a crack is open: [kept]. */
static int64_t drop_broken(const frame_view *damage, float *position, float *value) {
    int64_t kept = 0;
    for (int64_t i = 0; i < damage->count; i++) {
        if (damage->value[i] >= 0.9F) continue;
        memcpy(position + 3 * kept, damage->position + 3 * i, 3 * sizeof *position);
        value[kept++] = damage->value[i];
    }
    return kept;
}

static status intact_surface(const mesh_command *c, frame_player *player, int64_t frame, view_surface *out, report *r) {
    frame_view view;
    view_surface_options o = {.cell = (float)c->cell, .spacing = (float)c->spacing};
    status code = frame_player_read(player, frame, "damage", &view, r);
    if (code != STATUS_OK) return code;
    size_t n = (size_t)view.count;
    float *position = memory_allocate_array(n, 3 * sizeof *position), *value = memory_allocate_array(n, sizeof *value);
    if (position && value) code = view_surface_make(position, value, drop_broken(&view, position, value), &o, out, r);
    else code = report_set(r, STATUS_SYSTEM, "out of memory for a surface");
    memory_free(position, n * 3 * sizeof *position);
    memory_free(value, n * sizeof *value);
    return code;
}

static status make_surface(const mesh_command *c, frame_player *player, int64_t frame, view_surface *out, report *r) {
    frame_view view;
    const record *corners = record_find(&c->first, "solid/tetrahedra");
    view_surface_options o = {.cell = (float)c->cell, .spacing = (float)c->spacing};
    if (c->intact && !corners) return intact_surface(c, player, frame, out, r);
    status code = frame_player_read(player, frame, c->field, &view, r);
    if (code != STATUS_OK) return code;
    if (corners) return view_surface_tetrahedra(view.position, view.value, view.count, corners->data, corners->count, out, r);
    return view_surface_make(view.position, view.value, view.count, &o, out, r);
}

static status write_frame(mesh_command *c, frame_player *player, int64_t frame, const char *path, report *r) {
    view_surface surface = {0};
    status code = make_surface(c, player, frame, &surface, r);
    if (code == STATUS_OK && surface.triangle_count == 0 && !c->intact)
        code = report_input(r, NULL, 0, c->cell > 0 ? "--cell" : "--spacing", "a length that is small beside the body", "one that gives it no surface", NULL);
    export_mesh out = {.vertex_count = surface.vertex_count, .triangle_count = surface.triangle_count, .vertex = surface.vertex,
                        .value = c->field || c->intact ? surface.value : NULL, .value_name = c->field ? c->field : "damage", .triangle = surface.triangle};
    if (code == STATUS_OK) code = export_mesh_write(path, &out, r);
    c->written++;
    c->vertices = surface.vertex_count;
    c->triangles = surface.triangle_count;
    view_surface_free(&surface);
    if (code == STATUS_OK && !c->json)
        fprintf(stderr, "%s: frame %" PRId64 ", %" PRId64 " vertices, %" PRId64 " triangles\n", path, frame, c->vertices, c->triangles);
    return code;
}

/* ---- the command ------------------------------------------------------------------------------------------------- */

static status write_all(mesh_command *c, frame_player *player, report *r) {
    char path[1024];
    status code = STATUS_OK;
    if (!c->all) {
        int64_t last = frame_player_number(player, frame_player_count(player) - 1);
        return write_frame(c, player, c->frame < 0 ? last : c->frame, c->out, r);
    }
    for (int i = 0; i < frame_player_count(player) && code == STATUS_OK; i++) {
        int64_t frame = frame_player_number(player, i);
        code = export_sequence_path(c->out, frame, path, r);
        if (code == STATUS_OK) code = write_frame(c, player, frame, path, r);
    }
    return code;
}

static status print_json(const mesh_command *c, const char *id, report *r) {
    json_writer w;
    json_begin(&w, 0);
    json_object(&w);
    json_member_string(&w, "run_id", id);
    json_member_string(&w, "out", c->out);
    json_member_integer(&w, "frames", c->written);
    json_member_integer(&w, "vertices", c->vertices);
    json_member_integer(&w, "triangles", c->triangles);
    json_object_end(&w);
    return cli_print_json(&w, r);
}

/* Tetrahedra have a surface of their own; frame 0 says which vertices are their corners. */
static status find_tetrahedra(mesh_command *c, const char *folder, report *r) {
    static const char *const names[] = {"solid/tetrahedra"};
    double time;
    int64_t step;
    return frame_exists(folder, 0) ? frame_read_named(folder, 0, names, 1, &c->first, &time, &step, r) : STATUS_OK;
}

int command_mesh(int count, char **arguments) {
    static mesh_command c = {.frame = -1, .out = "sunder.ply"};
    char id[LEDGER_ID], folder[1024], path[1024];
    report r;
    ledger *l;
    frame_player *player = NULL;
    int result = parse(&c, count, arguments);
    if (result) return result;
    status code = ledger_open_past(c.database, path, sizeof path, &l, &r);
    if (code == STATUS_OK) code = runs_find(l, c.run, id, folder, &r);
    if (l) ledger_close(l);
    if (code == STATUS_OK) code = frame_player_open(folder, 0, &player, &r);
    if (code == STATUS_OK) code = find_tetrahedra(&c, folder, &r);
    if (code == STATUS_OK) code = write_all(&c, player, &r);
    if (code == STATUS_OK && c.json) code = print_json(&c, id, &r);
    record_clear(&c.first);
    frame_player_close(player);
    return code == STATUS_OK ? 0 : cli_fail(&r);
}
