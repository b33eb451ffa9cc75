/* Lua scenes and recipes: from a file's text to a validated `scene`.
 *
 * Scripts run in a sandbox: no os, io, debug, coroutines, load of binary chunks; `require` reaches only the built-in
 * module "sunder" and files beside the scene; 5 s and 512 MiB by default, and no string over 16 MiB: limits that no pcall
 * loop and no pattern call can swallow. Reading a name that does not exist is an error with the nearest one. After
 * loading, a write to a global, an upvalue or a table from a function of time or place is an error (purity.c). No C
 * resource is held across a Lua error. The C locale's decimal point is assumed (setlocale LC_NUMERIC stays "C"). */
#ifndef SUNDER_SCRIPT_SCRIPT_H
#define SUNDER_SCRIPT_SCRIPT_H

#include "base/status.h"
#include "sim/scene.h"

typedef struct script script;

typedef struct script_setting {
    const char *key, *value; /* from --set KEY=VALUE */
} script_setting;

typedef struct script_options {
    const char *recipe;             /* --recipe NAME: replaces every body's material, NULL for none */
    const script_setting *settings; /* [setting_count] */
    int setting_count;
    const char *resolved;           /* script_resolved's text, to pin parameters: weaker than settings; NULL for none */
    double time_limit;              /* seconds of processor time; 5 */
    size_t memory_limit;            /* bytes; 512 MiB */
} script_options;

script_options script_options_default(void);

enum { SCRIPT_REPORTS = 64 };

/* Everything that was wrong, in file order where possible; `check --json` lists them all. */
typedef struct script_reports {
    int count;
    report items[SCRIPT_REPORTS];
} script_reports;

/* Loads, validates and resolves a scene file; its functions of time and place are tried at a few times and points. On
 * STATUS_OK *out owns the Lua state and the scene. On failure *out is NULL and `reports` holds at least one entry; its
 * first one's code is the return value. */
status script_load(const char *path, const script_options *options, script **out, script_reports *reports);

/* The scene, owned by the script: its functions call into the script's Lua state. */
scene *script_scene(script *s);

/* The text of each file that took part (scene, recipes, modules): written into the run's folder. name is relative,
 * without "..": "tube_pull.lua", "recipes/tube.lua". */
typedef struct script_source {
    const char *name, *text;
    size_t size;
} script_source;
int script_source_count(const script *s);
script_source script_source_at(const script *s, int index);

/* What the scene's s.params declared: what --set may be given for it. Strings and choices are the script's. */
typedef struct script_declaration {
    const char *name;
    const char *const *choices; /* [choice_count] of a text that has only those; NULL else */
    int choice_count;
    const scene_parameter *shown; /* its value, unit and doc */
} script_declaration;
int script_declaration_count(const script *s);
script_declaration script_declaration_at(const script *s, int index);

/* A Lua text that, given as script_options.resolved, pins every resolved parameter ("return { pull = 0.1, … }"); owned
 * by `s`. */
const char *script_resolved(script *s);

/* What the script printed, at most 8 KiB; owned by `s`. */
const char *script_log(const script *s);

void script_close(script *s);

#endif
