/* What the files of this floor share. Nothing outside src/script includes it.
 *
 * A script is loaded in one protected call (script.c). What is wrong is either recorded, so that one look at a scene
 * finds as many mistakes as possible (problem_*), or raised, when there is nothing to go on with (throw_*). Both end as
 * `report`s. All memory that outlives a Lua call lives in an arena or in the Lua state: an error may jump over any C
 * frame of this floor. */
#ifndef SUNDER_SCRIPT_INTERNAL_H
#define SUNDER_SCRIPT_INTERNAL_H

#include "script/guard.h"
#include "script/place.h"
#include "script/script.h"

#include <lauxlib.h>
#include <lua.h>

enum {
    SCRIPT_SOURCES = 64,
    SCRIPT_DECLARED = 96,
    SCRIPT_SETTINGS = 512,
    SCRIPT_PATH = 4096,
    SCRIPT_LOG = 8192,
    SCRIPT_TEXT = 128,            /* longest text value, terminator included */
    API_STACK = 64,               /* stack slots that a function called from Lua reserves when it reads tables */
    SCENE_SITE = SCENE_MATERIALS, /* row of the scene's own effects in script.sites */
};

/* A value without its origin: from a Lua table, from --set (raw: any kind that the text can be read as), or pinned. */
typedef enum plain_kind { PLAIN_NONE, PLAIN_NUMBER, PLAIN_BOOLEAN, PLAIN_TEXT, PLAIN_VECTOR, PLAIN_OTHER } plain_kind;
typedef struct plain_value {
    plain_kind kind;
    bool raw;         /* text that may be read as another kind */
    double number[3]; /* booleans: 0 or 1 */
    char text[SCRIPT_TEXT];
    char found[160]; /* for messages */
} plain_value;

typedef struct script_override {
    const char *key, *value;
    bool pinned; /* from options.resolved, not from --set */
    bool used;
} script_override;

/* What s.params declared. */
typedef struct declaration {
    char name[SCRIPT_TEXT];
    plain_kind kind;
    double minimum, maximum;
    const char *const *choices; /* [choice_count], in the script's arena; NULL when free */
    int choice_count;
    scene_parameter shown;
    const char *file;
    int line;
} declaration;

typedef struct source_file {
    const char *name;    /* in the run's folder: "recipes/tube.lua" */
    const char *display; /* in messages: the path as people write it */
    const char *text;    /* NUL-terminated */
    size_t size;
} source_file;

/* Where an effect was switched on. */
typedef struct effect_site {
    const char *file;
    int line;
} effect_site;

struct script {
    guard guard;
    lua_State *L;
    arena *memory;
    scene *scene;
    script_reports *reports; /* while loading */
    int problem_count;       /* recorded, those that no longer fitted included */
    int charged;             /* units of scene_charge so far */
    const char *recipe;      /* --recipe or NULL */
    const char *folder;      /* absolute, of the scene file */
    const char *working;     /* the working folder, absolute */
    bool loaded;             /* nothing may be declared, required or changed any more */
    place here;              /* the call into the module that is running */
    int scene_line;          /* of the call of s.scene */
    place body_places[SCENE_BODIES];
    place sheet_places[SCENE_SHEETS];
    int source_count, declared_count, override_count, watch_count;
    source_file sources[SCRIPT_SOURCES];
    declaration declared[SCRIPT_DECLARED];
    script_override overrides[SCRIPT_SETTINGS];
    effect_site sites[SCENE_MATERIALS + 1][EFFECT_LIMIT];
    uint64_t scene_keys_declared; /* bit by scene key: s.params said it */
    uint64_t scene_keys_set;      /* bit by scene key: --set said it */
    bool knob_set[SCENE_MATERIALS + 1][EFFECT_LIMIT][PARAMETER_LIMIT];
    bool density_set[SCENE_MATERIALS];
    uint64_t random_count; /* draws of math.random */
    int *watched;          /* [watch_count] upvalue index of each watched function (purity.c) */
    char log[SCRIPT_LOG];
    size_t log_used;
    const char *resolved;
};

/* Keys of the registry (lua_rawsetp). */
extern const char KEY_FROZEN, KEY_ENVIRONMENT, KEY_GLOBALS, KEY_MODULES, KEY_RECIPES, KEY_ORIGINS, KEY_MATERIALS,
    KEY_SCENE, KEY_SWEEP, KEY_FUNCTIONS, KEY_WATCHED;

/* Names of metatables (luaL_newmetatable). */
#define META_REPORT "sunder.report"
#define META_SHAPE "sunder.shape"
#define META_FIBRES "sunder.fibres"
#define META_CHOICE "sunder.choice"

script *script_of(lua_State *L);

/* ---- script.c ---- */
/* A script that has loaded nothing yet: its Lua state is bare. NULL: out of memory. */
script *script_create(const script_options *options, script_reports *reports);
/* Loads a Lua file that is no scene: runs it, then `read` with what it returned on top of the stack. `path`: as given; `file`: as people write it. */
typedef void script_reader(lua_State *L, const char *path, const char *file, void *out);
status script_load_file(const char *path, script_reader *read, void *out, script_reports *reports);

/* ---- errors.c ---- */
void throw_report(lua_State *L, const report *r) __attribute__((noreturn));
/* Raises wrong input at a place; the place's path is the key. */
void throw_place(lua_State *L, const place *p, const char *expected, const char *found, const char *nearest)
    __attribute__((noreturn));
/* Raises wrong input at the innermost line of a scene or recipe that is running. */
void throw_here(lua_State *L, const char *key, const char *expected, const char *found, const char *nearest)
    __attribute__((noreturn));
void throw_memory(lua_State *L) __attribute__((noreturn));
void problem_report(script *s, const report *r);
void problem_place(script *s, const place *p, const char *expected, const char *found, const char *nearest);
/* The line of a place, by its source's text. */
int place_line(script *s, const place *p);
/* The innermost running line of a scene or recipe. */
place place_running(lua_State *L);
/* lua_pcall's message handler: turns any error value into a report. */
int error_handler(lua_State *L);
/* Reads the error that a protected call left (and pops it). */
status error_take(script *s, int lua_status, report *r);
/* Appends to the script's log; what does not fit is dropped. */
void log_text(script *s, const char *text, size_t size);

/* ---- values.c ---- */
/* "3", "'text'", "a table", "a shape", "nothing" … */
void describe_value(lua_State *L, int index, char *text, size_t size);
plain_value plain_from_lua(lua_State *L, int index);
plain_value plain_from_text(const char *text);
/* What kind was expected of a value, and its range. */
typedef struct plain_rule {
    plain_kind kind;
    double minimum, maximum;
    bool above;                 /* the minimum itself is not allowed */
    bool whole;                 /* integers only */
    bool infinite;              /* ±inf allowed */
    bool automatic;             /* "auto" allowed: number 0 */
    const char *const *choices; /* of texts: the number is the index; NULL-terminated */
} plain_rule;
/* Brings a value to its rule's kind. False: expected[256] says what was wanted, *nearest the nearest choice or NULL. */
bool plain_fit(plain_value *v, const plain_rule *rule, char *expected, size_t size, const char **nearest);
/* Reads the value at `index` by a rule; records a problem and returns false when it does not fit. */
bool read_plain(script *s, int index, const place *p, const plain_rule *rule, plain_value *out);

/* Named fields of a table. */
typedef enum field_kind {
    FIELD_REAL,
    FIELD_SIZE,
    FIELD_VECTOR,
    FIELD_AXIS,
    FIELD_FLAG,
    FIELD_CHOICE,
    FIELD_TEXT,
    FIELD_OTHER
} field_kind;
typedef struct field {
    const char *key;
    field_kind kind;
    bool required;
    double *number; /* reals 1, vectors and axes 3, flags and choices 1 */
    char *text;     /* [SCRIPT_TEXT] */
    const char *const *choices;
    double minimum, maximum; /* of reals, when minimum < maximum */
    bool infinite;
    bool given; /* out */
} field;
/* Reads the table at `index`: unknown keys, wrong kinds and missing fields are recorded; returns whether all was well.
 * FIELD_OTHER is only known to be there. */
bool read_fields(script *s, int index, const place *p, field *fields, int count);
/* A table that says itself what is in it: no list where names are wanted, no metatable that adds keys unseen. */
bool read_table(script *s, int index, const place *p, const char *expected);
/* The length of a list whose keys are 1 … n and nothing else; −1 and a recorded problem otherwise. */
int read_list(script *s, int index, const place *p, int limit, const char *expected);
/* The keys of a table, sorted, as a list on the stack; keys that are no names are recorded as problems and left out. */
int push_sorted_names(script *s, int index, const place *p);

/* ---- sandbox.c, strings.c, tables.c ---- */
void sandbox_open(lua_State *L);
/* Wraps the table on top of the stack: reading goes through, writing is an error, unknown names are errors. `what`
 * names it. */
void push_read_only(lua_State *L, const char *what);
/* Pushes the table that really holds the contents of the value at `index` (itself, unless it is wrapped or frozen). */
void push_contents(lua_State *L, int index);
/* Pushes a value as text, without addresses: they differ from run to run. */
void push_text(lua_State *L, int index);
/* Iterators keep a state of their own (purity.c watches it). */
int gmatch_step(lua_State *L);
int pairs_step(lua_State *L);
void strings_open(lua_State *L, int library);
void tables_open(lua_State *L, int library, int base);

/* ---- files.c ---- */
/* Finds, reads and loads NAME.lua: leaves its chunk's function on the stack. */
const source_file *load_scene_file(lua_State *L, const char *path);
int sandbox_require(lua_State *L);
/* Pushes a fresh copy of a recipe's table, marked with its origin. `p` is where it was asked for. */
void push_recipe(lua_State *L, const char *name, const place *p);
const source_file *find_source(const script *s, const char *display);
/* Reads a data file (a mesh, a table) by its path from the scene's folder; it becomes one of the sources, so that the
 * run's folder has it. `endings` lists those allowed, as in ".obj.ply.stl", and is part of what was expected. NULL after
 * recording a problem at `p`. */
const source_file *read_data_file(script *s, const char *name, const char *endings, const place *p);

/* ---- module.c ---- */
/* Builds the module `sunder`: leaves it on the stack. */
void module_open(lua_State *L);
int api_recipe(lua_State *L);

/* ---- params.c ---- */
int api_params(lua_State *L);
int api_choice(lua_State *L);
/* Copies --set and pinned values into the script. */
void overrides_prepare(lua_State *L, const script_options *options);

/* ---- shapes.c, fibres.c ---- */
typedef struct shape_value {
    const shape *shape; /* NULL: wrong, and already reported */
    int weight;         /* primitives in the tree */
} shape_value;
/* Counts what a script makes in the scene's arena, in units of about 100 bytes; raises when it is absurdly much. */
void scene_charge(lua_State *L, int units);
void shapes_open(lua_State *L);
int api_shape(lua_State *L);
int api_mesh(lua_State *L);
int api_combine(lua_State *L);
int api_translate(lua_State *L);
int api_rotate(lua_State *L);
int api_scale(lua_State *L);
/* The shape at `index`, or NULL after recording a problem (also when the shape itself was wrong). */
const shape *read_shape(script *s, int index, const place *p);

void fibres_open(lua_State *L);
int api_fibres(lua_State *L);
/* Reads `fibres` of a body of that shape (NULL: it was wrong). The families of a function are FAMILIES_UNKNOWN until it is
 * tried. */
enum { FAMILIES_UNKNOWN = -1 };
void read_fibres(script *s, int index, const place *p, const shape *body, scene_fibres *out);

/* ---- callbacks.c ---- */
/* Reads a constant vector, or a Lua function, of three outputs. */
void read_function(script *s, int index, const place *p, scene_function *out);
/* The same of one output: a number, or a function of place that returns one. */
void read_scalar_function(script *s, int index, const place *p, scene_function *out);
/* Makes a callback of the Lua function at `index`; `p` names it in messages. */
void make_callback(script *s, int index, const place *p, int outputs, scene_function *out);
/* Calls every function of the scene once or a few times, where and when the simulation may call it too; records
 * failures and fills in fibre families. */
void try_functions(script *s);

/* ---- purity.c ---- */
/* Freezes every table that the callbacks can reach and remembers every upvalue. */
void purity_freeze(lua_State *L);
/* Compares upvalues with what they were; the name of a changed one, or NULL. Pushes nothing. */
const char *purity_broken(lua_State *L);

/* ---- materials.c ---- */
/* The index in the scene's materials of the value at `index` (table or recipe name) of a body of some engine, or −1 with a recorded problem. */
int read_material(script *s, int index, const place *p, engine_kind engine, const char *body);
/* Reads one effect's value (the table, a bare value, true or false) into `values`. */
void read_effect(script *s, int index, const place *p, const effect *e, effect_values *values, effect_site *site);
/* Ranges, required keys and twins of everything that is on. */
void check_effects(script *s);
bool set_effect_parameter(const effect *e, int key, plain_value *v, effect_values *values, char *expected, size_t size,
                          const char **nearest);

/* ---- scene_keys.c ---- */
int scene_key_count(void);
const char *scene_key_name(int key);
int scene_key_find(const char *name);
/* Writes a scene's plain key; false as plain_fit. */
bool scene_key_set(scene *s, int key, plain_value *v, char *expected, size_t size, const char **nearest);
void scene_key_show(const scene *s, int key, scene_parameter *out);

/* ---- scene_table.c ---- */
/* Names are kept short: 63 bytes. An absent one becomes "solid 2" and the like. */
void copy_name(script *s, const place *p, const char *given, const char *kind, int number, char out[64]);
/* Pushes the value under `key` of the table at `index`; whether there is one. */
bool push_value(lua_State *L, int index, const char *key);
/* Under the keys `shape`, `key` and `material` of the table at `index`. */
const shape *read_shape_field(script *s, int index, const place *p);
void function_field(script *s, int index, const place *p, const char *key, scene_function *out);
int read_body_material(script *s, int index, const place *p, engine_kind engine, const char *body);
/* Reads the table that the scene file returned (top of the stack). */
void read_scene(lua_State *L, const char *file);

/* ---- sheets.c ---- */
/* Reads the list under `sources` of the table at `index`. */
void read_sources(script *s, int index, const place *p, int *count, scene_source items[BODY_SOURCES]);
/* Reads one of `sheets`. */
void read_sheet(script *s, int index, const place *p, int number);

/* ---- expect.c ---- */
/* Reads `expect`, what a hard case expects of its run. */
void read_expect(script *s, int index, const place *p);

/* ---- sweep.c ---- */
/* Reads the table that a sweep's file returned (top of the stack); `path` is where the file is, from the working folder. */
struct sweep;
script_reader read_sweep;

/* ---- settings.c ---- */
/* Applies what s.params did not take: scene keys and knobs. Unknown keys are recorded. */
void settings_apply(script *s);

/* ---- resolved.c ---- */
/* Fills scene.parameters and the text that pins them. */
status resolve_parameters(script *s, report *r);

#endif
