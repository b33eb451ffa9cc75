#include "script/internal.h"
#include "script/sweep.h"

#include "base/memory.h"

#include <stdio.h>
#include <string.h>

script_options script_options_default(void) {
    return (script_options){.time_limit = 5, .memory_limit = (size_t)512 << 20};
}

typedef struct load_request {
    const char *path;
    const script_options *options;
} load_request;

/* Leaves the function of a file's chunk on the stack. */
static const source_file *push_chunk(lua_State *L, const char *path) {
    scene *sc = script_of(L)->scene;
    luaL_checkstack(L, 4 * API_STACK, "loading"); /* reading nests deep, and all of it in this one frame */
    sandbox_open(L);
    const source_file *file = load_scene_file(L, path);
    snprintf(sc->file, sizeof sc->file, "%s", file->display);
    return file;
}

/* Everything that runs Lua or reads its values; in protected mode. */
static int load_protected(lua_State *L) {
    const load_request *q = lua_touserdata(L, 1);
    script *s = script_of(L);
    const source_file *file = push_chunk(L, q->path);
    overrides_prepare(L, q->options);
    lua_call(L, 0, 1);
    read_scene(L, file->display);
    settings_apply(s);
    check_effects(s);
    purity_freeze(L);
    s->loaded = true;
    return 0;
}

/* Calls a function with one pointer; what goes wrong is recorded. */
static void run_protected(script *s, lua_CFunction call, void *request) {
    lua_State *L = s->L;
    guard_begin(&s->guard);
    lua_pushcfunction(L, error_handler);
    lua_pushcfunction(L, call);
    lua_pushlightuserdata(L, request);
    int outcome = lua_pcall(L, 1, 0, 1);
    report r;
    if (outcome != LUA_OK && error_take(s, outcome, &r) != STATUS_OK) problem_report(s, &r);
    lua_settop(L, 0);
}

/* The simulation's own checks know the scene, not the file: the line is found here. */
static void place_validation(script *s, report *r) {
    if (r->code != STATUS_INPUT || r->line > 0) return;
    if (!r->file[0]) snprintf(r->file, sizeof r->file, "%s", s->scene->file);
    place p = {.file = s->sources[0].display, .line = s->scene_line, .call = "scene"};
    for (int i = 0; i < s->scene->body_count; i++) {
        char name[80];
        snprintf(name, sizeof name, "body '%s'", s->scene->bodies[i].name);
        if (strstr(r->found, name)) p = s->body_places[i];
    }
    for (int i = 0; i < s->scene->sheet_count; i++) {
        char name[80];
        snprintf(name, sizeof name, "sheet '%s'", s->scene->sheets[i].name);
        if (strstr(r->found, name)) p = s->sheet_places[i];
    }
    p = place_key(&p, r->key);
    r->line = place_line(s, &p);
}

/* What follows reading: each step only if all was well so far. */
static void finish_loading(script *s) {
    report r;
    scene *sc = s->scene;
    bool spaced = sc->sheet_count > 0;
    for (int i = 0; i < sc->sheet_count; i++) spaced = spaced && sc->sheets[i].spacing > 0;
    if (s->problem_count == 0 && sc->particles == 0 && sc->dx == 0 && !spaced) {
        place p = {
            .file = sc->file, .line = s->scene_line, .call = "scene", .depth = 1, .path = {{.key = "particles"}}};
        problem_place(s, &p, "particles = a number of particles (or a grid spacing dx)", "nothing", NULL);
    }
    if (s->problem_count == 0) try_functions(s);
    if (s->problem_count == 0 && scene_validate(sc, &r) != STATUS_OK) {
        place_validation(s, &r);
        problem_report(s, &r);
    }
    if (s->problem_count == 0 && resolve_parameters(s, &r) != STATUS_OK) problem_report(s, &r);
}

static int source_rank(const script *s, const report *r) {
    for (int i = 0; i < s->source_count; i++)
        if (strncmp(s->sources[i].display, r->file, sizeof r->file - 1) == 0) return i;
    return s->source_count;
}

/* By file, in the order in which files were read, and line; what is equal keeps its order. */
static void sort_reports(const script *s, script_reports *reports) {
    for (int i = 1; i < reports->count; i++) {
        report moving = reports->items[i];
        int at = i, rank = source_rank(s, &moving);
        for (; at > 0; at--) {
            const report *before = &reports->items[at - 1];
            int other = source_rank(s, before);
            if (other < rank || (other == rank && before->line <= moving.line)) break;
            reports->items[at] = *before;
        }
        reports->items[at] = moving;
    }
}

script *script_create(const script_options *options, script_reports *reports) {
    script *s = memory_allocate(sizeof *s);
    if (!s) return NULL;
    s->reports = reports;
    s->recipe = options->recipe;
    s->guard.time_limit = options->time_limit;
    s->guard.memory_limit = options->memory_limit;
    s->memory = arena_create("script");
    s->scene = scene_create();
    s->L = s->memory && s->scene ? lua_newstate(guard_allocate, &s->guard) : NULL;
    if (s->L) {
        guard_arm(&s->guard, s->L);
        return s;
    }
    script_close(s);
    return NULL;
}

status script_load(const char *path, const script_options *options, script **out, script_reports *reports) {
    *out = NULL;
    reports->count = 0;
    script *s = script_create(options, reports);
    if (!s) {
        reports->count = 1;
        return report_set(&reports->items[0], STATUS_SYSTEM, "out of memory while %s was loaded", path);
    }
    load_request q = {path, options};
    run_protected(s, load_protected, &q);
    finish_loading(s);
    s->reports = NULL;
    if (s->problem_count == 0) {
        *out = s;
        return STATUS_OK;
    }
    sort_reports(s, reports);
    script_close(s);
    return reports->items[0].code;
}

typedef struct file_request {
    const char *path;
    script_reader *read;
    void *out;
} file_request;

static int load_file_protected(lua_State *L) {
    const file_request *q = lua_touserdata(L, 1);
    const source_file *file = push_chunk(L, q->path);
    lua_call(L, 0, 1);
    q->read(L, q->path, file->display, q->out);
    return 0;
}

status script_load_file(const char *path, script_reader *read, void *out, script_reports *reports) {
    script_options options = script_options_default();
    reports->count = 0;
    script *s = script_create(&options, reports);
    if (!s) {
        reports->count = 1;
        return report_set(&reports->items[0], STATUS_SYSTEM, "out of memory while %s was loaded", path);
    }
    run_protected(s, load_file_protected, &(file_request){path, read, out});
    s->reports = NULL;
    bool fine = s->problem_count == 0;
    if (!fine) sort_reports(s, reports);
    script_close(s);
    return fine ? STATUS_OK : reports->items[0].code;
}

status sweep_load(const char *path, sweep *out, script_reports *reports) {
    return script_load_file(path, read_sweep, out, reports);
}

scene *script_scene(script *s) {
    return s->scene;
}

int script_source_count(const script *s) {
    return s->source_count;
}

script_source script_source_at(const script *s, int index) {
    const source_file *file = &s->sources[index];
    return (script_source){.name = file->name, .text = file->text, .size = file->size};
}

int script_declaration_count(const script *s) {
    return s->declared_count;
}

script_declaration script_declaration_at(const script *s, int index) {
    const declaration *d = &s->declared[index];
    return (script_declaration){.name = d->name, .choices = d->choices, .choice_count = d->choice_count, .shown = &d->shown};
}

const char *script_resolved(script *s) {
    return s->resolved;
}

const char *script_log(const script *s) {
    return s->log;
}

void script_close(script *s) {
    if (!s) return;
    if (s->L) lua_close(s->L);
    scene_destroy(s->scene);
    arena_destroy(s->memory);
    memory_free(s, sizeof *s);
}
