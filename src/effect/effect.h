/* One table describes an effect.
 *
 * Everything that other floors show, validate, store or plan about an effect is read from its table: the script's
 * validator, the workbench's knobs, the ledger's columns, `sunder explain`, the checkpoint's contents, the automatic time
 * step and the reference pages. Adding an effect touches its own file and one list. */
#ifndef SUNDER_EFFECT_EFFECT_H
#define SUNDER_EFFECT_EFFECT_H

#include "base/status.h"

#include <stdbool.h>

typedef enum engine_kind { ENGINE_SOLID, ENGINE_SHEET } engine_kind;

/* Who owns an effect's parameters: each material its own, or the scene once. */
typedef enum effect_scope { SCOPE_MATERIAL, SCOPE_SCENE } effect_scope;

typedef enum parameter_kind {
    PARAMETER_REAL,
    PARAMETER_BOOLEAN, /* 0 or 1 */
    PARAMETER_CHOICE,  /* index into `choices` */
    PARAMETER_VECTOR,  /* three reals */
} parameter_kind;

enum { PARAMETER_LIMIT = 12, EFFECT_LIMIT = 32 };

/* Which way a parameter trades time for accuracy, for `sunder accuracy`: what has a rule becomes an axis of it. */
typedef enum accuracy_kind {
    ACCURACY_NONE,       /* it says what is simulated, not how well */
    ACCURACY_FACTOR,     /* the next finer value is `finer` times as large; 0 is as fine as can be */
    ACCURACY_DIFFERENCE, /* the next finer value is larger by `finer` */
    ACCURACY_CHOICE,     /* the next finer choice is `finer` (1 or −1) places on */
} accuracy_kind;

typedef struct accuracy_rule {
    accuracy_kind kind;
    double finer;
    const char *when; /* it matters only where this key of the same effect has the value `is`; NULL: always */
    double is;
} accuracy_rule;

typedef struct parameter {
    const char *key;  /* the scene's word, e.g. "sigma_c" */
    const char *unit; /* in base quantities: "1", "mass/(length time^2)", "time" … */
    const char *doc;  /* one line */
    parameter_kind kind;
    double minimum, maximum; /* inclusive range, for reals and each vector component */
    double fallback[3];      /* the value when the scene says nothing */
    const char *const *choices; /* NULL-terminated, for PARAMETER_CHOICE */
    bool live;        /* may be turned while a run goes on (acts at the next frame) */
    const char *why_not; /* of one that is not live: what makes it so, as in "the rest state is made with it" */
    bool logarithmic; /* a slider should step it by factors */
    bool required;    /* naming the effect without this key (or its twin) is an error */
    const char *twin; /* another key of the same effect that says the same thing: the one set last holds, both is an error */
    const char *scale; /* the field that scales this parameter from particle to particle, where a scene gives a function of place; NULL: one
                        * value a material */
    const char *short_form; /* the effect may be written as a bare value or array meaning this key (any non-NULL text) */
    accuracy_rule accuracy;
} parameter;

/* A per-particle array that an effect needs. */
typedef struct effect_field {
    const char *key; /* e.g. "damage" */
    int components;
    const char *unit;
    bool written; /* in frames, not only in checkpoints */
    const char *doc;
} effect_field;

/* A number that an effect reports each frame. */
typedef struct effect_measure {
    const char *key, *unit, *doc;
} effect_measure;

/* The values of one effect's parameters in one material (or scene). */
typedef struct effect_values {
    bool on;                           /* the effect was named */
    bool given[PARAMETER_LIMIT];       /* the scene said this key */
    double value[PARAMETER_LIMIT][3];  /* reals use [0] */
} effect_values;

struct solid_stages; /* src/solid/state.h */
struct sheet_stages; /* src/sheet/state.h */

typedef struct effect {
    const char *name; /* the scene's word, e.g. "damage" */
    engine_kind engine;
    effect_scope scope;
    const char *doc;
    const char *reference; /* paper and section, METHOD.md section */
    const parameter *parameters; /* [parameter_count] */
    int parameter_count;
    const effect_field *fields; /* [field_count] */
    int field_count;
    const effect_measure *measures; /* [measure_count] */
    int measure_count;
    /* Fills in twins and checks values against each other. `all` has shape [effect count]: the material's other effects
     * may be read (σc depends on E and ν). NULL when there is nothing to do. */
    status (*resolve)(effect_values *own, const effect_values *all, report *r);
    /* A key was turned while a run goes on: another one that says the same in its own way gives way to it (beyond twins). `all` as the engine's list.
     * NULL when there is none. */
    void (*turned)(effect_values *own, const effect_values *all, int key);
    const char *provides; /* what others may need of it where several effects are alternatives ("elasticity"), or NULL; a material
                           * has at most one that provides the same */
    const char *needs;    /* an effect, by name or by what it provides, that must be on beside this one; or NULL */
    const struct solid_stages *stages; /* what runs in the solid engine; NULL in effects whose work is the engine's own */
    const struct sheet_stages *sheet;  /* what runs in the sheet engine; likewise */
} effect;

/* The index of a parameter in its effect, or -1. */
int effect_parameter(const effect *e, const char *key);

/* Whether an effect answers a need: by its name or by what it provides. */
bool effect_supplies(const effect *e, const char *need);

/* Sets every value to its default and clears `given`. */
void effect_values_default(const effect *e, effect_values *values);

/* Checks ranges, required keys and twins of the values that are given, then resolves. `file`, `line` are where the scene
 * names the effect, for the message. */
status effect_values_check(const effect *e, effect_values *values, const effect_values *all, const char *file, int line,
                           report *r);

#endif
